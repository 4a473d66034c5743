/// What the pictures of a drive show, against closed forms: 30 GHz and 5 W, in sight of the mast from 80 to 100 m, and
/// around a corner, out of its sight, from 75 to 105 m.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "dcem/io/link_plots.hpp"
#include "tests/support/law_scenes.hpp"

namespace test_drive_pictures {

using namespace dcem;
using namespace dcem::test;

namespace {

constexpr double light_mps = 299'792'458.0, frequency_hz = 30e9, power_w = 5.0, speed_mps = 10.0, step_s = 0.1;
// Delays are some 300 ns; rounding of time, position and length is 1e-13 of that. The bounds leave a thousandfold.
constexpr double rounding_ns = 1e-7;

double power_dbm() {
  return 10.0 * std::log10(1000.0 * power_w);
}

/// Friis between isotropic antennas.
double friis_dbm(double distance_m) {
  return power_dbm() + 20.0 * std::log10(light_mps / frequency_hz / (4.0 * 3.14159265358979323846 * distance_m));
}

Device moving(std::vector<WaypointMotion::Waypoint> waypoints) {
  Device device = device_at("rx", Vec3(0.0));
  device.motion = WaypointMotion{std::move(waypoints)};
  return device;
}

/// A drive: what the pictures of it were made from, and where the receiver was.
struct Drive {
  io::LinkPlots plots{{"tx", "rx", power_dbm()}, 1e-9, PdpMode::incoherent};
  std::vector<double> times_s;
  std::vector<Vec3> receiver_m;
};

Drive driven(const Patches& patches, const Vec3& transmitter_m, Device receiver, std::size_t frames) {
  Scene scene = scene_through_files(patches);
  scene.add_transmitter(device_at("tx", transmitter_m, power_dbm()));
  scene.add_receiver(receiver);
  SimulationSettings settings = law_settings(2, 0);
  settings.frequency_hz = frequency_hz;
  settings.propagation.max_diffractions = 1;
  Simulator simulator(std::move(scene), settings);
  Drive drive;
  for (std::size_t frame = 0; frame < frames; ++frame) {
    const double time_s = step_s * static_cast<double>(frame);
    const FrameResult result = simulator.advance_to(time_s, frame);
    drive.plots.add(simulator.scene(), time_s, &result.links.at(0));
    drive.times_s.push_back(time_s);
    const Frame moved = simulator.scene().frame_at(time_s, frame);
    drive.receiver_m.push_back(simulator.scene().device_state(simulator.scene().receivers()[0], moved).position_m);
  }
  return drive;
}

/// Along the middle of a street, at the height of the mast: the distance is 80 m + speed · time.
Drive drive_in_sight() {
  const Patches patches{sheet(Vec3(60, 0, 0), Vec3(80, 0, 0), Vec3(0, 30, 0), "opaque"),
                        sheet(Vec3(60, -9, 6), Vec3(80, 0, 0), Vec3(0, 0, 6), "opaque"),
                        sheet(Vec3(60, 11, 6), Vec3(80, 0, 0), Vec3(0, 0, 6), "opaque")};
  return driven(patches, Vec3(0, 0, 3), moving({{0.0, {Vec3(80, 0, 3)}}, {2.0, {Vec3(100, 0, 3)}}}), 21);
}

constexpr double corner_x_m = 85.0, corner_y_m = 8.0, mast_z_m = 5.0, car_z_m = 1.6;

/// Along a street, past the corner of a house, and left into the side street.
Drive drive_around_the_corner() {
  Patches patches = box_faces(Vec3(20, corner_y_m, 0), Vec3(corner_x_m, 40, 12), "opaque");
  patches.push_back(sheet(Vec3(60, 0, 0), Vec3(120, 0, 0), Vec3(0, 60, 0), "opaque"));
  patches.push_back(sheet(Vec3(60, -9, 6), Vec3(80, 0, 0), Vec3(0, 0, 6), "opaque"));
  const double turn_s = 2.0, end_y_m = std::sqrt(105.0 * 105.0 - 95.0 * 95.0);
  const Device car = moving({{0.0, {Vec3(75, 2, car_z_m)}},
                             {turn_s, {Vec3(95, 2, car_z_m)}},
                             {turn_s + (end_y_m - 2.0) / speed_mps, {Vec3(95, end_y_m, car_z_m)}}});
  return driven(patches, Vec3(0, 0, mast_z_m), car, 63);
}

std::map<double, io::ScatterChart::Dot> direct_dots(const io::ScatterChart& chart) {
  std::map<double, io::ScatterChart::Dot> dots;
  for (const io::ScatterChart::Dot& dot : chart.dots) {
    if (dot.is_marked) CHECK(dots.emplace(dot.x, dot).second);
  }
  return dots;
}

const io::LineChart::Series* find_series(const std::vector<io::LineChart>& charts, const std::string& name) {
  for (const io::LineChart& chart : charts) {
    for (const io::LineChart::Series& series : chart.series) {
      if (series.name == name) return &series;
    }
  }
  return nullptr;
}

/// The most that a path can grow between two frames: in a scene that stands, its length changes by no more than the
/// receiver moves, because every path is stationary in its own points.
void check_that_traces_are_continuous(const io::ScatterChart& chart) {
  std::map<std::uint64_t, io::ScatterChart::Dot> last;
  std::size_t joined = 0;
  for (const io::ScatterChart::Dot& dot : chart.dots) {
    const auto before = last.find(dot.trace);
    if (dot.joins_last) {
      REQUIRE(before != last.end());
      CHECK(dot.x - before->second.x == doctest::Approx(step_s).epsilon(1e-9).scale(0.0));
      CHECK(std::abs(dot.y - before->second.y) <= 1e9 * speed_mps * step_s / light_mps + rounding_ns);
      ++joined;
    }
    last[dot.trace] = dot;
  }
  CHECK(joined > chart.dots.size() / 2);
}

}  // namespace

TEST_CASE("in sight, the direct path's power falls by 20 log10 of the distance and its delay grows as d/c") {
  const Drive drive = drive_in_sight();
  const std::map<double, io::ScatterChart::Dot> direct = direct_dots(drive.plots.taps().value());
  REQUIRE(direct.size() == drive.times_s.size());
  for (const auto& [time_s, dot] : direct) {
    const double distance_m = 80.0 + speed_mps * time_s;
    CHECK(std::abs(dot.y - 1e9 * distance_m / light_mps) < rounding_ns);
    CHECK(dot.value == doctest::Approx(friis_dbm(distance_m)).epsilon(1e-10));
  }
  // 20 log10(100/80) by hand.
  CHECK(direct.at(0.0).value - direct.rbegin()->second.value == doctest::Approx(1.9382002601611).epsilon(1e-9));
}

TEST_CASE("in sight, the line of sight of the chart is the same, and the coherent power swings about the incoherent") {
  const Drive drive = drive_in_sight();
  const std::vector<io::LineChart> charts = drive.plots.charts();
  const io::LineChart::Series* const los = find_series(charts, "line of sight");
  REQUIRE(los != nullptr);
  for (std::size_t frame = 0; frame < drive.times_s.size(); ++frame) {
    CHECK(los->y[frame] == doctest::Approx(friis_dbm(80.0 + speed_mps * los->x[frame])).epsilon(1e-10));
  }
  CHECK(find_series(charts, "transmitted") == nullptr);
  CHECK(find_series(charts, "diffuse") == nullptr);
}

TEST_CASE("in the profile's picture the direct path is a track of cells at (t, d/c), drawn in colour") {
  const Drive drive = drive_in_sight();
  const io::HeatMap map = drive.plots.profile().value();
  CHECK(map.axes.x_unit == "s");
  CHECK(map.axes.y_unit == "ns");
  CHECK(map.unit == "dBm");
  const io::HeatMapLayout layout = io::heat_map_layout(map);
  const io::Image image = io::draw_cells(map);
  for (const double time_s : drive.times_s) {
    const double distance_m = 80.0 + speed_mps * time_s, delay_ns = 1e9 * distance_m / light_mps;
    const auto column = static_cast<std::size_t>(std::lround((time_s - map.origin_x_m) / map.spacing_x_m));
    const auto row = static_cast<std::size_t>(std::lround((std::floor(delay_ns) + 0.5 - map.origin_y_m) / 1.0));
    REQUIRE(column < map.columns);
    REQUIRE(row < map.rows);
    // Other paths may fall into the same nanosecond.
    CHECK(map.values[row * map.columns + column] >= friis_dbm(distance_m) - 1e-9);
    const io::PixelPoint place = layout.point(time_s, std::floor(delay_ns) + 0.5);
    const io::Colour colour =
        image.pixel(static_cast<int>(place.x) - layout.plot.x, static_cast<int>(place.y) - layout.plot.y);
    CHECK_FALSE((colour.red == colour.green && colour.green == colour.blue));
  }
}

TEST_CASE("the delay of one path id moves no faster than the car") {
  check_that_traces_are_continuous(drive_in_sight().plots.taps().value());
  check_that_traces_are_continuous(drive_around_the_corner().plots.taps().value());
}

TEST_CASE("around the corner the direct path vanishes where the corner hides the mast, and diffraction goes on") {
  const Drive drive = drive_around_the_corner();
  const io::ScatterChart taps = drive.plots.taps().value();
  const std::map<double, io::ScatterChart::Dot> direct = direct_dots(taps);
  const std::vector<io::LineChart> charts = drive.plots.charts();
  const io::LineChart::Series *const diffracted = find_series(charts, "diffracted"), *const gone =
                                                                                         find_series(charts, "gone");
  REQUIRE(diffracted != nullptr);
  REQUIRE(gone != nullptr);
  CHECK(glm::length(drive.receiver_m.front()) == doctest::Approx(75.0).epsilon(0.01));
  CHECK(glm::length(drive.receiver_m.back()) == doctest::Approx(105.0).epsilon(0.01));
  std::size_t hidden_frames = 0;
  for (std::size_t frame = 0; frame < drive.times_s.size(); ++frame) {
    const Vec3& car_m = drive.receiver_m[frame];
    const bool hidden = car_m.x > corner_x_m && car_m.y * corner_x_m > corner_y_m * car_m.x;
    CHECK(direct.contains(drive.times_s[frame]) == !hidden);
    if (!hidden) continue;
    CHECK(diffracted->y[frame] < friis_dbm(glm::distance(car_m, Vec3(0, 0, mast_z_m))));
    if (hidden_frames == 0) CHECK(gone->y[frame] >= 1.0);
    // Over the upright edge both ways unfold into one triangle: Keller's cone.
    const double to_edge_m = std::hypot(corner_x_m, corner_y_m);
    const double onward_m = std::hypot(car_m.x - corner_x_m, car_m.y - corner_y_m);
    const double delay_ns = 1e9 * std::hypot(to_edge_m + onward_m, mast_z_m - car_z_m) / light_mps;
    const auto on_it = [&](const io::ScatterChart::Dot& dot) {
      return dot.x == drive.times_s[frame] && std::abs(dot.y - delay_ns) < rounding_ns;
    };
    CHECK(std::count_if(taps.dots.begin(), taps.dots.end(), on_it) == 1);
    ++hidden_frames;
  }
  CHECK(hidden_frames > 20);
  CHECK(hidden_frames < drive.times_s.size() - 20);
}

}  // namespace test_drive_pictures
