/// Two diffractions find the way over a flat roof and round a house along its walls: the leg between two edges of one
/// face lies on the face. The field over a roof has no step where an end rises through its plane.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "tests/support/law_scenes.hpp"

namespace test_along_faces {

using namespace dcem;
using namespace dcem::test;

namespace {

SimulationSettings two_edges(Discovery discovery = Discovery::exact) {
  SimulationSettings settings = law_settings(0, 0, discovery);
  settings.propagation.max_diffractions = 2;
  return settings;
}

/// Lengths of all paths over two edges between two points, ascending.
std::vector<double> lengths_over_two_edges(const Patches& patches, const Vec3& transmitter_m, const Vec3& receiver_m,
                                           Discovery discovery = Discovery::exact) {
  std::vector<double> lengths_m;
  for (const PathContribution& path :
       paths_between(scene_through_files(patches), transmitter_m, receiver_m, two_edges(discovery))) {
    if (kinds(path) == "DD") lengths_m.push_back(path.path.length_m);
  }
  std::sort(lengths_m.begin(), lengths_m.end());
  return lengths_m;
}

/// A roof in the plane z = 5 around a courtyard, with the walls inside and outside, in pieces that share their corners.
Patches house_with_courtyard() {
  const std::array<double, 4> cuts{-5, -2, 2, 5};
  Patches patches;
  const auto piece = [&](const Vec3& from, const Vec3& along, const Vec3& up) {
    patches.push_back({{from, from + along, from + along + up, from + up}, "pec"});
  };
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      const double x = cuts[i], y = cuts[j], width = cuts[i + 1] - x, depth = cuts[j + 1] - y;
      if (i != 1 || j != 1) piece(Vec3(x, y, 5), Vec3(width, 0, 0), Vec3(0, depth, 0));
    }
  for (std::size_t i = 0; i < 3; ++i) {
    const double from = cuts[i], length = cuts[i + 1] - from;
    for (const double at : {-5.0, 5.0}) {
      piece(Vec3(from, at, 0), Vec3(length, 0, 0), Vec3(0, 0, 5));
      piece(Vec3(at, from, 0), Vec3(0, length, 0), Vec3(0, 0, 5));
    }
  }
  for (const double at : {-2.0, 2.0}) {
    piece(Vec3(-2, at, 0), Vec3(4, 0, 0), Vec3(0, 0, 5));
    piece(Vec3(at, -2, 0), Vec3(0, 4, 0), Vec3(0, 0, 5));
  }
  return patches;
}

/// A car of metal 1.8 m wide along x, by its outline from the side: bonnet, windscreen, roof, rear window and boot.
Patches car() {
  const std::vector<Vec2> outline{{0, 0.2},    {0, 0.9},   {1, 0.9},   {1.7, 1.45},
                                  {3.2, 1.45}, {3.7, 1.0}, {4.5, 1.0}, {4.5, 0.2}};
  Patches patches;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vec2 from = outline[i], to = outline[(i + 1) % outline.size()];
    patches.push_back(
        {{Vec3(from.x, -0.9, from.y), Vec3(from.x, 0.9, from.y), Vec3(to.x, 0.9, to.y), Vec3(to.x, -0.9, to.y)},
         "pec"});
  }
  // The sides, in pieces that share their corners with the outline.
  for (const double y : {-0.9, 0.9}) {
    const auto piece = [&](const std::vector<std::size_t>& corners) {
      Patch patch{{}, "pec"};
      for (const std::size_t corner : corners) patch.corners_m.emplace_back(outline[corner].x, y, outline[corner].y);
      patches.push_back(patch);
    };
    piece({0, 1, 2});
    piece({0, 2, 5, 7});
    piece({2, 3, 4, 5});
    piece({5, 6, 7});
  }
  return patches;
}

/// A long house across the way, without floor: its roof is 10 m deep, at z = 0.
Scene long_house(const MaterialModel& model) {
  TriangleMesh mesh;
  for (const double x : {-5.0, 5.0}) {
    add_quad(mesh, {Vec3(x, -300, -200), Vec3(x, 300, -200), Vec3(x, 300, 0), Vec3(x, -300, 0)}, "wall");
  }
  add_quad(mesh, {Vec3(-5, -300, 0), Vec3(5, -300, 0), Vec3(5, 300, 0), Vec3(-5, 300, 0)}, "wall");
  Scene scene;
  scene.add_material({"wall", model});
  scene.set_scenery(mesh);
  return scene;
}

ComplexMatrix2 field_over(const MaterialModel& model, const Vec3& transmitter_m, const Vec3& receiver_m,
                          std::size_t* over_both = nullptr) {
  SimulationSettings settings = two_edges();
  settings.frequency_hz = 1e9;
  settings.itu.allow_extrapolation = true;
  ComplexMatrix2 sum;
  for (const PathContribution& path : paths_between(long_house(model), transmitter_m, receiver_m, settings)) {
    sum = sum + path.transfer;
    if (over_both != nullptr && kinds(path) == "DD") ++*over_both;
  }
  return sum;
}

const std::vector<MaterialModel>& faces() {
  static const std::vector<MaterialModel> all{PerfectConductor{}, ItuMaterial{"concrete", std::nullopt},
                                              ConstantReflection{0.8, std::nullopt}};
  return all;
}

}  // namespace

TEST_CASE("round a box there are four ways of two edges: along each face that leads from one end to the other") {
  const Patches house = box_faces(Vec3(-2, -4, 0), Vec3(2, 4, 5), "pec");
  const double over = 2.0 * std::hypot(7.0, 3.0) + 4.0, under = 2.0 * std::hypot(7.0, 2.0) + 4.0,
               round = 2.0 * std::hypot(7.0, 4.0) + 4.0;
  for (const Discovery discovery : {Discovery::exact, Discovery::sampled}) {
    const auto found = lengths_over_two_edges(house, Vec3(9, 0, 2), Vec3(-9, 0, 2), discovery);
    REQUIRE(found.size() == 4);
    CHECK(found[0] == doctest::Approx(under).epsilon(1e-12));
    CHECK(found[1] == doctest::Approx(over).epsilon(1e-12));
    CHECK(found[2] == doctest::Approx(round).epsilon(1e-12));
    CHECK(found[3] == doctest::Approx(round).epsilon(1e-12));
  }
}

TEST_CASE("a leg along a roof stays on the roof: none over a courtyard, and none through what stands on it") {
  const double over = 2.0 * std::hypot(7.0, 3.0) + 10.0;
  const auto ways = [&](const Patches& house, double y) {
    const auto found = lengths_over_two_edges(house, Vec3(12, y, 2), Vec3(-12, y, 2));
    return std::count_if(found.begin(), found.end(), [&](double length) { return std::abs(length - over) < 1e-9; });
  };
  CHECK(ways(house_with_courtyard(), 3.5) == 1);
  CHECK(ways(house_with_courtyard(), 0.5) == 0);
  Patches closed = box_faces(Vec3(-5, -5, 0), Vec3(5, 5, 5), "pec");
  CHECK(ways(closed, 0.5) == 1);
  Patches chimney = box_faces(Vec3(-1, 0, 5), Vec3(1, 1, 7), "pec");
  closed.insert(closed.end(), chimney.begin(), chimney.end());
  CHECK(ways(closed, 0.5) == 0);
  CHECK(ways(closed, 3.5) == 1);
}

TEST_CASE("the field behind a flat roof has no step where an end rises through the plane of the roof") {
  for (const MaterialModel& model : faces())
    for (const double aside : {0.0, 25.0}) {
      std::vector<ComplexMatrix2> field;
      std::size_t over_both = 0;
      for (int step = -10; step < 10; ++step) {
        field.push_back(field_over(model, Vec3(-40, 0, (step + 0.5) * 1e-3), Vec3(30, aside, -12), &over_both));
      }
      CHECK(over_both == field.size());
      for (const std::size_t row : {std::size_t{0}, std::size_t{1}})
        for (const std::size_t column : {std::size_t{0}, std::size_t{1}}) {
          std::vector<double> steps;
          for (std::size_t i = 0; i + 1 < field.size(); ++i)
            steps.push_back(std::abs(field[i + 1](row, column) - field[i](row, column)));
          const double across = steps[9];
          std::sort(steps.begin(), steps.end());
          CAPTURE(model.index());
          CAPTURE(aside);
          CAPTURE(row);
          CAPTURE(column);
          CHECK(across <= 2.0 * steps[9] + 1e-13);
        }
    }
}

TEST_CASE("over a car the ways lead along bonnet, roof and boot, from rim to rim") {
  const auto ways = [](const Vec3& transmitter_m, const Vec3& receiver_m, double length_m, Discovery discovery) {
    const auto found = lengths_over_two_edges(car(), transmitter_m, receiver_m, discovery);
    return std::count_if(found.begin(), found.end(), [&](double one_m) { return std::abs(one_m - length_m) < 1e-9; });
  };
  const auto way_m = [](const std::vector<Vec3>& points_m) {
    double length_m = 0.0;
    for (std::size_t i = 1; i < points_m.size(); ++i) length_m += glm::distance(points_m[i - 1], points_m[i]);
    return length_m;
  };
  const Vec3 ahead_m(-7, 0, 0.7), behind_m(12, 0, 0.6), beside_m(0.6, 6, 0.5), behind_beside_m(4.1, 6, 0.4);
  const double over_roof_m = way_m({ahead_m, Vec3(1.7, 0, 1.45), Vec3(3.2, 0, 1.45), behind_m});
  for (const Discovery discovery : {Discovery::exact, Discovery::sampled})
    CHECK(ways(ahead_m, behind_m, over_roof_m, discovery) == 1);
  // Across bonnet and boot, from one side to the other: in the plane through both ends, which is upright.
  const auto across_m = [&](const Vec3& from_m, double height_m) {
    return 2.0 * std::hypot(from_m.y - 0.9, height_m - from_m.z) + 1.8;
  };
  CHECK(ways(beside_m, Vec3(0.6, -6, 0.5), across_m(beside_m, 0.9), Discovery::exact) == 1);
  CHECK(ways(behind_beside_m, Vec3(4.1, -6, 0.4), across_m(behind_beside_m, 1.0), Discovery::exact) == 1);
}

TEST_CASE("the transfer over a roof is transposed when the ends are swapped") {
  for (const MaterialModel& model : faces()) {
    const Vec3 one_m(-40, 3, -5), other_m(30, -20, -12);
    const ComplexMatrix2 there = field_over(model, one_m, other_m),
                         back = transposed(field_over(model, other_m, one_m));
    CHECK(norm_squared(there) > 0.0);
    CHECK(norm_squared(there + Complex(-1.0) * back) <= 1e-22 * norm_squared(there));
  }
}

}  // namespace test_along_faces
