#pragma once
/// Builds parts of a `WideTree` anew in place; included by wide_tree.hpp.
///
/// The leaves of its layer (wide_layer.hpp) stay what they are: their boxes are known, and nothing in them is written.
/// So the price is that of the nodes alone.
///
/// How deep that may get: leaves of a built layer lie on level WideBinner::levels at most, its root being on level 1,
/// and no edit pushes a leaf further down: hanging makes nodes above `wide_edit_levels` only, and rotations lower
/// leaves only there. A regrown part has the levels of its plan, which are counted before anything changes. Where they
/// do not fit below the node, the node above is regrown instead; at the layer's root they always fit, because the
/// binner makes no more.
#include "dcem/accel/wide_bvh.hpp"

namespace dcem {

inline std::size_t WideTree::regrow(std::uint32_t node, double wanted_share) {
  if (!detail::is_used_node(arrays_, node)) throw std::invalid_argument("node " + std::to_string(node) + " of none");
  detail::WidePlan& plan = plan_;
  plan.make(arrays_, node, settings_.threads, settings_.divide_by_size);
  if (plan.empty()) return 0;
  const std::uint32_t deepest = detail::layer_level(arrays_, node) + plan.levels() - 1;
  if (deepest > detail::wide_layer_levels && !detail::is_layer_root(arrays_, node)) {
    return regrow(arrays_.node_place[node].node(), wanted_share);
  }
  if (std::isfinite(wanted_share) &&
      !(plan.weighted_area_m2(arrays_.costs) < wanted_share * detail::layer_area_below(arrays_, node))) {
    wear_.forget(node);
    wear_.touch(node);
    return 0;
  }
  fell(node);
  std::size_t made = 1;
  if (plan.is_leaf(0)) {
    hang_planned(WidePlace::at(node, 0), plan, 0);
    remember_hung(node);
  } else {
    made = plant_planned(node, plan, 0);
  }
  if (node == 0) sum_anew();
  wear_.renew_below(arrays_, node);
  return made;
}

/// Differences keep the sum, and their roundings add up; here it is right again.
inline void WideTree::sum_anew() {
  double sum_m2 = 0.0;
  for (const WideNode& node : arrays_.nodes) sum_m2 += detail::weighted_area(arrays_, node);
  arrays_.weighted_area_m2 = arrays_.largest_area_m2 = sum_m2;
}

/// Empties a node; the nodes of its layer below it become free.
inline void WideTree::fell(std::uint32_t node) {
  const auto first_freed = static_cast<std::ptrdiff_t>(arrays_.free_nodes.size());
  const auto empty_below = [&](std::uint32_t from, const auto& self) -> void {
    for (std::uint32_t lane = 0; lane < simd_lanes; ++lane) {
      const WideChild child = arrays_.nodes[from].child[lane];
      if (detail::is_layer_node(arrays_, child)) {
        self(child.index(), self);
        arrays_.node_place[child.index()] = {};
        arrays_.free_nodes.push_back(child.index());
      }
      arrays_.hang({}, WidePlace::at(from, lane), {});
    }
  };
  empty_below(node, empty_below);
  // Taken again in rising order: what is close in the tree stays close in memory.
  std::sort(arrays_.free_nodes.begin() + first_freed, arrays_.free_nodes.end(), std::greater<>());
}

/// Fills an empty node. Returns how many nodes that made, itself counted.
inline std::size_t WideTree::plant_planned(std::uint32_t node, const detail::WidePlan& plan, std::uint32_t slot) {
  std::array<std::uint32_t, simd_lanes> entries;
  const std::size_t count = plan.entries(slot, entries);
  std::size_t made = 1;
  for (std::uint32_t lane = 0; lane < count; ++lane)
    made += hang_planned(WidePlace::at(node, lane), plan, entries[lane]);
  remember_hung(node);
  return made;
}

/// Fills an empty lane. Returns how many nodes that made.
inline std::size_t WideTree::hang_planned(WidePlace place, const detail::WidePlan& plan, std::uint32_t slot) {
  if (plan.is_leaf(slot)) {
    arrays_.hang(plan.leaf(slot).child, place, plan.leaf(slot).box);
    return 0;
  }
  const std::uint32_t node = arrays_.take_node();
  const std::size_t made = plant_planned(node, plan, slot);
  arrays_.hang(WideChild::node(node), place, arrays_.nodes[node].box());
  return made;
}

/// Notes for the units that hang in a node how large it is now.
inline void WideTree::remember_hung(std::uint32_t node) {
  const WideNode& held = arrays_.nodes[node];
  const float area_m2 = held.box().half_area();
  for (const WideChild child : held.child) {
    const std::uint32_t unit = child.is_none() ? WideArrays::no_unit : arrays_.unit_of(child);
    if (unit != WideArrays::no_unit) area_when_hung_m2_[unit] = area_m2;
  }
}

}  // namespace dcem
