#pragma once
/// Four numbers at once, for what there is one of to a ray: its origin, its direction, the centre of a leaf. Beside
/// core/simd.hpp, which has eight of a kind.
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "dcem/core/simd_registers.hpp"

namespace dcem {

namespace detail {

inline namespace DCEM_ISA {

using Double4 = double __attribute__((vector_size(32)));

[[gnu::always_inline]] inline Float4 absolute(const Float4& value) {
  return std::bit_cast<Float4>(std::bit_cast<Int4>(value) & std::int32_t{0x7fffffff});
}
[[gnu::always_inline]] inline Float4 with_sign(const Float4& size, const Int4& sign) {
  return std::bit_cast<Float4>(std::bit_cast<Int4>(size) | sign);
}
/// The number `lane` in all four lanes.
template <int lane>
[[gnu::always_inline]] inline Float4 spread(const Float4& value) {
  return __builtin_shufflevector(value, value, lane, lane, lane, lane);
}
/// The lanes that `order` names.
[[gnu::always_inline]] inline Float4 permuted(const Float4& value, const Int4& order) {
#if defined(__AVX__)
  return __builtin_ia32_vpermilvarps(value, order);
#else
  return Float4{value[order[0]], value[order[1]], value[order[2]], value[order[3]]};
#endif
}
/// Bit i is the sign of lane i.
[[gnu::always_inline]] inline std::uint32_t sign_bits(const Int4& value) {
#if defined(__SSE2__)
  return static_cast<std::uint32_t>(__builtin_ia32_movmskps(std::bit_cast<Float4>(value)));
#else
  std::uint32_t bits = 0;
  for (std::size_t lane = 0; lane < 4; ++lane) bits |= (value[lane] < 0 ? 1U : 0U) << lane;
  return bits;
#endif
}
[[gnu::always_inline]] inline Float4 narrowed(const Double4& value) {
  return __builtin_convertvector(value, Float4);
}
/// What is left of numbers when their rounded ones are taken away.
[[gnu::always_inline]] inline Float4 remainder(const Double4& value, const Float4& rounded) {
#if defined(__AVX__) && !defined(__clang__)
  return narrowed(value - __builtin_ia32_cvtps2pd256(rounded));  // g++ 12 makes four steps of the portable form
#else
  return narrowed(value - __builtin_convertvector(rounded, Double4));
#endif
}
[[gnu::always_inline]] inline Float4 load_four(const void* numbers) {
  Float4 result;
  std::memcpy(&result, numbers, sizeof result);
  return result;
}
[[gnu::always_inline]] inline float float_at(const Float4& numbers, std::size_t lane) {
  float result;
  std::memcpy(&result, reinterpret_cast<const char*>(&numbers) + lane * sizeof(float), sizeof result);
  return result;
}

}  // namespace DCEM_ISA

}  // namespace detail

}  // namespace dcem
