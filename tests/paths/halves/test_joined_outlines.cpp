/// Nothing that one of several points sees is called hidden where façades meet along vertical lines.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "dcem/geometry/triangle.hpp"
#include "dcem/paths/halves/sight.hpp"
#include "tests/paths/halves/point_groups.hpp"
#include "tests/paths/small_scenes.hpp"

namespace test_joined_outlines {

using namespace dcem;
using namespace dcem::test;

namespace {

// Towns ---------------------------------------------------------------------------------------------------------------

/// Where façades meet, seen from above, and from where to where something stands there.
struct Line {
  double x_m, y_m, low_m, high_m;

  Vec3 at(double z_m) const { return {x_m, y_m, z_m}; }
};

/// Where a façade stands at one of its ends.
struct Post {
  double x_m, y_m, low_m, high_m;
};

/// Rows of façades that have nothing in common but the x and y of their ends, and things to be seen behind them.
class Town {
 public:
  Town(Draw& draw, const Vec3& origin_m) : draw_(draw), origin_m_(origin_m) {}

  TriangleMesh mesh;
  std::vector<Line> lines;

  /// A façade between two vertical lines. Three in four are rectangles cut along a diagonal; others bend a little at
  /// further columns, or have corners in the middle of a side, and no two triangles in one plane.
  void add_facade(const Post& from, const Post& to) {
    note(from);
    note(to);
    const std::string material = draw_.below(12) == 0 ? "glass" : draw_.below(2) == 0 ? "metal" : "opaque";
    const Vec3 a(from.x_m, from.y_m, from.low_m), b(to.x_m, to.y_m, to.low_m), c(to.x_m, to.y_m, to.high_m),
        d(from.x_m, from.y_m, from.high_m);
    const std::size_t kind = draw_.below(8);
    if (kind == 0) {
      const Vec3 middle_m = 0.25 * (a + b + c + d) + bent(a, b);
      for (const auto& [one, other] : std::array<std::pair<Vec3, Vec3>, 4>{{{a, b}, {b, c}, {c, d}, {d, a}}}) {
        add_triangle({one, other, middle_m}, material);
      }
    } else if (kind == 1) {  // a corner in the middle of a side that stands on a line
      Vec3 e(from.x_m, from.y_m, from.low_m + draw_.between(0.2, 0.8) * (from.high_m - from.low_m));
      if (draw_.below(2) == 0) e += bent(a, b);  // … or a bit beside it
      add_triangle({a, b, e}, material);
      add_triangle({e, b, c}, material);
      add_triangle({e, c, d}, material);
    } else if (kind < 5) {
      add_columns({a, b, c, d}, 1 + draw_.below(4), material);
    } else if (kind < 7) {
      add_quad(mesh, {a, b, c, d}, material);
    } else {
      add_quad(mesh, {b, c, d, a}, material);
    }
  }

  /// A row of houses from a place on; seen from above each façade turns by something from the last one.
  void add_row(const Vec3& start_m, double azimuth_rad, std::size_t houses) {
    Post last = post_at(start_m);
    for (std::size_t house = 0; house < houses; ++house) {
      azimuth_rad += some_turn_rad();
      const double long_m = draw_.below(4) == 0 ? draw_.magnitude(0.02, 0.5) : draw_.between(2.0, 12.0);
      const Vec3 end_m = Vec3(last.x_m, last.y_m, 0.0) + long_m * level(azimuth_rad);
      const Post next = post_at(end_m);
      Post first = beside(last);
      if (draw_.below(4) == 0) first.x_m += draw_.magnitude(1e-6, 2e-3) * std::copysign(1.0, next.x_m - last.x_m);
      add_facade(first, next);
      for (std::size_t spur = draw_.below(3); house > 0 && spur > 1; --spur) {
        add_facade(beside(last), post_at(Vec3(last.x_m, last.y_m, 0.0) + draw_.between(0.3, 8.0) * some_level()));
      }
      last = next;
    }
  }

  /// Houses all around a place.
  void add_courtyard(const Vec3& middle_m, double radius_m) {
    const std::size_t houses = 3 + draw_.below(7);
    std::vector<Post> posts;
    for (std::size_t house = 0; house < houses; ++house) {
      const double azimuth_rad =
          2.0 * pi * (static_cast<double>(house) + draw_.between(0.0, 0.9)) / static_cast<double>(houses);
      posts.push_back(post_at(middle_m + draw_.between(0.5, 1.0) * radius_m * level(azimuth_rad)));
    }
    for (std::size_t house = 0; house < houses; ++house) add_facade(beside(posts[house]), posts[(house + 1) % houses]);
  }

  /// What stands there to be seen, or not: small sheets and boxes, and walls all around, which meet, too.
  void add_things(std::size_t count, double far_m) {
    for (std::size_t thing = 0; thing < count; ++thing) {
      const Vec3 middle_m = origin_m_ + draw_.inside(Vec3(-60, -60, 0.2), Vec3(60, 60, 18));
      if (thing % 4 == 0) {
        add_box_faces(mesh, middle_m, middle_m + draw_.inside(Vec3(0.5), Vec3(6.0)), "metal");
      } else {
        const Vec3 u = some_level();
        add_sheet(mesh, middle_m, draw_.magnitude(0.05, 2.0) * u, draw_.magnitude(0.1, 2.0) * Vec3(0, 0, 1), "metal");
      }
    }
    for (int side = 0; side < 8; ++side) {
      const Vec3 from_m = origin_m_ + far_m * level(0.25 * pi * side + 0.1);
      const Vec3 to_m = origin_m_ + far_m * level(0.25 * pi * (side + 1) + 0.1);
      add_quad(mesh,
               {Vec3(from_m.x, from_m.y, -50), Vec3(to_m.x, to_m.y, -50), Vec3(to_m.x, to_m.y, 200),
                Vec3(from_m.x, from_m.y, 200)},
               "opaque");
    }
  }

  static Vec3 level(double azimuth_rad) { return {std::cos(azimuth_rad), std::sin(azimuth_rad), 0.0}; }

 private:
  Vec3 some_level() { return level(draw_.between(-pi, pi)); }
  void note(const Post& post) { lines.push_back({post.x_m, post.y_m, post.low_m, post.high_m}); }
  void add_triangle(const std::array<Vec3, 3>& corners_m, const std::string& material) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices_m.size());
    mesh.vertices_m.insert(mesh.vertices_m.end(), corners_m.begin(), corners_m.end());
    mesh.triangles.push_back({{first, first + 1, first + 2}, material_index(mesh, material)});
  }
  /// From nothing over micrometres up to about what facets may stray, across a wall.
  Vec3 bent(const Vec3& from_m, const Vec3& to_m) {
    if (draw_.below(3) == 0) return Vec3(0.0);
    const Vec3 along = glm::normalize(to_m - from_m);
    return draw_.magnitude(1e-6, 1e-3) * (draw_.below(2) == 0 ? 1.0 : -1.0) * Vec3(-along.y, along.x, 0.0);
  }
  /// A façade in columns, the places of which are rounded or off by a bit; lines between them need not be upright.
  void add_columns(const std::array<Vec3, 4>& corners_m, std::size_t inner, const std::string& material) {
    const auto& [a, b, c, d] = corners_m;
    const double grid_m = std::array<double, 3>{0.0, 1e-4, 1e-3}[draw_.below(3)];
    const bool are_upright = draw_.below(2) == 0;
    std::vector<std::array<Vec3, 2>> columns{{a, d}};
    for (std::size_t column = 1; column <= inner; ++column) {
      const double share = (static_cast<double>(column) + draw_.between(-0.3, 0.3)) / static_cast<double>(inner + 1);
      Vec3 low_m = a + share * (b - a), high_m = d + share * (c - d);
      const Vec3 off_m = bent(a, b);
      low_m += off_m;
      high_m += are_upright ? off_m : bent(a, b);
      for (Vec3* const corner_m : {&low_m, &high_m}) {
        if (grid_m == 0.0) continue;
        corner_m->x = grid_m * std::round(corner_m->x / grid_m);
        corner_m->y = grid_m * std::round(corner_m->y / grid_m);
      }
      columns.push_back({low_m, high_m});
    }
    columns.push_back({b, c});
    for (std::size_t column = 1; column < columns.size(); ++column) {
      const auto& [low_m, high_m] = columns[column - 1];
      const auto& [next_low_m, next_high_m] = columns[column];
      if (draw_.below(2) == 0) {
        add_quad(mesh, {low_m, next_low_m, next_high_m, high_m}, material);
      } else {
        add_quad(mesh, {high_m, low_m, next_low_m, next_high_m}, material);
      }
    }
  }
  Post post_at(const Vec3& foot_m) {
    const double grid_m = std::array<double, 3>{0.0, 1e-4, 1e-3}[draw_.below(3)];
    const auto rounded = [&](double value_m) {
      return grid_m == 0.0 ? value_m : grid_m * std::round(value_m / grid_m);
    };
    const double low_m = draw_.below(3) == 0 ? draw_.between(0.0, 3.0) : 0.0;
    return {rounded(foot_m.x), rounded(foot_m.y), low_m, low_m + draw_.between(0.5, 14.0)};
  }
  /// The same line for the next façade, higher or lower: sometimes they have little of it in common.
  Post beside(const Post& post) {
    Post result = post;
    switch (draw_.below(5)) {
      case 0:
        result.low_m = post.high_m - draw_.between(0.1, 0.3);
        break;
      case 1:
        result.high_m = post.low_m + draw_.between(0.1, 0.3);
        break;
      case 2:
        result.low_m = post.low_m;
        return result;
      default:
        result.low_m = post.low_m + draw_.between(-1.0, 0.3);
        break;
    }
    if (result.low_m + 0.5 > result.high_m || draw_.below(2) == 0)
      result.high_m = result.low_m + draw_.between(0.5, 12.0);
    return result;
  }
  double some_turn_rad() {
    switch (draw_.below(8)) {
      case 0:
        return 0.5 * pi;
      case 1:
        return -0.5 * pi;
      case 2:
        return draw_.magnitude(1e-4, 5e-2);
      case 3:
        return -draw_.magnitude(1e-4, 5e-2);
      case 4:
        return pi - draw_.magnitude(1e-3, 0.2);
      case 5:
        return pi + draw_.magnitude(1e-3, 0.2);
      default:
        return draw_.between(-1.5, 1.5);
    }
  }

  Draw& draw_;
  Vec3 origin_m_;
};

Town some_town(Draw& draw, const Vec3& origin_m) {
  Town town(draw, origin_m);
  for (std::size_t row = 2 + draw.below(3); row > 0; --row) {
    const Vec3 start_m = origin_m + draw.inside(Vec3(-25, -25, 0), Vec3(25, 25, 0));
    town.add_row(start_m, draw.between(-pi, pi), 2 + draw.below(6));
  }
  if (draw.below(2) == 0) {
    town.add_courtyard(origin_m + draw.inside(Vec3(-15, -15, 0), Vec3(15, 15, 0)), draw.between(3.0, 20.0));
  }
  town.add_things(draw.below(4) == 0 ? 0 : 30, draw.between(80.0, 200.0));
  return town;
}

// What is seen by trying ----------------------------------------------------------------------------------------------

struct Hit {
  double t;
  FacetId facet;
};

/// All triangles of a scene, asked one by one.
class AllTriangles {
 public:
  explicit AllTriangles(const Scene& scene) : scene_(scene) {
    for (std::uint32_t triangle = 0; triangle < scene.triangles().size(); ++triangle) {
      corners_m_.push_back(scene.corners_m(triangle));
    }
  }

  /// What a ray meets from `t_min` on, up to the first thing that is opaque, or one sheet more than may be crossed.
  void met_by(const Ray<double>& ray, int sheets, std::vector<Hit>& hits, double t_min = 0.0) const {
    hits.clear();
    const WatertightRay prepared(ray);
    double nearest = std::numeric_limits<double>::infinity();
    for (std::uint32_t triangle = 0; triangle < corners_m_.size(); ++triangle) {
      const auto t = prepared.intersect(corners_m_[triangle]);
      if (!t || *t <= t_min || *t > nearest) continue;
      const FacetId facet = scene_.facet_of_triangle(triangle);
      hits.push_back({*t, facet});
      if (!scene_.facet(facet).transmits) nearest = *t;
    }
    std::erase_if(hits, [&](const Hit& hit) { return hit.t > nearest; });
    std::ranges::sort(hits, {}, &Hit::t);
    const std::size_t most = static_cast<std::size_t>(sheets) + 1;
    if (hits.size() > most) hits.erase(hits.begin() + static_cast<std::ptrdiff_t>(most), hits.end());
  }
  /// Whether a point of an edge is seen through nothing but its faces.
  bool is_free(const Vec3& from_m, const Vec3& to_m, const WorldWedge& wedge) const {
    const WatertightRay prepared({from_m, to_m - from_m});
    for (std::uint32_t triangle = 0; triangle < corners_m_.size(); ++triangle) {
      const FacetId facet = scene_.facet_of_triangle(triangle);
      if (facet == wedge.facets[0] || facet == wedge.facets[1]) continue;
      const auto t = prepared.intersect(corners_m_[triangle]);
      if (t && *t > 0.0 && *t < 1.0 + 1e-9) return false;
      if (distance_to_triangle_m(corners_m_[triangle], to_m) < 1e-3) return false;  // nothing diffracts there
    }
    return true;
  }
  double distance_m(const Vec3& point_m) const {
    double least_m = std::numeric_limits<double>::infinity();
    for (const TriangleCorners& corners_m : corners_m_) {
      least_m = std::min(least_m, distance_to_triangle_m(corners_m, point_m));
    }
    return least_m;
  }
  const TriangleCorners& some_corners_m(Draw& draw) const { return corners_m_[draw.below(corners_m_.size())]; }
  /// One of those that are nearest, or any where none is near.
  const TriangleCorners& some_near_corners_m(Draw& draw) const {
    return near_.empty() ? some_corners_m(draw) : corners_m_[near_[draw.below(near_.size())]];
  }
  void find_near(const Vec3& point_m, double near_m) {
    near_.clear();
    for (std::size_t triangle = 0; triangle < corners_m_.size(); ++triangle) {
      if (distance_to_triangle_m(corners_m_[triangle], point_m) < near_m) near_.push_back(triangle);
    }
  }

 private:
  const Scene& scene_;
  std::vector<TriangleCorners> corners_m_;
  std::vector<std::size_t> near_;
};

// Points side by side -------------------------------------------------------------------------------------------------

/// Somewhere in the street, a bit in front of a façade, by a line, or in the plane of a façade.
Vec3 some_place_m(Draw& draw, const Town& town, const Vec3& origin_m, const AllTriangles& triangles) {
  const Line& line = town.lines[draw.below(town.lines.size())];
  const Vec3 by_line_m = line.at(draw.between(0.3, 8.0));
  const TriangleCorners& corners_m = triangles.some_corners_m(draw);
  const double u = draw.between(0.0, 1.0), v = draw.between(0.0, 1.0 - u);
  const Vec3 on_wall_m = corners_m[0] + u * (corners_m[1] - corners_m[0]) + v * (corners_m[2] - corners_m[0]);
  const Vec3 product = glm::cross(corners_m[1] - corners_m[0], corners_m[2] - corners_m[0]);
  const double side = draw.below(2) == 0 ? 1.0 : -1.0;
  const Vec3 normal = glm::normalize(product);
  switch (draw.below(7)) {
    case 0:
      return by_line_m + draw.magnitude(0.01, 2.0) * Town::level(draw.between(-pi, pi));
    case 1:
      return on_wall_m + draw.magnitude(2e-3, 1.0) * side * normal;
    case 2: {
      const Vec3 off_m = draw.below(2) == 0 ? Vec3(0.0) : draw.magnitude(1e-4, 0.1) * normal;
      return on_wall_m + draw.between(-15.0, 15.0) * glm::normalize(corners_m[1] - corners_m[0]) + off_m;
    }
    case 3: {  // so close to a corner that what a wall is bent by is more than a pixel
      const Vec3& corner_m = corners_m[draw.below(3)];
      const Vec3 inwards_m = draw.magnitude(1e-3, 0.1) * glm::normalize(on_wall_m - corner_m);
      return corner_m + inwards_m + draw.magnitude(2e-3, 0.05) * side * normal;
    }
    default:
      return origin_m + draw.inside(Vec3(-25, -25, 0.3), Vec3(25, 25, 8));
  }
}

PointGroup some_group(Draw& draw, const Vec3& middle_m) {
  const double size_m = draw.below(3) == 0 ? draw.magnitude(1e-4, 0.1) : draw.magnitude(0.01, 8.0);
  const double high_m = draw.below(2) == 0 ? 0.0 : draw.between(0.0, 0.5) * size_m;
  const Vec3 half_m = 0.5 * Vec3(size_m, draw.between(0.05, 1.0) * size_m, high_m);
  PointGroup group;
  switch (draw.below(4)) {
    case 0:
      group.points_m = {middle_m};
      break;
    case 1:
      for (int x = 0; x < 4; ++x) {
        for (int y = 0; y < 4; ++y) group.points_m.push_back(middle_m + size_m / 3.0 * Vec3(x - 1.5, y - 1.5, 0.0));
      }
      break;
    case 2:
      return points_of_box(middle_m, half_m);
    default:
      for (std::size_t point = 2 + draw.below(15); point > 0; --point) {
        group.points_m.push_back(middle_m + draw.inside(-half_m, half_m));
      }
  }
  return group;
}

/// What a ray is aimed at: all around, a line, the rim of a triangle, or a thing; close to it by nanometres or
/// centimetres.
Vec3 some_aim_m(Draw& draw, const Town& town, const AllTriangles& triangles, const Vec3& from_m) {
  const double off_m = draw.below(8) == 0 ? 0.0 : draw.magnitude(1e-9, 0.1) * (draw.below(2) == 0 ? 1.0 : -1.0);
  const std::size_t kind = draw.below(8);
  if (kind == 0) return from_m + draw.direction();
  if (kind < 5) {
    const Line& line = town.lines[draw.below(town.lines.size())];
    const double z_m = draw.below(3) == 0
                           ? (draw.below(2) == 0 ? line.low_m : line.high_m) + draw.between(-1.0, 1.0) * off_m
                           : draw.between(line.low_m, line.high_m);
    const Vec3 aim_m = line.at(z_m), way_m = aim_m - from_m;
    const double away_m = std::hypot(way_m.x, way_m.y);
    return away_m > 0.0 ? aim_m + off_m / away_m * Vec3(-way_m.y, way_m.x, 0.0) : aim_m;
  }
  const TriangleCorners& corners_m =
      draw.below(2) == 0 ? triangles.some_near_corners_m(draw) : triangles.some_corners_m(draw);
  if (kind == 5 || kind == 6) {
    const std::size_t side = draw.below(3);
    return corners_m[side] + draw.between(0.0, 1.0) * (corners_m[(side + 1) % 3] - corners_m[side]) +
           off_m * draw.direction();
  }
  const double u = draw.between(0.0, 1.0), v = draw.between(0.0, 1.0 - u);
  return corners_m[0] + u * (corners_m[1] - corners_m[0]) + v * (corners_m[2] - corners_m[0]);
}

struct Count {
  std::size_t rays = 0, met = 0, hidden = 0, joints = 0, bent = 0;
  std::size_t lost = 0;                ///< facets that are met and not seen
  std::size_t masked = 0;              ///< points that are met and called hidden
  std::size_t edges = 0, cut_off = 0;  ///< points of edges that are free, and of these those of edges not seen
};

/// Shoots from a group, which has looked.
void shoot(Draw& draw, const Town& town, const Scene& scene, const FacetOutlines& outlines, const PointGroup& group,
           const Sight& sight, const SeenLayer& seen, const AllTriangles& triangles, int sheets, int rays,
           Count& count) {
  const auto is_along = [&](const Plane& plane) {  // then nothing is reflected there
    return std::ranges::all_of(group.points_m, [&](const Vec3& point_m) {
      return std::abs(signed_distance_m(plane, point_m)) <= in_plane_guard_m;
    });
  };
  std::vector<Hit> hits;
  for (int ray = 0; ray < rays; ++ray) {
    const Vec3 from_m = group.some_point_m(draw);
    const Ray<double> way{from_m, some_aim_m(draw, town, triangles, from_m) - from_m};
    if (!has_direction(way)) continue;
    ++count.rays;
    triangles.met_by(way, sheets, hits);
    for (const Hit& hit : hits) {
      const Plane& plane = scene.facet(hit.facet).plane;
      if (is_along(plane)) continue;
      ++count.met;
      const bool is_lost = !std::ranges::binary_search(seen.mirrors, hit.facet);
      const bool is_masked = sight.map().hides(way.at(hit.t), sight.nearer_on(scene, outlines, hit.facet));
      count.lost += is_lost ? 1U : 0U;
      count.masked += is_masked ? 1U : 0U;
      if ((is_lost || is_masked) && count.lost + count.masked < 4) {
        MESSAGE("facet " << hit.facet.value << (is_lost ? " lost" : " masked") << " ray " << ray);
      }
    }
  }
}

/// Looks at points of edges.
void look_at_edges(Draw& draw, const Scene& scene, const PointGroup& group, const SeenLayer& seen,
                   const AllTriangles& triangles, int points, Count& count) {
  for (int point = 0; point < points && !scene.wedges().empty(); ++point) {
    const WedgeId id(static_cast<std::uint32_t>(draw.below(scene.wedges().size())));
    const WorldWedge& wedge = scene.wedge(id);
    if (!diffracts(wedge, {})) continue;
    const Vec3 from_m = group.some_point_m(draw);
    const Vec3 to_m = wedge.edge.start_m + draw.between(0.02, 0.98) * (wedge.edge.end_m - wedge.edge.start_m);
    // Clearly outside, and along none of the two faces: nothing diffracts there.
    const double azimuth = azimuth_rad(wedge.edge, from_m - to_m);
    if (azimuth < 1e-3 || azimuth > wedge.edge.exterior_angle_rad - 1e-3) continue;
    if (!triangles.is_free(from_m, to_m, wedge)) continue;
    ++count.edges;
    const bool is_cut_off = !std::ranges::binary_search(seen.edges, id);
    count.cut_off += is_cut_off ? 1U : 0U;
  }
}

Count shoot_in_towns(std::uint64_t seed, int towns, int groups, int rays) {
  Draw draw(seed);
  Count count;
  for (int number = 0; number < towns; ++number) {
    const std::array<double, 4> offsets_m{0.0, 0.0, 1e4, 1e5};
    const double offset_m = offsets_m[draw.below(offsets_m.size())];
    const Vec3 origin_m = draw.inside(Vec3(-1, -1, 0), Vec3(1, 1, 0)) * offset_m;
    const Town town = some_town(draw, origin_m);
    TracedScene<> traced(scene_of(town.mesh));
    const FacetOutlines outlines(traced.scene);
    for (std::uint32_t facet = 0; facet < outlines.size(); ++facet) {
      count.joints += outlines.joints(FacetId(facet)).size();
      const FacetOutline& outline = outlines.of(FacetId(facet));
      count.bent += hides_as_hull(outline) && outline.stray_m > 2e-6 ? 1U : 0U;
    }
    AllTriangles triangles(traced.scene);
    for (int place = 0; place < groups; ++place) {
      PointGroup group = some_group(draw, some_place_m(draw, town, origin_m, triangles));
      if (!group.is_body) {  // points touch nothing
        std::erase_if(group.points_m, [&](const Vec3& point_m) { return triangles.distance_m(point_m) < 2e-4; });
      }
      if (group.points_m.empty()) continue;
      triangles.find_near(group.points_m[0], 0.5);
      Sight sight(std::array<int, 4>{64, 128, 256, 384}[draw.below(4)]);
      HalfSettings settings;
      if (draw.below(4) == 0) settings.closer_from = 0;
      if (draw.below(4) == 0) settings.sheets = static_cast<int>(draw.below(2));
      SeenLayer seen;
      if (group.is_body) {
        sight.look_from_within(group.points_m);
      } else if (group.points_m.size() == 1 && draw.below(2) == 0) {
        sight.look_from(traced.end(group.points_m[0]));
      } else {
        sight.look_from(group.points_m);
      }
      sight.find_scenery(traced.scene, outlines, settings, seen);
      count.hidden += outlines.size() - seen.mirrors.size();
      const std::size_t before = count.lost + count.masked + count.cut_off;
      CAPTURE(seed);
      CAPTURE(number);
      CAPTURE(place);
      shoot(draw, town, traced.scene, outlines, group, sight, seen, triangles, std::min(settings.sheets, 1'000), rays,
            count);
      look_at_edges(draw, traced.scene, group, seen, triangles, rays / 10, count);
      CHECK(count.lost + count.masked + count.cut_off == before);
    }
  }
  return count;
}

}  // namespace

TEST_CASE("no ray from any of several points meets what they call hidden, close to lines where façades meet, too") {
  const Count count = shoot_in_towns(1, 40, 6, 1'500);
  MESSAGE(count.rays << " rays, " << count.met << " hits, " << count.hidden << " facets hidden, " << count.joints
                     << " joints, " << count.bent << " bent walls, " << count.edges << " points of edges");
  CHECK(count.cut_off == 0);
  CHECK(count.lost == 0);
  CHECK(count.masked == 0);
}

namespace {

/// A point of a mirror on the way from an image to somewhere: to what is aimed at, where that way leads through it.
Vec3 some_mirror_point_m(Draw& draw, const Town& town, const Scene& scene, const FacetOutlines& outlines,
                         const AllTriangles& triangles, FacetId mirror, const Vec3& image_m) {
  const WorldFacet& facet = scene.facet(mirror);
  const Vec3 way_m = some_aim_m(draw, town, triangles, image_m) - image_m;
  const double share = -signed_distance_m(facet.plane, image_m) / glm::dot(facet.plane.normal, way_m);
  const Vec3 point_m = image_m + share * way_m;
  if (share > 0.0 && std::isfinite(share) && outlines.is_over(mirror, point_m, 0.0)) return point_m;
  const TriangleCorners corners_m =
      scene.corners_m(facet.first_triangle + static_cast<std::uint32_t>(draw.below(facet.triangle_count)));
  const double u = draw.between(0.0, 1.0), v = draw.between(0.0, 1.0 - u);
  return corners_m[0] + u * (corners_m[1] - corners_m[0]) + v * (corners_m[2] - corners_m[0]);
}

Count shoot_through_mirrors(std::uint64_t seed, int towns, int mirrors, int rays) {
  Draw draw(seed);
  Count count;
  for (int number = 0; number < towns; ++number) {
    const Vec3 origin_m = draw.inside(Vec3(-1, -1, 0), Vec3(1, 1, 0)) * (draw.below(3) == 0 ? 1e4 : 0.0);
    const Town town = some_town(draw, origin_m);
    TracedScene<> traced(scene_of(town.mesh));
    const FacetOutlines outlines(traced.scene);
    const AllTriangles triangles(traced.scene);
    for (int round = 0; round < mirrors; ++round) {
      const FacetId mirror(static_cast<std::uint32_t>(draw.below(outlines.size())));
      const Plane& plane = traced.scene.facet(mirror).plane;
      PointGroup group = some_group(draw, some_place_m(draw, town, origin_m, triangles));
      const double side = signed_distance_m(plane, group.points_m[0]) > 0.0 ? 1.0 : -1.0;
      const auto is_before = [&](const Vec3& point_m) {
        return side * signed_distance_m(plane, point_m) > in_plane_guard_m;
      };
      if (!std::ranges::all_of(group.points_m, is_before)) continue;
      for (Vec3& point_m : group.points_m) point_m = mirrored(plane, point_m);
      Sight sight(128);
      std::vector<FacetId> seen;
      if (group.points_m.size() == 1 && draw.below(2) == 0) {
        sight.look_through(traced.scene, outlines, mirror, group.points_m[0], std::nullopt);
      } else {
        sight.look_through(traced.scene, outlines, mirror, group.points_m, group.is_body);
      }
      sight.find_facets(traced.scene, outlines, {}, false, seen);
      count.hidden += outlines.size() - seen.size();
      std::vector<Hit> hits;
      for (int ray = 0; ray < rays; ++ray) {
        const Vec3 image_m = group.some_point_m(draw);
        const Vec3 point_m = some_mirror_point_m(draw, town, traced.scene, outlines, triangles, mirror, image_m);
        triangles.met_by({image_m, point_m - image_m}, 1'000, hits, 1.0);
        for (const Hit& hit : hits) {
          if (hit.facet == mirror) continue;
          ++count.met;
          count.lost += std::ranges::find(seen, hit.facet) == seen.end() ? 1U : 0U;
        }
      }
      CAPTURE(seed);
      CAPTURE(number);
      CAPTURE(round);
      CHECK(count.lost == 0);
      if (count.lost > 0) return count;
    }
  }
  return count;
}

}  // namespace

TEST_CASE("nor does a ray from any of their images through the mirror") {
  const Count count = shoot_through_mirrors(91, 40, 30, 200);
  MESSAGE(count.met << " hits, " << count.hidden << " facets hidden");
  CHECK(count.met > 100'000);
  CHECK(count.hidden > 50'000);
}

TEST_CASE("nor where a wall's rim is bent and the points are millimetres away from it") {
  Draw draw(51);
  std::size_t met = 0, masked = 0, bent = 0;
  for (int round = 0; round < 600; ++round) {
    // Three columns; the corner in the middle of the upper rim, and perhaps that below it, is off the plane.
    const double off_m = draw.magnitude(1e-5, 0.9e-3) * (draw.below(2) == 0 ? 1.0 : -1.0);
    const double wide_m = draw.between(4.0, 12.0), high_m = draw.between(1.0, 3.0);
    const Vec3 rim_m(draw.between(-1.0, 1.0), off_m, high_m), foot_m(rim_m.x, draw.below(2) == 0 ? off_m : 0.0, 0.0);
    Town town(draw, Vec3(0.0));
    add_quad(town.mesh, {Vec3(-wide_m, 0, 0), foot_m, rim_m, Vec3(-wide_m, 0, high_m)}, "metal");
    add_quad(town.mesh, {foot_m, Vec3(wide_m, 0, 0), Vec3(wide_m, 0, high_m), rim_m}, "metal");
    town.add_things(0, 100.0);
    TracedScene<> traced(scene_of(town.mesh));
    const FacetOutlines outlines(traced.scene);
    const AllTriangles triangles(traced.scene);
    for (std::uint32_t facet = 0; facet < outlines.size(); ++facet) {
      bent += hides_as_hull(outlines.of(FacetId(facet))) && outlines.of(FacetId(facet)).stray_m > 2e-6 ? 1U : 0U;
    }
    const double away_m = draw.magnitude(2e-3, 0.05) * (draw.below(2) == 0 ? 1.0 : -1.0);
    std::vector<Vec3> points_m{rim_m + Vec3(draw.between(-0.01, 0.01), away_m, -draw.magnitude(1e-3, 0.05))};
    if (draw.below(2) == 0) points_m.push_back(points_m[0] + 0.2 * std::abs(away_m) * draw.direction());
    Sight sight(256);
    SeenLayer seen;
    sight.look_from(points_m);
    sight.find_scenery(traced.scene, outlines, {}, seen);
    std::vector<Hit> hits;
    for (int ray = 0; ray < 300; ++ray) {
      const Vec3 aim_m = rim_m + Vec3(draw.between(-0.03, 0.03), 0.0, draw.between(-2e-3, 2e-3));
      const Vec3& from_m = points_m[draw.below(points_m.size())];
      const Ray<double> way{from_m, aim_m - from_m};
      triangles.met_by(way, 0, hits);
      if (hits.empty()) continue;
      ++met;
      masked += sight.map().hides(way.at(hits[0].t), sight.nearer_on(traced.scene, outlines, hits[0].facet)) ? 1U : 0U;
    }
  }
  MESSAGE(met << " hits, " << bent << " bent walls");
  CHECK(masked == 0);
  CHECK(bent > 100);
}

namespace {

/// A street between two rows of houses that adjoin, each of a height of its own, and small things behind them.
/// `shift_m`: by how much every second house is moved along the street.
TriangleMesh long_street(double shift_m) {
  Draw draw(7);
  TriangleMesh mesh;
  for (const double side : {-1.0, 1.0}) {
    double end_m = -150.0;
    for (int house = 0; house < 50; ++house) {
      const double start_m = end_m, moved_m = house % 2 == 0 ? 0.0 : shift_m;
      end_m += draw.between(4.0, 8.0);
      const double low_m = -draw.between(0.5, 1.5), high_m = draw.between(6.0, 14.0), y_m = 8.0 * side;
      add_quad(mesh,
               {Vec3(start_m + moved_m, y_m, low_m), Vec3(end_m + moved_m, y_m, low_m),
                Vec3(end_m + moved_m, y_m, high_m), Vec3(start_m + moved_m, y_m, high_m)},
               "opaque");
    }
    for (int thing = 0; thing < 2'000; ++thing) {
      const Vec3 middle_m(draw.between(-120.0, 120.0), side * draw.between(10.0, 60.0), draw.between(0.5, 3.0));
      add_sheet(mesh, middle_m, draw.between(0.1, 0.6) * Town::level(draw.between(-pi, pi)), Vec3(0, 0, 0.4), "metal");
    }
  }
  return mesh;
}

/// How many facets sixteen points in the middle of a street see.
std::size_t seen_in_street(double shift_m, int pixels) {
  TracedScene<> traced(scene_of(long_street(shift_m)));
  const FacetOutlines outlines(traced.scene);
  std::vector<Vec3> points_m;
  for (int x = 0; x < 4; ++x) {
    for (int y = 0; y < 4; ++y) points_m.emplace_back(0.7 * x, 0.7 * y - 1.0, 1.5);
  }
  Sight sight(pixels);
  SeenLayer seen;
  sight.look_from(points_m);
  sight.find_scenery(traced.scene, outlines, {}, seen);
  return seen.mirrors.size();
}

}  // namespace

TEST_CASE("several points see far fewer things behind a row of houses than where its numbers do not agree") {
  for (const int pixels : {128, 256, 384}) {
    const std::size_t joined = seen_in_street(0.0, pixels), apart = seen_in_street(1e-6, pixels);
    MESSAGE(joined << " of " << apart << " with " << pixels << " pixels");
    CHECK(2 * joined < apart);
  }
}

namespace {

/// Whether what a ray meets first, which is the facet of this material, is among what points see, and not masked.
/// Asked for several sizes of the map.
void check_is_seen(const TriangleMesh& mesh, const std::vector<Vec3>& points_m, const Vec3& aim_m,
                   const std::string& material) {
  TracedScene<> traced(scene_of(mesh));
  const FacetOutlines outlines(traced.scene);
  const AllTriangles triangles(traced.scene);
  std::vector<Hit> hits;
  const Ray<double> way{points_m[0], aim_m - points_m[0]};
  triangles.met_by(way, 0, hits);
  REQUIRE(hits.size() == 1);
  REQUIRE(traced.scene.material(traced.scene.facet(hits[0].facet).material).name == material);
  for (const int pixels : {64, 128, 256, 384}) {
    CAPTURE(pixels);
    Sight sight(pixels);
    SeenLayer seen;
    sight.look_from(points_m);
    sight.find_scenery(traced.scene, outlines, {}, seen);
    CHECK(std::ranges::binary_search(seen.mirrors, hits[0].facet));
    CHECK_FALSE(sight.map().hides(way.at(hits[0].t), sight.nearer_on(traced.scene, outlines, hits[0].facet)));
  }
}

}  // namespace

TEST_CASE("what is seen through a crack of a bent wall, beside a corner in the middle of another triangle's side") {
  // Seen from the front the wall is whole: its lower half bends back by half a millimetre where the upper has no
  // corner. Whoever looks up sees through between them.
  const double bend_m = 0.5e-3;
  const Vec3 bent_low(-5, 10 + bend_m, 0), bent_high(-5, 10 + bend_m, 3);
  TriangleMesh mesh;
  add_quad(mesh, {Vec3(-10, 10, 3), Vec3(0, 10, 3), Vec3(0, 10, 6), Vec3(-10, 10, 6)}, "opaque");
  add_quad(mesh, {Vec3(0, 10, 3), Vec3(10, 10, 3), Vec3(10, 10, 6), Vec3(0, 10, 6)}, "opaque");
  add_quad(mesh, {Vec3(-10, 10, 0), bent_low, bent_high, Vec3(-10, 10, 3)}, "opaque");
  add_quad(mesh, {bent_low, Vec3(0, 10, 0), Vec3(0, 10, 3), bent_high}, "opaque");
  add_quad(mesh, {Vec3(0, 10, 0), Vec3(10, 10, 0), Vec3(10, 10, 3), Vec3(0, 10, 3)}, "opaque");
  add_sheet(mesh, Vec3(-5, 12, 3.4), Vec3(0.2, 0, 0), Vec3(0, 0, 0.2), "metal");
  const Vec3 from_m(-5, 0, 1), aim_m(-5, 10 + 0.5 * bend_m, 3);
  SUBCASE("from one point") {
    check_is_seen(mesh, {from_m}, aim_m, "metal");
  }
  SUBCASE("from three") {
    check_is_seen(mesh, {from_m, Vec3(-4, 0, 1), Vec3(-5.5, 0.5, 1)}, aim_m, "metal");
  }
}

TEST_CASE("what is seen through a hole of a bent wall that is as large as what bends add to the wall's area") {
  constexpr int columns = 30;
  constexpr double high_m = 10.0, slope = 0.48e-3;
  const double leg_m = std::sqrt(2.0 * columns * high_m * (std::sqrt(1.0 + slope * slope) - 1.0));  // 8 mm
  // A zigzag by half a millimetre, a metre to each column.
  const auto at = [&](int column, double share, double z_m) {
    const double off_m = slope * (column % 2 == 0 ? share : 1.0 - share);
    return Vec3(column + share - 0.5 * columns, 20.0 + off_m, z_m);
  };
  TriangleMesh mesh;
  for (int column = 0; column < columns; ++column) {
    const std::array<Vec3, 4> corners_m{at(column, 0, 0), at(column, 1, 0), at(column, 1, high_m),
                                        at(column, 0, high_m)};
    if (column != 15) {
      add_quad(mesh, corners_m, "opaque");
      continue;
    }
    const auto& [a, b, c, d] = corners_m;
    const Vec3 e = at(column, 0.5, 3), f = at(column, 0.5 + leg_m, 3), g = at(column, 0.5, 3 + leg_m);
    for (const std::array<Vec3, 3>& triangle : std::array<std::array<Vec3, 3>, 7>{
             {{a, b, e}, {b, f, e}, {b, c, f}, {c, g, f}, {c, d, g}, {d, e, g}, {d, a, e}}}) {
      const auto first = static_cast<std::uint32_t>(mesh.vertices_m.size());
      mesh.vertices_m.insert(mesh.vertices_m.end(), triangle.begin(), triangle.end());
      mesh.triangles.push_back({{first, first + 1, first + 2}, material_index(mesh, "opaque")});
    }
  }
  add_sheet(mesh, Vec3(0.5, 30, 3.5), Vec3(1, 0, 0), Vec3(0, 0, 1), "metal");
  const Vec3 from_m(0.5, 0, 2), aim_m = at(15, 0.5 + 0.25 * leg_m, 3 + 0.25 * leg_m);
  SUBCASE("from one point") {
    check_is_seen(mesh, {from_m}, aim_m, "metal");
  }
  SUBCASE("from two") {
    check_is_seen(mesh, {from_m, from_m + Vec3(1, 0, 0)}, aim_m, "metal");
  }
}

TEST_CASE(
    "what is seen past two walls on one side of their line, from close to the plane of one while the other bends") {
  // The point is 0.45 mm in front of the straight wall, and the corners of the other one's hull on the line are 0.8 mm
  // beside the line: seen from them the point would be behind the straight wall.
  constexpr double bend_m = 0.95e-3, slope = 4.5e-5;
  const double half = std::sqrt(0.5);
  const auto at = [&](int column, double z_m) {
    const bool is_end = column == 0 || column == 6;
    const double along_m = 4.5 * column, off_m = is_end ? 0.0 : bend_m;
    return Vec3(-10.0 - half * along_m + half * off_m, half * along_m + half * off_m, z_m);
  };
  TriangleMesh mesh;
  for (int column = 0; column < 6; ++column) {
    add_quad(mesh, {at(column, 0.5), at(column + 1, 0.5), at(column + 1, 2.5), at(column, 2.5)}, "opaque");
  }
  add_quad(mesh, {Vec3(-10, 0, 0), Vec3(-20, 10 * slope, 0), Vec3(-20, 10 * slope, 6), Vec3(-10, 0, 6)}, "opaque");
  add_sheet(mesh, Vec3(-20, -0.25, 1.55), Vec3(0, 0.02, 0), Vec3(0, 0, 0.02), "metal");
  const Vec3 from_m(0, 0, 1.5), aim_m(-20, -0.25, 1.55);
  SUBCASE("from one point") {
    check_is_seen(mesh, {from_m}, aim_m, "metal");
  }
  SUBCASE("from two") {
    check_is_seen(mesh, {from_m, from_m + Vec3(0, 2e-6, 0)}, aim_m, "metal");
  }
}

}  // namespace test_joined_outlines
