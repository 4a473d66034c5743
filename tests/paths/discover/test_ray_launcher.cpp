/// Rays leave in all directions alike, turned by nothing but seed, receiver and frame, and propose what they meet.
#include "dcem/paths/discover/ray_launcher.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <span>
#include <tuple>
#include <vector>

#include "dcem/paths/discover/exact_search.hpp"
#include "tests/paths/small_scenes.hpp"

namespace test_ray_launcher {

using namespace dcem;
using namespace dcem::test;

namespace {

struct Proposed {
  std::set<Sequence> sequences;
  int repeated = 0;
  std::uint64_t rays = 0;
};

Proposed launch(TracedScene<>& traced, const LinkEnd& receiver, const LaunchSettings& settings,
                const Mat3& rotation = Mat3(1.0)) {
  Proposed proposed;
  RayLauncher<WideIndex> launcher(traced.tracer, settings);
  launcher.for_each_sequence(receiver, rotation, [&](const Sequence& sequence, const std::vector<Vec3>& images_m) {
    proposed.repeated += !proposed.sequences.insert(sequence).second;
    std::vector<Vec3> expected_m{receiver.position_m};
    for (const SequenceElement element : sequence) {
      append_image(expected_m, traced.scene.facet(element.mirror()).plane);
    }
    CHECK(images_m == expected_m);  // the same function, hence the same bits as in the exact search
  });
  proposed.rays = launcher.rays();
  return proposed;
}

std::size_t longest(const Proposed& proposed) {
  std::size_t length = 0;
  for (const Sequence& sequence : proposed.sequences) length = std::max(length, sequence.size());
  return length;
}

}  // namespace

TEST_CASE("the sphere of rays has no preferred direction") {
  for (const std::uint32_t count : {1U, 2U, 10U, 2000U, 100'000U}) {
    Vec3 sum(0.0);
    for (std::uint32_t index = 0; index < count; ++index) {
      const Vec3 direction = fibonacci_direction(index, count);
      CHECK(std::abs(glm::length(direction) - 1.0) < 1e-15 * 4);  // the rounding of three squares and a root
      sum += direction;
    }
    // Heights are symmetric about 0. Across, summation by parts bounds the sum: the partial sums of exp(jiα) are at
    // most 1/sin(α/2) = 1.073 for α = π(3 - √5), and the radii rise to 1 and fall again: 2·1.073. Rounding: 1e-15 each.
    CHECK(std::abs(sum.z) < 1e-15 * count);
    CHECK(std::hypot(sum.x, sum.y) < 2.15 + 1e-11 * count);
  }
}

TEST_CASE("equal parts of the sphere get equal numbers of rays") {
  // Equal-area bands by construction hold count/8 rays; an octant's share varies with its border, a few times √count.
  const std::uint32_t count = 8000;
  std::array<int, 8> octants{};
  for (std::uint32_t index = 0; index < count; ++index) {
    const Vec3 d = fibonacci_direction(index, count);
    ++octants[static_cast<std::size_t>((d.x > 0.0) + 2 * (d.y > 0.0) + 4 * (d.z > 0.0))];
  }
  for (const int rays : octants) CHECK(std::abs(rays - 1000) < 30);
}

TEST_CASE("the directions of a launch are those of the sphere, each once, neighbours together") {
  const auto less = [](const Vec3& one, const Vec3& other) {
    return std::tie(one.z, one.x, one.y) < std::tie(other.z, other.x, other.y);
  };
  for (const std::uint32_t count : {0U, 1U, 200U, 5000U, 200U}) {
    const std::span<const Vec3> launched = launch_directions(count);
    std::vector<Vec3> sorted(launched.begin(), launched.end()), expected;
    for (std::uint32_t index = 0; index < count; ++index) expected.push_back(fibonacci_direction(index, count));
    std::ranges::sort(sorted, less);
    std::ranges::sort(expected, less);
    CHECK(sorted == expected);
    if (count < 2) continue;
    double turn = 0.0;
    for (std::size_t at = 1; at < launched.size(); ++at) turn += glm::distance(launched[at - 1], launched[at]);
    // Neighbours are about 3.5 / √count apart, and a Morton order goes about twice as far; points drawn at random 1.33.
    CHECK(turn / count < 8.0 / std::sqrt(count));
  }
}

TEST_CASE("the launch rotation is a rotation, and each of seed, receiver and frame turns it") {
  const auto same = [](const Mat3& a, const Mat3& b) { return a[0] == b[0] && a[1] == b[1] && a[2] == b[2]; };
  const Mat3 one = launch_rotation(1, "ue", 5);
  CHECK(same(one, launch_rotation(1, "ue", 5)));
  CHECK_FALSE(same(one, launch_rotation(2, "ue", 5)));
  CHECK_FALSE(same(one, launch_rotation(1, "uf", 5)));
  CHECK_FALSE(same(one, launch_rotation(1, "ue", 6)));
  for (int column = 0; column < 3; ++column) {
    for (int other = 0; other < 3; ++other) {
      CHECK(glm::dot(one[column], one[other]) == doctest::Approx(column == other ? 1.0 : 0.0).epsilon(1e-14));
    }
  }
  CHECK(glm::dot(glm::cross(one[0], one[1]), one[2]) == doctest::Approx(1.0).epsilon(1e-14));
}

TEST_CASE("rotations are drawn uniformly from all rotations") {
  // For the uniform measure on SO(3) every entry has mean 0 and mean square 1/3 (it is a coordinate of a point on the
  // sphere), and the trace has mean 0, mean square 1 and fourth moment 3 (characters). Five standard errors each.
  const int draws = 20'000;
  Mat3 mean(0.0), mean_square(0.0);
  double trace = 0.0, trace_square = 0.0;
  for (int frame = 0; frame < draws; ++frame) {
    const Mat3 r = launch_rotation(11, "receiver", static_cast<std::size_t>(frame));
    for (int c = 0; c < 3; ++c) {
      mean[c] += r[c] / double(draws);
      mean_square[c] += r[c] * r[c] / double(draws);
    }
    trace += (r[0][0] + r[1][1] + r[2][2]) / draws;
    trace_square += std::pow(r[0][0] + r[1][1] + r[2][2], 2) / draws;
  }
  const double root = std::sqrt(static_cast<double>(draws));
  for (int c = 0; c < 3; ++c) {
    for (int row = 0; row < 3; ++row) {
      CHECK(std::abs(mean[c][row]) < 5.0 * std::sqrt(1.0 / 3.0) / root);
      CHECK(std::abs(mean_square[c][row] - 1.0 / 3.0) < 5.0 * std::sqrt(4.0 / 45.0) / root);
    }
  }
  CHECK(std::abs(trace) < 5.0 / root);
  CHECK(std::abs(trace_square - 1.0) < 5.0 * std::sqrt(2.0) / root);
}

TEST_CASE("in a closed room every ray makes as many legs as there are reflections") {
  TriangleMesh mesh;
  add_box_faces(mesh, Vec3(0.0), Vec3(4, 5, 3), "opaque");
  TracedScene<> traced(scene_of(mesh));
  const LinkEnd receiver = traced.end(Vec3(1.1, 2.3, 1.7));
  for (const int order : {1, 2, 5}) {
    const Proposed proposed = launch(traced, receiver, {500, order, 0}, launch_rotation(1, "a", 0));
    CHECK(proposed.rays == 500U * static_cast<unsigned>(order));
    CHECK(proposed.repeated == 0);
    CHECK(longest(proposed) == static_cast<std::size_t>(order));
    CHECK(proposed.sequences.count(Sequence{}) == 1);
  }
}

TEST_CASE("rays propose only what the exhaustive search visits, and many rays propose all first reflections") {
  TriangleMesh mesh;
  add_box_faces(mesh, Vec3(0.0), Vec3(4, 5, 3), "opaque");
  add_sheet(mesh, Vec3(2, 2, 1.5), Vec3(0.5, 0.2, 0), Vec3(0, 0.1, 0.6), "glass");
  TracedScene<> traced(scene_of(mesh));
  const LinkEnd receiver = traced.end(Vec3(1.1, 3.3, 1.7));
  std::set<Sequence> visited;
  ExactSearch(traced.scene, 3).for_each_sequence(receiver, [&](const Sequence& s, const auto&) { visited.insert(s); });
  const Proposed proposed = launch(traced, receiver, {4000, 3, 2}, launch_rotation(1, "a", 0));
  for (const Sequence& sequence : proposed.sequences) CHECK(visited.count(sequence) == 1);
  for (std::size_t facet = 0; facet < traced.scene.facets().size(); ++facet) {
    CHECK(proposed.sequences.count(Sequence{FacetId(facet)}) == 1);
  }
  CHECK(proposed.sequences.size() > 50);
}

TEST_CASE("a sheet reflects a ray and lets it pass, as often as crossings are allowed") {
  TriangleMesh mesh;
  for (const double x : {1.0, 2.0, 3.0}) add_sheet_across_x(mesh, x, 1000.0, "glass");
  add_sheet_across_x(mesh, 4.0, 2000.0, "opaque");
  TracedScene<> traced(scene_of(mesh));
  const LinkEnd receiver = traced.end(Vec3(0.0, 0.3, 0.2));
  const auto at = [&](double x) { return traced.facet_at(Vec3(x, 5, 1), x == 4.0 ? "opaque" : "glass"); };
  for (int crossings = 0; crossings <= 3; ++crossings) {
    const Proposed proposed = launch(traced, receiver, {200, 1, crossings});
    for (int sheet = 0; sheet < 4; ++sheet) {
      const bool reached = sheet <= crossings;
      CHECK(proposed.sequences.count(Sequence{at(1.0 + sheet)}) == (reached ? 1U : 0U));
    }
    // Every ray towards +x meets all the sheets but the few that pass their far rims; each crossing is one more ray.
    std::uint64_t forward = 0;
    for (std::uint32_t index = 0; index < 200; ++index) forward += fibonacci_direction(index, 200).x > 0.01;
    CHECK(proposed.rays >= 200U + forward * static_cast<unsigned>(crossings));
    CHECK(proposed.rays <= 200U + (forward + 4) * static_cast<unsigned>(crossings));
  }
}

TEST_CASE("a reflected ray uses up the crossings of the ray it came from") {
  // Receiver between a sheet (x = 1) and a mirror (x = -1); behind the sheet a wall (x = 2). With one crossing, the
  // wall is reached once: straight, or after the mirror, but not again after it has been crossed back.
  TriangleMesh mesh;
  add_sheet_across_x(mesh, 1.0, 1000.0, "glass");
  add_sheet_across_x(mesh, -1.0, 1000.0, "opaque");
  add_sheet_across_x(mesh, 2.0, 1000.0, "opaque");
  TracedScene<> traced(scene_of(mesh));
  const FacetId sheet = traced.facet_at(Vec3(1, 5, 1), "glass"), mirror = traced.facet_at(Vec3(-1, 5, 1), "opaque"),
                wall = traced.facet_at(Vec3(2, 5, 1), "opaque");
  const auto proposes = [&](int crossings, const Sequence& sequence) {
    return launch(traced, traced.end(Vec3(0.0)), {200, 3, crossings}).sequences.count(sequence) == 1;
  };
  CHECK(proposes(1, {wall}));
  CHECK(proposes(1, {mirror, wall}));
  CHECK(proposes(1, {wall, sheet}));         // back at the sheet's far face
  CHECK_FALSE(proposes(1, {wall, mirror}));  // that would be the second crossing
  CHECK(proposes(2, {wall, mirror}));
  CHECK_FALSE(proposes(2, {wall, mirror, wall}));
  CHECK(proposes(3, {wall, mirror, wall}));
  CHECK_FALSE(proposes(0, {wall}));
}

TEST_CASE("without reflections only the direct path is proposed and no ray is shot") {
  TriangleMesh mesh;
  add_sheet_across_x(mesh, 1.0, 1.0, "glass");
  TracedScene<> traced(scene_of(mesh));
  const Proposed proposed = launch(traced, traced.end(Vec3(0.0)), {200, 0, 2});
  CHECK(proposed.sequences == std::set<Sequence>{{}});
  CHECK(proposed.rays == 0);
}

TEST_CASE("the body that the receiver rides on and the wall it is mounted on are not in the way") {
  Scene scene = scene_of_materials();
  TriangleMesh mesh;
  add_sheet_across_x(mesh, 0.0, 1000.0, "opaque");
  add_sheet_across_x(mesh, 10.0, 1000.0, "metal");
  scene.set_scenery(mesh);
  const BodyId car =
      scene.add_object("car", make_box(Vec3(2, 2, 2), "metal"), LinearMotion{{Vec3(5, 0, -1)}, Vec3(0.0), 0});
  TracedScene<> traced(std::move(scene));
  const FacetId own = traced.facet_at(Vec3(0, 5, 1), "opaque"), far = traced.facet_at(Vec3(10, 5, 1), "metal");
  const Proposed on_wall = launch(traced, traced.end(Vec3(0, 0, 0)), {200, 1, 0});
  CHECK(on_wall.sequences.count(Sequence{own}) == 0);
  CHECK(on_wall.sequences.count(Sequence{far}) == 1);
  const Proposed in_car = launch(traced, traced.end(Vec3(5, 0, 0), car), {200, 1, 0});
  CHECK(in_car.sequences == std::set<Sequence>{{}, {own}, {far}});
  const Proposed locked_in = launch(traced, traced.end(Vec3(5, 0, 0)), {200, 1, 0});
  CHECK(locked_in.sequences.size() == 7);  // its six faces hide the walls
  CHECK(locked_in.sequences.count(Sequence{own}) == 0);
}

}  // namespace test_ray_launcher
