/// Every level of instructions gives the same answers and does the same work, to the last bit and the last node; so do
/// rays one by one, in packets and in a stream.
#include <doctest/doctest.h>

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "dcem/accel/wide_bvh.hpp"
#include "dcem/core/random.hpp"
#include "tests/accel/wide/wide_scenes.hpp"

namespace test_kernels {

using namespace dcem;

namespace {

/// What all queries of a kind say, and the work that they take.
struct Told {
  std::vector<std::optional<TriangleHit>> closest, many;
  std::vector<char> occluded;
  std::vector<std::size_t> visited;
  TraversalCounters one_by_one, at_once, any, all;

  friend bool operator==(const Told&, const Told&) = default;
};

/// A soup of triangles of very different sizes, some of them in each other's plane.
struct Soup {
  std::vector<Vec3> vertices_m;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<Aabb<double>> boxes;

  explicit Soup(std::uint64_t seed, std::size_t count) {
    RandomStream random(seed);
    const auto between = [&](double low, double high) { return low + (high - low) * random.uniform(); };
    for (std::size_t triangle = 0; triangle < count; ++triangle) {
      const double size_m = std::pow(10.0, between(-1.0, 1.5));
      const Vec3 at_m(between(-50, 50), between(-50, 50), triangle % 5 == 0 ? 0.0 : between(-20, 20));
      std::array<std::uint32_t, 3> corners{};
      Aabb<double> box;
      for (std::uint32_t& corner : corners) {
        corner = static_cast<std::uint32_t>(vertices_m.size());
        const double lift_m = triangle % 5 == 0 ? 0.0 : between(-size_m, size_m);
        vertices_m.push_back(at_m + Vec3(between(-size_m, size_m), between(-size_m, size_m), lift_m));
        box.extend(vertices_m.back());
      }
      triangles.push_back(corners);
      boxes.push_back(box);
    }
  }
  TriangleView view() const { return {vertices_m, triangles}; }
};

/// Spheres of rays (packets), rays from anywhere (a stream), segments; some with a filter that asks, some that leave
/// out an object, some that lie in planes or lead nowhere.
std::vector<RayQuery> questions(std::uint64_t seed, const HitFilter& odd_only) {
  RandomStream random(seed);
  const auto between = [&](double low, double high) { return low + (high - low) * random.uniform(); };
  const auto place = [&] { return Vec3(between(-60, 60), between(-60, 60), between(-25, 25)); };
  std::vector<RayQuery> queries;
  for (int sphere = 0; sphere < 6; ++sphere) {
    const Vec3 from_m = place();
    const Vec3 ahead = place();
    for (int ray = 0; ray < 40; ++ray) queries.push_back({{from_m, ahead + 0.2 * place()}});
  }
  for (int ray = 0; ray < 400; ++ray) queries.push_back({{place(), place()}});
  for (int ray = 0; ray < 200; ++ray) queries.push_back({segment_between(place(), place())});
  for (int ray = 0; ray < 40; ++ray) queries.push_back({{place(), Vec3(ray % 3 - 1, ray % 5 - 2, 0)}});
  for (std::size_t ray = 0; ray < queries.size(); ++ray) {
    if (ray % 7 == 3) queries[ray].filter = odd_only;
    if (ray % 11 == 5) queries[ray].filter.ignored_objects[1] = 1;
    if (ray % 13 == 6) queries[ray].filter.sure_from = 0.2F;
    if (ray % 17 == 8) queries[ray].ray.t_max = between(0.1, 1.5);
  }
  return queries;
}

Told ask(const WideBvh& tree, std::span<const RayQuery> queries) {
  Told told;
  told.many.resize(queries.size());
  tree.closest_hits(queries, told.many, &told.at_once);
  for (const RayQuery& query : queries) {
    told.closest.push_back(tree.closest_hit(query.ray, query.filter, &told.one_by_one));
    told.occluded.push_back(tree.occluded(query.ray, query.filter, &told.any) ? 1 : 0);
    std::size_t count = 0;
    const auto note = [&](const TriangleHit& hit) {
      count += 1 + hit.triangle;
      return false;
    };
    tree.visit_hits(query.ray, query.filter, note, &told.all);
    told.visited.push_back(count);
  }
  return told;
}

constexpr auto is_odd = [](const TriangleHit& hit) { return hit.triangle % 2 == 1; };

}  // namespace

TEST_CASE("rays one by one and many at once get the same answers") {
  const HitFilter odd_only = filter_by(is_odd);
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    CAPTURE(seed);
    const Soup soup(seed, 30 * seed * seed);
    WideBvh tree;
    const auto half = static_cast<std::uint32_t>(soup.triangles.size() / 2);
    tree.build_objects(soup.view(), soup.boxes, std::vector<std::uint32_t>{0, half});
    const Told told = ask(tree, questions(seed, odd_only));
    CHECK(told.many == told.closest);
    std::size_t hits = 0;
    for (std::size_t ray = 0; ray < told.closest.size(); ++ray) {
      REQUIRE(told.closest[ray].has_value() == (told.occluded[ray] != 0));
      REQUIRE(told.closest[ray].has_value() == (told.visited[ray] != 0));
      hits += told.closest[ray] ? 1U : 0U;
    }
    CHECK(hits > 20);
  }
}

TEST_CASE("of what only the cone of a packet meets, no more than the boxes in the root are gone to") {
  std::vector<Vec3> vertices_m;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<Aabb<double>> boxes;
  RandomStream random(7);
  for (std::uint32_t triangle = 0; triangle < 2000; ++triangle) {
    const Vec3 at_m(random.uniform() - 0.5, 4.0 * random.uniform() - 2.0, 100.0 + random.uniform());
    for (const Vec3& aside_m : {Vec3(0.0), Vec3(0.1, 0.0, 0.0), Vec3(0.0, 0.1, 0.05)}) {
      vertices_m.push_back(at_m + aside_m);
    }
    triangles.push_back({3 * triangle, 3 * triangle + 1, 3 * triangle + 2});
    boxes.push_back({at_m, at_m + Vec3(0.1, 0.1, 0.05)});
  }
  WideBvh tree;
  tree.build({vertices_m, triangles}, boxes);
  // To the left of all triangles and to the right of them, 4 m from them where they are.
  std::vector<RayQuery> queries;
  for (int ray = 0; ray < 16; ++ray) queries.push_back({{Vec3(0.0), Vec3(ray % 2 == 0 ? -0.04 : 0.04, 0.0, 1.0)}});
  std::vector<std::optional<TriangleHit>> hits(queries.size());
  TraversalCounters counters;
  tree.closest_hits(queries, hits, &counters);
  for (const auto& hit : hits) CHECK(!hit);
  CHECK(counters.nodes_visited > 1);  // the cone does meet them
  CHECK(counters.nodes_visited <= 1 + simd_lanes);
}

#if defined(DCEM_ENGINE)

TEST_CASE("every level of instructions that the processor has: the same answers, the same work") {
  const InstructionSet before = instruction_set();
  const HitFilter odd_only = filter_by(is_odd);
  for (std::uint64_t seed = 21; seed <= 26; ++seed) {
    CAPTURE(seed);
    const Soup soup(seed, 2000);
    WideBvh tree;
    tree.build_objects(soup.view(), soup.boxes, std::vector<std::uint32_t>{0, 500});
    const std::vector<RayQuery> queries = questions(seed, odd_only);
    select_instruction_set(InstructionSet::baseline);
    CHECK(instruction_set() == InstructionSet::baseline);
    const Told expected = ask(tree, queries);
    for (const InstructionSet set : {InstructionSet::avx2, InstructionSet::avx512}) {
      if (!is_supported(set)) continue;
      select_instruction_set(set);
      CHECK(instruction_set() == set);
      CHECK(ask(tree, queries) == expected);
    }
  }
  select_instruction_set(before);
}

TEST_CASE("a level that the processor lacks is refused by name, and nothing changes") {
  const InstructionSet before = instruction_set();
  for (const InstructionSet set : {InstructionSet::avx2, InstructionSet::avx512}) {
    if (is_supported(set)) continue;
    CHECK_THROWS_AS(select_instruction_set(set), std::invalid_argument);
    CHECK(instruction_set() == before);
  }
}

#endif

}  // namespace test_kernels
