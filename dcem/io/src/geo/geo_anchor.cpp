#include "dcem/io/geo_anchor.hpp"

#include <cmath>

#include "dcem/core/units.hpp"
#include "dcem/io/src/geo/utm.hpp"

namespace dcem::io {
namespace {

// The ellipsoid of WGS 84 (NIMA TR8350.2): semi-major axis and flattening.
constexpr double major_m = 6378137.0, flattening = 1.0 / 298.257223563;
constexpr double minor_m = major_m * (1.0 - flattening);
constexpr double first_eccentricity2 = flattening * (2.0 - flattening);
constexpr double second_eccentricity2 = first_eccentricity2 / (1.0 - first_eccentricity2);

/// From the plane to Earth-centred coordinates, and from there to the ellipsoid by Bowring's formula (Survey Review 23,
/// 1976), which is off by less than a micrometre near the ground.
GeoPlace place_from_plane(const GeoOrigin& origin, double x_m, double y_m) {
  const double lat = degrees_to_radians(origin.lat_deg), lon = degrees_to_radians(origin.lon_deg);
  const double across_m = major_m / std::sqrt(1.0 - first_eccentricity2 * std::sin(lat) * std::sin(lat));
  const double outwards_m = across_m * std::cos(lat) - std::sin(lat) * y_m;  // away from the axis, in the meridian
  const double up_m = across_m * (1.0 - first_eccentricity2) * std::sin(lat) + std::cos(lat) * y_m;
  const double radius_m = std::hypot(outwards_m, x_m);
  const double aux = std::atan2(up_m * major_m, radius_m * minor_m);
  const double lat_there = std::atan2(up_m + second_eccentricity2 * minor_m * std::pow(std::sin(aux), 3),
                                      radius_m - first_eccentricity2 * major_m * std::pow(std::cos(aux), 3));
  const double turn = std::atan2(x_m, outwards_m);
  const double lon_there = std::remainder(radians_to_degrees(lon + turn), 360.0);
  return {radians_to_degrees(lat_there), lon_there, -radians_to_degrees(turn * std::sin(lat))};
}

}  // namespace

GeoPlace place_on_earth(const GeoAnchor& anchor, double x_m, double y_m) {
  if (const auto* origin = std::get_if<GeoOrigin>(&anchor)) return place_from_plane(*origin, x_m, y_m);
  const UtmFrame& frame = std::get<UtmFrame>(anchor);
  return place_from_utm(frame, x_m + frame.offset_m[0], y_m + frame.offset_m[1]);
}

}  // namespace dcem::io
