#pragma once
/// Rotations in a `WideBvh`; included by wide_bvh.hpp.
///
/// Around a node of eight entries, some of them nodes themselves, three changes cost nothing but the surface of those
/// inner entries (Kopta, Ize, Spjut, Brunvand, Davis, Kensler, "Fast, effective BVH updates for animated scenes", I3D
/// 2012, for eight children): an entry of a child node comes up into a free lane; it changes places with an entry of
/// the node; it goes over into a free lane of another child node. The best is taken where Σ cost · surface falls.
///
/// Nothing leaves its level (wide/levels.hpp), so objects stay whole. What goes down are leaves alone, and no deeper
/// than insertion puts them: so a tree gets no deeper by rotations, however many there are.
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "dcem/accel/wide/levels.hpp"
#include "dcem/accel/wide_bvh.hpp"

namespace dcem {

namespace detail {

/// One change around a node.
struct WideRotation {
  enum class Kind { none, up, exchange, over };

  Kind kind = Kind::none;
  float gain_m2 = 0.0F;     ///< by which the surface of inner entries falls
  std::uint32_t from = 0;   ///< lane of the child node that gives an entry away
  std::uint32_t entry = 0;  ///< the lane of that entry, in the child node
  std::uint32_t other = 0;  ///< lane of the node: free, or exchanged, or the child node that takes the entry
};

/// Looks for the best change around one node.
class WideRotationSearch {
 public:
  /// A change must gain more than this share of the node's surface: what is less is not worth the writing, and
  /// roundings cannot be taken for gains.
  static constexpr float least_share = 1e-3F;

  WideRotationSearch(const WideArrays& arrays, std::uint32_t node, std::uint32_t depth)
      : arrays_(arrays), node_(arrays.nodes[node]), lanes_(node_), areas_m2_(lanes_.half_areas()) {
    for (std::uint32_t lane = 0; lane < simd_lanes; ++lane) {
      const WideChild child = node_.child[lane];
      const std::uint32_t bit = 1U << lane;
      if (child.is_none()) {
        free_ |= bit;
      } else if (is_level_node(arrays, child)) {
        inner_ |= bit;
        if (arrays.nodes[child.index()].child_count() < simd_lanes) open_ |= bit;
      } else if (depth < wide_edit_depth_limit) {
        lowerable_ |= bit;
      }
    }
  }

  WideRotation best() {
    if (inner_ == 0) return best_;
    best_.gain_m2 = least_share * node_.box().half_area();
    for (std::uint32_t rest = inner_; rest != 0; rest &= rest - 1) {
      try_child(static_cast<std::uint32_t>(std::countr_zero(rest)));
    }
    return best_;
  }

 private:
  void try_child(std::uint32_t from) {
    const WideNode& child = arrays_.nodes[node_.child[from].index()];
    // boxes_after[i]: around the entries behind i.
    std::array<Aabb<float>, simd_lanes + 1> boxes_after;
    for (std::uint32_t lane = simd_lanes; lane-- > 0;) {
      boxes_after[lane] = boxes_after[lane + 1];
      boxes_after[lane].extend(child.box(lane));
    }
    const bool dissolves = child.child_count() <= 2;
    Aabb<float> before;
    for (std::uint32_t lane = 0; lane < simd_lanes; ++lane) {
      if (child.child[lane].is_none()) continue;
      Aabb<float> others = before;
      others.extend(boxes_after[lane + 1]);
      before.extend(child.box(lane));
      try_entry(from, lane, child.box(lane), others, dissolves);
    }
  }

  void try_entry(std::uint32_t from, std::uint32_t entry, const Aabb<float>& box, const Aabb<float>& others,
                 bool dissolves) {
    const float lightened_m2 = areas_m2_[from] - (dissolves ? 0.0F : others.half_area());
    if (free_ != 0) {  // nothing else gains more
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(free_));
      offer({WideRotation::Kind::up, lightened_m2, from, entry, lane});
      return;
    }
    if (lowerable_ != 0) {
      const std::array<float, simd_lanes> exchanged_m2 = lanes_.half_areas_with(others);
      for (std::uint32_t rest = lowerable_; rest != 0; rest &= rest - 1) {
        const auto lane = static_cast<std::uint32_t>(std::countr_zero(rest));
        offer({WideRotation::Kind::exchange, areas_m2_[from] - exchanged_m2[lane], from, entry, lane});
      }
    }
    const std::uint32_t takers = open_ & ~(1U << from);
    if (takers == 0 || lightened_m2 <= best_.gain_m2) return;
    const std::array<float, simd_lanes> grown_m2 = lanes_.half_areas_with(box);
    for (std::uint32_t rest = takers; rest != 0; rest &= rest - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(rest));
      offer({WideRotation::Kind::over, lightened_m2 - (grown_m2[lane] - areas_m2_[lane]), from, entry, lane});
    }
  }

  void offer(const WideRotation& rotation) {
    if (rotation.gain_m2 > best_.gain_m2) best_ = rotation;
  }

  const WideArrays& arrays_;
  const WideNode& node_;
  BoxLanes lanes_;
  std::array<float, simd_lanes> areas_m2_;
  std::uint32_t free_ = 0, inner_ = 0, open_ = 0, lowerable_ = 0;  ///< lanes of the node
  WideRotation best_;
};

}  // namespace detail

inline std::size_t WideBvh::rotate_touched(std::uint32_t most_per_node) {
  if (arrays_.nodes.empty()) return 0;
  degradation_.mark_paths(arrays_);
  if (!degradation_.tracked().measures()) degradation_.forget_touches();
  const std::size_t count = degradation_.is_marked(0) ? rotate_below(0, 1, most_per_node) : 0;
  degradation_.unmark();
  return count;
}

/// Children first: what comes up from them may go further up. `depth`: of the node, in its level.
inline std::size_t WideBvh::rotate_below(std::uint32_t node, std::uint32_t depth, std::uint32_t most_per_node) {
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

inline void WideBvh::carry_out(const detail::WideRotation& rotation, std::uint32_t node) {
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
    detach(from);
  } else {
    const std::uint32_t taker = other.index();
    std::uint32_t lane = 0;
    while (!arrays_.nodes[taker].child[lane].is_none()) ++lane;
    arrays_.attach(entry, NodeLane::at(taker, lane), entry_box);
    arrays_.tighten_above(taker);
    detach(from);
    degradation_.touch(taker);
  }
  remember_inserted(entry);
}

/// Notes for an object how large the node is in which it hangs now.
inline void WideBvh::remember_inserted(WideChild child) {
  const std::uint32_t object = arrays_.object_rooted_at(child);
  if (object == WideArrays::no_object) return;
  area_when_inserted_m2_[object] = arrays_.nodes[arrays_.place_of(child).node()].box().half_area();
}

}  // namespace dcem
