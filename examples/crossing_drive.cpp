/// A car drives through a street crossing: received power, line of sight and Doppler of the strongest path, frame by
/// frame.
#include <algorithm>
#include <cstdio>

#include "dcem/dcem.hpp"
#include "dcem/io/scenario.hpp"
#include "dcem/sim/simulator.hpp"

namespace {

/// One line per link: what changes while the car passes the corner.
void print(const dcem::LinkResult& link, double time_s) {
  std::printf("%6.1f s  %-4s", time_s, link.statistics.line_of_sight ? "LOS" : "");
  if (link.paths.empty()) {
    std::puts("  no path");
    return;
  }
  const auto strongest = std::max_element(link.paths.begin(), link.paths.end(),
                                          [](const auto& a, const auto& b) { return a.power_ratio < b.power_ratio; });
  std::printf("%4zu paths  %8.2f dBm  strongest %-3s %+9.1f Hz\n", link.paths.size(),
              link.statistics.power_incoherent_dbm.value_or(0.0),
              strongest->path.interactions.empty() ? "LOS" : dcem::kinds(strongest->path).c_str(),
              strongest->doppler_hz);
}

}  // namespace

int main() {
  const dcem::io::Scenario scenario = dcem::io::load_scenario(DCEM_DATA_DIR "/crossing_drive.json");
  dcem::Simulator simulator(scenario.scene, scenario.settings);
  for (std::size_t frame = 0; frame < scenario.time.frames; frame += 5) {
    const dcem::FrameResult result = simulator.advance_to(scenario.time_s(frame), frame);
    for (const dcem::LinkResult& link : result.links) print(link, result.time_s);
  }
}
