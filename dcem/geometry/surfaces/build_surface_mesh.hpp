#pragma once
/// From a mesh as found to surfaces.
#include "dcem/geometry/surfaces/surface_mesh.hpp"

namespace dcem {

/// Builds the surfaces of a mesh. Throws std::invalid_argument on a vertex that is not finite, or an index out of
/// range.
SurfaceMesh build_surface_mesh(const TriangleMesh& mesh, const SurfaceSettings& settings = {});

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/geometry/surfaces/build_surface_mesh_bodies.hpp"
#endif
