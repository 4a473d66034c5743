/// Two drives at 30 GHz with 5 W, drawn: along a street in sight of the mast from 80 to 100 m, and around the corner of
/// a house, out of its sight, from 75 to 105 m.
///
/// Writes for each the power delay profile over time and the delays of its paths (PNG), and its powers and spreads over
/// time (SVG), into the current folder.
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "dcem/dcem.hpp"
#include "dcem/io/link_plots.hpp"
#include "dcem/sim/simulator.hpp"

namespace {

constexpr double speed_mps = 10.0, step_s = 0.05, antenna_height_m = 1.6;
const dcem::Vec3 mast_m{0.0, 0.0, 5.0};

/// A street along x with houses on both sides; between the two on the left a side street leaves at x = 95 m.
dcem::Scene street() {
  dcem::Scene scene;
  scene.add_material({"wall", dcem::ConstantReflection{0.8, std::nullopt}});
  scene.add_material({"road", dcem::ConstantReflection{0.5, std::nullopt}});
  dcem::TriangleMesh scenery;
  dcem::add_quad(scenery,
                 {dcem::Vec3(-20, -40, 0), dcem::Vec3(180, -40, 0), dcem::Vec3(180, 80, 0), dcem::Vec3(-20, 80, 0)},
                 "road");
  scene.set_scenery(scenery);
  const auto add_house = [&](const char* id, const dcem::Vec3& corner_m, const dcem::Vec3& size_m) {
    const dcem::Vec3 foot_m = corner_m + dcem::Vec3(0.5 * size_m.x, 0.5 * size_m.y, 0.0);
    scene.add_object(id, dcem::make_box(size_m, "wall"), dcem::LinearMotion{{foot_m}});
  };
  add_house("left", {20, 8, 0}, {65, 30, 12});
  add_house("behind", {105, 8, 0}, {40, 60, 15});
  add_house("right", {20, -25, 0}, {125, 17, 10});
  scene.add_transmitter(dcem::device_at("mast", mast_m, dcem::watt_to_dbm(5.0)));
  return scene;
}

/// A car along a line of points at constant speed, as long as it takes.
dcem::Device car_along(const std::vector<dcem::Vec3>& points_m) {
  dcem::WaypointMotion motion;
  double time_s = 0.0;
  for (std::size_t index = 0; index < points_m.size(); ++index) {
    if (index > 0) time_s += glm::distance(points_m[index - 1], points_m[index]) / speed_mps;
    motion.waypoints.push_back({time_s, {points_m[index]}});
  }
  dcem::Device car = dcem::device_at("car", points_m.front());
  car.motion = motion;
  return car;
}

/// Straight on, 80 to 100 m from the mast.
std::vector<dcem::Vec3> in_sight() {
  const double dz_m = mast_m.z - antenna_height_m;
  const auto at = [&](double distance_m) {
    return dcem::Vec3(std::sqrt(distance_m * distance_m - dz_m * dz_m), 0.0, antenna_height_m);
  };
  return {at(80.0), at(100.0)};
}

/// Along the street from 75 m, left around the corner with a radius of 6 m, and up the side street to 105 m.
std::vector<dcem::Vec3> around_the_corner() {
  constexpr double lane_m = 2.0, side_street_m = 95.0, radius_m = 6.0;
  std::vector<dcem::Vec3> points{{75.0, lane_m, antenna_height_m}};
  for (int step = 0; step <= 12; ++step) {
    const double angle = 0.5 * dcem::pi * step / 12.0;
    points.emplace_back(side_street_m - radius_m + radius_m * std::sin(angle),
                        lane_m + radius_m - radius_m * std::cos(angle), antenna_height_m);
  }
  points.emplace_back(side_street_m, std::sqrt(105.0 * 105.0 - side_street_m * side_street_m), antenna_height_m);
  return points;
}

void draw(const dcem::io::LinkPlots& plots, const std::string& name) {
  dcem::io::write_heat_map(plots.profile().value(), name + "_pdp.png");
  dcem::io::write_scatter_chart(plots.taps().value(), name + "_taps.png");
  const std::vector<dcem::io::LineChart> charts = plots.charts();
  dcem::io::write_line_charts(charts, name + ".svg");
}

void drive(const std::string& name, const std::vector<dcem::Vec3>& points_m) {
  dcem::Scene scene = street();
  const dcem::Device car = car_along(points_m);
  const double end_s = std::get<dcem::WaypointMotion>(car.motion).waypoints.back().time_s;
  scene.add_receiver(car);
  dcem::SimulationSettings settings;
  settings.frequency_hz = 30e9;
  settings.propagation.max_transmissions = 0;
  settings.propagation.discovery = dcem::Discovery::exact;
  dcem::Simulator simulator(std::move(scene), settings);
  dcem::io::LinkPlots plots({"mast", "car", dcem::watt_to_dbm(5.0)}, 1e-9, dcem::PdpMode::incoherent);
  std::size_t out_of_sight = 0, frame = 0;
  for (; static_cast<double>(frame) * step_s <= end_s; ++frame) {
    const dcem::FrameResult result = simulator.advance_to(static_cast<double>(frame) * step_s, frame);
    out_of_sight += result.links.at(0).statistics.line_of_sight ? 0 : 1;
    plots.add(simulator.scene(), result.time_s, &result.links[0]);
  }
  draw(plots, name);
  std::printf("%-13s %3zu frames, %zu without line of sight\n", name.c_str(), frame, out_of_sight);
}

}  // namespace

int main() {
  drive("drive_sight", in_sight());
  drive("drive_corner", around_the_corner());
}
