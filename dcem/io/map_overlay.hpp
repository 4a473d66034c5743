#pragma once
/// Maps on the ground of Google Earth.
#include <string>

#include "dcem/io/atomic_file.hpp"
#include "dcem/io/geo_anchor.hpp"
#include "dcem/io/heat_map.hpp"

namespace dcem::io {

/// Writes the cells of a map as a picture without axes and text into `picture`, and into `kml` what lays it over the
/// ground (OGC KML with gx:LatLonQuad of Google's extensions); the caller commits. Throws `OutputError`, and as
/// `heat_map_layout` and `place_on_earth`.
void write_ground_overlay(AtomicFile& kml, AtomicFile& picture, const HeatMap& map, const GeoAnchor& anchor);

}  // namespace dcem::io
