#pragma once
/// The children that a ray on its way comes to later.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "dcem/accel/wide/node.hpp"
#include "dcem/core/lane_keys.hpp"

namespace dcem {

namespace detail {

inline namespace DCEM_ISA {

/// A stack: for each node passed the children that wait. The nearest one of each level stands beside it, so that the
/// level to go on with is found for eight levels at once, without a question for each: how many the last hit has put
/// out of reach, no processor foresees. For walks that give way between their steps; in one that goes on at once the
/// eight would wait for what it has just written.
class WaitingChildren {
 public:
  /// No other initial values: most of the room is never used.
  WaitingChildren() { std::fill_n(nearest_.begin(), simd_lanes, LaneKeys::none); }

  void clear() { height_ = 0; }

  /// Children of a node below the one before. `is_any`: whether there are any.
  [[gnu::always_inline]] void push(std::uint32_t node, const LaneKeys& keys, bool is_any) {
    keys_[height_] = keys;
    nodes_[height_] = node;
    nearest_[height_ + simd_lanes] = keys.least();
    height_ += is_any ? 1U : 0U;
  }

  /// A node and one of its lanes.
  struct Place {
    std::uint32_t node;
    std::uint32_t lane;
  };

  /// Takes the nearest child of the last node that has one within a limit from zero on. Returns false where none has:
  /// then nothing waits until the next `clear`.
  [[gnu::always_inline]] bool take(float limit, Place& place) {
    while (true) {
      // The last eight levels; below the first one there is none that waits.
      const std::uint32_t levels = LaneKeys::load(&nearest_[height_]).within(limit);
      if (levels != 0) {
        height_ += static_cast<std::uint32_t>(std::bit_width(levels));
        height_ -= simd_lanes;
        place = take_of(height_ - 1);
        return true;
      }
      if (height_ <= simd_lanes) return false;
      height_ -= simd_lanes;
    }
  }

 private:
  [[gnu::always_inline]] Place take_of(std::uint32_t level) {
    std::uint32_t& nearest = nearest_[level + simd_lanes];
    const std::uint32_t lane = LaneKeys::lane(nearest);
    keys_[level].remove(nearest);
    nearest = keys_[level].least();
    return {nodes_[level], lane};
  }

  std::uint32_t height_ = 0;
  std::array<LaneKeys, wide_depth_limit> keys_;
  std::array<std::uint32_t, wide_depth_limit> nodes_;
  std::array<std::uint32_t, simd_lanes + wide_depth_limit> nearest_;  ///< of level i at simd_lanes + i
};

}  // namespace DCEM_ISA

}  // namespace detail

}  // namespace dcem
