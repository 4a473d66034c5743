/// A point of a map is a receiver: whatever a map shares among its points, it gives what a run gives, to the last bit.
#include <doctest/doctest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "dcem/io/scenario.hpp"
#include "dcem/sim/simulator.hpp"
#include "tests/io/temporary_folder.hpp"

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
  // Exact, with cars and a sheet of glass in the way. Left to itself a map looks for a third interaction by rays, and a
  // run does not.
  struct Case {
    int interactions;
    Discovery discovery;
    std::size_t columns, rows;
  };
  for (const auto& [interactions, discovery, columns, rows] :
       {Case{2, Discovery::automatic, 9, 7}, Case{3, Discovery::automatic, 9, 7}, Case{3, Discovery::exact, 3, 2}}) {
    io::Scenario scenario = io::load_scenario(std::filesystem::path(DCEM_DATA_DIR) / "town_drive.json");
    PropagationSettings& propagation = scenario.settings.propagation;
    propagation.discovery = discovery;
    propagation.cache = CacheMode::off;
    propagation.max_interactions = interactions;
    propagation.rays = 200;
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
    const bool same_plan = simulator.plan().discovery == simulator.map_plan().discovery;
    CHECK(same_plan == (interactions == 2 || discovery == Discovery::exact));
    std::size_t open = 0, paths = 0;
    for (const LinkResult& link : simulator.solve(points)) {
      for (const std::vector<RadioMap>& map : maps) {
        const RadioMapPoint& point = map[link.transmitter].points[link.receiver];
        CAPTURE(link.receiver);
        if (point.obstructed) continue;
        CHECK(same_bits(point.statistics,
                        same_plan ? link.statistics : maps[0][link.transmitter].points[link.receiver].statistics));
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
