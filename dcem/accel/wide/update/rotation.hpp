#pragma once
/// Looks for rotations in a wide tree.
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

#include "dcem/accel/wide/arrays.hpp"
#include "dcem/accel/wide/levels.hpp"

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

}  // namespace dcem
