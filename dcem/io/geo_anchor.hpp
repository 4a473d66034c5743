#pragma once
/// Where on the Earth (WGS 84) a scene lies: the block `geo` of a scenario.
#include <array>
#include <string_view>
#include <variant>

namespace dcem::io {

/// The origin of the scene; x runs east and y north in the plane that touches the ellipsoid there.
struct GeoOrigin {
  double lat_deg = 0.0;
  double lon_deg = 0.0;
};

/// A zone of UTM; easting and northing are x and y plus the offset.
struct UtmFrame {
  int zone = 32;  ///< 1…60
  bool northern = true;
  std::array<double, 2> offset_m{0.0, 0.0};
};

using GeoAnchor = std::variant<GeoOrigin, UtmFrame>;

struct GeoPlace {
  double lat_deg = 0.0;
  double lon_deg = 0.0;
  double north_deg = 0.0;  ///< of the scene's y axis: by how much it points east of north
};

/// Whether this build knows UTM.
bool knows_utm();

inline constexpr std::string_view no_utm = "this build knows no UTM";
inline constexpr std::string_view utm_expected = "GeographicLib (libgeographiclib-dev) when DCEM was built";

/// The place of a point of the scene. Throws std::invalid_argument where UTM ends, and std::logic_error where this
/// build knows no UTM.
GeoPlace place_on_earth(const GeoAnchor& anchor, double x_m, double y_m);
/// x and y of the point of the scene that has this place. Throws std::invalid_argument where the anchor has none for
/// it, and std::logic_error where this build knows no UTM.
std::array<double, 2> point_in_scene_m(const GeoAnchor& anchor, double lat_deg, double lon_deg);

}  // namespace dcem::io
