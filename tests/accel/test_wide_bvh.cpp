#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "dcem/accel/brute_force.hpp"
#include "dcem/accel/wide_bvh.hpp"
#include "tests/accel/wide/wide_scenes.hpp"
#include "tests/support/shared_data.hpp"

namespace test_wide_bvh {

using namespace dcem;
using dcem_test::any_ray;
using dcem_test::exact_hits;
using dcem_test::fault_of_closest;
using dcem_test::fault_of_hits;
using dcem_test::hits_on_line;
using dcem_test::infinity;
using dcem_test::not_a_number;
using dcem_test::OracleHit;
using dcem_test::reported;
using dcem_test::text_of;
using dcem_test::WideMesh;

namespace {

struct Built {
  WideMesh mesh;
  std::vector<Aabb<double>> boxes;
  WideBvh tree;
  bool has_lines = false;

  explicit Built(WideMesh given, const WideBuildSettings& settings = {}) : mesh(std::move(given)), boxes(mesh.boxes()) {
    for (std::uint32_t triangle = 0; triangle < mesh.triangles.size(); ++triangle) {
      has_lines = has_lines || dcem_test::is_line(mesh.corners(triangle));
    }
    tree.build(mesh.view(), boxes, settings);
    REQUIRE(tree.validate(boxes) == "");
  }
  Aabb<double> bounds() const {
    Aabb<double> all;
    for (const Aabb<double>& box : boxes) all.extend(box);
    return all;
  }
};

/// All queries of one ray: against the oracle that knows how far roundings reach, and to the last bit against the same
/// arithmetic without a tree.
void check_ray(const Built& scene, const Ray<double>& ray) {
  INFO(text_of(ray));
  const std::vector<OracleHit> line = hits_on_line(scene.mesh, ray);
  REQUIRE(fault_of_closest(line, ray, scene.tree.closest_hit(ray)) == "");
  const auto is_sound = [&](const TriangleHit& hit) { return !dcem_test::is_line(scene.mesh.corners(hit.triangle)); };
  const HitFilter filter = scene.has_lines ? filter_by(is_sound) : HitFilter{};
  REQUIRE(fault_of_hits(scene.tree, exact_hits(scene.mesh, ray, filter), ray, filter) == "");
  const int in_the_way = dcem_test::oracle_occluded(line, ray);
  if (in_the_way >= 0) REQUIRE(scene.tree.occluded(ray) == (in_the_way == 1));
}

void check_rays(const Built& scene, int trials, std::uint64_t seed) {
  RandomStream random(seed);
  const Aabb<double> bounds = scene.bounds();
  std::vector<RayQuery> queries;
  for (int trial = 0; trial < trials; ++trial) {
    queries.push_back({any_ray(random, scene.mesh, bounds)});
    check_ray(scene, queries.back().ray);
  }
  std::vector<std::optional<TriangleHit>> hits(queries.size());
  scene.tree.closest_hits(queries, hits);
  int found = 0;
  for (std::size_t ray = 0; ray < queries.size(); ++ray) {
    INFO(text_of(queries[ray].ray));
    REQUIRE(hits[ray] == scene.tree.closest_hit(queries[ray].ray));
    found += hits[ray] ? 1 : 0;
  }
  CHECK(found > trials / 20);
}

void check_regions(const Built& scene, int trials, std::uint64_t seed) {
  BruteForce<double> oracle;
  oracle.build(scene.boxes);
  RandomStream random(seed);
  for (int trial = 0; trial < trials; ++trial) {
    const auto region = dcem_test::random_box<double>(random);
    const auto low_enough = [&](const Aabb<double>& box) { return box.min.x + 2 * box.min.y < region.max.z; };
    REQUIRE(reported([&](auto leaf) { scene.tree.overlapping(region, leaf); }) ==
            reported([&](auto leaf) { oracle.overlapping(region, leaf); }));
    REQUIRE(reported([&](auto leaf) { scene.tree.visit(low_enough, leaf); }) ==
            reported([&](auto leaf) { oracle.visit(low_enough, leaf); }));
  }
}

/// Small regions that end on a face of a triangle's box, to the last bit or one number beside it.
void check_touching_regions(const Built& scene, int trials, std::uint64_t seed) {
  BruteForce<double> oracle;
  oracle.build(scene.boxes);
  RandomStream random(seed);
  const auto any_of = [&](std::size_t count) {
    return static_cast<std::size_t>(random.uniform() * static_cast<double>(count));
  };
  int asked = 0, touching = 0;
  while (asked < trials) {
    const Aabb<double>& box = scene.boxes[any_of(scene.boxes.size())];
    if (box.empty()) continue;
    ++asked;
    const auto axis = static_cast<int>(any_of(3));
    const Vec3 middle_m = box.center();
    Aabb<double> region = inflated(Aabb<double>{middle_m, middle_m}, 1e-3);
    const bool is_above = random.uniform() < 0.5;
    double face_m = is_above ? box.max[axis] : box.min[axis];
    const std::size_t beside = any_of(3);  // on it, just inside, just outside
    if (beside > 0) face_m = std::nextafter(face_m, (beside == 1) == is_above ? -infinity : infinity);
    (is_above ? region.min : region.max)[axis] = face_m;
    (is_above ? region.max : region.min)[axis] = is_above ? face_m + 2e-3 : face_m - 2e-3;
    const auto expected = reported([&](auto leaf) { oracle.overlapping(region, leaf); });
    REQUIRE(reported([&](auto leaf) { scene.tree.overlapping(region, leaf); }) == expected);
    touching += expected.empty() ? 0 : 1;
  }
  CHECK(touching > trials / 3);
}

WideMesh moved_by(const WideMesh& mesh, double scale, const Vec3& shift) {
  return mesh.changed([&](const Vec3& vertex) { return scale * vertex + shift; });
}

WideMesh without_every(const WideMesh& mesh, std::uint32_t step) {
  WideMesh result = mesh;
  result.absent.assign(mesh.triangles.size(), false);
  for (std::size_t triangle = 0; triangle < mesh.triangles.size(); triangle += step) result.absent[triangle] = true;
  return result;
}

}  // namespace

TEST_CASE("soups, boxes, balls: every query gives the oracle's answer") {
  for (const std::size_t count : {1U, 2U, 3U, 8U, 9U, 40U, 700U}) {
    CAPTURE(count);
    const Built scene(dcem_test::soup(count, count));
    check_rays(scene, count < 100 ? 400 : 1500, 10 + count);
    check_regions(scene, 300, 20 + count);
  }
  check_rays(Built(dcem_test::boxes_mesh(60, 31)), 3000, 32);
  check_regions(Built(dcem_test::boxes_mesh(60, 31)), 500, 33);
  check_rays(Built(dcem_test::ball(Vec3(0.3, 0.2, 0.1), 5.0, 12)), 3000, 34);
}

TEST_CASE(
    "a region that touches the box of a triangle finds it, and one a number beside it does not, however far away") {
  for (const Vec3& shift : {Vec3(0.0), Vec3(3e5, -5e6, 40.0)}) {
    for (const double scale : {1e-3, 1.0, 200.0}) {
      CAPTURE(scale);
      check_touching_regions(Built(moved_by(dcem_test::soup(700, 5), scale, shift)), 3000, 35);
      // Flat quads that lie askew: each of their corners may reach farthest.
      check_touching_regions(Built(moved_by(dcem_test::ball(Vec3(0.3, 0.2, 0.1), 5.0, 12), scale, shift)), 1000, 37);
      check_touching_regions(Built(without_every(moved_by(dcem_test::boxes_mesh(60, 31), scale, shift), 3)), 1000, 36);
    }
  }
}

TEST_CASE("a dirty mesh: needles, no area, repeated points, triangles drawn twice") {
  check_rays(Built(dcem_test::dirty_mesh(60, 41)), 6000, 42);
}

TEST_CASE("a triangle drawn twice is as solid as one drawn once") {
  // Same vertices; a copy of the third; a third moved along the shared edge, so that the areas cancel to the bit.
  for (const int kind : {0, 1, 2}) {
    CAPTURE(kind);
    WideMesh mesh;
    for (const Vec3& vertex : {Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(1, 2, 0), Vec3(1, 2, 0), Vec3(2, 2, 0)}) {
      mesh.add_vertex(vertex);
    }
    mesh.add(0, 1, 2);
    kind == 0 ? mesh.add(0, 1, 2) : mesh.add(0, 1, kind == 1 ? 3U : 4U);
    const Built scene(mesh);
    CHECK(scene.tree.closest_hit({Vec3(1.5, 1, 5), Vec3(0, 0, -1)}).has_value());
    CHECK(scene.tree.occluded({Vec3(1.5, 1, 5), Vec3(0, 0, -1)}));
    check_rays(scene, 1000, 43);
  }
}

TEST_CASE("bent quadrilaterals, also along their surface") {
  for (const double bend_m : {1e-7, 1e-5, 2e-4}) {
    CAPTURE(bend_m);
    const Built scene(dcem_test::bent_ground(16, bend_m, 51));
    check_rays(scene, 2000, 52);
    RandomStream random(53);
    for (int trial = 0; trial < 6000; ++trial) {
      const double height = 4 * bend_m;
      const Vec3 from(dcem_test::between(random, -8, 8), dcem_test::between(random, -8, 8),
                      dcem_test::between(random, -height, height));
      const Vec3 to(dcem_test::between(random, -8, 8), dcem_test::between(random, -8, 8),
                    dcem_test::between(random, -height, height));
      Ray<double> ray = segment_between(from, to);
      if (trial % 3 == 0) ray.t_min = random.uniform();
      check_ray(scene, ray);
    }
  }
}

TEST_CASE("a pair folded at its diagonal, met twice: the nearer hit counts, and the farther from behind it") {
  // A lid of 1 m whose fourth corner hangs 0.9 mm too low; the ray comes in under the ridge along both faces.
  WideMesh mesh;
  for (const Vec3& vertex : {Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0), Vec3(0, 0, -9e-4)}) mesh.add_vertex(vertex);
  mesh.add(0, 1, 2);
  mesh.add(0, 2, 3);
  const Built scene(mesh);
  RandomStream random(55);
  for (int trial = 0; trial < 5000; ++trial) {
    const Vec3 from(-1, -1 + random.uniform(), -9e-4 * random.uniform() - 3e-4);
    const Vec3 to(1.5, 0.5 + random.uniform(), 3e-4 * random.uniform());
    Ray<double> ray = segment_between(from, to);
    if (trial % 2 == 0) ray.t_min = random.uniform();
    if (trial % 5 == 0) ray.t_max = ray.t_min + random.uniform();
    check_ray(scene, ray);
  }
}

TEST_CASE("shifted by 10 km, huge and tiny: the answers are those of double precision") {
  const WideMesh mesh = dcem_test::boxes_mesh(40, 61);
  const WideMesh pieces = dcem_test::soup(200, 62);
  for (const WideMesh& given : {mesh, pieces}) {
    check_rays(Built(moved_by(given, 1.0, Vec3(1e4, -1e4, 300.0))), 1500, 63);
    check_rays(Built(moved_by(given, 1e-6, Vec3(0.0))), 1500, 64);
    check_rays(Built(moved_by(given, 1e-7, Vec3(0.3, 0.1, 0.2))), 1500, 64);
    check_rays(Built(moved_by(given, 1e9, Vec3(0.0))), 1500, 65);
    check_rays(Built(moved_by(given, 1e13, Vec3(0.0))), 1500, 66);
  }
}

TEST_CASE("small things far from zero: 1e9 m and 1e14 m away") {
  const WideMesh pieces = dcem_test::soup(200, 71);
  check_rays(Built(moved_by(pieces, 1.0, Vec3(1e9, -1e9, 1e9))), 1500, 72);
  check_rays(Built(moved_by(pieces, 1.0, Vec3(1e14, 1e14, -1e14))), 1500, 73);
}

TEST_CASE("one thing beside the origin of a map, another at its far end") {
  WideMesh mesh = moved_by(dcem_test::soup(100, 75), 1e-3, Vec3(-2e4, 1e4, 0));
  mesh.append(moved_by(dcem_test::soup(100, 76), 1e-3, Vec3(3e4, -1e4, 0)));
  const Built scene(mesh);
  RandomStream random(77);
  const Aabb<double> there = inflated(Aabb<double>{Vec3(-2e4, 1e4, 0), Vec3(-2e4, 1e4, 0)}, 0.01);
  for (int trial = 0; trial < 3000; ++trial) check_ray(scene, any_ray(random, mesh, there));
}

TEST_CASE("objects stacked on one point") {
  WideMesh mesh;
  for (int copy = 0; copy < 60; ++copy) mesh.append(dcem_test::box_mesh(Vec3(-1), Vec3(1)));
  check_rays(Built(mesh), 1000, 81);
  WideMesh points;
  for (int copy = 0; copy < 100; ++copy) points.add(Vec3(1), Vec3(1), Vec3(1));
  points.append(dcem_test::box_mesh(Vec3(-1), Vec3(1)));
  check_rays(Built(points), 1000, 82);
}

TEST_CASE("sizes that double from one to the next: the tree stays shallow enough for its walks") {
  WideMesh mesh;
  double size = 1e-30;
  for (int index = 0; index < 140; ++index, size *= 2) {
    mesh.add(Vec3(size, 0, 0), Vec3(1.3 * size, 0.2 * size, 0), Vec3(1.1 * size, 0.1 * size, 0.4 * size));
  }
  for (const std::uint32_t limit : {512U, 0U}) {
    WideBuildSettings settings;
    settings.object_subtree_limit = limit;
    const Built scene(mesh, settings);
    CHECK(scene.tree.closest_hit({Vec3(1e12, 1e11, 1e11), Vec3(-1, -0.1, -0.1)}).has_value() ==
          !hits_on_line(mesh, {Vec3(1e12, 1e11, 1e11), Vec3(-1, -0.1, -0.1)}).empty());
  }
}

TEST_CASE("an empty tree, and a tree of triangles that are not there") {
  const Built none{WideMesh()};
  const Ray<double> ray{Vec3(0, 0, 5), Vec3(0, 0, -1)};
  const auto all_of = [&](const WideBvh& tree) {
    std::size_t count = 0;
    const auto leaf = [&](std::uint32_t) { ++count; };
    tree.overlapping({Vec3(-100), Vec3(100)}, leaf);
    tree.visit([](const Aabb<double>&) { return true; }, leaf);
    tree.visit_hits(ray, {}, [&](const TriangleHit&) { return ++count, false; });
    return count;
  };
  CHECK(!none.tree.closest_hit(ray));
  CHECK(!none.tree.occluded(ray));
  CHECK(all_of(none.tree) == 0);
  CHECK(none.tree.bounds().empty());
  const Built gone(without_every(dcem_test::boxes_mesh(5, 91), 1));
  CHECK(!gone.tree.closest_hit(ray));
  CHECK(!gone.tree.occluded(ray));
  CHECK(!gone.tree.closest_hit({Vec3(0), Vec3(1e-20, 0, 0)}));
  CHECK(all_of(gone.tree) == 0);
  CHECK(gone.tree.bounds().empty());
}

TEST_CASE("a triangle with an empty box is not there, be it half of a pair") {
  for (const std::uint32_t step : {2U, 3U, 5U}) {
    CAPTURE(step);
    const Built scene(without_every(dcem_test::boxes_mesh(30, 92), step));
    check_rays(scene, 2000, 93);
    check_regions(scene, 300, 94);
  }
}

TEST_CASE("directions of any length, components of zero, and rays from behind") {
  const Built scene(dcem_test::boxes_mesh(40, 111));
  RandomStream random(112);
  for (int trial = 0; trial < 6000; ++trial) {
    Ray<double> ray = any_ray(random, scene.mesh, scene.bounds());
    const double factor = std::pow(10.0, std::round(dcem_test::between(random, -14, 14)));
    ray.direction *= factor;
    ray.t_min /= factor;
    ray.t_max /= factor;
    if (trial % 5 == 0) ray.t_min = -random.uniform() / factor;
    if (trial % 7 == 0) ray.direction[trial % 3] *= 1e-23;
    check_ray(scene, ray);
  }
}

TEST_CASE("a short direction from far away") {
  // The slab of a ray all but parallel to it must not be left early.
  const Built scene(dcem_test::box_mesh(Vec3(-1), Vec3(1)));
  RandomStream random(115);
  for (const double far_m : {1e2, 1e3, 1e5, 1e7, 1e9}) {
    for (const double length : {1.5e-12, 1e-9, 1.0, 1e6}) {
      for (int trial = 0; trial < 200; ++trial) {
        Ray<double> ray;
        const int axis = trial % 3;
        for (int other = 0; other < 3; ++other) {
          ray.origin[other] = trial % 2 == 0 ? 0.9999999 : dcem_test::between(random, -1, 1);
          ray.direction[other] = trial % 4 < 2 ? 0.0 : -0.0;
        }
        ray.origin[axis] = -far_m;
        ray.direction[axis] = length;
        INFO(text_of(ray));
        const auto hit = scene.tree.closest_hit(ray);
        REQUIRE(hit.has_value());
        REQUIRE(hit->t == doctest::Approx((far_m - 1) / length).epsilon(1e-9).scale(0.0));
        REQUIRE(scene.tree.occluded(ray));
      }
    }
  }
}

TEST_CASE("rays that are none meet nothing") {
  WideMesh mesh = dcem_test::boxes_mesh(20, 121);
  mesh.append(dcem_test::soup(60, 122, 20.0));
  const Built scene(mesh);
  const auto meets_nothing = [&](const Ray<double>& ray) {
    INFO(text_of(ray));
    CHECK(!scene.tree.closest_hit(ray));
    CHECK(!scene.tree.occluded(ray));
  };
  const Vec3 from(-30, 0.1, 0.2), along(1, 0.01, 0.02);
  for (const double bad : {not_a_number, infinity, -infinity}) {
    for (int axis = 0; axis < 3; ++axis) {
      Ray<double> ray{from, along};
      ray.origin[axis] = bad;
      meets_nothing(ray);
      ray = {from, along};
      ray.direction[axis] = bad;
      meets_nothing(ray);
    }
    meets_nothing({from, Vec3(bad)});
    meets_nothing({Vec3(bad), along});
  }
  meets_nothing({from, along, not_a_number, infinity});
  meets_nothing({from, along, 0.0, not_a_number});
  meets_nothing({from, along, 40.0, 20.0});
  meets_nothing({from, along, infinity, infinity});
  meets_nothing({from, Vec3(0)});
}

TEST_CASE("hits exactly at t_min and t_max count") {
  const Built scene(dcem_test::box_mesh(Vec3(-1), Vec3(1)));
  for (const double t : {4.0, 6.0}) {
    const auto hit = scene.tree.closest_hit({Vec3(-5, 0.25, 0.125), Vec3(1, 0, 0), t, t});
    REQUIRE(hit.has_value());
    CHECK(hit->t == t);
    CHECK(scene.tree.occluded({Vec3(-5, 0.25, 0.125), Vec3(1, 0, 0), t, t}));
  }
  CHECK(scene.tree.closest_hit({Vec3(-1, 0.25, 0.125), Vec3(1, 0, 0), 0.0, 0.0}).has_value());
}

TEST_CASE("ends just before or behind a surface: the surface is not met, or is") {
  const Built scene(dcem_test::boxes_mesh(30, 125));
  RandomStream random(126);
  int met = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    Ray<double> ray = any_ray(random, scene.mesh, scene.bounds());
    ray.t_min = 0.0, ray.t_max = infinity;
    const auto hit = scene.tree.closest_hit(ray);
    if (!hit || hit->t < 1e-3) continue;
    ++met;
    // Of the order of a rounding in single precision, and far above one in double.
    const double step = std::pow(10.0, dcem_test::between(random, -8.5, -6));
    Ray<double> before = ray, behind = ray, from_before = ray, from_behind = ray;
    before.t_max = hit->t * (1 - step);
    behind.t_max = hit->t * (1 + step);
    from_before.t_min = hit->t * (1 - step);
    from_behind.t_min = hit->t * (1 + step);
    for (const Ray<double>& one : {before, behind, from_before, from_behind}) check_ray(scene, one);
  }
  CHECK(met > 1000);
}

TEST_CASE("boxes in single precision hold those in double, also seen from the world") {
  for (const Vec3& shift : {Vec3(0), Vec3(1e4, -1e4, 3), Vec3(1e9)}) {
    const Built scene(moved_by(dcem_test::boxes_mesh(30, 127), 1.0, shift));
    const WideArrays& arrays = scene.tree.arrays();
    for (const Aabb<double>& box : scene.boxes) {
      const Aabb<float> rounded = arrays.rounded_out(box);
      for (int axis = 0; axis < 3; ++axis) {
        // As long double, in which the difference is exact.
        const long double origin = arrays.origin_m[axis];
        REQUIRE(static_cast<long double>(rounded.min[axis]) <= box.min[axis] - origin);
        REQUIRE(static_cast<long double>(rounded.max[axis]) >= box.max[axis] - origin);
        REQUIRE(arrays.extent_m >= std::max(std::abs(rounded.min[axis]), std::abs(rounded.max[axis])));
      }
      REQUIRE(scene.tree.bounds().contains(box));
      // Regions that touch in one corner or in one face only.
      for (const Aabb<double>& region :
           {Aabb<double>{box.max, box.max + Vec3(1e-3)}, {box.min - Vec3(1e-3), box.min}}) {
        bool is_found = false;
        scene.tree.overlapping(region,
                               [&](std::uint32_t triangle) { is_found = is_found || scene.boxes[triangle] == box; });
        REQUIRE(is_found);
      }
    }
  }
  // A face in the origin of the tree, where single precision leaves no room.
  WideMesh faces = dcem_test::box_mesh(Vec3(-2), Vec3(2));
  faces.add(Vec3(0, 1, 1), Vec3(0, 1.5, 1), Vec3(0, 1, 1.5));
  const Built scene(faces);
  std::size_t count = 0;
  scene.tree.overlapping({Vec3(-0.5, 1, 1), Vec3(0, 1.2, 1.2)},
                         [&](std::uint32_t triangle) { count += triangle == 12; });
  scene.tree.overlapping({Vec3(0, 1, 1), Vec3(0.5, 1.2, 1.2)},
                         [&](std::uint32_t triangle) { count += triangle == 12; });
  CHECK(count == 2);
}

TEST_CASE("of equally near triangles the one with the smallest number") {
  WideMesh mesh;
  for (int copy = 0; copy < 50; ++copy) mesh.append(dcem_test::box_mesh(Vec3(-1), Vec3(1)));
  const Built scene(mesh);
  RandomStream random(131);
  for (int trial = 0; trial < 300; ++trial) {
    const Vec3 aim(dcem_test::between(random, -0.99, 0.99), dcem_test::between(random, -0.99, 0.99), 1.0);
    const auto hit = scene.tree.closest_hit(
        segment_between(Vec3(0.1, 0.2, 9.0), Vec3(0.1, 0.2, 9.0) + 2.0 * (aim - Vec3(0.1, 0.2, 9.0))));
    REQUIRE(hit.has_value());
    REQUIRE(hit->triangle < 12);
  }
}

TEST_CASE("Munich: rays through the town give the oracle's answers") {
  DCEM_NEEDS_SHARED();
  const Built scene(dcem_test::read_obj(dcem::test::shared_path("scenes/munich.obj")));
  REQUIRE(scene.mesh.triangles.size() == 38936);
  check_rays(scene, 300, 141);
}

TEST_CASE("no ray leaks through an edge or a corner of a closed mesh") {
  RandomStream random(151);
  std::vector<WideMesh> closed{dcem_test::box_mesh(Vec3(-1), Vec3(1)), dcem_test::ball(Vec3(0.1), 1.0, 14),
                               dcem_test::box_mesh(Vec3(-1.1, -0.7, -0.3), Vec3(0.9, 1.3, 0.77))};
  const Vec3 axis = glm::normalize(Vec3(1, 2, 3));
  closed.push_back(
      closed[0].changed([&](const Vec3& v) { return v + glm::cross(axis, v) * 0.7 + Vec3(3e3, 2e3, 10); }));
  closed.push_back(closed[1].changed([&](const Vec3& v) { return v * 1e-4 + Vec3(3e3, 2e3, 10); }));
  for (const WideMesh& mesh : closed) {
    const Built scene(mesh);
    const Vec3 centre = scene.bounds().center();
    const double size = scene.bounds().extent().x;
    for (int trial = 0; trial < 40000; ++trial) {
      const auto corners = mesh.corners(static_cast<std::uint32_t>(random.next() % mesh.triangles.size()));
      const double along = trial % 3 == 0 ? 0.0 : random.uniform();
      const Vec3 aim = corners[0] + along * (corners[1] - corners[0]);
      // From within; the point aimed at may be missed by a rounding, the mesh around it may not.
      const Vec3 from = centre + dcem_test::random_in_cube(random, 0.1 * size);
      const Ray<double> ray{from, aim - from};
      INFO(text_of(ray));
      const auto hit = scene.tree.closest_hit(ray);
      REQUIRE(hit.has_value());
      // The point aimed at is rounded to 5e-13 m, 3 km from zero.
      REQUIRE(std::abs(hit->t - 1.0) < 1e-9 + 4e-12 / glm::length(ray.direction));
      REQUIRE(scene.tree.occluded(ray));
    }
  }
}

TEST_CASE("in huge pages or not, the tree is the same") {
  const dcem_test::WideMesh mesh = dcem_test::soup(40'000, 4);  // some megabytes of leaves
  const std::vector<Aabb<double>> boxes = mesh.boxes();
  WideBvh tree, other;
  tree.build(mesh.view(), boxes);
  other.build(mesh.view(), boxes, {.huge_pages = false});
  CHECK(tree.arrays().leaves.get_allocator().asks());
  CHECK_FALSE(other.arrays().leaves.get_allocator().asks());
  REQUIRE(std::span(tree.arrays().leaves).size_bytes() > HugePageAllocator<QuadLeaf>::least_bytes);
  const auto same = [](const auto& one, const auto& another, auto member) {
    return std::ranges::equal(one, another, {}, member, member);
  };
  for (int turn = 0; turn < 2; ++turn) {
    CHECK(same(tree.arrays().nodes, other.arrays().nodes, &WideNode::bounds_m));
    CHECK(same(tree.arrays().nodes, other.arrays().nodes, &WideNode::child));
    CHECK(same(tree.arrays().leaves, other.arrays().leaves, &QuadLeaf::corner_m));
    CHECK(other.validate(boxes).empty());
    // What was asked for in one way is given back before it is asked for in the other.
    other.build(mesh.view(), boxes);
    CHECK(other.arrays().leaves.get_allocator().asks());
  }
}

TEST_CASE("what is switched off changes no answer") {
  const dcem_test::WideMesh mesh = dcem_test::soup(3000, 8);
  const std::vector<Aabb<double>> boxes = mesh.boxes();
  WideBvh tree, other;
  tree.build(mesh.view(), boxes);
  other.build(mesh.view(), boxes,
              {.pair_flatness = -1.0, .huge_pages = false, .divide_by_size = false, .fetch_ahead = false});
  CHECK(other.validate(boxes).empty());
  std::size_t hits = 0;
  RandomStream random(5);
  for (int turn = 0; turn < 2000; ++turn) {
    const Ray<double> ray{dcem_test::random_point<double>(random, 10.0), dcem_test::random_direction(random)};
    const auto expected = tree.closest_hit(ray), found = other.closest_hit(ray);
    REQUIRE(found.has_value() == expected.has_value());
    if (!found) continue;
    ++hits;
    REQUIRE(found->t == expected->t);
    REQUIRE(found->triangle == expected->triangle);
  }
  CHECK(hits > 500);
}

TEST_CASE("bad input is refused before anything changes") {
  const WideMesh mesh = dcem_test::boxes_mesh(10, 161);
  Built scene(mesh);
  const Ray<double> ray{Vec3(30, 0.3, 0.2), Vec3(-1, 0, 0)};
  const auto refused = [&](auto&& edit) {
    CHECK_THROWS_AS(edit(), std::invalid_argument);
    REQUIRE(scene.tree.validate(scene.boxes) == "");
    REQUIRE(scene.tree.object_count() == 1);
  };
  const std::vector<std::uint32_t> whole{0};
  std::vector<std::uint32_t> all(mesh.triangles.size());
  for (std::uint32_t triangle = 0; triangle < all.size(); ++triangle) all[triangle] = triangle;
  const WideMesh other = mesh.changed([](const Vec3& vertex) { return vertex + Vec3(1); });
  for (const double bad : {not_a_number, infinity, -1e16}) {
    auto boxes = other.boxes();
    boxes[100].min.y = bad;
    if (bad == infinity) boxes[100] = {Vec3(-infinity), Vec3(infinity)};
    refused([&] { scene.tree.build(other.view(), boxes); });
    refused([&] { scene.tree.build_objects(other.view(), boxes, whole); });
    refused([&] { scene.tree.rebuild(other.view(), boxes); });
    refused([&] { scene.tree.refit(all, other.view(), boxes); });
  }
  auto few = other.boxes();
  few.pop_back();
  WideMesh smaller = other;
  smaller.triangles.pop_back();
  refused([&] { scene.tree.build(other.view(), few); });
  refused([&] { scene.tree.refit(all, other.view(), few); });
  refused([&] { scene.tree.refit(all, smaller.view(), few); });
  refused([&] { scene.tree.refit(all, smaller.view(), other.boxes()); });
  refused([&] { scene.tree.refit(std::vector<std::uint32_t>{0, 1, 120}, other.view(), other.boxes()); });
  for (const std::vector<std::uint32_t>& first :
       {std::vector<std::uint32_t>{}, {1}, {0, 50, 40}, {0, 121}, {0, 0xffffffffU}}) {
    refused([&] { scene.tree.build_objects(other.view(), other.boxes(), first); });
  }
  for (const WideBuildSettings& settings :
       {WideBuildSettings{WideCosts{0.0, 1.0}}, WideBuildSettings{WideCosts{1.0, NAN}},
        WideBuildSettings{WideCosts{}, NAN}, WideBuildSettings{WideCosts{}, 1e-3, 512, 0},
        WideBuildSettings{WideCosts{}, 1e-3, 512, 9}}) {
    refused([&] { scene.tree.build(other.view(), other.boxes(), settings); });
  }
  CHECK(scene.tree.closest_hit(ray).has_value() == !hits_on_line(mesh, ray).empty());
}

TEST_CASE("corners that name no vertex, are refused") {
  WideMesh mesh = dcem_test::boxes_mesh(10, 165);
  Built scene(mesh);
  WideMesh astray = mesh;
  astray.triangles[7][1] = 1000;
  CHECK_THROWS_AS(scene.tree.build(astray.view(), scene.boxes), std::invalid_argument);
  WideMesh other_way = mesh;
  std::swap(other_way.triangles[7][0], other_way.triangles[9][0]);
  CHECK_THROWS_AS(scene.tree.rebuild(other_way.view(), scene.boxes), std::invalid_argument);
  WideMesh shorter = mesh;
  shorter.vertices.pop_back();
  CHECK_THROWS_AS(scene.tree.refit(std::vector<std::uint32_t>{7}, shorter.view(), scene.boxes), std::invalid_argument);
  REQUIRE(scene.tree.validate(scene.boxes) == "");
}

TEST_CASE("what only touches the border of a region is found in the middle of a scene far from the world's origin") {
  // The tree counts from the middle: there it widens a box by next to nothing, and the way back to the world must.
  WideMesh mesh;
  for (int row = 0; row < 16; ++row) {
    mesh.add(Vec3(4086, row, 0), Vec3(4095, row, 0), Vec3(4095, row, 1));
    mesh.add(Vec3(4096, row, 0), Vec3(4106, row, 0), Vec3(4106, row, 1));
  }
  const Built scene(mesh);
  const auto begins_before_middle = [](const Aabb<double>& box) { return box.min.x <= 4096.0; };
  CHECK(reported([&](auto leaf) { scene.tree.visit(begins_before_middle, leaf); }).size() == mesh.triangles.size());
  const Built mirrored(mesh.changed([](const Vec3& vertex) { return Vec3(8192.0 - vertex.x, vertex.y, vertex.z); }));
  const auto ends_beyond_middle = [](const Aabb<double>& box) { return box.max.x >= 4096.0; };
  CHECK(reported([&](auto leaf) { mirrored.tree.visit(ends_beyond_middle, leaf); }).size() == mesh.triangles.size());
}

}  // namespace test_wide_bvh
