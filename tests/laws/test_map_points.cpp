/// A point of a map is a receiver: whatever a map shares among its points, it gives what a run gives, to the last bit.
#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "dcem/channel/cell_average.hpp"
#include "dcem/io/scenario.hpp"
#include "dcem/sim/simulator.hpp"
#include "tests/io/temporary_folder.hpp"

namespace test_map_points {

using namespace dcem;

namespace {

/// The office with rough walls and arrays at both ends, over a coarse grid.
io::Scenario rough_office(const test::TemporaryFolder& folder, const std::string& discovery) {
  for (const char* file : {"office.obj", "office.mtl"}) {
    std::filesystem::copy_file(std::filesystem::path(DCEM_DATA_DIR) / file, folder / file,
                               std::filesystem::copy_options::overwrite_existing);
  }
  std::string text = test::file_bytes(std::filesystem::path(DCEM_DATA_DIR) / "office_map_diffuse.json");
  const auto replace_all = [&](const std::string& what, const std::string& by) {
    REQUIRE(text.find(what) != std::string::npos);
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size())) {
      text.replace(at, what.size(), by);
    }
  };
  replace_all(R"("polarization": "V")", R"("polarization": {"slant_deg": 45}, "array": {"rows": 1, "columns": 2})");
  replace_all(R"("spacing_m": [0.2, 0.2], "count": [100, 60])", R"("spacing_m": [3.05, 2.8], "count": [7, 4])");
  replace_all(R"("diffuse": {"enabled": true})", R"("diffuse": {"tolerance_db": 1, "tile_budget": 2000}, "rays": 300)");
  replace_all(R"("discovery": "exact")", R"("discovery": ")" + discovery + "\"");
  std::ofstream(folder / "office.json") << text;
  return io::load_scenario(folder / "office.json");
}

bool same_bits(const std::optional<double>& one, const std::optional<double>& other) {
  return one.has_value() == other.has_value() && (!one || std::memcmp(&*one, &*other, sizeof(double)) == 0);
}

bool same_bits(const LinkStatistics& one, const LinkStatistics& other) {
  return one.line_of_sight == other.line_of_sight && one.path_count == other.path_count &&
         same_bits(one.power_dbm, other.power_dbm) && same_bits(one.path_gain_db, other.path_gain_db) &&
         same_bits(one.power_incoherent_dbm, other.power_incoherent_dbm) &&
         same_bits(one.power_diffracted_dbm, other.power_diffracted_dbm) &&
         same_bits(one.power_diffuse_dbm, other.power_diffuse_dbm) && same_bits(one.mean_delay_s, other.mean_delay_s) &&
         same_bits(one.rms_delay_spread_s, other.rms_delay_spread_s);
}

}  // namespace

TEST_CASE("a map equals a run point by point, with diffuse power and arrays, whatever it shares") {
  const test::TemporaryFolder folder;
  for (const std::string discovery : {"exact", "sampled"}) {
    io::Scenario scenario = rough_office(folder, discovery);
    const ReceiverGrid grid = scenario.grids.at(0);
    std::vector<RadioMap> maps;
    for (const bool share : {true, false}) {
      SimulationSettings settings = scenario.settings;
      settings.share_map_work = share;
      Simulator simulator(scenario.scene, settings);
      simulator.advance_to(0.0);
      maps.push_back(simulator.radio_maps(grid).at(0));
    }
    for (std::size_t cell = 0; cell < grid.size(); ++cell) {
      scenario.scene.add_receiver(grid_receiver(grid, cell / grid.columns(), cell % grid.columns()));
    }
    Simulator simulator(scenario.scene, scenario.settings);
    const FrameResult run = simulator.advance_to(0.0);
    REQUIRE(run.links.size() == grid.size());
    std::size_t diffuse = 0, diffracted = 0;
    for (const LinkResult& link : run.links) {
      for (const RadioMap& map : maps) {
        const RadioMapPoint& point = map.points[link.receiver];
        CAPTURE(link.receiver);
        if (!point.obstructed) CHECK(same_bits(point.statistics, link.statistics));
      }
      diffuse += link.statistics.power_diffuse_dbm.has_value();
      diffracted += link.statistics.power_diffracted_dbm.has_value();
    }
    CHECK(diffuse > 20);
    CHECK(diffracted > 20);
  }
}

TEST_CASE("points of a town's map that look together find what each finds by itself, and what a run finds") {
  // Exact, with cars and a sheet of glass in the way.
  struct Case {
    int interactions;
    std::size_t columns, rows;
  };
  for (const auto& [interactions, columns, rows] : {Case{2, 9, 7}, Case{3, 4, 3}}) {
    io::Scenario scenario = io::load_scenario(std::filesystem::path(DCEM_DATA_DIR) / "town_drive.json");
    PropagationSettings& propagation = scenario.settings.propagation;
    propagation.discovery = Discovery::automatic;
    propagation.cache = CacheMode::off;
    propagation.max_interactions = interactions;
    ReceiverGrid grid;
    grid.id = "map";
    grid.spacing_m = {2.0, 1.5};
    grid.count = {columns, rows};
    grid.origin_m =
        scenario.scene.device_state(scenario.scene.receivers()[0], scenario.scene.frame_at(4.0)).position_m +
        Vec3(-8.0, -4.5, 0.0);
    std::vector<std::vector<RadioMap>> maps;
    std::vector<WorkCounters> work(2);
    for (const bool share : {true, false}) {
      SimulationSettings settings = scenario.settings;
      settings.share_map_work = share;
      Simulator simulator(scenario.scene, settings);
      simulator.move_to(simulator.scene().frame_at(4.0));
      maps.push_back(simulator.radio_maps(grid, {}, &work[share ? 0 : 1]));
    }
    std::vector<Device> points;
    for (std::size_t cell = 0; cell < grid.size(); ++cell) {
      points.push_back(grid_receiver(grid, cell / grid.columns(), cell % grid.columns()));
    }
    Simulator simulator(scenario.scene, scenario.settings);
    simulator.move_to(simulator.scene().frame_at(4.0));
    std::size_t open = 0, paths = 0;
    for (const LinkResult& link : simulator.solve(points)) {
      for (const std::vector<RadioMap>& map : maps) {
        const RadioMapPoint& point = map[link.transmitter].points[link.receiver];
        CAPTURE(link.receiver);
        if (point.obstructed) continue;
        CHECK(same_bits(point.statistics, link.statistics));
        ++open;
        paths += link.paths.size();
      }
    }
    MESSAGE(open << " links, " << paths << " paths, " << work[0].sequences_solved << " sequences solved instead of "
                 << work[1].sequences_solved);
    CHECK(open > columns * rows);
    CHECK(paths > 1'000);
    if (interactions == 2) CHECK(work[0].sequences_solved < work[1].sequences_solved);
  }
}

TEST_CASE("the mean over a cell is that of runs at its samples, and progress counts them all") {
  const test::TemporaryFolder folder;
  const io::Scenario scenario = rough_office(folder, "exact");
  ReceiverGrid grid = scenario.grids.at(0);
  grid.count = {4, 2};
  grid.samples = {3, 2};
  Simulator simulator(scenario.scene, scenario.settings);
  simulator.advance_to(0.0);
  std::atomic<std::size_t> done = 0;
  const RadioMap map = simulator.radio_maps(grid, [&](std::size_t points) { done += points; }).at(0);
  CHECK(done == grid.size() * 6);
  REQUIRE(map.points.size() == grid.size());
  const ReceiverGrid fine = sample_grid(grid);
  const RadioMap samples = simulator.radio_maps(fine).at(0);
  std::vector<Device> receivers;
  for (std::size_t at = 0; at < fine.size(); ++at) {
    receivers.push_back(grid_receiver(fine, at / fine.columns(), at % fine.columns()));
  }
  std::vector<double> powers_mw(grid.size(), 0.0);
  std::vector<int> open(grid.size(), 0);
  for (const LinkResult& link : simulator.solve(receivers)) {
    const RadioMapPoint& sample = samples.points[link.receiver];
    if (sample.obstructed) continue;
    CHECK(same_bits(sample.statistics, link.statistics));
    const std::size_t row = link.receiver / fine.columns() / 2, column = link.receiver % fine.columns() / 3;
    powers_mw[row * grid.columns() + column] += std::pow(10.0, 0.1 * link.statistics.power_dbm.value());
    ++open[row * grid.columns() + column];
  }
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    CAPTURE(cell);
    CHECK(map.points[cell].obstructed == (open[cell] == 0));
    CHECK(map.points[cell].position_m == grid_point_m(grid, cell / grid.columns(), cell % grid.columns()));
    if (open[cell] == 0) continue;
    CHECK(map.points[cell].statistics.power_dbm.value() ==
          doctest::Approx(10.0 * std::log10(powers_mw[cell] / open[cell])).epsilon(1e-12));
  }
}

TEST_CASE("a list of points has the values of a run there, whatever neighbours share") {
  struct Case {
    int interactions;
    std::size_t points;
  };
  // Along the street as a car drives, some of them on a wall or inside a house; exact by itself up to three.
  for (const auto& [interactions, points] : {Case{2, 60}, Case{3, 12}}) {
    io::Scenario scenario = io::load_scenario(std::filesystem::path(DCEM_DATA_DIR) / "town_drive.json");
    PropagationSettings& propagation = scenario.settings.propagation;
    propagation.discovery = Discovery::automatic;
    propagation.cache = CacheMode::off;
    propagation.max_interactions = interactions;
    const Vec3 start_m =
        scenario.scene.device_state(scenario.scene.receivers()[0], scenario.scene.frame_at(4.0)).position_m;
    const auto corners_m = scenario.scene.corners_m(0);
    ReceiverList list{"route", {}};
    for (std::size_t index = 0; index < points; ++index) {
      const double along_m = static_cast<double>(index);
      const double climb_m = 0.4 * static_cast<double>(index % 5);  // no plane, as a grid is
      const Vec3 place_m = index % 10 == 9 ? (corners_m[0] + corners_m[1] + corners_m[2]) / 3.0
                                           : start_m + Vec3(0.9 * along_m, 0.2 * along_m, climb_m);
      Device device = device_at("route[" + std::to_string(index) + "]", place_m);
      if (index % 10 == 8) device.motion = LinearMotion{{place_m}, Vec3(1.0, 0.0, 0.0), 0.0};
      list.receivers.push_back(device);
    }
    std::vector<std::vector<RadioMap>> maps;
    std::vector<WorkCounters> work(2);
    std::vector<LinkResult> links;
    for (const bool share : {true, false}) {
      SimulationSettings settings = scenario.settings;
      settings.share_map_work = share;
      Simulator simulator(scenario.scene, settings);
      simulator.move_to(simulator.scene().frame_at(4.0));
      std::atomic<std::size_t> done = 0;
      maps.push_back(simulator.radio_maps(
          list, [&](std::size_t more) { done += more; }, &work[share ? 0 : 1]));
      CHECK(done == points);
      if (share) links = simulator.solve(list.receivers);
    }
    std::size_t paths = 0;
    for (const LinkResult& link : links) {
      for (const std::vector<RadioMap>& of : maps) {
        const RadioMapPoint& point = of[link.transmitter].points[link.receiver];
        CAPTURE(link.receiver);
        CHECK_FALSE(of[link.transmitter].places.is_grid());
        CHECK_FALSE(point.obstructed);
        CHECK(same_bits(point.statistics, link.statistics));
      }
      paths += link.paths.size();
    }
    CHECK(glm::distance(maps[0][0].points[8].position_m, start_m + Vec3(7.2 + 4.0, 1.6, 1.2)) < 1e-9);
    CHECK(paths > 100);
    MESSAGE(paths << " paths, " << work[0].sequences_solved << " sequences solved instead of "
                  << work[1].sequences_solved);
    if (interactions == 2) CHECK(work[0].sequences_solved < work[1].sequences_solved);
  }
}

}  // namespace test_map_points
