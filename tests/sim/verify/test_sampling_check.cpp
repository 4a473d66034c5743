/// What rays lack is told from links that are searched again.
#include "dcem/sim/verify/sampling_check.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "dcem/io/scenario.hpp"
#include "dcem/sim/simulator.hpp"

namespace test_sampling_check {

using namespace dcem;

namespace {

/// Points on the streets of the town whose drive ships with DCEM.
struct Town {
  io::Scenario scenario = io::load_scenario(std::filesystem::path(DCEM_DATA_DIR) / "town_drive.json");
  std::vector<Device> receivers;

  Town() {
    scenario.settings.threads = 1;
    for (int row = 0; row < 6; ++row) {
      for (int column = 0; column < 4; ++column) {
        Device device;
        device.id = "street" + std::to_string(4 * row + column);
        device.motion = LinearMotion{{Vec3(-100.0 + 30.0 * row, -6.0 + 4.0 * column, 1.5)}, Vec3(0.0), 0.0};
        receivers.push_back(device);
      }
    }
  }

  Simulator simulator(Discovery discovery, std::uint32_t rays, int max_interactions = 2) const {
    SimulationSettings settings = scenario.settings;
    settings.propagation.discovery = discovery;
    settings.propagation.rays = rays;
    settings.propagation.max_interactions = max_interactions;
    settings.propagation.max_reflections = std::max(2, max_interactions);
    return {scenario.scene, settings};
  }

  SamplingReport check(const Simulator& simulator, std::size_t most_receivers = 24) const {
    const Frame frame = simulator.scene().frame_at(0.0, 0);
    WorkCounters work;
    const std::vector<LinkResult> links = simulator.solve(receivers, &work);
    return check_sampling(simulator, frame, {receivers, links, work.sequences_proposed}, most_receivers);
  }
};

}  // namespace

TEST_CASE("what two searches of a link find is told apart by path, and by power") {
  SamplingReport report;
  report.links = {{4, 4, 0.0}, {1, 4, 3.0}, {0, 2, 0.0}, {0, 0, 0.0}};
  CHECK(*report.recall() == doctest::Approx(0.5));
  CHECK(report.links_not_reached() == 1);
  CHECK(report.missing_db(0.5) == 0.0);  // of the two links on which rays found something
  CHECK(report.missing_db(1.0) == 3.0);
  CHECK_FALSE(SamplingReport{}.recall().has_value());
  report.links = {{0, 2, 0.0}};
  CHECK(report.recall() == 0.0);
  CHECK_FALSE(report.missing_db(0.5).has_value());
}

TEST_CASE("where nothing is left to rays nothing is checked") {
  const Town town;
  const SamplingReport report = town.check(town.simulator(Discovery::automatic, 2000));
  CHECK_FALSE(report.is_sampled);
  CHECK(report.links.empty());
}

TEST_CASE("in a town the check says by how much rays fall short of an exact search, and less for more rays") {
  const Town town;
  double last = 0.0;
  for (const std::uint32_t rays : {500U, 5000U, 50'000U}) {
    const SamplingReport report = town.check(town.simulator(Discovery::sampled, rays));
    CHECK(report.exact);
    CHECK(report.rays == rays);
    REQUIRE(report.links.size() > 20);
    MESSAGE(rays << " rays find " << *report.recall() << " of the paths; missing " << *report.missing_db(0.5) << ", "
                 << *report.missing_db(0.95) << " dB; not reached " << report.links_not_reached());
    CHECK(report.recall() > last);
    CHECK(report.recall() < 1.0);
    last = *report.recall();
  }
  CHECK(last > 0.7);
}

TEST_CASE("beyond what exact search covers ten times as many rays are the measure") {
  const Town town;
  const SamplingReport report = town.check(town.simulator(Discovery::automatic, 500, 4), 4);
  CHECK_FALSE(report.exact);
  CHECK(report.reference_rays == 5000);
  REQUIRE(report.links.size() == 4 * town.scenario.scene.transmitters().size());
  CHECK(report.recall() < 1.0);
  CHECK(report.missing_db(1.0) > 0.0);
}

TEST_CASE("a second search takes fewer receivers, then fewer rays, and is left out, rather than take long") {
  const Town town;
  const Simulator simulator = town.simulator(Discovery::automatic, 500, 4);
  const Frame frame = simulator.scene().frame_at(0.0, 0);
  const std::vector<LinkResult> links = simulator.solve(town.receivers);
  const auto report_of = [&](std::uint64_t sequences_of_one) {
    return check_sampling(simulator, frame, {town.receivers, links, sequences_of_one * town.receivers.size()}, 4);
  };
  const std::size_t transmitters = town.scenario.scene.transmitters().size();
  CHECK(report_of(200'000).links.size() == 2 * transmitters);  // ten times 200,000 for each of two
  CHECK(report_of(200'000).reference_rays == 5000);
  CHECK(report_of(1'000'000).links.size() == transmitters);
  CHECK(report_of(1'000'000).reference_rays == 2000);  // four times as many for one
  CHECK(report_of(3'000'000).is_sampled);
  CHECK(report_of(3'000'000).links.empty());
}

TEST_CASE("an exact search that tries all sequences is no second search: it may take days") {
  // A closed room of six facets: ten reflections are millions of sequences, which a search by name may try.
  TriangleMesh room;
  for (const double z : {0.0, 3.0})
    add_quad(room, {Vec3(0, 0, z), Vec3(5, 0, z), Vec3(5, 4, z), Vec3(0, 4, z)}, "metal");
  for (const double y : {0.0, 4.0})
    add_quad(room, {Vec3(0, y, 0), Vec3(5, y, 0), Vec3(5, y, 3), Vec3(0, y, 3)}, "metal");
  for (const double x : {0.0, 5.0})
    add_quad(room, {Vec3(x, 0, 0), Vec3(x, 4, 0), Vec3(x, 4, 3), Vec3(x, 0, 3)}, "metal");
  Scene scene;
  scene.add_material({"metal", PerfectConductor{}});
  scene.set_scenery(room);
  Device device;
  device.id = "tx";
  device.motion = LinearMotion{{Vec3(1, 1.2, 2.1)}, Vec3(0.0), 0.0};
  scene.add_transmitter(device);
  device.id = "rx";
  device.motion = LinearMotion{{Vec3(3.7, 2.9, 1.3)}, Vec3(0.0), 0.0};
  scene.add_receiver(device);
  SimulationSettings settings;
  settings.frequency_hz = 5e9;
  settings.threads = 1;
  settings.propagation.max_reflections = 10;
  settings.propagation.max_diffractions = 0;
  settings.propagation.discovery = Discovery::sampled;
  settings.propagation.rays = 300;
  Simulator simulator(scene, settings);
  const FrameResult frame = simulator.advance_to(0.0);
  const SamplingReport report =
      check_sampling(simulator, simulator.scene().frame_at(0.0),
                     {simulator.scene().receivers(), frame.links, frame.work.sequences_proposed});
  CHECK_FALSE(report.exact);
}

}  // namespace test_sampling_check
