#pragma once
/// As many double-precision numbers at once as a register of the machine holds, and vectors of them: beside simd.hpp,
/// for what is computed in double.
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "dcem/core/simd.hpp"

namespace dcem::detail {

inline namespace DCEM_ISA {

/// Double-precision lanes in one register.
using DoublePart = double __attribute__((vector_size(sizeof(FloatPart))));
using LongPart = std::int64_t __attribute__((vector_size(sizeof(FloatPart))));
inline constexpr std::size_t double_part_lanes = sizeof(DoublePart) / sizeof(double);

/// Single-precision numbers from the lanes of one register.
using NarrowPart = float __attribute__((vector_size(sizeof(DoublePart) / 2)));

[[gnu::always_inline]] inline void store_narrow(const DoublePart& part, float* to) {
  const NarrowPart narrow = __builtin_convertvector(part, NarrowPart);
  std::memcpy(to, &narrow, sizeof narrow);
}

[[gnu::always_inline]] inline DoublePart absolute(const DoublePart& part) {
  return std::bit_cast<DoublePart>(std::bit_cast<LongPart>(part) & std::int64_t{0x7fffffffffffffff});
}

/// The numbers that `value(lane)` gives.
template <typename Value>
[[gnu::always_inline]] inline void set_lanes(DoublePart& part, Value&& value) {
  if constexpr (double_part_lanes == 4) {
    part = DoublePart{value(0), value(1), value(2), value(3)};
  } else {
    part = DoublePart{value(0), value(1)};
  }
}

/// What `choose(one, other)`, for numbers as for registers, leaves of all lanes.
template <typename Choose>
[[gnu::always_inline]] inline double fold_lanes(const DoublePart& part, Choose&& choose) {
  if constexpr (double_part_lanes == 4) {
    using Double2 = double __attribute__((vector_size(16)));
    const Double2 two = choose(__builtin_shufflevector(part, part, 0, 1), __builtin_shufflevector(part, part, 2, 3));
    return choose(two[0], two[1]);
  } else {
    return choose(part[0], part[1]);
  }
}

/// A vector in each lane of a register.
struct VectorPart {
  DoublePart x, y, z;

  template <typename Vector>
  [[gnu::always_inline]] void set(Vector&& vector) {
    set_lanes(x, [&](std::size_t lane) { return vector(lane).x; });
    set_lanes(y, [&](std::size_t lane) { return vector(lane).y; });
    set_lanes(z, [&](std::size_t lane) { return vector(lane).z; });
  }
  [[gnu::always_inline]] void set_where(const LongPart& where, const VectorPart& then, const VectorPart& otherwise) {
    x = where ? then.x : otherwise.x;
    y = where ? then.y : otherwise.y;
    z = where ? then.z : otherwise.z;
  }
  [[gnu::always_inline]] void store(double* to_x, double* to_y, double* to_z) const {
    std::memcpy(to_x, &x, sizeof x);
    std::memcpy(to_y, &y, sizeof y);
    std::memcpy(to_z, &z, sizeof z);
  }
  [[gnu::always_inline]] void set_difference(const VectorPart& to, const VectorPart& from) {
    x = to.x - from.x;
    y = to.y - from.y;
    z = to.z - from.z;
  }
  [[gnu::always_inline]] void set_cross(const VectorPart& one, const VectorPart& other) {
    x = one.y * other.z - one.z * other.y;
    y = one.z * other.x - one.x * other.z;
    z = one.x * other.y - one.y * other.x;
  }
  [[gnu::always_inline]] void scale(const DoublePart& by) {
    x *= by;
    y *= by;
    z *= by;
  }
  [[gnu::always_inline]] void dot(const VectorPart& other, DoublePart& result) const {
    result = x * other.x + y * other.y + z * other.z;
  }
};

/// 1 / √value for values from 1e-300 to 1e300: a guess from the exponent, good to 4 %, and Newton's method,
/// y ← y (1.5 − value y² / 2). Four steps are good to rounding, two to 1e-5, from below.
[[gnu::always_inline]] inline void set_reciprocal_root(DoublePart& result, const DoublePart& value, int steps) {
  result = std::bit_cast<DoublePart>(0x5fe6eb50c7b537a9 - (std::bit_cast<LongPart>(value) >> 1));
  for (int step = 0; step < steps; ++step) result = result * (1.5 - 0.5 * value * result * result);
}

}  // namespace DCEM_ISA

}  // namespace dcem::detail
