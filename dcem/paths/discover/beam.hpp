#pragma once
/// A beam: everything that an image point can see through a convex window. It prunes the search over all sequences and
/// is conservative: what it discards cannot carry a path.
#include <span>
#include <vector>

#include "dcem/geometry/plane.hpp"

namespace dcem {

/// A cone with its apex at an image of the receiver, cut off by a convex window on the mirror that made the image.
/// Beyond the window the cone is where reflected legs run.
class Beam {
 public:
  /// `apex_m` is the image, `window_m` the corners of the lit part of the mirror in order around it.
  Beam(const Vec3& apex_m, const Plane& mirror, std::span<const Vec3> window_m) : apex_m_(apex_m), mirror_(mirror) {
    apex_side_ = signed_distance_m(mirror, apex_m) > 0.0 ? 1.0 : -1.0;
    Vec3 centre_m(0.0);
    for (const Vec3& corner : window_m) centre_m += corner / static_cast<double>(window_m.size());
    for (std::size_t index = 0; index < window_m.size(); ++index) {
      add_side(window_m[index], window_m[(index + 1) % window_m.size()], centre_m);
    }
  }

  const Vec3& apex_m() const { return apex_m_; }

  /// The part of a convex polygon inside the beam, into `inside_m`; false where there is none.
  bool clip(std::span<const Vec3> polygon_m, std::vector<Vec3>& inside_m) const {
    for (std::size_t side = 0; side <= side_normals_.size(); ++side) {
      bool any = false;
      for (const Vec3& corner : polygon_m) any = any || depth_m(side, corner) >= 0.0;
      if (!any) return false;
    }
    inside_m.assign(polygon_m.begin(), polygon_m.end());
    for (std::size_t side = 0; side <= side_normals_.size() && !inside_m.empty(); ++side) clip_by(side, inside_m);
    return !inside_m.empty();
  }

 private:
  /// Slack of every test: beams are a little wider than they are, so rounding discards nothing. 1e-6 m and 1e-6 rad are
  /// a million times the rounding error of points a kilometre away.
  static constexpr double slack = 1e-6;
  /// A window edge that looks shorter than this from the apex gives no reliable side plane; leaving it out only widens
  /// the beam.
  static constexpr double shortest_seen_edge_m = 1e-3;

  void add_side(const Vec3& from_m, const Vec3& to_m, const Vec3& centre_m) {
    const Vec3 scaled = glm::cross(from_m - apex_m_, to_m - from_m);
    const double length = glm::length(scaled);
    if (!(length > shortest_seen_edge_m * glm::distance(from_m, apex_m_))) return;
    const Vec3 normal = scaled / length;
    side_normals_.push_back(glm::dot(normal, centre_m - apex_m_) < 0.0 ? -normal : normal);
  }

  /// How far a point lies inside one boundary, slack included. The last boundary is the mirror itself.
  double depth_m(std::size_t side, const Vec3& point_m) const {
    if (side == side_normals_.size()) return slack - apex_side_ * signed_distance_m(mirror_, point_m);
    const Vec3 offset = point_m - apex_m_;
    return glm::dot(side_normals_[side], offset) + slack * (1.0 + glm::length(offset));
  }

  /// Sutherland and Hodgman 1974, one boundary.
  void clip_by(std::size_t side, std::vector<Vec3>& polygon_m) const {
    scratch_m_.clear();
    for (std::size_t index = 0; index < polygon_m.size(); ++index) {
      const Vec3 &from = polygon_m[index], &to = polygon_m[(index + 1) % polygon_m.size()];
      const double from_depth = depth_m(side, from), to_depth = depth_m(side, to);
      if (from_depth >= 0.0) scratch_m_.push_back(from);
      if ((from_depth >= 0.0) != (to_depth >= 0.0)) {
        scratch_m_.push_back(from + from_depth / (from_depth - to_depth) * (to - from));
      }
    }
    polygon_m.swap(scratch_m_);
  }

  Vec3 apex_m_;
  Plane mirror_;
  double apex_side_ = 1.0;
  std::vector<Vec3> side_normals_;
  mutable std::vector<Vec3> scratch_m_;
};

}  // namespace dcem
