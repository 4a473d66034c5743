#pragma once
/// A scene of which every point of every body may be up to a distance away from where it is.
///
/// Everything here is a bound that holds for all positions that bodies and ends can take within that distance.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "dcem/geometry/segment_distance.hpp"
#include "dcem/scene/scene.hpp"

namespace dcem {

/// A point known to within so many metres.
struct VaguePoint {
  Vec3 at_m{0.0};
  double moved_m = 0.0;
};

/// How a rigid body can turn while none of its points moves by more than some distance.
struct BodyShape {
  Vec3 centre_m{0.0};     ///< the mean of its corners: a point of its convex hull, so it moves by no more
  double turn_per_m = 0;  ///< |R − I| of its rotation R is at most this times that distance
};

namespace detail {

/// The largest eigenvalue of a symmetric matrix that is not negative, from above: powers of it by squaring, and the
/// trace of the n-th power is no less than the n-th power of the eigenvalue.
inline double largest_eigenvalue(Mat3 matrix) {
  const double scale = matrix[0][0] + matrix[1][1] + matrix[2][2];
  if (!(scale > 0.0)) return 0.0;
  matrix /= scale;
  double log_scale = std::log(scale), power = 1.0;
  for (int step = 0; step < 7; ++step) {
    matrix = matrix * matrix;
    power *= 2.0;
    const double trace = matrix[0][0] + matrix[1][1] + matrix[2][2];
    log_scale += std::log(trace) / power;
    matrix /= trace;
  }
  return std::exp(log_scale) * (1.0 + 1e-9);
}

}  // namespace detail

/// With the corners v of the body, their mean m, and displacements u(v) of at most r under a motion with the rotation
/// R, Σ|(R − I)(v − m)|² = Σ|u(v) − u(m)|² ≤ Σ|u(v)|² ≤ N r². The left side is |R − I|² Σ|(v − m) across the axis|²,
/// and that sum is no less than the trace of C = Σ(v − m)(v − m)ᵀ less its largest eigenvalue.
inline BodyShape shape_of_body(const Scene& scene, BodyId body) {
  const auto [first, last] = scene.triangle_range(body);
  BodyShape shape;
  const double count = 3.0 * (last - first);
  for (std::uint32_t triangle = first; triangle < last; ++triangle) {
    for (const Vec3& corner_m : scene.corners_m(triangle)) shape.centre_m += corner_m / count;
  }
  Mat3 spread(0.0);
  for (std::uint32_t triangle = first; triangle < last; ++triangle) {
    for (const Vec3& corner_m : scene.corners_m(triangle)) {
      const Vec3 away_m = corner_m - shape.centre_m;
      spread += glm::outerProduct(away_m, away_m);
    }
  }
  const double trace = spread[0][0] + spread[1][1] + spread[2][2];
  const double across = trace - detail::largest_eigenvalue(spread);
  shape.turn_per_m = across > 1e-12 * trace ? std::sqrt(count / across) : 1e12;
  return shape;
}

/// The shapes of all bodies where they are now.
inline std::vector<BodyShape> body_shapes(const Scene& scene) {
  std::vector<BodyShape> shapes(scene.bodies().size());
  for (std::size_t body = 1; body < shapes.size(); ++body) {
    if (scene.body_state(BodyId(body)).present) shapes[body] = shape_of_body(scene, BodyId(body));
  }
  return shapes;
}

/// Seen from the scenery, or from a body: for what is over one body alone it is the ends that move, and the body
/// stands.
class VagueScene {
 public:
  /// Bodies may be up to `moved_m` from where they are. What is handed over must stay.
  VagueScene(const Scene& scene, const std::vector<BodyShape>& shapes, double moved_m, BodyId frame = BodyId(0))
      : scene_(scene), shapes_(shapes), moved_m_(moved_m), frame_(frame) {}

  const Scene& scene() const { return scene_; }
  double moved_m() const { return moved_m_; }
  BodyId frame() const { return frame_; }

  /// A device that stands on nothing.
  VaguePoint end(const Vec3& position_m) const { return {position_m, moved_m_ + drag_m(frame_, position_m, moved_m_)}; }

  /// How far points of a body, and what is between them, may be from where they are.
  double reach_m(BodyId body, std::span<const Vec3> points_m) const {
    if (body == frame_) return 0.0;
    double most_m = 0.0;
    const double own_m = body.value == 0 ? 0.0 : moved_m_;
    for (const Vec3& point_m : points_m) most_m = std::max(most_m, own_m + drag_m(frame_, point_m, own_m));
    return most_m;
  }
  /// The same for any body that is no farther than the result and `more_m` from a segment; infinite where that is no
  /// bound. With t the turn, a point that is e away moves by at most a + t e, so e = (a + more)/(1 − t) is enough.
  double most_reach_m(const Segment& segment, double more_m) const {
    const double turned = turn_of(frame_);
    if (!(turned < 0.5)) return std::numeric_limits<double>::infinity();
    const double at_ends_m =
        moved_m_ + std::max(drag_m(frame_, segment.from_m, moved_m_), drag_m(frame_, segment.to_m, moved_m_));
    return (at_ends_m + turned * more_m) / (1.0 - turned);
  }

  /// How far a body can turn, as |R − I|.
  double turn(BodyId body) const { return body == frame_ ? 0.0 : turn_of(body) + turn_of(frame_); }

  /// A body has moved by g, and so a point x, seen from the body, is at g⁻¹(x): how far that may be from where the
  /// point is now. Seen from a body that moves itself by f, it is |g⁻¹ f(x) − x| ≤ |g⁻¹(f(x)) − f(x)| + |f(x) − x|.
  double seen_moved_m(BodyId body, const VaguePoint& point) const {
    return point.moved_m + against_m(body, point.at_m, 0.0);
  }

  /// The image in a mirror. With M the reflection as the mirror stands, that in the moved one is g M g⁻¹, an isometry.
  VaguePoint image(FacetId mirror, const VaguePoint& point) const {
    const WorldFacet& facet = scene_.facet(mirror);
    const Vec3 image_m = mirrored(facet.plane, point.at_m);
    if (facet.body == frame_) return {image_m, point.moved_m};
    const double back_m = against_m(facet.body, point.at_m, 0.0);
    return {image_m, point.moved_m + back_m + against_m(facet.body, image_m, back_m)};
  }

 private:
  double turn_of(BodyId body) const { return body.value == 0 ? 0.0 : shapes_[body.value].turn_per_m * moved_m_; }
  /// How far a point that a body carries along, though it is away from it, may be from `point_m`, seen from the
  /// scenery; the point itself is known to within `slack_m`. |g(x) − x| ≤ |(R − I)(x − c)| + |g(c) − c|.
  double drag_m(BodyId body, const Vec3& point_m, double slack_m) const {
    if (body.value == 0) return 0.0;
    return moved_m_ + turn_of(body) * (glm::distance(point_m, shapes_[body.value].centre_m) + slack_m);
  }
  /// The same, there and back, seen from the frame.
  double against_m(BodyId body, const Vec3& point_m, double slack_m) const {
    if (body == frame_) return 0.0;
    const double frame_m = drag_m(frame_, point_m, slack_m + moved_m_);
    return frame_m + drag_m(body, point_m, slack_m + moved_m_ + frame_m);
  }

  const Scene& scene_;
  const std::vector<BodyShape>& shapes_;
  double moved_m_;
  BodyId frame_;
};

}  // namespace dcem
