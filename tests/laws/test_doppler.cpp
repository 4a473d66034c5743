/// Doppler is the rate at which a path shortens, whatever moves: checked against differences of path lengths between
/// neighbouring instants. Motions come from scenario files.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <optional>
#include <string>

#include "dcem/io/scenario.hpp"
#include "tests/support/law_scenes.hpp"

namespace test_doppler {

using namespace dcem;
using namespace dcem::test;

namespace {

/// Writes a scenario over a scenery and reads it back.
io::Scenario scenario(const Patches& scenery, const std::string& objects, const std::string& devices,
                      const std::string& orders = R"("max_reflections": 3, "max_diffractions": 0)") {
  const TemporaryFolder folder;
  write_law_materials(folder / "laws.mtl");
  write_patches(folder / "scenery.obj", scenery);
  write_patches(folder / "screen.obj", {sheet(Vec3(0), Vec3(0, 3, 0), Vec3(0.3, 0, 2), "pec")});
  write_patches(folder / "curtain.obj", {sheet(Vec3(0), Vec3(0.4, 6, 0), Vec3(0, 0, 5), "glass")});
  {
    std::ofstream json(folder / "moving.json");
    json << R"({"format": "dcem-scenario/1", "scene": {"obj": "scenery.obj"}, "frequency_hz": 28e9,)"
         << R"("materials": {"metal": {"model": "pec"}}, "objects": [)" << objects << "], " << devices
         << R"(, "propagation": {"max_transmissions": 2, "discovery": "exact", )" << orders << "}}";
  }
  return io::load_scenario(folder / "moving.json");
}

struct Seen {
  double length_m, doppler_hz;
  Path path;
};

std::map<std::string, Seen> paths_at(Simulator& simulator, double time_s) {
  std::map<std::string, Seen> result;
  for (const LinkResult& link : simulator.advance_to(time_s).links) {
    const std::string receiver = simulator.scene().receivers()[link.receiver].id;
    for (const PathContribution& path : link.paths) {
      result[receiver + ":" + path_id(simulator.scene(), path.path)] = {path.path.length_m, path.doppler_hz, path.path};
    }
  }
  return result;
}

/// −L'(t)/λ from four neighbouring instants (Richardson); absent where the path is not there at all of them.
std::optional<double> shortening_hz(const std::string& id, const std::array<std::map<std::string, Seen>, 4>& around,
                                    double step_s) {
  std::array<double, 4> length{};
  for (std::size_t index = 0; index < 4; ++index) {
    const auto found = around[index].find(id);
    if (found == around[index].end()) return std::nullopt;
    length[index] = found->second.length_m;
  }
  const double wide = (length[3] - length[0]) / (4.0 * step_s), narrow = (length[2] - length[1]) / (2.0 * step_s);
  return -(4.0 * narrow - wide) / 3.0 * law_frequency_hz / 299'792'458.0;
}

struct Tally {
  std::size_t checked = 0, on_objects = 0, at_moving_edges = 0;
  double largest_hz = 0.0;
};

void check_doppler(Simulator& simulator, double time_s, Tally& tally) {
  constexpr double step_s = 5e-4;
  const std::array<std::map<std::string, Seen>, 4> around{
      paths_at(simulator, time_s - 2 * step_s), paths_at(simulator, time_s - step_s),
      paths_at(simulator, time_s + step_s), paths_at(simulator, time_s + 2 * step_s)};
  for (const auto& entry : paths_at(simulator, time_s)) {
    const std::string& id = entry.first;
    const Seen& seen = entry.second;
    const std::optional<double> expected = shortening_hz(id, around, step_s);
    if (!expected) continue;
    CAPTURE(id);
    // 2e-5 Hz: the next term of Richardson's formula, step⁴·L⁽⁵⁾/λ, is far below; lengths rounded to 1e-14 m leave
    // 1e-14/(5e-4·λ) = 2e-9 Hz, which a flat bounce on a turning plane magnifies.
    CHECK(std::abs(seen.doppler_hz - *expected) < 2e-5 + 1e-8 * std::abs(*expected));
    ++tally.checked;
    tally.on_objects += id.find('@') != std::string::npos;
    for (const Interaction& one : seen.path.interactions) {
      tally.at_moving_edges +=
          one.kind == InteractionKind::diffraction && simulator.scene().facet(one.facet).body != BodyId{};
    }
    tally.largest_hz = std::max(tally.largest_hz, std::abs(*expected));
  }
}

void check_times(io::Scenario read, std::size_t least_checked, std::size_t least_on_objects,
                 std::size_t least_at_moving_edges = 0) {
  Simulator simulator(std::move(read.scene), read.settings);
  Tally tally;
  for (int instant = 0; instant < 30; ++instant) check_doppler(simulator, 0.21 + 0.131 * instant, tally);
  MESSAGE(tally.checked << " paths, " << tally.on_objects << " over objects, " << tally.at_moving_edges
                        << " times at a moving edge, up to " << tally.largest_hz << " Hz");
  CHECK(tally.checked > least_checked);
  CHECK(tally.on_objects >= least_on_objects);
  CHECK(tally.at_moving_edges >= least_at_moving_edges);
  CHECK(tally.largest_hz > 1000.0);
}

const std::string free_devices =
    R"("transmitters": [{"id": "tx", "power_dbm": 0, "position_m": [-12, 4, 3.1], "velocity_mps": [9, -2, 0.3]}],
       "receivers": [{"id": "rx", "position_m": [14, -3, 1.7], "velocity_mps": [-17, 3, -0.1]},
                     {"id": "still", "position_m": [3, 9, 2.2]}])";

Patches street() {
  return {sheet(Vec3(0, 0, 0), Vec3(200, 0, 0), Vec3(0, 200, 0), "half_space"),
          sheet(Vec3(0, 16, 6), Vec3(90, 0, 0), Vec3(0, 0, 6), "opaque"),
          sheet(Vec3(0, -14, 6), Vec3(90, 1, 0), Vec3(0, 0, 6), "wall")};
}

}  // namespace

TEST_CASE("Doppler: moving devices, nothing else") {
  check_times(scenario(street(), "", free_devices), 300, 0);
}

TEST_CASE("Doppler: a mirror that comes closer at v shifts by 2·v·cosθ/λ") {
  const std::string objects =
      R"({"id": "mirror", "obj": "screen.obj", "motion": {"position_m": [8, 0, 3], "velocity_mps": [-6, 4, 0]}})";
  const std::string devices = R"("transmitters": [{"id": "tx", "power_dbm": 0, "position_m": [0, 1, 3]}],
                                 "receivers": [{"id": "rx", "position_m": [0, -1, 3.2]}])";
  io::Scenario read = scenario(street(), objects, devices);
  Simulator simulator(std::move(read.scene), read.settings);
  // The mirror's normal lies in the plane y = 0: from its edges (0, 3, 0) and (0.3, 0, 2) it is (2, 0, −0.3)/√4.09.
  const double normal_x = 2.0 / std::sqrt(4.09), normal_z = -0.3 / std::sqrt(4.09);
  bool found = false;
  for (const auto& [id, seen] : paths_at(simulator, 0.0)) {
    if (seen.path.interactions.size() != 1 || id.find("@mirror") == std::string::npos) continue;
    found = true;
    const Vec3 out = glm::normalize(seen.path.interactions[0].point_m - Vec3(0, 1, 3));
    const double cosine = std::abs(out.x * normal_x + out.z * normal_z);
    const double approach_mps = 6.0 * normal_x;  // the motion along y is within the mirror's plane
    CHECK(seen.doppler_hz == doctest::Approx(2.0 * approach_mps * cosine * 28e9 / 299'792'458.0).epsilon(1e-10));
  }
  CHECK(found);
}

TEST_CASE("Doppler: translating bodies, opaque and transmissive, and devices that ride") {
  const std::string objects = R"(
    {"id": "van", "box_m": [6, 2.4, 2.8], "material": "metal",
     "motion": {"position_m": [-9, 8, 0], "yaw_deg": 14, "velocity_mps": [5, -1.5, 0]}},
    {"id": "car", "box_m": [4, 1.8, 1.4], "material": "metal",
     "motion": {"waypoints": [{"t_s": 0, "position_m": [-30, -6, 0], "yaw_deg": 3},
                              {"t_s": 2, "position_m": [0, -5, 0], "yaw_deg": 3},
                              {"t_s": 5, "position_m": [40, -7, 0], "yaw_deg": 3}]}},
    {"id": "curtain", "obj": "curtain.obj", "motion": {"position_m": [1, 0, 4], "velocity_mps": [2, 1, 0.2]}})";
  const std::string devices =
      R"("transmitters": [{"id": "tx", "power_dbm": 0, "position_m": [-12, 4, 3.1], "velocity_mps": [9, -2, 0.3]}],
         "receivers": [{"id": "roof", "attach_to": "car", "offset_m": [0.5, 0.1, 1.6]},
                       {"id": "rx", "position_m": [14, -3, 1.7], "velocity_mps": [-3, 1, 0]}])";
  check_times(scenario(street(), objects, devices), 400, 100);
}

TEST_CASE("Doppler: bodies that turn, in yaw across ±180°, in pitch and in roll") {
  const std::string objects = R"(
    {"id": "turning", "box_m": [7, 3, 5], "material": "metal",
     "motion": {"waypoints": [{"t_s": 0, "position_m": [-3, 6, 0], "yaw_deg": 150},
                              {"t_s": 5, "position_m": [2, 7, 0], "yaw_deg": -100}]}},
    {"id": "screen", "obj": "screen.obj",
     "motion": {"waypoints": [{"t_s": 0, "position_m": [4, -8, 3], "yaw_deg": 80, "pitch_deg": -12, "roll_deg": 5},
                              {"t_s": 5, "position_m": [7, -7, 4], "yaw_deg": 130, "pitch_deg": 20, "roll_deg": -9}]}},
    {"id": "rider", "box_m": [4, 1.8, 1.4], "material": "metal",
     "motion": {"waypoints": [{"t_s": 0, "position_m": [10, 2, 0], "yaw_deg": 0},
                              {"t_s": 5, "position_m": [30, -6, 0], "yaw_deg": 200, "pitch_deg": 3}]}})";
  const std::string devices =
      R"("transmitters": [{"id": "tx", "power_dbm": 0, "position_m": [-12, 2, 3.1], "velocity_mps": [2, -1, 0.3]}],
         "receivers": [{"id": "arm", "attach_to": "rider", "offset_m": [1.9, 0.7, 1.7]},
                       {"id": "own", "attach_to": "rider", "offset_m": [-1.2, 0.2, 2.3], "sees_own_body": true},
                       {"id": "rx", "position_m": [14, -3, 1.7], "velocity_mps": [-17, 3, -0.1]}])";
  check_times(scenario(street(), objects, devices), 400, 60);
}

TEST_CASE("Doppler: edges of a box that drives and turns, in yaw, pitch and roll, between ends that move") {
  const std::string objects = R"(
    {"id": "truck", "box_m": [7, 3, 4], "material": "metal",
     "motion": {"waypoints": [{"t_s": 0, "position_m": [-3, 4, 0.3], "yaw_deg": 150},
                              {"t_s": 5, "position_m": [12, -1, 0.6], "yaw_deg": -100, "pitch_deg": 8, "roll_deg": -5}]}},
    {"id": "van", "box_m": [5, 2, 2.5], "material": "metal",
     "motion": {"position_m": [4, -6, 0], "yaw_deg": 20, "velocity_mps": [-6, 2, 0]}})";
  const std::string devices =
      R"("transmitters": [{"id": "tx", "power_dbm": 0, "position_m": [-12, 2, 3.1], "velocity_mps": [12, -1, 0.3]}],
         "receivers": [{"id": "roof", "attach_to": "van", "offset_m": [0.5, 0.1, 2.9]},
                       {"id": "low", "position_m": [14, -3, 1.1], "velocity_mps": [-17, 3, -0.1]},
                       {"id": "still", "position_m": [6, 9, 2.2]}])";
  check_times(scenario(street(), objects, devices, R"("max_reflections": 1, "max_diffractions": 1)"), 1000, 400, 300);
}

TEST_CASE("Doppler: two edges in a row, of two boxes that move") {
  const std::string objects = R"(
    {"id": "truck", "box_m": [7, 3, 4], "material": "metal",
     "motion": {"waypoints": [{"t_s": 0, "position_m": [-3, 1, 0.3], "yaw_deg": 150},
                              {"t_s": 5, "position_m": [4, -1, 0.6], "yaw_deg": 190, "roll_deg": -5}]}},
    {"id": "van", "box_m": [5, 2, 2.5], "material": "metal",
     "motion": {"position_m": [9, -6, 0], "yaw_deg": 20, "velocity_mps": [-1, 2, 0]}})";
  const std::string devices =
      R"("transmitters": [{"id": "tx", "power_dbm": 0, "position_m": [-12, 2, 1.1], "velocity_mps": [2, -1, 0.3]}],
         "receivers": [{"id": "low", "position_m": [18, -3, 1.2], "velocity_mps": [-17, 3, -0.1]}])";
  check_times(scenario(street(), objects, devices, R"("max_reflections": 0, "max_diffractions": 2)"), 100, 100, 200);
}

}  // namespace test_doppler
