#pragma once
/// Bodies of wide_bvh.hpp: how a `WideBvh` is built, and how objects are put elsewhere.
#include "dcem/accel/wide/build/builder.hpp"
#include "dcem/accel/wide/build/quads.hpp"
#include "dcem/accel/wide_bvh.hpp"
#include "dcem/core/build_mode.hpp"

namespace dcem {

DCEM_INLINE void WideBvh::require_input(const TriangleView& mesh, Boxes boxes) {
  if (mesh.size() != boxes.size()) throw std::invalid_argument("one box per triangle is needed");
  require_valid_boxes(boxes);
  std::uint32_t highest = 0;
  for (const auto& [a, b, c] : mesh.triangles) highest = std::max({highest, a, b, c});
  if (highest < mesh.vertices_m.size()) return;
  for (std::uint32_t triangle = 0; triangle < mesh.size(); ++triangle) require_corners(mesh, triangle);
}

DCEM_INLINE void WideBvh::require_corners(const TriangleView& mesh, std::uint32_t triangle) {
  for (const std::uint32_t vertex : mesh.triangles[triangle]) {
    if (vertex >= mesh.vertices_m.size()) {
      throw std::invalid_argument("triangle " + std::to_string(triangle) + " has a corner that is no vertex");
    }
  }
}

DCEM_INLINE void WideBvh::build_objects(const TriangleView& mesh, Boxes boxes,
                                        std::span<const std::uint32_t> object_first,
                                        const WideBuildSettings& settings) {
  require_input(mesh, boxes);
  require_valid_objects(object_first, boxes.size());
  dcem::validate(settings);
  settings_ = settings;
  object_first_.assign(object_first.begin(), object_first.end());
  quads_.clear();
  first_quad_.assign(1, 0);
  detail::QuadBuilder pairing(mesh, settings_.pair_flatness);
  for (std::size_t object = 0; object < object_first.size(); ++object) {
    const bool is_last = object + 1 == object_first.size();
    pairing.append(object_first[object], is_last ? static_cast<std::uint32_t>(mesh.size()) : object_first[object + 1],
                   quads_);
    first_quad_.push_back(static_cast<std::uint32_t>(quads_.size()));
  }
  build_all(mesh, boxes);
}

DCEM_INLINE void WideBvh::rebuild(const TriangleView& mesh, Boxes boxes) {
  require_input(mesh, boxes);
  if (boxes.size() != primitive_count()) throw std::invalid_argument("one box per triangle of the tree is needed");
  // The pairs of the last build name vertices.
  if (!std::ranges::equal(mesh.triangles, arrays_.triangles)) throw std::invalid_argument("the triangles are others");
  build_all(mesh, boxes);
}

DCEM_INLINE void WideBvh::build_all(const TriangleView& mesh, Boxes boxes) {
  arrays_.clear_for(settings_.huge_pages);
  arrays_.costs = settings_.costs;
  arrays_.fetch_ahead = settings_.fetch_ahead;
  arrays_.vertices_m.assign(mesh.vertices_m.begin(), mesh.vertices_m.end());
  arrays_.triangles.assign(mesh.triangles.begin(), mesh.triangles.end());
  arrays_.is_there.resize(boxes.size());
  arrays_.quad_of_triangle.resize(boxes.size());
  Aabb<double> all;
  for (std::uint32_t triangle = 0; triangle < boxes.size(); ++triangle) {
    const bool is_there = !boxes[triangle].empty();
    arrays_.is_there[triangle] = is_there ? 1 : 0;
    if (is_there) all.extend(boxes[triangle]);
  }
  arrays_.origin_m = all.empty() ? Vec3(0.0) : all.center();
  WideBuilder(settings_).build(arrays_, quads_, first_quad_);
  sah_at_build_ = sah_cost();
  leaf_is_dirty_.assign(arrays_.leaves.size(), 0);
  object_is_moved_.assign(object_first_.size(), 0);
  dirty_leaves_.clear();
  moved_objects_.clear();
  area_when_inserted_m2_.assign(object_first_.size(), 0.0F);
  for (std::size_t object = 0; object < object_first_.size(); ++object) {
    if (arrays_.object_root[object].is_none()) continue;
    area_when_inserted_m2_[object] =
        arrays_.nodes[arrays_.place_of(arrays_.object_root[object]).node()].box().half_area();
  }
  degradation_.renew(arrays_);
}

DCEM_INLINE std::size_t WideBvh::reinsert_moved(double growth_limit, std::uint32_t turn_length, ThreadPool* pool) {
  const auto has_grown = [&](std::uint32_t object) {
    const std::uint32_t node = arrays_.place_of(arrays_.object_root[object]).node();
    const NodeLane above = arrays_.lane_of_node[node];
    const double area_m2 = static_cast<double>((above.is_none() ? root_box() : arrays_.box_at(above)).half_area());
    return area_m2 > growth_limit * static_cast<double>(area_when_inserted_m2_[object]);
  };
  const std::size_t moved = moved_objects_.size();
  const std::size_t in_turn = turn_length == 0 ? 0 : (moved + turn_length - 1) / turn_length;
  // One by one each sees where the others have gone. Of very many it does not matter whether some do not.
  constexpr std::size_t very_many = 512, of_a_group = 256;
  std::vector<std::uint32_t> group;
  std::size_t count = 0;
  const auto end_group = [&] {
    count += reinsert_together(group, pool);
    group.clear();
  };
  const auto take = [&](std::uint32_t object) {
    if (moved < very_many) {
      count += reinsert(object) ? 1U : 0U;
      return;
    }
    group.push_back(object);
    if (group.size() == of_a_group) end_group();
  };
  for (std::size_t index = 0; index < in_turn; ++index) take(moved_objects_[next_turn_++ % moved]);
  if (!group.empty()) end_group();
  for (const std::uint32_t object : moved_objects_) {
    if (has_grown(object)) take(object);
  }
  if (!group.empty()) end_group();
  return count;
}

/// All are taken out first. Each looks for its spot in what is left, and those that find the same one look again, after
/// the first of them has come there. So the tree does not depend on how many threads look.
DCEM_INLINE std::size_t WideBvh::reinsert_together(std::span<const std::uint32_t> objects, ThreadPool* pool) {
  std::vector<LooseObject> loose;
  for (const std::uint32_t object : objects) {
    const NodeLane place = arrays_.place_of(arrays_.object_root[object]);
    const Aabb<float> box = arrays_.box_at(place);
    if (box.empty()) continue;
    loose_nodes_.add(detach(place));
    loose.push_back({object, box});
  }
  loose_nodes_.tighten_all(arrays_);
  const std::size_t count = loose.size();
  while (!loose.empty()) {
    find_spots(loose, pool);
    std::erase_if(loose, [&](const LooseObject& one) {
      if (arrays_.child_at(NodeLane::at(one.spot.node, one.spot.lane)) != one.there) return false;
      insert(one.object, one.box, one.spot);
      return true;
    });
  }
  return count;
}

DCEM_INLINE void WideBvh::find_spots(std::span<LooseObject> objects, ThreadPool* pool) const {
  constexpr std::size_t at_once = 32;  // some forty microseconds
  const auto look = [&](std::size_t block, unsigned) {
    std::vector<Branch> branches;
    const std::size_t first = block * at_once;
    for (LooseObject& one : objects.subspan(first, std::min(at_once, objects.size() - first))) {
      one.spot = cheapest_spot(one.box, branches);
      one.there = arrays_.child_at(NodeLane::at(one.spot.node, one.spot.lane));
    }
  };
  const std::size_t blocks = (objects.size() + at_once - 1) / at_once;
  ThreadPool alone(1);
  (pool != nullptr ? *pool : alone).for_each(blocks, look);
}

DCEM_INLINE bool WideBvh::reinsert(std::uint32_t object) {
  const WideChild root = arrays_.object_root[object];
  const NodeLane place = arrays_.place_of(root);
  const Aabb<float> box = arrays_.box_at(place);
  if (box.empty()) return false;
  arrays_.tighten_above(detach(place));
  insert(object, box, cheapest_spot(box, branches_));
  return true;
}

DCEM_INLINE void WideBvh::insert(std::uint32_t object, const Aabb<float>& box, const Spot& spot) {
  const WideChild root = arrays_.object_root[object];
  attach_at(root, box, spot);
  area_when_inserted_m2_[object] = arrays_.nodes[arrays_.place_of(root).node()].box().half_area();
}

/// Empties a lane. A node that is left with one entry gives its place to that entry. Returns the node above which boxes
/// are to be made tight.
DCEM_INLINE std::uint32_t WideBvh::detach(NodeLane place) {
  arrays_.attach({}, place, {});
  const std::uint32_t node = place.node();
  if (node == 0 || arrays_.nodes[node].child_count() > 1) {
    degradation_.touch(node);
    return node;
  }
  const NodeLane above = arrays_.lane_of_node[node];
  std::uint32_t lane = 0;
  while (lane < simd_lanes && arrays_.nodes[node].child[lane].is_none()) ++lane;
  const WideChild left = lane < simd_lanes ? arrays_.nodes[node].child[lane] : WideChild{};
  const Aabb<float> box = lane < simd_lanes ? arrays_.nodes[node].box(lane) : Aabb<float>{};
  if (!left.is_none()) arrays_.attach({}, NodeLane::at(node, lane), {});
  arrays_.attach(left, above, box);
  arrays_.lane_of_node[node] = {};
  arrays_.free_nodes.push_back(node);
  degradation_.touch(above.node());
  return above.node();
}

/// Offers the lanes of one node: a free one, or an entry that is not divided further, to be joined under a new node, as
/// far down as new nodes are made. Free lanes may lie between others. There is always a spot above that: a node without
/// one has eight inner nodes below it, and so have they, which no tree can afford for long.
DCEM_INLINE void WideBvh::offer_spots(const Branch& branch, const Aabb<float>& box, std::vector<Branch>& branches,
                                      Spot& best) const {
  const auto& [cost_m2, node, depth] = branch;
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
    if (child.is_leaf() || arrays_.object_rooted_at(child) != WideArrays::no_object) {
      const bool may_join = depth < detail::wide_edit_depth_limit;
      if (may_join && cost_m2 + both_m2 < best.cost_m2) best = {cost_m2 + both_m2, node, lane, true};
      continue;
    }
    const double grown_m2 = cost_m2 + both_m2 - arrays_.costs.node * static_cast<double>(own[lane]);
    if (!(grown_m2 < best.cost_m2)) continue;
    branches.push_back({grown_m2, child.index(), depth + 1});
    std::push_heap(branches.begin(), branches.end());
  }
}

DCEM_INLINE WideBvh::Spot WideBvh::cheapest_spot(const Aabb<float>& box, std::vector<Branch>& branches) const {
  Spot best;
  branches.clear();
  branches.push_back({0.0, 0, 1});
  while (!branches.empty()) {
    std::pop_heap(branches.begin(), branches.end());
    const Branch branch = branches.back();
    branches.pop_back();
    if (!(branch.cost_m2 < best.cost_m2)) break;
    offer_spots(branch, box, branches, best);
  }
  DCEM_ASSERT(best.lane < simd_lanes);
  return best;
}

DCEM_INLINE void WideBvh::attach_at(WideChild child, const Aabb<float>& box, const Spot& spot) {
  NodeLane place = NodeLane::at(spot.node, spot.lane);
  if (spot.joins) {
    const WideChild beside = arrays_.child_at(place);
    const Aabb<float> beside_box = arrays_.box_at(place);
    const std::uint32_t node = arrays_.take_node();
    Aabb<float> both = beside_box;
    both.extend(box);
    arrays_.attach(WideChild::node(node), place, both);
    arrays_.attach(beside, NodeLane::at(node, 0), beside_box);
    place = NodeLane::at(node, 1);
    degradation_.forget(node);
  }
  arrays_.attach(child, place, box);
  degradation_.touch(place.node());
  // From the node that was there: a new one below it is tight already, and the way up would end at it.
  arrays_.tighten_above(spot.node);
}

DCEM_INLINE std::string WideBvh::validate(Boxes boxes) const {
  return detail::find_wide_defect(arrays_, boxes);
}

}  // namespace dcem
