// UTM with GeographicLib. Compiled only where GeographicLib is.
#include <GeographicLib/Config.h>

#include <GeographicLib/UTMUPS.hpp>
#include <stdexcept>

#include "dcem/io/src/exchange/utm.hpp"

namespace dcem::io {

bool knows_utm() {
  return true;
}

std::string utm_library() {
  return "GeographicLib " GEOGRAPHICLIB_VERSION_STRING;
}

GeoPlace place_from_utm(const UtmFrame& frame, double easting_m, double northing_m) {
  try {
    GeoPlace place;
    double scale = 1.0;
    GeographicLib::UTMUPS::Reverse(frame.zone, frame.northern, easting_m, northing_m, place.lat_deg, place.lon_deg,
                                   place.north_deg, scale);
    return place;
  } catch (const GeographicLib::GeographicErr& error) {
    throw std::invalid_argument(std::string("geo: no place in UTM (") + error.what() +
                                "); expected a scene within the zone");
  }
}

}  // namespace dcem::io
