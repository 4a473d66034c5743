#pragma once
/// Bodies of wide_bvh.hpp: builds parts of a `WideBvh` anew in place.
///
/// The leaves of its level (wide/levels.hpp) stay what they are: their boxes are known, and nothing in them is written.
/// So the price is that of the nodes alone.
///
/// How deep that may get: leaves of a built level lie on depth detail::wide_build_depth_limit at most, its root being
/// on depth 1, and no edit pushes a leaf further down: insertion makes nodes above `wide_edit_depth_limit` only, and
/// rotations lower leaves only there. A part that was rebuilt in place has the levels of its plan, which are counted
/// before anything changes. Where they do not fit below the node, the node above is rebuilt_in_place instead; at the
/// level's root they always fit, because the binner makes no more.
#include "dcem/accel/wide/build/plan.hpp"
#include "dcem/accel/wide_bvh.hpp"
#include "dcem/core/build_mode.hpp"

namespace dcem {

DCEM_INLINE WideBvh::PlanRoom::PlanRoom() = default;
DCEM_INLINE WideBvh::PlanRoom::PlanRoom(const PlanRoom&) {}
DCEM_INLINE WideBvh::PlanRoom::PlanRoom(PlanRoom&&) noexcept = default;
DCEM_INLINE WideBvh::PlanRoom& WideBvh::PlanRoom::operator=(const PlanRoom&) {
  return *this;
}
DCEM_INLINE WideBvh::PlanRoom& WideBvh::PlanRoom::operator=(PlanRoom&&) noexcept = default;
DCEM_INLINE WideBvh::PlanRoom::~PlanRoom() = default;

DCEM_INLINE detail::WidePlan& WideBvh::PlanRoom::plan() {
  if (!plan_) plan_ = std::make_unique<detail::WidePlan>();
  return *plan_;
}

DCEM_INLINE std::size_t WideBvh::rebuild_subtree(std::uint32_t node, double wanted_share) {
  if (!detail::is_used_node(arrays_, node)) throw std::invalid_argument("node " + std::to_string(node) + " of none");
  detail::WidePlan& plan = plan_room_.plan();
  plan.make(arrays_, node, settings_.threads, settings_.divide_by_size);
  if (plan.empty()) return 0;
  const std::uint32_t deepest = detail::depth_in_level(arrays_, node) + plan.levels() - 1;
  if (deepest > detail::wide_level_depth_limit && !detail::is_level_root(arrays_, node)) {
    return rebuild_subtree(arrays_.lane_of_node[node].node(), wanted_share);
  }
  if (std::isfinite(wanted_share) &&
      !(plan.weighted_area_m2(arrays_.costs) < wanted_share * detail::level_area_below(arrays_, node))) {
    degradation_.forget(node);
    degradation_.touch(node);
    return 0;
  }
  release_below(node);
  std::size_t made = 1;
  if (plan.is_leaf(0)) {
    attach_planned(NodeLane::at(node, 0), plan, 0);
    remember_inserted(node);
  } else {
    made = build_planned(node, plan, 0);
  }
  if (node == 0) sum_anew();
  degradation_.renew_below(arrays_, node);
  return made;
}

/// Differences keep the sum, and their roundings add up; here it is right again.
DCEM_INLINE void WideBvh::sum_anew() {
  double sum_m2 = 0.0;
  for (const WideNode& node : arrays_.nodes) sum_m2 += detail::weighted_area(arrays_, node);
  arrays_.weighted_area_m2 = arrays_.largest_area_m2 = sum_m2;
}

/// Empties a node; the nodes of its level below it become free.
DCEM_INLINE void WideBvh::release_below(std::uint32_t node) {
  const auto first_freed = static_cast<std::ptrdiff_t>(arrays_.free_nodes.size());
  const auto empty_below = [&](std::uint32_t from, const auto& self) -> void {
    for (std::uint32_t lane = 0; lane < simd_lanes; ++lane) {
      const WideChild child = arrays_.nodes[from].child[lane];
      if (detail::is_level_node(arrays_, child)) {
        self(child.index(), self);
        arrays_.lane_of_node[child.index()] = {};
        arrays_.free_nodes.push_back(child.index());
      }
      arrays_.attach({}, NodeLane::at(from, lane), {});
    }
  };
  empty_below(node, empty_below);
  // Taken again in rising order: what is close in the tree stays close in memory.
  std::sort(arrays_.free_nodes.begin() + first_freed, arrays_.free_nodes.end(), std::greater<>());
}

/// Fills an empty node. Returns how many nodes that made, itself counted.
DCEM_INLINE std::size_t WideBvh::build_planned(std::uint32_t node, const detail::WidePlan& plan, std::uint32_t slot) {
  std::array<std::uint32_t, simd_lanes> entries;
  const std::size_t count = plan.entries(slot, entries);
  std::size_t made = 1;
  for (std::uint32_t lane = 0; lane < count; ++lane)
    made += attach_planned(NodeLane::at(node, lane), plan, entries[lane]);
  remember_inserted(node);
  return made;
}

/// Fills an empty lane. Returns how many nodes that made.
DCEM_INLINE std::size_t WideBvh::attach_planned(NodeLane place, const detail::WidePlan& plan, std::uint32_t slot) {
  if (plan.is_leaf(slot)) {
    arrays_.attach(plan.leaf(slot).child, place, plan.leaf(slot).box);
    return 0;
  }
  const std::uint32_t node = arrays_.take_node();
  const std::size_t made = build_planned(node, plan, slot);
  arrays_.attach(WideChild::node(node), place, arrays_.nodes[node].box());
  return made;
}

/// Notes for the objects that are children of a node how large it is now.
DCEM_INLINE void WideBvh::remember_inserted(std::uint32_t node) {
  const WideNode& held = arrays_.nodes[node];
  const float area_m2 = held.box().half_area();
  for (const WideChild child : held.child) {
    const std::uint32_t object = child.is_none() ? WideArrays::no_object : arrays_.object_rooted_at(child);
    if (object != WideArrays::no_object) area_when_inserted_m2_[object] = area_m2;
  }
}

}  // namespace dcem
