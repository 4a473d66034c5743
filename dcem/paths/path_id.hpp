#pragma once
/// The name of a path, the same in every frame in which it exists.
#include <string>

#include "dcem/paths/path.hpp"
#include "dcem/scene/scene.hpp"

namespace dcem {

/// Kind, object and facet of each interaction from transmitter to receiver, as in `R12/T3@car1`: reflected at facet 12
/// of the scenery, then through facet 3 of the object `car1`; `D7` is a diffraction at edge 7. The line of sight is
/// `LOS`. Facets and edges are numbered within their body in an order that depends on its geometry alone, so objects
/// that come, go or move do not rename a path.
inline std::string path_id(const Scene& scene, const Path& path) {
  if (path.interactions.empty()) return "LOS";
  std::string id;
  for (const Interaction& interaction : path.interactions) {
    const std::string& object = scene.body_name(scene.facet(interaction.facet).body);
    if (!id.empty()) id += '/';
    id += static_cast<char>(interaction.kind);
    id += std::to_string(interaction.kind == InteractionKind::diffraction ? scene.wedge_number(interaction.wedge)
                                                                          : scene.facet_number(interaction.facet));
    if (!object.empty()) id += '@' + object;
  }
  return id;
}

}  // namespace dcem
