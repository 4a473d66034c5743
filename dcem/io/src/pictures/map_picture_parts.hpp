#pragma once
/// What the pictures of all maps have in common. Private to dcem::io.
#include <limits>
#include <optional>
#include <string>

#include "dcem/io/heat_map.hpp"
#include "dcem/scene/device.hpp"
#include "dcem/scene/scene.hpp"

namespace dcem::io {

/// A point of a picture without a value.
inline constexpr double no_value_db = std::numeric_limits<double>::quiet_NaN();

/// Where and when a map was made.
struct MapOccasion {
  const Scene& scene;
  const Frame& frame;
  double frequency_hz = 0.0;
  std::optional<double> time_s;  ///< for the title
};

/// A picture without values: the axes of the grid, the walls at its height, and the transmitters with their names.
/// `what` begins the title.
HeatMap empty_map_picture(const ReceiverGrid& grid, const MapOccasion& occasion, const std::string& what);

/// Hatches the next cell where its point is obstructed or sheltered; the legend tells of the latter where there are
/// any.
template <typename Point>
void hatch_point(HeatMap& picture, const Point& point) {
  picture.hatched.push_back(point.obstructed || point.sheltered ? 1 : 0);
  if (point.sheltered) picture.hatched_label = "inside, on a wall, or unreached under a roof";
}

/// ", 30 GHz, z = 1.50 m" and, where there are any, the samples of a cell and the instant.
std::string map_title_end(const ReceiverGrid& grid, const MapOccasion& occasion);

}  // namespace dcem::io
