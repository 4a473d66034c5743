#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "dcem/accel/wide/trace/ray.hpp"
#include "dcem/accel/wide_bvh.hpp"
#include "tests/accel/wide/wide_scenes.hpp"

namespace test_ray {

using namespace dcem;
using dcem_test::between;
using dcem_test::infinity;
using dcem_test::random_direction;
using dcem_test::random_in_cube;
using dcem_test::text_of;
using dcem_test::WideMesh;

namespace {

/// How one kind of quad is made and aimed at.
struct Kind {
  double size_m;
  double thinness;       ///< height over length
  double bend;           ///< relative to the size
  double distance_m;     ///< of the ray's origin, at most
  double shift_m = 0.0;  ///< of everything
};

double exponent_between(RandomStream& random, double low, double high) {
  return std::pow(10.0, between(random, low, high));
}

/// Up to eight quads near one point, as pairs or as single triangles.
WideMesh quads_of(RandomStream& random, const Kind& kind) {
  WideMesh mesh;
  const Vec3 shift = kind.shift_m * random_direction(random);
  const double spread = random.uniform() < 0.5 ? kind.size_m : 30 * kind.size_m;
  for (int quad = 0; quad < 4; ++quad) {
    const Vec3 along = random_direction(random);
    const Vec3 across = glm::normalize(glm::cross(along, random_direction(random)));
    const Vec3 normal = glm::cross(along, across);
    const Vec3 at = shift + random_in_cube(random, spread);
    const double length = kind.size_m * between(random, 0.3, 1.0), height = length * kind.thinness;
    const auto a = mesh.add_vertex(at);
    const auto b = mesh.add_vertex(at + length * between(random, 0.3, 0.7) * along - height * across);
    const auto c = mesh.add_vertex(at + length * along);
    mesh.add(a, b, c);
    if (random.uniform() < 0.3) continue;
    const double fold = between(random, -kind.bend, kind.bend) * length;
    const Vec3 beyond = height * between(random, 0.2, 1.0) * across + fold * normal;
    mesh.add(a, c, mesh.add_vertex(at + length * between(random, 0.3, 0.7) * along + beyond));
  }
  // One more far behind: the tree's origin is then far from the quads, in the middle.
  if (kind.shift_m > 0.0) mesh.add(-shift, -shift + Vec3(1, 0, 0), -shift + Vec3(0, 1, 0));
  return mesh;
}

/// A ray close to an edge, a corner or the inside of a triangle, some of them along its surface.
Ray<double> aimed(RandomStream& random, const WideMesh& mesh, const Kind& kind) {
  const std::size_t count = mesh.triangles.size() - (kind.shift_m > 0.0 ? 1 : 0);
  const auto corners = mesh.corners(static_cast<std::uint32_t>(random.next() % count));
  const double place = random.uniform();
  Vec3 aim = dcem_test::random_on(random, corners);
  if (place < 0.8) aim += exponent_between(random, -9, 0) * kind.size_m * random_direction(random);
  const double distance = exponent_between(random, -3, 0) * kind.distance_m;
  Vec3 direction = random_direction(random);
  if (random.uniform() < 0.4) {
    const Vec3 across = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    if (glm::length(across) > 0.0) {
      const Vec3 normal = glm::normalize(across);
      direction -= normal * glm::dot(normal, direction) * (1.0 - exponent_between(random, -9, -1));
    }
  }
  // Along an edge, which a thin triangle seen from its end is.
  if (random.uniform() < 0.15) direction = corners[2] - corners[0] + 1e-5 * kind.size_m * direction;
  direction = glm::normalize(direction);
  const double speed = exponent_between(random, -3, 3);
  return {aim - distance * direction, speed * direction, 0.0, infinity};
}

struct Tally {
  std::uint64_t lanes = 0, refused = 0, certain = 0, asked = 0, sides = 0;
};

/// What the filter says of every lane of every leaf, against double precision.
void check_leaves(const WideBvh& tree, const WideMesh& mesh, const Ray<double>& ray, Tally& tally) {
  const WideArrays& arrays = tree.arrays();
  const WideRay wide(ray, arrays.origin_m, arrays.extent_m);
  if (!wide.usable()) return;
  const WatertightRay exact(ray);
  for (std::uint32_t leaf = 0; leaf < arrays.leaves.size(); ++leaf) {
    QuadHits hits, early_hits;
    hits.certain = 0;
    const std::uint32_t met = wide.meets<false>(arrays.leaves[leaf], WideRay::padded(ray.t_max), hits);
    REQUIRE(wide.meets<true>(arrays.leaves[leaf], WideRay::padded(ray.t_max), early_hits) == met);
    for (std::uint32_t lane = 0; lane < simd_lanes; ++lane) {
      const Quad& quad = arrays.quads[leaf * simd_lanes + lane];
      if (quad.is_none()) continue;
      bool on_line = false;
      bool in_range = false;
      bool is_in_bounds = true;
      for (const std::uint32_t triangle : quad.triangles()) {
        const auto t = exact.intersect(mesh.corners(triangle));
        if (!t) continue;
        on_line = true;
        const double room = dcem_test::tolerance_of(mesh.corners(triangle), ray, *t);
        if (!(*t - room > ray.t_min && *t + room < ray.t_max)) continue;
        in_range = true;
        if ((met >> lane & 1U) != 0) {
          is_in_bounds = is_in_bounds && !(static_cast<double>(hits.first[lane]) > *t + room) &&
                         !(static_cast<double>(hits.last[lane]) < *t - room);
        }
      }
      const bool is_met = (met >> lane & 1U) != 0, is_certain = (met & hits.certain & (1U << lane)) != 0;
      ++tally.lanes;
      tally.refused += is_met ? 0U : 1U;
      tally.certain += is_certain ? 1U : 0U;
      tally.asked += is_met && !is_certain ? 1U : 0U;
      const QuadCertainty certainty = is_certain ? hits.certainty(lane) : QuadCertainty::undecided;
      const bool is_side = certainty == QuadCertainty::first || certainty == QuadCertainty::second;
      const std::uint32_t side = certainty == QuadCertainty::second ? 1 : 0;
      tally.sides += is_side ? 1U : 0U;
      const bool is_side_right = !is_side || exact.intersect(mesh.corners(quad.triangle[side])).has_value();
      if ((in_range && !is_met) || (is_certain && !on_line) || !is_in_bounds || !is_side_right) {
        INFO(text_of(ray));
        CAPTURE(on_line);
        CAPTURE(in_range);
        CAPTURE(is_met);
        CAPTURE(is_certain);
        CAPTURE(is_in_bounds);
        CAPTURE(hits.first[lane]);
        CAPTURE(hits.last[lane]);
        FAIL("single precision decides against double precision");
      }
    }
  }
}

Tally check_kind(const Kind& kind, int meshes, int rays, std::uint64_t seed) {
  RandomStream random(seed);
  Tally tally;
  for (int trial = 0; trial < meshes; ++trial) {
    const WideMesh mesh = quads_of(random, kind);
    WideBvh tree;
    tree.build(mesh.view(), mesh.boxes());
    for (int shot = 0; shot < rays; ++shot) {
      Ray<double> ray = aimed(random, mesh, kind);
      check_leaves(tree, mesh, ray, tally);
      // Ends of the ray close to the surface, from either side.
      const double t = kind.distance_m * random.uniform() / glm::length(ray.direction);
      ray.t_max = t;
      check_leaves(tree, mesh, ray, tally);
      ray.t_min = t, ray.t_max = infinity;
      check_leaves(tree, mesh, ray, tally);
    }
  }
  return tally;
}

}  // namespace

TEST_CASE("of a quad, single precision never says what double precision denies") {
  std::uint64_t seed = 0;
  for (const double size_m : {1e-3, 0.1, 3.0, 100.0}) {
    for (const double distance_m : {1e-2, 1.0, 100.0, 3e4}) {
      for (const double thinness : {1.0, 1e-2, 1e-5}) {
        for (const double bend : {0.0, 1e-7, 9e-4}) {
          const Kind kind{size_m, thinness, bend, distance_m, seed % 2 == 0 ? 0.0 : 1e4};
          CAPTURE(size_m);
          CAPTURE(distance_m);
          CAPTURE(thinness);
          CAPTURE(bend);
          check_kind(kind, 300, 30, ++seed);
        }
      }
    }
  }
}

TEST_CASE("an everyday quad is decided by single precision, nearly always") {
  RandomStream random(5);
  const WideMesh mesh = dcem_test::boxes_mesh(3, 6);
  WideBvh tree;
  tree.build(mesh.view(), mesh.boxes());
  Tally tally;
  for (int trial = 0; trial < 20000; ++trial) {
    const Vec3 from = random_in_cube(random, 30.0);
    check_leaves(tree, mesh, segment_between(from, random_in_cube(random, 12.0)), tally);
  }
  CHECK(tally.certain > 100);
  CHECK(tally.asked < tally.certain / 4);
  CHECK(tally.sides > tally.certain / 2);
  CHECK(tally.refused > tally.lanes * 99 / 100);
}

TEST_CASE("a needle aimed at a ray that passes far away is not surely met") {
  // The products of far corners are rounded more than the needle is wide.
  RandomStream random(11);
  Tally tally;
  for (int trial = 0; trial < 60000; ++trial) {
    WideMesh mesh;
    const Vec3 along = random_direction(random);
    const Vec3 across = glm::normalize(glm::cross(along, random_direction(random)));
    const double length = exponent_between(random, -5, 0), width = length * exponent_between(random, -6, -1);
    mesh.add(Vec3(0), length * along, 0.5 * length * along + width * across);
    // A second triangle makes the leaf large enough to be looked at.
    mesh.add(Vec3(200, 0, 0), Vec3(200, 1, 0), Vec3(200, 0, 1));
    WideBvh tree;
    tree.build(mesh.view(), mesh.boxes());
    const double far_m = exponent_between(random, -1, 2.3);
    const Vec3 origin = far_m * random_direction(random);
    // The ray passes a point on the needle's own line.
    const Vec3 passes = exponent_between(random, -1, 2.3) * (random.uniform() < 0.5 ? along : -along);
    check_leaves(tree, mesh, {origin, passes - origin}, tally);
  }
  CHECK(tally.lanes > 100000);
}

TEST_CASE("of quads whose vertices have moved in any way, single precision says nothing false") {
  RandomStream random(21);
  Tally tally;
  for (int trial = 0; trial < 2000; ++trial) {
    Kind kind{1.0, 1.0, 0.0, 10.0};
    WideMesh mesh = quads_of(random, kind);
    WideBvh tree;
    tree.build(mesh.view(), mesh.boxes());
    const Vec3 flat = random_direction(random);
    for (Vec3& vertex : mesh.vertices) {
      const Vec3 by = random_in_cube(random, trial % 2 == 0 ? 1.0 : 0.1);
      // In the plane of all, every third time: pairs become concave and overlap, and stay flat.
      vertex = trial % 3 == 0 ? vertex + by - flat * glm::dot(flat, vertex + by) : vertex + by;
    }
    std::vector<std::uint32_t> all;
    for (std::uint32_t triangle = 0; triangle < mesh.triangles.size(); ++triangle) all.push_back(triangle);
    tree.refit(all, mesh.view(), mesh.boxes());
    for (int shot = 0; shot < 30; ++shot) check_leaves(tree, mesh, aimed(random, mesh, kind), tally);
  }
  CHECK(tally.certain > 0);
}

TEST_CASE("a box that the ray meets is met, whatever the direction and however close to a face") {
  RandomStream random(31);
  for (int trial = 0; trial < 300000; ++trial) {
    const double size = exponent_between(random, -3, 3), distance = size * exponent_between(random, -2, 5);
    WideArrays arrays;
    arrays.origin_m = trial % 4 == 0 ? random_in_cube(random, 1e4) : Vec3(0.0);
    WideNode node;
    std::array<Aabb<double>, simd_lanes> boxes;
    for (std::uint32_t lane = 0; lane < simd_lanes; ++lane) {
      const Vec3 low = arrays.origin_m + random_in_cube(random, size);
      boxes[lane] = {low, low};
      for (int axis = 0; axis < 3; ++axis) {
        if (random.uniform() < 0.8) boxes[lane].max[axis] += size * random.uniform();
      }
      const Aabb<float> rounded = arrays.rounded_out(boxes[lane]);
      node.set_box(lane, rounded);
      for (int axis = 0; axis < 3; ++axis) {
        arrays.extent_m = std::max({arrays.extent_m, std::abs(rounded.min[axis]), std::abs(rounded.max[axis])});
      }
    }
    const auto lane = static_cast<std::uint32_t>(random.next() % simd_lanes);
    // A point of the box, as a rule on its rim.
    Vec3 aim(0), origin(0);
    for (int axis = 0; axis < 3; ++axis) {
      const double kind = random.uniform();
      const Aabb<double>& box = boxes[lane];
      aim[axis] = kind < 0.4   ? box.min[axis]
                  : kind < 0.8 ? box.max[axis]
                               : between(random, box.min[axis], box.max[axis]);
      origin[axis] = random.uniform() < 0.3 ? aim[axis] : aim[axis] + between(random, -distance, distance);
    }
    const double speed = exponent_between(random, -11, 11) / distance;
    Ray<double> ray{origin, speed * (aim - origin), 0.0, infinity};
    if (glm::length(ray.direction) == 0.0) continue;
    for (int axis = 0; axis < 3; ++axis) {
      if (ray.direction[axis] == 0.0 && random.uniform() < 0.5) ray.direction[axis] = -0.0;
    }
    // Where the double ray is at the point, give or take its own rounding.
    const double t = 1.0 / speed;
    if (trial % 2 == 0) ray.t_max = t * (1 + 1e-15);
    if (trial % 3 == 0) ray.t_min = t * (1 - 1e-15);
    const WideRay wide(ray, arrays.origin_m, arrays.extent_m);
    if (!wide.usable()) continue;
    Float8 entry;
    const std::uint32_t missed = WideRay::BoxTest(wide, wide.t_max()).misses(node, entry).bits();
    INFO(text_of(ray));
    REQUIRE((missed >> lane & 1U) == 0U);
    REQUIRE(static_cast<double>(entry[lane]) <= static_cast<double>(WideRay::padded(t)));
  }
}

TEST_CASE("boxes well beside a ray are not met: the margins are roundings") {
  RandomStream random(41);
  for (int trial = 0; trial < 20000; ++trial) {
    WideArrays arrays;
    WideNode node;
    const Aabb<float> box{Vector3<float>(-1.0F), Vector3<float>(1.0F)};
    node.set_box(3, box);
    arrays.extent_m = 1.0F;
    // Beside the face x = 1 by 1e-5 m, from at most 20 m.
    const Vec3 from(1.00001, between(random, -20, -10), between(random, -1, 1));
    const WideRay wide({from, Vec3(0, exponent_between(random, -3, 3), 0)}, Vec3(0), arrays.extent_m);
    Float8 entry;
    REQUIRE(wide.usable());
    REQUIRE(WideRay::BoxTest(wide, wide.t_max()).misses(node, entry).bits() == 0xffU);
  }
}

TEST_CASE("which rays single precision follows") {
  const auto usable = [](const Ray<double>& ray) { return WideRay(ray, Vec3(0), 10.0F).usable(); };
  const Vec3 from(1, 2, 3), along(0, 0, 1);
  CHECK(usable({from, along}));
  CHECK(usable({from, 1e-11 * along}));
  CHECK(usable({from, 1e11 * along}));
  CHECK(usable({from, along, 0.0, 0.0}));
  CHECK(usable({from - 0.9e6 * along, along}));
  CHECK(!usable({from - 1.1e6 * along, along}));
  for (const double bad : {dcem_test::not_a_number, infinity, -infinity}) {
    for (int axis = 0; axis < 3; ++axis) {
      Ray<double> ray{from, along};
      ray.origin[axis] = bad;
      CHECK(!usable(ray));
      ray = {from, along};
      ray.direction[axis] = bad;
      CHECK(!usable(ray));
    }
    CHECK(!usable({from, along, bad, -1.0}));
  }
  CHECK(!usable({from, along, 0.0, dcem_test::not_a_number}));
  CHECK(!usable({from, along, dcem_test::not_a_number, infinity}));
  CHECK(!usable({from, along, -0.5, infinity}));
  CHECK(!usable({from, along, 2.0, 1.0}));
  CHECK(!usable({from, 1e-13 * along}));
  CHECK(!usable({from, 1e13 * along}));
  CHECK(!usable({1e13 * along, along}));
  CHECK(!usable({from, Vec3(0)}));
}

TEST_CASE("a padded t is never rounded down") {
  RandomStream random(51);
  for (int trial = 0; trial < 100000; ++trial) {
    const double t = exponent_between(random, -30, 29);
    REQUIRE(static_cast<double>(WideRay::padded(t)) >= t);
    REQUIRE(static_cast<double>(WideRay::padded(t)) <= t * (1 + 1e-6));
  }
  CHECK(WideRay::padded(infinity) >= 1e30F);
}

}  // namespace test_ray
