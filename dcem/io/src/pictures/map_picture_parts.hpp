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

/// A picture without values: the axes of the grid, the walls at its height, and the transmitters, of which those for
/// which `labelled(id)` holds have a label. `what` begins the title.
template <typename Labelled>
HeatMap empty_map_picture(const ReceiverGrid& grid, const MapOccasion& occasion, const std::string& what,
                          Labelled&& labelled);

/// ", 30 GHz, z = 1.50 m" and, where there are any, the samples of a cell and the instant.
std::string map_title_end(const ReceiverGrid& grid, const MapOccasion& occasion);

// ---------------------------------------------------------------------------------------------------------------------

/// The same without transmitters.
HeatMap map_picture_ground(const ReceiverGrid& grid, const MapOccasion& occasion);

template <typename Labelled>
HeatMap empty_map_picture(const ReceiverGrid& grid, const MapOccasion& occasion, const std::string& what,
                          Labelled&& labelled) {
  HeatMap picture = map_picture_ground(grid, occasion);
  picture.title = what + map_title_end(grid, occasion);
  for (const Device& device : occasion.scene.transmitters()) {
    const DeviceState state = occasion.scene.device_state(device, occasion.frame);
    if (!state.present) continue;
    picture.transmitters.push_back(
        {state.position_m.x, state.position_m.y, labelled(device.id) ? device.id : std::string()});
  }
  return picture;
}

}  // namespace dcem::io
