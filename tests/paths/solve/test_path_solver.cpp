/// A sequence of mirrors and two ends give one exact path, or none.
#include "dcem/paths/solve/path_solver.hpp"

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "tests/paths/small_scenes.hpp"

namespace test_path_solver {

using namespace dcem;
using namespace dcem::test;

namespace {

using Names = std::vector<std::string>;

struct Question {
  explicit Question(const TriangleMesh& mesh, int max_transmissions = 2)
      : traced(scene_of(mesh)), solver(traced.tracer, max_transmissions) {}
  explicit Question(Scene scene, int max_transmissions = 2)
      : traced(std::move(scene)), solver(traced.tracer, max_transmissions) {}

  std::optional<Path> solve(const LinkEnd& transmitter, const LinkEnd& receiver, const Sequence& mirrors) {
    std::vector<Vec3> images_m{receiver.position_m};
    for (const SequenceElement element : mirrors) {
      append_image(images_m, traced.scene.facet(element.mirror()).plane);
    }
    return solver.solve(transmitter, receiver, mirrors, images_m);
  }
  std::optional<Path> solve(const Vec3& transmitter_m, const Vec3& receiver_m, const Sequence& mirrors) {
    return solve(traced.end(transmitter_m), traced.end(receiver_m), mirrors);
  }
  Names materials(const Path& path) const {
    Names names;
    for (const Interaction& i : path.interactions) {
      names.push_back(traced.scene.material(traced.scene.facet(i.facet).material).name);
    }
    return names;
  }

  TracedScene<> traced;
  PathSolver<WideIndex> solver;
};

/// A floor at z = 0, a glass sheet across the leg that comes down and a wall sheet across the one that goes up.
TriangleMesh floor_and_sheets() {
  TriangleMesh mesh;
  add_sheet(mesh, Vec3(0, 0, 0), Vec3(20, 0, 0), Vec3(0, 20, 0), "opaque");
  add_sheet(mesh, Vec3(-2, 0, 2), Vec3(0, 3, 0), Vec3(0, 0, 1.9), "glass");
  add_sheet(mesh, Vec3(2, 0, 2), Vec3(0, 3, 0), Vec3(0, 0, 1.9), "wall");
  return mesh;
}

}  // namespace

TEST_CASE("interactions stand in the order in which the wave meets them, with their points") {
  Question question(floor_and_sheets());
  const FacetId floor = question.traced.facet_at(Vec3(-15, 5, 0), "opaque");
  const auto path = question.solve(Vec3(-4, 0.2, 2), Vec3(4, 0.2, 2), {floor});
  REQUIRE(path.has_value());
  CHECK(kinds(*path) == "TRT");
  CHECK(question.materials(*path) == Names{"glass", "opaque", "wall"});
  const std::vector<Vec3> expected_m{{-2, 0.2, 1}, {0, 0.2, 0}, {2, 0.2, 1}};
  for (std::size_t index = 0; index < 3; ++index) {
    CHECK(glm::distance(path->interactions[index].point_m, expected_m[index]) < 1e-14);  // a few roundings of 4
  }
  CHECK(path->length_m == doctest::Approx(2.0 * std::sqrt(20.0)).epsilon(1e-15));
}

TEST_CASE("transmissions are bounded over the whole path, not leg by leg") {
  for (int limit = 0; limit <= 3; ++limit) {
    Question question(floor_and_sheets(), limit);
    const FacetId floor = question.traced.facet_at(Vec3(-15, 5, 0), "opaque");
    const Vec3 transmitter_m(-4, 0.2, 2), receiver_m(4, 0.2, 2);
    CHECK(question.solve(transmitter_m, receiver_m, {floor}).has_value() == (limit >= 2));
    CHECK(question.solve(transmitter_m, receiver_m, {}).has_value() == (limit >= 2));
    CHECK(question.solve(transmitter_m, Vec3(1, 0.2, 0.4), {floor}).has_value() == (limit >= 1));
    CHECK(question.solve(transmitter_m, Vec3(-3, 0.2, 1), {floor}).has_value());
  }
}

TEST_CASE("a sheet that reflects is not crossed by the same path, and reflects on both faces") {
  TriangleMesh mesh;
  add_sheet_across_x(mesh, 0.0, 5.0, "glass");
  Question question(mesh);
  const FacetId glass = question.traced.facet_at(Vec3(0, 1, 1), "glass");
  for (const double side : {1.0, -1.0}) {
    const auto path = question.solve(Vec3(side, 0.3, 0.1), Vec3(2 * side, 1, 0.4), {glass});
    REQUIRE(path.has_value());
    CHECK(kinds(*path) == "R");
  }
  CHECK_FALSE(question.solve(Vec3(1, 0.3, 0.1), Vec3(-2, 1, 0.4), {glass}).has_value());
  const auto through = question.solve(Vec3(1, 0.3, 0.1), Vec3(-2, 1, 0.4), {});
  REQUIRE(through.has_value());
  CHECK(kinds(*through) == "T");
}

TEST_CASE("where facets overlap in one plane every proposal leads to the same path") {
  TriangleMesh mesh;
  add_sheet_across_x(mesh, 0.0, 5.0, "wall");
  add_sheet_across_x(mesh, 0.0, 6.0, "glass");
  add_sheet_across_x(mesh, 0.0, 7.0, "alpha");
  Question question(mesh);
  const Vec3 transmitter_m(1, 0.3, 0.1), receiver_m(2, 1, 0.4);
  for (const std::string name : {"wall", "glass", "alpha"}) {
    const FacetId id = question.traced.facet_at(Vec3(0, 1, 1), name);
    const auto path = question.solve(transmitter_m, receiver_m, {id});
    REQUIRE(path.has_value());
    CHECK(question.materials(*path) == Names{"alpha"});
    CHECK(kinds(*path) == "R");
  }
  // Where only two of them are, the first of the two stands for both; where one is, it stands for itself.
  const Vec3 up(0, 5.5, 0), further(0, 6.5, 0);
  const FacetId alpha = question.traced.facet_at(Vec3(0, 1, 1), "alpha"),
                glass = question.traced.facet_at(Vec3(0, 1, 1), "glass"),
                wall = question.traced.facet_at(Vec3(0, 1, 1), "wall");
  CHECK(question.solve(Vec3(1, 0, 0) + up, Vec3(2, 0.1, 0) + up, {glass}).has_value());
  CHECK_FALSE(question.solve(Vec3(1, 0, 0) + up, Vec3(2, 0.1, 0) + up, {wall}).has_value());
  CHECK(question.solve(Vec3(1, 0, 0) + further, Vec3(2, 0.1, 0) + further, {alpha}).has_value());
}

TEST_CASE("overlapping mirrors in a corner: all four proposals lead to one path of order two") {
  TriangleMesh mesh;
  add_sheet(mesh, Vec3(0, 0, 0), Vec3(5, 0, 0), Vec3(0, 5, 0), "opaque");
  add_sheet(mesh, Vec3(0, 0, 0), Vec3(6, 0, 0), Vec3(0, 6, 0), "glass");
  add_sheet_across_x(mesh, 4.0, 4.0, "wall");
  add_sheet_across_x(mesh, 4.0, 4.5, "metal");
  Question question(mesh);
  const FacetId floors[] = {question.traced.facet_at(Vec3(1, 2, 0), "opaque"),
                            question.traced.facet_at(Vec3(1, 2, 0), "glass")};
  const FacetId walls[] = {question.traced.facet_at(Vec3(4, 2, 1), "wall"),
                           question.traced.facet_at(Vec3(4, 2, 1), "metal")};
  int solved = 0;
  for (const FacetId floor : floors) {
    for (const FacetId wall : walls) {
      const auto path = question.solve(Vec3(0, 0, 1), Vec3(1, 0.5, 3), {wall, floor});
      REQUIRE(path.has_value());
      CHECK(question.materials(*path) == Names{"glass", "metal"});
      ++solved;
    }
  }
  CHECK(solved == 4);
}

TEST_CASE("two facets of different materials side by side: on the seam one path, by name") {
  TriangleMesh mesh;
  add_sheet(mesh, Vec3(-2, 0, 0), Vec3(2, 0, 0), Vec3(0, 2, 0), "metal");
  add_sheet(mesh, Vec3(2, 0, 0), Vec3(2, 0, 0), Vec3(0, 2, 0), "opaque");
  Question question(mesh);
  for (const std::string name : {"metal", "opaque"}) {
    const FacetId id = question.traced.facet_at(Vec3(name == "metal" ? -1 : 1, 0.5, 0), name);
    const auto path = question.solve(Vec3(-1, 0.3, 1), Vec3(1, 0.3, 1), {id});
    REQUIRE(path.has_value());
    CHECK(question.materials(*path) == Names{"metal"});
  }
}

TEST_CASE("a device mounted on a facet neither hears it reflect nor is blocked by it") {
  TriangleMesh mesh;
  add_sheet(mesh, Vec3(0, 0, 0), Vec3(20, 0, 0), Vec3(0, 20, 0), "metal");
  add_sheet(mesh, Vec3(0, 0, 3), Vec3(20, 0, 0), Vec3(0, 20, 0), "opaque");
  Question question(mesh);
  const FacetId floor = question.traced.facet_at(Vec3(5, 2, 0), "metal"),
                ceiling = question.traced.facet_at(Vec3(5, 2, 3), "opaque");
  const Vec3 high(4, 0, 2);
  for (const double height_m : {0.0, 0.5e-4, -0.5e-4}) {
    const Vec3 low(0, 0, height_m);
    CHECK(question.solve(low, high, {}).has_value());
    CHECK(question.solve(high, low, {}).has_value());
    CHECK_FALSE(question.solve(low, high, {floor}).has_value());
    CHECK_FALSE(question.solve(high, low, {floor}).has_value());
    CHECK(question.solve(low, high, {ceiling}).has_value());
    // Its floor may still reflect further on, between two other legs: down from the ceiling and up again.
    CHECK(question.solve(low, high, {floor, ceiling}).has_value());
  }
  CHECK(question.solve(Vec3(0, 0, 2e-4), high, {floor}).has_value());
}

TEST_CASE("ends in one place have no direct path, but may see themselves in a mirror") {
  TriangleMesh mesh;
  add_sheet_across_x(mesh, 0.0, 5.0, "metal");
  Question question(mesh);
  const Vec3 here(3, 0.5, 0.25);
  CHECK_FALSE(question.solve(here, here, {}).has_value());
  CHECK_FALSE(question.solve(here, here + Vec3(5e-10, 0, 0), {}).has_value());
  const auto path = question.solve(here, here, {question.traced.facet_at(Vec3(0, 1, 1), "metal")});
  REQUIRE(path.has_value());
  CHECK(path->length_m == 6.0);
  CHECK(path->interactions[0].point_m == Vec3(0, 0.5, 0.25));
}

TEST_CASE("a facet that is absent, or belongs to the body of either end, is no mirror") {
  Scene scene = scene_of_materials();
  const BodyId plate = scene.add_object("plate", make_box(Vec3(8, 8, 1), "metal"), {});
  Question question(std::move(scene));
  const FacetId top = question.traced.facet_at(Vec3(1, 2, 1), "metal");
  const Vec3 one(-1, 0, 2), other(1, 0, 2);
  auto& traced = question.traced;
  CHECK(question.solve(traced.end(one), traced.end(other), {top}).has_value());
  CHECK_FALSE(question.solve(traced.end(one, plate), traced.end(other), {top}).has_value());
  CHECK_FALSE(question.solve(traced.end(one), traced.end(other, plate), {top}).has_value());
  Frame frame = traced.scene.frame_at(0.0);
  frame.bodies[1].present = false;
  traced.apply(frame);
  CHECK_FALSE(question.solve(traced.end(one), traced.end(other), {top}).has_value());
}

TEST_CASE("reversed ends see the reversed path") {
  Draw draw(3);
  TriangleMesh mesh;
  add_box_faces(mesh, Vec3(0.0), Vec3(6, 5, 3), "opaque");
  for (int sheet = 0; sheet < 4; ++sheet) {
    const Vec3 u = draw.direction(), v = glm::normalize(glm::cross(u, draw.direction()));
    add_sheet(mesh, draw.inside(Vec3(1, 1, 0.5), Vec3(5, 4, 2.5)), 0.8 * u, 0.8 * v, sheet % 2 == 0 ? "glass" : "wall");
  }
  Question question(mesh);
  int found = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const Vec3 one_m = draw.inside(Vec3(0.2), Vec3(5.8, 4.8, 2.8)),
               other_m = draw.inside(Vec3(0.2), Vec3(5.8, 4.8, 2.8));
    const std::size_t facets = question.traced.scene.facets().size();
    const Sequence forth{FacetId(draw.below(facets)), FacetId(draw.below(facets))};
    if (forth[0] == forth[1]) continue;
    const auto there = question.solve(one_m, other_m, forth),
               back = question.solve(other_m, one_m, {forth[1], forth[0]});
    REQUIRE(there.has_value() == back.has_value());
    if (!there) continue;
    ++found;
    REQUIRE(there->interactions.size() == back->interactions.size());
    CHECK(there->length_m == doctest::Approx(back->length_m).epsilon(1e-14));
    for (std::size_t index = 0; index < there->interactions.size(); ++index) {
      const Interaction &a = there->interactions[index], &b = back->interactions[back->interactions.size() - 1 - index];
      CHECK(a.kind == b.kind);
      CHECK(a.facet == b.facet);
      CHECK(glm::distance(a.point_m, b.point_m) < 1e-9);  // a rounding of 1e-15, at grazing incidence magnified
    }
  }
  CHECK(found > 200);
}

TEST_CASE("what was done is counted") {
  Question question(floor_and_sheets());
  const FacetId floor = question.traced.facet_at(Vec3(-15, 5, 0), "opaque");
  question.solve(Vec3(-4, 0.2, 2), Vec3(4, 0.2, 2), {floor});
  question.solve(Vec3(-4, 0.2, 2), Vec3(4, 0.2, 2), {});
  question.solve(Vec3(-4, 0.2, 2), Vec3(4, 0.2, -2), {floor});  // the wrong side: no leg is walked
  CHECK(question.solver.counters().sequences_solved == 3);
  CHECK(question.solver.counters().legs == 3);
  CHECK(question.solver.counters().traversal.primitives_tested > 0);
}

TEST_CASE("an end in the plane of a face, beyond the face, is at grazing: there is no diffracted path to it") {
  TriangleMesh mesh;
  add_box_faces(mesh, Vec3(-2, -2, -2), Vec3(2, 2, 2), "metal");
  Question question(mesh);
  std::optional<WedgeId> edge;
  for (std::size_t index = 0; index < question.traced.scene.wedges().size(); ++index) {
    const Wedge& held = question.traced.scene.wedge(WedgeId(index)).edge;
    const bool along_y = held.start_m.x == 2.0 && held.end_m.x == 2.0 && held.start_m.z == 2.0 && held.end_m.z == 2.0;
    if (along_y) edge = WedgeId(index);
  }
  REQUIRE(edge.has_value());
  // Over the top face and 8 m further. A nanometre is the guard by which a point is off a plane (geometry/plane.hpp).
  const auto is_there = [&](double height_m) {
    const LinkEnd from = question.traced.end(Vec3(6, 0, 0));
    const LinkEnd to = question.traced.end(Vec3(-10, 0, 2.0 + height_m));
    return question.solver.solve(from, to, Sequence{*edge}).has_value();
  };
  CHECK(is_there(1e-3));
  CHECK(is_there(1e-7));
  CHECK_FALSE(is_there(1e-10));
  CHECK_FALSE(is_there(0.0));
}

}  // namespace test_path_solver
