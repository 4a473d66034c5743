/// Children that wait, as a stack of any depth gives them: those of the last node first, of these the nearest, and none
/// that is beyond the limit.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "dcem/accel/wide/trace/waiting_children.hpp"
#include "dcem/core/random.hpp"

namespace test_waiting_children {

using namespace dcem;

namespace {

using Place = std::pair<std::uint32_t, std::uint32_t>;  // node, lane

/// The same as lists.
class Lists {
 public:
  void push(std::uint32_t node, const std::vector<std::pair<float, std::uint32_t>>& waiting) {
    levels_.push_back({node, waiting});
    std::sort(levels_.back().waiting.begin(), levels_.back().waiting.end());
  }
  std::optional<Place> take(float limit) {
    for (; !levels_.empty(); levels_.pop_back()) {
      auto& waiting = levels_.back().waiting;
      if (waiting.empty() || waiting.front().first > limit) continue;
      const Place place{levels_.back().node, waiting.front().second};
      waiting.erase(waiting.begin());
      return place;
    }
    return std::nullopt;
  }

 private:
  struct Level {
    std::uint32_t node;
    std::vector<std::pair<float, std::uint32_t>> waiting;
  };
  std::vector<Level> levels_;
};

/// Whole numbers of metres: keys tell them apart.
std::vector<std::pair<float, std::uint32_t>> some_children(RandomStream& random) {
  std::vector<std::pair<float, std::uint32_t>> waiting;
  for (std::uint32_t lane = 0; lane < simd_lanes; ++lane) {
    if (random.uniform() < 0.4) waiting.emplace_back(static_cast<float>(8 * (random.next() % 100) + lane), lane);
  }
  return waiting;
}

LaneKeys keys_of(const std::vector<std::pair<float, std::uint32_t>>& waiting) {
  std::array<float, simd_lanes> entry, is_out;
  entry.fill(0.0F);
  is_out.fill(1.0F);
  for (const auto& [number, lane] : waiting) {
    entry[lane] = number;
    is_out[lane] = 0.0F;
  }
  return {Float8(entry), Float8(is_out) > Float8(0.5F)};
}

std::optional<Place> take(detail::WaitingChildren& children, float limit) {
  detail::WaitingChildren::Place place;
  if (!children.take(limit, place)) return std::nullopt;
  return Place{place.node, place.lane};
}

}  // namespace

TEST_CASE("children come as from lists: the last node first, the nearest of it, none beyond a limit that falls") {
  RandomStream random(11);
  std::size_t deepest = 0;
  detail::WaitingChildren children;
  for (int walk = 0; walk < 3000; ++walk) {
    children.clear();
    Lists lists;
    float limit = 900.0F;
    std::uint32_t depth = 0, node = 0;
    const double down = walk % 3 == 0 ? 0.5 : 0.9;  // how often a step leads down
    for (int step = 0; step < 200; ++step) {
      if (depth < 100 && random.uniform() < down) {
        const auto waiting = some_children(random);
        children.push(node, keys_of(waiting), !waiting.empty());
        if (!waiting.empty()) lists.push(node, waiting);
        ++node;
        deepest = std::max<std::size_t>(deepest, ++depth);
        continue;
      }
      if (random.uniform() < 0.1) limit *= static_cast<float>(random.uniform());
      const auto expected = lists.take(limit);
      REQUIRE(take(children, limit) == expected);
      if (!expected) break;
    }
    while (const auto expected = lists.take(limit)) REQUIRE(take(children, limit) == expected);
    REQUIRE(take(children, limit) == std::nullopt);
  }
  CHECK(deepest == 100);
}

TEST_CASE("a stack of many levels of which only the first is within reach gives that") {
  for (std::uint32_t levels = 1; levels <= detail::wide_depth_limit; ++levels) {
    detail::WaitingChildren children;
    children.clear();
    children.push(7, keys_of({{1.0F, 3}}), true);
    for (std::uint32_t level = 1; level < levels; ++level) children.push(level, keys_of({{50.0F, 5}}), true);
    REQUIRE(take(children, 10.0F) == Place{7, 3});
    REQUIRE(take(children, 10.0F) == std::nullopt);
  }
}

}  // namespace test_waiting_children
