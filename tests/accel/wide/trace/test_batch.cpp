#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <vector>

#include "dcem/accel/wide/trace/batch.hpp"
#include "dcem/accel/wide/trace/ray_order.hpp"
#include "tests/accel/wide/wide_scenes.hpp"

using namespace dcem;
using dcem_test::infinity;
using dcem_test::not_a_number;

namespace {

Vec3 drawn_direction(RandomStream& random) {
  return glm::normalize(Vec3(dcem_test::between(random, -1, 1), dcem_test::between(random, -1, 1),
                             dcem_test::between(random, -1, 1) + 1e-9));
}

/// Rays from everywhere, with some that single precision does not follow.
std::vector<Ray<double>> drawn_rays(std::size_t count, std::uint64_t seed) {
  RandomStream random(seed);
  std::vector<Ray<double>> rays;
  for (std::size_t index = 0; index < count; ++index) {
    const Vec3 from(dcem_test::between(random, -20, 120), dcem_test::between(random, -20, 120),
                    dcem_test::between(random, -5, 30));
    rays.push_back({from, drawn_direction(random), 0.0, index % 3 == 0 ? infinity : 40.0});
  }
  for (std::size_t index = 7; index < count; index += 97) rays[index].origin.x = not_a_number;
  for (std::size_t index = 8; index < count; index += 97) rays[index].direction = Vec3(0.0);
  for (std::size_t index = 9; index < count; index += 97) rays[index].origin.y = infinity;
  for (std::size_t index = 10; index < count; index += 97) rays[index].direction.z = not_a_number;
  for (std::size_t index = 11; index < count; index += 97) rays[index].t_max = -1.0;
  for (std::size_t index = 12; index < count; index += 97) rays[index].origin *= 1e14;
  return rays;
}

bool is_permutation(std::span<const std::uint32_t> order, std::size_t count) {
  std::vector<std::uint32_t> sorted(order.begin(), order.end()), all(count);
  std::ranges::sort(sorted);
  std::iota(all.begin(), all.end(), 0U);
  return sorted == all;
}

/// Mean distance from one ray to the next in an order.
template <typename Distance>
double mean_step(std::span<const std::uint32_t> order, Distance&& distance) {
  double sum = 0.0;
  for (std::size_t at = 1; at < order.size(); ++at) sum += distance(order[at - 1], order[at]);
  return sum / static_cast<double>(order.size() - 1);
}

std::uint64_t bits(const std::optional<TriangleHit>& hit) {
  return hit ? std::bit_cast<std::uint64_t>(hit->t) : 1;
}

}  // namespace

TEST_CASE("a batch answers what single queries answer, to the last bit, for any number of threads") {
  const dcem_test::WideMesh mesh = dcem_test::boxes_mesh(200, 3);
  WideBvh tree;
  tree.build(mesh.view(), mesh.boxes());
  const auto odd_ones = [](std::uint32_t triangle) { return triangle % 2 == 1; };
  std::size_t met = 0;
  for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{255}, std::size_t{3000}}) {
    const std::vector<Ray<double>> rays = drawn_rays(count, count);
    for (const unsigned threads : {1U, 2U, 5U}) {
      WideBatch batch(threads);
      std::vector<std::optional<TriangleHit>> hits(count), odd_hits(count);
      std::vector<std::uint8_t> occluded(count, 7);
      TraversalCounters together, one_by_one;
      batch.closest_hit(tree, rays, hits, {}, &together);
      batch.closest_hit(tree, rays, odd_hits, odd_ones, &together);
      batch.occluded(tree, rays, occluded, {}, &together);
      for (std::size_t index = 0; index < count; ++index) {
        const auto hit = tree.closest_hit(rays[index], &one_by_one);
        const auto odd_hit = tree.closest_hit(rays[index], odd_ones, &one_by_one);
        REQUIRE(bits(hits[index]) == bits(hit));
        REQUIRE(bits(odd_hits[index]) == bits(odd_hit));
        if (hit) REQUIRE(hits[index]->triangle == hit->triangle);
        REQUIRE(occluded[index] == (tree.occluded(rays[index], &one_by_one) ? 1 : 0));
        met += hit ? 1U : 0U;
      }
      CHECK(together.nodes_visited == one_by_one.nodes_visited);
      CHECK(together.primitives_tested == one_by_one.primitives_tested);
    }
  }
  CHECK(met > 50);
}

TEST_CASE("the order holds every ray once, and is the same for the same rays, whatever was sorted before") {
  const std::vector<Ray<double>> rays = drawn_rays(5000, 1);
  RayOrder fresh, used;
  const auto first = fresh.sort(rays);
  const std::vector<std::uint32_t> expected(first.begin(), first.end());
  CHECK(is_permutation(expected, rays.size()));
  CHECK(used.sort({}).empty());
  CHECK(used.sort(std::span(rays).first(1)).size() == 1);
  CHECK(is_permutation(used.sort(std::span(rays).first(100)), 100));
  CHECK(std::ranges::equal(used.sort(rays), expected));
}

TEST_CASE("equal rays keep the order in which they were given") {
  const std::vector<Ray<double>> rays(300, Ray<double>{Vec3(1, 2, 3), Vec3(0, 0, 1)});
  RayOrder order;
  std::vector<std::uint32_t> given(rays.size());
  std::iota(given.begin(), given.end(), 0U);
  CHECK(std::ranges::equal(order.sort(rays), given));
}

TEST_CASE("rays that follow each other begin near each other") {
  // 4096 cells for 20,000 points of a square of 100 m: a step within a cell of 1.6 m, or to the next one, against a
  // mean of 52 m between points drawn anew.
  RandomStream random(4);
  std::vector<Ray<double>> rays;
  for (int index = 0; index < 20'000; ++index) {
    const Vec3 from(dcem_test::between(random, 0, 100), dcem_test::between(random, 0, 100), 1.0);
    rays.push_back({from, drawn_direction(random)});
  }
  const auto apart = [&](std::uint32_t one, std::uint32_t other) {
    return glm::distance(rays[one].origin, rays[other].origin);
  };
  RayOrder order;
  std::vector<std::uint32_t> given(rays.size());
  std::iota(given.begin(), given.end(), 0U);
  CHECK(mean_step(given, apart) > 45.0);
  CHECK(mean_step(order.sort(rays), apart) < 2.5);
}

TEST_CASE("rays from one point are sorted by direction") {
  RandomStream random(5);
  std::vector<Ray<double>> rays;
  for (int index = 0; index < 20'000; ++index) rays.push_back({Vec3(7, 8, 9), drawn_direction(random)});
  const auto apart = [&](std::uint32_t one, std::uint32_t other) {
    return glm::distance(rays[one].direction, rays[other].direction);
  };
  RayOrder order;
  // 20,000 directions: neighbours on the sphere are 0.025 apart; the grid is as fine as 2/64.
  CHECK(mean_step(order.sort(rays), apart) < 0.1);
}

TEST_CASE("a batch without a place for each answer is refused") {
  WideBvh tree;
  WideBatch batch;
  const std::vector<Ray<double>> rays(3, Ray<double>{Vec3(0.0), Vec3(1, 0, 0)});
  std::vector<std::optional<TriangleHit>> hits(2);
  std::vector<std::uint8_t> occluded(4);
  CHECK_THROWS_AS(batch.closest_hit(tree, rays, hits), std::invalid_argument);
  CHECK_THROWS_AS(batch.occluded(tree, rays, occluded), std::invalid_argument);
}
