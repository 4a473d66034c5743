/// Façades that stand on the lowest level hide what would be seen under their feet, and nothing that is seen.
#include "dcem/paths/halves/facet_feet.hpp"

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

#include "dcem/core/thread_pool.hpp"
#include "dcem/paths/halves/sight.hpp"
#include "tests/paths/halves/point_groups.hpp"
#include "tests/paths/halves/small_town.hpp"
#include "tests/paths/small_scenes.hpp"
#include "tests/support/all_tests.hpp"

namespace test_facet_feet {

using namespace dcem;
using namespace dcem::test;

namespace {

// Towns ---------------------------------------------------------------------------------------------------------------

Vec3 level(double azimuth_rad) {
  return {std::cos(azimuth_rad), std::sin(azimuth_rad), 0.0};
}

/// The lower rim of a façade.
struct Foot {
  Vec3 from_m, to_m;

  Vec3 at(double share) const { return from_m + share * (to_m - from_m); }
  /// Level, away from the façade.
  Vec3 across() const {
    const Vec3 along = glm::normalize(to_m - from_m);
    return {-along.y, along.x, 0.0};
  }
};

/// How often something in a town is not as façades that stand on its level are: 0: never, 1: always.
struct TownKind {
  bool has_ground = false;
  bool has_bodies = false;
  double odd_share = 0.0;
};

/// Houses and façades at one level, and small things beside their feet.
class Town {
 public:
  Town(Draw& draw, const TownKind& kind, const Vec3& origin_m) : draw_(draw), kind_(kind), origin_m_(origin_m) {
    // Something stands on the level for sure.
    add_wall({place_m(Vec3(-8, -6, 0)), place_m(Vec3(9, -7, 0))}, 6.0);
    if (kind_.has_ground) add_ground();
    for (std::size_t house = 1 + draw_.below(3); house > 0; --house) add_house();
    for (std::size_t row = 1 + draw_.below(3); row > 0; --row) add_row(30.0, 8.0);
    if (draw_.below(2) == 0) add_row(400.0, 60.0);
    for (std::size_t thing = 6 + draw_.below(14); thing > 0; --thing) add_thing();
    if (draw_.below(2) == 0) add_walls_around(draw_.magnitude(60.0, 2'500.0));
  }

  const Vec3& origin_m() const { return origin_m_; }
  double level_m() const { return origin_m_.z; }
  const std::vector<Foot>& feet() const { return feet_; }

  Scene scene() {
    Scene result = scene_of(mesh_);
    for (int number = 0; kind_.has_bodies && number < 5; ++number) {
      const Vec3 at_m = beside_some_foot_m(draw_.magnitude(2e-3, 3.0));
      result.add_object("body " + std::to_string(number), some_body(), LinearMotion{{at_m, draw_.between(-pi, pi)}});
    }
    return result;
  }

  const Foot& some_foot() { return feet_[draw_.below(feet_.size())]; }
  /// On the level, so far from a foot.
  Vec3 beside_some_foot_m(double away_m) {
    const Foot& foot = some_foot();
    Vec3 at_m = foot.at(draw_.between(-0.05, 1.05)) + away_m * some_sign() * foot.across();
    at_m.z = level_m();
    return at_m;
  }
  /// Nothing, or from nanometres to centimetres, above the level.
  double some_little_m() {
    constexpr std::array<double, 5> little_m{0.0, 1e-9, 1e-6, 1e-3, 0.05};
    return little_m[draw_.below(little_m.size())];
  }

 private:
  double some_sign() { return draw_.below(2) == 0 ? 1.0 : -1.0; }
  Vec3 place_m(const Vec3& beside_m) const { return {origin_m_.x + beside_m.x, origin_m_.y + beside_m.y, level_m()}; }
  std::string some_material() { return draw_.below(10) == 0 ? "glass" : draw_.below(2) == 0 ? "metal" : "opaque"; }

  void add_triangle(const std::array<Vec3, 3>& corners_m, const std::string& material) {
    const auto first = static_cast<std::uint32_t>(mesh_.vertices_m.size());
    mesh_.vertices_m.insert(mesh_.vertices_m.end(), corners_m.begin(), corners_m.end());
    mesh_.triangles.push_back({{first, first + 1, first + 2}, material_index(mesh_, material)});
  }
  void add_wall(const Foot& foot, double high_m) {
    feet_.push_back(foot);
    const Vec3 up_m(0, 0, high_m);
    add_quad(mesh_, {foot.from_m, foot.to_m, foot.to_m + up_m, foot.from_m + up_m}, some_material());
  }
  /// In upright columns that are bent against each other by less than facets may stray.
  void add_bent_wall(const Foot& foot, double high_m) {
    feet_.push_back(foot);
    const std::string material = some_material();
    const Vec3 up_m(0, 0, high_m);
    const std::size_t columns = 2 + draw_.below(3);
    Vec3 last_m = foot.from_m;
    for (std::size_t column = 1; column <= columns; ++column) {
      Vec3 next_m = foot.at(static_cast<double>(column) / static_cast<double>(columns));
      next_m += column == columns ? Vec3(0.0) : draw_.magnitude(1e-7, 8e-4) * some_sign() * foot.across();
      add_quad(mesh_, {last_m, next_m, next_m + up_m, last_m + up_m}, material);
      last_m = next_m;
    }
  }
  /// One that the level ends under, or that is no rectangle, or leans.
  void add_odd_wall(Foot foot, double high_m) {
    const Vec3 along_m = foot.to_m - foot.from_m;
    const std::string material = some_material();
    Vec3 up_m(0, 0, high_m), more_m(0.0);
    switch (draw_.below(4)) {
      case 0:
        foot.from_m.z += some_little_m();
        foot.to_m.z = draw_.below(2) == 0 ? foot.from_m.z : foot.to_m.z + some_little_m();
        break;
      case 1:
        more_m = draw_.between(-0.4, 1.0) * along_m;
        break;
      case 2:
        up_m += draw_.magnitude(1e-6, 3.0) * some_sign() * foot.across();
        break;
      default: {  // a notch
        feet_.push_back(foot);
        const Vec3 notch_m = foot.at(draw_.between(0.3, 0.7)) + Vec3(0, 0, draw_.magnitude(1e-5, 0.02));
        add_triangle({foot.from_m, notch_m, foot.from_m + up_m}, material);
        add_triangle({notch_m, foot.to_m + up_m, foot.from_m + up_m}, material);
        return add_triangle({notch_m, foot.to_m, foot.to_m + up_m}, material);
      }
    }
    feet_.push_back(foot);
    add_quad(mesh_, {foot.from_m, foot.to_m, foot.to_m + up_m + more_m, foot.from_m + up_m - more_m}, material);
  }
  void add_some_wall(const Foot& foot, double high_m) {
    if (draw_.between(0.0, 1.0) < kind_.odd_share) return add_odd_wall(foot, high_m);
    return draw_.below(4) == 0 ? add_bent_wall(foot, high_m) : add_wall(foot, high_m);
  }
  /// Façades that meet, and turn by something from one to the next.
  void add_row(double within_m, double long_m) {
    const double start_rad = draw_.between(-pi, pi);
    Vec3 last_m = place_m(draw_.between(0.1, 1.0) * within_m * level(start_rad));
    double azimuth_rad = draw_.between(-pi, pi);
    for (std::size_t wall = 1 + draw_.below(4); wall > 0; --wall) {
      azimuth_rad += draw_.between(-1.2, 1.2);
      const Vec3 next_m = last_m + draw_.between(0.3, 1.0) * long_m * level(azimuth_rad);
      add_some_wall({last_m, next_m}, draw_.between(1.0, 12.0));
      last_m = next_m;
    }
  }
  void add_house() {
    const Vec3 along = level(draw_.between(-pi, pi)), across(-along.y, along.x, 0.0);
    const Vec3 corner_m = place_m(draw_.inside(Vec3(-25, -25, 0), Vec3(25, 25, 0)));
    const Vec3 long_m = draw_.between(2.0, 12.0) * along, wide_m = draw_.between(2.0, 9.0) * across;
    const std::array<Vec3, 4> low_m{corner_m, corner_m + long_m, corner_m + long_m + wide_m, corner_m + wide_m};
    const Vec3 up_m(0, 0, draw_.between(2.0, 14.0));
    for (std::size_t side = 0; side < 4; ++side) {
      const Vec3 &from_m = low_m[side], &to_m = low_m[(side + 1) % 4];
      feet_.push_back({from_m, to_m});
      add_quad(mesh_, {from_m, to_m, to_m + up_m, from_m + up_m}, "metal");
    }
    add_quad(mesh_, {low_m[0] + up_m, low_m[1] + up_m, low_m[2] + up_m, low_m[3] + up_m}, "metal");
    if (draw_.below(2) == 0) add_quad(mesh_, low_m, "metal");
  }
  /// Something small on the level or a little above: a plate, a sheet that stands or leans.
  void add_thing() {
    const Vec3 low_m = beside_some_foot_m(draw_.magnitude(1e-3, 10.0)) + Vec3(0, 0, some_little_m());
    const Vec3 along = level(draw_.between(-pi, pi)), across(-along.y, along.x, 0.0);
    const Vec3 u_m = draw_.magnitude(0.02, 3.0) * along;
    const double high_m = draw_.magnitude(0.02, 1.0);
    std::array<Vec3, 3> rises_m{high_m * across, Vec3(0, 0, high_m), Vec3(0, 0, high_m) + high_m * across};
    const Vec3& rise_m = rises_m[draw_.below(rises_m.size())];
    add_quad(mesh_, {low_m, low_m + u_m, low_m + u_m + rise_m, low_m + rise_m}, some_material());
  }
  void add_ground() {
    constexpr double half_m = 3'000.0;
    add_quad(mesh_,
             {place_m(Vec3(-half_m, -half_m, 0)), place_m(Vec3(half_m, -half_m, 0)), place_m(Vec3(half_m, half_m, 0)),
              place_m(Vec3(-half_m, half_m, 0))},
             "opaque");
  }
  void add_walls_around(double far_m) {
    for (int side = 0; side < 8; ++side) {
      const auto corner_m = [&](int number) { return place_m(far_m * level(0.25 * pi * number + 0.1)); };
      add_wall({corner_m(side), corner_m(side + 1)}, draw_.between(3.0, 100.0));
    }
  }
  /// A box, or a wedge that stands on its edge or its tip, that reaches under the level; some are below it.
  TriangleMesh some_body() {
    TriangleMesh body;
    const double low_m = -draw_.magnitude(1e-3, 5.0);
    const double high_m = draw_.below(3) == 0 ? 0.5 * low_m : draw_.magnitude(1e-3, 2.0);
    const double half_m = draw_.magnitude(0.02, 2.0), wide_m = draw_.magnitude(0.02, 1.0);
    if (draw_.below(2) == 0) {
      add_box_faces(body, Vec3(-half_m, -wide_m, low_m), Vec3(half_m, wide_m, high_m), "metal");
      return body;
    }
    const double keel_m = draw_.below(2) == 0 ? 0.0 : half_m;
    const std::array<Vec3, 4> top_m{Vec3(-half_m, -wide_m, high_m), Vec3(half_m, -wide_m, high_m),
                                    Vec3(half_m, wide_m, high_m), Vec3(-half_m, wide_m, high_m)};
    const Vec3 one_m(-keel_m, 0, low_m), other_m(keel_m, 0, low_m);
    add_quad(body, top_m, "metal");
    const auto add = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
      const auto first = static_cast<std::uint32_t>(body.vertices_m.size());
      body.vertices_m.insert(body.vertices_m.end(), {a, b, c});
      body.triangles.push_back({{first, first + 1, first + 2}, material_index(body, "metal")});
    };
    add(top_m[0], top_m[3], one_m);
    add(top_m[1], top_m[2], other_m);
    for (const auto& [left_m, right_m] : {std::pair(top_m[0], top_m[1]), std::pair(top_m[3], top_m[2])}) {
      add(left_m, right_m, one_m);
      if (keel_m > 0.0) add(right_m, other_m, one_m);
    }
    return body;
  }

  Draw& draw_;
  TownKind kind_;
  Vec3 origin_m_;  ///< on the level
  TriangleMesh mesh_;
  std::vector<Foot> feet_;
};

// Points that look ----------------------------------------------------------------------------------------------------

/// How high over the level points are. `is_low`: down to below it.
double some_height_m(Draw& draw, bool is_low) {
  if (is_low) return draw.below(3) == 0 ? draw.between(-0.02, 0.12) : draw.between(-6.0, 0.15);
  return draw.below(3) == 0 ? draw.between(0.1, 0.3) : draw.magnitude(0.1, 30.0);
}

/// In the streets, beside a façade, or up to two kilometres away.
Vec3 some_place_m(Draw& draw, Town& town, bool is_low) {
  Vec3 place_m = town.origin_m();
  switch (draw.below(3)) {
    case 0:
      place_m = town.beside_some_foot_m(draw.magnitude(0.01, 30.0));
      break;
    case 1:
      place_m += draw.magnitude(100.0, 2'000.0) * level(draw.between(-pi, pi));
      break;
    default:
      place_m += draw.inside(Vec3(-30, -30, 0), Vec3(30, 30, 0));
  }
  place_m.z = town.level_m() + some_height_m(draw, is_low);
  return place_m;
}

PointGroup some_group(Draw& draw, const Vec3& middle_m) {
  const double size_m = draw.magnitude(0.01, 6.0);
  const double high_m = draw.below(2) == 0 ? 0.0 : draw.between(0.0, 0.3) * size_m;
  const Vec3 half_m = 0.5 * Vec3(size_m, draw.between(0.1, 1.0) * size_m, high_m);
  PointGroup group;
  group.points_m = {middle_m};
  const std::size_t kind = draw.below(4);
  if (kind == 2) return points_of_box(middle_m, half_m);
  if (kind == 3) {
    for (std::size_t point = 1 + draw.below(8); point > 0; --point) {
      group.points_m.push_back(middle_m + draw.inside(-half_m, half_m));
    }
  }
  return group;
}

// What is seen by trying ----------------------------------------------------------------------------------------------

struct Hit {
  double t;
  FacetId facet;
};

/// What a ray meets beyond `from`, up to the first thing that is opaque.
void find_hits(const TracedScene<>& traced, const Ray<double>& way, double from, std::vector<Hit>& hits) {
  double nearest = std::numeric_limits<double>::infinity();
  hits.clear();
  traced.index.visit_hits(way, HitFilter{}, [&](const TriangleHit& hit) {
    const FacetId id = traced.scene.facet_of_triangle(hit.triangle);
    if (hit.t <= from) return false;
    hits.push_back({hit.t, id});
    if (!traced.scene.facet(id).transmits) nearest = std::min(nearest, hit.t);
    return false;
  });
  std::erase_if(hits, [&](const Hit& hit) { return hit.t > nearest; });
}

/// Whether a point of an edge is seen through nothing but its faces, and diffracts.
bool is_free(TracedScene<>& traced, const Vec3& from_m, const Vec3& to_m, const WorldWedge& wedge) {
  bool is_met = false;
  const auto is_third = [&](FacetId id) { return id != wedge.facets[0] && id != wedge.facets[1]; };
  traced.index.visit_hits({from_m, to_m - from_m}, HitFilter{}, [&](const TriangleHit& hit) {
    is_met = is_met || (hit.t > 0.0 && hit.t < 1.0 + 1e-9 && is_third(traced.scene.facet_of_triangle(hit.triangle)));
    return false;
  });
  return !is_met && std::ranges::none_of(traced.tracer.facets_near(to_m, 1e-3, {}, traced.counters), is_third);
}

double nearest_m(TracedScene<>& traced, const Vec3& point_m) {
  return traced.tracer.facets_near(point_m, 3e-4, {}, traced.counters).empty() ? 1.0 : 0.0;
}

/// What a ray is aimed at: a foot, what is right behind it and beside its ends, or anything.
Vec3 some_aim_m(Draw& draw, Town& town, const Scene& scene, const Vec3& from_m) {
  const double off_m = (draw.below(2) == 0 ? 1.0 : -1.0) * draw.magnitude(1e-9, 1e-3);
  const std::size_t kind = draw.below(8);
  if (kind == 0) return from_m + draw.direction();
  if (kind < 3) {  // or a triangle, and its rims
    const std::array<Vec3, 3> corners_m =
        scene.corners_m(static_cast<std::uint32_t>(draw.below(scene.triangles().size())));
    const double u = draw.between(0.0, 1.0), v = kind == 1 ? 0.0 : draw.between(0.0, 1.0 - u);
    return corners_m[0] + u * (corners_m[1] - corners_m[0]) + v * (corners_m[2] - corners_m[0]);
  }
  const Foot& foot = town.some_foot();
  const double share = draw.below(4) == 0 ? (draw.below(2) == 0 ? 0.0 : 1.0) : draw.between(0.0, 1.0);
  Vec3 aim_m = foot.at(share) + Vec3(0, 0, draw.below(6) == 0 ? 0.0 : off_m);
  if (kind == 3)
    return aim_m + draw.magnitude(1e-9, 0.1) * (draw.below(2) == 0 ? 1.0 : -1.0) * (foot.to_m - foot.from_m);
  if (kind == 4) return aim_m;
  Vec3 way_m = aim_m - from_m;
  way_m.z = 0.0;
  const double away_m = glm::length(way_m);
  return away_m > 0.0 ? aim_m + draw.magnitude(1e-4, 10.0) / away_m * way_m : aim_m;
}

struct Count {
  std::size_t rays = 0, met = 0, hidden = 0, below = 0;  ///< `below`: hits under the level
  std::size_t lost = 0;                                  ///< facets that are met and not listed
  std::size_t masked = 0;                                ///< points that are met and called hidden
  std::size_t edges = 0, cut_off = 0;  ///< points of edges that are free, and of these those that are called hidden
  std::size_t low_edges = 0;           ///< of edges, under the level

  std::size_t wrong() const { return lost + masked + cut_off; }
};

/// Towns of a kind, and points that look in them.
class Looks {
 public:
  Looks(std::uint64_t seed, double odd_share, bool has_bodies, bool is_low)
      : draw_(seed), odd_share_(odd_share), has_bodies_(has_bodies), is_low_(is_low) {}

  Count count;

  /// `through`: through mirrors, not all around.
  void shoot_in_towns(int towns, int groups, int rays, bool through = false) {
    for (int number = 0; number < towns; ++number) {
      const std::array<double, 4> offsets_m{0.0, 0.0, 1e3, 1e5};
      Vec3 origin_m = offsets_m[draw_.below(offsets_m.size())] * level(draw_.between(-pi, pi));
      origin_m.z = draw_.below(3) == 0 ? 0.0 : draw_.between(-50.0, 300.0);
      const bool has_ground = draw_.below(3) == 0;
      Town town(draw_, {has_ground, has_bodies_, odd_share_}, origin_m);
      TracedScene<> traced(town.scene());
      const FacetOutlines outlines(traced.scene);
      for (int place = 0; place < groups; ++place) {
        CAPTURE(number);
        CAPTURE(place);
        const std::size_t before = count.wrong();
        if (through) {
          look_through(town, traced, outlines, rays);
        } else {
          look(town, traced, outlines, rays);
        }
        CHECK(count.wrong() == before);
      }
    }
  }

 private:
  void look(Town& town, TracedScene<>& traced, const FacetOutlines& outlines, int rays) {
    PointGroup group = some_group(draw_, some_place_m(draw_, town, is_low_));
    if (!group.is_body) {  // points touch nothing
      std::erase_if(group.points_m, [&](const Vec3& point_m) { return nearest_m(traced, point_m) == 0.0; });
    }
    if (group.points_m.empty()) return;
    Sight sight(std::array<int, 4>{64, 128, 256, 384}[draw_.below(4)]);
    HalfSettings settings;
    if (draw_.below(3) == 0) settings.closer_from = 0;
    if (group.is_body) {
      sight.look_from_within(group.points_m);
    } else if (group.points_m.size() == 1 && draw_.below(2) == 0) {
      sight.look_from(traced.end(group.points_m[0]));
    } else {
      sight.look_from(group.points_m);
    }
    SeenLayer seen, bodies;
    sight.find_scenery(traced.scene, outlines, settings, seen);
    sight.find_bodies(traced.scene, outlines, settings, {}, bodies);
    count.hidden += outlines.size() - seen.mirrors.size() - bodies.mirrors.size();
    std::vector<Hit> hits;
    for (int ray = 0; ray < rays; ++ray) {
      const Vec3 from_m = group.some_point_m(draw_);
      const Ray<double> way{from_m, some_aim_m(draw_, town, traced.scene, from_m) - from_m};
      if (!has_direction(way)) continue;
      ++count.rays;
      find_hits(traced, way, 0.0, hits);
      for (const Hit& hit : hits) {
        if (is_along(group, traced.scene.facet(hit.facet).plane)) continue;
        const Vec3 point_m = way.at(hit.t);
        ++count.met;
        count.below += point_m.z < town.level_m() - 1e-6 ? 1U : 0U;
        count.lost += holds(seen.mirrors, hit.facet) || holds(bodies.mirrors, hit.facet) ? 0U : 1U;
        count.masked += sight.map().hides(point_m, sight.nearer_on(traced.scene, outlines, hit.facet)) ? 1U : 0U;
      }
    }
    for (int point = 0; point < rays / 10; ++point) {
      look_at_edge(town, traced, outlines, group, sight, {seen.edges, bodies.edges});
    }
  }

  void look_at_edge(const Town& town, TracedScene<>& traced, const FacetOutlines& outlines, const PointGroup& group,
                    const Sight& sight, const std::array<std::vector<WedgeId>, 2>& seen) {
    const WedgeId id(static_cast<std::uint32_t>(draw_.below(traced.scene.wedges().size())));
    const WorldWedge& wedge = traced.scene.wedge(id);
    if (!diffracts(wedge, {})) return;
    const Vec3 from_m = group.some_point_m(draw_);
    const auto at_m = [&](double share) {
      return wedge.edge.start_m + share * (wedge.edge.end_m - wedge.edge.start_m);
    };
    const double share = draw_.between(0.02, 0.97);
    const Vec3 to_m = at_m(share);
    // Clearly outside, and along none of the two faces: nothing diffracts there.
    const double azimuth = azimuth_rad(wedge.edge, from_m - to_m);
    if (azimuth < 1e-3 || azimuth > wedge.edge.exterior_angle_rad - 1e-3) return;
    if (!is_free(traced, from_m, to_m, wedge)) return;
    ++count.edges;
    count.low_edges += to_m.z < town.level_m() - 1e-6 ? 1U : 0U;
    const bool is_listed = holds(seen[0], id) || holds(seen[1], id);
    const bool is_masked = sight.map().hides(to_m, sight.nearer_on(traced.scene, outlines, id)) ||
                           !sight.shows(traced.scene, outlines, id, to_m, at_m(share + 0.01));
    count.cut_off += !is_listed || is_masked ? 1U : 0U;
  }

  void look_through(Town& town, TracedScene<>& traced, const FacetOutlines& outlines, int rays) {
    const FacetId mirror(static_cast<std::uint32_t>(draw_.below(outlines.size())));
    const WorldFacet& facet = traced.scene.facet(mirror);
    PointGroup group = some_group(draw_, some_place_m(draw_, town, is_low_));
    const double side = signed_distance_m(facet.plane, group.points_m[0]) > 0.0 ? 1.0 : -1.0;
    const auto is_before = [&](const Vec3& point_m) {
      return side * signed_distance_m(facet.plane, point_m) > in_plane_guard_m;
    };
    if (!std::ranges::all_of(group.points_m, is_before)) return;
    for (Vec3& point_m : group.points_m) point_m = mirrored(facet.plane, point_m);
    Sight sight(128);
    if (group.points_m.size() == 1 && draw_.below(2) == 0) {
      sight.look_through(traced.scene, outlines, mirror, group.points_m[0], std::nullopt);
    } else {
      sight.look_through(traced.scene, outlines, mirror, group.points_m, group.is_body);
    }
    std::vector<FacetId> seen;
    sight.find_facets(traced.scene, outlines, {}, true, seen);
    std::ranges::sort(seen);
    count.hidden += outlines.size() - seen.size();
    std::vector<Hit> hits;
    for (int ray = 0; ray < rays; ++ray) {
      const Vec3 image_m = group.some_point_m(draw_);
      const Vec3 point_m = some_mirror_point_m(town, traced.scene, outlines, mirror, image_m);
      ++count.rays;
      const Ray<double> way{image_m, point_m - image_m};
      find_hits(traced, way, 1.0, hits);
      for (const Hit& hit : hits) {
        if (hit.facet == mirror) continue;
        ++count.met;
        count.below += way.at(hit.t).z < town.level_m() - 1e-6 ? 1U : 0U;
        count.lost += holds(seen, hit.facet) ? 0U : 1U;
      }
    }
  }

  /// On the way to what is aimed at, where that way leads through the mirror.
  Vec3 some_mirror_point_m(Town& town, const Scene& scene, const FacetOutlines& outlines, FacetId mirror,
                           const Vec3& image_m) {
    const WorldFacet& facet = scene.facet(mirror);
    for (int trial = 0; trial < 4; ++trial) {
      const Vec3 way_m = some_aim_m(draw_, town, scene, image_m) - image_m;
      const double share = -signed_distance_m(facet.plane, image_m) / glm::dot(facet.plane.normal, way_m);
      const Vec3 point_m = image_m + share * way_m;
      if (share > 0.0 && std::isfinite(share) && outlines.is_over(mirror, point_m, 0.0)) return point_m;
    }
    const std::array<Vec3, 3> corners_m =
        scene.corners_m(facet.first_triangle + static_cast<std::uint32_t>(draw_.below(facet.triangle_count)));
    const double u = draw_.between(0.0, 1.0), v = draw_.between(0.0, 1.0 - u);
    return corners_m[0] + u * (corners_m[1] - corners_m[0]) + v * (corners_m[2] - corners_m[0]);
  }

  template <typename Id>
  static bool holds(const std::vector<Id>& sorted, Id id) {
    return std::ranges::binary_search(sorted, id);
  }
  /// Then nothing is reflected there.
  static bool is_along(const PointGroup& group, const Plane& plane) {
    return std::ranges::all_of(group.points_m, [&](const Vec3& point_m) {
      return std::abs(signed_distance_m(plane, point_m)) <= in_plane_guard_m;
    });
  }

  Draw draw_;
  double odd_share_;
  bool has_bodies_, is_low_;
};

void check_nothing_is_wrong(const Count& count) {
  CHECK(count.lost == 0);
  CHECK(count.masked == 0);
  CHECK(count.cut_off == 0);
}

/// More of them where all tests are run.
int towns(int few) {
  return all_or(10 * few, few);
}

}  // namespace

TEST_CASE("no ray from points above façades' feet meets what they call hidden, close to the feet, too") {
  Looks looks(1, 0.1, false, false);
  looks.shoot_in_towns(towns(30), 6, 600);
  check_nothing_is_wrong(looks.count);
  CHECK(looks.count.met > 40'000);
  CHECK(looks.count.hidden > 1'000);  // or nothing was tested
}

TEST_CASE("nor does a ray from their images through mirrors") {
  Looks looks(2, 0.1, true, false);
  looks.shoot_in_towns(towns(20), 60, 60, true);
  check_nothing_is_wrong(looks.count);
  CHECK(looks.count.met > 10'000);
  CHECK(looks.count.hidden > 5'000);
}

TEST_CASE("bodies that reach under the level are seen under the feet of façades, and their edges and points") {
  Looks looks(3, 0.1, true, false);
  looks.shoot_in_towns(towns(30), 6, 500);
  check_nothing_is_wrong(looks.count);
  CHECK(looks.count.below > 1'000);
  CHECK(looks.count.low_edges > 100);
}

TEST_CASE("nothing that is seen is called hidden where feet are above the level, walls lean, or are no rectangles") {
  Looks looks(4, 0.8, true, false);
  looks.shoot_in_towns(towns(30), 6, 500);
  check_nothing_is_wrong(looks.count);
  CHECK(looks.count.met > 40'000);
}

TEST_CASE("nor from points close to the level and below it") {
  Looks looks(5, 0.3, true, true);
  looks.shoot_in_towns(towns(30), 6, 400);
  check_nothing_is_wrong(looks.count);
  CHECK(looks.count.met > 20'000);
}

namespace {

/// A wall of four corners in order, beside a plate on the lowest level.
class WallOnPlate {
 public:
  explicit WallOnPlate(const std::array<Vec3, 4>& corners_m, double level_m = 0.0) {
    add_quad(mesh_, corners_m, "metal");
    add_plate(level_m);
  }
  /// With a further corner in the middle of its base, from (0, 0, 0) to (10, 0, 0).
  explicit WallOnPlate(const Vec3& base_m) {
    const Vec3 low_m(0.0), high_m(0, 0, 6), far_low_m(10, 0, 0), far_high_m(10, 0, 6);
    for (const auto& [one, other] :
         {std::pair(low_m, high_m), std::pair(high_m, far_high_m), std::pair(far_high_m, far_low_m)}) {
      const auto first = static_cast<std::uint32_t>(mesh_.vertices_m.size());
      mesh_.vertices_m.insert(mesh_.vertices_m.end(), {one, other, base_m});
      mesh_.triangles.push_back({{first, first + 1, first + 2}, material_index(mesh_, "metal")});
    }
    add_plate(0.0);
  }

  bool stands() const {
    const Scene scene = scene_of(mesh_);
    const FacetOutlines outlines(scene);
    return outlines.feet().stands(scene.facet_of_triangle(0));
  }

 private:
  void add_plate(double level_m) { add_sheet(mesh_, Vec3(50, 0, level_m), Vec3(1, 0, 0), Vec3(0, 1, 0), "opaque"); }

  TriangleMesh mesh_;
};

}  // namespace

TEST_CASE("a façade stands where its foot is on the lowest level to the last bit") {
  const auto lifted = [](double from_m, double to_m, double level_m) {
    const Vec3 up_m(0, 0, 6), from(0, 0, level_m + from_m), to(7, 3, level_m + to_m);
    return WallOnPlate({from, to, to + up_m, from + up_m}, level_m).stands();
  };
  for (const double level_m : {0.0, -3.7, 112.3}) {
    CAPTURE(level_m);
    CHECK(lifted(0.0, 0.0, level_m));
    for (const double above_m : {1e-10, 1e-9, 1e-6, 1e-3, 0.05, 1.0}) {
      CAPTURE(above_m);
      CHECK_FALSE(lifted(above_m, above_m, level_m));
      CHECK_FALSE(lifted(0.0, above_m, level_m));
      CHECK_FALSE(lifted(above_m, 0.0, level_m));
    }
  }
  CHECK(WallOnPlate(Vec3(4, 0, 0)).stands());
  for (const double notch_m : {1e-10, 1e-6, 5e-4}) {
    CAPTURE(notch_m);
    CHECK_FALSE(WallOnPlate(Vec3(4, 0, notch_m)).stands());
  }
}

TEST_CASE("a façade stands where it is upright and its sides go straight up") {
  const auto stands = [](const Vec3& from_more_m, const Vec3& to_more_m) {
    const Vec3 from(0, 0, 0), to(8, 0, 0), up_m(0, 0, 6);
    return WallOnPlate({from, to, to + up_m + to_more_m, from + up_m + from_more_m}).stands();
  };
  CHECK(stands(Vec3(0.0), Vec3(0.0)));
  CHECK(stands(Vec3(0.0), Vec3(0, 0, 2)));
  for (const double aside_m : {1e-6, 1e-3, 1.0}) {
    CAPTURE(aside_m);
    const Vec3 along_m(aside_m, 0, 0), across_m(0, aside_m, 0);
    CHECK_FALSE(stands(Vec3(0.0), along_m));  // wider at the top
    CHECK_FALSE(stands(-along_m, along_m));
    CHECK_FALSE(stands(along_m, Vec3(0.0)));  // wider at the bottom
    CHECK_FALSE(stands(along_m, -along_m));
    CHECK_FALSE(stands(along_m, along_m));
    CHECK_FALSE(stands(across_m, across_m));
  }
}

TEST_CASE("no body stands, nothing stands where there is no scenery, and feet alone are lowered") {
  TriangleMesh mesh;
  add_quad(mesh, {Vec3(0, 0, 0), Vec3(0, 8, 0), Vec3(0, 8, 6), Vec3(0, 0, 6)}, "metal");
  Scene scene = scene_of(mesh), empty = scene_of_materials();
  for (Scene* const with_body : {&scene, &empty}) {
    with_body->add_object("wall", mesh, LinearMotion{{Vec3(3, 0, 0)}});
    with_body->apply(with_body->frame_at(0.0));
  }
  const FacetOutlines outlines(scene), outlines_without(empty);
  const FacetFeet& feet = outlines.feet();
  CHECK(feet.lowest_m() == 0.0);
  CHECK(feet.stands(FacetId(0)));
  CHECK_FALSE(feet.stands(FacetId(1)));
  CHECK(outlines_without.feet().lowest_m() == std::numeric_limits<double>::infinity());
  CHECK_FALSE(outlines_without.feet().stands(FacetId(0)));
  const std::span<const Vec3> hull_m = scene.hull_m(scene.facet(FacetId(0)));
  detail::InsetOutline room;
  const std::span<const Vec3> deep_m = feet.deepened(FacetId(0), hull_m, 2.5, room);
  REQUIRE(deep_m.size() == hull_m.size());
  for (std::size_t corner = 0; corner < hull_m.size(); ++corner) {
    const double lower_m = hull_m[corner].z < 1.0 ? 2.5 : 0.0;
    CHECK(glm::distance(deep_m[corner], hull_m[corner] - Vec3(0, 0, lower_m)) < 1e-8);
  }
}

TEST_CASE("a view map hides nothing below the height that it is told, until it looks from somewhere else") {
  const Plane wall{Vec3(2, 0, 0), Vec3(-1, 0, 0)}, behind{Vec3(3, 0, 0), Vec3(-1, 0, 0)};
  const std::array<Vec3, 4> wall_m{Vec3(2, -9, -9), {2, 9, -9}, {2, 9, 9}, {2, -9, 9}};
  const auto sheet_m = [](double low_m) {
    return std::array<Vec3, 4>{Vec3(3, -1, low_m), {3, 1, low_m}, {3, 1, 1}, {3, -1, 1}};
  };
  ViewMap map(64);
  map.look_from(Vec3(0.0));
  map.cover(wall_m, wall);
  const auto hides_all = [&](double low_m) {
    const bool point = map.hides(Vec3(3, 0, low_m), 1.0), box = map.hides({Vec3(3, -1, low_m), Vec3(4, 1, 1)}, 1.0);
    const bool polygon = !map.shows(sheet_m(low_m), behind, 1.0);
    const bool rises = !map.shows(Vec3(3, 0, low_m), Vec3(3, 0, 1), 1.0);
    const bool falls = !map.shows(Vec3(3, 0, 1), Vec3(3, 0, low_m), 1.0);
    CHECK(point == box);
    CHECK(point == polygon);
    CHECK(point == rises);
    CHECK(point == falls);
    return point;
  };
  CHECK(hides_all(-0.6));
  map.hide_nothing_below(-0.5);
  CHECK(hides_all(-0.4));
  CHECK_FALSE(hides_all(-0.6));
  CHECK(map.hides(Vec3(3, 0, -0.4), 1.0, Vec3(0.05)));
  CHECK_FALSE(map.hides(Vec3(3, 0, -0.4), 1.0, Vec3(0.15)));  // it may be lower
  CHECK(map.hides(Vec3(3, 0, -0.4), 1.0, Vec3(0.15, 0.15, 0)));
  map.look_from(Vec3(0.0));
  map.cover(wall_m, wall);
  CHECK(hides_all(-0.6));
}

namespace {

/// A façade 8 m high and 300 m away, and 40 low walls far behind it, of which nothing is seen.
struct FarFacade {
  TriangleMesh mesh;
  std::size_t facades = 0;

  /// `cuts_m`: where façades meet that are one row.
  explicit FarFacade(bool has_ground, const std::vector<double>& cuts_m = {}) {
    std::vector<double> ends_m{-100.0, 100.0};
    ends_m.insert(ends_m.begin() + 1, cuts_m.begin(), cuts_m.end());
    for (std::size_t end = 1; end < ends_m.size(); ++end) {
      // Not in one plane, or they would be one.
      const double from_x_m = 300.0 + static_cast<double>((end - 1) % 2), to_x_m = 300.0 + static_cast<double>(end % 2);
      const Vec3 from_m(from_x_m, ends_m[end - 1], 0), to_m(to_x_m, ends_m[end], 0), up_m(0, 0, 8);
      add_quad(mesh, {from_m, to_m, to_m + up_m, from_m + up_m}, "metal");
    }
    facades = ends_m.size() - 1;
    for (int wall = 0; wall < 40; ++wall) {
      const double x_m = 305.0 + 8.0 * wall, y_m = 4.0 * (wall % 5 - 2);
      add_quad(mesh, {Vec3(x_m, y_m - 3, 0), Vec3(x_m, y_m + 3, 0), Vec3(x_m, y_m + 3, 4), Vec3(x_m, y_m - 3, 4)},
               "metal");
    }
    if (has_ground) add_sheet(mesh, Vec3(300, 0, 0), Vec3(1'000, 0, 0), Vec3(0, 1'000, 0), "opaque");
  }

  /// How many of the walls are among facets that are seen; the façades are.
  std::size_t walls_in(const Scene& scene, std::span<const FacetId> seen) const {
    std::size_t walls = 0, before_them = 0;
    for (const FacetId id : seen) {
      const double x_m = scene.hull_m(scene.facet(id))[0].x;
      const bool is_wall = scene.facet(id).body == BodyId(0) && scene.facet(id).plane.normal.z == 0.0;
      walls += x_m > 302.0 && is_wall ? 1U : 0U;
      before_them += x_m < 302.0 && is_wall ? 1U : 0U;
    }
    CHECK(before_them == facades);
    return walls;
  }
};

std::vector<Vec3> points_around(const Vec3& middle_m, double half_m) {
  std::vector<Vec3> points_m;
  for (const double x : {-half_m, half_m}) {
    for (const double y : {-half_m, half_m}) points_m.push_back(middle_m + Vec3(x, y, 0.0));
  }
  return points_m;
}

}  // namespace

TEST_CASE("from the street nothing is seen behind a façade far away, though its foot runs through a row of pixels") {
  const Vec3 eye_m(0, 0, 1.7);
  for (const bool has_ground : {false, true}) {
    const FarFacade far(has_ground);
    TracedScene<> traced(scene_of(far.mesh));
    const FacetOutlines outlines(traced.scene);
    const LinkEnd end = traced.end(eye_m);
    CAPTURE(has_ground);
    SeenLayer seen;
    Sight sight(256);
    const auto look_from_end = [&] { sight.look_from(end); };
    const auto look_from_points = [&] { sight.look_from(points_around(eye_m, 1.0)); };
    const auto look_from_body = [&] { sight.look_from_within(points_around(eye_m, 1.0)); };
    look_from_end();
    sight.find_scenery(traced.scene, outlines, {}, seen);
    CHECK(far.walls_in(traced.scene, seen.mirrors) == 0);
    CHECK(sight.map().hides(Vec3(450, 5, 1e-6), 1.0));
    CHECK_FALSE(sight.map().hides(Vec3(450, 5, -1e-6), 1.0));
    SeenLayer in_steps, of_threads;
    look_from_end();
    for (int step = 0; step < Sight::scenery_steps; ++step) {
      sight.find_scenery_step(step, traced.scene, outlines, {}, in_steps);
    }
    ThreadPool pool(2);
    sight.look_from(end, &pool);
    sight.find_scenery(traced.scene, outlines, {}, of_threads, &pool);
    CHECK(in_steps.mirrors == seen.mirrors);
    CHECK(of_threads.mirrors == seen.mirrors);
    look_from_points();
    sight.find_scenery(traced.scene, outlines, {}, seen);
    CHECK(far.walls_in(traced.scene, seen.mirrors) == 0);
    look_from_body();
    sight.find_scenery(traced.scene, outlines, {}, seen);
    CHECK(far.walls_in(traced.scene, seen.mirrors) == 0);
  }
}

TEST_CASE("nor cell by cell, where the façade is lower than a pixel of the map") {
  for (const bool has_ground : {false, true}) {
    const FarFacade far(has_ground);
    TracedScene<> traced(scene_of(far.mesh));
    const FacetOutlines outlines(traced.scene);
    Sight sight(64);
    SeenLayer once, seen;
    HalfSettings twice;
    twice.closer_from = 0;
    sight.look_from(traced.end(Vec3(0, 0, 1.7)));
    sight.find_scenery(traced.scene, outlines, {}, once);
    CHECK(far.walls_in(traced.scene, once.mirrors) == 40);  // or nothing is tested
    sight.look_from(traced.end(Vec3(0, 0, 1.7)));
    sight.find_scenery(traced.scene, outlines, twice, seen);
    CHECK(far.walls_in(traced.scene, seen.mirrors) == 0);
  }
}

TEST_CASE("nor between façades that meet, from points side by side") {
  for (const bool has_ground : {false, true}) {
    const FarFacade far(has_ground, {-30.0, 0.0, 30.0});
    TracedScene<> traced(scene_of(far.mesh));
    const FacetOutlines outlines(traced.scene);
    Sight sight(256);
    SeenLayer seen;
    sight.look_from(points_around(Vec3(0, 0, 1.7), 0.7));
    sight.find_scenery(traced.scene, outlines, {}, seen);
    CHECK(far.walls_in(traced.scene, seen.mirrors) <= 4);  // what is asked about before both façades are looked at
    for (const double y_m : {-3.0, -1.0, 0.0, 1.0, 3.0}) CHECK(sight.map().hides(Vec3(450, y_m, 1e-6), 1.0));
  }
}

TEST_CASE("nor through a mirror") {
  for (const bool has_ground : {false, true}) {
    FarFacade far(has_ground);
    add_sheet(far.mesh, Vec3(-20, 0, 1.6), Vec3(0, 0.6, 0), Vec3(0, 0, 0.5), "metal");
    TracedScene<> traced(scene_of(far.mesh));
    const FacetOutlines outlines(traced.scene);
    const FacetId mirror = traced.facet_at(Vec3(-20, 0.1, 1.6), "metal");
    Sight sight(256);
    std::vector<FacetId> seen;
    sight.look_through(traced.scene, outlines, mirror, Vec3(-40, 0, 1.7), std::nullopt);
    sight.find_facets(traced.scene, outlines, {}, false, seen);
    CHECK(far.walls_in(traced.scene, seen) == 0);
    sight.look_through(traced.scene, outlines, mirror, points_around(Vec3(-40, 0, 1.7), 0.1));
    sight.find_facets(traced.scene, outlines, {}, false, seen);
    CHECK(far.walls_in(traced.scene, seen) == 0);
  }
}

TEST_CASE("a body behind a façade far away is seen where some of it is under the foot, and not where nothing is") {
  for (const auto& [x_m, low_m] : {std::pair(300.01, -1e-3), std::pair(310.0, -1.0), {310.0, 0.0}, {310.0, 1e-3}}) {
    const FarFacade far(false);
    Scene scene = scene_of(far.mesh);
    TriangleMesh box;
    add_box_faces(box, Vec3(0, -1, 0), Vec3(2, 1, 1.5), "metal");
    scene.add_object("car", box, LinearMotion{{Vec3(x_m, 0, low_m)}});
    TracedScene<> traced(std::move(scene));
    const FacetOutlines outlines(traced.scene);
    Sight sight(256);
    std::vector<FacetId> seen;
    CAPTURE(low_m);
    sight.look_from(traced.end(Vec3(0, 0, 1.7)));
    sight.find_facets(traced.scene, outlines, {}, true, seen);
    const auto is_of_body = [&](FacetId id) { return traced.scene.facet(id).body != BodyId(0); };
    CHECK(std::ranges::any_of(seen, is_of_body) == (low_m < 0.0));
    CHECK(far.walls_in(traced.scene, seen) == 0);  // the body is none of the scenery
    CHECK(sight.map().hides(Vec3(x_m, 1.0, low_m), 1.0) == (low_m >= 0.0));
  }
}

TEST_CASE("from below the level what is behind a façade is seen, by a sight that was above it before, too") {
  const FarFacade far(false);
  TracedScene<> traced(scene_of(far.mesh));
  const FacetOutlines outlines(traced.scene);
  Sight sight(256);
  SeenLayer seen;
  sight.look_from(traced.end(Vec3(0, 0, 1.7)));
  sight.find_scenery(traced.scene, outlines, {}, seen);
  CHECK(far.walls_in(traced.scene, seen.mirrors) == 0);
  sight.look_from(traced.end(Vec3(0, 0, -0.5)));
  sight.find_scenery(traced.scene, outlines, {}, seen);
  CHECK(far.walls_in(traced.scene, seen.mirrors) == 40);
}

TEST_CASE("what is under a façade that does not stand is seen") {
  for (const double above_m : {1e-6, 1e-3, 0.05}) {
    for (const bool is_slanted : {false, true}) {
      TriangleMesh mesh;
      const Vec3 up_m(is_slanted ? 2.0 : 0.0, 0, 8);
      const Vec3 from_m(300, -100, above_m), to_m(300, 100, above_m);
      add_quad(mesh, {from_m, to_m, to_m + up_m, from_m + up_m}, "metal");
      add_quad(mesh, {Vec3(300.001, -50, 0), Vec3(302, -50, 0), Vec3(302, 50, 0), Vec3(300.001, 50, 0)}, "opaque");
      TracedScene<> traced(scene_of(mesh));
      const FacetOutlines outlines(traced.scene);
      Sight sight(256);
      std::vector<FacetId> seen;
      sight.look_from(traced.end(Vec3(0, 0, 0.11)));
      sight.find_facets(traced.scene, outlines, {}, false, seen);
      CAPTURE(above_m);
      CAPTURE(is_slanted);
      CHECK(seen.size() == 2);
      CHECK_FALSE(sight.map().hides(Vec3(301.0, 1.0, 0.0), 1.0));
    }
  }
}

TEST_CASE("an edge that ends below all corners, because its faces stray from their planes, is seen under a foot") {
  constexpr int strips = 8;
  constexpr double bend_per_m = 6e-3;
  for (const double behind_m : {0.008, 0.01, 0.02, 0.03}) {
    TriangleMesh mesh;
    add_quad(mesh, {Vec3(-20, 0, 0), Vec3(20, 0, 0), Vec3(20, 0, 3), Vec3(-20, 0, 3)}, "opaque");
    for (int strip = 0; strip < strips; ++strip) {
      const double low_m = static_cast<double>(strip) / strips, high_m = static_cast<double>(strip + 1) / strips;
      const double near_m = behind_m + bend_per_m * low_m * low_m, far_m = behind_m + bend_per_m * high_m * high_m;
      add_quad(mesh, {Vec3(-2, near_m, low_m), Vec3(2, near_m, low_m), Vec3(2, far_m, high_m), Vec3(-2, far_m, high_m)},
               "metal");
    }
    const double top_m = behind_m + 0.25;
    add_quad(mesh, {Vec3(-2, behind_m, 0), Vec3(2, behind_m, 0), Vec3(2, top_m, 1), Vec3(-2, top_m, 1)}, "metal");
    TracedScene<> traced(scene_of(mesh));
    const bool is_below = std::ranges::any_of(traced.scene.wedges(), [](const WorldWedge& wedge) {
      return wedge.edge.start_m.z < -1e-3 && wedge.edge.end_m.z < -1e-3;
    });
    CHECK(is_below);
    Asked asked;
    asked.reflections = 0;
    asked.diffractions = 1;
    asked.interactions = 1;
    const LinkEnd from = traced.end(Vec3(0, -10, 1)), to = traced.end(Vec3(0.5, 8, 1));
    const auto all = all_sequences(traced, from, to, asked);
    CHECK(all.size() == 1);
    CHECK(same_paths(all, joined(traced, from, to, asked)));
  }
}

}  // namespace test_facet_feet
