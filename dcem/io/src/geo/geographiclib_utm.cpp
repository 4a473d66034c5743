// UTM with GeographicLib. Compiled only where GeographicLib is.
#include <GeographicLib/Config.h>

#include <GeographicLib/UTMUPS.hpp>
#include <stdexcept>

#include "dcem/io/src/geo/utm.hpp"

namespace dcem::io {

bool knows_utm() {
  return true;
}

std::string utm_library() {
  return "GeographicLib " GEOGRAPHICLIB_VERSION_STRING;
}

UtmZone utm_zone(const GeoPoint& point) {
  const int zone =
      GeographicLib::UTMUPS::StandardZone(point.latitude_deg, point.longitude_deg, GeographicLib::UTMUPS::UTM);
  return {zone, point.latitude_deg >= 0.0};
}

Vec2 utm_m(const GeoPoint& point, const UtmZone& zone) {
  int its_zone = 0;
  bool is_north = true;
  Vec2 result(0.0);
  try {
    GeographicLib::UTMUPS::Forward(point.latitude_deg, point.longitude_deg, its_zone, is_north, result.x, result.y,
                                   zone.number);
  } catch (const GeographicLib::GeographicErr& error) {
    throw std::invalid_argument(std::string("no place in UTM (") + error.what() + "); expected one within the zone");
  }
  // A scene across the equator stays in one piece: northings go on below 0, or above 10 000 km.
  if (is_north != zone.is_north) result.y += is_north ? 1e7 : -1e7;
  return result;
}

GeoPoint geo_point(const Vec2& utm_m, const UtmZone& zone) {
  GeoPoint point;
  try {
    GeographicLib::UTMUPS::Reverse(zone.number, zone.is_north, utm_m.x, utm_m.y, point.latitude_deg,
                                   point.longitude_deg);
  } catch (const GeographicLib::GeographicErr& error) {
    throw std::invalid_argument(std::string("no place in UTM (") + error.what() + "); expected one within the zone");
  }
  return point;
}

GeoPlace place_from_utm(const UtmFrame& frame, double easting_m, double northing_m) {
  try {
    GeoPlace place;
    double scale = 1.0;
    GeographicLib::UTMUPS::Reverse(frame.zone, frame.northern, easting_m, northing_m, place.lat_deg, place.lon_deg,
                                   place.north_deg, scale);
    return place;
  } catch (const GeographicLib::GeographicErr& error) {
    throw std::invalid_argument(std::string("no place in UTM (") + error.what() +
                                "); expected a scene within the zone");
  }
}

}  // namespace dcem::io
