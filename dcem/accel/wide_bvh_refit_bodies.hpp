#pragma once
/// Bodies of wide_bvh.hpp: how a `WideBvh` takes over what has moved.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>

#include "dcem/accel/wide/update/leaf_writer.hpp"
#include "dcem/accel/wide_bvh.hpp"
#include "dcem/core/build_mode.hpp"
#include "dcem/core/thread_pool.hpp"

namespace dcem {

DCEM_INLINE WideRefitReport WideBvh::refit(std::span<const std::uint32_t> moved, const TriangleView& mesh, Boxes boxes,
                                           ThreadPool* pool) {
  if (mesh.size() != primitive_count() || boxes.size() != primitive_count()) {
    throw std::invalid_argument("one box per triangle of the tree is needed");
  }
  if (mesh.vertices_m.size() != arrays_.vertices_m.size()) throw std::invalid_argument("the vertices are others");
  constexpr std::size_t many = 4096;  // fewer are moved before anybody has woken up
  if (pool != nullptr && (pool->size() == 1 || moved.size() < many)) pool = nullptr;
  look_at_boxes(moved, boxes, pool);
  for (const std::uint32_t object : moved_objects_) object_is_moved_[object] = 0;
  moved_objects_.clear();
  WideRefitReport report;
  mark_dirty(moved);
  report.leaves_written = dirty_leaves_.size();
  pool != nullptr ? write_dirty_leaves(mesh.vertices_m, report, *pool) : write_dirty_leaves(mesh.vertices_m, report);
  dirty_leaves_.clear();
  if (arrays_.is_area_imprecise()) sum_anew();
  return report;
}

DCEM_INLINE void WideBvh::write_dirty_leaves(std::span<const Vec3> from_m, WideRefitReport& report) {
  for (std::size_t index = 0; index < dirty_leaves_.size(); ++index) {
    if (settings_.fetch_ahead) {
      if (index + 2 < dirty_leaves_.size()) arrays_.fetch_leaf(dirty_leaves_[index + 2]);
      if (index + 1 < dirty_leaves_.size()) arrays_.fetch_around_leaf(dirty_leaves_[index + 1], from_m);
    }
    const std::uint32_t leaf = dirty_leaves_[index];
    arrays_.copy_vertices(leaf, from_m);
    take_leaf(leaf, arrays_.write_leaf(leaf));
  }
  report.nodes_visited += loose_nodes_.tighten_all(arrays_);
}

/// Vertices first: leaves may have some in common.
DCEM_INLINE void WideBvh::write_dirty_leaves(std::span<const Vec3> from_m, WideRefitReport& report, ThreadPool& pool) {
  pool.for_each_quick(dirty_leaves_.size(),
                      [&](std::size_t index) { arrays_.copy_vertices_together(dirty_leaves_[index], from_m); });
  dirty_boxes_.resize(dirty_leaves_.size());
  pool.for_each_quick(dirty_leaves_.size(),
                      [&](std::size_t index) { dirty_boxes_[index] = arrays_.write_leaf(dirty_leaves_[index]); });
  for (std::size_t index = 0; index < dirty_leaves_.size(); ++index) {
    if (settings_.fetch_ahead && index + 2 < dirty_leaves_.size()) arrays_.fetch_node_of(dirty_leaves_[index + 2]);
    take_leaf(dirty_leaves_[index], dirty_boxes_[index]);
  }
  report.nodes_visited += loose_nodes_.tighten_all(arrays_);
}

/// Hangs a leaf that has been written into the tree; what is above it is tightened later, with all of them.
DCEM_INLINE void WideBvh::take_leaf(std::uint32_t leaf, const Aabb<float>& box) {
  leaf_is_dirty_[leaf] = 0;
  const NodeLane place = arrays_.lane_of_leaf[leaf];
  arrays_.note_extent(box);
  if (box != arrays_.box_at(place)) {
    arrays_.set_box(place, box);
    loose_nodes_.add(place.node());
    degradation_.touch(place.node());
  }
  note_moved_object(arrays_.leaves[leaf].object);
}

/// Which of the triangles are there now. `is_there_now_` is empty when all are: then nothing is noted one by one.
DCEM_INLINE void WideBvh::look_at_boxes(std::span<const std::uint32_t> moved, Boxes boxes, ThreadPool* pool) {
  is_there_now_.clear();
  if (pool != nullptr ? are_plain(moved, boxes, *pool) : are_plain(moved, boxes)) return;
  for (const std::uint32_t triangle : moved) {
    require_valid_box(boxes[triangle], triangle);
    is_there_now_.push_back(boxes[triangle].empty() ? 0 : 1);
  }
}

/// Whether all of these triangles are there, with boxes that need no closer look.
DCEM_INLINE bool WideBvh::are_plain(std::span<const std::uint32_t> moved, Boxes boxes) {
  detail::PlainBoxes plain;
  for (const std::uint32_t triangle : moved) {
    if (triangle >= boxes.size()) throw std::invalid_argument("triangle " + std::to_string(triangle) + " of none");
    plain.add(boxes[triangle]);
  }
  return plain.all();
}

DCEM_INLINE bool WideBvh::are_plain(std::span<const std::uint32_t> moved, Boxes boxes, ThreadPool& pool) {
  constexpr std::size_t block = 2048;
  block_is_plain_.resize((moved.size() + block - 1) / block);
  pool.for_each(block_is_plain_.size(), [&](std::size_t number, unsigned) {
    const std::size_t first = number * block;
    block_is_plain_[number] = are_plain(moved.subspan(first, std::min(block, moved.size() - first)), boxes) ? 1 : 0;
  });
  return std::ranges::all_of(block_is_plain_, [](char is_plain) { return is_plain != 0; });
}

/// Notes the leaves in which triangles have moved, each once.
DCEM_INLINE void WideBvh::mark_dirty(std::span<const std::uint32_t> moved) {
  for (std::size_t index = 0; index < moved.size(); ++index) {
    arrays_.is_there[moved[index]] = is_there_now_.empty() ? char{1} : is_there_now_[index];
    const std::uint32_t leaf = arrays_.quad_of_triangle[moved[index]] / simd_lanes;
    if (leaf_is_dirty_[leaf] != 0) continue;
    leaf_is_dirty_[leaf] = 1;
    dirty_leaves_.push_back(leaf);
  }
}

DCEM_INLINE void WideBvh::note_moved_object(std::uint32_t object) {
  if (arrays_.object_root[object].is_none() || object_is_moved_[object] != 0) return;
  object_is_moved_[object] = 1;
  moved_objects_.push_back(object);
}

}  // namespace dcem
