#pragma once
/// The directions in which a receiver shoots its rays.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <string_view>

#include "dcem/core/constants.hpp"
#include "dcem/core/random.hpp"
#include "dcem/geometry/ray.hpp"
#include "dcem/geometry/vector.hpp"

namespace dcem {

/// Directions of a Fibonacci sphere: point i of n has height 1 − (2i + 1)/n and azimuth i·π(3 − √5).
/// Source: Swinbank and Purser, Q. J. R. Meteorol. Soc. 132, 2006.
inline Vec3 fibonacci_direction(std::uint32_t index, std::uint32_t count) {
  const double z = 1.0 - (2.0 * index + 1.0) / count;
  const double radius = std::sqrt(std::max(0.0, 1.0 - z * z));
  const double azimuth_rad = index * (pi * (3.0 - std::sqrt(5.0)));
  return {radius * std::cos(azimuth_rad), radius * std::sin(azimuth_rad), z};
}

/// A rotation drawn uniformly from all rotations (Shoemake, Graphics Gems III, 1992).
Mat3 random_rotation(RandomStream& random);

/// The rotation of the launch sphere of one receiver in one frame.
Mat3 launch_rotation(std::uint64_t seed, std::string_view receiver_id, std::size_t frame);

/// All directions of a sphere of `count` rays, in an order in which neighbours follow each other: a Fibonacci sphere
/// goes round with every point, and each ray would look at another part of the scene than the one before. Computed once
/// and kept; any thread may ask.
std::span<const Vec3> launch_directions(std::uint32_t count);

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/discover/launch_sphere_bodies.hpp"
#endif
