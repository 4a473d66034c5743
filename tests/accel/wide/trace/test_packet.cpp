/// Rays from one point that go through a tree together: the answers of rays that go alone, which an index in double
/// precision throughout gives as well, for a fraction of the steps.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "dcem/accel/binary_index.hpp"
#include "dcem/accel/wide_bvh.hpp"
#include "dcem/core/random.hpp"
#include "dcem/paths/discover/launch_sphere.hpp"
#include "tests/accel/wide/wide_scenes.hpp"

namespace test_packet {

using namespace dcem;
using dcem_test::WideMesh;

namespace {

double between(RandomStream& random, double low, double high) {
  return low + (high - low) * random.uniform();
}

/// A wall of two triangles that share an edge, from a corner along two ways; the fourth corner is off by `bend_m`.
void add_wall(WideMesh& mesh, const Vec3& corner_m, const Vec3& along_m, const Vec3& up_m, const Vec3& bend_m) {
  const std::uint32_t a = mesh.add_vertex(corner_m), b = mesh.add_vertex(corner_m + along_m);
  const std::uint32_t c = mesh.add_vertex(corner_m + along_m + up_m);
  const std::uint32_t d = mesh.add_vertex(corner_m + up_m + bend_m);
  mesh.add(a, b, c);
  mesh.add(a, c, d);
}

/// Houses on a plain: walls in pairs of triangles, party walls that lie in each other, and roofs that are bent a
/// little. The objects: one half and the other.
struct Town {
  WideMesh mesh;
  std::array<std::uint32_t, 2> object_first{0, 0};
  WideBvh tree;
  BinaryIndex twin;

  Town(std::uint64_t seed, int houses, double scale = 1.0) {
    RandomStream random(seed);
    add_wall(mesh, Vec3(-300, -300, 0), Vec3(600, 0, 0), Vec3(0, 600, 0), Vec3(0));
    for (int house = 0; house < houses; ++house) {
      if (house == houses / 2) object_first[1] = static_cast<std::uint32_t>(mesh.triangles.size());
      add_house(random);
    }
    for (Vec3& vertex_m : mesh.vertices) vertex_m *= scale;
    const std::vector<Aabb<double>> boxes = mesh.boxes();
    tree.build_objects(mesh.view(), boxes, object_first);
    twin.build(mesh.view(), boxes, object_first);
  }

 private:
  void add_house(RandomStream& random) {
    const Vec3 at_m(std::round(between(random, -15, 15)) * 12.0, std::round(between(random, -15, 15)) * 12.0, 0.0);
    const Vec3 size_m(12.0, 12.0, between(random, 5, 30)), x(size_m.x, 0, 0), y(0, size_m.y, 0), z(0, 0, size_m.z);
    add_wall(mesh, at_m, x, z, Vec3(0));
    add_wall(mesh, at_m, y, z, Vec3(0));
    add_wall(mesh, at_m + y, x, z, Vec3(0));
    add_wall(mesh, at_m + x, y, z, Vec3(0));
    add_wall(mesh, at_m + z, x, y, Vec3(0, 0, between(random, 0.0, 1e-5)));
  }
};

/// Of three triangles the one that the context names, so that each ray is asked about with its own.
constexpr std::array<std::uint32_t, 3> thirds{0, 1, 2};
constexpr bool (*is_of_a_third)(const void*, const TriangleHit&) = [](const void* context, const TriangleHit& hit) {
  return hit.triangle % 3 == *static_cast<const std::uint32_t*>(context);
};

/// A sphere of rays from a point, as a receiver launches them.
std::vector<RayQuery> sphere(const Vec3& from_m, std::uint32_t rays, RandomStream& random) {
  const Mat3 turned = random_rotation(random);
  std::vector<RayQuery> queries;
  for (const Vec3& direction : launch_directions(rays)) queries.push_back({{from_m, turned * direction}});
  return queries;
}

struct Work {
  TraversalCounters together, alone;
};

/// Asks all at once, one by one, and the twin; in blocks, so that runs are cut anywhere.
Work check(const Town& town, std::span<const RayQuery> queries, std::size_t block) {
  Work work;
  std::vector<std::optional<TriangleHit>> hits(queries.size());
  for (std::size_t first = 0; first < queries.size(); first += block) {
    const std::size_t count = std::min(block, queries.size() - first);
    town.tree.closest_hits(queries.subspan(first, count), std::span(hits).subspan(first, count), &work.together);
  }
  for (std::size_t ray = 0; ray < queries.size(); ++ray) {
    CAPTURE(ray);
    const RayQuery& query = queries[ray];
    REQUIRE(hits[ray] == town.tree.closest_hit(query.ray, query.filter, &work.alone));
    REQUIRE(hits[ray] == town.twin.closest_hit(query.ray, query.filter));
  }
  return work;
}

/// The rays of questions that are alike but for their directions.
std::vector<Vec3> directions_of(std::span<const RayQuery> queries) {
  std::vector<Vec3> directions;
  for (const RayQuery& query : queries) directions.push_back(query.ray.direction);
  return directions;
}

/// What a fan meets, and the work that it takes.
struct FanTold {
  std::vector<std::optional<TriangleHit>> hits;
  TraversalCounters counters;

  std::size_t hit_count() const {
    return static_cast<std::size_t>(std::ranges::count_if(hits, [](const auto& hit) { return hit.has_value(); }));
  }
  friend bool operator==(const FanTold&, const FanTold&) = default;
};

/// Asks for a fan and for its rays with a filter each, in the same blocks: the same answers for the same work.
FanTold check_fan(const Town& town, const Vec3& from_m, std::span<const Vec3> directions, const HitFilter& filter,
                  std::size_t block) {
  FanTold told;
  TraversalCounters as_rays;
  for (std::size_t first = 0; first < directions.size(); first += block) {
    const std::span<const Vec3> own = directions.subspan(first, std::min(block, directions.size() - first));
    std::vector<RayQuery> queries;
    for (const Vec3& direction : own) queries.push_back({{from_m, direction}, filter});
    std::vector<std::optional<TriangleHit>> hits(own.size(), TriangleHit{-1.0, 77}), expected = hits;
    town.tree.closest_hits(RayFan{from_m, own, filter}, hits, &told.counters);
    town.tree.closest_hits(queries, expected, &as_rays);
    REQUIRE(hits == expected);
    town.twin.closest_hits(RayFan{from_m, own, filter}, expected);
    REQUIRE(hits == expected);
    told.hits.insert(told.hits.end(), hits.begin(), hits.end());
  }
  CHECK(told.counters == as_rays);
  // A hit is told by a triangle that was looked at.
  CHECK(told.counters.primitives_tested >= told.hit_count());
  return told;
}

}  // namespace

TEST_CASE("a sphere of rays meets what its rays meet one by one, for a quarter of their steps") {
  RandomStream random(1);
  for (const std::uint32_t rays : {30U, 200U, 2000U, 20000U}) {
    CAPTURE(rays);
    const Town town(rays, 150);
    Work all;
    for (const Vec3& from_m : {Vec3(3, 2, 1.5), Vec3(-40, 70, 40), Vec3(100, -200, 900)}) {
      const Work work = check(town, sphere(from_m, rays, random), 1024);
      all.together += work.together;
      all.alone += work.alone;
    }
    if (rays >= 2000) CHECK(4 * all.together.nodes_visited < all.alone.nodes_visited);
  }
}

TEST_CASE("rays of a sphere from a wall, from a corner and from far away") {
  RandomStream random(2);
  const Town town(2, 100);
  const Vec3 corner_m = town.mesh.vertices[8], next_m = town.mesh.vertices[9], above_m = town.mesh.vertices[10];
  for (const Vec3& from_m : {corner_m, 0.5 * (corner_m + next_m), 0.3 * corner_m + 0.3 * next_m + 0.4 * above_m,
                             Vec3(0, 0, 0), Vec3(1e4, 2e3, 5e3), Vec3(1e7, 0, 1e6), Vec3(1e9, 1e9, 1e9)}) {
    CAPTURE(from_m.x);
    check(town, sphere(from_m, 2000, random), 700);
  }
  // From far away, towards the houses.
  std::vector<RayQuery> queries;
  for (int ray = 0; ray < 2000; ++ray) {
    const Vec3 to_m(between(random, -200, 200), between(random, -200, 200), between(random, 0, 30));
    queries.push_back({{Vec3(3e5, 2e5, 1e5), to_m - Vec3(3e5, 2e5, 1e5)}});
  }
  check(town, queries, 2000);
}

TEST_CASE("rays of a packet end where each of them ends, and each has its own filter") {
  RandomStream random(3);
  const Town town(3, 120);
  for (int trial = 0; trial < 30; ++trial) {
    CAPTURE(trial);
    const Vec3 from_m(between(random, -150, 150), between(random, -150, 150), between(random, 1, 60));
    std::vector<RayQuery> queries = sphere(from_m, trial % 2 == 0 ? 500 : 3000, random);
    for (RayQuery& query : queries) {
      const double kind = random.uniform();
      if (kind < 0.2) query.ray.t_max = std::pow(10.0, between(random, -2.0, 3.0));
      if (kind > 0.9) query.ray.t_max = trial % 3 == 0 ? 0.0 : 1e300;
      if (trial % 3 == 1 && kind > 0.1 && kind < 0.3) query.ray.t_min = between(random, 0.0, 30.0);
      if (trial % 5 == 2) query.ray.direction *= std::pow(10.0, between(random, -8.0, 8.0));
      if (trial % 4 == 0) continue;
      if (trial % 4 == 3 || random.uniform() < 0.3) {
        query.filter.counts = is_of_a_third;
        query.filter.context = &thirds[random.next() % 3];
        query.filter.sure_from = static_cast<float>(trial % 4 == 3 ? 20.0 : between(random, 0.0, 60.0));
        query.filter.sure_to = static_cast<float>(trial % 8 == 3 ? 50.0 : between(random, 40.0, 400.0));
      }
      if (random.uniform() < 0.1) query.filter.ignored_objects[random.next() % 2] = random.next() % 2 == 0 ? 0U : 1U;
    }
    check(town, queries, 1 + static_cast<std::size_t>(random.next() % 1500));
  }
}

TEST_CASE("rays that are no packet: in any order, from two points in turns, with numbers that lead nowhere") {
  RandomStream random(4);
  const Town town(4, 80);
  std::vector<RayQuery> queries = sphere(Vec3(5, 5, 2), 3000, random);
  for (std::size_t ray = queries.size(); ray > 1; --ray) {
    std::swap(queries[ray - 1], queries[random.next() % ray]);
  }
  check(town, queries, 1024);
  queries = sphere(Vec3(5, 5, 2), 2000, random);
  for (std::size_t ray = 0; ray < queries.size(); ray += 3 + random.next() % 40) queries[ray].ray.origin.z += 1.0;
  check(town, queries, 333);
  const double infinite = dcem_test::infinity, nothing = dcem_test::not_a_number;
  queries = sphere(Vec3(5, 5, 2), 2000, random);
  for (std::size_t ray = 0; ray < queries.size(); ray += 1 + random.next() % 20) {
    Ray<double>& own = queries[ray].ray;
    const std::array<double, 6> odd{0.0, nothing, infinite, 1e-30, 1e30, -1.0};
    const double number = odd[random.next() % odd.size()];
    if (ray % 4 == 0) own.direction[static_cast<int>(ray % 3)] = number;
    if (ray % 4 == 1) own.direction *= number;
    if (ray % 4 == 2) own.t_max = number;
    if (ray % 4 == 3) own.origin[static_cast<int>(ray % 3)] = number;
  }
  check(town, queries, 512);
}

TEST_CASE("spheres of rays in scenes of any size, with directions of any length") {
  RandomStream random(7);
  for (const double scale : {1e-15, 1e-12, 1e-9, 1e-3, 1e6, 1e9, 3e10, 3e12}) {
    CAPTURE(scale);
    const Town town(7, 60, scale);
    for (const double length : {1.0, 1e-12, 1e-10, 3e-9, 1e-4, 1e5, 3e8, 1e10, 1e12}) {
      CAPTURE(length);
      std::vector<RayQuery> queries = sphere(scale * Vec3(4, 3, 25), 400, random);
      for (RayQuery& query : queries) query.ray.direction *= length * between(random, 0.5, 1.0);
      check(town, queries, 400);
    }
  }
}

TEST_CASE("rays of a packet end at a hit, or as little before it or after it as numbers allow") {
  RandomStream random(8);
  const Town town(8, 100);
  std::vector<RayQuery> queries = sphere(Vec3(4, 3, 25), 3000, random);
  for (RayQuery& query : queries) {
    const std::optional<TriangleHit> hit = town.twin.closest_hit(query.ray, {});
    if (!hit) continue;
    const double towards = random.next() % 3 == 0 ? 0.0 : dcem_test::infinity;
    query.ray.t_max = random.next() % 3 == 0 ? hit->t : std::nextafter(hit->t, towards);
  }
  check(town, queries, 3000);
}

TEST_CASE("rays that ignore an object which they do not meet take the steps of rays that ignore none") {
  RandomStream random(9);
  const Town town(9, 150);
  std::vector<RayQuery> queries = sphere(Vec3(4, 3, 25), 1999, random);
  const TraversalCounters expected = check(town, queries, 45).together;
  for (RayQuery& query : queries) query.filter.ignored_objects[1] = 77;
  CHECK(check(town, queries, 45).together.nodes_visited == expected.nodes_visited);
}

TEST_CASE("a fan meets what its rays meet with a filter each, for the same work") {
  RandomStream random(11);
  for (int trial = 0; trial < 60; ++trial) {
    CAPTURE(trial);
    const Town town(11 + static_cast<std::uint64_t>(trial % 5), 100);
    const Vec3 corner_m = town.mesh.vertices[8];
    const bool is_far = trial % 10 == 1;
    const Vec3 from_m = is_far            ? Vec3(3e5, 2e5, 1e5)
                        : trial % 10 == 0 ? corner_m
                                          : Vec3(between(random, -150, 150), between(random, -150, 150), 3.0);
    std::vector<Vec3> directions = directions_of(sphere(from_m, trial % 2 == 0 ? 300 : 3000, random));
    for (Vec3& direction : directions) {
      if (is_far) direction = 200.0 * direction - from_m;  // towards the town
    }
    HitFilter filter;
    if (trial % 3 == 1) {
      filter.counts = is_of_a_third;
      filter.context = &thirds[random.next() % 3];
      filter.sure_from = static_cast<float>(between(random, 0.0, 60.0));
      filter.sure_to = static_cast<float>(between(random, 40.0, 400.0));
    }
    if (trial % 4 == 3) filter.ignored_objects[random.next() % 2] = random.next() % 2 == 0 ? 0U : 1U;
    if (trial % 5 == 4) {
      for (Vec3& direction : directions) direction *= std::pow(10.0, between(random, -8.0, 8.0));
    }
    const std::size_t block = 1 + static_cast<std::size_t>(random.next() % 1500);
    CHECK(check_fan(town, from_m, directions, filter, block).hit_count() > 0);
  }
}

TEST_CASE("fans that are no packet: in any order, of few rays, of none, with numbers that lead nowhere") {
  RandomStream random(12);
  const Town town(12, 80);
  const Vec3 from_m(5, 5, 2);
  const std::vector<Vec3> directions = directions_of(sphere(from_m, 2000, random));
  std::vector<Vec3> shuffled = directions;
  for (std::size_t ray = shuffled.size(); ray > 1; --ray) std::swap(shuffled[ray - 1], shuffled[random.next() % ray]);
  check_fan(town, from_m, shuffled, {}, 1024);
  for (std::size_t count = 1; count < 10; ++count) {
    check_fan(town, from_m, std::span(directions).first(count), {}, 100);
    check_fan(town, from_m, directions, {}, count);
  }
  TraversalCounters of_none;
  town.tree.closest_hits(RayFan{from_m, {}, {}}, {}, &of_none);
  town.twin.closest_hits(RayFan{from_m, {}, {}}, {}, &of_none);
  CHECK(of_none == TraversalCounters{});
  std::vector<Vec3> odd = directions;
  for (std::size_t ray = 0; ray < odd.size(); ray += 1 + random.next() % 20) {
    const std::array<double, 6> numbers{0.0, dcem_test::not_a_number, dcem_test::infinity, 1e-30, 1e30, -1.0};
    const double number = numbers[random.next() % numbers.size()];
    if (ray % 2 == 0) odd[ray][static_cast<int>(ray % 3)] = number;
    if (ray % 2 == 1) odd[ray] *= number;
  }
  check_fan(town, from_m, odd, {}, 512);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double number : {dcem_test::not_a_number, dcem_test::infinity, -1e30}) {
      Vec3 nowhere_m = from_m;
      nowhere_m[axis] = number;
      check_fan(town, nowhere_m, directions, {}, 512);
    }
  }
}

TEST_CASE("a fan needs a place for each answer") {
  const Town town(13, 5);
  const std::vector<Vec3> directions(3, Vec3(1, 0, 0));
  std::vector<std::optional<TriangleHit>> hits(2);
  CHECK_THROWS_AS(town.tree.closest_hits(RayFan{Vec3(0.0), directions, {}}, hits), std::invalid_argument);
  CHECK_THROWS_AS(town.twin.closest_hits(RayFan{Vec3(0.0), directions, {}}, hits), std::invalid_argument);
}

#if defined(DCEM_ENGINE)

TEST_CASE("packets of all sizes: every level of instructions gives the same answers for the same work") {
  const InstructionSet before = instruction_set();
  RandomStream random(10);
  const Town town(10, 150);
  const std::vector<RayQuery> queries = sphere(Vec3(4, 3, 25), 5000, random);
  const HitFilter filter{.sure_from = 30.0F, .sure_to = 80.0F, .counts = is_of_a_third, .context = &thirds[1]};
  const auto ask_fan = [&](std::size_t block) {
    return check_fan(town, Vec3(4, 3, 25), directions_of(queries), filter, block);
  };
  for (const std::size_t block : {64U, 63U, 41U, 1000U}) {
    CAPTURE(block);
    select_instruction_set(InstructionSet::baseline);
    const Work expected = check(town, queries, block);
    const FanTold expected_fan = ask_fan(block);
    for (const InstructionSet set : {InstructionSet::avx2, InstructionSet::avx512}) {
      if (!is_supported(set)) continue;
      select_instruction_set(set);
      const Work work = check(town, queries, block);
      CHECK(ask_fan(block) == expected_fan);
      CHECK(work.together == expected.together);
      CHECK(work.alone == expected.alone);
    }
  }
  select_instruction_set(before);
}

#endif

TEST_CASE("rays of a packet along a wall that is bent a little") {
  RandomStream random(5);
  for (int trial = 0; trial < 400; ++trial) {
    CAPTURE(trial);
    WideMesh mesh;
    add_wall(mesh, Vec3(0), Vec3(10, 0, 0), Vec3(0, 0, 10), Vec3(0, between(random, -1e-3, 1e-3), 0));
    const std::vector<Aabb<double>> boxes = mesh.boxes();
    WideBvh tree;
    tree.build(mesh.view(), boxes);
    BinaryIndex twin;
    twin.build(mesh.view(), boxes, std::vector<std::uint32_t>{0});
    const Vec3 from_m(between(random, -20, -1), between(random, -2e-3, 2e-3), between(random, -5, 15));
    std::vector<RayQuery> queries;
    for (int ray = 0; ray < 64; ++ray) {
      const Vec3 to_m(between(random, 0, 10), between(random, -1e-3, 1e-3), between(random, 0, 10));
      queries.push_back({{from_m, to_m - from_m}});
    }
    std::vector<std::optional<TriangleHit>> hits(queries.size());
    tree.closest_hits(queries, hits);
    for (std::size_t ray = 0; ray < queries.size(); ++ray) {
      CAPTURE(ray);
      REQUIRE(hits[ray] == tree.closest_hit(queries[ray].ray));
      REQUIRE(hits[ray] == twin.closest_hit(queries[ray].ray));
    }
  }
}

TEST_CASE("rays that stand behind a packet, and are not of it, do not add to its work") {
  RandomStream random(6);
  const Town town(6, 150);
  const Vec3 from_m(4, 3, 25);
  const auto towards = [&](double x, std::size_t count) {
    std::vector<RayQuery> queries;
    while (queries.size() < count) {
      queries.push_back({{from_m, Vec3(x, 0.1 * random.uniform(), 0.1 * random.uniform())}});
    }
    return queries;
  };
  for (std::size_t count = 4; count <= 24; ++count) {
    CAPTURE(count);
    std::vector<RayQuery> queries = towards(1.0, count);
    const std::vector<RayQuery> behind = towards(-1.0, 16);
    TraversalCounters apart = check(town, queries, 100).together;
    apart += check(town, behind, 100).together;
    queries.insert(queries.end(), behind.begin(), behind.end());
    CHECK(check(town, queries, 100).together == apart);
  }
}

TEST_CASE("of walls that lie in each other each ray of a packet meets the one of the smaller number") {
  WideMesh mesh;
  for (int wall = 0; wall < 40; ++wall) add_wall(mesh, Vec3(-5, 10, -5), Vec3(10, 0, 0), Vec3(0, 0, 10), Vec3(0));
  const std::vector<Aabb<double>> boxes = mesh.boxes();
  WideBvh tree;
  tree.build(mesh.view(), boxes);
  std::vector<RayQuery> queries;
  for (int ray = 0; ray < 256; ++ray) {
    queries.push_back({{Vec3(0.0), Vec3(0.4 * (ray % 16 - 7.5) / 8, 1.0, 0.4 * (ray / 16 - 7.5) / 8)}});
  }
  std::vector<std::optional<TriangleHit>> hits(queries.size());
  tree.closest_hits(queries, hits);
  std::size_t count = 0;
  for (std::size_t ray = 0; ray < hits.size(); ++ray) {
    CAPTURE(ray);
    REQUIRE(hits[ray]);
    CHECK(hits[ray]->triangle < 2);
    count += hits[ray]->triangle;
  }
  CHECK(count > 0);
  CHECK(count < hits.size());
}

}  // namespace test_packet
