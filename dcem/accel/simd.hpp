#pragma once
/// Several numbers at once: the compiler's vector types (g++, clang), and the few operations that they lack.
///
/// Sums, products, comparisons and `a < b ? a : b` on these types become the instructions of whatever machine is
/// compiled for: eight lanes with AVX, two halves with SSE2 or NEON. Two operations have no portable form that compiles
/// well, collecting the signs of a comparison and multiplying and adding in one step: x86 has an instruction for each,
/// elsewhere plain code does it.
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace dcem {

inline constexpr std::uint32_t simd_lanes = 8;

using Float8 = float __attribute__((vector_size(32)));
using Int8 = std::int32_t __attribute__((vector_size(32)));
using Float4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));
using Double4 = double __attribute__((vector_size(32)));

/// All functions take references: a vector of 32 bytes passed by value would tie callers to one instruction set.
namespace simd {

[[gnu::always_inline]] inline void load(Float8& lanes, const float* from) {
  std::memcpy(&lanes, from, sizeof lanes);
}

/// The smaller one of each lane; that of `other` where one of them is NaN.
[[gnu::always_inline]] inline void set_minimum(Float8& one, const Float8& other) {
  one = one < other ? one : other;
}
/// The larger one of each lane; that of `other` where one of them is NaN.
[[gnu::always_inline]] inline void set_maximum(Float8& one, const Float8& other) {
  one = one > other ? one : other;
}

/// one · other + addend, in one rounding where the machine can.
[[gnu::always_inline]] inline void multiply_add(Float8& one, const Float8& other, const Float8& addend) {
#if defined(__AVX__) && defined(__FMA__)
  one = __builtin_ia32_vfmaddps256(one, other, addend);
#else
  one = one * other + addend;
#endif
}

/// Bit i is set where lane i of a comparison holds.
[[gnu::always_inline]] inline std::uint32_t bits(const Int8& comparison) {
#if defined(__AVX__)
  Float8 signs;
  std::memcpy(&signs, &comparison, sizeof signs);
  return static_cast<std::uint32_t>(__builtin_ia32_movmskps256(signs));
#elif defined(__SSE2__)
  Float4 halves[2];
  std::memcpy(halves, &comparison, sizeof halves);
  return static_cast<std::uint32_t>(__builtin_ia32_movmskps(halves[0]) | (__builtin_ia32_movmskps(halves[1]) << 4));
#else
  std::uint32_t result = 0;
  for (std::size_t lane = 0; lane < simd_lanes; ++lane) result |= (comparison[lane] != 0 ? 1U : 0U) << lane;
  return result;
#endif
}

}  // namespace simd

}  // namespace dcem
