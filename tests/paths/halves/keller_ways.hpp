#pragma once
/// Ways over an edge along Keller's cone, and what they meet: every triangle is asked, in double precision.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "dcem/geometry/triangle.hpp"
#include "dcem/paths/halves/edge_looker.hpp"
#include "dcem/paths/query/leg_filter.hpp"
#include "tests/paths/small_scenes.hpp"

namespace dcem::test {

/// A way from an end that leaves an edge at a place along it. Lengths along it count across the edge.
struct KellerWay {
  double place_m = 0.0, azimuth_rad = 0.0;
  Ray<double> ray;
};

/// An edge, and an end by where it is beside it.
class KellerEnd {
 public:
  KellerEnd(const Wedge& edge, double place_m, double distance_m, double azimuth_rad)
      : edge_(edge),
        position_m_(edge.start_m + place_m * edge_direction(edge) + distance_m * across(azimuth_rad)),
        place_m_(glm::dot(position_m_ - edge.start_m, edge_direction(edge))),
        distance_m_(glm::distance(position_m_, edge.start_m + place_m_ * edge_direction(edge))) {}

  const Vec3& position_m() const { return position_m_; }

  KellerWay way(double place_m, double azimuth_rad) const {
    const Vec3 along = edge_direction(edge_) * ((place_m - place_m_) / distance_m_);
    return {place_m, azimuth_rad, {edge_.start_m + place_m * edge_direction(edge_), across(azimuth_rad) + along}};
  }

  /// The way that leads to a point.
  KellerWay way_to(const Vec3& point_m) const {
    const Vec3 away_m = point_m - edge_.start_m;
    const double x = glm::dot(away_m, edge_.tangent), y = glm::dot(away_m, edge_.normal);
    const double z = glm::dot(away_m, edge_direction(edge_)), distance_m = std::hypot(x, y);
    const double azimuth = std::atan2(y, x);
    return way(z + (place_m_ - z) * (distance_m / (distance_m + distance_m_)),
               azimuth < 0 ? azimuth + 2 * pi : azimuth);
  }

 private:
  Vec3 across(double azimuth_rad) const {
    return std::cos(azimuth_rad) * edge_.tangent + std::sin(azimuth_rad) * edge_.normal;
  }

  Wedge edge_;
  Vec3 position_m_;
  double place_m_, distance_m_;
};

/// What ways over one edge of a scene meet, as legs have it.
class KellerJudge {
 public:
  /// `stops_at_sheets`: no path crosses one.
  KellerJudge(const Scene& scene, WedgeId edge, bool stops_at_sheets)
      : scene_(scene), wedge_(scene.wedge(edge)), stops_at_sheets_(stops_at_sheets) {
    for (std::uint32_t facet = 0; facet < scene.facets().size(); ++facet) {
      holds_.push_back(holds_edge(scene.facet(FacetId(facet)).plane, wedge_.edge, weld_m()) ? 1 : 0);
    }
  }

  /// The facets that a way may reflect on.
  const std::vector<FacetId>& lit_by(const KellerWay& way) {
    find_hits(way);
    lit_.clear();
    for (const Hit& hit : hits_) {
      if (is_known(hit.facet) || !may_reflect(hit.facet)) continue;
      const std::optional<double> along = mirror_at(hit.facet, way);
      if (along && is_clear(way, *along) && is_reached(hit.facet, *along, way)) lit_.push_back(hit.facet);
    }
    return lit_;
  }

  /// Whether a third facet is at the point from which a way leaves: nothing diffracts there.
  bool is_touched(const KellerWay& way) const {
    for (std::uint32_t triangle = 0; triangle < scene_.triangles().size(); ++triangle) {
      const bool is_own = is_of_wedge(scene_.facet_of_triangle(triangle));
      const double tolerance_m = weld_m() + wedge_.edge.stray_m;
      if (!is_own && distance_to_triangle_m(scene_.corners_m(triangle), way.ray.origin) <= tolerance_m) return true;
    }
    return false;
  }

 private:
  struct Hit {
    double along;
    FacetId facet;
  };

  double weld_m() const { return scene_.settings().weld_tolerance_m; }
  bool is_of_wedge(FacetId id) const { return wedge_.facets[0] == id || wedge_.facets[1] == id; }
  bool is_known(FacetId id) const { return std::ranges::find(lit_, id) != lit_.end(); }
  bool may_reflect(FacetId id) const { return scene_.facet(id).present && !is_of_wedge(id) && holds_[id.value] == 0; }

  void find_hits(const KellerWay& way) {
    hits_.clear();
    const WatertightRay ray(way.ray);
    for (std::uint32_t triangle = 0; triangle < scene_.triangles().size(); ++triangle) {
      const std::optional<double> along = ray.intersect(scene_.corners_m(triangle));
      if (along && *along > 0.0) hits_.push_back({*along, scene_.facet_of_triangle(triangle)});
    }
  }

  /// Where a mirror's plane is met, if that is over the mirror.
  std::optional<double> mirror_at(FacetId id, const KellerWay& way) const {
    const WorldFacet& facet = scene_.facet(id);
    const double slope = glm::dot(facet.plane.normal, way.ray.direction);
    if (slope == 0.0) return std::nullopt;
    const double along = -signed_distance_m(facet.plane, way.ray.origin) / slope;
    const Vec3 point_m = way.ray.at(along);
    for (std::uint32_t at = 0; at < facet.triangle_count; ++at) {
      const TriangleCorners corners_m = scene_.corners_m(facet.first_triangle + at);
      if (contact(corners_m, facet.plane.normal, point_m, in_plane_guard_m).covered_rad == 2.0 * pi) return along;
    }
    return std::nullopt;
  }

  /// Off the edge by a centimetre, and off its faces.
  bool is_clear(const KellerWay& way, double along) const {
    const double off_faces = std::min(way.azimuth_rad, wedge_.edge.exterior_angle_rad - way.azimuth_rad);
    return along > 0.01 && along * off_faces > in_plane_guard_m;
  }

  /// What a leg ignores, at the edge and at the mirror, does not stop it.
  bool is_reached(FacetId mirror, double to, const KellerWay& way) const {
    return std::ranges::none_of(hits_, [&](const Hit& hit) {
      const WorldFacet& facet = scene_.facet(hit.facet);
      if (hit.along >= to || hit.facet == mirror || is_of_wedge(hit.facet)) return false;
      if (facet.transmits && !stops_at_sheets_) return false;
      const Vec3 point_m = way.ray.at(hit.along);
      const auto is_along = [&](FacetId id) { return lies_along(scene_, facet, scene_.facet(id).plane, point_m); };
      return !is_along(mirror) && !is_along(wedge_.facets[0]) && !is_along(wedge_.facets[1]);
    });
  }

  const Scene& scene_;
  const WorldWedge& wedge_;
  bool stops_at_sheets_;
  std::vector<char> holds_;
  std::vector<Hit> hits_;
  std::vector<FacetId> lit_;
};

}  // namespace dcem::test
