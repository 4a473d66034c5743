#pragma once
/// Scenes of a few sheets, built in memory, for tests that ask one header at a time.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "dcem/accel/brute_force_index.hpp"
#include "dcem/accel/wide_index.hpp"
#include "dcem/core/random.hpp"
#include "dcem/paths/query/link_end.hpp"
#include "dcem/paths/query/scene_tracer.hpp"

namespace dcem::test {

/// A scene that knows some materials: opaque `metal` and `opaque`, sheets `alpha`, `glass`, `wall`. Their order as
/// materials is not that of their names.
inline Scene scene_of_materials() {
  Scene scene;
  scene.add_material({"wall", ConstantReflection{0.7, 20.0}});
  scene.add_material({"opaque", ConstantReflection{0.8, std::nullopt}});
  scene.add_material({"metal", PerfectConductor{}});
  scene.add_material({"glass", ConstantReflection{0.74, 5.0}});
  scene.add_material({"alpha", ConstantReflection{0.5, 3.0}});
  return scene;
}

/// Adds a parallelogram around its centre; the diagonal of its two triangles runs through the centre.
inline void add_sheet(TriangleMesh& mesh, const Vec3& centre_m, const Vec3& half_u_m, const Vec3& half_v_m,
                      const std::string& material) {
  add_quad(mesh,
           {centre_m - half_u_m - half_v_m, centre_m + half_u_m - half_v_m, centre_m + half_u_m + half_v_m,
            centre_m - half_u_m + half_v_m},
           material);
}

/// A sheet across the x axis, `half_m` to each side of it.
inline void add_sheet_across_x(TriangleMesh& mesh, double x_m, double half_m, const std::string& material) {
  add_sheet(mesh, Vec3(x_m, 0, 0), Vec3(0, half_m, 0), Vec3(0, 0, half_m), material);
}

/// The same rectangle, cut into `cells` × `cells` squares of two triangles each, with common corners.
inline void add_tiled_sheet(TriangleMesh& mesh, const Vec3& centre_m, const Vec3& half_u_m, const Vec3& half_v_m,
                            int cells, const std::string& material) {
  const double share = 1.0 / cells;
  for (int i = 0; i < cells; ++i) {
    for (int j = 0; j < cells; ++j) {
      const auto corner = [&](int a, int b) {
        return centre_m + (2.0 * share * a - 1.0) * half_u_m + (2.0 * share * b - 1.0) * half_v_m;
      };
      add_quad(mesh, {corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)}, material);
    }
  }
}

/// Six faces of the box between two corners.
inline void add_box_faces(TriangleMesh& mesh, const Vec3& low_m, const Vec3& high_m, const std::string& material) {
  const Vec3 centre_m = 0.5 * (low_m + high_m), half_m = 0.5 * (high_m - low_m);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      Vec3 middle_m = centre_m, u(0.0), v(0.0);
      middle_m[axis] += side * half_m[axis];
      u[(axis + 1) % 3] = half_m[(axis + 1) % 3];
      v[(axis + 2) % 3] = half_m[(axis + 2) % 3];
      add_sheet(mesh, middle_m, u, v, material);
    }
  }
}

/// A scenery with the materials above.
inline Scene scene_of(const TriangleMesh& mesh) {
  Scene scene = scene_of_materials();
  scene.set_scenery(mesh);
  return scene;
}

/// A scene with a tree over it and questions to both.
template <typename Index = WideIndex>
struct TracedScene {
  explicit TracedScene(Scene of) : scene(std::move(of)) { apply(scene.frame_at(0.0)); }
  TracedScene(const TracedScene&) = delete;
  TracedScene& operator=(const TracedScene&) = delete;

  /// Moves the bodies, and builds the tree anew.
  void apply(const Frame& frame) {
    scene.apply(frame);
    index.build(scene.triangle_view(), scene.triangle_boxes(), scene.first_triangles());
  }

  LinkEnd end(const Vec3& position_m, std::optional<BodyId> ignored_body = std::nullopt) {
    return make_link_end(tracer, position_m, ignored_body, counters);
  }

  /// The facet of a material at a point.
  FacetId facet_at(const Vec3& point_m, const std::string& material) {
    for (const FacetId id : tracer.facets_near(point_m, 1e-6, {}, counters)) {
      if (scene.material(scene.facet(id).material).name == material) return id;
    }
    throw std::logic_error("no facet of " + material + " is there");
  }

  Scene scene;
  Index index;
  SceneTracer<Index> tracer{scene, index};
  TraversalCounters counters;
};

/// Draws numbers for scenes; the same on every machine.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : stream_(hash_values(seed, 0x51ceULL)) {}
  double between(double low, double high) { return low + (high - low) * stream_.uniform(); }
  /// Every order of magnitude between the two is as likely as any other.
  double magnitude(double low, double high) { return low * std::pow(high / low, stream_.uniform()); }
  std::size_t below(std::size_t count) { return static_cast<std::size_t>(stream_.next() % count); }
  Vec3 inside(const Vec3& low, const Vec3& high) {
    return {between(low.x, high.x), between(low.y, high.y), between(low.z, high.z)};
  }
  Vec3 direction() {
    const double z = between(-1.0, 1.0), azimuth = between(-pi, pi), radius = std::sqrt(1.0 - z * z);
    return {radius * std::cos(azimuth), radius * std::sin(azimuth), z};
  }

 private:
  RandomStream stream_;
};

}  // namespace dcem::test
