/// Which edges diffract, and where: not where another facet touches, not on the inner side, not next to a mirror in
/// whose plane they lie.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/support/law_scenes.hpp"

namespace test_edge_contact {

using namespace dcem;
using namespace dcem::test;

namespace {

constexpr Discovery both_discoveries[]{Discovery::exact, Discovery::sampled};

SimulationSettings edge_settings(int reflections, int transmissions, Discovery discovery = Discovery::exact) {
  SimulationSettings settings = law_settings(reflections, transmissions, discovery);
  settings.propagation.max_diffractions = 1;
  return settings;
}

Patches operator+(Patches one, const Patches& other) {
  one.insert(one.end(), other.begin(), other.end());
  return one;
}

Patch ground() {
  return sheet(Vec3(0, 0, 0), Vec3(60, 0, 0), Vec3(0, 60, 0), "half_space");
}

Patches without(Patches faces, std::size_t index) {
  faces.erase(faces.begin() + static_cast<std::ptrdiff_t>(index));
  return faces;
}

/// The points of all diffractions of all paths whose kinds are these, or of all where none are given.
std::vector<Vec3> edge_points_m(const std::vector<PathContribution>& paths, const std::string& letters = "") {
  std::vector<Vec3> points_m;
  for (const PathContribution& path : paths) {
    if (!letters.empty() && kinds(path) != letters) continue;
    for (const Interaction& one : path.path.interactions) {
      if (one.kind == InteractionKind::diffraction) points_m.push_back(one.point_m);
    }
  }
  return points_m;
}

std::size_t count_at(const std::vector<Vec3>& points_m, int axis, double level_m) {
  return static_cast<std::size_t>(std::count_if(points_m.begin(), points_m.end(),
                                                [&](const Vec3& p) { return std::abs(p[axis] - level_m) < 1e-3; }));
}

std::vector<Vec3> edge_points_between(const Patches& patches, const Vec3& transmitter_m, const Vec3& receiver_m,
                                      const SimulationSettings& settings, const std::string& letters = "") {
  return edge_points_m(paths_between(scene_through_files(patches), transmitter_m, receiver_m, settings), letters);
}

/// All rigid poses in which a law is tried.
std::vector<Mat3> turns() {
  std::vector<Mat3> result{Mat3(1.0)};
  Dice dice(18);
  for (int index = 0; index < 6; ++index) result.push_back(rotation_about(dice.direction(), dice.between(-pi, pi)));
  return result;
}

}  // namespace

TEST_CASE("the foot of a box on the ground does not diffract, with or without a floor; that of a box in the air does") {
  const Vec3 transmitter_m(9, -2, 1.5), receiver_m(8, 3, 2.5);
  const Vec3 low(-2, -4, 0), high(2, 4, 5);
  for (const Mat3& turn : turns()) {
    const auto map = [&](const Vec3& p) { return turn * p; };
    const auto heights = [&](const Patches& patches) {
      std::vector<Vec3> points_m =
          edge_points_between(mapped(patches, map), map(transmitter_m), map(receiver_m), edge_settings(0, 0));
      for (Vec3& p : points_m) p = glm::transpose(turn) * p;
      return points_m;
    };
    const Patches box = box_faces(low, high, "pec");
    CHECK(count_at(heights(Patches{ground()} + box), 2, 0.0) == 0);
    CHECK(count_at(heights(Patches{ground()} + without(box, 4)), 2, 0.0) == 0);
    // Rounded coordinates: a tenth of the tolerance off the ground, above or below.
    for (const double gap_m : {1e-5, -1e-5}) {
      const Patches near = mapped(box, [&](const Vec3& p) { return p + Vec3(0, 0, gap_m); });
      CHECK(count_at(heights(Patches{ground()} + near), 2, 0.0) == 0);
    }
    const Patches high_up = mapped(box, [](const Vec3& p) { return p + Vec3(0, 0, 0.4); });
    CHECK(count_at(heights(Patches{ground()} + high_up), 2, 0.4) == 1);
    CHECK(count_at(heights(box), 2, 0.0) == 1);
    CHECK(count_at(heights(box), 2, 5.0) == 1);
  }
}

TEST_CASE("the roof edge shared with an adjoining house of the same height does not diffract") {
  // House a from x = −10 to 0; house b from 0 to 10, as deep or deeper, of the same material or another.
  const Patches a = box_faces(Vec3(-10, -5, 0), Vec3(0, 5, 8), "opaque");
  const Vec3 transmitter_m(-7, 1, 14), receiver_m(8, -1, 13);
  for (const std::string material : {"opaque", "alpha"}) {
    for (const double depth_m : {5.0, 6.5}) {
      for (const bool party_walls : {true, false}) {
        CAPTURE(material);
        CAPTURE(depth_m);
        CAPTURE(party_walls);
        const Patches b = box_faces(Vec3(0, -depth_m, 0), Vec3(10, depth_m, 8), material);
        const Patches both = Patches{ground()} + (party_walls ? a : without(a, 1)) + (party_walls ? b : without(b, 0));
        const auto points_m = edge_points_between(both, transmitter_m, receiver_m, edge_settings(0, 0));
        CHECK(count_at(points_m, 0, 0.0) == 0);
        CHECK(points_m.size() >= 2);  // the outer roof edges do
      }
    }
    const Patches lower = box_faces(Vec3(0, -5, 0), Vec3(10, 5, 6), material);
    const auto points_m =
        edge_points_between(Patches{ground()} + a + lower, transmitter_m, receiver_m, edge_settings(0, 0));
    CHECK(count_at(points_m, 0, 0.0) == 1);
  }
}

TEST_CASE("diagonals and seams do not diffract, however a wall is cut") {
  Patches tiles, two_materials;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 3; ++j) {
      const Patch tile = sheet(Vec3(2 * i - 3, 0, 2 * j + 1), Vec3(1, 0, 0), Vec3(0, 0, 1), "opaque");
      tiles.push_back(tile);
      two_materials.push_back(tile);
      if ((i + j) % 2 == 0) two_materials.back().material = "alpha";
    }
  }
  const Patches whole{sheet(Vec3(0, 0, 3), Vec3(4, 0, 0), Vec3(0, 0, 3), "opaque")};
  SimulationSettings settings = edge_settings(0, 0);
  const Vec3 transmitter_m(0.4, 7, 2.7), receiver_m(-0.7, -6, 3.2);
  CHECK(edge_points_between(tiles, transmitter_m, receiver_m, settings).empty());
  CHECK(edge_points_between(two_materials, transmitter_m, receiver_m, settings).empty());
  settings.propagation.diffraction.free_edges = true;
  for (const Patches& one : {whole, tiles, two_materials}) {
    const auto points_m = edge_points_between(one, transmitter_m, receiver_m, settings);
    CHECK(points_m.size() == 4);
    CHECK(count_at(points_m, 0, -4) + count_at(points_m, 0, 4) + count_at(points_m, 2, 0) + count_at(points_m, 2, 6) ==
          4);
  }
}

TEST_CASE("inner corners do not diffract, from inside a room or from a yard") {
  const Patches room = box_faces(Vec3(0), Vec3(6, 5, 3), "opaque");
  CHECK(edge_points_between(room, Vec3(1, 1, 1), Vec3(4, 3, 2), edge_settings(2, 0)).empty());
  // Two walls that meet in a corner: on the side of 90° nothing, on the other one path.
  const Patches yard{{{Vec3(0, 0, -9), Vec3(8, 0, -9), Vec3(8, 0, 9), Vec3(0, 0, 9)}, "opaque"},
                     {{Vec3(0, 0, -9), Vec3(0, 8, -9), Vec3(0, 8, 9), Vec3(0, 0, 9)}, "opaque"}};
  CHECK(edge_points_between(yard, Vec3(3, 2, 0), Vec3(2, 4, 1), edge_settings(1, 0)).empty());
  CHECK(edge_points_between(yard, Vec3(-3, 2, 0), Vec3(-2, -4, 1), edge_settings(1, 0)).size() == 1);
  CHECK(edge_points_between(yard, Vec3(-3, 2, 0), Vec3(3, -4, 1), edge_settings(0, 0)).size() == 1);
  // From the yard, even where the walls may be crossed, to the outside.
  const Patches panes = mapped(yard, [](const Vec3& p) { return p; });
  Patches glass = panes;
  for (Patch& pane : glass) pane.material = "glass";
  CHECK(edge_points_between(glass, Vec3(3, 2, 0), Vec3(-2, -4, 1), edge_settings(1, 3)).empty());
}

TEST_CASE("an edge at which three facets meet does not diffract") {
  Patches walls{{{Vec3(0, 0, -9), Vec3(8, 0, -9), Vec3(8, 0, 9), Vec3(0, 0, 9)}, "opaque"},
                {{Vec3(0, 0, -9), Vec3(0, 8, -9), Vec3(0, 8, 9), Vec3(0, 0, 9)}, "opaque"}};
  const Vec3 transmitter_m(-3, 2, 0), receiver_m(-2, -4, 1);
  CHECK(edge_points_between(walls, transmitter_m, receiver_m, edge_settings(0, 0)).size() == 1);
  walls.push_back({{Vec3(0, 0, -9), Vec3(5, 6, -9), Vec3(5, 6, 9), Vec3(0, 0, 9)}, "alpha"});
  SimulationSettings settings = edge_settings(0, 0);
  CHECK(edge_points_between(walls, transmitter_m, receiver_m, settings).empty());
  settings.propagation.diffraction.free_edges = true;  // a rim that meets others is no rim
  CHECK(count_at(edge_points_between(walls, transmitter_m, receiver_m, settings), 1, 0.0) == 0);
}

TEST_CASE("a point of an edge that touches a third facet does not diffract, a millimetre beside it does") {
  const Patches walls{{{Vec3(0, 0, -9), Vec3(8, 0, -9), Vec3(8, 0, 9), Vec3(0, 0, 9)}, "opaque"},
                      {{Vec3(0, 0, -9), Vec3(0, 8, -9), Vec3(0, 8, 9), Vec3(0, 0, 9)}, "opaque"}};
  const Vec3 transmitter_m(-5, 5, 0), receiver_m(-5, -5, 1);  // the point is at z = 1/2
  const auto with_awning = [&](double z_m, double off_m) {
    // A level triangle whose tip comes from the side of −x; both legs pass it.
    const Patch awning{{Vec3(-off_m, 0, z_m), Vec3(-3, -0.3, z_m), Vec3(-3, 0.3, z_m)}, "pec"};
    return edge_points_between(walls + Patches{awning}, transmitter_m, receiver_m, edge_settings(0, 0)).size();
  };
  CHECK(with_awning(0.5, 0.0) == 0);
  CHECK(with_awning(0.5, 5e-5) == 0);
  CHECK(with_awning(0.50005, 0.0) == 0);
  CHECK(with_awning(0.501, 0.0) == 1);
  CHECK(with_awning(0.499, 0.0) == 1);
  CHECK(with_awning(0.5, 1e-3) == 1);
}

TEST_CASE("a device mounted on a face sees none of that face's edges, and a finite field at the others") {
  // The wall across the way has a corner at x = 4 that the device sees, and the receiver over the roof.
  const Patches walls =
      box_faces(Vec3(-2, -4, 0), Vec3(2, 4, 5), "opaque") + box_faces(Vec3(4, 2, 0), Vec3(6, 4, 8), "opaque");
  const Vec3 receiver_m(-7, 1, 12);
  for (const Discovery discovery : both_discoveries) {
    for (const double gap_m : {0.0, 3e-5, -3e-5}) {
      CAPTURE(gap_m);
      const auto paths =
          paths_between(scene_through_files(walls), Vec3(2 + gap_m, 1, 3), receiver_m, edge_settings(1, 0, discovery));
      for (const PathContribution& path : paths) CHECK(std::isfinite(norm_squared(path.transfer)));
      CHECK(count_at(edge_points_m(paths), 0, 2.0) == 0);
      CHECK(count_at(edge_points_m(paths), 0, 4.0) > 0);
    }
    // A millimetre off the wall it sees them.
    const auto paths =
        paths_between(scene_through_files(walls), Vec3(2.001, 1, 3), receiver_m, edge_settings(1, 0, discovery));
    CHECK(count_at(edge_points_m(paths), 0, 2.0) > 0);
  }
}

TEST_CASE(
    "next to a diffraction no mirror holds the edge: neither the wedge's own faces nor a wall in line with them") {
  // Two houses in line, front walls in y = −4; between them a gap. And a wall across the street.
  const Patches street = Patches{ground(), sheet(Vec3(0, -16, 8), Vec3(40, 0, 0), Vec3(0, 0, 8), "opaque")} +
                         without(box_faces(Vec3(-12, -4, 0), Vec3(-3, 6, 9), "opaque"), 4) +
                         without(box_faces(Vec3(4, -4, 0), Vec3(15, 7, 7), "alpha"), 4);
  Dice dice(41);
  std::size_t next_to_mirror = 0;
  for (int round = 0; round < 12; ++round) {
    const Vec3 transmitter_m = dice.inside(Vec3(-20, -15, 1), Vec3(20, -5, 8));
    const Vec3 receiver_m = dice.inside(Vec3(-20, -15, 1), Vec3(20, 15, 8));
    const Scene scene = scene_through_files(street);
    for (const PathContribution& path : paths_between(scene, transmitter_m, receiver_m, edge_settings(2, 0))) {
      const auto& touched = path.path.interactions;
      for (std::size_t index = 0; index + 1 < touched.size(); ++index) {
        const bool edge_first = touched[index].kind == InteractionKind::diffraction;
        const bool edge_then = touched[index + 1].kind == InteractionKind::diffraction;
        if (edge_first == edge_then) continue;
        ++next_to_mirror;
        const Interaction &mirror = touched[edge_first ? index + 1 : index],
                          &edge = touched[edge_first ? index : index + 1];
        const Wedge& wedge = scene.wedge(edge.wedge).edge;
        const Plane& plane = scene.facet(mirror.facet).plane;
        CHECK(std::max(std::abs(signed_distance_m(plane, wedge.start_m)),
                       std::abs(signed_distance_m(plane, wedge.end_m))) > 1e-3);
      }
    }
  }
  CHECK(next_to_mirror > 50);
}

TEST_CASE("min_exterior_angle_deg: a bend of 185° diffracts from 181° on, a corner of 270° up to 269.999°") {
  const auto bend = [](double exterior_deg) {
    const double half = degrees_to_radians(exterior_deg - 180.0) / 2;  // both halves slope down from the crest x = 0
    const Vec3 left(-6 * std::cos(half), 0, -6 * std::sin(half)), right(6 * std::cos(half), 0, -6 * std::sin(half));
    return Patches{{{Vec3(0, -5, 0), Vec3(0, 5, 0), left + Vec3(0, 5, 0), left - Vec3(0, 5, 0)}, "opaque"},
                   {{Vec3(0, -5, 0), Vec3(0, 5, 0), right + Vec3(0, 5, 0), right - Vec3(0, 5, 0)}, "opaque"}};
  };
  const auto paths_over = [&](double exterior_deg, double least_deg) {
    SimulationSettings settings = edge_settings(0, 0);
    settings.propagation.diffraction.min_exterior_angle_deg = least_deg;
    return edge_points_between(bend(exterior_deg), Vec3(-3, 1, 4), Vec3(4, -1, 3), settings).size();
  };
  CHECK(paths_over(185, SimulationSettings{}.propagation.diffraction.min_exterior_angle_deg) == 0);
  CHECK(paths_over(185, 181) == 1);
  CHECK(paths_over(189.9, 190) == 0);
  CHECK(paths_over(190.1, 190) == 1);
  CHECK(paths_over(270, 269.999) == 1);
  CHECK(paths_over(270, 270.001) == 0);
  CHECK(paths_over(180.5, 180.2) == 1);
}

TEST_CASE("min_exterior_angle_deg 270 keeps the right angles of a box, however it stands") {
  const Vec3 transmitter_m(9, -2, 6.5), receiver_m(8, 3, 7.5);
  SimulationSettings settings = edge_settings(0, 0);
  settings.propagation.diffraction.min_exterior_angle_deg = 270.0;
  for (const Mat3& turn : turns()) {
    const auto map = [&](const Vec3& p) { return turn * p; };
    const Patches box = mapped(box_faces(Vec3(-2, -4, 0), Vec3(2, 4, 5), "pec"), map);
    CHECK(edge_points_between(box, map(transmitter_m), map(receiver_m), settings).size() ==
          edge_points_between(box, map(transmitter_m), map(receiver_m), edge_settings(0, 0)).size());
  }
}

TEST_CASE("region shadow reports those paths, and only those, whose every edge hides its neighbours from each other") {
  const Vec3 low(-2, -4, 0), high(2, 4, 5);
  const Patches box = box_faces(low, high, "opaque");
  const auto inside = [&](const Vec3& p) {
    return p.x > low.x && p.x < high.x && p.y > low.y && p.y < high.y && p.z > low.z && p.z < high.z;
  };
  Dice dice(42);
  std::size_t shadowed = 0, lit = 0;
  for (int round = 0; round < 120; ++round) {
    const auto outside = [&] {
      Vec3 point_m(0, 0, 1);
      while (inside(point_m)) point_m = dice.inside(Vec3(-9, -12, -4), Vec3(9, 12, 11));
      return point_m;
    };
    const Vec3 transmitter_m = outside(), receiver_m = outside();
    const Scene scene = scene_through_files(box);
    SimulationSettings settings = edge_settings(0, 0);
    settings.propagation.max_diffractions = 2;
    const auto everywhere = paths_between(scene, transmitter_m, receiver_m, settings);
    settings.propagation.diffraction.region = DiffractionRegion::shadow;
    const auto in_shadow = paths_between(scene, transmitter_m, receiver_m, settings);
    std::vector<std::vector<double>> expected, found;
    for (const PathContribution& path : everywhere) {
      bool all = true;
      const auto& touched = path.path.interactions;
      for (std::size_t index = 0; index < touched.size(); ++index) {
        const Vec3 before_m = index == 0 ? transmitter_m : touched[index - 1].point_m;
        const Vec3 after_m = index + 1 == touched.size() ? receiver_m : touched[index + 1].point_m;
        const Vec3 back = glm::normalize(before_m - touched[index].point_m);
        const Vec3 on = glm::normalize(after_m - touched[index].point_m);
        // Close to the edge, the straight way between the neighbours runs through the box or passes it.
        bool hidden = false;
        for (int share = 1; share < 4000; ++share) {
          const double s = share / 4000.0;
          hidden = hidden || inside(touched[index].point_m + 1e-3 * ((1 - s) * back + s * on));
        }
        CHECK(touched[index].in_shadow == hidden);
        all = all && hidden;
        ++(hidden ? shadowed : lit);
      }
      if (all) expected.push_back(all_numbers(path));
    }
    for (const PathContribution& path : in_shadow) found.push_back(all_numbers(path));
    CHECK(found == expected);
  }
  CHECK(shadowed > 50);
  CHECK(lit > 50);
}

TEST_CASE("rims of sheets diffract only on request") {
  const Patches screen{sheet(Vec3(0, 0, 3), Vec3(4, 0, 0), Vec3(0, 0, 3), "opaque")};
  for (const Discovery discovery : both_discoveries) {
    SimulationSettings settings = edge_settings(1, 0, discovery);
    CHECK(edge_points_between(screen, Vec3(0.4, 7, 2.7), Vec3(-0.7, -6, 3.2), settings).empty());
    settings.propagation.diffraction.free_edges = true;
    CHECK(edge_points_between(screen, Vec3(0.4, 7, 2.7), Vec3(-0.7, -6, 3.2), settings).size() == 4);
    // On the lit side as well, and beside the sheet in its plane there is no exterior to speak of.
    CHECK(edge_points_between(screen, Vec3(0.4, 7, 2.7), Vec3(-0.7, 6, 3.2), settings, "D").size() == 4);
  }
}

TEST_CASE("a leg to or from an edge is blocked by a wall and crosses sheets, each listed in order") {
  const Patches walls{{{Vec3(0, 0, -9), Vec3(8, 0, -9), Vec3(8, 0, 9), Vec3(0, 0, 9)}, "opaque"},
                      {{Vec3(0, 0, -9), Vec3(0, 8, -9), Vec3(0, 8, 9), Vec3(0, 0, 9)}, "opaque"}};
  const Vec3 transmitter_m(-6, 6, 0), receiver_m(6, -6, 1);
  const auto across = [](double x_m, const std::string& material) {
    return x_m < 0 ? sheet(Vec3(x_m, -x_m, 0), Vec3(0.4, 0.4, 0), Vec3(0, 0, 2), material)
                   : sheet(Vec3(x_m, -x_m, 0.5), Vec3(0.4, 0.4, 0), Vec3(0, 0, 2), material);
  };
  const auto kinds_and_materials = [&](const Patches& more, int crossings) {
    std::string text;
    const Scene scene = scene_through_files(walls + more);
    for (const PathContribution& path : paths_between(scene, transmitter_m, receiver_m, edge_settings(0, crossings))) {
      if (edge_points_m({path}).empty()) continue;
      text += kinds(path);
      double place_m = -6.0;  // the transmitter's; all go towards +x
      for (const Interaction& one : path.path.interactions) {
        if (one.kind == InteractionKind::transmission) {
          text += " " + scene.material(scene.facet(one.facet).material).name;
        }
        CHECK(one.point_m.x > place_m);
        place_m = one.point_m.x;
      }
      text += ";";
    }
    return text;
  };
  CHECK(kinds_and_materials({}, 3) == "D;");
  CHECK(kinds_and_materials({across(-3, "glass")}, 3) == "TD glass;");
  CHECK(kinds_and_materials({across(3, "wall")}, 3) == "DT wall;");
  CHECK(kinds_and_materials({across(3, "wall"), across(2, "lossy"), across(-4, "glass")}, 3) ==
        "TDTT glass lossy wall;");
  CHECK(kinds_and_materials({across(3, "wall"), across(2, "lossy"), across(-4, "glass")}, 2).empty());
  CHECK(kinds_and_materials({across(-3, "opaque")}, 3).empty());
  CHECK(kinds_and_materials({across(3, "pec")}, 3).empty());
  CHECK(kinds_and_materials({across(3, "glass")}, 0).empty());
}

}  // namespace test_edge_contact
