/// `valid_until_m` of the links of a run: when it is there, and that it depends on nothing but the frame.
#include <doctest/doctest.h>

#include <optional>
#include <vector>

#include "dcem/sim/discovery.hpp"
#include "dcem/sim/simulator.hpp"
#include "tests/paths/small_scenes.hpp"

namespace test_valid_until {

using namespace dcem;
using namespace dcem::test;

namespace {

/// A yard between three walls, in which a trolley drives for two seconds and then stands.
Scene yard() {
  TriangleMesh mesh;
  add_sheet(mesh, Vec3(0.0), Vec3(20, 0, 0), Vec3(0, 20, 0), "opaque");
  add_sheet(mesh, Vec3(0, 9, 3), Vec3(8, 0, 0), Vec3(0, 0, 3), "metal");
  add_box_faces(mesh, Vec3(-3, -2, 0), Vec3(-1, 1, 4), "metal");
  Scene scene = scene_of(mesh);
  WaypointMotion motion;
  motion.waypoints = {{0.0, {Vec3(2, 1.5, 0.05), 0.4, 0, 0}}, {2.0, {Vec3(6, 2, 0.05), 1.9, 0, 0}}};
  scene.add_object("trolley", make_box(Vec3(1, 0.6, 0.9), "metal"), motion);
  scene.add_transmitter(device_at("mast", Vec3(7, -6, 8), 30.0));
  scene.add_transmitter(device_at("lamp", Vec3(-7, 5, 4), 30.0));
  scene.add_receiver(device_at("post", Vec3(5, 6, 1.5)));
  Device rider = device_at("rider", Vec3(0.0));
  rider.attachment = Attachment{"trolley", Vec3(0, 0, 1.3), false};
  scene.add_receiver(rider);
  return scene;
}

SimulationSettings settings_with(std::optional<double> limit_m) {
  SimulationSettings settings;
  settings.frequency_hz = 5e9;
  settings.threads = 1;
  settings.propagation.max_interactions = 2;
  settings.propagation.valid_until_limit_m = limit_m;
  return settings;
}

std::vector<std::optional<double>> values_at(Simulator& simulator, double time_s) {
  std::vector<std::optional<double>> values;
  for (const LinkResult& link : simulator.advance_to(time_s).links) values.push_back(link.valid_until_m);
  return values;
}

/// Whether all links of a frame have a value; where not, there is a reason to be told.
bool all_known(const SimulationSettings& settings) {
  Simulator simulator(yard(), settings);
  const auto values = values_at(simulator, 0.0);
  CHECK(values.size() == 4);
  const bool known = std::ranges::all_of(values, [](const auto& value) { return value.has_value(); });
  const bool is_asked = settings.propagation.valid_until_limit_m.has_value();
  if (is_asked) CHECK(why_no_lifetimes(settings.propagation, simulator.discovery()).empty() == known);
  return known;
}

}  // namespace

TEST_CASE("valid_until_m is what the frame has, whatever came before it and on however many threads") {
  Simulator running(yard(), settings_with(0.5));
  SimulationSettings threaded = settings_with(0.5);
  threaded.threads = 3;
  for (const double time_s : {0.0, 0.4, 1.9, 2.0, 2.5, 3.0}) {
    CAPTURE(time_s);
    Simulator fresh(yard(), threaded);
    const auto values = values_at(running, time_s);
    CHECK(values == values_at(fresh, time_s));
    for (const auto& value : values) {
      REQUIRE(value.has_value());
      CHECK(*value > 0.0);
      CHECK(*value <= 0.5);
    }
  }
}

TEST_CASE("valid_until_m is there where it is asked for and proved, and nowhere else") {
  CHECK(all_known(settings_with(0.5)));
  CHECK_FALSE(all_known(settings_with(std::nullopt)));
  SimulationSettings settings = settings_with(0.5);
  settings.propagation.cache = CacheMode::off;
  CHECK_FALSE(all_known(settings));
  settings = settings_with(0.5);
  settings.propagation.max_interactions = 3;
  CHECK_FALSE(all_known(settings));
  settings = settings_with(0.5);
  settings.propagation.max_diffractions = 2;
  CHECK_FALSE(all_known(settings));
  settings.propagation.max_interactions = 1;
  CHECK(all_known(settings));
  settings = settings_with(0.5);
  settings.propagation.min_path_gain_db = -200.0;
  CHECK_FALSE(all_known(settings));
  settings = settings_with(0.5);
  settings.propagation.max_path_length_m = 500.0;
  CHECK_FALSE(all_known(settings));
  settings = settings_with(0.5);
  settings.propagation.line_of_sight = false;
  CHECK_FALSE(all_known(settings));
  settings.propagation.max_transmissions = 0;
  CHECK(all_known(settings));
  settings.propagation.discovery = Discovery::sampled;
  CHECK_FALSE(all_known(settings));
}

TEST_CASE("the limit of valid_until_m is checked") {
  CHECK_THROWS_AS(Simulator(yard(), settings_with(0.0)), std::invalid_argument);
  CHECK_THROWS_AS(Simulator(yard(), settings_with(101.0)), std::invalid_argument);
}

}  // namespace test_valid_until
