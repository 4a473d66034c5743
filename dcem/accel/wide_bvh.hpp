#pragma once
/// Tree of eight children a node over triangles: the fast one. Boxes and first tests are in single precision and never
/// decide against double precision, so that its answers are those of `BruteForce`.
///
/// Objects own subtrees that edits take as a whole; what moves is followed in place, without allocation.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "dcem/accel/counters.hpp"
#include "dcem/accel/detail/box_check.hpp"
#include "dcem/accel/hit_filter.hpp"
#include "dcem/accel/sah_cost.hpp"
#include "dcem/accel/wide/arrays.hpp"
#include "dcem/accel/wide/trace/kernels.hpp"
#include "dcem/accel/wide/update/degradation.hpp"
#include "dcem/accel/wide/update/loose_nodes.hpp"
#include "dcem/accel/wide/validate.hpp"
#include "dcem/geometry/aabb.hpp"
#include "dcem/geometry/ray.hpp"
#include "dcem/geometry/triangle_view.hpp"

namespace dcem {

class ThreadPool;

namespace detail {
class WidePlan;
struct WideRotation;
}  // namespace detail

/// What following a motion took.
struct WideRefitReport {
  std::size_t leaves_written = 0;
  std::size_t nodes_visited = 0;
};

/// Boxes and triangles are passed in full to every edit, indexed by triangle; a triangle with an empty box is not
/// there, any other box is that around its corners. Edits throw std::invalid_argument, before anything changes, for bad
/// boxes (see Bvh) and numbers out of range. Queries may run on several threads at once, edits may not.
class WideBvh {
 public:
  using Boxes = std::span<const Aabb<double>>;

  // Building.

  /// A new tree. Triangles [object_first[i], object_first[i + 1]) are object i, the last object ends with the
  /// triangles. Groups of up to WideBuildSettings::object_subtree_limit quads own a subtree.
  void build_objects(const TriangleView& mesh, Boxes boxes, std::span<const std::uint32_t> object_first,
                     const WideBuildSettings& settings = {});
  void build(const TriangleView& mesh, Boxes boxes, const WideBuildSettings& settings = {}) {
    const std::uint32_t whole = 0;
    build_objects(mesh, boxes, {&whole, 1}, settings);
  }
  /// Builds everything anew, with the objects, the quads and the settings of the last build; the triangles must have
  /// the vertices that they had then.
  void rebuild(const TriangleView& mesh, Boxes boxes);

  // Following motion.

  /// Takes over the corners of the triangles in `moved`, and which of them are there, and makes all boxes above them
  /// tight again. Vertices may move in any way; which vertices a triangle has stays as it was built. `moved` names
  /// every triangle of which a corner has moved. Allocates nothing once the lists have grown. Where very many have
  /// moved, the threads of `pool` share the work; the tree is the same.
  WideRefitReport refit(std::span<const std::uint32_t> moved, const TriangleView& mesh, Boxes boxes,
                        ThreadPool* pool = nullptr);

  /// Takes objects out of the tree that the last refit moved, and inserts each where it costs least (branch and bound
  /// over Σ cost · surface: Bittner, Hapala, Havran, "Fast insertion-based optimization of bounding volume
  /// hierarchies", Computer Graphics Forum 2013): those that make the node above them larger than `growth_limit`
  /// times what it was when they came there, and of all one in `turn_length`, in turn (0: none). Growth alone misses
  /// what has become a bad place little by little, or by what others do. Of very many, groups are taken out at once and
  /// the threads of `pool` look for their places; the tree is the same for any of them. Returns how many were moved.
  std::size_t reinsert_moved(double growth_limit, std::uint32_t turn_length = default_turn_length,
                             ThreadPool* pool = nullptr);
  static constexpr std::uint32_t default_turn_length = 50;

  /// Builds what is below an inner node anew, in place, from the boxes as they are now: the node's part of its level
  /// (wide/levels.hpp), of which leaves and objects are the leaves; node 0 is all but those. Where the result would lie
  /// too deep, more is built anew, from a node above on. Returns how many nodes were written: none where Σ cost ·
  /// surface below the node would not fall below `wanted_share` of what it is (above 0; infinity: whatever it will be);
  /// the node's degradation is then counted from now on.
  std::size_t rebuild_subtree(std::uint32_t node, double wanted_share = std::numeric_limits<double>::infinity());

  /// Exchanges children around the nodes that edits have touched since the last call, where Σ cost · surface falls (see
  /// update/rotation.hpp), up to so many a node. Needs `watch`. Returns how many children changed their place.
  std::size_t rotate_touched(std::uint32_t most_per_node = 1);

  // Degradation (see degradation.hpp).

  /// Says what is noted from now on. What is tracked anew counts as built now.
  void watch(const TrackedMeasures& tracked) { degradation_.watch(tracked, arrays_); }
  const TrackedMeasures& tracked() const { return degradation_.tracked(); }
  /// Brings the measures up to date along the paths that edits have touched. Returns the nodes on them, children before
  /// parents; valid until the next call.
  std::span<const std::uint32_t> measure() {
    degradation_.refresh(arrays_);
    return degradation_.refreshed();
  }
  /// Per node, as of the last `measure` or `rebuild_subtree`; empty where no measure is tracked. Meaningless for nodes
  /// that are not in use.
  std::span<const Degradation> degradation() const { return degradation_.all(); }

  // Queries, as `SpatialIndex` has them. `counters`, when given, is added to.

  /// The closest hit from t_min to t_max that passes the filter; of equally near ones that on the triangle with the
  /// smallest number. t is exact_hit_t, whatever the tree looks like.
  std::optional<TriangleHit> closest_hit(const Ray<double>& ray, const HitFilter& filter = {},
                                         TraversalCounters* counters = nullptr) const {
    // Counted where the caller wants it: a sum that is added at the end would be read before it is all written.
    TraversalCounters unwanted;
    return detail::wide_kernels().closest_hit(arrays_, ray, filter, counters != nullptr ? *counters : unwanted);
  }

  /// The same for each of many rays, which is faster. Rays from one point are faster still where those that point in
  /// similar directions follow one another. Throws std::invalid_argument where there is not one place for each answer.
  void closest_hits(std::span<const RayQuery> queries, std::span<std::optional<TriangleHit>> hits,
                    TraversalCounters* counters = nullptr) const {
    if (queries.size() != hits.size()) throw std::invalid_argument("closest_hits: one place for each ray is needed");
    TraversalCounters unwanted;
    detail::wide_kernels().closest_hits(arrays_, queries, hits, counters != nullptr ? *counters : unwanted);
  }
  /// The same for the rays of a fan, which is faster than to ask for each with a filter of its own. Throws as well.
  void closest_hits(const RayFan& fan, std::span<std::optional<TriangleHit>> hits,
                    TraversalCounters* counters = nullptr) const {
    if (fan.directions.size() != hits.size()) {
      throw std::invalid_argument("closest_hits: one place for each ray is needed");
    }
    TraversalCounters unwanted;
    detail::wide_kernels().closest_hits_of_fan(arrays_, fan, hits, counters != nullptr ? *counters : unwanted);
  }

  /// Whether there is a hit from t_min to t_max that passes the filter.
  bool occluded(const Ray<double>& ray, const HitFilter& filter = {}, TraversalCounters* counters = nullptr) const {
    TraversalCounters unwanted;
    return detail::wide_kernels().occluded(arrays_, ray, filter, counters != nullptr ? *counters : unwanted);
  }

  /// Calls `visit(hit) -> bool` for each hit from t_min to t_max that passes the filter, in no promised order, until
  /// one returns true. Returns whether one did.
  template <typename Visit>
  bool visit_hits(const Ray<double>& ray, const HitFilter& filter, Visit&& visit,
                  TraversalCounters* counters = nullptr) const {
    using Visitor = std::remove_reference_t<Visit>;
    const detail::HitVisitor visitor{
        [](void* context, const TriangleHit& hit) -> bool { return (*static_cast<Visitor*>(context))(hit); },
        const_cast<void*>(static_cast<const void*>(&visit))};
    TraversalCounters unwanted;
    return detail::wide_kernels().visit_hits(arrays_, ray, filter, visitor, counters != nullptr ? *counters : unwanted);
  }

  /// Calls `visit(triangle)` once for every triangle whose box has a point in common with `box`.
  template <typename Visit>
  void overlapping(const Aabb<double>& box, Visit&& visit, TraversalCounters* counters = nullptr) const;

  /// Calls `visit(triangle)` once for every triangle with a box for which `keep(box) -> bool` holds. It must hold for
  /// every box that contains a box for which it holds: half spaces, frusta, beams.
  template <typename Keep, typename Visit>
  void visit(Keep&& keep, Visit&& visit, TraversalCounters* counters = nullptr) const;

  // Looking inside.

  std::size_t primitive_count() const { return arrays_.triangles.size(); }
  std::size_t object_count() const { return object_first_.size(); }
  Aabb<double> bounds() const { return in_world(root_box()); }
  const WideArrays& arrays() const { return arrays_; }
  const WideBuildSettings& settings() const { return settings_; }

  /// Expected cost of a long random ray by the surface-area heuristic, no unit; from a sum that every edit keeps.
  double sah_cost() const {
    const double root_m2 = static_cast<double>(root_box().half_area());
    return sah_from_area(arrays_.weighted_area_m2 + arrays_.costs.node * root_m2, root_m2);
  }
  BvhQuality quality() const { return {sah_cost(), sah_at_build_}; }

  /// A sentence about the first broken promise, empty when all are kept. `boxes`: the triangles' boxes as they are now.
  std::string validate(Boxes boxes) const;

 private:
  Aabb<float> root_box() const { return arrays_.nodes.empty() ? Aabb<float>{} : arrays_.nodes[0].box(); }
  Aabb<double> in_world(const Aabb<float>& box) const;

  /// What differences of coordinates in the tree may lose.
  double lost_m() const;

  template <typename Children, typename Quads, typename Keep, typename Visit>
  void visit_where(Children&& children, Quads&& quads, Keep&& keep, Visit&& visit, TraversalCounters* counters) const;

  static void require_input(const TriangleView& mesh, Boxes boxes);
  static void require_corners(const TriangleView& mesh, std::uint32_t triangle);
  void build_all(const TriangleView& mesh, Boxes boxes);
  void look_at_boxes(std::span<const std::uint32_t> moved, Boxes boxes, ThreadPool* pool);
  static bool are_plain(std::span<const std::uint32_t> moved, Boxes boxes);
  bool are_plain(std::span<const std::uint32_t> moved, Boxes boxes, ThreadPool& pool);
  void write_dirty_leaves(std::span<const Vec3> from_m, WideRefitReport& report);
  void write_dirty_leaves(std::span<const Vec3> from_m, WideRefitReport& report, ThreadPool& pool);
  void take_leaf(std::uint32_t leaf, const Aabb<float>& box);
  void mark_dirty(std::span<const std::uint32_t> moved);
  void note_moved_object(std::uint32_t object);
  bool reinsert(std::uint32_t object);
  std::size_t reinsert_together(std::span<const std::uint32_t> objects, ThreadPool* pool);
  std::uint32_t detach(NodeLane place);
  /// A node where something might be inserted, and what the nodes down to it would grow by.
  struct Branch {
    double cost_m2;
    std::uint32_t node;
    std::uint32_t depth;                                                           ///< of the node, 1 for the root
    bool operator<(const Branch& other) const { return cost_m2 > other.cost_m2; }  // the cheapest on top
  };
  struct Spot {
    double cost_m2 = std::numeric_limits<double>::infinity();
    std::uint32_t node = 0;
    std::uint32_t lane = simd_lanes;  ///< of a free lane; or of the entry to join, with `joins`
    bool joins = false;
  };
  /// An object that has been taken out, where it may go, and what was there when that was found out.
  struct LooseObject {
    std::uint32_t object;
    Aabb<float> box;
    Spot spot{};
    WideChild there{};
  };
  void find_spots(std::span<LooseObject> objects, ThreadPool* pool) const;
  /// `branches`: scratch memory.
  Spot cheapest_spot(const Aabb<float>& box, std::vector<Branch>& branches) const;
  void offer_spots(const Branch& branch, const Aabb<float>& box, std::vector<Branch>& branches, Spot& best) const;
  void insert(std::uint32_t object, const Aabb<float>& box, const Spot& spot);
  void attach_at(WideChild child, const Aabb<float>& box, const Spot& spot);
  void release_below(std::uint32_t node);
  std::size_t build_planned(std::uint32_t node, const detail::WidePlan& plan, std::uint32_t slot);
  std::size_t attach_planned(NodeLane place, const detail::WidePlan& plan, std::uint32_t slot);
  void remember_inserted(std::uint32_t node);
  void sum_anew();
  std::size_t rotate_below(std::uint32_t node, std::uint32_t depth, std::uint32_t most_per_node);
  void carry_out(const detail::WideRotation& rotation, std::uint32_t node);
  void remember_inserted(WideChild child);

  /// Memory for plans of parts to be built anew. Nothing in it outlives the edit that it is made for: a copy begins
  /// without.
  class PlanRoom {
   public:
    PlanRoom();
    PlanRoom(const PlanRoom& other);
    PlanRoom(PlanRoom&& other) noexcept;
    PlanRoom& operator=(const PlanRoom& other);
    PlanRoom& operator=(PlanRoom&& other) noexcept;
    ~PlanRoom();
    detail::WidePlan& plan();

   private:
    std::unique_ptr<detail::WidePlan> plan_;
  };

  WideArrays arrays_;
  WideBuildSettings settings_;
  std::vector<std::uint32_t> object_first_;
  std::vector<Quad> quads_;                ///< by object
  std::vector<std::uint32_t> first_quad_;  ///< one more entry than objects
  double sah_at_build_ = 0.0;

  detail::LooseNodes loose_nodes_;
  std::vector<std::uint32_t> dirty_leaves_;
  std::vector<char> leaf_is_dirty_, is_there_now_;
  // Where threads share the work:
  std::vector<Aabb<float>> dirty_boxes_;  ///< of these leaves, as they are now
  std::vector<char> block_is_plain_;
  std::vector<std::uint32_t> moved_objects_;
  std::vector<char> object_is_moved_;
  std::vector<float>
      area_when_inserted_m2_;  ///< per object: half surface of the node around, when the object came there
  std::vector<Branch> branches_;
  std::size_t next_turn_ = 0;
  detail::DegradationLog degradation_;
  PlanRoom plan_room_;
};

}  // namespace dcem

#include "dcem/accel/wide/box_queries.hpp"

#if !defined(DCEM_ENGINE)
#include "dcem/accel/wide_bvh_bodies.hpp"
#include "dcem/accel/wide_bvh_rebuild_bodies.hpp"
#include "dcem/accel/wide_bvh_refit_bodies.hpp"
#include "dcem/accel/wide_bvh_rotate_bodies.hpp"
#endif
