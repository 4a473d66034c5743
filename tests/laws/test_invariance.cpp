/// What is not physics must not matter: where the origin is, which way the axes point, how a wall is cut into
/// triangles, in which order a file lists them.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iomanip>
#include <string>
#include <vector>

#include "tests/support/law_scenes.hpp"

namespace test_invariance {

using namespace dcem;
using namespace dcem::test;

namespace {

constexpr double length_tolerance_m = 1e-6, power_tolerance_db = 1e-6;

std::vector<RandomRoom> rooms() {
  std::vector<RandomRoom> result;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) result.push_back(random_room(200 + seed, 3, 1));
  return result;
}

SimulationSettings settings() {
  return law_settings(3, 2);
}

double power_db(const PathContribution& path) {
  return 10.0 * std::log10(norm_squared(path.transfer));
}

bool same_points(const Path& path, const Path& other, const auto& map) {
  if (path.interactions.size() != other.interactions.size()) return false;
  for (std::size_t index = 0; index < path.interactions.size(); ++index) {
    const Interaction &a = path.interactions[index], &b = other.interactions[index];
    if (a.kind != b.kind || glm::distance(map(a.point_m), b.point_m) > length_tolerance_m) return false;
  }
  return true;
}

/// Each path has exactly one partner whose points are the mapped ones; `check` looks at the pair.
void check_same(const std::vector<PathContribution>& before, const std::vector<PathContribution>& after,
                const auto& map, const auto& check) {
  REQUIRE(before.size() > 10);
  REQUIRE(before.size() == after.size());
  for (const PathContribution& path : before) {
    std::size_t partners = 0;
    for (const PathContribution& other : after) {
      if (std::abs(path.path.length_m - other.path.length_m) > length_tolerance_m) continue;
      if (!same_points(path.path, other.path, map)) continue;
      ++partners;
      CHECK(std::abs(power_db(path) - power_db(other)) < power_tolerance_db);
      check(path, other);
    }
    CHECK(partners == 1);
  }
}

constexpr auto no_more_checks = [](const PathContribution&, const PathContribution&) {};

/// Each patch, a parallelogram, as 8×16 cells of two triangles.
Patches cut_into_256(const Patches& patches) {
  Patches pieces;
  for (const Patch& patch : patches) {
    const auto& c = patch.corners_m;
    const auto at = [&](int row, int column) {
      return c[0] + row / 8.0 * (c[3] - c[0]) + column / 16.0 * (c[1] - c[0]);
    };
    for (int row = 0; row < 8; ++row) {
      for (int column = 0; column < 16; ++column) {
        const std::array<Vec3, 4> q{at(row, column), at(row, column + 1), at(row + 1, column + 1), at(row + 1, column)};
        const bool other_diagonal = (row + column) % 2 == 1;
        pieces.push_back({{q[0], q[1], other_diagonal ? q[3] : q[2]}, patch.material});
        pieces.push_back({{other_diagonal ? q[1] : q[0], q[2], q[3]}, patch.material});
      }
    }
  }
  return pieces;
}

/// Each patch as two triangles.
Patches as_triangles(const Patches& patches) {
  Patches pieces;
  for (const Patch& patch : patches) {
    const auto& c = patch.corners_m;
    pieces.push_back({{c[0], c[1], c[2]}, patch.material});
    pieces.push_back({{c[0], c[2], c[3]}, patch.material});
  }
  return pieces;
}

std::string link_bits(Scene scene, const RandomRoom& room, Discovery discovery) {
  scene.add_transmitter(device_at("tx", room.transmitter_m, 0.0, antenna(PolarizationKind::dual)));
  scene.add_receiver(device_at("rx", room.receiver_m, 0.0, antenna(PolarizationKind::dual)));
  SimulationSettings exact = settings();
  exact.propagation.discovery = discovery;
  Simulator simulator(std::move(scene), exact);
  const FrameResult frame = simulator.advance_to(0.0);
  return bits(simulator.scene(), frame.links.at(0));
}

/// The same triangles in another order, with vertices shared and in another order, each triangle started at another
/// corner and, with `rewind`, wound the other way.
Scene shuffled_through_file(Patches triangles, Dice& dice, bool rewind) {
  const TemporaryFolder folder;
  write_law_materials(folder / "laws.mtl");
  std::vector<Vec3> vertices;
  for (const Patch& triangle : triangles) {
    for (const Vec3& corner : triangle.corners_m) {
      if (std::find(vertices.begin(), vertices.end(), corner) == vertices.end()) vertices.push_back(corner);
    }
  }
  dice.shuffle(vertices);
  dice.shuffle(triangles);
  {
    std::ofstream obj(folder / "shuffled.obj");
    obj << std::setprecision(17) << "mtllib laws.mtl\n";
    for (const Vec3& v : vertices) obj << "v " << v.x << ' ' << v.y << ' ' << v.z << "\n";
    for (Patch& triangle : triangles) {
      std::rotate(triangle.corners_m.begin(), triangle.corners_m.begin() + static_cast<long>(dice.below(3)),
                  triangle.corners_m.end());
      if (rewind && dice.below(2) == 1) std::reverse(triangle.corners_m.begin(), triangle.corners_m.end());
      obj << "usemtl " << triangle.material << "\nf";
      for (const Vec3& corner : triangle.corners_m) {
        obj << ' ' << 1 + (std::find(vertices.begin(), vertices.end(), corner) - vertices.begin());
      }
      obj << "\n";
    }
  }
  Scene scene;
  add_obj_file(scene, folder / "shuffled.obj", [&](const TriangleMesh& mesh) { scene.set_scenery(mesh); });
  return scene;
}

}  // namespace

TEST_CASE("invariance: rotation by an odd angle about an odd axis") {
  for (const RandomRoom& room : rooms()) {
    const Mat3 turn = rotation_about(Vec3(0.31, -0.77, 0.52), 1.2345);
    const auto map = [&](const Vec3& point) { return turn * point; };
    const auto before =
        paths_between(scene_through_files(room.patches), room.transmitter_m, room.receiver_m, settings());
    const auto after = paths_between(scene_through_files(mapped(room.patches, map)), map(room.transmitter_m),
                                     map(room.receiver_m), settings());
    // V and H turn with the axes; what is left of the transfer matrix is its norm, which check_same compares.
    check_same(before, after, map, no_more_checks);
  }
}

TEST_CASE("invariance: rotation about the vertical leaves V and H as they were") {
  for (const RandomRoom& room : rooms()) {
    const Mat3 turn = rotation_about(Vec3(0, 0, 1), -2.3017);
    const auto map = [&](const Vec3& point) { return turn * point; };
    const auto before =
        paths_between(scene_through_files(room.patches), room.transmitter_m, room.receiver_m, settings());
    const auto after = paths_between(scene_through_files(mapped(room.patches, map)), map(room.transmitter_m),
                                     map(room.receiver_m), settings());
    check_same(before, after, map, [](const PathContribution& path, const PathContribution& other) {
      for (std::size_t entry = 0; entry < 4; ++entry) {
        // 1e-9: the phase of −kL with L good to 1e-13 m, k = 590 rad/m.
        CHECK(std::abs(path.transfer(entry / 2, entry % 2) - other.transfer(entry / 2, entry % 2)) <
              1e-9 * std::sqrt(norm_squared(path.transfer)));
      }
    });
  }
}

TEST_CASE("invariance: translation by 3 km") {
  for (const RandomRoom& room : rooms()) {
    const Vec3 offset(2143.6, -1987.3, 672.9);
    const auto map = [&](const Vec3& point) { return point + offset; };
    const auto before =
        paths_between(scene_through_files(room.patches), room.transmitter_m, room.receiver_m, settings());
    const auto after = paths_between(scene_through_files(mapped(room.patches, map)), map(room.transmitter_m),
                                     map(room.receiver_m), settings());
    check_same(before, after, map, [](const PathContribution& path, const PathContribution& other) {
      for (std::size_t entry = 0; entry < 4; ++entry) {
        // 1e-6: coordinates of 3 km are rounded to 5e-13 m, which flat folding magnifies; k = 590 rad/m.
        CHECK(std::abs(path.transfer(entry / 2, entry % 2) - other.transfer(entry / 2, entry % 2)) <
              1e-6 * std::sqrt(norm_squared(path.transfer)));
      }
    });
  }
}

TEST_CASE("invariance: each wall cut into 256 triangles, in both discoveries") {
  for (const RandomRoom& room : rooms()) {
    const Scene whole = scene_through_files(room.patches), cut = scene_through_files(cut_into_256(room.patches));
    CHECK(cut.triangles().size() == 256 * room.patches.size());
    CHECK(cut.facets().size() == room.patches.size());
    const auto same_place = [](const Vec3& point) { return point; };
    for (const Discovery discovery : {Discovery::exact, Discovery::sampled}) {
      SimulationSettings with = settings();
      with.propagation.discovery = discovery;
      check_same(paths_between(whole, room.transmitter_m, room.receiver_m, with),
                 paths_between(cut, room.transmitter_m, room.receiver_m, with), same_place, no_more_checks);
    }
  }
}

TEST_CASE("invariance: the order of faces and vertices and their winding change no bit") {
  Dice dice(5);
  for (const RandomRoom& room : rooms()) {
    const Patches triangles = as_triangles(room.patches);
    for (const Discovery discovery : {Discovery::exact, Discovery::sampled}) {
      const std::string before = link_bits(scene_through_files(triangles), room, discovery);
      CHECK(before.size() > 1000);
      CHECK(link_bits(shuffled_through_file(triangles, dice, false), room, discovery) == before);
      CHECK(link_bits(shuffled_through_file(triangles, dice, true), room, discovery) == before);
    }
  }
}

TEST_CASE("invariance: units and the axis that points up") {
  const RandomRoom room = random_room(207, 2, 1);
  const TemporaryFolder folder;
  write_law_materials(folder / "laws.mtl");
  // The file holds millimetres with y up: (x, y, z) there is (x, −z, y) here.
  write_patches(folder / "y_up.obj", mapped(room.patches, [](const Vec3& p) { return 1000.0 * Vec3(p.x, p.z, -p.y); }));
  const io::ObjFile obj = io::read_obj(folder / "y_up.obj", {io::UpAxis::y, 1e-3});
  Scene scene;
  for (const auto& [name, mtl] : obj.materials) scene.add_material(*io::material_from_mtl(name, &mtl));
  scene.set_scenery(obj.mesh);
  check_same(
      paths_between(scene_through_files(room.patches), room.transmitter_m, room.receiver_m, settings()),
      paths_between(std::move(scene), room.transmitter_m, room.receiver_m, settings()),
      [](const Vec3& point) { return point; }, no_more_checks);
}

}  // namespace test_invariance
