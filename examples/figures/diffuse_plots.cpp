/// What diffuse scattering adds in an office, drawn: coverage without and with it, the difference, and a power delay
/// profile with its specular and its diffuse share.
///
/// Writes three PNG and one SVG into the current folder. The raster is coarse; `dcem map data/office_map_diffuse.json`
/// draws the same office every 0.2 m.
#include <algorithm>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "dcem/channel/power_delay_profile.hpp"
#include "dcem/dcem.hpp"
#include "dcem/io/line_chart.hpp"
#include "dcem/io/map_writer.hpp"
#include "dcem/io/scenario.hpp"
#include "dcem/sim/simulator.hpp"

namespace {

constexpr double bin_s = 1e-9, floor_dbm = -100.0;
constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

dcem::Simulator office(const dcem::io::Scenario& scenario, bool diffuse) {
  dcem::SimulationSettings settings = scenario.settings;
  settings.propagation.diffuse.enabled = diffuse;
  settings.propagation.diffuse.tolerance_db = 0.5;  // what the colours of a picture can show
  settings.propagation.diffuse.tile_budget = 3000;
  return {scenario.scene, settings};
}

dcem::io::HeatMap picture(const dcem::Simulator& simulator, const dcem::RadioMap& map) {
  return dcem::io::map_picture(map, simulator.scene(), simulator.scene().frame_at(0.0),
                               simulator.settings().frequency_hz);
}

void draw_maps(const dcem::io::Scenario& scenario) {
  dcem::ReceiverGrid grid = scenario.grids.at(0);
  grid.origin_m += dcem::Vec3(0.15, 0.15, 0.0);
  grid.spacing_m = {0.5, 0.5};
  grid.count = {40, 24};
  const dcem::Simulator without = office(scenario, false), with = office(scenario, true);
  dcem::io::HeatMap off = picture(without, without.radio_maps(grid).at(0));
  dcem::io::HeatMap on = picture(with, with.radio_maps(grid).at(0));
  off.range = on.range = dcem::io::default_value_range(on);
  off.title = "Office at 30 GHz without diffuse power";
  on.title = "Office at 30 GHz with diffuse power";
  dcem::io::HeatMap gain = on;
  gain.title = "What diffuse power adds";
  gain.label = "gain";
  gain.unit = "dB";
  gain.range.reset();
  for (std::size_t cell = 0; cell < gain.values.size(); ++cell) gain.values[cell] = on.values[cell] - off.values[cell];
  dcem::io::write_heat_map(off, "diffuse_office_off.png");
  dcem::io::write_heat_map(on, "diffuse_office_on.png");
  dcem::io::write_heat_map(gain, "diffuse_office_gain.png");
}

/// Vertical lines, which a chart draws as lines with gaps; from the top, so that dashes begin there.
/// `place` is where in its bin a bar stands, so that two of them can be told apart.
dcem::io::LineChart::Series bars(const std::string& name, const std::vector<dcem::PdpTap>& taps, double place,
                                 double (*power)(const dcem::PdpTap&), double power_dbm) {
  dcem::io::LineChart::Series series{name};
  for (const dcem::PdpTap& tap : taps) {
    const double level_dbm = power(tap) > 0.0 ? power_dbm + dcem::power_ratio_to_db(power(tap)) : nothing;
    const double delay_ns = 1e9 * (tap.delay_s + place * bin_s);
    if (!(level_dbm > floor_dbm)) continue;
    for (const double value : {level_dbm, floor_dbm, nothing}) {
      series.x.push_back(delay_ns);
      series.y.push_back(value);
    }
  }
  return series;
}

double specular(const dcem::PdpTap& tap) {
  return tap.power_ratio - tap.diffuse_power_ratio;
}
double diffuse(const dcem::PdpTap& tap) {
  return tap.diffuse_power_ratio;
}

void draw_profile(const dcem::io::Scenario& scenario) {
  dcem::Simulator simulator = office(scenario, true);
  simulator.advance_to(0.0);
  const std::vector<dcem::Device> receivers{dcem::device_at("room", {11.3, 3.1, 1.5})};
  const dcem::LinkResult link = simulator.solve(receivers).at(0);
  const double power_dbm = simulator.scene().transmitters()[0].power_dbm;
  const auto taps =
      dcem::power_delay_profile(link.paths, power_samples(link.diffuse), bin_s, dcem::PdpMode::incoherent);
  dcem::io::LineChart chart;
  chart.title = "Power delay profile in a room beside the corridor, bins of 1 ns";
  chart.x_label = "delay";
  chart.x_unit = "ns";
  chart.y_label = "received power";
  chart.y_unit = "dBm";
  chart.series = {bars("specular paths", taps, 0.35, specular, power_dbm),
                  bars("diffuse", taps, 0.65, diffuse, power_dbm)};
  dcem::io::write_line_charts({&chart, 1}, "diffuse_profile.svg");
  std::printf("in the room: %.1f dBm specular, %.1f dBm diffuse, %zu tiles\n",
              power_dbm + dcem::power_ratio_to_db(dcem::power_moments(power_samples(link.paths, {}))->power_ratio),
              *link.statistics.power_diffuse_dbm, link.diffuse.tiles.size());
}

}  // namespace

int main() {
  const dcem::io::Scenario scenario = dcem::io::load_scenario(DCEM_DATA_DIR "/office_map_diffuse.json");
  draw_maps(scenario);
  draw_profile(scenario);
}
