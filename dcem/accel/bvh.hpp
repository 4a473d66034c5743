#pragma once
/// Binary tree of boxes: the structure in which rays, segments and regions find primitives.
///
/// The tree knows boxes and primitive numbers only. Queries hand each primitive whose own box qualifies to a callback;
/// so a query's answer depends on the boxes alone, never on the shape of the tree, and equals that of `BruteForce`.
/// A primitive's box must hold everything its callback can report, rounding included.
#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "dcem/accel/binary/arrays.hpp"
#include "dcem/accel/binary/node.hpp"
#include "dcem/accel/binary/refit.hpp"
#include "dcem/accel/binary/sah_builder.hpp"
#include "dcem/accel/binary/sah_settings.hpp"
#include "dcem/accel/binary/subtree_degradation.hpp"
#include "dcem/accel/binary/traversal.hpp"
#include "dcem/accel/binary/validate.hpp"
#include "dcem/accel/counters.hpp"
#include "dcem/accel/detail/box_check.hpp"
#include "dcem/accel/sah_cost.hpp"
#include "dcem/geometry/aabb.hpp"
#include "dcem/geometry/ray.hpp"

namespace dcem {

/// Boxes are passed in full to every edit, indexed by primitive. Edits throw std::invalid_argument, before anything
/// changes, for boxes with NaN, infinity or corners beyond 1e15 m, and for numbers out of range. Empty boxes are
/// allowed and never met. Queries may run on several threads at once, edits may not.
template <std::floating_point Scalar>
class Bvh {
 public:
  using Box = Aabb<Scalar>;
  using Boxes = std::span<const Box>;

  // Building.

  /// A new tree over all boxes; primitive i is box i.
  void build(Boxes boxes, const SahSettings& settings = {});

  /// The same, where primitives [object_first[i], object_first[i+1]) are object i, such as one object, and the last
  /// object ends with the boxes. Every object owns a subtree; a tree over the objects joins them. The first object
  /// starts at 0.
  void build_objects(Boxes boxes, std::span<const std::uint32_t> object_first, const SahSettings& settings = {});
  /// Builds everything anew, with the objects and settings of the last build.
  void rebuild(Boxes boxes);

  /// Builds the tree below one node anew over the primitives it holds, with their present boxes. Nodes elsewhere keep
  /// their slots and contents, except that ancestors are refitted if the node's box has become another. Above object
  /// roots, objects stay objects.
  void rebuild_subtree(std::uint32_t node, Boxes boxes);

  /// Builds the nodes below one node anew, but only those of its own level: above object roots the tree over the
  /// objects, each object's own tree staying as it is and only put elsewhere; inside an object the same as
  /// rebuild_subtree.
  void rebuild_level(std::uint32_t node, Boxes boxes) {
    require_boxes(boxes);
    require_node(node);
    lies_in_object(node) ? rebuild_subtree(node, boxes) : rebuild_above_objects(node);
  }

  // Following motion.

  /// Takes over the boxes of `moved_primitives` and makes all boxes above them exactly tight again. Repeated and
  /// unmoved primitives are harmless. Allocates nothing.
  RefitReport refit(std::span<const std::uint32_t> moved_primitives, Boxes boxes);

  /// The same for every primitive.
  RefitReport refit_all(Boxes boxes);

  // Queries. `counters`, when given, is added to.

  /// The closest hit: calls `leaf(primitive, t_max)` for primitives whose box the ray meets up to t_max, which
  /// starts as the ray's and which the callback lowers to the t of each nearer hit. Near boxes come first, a box that
  /// only touches t_max is still reported. The order among equals is open: a callback that wants one answer on a tie
  /// must choose it by itself at equal t, for instance the lower primitive.
  template <class Leaf>
  void closest(const Ray<Scalar>& ray, Leaf&& leaf, TraversalCounters* counters = nullptr) const {
    const TraversalCounters spent = detail::walk_closest(arrays_, ray, leaf);
    if (counters != nullptr) *counters += spent;
  }

  /// Calls `leaf(primitive) -> bool` for primitives whose box the ray meets, in no promised order, until one returns
  /// true. Returns whether one did.
  template <class Leaf>
  bool any(const Ray<Scalar>& ray, Leaf&& leaf, TraversalCounters* counters = nullptr) const {
    const SlabTest<Scalar> slab(ray);
    return walk([&](const Box& box) { return slab.meets(box, slab.t_max()); }, leaf, counters);
  }

  /// Calls `leaf(primitive)` once for every primitive whose box the ray meets.
  template <class Leaf>
  void all(const Ray<Scalar>& ray, Leaf&& leaf, TraversalCounters* counters = nullptr) const {
    const SlabTest<Scalar> slab(ray);
    visit([&](const Box& box) { return slab.meets(box, slab.t_max()); }, leaf, counters);
  }

  /// Calls `leaf(primitive)` once for every primitive whose box has a point in common with `box`.
  template <class Leaf>
  void overlapping(const Box& box, Leaf&& leaf, TraversalCounters* counters = nullptr) const {
    visit([region = canonical_box(box)](const Box& held) { return region.overlaps(held); }, leaf, counters);
  }

  /// Calls `leaf(primitive)` once for every primitive with a non-empty box for which `keep_box(box) -> bool` holds.
  /// It must hold for every box that contains a box for which it holds: half spaces, frusta, beams.
  template <class Keep, class Leaf>
  void visit(Keep&& keep_box, Leaf&& leaf, TraversalCounters* counters = nullptr) const {
    const auto go_on = [&](std::uint32_t primitive) {
      leaf(primitive);
      return false;
    };
    walk([&](const Box& box) { return !box.empty() && keep_box(box); }, go_on, counters);
  }

  // Looking inside.

  std::size_t primitive_count() const { return arrays_.order.size(); }
  Box bounds() const { return arrays_.empty() ? Box{} : arrays_.nodes[0].box; }

  /// Root of the subtree that an object owns, no_node for an empty object. Valid until the next build or rebuild.
  std::uint32_t object_root(std::size_t object) const { return object_root_.at(object); }
  std::size_t object_count() const { return object_root_.size(); }

  /// Whether a node belongs to the tree of one object; otherwise it lies above object roots.
  bool lies_in_object(std::uint32_t node) const;

  /// Calls `visit(slot)` for a node and for every node below it of the same level, parents before children.
  template <class Visit>
  void for_each_in_level(std::uint32_t node, Visit&& visit) const {
    std::vector<std::uint32_t> level{node};
    for (std::size_t index = 0; index < level.size(); ++index) {
      const BvhNode<Scalar> held = arrays_.nodes[level[index]];
      visit(level[index]);
      if (held.is_leaf()) continue;
      for (const std::uint32_t child : {held.left(), held.right()}) {
        if (!degradation_[child].is_object_root) level.push_back(child);
      }
    }
  }

  /// All slots, also unused ones; the root is slot 0.
  std::span<const BvhNode<Scalar>> nodes() const { return arrays_.nodes; }
  const BvhArrays<Scalar>& arrays() const { return arrays_; }
  const SahSettings& settings() const { return settings_; }

  /// Levels from the root to the deepest leaf: 0 without primitives, 1 for a single leaf. Walks the whole tree.
  std::uint32_t depth() const;

  /// Expected cost of a long random ray by the surface-area heuristic, no unit; from a sum that every edit keeps.
  double sah_cost() const {
    return arrays_.empty() ? 0.0
                           : sah_from_area(degradation_[0].weighted_area_m2, static_cast<double>(bounds().half_area()));
  }
  BvhQuality quality() const { return {sah_cost(), sah_at_build_}; }
  /// What is known of the subtree below a node: kept by every edit.
  const SubtreeDegradation& degradation(std::uint32_t node) const { return degradation_.at(node); }
  /// The nodes above the primitives of the last refit, children before parents.
  std::span<const std::uint32_t> last_refit() const { return last_refit_; }

  /// A sentence about the first broken invariant, empty when all hold. `boxes` are the primitives' boxes as they are
  /// now: a tree that was not told of a motion is defective.
  std::string validate(Boxes boxes) const;

 private:
  template <class Meets, class Visit>
  bool walk(Meets&& meets, Visit& visit, TraversalCounters* counters) const {
    TraversalCounters spent;
    const bool stopped = detail::walk_any(arrays_, meets, visit, spent);
    if (counters != nullptr) *counters += spent;
    return stopped;
  }

  void require_node(std::uint32_t node) const {
    if (node < arrays_.nodes.size() && arrays_.parent[node] != free_slot) return;
    throw std::invalid_argument("node " + std::to_string(node) + " is not in the tree");
  }
  void require_boxes(Boxes boxes) const {
    if (boxes.size() != primitive_count()) throw std::invalid_argument("one box per primitive of the tree is needed");
  }
  std::uint32_t object_at(std::size_t position) const;
  std::uint32_t level_of(std::uint32_t node, std::uint32_t above) const;
  void grow_objects(std::uint32_t slot, std::span<const std::uint32_t> objects, Boxes boxes, std::uint32_t levels);
  void grow_range(std::uint32_t slot, std::size_t begin, std::size_t end, Boxes boxes, std::uint32_t levels);
  void rebuild_below(std::uint32_t node, Boxes boxes);
  void rebuild_above_objects(std::uint32_t node);
  std::uint32_t first_position(std::uint32_t node) const;
  void insert_object(std::uint32_t slot, std::uint32_t object, const BvhNode<Scalar>& root,
                     const SubtreeDegradation& degradation);
  void begin_degradation_below(std::uint32_t node);
  void begin_degradation_above_objects(std::uint32_t node);
  void refresh_degradation_above(std::uint32_t node);
  RefitReport sweep_dirty();
  bool tighten(std::uint32_t slot);
  bool take_over(std::uint32_t primitive, const Box& box);
  std::string check_objects() const;
  std::string check_degradation() const;

  BvhArrays<Scalar> arrays_;
  SahSettings settings_;
  std::vector<std::uint32_t> object_first_;  ///< positions; one more entry than objects
  std::vector<std::uint32_t> object_root_;
  std::vector<SubtreeDegradation> degradation_;  ///< per slot
  double sah_at_build_ = 0.0;
  DirtyPaths dirty_;
  std::vector<std::uint32_t> last_refit_;
};

}  // namespace dcem

#include "dcem/accel/binary/edits.hpp"
#include "dcem/accel/binary/levels.hpp"
