#pragma once
/// What the viewer keeps of the maps over one grid or list. Private to dcem::io.
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "dcem/channel/map_combination.hpp"
#include "dcem/channel/radio_map.hpp"

namespace dcem::io {

/// Where the cells of a grid lie, with the points in their middles.
struct ViewedRaster {
  Vec3 corner_m{0.0};  ///< the lower left corner of the first cell
  std::array<double, 2> spacing_m{1.0, 1.0};
  std::size_t columns = 0, rows = 0;
};

enum class MapQuantity { power, best_server, sinr, sir };

/// One quantity at all points.
struct ViewedLayer {
  MapQuantity quantity = MapQuantity::power;
  std::size_t transmitter = 0;  ///< of a power
  std::vector<float> values;    ///< dBm (incoherent), number of the server, or dB; NaN where there is none
};

struct ViewedMap {
  std::string places;                  ///< id of the grid or list
  std::optional<ViewedRaster> raster;  ///< of a grid
  std::vector<Vec3> points_m;          ///< of a list
  std::vector<bool> obstructed;
  std::vector<ViewedLayer> layers;  ///< the powers by transmitter, then what they are together

  std::size_t value_count() const { return layers.size() * obstructed.size(); }
};

/// The maps of all transmitters over one grid or list, and what they are together where that says more than one of
/// them: every `step`-th point of a list, or along each axis of a grid. At least one map.
ViewedMap view_of_maps(std::span<const RadioMap> maps, const CombinedMap& combined, bool has_noise, std::size_t step);

}  // namespace dcem::io
