/// A path crosses at most so many sheets, so that a view may hide what is behind more of them: nothing is lost by that.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "tests/paths/halves/crowds.hpp"

namespace test_sheets_in_view {

using namespace dcem;
using namespace dcem::test;

namespace {

/// A ground, houses that waves pass, and screens between them, one in three of them a pile.
TriangleMesh glass_houses(Draw& draw, int houses, int screens) {
  TriangleMesh mesh;
  add_sheet(mesh, Vec3(0.0), Vec3(30, 0, 0), Vec3(0, 30, 0), "opaque");
  for (int house = 0; house < houses; ++house) {
    const Vec3 low_m(draw.between(-20, 12), draw.between(-20, 12), draw.below(2) == 0 ? 0.0 : 0.01);
    add_box_faces(mesh, low_m, low_m + draw.inside(Vec3(2, 2, 2), Vec3(10, 10, 12)),
                  draw.below(4) == 0 ? "metal" : "wall");
  }
  for (int screen = 0; screen < screens; ++screen) {
    const double turn = draw.between(-pi, pi);
    const Vec3 along(std::cos(turn), std::sin(turn), 0), across(-along.y, along.x, 0);
    const Vec3 middle_m = draw.inside(Vec3(-20, -20, 2), Vec3(20, 20, 4));
    const double half_m = draw.between(1, 9), apart_m = draw.magnitude(1e-5, 0.3);
    const std::size_t pile = screen % 3 == 0 ? 3 : 1;
    for (std::size_t sheet = 0; sheet < pile; ++sheet) {
      // Of different sizes, or those on top of each other would be welded to one.
      add_sheet(mesh, middle_m + static_cast<double>(sheet) * apart_m * across,
                (half_m + 0.1 * static_cast<double>(sheet)) * along, Vec3(0, 0, 2),
                draw.below(2) == 0 ? "glass" : "alpha");
    }
  }
  return mesh;
}

}  // namespace

TEST_CASE("joined halves find every path through one, two, three and more sheets, and the same bits") {
  std::size_t found = 0;
  for (std::uint64_t seed = 3000; seed < 3060; ++seed) {
    Draw draw(seed);
    TracedScene<> traced(scene_of(glass_houses(draw, 1 + static_cast<int>(draw.below(3)), 6)));
    for (int link = 0; link < 4; ++link) {
      const LinkEnd from = somewhere(traced, draw), to = somewhere(traced, draw);
      CAPTURE(seed);
      CAPTURE(link);
      found += check_joined(traced, from, to, {link < 3 ? 1 + link : 4 + static_cast<int>(draw.below(7))},
                            draw.below(2) == 0 ? 256 : 64);
    }
  }
  MESSAGE(found << " paths");
  CHECK(found > 1'000);
}

TEST_CASE("a crowd finds every path through sheets of each of its points") {
  std::size_t found = 0;
  for (std::uint64_t seed = 3100; seed < 3125; ++seed) {
    Draw draw(seed);
    TracedScene<> traced(scene_of(glass_houses(draw, 2, 5)));
    const std::vector<Vec3> points_m = some_crowd(draw, 4.0, Vec3(-15, -15, 0.5), Vec3(15, 15, 8));
    CAPTURE(seed);
    found += check_crowd(traced, somewhere(traced, draw), points_m, {1 + static_cast<int>(draw.below(5))}, 128);
  }
  MESSAGE(found << " paths");
  CHECK(found > 500);
}

TEST_CASE("no ray that may still cross a sheet meets a facet that a view calls hidden, and much is hidden") {
  Draw draw(5);
  std::size_t met = 0, lost = 0, hidden = 0, all = 0;
  constexpr std::array<int, 4> most_crossed{1, 2, 3, 5};
  for (int round = 0; round < 16; ++round) {
    const int crossed = most_crossed[static_cast<std::size_t>(round % 4)];
    TracedScene<> traced(scene_of(glass_houses(draw, 12, crossed > 3 ? 120 : 24)));
    const FacetOutlines outlines(traced.scene);
    HalfSettings settings;
    settings.sheets = crossed;
    if (round / 4 % 2 == 1) settings.closer_from = 0;
    for (int place = 0; place < 4; ++place) {
      const LinkEnd end = traced.end(draw.inside(Vec3(-25, -25, 0.2), Vec3(25, 25, 10)));
      PathHalf half(place < 2 ? 64 : 256);
      half.find_scenery(traced.scene, outlines, end, settings);
      const std::vector<FacetId>& seen = half.layers()[0].mirrors;
      hidden += outlines.size() - seen.size();
      all += outlines.size();
      for (int ray = 0; ray < 20'000; ++ray) {
        const Vec3 to_m = end.position_m + 60.0 * draw.direction();
        std::vector<Crossing> hits;  // all sheets on the way, those on top of each other as one
        const auto first = traced.tracer.closest_hit({end.position_m, to_m - end.position_m}, {}, {}, traced.counters);
        if (!first) continue;
        // Up to the first wall, which no more than so many sheets may be in front of.
        double wall = 1.0;
        traced.index.visit_hits({end.position_m, to_m - end.position_m}, HitFilter{}, [&](const TriangleHit& hit) {
          const FacetId id = traced.scene.facet_of_triangle(hit.triangle);
          if (!traced.scene.facet(id).transmits && hit.t > 0.0) wall = std::min(wall, hit.t);
          return false;
        });
        const Vec3 stop_m = end.position_m + 0.9999 * wall * (to_m - end.position_m);
        if (!traced.tracer.follow_leg(end.position_m, stop_m, {}, {}, {}, 1000, hits, traced.counters)) continue;
        const std::size_t may_meet = std::min<std::size_t>(hits.size(), static_cast<std::size_t>(crossed) + 1);
        for (std::size_t hit = 0; hit < may_meet; ++hit) {
          ++met;
          lost += std::ranges::binary_search(seen, hits[hit].facet) ? 0U : 1U;
        }
      }
    }
  }
  MESSAGE(met << " hits, " << hidden << " of " << all << " facets hidden");
  CHECK(lost == 0);
  CHECK(met > 300'000);
  CHECK(hidden > all / 20);  // or nothing was tested
}

TEST_CASE("behind one sheet more than a path may cross nothing is seen") {
  for (const int sheets : {3, 5, 11}) {
    TriangleMesh mesh;
    for (int sheet = 0; sheet < sheets; ++sheet) add_sheet_across_x(mesh, 2.0 + 0.3 * sheet, 20.0, "glass");
    add_sheet_across_x(mesh, 6.0, 1.0, "metal");
    TracedScene<> traced(scene_of(mesh));
    const FacetOutlines outlines(traced.scene);
    const FacetId behind = traced.facet_at(Vec3(6, 0, 0), "metal");
    for (int crossed = 0; crossed <= 10; ++crossed) {
      HalfSettings settings;
      settings.sheets = crossed;
      PathHalf half;
      half.find_scenery(traced.scene, outlines, traced.end(Vec3(0.0)), settings);
      CAPTURE(sheets);
      CAPTURE(crossed);
      CHECK(std::ranges::binary_search(half.layers()[0].mirrors, behind) == (crossed >= sheets));
    }
  }
}

TEST_CASE("what is before the last of slanted sheets is seen all along them, and little of what is behind") {
  std::size_t behind = 0, behind_seen = 0;
  for (const Vec3& slant : {Vec3(1, 0.7, 0.4), Vec3(1, -0.7, -0.4), Vec3(-0.5, 1, -0.5), Vec3(0.4, -0.6, 1)}) {
    const Vec3 normal = glm::normalize(slant), along = glm::normalize(glm::cross(normal, Vec3(0.1, 0.2, 1)));
    const Vec3 across = glm::cross(normal, along);
    for (int crossed = 1; crossed <= 10; ++crossed) {
      const auto depth_m = [](int sheet) { return 3.0 + 0.5 * sheet; };
      TriangleMesh mesh;
      for (int sheet = 0; sheet <= crossed; ++sheet) {
        add_sheet(mesh, depth_m(sheet) * normal, 60.0 * along, 60.0 * across, "glass");
      }
      std::vector<Vec3> before_m, behind_m;
      for (int place = -8; place <= 8; ++place) {
        const Vec3 beside_m = 0.6 * place * along + 0.4 * place * across;
        before_m.push_back((depth_m(crossed) - 0.1) * normal + beside_m);
        behind_m.push_back((depth_m(crossed) + 1.0) * normal + beside_m);
        for (const Vec3& middle_m : {before_m.back(), behind_m.back()}) {
          add_sheet(mesh, middle_m, 0.2 * along, 0.1 * across, "metal");
        }
      }
      TracedScene<> traced(scene_of(mesh));
      const FacetOutlines outlines(traced.scene);
      HalfSettings settings;
      settings.sheets = crossed;
      PathHalf half;
      half.find_scenery(traced.scene, outlines, traced.end(Vec3(0.0)), settings);
      const auto is_seen = [&](const Vec3& point_m) {
        return std::ranges::binary_search(half.layers()[0].mirrors, traced.facet_at(point_m, "metal"));
      };
      CAPTURE(crossed);
      for (const Vec3& point_m : before_m) CHECK(is_seen(point_m));
      behind += behind_m.size();
      behind_seen += static_cast<std::size_t>(std::ranges::count_if(behind_m, is_seen));
    }
  }
  MESSAGE(behind_seen << " of " << behind << " behind are seen");
  CHECK(10 * behind_seen < behind);
}

TEST_CASE("a pile of sheets that a leg counts once hides as one sheet") {
  TriangleMesh mesh;
  // Of different sizes, or they would be welded to one.
  for (int sheet = 0; sheet < 5; ++sheet) add_sheet_across_x(mesh, 2.0 + 0.9e-4 * sheet, 20.0 + sheet, "glass");
  add_sheet_across_x(mesh, 6.0, 1.0, "metal");
  TracedScene<> traced(scene_of(mesh));
  const FacetOutlines outlines(traced.scene);
  HalfSettings settings;
  settings.sheets = 1;
  PathHalf half;
  half.find_scenery(traced.scene, outlines, traced.end(Vec3(0.0)), settings);
  CHECK(std::ranges::binary_search(half.layers()[0].mirrors, traced.facet_at(Vec3(6, 0, 0), "metal")));
  CHECK(outlines.size() == 6);
  std::vector<Crossing> crossings;
  CHECK(traced.tracer.follow_leg(Vec3(0.0), Vec3(5, 0.1, 0.2), {}, {}, {}, 1, crossings, traced.counters));
}

TEST_CASE("a fan of sheets, each parallel to the next alone, hides as one sheet") {
  TriangleMesh mesh;
  for (int sheet = 0; sheet < 6; ++sheet) {  // about a common line, 0.08 degrees from one to the next
    const double turn = 1.4e-3 * sheet, half_m = 20.0 + sheet;
    add_sheet(mesh, Vec3(2, 0, 0), half_m * Vec3(std::sin(turn), std::cos(turn), 0), half_m * Vec3(0, 0, 1), "glass");
  }
  add_sheet_across_x(mesh, 6.0, 0.01, "metal");
  TracedScene<> traced(scene_of(mesh));
  const FacetOutlines outlines(traced.scene);
  REQUIRE(outlines.size() == 7);
  HalfSettings settings;
  settings.sheets = 1;
  PathHalf half;
  half.find_scenery(traced.scene, outlines, traced.end(Vec3(0.0)), settings);
  CHECK(std::ranges::binary_search(half.layers()[0].mirrors, traced.facet_at(Vec3(6, 0, 0), "metal")));
  std::vector<Crossing> crossings;
  CHECK(traced.tracer.follow_leg(Vec3(0.0), Vec3(5, 1e-3, 0.2), {}, {}, {}, 1, crossings, traced.counters));
}

}  // namespace test_sheets_in_view
