#pragma once
/// Whether a path over given mirrors and edges of a city is one: required where every condition holds by a margin,
/// possible where rounding or a rule of contact may decide, else impossible.
#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "dcem/core/constants.hpp"
#include "tests/paths/halves/city_triangles.hpp"

namespace dcem::test {

/// A facet that reflects or an edge that diffracts, by its number in the scene.
struct Step {
  bool is_edge = false;
  std::uint32_t number = 0;
  friend auto operator<=>(const Step&, const Step&) = default;
};

enum class Verdict { impossible, possible, required };

struct JudgedPath {
  std::vector<Step> steps;  ///< from the transmitter
  std::vector<Vec3> points_m;
  double length_m = 0.0;
  Verdict verdict = Verdict::required;
  /// For each step the facets that lie on its mirror at its point: one of them may stand for it.
  std::vector<std::vector<std::uint32_t>> overlays;
  std::string doubts;  ///< why it is only possible

  bool is_overlaid() const {
    return std::any_of(overlays.begin(), overlays.end(), [](const auto& facets) { return !facets.empty(); });
  }

  void doubt(const char* why) {
    if (verdict == Verdict::required) verdict = Verdict::possible;
    if (doubts.find(why) == std::string::npos) doubts += std::string(" ") + why;
  }
  bool refuse() {
    verdict = Verdict::impossible;
    return false;
  }
};

/// Required paths keep this far off rims, off the planes of their mirrors and off third facets, metres: as far as
/// welding may have moved a vertex, and 100 times the rounding at grazing.
inline constexpr double required_margin_m = 1e-4;

/// Of a required path no leg is shorter, metres: its direction is known to 1e-6 then.
inline constexpr double required_leg_m = 1e-3;

/// Required paths leave an edge at this angle from its faces at least: 0.1 mm at a metre.
inline constexpr double required_angle_rad = 1e-4;

/// Possible is what fails by less, metres and radians: what two programs may round differently.
inline constexpr double possible_slack = 1e-6;

class CityJudge {
 public:
  explicit CityJudge(const Scene& scene) : scene_(scene), city_(scene), weld_m_(scene.settings().weld_tolerance_m) {
    for (const WorldFacet& facet : scene.facets()) rims_.push_back(rim_of(facet));
  }

  const CityTriangles& city() const { return city_; }

  /// False where the path is impossible. `steps` and `points_m` of the path are given.
  bool judge(const Vec3& from_m, const Vec3& to_m, JudgedPath& path) const {
    std::vector<Vec3> places_m{from_m};
    places_m.insert(places_m.end(), path.points_m.begin(), path.points_m.end());
    places_m.push_back(to_m);
    for (std::size_t index = 0; index < path.steps.size(); ++index) {
      const bool holds =
          path.steps[index].is_edge ? touches_edge(path, places_m, index) : touches_mirror(path, places_m, index);
      if (!holds) return false;
    }
    path.length_m = 0.0;
    for (std::size_t leg = 0; leg + 1 < places_m.size(); ++leg) {
      const double length_m = glm::distance(places_m[leg], places_m[leg + 1]);
      path.length_m += length_m;
      if (length_m < required_leg_m) path.doubt("short");
      const StraightLeg straight{places_m[leg],
                                 places_m[leg + 1],
                                 {leg == 0 ? LegStop{} : stop(path.steps[leg - 1]),
                                  leg == path.steps.size() ? LegStop{} : stop(path.steps[leg])}};
      const LegState state = city_.state(straight);
      if (state == LegState::blocked) return path.refuse();
      if (state == LegState::doubtful) path.doubt("leg");
    }
    path.overlays.resize(path.steps.size());
    for (std::size_t index = 0; index < path.steps.size(); ++index) look_around(path, index);
    return path.verdict != Verdict::impossible;
  }

 private:
  using Segment = std::pair<Vec3, Vec3>;

  const WorldFacet& facet(const Step& step) const { return scene_.facet(FacetId(step.number)); }
  const WorldWedge& wedge(const Step& step) const { return scene_.wedge(WedgeId(step.number)); }
  static double above_m(const Plane& plane, const Vec3& point_m) {
    return glm::dot(plane.normal, point_m - plane.point_m);
  }

  LegStop stop(const Step& step) const {
    if (!step.is_edge) return {{step.number, step.number}};
    return {{wedge(step).facets[0].value, wedge(step).facets[1].value}};
  }

  /// Sides of a facet's triangles that belong to one of them alone.
  std::vector<Segment> rim_of(const WorldFacet& facet) const {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
    for (std::uint32_t index = 0; index < facet.triangle_count; ++index) {
      const auto& corners = scene_.triangles()[facet.first_triangle + index];
      for (std::size_t side = 0; side < 3; ++side) ++sides[std::minmax(corners[side], corners[(side + 1) % 3])];
    }
    std::vector<Segment> rim;
    for (const auto& [side, count] : sides) {
      if (count == 1) rim.emplace_back(scene_.vertices_m()[side.first], scene_.vertices_m()[side.second]);
    }
    return rim;
  }

  /// How far the foot of a point is inside the triangle of a facet that it is furthest in; negative outside of all.
  double inside_m(const WorldFacet& facet, const Vec3& point_m) const {
    double most_m = -std::numeric_limits<double>::infinity();
    for (std::uint32_t index = 0; index < facet.triangle_count; ++index) {
      const auto corners = scene_.corners_m(facet.first_triangle + index);
      const double turn =
          glm::dot(facet.plane.normal, glm::cross(corners[1] - corners[0], corners[2] - corners[0])) < 0.0 ? -1.0 : 1.0;
      double least_m = std::numeric_limits<double>::infinity();
      for (std::size_t side = 0; side < 3; ++side) {
        const Vec3 inwards = turn * glm::cross(facet.plane.normal, corners[(side + 1) % 3] - corners[side]);
        least_m = std::min(least_m, glm::dot(inwards, point_m - corners[side]) / glm::length(inwards));
      }
      most_m = std::max(most_m, least_m);
    }
    return most_m;
  }

  double from_rim_m(const Step& step, const Vec3& point_m) const {
    double nearest_m = std::numeric_limits<double>::infinity();
    const Plane& plane = facet(step).plane;
    const auto foot = [&](const Vec3& place_m) { return place_m - above_m(plane, place_m) * plane.normal; };
    for (const Segment& side : rims_[step.number]) {
      nearest_m = std::min(nearest_m, distance_between_m(foot(point_m), foot(side.first), foot(side.second)));
    }
    return nearest_m;
  }

  bool touches_mirror(JudgedPath& path, const std::vector<Vec3>& places_m, std::size_t index) const {
    const Step& step = path.steps[index];
    const Plane& plane = facet(step).plane;
    const Vec3& here_m = places_m[index + 1];
    const double before_m = above_m(plane, places_m[index]), after_m = above_m(plane, places_m[index + 2]);
    const double nearer_m = std::min(std::abs(before_m), std::abs(after_m));
    if (before_m * after_m < 0.0 && nearer_m > possible_slack) return path.refuse();
    if (nearer_m < required_margin_m) path.doubt("plane");
    const double way_m = glm::distance(places_m[index], here_m) + glm::distance(here_m, places_m[index + 2]);
    const double off_m = 1e-9 * way_m / (std::abs(before_m) + std::abs(after_m));  // a nanometre, at that angle
    if (inside_m(facet(step), here_m) < -possible_slack - off_m) return path.refuse();
    if (from_rim_m(step, here_m) < required_margin_m + off_m) path.doubt("rim");
    if (index > 0) fits_neighbour(path, path.steps[index - 1], plane, places_m[index]);
    if (index + 1 < path.steps.size()) fits_neighbour(path, path.steps[index + 1], plane, places_m[index + 2]);
    return path.verdict != Verdict::impossible;
  }

  /// No mirror whose plane holds the edge goes next to it (weld tolerance and the edge's dirt); mirrors a hair apart
  /// are left to the rules of contact.
  void fits_neighbour(JudgedPath& path, const Step& next, const Plane& plane, const Vec3& there_m) const {
    if (!next.is_edge) {
      const bool along = std::abs(glm::dot(plane.normal, facet(next).plane.normal)) > 0.99;
      if (along && std::abs(above_m(plane, there_m)) < 2.0 * weld_m_) path.doubt("along");
      return;
    }
    const Wedge& edge = wedge(next).edge;
    const double off_m = std::max(std::abs(above_m(plane, edge.start_m)), std::abs(above_m(plane, edge.end_m)));
    const double limit_m = weld_m_ + edge.stray_m;
    if (off_m < limit_m - 1e-9) path.refuse();
    if (off_m < limit_m + required_margin_m) path.doubt("holds");
  }

  bool touches_edge(JudgedPath& path, const std::vector<Vec3>& places_m, std::size_t index) const {
    const Wedge& edge = wedge(path.steps[index]).edge;
    const Vec3& here_m = places_m[index + 1];
    const Vec3 along = glm::normalize(edge.end_m - edge.start_m);
    const double place_m = glm::dot(here_m - edge.start_m, along);
    const double from_end_m = std::min(place_m, glm::distance(edge.start_m, edge.end_m) - place_m);
    if (from_end_m < -possible_slack) return path.refuse();
    if (from_end_m < required_margin_m) path.doubt("end");
    for (const Vec3& neighbour_m : {places_m[index], places_m[index + 2]}) {
      const double to_tangent_m = glm::dot(neighbour_m - here_m, edge.tangent);
      const double to_normal_m = glm::dot(neighbour_m - here_m, edge.normal);
      double azimuth = std::atan2(to_normal_m, to_tangent_m);
      if (azimuth < -possible_slack) azimuth += 2.0 * pi;
      const double from_face = std::min(azimuth, edge.exterior_angle_rad - azimuth);
      if (from_face < -possible_slack) return path.refuse();
      const double across_m = std::hypot(to_tangent_m, to_normal_m);
      if (from_face < required_angle_rad || across_m * from_face < required_margin_m) path.doubt("face");
    }
    return true;
  }

  /// Facets around the point of a step: on an edge a third one ends diffraction, on a mirror one may stand for it.
  void look_around(JudgedPath& path, std::size_t index) const {
    const Step& step = path.steps[index];
    const LegStop own = stop(step);
    const double dirt_m = step.is_edge ? wedge(step).edge.stray_m : 0.0;
    const Vec3& here_m = path.points_m[index];
    city_.any_beside(here_m, here_m, [&](const FlatTriangle& triangle) {
      if (triangle.facet == own.facets[0] || triangle.facet == own.facets[1]) return false;
      const double apart_m = triangle.distance_m(here_m) - weld_m_ - dirt_m;
      if (step.is_edge) {
        if (apart_m < -possible_slack) path.refuse();
        if (apart_m < required_margin_m) path.doubt("third");
      } else if (apart_m < required_margin_m) {
        const Vec3& normal = scene_.facet(FacetId(triangle.facet)).plane.normal;
        const bool lies_on = std::abs(glm::dot(normal, facet(step).plane.normal)) > 0.999;
        if (lies_on) path.overlays[index].push_back(triangle.facet);
      }
      return false;
    });
  }

  const Scene& scene_;
  CityTriangles city_;
  double weld_m_;
  std::vector<std::vector<Segment>> rims_;
};

}  // namespace dcem::test
