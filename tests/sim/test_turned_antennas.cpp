/// Antennas through the whole line: they turn with what carries them, and with the world.
#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include "dcem/paths/path_id.hpp"
#include "dcem/sim/simulator.hpp"
#include "dcem/sim/verify/same_bits.hpp"
#include "dcem/sim/verify/verifier.hpp"
#include "tests/paths/small_scenes.hpp"

namespace test_turned_antennas {

using namespace dcem;
using namespace dcem::test;

namespace {

constexpr double degree = pi / 180.0;

SimulationSettings settings_for(int reflections, int transmissions, unsigned threads = 1) {
  SimulationSettings settings;
  settings.frequency_hz = 28e9;
  settings.propagation.max_reflections = reflections;
  settings.propagation.max_transmissions = transmissions;
  settings.propagation.max_diffractions = 0;
  settings.threads = threads;
  return settings;
}

Antenna sector(PolarizationKind kind, const Orientation& turned, const AntennaArray& array = {}) {
  return {0.0, {kind}, Tr38901Element{}, turned, array};
}

/// The angles that make a rotation matrix: its first column says yaw and pitch, the rest of its last row roll.
Orientation orientation_of(const Mat3& rotation) {
  return {std::atan2(rotation[0].y, rotation[0].x), -std::asin(rotation[0].z),
          std::atan2(rotation[1].z, rotation[2].z)};
}

/// A ground, two walls and a pane, everything turned about the origin.
Scene yard(const Mat3& turn) {
  TriangleMesh mesh;
  const auto add = [&](const Vec3& centre_m, const Vec3& u, const Vec3& v, const std::string& material) {
    add_sheet(mesh, turn * centre_m, turn * u, turn * v, material);
  };
  add(Vec3(0, 0, 0), Vec3(30, 0, 0), Vec3(0, 30, 0), "opaque");
  add(Vec3(0, 12, 5), Vec3(25, 3, 0), Vec3(0, 0, 5), "wall");
  add(Vec3(14, -2, 4), Vec3(1, 9, 0), Vec3(0, 0, 4), "metal");
  add(Vec3(2, -1, 1.5), Vec3(1.5, 1, 0.3), Vec3(0, 0.4, 1.4), "glass");
  return scene_of(mesh);
}

/// The paths between a transmitter and a receiver in the yard, with circular and slanted sectors, all turned.
std::vector<PathContribution> paths_in_yard(const Mat3& turn) {
  Scene scene = yard(turn);
  const auto device = [&](const char* id, const Vec3& place_m, PolarizationKind kind, const Orientation& own) {
    const Mat3 rotation = turn * rotation_matrix(own);
    return device_at(id, turn * place_m, 0.0, sector(kind, orientation_of(rotation), {2, 2, 0.5}));
  };
  scene.add_transmitter(device("tx", Vec3(-6, 2, 3), PolarizationKind::right_circular, {0.2, 0.1, 0.4}));
  scene.add_receiver(device("rx", Vec3(8, -3.1, 1.2), PolarizationKind::vertical, {2.8, -0.1, 0.3}));
  return std::move(Simulator(std::move(scene), settings_for(2, 2)).advance_to(0.0).links.at(0).paths);
}

}  // namespace

TEST_CASE("the beam of an antenna on a roof turns with the car") {
  Scene scene = scene_of_materials();
  scene.add_object("car", make_box(Vec3(4, 2, 1.5), "metal"),
                   WaypointMotion{{{0.0, {Vec3(0.0), 0.0}}, {2.0, {Vec3(0.0), 170 * degree}}}});
  scene.add_transmitter(device_at("mast", Vec3(40, 0, 1.6)));
  const double looks_left = 30 * degree;
  for (const char* id : {"ahead", "left", "plain"}) {
    Device device = device_at(id, Vec3(0.0));
    device.attachment = Attachment{"car", Vec3(0, 0, 1.6), false};
    if (std::string(id) == "ahead") device.antenna = sector(PolarizationKind::vertical, {});
    if (std::string(id) == "left") device.antenna = sector(PolarizationKind::vertical, {looks_left});
    scene.add_receiver(device);
  }
  Simulator simulator(std::move(scene), settings_for(0, 0));
  for (double time_s = 0.0; time_s <= 2.0; time_s += 0.125) {
    const FrameResult frame = simulator.advance_to(time_s);
    const double yaw_deg = 85.0 * time_s;
    // The mast is at azimuth 0: off the beam by what car and mounting have turned, at the same height.
    const auto gain_db = [](double off_deg) { return 8.0 - std::min(12.0 * off_deg * off_deg / 4225.0, 30.0); };
    const double plain_db = *frame.links.at(2).statistics.power_dbm;
    CHECK(*frame.links.at(0).statistics.power_dbm - plain_db == doctest::Approx(gain_db(yaw_deg)).epsilon(1e-10));
    const double off_left_deg = std::min(yaw_deg + 30.0, 360.0 - yaw_deg - 30.0);
    CHECK(*frame.links.at(1).statistics.power_dbm - plain_db == doctest::Approx(gain_db(off_left_deg)).epsilon(1e-10));
  }
}

TEST_CASE("turning the world with its antennas, in any way, changes no field") {
  const std::vector<PathContribution> upright = paths_in_yard(Mat3(1.0));
  REQUIRE(upright.size() >= 6);
  for (const Pose& pose : {Pose{Vec3(0.0), 1.1, 0.0, 0.0}, Pose{Vec3(0.0), 0.4, -0.7, 0.9}}) {
    const std::vector<PathContribution> turned = paths_in_yard(rotation_matrix(pose));
    REQUIRE(turned.size() == upright.size());
    for (std::size_t path = 0; path < upright.size(); ++path) {
      const PathContribution &a = upright[path], &b = turned[path];
      CHECK(kinds(a.path) == kinds(b.path));
      // Lengths of 40 m rounded at 1e-14 m turn the phase by 6e-12 rad; planes are refitted to turned vertices.
      CHECK(std::abs(a.amplitude - b.amplitude) < 1e-9 * std::abs(a.amplitude));
      REQUIRE(b.channel.rows() == 4);
      REQUIRE(b.channel.columns() == 4);
      for (std::size_t entry = 0; entry < 16; ++entry) {
        CHECK(std::abs(a.channel(entry / 4, entry % 4) - b.channel(entry / 4, entry % 4)) <
              1e-9 * std::abs(a.amplitude));
      }
    }
  }
}

TEST_CASE("links between arrays and turned antennas are the same to the bit for any number of threads, and verified") {
  const auto solve = [](unsigned threads) {
    Scene scene = yard(Mat3(1.0));
    scene.add_transmitter(
        device_at("tx", Vec3(-6, 2, 3), 0.0, sector(PolarizationKind::dual, {0.2, 0.1, 0.4}, {2, 1})));
    for (int index = 0; index < 5; ++index) {
      scene.add_receiver(device_at("rx" + std::to_string(index), Vec3(8, index - 3.1, 1.2), 0.0,
                                   sector(PolarizationKind::slant, {2.8, 0.1 * index, 0.3}, {1, 3})));
    }
    const SimulationSettings settings = settings_for(2, 1, threads);
    Simulator simulator(scene, settings);
    FrameResult result = simulator.advance_to(0.0);
    Verifier verifier(scene, settings);
    verifier.check(scene.frame_at(0.0), result);
    CHECK(verifier.report().passed());
    return result;
  };
  const FrameResult one = solve(1), three = solve(3);
  REQUIRE(one.links.size() == 5);
  for (std::size_t link = 0; link < 5; ++link) {
    REQUIRE(one.links[link].paths.size() == three.links[link].paths.size());
    REQUIRE_FALSE(one.links[link].paths.empty());
    for (std::size_t path = 0; path < one.links[link].paths.size(); ++path) {
      CHECK(one.links[link].paths[path].channel.columns() == 4);
      CHECK(detail::same_bits(one.links[link].paths[path], three.links[link].paths[path]));
    }
  }
}

TEST_CASE("a path in the null of a pattern stays a path without power, and nothing is undefined by it") {
  Scene scene = yard(Mat3(1.0));
  // Straight above each other: along the wires. The ground's reflection leaves along the wire, too.
  scene.add_transmitter(device_at("tx", Vec3(-6, 2, 3), 0.0, {0.0, {PolarizationKind::vertical}, HalfWaveDipole{}}));
  scene.add_receiver(device_at("rx", Vec3(-6, 2, 8)));
  Simulator simulator(std::move(scene), settings_for(0, 0));
  const LinkResult link = simulator.advance_to(0.0).links.at(0);
  REQUIRE(link.paths.size() == 1);
  CHECK(link.paths[0].power_ratio == 0.0);
  CHECK(link.paths[0].amplitude == Complex(0.0));
  CHECK(link.statistics.path_count == 1);
  CHECK_FALSE(link.statistics.power_dbm.has_value());
  CHECK_FALSE(link.statistics.mean_delay_s.has_value());
}

}  // namespace test_turned_antennas
