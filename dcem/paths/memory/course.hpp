#pragma once
/// The straight line that a device moves along, as long as it does.
#include <optional>

#include "dcem/geometry/vector.hpp"

namespace dcem {

/// Most devices go straight on for metres: what is asked of all points that such a one may get to is then asked of a
/// line, not of all that is around it. Told where it is, frame by frame.
class Course {
 public:
  /// By how much two points of one course may lie aside of each other: traces are rounded to a centimetre, and give
  /// the direction of a step as well as that.
  static constexpr double aside_m = 0.05;

  /// The device is at a point now. False where that is beside the line, or there was none yet: what was asked along it
  /// holds no longer.
  bool follow(const Vec3& at_m);
  /// Where the device is going, of length 1, and has gone for some frames; none where that is not known.
  const Vec3* ahead() const { return frames_ >= least_frames && ahead_ ? &*ahead_ : nullptr; }

 private:
  static constexpr int least_frames = 2;
  /// So long a way says better where it leads than its last step does.
  static constexpr double long_enough_m = 0.5;

  bool is_beside(const Vec3& at_m) const;
  void turn(const Vec3& at_m);

  std::optional<Vec3> ahead_, from_m_, last_m_;
  int frames_ = 0;  ///< on this line
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/memory/course_bodies.hpp"
#endif
