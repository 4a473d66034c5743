/// Edges that lie on something else all along: which they are follows from where the boxes stand.
#include "dcem/paths/query/embedded_edges.hpp"

#include <doctest/doctest.h>

#include "dcem/accel/wide_index.hpp"
#include "dcem/geometry/triangle_mesh.hpp"

namespace test_embedded_edges {

using namespace dcem;

namespace {

/// A box 4 × 2 × 3 m whose floor has its middle at `place_m`, on a ground of 20 × 20 m, in one body.
Scene box_on_ground(const Vec3& place_m) {
  TriangleMesh mesh;
  add_quad(mesh, {Vec3(-10, -10, 0), Vec3(10, -10, 0), Vec3(10, 10, 0), Vec3(-10, 10, 0)}, "metal");
  Scene scene;
  scene.add_material({"metal", PerfectConductor{}});
  const auto add_face = [&](const std::array<Vec3, 4>& face) {
    std::array<Vec3, 4> moved = face;
    for (Vec3& corner : moved) corner += place_m;
    add_quad(mesh, moved, "metal");
  };
  add_face({Vec3(-2, -1, 0), Vec3(-2, 1, 0), Vec3(2, 1, 0), Vec3(2, -1, 0)});
  add_face({Vec3(-2, -1, 3), Vec3(2, -1, 3), Vec3(2, 1, 3), Vec3(-2, 1, 3)});
  add_face({Vec3(-2, -1, 0), Vec3(2, -1, 0), Vec3(2, -1, 3), Vec3(-2, -1, 3)});
  add_face({Vec3(-2, 1, 0), Vec3(-2, 1, 3), Vec3(2, 1, 3), Vec3(2, 1, 0)});
  add_face({Vec3(-2, -1, 0), Vec3(-2, -1, 3), Vec3(-2, 1, 3), Vec3(-2, 1, 0)});
  add_face({Vec3(2, -1, 0), Vec3(2, 1, 0), Vec3(2, 1, 3), Vec3(2, -1, 3)});
  scene.set_scenery(mesh);
  return scene;
}

/// How many edges are covered, and whether all of them lie in the ground.
struct Covered {
  std::size_t edges = 0;
  bool all_in_ground = true;
};

Covered covered_in(Scene scene) {
  scene.apply(scene.frame_at(0.0));
  WideIndex index;
  index.build(scene.triangle_view(), scene.triangle_boxes(), scene.first_triangles());
  ThreadPool pool(1);
  Covered result;
  const std::vector<char> covered = embedded_edges(scene, index, pool);
  REQUIRE(covered.size() == scene.wedges().size());
  for (std::size_t wedge = 0; wedge < covered.size(); ++wedge) {
    if (covered[wedge] == 0) continue;
    const Wedge& edge = scene.wedges()[wedge].edge;
    ++result.edges;
    result.all_in_ground = result.all_in_ground && std::abs(edge.start_m.z) < 1e-3 && std::abs(edge.end_m.z) < 1e-3;
  }
  return result;
}

}  // namespace

TEST_CASE("the foot of a box on the ground is covered, also across the seam of the ground's triangles") {
  const Covered middle = covered_in(box_on_ground({0.3, 0.2, 0}));  // over the diagonal
  CHECK(middle.edges == 4);
  CHECK(middle.all_in_ground);
}

TEST_CASE("a box above the ground, or half beyond its rim, has free edges there") {
  CHECK(covered_in(box_on_ground({0, 0, 0.01})).edges == 0);
  // The long edges stand out by half; of the short ones that over the ground is covered, the other is in the air.
  const Covered rim = covered_in(box_on_ground({10, 3, 0}));
  CHECK(rim.edges == 1);
  CHECK(rim.all_in_ground);
}

}  // namespace test_embedded_edges
