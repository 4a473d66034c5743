#pragma once
/// The oracle: every query of `Bvh`, answered by asking each box in turn.
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "dcem/accel/binary/node.hpp"
#include "dcem/accel/binary/refit.hpp"
#include "dcem/accel/binary/sah_settings.hpp"
#include "dcem/accel/binary/slab_test.hpp"
#include "dcem/accel/counters.hpp"
#include "dcem/accel/detail/box_check.hpp"
#include "dcem/accel/sah_cost.hpp"
#include "dcem/accel/tree_settings.hpp"
#include "dcem/geometry/aabb.hpp"
#include "dcem/geometry/ray.hpp"

namespace dcem {

/// Same members, same meaning and same errors as `Bvh`; see there. Primitives are asked in ascending order.
template <std::floating_point Scalar>
class BruteForce {
 public:
  using Box = Aabb<Scalar>;
  using Boxes = std::span<const Box>;

  void build(Boxes boxes, const SahSettings& settings = {}) {
    const std::uint32_t whole = 0;
    build_objects(boxes, {&whole, 1}, settings);
  }
  void build_objects(Boxes boxes, std::span<const std::uint32_t> object_first, const SahSettings& settings = {}) {
    require_valid_settings(settings);
    require_valid_boxes(boxes);
    require_valid_objects(object_first, boxes.size());
    settings_ = settings;
    object_count_ = object_first.size();
    boxes_.assign(boxes.begin(), boxes.end());
    for (Box& box : boxes_) box = canonical_box(box);
  }
  /// Takes over all boxes: there are no subtrees, the one node holds everything.
  void rebuild_subtree(std::uint32_t node, Boxes boxes) {
    if (node != 0 || boxes_.empty()) throw std::invalid_argument("the only node is 0");
    refit_all(boxes);
  }

  RefitReport refit(std::span<const std::uint32_t> moved_primitives, Boxes boxes) {
    require_boxes(boxes);
    for (const std::uint32_t primitive : moved_primitives) {
      if (primitive >= boxes.size()) throw std::invalid_argument("primitive " + std::to_string(primitive) + " of none");
      require_valid_box(boxes[primitive], primitive);
    }
    for (const std::uint32_t primitive : moved_primitives) boxes_[primitive] = canonical_box(boxes[primitive]);
    return {};
  }
  RefitReport refit_all(Boxes boxes) {
    require_boxes(boxes);
    require_valid_boxes(boxes);
    for (std::size_t primitive = 0; primitive < boxes.size(); ++primitive) {
      boxes_[primitive] = canonical_box(boxes[primitive]);
    }
    return {};
  }

  template <class Leaf>
  void closest(const Ray<Scalar>& ray, Leaf&& leaf, TraversalCounters* counters = nullptr) const {
    const SlabTest<Scalar> slab(ray);
    Scalar t_max = slab.t_max();
    const auto ask = [&](std::uint32_t primitive) {
      leaf(primitive, t_max);
      return false;
    };
    loop([&](const Box& box) { return slab.meets(box, t_max); }, ask, counters);
  }
  template <class Leaf>
  bool any(const Ray<Scalar>& ray, Leaf&& leaf, TraversalCounters* counters = nullptr) const {
    const SlabTest<Scalar> slab(ray);
    return loop([&](const Box& box) { return slab.meets(box, slab.t_max()); }, leaf, counters);
  }
  template <class Leaf>
  void all(const Ray<Scalar>& ray, Leaf&& leaf, TraversalCounters* counters = nullptr) const {
    const SlabTest<Scalar> slab(ray);
    visit([&](const Box& box) { return slab.meets(box, slab.t_max()); }, leaf, counters);
  }
  template <class Leaf>
  void overlapping(const Box& box, Leaf&& leaf, TraversalCounters* counters = nullptr) const {
    visit([region = canonical_box(box)](const Box& held) { return region.overlaps(held); }, leaf, counters);
  }
  template <class Keep, class Leaf>
  void visit(Keep&& keep_box, Leaf&& leaf, TraversalCounters* counters = nullptr) const {
    const auto go_on = [&](std::uint32_t primitive) {
      leaf(primitive);
      return false;
    };
    loop([&](const Box& box) { return !box.empty() && keep_box(box); }, go_on, counters);
  }

  std::size_t primitive_count() const { return boxes_.size(); }
  Box bounds() const {
    Box bounds;
    for (const Box& box : boxes_) bounds.extend(box);
    return bounds;
  }
  std::size_t object_count() const { return object_count_; }
  std::uint32_t object_root(std::size_t object) const {
    if (object >= object_count_) throw std::out_of_range("no such object");
    return no_node;
  }
  std::span<const BvhNode<Scalar>> nodes() const { return {}; }
  std::uint32_t depth() const { return boxes_.empty() ? 0 : 1; }
  /// Every ray asks every primitive.
  double sah_cost() const {
    return bounds().half_area() > 0 ? settings_.intersection_cost * static_cast<double>(boxes_.size()) : 0.0;
  }
  BvhQuality quality() const { return {sah_cost(), sah_cost()}; }

  std::string validate(Boxes boxes) const {
    if (boxes.size() != boxes_.size()) return "the number of boxes is another";
    for (std::size_t primitive = 0; primitive < boxes.size(); ++primitive) {
      if (boxes_[primitive] != canonical_box(boxes[primitive])) {
        return "the stored box of primitive " + std::to_string(primitive) + " is not its box";
      }
    }
    return {};
  }

 private:
  template <class Meets, class Visit>
  bool loop(Meets&& meets, Visit& visit, TraversalCounters* counters) const {
    TraversalCounters spent;
    bool stopped = false;
    for (std::uint32_t primitive = 0; primitive < boxes_.size() && !stopped; ++primitive) {
      if (!meets(boxes_[primitive])) continue;
      ++spent.primitives_tested;
      stopped = visit(primitive);
    }
    if (counters != nullptr) *counters += spent;
    return stopped;
  }

  void require_boxes(Boxes boxes) const {
    if (boxes.size() != boxes_.size()) throw std::invalid_argument("one box per primitive of the tree is needed");
  }

  std::vector<Box> boxes_;
  SahSettings settings_;
  std::size_t object_count_ = 0;
};

/// The oracle has no shape that could degrade.
template <std::floating_point Scalar>
class BruteForceUpdater {
 public:
  explicit BruteForceUpdater(const TreeUpdateSettings& settings = {}) { validate(settings); }

  TreeUpdateReport update(BruteForce<Scalar>& tree, std::span<const std::uint32_t> moved,
                          typename BruteForce<Scalar>::Boxes boxes) const {
    tree.refit(moved, boxes);
    TreeUpdateReport report;
    report.sah_cost = report.sah_cost_at_build = tree.sah_cost();
    return report;
  }
};

}  // namespace dcem
