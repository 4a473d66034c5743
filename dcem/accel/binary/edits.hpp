#pragma once
/// Definitions of the edits and checks of `Bvh`; included by bvh.hpp.
#include "dcem/accel/bvh.hpp"

namespace dcem {

template <std::floating_point Scalar>
void Bvh<Scalar>::build(Boxes boxes, const SahSettings& settings) {
  const std::uint32_t whole = 0;
  build_objects(boxes, {&whole, 1}, settings);
}

template <std::floating_point Scalar>
void Bvh<Scalar>::build_objects(Boxes boxes, std::span<const std::uint32_t> object_first, const SahSettings& settings) {
  require_valid_settings(settings);
  require_valid_boxes(boxes);
  require_valid_objects(object_first, boxes.size());
  settings_ = settings;
  arrays_.reset(boxes.size());
  object_first_.assign(object_first.begin(), object_first.end());
  object_first_.push_back(static_cast<std::uint32_t>(boxes.size()));
  object_root_.assign(object_first.size(), no_node);
  std::vector<std::uint32_t> objects;
  for (std::uint32_t object = 0; object < object_root_.size(); ++object) {
    if (object_first_[object] < object_first_[object + 1]) objects.push_back(object);
  }
  if (!objects.empty()) grow_objects(0, objects, boxes, maximum_build_depth);
  degradation_.clear();
  last_refit_.clear();
  if (!arrays_.empty()) begin_degradation_below(0);
  sah_at_build_ = sah_cost();
}

template <std::floating_point Scalar>
void Bvh<Scalar>::rebuild(Boxes boxes) {
  std::vector<std::uint32_t> object_first = object_first_;
  if (!object_first.empty()) object_first.pop_back();
  build_objects(boxes, object_first, settings_);
}

/// Plants a tree over the objects at `slot` and each object's own tree at a leaf of it.
template <std::floating_point Scalar>
void Bvh<Scalar>::grow_objects(std::uint32_t slot, std::span<const std::uint32_t> objects, Boxes boxes,
                               std::uint32_t levels) {
  std::vector<BuildItem<Scalar>> items;
  for (const std::uint32_t object : objects) {
    Box bounds;
    for (std::uint32_t position = object_first_[object]; position < object_first_[object + 1]; ++position) {
      bounds.extend(canonical_box(boxes[arrays_.order[position]]));
    }
    items.emplace_back(bounds, object);
  }
  SahSettings one_object_a_leaf = settings_;
  one_object_a_leaf.leaf_limit = one_object_a_leaf.leaf_maximum = 1;
  const auto sprout = SahBuilder<Scalar>(one_object_a_leaf).build(items, levels);
  arrays_.build_all(slot, sprout, [&](std::uint32_t leaf) {
    const std::uint32_t object = items[arrays_.nodes[leaf].first].index;
    object_root_[object] = leaf;
    grow_range(leaf, object_first_[object], object_first_[object + 1], boxes, maximum_build_depth);
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
  arrays_.build_all(slot, sprout, [&](std::uint32_t leaf) {
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
  rebuild_below(node, boxes);
  last_refit_.clear();
  begin_degradation_below(node);
  if (arrays_.nodes[node].box != old_box) {
    for (std::uint32_t above = arrays_.parent[node]; above != no_node && tighten(above);) above = arrays_.parent[above];
  }
  refresh_degradation_above(node);
  if (node == 0) sah_at_build_ = sah_cost();
}

/// Frees and builds below `node`: one range of positions inside an object, whole objects above the object roots.
template <std::floating_point Scalar>
void Bvh<Scalar>::rebuild_below(std::uint32_t node, Boxes boxes) {
  std::size_t begin = arrays_.order.size();
  std::size_t end = 0;
  std::vector<std::uint32_t> objects;
  for_each_node(nodes(), node, [&](std::uint32_t slot, std::uint32_t) {
    const BvhNode<Scalar>& held = arrays_.nodes[slot];
    if (!held.is_leaf()) return;
    begin = std::min<std::size_t>(begin, held.first);
    end = std::max<std::size_t>(end, held.first + held.count);
    objects.push_back(object_at(held.first));
  });
  std::ranges::sort(objects);
  objects.erase(std::unique(objects.begin(), objects.end()), objects.end());
  arrays_.free_below(node);
  if (objects.size() == 1) {
    const std::uint32_t depth = level_of(node, object_root_[objects.front()]);
    grow_range(node, begin, end, boxes, maximum_build_depth + 1 - depth);
  } else {
    grow_objects(node, objects, boxes, maximum_build_depth + 1 - level_of(node, 0));
  }
}

template <std::floating_point Scalar>
std::uint32_t Bvh<Scalar>::object_at(std::size_t position) const {
  const auto after = std::ranges::upper_bound(object_first_, position);
  return static_cast<std::uint32_t>(after - object_first_.begin() - 1);
}

/// Levels from `above`, which is 1, down to `node`.
template <std::floating_point Scalar>
std::uint32_t Bvh<Scalar>::level_of(std::uint32_t node, std::uint32_t above) const {
  std::uint32_t depth = 1;
  for (; node != above; node = arrays_.parent[node]) ++depth;
  return depth;
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
    refresh_degradation<Scalar>(degradation_, nodes(), slot, settings_);
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
  for_each_node(nodes(), 0, [&](std::uint32_t, std::uint32_t depth) { deepest = std::max(deepest, depth); });
  return deepest;
}

template <std::floating_point Scalar>
std::string Bvh<Scalar>::validate(Boxes boxes) const {
  if (std::string defect = find_defect(arrays_, boxes); !defect.empty()) return defect;
  if (std::string defect = check_objects(); !defect.empty()) return defect;
  return check_degradation();
}

}  // namespace dcem
