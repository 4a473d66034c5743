#pragma once
/// Bodies of launch_sphere.hpp.
#include <cmath>
#include <cstdint>
#include <map>
#include <mutex>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "dcem/accel/ray_order.hpp"
#include "dcem/core/build_mode.hpp"
#include "dcem/paths/discover/launch_sphere.hpp"

namespace dcem {

DCEM_INLINE Mat3 random_rotation(RandomStream& random) {
  const double u1 = random.uniform(), u2 = 2.0 * pi * random.uniform(), u3 = 2.0 * pi * random.uniform();
  const double x = std::sqrt(1.0 - u1) * std::sin(u2), y = std::sqrt(1.0 - u1) * std::cos(u2);
  const double z = std::sqrt(u1) * std::sin(u3), w = std::sqrt(u1) * std::cos(u3);
  return Mat3(1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y),  //
              2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x),  //
              2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y));
}

DCEM_INLINE Mat3 launch_rotation(std::uint64_t seed, std::string_view receiver_id, std::size_t frame) {
  RandomStream random(hash_values(seed, hash_text(receiver_id), frame));
  return random_rotation(random);
}

DCEM_INLINE std::span<const Vec3> launch_directions(std::uint32_t count) {
  static std::mutex mutex;
  static std::map<std::uint32_t, std::vector<Vec3>> spheres;
  const std::scoped_lock lock(mutex);
  const auto known = spheres.find(count);
  if (known != spheres.end()) return known->second;
  std::vector<Ray<double>> rays;
  for (std::uint32_t index = 0; index < count; ++index) {
    rays.push_back({Vec3(0.0), fibonacci_direction(index, count)});
  }
  std::vector<Vec3> sphere;
  RayOrder order;
  for (const std::uint32_t index : order.sort(rays)) sphere.push_back(rays[index].direction);
  return spheres.emplace(count, std::move(sphere)).first->second;
}

}  // namespace dcem
