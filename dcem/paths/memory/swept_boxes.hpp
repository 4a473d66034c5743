#pragma once
/// Where bodies that have changed were a moment ago, and where they are: what comes near to none of these boxes is as
/// it was.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "dcem/geometry/aabb.hpp"
#include "dcem/geometry/pose.hpp"

namespace dcem {

/// A box with axes of its own.
struct TurnedBox {
  Vec3 centre_m{0.0};
  Mat3 axes{1.0};  ///< as columns, of unit length
  Vec3 half_m{0.0};

  /// Whether a straight leg comes into the box. Along each axis of the box the leg is inside between two places of it;
  /// it meets the box where all three stretches and the leg itself have a place in common.
  bool meets(const Vec3& from_m, const Vec3& to_m) const {
    const Vec3 start = (from_m - centre_m) * axes, way = (to_m - from_m) * axes;  // row times matrix: along the axes
    double first = 0.0, last = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
      const double inverse = 1.0 / way[axis];
      const double one = (-half_m[axis] - start[axis]) * inverse, other = (half_m[axis] - start[axis]) * inverse;
      if (std::isnan(one) || std::isnan(other)) continue;  // along a face, in its plane
      first = std::max(first, std::min(one, other));
      last = std::min(last, std::max(one, other));
      if (first > last) return false;
    }
    return true;
  }

  Aabb<double> around() const {
    const Vec3 reach = glm::abs(axes[0]) * half_m.x + glm::abs(axes[1]) * half_m.y + glm::abs(axes[2]) * half_m.z;
    return {centre_m - reach, centre_m + reach};
  }
};

/// The box of a body in its own axes, at a pose, grown on every side.
inline TurnedBox box_at(const Aabb<double>& local, const Pose& pose, double margin_m) {
  const Mat3 axes = rotation_matrix(pose);
  return {pose.position_m + axes * local.center(), axes, 0.5 * local.extent() + margin_m};
}

class SweptBoxes {
 public:
  void clear() {
    boxes_.clear();
    around_.clear();
  }
  void add(const Aabb<double>& local, const Pose& pose, double margin_m) {
    boxes_.push_back(box_at(local, pose, margin_m));
    around_.push_back(boxes_.back().around());
  }
  bool empty() const { return boxes_.empty(); }

  /// Whether any leg of a way through points comes near to a box; `around`: a box that holds the way.
  bool meet(std::span<const Vec3> points_m, const Aabb<double>& around) const {
    for (std::size_t number = 0; number < boxes_.size(); ++number) {
      if (!around_[number].overlaps(around)) continue;
      for (std::size_t leg = 1; leg < points_m.size(); ++leg) {
        if (boxes_[number].meets(points_m[leg - 1], points_m[leg])) return true;
      }
    }
    return false;
  }

 private:
  std::vector<TurnedBox> boxes_;
  std::vector<Aabb<double>> around_;
};

}  // namespace dcem
