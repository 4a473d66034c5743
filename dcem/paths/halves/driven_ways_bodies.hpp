#pragma once
/// Bodies of driven_ways.hpp.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/halves/driven_ways.hpp"

namespace dcem {

DCEM_INLINE void DrivenWays::note(std::size_t device, const std::optional<Vec3>& at_m) {
  if (device >= devices_.size()) devices_.resize(device + 1);
  const std::optional<Vec3> before_m = std::exchange(devices_[device].last_m, at_m);
  if (!at_m || !before_m) return;
  const Vec3 step_m = *at_m - *before_m;
  const double length_m = glm::length(step_m);
  if (!(length_m > 0.0 && length_m <= longest_step_m)) return;
  const Vec3 towards = step_m / length_m;
  const int samples = static_cast<int>(std::ceil(2.0 * length_m / cell_m));
  for (int sample = 1; sample <= samples; ++sample) {
    const Vec3 here_m = *before_m + static_cast<double>(sample) / samples * step_m;
    look_who_passed(here_m, towards, device);
    cells_.insert_or_assign(cell_of(here_m), Passed{device, frame_, here_m, towards});
  }
}

DCEM_INLINE void DrivenWays::look_who_passed(const Vec3& at_m, const Vec3& towards, std::size_t device) {
  const Cell cell = cell_of(at_m);
  for (std::int32_t x = cell.x - 1; x <= cell.x + 1; ++x) {
    for (std::int32_t y = cell.y - 1; y <= cell.y + 1; ++y) {
      const auto found = cells_.find({x, y});
      if (found == cells_.end() || found->second.device == device) continue;
      if (!is_same_way(found->second, at_m, towards)) continue;
      devices_[found->second.device].followed.note(frame_);
      devices_[device].follows.note(frame_);
    }
  }
}

/// Not of one that is level with it: of two side by side none follows.
DCEM_INLINE bool DrivenWays::is_same_way(const Passed& passed, const Vec3& at_m, const Vec3& towards) const {
  if (passed.frame + 2 > frame_ || passed.frame + lifetime_frames < frame_) return false;
  const Vec3 away_m = at_m - passed.at_m;
  const Vec3 beside = away_m - glm::dot(away_m, towards) * towards;
  return glm::dot(passed.towards, towards) >= least_cosine && std::hypot(beside.x, beside.y) <= beside_m &&
         std::abs(beside.z) <= above_m;
}

DCEM_INLINE void DrivenWays::Streak::note(std::uint64_t frame) {
  if (last_frame == frame) return;
  count = last_frame + 1 == frame ? count + 1 : 1;
  last_frame = frame;
  if (count >= least_frames) until = frame + lasting_frames;
}

DCEM_INLINE void DrivenWays::next_frame() {
  ++frame_;
  if (frame_ % 16 != 0) return;
  std::erase_if(cells_, [&](const auto& cell) { return cell.second.frame + lifetime_frames < frame_; });
}

DCEM_INLINE DrivenWays::Cell DrivenWays::cell_of(const Vec3& at_m) {
  const auto number = [](double along_m) {
    return static_cast<std::int32_t>(std::clamp(std::floor(along_m / cell_m), -1e9, 1e9));
  };
  return {number(at_m.x), number(at_m.y)};
}

}  // namespace dcem
