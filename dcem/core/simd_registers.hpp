#pragma once
/// The registers that numbers side by side lie in: the compiler's vector types (g++, clang), as many of them as eight
/// lanes need on the machine that is compiled for.
///
/// No intrinsics: sums, products, comparisons and `a < b ? a : b` on vector types become the instructions of whatever
/// is compiled for. One operation has no portable form that compiles well, collecting the signs of a comparison: x86
/// has an instruction for it, elsewhere plain code does it.
#include <bit>
#include <cstddef>
#include <cstdint>

#include "dcem/core/instruction_set.hpp"

namespace dcem {

using Float4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));

namespace detail {

inline namespace DCEM_ISA {

#if defined(__AVX__)
using FloatPart = float __attribute__((vector_size(32)));
using IntPart = std::int32_t __attribute__((vector_size(32)));
using UintPart = std::uint32_t __attribute__((vector_size(32)));

/// Lanes in one register.
template <typename Part>
struct SimdLanes {
  Part low;

  template <typename Operation>
  [[gnu::always_inline]] void each(Operation&& operation) {
    operation(low);
  }
  template <typename Other, typename Operation>
  [[gnu::always_inline]] void with(const SimdLanes<Other>& other, Operation&& operation) {
    operation(low, other.low);
  }
};
#else
using FloatPart = float __attribute__((vector_size(16)));
using IntPart = std::int32_t __attribute__((vector_size(16)));
using UintPart = std::uint32_t __attribute__((vector_size(16)));

/// Lanes in two registers: a vector wider than a register is taken apart lane by lane by g++. They lie where one wide
/// register would: what holds lanes looks the same to code that is compiled for other processors.
template <typename Part>
struct alignas(2 * sizeof(Part)) SimdLanes {
  Part low, high;

  template <typename Operation>
  [[gnu::always_inline]] void each(Operation&& operation) {
    operation(low);
    operation(high);
  }
  template <typename Other, typename Operation>
  [[gnu::always_inline]] void with(const SimdLanes<Other>& other, Operation&& operation) {
    operation(low, other.low);
    operation(high, other.high);
  }
};
#endif

inline constexpr std::size_t simd_part_lanes = sizeof(FloatPart) / sizeof(float);

/// Bit i is set where lane i, all ones or all zeros, is all ones.
[[gnu::always_inline]] inline std::uint32_t part_bits(const IntPart& lanes) {
#if defined(__AVX__)
  return static_cast<std::uint32_t>(__builtin_ia32_movmskps256(std::bit_cast<FloatPart>(lanes)));
#elif defined(__SSE2__)
  return static_cast<std::uint32_t>(__builtin_ia32_movmskps(std::bit_cast<FloatPart>(lanes)));
#else
  std::uint32_t result = 0;
  for (std::size_t lane = 0; lane < simd_part_lanes; ++lane) result |= (lanes[lane] != 0 ? 1U : 0U) << lane;
  return result;
#endif
}

}  // namespace DCEM_ISA

}  // namespace detail

}  // namespace dcem
