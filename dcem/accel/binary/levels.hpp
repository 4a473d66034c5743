#pragma once
/// The two layers of a `Bvh`, the tree over the groups and the groups' own trees: edits of the upper one alone, the
/// wear of both, and their checks. Included by bvh.hpp.
#include "dcem/accel/bvh.hpp"

namespace dcem {

/// Takes the groups' own trees off, builds the layer above them anew, and hangs them on again.
template <std::floating_point Scalar>
void Bvh<Scalar>::rebuild_above_groups(std::uint32_t node) {
  struct Hanging {
    std::uint32_t group;
    BvhNode<Scalar> root;
    SubtreeWear wear;
  };
  std::vector<Hanging> hanging;
  std::vector<BuildItem<Scalar>> items;
  std::vector<std::uint32_t> pairs;
  for_each_in_layer(node, [&](std::uint32_t above) {
    pairs.push_back(arrays_.nodes[above].left());
    for (const std::uint32_t slot : {arrays_.nodes[above].left(), arrays_.nodes[above].right()}) {
      if (!wear_[slot].is_group_root) continue;
      items.emplace_back(arrays_.nodes[slot].box, static_cast<std::uint32_t>(hanging.size()));
      hanging.push_back({group_at(first_position(slot)), arrays_.nodes[slot], wear_[slot]});
    }
  });
  arrays_.release(pairs);
  SahSettings one_group_a_leaf = settings_;
  one_group_a_leaf.leaf_limit = one_group_a_leaf.leaf_maximum = 1;
  const auto sprout = SahBuilder<Scalar>(one_group_a_leaf).build(items, maximum_build_levels + 1 - level_of(node, 0));
  for (const std::uint32_t pair : pairs) wear_[pair] = wear_[pair + 1] = {};
  arrays_.plant(node, sprout, [&](std::uint32_t leaf) {
    const Hanging& group = hanging[items[arrays_.nodes[leaf].first].index];
    hang_group(leaf, group.group, group.root, group.wear);
  });
  begin_wear_above_groups(node);
}

template <std::floating_point Scalar>
void Bvh<Scalar>::begin_wear_above_groups(std::uint32_t node) {
  std::vector<std::uint32_t> layer;
  for_each_in_layer(node, [&](std::uint32_t slot) { layer.push_back(slot); });
  for (auto slot = layer.rbegin(); slot != layer.rend(); ++slot) begin_wear<Scalar>(wear_, nodes(), *slot, settings_);
  refresh_wear_above(node);
  last_refit_.clear();
}

/// Puts a group's root, whose children stay where they are, into another slot.
template <std::floating_point Scalar>
void Bvh<Scalar>::hang_group(std::uint32_t slot, std::uint32_t group, const BvhNode<Scalar>& root,
                             const SubtreeWear& wear) {
  arrays_.nodes[slot] = root;
  wear_[slot] = wear;
  group_root_[group] = slot;
  if (!root.is_leaf()) {
    arrays_.parent[root.left()] = arrays_.parent[root.right()] = slot;
    return;
  }
  for (std::size_t index = 0; index < root.count; ++index) arrays_.leaf_of[arrays_.order[root.first + index]] = slot;
}

template <std::floating_point Scalar>
bool Bvh<Scalar>::lies_in_group(std::uint32_t node) const {
  while (node != no_node && !wear_[node].is_group_root) node = arrays_.parent[node];
  return node != no_node;
}

/// Any position in the primitive order that a subtree holds.
template <std::floating_point Scalar>
std::uint32_t Bvh<Scalar>::first_position(std::uint32_t node) const {
  while (!arrays_.nodes[node].is_leaf()) node = arrays_.nodes[node].left();
  return arrays_.nodes[node].first;
}

/// Notes a subtree, groups included, as built now.
template <std::floating_point Scalar>
void Bvh<Scalar>::begin_wear_below(std::uint32_t node) {
  wear_.resize(arrays_.nodes.size());
  dirty_.reserve(arrays_.nodes.size());
  last_refit_.reserve(arrays_.nodes.size());
  std::vector<std::uint32_t> below;
  for_each_node(nodes(), node, [&](std::uint32_t slot, std::uint32_t) {
    below.push_back(slot);
    wear_[slot] = {};
  });
  for (const std::uint32_t slot : below) {
    if (arrays_.nodes[slot].is_leaf()) wear_[group_root_[group_at(arrays_.nodes[slot].first)]].is_group_root = true;
  }
  for (auto slot = below.rbegin(); slot != below.rend(); ++slot) {
    begin_wear<Scalar>(wear_, nodes(), *slot, settings_);
  }
}

template <std::floating_point Scalar>
void Bvh<Scalar>::refresh_wear_above(std::uint32_t node) {
  for (std::uint32_t above = arrays_.parent[node]; above != no_node; above = arrays_.parent[above]) {
    refresh_wear<Scalar>(wear_, nodes(), above, settings_);
  }
}

/// Each group's root holds exactly the group's positions.
template <std::floating_point Scalar>
std::string Bvh<Scalar>::check_groups() const {
  for (std::size_t group = 0; group < group_root_.size(); ++group) {
    const std::uint32_t begin = group_first_[group];
    const std::uint32_t end = group_first_[group + 1];
    std::size_t held = 0;
    bool inside = (group_root_[group] == no_node) == (begin == end);
    if (inside && begin != end) {
      for_each_node(nodes(), group_root_[group], [&](std::uint32_t slot, std::uint32_t) {
        const BvhNode<Scalar>& node = arrays_.nodes[slot];
        if (node.is_leaf()) inside = inside && node.first >= begin && node.first + node.count <= end;
        held += node.count;
      });
    }
    if (!inside || held != end - begin) return "group " + std::to_string(group) + " does not own its subtree";
  }
  return {};
}

/// Each node's sums are those of its children and its own; sums from children have no history, so they agree exactly.
template <std::floating_point Scalar>
std::string Bvh<Scalar>::check_wear() const {
  if (arrays_.empty()) return {};
  std::vector<SubtreeWear> expected = wear_;
  for (SubtreeWear& wear : expected) wear.is_group_root = false;
  for (const std::uint32_t root : group_root_) {
    if (root != no_node) expected[root].is_group_root = true;
  }
  for (std::uint32_t slot = 0; slot < arrays_.nodes.size(); ++slot) {
    if (arrays_.parent[slot] == free_slot) continue;
    refresh_wear<Scalar>(expected, nodes(), slot, settings_);
    if (expected[slot] != wear_[slot]) return "node " + std::to_string(slot) + ": what is known of its wear is wrong";
  }
  return {};
}

}  // namespace dcem
