#pragma once
/// Bodies of receiver_way.hpp.
#include "dcem/core/build_mode.hpp"
#include "dcem/paths/memory/receiver_way.hpp"

namespace dcem {

DCEM_INLINE bool ReceiverWay::go_on(const Vec3& at_m) {
  if (before_m_) step_m_ = glm::distance(*before_m_, at_m);
  come_m_ += 1.000001 * step_m_ + 1e-9;
  before_m_ = at_m;
  const bool was_asked_along = course_.ahead() != nullptr;
  return course_.follow(at_m) || !was_asked_along;
}

}  // namespace dcem
