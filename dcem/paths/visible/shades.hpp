#pragma once
/// What may stand before a surface, as seen from one end of a link: the convex patches in its view.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "dcem/paths/halves/facet_outlines.hpp"
#include "dcem/paths/halves/hull_sides.hpp"
#include "dcem/paths/query/leg_filter.hpp"
#include "dcem/paths/query/link_end.hpp"

namespace dcem {

/// The directions from a point to something: those within an angle of an axis. A cone that is as wide as half of all
/// directions stands for all of them.
struct DirectionCone {
  Vec3 axis{0.0, 0.0, 1.0};
  double cosine = 1.0, sine = 0.0;  ///< of the angle
  bool is_all = true;

  /// Below this cosine of its angle a cone counts as all directions.
  static constexpr double least_cosine = 0.1;

  /// The cone of some points, of which none may be at `from_m`.
  static DirectionCone around(const Vec3& from_m, std::span<const Vec3> points_m) {
    Vec3 sum(0.0);
    for (const Vec3& point_m : points_m) sum += glm::normalize(point_m - from_m);
    const double length = glm::length(sum);
    if (!(length > 1e-6)) return {};
    DirectionCone cone{sum / length};
    for (const Vec3& point_m : points_m) {
      cone.cosine = std::min(cone.cosine, glm::dot(cone.axis, glm::normalize(point_m - from_m)));
    }
    cone.is_all = !(cone.cosine > least_cosine);
    cone.sine = std::sqrt(std::max(0.0, 1.0 - cone.cosine * cone.cosine));
    return cone;
  }
};

/// The shades of one end, in the order of their facets.
class Shades {
 public:
  struct Shade {
    FacetId facet;
    BodyId body;
    std::uint32_t first_corner = 0, corner_count = 0;
    Vec3 normal{0.0};       ///< of its plane, away from the end
    double offset_m = 0.0;  ///< no more than normal·x of any of its points
    bool transmits = false;
  };

  Shades() = default;
  /// `seen`: the facets that the end may see, ascending. What lies behind none of them is seen.
  Shades(const Scene& scene, const FacetOutlines& outlines, const LinkEnd& end, std::span<const FacetId> seen);

  const Vec3& from_m() const { return from_m_; }
  std::size_t size() const { return shades_.size(); }
  const Shade& operator[](std::size_t index) const { return shades_[index]; }
  std::span<const Vec3> corners_m(const Shade& shade) const {
    return std::span(corners_m_).subspan(shade.first_corner, shade.corner_count);
  }
  /// The sides of the cone behind a shade: planes through the end, as many as there are corners or fewer.
  std::span<const HullSide> sides(std::size_t index) const {
    return std::span(sides_).subspan(first_side_[index], first_side_[index + 1] - first_side_[index]);
  }

  /// The shades that may be within a cone and nearer than `farthest_m`, the widest first.
  void find(const DirectionCone& cone, double farthest_m, std::vector<std::uint32_t>& found) const;

  /// Adds the sides of the cone from a point over a convex polygon.
  static void add_sides(const Vec3& from_m, std::span<const Vec3> corners_m, std::vector<HullSide>& sides) {
    Vec3 middle(0.0);
    for (const Vec3& corner_m : corners_m) middle += corner_m - from_m;
    for (std::size_t index = 0; index < corners_m.size(); ++index) {
      const Vec3 &here_m = corners_m[index], &next_m = corners_m[index + 1 == corners_m.size() ? 0 : index + 1];
      Vec3 normal = glm::cross(here_m - from_m, next_m - from_m);
      const double length = glm::length(normal);
      if (!(length > shortest_side_m * glm::length(here_m - from_m))) continue;  // two corners in one place
      normal *= (glm::dot(normal, middle) < 0.0 ? -1.0 : 1.0) / length;
      sides.push_back({normal, glm::dot(normal, from_m)});
    }
  }

 private:
  static constexpr std::size_t block_size = 16;
  static constexpr double shortest_side_m = 1e-7;

  /// Cones and least distances side by side, in single precision. `cosine` is −10⁹ for all directions.
  struct Cones {
    std::vector<float> x, y, z, cosine, sine, nearest_m;
    void add(const DirectionCone& cone, double nearest);
    template <typename Visit>
    void for_each_met(const DirectionCone& cone, double farthest_m, std::size_t first, std::size_t end,
                      Visit&& visit) const;
  };

  void add(const WorldFacet& facet, FacetId id, double stray_m, std::span<const Vec3> corners_m);
  void make_blocks();
  static double nearest_m(const Vec3& from_m, std::span<const Vec3> corners_m, double plane_distance_m);

  Vec3 from_m_{0.0};
  std::vector<Shade> shades_;
  std::vector<Vec3> corners_m_;
  std::vector<HullSide> sides_;
  std::vector<std::uint32_t> first_side_{0};
  std::vector<DirectionCone> cones_;
  std::vector<double> nearest_m_;
  Cones of_shades_, of_blocks_;
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/visible/shades_bodies.hpp"
#endif
