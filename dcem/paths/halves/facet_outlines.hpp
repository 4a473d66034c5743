#pragma once
/// What the exact search asks of the facets of a scene: where they lie, what they hide, and in which order they come
/// from a point.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "dcem/core/fetch.hpp"
#include "dcem/geometry/aabb.hpp"
#include "dcem/paths/halves/cone.hpp"
#include "dcem/paths/halves/facet_feet.hpp"
#include "dcem/paths/halves/facet_joints.hpp"
#include "dcem/paths/halves/hull_sides.hpp"
#include "dcem/paths/halves/plane_index.hpp"
#include "dcem/scene/scene.hpp"

namespace dcem {

namespace detail {

/// Facets that stray no farther from their plane are flat: 2 µm from 13 cm away are 0.002 of a pixel.
inline constexpr double flat_facet_m = 2e-6;

}  // namespace detail

/// A facet as the exact search sees it. Its plane is that of the `WorldFacet`.
struct FacetOutline {
  Aabb<double> box;
  double stray_m = 0.0;     ///< how far its triangles leave its plane
  double lift_m = 0.0;      ///< what is no farther from its plane does not hide it: legs ignore it there
  bool fills_hull = false;  ///< its triangles are its convex hull, without holes or dents
  bool is_joined = false;   ///< and without gaps where they stray from its plane
  std::uint32_t first_side = 0, side_count = 0;
};

/// Whether a facet hides what its hull does, moved in by what it strays.
inline bool hides_as_hull(const FacetOutline& outline) {
  constexpr double most_stray_m = 1e-3;
  return outline.fills_hull && outline.is_joined && outline.stray_m <= most_stray_m;
}

/// The outlines of all facets, and a binary tree of boxes over those of the standing scenery; each other body has one
/// box.
class FacetOutlines {
 public:
  /// Those of one body that is not the scenery: a run of facets.
  struct BodyFacets {
    Aabb<double> box;  ///< empty while the body is not there
    std::uint32_t first = 0, count = 0;
  };

  explicit FacetOutlines(const Scene& scene);

  /// Follows bodies that have moved, come or gone.
  void update(const Scene& scene, std::span<const BodyId> moved);

  const FacetOutline& of(FacetId facet) const { return outlines_[facet.value]; }
  /// A facet that is soon looked at.
  [[gnu::always_inline]] void fetch(const Scene& scene, FacetId facet) const {
    dcem::fetch(scene.facet(facet));
    dcem::fetch(of(facet));
  }
  /// In the middle of the scenery: from here the exact search counts in single precision.
  const Vec3& middle_m() const { return middle_m_; }
  std::size_t size() const { return outlines_.size(); }
  /// All bodies but the scenery.
  std::span<const BodyFacets> bodies() const { return bodies_; }
  /// Calls `visit(body)` for the bodies, the scenery not among them, that a cone may reach; it counts from the middle.
  template <typename Visit>
  void for_each_body_in(std::span<const HalfSpace> cone, Visit&& visit) const {
    body_clusters_.for_each_item_in(cone, [&](std::uint32_t item) { visit(bodies_there_[item]); });
  }
  std::span<const HullSide> sides(FacetId facet) const {
    return std::span(sides_).subspan(outlines_[facet.value].first_side, outlines_[facet.value].side_count);
  }

  /// Those that meet a facet along a vertical line and have a higher number.
  std::span<const FacetJoint> joints(FacetId facet) const { return joints_.of(facet); }

  /// Those that stand on the lowest level of the scenery.
  const FacetFeet& feet() const { return feet_; }

  /// Whether a point of a facet's plane is over its hull, or no farther from it than `margin_m`.
  bool is_over(FacetId facet, const Vec3& point_m, double margin_m) const {
    const auto inside = [&](const HullSide& side) {
      return glm::dot(side.normal, point_m) >= side.offset_m - margin_m;
    };
    const std::span<const HullSide> all = sides(facet);
    return std::all_of(all.begin(), all.end(), inside);
  }

  /// The planes of the facets of the scenery, with their lifts.
  const PlaneIndex& planes() const { return planes_; }

  /// Calls `visit(facet)` for all facets of the scenery but those in boxes of which `hidden(box)` is true when their
  /// turn comes: boxes near to the point come before those behind them.
  template <typename Hidden, typename Visit>
  void visit_from(const Scene& scene, const Vec3& point_m, Hidden&& hidden, Visit&& visit) const {
    if (nodes_.empty()) return;
    std::vector<Waiting> waiting{{distance_squared(nodes_[0].box, point_m), 0}};
    const auto push = [&](std::uint32_t node) {
      waiting.push_back({distance_squared(nodes_[node].box, point_m), node});
      std::push_heap(waiting.begin(), waiting.end());
    };
    while (!waiting.empty()) {
      std::pop_heap(waiting.begin(), waiting.end());
      const std::uint32_t number = waiting.back().node;
      const Node& node = nodes_[number];
      waiting.pop_back();
      if (hidden(node.box)) continue;
      if (node.right != 0) {
        push(number + 1);
        push(node.right);
      }
      // What comes next is fetched while this is looked at.
      const std::span<const FacetId> here = facets_in(node);
      const std::span<const FacetId> next =
          waiting.empty() ? std::span<const FacetId>{} : facets_in(nodes_[waiting.front().node]);
      for (const FacetId id : next) fetch(scene, id);
      for (const FacetId id : here) fetch_hull(scene, id);
      for (std::size_t at = 0; at < here.size(); ++at) {
        visit(here[at]);
        if (at > 0) continue;
        for (const FacetId id : next) fetch_hull(scene, id);
      }
    }
  }

 private:
  static constexpr std::uint32_t leaf_size = 4;

  struct Node {
    Aabb<double> box;
    std::uint32_t first = 0, count = 0;  ///< of `items_`; none at a node with children
    std::uint32_t right = 0;             ///< the second child; the first one follows the node. 0: a leaf
  };

  /// Nearest first; of equals the one with the smaller number, so that the order is that of the scene alone.
  struct Waiting {
    double distance_squared;
    std::uint32_t node;
    bool operator<(const Waiting& other) const {
      return distance_squared != other.distance_squared ? distance_squared > other.distance_squared : node > other.node;
    }
  };

  [[gnu::always_inline]] static void fetch_hull(const Scene& scene, FacetId facet) {
    dcem::fetch(scene.hull_m(scene.facet(facet)));
  }

  std::span<const FacetId> facets_in(const Node& node) const {
    return std::span(items_).subspan(node.first, node.count);
  }
  static double distance_squared(const Aabb<double>& box, const Vec3& point_m) {
    const Vec3 way_m = glm::clamp(point_m, box.min, box.max) - point_m;
    return glm::dot(way_m, way_m);
  }

  static std::uint32_t end_of_body(const Scene& scene, std::uint32_t body);
  /// Works out where a facet lies now.
  void place(const Scene& scene, std::uint32_t index);
  /// Works out what does not change when the facet moves.
  void measure(const Scene& scene, std::uint32_t index);
  void lay_out_planes(const Scene& scene);
  void fit(BodyFacets& facets) const;
  void cluster_bodies();
  /// Halves items along the longest side of the box of their centres; a node stands before its children.
  void grow(std::uint32_t first, std::uint32_t count);
  void divide(std::uint32_t first, std::uint32_t count, int axis);

  std::vector<FacetOutline> outlines_;
  std::vector<HullSide> sides_;
  std::vector<FacetId> items_;  ///< facets of the scenery, in the order of the leaves
  std::vector<Node> nodes_;     ///< the root first
  PlaneIndex planes_;
  std::vector<BodyFacets> bodies_;
  std::vector<BodyId> bodies_there_;  ///< those that are not absent …
  ConeClusters body_clusters_;        ///< … and their boxes
  FacetJoints joints_;
  FacetFeet feet_;
  Vec3 middle_m_{0.0};
  std::vector<std::pair<double, std::uint32_t>> places_;  ///< of items along an axis, while the tree grows
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/halves/facet_outlines_bodies.hpp"
#endif
