#pragma once
/// Longitudes and latitudes on the plane (UTM, WGS 84), by GeographicLib. Private to dcem::io.
///
/// Without GeographicLib all that know places throw std::logic_error: `knows_utm` is asked first.
#include <optional>
#include <string>
#include <string_view>

#include "dcem/geometry/vector.hpp"
#include "dcem/io/geo_anchor.hpp"

namespace dcem::io {

struct GeoPoint {
  double latitude_deg = 0.0, longitude_deg = 0.0;
};

struct UtmZone {
  int number = 0;
  bool is_north = true;

  /// As scenarios name it: "utm32n".
  std::string name() const { return "utm" + std::to_string(number) + (is_north ? 'n' : 's'); }
};

/// The zone of such a name; nothing where there is none.
std::optional<UtmZone> utm_zone_named(std::string_view name);

/// "GeographicLib 2.1.2", or "no GeographicLib".
std::string utm_library();

/// The standard zone of a point.
UtmZone utm_zone(const GeoPoint& point);
/// Easting and northing in a zone, also of points somewhat outside of it. Throws std::invalid_argument far outside.
Vec2 utm_m(const GeoPoint& point, const UtmZone& zone);
/// Throws std::invalid_argument where that is no place of the zone.
GeoPoint geo_point(const Vec2& utm_m, const UtmZone& zone);
/// Throws as `place_on_earth`.
GeoPlace place_from_utm(const UtmFrame& frame, double easting_m, double northing_m);

}  // namespace dcem::io
