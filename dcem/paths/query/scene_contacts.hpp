#pragma once
/// What touches what in a scene, found once for many points.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "dcem/paths/query/edge_contacts.hpp"
#include "dcem/paths/query/scene_tracer.hpp"

namespace dcem {

/// What `KnownContacts` tells of.
struct SceneContacts {
  std::vector<EdgeContact> edges;
  std::vector<char> stacked;

  KnownContacts known() const { return {edges, stacked}; }
};

namespace detail {

/// Whether another facet may lie on top of one somewhere: parallel, and within the weld tolerance of it.
template <typename Index>
bool is_stacked(const SceneTracer<Index>& tracer, FacetId id) {
  const Scene& scene = tracer.scene();
  const WorldFacet& facet = scene.facet(id);
  const double tolerance_m = 1.001 * scene.settings().weld_tolerance_m;
  bool found = false;
  const auto ask = [&](std::uint32_t triangle) {
    const FacetId other = scene.facet_of_triangle(triangle);
    if (found || other == id || !tracer.parallel(id, other)) return;
    int before = 0, behind = 0;
    for (const Vec3& corner_m : scene.corners_m(triangle)) {
      const double distance_m = signed_distance_m(facet.plane, corner_m);
      before += distance_m > tolerance_m ? 1 : 0;
      behind += distance_m < -tolerance_m ? 1 : 0;
    }
    found = before < 3 && behind < 3;
  };
  tracer.index().overlapping(inflated(scene.hull_box(facet), tolerance_m + facet_reach_m(scene)), ask);
  return found;
}

}  // namespace detail

/// By facet, whether another one may lie on top of it. Empty where there are bodies that may move.
template <typename Index>
std::vector<char> stacked_facets(const Scene& scene, const Index& index, ThreadPool& pool) {
  if (scene.bodies().size() > 1) return {};
  const SceneTracer<Index> tracer(scene, index);
  std::vector<char> stacked(scene.facets().size());
  pool.for_each(stacked.size(), [&](std::size_t facet, unsigned) {
    stacked[facet] = detail::is_stacked(tracer, FacetId(static_cast<std::uint32_t>(facet))) ? 1 : 0;
  });
  return stacked;
}

template <typename Index>
SceneContacts scene_contacts(const Scene& scene, const Index& index, const EdgeRules& rules, ThreadPool& pool) {
  return {edge_contacts(scene, index, rules, pool), stacked_facets(scene, index, pool)};
}

}  // namespace dcem
