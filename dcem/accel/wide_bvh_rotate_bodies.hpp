#pragma once
/// Bodies of wide_bvh.hpp: carries out rotations in a `WideBvh`.
#include <cstddef>
#include <cstdint>

#include "dcem/accel/wide/update/rotation.hpp"
#include "dcem/accel/wide_bvh.hpp"
#include "dcem/core/build_mode.hpp"

namespace dcem {

DCEM_INLINE std::size_t WideBvh::rotate_touched(std::uint32_t most_per_node) {
  if (arrays_.nodes.empty()) return 0;
  degradation_.mark_paths(arrays_);
  if (!degradation_.tracked().measures()) degradation_.forget_touches();
  const std::size_t count = degradation_.is_marked(0) ? rotate_below(0, 1, most_per_node) : 0;
  degradation_.unmark();
  return count;
}

/// Children first: what comes up from them may go further up. `depth`: of the node, in its level.
DCEM_INLINE std::size_t WideBvh::rotate_below(std::uint32_t node, std::uint32_t depth, std::uint32_t most_per_node) {
  std::size_t count = 0;
  for (std::uint32_t lane = 0; lane < simd_lanes; ++lane) {
    const WideChild child = arrays_.nodes[node].child[lane];
    if (child.is_none() || child.is_leaf() || !degradation_.is_marked(child.index())) continue;
    const bool same_level = detail::is_level_node(arrays_, child);
    count += rotate_below(child.index(), same_level ? depth + 1 : 1, most_per_node);
  }
  for (std::uint32_t turn = 0; turn < most_per_node; ++turn) {
    const detail::WideRotation rotation = detail::WideRotationSearch(arrays_, node, depth).best();
    if (rotation.kind == detail::WideRotation::Kind::none) break;
    carry_out(rotation, node);
    ++count;
  }
  return count;
}

DCEM_INLINE void WideBvh::carry_out(const detail::WideRotation& rotation, std::uint32_t node) {
  using Kind = detail::WideRotation::Kind;
  const std::uint32_t giver = arrays_.nodes[node].child[rotation.from].index();
  const NodeLane from = NodeLane::at(giver, rotation.entry), own = NodeLane::at(node, rotation.other);
  const WideChild entry = arrays_.child_at(from), other = arrays_.child_at(own);
  const Aabb<float> entry_box = arrays_.box_at(from), other_box = arrays_.box_at(own);
  degradation_.touch(giver);
  if (rotation.kind == Kind::exchange) {
    arrays_.attach(entry, own, entry_box);
    arrays_.attach(other, from, other_box);
    arrays_.tighten_above(giver);
    remember_inserted(other);
  } else if (rotation.kind == Kind::up) {
    arrays_.attach(entry, own, entry_box);
    arrays_.tighten_above(detach(from));
  } else {
    const std::uint32_t taker = other.index();
    std::uint32_t lane = 0;
    while (!arrays_.nodes[taker].child[lane].is_none()) ++lane;
    arrays_.attach(entry, NodeLane::at(taker, lane), entry_box);
    arrays_.tighten_above(taker);
    arrays_.tighten_above(detach(from));
    degradation_.touch(taker);
  }
  remember_inserted(entry);
}

/// Notes for an object how large the node is in which it hangs now.
DCEM_INLINE void WideBvh::remember_inserted(WideChild child) {
  const std::uint32_t object = arrays_.object_rooted_at(child);
  if (object == WideArrays::no_object) return;
  area_when_inserted_m2_[object] = arrays_.nodes[arrays_.place_of(child).node()].box().half_area();
}

}  // namespace dcem
