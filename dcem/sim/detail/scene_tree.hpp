#pragma once
/// A tree over a scene's triangles, whatever its kind: how it is built and how it follows the scene.
#include <concepts>
#include <cstdint>
#include <span>

#include "dcem/accel/binary/updater.hpp"
#include "dcem/accel/wide/update/updater.hpp"
#include "dcem/scene/scene.hpp"

namespace dcem {

/// The scene's triangles as a wide tree sees them. Valid until the scene changes.
inline TriangleView triangle_view(const Scene& scene) {
  return {scene.vertices_m(), scene.triangles()};
}

/// One group per body.
template <typename Tree>
void build_tree(Tree& tree, const Scene& scene) {
  if constexpr (std::same_as<Tree, WideBvh>) {
    tree.build_objects(triangle_view(scene), scene.triangle_boxes(), scene.first_triangles());
  } else {
    tree.build_objects(scene.triangle_boxes(), scene.first_triangles());
  }
}

/// Brings the tree up to date with the scene, in which the triangles in `moved` have moved.
template <typename Tree>
TreeUpdateReport update_tree(UpdaterOf<Tree>& updater, Tree& tree, std::span<const std::uint32_t> moved,
                             const Scene& scene) {
  if constexpr (std::same_as<Tree, WideBvh>) {
    return updater.update(tree, moved, triangle_view(scene), scene.triangle_boxes());
  } else {
    return updater.update(tree, moved, scene.triangle_boxes());
  }
}

}  // namespace dcem
