#pragma once
/// One end's half of all its paths: what the end may see, its images in the mirrors among it, and the cones behind
/// them.
///
/// A half belongs to a device in a frame and serves all its links. What moves hides nothing in it: so the scenery's
/// part is worked out once for an end that stands, and only what moves is looked at in every frame.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/paths/halves/facet_outlines.hpp"
#include "dcem/paths/halves/half_layer.hpp"
#include "dcem/paths/halves/view_map.hpp"
#include "dcem/paths/query/link_end.hpp"
#include "dcem/paths/solve/edge_rules.hpp"

namespace dcem {

/// What is the same for all halves.
struct HalfSettings {
  bool edges = true;         ///< look for edges, too
  bool sheets_hide = false;  ///< no path crosses a sheet: sheets hide as walls do
  EdgeRules rules{};
};

class PathHalf {
 public:
  /// Pixels along a side of the view map: by measurement for ends at street level.
  static constexpr int default_pixels = 256;

  explicit PathHalf(int map_pixels = default_pixels) : map_(map_pixels) {}

  /// Works out what the end may see of the scenery.
  void find_scenery(const Scene& scene, const FacetOutlines& outlines, const LinkEnd& end,
                    const HalfSettings& settings);
  /// The same of all other bodies, where they are now. The scenery must be known.
  void find_bodies(const Scene& scene, const FacetOutlines& outlines, const LinkEnd& end, const HalfSettings& settings);

  const Vec3& position_m() const { return map_.from_m(); }
  /// That of the scenery, and that of what moves.
  std::span<const HalfLayer, 2> layers() const { return layers_; }

  /// Whether the end surely cannot see a point that lies on a facet, or on an edge.
  bool hides(const Scene& scene, const FacetOutlines& outlines, FacetId facet, const Vec3& point_m) const {
    return map_.hides(point_m, nearer_on(scene, outlines, facet, 0.0));
  }
  bool hides(const Scene& scene, const FacetOutlines& outlines, WedgeId edge, const Vec3& point_m) const {
    return map_.hides(point_m, nearer_on(scene, outlines, edge));
  }

 private:
  /// A leg that grazes a mirror may ignore what lies along it for a long way. Facets for which that is more than
  /// this are looked at one by one, whatever hides the box they are in.
  static constexpr double longest_lift_m = 0.05;
  /// Triangles that leave their facet's plane by more hide as they are, not as the facet's hull. 2 µm from 13 cm away
  /// are 0.002 of a pixel.
  static constexpr double flat_m = 2e-6;

  /// By how much nearer a point of a facet or an edge counts, so that nothing that its legs ignore hides it.
  double nearer_on(const Scene& scene, const FacetOutlines& outlines, FacetId facet, double more_m) const {
    const double distance_m = std::abs(signed_distance_m(scene.facet(facet).plane, position_m()));
    const double lift_m = outlines.of(facet).lift_m + more_m;
    return distance_m > 2.0 * lift_m ? distance_m / (distance_m - lift_m) : 1e30;
  }
  double nearer_on(const Scene& scene, const FacetOutlines& outlines, WedgeId edge) const {
    const WorldWedge& wedge = scene.wedge(edge);
    return std::max(nearer_on(scene, outlines, wedge.facets[0], wedge.edge.stray_m),
                    nearer_on(scene, outlines, wedge.facets[1], wedge.edge.stray_m));
  }

  /// Whether the end grazes a facet so that some point of it, lifted, is farther in front than boxes allow for.
  bool is_lifted_far(const Scene& scene, const FacetOutlines& outlines, FacetId id) const {
    const FacetOutline& outline = outlines.of(id);
    const double distance_m = std::abs(signed_distance_m(scene.facet(id).plane, position_m()));
    const Vec3 farthest_m =
        glm::max(glm::abs(outline.box.min - position_m()), glm::abs(outline.box.max - position_m()));
    return distance_m * longest_lift_m <= outline.lift_m * glm::length(farthest_m);
  }
  bool may_see(const Scene& scene, const FacetOutlines& outlines, FacetId id, const LinkEnd& end);
  void cover(const Scene& scene, const FacetOutlines& outlines, FacetId id, const HalfSettings& settings);
  void cover_triangles(const Scene& scene, const WorldFacet& facet);
  void finish(const Scene& scene, const FacetOutlines& outlines, const LinkEnd& end, const HalfSettings& settings,
              HalfLayer& layer);

  ViewMap map_;
  std::array<HalfLayer, 2> layers_;
  std::vector<char> seen_;
};

// ---------------------------------------------------------------------------------------------------------------------

inline void PathHalf::find_scenery(const Scene& scene, const FacetOutlines& outlines, const LinkEnd& end,
                                   const HalfSettings& settings) {
  map_.look_from(end.position_m);
  for (HalfLayer& layer : layers_) layer.clear();
  seen_.assign(outlines.size(), 0);
  HalfLayer& layer = layers_[0];
  const auto look_at = [&](FacetId id) {
    if (seen_[id.value] != 0 || !may_see(scene, outlines, id, end)) return;
    seen_[id.value] = 1;
    layer.mirrors.push_back(id);
    cover(scene, outlines, id, settings);
  };
  const auto hidden = [&](const Aabb<double>& box) { return map_.hides(box, longest_lift_m); };
  outlines.visit_from(position_m(), hidden, look_at);
  for (const std::uint32_t index : outlines.scenery()) {
    if (is_lifted_far(scene, outlines, FacetId(index))) look_at(FacetId(index));
  }
  finish(scene, outlines, end, settings, layer);
}

inline void PathHalf::find_bodies(const Scene& scene, const FacetOutlines& outlines, const LinkEnd& end,
                                  const HalfSettings& settings) {
  HalfLayer& layer = layers_[1];
  layer.clear();
  for (const FacetOutlines::BodyFacets& body : outlines.bodies()) {
    if (body.box.empty()) continue;
    const bool is_hidden = map_.hides(body.box, longest_lift_m);
    for (std::uint32_t index = body.first; index < body.first + body.count; ++index) {
      const FacetId id(index);
      if (is_hidden && !is_lifted_far(scene, outlines, id)) continue;
      if (may_see(scene, outlines, id, end)) layer.mirrors.push_back(id);
    }
  }
  finish(scene, outlines, end, settings, layer);
}

inline bool PathHalf::may_see(const Scene& scene, const FacetOutlines& outlines, FacetId id, const LinkEnd& end) {
  const WorldFacet& facet = scene.facet(id);
  if (!facet.present || facet.body == end.ignored_body) return false;
  if (std::abs(signed_distance_m(facet.plane, position_m())) <= in_plane_guard_m) return false;  // no reflection there
  return map_.shows(scene.hull_m(facet), facet.plane, outlines.of(id).lift_m);
}

inline void PathHalf::cover(const Scene& scene, const FacetOutlines& outlines, FacetId id,
                            const HalfSettings& settings) {
  const WorldFacet& facet = scene.facet(id);
  const FacetOutline& outline = outlines.of(id);
  if (facet.transmits && !settings.sheets_hide) return;
  const double side = signed_distance_m(facet.plane, position_m());
  if (std::abs(side) <= 2.0 * outline.lift_m) return;  // an end that touches it looks past it
  if (outline.stray_m > flat_m) return cover_triangles(scene, facet);
  Plane plane = facet.plane;
  plane.point_m -= (side > 0.0 ? 1.0 : -1.0) * outline.stray_m * plane.normal;  // where it is farthest
  if (outline.fills_hull) return map_.cover(scene.hull_m(facet), plane);
  for (std::uint32_t triangle = 0; triangle < facet.triangle_count; ++triangle) {
    map_.cover(scene.corners_m(facet.first_triangle + triangle), plane);
  }
}

inline void PathHalf::cover_triangles(const Scene& scene, const WorldFacet& facet) {
  for (std::uint32_t triangle = 0; triangle < facet.triangle_count; ++triangle) {
    const std::array<Vec3, 3> corners_m = scene.corners_m(facet.first_triangle + triangle);
    const Vec3 normal = glm::cross(corners_m[1] - corners_m[0], corners_m[2] - corners_m[0]);
    const double size = glm::length(normal);
    if (!(size > 1e-6)) continue;  // a sliver's normal says little, and it hides little
    const Plane plane{corners_m[0], normal / size};
    if (std::abs(signed_distance_m(plane, position_m())) > 0.01) map_.cover(corners_m, plane);
  }
}

/// Adds the edges, and lays out the layer. Where a point of an edge is seen from its exterior, so is one of its faces
/// beside it: but for a third facet that touches it there, and then nothing diffracts.
inline void PathHalf::finish(const Scene& scene, const FacetOutlines& outlines, const LinkEnd& end,
                             const HalfSettings& settings, HalfLayer& layer) {
  constexpr double graze_rad = 1e-6;  // there the solver decides
  const auto out_of_reach = [&](WedgeId id) {
    const WorldWedge& wedge = scene.wedge(id);
    if (!diffracts(wedge, settings.rules) || is_embedded(id, settings.rules)) return true;
    const double azimuth = azimuth_rad(wedge.edge, position_m() - wedge.edge.start_m);
    if (azimuth > wedge.edge.exterior_angle_rad + graze_rad && azimuth < 2.0 * pi - graze_rad) return true;
    return !map_.shows(wedge.edge.start_m, wedge.edge.end_m, nearer_on(scene, outlines, id));
  };
  std::ranges::sort(layer.mirrors);
  if (settings.edges) {
    for (const FacetId face : layer.mirrors) {
      for (const WedgeId id : scene.wedges_of_facet(face)) layer.edges.push_back(id);
    }
    std::ranges::sort(layer.edges);
    layer.edges.erase(std::unique(layer.edges.begin(), layer.edges.end()), layer.edges.end());
    std::erase_if(layer.edges, out_of_reach);
  }
  std::erase_if(layer.mirrors, [&](FacetId id) { return std::ranges::binary_search(end.mounted_on, id); });
  layer.lay_out(scene, position_m(), outlines.middle_m());
}

}  // namespace dcem
