/// Places: what any point of one sees is known in it; and they are worked out a little in each frame.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <set>
#include <span>
#include <vector>

#include "dcem/paths/halves/facet_edges.hpp"
#include "dcem/paths/halves/kept_half.hpp"
#include "tests/paths/small_scenes.hpp"

namespace test_place {

using namespace dcem;
using namespace dcem::test;

namespace {

/// A ground and houses, some with a sheet before them.
Scene houses(Draw& draw, int count) {
  TriangleMesh mesh;
  add_sheet(mesh, Vec3(0.0), Vec3(80, 0, 0), Vec3(0, 80, 0), "opaque");
  for (int house = 0; house < count; ++house) {
    const Vec3 low_m = draw.inside(Vec3(-70, -70, 0), Vec3(60, 60, 0.01));
    add_box_faces(mesh, low_m, low_m + draw.inside(Vec3(3, 3, 3), Vec3(14, 14, 15)), "metal");
    if (draw.below(3) != 0) continue;
    add_sheet(mesh, low_m + Vec3(-1, 5, 8), Vec3(0, 9, 0), Vec3(0, 0, 8), draw.below(2) == 0 ? "glass" : "wall");
  }
  return scene_of(mesh);
}

PlaceBox somewhere(Draw& draw) {
  const double turn_rad = draw.between(-pi, pi);
  return {draw.inside(Vec3(-60, -60, 0.4), Vec3(60, 60, 12)),
          {std::cos(turn_rad), std::sin(turn_rad), 0},
          {draw.between(0.5, 3.0), draw.between(0.2, 0.6), draw.between(0.1, 0.3)}};
}

/// A point in a box, one in three in one of its faces.
Vec3 inside_m(const PlaceBox& box, Draw& draw) {
  Vec3 at = 0.99999 * draw.inside(Vec3(-1), Vec3(1));
  if (draw.below(3) == 0) at[static_cast<int>(draw.below(3))] = draw.below(2) == 0 ? 0.99999 : -0.99999;
  return box.middle_m + at.x * box.half_m.x * box.ahead + at.y * box.half_m.y * box.aside() +
         Vec3(0, 0, at.z * box.half_m.z);
}

/// A device that drives straight on in an empty street.
struct Drive {
  Drive() : traced(street()), outlines(traced.scene) { half.keep_places({2.0}); }

  static Scene street() {
    Draw draw(1);
    return houses(draw, 1);
  }
  void go_on(double step_m) {
    at_m += step_m;
    go_to(Vec3(at_m, 79, 0.0));
  }
  void go_to(const Vec3& on_ground_m) {
    half.update(traced.scene, outlines, traced.end(on_ground_m + Vec3(0, 0, 1.5)), {});
  }

  TracedScene<> traced;
  FacetOutlines outlines;
  KeptHalf half;
  double at_m = -70.0;
};

}  // namespace

TEST_CASE("what any point of a place reaches is seen from the place, as a mirror and along its edges") {
  Draw draw(3);
  std::size_t mirrors = 0, edges = 0, not_seen = 0, lost = 0;
  for (int round = 0; round < 12; ++round) {
    TracedScene<> traced(houses(draw, 30));
    const Scene& scene = traced.scene;
    const FacetOutlines outlines(scene);
    for (int turn = 0; turn < 4; ++turn) {
      HalfSettings settings;
      settings.sheets = turn;
      const auto crossed = static_cast<std::size_t>(turn);
      const Place place(scene, outlines, somewhere(draw), settings);
      const SeenLayer& known = place.scenery();
      not_seen += outlines.size() - known.mirrors.size();
      for (int point = 0; point < 2'000; ++point) {
        const Vec3 from_m = inside_m(place.box(), draw);
        const auto triangle = static_cast<std::uint32_t>(draw.below(scene.triangles().size()));
        const FacetId facet = scene.facet_of_triangle(triangle);
        const auto corners_m = scene.corners_m(triangle);
        const double u = draw.between(0, 1), v = draw.between(0, 1 - u);
        const Vec3 to_m = corners_m[0] + u * (corners_m[1] - corners_m[0]) + v * (corners_m[2] - corners_m[0]);
        const LegEnd own{{&facet, 1}, {&scene.facet(facet).plane, nullptr}};
        std::vector<Crossing> crossings;
        if (!traced.tracer.follow_leg(from_m, to_m, {}, own, {}, crossed, crossings, traced.counters)) continue;
        ++mirrors;
        lost += std::ranges::binary_search(known.mirrors, facet) ? 0U : 1U;
      }
      for (int point = 0; point < 1'000; ++point) {
        const Vec3 from_m = inside_m(place.box(), draw);
        const WedgeId edge(static_cast<std::uint32_t>(draw.below(scene.wedges().size())));
        const WorldWedge& wedge = scene.wedge(edge);
        const Vec3 to_m = glm::mix(wedge.edge.start_m, wedge.edge.end_m, draw.between(0.01, 0.99));
        if (!diffracts(wedge, EdgeRules{}) || !may_face(wedge.edge, from_m - wedge.edge.start_m)) continue;
        const LegEnd own{wedge.facets, {&scene.facet(wedge.facets[0]).plane, &scene.facet(wedge.facets[1]).plane}};
        std::vector<Crossing> crossings;
        if (!traced.tracer.follow_leg(from_m, to_m, {}, own, {}, crossed, crossings, traced.counters)) continue;
        ++edges;
        lost += std::ranges::binary_search(known.edges, edge) ? 0U : 1U;
      }
    }
  }
  MESSAGE(mirrors << " points of mirrors and " << edges << " of edges reached, " << not_seen << " facets not seen");
  CHECK(lost == 0);
  CHECK(mirrors > 5'000);
  CHECK(edges > 2'000);
  CHECK(not_seen > 1'000);  // or nothing was tested
}

TEST_CASE("of a place that lies ahead each frame works out as much, and it is known before it is needed") {
  for (const double step_m : {0.01, 0.03, 0.14, 0.5, 1.0, 1.4, 2.0}) {
    CAPTURE(step_m);
    Drive drive;
    std::size_t places = 0, known_ahead = 0;
    int most = 0;
    for (int frame = 0; frame < static_cast<int>(60.0 / step_m); ++frame) {
      const Place* const before = drive.half.place().get();
      const bool was_known = drive.half.next_place() != nullptr;
      drive.go_on(step_m);
      const bool enters = drive.half.place().get() != before && drive.half.place();
      places += enters ? 1U : 0U;
      known_ahead += enters && was_known ? 1U : 0U;
      if (places > 0) most = std::max(most, drive.half.work_on_next());  // until the first one it looks itself
    }
    CHECK(places > 5);
    CHECK(known_ahead == places);
    // A place takes 45, what is prepared in it 20, and 7 that it is entered: in the frames from one to the next, of
    // which at most eight are used. Parts are at most 8.
    const double frames = std::min(8.0, std::floor(((step_m < 1.0 ? 4.0 : 6.0) - 0.25) / step_m));
    CHECK(most > 0);
    CHECK(most <= std::ceil(72.0 / frames) + 4.0);
  }
}

TEST_CASE("a device that jumps or sets out looks itself, and works out little beside, until its first place is known") {
  for (const double step_m : {0.14, 0.5, 1.4, 2.0}) {
    CAPTURE(step_m);
    Drive drive;
    for (int jump = 0; jump < 3; ++jump) {
      drive.go_on(jump == 0 ? 0.0 : 20.0);
      int frames = 0, most = 0;
      while (!drive.half.place() && frames < 30) {
        drive.go_on(step_m);
        if (!drive.half.place()) most = std::max(most, drive.half.work_on_next());
        ++frames;
      }
      CHECK(frames >= 12);  // in each of these a twelfth of 65, and parts are at most 8
      CHECK(frames <= 13);
      CHECK(most <= std::ceil(65.0 / 12.0) + 4.0);
    }
  }
}

TEST_CASE("where no candidates are found meanwhile, the work on a place fills all frames until it is entered") {
  for (const double step_m : {0.03, 0.14, 0.25}) {
    CAPTURE(step_m);
    Drive drive;
    drive.half.keep_places({.longest_step_m = 2.0, .candidates = false});
    drive.go_on(0.0);
    int most = 0, all = 0, last = 0;
    for (int frame = 0; frame < 24; ++frame) {
      drive.go_on(step_m);
      if (drive.half.place()) break;
      most = std::max(most, drive.half.work_on_next());
      all += drive.half.work_on_next();
      if (drive.half.work_on_next() > 0) last = frame;
    }
    CHECK(all == 45);
    CHECK(most <= 8);   // one part
    CHECK(last >= 21);  // with 20 more for candidates it would be done by the seventeenth
  }
}

TEST_CASE("devices that set out together work on their places in different frames, if there are enough of these") {
  Drive first, second;
  for (Drive* drive : {&first, &second}) {
    drive->half.keep_places({.longest_step_m = 2.0, .candidates = false, .early = early_of(drive == &first ? 0 : 1)});
    drive->go_on(0.0);
  }
  int busy = 0, both = 0;
  for (int frame = 0; frame < 24; ++frame) {
    for (Drive* drive : {&first, &second}) drive->go_on(0.14);
    REQUIRE(first.half.place() == nullptr);
    busy += (first.half.work_on_next() > 0 ? 1 : 0) + (second.half.work_on_next() > 0 ? 1 : 0);
    both += first.half.work_on_next() > 0 && second.half.work_on_next() > 0 ? 1 : 0;
  }
  CHECK(busy >= 14);
  CHECK(both <= 1);
}

TEST_CASE(
    "a device of which its places alone are kept is where one that keeps all it sees is, and sees the same there") {
  Draw draw(6);
  std::size_t in_places = 0, outside = 0, standing = 0;
  for (int round = 0; round < 40; ++round) {
    Drive all, places;
    Vec3 at_m(draw.inside(Vec3(-60, 60, 0), Vec3(60, 79, 0))), step_m(0.0);
    for (int frame = 0; frame < 60; ++frame) {
      const Vec3 before_m = at_m;
      const std::size_t what = draw.below(30);
      if (what == 0) at_m = draw.inside(Vec3(-60, 60, 0), Vec3(60, 79, 0));  // jumps
      if (what < 3) step_m = draw.between(0.1, 2.5) * Vec3(1, 0, 0);         // too fast, sometimes
      if (what <= 25) at_m += step_m;
      all.go_to(at_m);
      const LinkEnd end = places.traced.end(at_m + Vec3(0, 0, 1.5));
      bool sees = true;
      if (places.half.is_followed() && at_m == before_m) {
        places.half.update(places.traced.scene, places.outlines, end, {});
      } else {
        sees = places.half.update_in_place(places.traced.scene, places.outlines, end, {});
      }
      CHECK(places.half.is_of_frame() == sees);
      REQUIRE((places.half.place() == nullptr) == (all.half.place() == nullptr));
      if (!sees) {
        CHECK(places.half.place() == nullptr);
        ++outside;
        continue;
      }
      CHECK(places.half.half().layers()[0].mirrors == all.half.half().layers()[0].mirrors);
      CHECK(places.half.half().layers()[0].edges == all.half.half().layers()[0].edges);
      CHECK(places.half.half().position_m() == end.position_m);
      (places.half.place() ? in_places : standing) += 1;
    }
  }
  CHECK(in_places > 300);
  CHECK(outside > 300);
  CHECK(standing > 50);
}

TEST_CASE("in a bend that leads out of all places few of them are begun, and none anew in every frame") {
  Drive drive;
  int work = 0, in_places = 0;
  for (int frame = 0; frame < 300; ++frame) {
    const double turned = 1.4 * frame / 6.0;
    drive.go_to(6.0 * Vec3(std::cos(turned), std::sin(turned), 0.0));
    in_places += drive.half.place() ? 1 : 0;
    work += drive.half.work_on_next();
  }
  CHECK(in_places == 0);
  CHECK(work < 600);  // 2 a frame: of looking itself, some 20, a tenth
}

TEST_CASE("a device that brakes, speeds up or turns is in places most of the time") {
  for (const double radius_m : {6.0, 10.0, 20.0}) {
    CAPTURE(radius_m);
    Drive drive;
    int in_places = 0;
    for (int frame = 0; frame < 200; ++frame) {
      const double turned = 0.5 * frame / radius_m;
      drive.go_to(radius_m * Vec3(std::cos(turned), std::sin(turned), 0.0));
      in_places += drive.half.place() ? 1 : 0;
    }
    CHECK(in_places > 80);
  }
  for (const double by_mps : {-0.1, 0.1}) {  // in each frame of 0.1 s
    CAPTURE(by_mps);
    Drive drive;
    int in_places = 0;
    double speed_mps = by_mps < 0.0 ? 8.0 : 0.5;
    for (int frame = 0; frame < 80; ++frame, speed_mps += by_mps) {
      drive.go_on(0.1 * speed_mps);
      in_places += drive.half.place() ? 1 : 0;
    }
    CHECK(in_places > 60);
  }
}

TEST_CASE("the edges of facets are those of each of them, in order, of few facets and of many") {
  Draw draw(4);
  const Scene scene = houses(draw, 300);
  const std::size_t all = scene.facets().size();
  std::size_t few = 0, many = 0;
  for (int round = 0; round < 200; ++round) {
    // Facets side by side, which share edges: a dozen of them, or many.
    const std::size_t most = round % 2 == 0 ? 12 : all, count = 1 + draw.below(most),
                      first = draw.below(all - count + 1);
    std::vector<FacetId> facets;
    for (std::size_t at = 0; at < count; ++at) facets.emplace_back(static_cast<std::uint32_t>(first + at));
    std::set<WedgeId> expected;
    for (const FacetId facet : facets) {
      for (const WedgeId edge : scene.wedges_of_facet(facet)) expected.insert(edge);
    }
    std::vector<WedgeId> edges(3, WedgeId(0));  // what was there is forgotten
    collect_edges(scene, facets, edges);
    CHECK(std::ranges::equal(edges, expected));
    (256 * facets.size() < scene.wedges().size() ? few : many) += edges.empty() ? 0U : 1U;
  }
  CHECK(few > 50);
  CHECK(many > 50);
}

}  // namespace test_place
