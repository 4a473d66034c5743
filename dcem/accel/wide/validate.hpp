#pragma once
/// Checks every promise of a wide tree's arrays: for tests, and after edits while debugging.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "dcem/accel/detail/box_check.hpp"
#include "dcem/accel/wide/arrays.hpp"
#include "dcem/accel/wide/node.hpp"

namespace dcem::detail {

/// One walk over the arrays. Every index is checked before it is used.
class WideInspector {
 public:
  WideInspector(const WideArrays& arrays, std::span<const Aabb<double>> boxes) : arrays_(arrays), boxes_(boxes) {}

  std::string find_defect() {
    if (arrays_.triangles.size() != boxes_.size()) return "the number of boxes is another";
    for (std::uint32_t triangle = 0; triangle < boxes_.size(); ++triangle) {
      if (arrays_.box_of(triangle) != canonical_box(boxes_[triangle])) {
        return "triangle " + std::to_string(triangle) + " is not where its box is";
      }
    }
    if (arrays_.nodes.empty()) return boxes_.empty() ? "" : "there is no root";
    node_seen_.assign(arrays_.nodes.size(), false);
    leaf_seen_.assign(arrays_.leaves.size(), false);
    if (std::string defect = check_node(0, 1); !defect.empty()) return defect;
    return check_whole();
  }

 private:
  static std::string at(const char* what, std::uint32_t index, const std::string& defect) {
    return std::string(what) + " " + std::to_string(index) + ": " + defect;
  }

  std::string check_node(std::uint32_t node, std::uint32_t depth) {
    if (depth > wide_depth_limit) return at("node", node, "lies deeper than a walk can follow");
    if (node_seen_[node]) return at("node", node, "hangs in two places");
    node_seen_[node] = true;
    for (std::uint32_t lane = 0; lane < simd_lanes; ++lane) {
      const WideChild child = arrays_.nodes[node].child[lane];
      const Aabb<float> box = arrays_.nodes[node].box(lane);
      if (child.is_none()) {
        if (!box.empty()) return at("node", node, "a lane without child has a box");
        continue;
      }
      if (std::string defect = check_child(child, NodeLane::at(node, lane), box, depth); !defect.empty()) {
        return defect;
      }
    }
    return {};
  }

  std::string check_child(WideChild child, NodeLane place, const Aabb<float>& box, std::uint32_t depth) {
    const bool exists = child.index() < (child.is_leaf() ? arrays_.leaves.size() : arrays_.nodes.size());
    if (!exists) return at("node", place.node(), "leads to what does not exist");
    if (arrays_.place_of(child) != place) return at("node", place.node(), "a child does not know where it hangs");
    const std::uint32_t object = arrays_.object_rooted_at(child);
    if (object != WideArrays::no_object && !(arrays_.object_root[object] == child)) {
      return at("node", place.node(), "an object does not know its root");
    }
    sum_m2_ += (child.is_leaf() ? arrays_.costs.leaf : arrays_.costs.node) * static_cast<double>(box.half_area());
    if (child.is_leaf()) return check_leaf(child.index(), box);
    if (arrays_.nodes[child.index()].box() != box) return at("node", child.index(), "its box is not tight");
    return check_node(child.index(), depth + 1);
  }

  std::string check_leaf(std::uint32_t leaf, const Aabb<float>& box) {
    if (leaf_seen_[leaf]) return at("leaf", leaf, "hangs in two places");
    leaf_seen_[leaf] = true;
    Aabb<double> all;
    for (std::uint32_t lane = 0; lane < simd_lanes; ++lane) {
      const std::uint32_t index = leaf * simd_lanes + lane;
      const Quad& quad = arrays_.quads[index];
      const bool there = !quad.is_none() && !arrays_.box_of_quad(quad).empty();
      if ((arrays_.leaves[leaf].lanes >> lane & 1U) != (there ? 1U : 0U)) {
        return at("leaf", leaf, "its lanes are not those of the triangles that are there");
      }
      if (quad.is_none()) continue;
      for (const std::uint32_t triangle : quad.triangles()) {
        if (triangle >= boxes_.size()) return at("leaf", leaf, "holds a triangle that does not exist");
        if (arrays_.quad_of_triangle[triangle] != index) return at("triangle", triangle, "is in another quad");
        ++triangles_;
      }
      all.extend(arrays_.box_of_quad(quad));
    }
    return arrays_.rounded_out(all) == box ? "" : at("leaf", leaf, "its box is not tight");
  }

  std::string check_whole() const {
    for (std::uint32_t node = 0; node < node_seen_.size(); ++node) {
      const bool is_free =
          std::find(arrays_.free_nodes.begin(), arrays_.free_nodes.end(), node) != arrays_.free_nodes.end();
      if (node_seen_[node] == is_free) return at("node", node, "is neither used nor free, or both");
    }
    for (std::uint32_t leaf = 0; leaf < leaf_seen_.size(); ++leaf) {
      if (!leaf_seen_[leaf]) return at("leaf", leaf, "hangs nowhere");
    }
    if (triangles_ != boxes_.size()) return "not every triangle is in the tree";
    // The sum is kept by differences: it drifts by roundings only.
    if (std::abs(sum_m2_ - arrays_.weighted_area_m2) > 1e-9 * (sum_m2_ + 1e-300)) return "the sum of areas is off";
    return {};
  }

  const WideArrays& arrays_;
  std::span<const Aabb<double>> boxes_;
  std::vector<bool> node_seen_, leaf_seen_;
  std::size_t triangles_ = 0;
  double sum_m2_ = 0.0;
};

inline std::string find_wide_defect(const WideArrays& arrays, std::span<const Aabb<double>> boxes) {
  return WideInspector(arrays, boxes).find_defect();
}

}  // namespace dcem::detail
