#pragma once
/// Bodies of world_geometry.hpp.
#include <algorithm>
#include <map>
#include <utility>

#include "dcem/core/build_mode.hpp"
#include "dcem/world/world_geometry.hpp"

namespace dcem {

namespace detail {

/// Room for more at the end of a list: exactly so much for the first, the scenery, and with some to spare for what
/// follows one by one.
template <typename List>
void make_room(List& list, std::size_t more) {
  const std::size_t needed = list.size() + more;
  if (needed > list.capacity()) list.reserve(std::max(needed, list.capacity() + list.capacity() / 2));
}

}  // namespace detail

DCEM_INLINE WorldGeometry::WorldGeometry() = default;
DCEM_INLINE WorldGeometry::WorldGeometry(const WorldGeometry&) = default;
DCEM_INLINE WorldGeometry::WorldGeometry(WorldGeometry&&) noexcept = default;
DCEM_INLINE WorldGeometry& WorldGeometry::operator=(const WorldGeometry&) = default;
DCEM_INLINE WorldGeometry& WorldGeometry::operator=(WorldGeometry&&) noexcept = default;
DCEM_INLINE WorldGeometry::~WorldGeometry() = default;

DCEM_INLINE void WorldGeometry::clear() {
  *this = {};
}

DCEM_INLINE void WorldGeometry::append(const SurfaceMesh& mesh, std::span<const SurfaceMaterial> materials,
                                       const BodyState& state) {
  const BodyId id(first_.size());
  first_.push_back({static_cast<std::uint32_t>(vertices_m_.size()), static_cast<std::uint32_t>(triangles_.size()),
                    static_cast<std::uint32_t>(facets_.size()), static_cast<std::uint32_t>(hull_points_m_.size()),
                    static_cast<std::uint32_t>(wedges_.size())});
  make_room(mesh);
  append_facets(mesh, materials, first_.back());
  append_triangles(mesh, first_.back());
  append_wedges(mesh, first_.back());
  append_foliage(mesh, first_.back());
  vertices_m_.insert(vertices_m_.end(), mesh.vertices_m.begin(), mesh.vertices_m.end());
  hull_points_m_.insert(hull_points_m_.end(), mesh.hull_points_m.begin(), mesh.hull_points_m.end());
  place(id, mesh, state);
}

DCEM_INLINE void WorldGeometry::make_room(const SurfaceMesh& mesh) {
  const auto for_each_of = [](std::size_t count, auto&... lists) { (detail::make_room(lists, count), ...); };
  for_each_of(mesh.facets.size(), facets_, first_wedge_of_facet_);
  for_each_of(mesh.wedges.size(), wedges_);
  for_each_of(mesh.triangles.size(), triangles_, facet_of_triangle_, shell_of_triangle_, boxes_);
  for_each_of(mesh.vertices_m.size(), vertices_m_);
  for_each_of(mesh.hull_points_m.size(), hull_points_m_);
}

DCEM_INLINE void WorldGeometry::append_facets(const SurfaceMesh& mesh, std::span<const SurfaceMaterial> materials,
                                              const First& first) {
  const BodyId body(first_.size() - 1);
  for (const Facet& local : mesh.facets) {
    const SurfaceMaterial& material = materials[local.material];
    has_sheets_ = has_sheets_ || material.transmits;
    facets_.push_back({local.plane, material.id, body, first.triangle + local.first_triangle, local.triangle_count,
                       first.hull_point + local.first_hull_point, local.hull_point_count, material.transmits,
                       !material.is_foliage, material.scatters, material.is_foliage});
  }
}

DCEM_INLINE void WorldGeometry::append_triangles(const SurfaceMesh& mesh, const First& first) {
  for (std::size_t index = 0; index < mesh.triangles.size(); ++index) {
    const auto& local = mesh.triangles[index];
    triangles_.push_back({first.vertex + local[0], first.vertex + local[1], first.vertex + local[2]});
    facet_of_triangle_.push_back(FacetId(first.facet + mesh.facet_of_triangle[index]));
    shell_of_triangle_.push_back(mesh.shell_of_triangle[index]);
  }
  boxes_.resize(triangles_.size());
}

DCEM_INLINE void WorldGeometry::append_wedges(const SurfaceMesh& mesh, const First& first) {
  const BodyId body(first_.size() - 1);
  for (const Wedge& local : mesh.wedges) {
    const std::uint32_t one = local.facets[0], other = is_free(local) ? one : local.facets[1];
    wedges_.push_back({local, {FacetId(first.facet + one), FacetId(first.facet + other)}, body, true});
  }
  list_wedges_by_facet(first);
}

/// Counted facet by facet first, so that each list has its place.
DCEM_INLINE void WorldGeometry::list_wedges_by_facet(const First& first) {
  const auto for_each_rim = [&](auto&& visit) {
    for (std::size_t index = first.wedge; index < wedges_.size(); ++index) {
      const auto [one, other] = wedges_[index].facets;
      visit(one.value - first.facet, WedgeId(index));
      if (other != one) visit(other.value - first.facet, WedgeId(index));
    }
  };
  std::vector<std::uint32_t> next(facets_.size() - first.facet, 0);
  for_each_rim([&](std::uint32_t facet, WedgeId) { ++next[facet]; });
  std::uint32_t end = first_wedge_of_facet_.back();
  for (std::uint32_t& of_facet : next) {
    first_wedge_of_facet_.push_back(end += of_facet);
    of_facet = end - of_facet;
  }
  detail::make_room(wedges_by_facet_, end - wedges_by_facet_.size());
  wedges_by_facet_.resize(end);
  for_each_rim([&](std::uint32_t facet, WedgeId wedge) { wedges_by_facet_[next[facet]++] = wedge; });
}

DCEM_INLINE void WorldGeometry::append_foliage(const SurfaceMesh& mesh, const First& first) {
  std::map<std::uint32_t, FoliageShell> shells;
  for (std::uint32_t index = 0; index < mesh.triangles.size(); ++index) {
    const WorldFacet& facet = facets_[first.facet + mesh.facet_of_triangle[index]];
    if (!facet.is_foliage) continue;
    FoliageShell& shell = shells[mesh.shell_of_triangle[index]];
    shell.body = facet.body;
    shell.material = facet.material;
    shell.triangles.push_back(first.triangle + index);
  }
  for (auto& [number, shell] : shells) foliage_.push_back(std::move(shell));
}

DCEM_INLINE void WorldGeometry::place(BodyId id, const SurfaceMesh& mesh, const BodyState& state) {
  const First& first = first_[id.value];
  const Mat3 rotation = rotation_matrix(state.placement.pose);
  const auto to_world = [&](const Vec3& local) { return state.placement.pose.position_m + rotation * local; };
  const bool stands = id == BodyId{};  // the scenery's coordinates are the world's, to the last bit
  for (std::size_t index = 0; index < mesh.vertices_m.size() && !stands; ++index) {
    vertices_m_[first.vertex + index] = to_world(mesh.vertices_m[index]);
  }
  for (std::size_t index = 0; index < mesh.hull_points_m.size() && !stands; ++index) {
    hull_points_m_[first.hull_point + index] = to_world(mesh.hull_points_m[index]);
  }
  for (std::size_t index = 0; index < mesh.facets.size(); ++index) {
    WorldFacet& facet = facets_[first.facet + index];
    const Plane& local = mesh.facets[index].plane;
    if (!stands) facet.plane = {to_world(local.point_m), rotation * local.normal};
    facet.present = state.present && !facet.is_foliage;
  }
  for (std::size_t index = 0; index < mesh.wedges.size(); ++index) {
    WorldWedge& wedge = wedges_[first.wedge + index];
    const Wedge& local = mesh.wedges[index];
    if (!stands) {
      wedge.edge.start_m = to_world(local.start_m);
      wedge.edge.end_m = to_world(local.end_m);
      wedge.edge.tangent = rotation * local.tangent;
      wedge.edge.normal = rotation * local.normal;
    }
    const bool solid = !facets_[wedge.facets[0].value].is_foliage && !facets_[wedge.facets[1].value].is_foliage;
    wedge.present = state.present && solid;
  }
  place_boxes(mesh, first, state.present);
  place_foliage(id, state.present);
}

DCEM_INLINE void WorldGeometry::place_boxes(const SurfaceMesh& mesh, const First& first, bool present) {
  for (std::size_t index = 0; index < mesh.triangles.size(); ++index) {
    const auto triangle = static_cast<std::uint32_t>(first.triangle + index);
    Aabb<double> box;
    if (present && !facets_[facet_of_triangle_[triangle].value].is_foliage) {
      for (const Vec3& corner : corners_m(triangle)) box.extend(corner);
    }
    boxes_[triangle] = box;
  }
}

DCEM_INLINE void WorldGeometry::place_foliage(BodyId id, bool present) {
  for (FoliageShell& shell : foliage_) {
    if (shell.body != id) continue;
    shell.box = {};
    for (const std::uint32_t triangle : shell.triangles) {
      if (!present) break;
      for (const Vec3& corner : corners_m(triangle)) shell.box.extend(corner);
    }
  }
}

}  // namespace dcem
