#pragma once
/// Checks every promise of a tree's arrays: for tests, and after edits while debugging.
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "dcem/accel/binary/arrays.hpp"
#include "dcem/accel/detail/box_check.hpp"

namespace dcem {

namespace detail {

/// One walk over possibly broken arrays: no index is used before it was checked.
template <std::floating_point Scalar>
class BvhInspector {
 public:
  BvhInspector(const BvhArrays<Scalar>& arrays, std::span<const Aabb<Scalar>> boxes) : arrays_(arrays), boxes_(boxes) {}

  std::string find_defect();

 private:
  std::string check_sizes() const;
  std::string check_node(std::uint32_t slot, std::uint32_t depth);
  std::string check_inner(std::uint32_t slot) const;
  std::string check_leaf(std::uint32_t slot);
  std::string check_position(std::uint32_t slot, std::size_t position);
  std::string check_free_slots() const;

  static std::string at(std::uint32_t slot, const std::string& defect) {
    return "node " + std::to_string(slot) + ": " + defect;
  }

  const BvhArrays<Scalar>& arrays_;
  std::span<const Aabb<Scalar>> boxes_;
  std::vector<bool> slot_seen_;
  std::vector<bool> primitive_seen_;
};

template <std::floating_point Scalar>
std::string BvhInspector<Scalar>::check_sizes() const {
  const std::size_t primitives = boxes_.size();
  if (arrays_.order.size() != primitives || arrays_.ordered_boxes.size() != primitives ||
      arrays_.leaf_of.size() != primitives) {
    return "the tree holds " + std::to_string(arrays_.order.size()) + " primitives, there are " +
           std::to_string(primitives) + " boxes";
  }
  if (arrays_.parent.size() != arrays_.nodes.size()) return "parent links and nodes differ in number";
  if (arrays_.nodes.empty() != (primitives == 0)) return "a tree has a root exactly when it has primitives";
  return {};
}

template <std::floating_point Scalar>
std::string BvhInspector<Scalar>::check_position(std::uint32_t slot, std::size_t position) {
  const std::uint32_t primitive = arrays_.order[position];
  if (primitive >= boxes_.size()) return at(slot, "holds a primitive that does not exist");
  const std::string name = "primitive " + std::to_string(primitive);
  if (primitive_seen_[primitive]) return at(slot, name + " is in the tree twice");
  primitive_seen_[primitive] = true;
  if (arrays_.leaf_of[primitive] != slot) return at(slot, name + " is linked to another leaf");
  if (arrays_.ordered_boxes[position] != canonical_box(boxes_[primitive])) {
    return at(slot, "the stored box of " + name + " is not its box");
  }
  return {};
}

template <std::floating_point Scalar>
std::string BvhInspector<Scalar>::check_leaf(std::uint32_t slot) {
  const BvhNode<Scalar>& node = arrays_.nodes[slot];
  if (node.count > maximum_leaf_size) return at(slot, "a leaf too large");
  if (std::size_t{node.first} + node.count > arrays_.order.size()) return at(slot, "a leaf beyond the primitive order");
  Aabb<Scalar> tight;
  for (std::size_t position = node.first; position < node.first + node.count; ++position) {
    if (std::string defect = check_position(slot, position); !defect.empty()) return defect;
    tight.extend(arrays_.ordered_boxes[position]);
  }
  return tight == node.box ? std::string{} : at(slot, "the box is not that of its primitives");
}

template <std::floating_point Scalar>
std::string BvhInspector<Scalar>::check_inner(std::uint32_t slot) const {
  const BvhNode<Scalar>& node = arrays_.nodes[slot];
  if (node.left() < 2 || node.left() % 2 != 0 || node.right() >= arrays_.nodes.size() || node.right() < node.left()) {
    return at(slot, "the children are not a pair of slots");
  }
  Aabb<Scalar> tight;
  for (const std::uint32_t child : {node.left(), node.right()}) {
    if (arrays_.parent[child] != slot) return at(child, "the parent link is wrong");
    if (!node.box.contains(arrays_.nodes[child].box)) return at(child, "the box is not inside the parent's");
    tight.extend(arrays_.nodes[child].box);
  }
  return tight == node.box ? std::string{} : at(slot, "the box is not that of its children");
}

template <std::floating_point Scalar>
std::string BvhInspector<Scalar>::check_node(std::uint32_t slot, std::uint32_t depth) {
  if (depth >= traversal_stack_size) return at(slot, "deeper than the traversal stack");
  if (slot_seen_[slot]) return at(slot, "reached twice");
  slot_seen_[slot] = true;
  return arrays_.nodes[slot].is_leaf() ? check_leaf(slot) : check_inner(slot);
}

template <std::floating_point Scalar>
std::string BvhInspector<Scalar>::check_free_slots() const {
  std::vector<bool> listed(arrays_.nodes.size(), false);
  listed[1] = true;
  for (const std::uint32_t pair : arrays_.free_pairs) {
    if (pair < 2 || pair % 2 != 0 || pair + 1 >= listed.size() || listed[pair]) return at(pair, "not a free pair");
    listed[pair] = listed[pair + 1] = true;
  }
  for (std::uint32_t slot = 0; slot < listed.size(); ++slot) {
    if (slot_seen_[slot] == listed[slot]) return at(slot, "neither in the tree nor free, or both");
    if (listed[slot] != (arrays_.parent[slot] == free_slot)) return at(slot, "the free mark is wrong");
  }
  return {};
}

template <std::floating_point Scalar>
std::string BvhInspector<Scalar>::find_defect() {
  if (std::string defect = check_sizes(); !defect.empty()) return defect;
  if (boxes_.empty()) return {};
  slot_seen_.assign(arrays_.nodes.size(), false);
  primitive_seen_.assign(boxes_.size(), false);
  if (arrays_.parent[0] != no_node) return at(0, "the root has a parent");
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pending{{0, 1}};
  while (!pending.empty()) {
    const auto [slot, depth] = pending.back();
    pending.pop_back();
    if (std::string defect = check_node(slot, depth); !defect.empty()) return defect;
    const BvhNode<Scalar>& node = arrays_.nodes[slot];
    if (node.is_leaf()) continue;
    pending.emplace_back(node.right(), depth + 1);
    pending.emplace_back(node.left(), depth + 1);
  }
  for (std::size_t primitive = 0; primitive < boxes_.size(); ++primitive) {
    if (!primitive_seen_[primitive]) return "primitive " + std::to_string(primitive) + " is in no leaf";
  }
  return check_free_slots();
}

}  // namespace detail

/// A sentence about the first broken promise, empty when there is none: children inside parents and linked to them,
/// every box exactly tight, each primitive in one leaf that it is linked to, levels within the traversal stack, every
/// slot either in the tree or free. `boxes` are the primitives' boxes as they are now.
template <std::floating_point Scalar>
std::string find_defect(const BvhArrays<Scalar>& arrays, std::span<const Aabb<Scalar>> boxes) {
  return detail::BvhInspector<Scalar>(arrays, boxes).find_defect();
}

}  // namespace dcem
