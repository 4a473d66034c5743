#pragma once
/// Every path of at most two interactions in a city, one edge at most, by loops over all facets, all edges and all
/// pairs of them. Nothing is left out but what plain arithmetic refuses, pair by pair.
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "dcem/core/constants.hpp"
#include "tests/paths/halves/city_judge.hpp"

namespace dcem::test {

class CityOracle {
 public:
  explicit CityOracle(const Scene& scene) : scene_(scene), judge_(scene) {
    for (const WorldFacet& facet : scene.facets()) mirrors_.push_back(mirror_of(facet));
    for (std::uint32_t number = 0; number < scene.wedges().size(); ++number) {
      const Wedge& edge = scene.wedges()[number].edge;
      const bool free = edge.facets[1] == no_facet;
      if (!free && edge.exterior_angle_rad >= 190.0 / 180.0 * pi) edges_.push_back(edge_of(edge, number));
    }
  }

  const CityTriangles& city() const { return judge_.city(); }
  std::size_t mirror_count() const { return mirrors_.size(); }
  std::size_t edge_count() const { return edges_.size(); }

  /// All that are possible or required, from a transmitter to a receiver.
  std::vector<JudgedPath> paths(const Vec3& from_m, const Vec3& to_m) const {
    Search search{*this, from_m, to_m, {}};
    search.add({}, {});
    search.single_mirrors();
    search.single_edges();
    search.two_mirrors();
    search.mirror_then_edge(false);
    std::swap(search.from_m, search.to_m);
    search.mirror_then_edge(true);
    return std::move(search.found);
  }

 private:
  struct Mirror {
    Vec3 normal, centre_m;
    double offset_m = 0.0, reach_squared = 0.0;  ///< of a ball that holds all corners, and a centimetre more

    double above_m(const Vec3& point_m) const { return glm::dot(normal, point_m) - offset_m; }
    Vec3 image_m(const Vec3& point_m) const { return point_m - 2.0 * above_m(point_m) * normal; }
    bool may_hold(const Vec3& point_m) const {
      const Vec3 away_m = point_m - centre_m;
      return glm::dot(away_m, away_m) <= reach_squared;
    }
  };

  /// An edge and the outward normals of its two faces: outside is what is above either.
  struct Edge {
    Vec3 start_m, along, middle_m;
    std::array<Vec3, 2> outwards;
    double length_m = 0.0;
    std::uint32_t number = 0;

    bool may_be_outside(const Vec3& from_start_m) const {
      constexpr double slack_m = 1e-3;  // more than `possible_slack` at a kilometre
      return glm::dot(from_start_m, outwards[0]) > -slack_m || glm::dot(from_start_m, outwards[1]) > -slack_m;
    }
  };

  /// An edge as an end sees it: where along it and how far across.
  struct SeenEdge {
    Edge edge;
    double along_m, across_m;
  };

  /// The image of an end in a mirror, and the cone from there around the mirror's ball: paths are inside it.
  struct Image {
    Vec3 point_m, axis{0.0};
    double end_above_m = 0.0;  ///< of the end itself, over the mirror
    double sine = 0.0, cosine = 0.0;

    Image(const Mirror& mirror, const Vec3& end_m)
        : point_m(mirror.image_m(end_m)), end_above_m(mirror.above_m(end_m)) {
      const double away_m = glm::distance(mirror.centre_m, point_m);
      if (away_m * away_m <= mirror.reach_squared) return;  // inside the ball: nothing is outside the cone
      axis = (mirror.centre_m - point_m) / away_m;
      sine = std::sqrt(mirror.reach_squared) / away_m;
      cosine = std::sqrt(1.0 - sine * sine);
    }

    /// Whether a ball may be in the cone; a millimetre is more than the rounding of the squares.
    bool may_reach(const Vec3& centre_m, double radius_m) const {
      const Vec3 away_m = centre_m - point_m;
      const double ahead_m = glm::dot(away_m, axis);
      const double room_m = ahead_m * sine + radius_m + 1e-3;
      return room_m >= 0.0 && (glm::dot(away_m, away_m) - ahead_m * ahead_m) * cosine * cosine <= room_m * room_m;
    }
  };

  struct Search {
    const CityOracle& oracle;
    Vec3 from_m, to_m;
    std::vector<JudgedPath> found;

    void add(std::vector<Step> steps, std::vector<Vec3> points_m) {
      judge(std::move(steps), std::move(points_m), false);
    }

    void judge(std::vector<Step> steps, std::vector<Vec3> points_m, bool turned) {
      JudgedPath path;
      path.steps = std::move(steps);
      path.points_m = std::move(points_m);
      if (!oracle.judge_.judge(from_m, to_m, path)) return;
      if (turned) {
        std::reverse(path.steps.begin(), path.steps.end());
        std::reverse(path.points_m.begin(), path.points_m.end());
        std::reverse(path.overlays.begin(), path.overlays.end());
      }
      found.push_back(std::move(path));
    }

    std::vector<Image> images_of(const Vec3& end_m) const {
      std::vector<Image> images;
      for (const Mirror& mirror : oracle.mirrors_) images.emplace_back(mirror, end_m);
      return images;
    }

    std::vector<SeenEdge> edges_seen_from(const Vec3& end_m) const {
      std::vector<SeenEdge> seen;
      for (const Edge& edge : oracle.edges_) {
        const Vec3 away_m = end_m - edge.start_m;
        if (!edge.may_be_outside(away_m)) continue;
        seen.push_back({edge, glm::dot(away_m, edge.along), glm::length(glm::cross(away_m, edge.along))});
      }
      return seen;
    }

    void single_mirrors() {
      for (std::uint32_t number = 0; number < oracle.mirrors_.size(); ++number) {
        const Mirror& mirror = oracle.mirrors_[number];
        const double from = mirror.above_m(from_m), to = mirror.above_m(to_m);
        if (from * to <= 0.0) continue;
        const Vec3 point_m = mirror.image_m(from_m) + from / (from + to) * (to_m - mirror.image_m(from_m));
        if (mirror.may_hold(point_m)) add({{false, number}}, {point_m});
      }
    }

    /// The law of diffraction: unfolded around the edge the path is straight.
    static double place_m(const SeenEdge& one, double along_m, double across_m) {
      return along_m + (one.along_m - along_m) * across_m / (across_m + one.across_m);
    }

    void single_edges() {
      for (const SeenEdge& seen : edges_seen_from(to_m)) {
        const Edge& edge = seen.edge;
        const Vec3 away_m = from_m - edge.start_m;
        if (!edge.may_be_outside(away_m)) continue;
        const double along_m = place_m(seen, glm::dot(away_m, edge.along), glm::length(glm::cross(away_m, edge.along)));
        if (along_m < -possible_slack || along_m > edge.length_m + possible_slack) continue;
        add({{true, edge.number}}, {edge.start_m + along_m * edge.along});
      }
    }

    /// The image of the transmitter in the first mirror, both points and that of the receiver in the second are on one
    /// line, in this order.
    void two_mirrors() {
      const std::vector<Image> from_images = images_of(from_m), to_images = images_of(to_m);
      for (std::uint32_t first = 0; first < from_images.size(); ++first) {
        const Mirror& mirror = oracle.mirrors_[first];
        const Image& from = from_images[first];
        for (std::uint32_t second = 0; second < to_images.size(); ++second) {
          const Image& to = to_images[second];
          const double over_first = mirror.above_m(to.point_m);
          if (over_first * from.end_above_m <= 0.0) continue;
          const Mirror& other = oracle.mirrors_[second];
          const double over_second = other.above_m(from.point_m);
          if (over_second * to.end_above_m <= 0.0) continue;
          // The first point does not lie behind the second one.
          if (std::abs(from.end_above_m * to.end_above_m) > (1.0 + possible_slack) * std::abs(over_first * over_second))
            continue;
          const Vec3 line_m = to.point_m - from.point_m;
          const Vec3 one_m = from.point_m + from.end_above_m / (from.end_above_m + over_first) * line_m;
          if (!mirror.may_hold(one_m)) continue;
          const Vec3 two_m = from.point_m + over_second / (over_second + to.end_above_m) * line_m;
          if (!other.may_hold(two_m) || first == second) continue;
          add({{false, first}, {false, second}}, {one_m, two_m});
        }
      }
    }

    /// From `from_m` over a mirror and then an edge to `to_m`.
    void mirror_then_edge(bool turned) {
      const std::vector<Image> images = images_of(from_m);
      const std::vector<SeenEdge> edges = edges_seen_from(to_m);
      for (std::uint32_t number = 0; number < images.size(); ++number) {
        const Mirror& mirror = oracle.mirrors_[number];
        const Image& image = images[number];
        for (const SeenEdge& seen : edges) {
          const Edge& edge = seen.edge;
          if (!image.may_reach(edge.middle_m, 0.5 * edge.length_m)) continue;
          const Vec3 away_m = image.point_m - edge.start_m;
          const double image_along_m = glm::dot(away_m, edge.along);
          if (std::max(image_along_m, seen.along_m) < -possible_slack ||
              std::min(image_along_m, seen.along_m) > edge.length_m + possible_slack || !edge.may_be_outside(away_m)) {
            continue;
          }
          const double along_m = place_m(seen, image_along_m, glm::length(glm::cross(away_m, edge.along)));
          if (along_m < -possible_slack || along_m > edge.length_m + possible_slack) continue;
          const Vec3 edge_point_m = edge.start_m + along_m * edge.along;
          const double edge_above_m = mirror.above_m(edge_point_m);
          if (edge_above_m * image.end_above_m <= 0.0) continue;
          const Vec3 point_m =
              image.point_m + image.end_above_m / (image.end_above_m + edge_above_m) * (edge_point_m - image.point_m);
          if (mirror.may_hold(point_m)) judge({{false, number}, {true, edge.number}}, {point_m, edge_point_m}, turned);
        }
      }
    }
  };

  Mirror mirror_of(const WorldFacet& facet) const {
    Vec3 low_m(std::numeric_limits<double>::infinity()), high_m(-low_m);
    for (std::uint32_t index = 0; index < facet.triangle_count; ++index) {
      for (const Vec3& corner_m : scene_.corners_m(facet.first_triangle + index)) {
        low_m = glm::min(low_m, corner_m);
        high_m = glm::max(high_m, corner_m);
      }
    }
    const double reach_m = 0.5 * glm::distance(low_m, high_m) + 0.01;
    return {facet.plane.normal, 0.5 * (low_m + high_m), glm::dot(facet.plane.normal, facet.plane.point_m),
            reach_m * reach_m};
  }

  static Edge edge_of(const Wedge& edge, std::uint32_t number) {
    const double last = edge.exterior_angle_rad - 0.5 * pi;  // where the outward normal of face n looks
    return {edge.start_m,
            glm::normalize(edge.end_m - edge.start_m),
            0.5 * (edge.start_m + edge.end_m),
            {edge.normal, std::cos(last) * edge.tangent + std::sin(last) * edge.normal},
            glm::distance(edge.start_m, edge.end_m),
            number};
  }

  const Scene& scene_;
  CityJudge judge_;
  std::vector<Mirror> mirrors_;
  std::vector<Edge> edges_;
};

}  // namespace dcem::test
