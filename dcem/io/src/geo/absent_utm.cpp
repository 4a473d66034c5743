// In place of geographiclib_utm.cpp where there is no GeographicLib.
#include <stdexcept>

#include "dcem/io/src/geo/utm.hpp"

namespace dcem::io {

namespace {

[[noreturn]] void refuse() {
  throw std::logic_error(std::string(no_utm) + "; expected " + std::string(utm_expected));
}

}  // namespace

bool knows_utm() {
  return false;
}

std::string utm_library() {
  return "no GeographicLib";
}

UtmZone utm_zone(const GeoPoint&) {
  refuse();
}

Vec2 utm_m(const GeoPoint&, const UtmZone&) {
  refuse();
}

GeoPoint geo_point(const Vec2&, const UtmZone&) {
  refuse();
}

GeoPlace place_from_utm(const UtmFrame&, double, double) {
  refuse();
}

}  // namespace dcem::io
