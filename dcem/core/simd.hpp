#pragma once
/// Eight numbers at once: what can be done with them, on the registers of simd_registers.hpp.
///
/// Nothing is multiplied and added in one step, although most processors can: every processor then computes the same
/// bits.
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "dcem/core/instruction_set.hpp"
#include "dcem/core/simd_registers.hpp"

namespace dcem {

inline constexpr std::uint32_t simd_lanes = 8;

inline namespace DCEM_ISA {

/// The result of a comparison: all bits of a lane are set where it holds.
struct Mask8 {
  detail::SimdLanes<detail::IntPart> lanes;

  [[gnu::always_inline]] friend Mask8 operator&(const Mask8& first, const Mask8& other) {
    Mask8 one = first;
    one.lanes.with(other.lanes, [](auto& part, const auto& by) { part &= by; });
    return one;
  }
  [[gnu::always_inline]] friend Mask8 operator|(const Mask8& first, const Mask8& other) {
    Mask8 one = first;
    one.lanes.with(other.lanes, [](auto& part, const auto& by) { part |= by; });
    return one;
  }

  /// Bit i is set where lane i holds.
  [[gnu::always_inline]] std::uint32_t bits() const {
#if defined(__AVX__)
    return detail::part_bits(lanes.low);
#else
    return detail::part_bits(lanes.low) | (detail::part_bits(lanes.high) << detail::simd_part_lanes);
#endif
  }
};

/// Eight single-precision numbers. A plain number stands for eight times itself. Functions take them by reference:
/// where one is passed by value, g++ notes that its version 4.6 has changed how.
struct Float8 {
  detail::SimdLanes<detail::FloatPart> lanes;

  Float8() = default;  // no initial value: it would cost where the lanes are written next
  [[gnu::always_inline]] Float8(float all) {
    // As a difference, because the compiler knows that it changes nothing; a sum would lose the sign of zero.
    lanes.each([all](auto& part) { part = all - detail::FloatPart{}; });
  }
  [[gnu::always_inline]] explicit Float8(const std::array<float, simd_lanes>& numbers) {
    std::memcpy(&lanes, numbers.data(), sizeof lanes);
  }
  /// The eight numbers at an address, which need not be aligned.
  [[gnu::always_inline]] static Float8 load(const void* numbers) {
    Float8 result;
    std::memcpy(&result.lanes, numbers, sizeof result.lanes);
    return result;
  }
  [[gnu::always_inline]] Float8(const Float4& first, const Float4& last) {
#if defined(__AVX__)
    lanes.low = __builtin_shufflevector(first, last, 0, 1, 2, 3, 4, 5, 6, 7);
#else
    lanes.low = first;
    lanes.high = last;
#endif
  }
  [[gnu::always_inline]] Float4 first_four() const {
#if defined(__AVX__)
    return __builtin_shufflevector(lanes.low, lanes.low, 0, 1, 2, 3);
#else
    return lanes.low;
#endif
  }
  [[gnu::always_inline]] Float4 last_four() const {
#if defined(__AVX__)
    return __builtin_shufflevector(lanes.low, lanes.low, 4, 5, 6, 7);
#else
    return lanes.high;
#endif
  }
  [[gnu::always_inline]] void store(std::array<float, simd_lanes>& numbers) const {
    std::memcpy(numbers.data(), &lanes, sizeof lanes);
  }
  float operator[](std::size_t lane) const {
    std::array<float, simd_lanes> numbers;
    store(numbers);
    return numbers[lane];
  }

  [[gnu::always_inline]] friend Float8 operator+(const Float8& first, const Float8& other) {
    Float8 one = first;
    one.lanes.with(other.lanes, [](auto& part, const auto& by) { part += by; });
    return one;
  }
  [[gnu::always_inline]] friend Float8 operator-(const Float8& first, const Float8& other) {
    Float8 one = first;
    one.lanes.with(other.lanes, [](auto& part, const auto& by) { part -= by; });
    return one;
  }
  [[gnu::always_inline]] friend Float8 operator*(const Float8& first, const Float8& other) {
    Float8 one = first;
    one.lanes.with(other.lanes, [](auto& part, const auto& by) { part *= by; });
    return one;
  }
  [[gnu::always_inline]] friend Float8 operator/(const Float8& first, const Float8& other) {
    Float8 one = first;
    one.lanes.with(other.lanes, [](auto& part, const auto& by) { part /= by; });
    return one;
  }
  [[gnu::always_inline]] friend Float8 operator-(const Float8& first) {
    Float8 one = first;
    one.lanes.each([](auto& part) { part = -part; });
    return one;
  }
  [[gnu::always_inline]] friend Mask8 operator<(const Float8& first, const Float8& other) {
    Float8 one = first;
    one.lanes.with(other.lanes, [](auto& part, const auto& by) { part = std::bit_cast<detail::FloatPart>(part < by); });
    return std::bit_cast<Mask8>(one.lanes);
  }
  [[gnu::always_inline]] friend Mask8 operator<=(const Float8& first, const Float8& other) {
    Float8 one = first;
    one.lanes.with(other.lanes,
                   [](auto& part, const auto& by) { part = std::bit_cast<detail::FloatPart>(part <= by); });
    return std::bit_cast<Mask8>(one.lanes);
  }
  [[gnu::always_inline]] friend Mask8 operator>(const Float8& one, const Float8& other) {
    return other < one;
  }
};

/// Operations on Float8 that have no sign of their own.
namespace simd {

/// The four numbers of each of eight places side by side: the first of all, the second of all, …
[[gnu::always_inline]] inline std::array<Float8, 4> turned(const std::array<const float*, simd_lanes>& places) {
  std::array<Float4, simd_lanes> rows;
  for (std::size_t lane = 0; lane < simd_lanes; ++lane) std::memcpy(&rows[lane], places[lane], sizeof rows[lane]);
  std::array<std::array<Float4, 4>, 2> halves;
  for (std::size_t half = 0; half < 2; ++half) {
    const Float4 &a = rows[4 * half], &b = rows[4 * half + 1], &c = rows[4 * half + 2], &d = rows[4 * half + 3];
    const Float4 ab_low = __builtin_shufflevector(a, b, 0, 4, 1, 5),
                 ab_high = __builtin_shufflevector(a, b, 2, 6, 3, 7);
    const Float4 cd_low = __builtin_shufflevector(c, d, 0, 4, 1, 5),
                 cd_high = __builtin_shufflevector(c, d, 2, 6, 3, 7);
    halves[half] = {
        __builtin_shufflevector(ab_low, cd_low, 0, 1, 4, 5), __builtin_shufflevector(ab_low, cd_low, 2, 3, 6, 7),
        __builtin_shufflevector(ab_high, cd_high, 0, 1, 4, 5), __builtin_shufflevector(ab_high, cd_high, 2, 3, 6, 7)};
  }
  return {Float8(halves[0][0], halves[1][0]), Float8(halves[0][1], halves[1][1]), Float8(halves[0][2], halves[1][2]),
          Float8(halves[0][3], halves[1][3])};
}

/// The smaller one in each lane; that of `other` where one of them is NaN.
[[gnu::always_inline]] inline Float8 minimum(const Float8& first, const Float8& other) {
  Float8 one = first;
  one.lanes.with(other.lanes, [](auto& part, const auto& by) { part = part < by ? part : by; });
  return one;
}
/// The larger one in each lane; that of `other` where one of them is NaN.
[[gnu::always_inline]] inline Float8 maximum(const Float8& first, const Float8& other) {
  Float8 one = first;
  one.lanes.with(other.lanes, [](auto& part, const auto& by) { part = part > by ? part : by; });
  return one;
}
/// `first` in the lanes where the mask holds, `other` in the rest.
[[gnu::always_inline]] inline Float8 select(const Mask8& mask, const Float8& first, const Float8& other) {
  Float8 one = first;
  Mask8 chosen = mask;
  chosen.lanes.with(one.lanes, [](auto& bits, const auto& part) { bits &= std::bit_cast<detail::IntPart>(part); });
  Mask8 rest = mask;
  rest.lanes.with(other.lanes,
                  [](auto& bits, const auto& part) { bits = ~bits & std::bit_cast<detail::IntPart>(part); });
  chosen = chosen | rest;
  one.lanes.with(chosen.lanes, [](auto& part, const auto& bits) { part = std::bit_cast<detail::FloatPart>(bits); });
  return one;
}
[[gnu::always_inline]] inline Float8 absolute(const Float8& of) {
  Float8 value = of;
  value.lanes.each([](auto& part) {
    part = std::bit_cast<detail::FloatPart>(std::bit_cast<detail::IntPart>(part) & std::int32_t{0x7fffffff});
  });
  return value;
}
/// Whether integers of the same bits are compared sooner than the numbers: in one step instead of four, where there are
/// instructions for it. Numbers from zero on have the order of their integers, and every number below is a negative
/// integer.
#if defined(__AVX2__) || !defined(__SSE2__)
inline constexpr bool compares_integers = true;
#else
inline constexpr bool compares_integers = false;
#endif

/// The larger one in each lane; of two below zero, either.
[[gnu::always_inline]] inline Float8 later(const Float8& first, const Float8& other) {
  Float8 one = first;
  if constexpr (!compares_integers) return maximum(one, other);
  one.lanes.with(other.lanes, [](auto& part, const auto& by) {
    const auto bits = std::bit_cast<detail::IntPart>(part), other_bits = std::bit_cast<detail::IntPart>(by);
    part = std::bit_cast<detail::FloatPart>(bits > other_bits ? bits : other_bits);
  });
  return one;
}
/// The smaller one in each lane; where one is below zero, one that is.
[[gnu::always_inline]] inline Float8 earlier(const Float8& first, const Float8& other) {
  Float8 one = first;
  if constexpr (!compares_integers) return minimum(one, other);
  one.lanes.with(other.lanes, [](auto& part, const auto& by) {
    const auto bits = std::bit_cast<detail::IntPart>(part), other_bits = std::bit_cast<detail::IntPart>(by);
    part = std::bit_cast<detail::FloatPart>(bits < other_bits ? bits : other_bits);
  });
  return one;
}
/// Whether `first`, from zero on, is larger than `other`, which may be anything. A zero with a sign counts as below
/// zero.
[[gnu::always_inline]] inline Mask8 is_later(const Float8& first, const Float8& other) {
  Float8 one = first;
  one.lanes.with(other.lanes, [](auto& part, const auto& by) {
    part = std::bit_cast<detail::FloatPart>(std::bit_cast<detail::IntPart>(part) > std::bit_cast<detail::IntPart>(by));
  });
  return std::bit_cast<Mask8>(one.lanes);
}
/// Rounded as everywhere: each lane has the bits of std::sqrt.
[[gnu::always_inline]] inline Float8 square_root(const Float8& of) {
  Float8 root = of;
#if defined(__AVX__)
  root.lanes.low = __builtin_ia32_sqrtps256(root.lanes.low);
#elif defined(__SSE2__)
  root.lanes.low = __builtin_ia32_sqrtps(root.lanes.low);
  root.lanes.high = __builtin_ia32_sqrtps(root.lanes.high);
#else
  root.lanes.each([](auto& part) {
    for (std::size_t lane = 0; lane < detail::simd_part_lanes; ++lane) part[lane] = std::sqrt(part[lane]);
  });
#endif
  return root;
}

}  // namespace simd

}  // namespace DCEM_ISA

}  // namespace dcem
