#pragma once
/// Bodies of build_surface_mesh.hpp.
#include <algorithm>

#include "dcem/core/build_mode.hpp"
#include "dcem/geometry/surfaces/build_surface_mesh.hpp"
#include "dcem/geometry/surfaces/facet_builder.hpp"
#include "dcem/geometry/surfaces/wedge_builder.hpp"

namespace dcem {

DCEM_INLINE SurfaceMesh build_surface_mesh(const TriangleMesh& mesh, const SurfaceSettings& settings) {
  SurfaceMesh surface = detail::FacetBuilder(clean_mesh(mesh, settings), settings).build();
  surface.wedges = build_wedges(surface, settings);
  const auto free = std::count_if(surface.wedges.begin(), surface.wedges.end(), is_free);
  surface.report.free_edges = static_cast<std::size_t>(free);
  surface.report.wedges = surface.wedges.size() - surface.report.free_edges;
  return surface;
}

}  // namespace dcem
