#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "dcem/core/lane_keys.hpp"
#include "dcem/core/random.hpp"

namespace test_lane_keys {

using namespace dcem;

namespace {

constexpr float infinite = std::numeric_limits<float>::infinity();
using Lanes = std::array<float, simd_lanes>;

/// From zero to infinity, small and large ones.
float some_number(RandomStream& random) {
  const double kind = random.uniform();
  if (kind < 0.1) return 0.0F;
  if (kind < 0.2) return infinite;
  return static_cast<float>(std::pow(10.0, 40.0 * random.uniform() - 20.0));
}

/// The lanes in which `set` says `wanted`.
Mask8 mask_of(const std::array<bool, simd_lanes>& set, bool wanted) {
  Lanes numbers;
  for (std::size_t lane = 0; lane < simd_lanes; ++lane) numbers[lane] = set[lane] == wanted ? 1.0F : 3.0F;
  return Float8(numbers) < Float8(2.0F);
}

}  // namespace

TEST_CASE("lanes come in the order of their numbers, each once, to eight units of the last place") {
  RandomStream random(3);
  for (int trial = 0; trial < 20000; ++trial) {
    Lanes numbers;
    std::array<bool, simd_lanes> waits;
    for (float& number : numbers) number = some_number(random);
    if (trial % 5 == 0) numbers[3] = numbers[6];
    for (bool& each : waits) each = random.uniform() < 0.6;
    LaneKeys keys(Float8(numbers), mask_of(waits, false));
    float latest = 0.0F;
    auto left = waits;
    for (auto count = std::count(waits.begin(), waits.end(), true); count > 0; --count) {
      const std::uint32_t key = keys.least();
      const std::uint32_t lane = LaneKeys::lane(key);
      REQUIRE(left[lane]);
      left[lane] = false;
      REQUIRE(numbers[lane] >= latest * (1.0F - 8 * 0x1p-23F));
      latest = std::max(latest, numbers[lane]);
      keys.remove(key);
    }
    REQUIRE(!LaneKeys::may_be_within(keys.least(), infinite));
  }
}

TEST_CASE("a lane whose number is within a limit is never left out, and one well above it always") {
  RandomStream random(5);
  for (int trial = 0; trial < 20000; ++trial) {
    Lanes numbers;
    numbers.fill(infinite);
    const std::size_t lane = random.next() % simd_lanes;
    numbers[lane] = some_number(random);
    const float limit = trial % 3 == 0 ? numbers[lane] : some_number(random);
    const std::uint32_t key = LaneKeys(Float8(numbers)).least();
    REQUIRE(LaneKeys::number(key) <= numbers[lane]);
    if (numbers[lane] <= limit) REQUIRE(LaneKeys::may_be_within(key, limit));
    if (numbers[lane] * (1.0F - 16 * 0x1p-23F) > limit && limit > 0.0F) REQUIRE(!LaneKeys::may_be_within(key, limit));
  }
}

TEST_CASE("which of eight keys are within a limit is what each says by itself, in memory as well") {
  RandomStream random(6);
  for (int trial = 0; trial < 20000; ++trial) {
    std::array<std::uint32_t, simd_lanes> each;
    for (std::uint32_t& key : each) {
      Lanes numbers;
      numbers.fill(infinite);
      numbers[random.next() % simd_lanes] = some_number(random);
      key = random.uniform() < 0.2 ? LaneKeys::none : LaneKeys(Float8(numbers)).least();
    }
    const float limit = trial % 3 == 0 ? LaneKeys::number(each[random.next() % simd_lanes]) : some_number(random);
    const std::uint32_t within = LaneKeys::load(each.data()).within(limit >= 0.0F ? limit : infinite);
    for (std::size_t lane = 0; lane < simd_lanes; ++lane) {
      REQUIRE((within >> lane & 1U) ==
              (LaneKeys::may_be_within(each[lane], limit >= 0.0F ? limit : infinite) ? 1U : 0U));
    }
  }
}

TEST_CASE("later and earlier agree with the numbers, from zero on and in what is below zero") {
  RandomStream random(7);
  for (int trial = 0; trial < 20000; ++trial) {
    Lanes first, second;
    for (std::size_t lane = 0; lane < simd_lanes; ++lane) {
      first[lane] = random.uniform() < 0.7 ? some_number(random) : -1.0F - some_number(random);
      second[lane] = random.uniform() < 0.7 ? some_number(random) : -1.0F - some_number(random);
    }
    const Float8 one(first), other(second);
    const Float8 later = simd::later(one, other), earlier = simd::earlier(one, other);
    const std::uint32_t is_later = simd::is_later(one, other).bits();
    for (std::size_t lane = 0; lane < simd_lanes; ++lane) {
      const float high = std::max(first[lane], second[lane]), low = std::min(first[lane], second[lane]);
      REQUIRE((later[lane] == high || (high < 0.0F && later[lane] < 0.0F)));
      REQUIRE((earlier[lane] == low || (low < 0.0F && earlier[lane] < 0.0F)));
      if (first[lane] >= 0.0F) REQUIRE((is_later >> lane & 1U) == (first[lane] > second[lane] ? 1U : 0U));
    }
  }
}

}  // namespace test_lane_keys
