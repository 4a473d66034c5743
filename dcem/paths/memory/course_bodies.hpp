#pragma once
/// Bodies of course.hpp.
#include "dcem/core/build_mode.hpp"
#include "dcem/paths/memory/course.hpp"

namespace dcem {

DCEM_INLINE bool Course::follow(const Vec3& at_m) {
  if (!last_m_) {
    from_m_ = last_m_ = at_m;
    return true;
  }
  const bool stays = ahead_ && !is_beside(at_m);
  if (!stays) turn(at_m);
  frames_ += stays && frames_ < least_frames ? 1 : 0;
  last_m_ = at_m;
  return stays;
}

DCEM_INLINE bool Course::is_beside(const Vec3& at_m) const {
  const Vec3 way_m = at_m - *from_m_;
  return !(glm::length(way_m - glm::dot(way_m, *ahead_) * *ahead_) <= 0.5 * aside_m);
}

/// Sets out from where the device is now.
DCEM_INLINE void Course::turn(const Vec3& at_m) {
  const Vec3 way_m = at_m - *from_m_;
  const Vec3 step_m = glm::length(way_m) < long_enough_m ? at_m - *last_m_ : way_m;
  const double length_m = glm::length(step_m);
  ahead_ = length_m > 0.0 ? std::optional(step_m / length_m) : std::nullopt;
  from_m_ = at_m;
  frames_ = 0;
}

}  // namespace dcem
