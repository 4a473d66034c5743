/// The shipped office with rough walls: what the refinement says has converged against a fine and even grid of points,
/// which knows nothing of bounds and estimates.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "dcem/core/random.hpp"
#include "dcem/io/scenario.hpp"
#include "dcem/sim/simulator.hpp"
#include "tests/io/temporary_folder.hpp"
#include "tests/support/even_grid.hpp"

namespace test_diffuse_power_slow {

using namespace dcem;
using namespace dcem::test;

namespace {

/// data/office_map.json with materials that scatter, S = 0.4.
io::Scenario rough_office() {
  const TemporaryFolder folder;
  const std::filesystem::path data(DCEM_DATA_DIR);
  for (const char* name : {"office.obj", "office.mtl"}) std::filesystem::copy_file(data / name, folder / name);
  std::ifstream stream(data / "office_map.json");
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  const std::string key = "\"scene\"", materials = R"("materials": {
    "wall": {"model": "constant", "reflection": 0.7, "penetration_loss_db": 20, "scattering": 0.4},
    "glass": {"model": "constant", "reflection": 0.74, "penetration_loss_db": 5, "scattering": 0.4},
    "floor": {"model": "constant", "reflection": 0.7, "scattering": 0.4, "scattering_pattern": "directive"},
    "ceiling": {"model": "constant", "reflection": 0.7, "scattering": 0.4}}, )";
  REQUIRE(text.find(key) != std::string::npos);
  text.insert(text.find(key), materials);
  std::ofstream(folder / "office.json") << text;
  return io::load_scenario(folder / "office.json");
}

}  // namespace

TEST_CASE("diffuse power in the office: what has converged is within its tolerance, and the residual covers the rest") {
  const io::Scenario office = rough_office();
  SimulationSettings settings = office.settings;
  settings.propagation.max_reflections = settings.propagation.max_diffractions = 0;
  settings.propagation.diffuse.enabled = true;
  Scene scene = office.scene;
  scene.apply(scene.frame_at(0.0));
  const Illuminated world(scene, settings.frequency_hz);

  RandomStream random(31);
  std::vector<Device> receivers;
  TraversalCounters counters;
  while (receivers.size() < 10) {
    const Vec3 position_m(0.5 + 19.0 * random.uniform(), 0.5 + 11.0 * random.uniform(), 1.5);
    if (!world.tracer.facets_near(position_m, 0.4, {}, counters).empty()) continue;
    receivers.push_back(device_at("rx" + std::to_string(receivers.size()), position_m));
  }
  // Shadows that a grid sees by slivers make it err; grids of larger cells show by how much.
  struct Even {
    double power, error;
  };
  const auto even = [&](const LinkResult& link, double cell_m) {
    const Vec3 from_m = scene.device_state(scene.transmitters()[link.transmitter], {}).position_m;
    const Vec3 to_m = scene.device_state(receivers[link.receiver], {}).position_m;
    const double power = grid_power(world, from_m, to_m, cell_m, 2);
    double error = 0.0;
    for (const double larger : {1.4, 2.0}) {
      error = std::max(error, std::abs(power - grid_power(world, from_m, to_m, larger * cell_m, 2)));
    }
    return Even{power, error};
  };
  std::size_t converged = 0, told = 0;
  for (const double tolerance_db : {1.0, 0.1}) {
    CAPTURE(tolerance_db);
    settings.propagation.diffuse.tolerance_db = tolerance_db;
    Simulator simulator(office.scene, settings);
    simulator.move_to(simulator.scene().frame_at(0.0));
    for (const LinkResult& link : simulator.solve(receivers)) {
      CAPTURE(link.transmitter);
      CAPTURE(link.receiver);
      if (tolerance_db == 1.0 && !link.diffuse.converged) continue;  // the budget is spent, the same in both runs
      const auto allowed_of = [&](double power) { return (std::pow(10.0, 0.1 * tolerance_db) - 1.0) * power; };
      double cell_m = link.diffuse.converged && tolerance_db == 0.1 ? 0.06 : 0.15;
      Even expected = even(link, cell_m);
      // Behind many walls little is seen, and by finer cells.
      while (expected.error > 0.5 * allowed_of(expected.power) && cell_m > 0.03) {
        cell_m *= 0.5;
        expected = even(link, cell_m);
      }
      REQUIRE(expected.power > 0.0);
      const double difference = std::abs(link.diffuse.power_ratio - expected.power);
      CHECK(difference <= link.diffuse.residual_ratio + expected.error);
      if (!link.diffuse.converged) continue;
      const double allowed = allowed_of(expected.power);
      CHECK(difference <= allowed + expected.error);
      ++converged;
      told += expected.error < allowed;  // or this comparison says nothing
    }
  }
  MESSAGE(converged << " have converged");
  CHECK(converged > 5);
  CHECK(told > 50);  // of the floor one receiver, behind two walls, sees 0.02 m²
}

TEST_CASE("diffuse power of a wall behind a bus: what has converged is within its tolerance, shadow or not") {
  RandomStream random(11);
  const auto between = [&](double low, double high) { return low + (high - low) * random.uniform(); };
  for (int trial = 0; trial < 40; ++trial) {
    CAPTURE(trial);
    Scene scene;
    scene.add_material({"wall", ConstantReflection{0.7, {}}, 0.0, {0.4}});
    scene.add_material({"metal", PerfectConductor{}});
    TriangleMesh wall;
    add_quad(wall, {Vec3(-15, 0, 0), Vec3(15, 0, 0), Vec3(15, 0, 12), Vec3(-15, 0, 12)}, "wall");
    scene.set_scenery(wall);
    const Vec3 size_m(between(1, 12), between(0.5, 3), between(1.5, 4));
    const Pose pose{Vec3(between(-8, 8), between(4, 8), 0), between(-0.5, 0.5)};
    scene.add_object("bus", make_box(size_m, "metal"), LinearMotion{pose});
    const Vec3 from_m(between(-15, 15), between(10, 14), between(1, 3));
    const Vec3 to_m(between(-15, 15), between(10, 20), between(1, 10));
    scene.add_transmitter(device_at("tx", from_m));
    scene.add_receiver(device_at("rx", to_m));
    scene.apply(scene.frame_at(0.0));
    SimulationSettings settings;
    settings.threads = 1;
    settings.propagation.discovery = Discovery::exact;
    settings.propagation.max_reflections = settings.propagation.max_diffractions = 0;
    settings.propagation.diffuse.enabled = true;
    Simulator simulator(scene, settings);
    const FrameResult frame = simulator.advance_to(0.0);
    const DiffusePower& power = frame.links.at(0).diffuse;

    const Illuminated world(scene, settings.frequency_hz);
    const double even = grid_power(world, from_m, to_m, 0.1, 2);
    // Cells of 0.04 m changed none of these by more than 0.021 dB.
    if (power.converged) CHECK(std::abs(10.0 * std::log10(power.power_ratio / even)) < 0.1 + 0.03);
  }
}

}  // namespace test_diffuse_power_slow
