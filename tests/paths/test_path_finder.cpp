/// A discovery proposes, the solver decides: the list of paths of one receiver.
#include "dcem/paths/path_finder.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

#include "dcem/paths/path_id.hpp"
#include "tests/paths/small_scenes.hpp"

namespace test_path_finder {

using namespace dcem;
using namespace dcem::test;

namespace {

using Ends = std::vector<std::optional<LinkEnd>>;

TriangleMesh office() {
  TriangleMesh mesh;
  add_box_faces(mesh, Vec3(0.0), Vec3(9, 6, 3), "opaque");
  add_sheet(mesh, Vec3(4, 3, 1.5), Vec3(0, 2.2, 0), Vec3(0, 0, 1.2), "glass");
  add_sheet(mesh, Vec3(6, 4, 1.5), Vec3(1.2, 0.4, 0), Vec3(0, 0, 1.1), "wall");
  return mesh;
}

std::vector<std::string> ids(const Scene& scene, const LinkPaths& link) {
  std::vector<std::string> all;
  for (const Path& path : link.paths) all.push_back(path_id(scene, path));
  return all;
}

}  // namespace

TEST_CASE("a closed room has 4N^2 + 2 paths of order N, sorted, none twice") {
  TriangleMesh mesh;
  add_box_faces(mesh, Vec3(0.0), Vec3(9, 6, 3), "opaque");
  TracedScene<> traced(scene_of(mesh));
  SearchCounters counters;
  const auto links = find_paths(traced.tracer, {true, 3, 0}, traced.end(Vec3(7.3, 4.1, 1.2)), {"ue", 0},
                                Ends{traced.end(Vec3(1.7, 2.3, 2.1))}, counters);
  const LinkPaths& link = links.at(0);
  CHECK(link.paths.size() == 1 + 6 + 18 + 38);
  CHECK(link.line_of_sight);
  CHECK(std::is_sorted(link.paths.begin(), link.paths.end(), reported_before));
  std::vector<std::string> names = ids(traced.scene, link);
  std::sort(names.begin(), names.end());
  CHECK(std::adjacent_find(names.begin(), names.end()) == names.end());
}

TEST_CASE("transmitters do not disturb each other, and an absent one has no paths") {
  TracedScene<> traced(scene_of(office()));
  SearchCounters counters;
  const LinkEnd receiver = traced.end(Vec3(7.3, 4.9, 1.2));
  const LinkEnd one = traced.end(Vec3(1.7, 2.3, 2.1)), two = traced.end(Vec3(8, 1, 1));
  for (const bool exhaustive : {true, false}) {
    const PathSearchSettings settings{exhaustive, 2, 2, 500};
    const auto find = [&](const Ends& ends) {
      return find_paths(traced.tracer, settings, receiver, {"ue", 0}, ends, counters);
    };
    const auto together = find({one, std::nullopt, two});
    REQUIRE(together.size() == 3);
    CHECK(together[1].paths.empty());
    CHECK_FALSE(together[1].line_of_sight);
    CHECK(ids(traced.scene, together[0]) == ids(traced.scene, find({one})[0]));
    CHECK(ids(traced.scene, together[2]) == ids(traced.scene, find({two})[0]));
    CHECK(together[0].paths.size() > 10);
    CHECK(find({}).empty());
  }
}

TEST_CASE("sampled paths are exhaustive paths with the same bits; rays do not grow with the transmitters") {
  TracedScene<> traced(scene_of(office()));
  const LinkEnd receiver = traced.end(Vec3(7.3, 4.9, 1.2)), one = traced.end(Vec3(1.7, 2.3, 2.1));
  SearchCounters exact_counters, few, many;
  const auto exact = find_paths(traced.tracer, {true, 2, 2}, receiver, {"ue", 0}, Ends{one}, exact_counters);
  const auto sampled = find_paths(traced.tracer, {false, 2, 2, 3000}, receiver, {"ue", 0}, Ends{one}, few);
  find_paths(traced.tracer, {false, 2, 2, 3000}, receiver, {"ue", 0}, Ends(20, one), many);
  CHECK(exact_counters.rays == 0);
  CHECK(few.rays > 3000);
  CHECK(few.rays == many.rays);
  CHECK(few.sequences_proposed == many.sequences_proposed);
  CHECK(many.solver.sequences_solved == 20 * few.solver.sequences_solved);
  CHECK(sampled[0].paths.size() > exact[0].paths.size() / 2);
  for (const Path& path : sampled[0].paths) {
    const auto twin = std::find_if(exact[0].paths.begin(), exact[0].paths.end(),
                                   [&](const Path& other) { return same_sequence(path, other); });
    REQUIRE(twin != exact[0].paths.end());
    CHECK(twin->length_m == path.length_m);
    for (std::size_t index = 0; index < path.interactions.size(); ++index) {
      CHECK(twin->interactions[index].point_m == path.interactions[index].point_m);
    }
  }
}

TEST_CASE("overlapping patches give one path, not one each") {
  TriangleMesh mesh;
  add_sheet(mesh, Vec3(0, 0, 0), Vec3(5, 0, 0), Vec3(0, 5, 0), "opaque");
  add_sheet(mesh, Vec3(0, 0, 0), Vec3(6, 0, 0), Vec3(0, 6, 0), "glass");
  add_sheet(mesh, Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(0, 7, 0), "metal");
  TracedScene<> traced(scene_of(mesh));
  SearchCounters counters;
  const auto links = find_paths(traced.tracer, {true, 2, 2}, traced.end(Vec3(1, 0, 1)), {"ue", 0},
                                Ends{traced.end(Vec3(-1, 0.5, 1)), traced.end(Vec3(-1, 0.5, -1))}, counters);
  CHECK(links[0].paths.size() == 2);  // direct, and one reflection
  CHECK(links[0].line_of_sight);
  CHECK(links[1].paths.empty());  // through the opaque one there is no way
  CHECK_FALSE(links[1].line_of_sight);
}

TEST_CASE("behind a sheet there is a direct path but no line of sight") {
  TriangleMesh mesh;
  add_sheet_across_x(mesh, 0.0, 5.0, "glass");
  TracedScene<> traced(scene_of(mesh));
  SearchCounters counters;
  const auto links = find_paths(traced.tracer, {true, 1, 1}, traced.end(Vec3(1, 0, 0.1)), {"ue", 0},
                                Ends{traced.end(Vec3(-1, 0.2, 0)), traced.end(Vec3(2, 0.2, 0))}, counters);
  REQUIRE(links[0].paths.size() == 1);
  CHECK(kinds(links[0].paths[0]) == "T");
  CHECK_FALSE(links[0].line_of_sight);
  CHECK(links[1].paths.size() == 2);
  CHECK(links[1].line_of_sight);
}

TEST_CASE("a line of sight is one even where a grazing reflection is no longer than it, to rounding") {
  // Heights of a millimetre, 10 to 90 km apart: the detour 2·h·h'/d is 1e-10 m and less, a rounding of the lengths.
  TriangleMesh mesh;
  add_sheet(mesh, Vec3(0.0), Vec3(1e5, 0, 0), Vec3(0, 1e5, 0), "glass");
  TracedScene<> traced(scene_of(mesh));
  Draw draw(3);
  int without = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    SearchCounters counters;
    const Ends transmitters{traced.end(Vec3(0, 0, draw.magnitude(1.1e-4, 1e-2)))};
    const LinkEnd receiver =
        traced.end(Vec3(draw.between(1e4, 9e4), draw.between(0, 1000), draw.magnitude(1.1e-4, 1e-2)));
    without += !find_paths(traced.tracer, {true, 1, 0}, receiver, {"ue", 0}, transmitters, counters)[0].line_of_sight;
  }
  CHECK(without == 0);
}

}  // namespace test_path_finder
