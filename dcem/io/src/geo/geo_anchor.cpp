#include "dcem/io/geo_anchor.hpp"

#include <charconv>
#include <cmath>
#include <cstddef>
#include <stdexcept>

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

/// The plane's point above or below a place: up along the ellipsoid's normal there until it meets the plane.
std::array<double, 2> point_on_plane(const GeoOrigin& origin, double lat_deg, double lon_deg) {
  const double lat0 = degrees_to_radians(origin.lat_deg), lat = degrees_to_radians(lat_deg);
  const double turn = degrees_to_radians(std::remainder(lon_deg - origin.lon_deg, 360.0));
  const auto across_m = [](double at) {
    return major_m / std::sqrt(1.0 - first_eccentricity2 * std::sin(at) * std::sin(at));
  };
  // From the origin, in Earth-centred axes: away from the Earth's axis in the origin's meridian, east, north.
  const std::array<double, 3> normal{std::cos(lat) * std::cos(turn), std::cos(lat) * std::sin(turn), std::sin(lat)};
  const std::array<double, 3> from_origin_m{
      across_m(lat) * normal[0] - across_m(lat0) * std::cos(lat0), across_m(lat) * normal[1],
      (1.0 - first_eccentricity2) * (across_m(lat) * normal[2] - across_m(lat0) * std::sin(lat0))};
  const double upwards = std::cos(lat0) * normal[0] + std::sin(lat0) * normal[2];
  if (!(upwards > 0.0)) {
    throw std::invalid_argument("beyond the horizon of the scene; expected a place on its side of the Earth");
  }
  const double below_m = std::cos(lat0) * from_origin_m[0] + std::sin(lat0) * from_origin_m[2];
  const auto on_plane_m = [&](std::size_t axis) { return from_origin_m[axis] - below_m / upwards * normal[axis]; };
  return {on_plane_m(1), std::cos(lat0) * on_plane_m(2) - std::sin(lat0) * on_plane_m(0)};
}

}  // namespace

std::optional<UtmZone> utm_zone_named(std::string_view name) {
  const bool has_ends = name.starts_with("utm") && (name.ends_with('n') || name.ends_with('s'));
  if (!has_ends || name.size() < 5) return std::nullopt;
  const char* const end = name.data() + name.size() - 1;
  UtmZone zone{0, name.ends_with('n')};
  const auto [rest, error] = std::from_chars(name.data() + 3, end, zone.number);
  if (error != std::errc{} || rest != end || zone.number < 1 || zone.number > 60) return std::nullopt;
  return zone;
}

std::array<double, 2> point_in_scene_m(const GeoAnchor& anchor, double lat_deg, double lon_deg) {
  if (const auto* origin = std::get_if<GeoOrigin>(&anchor)) return point_on_plane(*origin, lat_deg, lon_deg);
  const UtmFrame& frame = std::get<UtmFrame>(anchor);
  const Vec2 there_m = utm_m({lat_deg, lon_deg}, {frame.zone, frame.northern});
  return {there_m.x - frame.offset_m[0], there_m.y - frame.offset_m[1]};
}

GeoPlace place_on_earth(const GeoAnchor& anchor, double x_m, double y_m) {
  if (const auto* origin = std::get_if<GeoOrigin>(&anchor)) return place_from_plane(*origin, x_m, y_m);
  const UtmFrame& frame = std::get<UtmFrame>(anchor);
  return place_from_utm(frame, x_m + frame.offset_m[0], y_m + frame.offset_m[1]);
}

}  // namespace dcem::io
