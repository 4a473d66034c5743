/// Where surfaces touch, overlap or carry a device: one path stays one path, and none is lost.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "tests/support/law_scenes.hpp"

namespace test_contact {

using namespace dcem;
using namespace dcem::test;

namespace {

constexpr Discovery both_discoveries[]{Discovery::exact, Discovery::sampled};

SimulationSettings settings(int reflections, int transmissions, Discovery discovery) {
  return law_settings(reflections, transmissions, discovery);
}

Patch floor_patch(double x0, double x1, double z, const std::string& material) {
  return {{Vec3(x0, -3, z), Vec3(x1, -3, z), Vec3(x1, 3, z), Vec3(x0, 3, z)}, material};
}

std::vector<PathContribution> with_kinds(const std::vector<PathContribution>& paths, const std::string& letters) {
  std::vector<PathContribution> result;
  std::copy_if(paths.begin(), paths.end(), std::back_inserter(result),
               [&](const PathContribution& path) { return kinds(path) == letters; });
  return result;
}

/// What a path keeps of its free-space amplitude, per polarization at normal azimuth.
double amplitude_left(const PathContribution& path) {
  const double wavelength_m = 299'792'458.0 / law_frequency_hz;
  return std::abs(path.transfer(1, 1)) * 4.0 * pi * path.path.length_m / wavelength_m;
}

/// All rigid poses in which a law is tried: as it stands, and turned so that no coordinate is round.
std::vector<Mat3> turns() {
  std::vector<Mat3> result{Mat3(1.0)};
  Dice dice(17);
  for (int index = 0; index < 12; ++index) result.push_back(rotation_about(dice.direction(), dice.between(-pi, pi)));
  return result;
}

/// The kinds of all paths in alphabetical order, such as "LOS R RR".
std::string kinds_of(const std::vector<PathContribution>& paths) {
  std::vector<std::string> letters;
  for (const PathContribution& path : paths) letters.push_back(kinds(path).empty() ? "LOS" : kinds(path));
  std::sort(letters.begin(), letters.end());
  std::string text;
  for (const std::string& one : letters) text += (text.empty() ? "" : " ") + one;
  return text;
}

}  // namespace

TEST_CASE(
    "overlap: two coplanar patches of different material give one path, with the material whose name comes first") {
  // alpha reflects 0.9, opaque 0.8, in one plane or a third of the weld tolerance apart, in either order in the file.
  for (const Discovery discovery : both_discoveries) {
    for (const bool alpha_left : {true, false}) {
      for (const double gap_m : {0.0, 3e-5, -3e-5}) {
        for (const bool swap_in_file : {true, false}) {
          Patches patches{floor_patch(-6, 2, 0.0, alpha_left ? "alpha" : "opaque"),
                          floor_patch(-2, 6, gap_m, alpha_left ? "opaque" : "alpha")};
          if (swap_in_file) std::swap(patches[0], patches[1]);
          const Scene scene = scene_through_files(patches);
          CHECK(scene.facets().size() == 2);
          for (const double x : {-4.0, -1.3, 0.0, 1.1, 4.0}) {
            CAPTURE(x);
            CAPTURE(gap_m);
            const auto paths =
                paths_between(scene, Vec3(x - 1, 0.3, 2), Vec3(x + 1, 0.3, 2), settings(3, 0, discovery));
            const auto reflected = with_kinds(paths, "R");
            CHECK(kinds_of(paths) == "LOS R");
            REQUIRE(reflected.size() == 1);
            const bool only_left = x<-2, only_right = x> 2;
            const bool alpha = (only_left && alpha_left) || (only_right && !alpha_left) || (!only_left && !only_right);
            CHECK(amplitude_left(reflected[0]) == doctest::Approx(alpha ? 0.9 : 0.8).epsilon(1e-12));  // rounding
            CHECK(scene.material(scene.facet(reflected[0].path.interactions[0].facet).material).name ==
                  (alpha ? "alpha" : "opaque"));
          }
        }
      }
    }
  }
}

TEST_CASE(
    "overlap: in paths of several bounces every touched coplanar duplicate gives way, and only one path is left") {
  for (const Discovery discovery : both_discoveries) {
    for (const Mat3& turn : turns()) {
      const auto map = [&](const Vec3& p) { return turn * p; };
      // Two facing mirrors, each of two patches of which the inner one lies on the outer one.
      const Patches patches = mapped({floor_patch(-9, 9, 0, "opaque"), floor_patch(-2, 2, 0, "alpha"),
                                      floor_patch(-9, 9, 3, "opaque"), floor_patch(-2, 2, 3, "alpha")},
                                     map);
      const auto paths = paths_between(scene_through_files(patches), map(Vec3(-1, 0.2, 1.1)), map(Vec3(1.2, 0.1, 1.7)),
                                       settings(4, 0, discovery));
      CHECK(kinds_of(paths) == "LOS R R RR RR RRR RRR RRRR RRRR");
    }
  }
}

TEST_CASE("overlap: two coplanar sheets are crossed once, and the material whose name comes first is paid") {
  for (const Mat3& turn : turns()) {
    for (const bool swap_in_file : {true, false}) {
      const auto map = [&](const Vec3& p) { return turn * p; };
      Patches patches = mapped({floor_patch(-6, 2, 0, "wall"), floor_patch(-2, 6, 0, "glass")}, map);
      if (swap_in_file) std::swap(patches[0], patches[1]);
      const Scene scene = scene_through_files(patches);
      for (const double x : {-4.0, 0.3, 4.0}) {
        CAPTURE(x);
        const auto paths = paths_between(scene, map(Vec3(x, 0.2, 2)), map(Vec3(x + 0.1, 0.3, -2)), law_settings(0, 3));
        REQUIRE(paths.size() == 1);
        CHECK(kinds(paths[0]) == "T");
        CHECK(scene.material(scene.facet(paths[0].path.interactions[0].facet).material).name ==
              (x < -2 ? "wall" : "glass"));
      }
    }
  }
}

TEST_CASE("seams: a reflection on a diagonal, a seam, a shared corner is there once") {
  // Four quads of one material around the origin, each cut along a diagonal that ends there, so eight triangles meet.
  Patches pieces;
  for (const Vec3& far : {Vec3(4, 4, 0), Vec3(-4, 4, 0), Vec3(-4, -4, 0), Vec3(4, -4, 0)}) {
    pieces.push_back({{Vec3(0.0), Vec3(far.x, 0, 0), far}, "opaque"});
    pieces.push_back({{Vec3(0.0), far, Vec3(0, far.y, 0)}, "opaque"});
  }
  Dice dice(19);
  std::vector<Vec3> targets{Vec3(0.0)};
  for (int index = 0; index < 12; ++index) {
    const double s = dice.between(-3.9, 3.9);
    targets.insert(targets.end(), {Vec3(s, s, 0), Vec3(s, -s, 0), Vec3(s, 0, 0), Vec3(0, s, 0)});
  }
  for (const Mat3& turn : turns()) {
    const auto map = [&](const Vec3& p) { return turn * p; };
    const Scene scene = scene_through_files(mapped(pieces, map));
    CHECK(scene.facets().size() == 1);
    for (const Vec3& target : targets) {
      const Vec3 arm(0.9, -0.4, 1.3);
      const Vec3 from = map(target + arm), to = map(target + Vec3(-arm.x, -arm.y, arm.z));
      for (const Discovery discovery : both_discoveries) {
        CHECK(kinds_of(paths_between(scene, from, to, settings(2, 1, discovery))) == "LOS R");
      }
      // And nothing leaks between the triangles of an opaque wall.
      CHECK(paths_between(scene, from, map(target - arm), law_settings(0, 3)).empty());
    }
  }
}

TEST_CASE("seams: a sheet crossed on a diagonal, a seam, a shared corner is paid once") {
  Patches pieces;
  for (const Vec3& far : {Vec3(4, 4, 0), Vec3(-4, 4, 0), Vec3(-4, -4, 0), Vec3(4, -4, 0)}) {
    pieces.push_back({{Vec3(0.0), Vec3(far.x, 0, 0), far}, "glass"});
    pieces.push_back({{Vec3(0.0), far, Vec3(0, far.y, 0)}, "glass"});
  }
  Dice dice(20);
  for (const Mat3& turn : turns()) {
    const auto map = [&](const Vec3& p) { return turn * p; };
    const Scene scene = scene_through_files(mapped(pieces, map));
    for (int index = 0; index < 10; ++index) {
      const double s = index == 0 ? 0.0 : dice.between(-3.9, 3.9);
      const Vec3 arm(0.7, 0.2, 1.1);
      for (const Vec3& target : {Vec3(s, s, 0), Vec3(0, s, 0), Vec3(s, 0, 0)}) {
        const auto paths = paths_between(scene, map(target + arm), map(target - arm), law_settings(0, 3));
        CHECK(kinds_of(paths) == "T");
      }
    }
  }
}

TEST_CASE("seams: two materials side by side reflect once on their common edge") {
  for (const Discovery discovery : both_discoveries) {
    for (const Mat3& turn : turns()) {
      const auto map = [&](const Vec3& p) { return turn * p; };
      const Scene scene =
          scene_through_files(mapped({floor_patch(-5, 0, 0, "opaque"), floor_patch(0, 5, 0, "alpha")}, map));
      CHECK(scene.facets().size() == 2);
      for (const double y : {-2.1, -0.3, 0.0, 1.7}) {
        const auto paths = paths_between(scene, map(Vec3(-1.3, y, 2)), map(Vec3(1.3, y, 2)), settings(2, 0, discovery));
        // Which of the two it is, rounding may decide.
        CHECK(kinds_of(paths) == "LOS R");
      }
    }
  }
}

TEST_CASE("seams: nothing gets into a closed opaque box, least of all through its edges and corners") {
  const Patches box = box_faces(Vec3(-1, -2, -1.5), Vec3(1, 2, 1.5), "opaque");
  Dice dice(21);
  for (const Mat3& turn : turns()) {
    const auto map = [&](const Vec3& p) { return turn * p; };
    const Scene scene = scene_through_files(mapped(box, map));
    for (const double x : {-1.0, 1.0}) {
      for (const double y : {-2.0, 2.0}) {
        for (const double z : {-1.5, 1.5, dice.between(-1.5, 1.5)}) {
          const Vec3 edge(x, y, z), inside = dice.inside(Vec3(-0.8, -1.8, -1.3), Vec3(0.8, 1.8, 1.3));
          CHECK(paths_between(scene, map(inside), map(edge + 1.7 * (edge - inside)), law_settings(2, 3)).empty());
        }
      }
    }
  }
}

TEST_CASE("seams: every ray from inside a closed mesh hits it, also one aimed at an edge or a corner") {
  const Patches box = box_faces(Vec3(-1, -2, -1.5), Vec3(1, 2, 1.5), "opaque");
  Dice dice(22);
  for (const Mat3& turn : turns()) {
    Patches turned = mapped(box, [&](const Vec3& p) { return turn * p; });
    const Scene scene = scene_through_files(turned);
    WideIndex index;
    index.build(scene.triangle_view(), scene.triangle_boxes(), scene.first_triangles());
    const SceneTracer<WideIndex> tracer(scene, index);
    TraversalCounters counters;
    for (const Patch& face : turned) {
      for (std::size_t corner = 0; corner < 4; ++corner) {
        const Vec3 &a = face.corners_m[corner], &b = face.corners_m[(corner + 1) % 4],
                   &c = face.corners_m[(corner + 2) % 4];
        const double share = dice.between(0.0, 1.0);
        const Vec3 origin = turn * dice.inside(Vec3(-0.9, -1.9, -1.4), Vec3(0.9, 1.9, 1.4));
        for (const Vec3& target : {a, a + share * (b - a), a + share * (c - a)}) {
          const auto hit = tracer.closest_hit({origin, target - origin}, {}, {}, counters);
          REQUIRE(hit.has_value());
          CHECK(hit->t == doctest::Approx(1.0).epsilon(1e-9));
        }
      }
    }
  }
}

TEST_CASE("mounted: a device on a wall has no reflection from it and looks through it; next to it, it has one") {
  const Scene scene = scene_through_files({floor_patch(-6, 6, 0, "opaque")});
  for (const Discovery discovery : both_discoveries) {
    for (const double height_m : {0.0, 5e-5, -5e-5}) {
      CAPTURE(height_m);
      for (const double other_m : {2.0, -2.0}) {
        const Vec3 mounted(0.3, 0.2, height_m), free(1.7, -0.4, other_m);
        CHECK(kinds_of(paths_between(scene, mounted, free, settings(3, 1, discovery))) == "LOS");
        CHECK(kinds_of(paths_between(scene, free, mounted, settings(3, 1, discovery))) == "LOS");
      }
    }
    CHECK(kinds_of(paths_between(scene, Vec3(0.3, 0.2, 2e-4), Vec3(1.7, -0.4, 2), settings(3, 1, discovery))) ==
          "LOS R");
    CHECK(paths_between(scene, Vec3(0.3, 0.2, 2e-4), Vec3(1.7, -0.4, -2), settings(3, 1, discovery)).empty());
  }
}

TEST_CASE("mounted: facets coplanar with the mount are part of it, and the mount still mirrors later bounces") {
  for (const Discovery discovery : both_discoveries) {
    // The mount is two overlapping patches; a ceiling makes further bounces.
    const Scene scene = scene_through_files(
        {floor_patch(-6, 2, 0, "opaque"), floor_patch(-2, 6, 0, "alpha"), floor_patch(-6, 6, 3, "opaque")});
    const Vec3 mounted(0.3, 0.2, 0.0), free(1.7, -0.4, 1.1);
    // Direct; by the ceiling; by the ceiling and then the floor. Not by the floor first.
    CHECK(kinds_of(paths_between(scene, mounted, free, settings(2, 1, discovery))) == "LOS R RR");
    CHECK(kinds_of(paths_between(scene, free, mounted, settings(2, 1, discovery))) == "LOS R RR");
    // Both on the floor: the direct path runs along it. No reflection on it, one on the ceiling, none of order two.
    CHECK(kinds_of(paths_between(scene, mounted, Vec3(1.1, 0.9, 0.0), settings(2, 1, discovery))) == "LOS R");
  }
}

TEST_CASE("in the plane: a device in the plane of a mirror, beside it, has no reflection there and no NaN anywhere") {
  const Scene scene = scene_through_files({floor_patch(-1, 1, 0, "opaque")});
  for (const Discovery discovery : both_discoveries) {
    for (const Vec3& other : {Vec3(4, 0.4, 3), Vec3(0.2, 0.4, 1), Vec3(3, 1, 0), Vec3(5, 7, -2)}) {
      const auto paths = paths_between(scene, Vec3(5, 0.1, 0), other, settings(3, 1, discovery));
      CHECK(kinds_of(paths) == "LOS");
      for (const PathContribution& path : paths) {
        for (const double number : all_numbers(path)) CHECK(std::isfinite(number));
      }
    }
  }
}

TEST_CASE("own body: a car does not exist for the device that rides on it, and does when it is asked to") {
  const Patches box = box_faces(Vec3(-2, -1, 0), Vec3(2, 1, 1.5), "pec");
  const LinearMotion parked{{Vec3(10, 5, 0), 0.4, 0.0, 0.0}, Vec3(0.0), 0.0};
  const LinearMotion beside{{Vec3(10, 9, 0), 0.4, 0.0, 0.0}, Vec3(0.0), 0.0};
  const auto links = [&](const Vec3& offset_m, bool sees_own_body, bool with_neighbour, Discovery discovery) {
    std::vector<MovingPatches> cars{{"car", box, parked}};
    if (with_neighbour) cars.push_back({"neighbour", box, beside});
    Scene scene = scene_through_files({}, cars);
    Device rider = device_at("rider", Vec3(0.0), 0.0, antenna(PolarizationKind::dual));
    rider.attachment = Attachment{"car", offset_m, sees_own_body};
    scene.add_transmitter(rider);
    scene.add_receiver(device_at("mast", Vec3(10.5, 5.8, 8)));
    Simulator simulator(std::move(scene), settings(2, 2, discovery));
    return kinds_of(simulator.advance_to(0.0).links.at(0).paths);
  };
  for (const Discovery discovery : both_discoveries) {
    const Vec3 inside(0.3, 0.1, 0.7), above(0.3, 0.1, 1.8);
    CHECK(links(inside, false, false, discovery) == "LOS");
    CHECK(links(inside, true, false, discovery).empty());
    CHECK(links(above, false, false, discovery) == "LOS");
    CHECK(links(above, true, false, discovery) == "LOS R");
    // A car next to it is no part of the rider's own body: it is seen either way.
    CHECK(links(inside, true, true, discovery).empty());
    CHECK(links(inside, false, true, discovery).substr(0, 3) == "LOS");
  }
}

TEST_CASE("own body: another car mirrors for the rider, and the rider's car mirrors for others") {
  const Patches box = box_faces(Vec3(-2, -1, 0), Vec3(2, 1, 1.5), "pec");
  Scene scene = scene_through_files({}, {{"car", box, LinearMotion{{Vec3(0, 0, 0), 0, 0, 0}, Vec3(0.0), 0.0}},
                                         {"other", box, LinearMotion{{Vec3(0, 6, 0), 0, 0, 0}, Vec3(0.0), 0.0}}});
  Device rider = device_at("rider", Vec3(0.0));
  rider.attachment = Attachment{"car", Vec3(0, 0, 0.9), false};
  scene.add_transmitter(rider);
  scene.add_transmitter(device_at("post", Vec3(-1, 3.1, 0.8)));
  scene.add_receiver(device_at("walker", Vec3(0.7, 3.3, 1.1)));
  Simulator simulator(std::move(scene), law_settings(2, 0));
  const FrameResult frame = simulator.advance_to(0.0);
  // The rider sees the walker and the other car's side; its own side, which would stand between, is not there.
  CHECK(kinds_of(frame.links.at(0).paths) == "LOS R");
  // For the post both cars are mirrors: one bounce each, and one path each way between the two of them.
  CHECK(kinds_of(frame.links.at(1).paths) == "LOS R R RR RR");
}

TEST_CASE(
    "contact: the material edge of a patch that lies on a larger wall neither blocks nor doubles its neighbour's "
    "path") {
  // A poster on a wall, a tenth of the weld tolerance in front of it: the wall's path next to the poster is whole, and
  // the path on the poster is one.
  const Patches patches{floor_patch(-8, 8, 0, "opaque"),
                        {{Vec3(-1, -1, 1e-5), Vec3(1, -1, 1e-5), Vec3(1, 1, 1e-5), Vec3(-1, 1, 1e-5)}, "alpha"}};
  const Scene scene = scene_through_files(patches);
  for (const Discovery discovery : both_discoveries) {
    for (double x = -1.5; x <= 1.5; x += 0.05) {
      CAPTURE(x);
      const auto paths =
          paths_between(scene, Vec3(x - 0.9, 0.31, 1.2), Vec3(x + 0.9, 0.31, 1.2), settings(1, 0, discovery));
      CHECK(kinds_of(paths) == "LOS R");
    }
  }
}

}  // namespace test_contact
