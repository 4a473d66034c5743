/// A coverage map of an office: where does each of three transmitter sites reach, and which one is best?
///
/// Writes one picture per site into the current folder. The raster is coarse; `dcem map data/office_map.json` draws the
/// same office every 0.1 m.
#include <algorithm>
#include <cstdio>
#include <vector>

#include "dcem/dcem.hpp"
#include "dcem/io/map_writer.hpp"
#include "dcem/io/scenario.hpp"
#include "dcem/sim/simulator.hpp"

namespace {

/// Share of the points that receive at least `threshold_dbm` from one of the maps.
double covered_share(const std::vector<const dcem::RadioMap*>& maps, double threshold_dbm) {
  std::size_t covered = 0, points = 0;
  for (std::size_t index = 0; index < maps.front()->points.size(); ++index) {
    if (maps.front()->points[index].obstructed) continue;
    ++points;
    covered += std::any_of(maps.begin(), maps.end(), [&](const dcem::RadioMap* map) {
      return map->points[index].statistics.power_incoherent_dbm.value_or(-1e9) >= threshold_dbm;
    });
  }
  return static_cast<double>(covered) / static_cast<double>(std::max<std::size_t>(points, 1));
}

}  // namespace

int main() {
  const dcem::io::Scenario scenario = dcem::io::load_scenario(DCEM_DATA_DIR "/office_map_coarse.json");
  dcem::Simulator simulator(scenario.scene, scenario.settings);
  simulator.advance_to(scenario.time_s(0));
  const std::vector<dcem::RadioMap> maps = simulator.radio_maps(scenario.grids.at(0));

  constexpr double threshold_dbm = -80.0;
  std::vector<const dcem::RadioMap*> all;
  for (const dcem::RadioMap& map : maps) {
    all.push_back(&map);
    const std::string picture = "office_" + map.transmitter + ".png";
    const dcem::Frame frame = simulator.scene().frame_at(scenario.time_s(0));
    dcem::io::write_heat_map(dcem::io::map_picture(map, simulator.scene(), frame, scenario.settings.frequency_hz),
                             picture);
    std::printf("%-10s covers %5.1f %% of the floor at %.0f dBm: %s\n", map.transmitter.c_str(),
                100.0 * covered_share({&map}, threshold_dbm), threshold_dbm, picture.c_str());
  }
  std::printf("all sites cover %5.1f %%\n", 100.0 * covered_share(all, threshold_dbm));
}
