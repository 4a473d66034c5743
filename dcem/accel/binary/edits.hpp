#pragma once
/// Definitions of the edits and checks of `Bvh`; included by bvh.hpp.
#include "dcem/accel/bvh.hpp"

namespace dcem {

template <std::floating_point Scalar>
void Bvh<Scalar>::build(Boxes boxes, const SahSettings& settings) {
  const std::uint32_t whole = 0;
  build_grouped(boxes, {&whole, 1}, settings);
}

template <std::floating_point Scalar>
void Bvh<Scalar>::build_grouped(Boxes boxes, std::span<const std::uint32_t> group_first, const SahSettings& settings) {
  require_valid_settings(settings);
  require_valid_boxes(boxes);
  require_valid_groups(group_first, boxes.size());
  settings_ = settings;
  arrays_.reset(boxes.size());
  group_first_.assign(group_first.begin(), group_first.end());
  group_first_.push_back(static_cast<std::uint32_t>(boxes.size()));
  group_root_.assign(group_first.size(), no_node);
  std::vector<std::uint32_t> groups;
  for (std::uint32_t group = 0; group < group_root_.size(); ++group) {
    if (group_first_[group] < group_first_[group + 1]) groups.push_back(group);
  }
  if (!groups.empty()) grow_groups(0, groups, boxes, maximum_build_levels);
  wear_.clear();
  last_refit_.clear();
  if (!arrays_.empty()) begin_wear_below(0);
  sah_at_build_ = sah_cost();
}

template <std::floating_point Scalar>
void Bvh<Scalar>::rebuild(Boxes boxes) {
  std::vector<std::uint32_t> group_first = group_first_;
  if (!group_first.empty()) group_first.pop_back();
  build_grouped(boxes, group_first, settings_);
}

/// Plants a tree over the groups at `slot` and each group's own tree at a leaf of it.
template <std::floating_point Scalar>
void Bvh<Scalar>::grow_groups(std::uint32_t slot, std::span<const std::uint32_t> groups, Boxes boxes,
                              std::uint32_t levels) {
  std::vector<BuildItem<Scalar>> items;
  for (const std::uint32_t group : groups) {
    Box bounds;
    for (std::uint32_t position = group_first_[group]; position < group_first_[group + 1]; ++position) {
      bounds.extend(canonical_box(boxes[arrays_.order[position]]));
    }
    items.emplace_back(bounds, group);
  }
  SahSettings one_group_a_leaf = settings_;
  one_group_a_leaf.leaf_limit = one_group_a_leaf.leaf_maximum = 1;
  const auto sprout = SahBuilder<Scalar>(one_group_a_leaf).build(items, levels);
  arrays_.plant(slot, sprout, [&](std::uint32_t leaf) {
    const std::uint32_t group = items[arrays_.nodes[leaf].first].index;
    group_root_[group] = leaf;
    grow_range(leaf, group_first_[group], group_first_[group + 1], boxes, maximum_build_levels);
  });
}

/// Plants a tree at `slot` over the primitives that stand at positions begin … end−1 of the order.
template <std::floating_point Scalar>
void Bvh<Scalar>::grow_range(std::uint32_t slot, std::size_t begin, std::size_t end, Boxes boxes,
                             std::uint32_t levels) {
  std::vector<BuildItem<Scalar>> items;
  items.reserve(end - begin);
  for (std::size_t position = begin; position < end; ++position) {
    const std::uint32_t primitive = arrays_.order[position];
    items.emplace_back(canonical_box(boxes[primitive]), primitive);
  }
  const auto sprout = SahBuilder<Scalar>(settings_).build(items, levels);
  for (std::size_t position = begin; position < end; ++position) {
    arrays_.order[position] = items[position - begin].index;
    arrays_.ordered_boxes[position] = items[position - begin].box;
  }
  arrays_.plant(slot, sprout, [&](std::uint32_t leaf) {
    BvhNode<Scalar>& node = arrays_.nodes[leaf];
    node.first += static_cast<std::uint32_t>(begin);
    for (std::size_t index = 0; index < node.count; ++index) arrays_.leaf_of[arrays_.order[node.first + index]] = leaf;
  });
}

template <std::floating_point Scalar>
void Bvh<Scalar>::rebuild_subtree(std::uint32_t node, Boxes boxes) {
  require_boxes(boxes);
  require_node(node);
  for_each_node(nodes(), node, [&](std::uint32_t slot, std::uint32_t) {
    const BvhNode<Scalar>& held = arrays_.nodes[slot];
    for (std::size_t index = 0; index < held.count; ++index) {
      const std::uint32_t primitive = arrays_.order[held.first + index];
      require_valid_box(boxes[primitive], primitive);
    }
  });
  const Box old_box = arrays_.nodes[node].box;
  regrow(node, boxes);
  last_refit_.clear();
  begin_wear_below(node);
  if (arrays_.nodes[node].box != old_box) {
    for (std::uint32_t above = arrays_.parent[node]; above != no_node && tighten(above);) above = arrays_.parent[above];
  }
  refresh_wear_above(node);
  if (node == 0) sah_at_build_ = sah_cost();
}

/// Frees and plants below `node`: one range of positions inside a group, whole groups above the group roots.
template <std::floating_point Scalar>
void Bvh<Scalar>::regrow(std::uint32_t node, Boxes boxes) {
  std::size_t begin = arrays_.order.size();
  std::size_t end = 0;
  std::vector<std::uint32_t> groups;
  for_each_node(nodes(), node, [&](std::uint32_t slot, std::uint32_t) {
    const BvhNode<Scalar>& held = arrays_.nodes[slot];
    if (!held.is_leaf()) return;
    begin = std::min<std::size_t>(begin, held.first);
    end = std::max<std::size_t>(end, held.first + held.count);
    groups.push_back(group_at(held.first));
  });
  std::ranges::sort(groups);
  groups.erase(std::unique(groups.begin(), groups.end()), groups.end());
  arrays_.free_below(node);
  if (groups.size() == 1) {
    const std::uint32_t level = level_of(node, group_root_[groups.front()]);
    grow_range(node, begin, end, boxes, maximum_build_levels + 1 - level);
  } else {
    grow_groups(node, groups, boxes, maximum_build_levels + 1 - level_of(node, 0));
  }
}

template <std::floating_point Scalar>
std::uint32_t Bvh<Scalar>::group_at(std::size_t position) const {
  const auto after = std::ranges::upper_bound(group_first_, position);
  return static_cast<std::uint32_t>(after - group_first_.begin() - 1);
}

/// Levels from `above`, which is 1, down to `node`.
template <std::floating_point Scalar>
std::uint32_t Bvh<Scalar>::level_of(std::uint32_t node, std::uint32_t above) const {
  std::uint32_t level = 1;
  for (; node != above; node = arrays_.parent[node]) ++level;
  return level;
}

template <std::floating_point Scalar>
RefitReport Bvh<Scalar>::refit(std::span<const std::uint32_t> moved_primitives, Boxes boxes) {
  require_boxes(boxes);
  for (const std::uint32_t primitive : moved_primitives) {
    if (primitive >= boxes.size()) throw std::invalid_argument("primitive " + std::to_string(primitive) + " of none");
    require_valid_box(boxes[primitive], primitive);
  }
  for (const std::uint32_t primitive : moved_primitives) {
    if (take_over(primitive, boxes[primitive])) dirty_.mark(arrays_.leaf_of[primitive], arrays_.parent);
  }
  return sweep_dirty();
}

template <std::floating_point Scalar>
RefitReport Bvh<Scalar>::refit_all(Boxes boxes) {
  require_boxes(boxes);
  require_valid_boxes(boxes);
  for (const std::uint32_t primitive : arrays_.order) {
    if (take_over(primitive, boxes[primitive])) dirty_.mark(arrays_.leaf_of[primitive], arrays_.parent);
  }
  return sweep_dirty();
}

template <std::floating_point Scalar>
RefitReport Bvh<Scalar>::sweep_dirty() {
  last_refit_.clear();
  return dirty_.sweep(arrays_.parent, [this](std::uint32_t slot, bool stale) {
    const bool changed = stale && tighten(slot);
    refresh_wear<Scalar>(wear_, nodes(), slot, settings_);
    last_refit_.push_back(slot);
    return changed;
  });
}

/// Stores the box of a primitive; false when it is the one already stored.
template <std::floating_point Scalar>
bool Bvh<Scalar>::take_over(std::uint32_t primitive, const Box& box) {
  std::size_t position = arrays_.nodes[arrays_.leaf_of[primitive]].first;
  while (arrays_.order[position] != primitive) ++position;
  const Box canonical = canonical_box(box);
  if (arrays_.ordered_boxes[position] == canonical) return false;
  arrays_.ordered_boxes[position] = canonical;
  return true;
}

/// Makes one box tight again; false when the box stays as it was.
template <std::floating_point Scalar>
bool Bvh<Scalar>::tighten(std::uint32_t slot) {
  BvhNode<Scalar>& node = arrays_.nodes[slot];
  Box tight;
  if (node.is_leaf()) {
    for (std::size_t index = 0; index < node.count; ++index) tight.extend(arrays_.ordered_boxes[node.first + index]);
  } else {
    tight.extend(arrays_.nodes[node.left()].box);
    tight.extend(arrays_.nodes[node.right()].box);
  }
  if (tight == node.box) return false;
  node.box = tight;
  return true;
}

template <std::floating_point Scalar>
std::uint32_t Bvh<Scalar>::depth() const {
  std::uint32_t deepest = 0;
  if (arrays_.empty()) return deepest;
  for_each_node(nodes(), 0, [&](std::uint32_t, std::uint32_t level) { deepest = std::max(deepest, level); });
  return deepest;
}

template <std::floating_point Scalar>
std::string Bvh<Scalar>::validate(Boxes boxes) const {
  if (std::string defect = find_defect(arrays_, boxes); !defect.empty()) return defect;
  if (std::string defect = check_groups(); !defect.empty()) return defect;
  return check_wear();
}

}  // namespace dcem
