#include "dcem/io/src/viewer/viewed_surfaces.hpp"

#include "dcem/paths/path.hpp"

namespace dcem::io {

std::uint32_t ViewedSurfaces::number_of(const Scene& scene, const Interaction& touch) {
  const BodyId body = scene.facet(touch.facet).body;
  const bool is_edge = touch.kind == InteractionKind::diffraction;
  const std::uint32_t own = is_edge ? scene.wedge_number(touch.wedge) : scene.facet_number(touch.facet);
  const std::string& object = scene.body_name(body);
  const auto [place, is_new] =
      numbers_.try_emplace({object, is_edge, own}, static_cast<std::uint32_t>(surfaces_.size()));
  if (!is_new) return place->second;
  const SurfaceMesh& mesh = scene.body(body).mesh;
  ViewedSurface surface{object, scene.facet(touch.facet).material, {}, Vec3(0.0), 0.0};
  if (is_edge) {
    const Wedge& wedge = body.value == 0 ? scene.wedge(touch.wedge).edge : mesh.wedges[own];
    surface.normal = wedge.normal;
    surface.edge = edge_direction(wedge);
    surface.exterior_angle_rad = wedge.exterior_angle_rad;
  } else {
    surface.normal = mesh.facets[own].plane.normal;
  }
  surfaces_.push_back(surface);
  return place->second;
}

}  // namespace dcem::io
