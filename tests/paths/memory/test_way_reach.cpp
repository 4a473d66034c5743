/// How far points of ways move while their ends do, and a device along its course: no point ever moves farther than
/// said, and some move nearly as far.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "dcem/paths/halves/join_gates.hpp"
#include "dcem/paths/memory/candidate_way.hpp"
#include "dcem/paths/memory/receiver_way.hpp"
#include "tests/paths/small_scenes.hpp"

namespace test_way_reach {

using namespace dcem;
using namespace dcem::test;

namespace {

/// A drift, and places that it allows for.
struct Drifting {
  Vec3 direction;
  double most_m, aside_m;

  Drift drift() const { return {most_m, direction, aside_m}; }
  Vec3 somewhere(Draw& draw, const Vec3& from_m) const {
    const double share = draw.below(3) == 0 ? (draw.below(2) == 0 ? 1.0 : -1.0) : draw.between(-1, 1);
    const double aside = draw.below(2) == 0 ? 1.0 : draw.between(0, 1);
    const Vec3 way_m = share * most_m * direction + aside * aside_m * draw.direction();
    return from_m + way_m * std::min(1.0, most_m / std::max(1e-12, glm::length(way_m)));
  }
};

Drifting drawn_drift(Draw& draw, const Vec3& normal) {
  Vec3 direction = draw.direction();
  if (draw.below(2) == 0) direction = glm::normalize(glm::cross(direction, normal));  // along the plane
  const double most_m = draw.below(4) == 0 ? 0.0 : draw.magnitude(1e-3, 3.0);
  return {direction, most_m, draw.below(4) == 0 ? 0.0 : std::min(most_m, draw.magnitude(1e-3, 0.3))};
}

Vec3 crossing_m(const Plane& plane, const Vec3& from_m, const Vec3& to_m) {
  const double above_m = signed_distance_m(plane, from_m), below_m = signed_distance_m(plane, to_m);
  return from_m + above_m / (above_m - below_m) * (to_m - from_m);
}

/// How far points moved, as a share of how far they may.
struct Tally {
  std::size_t asked = 0, too_far = 0, nearly = 0;

  void note(double moved_m, double reach_m) {
    if (!std::isfinite(reach_m)) return;
    ++asked;
    too_far += moved_m > reach_m * (1.0 + 1e-9) + 1e-9 ? 1 : 0;
    nearly += reach_m > 0.0 && moved_m > 0.8 * reach_m ? 1 : 0;
  }
};

}  // namespace

TEST_CASE("a way crosses a plane no farther from where it did than the drifts of its ends allow") {
  Draw draw(1);
  Tally tally;
  for (int round = 0; round < 4'000; ++round) {
    const Plane plane{draw.inside(Vec3(-50), Vec3(50)), draw.direction()};
    const Vec3 aside = glm::normalize(glm::cross(plane.normal, draw.direction()));
    const Vec3 from_m = plane.point_m + draw.magnitude(0.05, 30) * plane.normal;
    const Vec3 to_m = plane.point_m - draw.magnitude(0.05, 30) * plane.normal + draw.between(0, 200) * aside;
    const Drifting from = drawn_drift(draw, plane.normal), to = drawn_drift(draw, plane.normal);
    const double reach_m = crossing_reach_m(plane, from_m, from.drift(), to_m, to.drift());
    const Vec3 before_m = crossing_m(plane, from_m, to_m);
    for (int place = 0; place < 25; ++place) {
      const Vec3 now_m = crossing_m(plane, from.somewhere(draw, from_m), to.somewhere(draw, to_m));
      tally.note(glm::distance(before_m, now_m), reach_m);
    }
  }
  CHECK(tally.too_far == 0);
  CHECK(tally.asked > 50'000);
  CHECK(tally.nearly > 500);  // or it says too little
}

TEST_CASE("who moves along a mirror turns no way over it, and who moves as far across it does") {
  const Plane ground{};
  const Vec3 low_m(0, 0, 1.5), far_m(60, 0, -10);
  const double along_m = crossing_reach_m(ground, low_m, {0.5, Vec3(1, 0, 0), 0.0}, far_m, Drift());
  const double any_way_m = crossing_reach_m(ground, low_m, Drift(0.5), far_m, Drift());
  CHECK(along_m == 0.5);
  CHECK(any_way_m > 2.5);
  const Plane wall{Vec3(0, 3, 0), Vec3(0, 1, 0)};  // in which the same drift is the same, mirrored
  CHECK(Drift(0.5, Vec3(0, 1, 0), 0.1).in(wall).off_m(ground) == doctest::Approx(0.1));
  const Plane slope{Vec3(0), glm::normalize(Vec3(1, 0, 1))};
  CHECK(Drift(0.5, Vec3(1, 0, 0), 0.0).in(slope).off_m(ground) == doctest::Approx(0.5));
  CHECK(Drift(0.5, Vec3(1, 0, 0), 0.0).in(slope).off_m(wall) == doctest::Approx(0.0));
}

TEST_CASE("what stays on an element moves along each axis no farther than said") {
  Draw draw(3);
  for (int round = 0; round < 2'000; ++round) {
    const bool is_level = draw.below(3) == 0;
    const Vec3 nearly = glm::normalize(Vec3(1, 0, 0) + draw.magnitude(1e-12, 1e-3) * draw.direction());
    const Plane plane{Vec3(0.0), is_level ? Vec3(0, 0, 1) : draw.below(2) == 0 ? nearly : draw.direction()};
    const double moved_m = draw.magnitude(0.01, 10);
    const Vec3 spread_m = spread_in(plane, moved_m);
    const Vec3 along = glm::normalize(glm::cross(plane.normal, draw.direction()));
    CHECK(glm::all(glm::lessThanEqual(glm::abs(moved_m * along), spread_m * (1.0 + 1e-9) + Vec3(1e-15))));
    CHECK(glm::all(glm::lessThanEqual(spread_m, Vec3(moved_m * (1.0 + 1e-9)))));
    if (is_level) CHECK(spread_m.z == 0.0);
    Wedge edge;
    edge.start_m = draw.inside(Vec3(-5), Vec3(5));
    edge.end_m = edge.start_m + draw.between(0.5, 20) * draw.direction();
    CHECK(spread_on(edge, moved_m) == glm::abs(moved_m * edge_direction(edge)));
  }
}

TEST_CASE("points of ways over one and two elements move no farther than the receiver's drift allows") {
  Draw draw(4);
  Tally tally;
  std::array<std::size_t, 5> kinds{};
  for (int round = 0; round < 3'000; ++round) {
    TriangleMesh mesh;
    for (int sheet = 0; sheet < 2; ++sheet) {
      const Vec3 u = draw.direction(), v = glm::normalize(glm::cross(u, draw.direction()));
      add_sheet(mesh, draw.inside(Vec3(-20), Vec3(20)), 40.0 * u, 40.0 * v, "metal");
    }
    const Vec3 low_m = draw.inside(Vec3(-20), Vec3(20));
    add_box_faces(mesh, low_m, low_m + draw.inside(Vec3(3), Vec3(20)), "metal");
    const Scene scene = scene_of(mesh);
    const Vec3 mast_m = draw.inside(Vec3(-30), Vec3(30)), receiver_m = draw.inside(Vec3(-30), Vec3(30));
    const FacetId one = scene.facet_of_triangle(0), other = scene.facet_of_triangle(2);
    const WedgeId edge(static_cast<std::uint32_t>(draw.below(scene.wedges().size())));
    const Wedge& wedge = scene.wedge(edge).edge;
    const EdgeLine line{wedge.start_m, edge_direction(wedge), edge_length_m(wedge)};
    const std::size_t kind = draw.below(kinds.size());
    const Plane &near = scene.facet(one).plane, &far = scene.facet(kind == 4 ? one : other).plane;
    const Vec3 behind_m = mirrored(far, mast_m);
    // The points of a way to a receiver, or none.
    const auto points_to = [&](const Vec3& to_m, CandidateWay& way) {
      const Vec3 image_m = mirrored(near, to_m);
      const auto on_edge = [&](const Vec3& from_m, const Vec3& end_m) {
        return line.at(detail::place_between(from_m, line, end_m));
      };
      switch (kind) {
        case 0:
          way.elements = {one};
          way.apex_m = mirrored(near, mast_m);
          way.points_m[0] = crossing_m(near, way.apex_m, to_m);
          return (signed_distance_m(near, mast_m) > 0.0) == (signed_distance_m(near, to_m) > 0.0);
        case 1:
          way.elements = {edge};
          way.apex_m = mast_m;
          way.points_m[0] = on_edge(mast_m, to_m);
          return true;
        case 2:
          way.elements = {one, edge};
          way.apex_m = mast_m;
          way.points_m[1] = on_edge(mast_m, image_m);
          way.points_m[0] = crossing_m(near, way.points_m[1], image_m);
          return (signed_distance_m(near, way.points_m[1]) > 0.0) == (signed_distance_m(near, to_m) > 0.0);
        case 3:
          way.elements = {one, other};
          way.apex_m = behind_m;
          way.points_m[1] = crossing_m(far, behind_m, image_m);
          way.points_m[0] = crossing_m(near, way.points_m[1], image_m);
          return (signed_distance_m(far, behind_m) > 0.0) != (signed_distance_m(far, image_m) > 0.0) &&
                 (signed_distance_m(near, way.points_m[1]) > 0.0) == (signed_distance_m(near, to_m) > 0.0);
        default:
          way.elements = {edge, one};
          way.apex_m = behind_m;
          way.points_m[0] = on_edge(behind_m, to_m);
          way.points_m[1] = crossing_m(far, behind_m, way.points_m[0]);
          return (signed_distance_m(far, behind_m) > 0.0) != (signed_distance_m(far, way.points_m[0]) > 0.0);
      }
    };
    CandidateWay way, moved;
    if (!points_to(receiver_m, way)) continue;
    const Drifting receiver = drawn_drift(draw, near.normal);
    if (receiver.drift().is_none()) continue;
    ++kinds[kind];
    const WayReach reach = way_reach(scene, receiver_m, way, receiver.drift());
    for (int place = 0; place < 20; ++place) {
      // Where the way is gone a crossing has passed through infinity: then nothing was said of it.
      const bool is_there = points_to(receiver.somewhere(draw, receiver_m), moved);
      for (std::size_t at = 0; at < way.elements.size(); ++at) {
        if (!is_there && reach[at].is_known()) continue;
        tally.note(glm::distance(way.points_m[at], moved.points_m[at]), reach[at].most_m());
      }
    }
  }
  CHECK(tally.too_far == 0);
  CHECK(tally.nearly > 200);
  CHECK(std::ranges::all_of(kinds, [](std::size_t count) { return count > 100; }));
}

TEST_CASE("a course lasts as long as its device stays close to one line") {
  Course course;
  const auto at = [](double along_m, double aside_m) { return Vec3(along_m, aside_m, 1.5); };
  CHECK(course.follow(at(0, 0)));
  CHECK_FALSE(course.follow(at(0.2, 0)));  // only now it is known where it leads
  CHECK(course.ahead() == nullptr);
  CHECK(course.follow(at(0.4, 0)));
  CHECK(course.ahead() == nullptr);
  CHECK(course.follow(at(0.6, 0)));
  REQUIRE(course.ahead() != nullptr);
  CHECK(*course.ahead() == Vec3(1, 0, 0));
  CHECK(course.follow(at(0.8, 0.4 * Course::aside_m)));
  CHECK(course.follow(at(1.0, -0.4 * Course::aside_m)));
  CHECK(course.follow(at(0.5, 0.0)));  // back along it
  CHECK(course.follow(at(0.5, 0.0)));  // or nowhere
  CHECK_FALSE(course.follow(at(1.2, 0.6 * Course::aside_m)));
  CHECK(course.ahead() == nullptr);
  CHECK_FALSE(course.follow(at(1.2, 3.0)));
  CHECK_FALSE(course.follow(Vec3(1.2, 3.0, 1.5 + Course::aside_m)));  // up and down count, too
}

TEST_CASE("two points of one course lie on a line through the one that runs where the course does, or a little aside") {
  Draw draw(6);
  std::size_t on_course = 0;
  for (int drive = 0; drive < 200; ++drive) {
    Course course;
    std::vector<Vec3> since_m;
    const Vec3 ahead = draw.direction();
    const double step_m = draw.magnitude(0.02, 2), noise_m = draw.magnitude(1e-3, 0.05);
    for (int frame = 0; frame < 60; ++frame) {
      const Vec3 now_m = step_m * frame * ahead + draw.between(0, noise_m) * draw.direction();
      const bool counted_on_it = course.ahead() != nullptr;
      if (!course.follow(now_m) || !counted_on_it) since_m.clear();
      if (course.ahead() == nullptr) continue;
      since_m.push_back(now_m);
      for (const Vec3& before_m : since_m) {
        ++on_course;
        const Vec3 way_m = now_m - before_m, along = *course.ahead();
        CHECK(glm::length(way_m - glm::dot(way_m, along) * along) <= Course::aside_m * (1.0 + 1e-9));
      }
    }
  }
  CHECK(on_course > 10'000);
}

TEST_CASE("what was asked along a course counts no longer once that is left, what was asked all around does") {
  const auto always = [](const Drift&) { return true; };
  const auto at = [](double along_m, double aside_m) { return Vec3(along_m, aside_m, 1.5); };
  ReceiverWay way;
  Refusal all_around, along;
  CHECK(way.go_on(at(0.0, 0)));
  CHECK(way.go_on(at(0.1, 0)));
  REQUIRE(way.holds_for_a_while(all_around, always));
  CHECK_FALSE(all_around.is_on_course);
  CHECK(way.go_on(at(0.2, 0)));
  CHECK(way.go_on(at(0.3, 0)));
  Drift asked;
  REQUIRE(way.holds_for_a_while(along, [&](const Drift& drift) {
    asked = drift;
    return true;
  }));
  CHECK(along.is_on_course);
  CHECK(asked.off_m(Plane{Vec3(0), Vec3(0, 1, 0)}) == Course::aside_m);
  CHECK(asked.off_m(Plane{Vec3(0), Vec3(1, 0, 0)}) == asked.most_m());
  CHECK(way.go_on(at(0.4, 0)));
  CHECK((way.is_refused(all_around) && way.is_refused(along)));
  CHECK_FALSE(way.go_on(at(0.4, 0.1)));
  for (Refusal* const each : {&all_around, &along}) each->forget_course();
  CHECK(way.is_refused(all_around));
  CHECK_FALSE(way.is_refused(along));
  CHECK(way.go_on(at(0.7, 0.1)));           // nothing was asked along the line in between
  CHECK_FALSE(way.is_refused(all_around));  // half a metre is over
}

TEST_CASE("a walker whose trace is rounded to a centimetre is on a course most of the time") {
  for (const double yaw_rad : {0.0, 0.3, 1.1, 2.5}) {
    Course course;
    int on_course = 0;
    for (int frame = 0; frame < 200; ++frame) {
      const double way_m = 0.14 * frame;
      course.follow(Vec3(std::round(100 * way_m * std::cos(yaw_rad)) / 100,
                         std::round(100 * way_m * std::sin(yaw_rad)) / 100, 1.5));
      on_course += course.ahead() != nullptr ? 1 : 0;
    }
    CHECK(on_course > 150);
  }
}

}  // namespace test_way_reach
