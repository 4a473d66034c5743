#include "dcem/io/shelter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "dcem/accel/wide_index.hpp"
#include "dcem/core/constants.hpp"

namespace dcem::io {
namespace {

constexpr double around_m = 100.0;
constexpr std::size_t directions_around = 8;
constexpr std::size_t most_free = 1;  ///< a gap between two sheets, a door that is not there

/// Not exactly upright, and none along an axis: edges and walls lie there.
const Vec3 upwards(1.3e-3, 2.1e-3, 1.0);
constexpr std::array<double, 2> slopes{0.05, 0.6};  ///< at the walls, and at where walls and roof meet
constexpr double first_azimuth_rad = 0.11;

bool is_scenery_met(const Simulator& simulator, const Vec3& from_m, const Vec3& direction, double farthest_m) {
  const Scene& scene = simulator.scene();
  const auto counts = [&](const TriangleHit& hit) {
    return hit.t <= farthest_m && scene.facet(scene.facet_of_triangle(hit.triangle)).body == BodyId{};
  };
  return simulator.index().visit_hits(Ray<double>{from_m, direction}, HitFilter{}, counts, nullptr);
}

bool is_reached(const std::vector<RadioMap>& maps, std::size_t point) {
  return std::ranges::any_of(maps, [&](const RadioMap& map) {
    return map.points[point].statistics.path_count > 0 || map.points[point].statistics.power_incoherent_dbm;
  });
}

bool transmits_indoors(const Simulator& simulator, const Frame& frame) {
  return std::ranges::any_of(simulator.scene().transmitters(), [&](const Device& device) {
    const DeviceState state = simulator.scene().device_state(device, frame);
    return state.present && is_under_a_roof(simulator, state.position_m);
  });
}

}  // namespace

bool is_under_a_roof(const Simulator& simulator, const Vec3& point_m) {
  constexpr double anywhere_m = 1e9;
  if (!is_scenery_met(simulator, point_m, upwards, anywhere_m)) return false;
  std::size_t free = 0;
  for (std::size_t index = 0; index < directions_around; ++index) {
    const double azimuth_rad = first_azimuth_rad + 2.0 * pi * static_cast<double>(index) / directions_around;
    for (const double slope : slopes) {
      const Vec3 direction(std::cos(azimuth_rad), std::sin(azimuth_rad), slope);
      free += is_scenery_met(simulator, point_m, direction, around_m) ? 0U : 1U;
    }
  }
  return free <= most_free;
}

void mark_sheltered(const Simulator& simulator, const Frame& frame, std::vector<RadioMap>& maps) {
  if (maps.empty() || transmits_indoors(simulator, frame)) return;
  for (std::size_t index = 0; index < maps.front().points.size(); ++index) {
    const RadioMapPoint& point = maps.front().points[index];
    if (point.obstructed || is_reached(maps, index) || !is_under_a_roof(simulator, point.position_m)) continue;
    for (RadioMap& map : maps) map.points[index].sheltered = true;
  }
}

}  // namespace dcem::io
