#include "dcem/io/frame_source.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "dcem/io/frames_ahead.hpp"
#include "tests/io/traffic_case.hpp"
#include "tests/support/shared_data.hpp"

namespace test_frame_source {

using namespace dcem;
using test::holds;
using test::step;
using test::TrafficCase;
using test::vehicle;

namespace {

const std::string north = R"(x="0" y="0" angle="0" speed="0")";

/// Who stands at which body.
std::map<std::string, std::size_t> places_of(const Frame& frame) {
  std::map<std::string, std::size_t> places;
  for (std::size_t body = 0; body < frame.bodies.size(); ++body) {
    const BodyState& state = frame.bodies[body];
    CHECK((state.present || state.occupant.empty()));
    if (!state.occupant.empty()) places[state.occupant] = body;
  }
  return places;
}

const Placement& placement_of(const Frame& frame, const std::string& id) {
  return frame.bodies.at(places_of(frame).at(id)).placement;
}

/// All frames of a scenario; each must be one that the scene takes.
std::vector<Frame> all_frames(io::Scenario& scenario) {
  std::vector<Frame> frames;
  io::FrameSource source(scenario);
  for (std::size_t index = 0; index < scenario.time.frames; ++index) {
    frames.push_back(source.frame(scenario.scene, index));
    scenario.scene.apply(frames.back());
  }
  return frames;
}

std::vector<Frame> all_frames(const TrafficCase& files) {
  io::Scenario scenario = files.load();
  return all_frames(scenario);
}

// Rounding of a few operations on lengths of metres.
constexpr double tolerance_m = 1e-12;

void check_near(const Vec3& a, const Vec3& b) {
  CAPTURE(a.x);
  CAPTURE(a.y);
  CAPTURE(a.z);
  CHECK(glm::length(a - b) <= tolerance_m * (1.0 + glm::length(b)));
}

/// A car with this id in a step at (x, 0), heading east.
std::string car_at(const std::string& id, double x_m) {
  return vehicle(id, "x=\"" + std::to_string(x_m) + "\" y=\"0\" angle=\"90\" speed=\"1\"");
}

}  // namespace

TEST_CASE("the front bumper, angle and slope of SUMO become the centre of the footprint and its heading") {
  TrafficCase files;  // a car is 4 m long: its centre is 2 m behind the bumper
  files.trace_lines = step("0", vehicle("north", R"(x="10" y="20" z="1" angle="0" speed="5")") +
                                    vehicle("east", R"(x="10" y="20" angle="90" speed="5")") +
                                    vehicle("southwest", R"(x="0" y="0" angle="225" speed="2")") +
                                    vehicle("up", R"(x="10" y="20" z="3" angle="270" speed="10" slope="30")") +
                                    vehicle("bus", R"(x="10" y="20" angle="180" speed="0")", "bus"));
  const Frame frame = all_frames(files).at(0);
  const double half_root = std::sqrt(0.5);
  check_near(placement_of(frame, "north").pose.position_m, Vec3(10, 18, 1));
  check_near(placement_of(frame, "north").velocity.linear_mps, Vec3(0, 5, 0));
  check_near(placement_of(frame, "east").pose.position_m, Vec3(8, 20, 0));
  check_near(placement_of(frame, "east").velocity.linear_mps, Vec3(5, 0, 0));
  check_near(placement_of(frame, "southwest").pose.position_m, Vec3(2 * half_root, 2 * half_root, 0));
  check_near(placement_of(frame, "southwest").velocity.linear_mps, Vec3(-2 * half_root, -2 * half_root, 0));
  check_near(placement_of(frame, "bus").pose.position_m, Vec3(10, 25, 0));
  // West and 30° uphill: the centre is 2·cos 30° further east and 2·sin 30° lower.
  check_near(placement_of(frame, "up").pose.position_m, Vec3(10 + std::sqrt(3.0), 20, 2));
  check_near(placement_of(frame, "up").velocity.linear_mps, Vec3(-5 * std::sqrt(3.0), 0, 5));
  CHECK(placement_of(frame, "up").pose.pitch_rad < 0.0);  // nose up
  CHECK(placement_of(frame, "up").velocity.angular_rad_per_s == Vec3(0.0));
}

TEST_CASE("a step of more vehicles than memory holds is refused with what they would take") {
  TrafficCase files;
  std::string vehicles;
  for (int number = 0; number <= 100'000; ++number) vehicles += car_at("v" + std::to_string(number), 5.0 * number);
  files.trace_lines = step("0", vehicles);
  std::string message;
  try {
    files.load();
  } catch (const io::InputError& error) {
    message = error.what();
  }
  CHECK(message.find("mobility.sumo_fcd: 100001 vehicles at a time need 1500 MB; expected at most 100000") !=
        std::string::npos);
}

TEST_CASE("in the world the box of a vehicle ends at its front bumper and stands on the ground") {
  TrafficCase files;
  files.trace_lines = step("0", vehicle("car", R"(x="10" y="20" angle="90" speed="5")"));
  io::Scenario scenario = files.load();
  all_frames(scenario);
  const auto [first, last] = scenario.scene.triangle_range(*scenario.scene.find_body("car"));
  Vec3 low(1e9), high(-1e9);
  for (std::uint32_t triangle = first; triangle < last; ++triangle) {
    for (const Vec3& corner_m : scenario.scene.corners_m(triangle)) {
      low = glm::min(low, corner_m);
      high = glm::max(high, corner_m);
    }
  }
  check_near(low, Vec3(6, 19, 0));
  check_near(high, Vec3(10, 21, 1.5));
}

TEST_CASE("without time the trace's own steps are the frames, however irregular") {
  TrafficCase files;
  files.trace_lines = step("5", car_at("a", 0)) + step("5.5", car_at("a", 1)) + step("7.25", car_at("a", 2));
  io::Scenario scenario = files.load();
  CHECK(scenario.time.frames == 3);
  CHECK(scenario.time_s(0) == 5.0);
  CHECK(scenario.time_s(1) == 5.5);
  CHECK(scenario.time_s(2) == 7.25);
  const std::vector<Frame> frames = all_frames(scenario);
  CHECK(frames[2].time_s == 7.25);
  CHECK(frames[2].index == 2);
  CHECK(placement_of(frames[1], "a").pose.position_m.x == 1.0 - 2.0);
}

TEST_CASE("what time leaves open is taken from the trace") {
  TrafficCase files;
  for (int index = 0; index <= 30; ++index) {  // 600.0, 600.1, … 603.0; the step is a rounded difference
    files.trace_lines += step(std::to_string(600 + index / 10) + "." + std::to_string(index % 10), car_at("a", index));
  }
  files.more = R"(, "time": {"frames": 4})";
  io::Scenario scenario = files.load();
  CHECK(scenario.time.start_s == 600.0);
  CHECK(scenario.time.step_s == 0.1);
  CHECK(scenario.time.frames == 4);
  files.more = R"(, "time": {"step_s": 0.5})";
  CHECK(files.load().time.frames == 7);
  files.more = R"(, "time": {"start_s": 601})";
  CHECK(files.load().time.frames == 21);
  files.more = R"(, "time": {"start_s": 601.05, "step_s": 0.3})";
  CHECK(files.load().time.frames == 7);  // the last at 602.85 s
  files.more = R"(, "time": {})";
  CHECK(files.load().time.frames == 31);
}

TEST_CASE("frames outside the trace are refused with its range") {
  TrafficCase files;
  files.trace_lines = step("10", car_at("a", 0)) + step("12", car_at("a", 1));
  files.more = R"(, "time": {"start_s": 9.9, "step_s": 1, "frames": 1})";
  CHECK(holds(files.error(), "time: frames from 9.9 s to 9.9 s; expected instants from 10 s to 12 s"));
  files.more = R"(, "time": {"start_s": 10, "step_s": 1, "frames": 4})";
  CHECK(holds(files.error(), "time: frames from 10 s to 13 s; expected instants from 10 s to 12 s"));
  files.more = R"(, "time": {"start_s": 13})";
  CHECK(holds(files.error(), "expected instants from 10 s to 12 s"));
  files.more = R"(, "time": {"start_s": 10.0000005, "step_s": 0.9999999, "frames": 3})";
  CHECK(files.error() == "no error");
}

TEST_CASE("an instant within a microsecond of a step is that step, to the last bit") {
  TrafficCase files;
  files.trace_lines = step("0", vehicle("a", R"(x="0.1" y="0.7" angle="33" speed="1.3")")) +
                      step("1", vehicle("a", R"(x="2.3" y="9.1" angle="44" speed="1.7")")) +
                      step("2", vehicle("a", R"(x="7.7" y="8.9" angle="45" speed="1.1")"));
  const std::vector<Frame> steps = all_frames(files);
  files.more = R"(, "time": {"start_s": 0.0000008, "step_s": 0.9999996, "frames": 3})";
  const std::vector<Frame> near = all_frames(files);
  for (std::size_t index = 0; index < 3; ++index) {
    CHECK(placement_of(near[index], "a") == placement_of(steps[index], "a"));
  }
}

TEST_CASE(
    "of steps closer together than a microsecond the nearest counts; what is a rounding error outside is inside") {
  TrafficCase files;
  files.trace_lines = step("-3", car_at("a", 1)) + step("-2.9999989999999999", car_at("a", 2)) +
                      step("-2.9999980000000002", car_at("b", 3)) + step("-2.9999976", car_at("c", 4));
  const auto names = [&](const std::string& time) {
    files.more = R"(, "time": )" + time;
    std::string result;
    for (const Frame& frame : all_frames(files)) {
      for (const auto& [name, body] : places_of(frame)) {
        result += name + std::to_string(std::lround(frame.bodies[body].placement.pose.position_m.x + 2.0)) + ' ';
      }
    }
    return result;
  };
  CHECK(names(R"({"start_s": -3, "step_s": 1e-6, "frames": 3})") == "a1 a2 b3 ");
  CHECK(names(R"({"start_s": -3, "step_s": 4e-7, "frames": 7})") == "a1 a1 a2 a2 b3 b3 c4 ");
  CHECK(names(R"({"start_s": -3.0000009999999999, "frames": 1})") == "a1 ");
  CHECK(names(R"({"start_s": -2.9999966000000001, "frames": 1})") == "c4 ");
}

TEST_CASE("between steps positions and speeds are linear, angles take the shortest arc") {
  TrafficCase files;
  files.types = R"(<vType id="car" length="4"/>)";
  files.trace_lines = step("0", vehicle("a", R"(x="0" y="0" angle="350" speed="10")") +
                                    vehicle("b", R"(x="100" y="0" angle="90" speed="4" slope="0")")) +
                      step("1", vehicle("a", R"(x="0" y="10" angle="10" speed="20")") +
                                    vehicle("b", R"(x="108" y="0" angle="90" speed="8" slope="10")"));
  files.more = R"(, "time": {"start_s": 0, "step_s": 0.25, "frames": 5})";
  const std::vector<Frame> frames = all_frames(files);
  const Placement& a = placement_of(frames[2], "a");  // halfway it heads north, by way of 0°, not of 180°
  check_near(rotation_matrix(a.pose)[0], Vec3(0, 1, 0));
  check_near(a.velocity.linear_mps, Vec3(0, 15, 0));
  // The centres of the two steps lie 2 m behind (0, 0) and (0, 10), on headings 10° left and right of north.
  const double ten_deg_rad = std::acos(-1.0) / 18;
  check_near(a.pose.position_m, Vec3(0, 5 - 2 * std::cos(ten_deg_rad), 0));
  const Placement& b = placement_of(frames[1], "b");  // a quarter of the way
  CHECK(b.pose.pitch_rad == doctest::Approx(-ten_deg_rad / 4).scale(0.0));
  CHECK(glm::length(b.velocity.linear_mps) == doctest::Approx(5.0));
}

TEST_CASE("between steps only those are there that both steps have, as the same type") {
  TrafficCase files;
  files.trace_lines = step("0", car_at("leaves", 0) + car_at("stays", 10) + car_at("turns", 20)) +
                      step("1", car_at("enters", 0) + car_at("stays", 11) + vehicle("turns", north, "bus"));
  files.more = R"(, "time": {"start_s": 0, "step_s": 0.5, "frames": 3})";
  const std::vector<Frame> frames = all_frames(files);
  CHECK(places_of(frames[0]).size() == 3);
  const auto between = places_of(frames[1]);
  CHECK(between.size() == 1);
  CHECK(between.contains("stays"));
  // The first body behind the scenery is the slot of the one bus, then come those of three cars.
  const auto after = places_of(frames[2]);
  CHECK(after.size() == 3);
  CHECK(after.at("turns") == 1);
  CHECK(after.at("stays") >= 2);
}

TEST_CASE("a vehicle that stands does not move by a bit, on a step or between") {
  TrafficCase files;
  const std::string standing = vehicle("a", R"(x="6896.23" y="8025.24" z="0.3" angle="102.79" speed="0" slope="1.7")");
  files.trace_lines = step("0", standing) + step("0.7", standing) + step("1.3", standing);
  files.more = R"(, "time": {"start_s": 0, "step_s": 0.1, "frames": 14})";
  const std::vector<Frame> frames = all_frames(files);
  for (const Frame& frame : frames) CHECK(frame.bodies == frames[0].bodies);
}

TEST_CASE("there are as many slots as vehicles of a type at a time, however many pass") {
  TrafficCase files;
  for (int index = 0; index < 20; ++index) {
    files.trace_lines += step(std::to_string(index),
                              car_at("car" + std::to_string(index), 0) + car_at("car" + std::to_string(index + 1), 20));
  }
  files.trace_lines += step("20", vehicle("bus1", north, "bus"));
  io::Scenario scenario = files.load();
  REQUIRE(scenario.traffic);
  REQUIRE(scenario.traffic->types.size() == 2);
  CHECK(scenario.traffic->types[0].name == "bus");
  CHECK(scenario.traffic->types[0].slots == 1);
  CHECK(scenario.traffic->types[1].slots == 2);
  CHECK(scenario.scene.slot_count() == 3);
  const std::vector<Frame> frames = all_frames(scenario);
  CHECK(places_of(frames[0]) == std::map<std::string, std::size_t>{{"car0", 2}, {"car1", 3}});
  CHECK(places_of(frames[1]) == std::map<std::string, std::size_t>{{"car1", 3}, {"car2", 2}});
  CHECK(places_of(frames[20]) == std::map<std::string, std::size_t>{{"bus1", 1}});
}

TEST_CASE("those who enter take the lowest free slots by their ids, but a slot just left rests if it can") {
  TrafficCase files;
  files.trace_lines = step("0", car_at("c", 0) + car_at("a", 10) + car_at("b", 20)) +  // a 1, b 2, c 3
                      step("1", car_at("a", 10) + car_at("b", 20)) +                   // 3 left
                      step("2", car_at("b", 20) + car_at("d", 0)) +  // 1 left just now, 3 has rested: d 3
                      step("3", car_at("b", 20) + car_at("d", 0) + car_at("e", 10)) +  // 1 has rested: e 1
                      step("4", car_at("d", 0) + car_at("e", 10) + car_at("f", 20)) +  // nothing else is free: f 2
                      step("5", "") + step("6", car_at("i", 0) + car_at("g", 10) + car_at("h", 20));
  const std::vector<Frame> frames = all_frames(files);
  using Places = std::map<std::string, std::size_t>;
  CHECK(places_of(frames[0]) == Places{{"a", 1}, {"b", 2}, {"c", 3}});
  CHECK(places_of(frames[2]) == Places{{"b", 2}, {"d", 3}});
  CHECK(places_of(frames[3]) == Places{{"b", 2}, {"d", 3}, {"e", 1}});
  CHECK(places_of(frames[4]) == Places{{"d", 3}, {"e", 1}, {"f", 2}});
  CHECK(places_of(frames[6]) == Places{{"g", 1}, {"h", 2}, {"i", 3}});
}

TEST_CASE("a vehicle that comes back enters like any other") {
  TrafficCase files;
  files.trace_lines = step("0", car_at("a", 0) + car_at("b", 10)) + step("1", car_at("b", 10)) +
                      step("2", car_at("b", 10) + car_at("c", 0)) + step("3", car_at("c", 0)) +
                      step("4", car_at("a", 10) + car_at("c", 0));
  const std::vector<Frame> frames = all_frames(files);
  using Places = std::map<std::string, std::size_t>;
  CHECK(places_of(frames[0]) == Places{{"a", 1}, {"b", 2}});
  CHECK(places_of(frames[2]) == Places{{"b", 2}, {"c", 1}});
  CHECK(places_of(frames[4]) == Places{{"a", 2}, {"c", 1}});
}

TEST_CASE("a frame depends on its number alone, not on the frames asked for before") {
  TrafficCase files;
  for (int index = 0; index < 12; ++index) {
    files.trace_lines += step(std::to_string(index), car_at("v" + std::to_string(index * 7 % 12), 0) +
                                                         car_at("v" + std::to_string(index * 5 % 12 + 12), 20));
  }
  io::Scenario scenario = files.load();
  const std::vector<Frame> frames = all_frames(scenario);
  for (std::size_t first = 0; first < frames.size(); first += 3) {
    io::FrameSource source(scenario);
    CHECK(source.frame(scenario.scene, first).bodies == frames[first].bodies);
    CHECK(source.frame(scenario.scene, first).bodies == frames[first].bodies);  // the same once more
    CHECK(source.frame(scenario.scene, first + 2).bodies == frames[first + 2].bodies);
    CHECK_THROWS_AS(source.frame(scenario.scene, first), std::invalid_argument);
  }
  CHECK_THROWS_AS(io::FrameSource(scenario).frame(scenario.scene, 12), std::invalid_argument);
}

TEST_CASE("a source stays good when the scene has been moved out of the scenario, and when it is moved itself") {
  TrafficCase files;
  files.trace_lines = step("0", car_at("a", 0)) + step("1", car_at("a", 1));
  std::optional<io::Scenario> scenario = files.load();
  const std::vector<Frame> frames = all_frames(*scenario);
  io::FrameSource source(*scenario);
  const Scene scene = std::move(scenario->scene);
  scenario.reset();
  CHECK(source.frame(scene, 0).bodies == frames[0].bodies);
  io::FrameSource moved = std::move(source);
  CHECK(moved.frame(scene, 1).bodies == frames[1].bodies);
}

TEST_CASE("without traffic the frames are those of the motions") {
  TrafficCase files;
  files.objects = R"({"id": "box", "box_m": [1, 1, 1], "material": "metal",
                      "motion": {"position_m": [1, 2, 0], "velocity_mps": [3, 0, 0]}})";
  files.mobility = "";
  files.more = R"(, "time": {"frames": 5})";
  const io::Scenario scenario = files.load();
  io::FrameSource source(scenario);
  CHECK(source.frame(scenario.scene, 3).bodies == scenario.scene.frame_at(scenario.time_s(3), 3).bodies);
  CHECK(source.frame(scenario.scene, 1).time_s == scenario.time_s(1));
  io::require_attached_devices(scenario, 0, 5);
}

TEST_CASE("objects stand beside the traffic and move on") {
  TrafficCase files;
  files.trace_lines = step("10", car_at("a", 0)) + step("11", car_at("a", 1));
  files.objects = R"({"id": "box", "box_m": [1, 1, 1], "material": "metal",
                      "motion": {"position_m": [1, 2, 0], "velocity_mps": [3, 0, 0]}})";
  io::Scenario scenario = files.load();
  const std::vector<Frame> frames = all_frames(scenario);
  // A pose with a velocity holds at the start, which is the trace's first step.
  check_near(frames[0].bodies[1].placement.pose.position_m, Vec3(1, 2, 0));
  check_near(frames[1].bodies[1].placement.pose.position_m, Vec3(4, 2, 0));
  CHECK(places_of(frames[1]).at("a") == 2);
}

TEST_CASE("a device rides on a vehicle while that is there") {
  TrafficCase files;
  files.trace_lines =
      step("0", car_at("b", 0)) + step("1", car_at("a", 5) + car_at("b", 0)) + step("2", car_at("b", 0));
  files.receivers = R"({"id": "rx", "attach_to": "a", "offset_m": [1, 0, 1.6]})";
  io::Scenario scenario = files.load();
  const std::vector<Frame> frames = all_frames(scenario);
  const Device& device = scenario.scene.receivers()[0];
  CHECK_FALSE(scenario.scene.device_state(device, frames[0]).present);
  CHECK(scenario.scene.device_state(device, frames[1]).present);
  check_near(scenario.scene.device_state(device, frames[1]).position_m, Vec3(5 - 2 + 1, 0, 1.6));
  CHECK_FALSE(scenario.scene.device_state(device, frames[2]).present);
  io::require_attached_devices(scenario, 0, 3);
  io::require_attached_devices(scenario, 1, 2);
  const std::string error = test::input_error_of([&] { io::require_attached_devices(scenario, 2, 3); });
  CHECK(holds(error, "case.json:4: receivers[0].attach_to: vehicle 'a' is in none of the frames asked for; expected"));
  CHECK(holds(test::input_error_of([&] { io::require_attached_devices(scenario, 0, 1); }), "none of the frames"));
}

TEST_CASE("a vehicle that is only between the frames asked for is in none of them") {
  TrafficCase files;
  files.trace_lines = step("0", car_at("b", 0)) + step("1", car_at("a", 5)) + step("2", car_at("a", 5)) +
                      step("3", car_at("b", 5)) + step("4", car_at("a", 5));
  files.receivers = R"({"id": "rx", "attach_to": "a", "offset_m": [1, 0, 1.6]})";
  files.more = R"(, "time": {"start_s": 0, "step_s": 3, "frames": 2})";
  const io::Scenario off = files.load();
  CHECK(holds(test::input_error_of([&] { io::require_attached_devices(off, 0, 2); }), "none of the frames"));
  files.more = R"(, "time": {"start_s": 0, "step_s": 1.5, "frames": 2})";  // at 1.5 s, between two steps that have it
  CHECK_NOTHROW(io::require_attached_devices(files.load(), 0, 2));
  files.more = R"(, "time": {"start_s": 0, "step_s": 2.5, "frames": 2})";  // gone again at 3 s: absent at 2.5 s
  const io::Scenario gone = files.load();
  CHECK(holds(test::input_error_of([&] { io::require_attached_devices(gone, 0, 2); }), "none of the frames"));
}

TEST_CASE("names that are not there, or there twice, are refused") {
  TrafficCase files;
  files.trace_lines = step("0", car_at("a", 0));
  files.receivers = R"({"id": "rx", "attach_to": "b", "offset_m": [0, 0, 2]})";
  CHECK(holds(files.error(), "receivers[0].attach_to: no object or vehicle 'b'; expected a vehicle of the trace"));
  files.objects = R"({"id": "box", "box_m": [1, 1, 1], "material": "metal"})";
  CHECK(holds(files.error(), "no object or vehicle 'b'; expected the nearest known one, 'box'"));
  files.objects = R"({"id": "a", "box_m": [1, 1, 1], "material": "metal"})";
  CHECK(holds(files.error(), "objects[0].id: 'a' is also a vehicle of the trace"));
}

TEST_CASE("longitudes and latitudes are not taken for metres") {
  TrafficCase files;
  files.trace_lines = step("0", vehicle("a", R"(x="9.7000" y="50.8700" angle="90" speed="15")")) +
                      step("10", vehicle("a", R"(x="9.7021" y="50.8700" angle="90" speed="15")"));
  CHECK(holds(files.error(), "for longitude and latitude the block geo, with the scene within a degree"));
  files.more = R"(, "geo": {"origin_lat_deg": 10, "origin_lon_deg": 9.7})";  // somewhere else
  CHECK(holds(files.error(), "for longitude and latitude the block geo, with the scene within a degree"));
  files.more = R"(, "geo": {"origin_lat_deg": 50.87, "origin_lon_deg": 9.7})";
  CHECK(files.load().traffic->degrees.has_value());
  files.trace_lines = step("0", car_at("a", 0)) + step("1000", car_at("a", 5));  // slow, but it moves
  CHECK(!files.load().traffic->degrees.has_value());
  files.more = "";
  CHECK(files.error() == "no error");
}

TEST_CASE("a trace that changed after it was loaded is refused") {
  TrafficCase files;
  files.trace_lines = step("0", car_at("a", 0)) + step("1", car_at("a", 1));
  const io::Scenario scenario = files.load();
  const auto error_with = [&](const std::string& lines) {
    test::write_text(files.folder / "trace.xml", test::trace(lines));
    return test::input_error_of([&] {
      io::FrameSource source(scenario);
      source.frame(scenario.scene, 1);
    });
  };
  CHECK(holds(error_with(step("0", car_at("a", 0))), "differs from when the scenario was loaded"));
  CHECK(holds(error_with(step("0", car_at("a", 0) + car_at("b", 9)) + step("1", "")), "differs from when"));
  CHECK(holds(error_with(step("0", vehicle("a", north, "bus")) + step("1", "")), "trace.xml:3: differs from when"));
}

TEST_CASE("a compressed trace gives the frames of the plain one") {
  TrafficCase files;
  files.trace_lines = step("0", car_at("a", 0) + car_at("b", 9)) + step("1", car_at("b", 1) + car_at("c", 2));
  const std::vector<Frame> plain = all_frames(files);
  files.mobility = R"({"sumo_fcd": "trace.xml.gz", "vehicle_types": ["types.xml"], "material": "metal"})";
  test::write_gz(files.folder / "trace.xml.gz", test::trace(files.trace_lines));
  const std::vector<Frame> packed = all_frames(files);
  REQUIRE(packed.size() == plain.size());
  for (std::size_t index = 0; index < plain.size(); ++index) CHECK(packed[index].bodies == plain[index].bodies);
}

TEST_CASE("the reference trace drives: slots for those at a time, boxes where the description puts them") {
  DCEM_NEEDS_SHARED();
  TrafficCase files;
  const std::string trace_file = test::shared_path("badhersfeld/fcd_600-660s_0.1s.xml.gz");
  files.mobility = "{\"sumo_fcd\": \"" + trace_file + "\", \"vehicle_types\": \"" +
                   test::shared_path("badhersfeld/vtypes.add.xml") + "\", \"material\": \"metal\"}";
  io::Scenario scenario = files.load();
  CHECK(scenario.time.frames == 600);
  // Counted in the file with another XML reader: bus 14, car 129, motorcycle 12, truck 26, van 20.
  CHECK(scenario.scene.slot_count() == 201);
  io::FrameSource source(scenario);
  std::size_t rows = 0;
  for (std::size_t index = 0; index < 600; ++index) {
    const Frame frame = source.frame(scenario.scene, index);
    rows += places_of(frame).size();
    if (index % 50 == 0) scenario.scene.apply(frame);
    if (index != 0) continue;
    // First rows of the file: car 317 (5 m) at 7365.74, 7944.10, 22.50°, 15.28 m/s; truck 330 (13 m) at 6216.30,
    // 8235.58, 293.06°. Centre by the description: (x − L/2·sin(angle), y − L/2·cos(angle)).
    const double degree_rad = std::acos(-1.0) / 180;
    check_near(placement_of(frame, "317").pose.position_m,
               Vec3(7365.74 - 2.5 * std::sin(22.5 * degree_rad), 7944.10 - 2.5 * std::cos(22.5 * degree_rad), 0));
    check_near(placement_of(frame, "317").velocity.linear_mps,
               15.28 * Vec3(std::sin(22.5 * degree_rad), std::cos(22.5 * degree_rad), 0));
    check_near(placement_of(frame, "330").pose.position_m,
               Vec3(6216.30 - 6.5 * std::sin(293.06 * degree_rad), 8235.58 - 6.5 * std::cos(293.06 * degree_rad), 0));
  }
  CHECK(rows == 114'086);
}

TEST_CASE("frames read ahead are the frames, and what is wrong with one is told when it is asked for") {
  TrafficCase files;
  for (int index = 0; index < 6; ++index) {
    const std::string time = std::to_string(index);
    files.trace_lines += step(time, car_at("a", index) + (index % 2 == 0 ? car_at("b", 20.0 + index) : ""));
  }
  const std::vector<Frame> expected = all_frames(files);
  for (const bool has_thread : {false, true}) {
    io::Scenario scenario = files.load();
    io::FrameSource source(scenario);
    io::FramesAhead ahead(source, scenario.scene, 1, 5, has_thread);
    for (std::size_t index = 1; index < 5; ++index) {
      const Frame frame = ahead.next();
      CHECK(frame.index == index);
      CHECK((frame.bodies == expected[index].bodies));
      scenario.scene.apply(frame);
    }
    io::FrameSource again(scenario);
    io::FramesAhead beyond(again, scenario.scene, 5, 7, has_thread);
    CHECK(beyond.next().index == 5);
    CHECK_THROWS_AS(beyond.next(), std::invalid_argument);
  }
}

}  // namespace test_frame_source
