#pragma once
/// Transmitters and receivers.
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "dcem/em/antenna/antenna.hpp"
#include "dcem/geometry/vector.hpp"
#include "dcem/world/motion.hpp"

namespace dcem {

/// A device rides on an object: its position is the object's pose applied to `offset_m`, and for its own links that
/// object does not exist unless `sees_own_body`.
struct Attachment {
  std::string object;
  Vec3 offset_m{0.0};
  bool sees_own_body = false;
};

/// A transmitter or a receiver. It stands or moves by `motion`, or rides on an object.
struct Device {
  std::string id;
  Motion motion = LinearMotion{};
  std::optional<Attachment> attachment;
  Antenna antenna;
  double power_dbm = 0.0;  ///< transmit power; not used for a receiver
  /// It is a transmitter and a receiver of the scene: of two such devices there is one link (Scene::add_transceiver).
  bool is_transceiver = false;
};

/// A device that stands still.
inline Device device_at(std::string id, const Vec3& position_m, double power_dbm = 0.0, Antenna antenna = {}) {
  return {std::move(id), LinearMotion{{position_m}, Vec3(0.0), 0.0}, std::nullopt, std::move(antenna), power_dbm};
}

/// Receivers on a regular grid: point (row, column) is origin + (column·spacing_x, row·spacing_y, 0).
struct ReceiverGrid {
  std::string id;
  Vec3 origin_m{0.0};
  std::array<double, 2> spacing_m{1.0, 1.0};  ///< along x and y
  std::array<std::size_t, 2> count{1, 1};     ///< along x (columns) and y (rows)
  Antenna antenna;
  /// Maps: along x and y, the points over which each cell's values are averaged (channel/cell_average.hpp).
  std::array<std::size_t, 2> samples{1, 1};

  std::size_t columns() const { return count[0]; }
  std::size_t rows() const { return count[1]; }
  std::size_t size() const { return count[0] * count[1]; }
  std::size_t samples_per_cell() const { return samples[0] * samples[1]; }
};

inline Vec3 grid_point_m(const ReceiverGrid& grid, std::size_t row, std::size_t column) {
  return grid.origin_m +
         Vec3(static_cast<double>(column) * grid.spacing_m[0], static_cast<double>(row) * grid.spacing_m[1], 0.0);
}

/// The grid's receiver at (row, column), with id `area[row,column]`.
inline Device grid_receiver(const ReceiverGrid& grid, std::size_t row, std::size_t column) {
  return device_at(grid.id + "[" + std::to_string(row) + "," + std::to_string(column) + "]",
                   grid_point_m(grid, row, column), 0.0, grid.antenna);
}

/// Receivers at points of a list, such as those along a route: `route[0]`, `route[1]`, …
struct ReceiverList {
  std::string id;
  std::vector<Device> receivers;
};

}  // namespace dcem
