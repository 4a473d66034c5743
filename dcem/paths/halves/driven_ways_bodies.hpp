#pragma once
/// Bodies of driven_ways.hpp.
#include <algorithm>
#include <cmath>
#include <utility>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/halves/driven_ways.hpp"

namespace dcem {

DCEM_INLINE void DrivenWays::note(std::size_t device, const std::optional<Vec3>& at_m) {
  if (device >= last_m_.size()) {
    last_m_.resize(device + 1);
    followed_until_.resize(device + 1, 0);
  }
  const std::optional<Vec3> before_m = std::exchange(last_m_[device], at_m);
  if (!at_m || !before_m) return;
  const Vec3 step_m = *at_m - *before_m;
  const double length_m = glm::length(step_m);
  if (!(length_m > 0.0 && length_m <= longest_step_m)) return;
  const int samples = static_cast<int>(std::ceil(2.0 * length_m / cell_m));
  for (int sample = 1; sample <= samples; ++sample) {
    const Cell cell = cell_of(*before_m + static_cast<double>(sample) / samples * step_m, step_m);
    note_followed_at(cell, device);
    cells_.insert_or_assign(cell, Passed{device, frame_});
  }
}

/// Cells beside it, and headings beside its own, count as well: none is to be missed for lying on a border.
DCEM_INLINE void DrivenWays::note_followed_at(const Cell& cell, std::size_t device) {
  for (std::int32_t x = cell.x - 1; x <= cell.x + 1; ++x) {
    for (std::int32_t y = cell.y - 1; y <= cell.y + 1; ++y) {
      for (std::int32_t turn = sectors - 1; turn <= sectors + 1; ++turn) {
        const auto passed = cells_.find({x, y, cell.level, (cell.sector + turn) % sectors});
        if (passed == cells_.end() || passed->second.device == device) continue;
        if (passed->second.frame + lifetime_frames < frame_) continue;
        followed_until_[passed->second.device] = frame_ + following_frames;
      }
    }
  }
}

DCEM_INLINE void DrivenWays::next_frame() {
  ++frame_;
  if (frame_ % 64 != 0) return;
  std::erase_if(cells_, [&](const auto& cell) { return cell.second.frame + lifetime_frames < frame_; });
}

DCEM_INLINE DrivenWays::Cell DrivenWays::cell_of(const Vec3& at_m, const Vec3& step_m) {
  const auto number = [](double along_m, double size_m) {
    return static_cast<std::int32_t>(std::clamp(std::floor(along_m / size_m), -1e9, 1e9));
  };
  // Eighths of a turn, from the east on, without a function that differs from library to library.
  const bool is_steep = std::abs(step_m.y) > std::abs(step_m.x);
  const std::int32_t quarter = step_m.y >= 0.0 ? (step_m.x > 0.0 ? 0 : 1) : (step_m.x > 0.0 ? 3 : 2);
  const std::int32_t sector = 2 * quarter + (is_steep == (quarter % 2 == 0) ? 1 : 0);
  return {number(at_m.x, cell_m), number(at_m.y, cell_m), number(at_m.z, level_m), sector};
}

}  // namespace dcem
