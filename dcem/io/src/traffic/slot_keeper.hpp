#pragma once
/// Which vehicle is in which slot of the body pools. Private to dcem::io.
#include <cstddef>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "dcem/io/src/traffic/trace_motion.hpp"

namespace dcem::io {

/// Gives vehicles that enter a free slot of their type, which they keep until they leave.
class SlotKeeper {
 public:
  explicit SlotKeeper(const std::vector<Traffic::Type>& types);

  /// The bodies at which the vehicles of the next frame stand, one per vehicle, which are ascending by id. Nothing
  /// where there are more vehicles of a type than slots.
  std::optional<std::vector<std::size_t>> next_frame(const std::vector<DrivingVehicle>& vehicles);

 private:
  struct Slot {
    std::string occupant;         ///< empty: free
    std::size_t frame_seen = 0;   ///< last frame in which the occupant was there
    std::size_t frame_freed = 0;  ///< frame in which the last occupant was gone
  };
  struct Spot {
    std::size_t type, slot;
  };

  void clear_left_slots();
  std::optional<std::size_t> free_slot_index(std::size_t type) const;

  std::vector<std::size_t> first_bodies_;
  std::vector<std::vector<Slot>> slots_;  ///< by type
  std::unordered_map<std::string, Spot> spots_;
  std::size_t frame_ = 0;  ///< counted from 1: 0 is before all frames
};

}  // namespace dcem::io
