#pragma once
/// Parts of a city, and ends of links in places where a search by views and cones might lose something: next to walls
/// and edges, in their planes and on their lines.
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "dcem/core/random.hpp"
#include "dcem/geometry/plane.hpp"
#include "dcem/geometry/triangle_mesh.hpp"
#include "dcem/scene/scene.hpp"
#include "tests/paths/halves/city_links.hpp"
#include "tests/paths/halves/city_triangles.hpp"

namespace dcem::test {

/// The triangles of which a part may be within `reach_m` of a place, in x and in y.
inline TriangleMesh part_of(const TriangleMesh& mesh, const Vec3& place_m, double reach_m) {
  TriangleMesh part = mesh;
  std::erase_if(part.triangles, [&](const TriangleMesh::Triangle& triangle) {
    Vec3 low_m = mesh.vertices_m[triangle.vertices[0]], high_m = low_m;
    for (const std::uint32_t vertex : triangle.vertices) {
      low_m = glm::min(low_m, mesh.vertices_m[vertex]);
      high_m = glm::max(high_m, mesh.vertices_m[vertex]);
    }
    return low_m.x > place_m.x + reach_m || high_m.x < place_m.x - reach_m || low_m.y > place_m.y + reach_m ||
           high_m.y < place_m.y - reach_m;
  });
  return part;
}

class CityCorners {
 public:
  CityCorners(const Scene& scene, const CityTriangles& city, const Vec3& centre_m, double reach_m, std::uint64_t seed)
      : scene_(scene), city_(city), centre_m_(centre_m), reach_m_(reach_m), random_(seed) {}

  /// Two places that see each other, or one time in twenty do not: between others there is little to lose.
  CityLink link() {
    while (true) {
      const CityLink link{place_m(), place_m()};
      if (below(20) == 0 || city_.state({link.from_m, link.to_m}) == LegState::clear) return link;
    }
  }

 private:
  static constexpr double clear_m = 3e-4;

  /// At most 60 m high, under the open sky three times out of four, and off everything by more than the weld
  /// tolerance: what a device is mounted on it does not see.
  Vec3 place_m() {
    while (true) {
      const Vec3 candidate_m = candidate();
      if (candidate_m.z < clear_m || candidate_m.z > 60.0 || std::abs(candidate_m.x - centre_m_.x) > 0.6 * reach_m_ ||
          std::abs(candidate_m.y - centre_m_.y) > 0.6 * reach_m_ || touches(candidate_m)) {
        continue;
      }
      const bool indoors = below(4) == 0;
      const StraightLeg up{candidate_m, candidate_m + Vec3(0, 0, 200)};
      if (indoors || city_.state(up) == LegState::clear) return candidate_m;
    }
  }

  double between(double low, double high) { return low + (high - low) * random_.uniform(); }
  /// Each power of ten as often as the others.
  double of_any_size(double low, double high) { return low * std::exp(random_.uniform() * std::log(high / low)); }
  std::size_t below(std::size_t count) { return static_cast<std::size_t>(random_.next() % count); }

  Vec3 candidate() {
    switch (below(5)) {
      case 0:
        return beside_triangle();
      case 1:
        return beside_edge();
      case 2:
        return in_plane_of_facet();
      case 3:
        return on_line_of_edge();
      default:
        break;
    }
    const double x_m = between(-0.6, 0.6) * reach_m_, y_m = between(-0.6, 0.6) * reach_m_;
    return {centre_m_.x + x_m, centre_m_.y + y_m, of_any_size(0.01, 40.0)};
  }

  Vec3 beside_triangle() {
    const FlatTriangle& triangle = city_.triangles()[below(city_.triangles().size())];
    const double along = random_.uniform(), across = (1.0 - along) * random_.uniform();
    const double off_m = (below(2) == 0 ? -1.0 : 1.0) * of_any_size(clear_m, 0.5);
    return triangle.corners_m[0] + along * (triangle.corners_m[1] - triangle.corners_m[0]) +
           across * (triangle.corners_m[2] - triangle.corners_m[0]) + off_m * triangle.normal;
  }

  Vec3 beside_edge() {
    const Wedge& edge = any_edge();
    const double turn_rad = between(0.0, edge.exterior_angle_rad), along = random_.uniform();
    return edge.start_m + along * (edge.end_m - edge.start_m) +
           of_any_size(1e-3, 0.3) * (std::cos(turn_rad) * edge.tangent + std::sin(turn_rad) * edge.normal);
  }

  Vec3 in_plane_of_facet() {
    const Plane& plane = scene_.facets()[below(scene_.facets().size())].plane;
    const PlaneBasis basis = plane_basis(plane.normal);
    const double right_m = between(-30.0, 30.0), up_m = between(-30.0, 30.0);
    const double off_m = below(2) == 0 ? 0.0 : of_any_size(1e-6, 1e-2);
    return plane.point_m + right_m * basis.u + up_m * basis.v + off_m * plane.normal;
  }

  Vec3 on_line_of_edge() {
    const Wedge& edge = any_edge();
    const double along_m = between(-20.0, 20.0);
    return edge.start_m + along_m * glm::normalize(edge.end_m - edge.start_m) + of_any_size(1e-5, 1e-2) * edge.normal;
  }

  const Wedge& any_edge() { return scene_.wedges()[below(scene_.wedges().size())].edge; }

  bool touches(const Vec3& place_m) const {
    return std::any_of(city_.triangles().begin(), city_.triangles().end(),
                       [&](const FlatTriangle& triangle) { return triangle.distance_m(place_m) < clear_m; });
  }

  const Scene& scene_;
  const CityTriangles& city_;
  Vec3 centre_m_;
  double reach_m_;
  RandomStream random_;
};

}  // namespace dcem::test
