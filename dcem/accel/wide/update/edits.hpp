#pragma once
/// How a `WideTree` is built and follows motion; included by wide_tree.hpp.
#include "dcem/accel/wide_bvh.hpp"

namespace dcem {

inline void WideTree::require_input(const TriangleView& mesh, Boxes boxes) {
  if (mesh.size() != boxes.size()) throw std::invalid_argument("one box per triangle is needed");
  if (!mesh.surface_of_triangle.empty() && mesh.surface_of_triangle.size() != mesh.size()) {
    throw std::invalid_argument("one surface per triangle is needed, or none at all");
  }
  require_valid_boxes(boxes);
  std::uint32_t highest = 0;
  for (const auto& [a, b, c] : mesh.triangles) highest = std::max({highest, a, b, c});
  if (highest < mesh.vertices_m.size()) return;
  for (std::uint32_t triangle = 0; triangle < mesh.size(); ++triangle) require_corners(mesh, triangle);
}

inline void WideTree::require_corners(const TriangleView& mesh, std::uint32_t triangle) {
  for (const std::uint32_t vertex : mesh.triangles[triangle]) {
    if (vertex >= mesh.vertices_m.size()) {
      throw std::invalid_argument("triangle " + std::to_string(triangle) + " has a corner that is no vertex");
    }
  }
}

inline void WideTree::build_grouped(const TriangleView& mesh, Boxes boxes, std::span<const std::uint32_t> group_first,
                                    const WideSettings& settings) {
  require_input(mesh, boxes);
  require_valid_groups(group_first, boxes.size());
  dcem::validate(settings);
  settings_ = settings;
  group_first_.assign(group_first.begin(), group_first.end());
  patches_.clear();
  first_patch_.assign(1, 0);
  detail::PatchBuilder pairing(mesh, settings_.pair_flatness);
  for (std::size_t group = 0; group < group_first.size(); ++group) {
    const bool is_last = group + 1 == group_first.size();
    pairing.append(group_first[group], is_last ? static_cast<std::uint32_t>(mesh.size()) : group_first[group + 1],
                   patches_);
    first_patch_.push_back(static_cast<std::uint32_t>(patches_.size()));
  }
  plant(mesh, boxes);
}

inline void WideTree::rebuild(const TriangleView& mesh, Boxes boxes) {
  require_input(mesh, boxes);
  if (boxes.size() != primitive_count()) throw std::invalid_argument("one box per triangle of the tree is needed");
  // The pairs of the last build name vertices.
  if (!std::ranges::equal(mesh.triangles, arrays_.triangles)) throw std::invalid_argument("the triangles are others");
  plant(mesh, boxes);
}

inline void WideTree::plant(const TriangleView& mesh, Boxes boxes) {
  arrays_.clear_for(settings_.huge_pages);
  arrays_.costs = settings_.costs;
  arrays_.vertices_m.assign(mesh.vertices_m.begin(), mesh.vertices_m.end());
  arrays_.triangles.assign(mesh.triangles.begin(), mesh.triangles.end());
  arrays_.is_there.resize(boxes.size());
  arrays_.patch_of_triangle.resize(boxes.size());
  Aabb<double> all;
  for (std::uint32_t triangle = 0; triangle < boxes.size(); ++triangle) {
    const bool is_there = !boxes[triangle].empty();
    arrays_.is_there[triangle] = is_there ? 1 : 0;
    if (is_there) all.extend(boxes[triangle]);
  }
  arrays_.origin_m = all.empty() ? Vec3(0.0) : all.center();
  WideBuilder(settings_).build(arrays_, patches_, first_patch_);
  sah_at_build_ = sah_cost();
  block_is_dirty_.assign(arrays_.blocks.size(), 0);
  unit_is_moved_.assign(group_first_.size(), 0);
  dirty_blocks_.clear();
  moved_units_.clear();
  area_when_hung_m2_.assign(group_first_.size(), 0.0F);
  for (std::size_t group = 0; group < group_first_.size(); ++group) {
    if (arrays_.unit_root[group].is_none()) continue;
    area_when_hung_m2_[group] = arrays_.nodes[arrays_.place_of(arrays_.unit_root[group]).node()].box().half_area();
  }
  wear_.renew(arrays_);
}

inline WideRefitReport WideTree::refit(std::span<const std::uint32_t> moved, const TriangleView& mesh, Boxes boxes) {
  if (mesh.size() != primitive_count() || boxes.size() != primitive_count()) {
    throw std::invalid_argument("one box per triangle of the tree is needed");
  }
  if (mesh.vertices_m.size() != arrays_.vertices_m.size()) throw std::invalid_argument("the vertices are others");
  look_at_boxes(moved, boxes);
  for (const std::uint32_t unit : moved_units_) unit_is_moved_[unit] = 0;
  moved_units_.clear();
  WideRefitReport report;
  mark_dirty(moved);
  report.blocks_written = dirty_blocks_.size();
  for (std::size_t index = 0; index < dirty_blocks_.size(); ++index) {
    if (settings_.fetch_ahead) {
      if (index + 2 < dirty_blocks_.size()) arrays_.fetch_block(dirty_blocks_[index + 2]);
      if (index + 1 < dirty_blocks_.size()) arrays_.fetch_around_block(dirty_blocks_[index + 1], mesh.vertices_m);
    }
    const std::uint32_t block = dirty_blocks_[index];
    block_is_dirty_[block] = 0;
    const WidePlace place = arrays_.block_place[block];
    arrays_.copy_vertices(block, mesh.vertices_m);
    const Aabb<float> box = arrays_.write_block(block);
    arrays_.note_extent(box);
    if (box != arrays_.box_at(place)) {
      arrays_.set_box(place, box);
      report.nodes_visited += arrays_.tighten_above(place.node());
      wear_.touch(place.node());
    }
    note_moved_unit(arrays_.group_of_block[block]);
  }
  dirty_blocks_.clear();
  if (arrays_.is_area_worn()) sum_anew();
  return report;
}

/// Which of the triangles are there now. `is_there_now_` is empty when all are: then nothing is noted one by one.
inline void WideTree::look_at_boxes(std::span<const std::uint32_t> moved, Boxes boxes) {
  is_there_now_.clear();
  detail::PlainBoxes plain;
  for (const std::uint32_t triangle : moved) {
    if (triangle >= boxes.size()) throw std::invalid_argument("triangle " + std::to_string(triangle) + " of none");
    plain.add(boxes[triangle]);
  }
  if (plain.all()) return;
  for (const std::uint32_t triangle : moved) {
    require_valid_box(boxes[triangle], triangle);
    is_there_now_.push_back(boxes[triangle].empty() ? 0 : 1);
  }
}

/// Notes the blocks in which triangles have moved, each once.
inline void WideTree::mark_dirty(std::span<const std::uint32_t> moved) {
  for (std::size_t index = 0; index < moved.size(); ++index) {
    arrays_.is_there[moved[index]] = is_there_now_.empty() ? char{1} : is_there_now_[index];
    const std::uint32_t block = arrays_.patch_of_triangle[moved[index]] / simd_lanes;
    if (block_is_dirty_[block] != 0) continue;
    block_is_dirty_[block] = 1;
    dirty_blocks_.push_back(block);
  }
}

inline void WideTree::note_moved_unit(std::uint32_t group) {
  if (arrays_.unit_root[group].is_none() || unit_is_moved_[group] != 0) return;
  unit_is_moved_[group] = 1;
  moved_units_.push_back(group);
}

inline std::size_t WideTree::reinsert_moved(double growth_limit, std::uint32_t turn_length) {
  const auto has_grown = [&](std::uint32_t group) {
    const std::uint32_t node = arrays_.place_of(arrays_.unit_root[group]).node();
    const WidePlace above = arrays_.node_place[node];
    const double area_m2 = static_cast<double>((above.is_none() ? root_box() : arrays_.box_at(above)).half_area());
    return area_m2 > growth_limit * static_cast<double>(area_when_hung_m2_[group]);
  };
  const std::size_t moved = moved_units_.size();
  const std::size_t in_turn = turn_length == 0 ? 0 : (moved + turn_length - 1) / turn_length;
  std::size_t count = 0;
  for (std::size_t index = 0; index < in_turn; ++index) {
    count += take_out_and_hang(moved_units_[next_turn_++ % moved]) ? 1U : 0U;
  }
  for (const std::uint32_t group : moved_units_) {
    if (has_grown(group)) count += take_out_and_hang(group) ? 1U : 0U;
  }
  return count;
}

inline bool WideTree::take_out_and_hang(std::uint32_t group) {
  const WideChild root = arrays_.unit_root[group];
  const WidePlace place = arrays_.place_of(root);
  const Aabb<float> box = arrays_.box_at(place);
  if (box.empty()) return false;
  take_out(place);
  hang_at(root, box, cheapest_spot(box));
  area_when_hung_m2_[group] = arrays_.nodes[arrays_.place_of(root).node()].box().half_area();
  return true;
}

/// Empties a lane. A node that is left with one entry gives its place to that entry.
inline void WideTree::take_out(WidePlace place) {
  arrays_.hang({}, place, {});
  const std::uint32_t node = place.node();
  if (node == 0 || arrays_.nodes[node].child_count() > 1) {
    arrays_.tighten_above(node);
    wear_.touch(node);
    return;
  }
  const WidePlace above = arrays_.node_place[node];
  std::uint32_t lane = 0;
  while (lane < simd_lanes && arrays_.nodes[node].child[lane].is_none()) ++lane;
  const WideChild left = lane < simd_lanes ? arrays_.nodes[node].child[lane] : WideChild{};
  const Aabb<float> box = lane < simd_lanes ? arrays_.nodes[node].box(lane) : Aabb<float>{};
  if (!left.is_none()) arrays_.hang({}, WidePlace::at(node, lane), {});
  arrays_.hang(left, above, box);
  arrays_.node_place[node] = {};
  arrays_.free_nodes.push_back(node);
  arrays_.tighten_above(above.node());
  wear_.touch(above.node());
}

/// Offers the lanes of one node: a free one, or an entry that is not divided further, to be joined under a new node, as
/// far down as new nodes are made. Free lanes may lie between others. There is always a spot above that: a node without
/// one has eight inner nodes below it, and so have they, which no tree can afford for long.
inline void WideTree::offer_spots(const Branch& branch, const Aabb<float>& box, Spot& best) {
  const auto& [cost_m2, node, level] = branch;
  const WideNode& held = arrays_.nodes[node];
  const detail::BoxLanes boxes(held);
  const std::array<float, simd_lanes> own = boxes.half_areas(), grown = boxes.half_areas_with(box);
  for (std::uint32_t lane = 0; lane < simd_lanes; ++lane) {
    const WideChild child = held.child[lane];
    if (child.is_none()) {
      if (cost_m2 < best.cost_m2) best = {cost_m2, node, lane, false};
      continue;
    }
    const double both_m2 = arrays_.costs.node * static_cast<double>(grown[lane]);
    if (child.is_block() || arrays_.unit_of(child) != WideArrays::no_unit) {
      const bool may_join = level < detail::wide_edit_levels;
      if (may_join && cost_m2 + both_m2 < best.cost_m2) best = {cost_m2 + both_m2, node, lane, true};
      continue;
    }
    const double grown_m2 = cost_m2 + both_m2 - arrays_.costs.node * static_cast<double>(own[lane]);
    if (!(grown_m2 < best.cost_m2)) continue;
    branches_.push_back({grown_m2, child.index(), level + 1});
    std::push_heap(branches_.begin(), branches_.end());
  }
}

inline WideTree::Spot WideTree::cheapest_spot(const Aabb<float>& box) {
  Spot best;
  branches_.clear();
  branches_.push_back({0.0, 0, 1});
  while (!branches_.empty()) {
    std::pop_heap(branches_.begin(), branches_.end());
    const Branch branch = branches_.back();
    branches_.pop_back();
    if (!(branch.cost_m2 < best.cost_m2)) break;
    offer_spots(branch, box, best);
  }
  DCEM_ASSERT(best.lane < simd_lanes);
  return best;
}

inline void WideTree::hang_at(WideChild child, const Aabb<float>& box, const Spot& spot) {
  WidePlace place = WidePlace::at(spot.node, spot.lane);
  if (spot.joins) {
    const WideChild beside = arrays_.child_at(place);
    const Aabb<float> beside_box = arrays_.box_at(place);
    const std::uint32_t node = arrays_.take_node();
    Aabb<float> both = beside_box;
    both.extend(box);
    arrays_.hang(WideChild::node(node), place, both);
    arrays_.hang(beside, WidePlace::at(node, 0), beside_box);
    place = WidePlace::at(node, 1);
    wear_.forget(node);
  }
  arrays_.hang(child, place, box);
  wear_.touch(place.node());
  // From the node that was there: a new one below it is tight already, and the way up would end at it.
  arrays_.tighten_above(spot.node);
}

inline std::string WideTree::validate(Boxes boxes) const {
  return detail::find_wide_defect(arrays_, boxes);
}

}  // namespace dcem
