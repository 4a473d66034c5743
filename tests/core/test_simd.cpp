#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "dcem/core/simd.hpp"

namespace test_simd {

using namespace dcem;

TEST_CASE("vector operations are those of their lanes") {
  using Lanes = std::array<float, 8>;
  const Lanes first{1, -2, 3, 0, -0.0F, 5, 6, 7}, second{2, -3, 3, 1, 0.0F, NAN, 5, 8};
  const Float8 one(first), other(second);
  const Float8 lesser = simd::minimum(one, other), greater = simd::maximum(one, other);
  const Float8 size = simd::absolute(one);
  for (std::size_t lane = 0; lane < 8; ++lane) {
    CHECK(size[lane] == std::abs(first[lane]));
    CHECK(Float8(2.5F)[lane] == 2.5F);
    if (lane == 5) continue;
    CHECK(lesser[lane] == std::min(first[lane], second[lane]));
    CHECK(greater[lane] == std::max(first[lane], second[lane]));
    CHECK((one * other)[lane] == first[lane] * second[lane]);
    CHECK((one + other)[lane] == first[lane] + second[lane]);
    CHECK((one - other)[lane] == first[lane] - second[lane]);
    CHECK((one / Float8(4.0F))[lane] == first[lane] / 4.0F);
    CHECK((-one)[lane] == -first[lane]);
  }
  CHECK(std::isnan(lesser[5]));
  CHECK(std::isnan(greater[5]));
  CHECK((one <= other).bits() == 0b10011101);
  CHECK((one > other).bits() == 0b01000010);
  for (std::uint32_t pattern = 0; pattern < 256; ++pattern) {
    Lanes lanes;
    for (std::size_t lane = 0; lane < 8; ++lane) lanes[lane] = (pattern >> lane & 1U) != 0 ? 1.0F : -1.0F;
    const Mask8 positive = Float8(0.0F) < Float8(lanes);
    REQUIRE(positive.bits() == pattern);
    REQUIRE((positive & (one < 3.5F)).bits() == (pattern & 0b00011111U));
    REQUIRE((positive | (one < 3.5F)).bits() == (pattern | 0b00011111U));
  }
}

TEST_CASE("numbers from zero on are ordered as their integers") {
  using Lanes = std::array<float, 8>;
  const Lanes first{0.0F, 1.0F, 2.5F, 1e30F, -1.0F, 3.0F, 0x1p-149F, INFINITY};
  const Lanes second{1.0F, 1.0F, 2.0F, 1e31F, 2.0F, -3.0F, 0.0F, 5.0F};
  const Float8 one(first), other(second);
  const Float8 later = simd::later(one, other), earlier = simd::earlier(one, other);
  const std::uint32_t is_later = simd::is_later(one, other).bits();
  for (std::size_t lane = 0; lane < 8; ++lane) {
    CAPTURE(lane);
    CHECK(later[lane] == std::max(first[lane], second[lane]));
    CHECK(earlier[lane] == std::min(first[lane], second[lane]));
    if (first[lane] >= 0.0F) CHECK((is_later >> lane & 1U) == (first[lane] > second[lane] ? 1U : 0U));
  }
}

}  // namespace test_simd
