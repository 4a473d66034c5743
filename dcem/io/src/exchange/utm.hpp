#pragma once
/// UTM, from GeographicLib. Private to dcem::io.
#include <string>

#include "dcem/io/geo_anchor.hpp"

namespace dcem::io {

/// Throws as `place_on_earth`.
GeoPlace place_from_utm(const UtmFrame& frame, double easting_m, double northing_m);

/// "GeographicLib 2.1.2". Only where there is one.
std::string utm_library();

}  // namespace dcem::io
