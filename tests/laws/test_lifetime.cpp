/// What `valid_until_m` promises: no motion within it changes the set of paths, from scratch by trying all sequences;
/// and that it is not much smaller than it could be.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "tests/laws/lifetime_cases.hpp"
#include "tests/support/all_tests.hpp"

namespace test_lifetime {

using namespace dcem;
using namespace dcem::test;

namespace {

struct Tally {
  std::size_t links = 0, paths = 0, motions = 0, broken = 0;
  std::size_t changed_soon = 0, changed_far = 0;  ///< links that some motion of 3 d, of 20 d changes
  std::vector<double> until_m;

  double quantile(double share) const {
    return until_m[static_cast<std::size_t>(share * static_cast<double>(until_m.size() - 1))];
  }
};

/// An end beside the walls of the town, now and then very close to one.
Vec3 somewhere_in(TracedScene<>& traced, Draw& draw) {
  const Vec3 end_m = draw.inside(Vec3(-20, -20, 0.3), Vec3(20, 20, 14));
  if (draw.below(4) != 0) return end_m;
  const Vec3 way = draw.direction();
  const std::optional<SurfaceHit> hit = traced.tracer.closest_hit({end_m, way}, {}, {}, traced.counters);
  return hit ? end_m + std::max(0.0, hit->t - draw.magnitude(0.003, 1.0)) * way : end_m;
}

void check_link(std::uint64_t seed, const Asked& asked, bool cars, Tally& tally) {
  Draw draw(seed);
  TracedScene<> traced(small_town(draw));
  Configuration now{traced.scene.frame_at(0.0), {}, {}};
  for (std::size_t body = 1; body < now.frame.bodies.size(); ++body) now.frame.bodies[body].present = cars;
  traced.apply(now.frame);
  now.from_m = somewhere_in(traced, draw);
  now.to_m = somewhere_in(traced, draw);
  const std::vector<Path> paths = paths_at(traced, now, asked);
  const double until_m = lifetime_m(traced, traced.end(now.from_m), traced.end(now.to_m), asked, paths);
  ++tally.links;
  tally.paths += paths.size();
  tally.until_m.push_back(until_m);
  REQUIRE(until_m >= 0.0);
  REQUIRE(until_m <= 1.0);
  if (!(until_m > 0.0)) return;
  const auto changes = [&](double moved_m, int kind) {
    const Configuration next = moved(draw, traced.scene, now, moved_m, static_cast<MotionKind>(kind));
    const std::vector<Path> after = paths_at(traced, next, asked);
    const bool differs = !same_set(paths, after);
    if (differs && moved_m <= until_m) {
      const std::string what = difference(traced.scene, paths, after);
      MESSAGE("seed " << seed << ", cars " << cars << ", d " << until_m << " m, motion " << kind << ":" << what);
    }
    return differs;
  };
  bool soon = false, far = false;
  for (int motion = 0; motion < 10; ++motion) {
    const int kind = motion % static_cast<int>(MotionKind::count);
    ++tally.motions;
    tally.broken += changes(0.999 * until_m, kind) ? 1 : 0;
    soon = soon || changes(3.0 * until_m, kind);
    far = far || changes(20.0 * until_m, kind);
  }
  tally.changed_soon += soon ? 1 : 0;
  tally.changed_far += far ? 1 : 0;
}

/// `DCEM_LIFETIME_TIMES` multiplies the number of links.
std::uint64_t scaled(std::uint64_t count) {
  const char* const times = std::getenv("DCEM_LIFETIME_TIMES");
  return times == nullptr ? count : static_cast<std::uint64_t>(std::atof(times) * static_cast<double>(count));
}

/// An upright wall in the plane x = 0 that ends at y = 0, and goes on far away from it.
TriangleMesh wall_up_to_y0() {
  TriangleMesh mesh;
  add_quad(mesh, {Vec3(0, -200, -200), Vec3(0, 0, -200), Vec3(0, 0, 200), Vec3(0, -200, 200)}, "metal");
  return mesh;
}

/// `distance_m` is what both ends have to move by, and in one direction, until the straight line from one to the other,
/// or to its image, touches the edge of the wall.
void check_wall(const Vec3& from_m, const Vec3& to_m, double distance_m, std::size_t paths_now) {
  TracedScene<> traced(scene_of(wall_up_to_y0()));
  const Asked asked{0, 1, 0, 1};
  const Configuration now{traced.scene.frame_at(0.0), from_m, to_m};
  const std::vector<Path> paths = paths_at(traced, now, asked);
  CHECK(paths.size() == paths_now);
  const double until_m = lifetime_m(traced, traced.end(from_m), traced.end(to_m), asked, paths, 50.0);
  CHECK(until_m < distance_m);
  CHECK(until_m > 0.94 * distance_m);  // it is found to a sixteenth of itself
}

}  // namespace

TEST_CASE("within valid_until_m no path of a random town appears or vanishes") {
  struct Case {
    std::string name;
    Asked asked;
    double median_m;  ///< at least, without cars
  };
  const std::vector<Case> cases{{"mirrors", {0, 2, 0, 2}, 0.05},          {"edges", {0, 0, 1, 1}, 0.02},
                                {"two interactions", {0, 2, 1, 2}, 0.01}, {"free edges", {0, 1, 1, 2, true}, 0.01},
                                {"sheets", {2, 2, 1, 2}, 0.01},           {"one sheet", {1, 1, 0, 1}, 0.05}};
  for (const Case& one : cases) {
    for (const bool cars : {false, true}) {
      Tally tally;
      for (std::uint64_t seed = 1; seed <= scaled(all_or(100U, 50U)); ++seed) check_link(seed, one.asked, cars, tally);
      std::ranges::sort(tally.until_m);
      const auto unproved = static_cast<std::size_t>(std::ranges::count(tally.until_m, 0.0));
      const std::string name = one.name + (cars ? " with cars: " : ": ");
      MESSAGE(name << tally.links << " links, " << tally.paths << " paths, " << tally.motions << " motions, changed "
                   << tally.broken << "; 0 for " << unproved << " links, quartiles " << tally.quantile(0.25) << " m, "
                   << tally.quantile(0.5) << " m, " << tally.quantile(0.75) << " m; changed by 3 d "
                   << tally.changed_soon << ", by 20 d " << tally.changed_far);
      CHECK(tally.broken == 0);
      CHECK(6 * unproved <= tally.links);
      CHECK(tally.quantile(0.5) > (cars ? 0.05 : 1.0) * one.median_m);
      CHECK(2 * tally.changed_far > tally.links);
    }
  }
}

TEST_CASE("a reflection at one wall: up to where its point is on the wall's edge, or comes onto it") {
  // Unfolded, the way from (3, y, 0) to the image (−6, y, 0) of the other end passes the edge y = 0 at |y|.
  check_wall(Vec3(3, -1, 0), Vec3(6, -1, 0), 1.0, 2);
  check_wall(Vec3(3, 1, 0), Vec3(6, 1, 0), 1.0, 1);
  // From (3, −4, 0) to (−3, 2, 0): it passes (0, 0, 0) at 1/√2.
  check_wall(Vec3(3, -4, 0), Vec3(3, 2, 0), std::sqrt(0.5), 2);
}

TEST_CASE("a direct path beside one wall: up to where the wall's edge comes into it, or leaves it") {
  check_wall(Vec3(5, 1, 0), Vec3(-5, 1, 0), 1.0, 1);
  check_wall(Vec3(5, -1, 0), Vec3(-5, -1, 0), 1.0, 0);
  check_wall(Vec3(5, 6, 0), Vec3(-5, -4, 0), std::sqrt(0.5), 1);
}

TEST_CASE("an end gets no nearer to a wall than the wall is") {
  TracedScene<> traced(scene_of(wall_up_to_y0()));
  const Asked asked{0, 1, 0, 1};
  const Configuration now{traced.scene.frame_at(0.0), Vec3(0.25, -30, 0), Vec3(6, -30, 0)};
  const double until_m =
      lifetime_m(traced, traced.end(now.from_m), traced.end(now.to_m), asked, paths_at(traced, now, asked), 50.0);
  CHECK(until_m <= 0.25 - 1e-4);
  CHECK(until_m > 0.2);
  CHECK(lifetime_m(traced, traced.end(Vec3(6, -30, 0)), traced.end(Vec3(6, -30, 0.25)), asked,
                   paths_at(traced, {now.frame, Vec3(6, -30, 0), Vec3(6, -30, 0.25)}, asked)) < 0.125);
  const LinkEnd mounted = traced.end(Vec3(0.0, -30, 0));
  CHECK(lifetime_m(traced, mounted, traced.end(now.to_m), asked, {}) == 0.0);
}

TEST_CASE("a diffraction at one edge: up to where its point comes to the end of the edge") {
  TriangleMesh mesh;  // a free edge along z from −10 to 0, of a wall that is far wider than the rest is away
  add_quad(mesh, {Vec3(0, -200, -10), Vec3(0, 0, -10), Vec3(0, 0, 0), Vec3(0, -200, 0)}, "metal");
  TracedScene<> traced(scene_of(mesh));
  // Over the edge at z = −1, level; both ends may rise by 1 m. The azimuths leave more room than that.
  const Asked asked{0, 0, 1, 1, true};
  const Configuration now{traced.scene.frame_at(0.0), Vec3(5, -4, -1), Vec3(-5, -4, -1)};
  const std::vector<Path> paths = paths_at(traced, now, asked);
  const double until_m = lifetime_m(traced, traced.end(now.from_m), traced.end(now.to_m), asked, paths, 50.0);
  CHECK(paths.size() == 4);  // one over each edge
  CHECK(until_m < 1.0);
  CHECK(until_m > 0.9);
}

TEST_CASE("a kerb beside a point of reflection at grazing: the point runs ten times as far as the ends move") {
  // From 1 m to 1 m above the ground, 20 m apart: the point is at x = 10, and the leg 5 cm high over a kerb of 2 cm at
  // x = 10.5. Where one end rises by d and the other falls, the point moves by 10 d towards the kerb: 3 cm are left.
  TriangleMesh mesh;
  add_sheet(mesh, Vec3(10, 0, 0), Vec3(100, 0, 0), Vec3(0, 100, 0), "metal");
  add_sheet(mesh, Vec3(10.5, 0, 0.01), Vec3(0, 50, 0), Vec3(0, 0, 0.01), "metal");
  TracedScene<> traced(scene_of(mesh));
  const Asked asked{0, 1, 0, 1};
  const Configuration now{traced.scene.frame_at(0.0), Vec3(0, 0, 1), Vec3(20, 0, 1)};
  const std::vector<Path> paths = paths_at(traced, now, asked);
  CHECK(paths.size() == 2);
  const double until_m = lifetime_m(traced, traced.end(now.from_m), traced.end(now.to_m), asked, paths, 50.0);
  CHECK(until_m <= 0.03);
  CHECK(until_m > 0.027);
}

TEST_CASE("a mirror that moves itself halves the distance, and less is left where it may turn") {
  Scene scene = scene_of_materials();
  TriangleMesh plate;
  add_sheet(plate, Vec3(0.0), Vec3(0, 2, 0), Vec3(0, 0, 2), "metal");
  scene.add_object("plate", plate, LinearMotion{{Vec3(0.0), 0, 0, 0}});
  TracedScene<> traced(std::move(scene));
  const Asked asked{0, 1, 0, 1};
  const Configuration now{traced.scene.frame_at(0.0), Vec3(3, 1, 0), Vec3(6, 1, 0)};
  const std::vector<Path> paths = paths_at(traced, now, asked);
  CHECK(paths.size() == 2);
  const double until_m = lifetime_m(traced, traced.end(now.from_m), traced.end(now.to_m), asked, paths, 50.0);
  CHECK(until_m <= 0.5);   // 1 m from the plate's edge: ends and plate move against each other
  CHECK(until_m > 0.125);  // turned by d/1.6 about its middle the plate throws the way 3 · 2 d/1.6 aside
}

}  // namespace test_lifetime
