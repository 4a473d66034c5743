#include "dcem/io/src/import/start_devices.hpp"

#include <cmath>
#include <numbers>

#include "dcem/io/src/import/import_draft.hpp"

namespace dcem::io {

nlohmann::ordered_json open_points_json(const ImportDraft& draft, const std::vector<TownPart>& parts,
                                        const Vec2& around_m, std::size_t count) {
  constexpr double first_radius_m = 15.0, step_m = 11.0, height_m = 1.5;
  constexpr std::size_t most_tries = 400;
  const double golden_rad = std::numbers::pi * (3.0 - std::sqrt(5.0));  // no direction comes twice
  nlohmann::ordered_json points = nlohmann::ordered_json::array();
  for (std::size_t attempt = 0; attempt < most_tries && points.size() < count; ++attempt) {
    const double turn_rad = golden_rad * static_cast<double>(attempt);
    const double radius_m = first_radius_m + step_m * std::sqrt(static_cast<double>(attempt));
    const Vec2 point_m = around_m + radius_m * Vec2(std::cos(turn_rad), std::sin(turn_rad));
    const Vec2 rounded_m = glm::round(10.0 * point_m) / 10.0;  // 24.2, not 24.200000000000003
    if (roof_height_m(parts, rounded_m) == 0.0) {
      points.push_back({rounded_m.x, rounded_m.y, ground_m(draft, rounded_m) + height_m});
    }
  }
  return points;
}

}  // namespace dcem::io
