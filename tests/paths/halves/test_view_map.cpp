/// What a view map calls hidden is hidden: no ray from its point ever meets it.
#include "dcem/paths/halves/view_map.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "dcem/core/thread_pool.hpp"
#include "dcem/paths/halves/kept_half.hpp"
#include "dcem/paths/halves/path_half.hpp"
#include "tests/paths/small_scenes.hpp"

namespace test_view_map {

using namespace dcem;
using namespace dcem::test;

namespace {

/// Boxes, tilted sheets and a ground, about 60 m across.
TriangleMesh heap_of_boxes(Draw& draw, int boxes) {
  TriangleMesh mesh;
  add_sheet(mesh, Vec3(0.0), Vec3(40, 0, 0), Vec3(0, 40, 0), "opaque");
  for (int box = 0; box < boxes; ++box) {
    const Vec3 low_m = draw.inside(Vec3(-30, -30, 0.5), Vec3(30, 30, 2));
    add_box_faces(mesh, low_m, low_m + draw.inside(Vec3(1.0), Vec3(9, 9, 15)), "metal");
  }
  for (int sheet = 0; sheet < boxes; ++sheet) {
    const Vec3 u = draw.direction(), v = glm::normalize(glm::cross(u, draw.direction()));
    add_sheet(mesh, draw.inside(Vec3(-30, -30, 2), Vec3(30, 30, 20)), draw.between(0.5, 5) * u,
              draw.between(0.5, 5) * v, draw.below(2) == 0 ? "metal" : "glass");
  }
  return mesh;
}

/// The facets that a ray meets beyond `from`, up to the first opaque one: sheets let rays pass.
std::vector<FacetId> met_by(const TracedScene<>& traced, const Ray<double>& way, double from) {
  double nearest = 1e30;
  std::vector<std::pair<double, FacetId>> hits;
  traced.index.visit_hits(way, HitFilter{}, [&](const TriangleHit& hit) {
    const FacetId id = traced.scene.facet_of_triangle(hit.triangle);
    if (hit.t > from) hits.emplace_back(hit.t, id);
    if (hit.t > from && !traced.scene.facet(id).transmits) nearest = std::min(nearest, hit.t);
    return false;
  });
  std::vector<FacetId> met;
  for (const auto& [t, id] : hits) {
    if (t <= nearest) met.push_back(id);
  }
  return met;
}

}  // namespace

TEST_CASE("no ray meets a facet that a half calls hidden") {
  Draw draw(1);
  std::size_t met = 0, hidden = 0, lost = 0;
  for (int round = 0; round < 12; ++round) {
    TracedScene<> traced(scene_of(heap_of_boxes(draw, 25)));
    const FacetOutlines outlines(traced.scene);
    for (const int pixels : {64, 256}) {
      PathHalf half(pixels);
      for (int place = 0; place < 3; ++place) {
        const LinkEnd end = traced.end(draw.inside(Vec3(-30, -30, 0.2), Vec3(30, 30, 20)));
        half.find_scenery(traced.scene, outlines, end, {});
        const std::vector<FacetId>& seen = half.layers()[0].mirrors;
        hidden += outlines.size() - seen.size();
        for (int ray = 0; ray < 30'000; ++ray) {
          for (const FacetId id : met_by(traced, {end.position_m, draw.direction()}, 0.0)) {
            ++met;
            lost += std::ranges::binary_search(seen, id) ? 0U : 1U;
          }
        }
      }
    }
  }
  MESSAGE(met << " hits, " << hidden << " facets hidden");
  CHECK(lost == 0);
  CHECK(met > 1'000'000);
  CHECK(hidden > 1'000);  // or nothing was tested
}

TEST_CASE("points of facets that rays reach are never masked, and many of the others are") {
  Draw draw(2);
  TracedScene<> traced(scene_of(heap_of_boxes(draw, 30)));
  const FacetOutlines outlines(traced.scene);
  std::size_t free = 0, masked = 0, blocked = 0, lost = 0;
  PathHalf half;
  for (int place = 0; place < 20; ++place) {
    const LinkEnd end = traced.end(draw.inside(Vec3(-30, -30, 0.2), Vec3(30, 30, 20)));
    half.find_scenery(traced.scene, outlines, end, {});
    for (int point = 0; point < 5'000; ++point) {
      const auto triangle = static_cast<std::uint32_t>(draw.below(traced.scene.triangles().size()));
      const FacetId facet = traced.scene.facet_of_triangle(triangle);
      const auto corners_m = traced.scene.corners_m(triangle);
      const double u = draw.between(0, 1), v = draw.between(0, 1 - u);
      const Vec3 point_m = corners_m[0] + u * (corners_m[1] - corners_m[0]) + v * (corners_m[2] - corners_m[0]);
      const LegEnd own{{&facet, 1}, {&traced.scene.facet(facet).plane, nullptr}};
      std::vector<Crossing> crossings;
      const bool reached =
          traced.tracer.follow_leg(end.position_m, point_m, {}, own, {}, 1000, crossings, traced.counters);
      const bool hides = half.hides(traced.scene, outlines, facet, point_m);
      free += reached ? 1U : 0U;
      blocked += reached ? 0U : 1U;
      lost += reached && hides ? 1U : 0U;
      masked += hides ? 1U : 0U;
    }
  }
  CHECK(lost == 0);
  CHECK(free > 10'000);
  CHECK(masked > blocked / 2);  // or the mask is not worth having
}

TEST_CASE("a point that is hidden wherever it may be is hidden at each of these places") {
  Draw draw(12);
  std::size_t hidden_any_way = 0, hidden_on_level = 0, lost = 0;
  for (int round = 0; round < 4; ++round) {
    TracedScene<> traced(scene_of(heap_of_boxes(draw, 30)));
    const FacetOutlines outlines(traced.scene);
    PathHalf half;
    for (int place = 0; place < 10; ++place) {
      const LinkEnd end = traced.end(draw.inside(Vec3(-30, -30, 0.2), Vec3(30, 30, 20)));
      half.find_scenery(traced.scene, outlines, end, {});
      const ViewMap& map = half.sight().map();
      for (int point = 0; point < 2'000; ++point) {
        const bool is_low = draw.below(2) == 0;
        const Vec3 point_m = draw.inside(Vec3(-40, -40, is_low ? 0 : -2), Vec3(40, 40, is_low ? 0 : 20));
        const double nearer = draw.between(1.0, 1.05), moved_m = draw.magnitude(1e-3, 5.0);
        const Vec3 any_way_m(moved_m), level_m(moved_m, moved_m, 0);
        hidden_any_way += map.hides(point_m, nearer, any_way_m) ? 1 : 0;
        hidden_on_level += map.hides(point_m, nearer, level_m) ? 1 : 0;
        const Vec3 beside_m = moved_m * draw.inside(Vec3(0), Vec3(1));
        for (const Vec3& spread_m : {any_way_m, level_m, beside_m}) {
          if (!map.hides(point_m, nearer, spread_m)) continue;
          for (int at = 0; at < 12; ++at) {
            const Vec3 share = at < 8 ? Vec3((at & 1) != 0 ? 1 : -1, (at & 2) != 0 ? 1 : -1, (at & 4) != 0 ? 1 : -1)
                                      : draw.inside(Vec3(-1), Vec3(1));
            lost += map.hides(point_m + 0.999999 * share * spread_m, nearer) ? 0 : 1;
          }
        }
      }
    }
  }
  CHECK(lost == 0);
  CHECK(hidden_any_way > 5'000);
  CHECK(10 * hidden_on_level > 11 * hidden_any_way);  // what moves along the ground is seen from low above it to stay
}

TEST_CASE("what fills the whole view hides everything behind it, and nothing in front") {
  ViewMap map(64);
  map.look_from(Vec3(0.0));
  const Plane wall{Vec3(2, 0, 0), Vec3(-1, 0, 0)};
  const std::array<Vec3, 4> corners_m{Vec3(2, -9, -9), {2, 9, -9}, {2, 9, 9}, {2, -9, 9}};
  map.cover(corners_m, wall);
  CHECK(map.hides(Vec3(3, 1, 1), 1.0));
  CHECK_FALSE(map.hides(Vec3(1.9, 1, 1), 1.0));
  CHECK_FALSE(map.hides(Vec3(-3, 1, 1), 1.0));
  CHECK(map.hides(Aabb<double>{Vec3(3, -1, -1), Vec3(4, 1, 1)}, 1.25));
  CHECK_FALSE(map.hides(Aabb<double>{Vec3(2.4, -1, -1), Vec3(4, 1, 1)}, 1.25));  // as if it began at 1.92
  CHECK_FALSE(map.hides(Aabb<double>{Vec3(-1, -1, -1), Vec3(4, 1, 1)}, 1.0));    // it holds the point
  CHECK_FALSE(map.shows(Vec3(3, -1, 0), Vec3(3, 1, 0), 1.0));
  CHECK(map.shows(Vec3(3, -1, 0), Vec3(3, 1, 0), 1.6));   // as if it were at 1.9
  CHECK(map.shows(Vec3(3, -40, 0), Vec3(3, 1, 0), 1.0));  // one end looks past the wall
}

TEST_CASE("a gap between two walls narrower than a pixel is seen through") {
  ViewMap map(64);
  map.look_from(Vec3(0.0));
  const Plane wall{Vec3(2, 0, 0), Vec3(-1, 0, 0)};
  for (const double side : {-1.0, 1.0}) {
    const std::array<Vec3, 4> corners_m{
        Vec3(2, side * 1e-4, -9), {2, side * 9, -9}, {2, side * 9, 9}, {2, side * 1e-4, 9}};
    map.cover(corners_m, wall);
  }
  CHECK(map.shows(Vec3(5, -1, 0), Vec3(5, 1, 0), 1.0));
  CHECK_FALSE(map.shows(Vec3(5, 1, 0), Vec3(5, 2, 0), 1.0));
}

TEST_CASE("no ray from any point of a crowd meets a facet that the crowd calls hidden") {
  Draw draw(11);
  std::size_t met = 0, hidden = 0, lost = 0;
  for (int round = 0; round < 12; ++round) {
    TracedScene<> traced(scene_of(heap_of_boxes(draw, 25)));
    const FacetOutlines outlines(traced.scene);
    for (int place = 0; place < 4; ++place) {
      const Vec3 middle_m = draw.inside(Vec3(-30, -30, 0.2), Vec3(30, 30, 20));
      const Vec3 half_m = draw.between(0.05, 4.0) * Vec3(1, 1, place % 2 == 0 ? 0.0 : 0.5);
      std::vector<Vec3> points_m;
      for (std::size_t point = 0; point < 2 + draw.below(15); ++point) {
        points_m.push_back(middle_m + draw.inside(-half_m, half_m));
      }
      Sight sight(place < 2 ? 64 : 256);
      SeenLayer seen;
      sight.look_from(points_m);
      sight.find_scenery(traced.scene, outlines, {}, seen);
      hidden += outlines.size() - seen.mirrors.size();
      for (int ray = 0; ray < 30'000; ++ray) {
        const Ray<double> way{points_m[draw.below(points_m.size())], draw.direction()};
        const auto hit = traced.tracer.closest_hit(way, {}, {}, traced.counters);
        if (!hit) continue;
        ++met;
        lost += std::ranges::binary_search(seen.mirrors, hit->facet) ? 0 : 1;
      }
    }
  }
  MESSAGE(met << " hits, " << hidden << " facets hidden");
  CHECK(lost == 0);
  CHECK(met > 500'000);
  CHECK(hidden > 400);
}

TEST_CASE("no ray meets a facet that only a second look calls hidden") {
  Draw draw(23);
  std::size_t met = 0, taken_away = 0, lost = 0;
  HalfSettings twice;
  twice.closer_from = 0;
  for (int round = 0; round < 6; ++round) {
    TracedScene<> traced(scene_of(heap_of_boxes(draw, 200)));
    const FacetOutlines outlines(traced.scene);
    for (int place = 0; place < 6; ++place) {
      // From beside the heap, where many facets are in few cells; every other time from several points.
      const double azimuth_rad = draw.between(0.0, 2.0 * pi), away_m = draw.between(20.0, 120.0);
      const Vec3 middle_m(away_m * std::cos(azimuth_rad), away_m * std::sin(azimuth_rad), draw.between(1.0, 40.0));
      std::vector<Vec3> points_m{middle_m};
      for (int point = 0; place % 2 == 1 && point < 7; ++point) {
        points_m.push_back(middle_m + draw.inside(Vec3(-1.0), Vec3(1.0)));
      }
      Sight sight(place < 3 ? 64 : 128);
      SeenLayer once, seen;
      sight.look_from(points_m);
      sight.find_scenery(traced.scene, outlines, {}, once);
      sight.look_from(points_m);
      sight.find_scenery(traced.scene, outlines, twice, seen);
      CHECK(std::ranges::includes(once.mirrors, seen.mirrors));
      CHECK(std::ranges::includes(once.edges, seen.edges));
      taken_away += once.mirrors.size() - seen.mirrors.size();
      for (int ray = 0; ray < 30'000; ++ray) {
        const Vec3& from_m = points_m[draw.below(points_m.size())];
        const Vec3 aim_m = draw.inside(Vec3(-40, -40, 0), Vec3(40, 40, 25));
        for (const FacetId id : met_by(traced, {from_m, aim_m - from_m}, 0.0)) {
          ++met;
          lost += std::ranges::binary_search(seen.mirrors, id) ? 0U : 1U;
        }
      }
    }
  }
  MESSAGE(met << " hits, " << taken_away << " facets taken away");
  CHECK(lost == 0);
  CHECK(met > 500'000);
  CHECK(taken_away > 200);  // or nothing was tested
}

TEST_CASE("what several threads see and list from a mast is what one sees, in its order") {
  Draw draw(31);
  TracedScene<> traced(scene_of(heap_of_boxes(draw, 200)));
  const FacetOutlines outlines(traced.scene);
  const LaneScene lanes(traced.scene, outlines);
  for (int place = 0; place < 3; ++place) {
    const LinkEnd end = traced.end(draw.inside(Vec3(-60, -60, 20), Vec3(60, 60, 40)));
    const auto look = [&](KeptHalf& half, ThreadPool* pool) {
      half.update(traced.scene, outlines, end, HalfSettings{}, {&lanes, true, true, 1, pool});
    };
    KeptHalf alone(128);
    look(alone, nullptr);
    const HalfLayer& seen = alone.half().layers()[0];
    CHECK(seen.edges.size() > 512);  // or each thread has all of them
    for (const unsigned threads : {1U, 2U, 5U}) {
      CAPTURE(threads);
      ThreadPool pool(threads);
      KeptHalf shared(128);
      look(shared, &pool);
      CHECK(shared.half().layers()[0].mirrors == seen.mirrors);
      CHECK(shared.half().layers()[0].edges == seen.edges);
      const std::vector<EdgePart> parts = alone.lists()->parts();
      CHECK(std::ranges::equal(shared.lists()->parts(), parts, [](const EdgePart& one, const EdgePart& other) {
        return one.edge == other.edge && one.from == other.from && one.to == other.to;
      }));
    }
  }
}

TEST_CASE("what several threads list of an end that has just come to a stop is what one lists") {
  Draw draw(37);
  TracedScene<> traced(scene_of(heap_of_boxes(draw, 200)));
  const FacetOutlines outlines(traced.scene);
  const LaneScene lanes(traced.scene, outlines);
  const Vec3 place_m(50.0, -20.0, 30.0);
  const auto look = [&](KeptHalf& half, ThreadPool* pool) {
    half.keep_places({0.5});
    for (const double behind_m : {0.2, 0.1, 0.0, 0.0, 0.0, 0.0}) {  // before a place is ready it stands
      const LinkEnd end = traced.end(place_m - Vec3(behind_m, 0, 0));
      half.update(traced.scene, outlines, end, HalfSettings{}, {&lanes, true, false, 1000, pool});
    }
    REQUIRE(half.lists() != nullptr);
  };
  KeptHalf alone(128);
  look(alone, nullptr);
  CHECK(alone.half().layers()[0].edges.size() > 512);
  const std::vector<EdgePart> parts = alone.lists()->parts();
  for (const unsigned threads : {2U, 5U}) {
    ThreadPool pool(threads);
    KeptHalf shared(128);
    look(shared, &pool);
    CHECK(std::ranges::equal(shared.lists()->parts(), parts, [](const EdgePart& one, const EdgePart& other) {
      return one.edge == other.edge && one.from == other.from && one.to == other.to;
    }));
  }
}

namespace {

/// What rays from images through triangles of their mirror meet, in heaps of boxes.
struct RaysThrough {
  std::size_t met = 0, lost = 0;  ///< facets, and of these those that are called hidden
  std::size_t hidden = 0;

  /// `look(draw, sight, traced, outlines, mirror)` has the sight look through the mirror and returns the images; none:
  /// there is nothing to be seen.
  template <typename Look>
  RaysThrough(std::uint64_t seed, Look&& look) {
    Draw draw(seed);
    for (int round = 0; round < 8; ++round) {
      TracedScene<> traced(scene_of(heap_of_boxes(draw, 25)));
      const FacetOutlines outlines(traced.scene);
      Sight sight(round % 2 == 0 ? 64 : 128);
      std::vector<FacetId> seen;
      for (std::uint32_t triangle = 0; triangle < traced.scene.triangles().size(); triangle += 2) {
        const FacetId mirror = traced.scene.facet_of_triangle(triangle);
        const std::vector<Vec3> images_m = look(draw, sight, traced, outlines, mirror);
        if (images_m.empty()) continue;
        sight.find_facets(traced.scene, outlines, {}, true, seen);
        hidden += outlines.size() - seen.size();
        shoot(traced, draw, triangle, images_m, seen);
      }
    }
    MESSAGE(met << " hits, " << hidden << " facets hidden");
  }

 private:
  void shoot(const TracedScene<>& traced, Draw& draw, std::uint32_t triangle, std::span<const Vec3> images_m,
             std::span<const FacetId> seen) {
    const auto corners_m = traced.scene.corners_m(triangle);
    for (int ray = 0; ray < 1'000; ++ray) {
      const Vec3& image_m = images_m[draw.below(images_m.size())];
      const double u = draw.between(0, 1), v = draw.between(0, 1 - u);
      const Vec3 point_m = corners_m[0] + u * (corners_m[1] - corners_m[0]) + v * (corners_m[2] - corners_m[0]);
      for (const FacetId id : met_by(traced, {image_m, point_m - image_m}, 1.0)) {
        if (id == traced.scene.facet_of_triangle(triangle)) continue;
        ++met;
        lost += std::ranges::find(seen, id) != seen.end() ? 0U : 1U;
      }
    }
  }
};

}  // namespace

TEST_CASE("no ray from an image through its mirror meets a facet that the view through the mirror calls hidden") {
  const RaysThrough rays(
      17, [](Draw& draw, Sight& sight, const TracedScene<>& traced, const FacetOutlines& outlines, FacetId mirror) {
        const Vec3 end_m = draw.inside(Vec3(-30, -30, 0.2), Vec3(30, 30, 20));
        const Vec3 image_m = mirrored(traced.scene.facet(mirror).plane, end_m);
        sight.look_through(traced.scene, outlines, mirror, image_m, std::nullopt);
        return std::vector{image_m};
      });
  CHECK(rays.lost == 0);
  CHECK(rays.met > 500'000);
  CHECK(rays.hidden > 100'000);
}

TEST_CASE("nor does a ray from any image of several points side by side") {
  const RaysThrough rays(
      18, [](Draw& draw, Sight& sight, const TracedScene<>& traced, const FacetOutlines& outlines, FacetId mirror) {
        const Plane& plane = traced.scene.facet(mirror).plane;
        const Vec3 middle_m = draw.inside(Vec3(-30, -30, 0.2), Vec3(30, 30, 20));
        const double side = signed_distance_m(plane, middle_m) > 0.0 ? 1.0 : -1.0, size_m = draw.between(0.1, 6.0);
        std::vector<Vec3> images_m;
        for (std::size_t point = 0; point < 16; ++point) {
          const Vec3 point_m = middle_m + draw.inside(Vec3(-0.5 * size_m), Vec3(0.5 * size_m));
          if (side * signed_distance_m(plane, point_m) > in_plane_guard_m) images_m.push_back(mirrored(plane, point_m));
        }
        if (!images_m.empty()) sight.look_through(traced.scene, outlines, mirror, images_m);
        return images_m;
      });
  CHECK(rays.lost == 0);
  CHECK(rays.met > 500'000);
  CHECK(rays.hidden > 50'000);
}

}  // namespace test_view_map
