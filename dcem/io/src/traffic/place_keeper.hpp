#pragma once
/// Which vehicle stands at which place. Private to dcem::io.
#include <cstddef>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "dcem/io/src/traffic/trace_motion.hpp"

namespace dcem::io {

/// Gives vehicles that enter a free place of their type, which they keep until they leave.
class PlaceKeeper {
 public:
  explicit PlaceKeeper(const std::vector<Traffic::Type>& types);

  /// The bodies at which the vehicles of the next frame stand, one per vehicle, which are ascending by id. Nothing
  /// where there are more vehicles of a type than places.
  std::optional<std::vector<std::size_t>> next_frame(const std::vector<DrivingVehicle>& vehicles);

 private:
  struct Place {
    std::string occupant;         ///< empty: free
    std::size_t frame_seen = 0;   ///< last frame in which the occupant was there
    std::size_t frame_freed = 0;  ///< frame in which the last occupant was gone
  };
  struct Spot {
    std::size_t type, place;
  };

  void clear_left_places();
  std::optional<std::size_t> free_place(std::size_t type) const;

  std::vector<std::size_t> first_bodies_;
  std::vector<std::vector<Place>> places_;  ///< by type
  std::unordered_map<std::string, Spot> spots_;
  std::size_t frame_ = 0;  ///< counted from 1: 0 is before all frames
};

}  // namespace dcem::io
