#pragma once
/// Bodies of triple_pool.hpp.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/halves/common_cone.hpp"
#include "dcem/paths/halves/edge_clusters.hpp"
#include "dcem/paths/memory/triple_pool.hpp"

namespace dcem {

/// What a step finds, and what it finds it with.
struct TriplePool::Finder {
  Finder(TriplePool& of_pool, const Scene& of_scene, const FacetOutlines& of_outlines, const LaneScene& of_lanes)
      : pool(of_pool),
        scene(of_scene),
        outlines(of_outlines),
        lanes(of_lanes),
        place(*of_pool.place_),
        beams(*place.beams()),
        reached(of_pool.reached_),
        listed(reached.tables()[BeamLists::of_scenery]),
        radius_m(static_cast<float>(place.radius_m())),
        double_images(scene, lanes) {}

  void find_part(int step) {
    const bool edges = pool.orders_.diffractions >= 1;
    if (edges) lay_out_edges();
    // Some of each neighbourhood, side by side: in some there is ten times as much to join as in others.
    constexpr std::size_t some = 256;
    const auto for_part = [&](std::size_t count, auto&& visit) {
      for (std::size_t first = some * static_cast<std::size_t>(step); first < count; first += some * steps) {
        for (std::size_t at = first; at < std::min(first + some, count); ++at) visit(static_cast<std::uint32_t>(at));
      }
    };
    for_part(scene.facets().size(), [&](std::uint32_t facet) {
      over_two_mirrors(FacetId(facet), edges);
      if (edges) edge_to_two_mirrors(FacetId(facet));
    });
    if (!edges) return;
    for_part(scene.wedges().size(), [&](std::uint32_t edge) { edge_between_mirrors(WedgeId(edge)); });
  }

  void add(SequenceElement near, SequenceElement middle, SequenceElement far) {
    pool.candidates_.push_back({near, middle, far});
  }
  bool is_of(WedgeId edge, FacetId facet) const {
    return scene.wedge(edge).facets[0] == facet || scene.wedge(edge).facets[1] == facet;
  }

  /// The edges that the place sees, as its middle does.
  void lay_out_edges() {
    std::vector<EdgePart> parts;
    for (const WedgeId id : place.scenery().edges) {
      parts.push_back(whole_edge(id.value, scene.wedge(id).edge, place.box().middle_m));
    }
    seen_edges.build(parts, lanes.origin_m(),
                     [&](const EdgePart& part) -> const Wedge& { return scene.wedge(WedgeId(part.edge)).edge; });
  }

  /// The device's last two points are on mirrors, the second of which is `middle`.
  void over_two_mirrors(FacetId middle, bool edges) {
    const bool mirrors = pool.orders_.reflections >= 3 && !listed.mirrors_before(middle).empty();
    if (!edges && !mirrors) return;
    for (const std::uint32_t at : beams.mirrors_before(middle)) {
      const PlaceMirror& near = place.mirrors()[at];
      place.find_images(scene.facet(near.facet).plane, near, images_m);
      for (const double side : {1.0, -1.0}) {
        if (!look_over(near, middle, side)) continue;
        if (mirrors) join_mirrors(near, middle);
        if (edges) join_edges(near, middle);
      }
    }
  }

  /// Works out what the images in two mirrors may see, of what of the first ones is on one side of the second mirror;
  /// false where there is nothing.
  bool look_over(const PlaceMirror& near, FacetId middle, double side) {
    const Plane& plane = scene.facet(middle).plane;
    span_beside(images_m, plane, side, beside_m);
    if (beside_m.empty()) return false;
    twice = mirrored(plane, near.image_m) - lanes.origin_m();
    common_cone_over_two(outlines.sides(middle), plane, side, beside_m, near.cone, lanes.origin_m(),
                         glm::length(twice) + lanes.reach_m(), cone);
    twice_error_m = LaneScene::error_m(2.0 * glm::length(twice) + lanes.reach_m());
    return true;
  }

  void join_mirrors(const PlaceMirror& near, FacetId middle) {
    listed.for_each_mirror_before(middle, cone, [&](std::uint32_t mirror) {
      const BeamMirror& far = reached.mirrors()[mirror];
      if (may_hold(far.cone, twice, radius_m + twice_error_m)) add(near.facet, middle, far.facet);
    });
  }

  void join_edges(const PlaceMirror& near, FacetId middle) {
    const Plane& plane = scene.facet(middle).plane;
    listed.for_each_part_before(middle, cone, twice, radius_m + twice_error_m, [&](const EdgePart& part) {
      const WedgeId id(part.edge);
      const Wedge& edge = scene.wedge(id).edge;
      if (is_of(id, middle)) return;  // that is in the wedge's own terms
      // The wedge's solid is convex: what all corners are inside of, all between them is.
      const bool faces = std::ranges::any_of(
          beside_m, [&](const Vec3& image_m) { return may_face(edge, mirrored(plane, image_m) - edge.start_m); });
      if (faces) add(near.facet, middle, id);
    });
  }

  /// The device's last point is on an edge, the two before it on mirrors of the standing end.
  void edge_to_two_mirrors(FacetId middle) {
    if (listed.mirrors_before(middle).empty() || place.scenery().edges.empty()) return;
    double_images.for_each(reached, listed, middle, seen_edges.boxes(),
                           [&](const BeamMirror& far, const Vec3& twice_m) {
                             const std::span<const HalfSpace> seen = double_images.cone(far, middle, twice_m);
                             const Vec3 from = twice_m - lanes.origin_m();
                             seen_edges.for_each_in<true>(seen, from, radius_m, [&](std::uint32_t number) {
                               const WedgeId id = place.scenery().edges[number];
                               const Wedge& edge = scene.wedge(id).edge;
                               if (is_of(id, middle) || !may_face(edge, twice_m - edge.start_m)) return;
                               add(id, middle, far.facet);
                             });
                           });
  }

  /// An edge that both ends light over a mirror each.
  void edge_between_mirrors(WedgeId edge) {
    for (const std::uint32_t at : beams.mirrors_before(edge)) {
      const PlaceMirror& near = place.mirrors()[at];
      listed.for_each_lit_part(
          edge, near.image_m - lanes.origin_m(), radius_m,
          [&](const EdgePart&, std::uint32_t mirror) { add(near.facet, edge, reached.mirrors()[mirror].facet); });
    }
  }

  TriplePool& pool;
  const Scene& scene;
  const FacetOutlines& outlines;
  const LaneScene& lanes;
  const Place& place;
  const SharedBeams& beams;
  const BeamLists& reached;
  const BeamTable& listed;
  float radius_m;
  DoubleImages double_images;
  EdgeClusters seen_edges;
  std::vector<Vec3> images_m, beside_m;  ///< in the near mirror; those of them that are looked over
  std::vector<HalfSpace> cone;           ///< of what the images in two mirrors may see
  Vec3 twice{0.0};                       ///< that of the place's middle, and how far it may be off
  float twice_error_m = 0.0F;
};

DCEM_INLINE void TriplePool::go_on(const Scene& scene, const FacetOutlines& outlines, const LaneScene& lanes) {
  const int step = steps - steps_left_;
  --steps_left_;
  if (orders_.interactions < 3 || orders_.reflections < 2) return;
  Finder(*this, scene, outlines, lanes).find_part(step);
  if (steps_left_ > 0) return;
  std::ranges::sort(candidates_);
  candidates_.erase(std::unique(candidates_.begin(), candidates_.end()), candidates_.end());
  candidates_.shrink_to_fit();
}

}  // namespace dcem
