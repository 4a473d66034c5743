#pragma once
/// Which of eight images may see anything through a window.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/core/simd.hpp"
#include "dcem/geometry/plane.hpp"
#include "dcem/paths/halves/lanes.hpp"

namespace dcem {

/// A cheap test before cones are made, with the images as lanes: in single precision, with room for its rounding.
class WindowLanes {
 public:
  /// A convex window in a plane, counted from `origin_m`.
  WindowLanes(const Plane& plane, std::span<const Vec3> window_m, const Vec3& origin_m)
      : normal_(plane.normal), offset_(glm::dot(plane.normal, plane.point_m - origin_m)) {
    Vec3 around(0.0);
    for (std::size_t index = 0; index < window_m.size(); ++index) {
      const Vec3 &from = window_m[index], &to = window_m[(index + 1) % window_m.size()];
      sides_.push_back({from - origin_m, to - from});
      around += glm::cross(from - window_m[0], to - window_m[0]);
    }
    turn_ = glm::dot(around, plane.normal) < 0.0 ? -1.0F : 1.0F;
  }

  /// Of the images in `lanes`, those that may see some of the boxes beyond the window.
  std::uint32_t seeing(const LanePoints& images, std::span<const ConeClusters::Box> boxes, std::uint32_t lanes) const;

 private:
  struct Side {
    Vec3 from, along;
  };
  Vec3 normal_;
  double offset_;
  std::vector<Side> sides_;
  float turn_;  ///< 1 where the corners are counterclockwise, seen from where the normal points to
};

// ---------------------------------------------------------------------------------------------------------------------

inline std::uint32_t WindowLanes::seeing(const LanePoints& images, std::span<const ConeClusters::Box> boxes,
                                         std::uint32_t lanes) const {
  const auto number = [](double value) { return static_cast<float>(value); };
  const Float8 height = dot(images, number(normal_.x), number(normal_.y), number(normal_.z)) - number(offset_);
  const Float8 side = Float8(-turn_) * height;  // of any length
  // Rounding of the images and of the sides through them.
  const Float8 room =
      Float8(1e-2F) + Float8(1e-5F) * (simd::absolute(images.x) + simd::absolute(images.y) + simd::absolute(images.z));
  std::uint32_t seeing = lanes & (simd::absolute(height) <= room).bits();  // nothing is known of them
  for (const ConeClusters::Box& box : boxes) {
    const Float8 hx = room + box.half[0], hy = room + box.half[1], hz = room + box.half[2];
    const Vec3 centre(box.centre[0], box.centre[1], box.centre[2]);
    const Float8 reach = Float8(std::abs(number(normal_.x))) * hx + Float8(std::abs(number(normal_.y))) * hy +
                         Float8(std::abs(number(normal_.z))) * hz;
    const Float8 beyond = Float8(number(offset_ - glm::dot(normal_, centre))) * height;
    std::uint32_t left = lanes & ~seeing & ~(beyond + simd::absolute(height) * reach < Float8(0.0F)).bits();
    for (const Side& line : sides_) {
      const Float8 ax = images.x - number(line.from.x), ay = images.y - number(line.from.y),
                   az = images.z - number(line.from.z);
      const float bx = number(line.along.x), by = number(line.along.y), bz = number(line.along.z);
      const Float8 nx = side * (az * by - ay * bz), ny = side * (ax * bz - az * bx), nz = side * (ay * bx - ax * by);
      const Float8 inside = nx * (Float8(box.centre[0]) - number(line.from.x)) +
                            ny * (Float8(box.centre[1]) - number(line.from.y)) +
                            nz * (Float8(box.centre[2]) - number(line.from.z)) + simd::absolute(nx) * hx +
                            simd::absolute(ny) * hy + simd::absolute(nz) * hz;
      left &= ~(inside < Float8(0.0F)).bits();
      if (left == 0) break;
    }
    seeing |= left;
    if (seeing == lanes) break;
  }
  return seeing;
}

}  // namespace dcem
