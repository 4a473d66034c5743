#pragma once
/// What single precision knows of a ray and the eight quads of a leaf: which are met, where, and in which triangle.
#include <array>
#include <cstdint>

#include "dcem/core/simd.hpp"

namespace dcem {

/// Whether a ray meets a quad, and in which triangle.
enum class QuadCertainty : std::uint8_t {
  undecided,
  met,    ///< the line of the ray meets the quad
  first,  ///< it meets the first triangle of the quad
  second
};

inline namespace DCEM_ISA {

/// What is known of a ray and the quads of a leaf.
struct QuadHits {
  Float8 first;           ///< a quad is met no earlier than here
  Float8 last;            ///< and no later than here
  std::uint32_t certain;  ///< bit i: quad i is met, not before t_min
  /// Bit i: if quad i is met, then it is its first, or its second triangle, by the side of the diagonal on which the
  /// ray passes; neither where that is undecided.
  std::array<std::uint32_t, 2> side;

  bool is_certain(std::uint32_t lane) const { return (certain >> lane & 1U) != 0; }
  QuadCertainty certainty(std::uint32_t lane) const {
    const auto bit = [lane](std::uint32_t lanes) { return lanes >> lane & 1U; };
    return static_cast<QuadCertainty>(bit(certain) * (1 + bit(side[0]) + 2 * bit(side[1])));
  }
};

}  // namespace DCEM_ISA

}  // namespace dcem
