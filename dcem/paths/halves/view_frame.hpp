#pragma once
/// The faces that a view is drawn on: the six of a cube, or one that just holds a window.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "dcem/geometry/aabb.hpp"
#include "dcem/paths/halves/face_outline.hpp"

namespace dcem::detail {

/// What is seen along one axis, between −1 and 1 both ways.
struct WindowFrame {
  Vec3 across, along, depth;               ///< of an offset from the point that looks
  Vec3 across_of_normal, along_of_normal;  ///< of a normal, so that its product with an offset stays what it is
};

/// A convex window, and how finely it is looked through.
struct WindowView {
  std::span<const Vec3> window_m;
  double room_m;                      ///< around it
  double least_pixel_m;               ///< no pixel is smaller where the window is nearest
  int pixels;                         ///< to a side
  std::span<const Vec3> offsets_m{};  ///< of further points that look through the window
};

/// The smallest frame around a point that holds all that it, and the points beside it, see through a window; none where
/// that is too wide to be seen along one axis.
///
/// What the point P + δ sees through W is X = W + s (W − P − δ) with s ≥ 0: it is in the frame around P if W and W − δ
/// are.
inline std::optional<WindowFrame> frame_of_window(const Vec3& from_m, const WindowView& view) {
  const std::span<const Vec3> window_m = view.window_m;
  constexpr double widest = 2.0;  // tangent of half the angle
  Vec3 centre_m(0.0), longest_m(0.0);
  for (std::size_t index = 0; index < window_m.size(); ++index) {
    centre_m += (window_m[index] - from_m) / static_cast<double>(window_m.size());
    const Vec3 side_m = window_m[(index + 1) % window_m.size()] - window_m[index];
    if (glm::dot(side_m, side_m) > glm::dot(longest_m, longest_m)) longest_m = side_m;
  }
  const Vec3 depth = glm::normalize(centre_m);
  const Vec3 level = longest_m - glm::dot(longest_m, depth) * depth;
  const Vec3 across = glm::length(level) > 1e-6 * glm::length(longest_m)
                          ? glm::normalize(level)
                          : glm::normalize(glm::cross(depth, std::abs(depth.z) < 0.9 ? Vec3(0, 0, 1) : Vec3(1, 0, 0)));
  const Vec3 along = glm::cross(depth, across);
  double wide = 0.0, high = 0.0, nearest_m = std::numeric_limits<double>::infinity();
  const auto hold = [&](const Vec3& offset_m) {
    const double depth_m = glm::dot(offset_m, depth);
    if (!(depth_m > 1e-3)) return false;
    wide = std::max(wide, std::abs(glm::dot(offset_m, across)) / depth_m);
    high = std::max(high, std::abs(glm::dot(offset_m, along)) / depth_m);
    nearest_m = std::min(nearest_m, depth_m);
    return true;
  };
  for (const Vec3& corner_m : window_m) {
    if (!hold(corner_m - from_m)) return std::nullopt;
    for (const Vec3& other_m : view.offsets_m) {
      if (!hold(corner_m - from_m - other_m)) return std::nullopt;
    }
  }
  const double least = 0.5 * view.pixels * view.least_pixel_m / nearest_m, room = 4.0 * view.room_m / nearest_m;
  wide = std::max(least, 1.001 * wide + room);
  high = std::max(least, 1.001 * high + room);
  if (!(wide < widest && high < widest)) return std::nullopt;
  return WindowFrame{across / wide, along / high, depth, wide * across, high * along};
}

/// Some faces of a view, one after the other; without a word all of them.
struct FaceSpan {
  int first = 0, last = 6;  ///< one past the last
};

/// Some of the six faces of a cube along the axes, or the one face of a window.
class ViewFaces {
 public:
  ViewFaces() = default;
  explicit ViewFaces(const WindowFrame& window) : count_(1), window_(window), steepness_(steepness_of(window)) {}
  /// The faces of the cube on which something may be seen that is inside half spaces around the point that looks, all
  /// of their normals pointing inwards: faces clearly outside one of them are left out.
  explicit ViewFaces(std::span<const Vec3> inwards) : count_(0) {
    for (const int face : {0, 1, 2, 3, 4, 5}) {
      const bool is_outside =
          std::any_of(inwards.begin(), inwards.end(), [&](const Vec3& normal) { return looks_away(face, normal); });
      if (!is_outside) cube_[static_cast<std::size_t>(count_++)] = face;
    }
  }

  int count() const { return count_; }
  /// What is seen on a face, and a fiftieth over its rim, rises by no more than so many times as much as it is away
  /// along x or y.
  double steepness(int face) const {
    if (window_) return steepness_;
    return cube_[static_cast<std::size_t>(face)] / 2 < 2 ? 1.03 : std::numeric_limits<double>::infinity();
  }
  /// How wide a face is at a distance of one, along the axis on which that is less.
  double least_width() const {
    if (!window_) return 2.0;
    return 2.0 /
           std::sqrt(std::max(glm::dot(window_->across, window_->across), glm::dot(window_->along, window_->along)));
  }
  /// Those of a span that are there.
  FaceSpan in(const FaceSpan& faces) const { return {faces.first, std::min(faces.last, count_)}; }
  FacePoint point(int face, const Vec3& offset_m) const {
    if (window_) {
      return {glm::dot(window_->across, offset_m), glm::dot(window_->along, offset_m),
              glm::dot(window_->depth, offset_m)};
    }
    const int side = cube_[static_cast<std::size_t>(face)], axis = side / 2;
    return {offset_m[(axis + 1) % 3], offset_m[(axis + 2) % 3], side % 2 == 0 ? offset_m[axis] : -offset_m[axis]};
  }
  FacePoint normal(int face, const Vec3& normal) const {
    if (!window_) return point(face, normal);
    return {glm::dot(window_->across_of_normal, normal), glm::dot(window_->along_of_normal, normal),
            glm::dot(window_->depth, normal)};
  }
  /// The smallest box of such points that holds a box of offsets: its lowest and its highest corner.
  std::pair<FacePoint, FacePoint> box(int face, const Aabb<double>& offsets_m) const {
    if (!window_) {
      const FacePoint low = point(face, offsets_m.min), high = point(face, offsets_m.max);
      return {{low.across, low.along, std::min(low.depth, high.depth)},
              {high.across, high.along, std::max(low.depth, high.depth)}};
    }
    const Vec3 centre_m = offsets_m.center(), half_m = 0.5 * offsets_m.extent();
    const FacePoint middle = point(face, centre_m);
    const auto reach = [&](const Vec3& along) { return glm::dot(glm::abs(along), half_m) * (1.0 + 1e-12); };
    const FacePoint half{reach(window_->across), reach(window_->along), reach(window_->depth)};
    return {{middle.across - half.across, middle.along - half.along, middle.depth - half.depth},
            {middle.across + half.across, middle.along + half.along, middle.depth + half.depth}};
  }

 private:
  /// The height of a way over its length ahead is largest in a corner; of that length it has 0.7 along x or y.
  static double steepness_of(const WindowFrame& window) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const double level = std::hypot(window.depth.x, window.depth.y);
    if (!(level > 1e-6)) return infinity;
    const Vec3 ahead(window.depth.x / level, window.depth.y / level, 0.0);
    double steepest = 0.0;
    for (const double aside : {-1.02, 1.02}) {
      for (const double up : {-1.02, 1.02}) {
        const Vec3 way = window.depth + aside * window.across_of_normal + up * window.along_of_normal;
        const double length = glm::dot(way, ahead);
        steepest = std::max(steepest, length > 1e-6 ? std::abs(way.z) / length : infinity);
      }
    }
    return 1.42 * steepest;
  }

  /// Whether all directions over a face of the cube are clearly against a normal.
  static bool looks_away(int face, const Vec3& normal) {
    constexpr double clearly = 0.1;
    const int axis = face / 2;
    const double ahead = face % 2 == 0 ? normal[axis] : -normal[axis];
    return ahead + std::abs(normal[(axis + 1) % 3]) + std::abs(normal[(axis + 2) % 3]) < -clearly;
  }

  std::array<int, 6> cube_{0, 1, 2, 3, 4, 5};
  int count_ = 6;
  std::optional<WindowFrame> window_;
  double steepness_ = 0.0;  ///< of what is seen through the window
};

}  // namespace dcem::detail
