#include <doctest/doctest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "dcem/core/random.hpp"
#include "dcem/geometry/surfaces/disjoint_sets.hpp"

namespace test_disjoint_sets {

using namespace dcem;

namespace {

/// The same by relabelling: n² but plain.
std::vector<std::uint32_t> relabelled(std::uint32_t count,
                                      const std::vector<std::pair<std::uint32_t, std::uint32_t>>& joins) {
  std::vector<std::uint32_t> label(count);
  for (std::uint32_t member = 0; member < count; ++member) label[member] = member;
  for (const auto& [a, b] : joins) {
    const std::uint32_t low = std::min(label[a], label[b]), high = std::max(label[a], label[b]);
    std::replace(label.begin(), label.end(), high, low);
  }
  return label;
}

}  // namespace

TEST_CASE("every member starts as a set of its own") {
  DisjointSets sets(5);
  for (std::uint32_t member = 0; member < 5; ++member) CHECK(sets.smallest(member) == member);
}

TEST_CASE("the smallest member stands for its set, in whatever order sets were joined") {
  RandomStream random(5);
  for (int repeat = 0; repeat < 50; ++repeat) {
    const std::uint32_t count = 60;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> joins;
    for (int join = 0; join < 40; ++join) {
      const auto a = static_cast<std::uint32_t>(random.next() % count),
                 b = static_cast<std::uint32_t>(random.next() % count);
      joins.emplace_back(a, b);
    }
    const std::vector<std::uint32_t> expected = relabelled(count, joins);
    DisjointSets forward(count), backward(count);
    for (const auto& [a, b] : joins) forward.join(a, b);
    std::reverse(joins.begin(), joins.end());
    for (const auto& [a, b] : joins) backward.join(b, a);
    for (std::uint32_t member = 0; member < count; ++member) {
      CHECK(forward.smallest(member) == expected[member]);
      CHECK(backward.smallest(member) == expected[member]);
    }
  }
}

TEST_CASE("a chain of a million joins, either way, is answered without deep recursion") {
  const std::uint32_t count = 1'000'000;
  DisjointSets rising(count), falling(count);
  for (std::uint32_t member = 1; member < count; ++member) rising.join(member - 1, member);
  for (std::uint32_t member = count - 1; member > 0; --member) falling.join(member - 1, member);
  CHECK(rising.smallest(count - 1) == 0);
  CHECK(falling.smallest(count - 1) == 0);
  CHECK(falling.smallest(count / 2) == 0);
}

}  // namespace test_disjoint_sets
