#include <doctest/doctest.h>

#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <vector>

#include "dcem/accel/binary_index.hpp"
#include "dcem/accel/brute_force_index.hpp"
#include "dcem/accel/wide_index.hpp"
#include "tests/accel/wide/wide_scenes.hpp"

namespace test_spatial_index {

using namespace dcem;
using dcem_test::any_ray;
using dcem_test::exact_hits;
using dcem_test::fault_of_hits;
using dcem_test::infinity;
using dcem_test::text_of;
using dcem_test::WideMesh;

namespace {

constexpr std::uint32_t triangles_of_object = 24;

/// Boxes in a heap, two of them an object.
struct Heap {
  WideMesh mesh;
  std::vector<Aabb<double>> boxes;
  std::vector<std::uint32_t> object_first;

  explicit Heap(std::uint64_t seed) : mesh(dcem_test::boxes_mesh(40, seed)), boxes(mesh.boxes()) {
    for (std::uint32_t first = 0; first < mesh.triangles.size(); first += triangles_of_object) {
      object_first.push_back(first);
    }
  }
  static std::uint32_t object_of(std::uint32_t triangle) { return triangle / triangles_of_object; }
  Aabb<double> bounds() const {
    Aabb<double> all;
    for (const Aabb<double>& box : boxes) all.extend(box);
    return all;
  }
  /// Moves every third object; every fifth goes away, or comes back. Returns the triangles that this concerns.
  std::vector<std::uint32_t> step(RandomStream& random) {
    std::vector<std::uint32_t> moved;
    mesh.absent.resize(mesh.triangles.size());
    for (std::uint32_t object = 0; object < object_first.size(); ++object) {
      const bool drives = random.uniform() < 0.3, flips = random.uniform() < 0.2;
      const Vec3 by = dcem_test::random_in_cube(random, 2.0);
      for (std::uint32_t index = 0; index < triangles_of_object; ++index) {
        const std::uint32_t triangle = object_first[object] + index;
        if (flips) mesh.absent[triangle] = !mesh.absent[triangle];
        if (drives || flips) moved.push_back(triangle);
      }
      // Boxes of eight vertices, two to an object.
      for (std::uint32_t vertex = 16 * object; drives && vertex < 16 * object + 16; ++vertex) {
        mesh.vertices[vertex] += by;
      }
    }
    boxes = mesh.boxes();
    return moved;
  }
};

/// A filter that asks about hits near both ends, and leaves out what is odd there; and an object or two.
struct OddFilter {
  HitFilter filter;

  explicit OddFilter(RandomStream& random) {
    filter.sure_from = static_cast<float>(random.uniform() < 0.3 ? -infinity : 0.6 * random.uniform());
    filter.sure_to = static_cast<float>(random.uniform() < 0.3 ? infinity : 0.6 + random.uniform());
    filter.counts = [](const void*, const TriangleHit& hit) { return hit.triangle % 2 == 0; };
    for (std::uint32_t& object : filter.ignored_objects) {
      if (random.uniform() < 0.5) object = static_cast<std::uint32_t>(random.next() % 20);
    }
  }
};

/// All directions from one point with one filter.
template <typename Index>
void check_fan(const Index& index, const Heap& heap, std::span<const RayQuery> queries, RandomStream& random) {
  const Vec3 from_m = queries.back().ray.origin;
  const HitFilter filter = OddFilter(random).filter;
  std::vector<Vec3> directions;
  for (const RayQuery& query : queries) directions.push_back(query.ray.direction);
  std::vector<std::optional<TriangleHit>> hits(directions.size());
  index.closest_hits(RayFan{from_m, directions, filter}, hits);
  for (std::size_t ray = 0; ray < directions.size(); ++ray) {
    const auto all = exact_hits(heap.mesh, {from_m, directions[ray]}, filter, &Heap::object_of);
    REQUIRE(hits[ray] == (all.empty() ? std::nullopt : std::optional(all.front())));
  }
}

template <typename Index>
void check_rays(const Index& index, const Heap& heap, int trials, RandomStream& random) {
  std::vector<RayQuery> queries;
  for (int trial = 0; trial < trials; ++trial) {
    const Ray<double> ray = any_ray(random, heap.mesh, heap.bounds());
    INFO(text_of(ray));
    const HitFilter filter = trial % 3 == 0 ? HitFilter{} : OddFilter(random).filter;
    REQUIRE(fault_of_hits(index, exact_hits(heap.mesh, ray, filter, &Heap::object_of), ray, filter) == "");
    queries.push_back({ray, filter});
  }
  std::vector<std::optional<TriangleHit>> hits(queries.size());
  index.closest_hits(queries, hits);
  for (std::size_t query = 0; query < queries.size(); ++query) {
    REQUIRE(hits[query] == index.closest_hit(queries[query].ray, queries[query].filter));
  }
  check_fan(index, heap, queries, random);
}

}  // namespace

TEST_CASE_TEMPLATE("an index gives the answers of exact_hit_t, to the last bit, wherever things drive", Index,
                   WideIndex, BinaryIndex, BruteForceIndex) {
  Heap heap(5);
  RandomStream random(6);
  for (const TreePolicy policy : {TreePolicy::adaptive, TreePolicy::refit_only, TreePolicy::rebuild_always}) {
    WideTreeSettings settings;
    settings.policy = policy;
    Index index(settings);
    index.build(heap.mesh.view(), heap.boxes, heap.object_first);
    for (int frame = 0; frame < 20; ++frame) {
      CAPTURE(frame);
      check_rays(index, heap, 100, random);
      const std::vector<std::uint32_t> moved = heap.step(random);
      index.note_rays({1000, 10}, 10);
      index.update(heap.mesh.view(), heap.boxes, moved);
    }
  }
}

TEST_CASE_TEMPLATE("a filter made of a function is asked about every hit", Index, WideIndex, BinaryIndex,
                   BruteForceIndex) {
  const Heap heap(15);
  Index index;
  index.build(heap.mesh.view(), heap.boxes, heap.object_first);
  RandomStream random(16);
  for (int trial = 0; trial < 500; ++trial) {
    const Ray<double> ray = any_ray(random, heap.mesh, heap.bounds());
    std::size_t asked = 0;
    const auto none = [&](const TriangleHit& hit) {
      const auto t = WatertightRay(ray).intersect(heap.mesh.corners(hit.triangle));
      REQUIRE(t.has_value());
      ++asked;
      return false;
    };
    CHECK(!index.closest_hit(ray, filter_by(none)));
    CHECK(!index.occluded(ray, filter_by(none)));
    CHECK(asked == 2 * exact_hits(heap.mesh, ray).size());
  }
}

TEST_CASE_TEMPLATE("regions find what their boxes say", Index, WideIndex, BinaryIndex, BruteForceIndex) {
  Heap heap(25);
  RandomStream random(26);
  Index index;
  index.build(heap.mesh.view(), heap.boxes, heap.object_first);
  index.update(heap.mesh.view(), heap.boxes, heap.step(random));
  for (int trial = 0; trial < 300; ++trial) {
    const auto region = dcem_test::random_box<double>(random);
    const auto low_enough = [&](const Aabb<double>& box) { return box.min.x + 2 * box.min.y < region.max.z; };
    std::vector<std::uint32_t> overlapping, low;
    for (std::uint32_t triangle = 0; triangle < heap.boxes.size(); ++triangle) {
      if (heap.boxes[triangle].empty()) continue;
      if (!region.empty() && region.overlaps(heap.boxes[triangle])) overlapping.push_back(triangle);
      if (low_enough(heap.boxes[triangle])) low.push_back(triangle);
    }
    REQUIRE(dcem_test::reported([&](auto visit) { index.overlapping(region, visit); }) == overlapping);
    REQUIRE(dcem_test::reported([&](auto visit) { index.visit(low_enough, visit); }) == low);
  }
}

TEST_CASE_TEMPLATE("an index that is empty, or over nothing that is there, finds nothing", Index, WideIndex,
                   BinaryIndex, BruteForceIndex) {
  const Ray<double> ray{Vec3(0, 0, 50), Vec3(0, 0, -1)};
  const auto finds_nothing = [&](const Index& index) {
    CHECK(fault_of_hits(index, {}, ray) == "");
    std::vector<std::optional<TriangleHit>> hits(2, TriangleHit{1.0, 0});
    index.closest_hits(std::vector<RayQuery>{{ray}, {ray}}, hits);
    CHECK(hits == std::vector<std::optional<TriangleHit>>(2));
    hits.assign(2, TriangleHit{1.0, 0});
    index.closest_hits(RayFan{ray.origin, std::vector<Vec3>(2, ray.direction), {}}, hits);
    CHECK(hits == std::vector<std::optional<TriangleHit>>(2));
    const auto all = [](const Aabb<double>&) { return true; };
    CHECK(dcem_test::reported([&](auto visit) { index.visit(all, visit); }).empty());
  };
  Index index;
  finds_nothing(index);
  Heap heap(35);
  heap.mesh.absent.assign(heap.mesh.triangles.size(), true);
  index.build(heap.mesh.view(), heap.mesh.boxes(), heap.object_first);
  finds_nothing(index);
}

TEST_CASE_TEMPLATE("bad input is refused, and what was there stays", Index, WideIndex, BinaryIndex, BruteForceIndex) {
  const Heap heap(45);
  Index index;
  index.build(heap.mesh.view(), heap.boxes, heap.object_first);
  const auto view = heap.mesh.view();
  auto bad = heap.boxes;
  bad[7].max.x = infinity;
  const std::vector<std::uint32_t> seven{7}, none_such{static_cast<std::uint32_t>(heap.boxes.size())};
  CHECK_THROWS_AS(index.update(view, bad, seven), std::invalid_argument);
  CHECK_THROWS_AS(index.update(view, heap.boxes, none_such), std::invalid_argument);
  CHECK_THROWS_AS(index.build(view, bad, heap.object_first), std::invalid_argument);
  CHECK_THROWS_AS(index.build(view, std::span(bad).first(3), heap.object_first), std::invalid_argument);
  std::vector<std::optional<TriangleHit>> hits(2);
  CHECK_THROWS_AS(index.closest_hits(std::vector<RayQuery>(3), hits), std::invalid_argument);
  RandomStream random(46);
  check_rays(index, heap, 50, random);
}

}  // namespace test_spatial_index
