#include "dcem/accel/convex_region.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>
#include <vector>

#include "dcem/accel/bvh.hpp"
#include "dcem/accel/wide_bvh.hpp"
#include "tests/accel/wide/wide_scenes.hpp"

namespace test_convex_region {

using namespace dcem;

namespace {

Vec3 drawn_point(RandomStream& random, double size_m) {
  return {dcem_test::between(random, -size_m, size_m), dcem_test::between(random, -size_m, size_m),
          dcem_test::between(random, -size_m, size_m)};
}

template <typename Tree>
std::set<std::uint32_t> visited(const Tree& tree, const ConvexRegion& region) {
  std::set<std::uint32_t> found;
  tree.visit(region, [&](std::uint32_t triangle) { REQUIRE(found.insert(triangle).second); });
  return found;
}

/// A window around a point, seen from the origin: its corners are turned about the way there.
std::vector<Vec3> window_around(const Vec3& middle_m, double radius_m, int corners, RandomStream& random) {
  const PlaneBasis basis = plane_basis(glm::normalize(middle_m + 0.2 * drawn_point(random, 1.0)));
  std::vector<Vec3> window_m;
  for (int corner = 0; corner < corners; ++corner) {
    const double turn_rad = 2.0 * pi * corner / corners;
    window_m.push_back(middle_m + radius_m * (std::cos(turn_rad) * basis.u + std::sin(turn_rad) * basis.v));
  }
  return window_m;
}

}  // namespace

TEST_CASE("a beam holds what can be reached from its apex through its window, and nothing before the window") {
  // A point beyond the window is in the beam if and only if the way to it from the apex passes through the polygon:
  // here a convex combination of corners, stretched, or pushed out over an edge.
  RandomStream random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3 apex_m = drawn_point(random, 1e3);
    const Vec3 way_m = drawn_point(random, 10.0);
    std::vector<Vec3> window_m = window_around(way_m, 0.3 * glm::length(way_m), 3 + trial % 5, random);
    if (trial % 2 == 1) std::ranges::reverse(window_m);
    Vec3 centre_m(0.0);
    for (Vec3& corner_m : window_m) {
      corner_m += apex_m;
      centre_m += corner_m / static_cast<double>(window_m.size());
    }
    const ConvexRegion beam = ConvexRegion::beam(apex_m, window_m);
    REQUIRE(beam.planes().size() == window_m.size() + 1);
    for (std::size_t corner = 0; corner < window_m.size(); ++corner) {
      const Vec3 edge_m = 0.5 * (window_m[corner] + window_m[(corner + 1) % window_m.size()]);
      const Vec3 inner_m = centre_m + 0.99 * (edge_m - centre_m), outer_m = centre_m + 1.01 * (edge_m - centre_m);
      for (const double stretch : {1.01, 3.0, 50.0}) {
        CHECK(beam.contains(apex_m + stretch * (inner_m - apex_m)));
        CHECK_FALSE(beam.contains(apex_m + stretch * (outer_m - apex_m)));
      }
      CHECK_FALSE(beam.contains(apex_m + 0.99 * (inner_m - apex_m)));
      CHECK_FALSE(beam.contains(apex_m - (inner_m - apex_m)));
    }
  }
}

TEST_CASE("a frustum is as wide and as high as its angles say") {
  const ConvexRegion frustum = ConvexRegion::frustum(Vec3(1, 2, 3), Vec3(0, 5, 0), Vec3(0, 1, 1), 0.5, 0.2);
  for (const double turn_rad : {-0.501, -0.499, 0.0, 0.499, 0.501}) {
    const Vec3 sideways = Vec3(1, 2, 3) + 7.0 * Vec3(std::sin(turn_rad), std::cos(turn_rad), 0.0);
    CHECK(frustum.contains(sideways) == (std::abs(turn_rad) < 0.5));
    const Vec3 upwards = Vec3(1, 2, 3) + 7.0 * Vec3(0.0, std::cos(0.4 * turn_rad), std::sin(0.4 * turn_rad));
    CHECK(frustum.contains(upwards) == (std::abs(turn_rad) < 0.5));
  }
  CHECK_FALSE(frustum.contains(Vec3(1, 1, 3)));
}

TEST_CASE("no tree loses a triangle that has a point in the region, and both find the same") {
  const dcem_test::WideMesh mesh = dcem_test::boxes_mesh(300, 11);
  const std::vector<Aabb<double>> boxes = mesh.boxes();
  WideBvh wide;
  wide.build(mesh.view(), boxes);
  Bvh<double> binary;
  binary.build(boxes);
  Aabb<double> all;
  for (const Aabb<double>& box : boxes) all.extend(box);
  RandomStream random(2);
  std::size_t kept = 0, asked = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const Vec3 apex_m = all.center() + drawn_point(random, 0.5 * glm::length(all.extent()));
    const Vec3 way_m = drawn_point(random, 5.0);
    std::vector<Vec3> window_m = window_around(way_m, 0.2 * glm::length(way_m), 4, random);
    for (Vec3& corner_m : window_m) corner_m += apex_m;
    const ConvexRegion beam = ConvexRegion::beam(apex_m, window_m);
    const std::set<std::uint32_t> found = visited(wide, beam);
    CHECK(found == visited(binary, beam));
    for (std::uint32_t triangle = 0; triangle < mesh.triangles.size(); ++triangle) {
      const TriangleCorners corners_m = mesh.corners(triangle);
      const bool has_point = std::ranges::any_of(corners_m, [&](const Vec3& corner) { return beam.contains(corner); });
      REQUIRE((!has_point || found.contains(triangle)));
      kept += has_point ? 1U : 0U;
    }
    asked += found.size();
  }
  CHECK(kept > 100);
  CHECK(asked < 100 * mesh.triangles.size() / 4);  // narrow beams: most of the tree is left out
}

TEST_CASE("a box that touches a plane is kept, one behind it is not; no planes keep everything") {
  const ConvexRegion above({Plane{Vec3(0, 0, 1e7), Vec3(0, 0, 1)}});
  CHECK(above(Aabb<double>{Vec3(-1, -1, 1e7 - 1), Vec3(1, 1, 1e7)}));
  CHECK_FALSE(above(Aabb<double>{Vec3(-1, -1, 1e7 - 1), Vec3(1, 1, 1e7 - 1e-8)}));
  CHECK(ConvexRegion()(Aabb<double>{Vec3(0.0), Vec3(0.0)}));
}

}  // namespace test_convex_region
