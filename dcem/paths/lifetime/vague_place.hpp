#pragma once
/// What an end may see that is somewhere in a box: of the scenery, as a `Place` knows it, and of bodies that move.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "dcem/paths/halves/cone.hpp"
#include "dcem/paths/halves/facet_edges.hpp"
#include "dcem/paths/halves/place.hpp"
#include "dcem/paths/lifetime/vague_scene.hpp"
#include "dcem/paths/sequence.hpp"

namespace dcem {

/// Serves all links of a device, for all distances of at most its own.
class VaguePlace {
 public:
  VaguePlace(const Scene& scene, const FacetOutlines& outlines, const std::vector<BodyShape>& shapes, const Vec3& end_m,
             double moved_m, const HalfSettings& settings)
      : place_(scene, outlines, {end_m, Vec3(1.0, 0.0, 0.0), Vec3(moved_m)}, settings), moved_m_(moved_m) {
    const Vec3 origin_m = outlines.middle_m();
    const double radius_m = place_.radius_m();
    images_.build_for_items(place_.mirrors().size(), [&](std::uint32_t at) {
      const Vec3 image = place_.mirrors()[at].image_m - origin_m;
      return inflated(Aabb<double>{image, image}, radius_m);
    });
    edges_.build_for_items(place_.scenery().edges.size(), [&](std::uint32_t at) {
      const Wedge& edge = scene.wedge(place_.scenery().edges[at]).edge;
      Aabb<double> box;
      box.extend(edge.start_m - origin_m);
      box.extend(edge.end_m - origin_m);
      return box;
    });
    find_bodies(scene, outlines, VagueScene(scene, shapes, moved_m), settings);
  }

  double moved_m() const { return moved_m_; }
  const Place& place() const { return place_; }
  /// Images of the place's middle, and edges, in clusters; they count from the middle of the outlines.
  const ConeClusters& images() const { return images_; }
  const ConeClusters& edges() const { return edges_; }
  /// Whether a point of an element of the scenery, known to within some distance, is surely hidden from all of the
  /// place.
  bool hides(const Scene& scene, const FacetOutlines& outlines, SequenceElement element,
             const VaguePoint& point) const {
    const Sight& sight = place_.sight();
    const double nearer = element.is_edge() ? sight.nearer_on(scene, outlines, element.edge())
                                            : sight.nearer_on(scene, outlines, element.mirror());
    return sight.map().hides(point.at_m, nearer, Vec3(point.moved_m));
  }
  /// Facets and edges of bodies, ascending, that may be seen while bodies and the end move.
  const SeenLayer& bodies() const { return bodies_; }

 private:
  void find_bodies(const Scene& scene, const FacetOutlines& outlines, const VagueScene& vague,
                   const HalfSettings& settings) {
    for (const FacetOutlines::BodyFacets& body : outlines.bodies()) {
      if (body.box.empty()) continue;
      const bool is_hidden = place_.sight().map().hides(inflated(body.box, moved_m_), Sight::nearer_boxes);
      for (std::uint32_t index = body.first; index < body.first + body.count; ++index) {
        const FacetId id(index);
        if (scene.facet(id).present && !(is_hidden && !is_grazed(scene, outlines, vague, id)))
          bodies_.mirrors.push_back(id);
      }
    }
    if (settings.edges) collect_edges(scene, bodies_.mirrors, bodies_.edges);
    std::erase_if(bodies_.edges, [&](WedgeId id) { return !diffracts(scene.wedge(id), settings.rules); });
  }
  /// Whether the end may come so close to the plane of a facet that its legs ignore things far in front of it: as
  /// `Sight` has it for bodies that stand.
  bool is_grazed(const Scene& scene, const FacetOutlines& outlines, const VagueScene& vague, FacetId id) const {
    const Vec3 middle_m = place_.box().middle_m;
    const VaguePoint end{middle_m, place_.radius_m()};
    const double away_m =
        std::abs(signed_distance_m(scene.facet(id).plane, middle_m)) - vague.seen_moved_m(scene.facet(id).body, end);
    return away_m * Sight::longest_lift_share <= 2.0 * outlines.of(id).lift_m;
  }

  Place place_;
  double moved_m_;
  ConeClusters images_, edges_;
  SeenLayer bodies_;
};

}  // namespace dcem
