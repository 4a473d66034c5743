#pragma once
/// The two levels of a `Bvh`, the tree over the objects and the objects' own trees: edits of the upper one alone, the
/// degradation of both, and their checks. Included by bvh.hpp.
#include "dcem/accel/bvh.hpp"

namespace dcem {

/// Takes the objects' own trees off, builds the level above them anew, and attaches them again.
template <std::floating_point Scalar>
void Bvh<Scalar>::rebuild_above_objects(std::uint32_t node) {
  struct Attached {
    std::uint32_t object;
    BvhNode<Scalar> root;
    SubtreeDegradation degradation;
  };
  std::vector<Attached> attached;
  std::vector<BuildItem<Scalar>> items;
  std::vector<std::uint32_t> pairs;
  for_each_in_level(node, [&](std::uint32_t above) {
    pairs.push_back(arrays_.nodes[above].left());
    for (const std::uint32_t slot : {arrays_.nodes[above].left(), arrays_.nodes[above].right()}) {
      if (!degradation_[slot].is_object_root) continue;
      items.emplace_back(arrays_.nodes[slot].box, static_cast<std::uint32_t>(attached.size()));
      attached.push_back({object_at(first_position(slot)), arrays_.nodes[slot], degradation_[slot]});
    }
  });
  arrays_.release(pairs);
  SahSettings one_object_a_leaf = settings_;
  one_object_a_leaf.leaf_limit = one_object_a_leaf.leaf_maximum = 1;
  const auto sprout = SahBuilder<Scalar>(one_object_a_leaf).build(items, maximum_build_depth + 1 - level_of(node, 0));
  for (const std::uint32_t pair : pairs) degradation_[pair] = degradation_[pair + 1] = {};
  arrays_.build_all(node, sprout, [&](std::uint32_t leaf) {
    const Attached& object = attached[items[arrays_.nodes[leaf].first].index];
    insert_object(leaf, object.object, object.root, object.degradation);
  });
  begin_degradation_above_objects(node);
}

template <std::floating_point Scalar>
void Bvh<Scalar>::begin_degradation_above_objects(std::uint32_t node) {
  std::vector<std::uint32_t> level;
  for_each_in_level(node, [&](std::uint32_t slot) { level.push_back(slot); });
  for (auto slot = level.rbegin(); slot != level.rend(); ++slot)
    begin_degradation<Scalar>(degradation_, nodes(), *slot, settings_);
  refresh_degradation_above(node);
  last_refit_.clear();
}

/// Puts an object's root, whose children stay where they are, into another slot.
template <std::floating_point Scalar>
void Bvh<Scalar>::insert_object(std::uint32_t slot, std::uint32_t object, const BvhNode<Scalar>& root,
                                const SubtreeDegradation& degradation) {
  arrays_.nodes[slot] = root;
  degradation_[slot] = degradation;
  object_root_[object] = slot;
  if (!root.is_leaf()) {
    arrays_.parent[root.left()] = arrays_.parent[root.right()] = slot;
    return;
  }
  for (std::size_t index = 0; index < root.count; ++index) arrays_.leaf_of[arrays_.order[root.first + index]] = slot;
}

template <std::floating_point Scalar>
bool Bvh<Scalar>::lies_in_object(std::uint32_t node) const {
  while (node != no_node && !degradation_[node].is_object_root) node = arrays_.parent[node];
  return node != no_node;
}

/// Any position in the primitive order that a subtree holds.
template <std::floating_point Scalar>
std::uint32_t Bvh<Scalar>::first_position(std::uint32_t node) const {
  while (!arrays_.nodes[node].is_leaf()) node = arrays_.nodes[node].left();
  return arrays_.nodes[node].first;
}

/// Notes a subtree, objects included, as built now.
template <std::floating_point Scalar>
void Bvh<Scalar>::begin_degradation_below(std::uint32_t node) {
  degradation_.resize(arrays_.nodes.size());
  dirty_.reserve(arrays_.nodes.size());
  last_refit_.reserve(arrays_.nodes.size());
  std::vector<std::uint32_t> below;
  for_each_node(nodes(), node, [&](std::uint32_t slot, std::uint32_t) {
    below.push_back(slot);
    degradation_[slot] = {};
  });
  for (const std::uint32_t slot : below) {
    if (arrays_.nodes[slot].is_leaf())
      degradation_[object_root_[object_at(arrays_.nodes[slot].first)]].is_object_root = true;
  }
  for (auto slot = below.rbegin(); slot != below.rend(); ++slot) {
    begin_degradation<Scalar>(degradation_, nodes(), *slot, settings_);
  }
}

template <std::floating_point Scalar>
void Bvh<Scalar>::refresh_degradation_above(std::uint32_t node) {
  for (std::uint32_t above = arrays_.parent[node]; above != no_node; above = arrays_.parent[above]) {
    refresh_degradation<Scalar>(degradation_, nodes(), above, settings_);
  }
}

/// Each object's root holds exactly the object's positions.
template <std::floating_point Scalar>
std::string Bvh<Scalar>::check_objects() const {
  for (std::size_t object = 0; object < object_root_.size(); ++object) {
    const std::uint32_t begin = object_first_[object];
    const std::uint32_t end = object_first_[object + 1];
    std::size_t held = 0;
    bool inside = (object_root_[object] == no_node) == (begin == end);
    if (inside && begin != end) {
      for_each_node(nodes(), object_root_[object], [&](std::uint32_t slot, std::uint32_t) {
        const BvhNode<Scalar>& node = arrays_.nodes[slot];
        if (node.is_leaf()) inside = inside && node.first >= begin && node.first + node.count <= end;
        held += node.count;
      });
    }
    if (!inside || held != end - begin) return "object " + std::to_string(object) + " does not own its subtree";
  }
  return {};
}

/// Each node's sums are those of its children and its own; sums from children have no history, so they agree exactly.
template <std::floating_point Scalar>
std::string Bvh<Scalar>::check_degradation() const {
  if (arrays_.empty()) return {};
  std::vector<SubtreeDegradation> expected = degradation_;
  for (SubtreeDegradation& degradation : expected) degradation.is_object_root = false;
  for (const std::uint32_t root : object_root_) {
    if (root != no_node) expected[root].is_object_root = true;
  }
  for (std::uint32_t slot = 0; slot < arrays_.nodes.size(); ++slot) {
    if (arrays_.parent[slot] == free_slot) continue;
    refresh_degradation<Scalar>(expected, nodes(), slot, settings_);
    if (expected[slot] != degradation_[slot])
      return "node " + std::to_string(slot) + ": what is known of its degradation is wrong";
  }
  return {};
}

}  // namespace dcem
