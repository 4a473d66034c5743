#pragma once
/// Bodies of facet_outlines.hpp.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/halves/facet_outlines.hpp"
#include "dcem/paths/halves/hull_filling.hpp"

namespace dcem {

DCEM_INLINE FacetOutlines::FacetOutlines(const Scene& scene) : outlines_(scene.facets().size()) {
  std::uint32_t sides = 0;
  for (std::uint32_t index = 0; index < outlines_.size(); ++index) {
    outlines_[index].first_side = std::exchange(sides, sides + scene.facets()[index].hull_point_count);
  }
  sides_.resize(sides);
  for (std::uint32_t index = 0; index < outlines_.size(); ++index) {
    place(scene, index);
    measure(scene, index);
  }
  const std::uint32_t scenery = end_of_body(scene, 0);
  for (std::uint32_t index = 0; index < scenery; ++index) {
    if (!outlines_[index].box.empty()) items_.push_back(FacetId(index));
  }
  if (!items_.empty()) {
    grow(0, static_cast<std::uint32_t>(items_.size()));
    places_ = std::vector<std::pair<double, std::uint32_t>>();
    middle_m_ = glm::round(nodes_.front().box.center());
    lay_out_planes(scene);
  }
  joints_.find(scene, scenery, [&](FacetId id) { return scene.facet(id).present && hides_as_hull(of(id)); });
  feet_.find(scene, scenery);
  for (std::uint32_t body = 1; body < scene.bodies().size(); ++body) {
    const std::uint32_t first = end_of_body(scene, body - 1);
    bodies_.push_back({{}, first, end_of_body(scene, body) - first});
    fit(bodies_.back());
  }
  cluster_bodies();
}

DCEM_INLINE void FacetOutlines::update(const Scene& scene, std::span<const BodyId> moved) {
  for (const BodyId body : moved) {
    if (body.value == 0) continue;  // the scenery stands
    BodyFacets& facets = bodies_[body.value - 1];
    for (std::uint32_t index = facets.first; index < facets.first + facets.count; ++index) place(scene, index);
    fit(facets);
  }
  if (!moved.empty()) cluster_bodies();
}

DCEM_INLINE void FacetOutlines::cluster_bodies() {
  bodies_there_.clear();
  for (std::uint32_t body = 0; body < bodies_.size(); ++body) {
    if (!bodies_[body].box.empty()) bodies_there_.emplace_back(body + 1);
  }
  body_clusters_.build_for_items(bodies_there_.size(), [&](std::uint32_t item) {
    const Aabb<double>& box = bodies_[bodies_there_[item].value - 1].box;
    return Aabb<double>{box.min - middle_m_, box.max - middle_m_};
  });
}

DCEM_INLINE std::uint32_t FacetOutlines::end_of_body(const Scene& scene, std::uint32_t body) {
  const bool last = body + 1 == scene.bodies().size();
  return last ? static_cast<std::uint32_t>(scene.facets().size()) : scene.world().first(BodyId(body + 1)).facet;
}

DCEM_INLINE void FacetOutlines::place(const Scene& scene, std::uint32_t index) {
  const WorldFacet& facet = scene.facets()[index];
  FacetOutline& outline = outlines_[index];
  const std::span<const Vec3> hull_m = scene.hull_m(facet);
  outline.side_count = facet.hull_point_count;
  outline.box = {};
  Vec3 centre_m(0.0);
  for (const Vec3& corner : hull_m) {
    if (facet.present) outline.box.extend(corner);
    centre_m += corner / static_cast<double>(hull_m.size());
  }
  if (facet.present) {
    // Edges are where planes cross: of facets that stray they may end lower than any corner.
    for (const WedgeId id : scene.wedges_of_facet(FacetId(index))) {
      const Wedge& edge = scene.wedge(id).edge;
      outline.box.min.z = std::min({outline.box.min.z, edge.start_m.z, edge.end_m.z});
    }
  }
  for (std::size_t corner = 0; corner < hull_m.size(); ++corner) {
    const Vec3 &from = hull_m[corner], &to = hull_m[(corner + 1) % hull_m.size()];
    const Vec3 across = glm::cross(facet.plane.normal, to - from);
    const double length = glm::length(across);
    HullSide& side = sides_[outline.first_side + corner];
    side = {};
    if (!(length > 1e-9)) continue;  // too short to say: everything is inside
    side.normal = (glm::dot(across, centre_m - from) < 0.0 ? -across : across) / length;
    side.offset_m = glm::dot(side.normal, from);
  }
}

DCEM_INLINE void FacetOutlines::measure(const Scene& scene, std::uint32_t index) {
  const WorldFacet& facet = scene.facets()[index];
  FacetOutline& outline = outlines_[index];
  const std::span<const Vec3> hull_m = scene.hull_m(facet);
  std::vector<std::array<Vec3, 3>> triangles_m;
  for (std::uint32_t triangle = 0; triangle < facet.triangle_count; ++triangle) {
    triangles_m.push_back(scene.corners_m(facet.first_triangle + triangle));
    for (const Vec3& corner : triangles_m.back()) {
      outline.stray_m = std::max(outline.stray_m, std::abs(signed_distance_m(facet.plane, corner)));
    }
  }
  outline.fills_hull = fills_hull(triangles_m, hull_m);
  outline.is_joined = outline.stray_m <= detail::flat_facet_m || are_joined(triangles_m, hull_m, facet.plane.normal);
  // A leg ignores what lies along its mirror within the weld tolerance, and the mirror's own triangles wherever they
  // are.
  outline.lift_m = 2.0 * scene.settings().weld_tolerance_m + 1.01 * outline.stray_m;
}

DCEM_INLINE void FacetOutlines::lay_out_planes(const Scene& scene) {
  std::vector<PlaneIndex::Item> planes;
  for (const FacetId facet : items_) planes.push_back({facet, scene.facet(facet).plane, of(facet).lift_m});
  planes_.build(planes, middle_m_);
}

DCEM_INLINE void FacetOutlines::fit(BodyFacets& facets) const {
  facets.box = {};
  for (std::uint32_t index = facets.first; index < facets.first + facets.count; ++index) {
    facets.box.extend(outlines_[index].box);
  }
}

DCEM_INLINE void FacetOutlines::grow(std::uint32_t first, std::uint32_t count) {
  const std::size_t number = nodes_.size();
  nodes_.push_back({{}, first, count, 0});
  Aabb<double> centres;
  for (std::uint32_t index = first; index < first + count; ++index) {
    nodes_[number].box.extend(of(items_[index]).box);
    centres.extend(of(items_[index]).box.center());
  }
  if (count <= leaf_size) return;
  const Vec3 size = centres.extent();
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  divide(first, count, axis);
  nodes_[number].count = 0;
  grow(first, count / 2);
  nodes_[number].right = static_cast<std::uint32_t>(nodes_.size());
  grow(first + count / 2, count - count / 2);
}

/// The lesser half of the items along an axis first. Their places are gathered before: those of facets lie apart.
DCEM_INLINE void FacetOutlines::divide(std::uint32_t first, std::uint32_t count, int axis) {
  places_.clear();
  for (std::uint32_t index = first; index < first + count; ++index) {
    places_.emplace_back(of(items_[index]).box.center()[axis], items_[index].value);
  }
  std::nth_element(places_.begin(), places_.begin() + count / 2, places_.end());
  for (std::uint32_t index = 0; index < count; ++index) items_[first + index] = FacetId(places_[index].second);
}

}  // namespace dcem
