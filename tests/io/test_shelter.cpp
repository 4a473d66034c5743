/// Points under the roof of a shell that is not closed are not "outdoors": where nothing reaches them they are no
/// street without coverage.
#include <doctest/doctest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dcem/geometry/triangle_mesh.hpp"
#include "dcem/io/combined_map_writer.hpp"
#include "dcem/io/map_writer.hpp"
#include "dcem/io/shelter.hpp"
#include "dcem/sim/simulator.hpp"

namespace test_shelter {

using namespace dcem;

namespace {

void add_wall(TriangleMesh& mesh, const Vec3& from, const Vec3& to, double foot_m, double top_m) {
  add_quad(
      mesh,
      {Vec3(from.x, from.y, foot_m), Vec3(to.x, to.y, foot_m), Vec3(to.x, to.y, top_m), Vec3(from.x, from.y, top_m)},
      "wall");
}

/// A ground with a house whose east wall ends 1 m below the roof, a courtyard without a roof, and a bridge.
TriangleMesh quarter() {
  TriangleMesh mesh;
  add_quad(mesh, {Vec3(-200, -200, 0), Vec3(200, -200, 0), Vec3(200, 200, 0), Vec3(-200, 200, 0)}, "wall");
  for (const double x : {20.0, 60.0}) {  // the house, then the courtyard
    add_wall(mesh, {x, 0, 0}, {x + 20, 0, 0}, 0, 8);
    add_wall(mesh, {x, 20, 0}, {x + 20, 20, 0}, 0, 8);
    add_wall(mesh, {x, 0, 0}, {x, 20, 0}, 0, 8);
    add_wall(mesh, {x + 20, 0, 0}, {x + 20, 20, 0}, 0, 7);
  }
  add_quad(mesh, {Vec3(20, 0, 8), Vec3(40, 0, 8), Vec3(40, 20, 8), Vec3(20, 20, 8)}, "wall");
  add_quad(mesh, {Vec3(-60, -60, 6), Vec3(-40, -60, 6), Vec3(-40, -40, 6), Vec3(-60, -40, 6)}, "wall");
  return mesh;
}

Simulator simulator_of(const Vec3& transmitter_m) {
  Scene scene;
  scene.add_material({"wall", ItuMaterial{"concrete", std::nullopt}});
  scene.set_scenery(quarter());
  scene.add_transmitter(device_at("mast", transmitter_m, 30.0));
  SimulationSettings settings{.frequency_hz = 3.5e9};
  settings.propagation.max_reflections = settings.propagation.max_transmissions = 0;
  settings.propagation.max_diffractions = 0;
  return {std::move(scene), settings};
}

/// Along y = 10, every 10 m from x = −55 to 95.
ReceiverGrid line_of_points() {
  ReceiverGrid grid;
  grid.id = "line";
  grid.origin_m = Vec3(-55.0, 10.3, 1.5);
  grid.spacing_m = {10.0, 10.0};
  grid.count = {16, 1};
  return grid;
}

std::vector<RadioMap> maps_of(Simulator& simulator) {
  const Frame frame = simulator.scene().frame_at(0.0);
  simulator.advance(frame);
  std::vector<RadioMap> maps = simulator.radio_maps(line_of_points());
  io::mark_sheltered(simulator, frame, maps);
  return maps;
}

}  // namespace

TEST_CASE("under a roof between walls, though the shell leaks; not in a courtyard, not under a bridge, not on top") {
  const Simulator simulator = simulator_of(Vec3(0, 0, 30));
  CHECK(io::is_under_a_roof(simulator, Vec3(25, 10.3, 1.5)));
  CHECK(io::is_under_a_roof(simulator, Vec3(38, 3, 1.5)));
  CHECK_FALSE(io::is_under_a_roof(simulator, Vec3(70, 10.3, 1.5)));
  CHECK_FALSE(io::is_under_a_roof(simulator, Vec3(-50, -50, 1.5)));
  CHECK_FALSE(io::is_under_a_roof(simulator, Vec3(30, 10, 8.5)));
  CHECK_FALSE(io::is_under_a_roof(simulator, Vec3(0, 0, 1.5)));
}

TEST_CASE("points that nothing reaches are sheltered in the house alone, and are hatched and not counted") {
  Simulator simulator = simulator_of(Vec3(50, 10, 40));
  const std::vector<RadioMap> maps = maps_of(simulator);
  std::size_t sheltered = 0;
  for (const RadioMapPoint& point : maps.front().points) {
    const bool in_house = point.position_m.x > 20.0 && point.position_m.x < 40.0;
    CAPTURE(point.position_m.x);
    CHECK_FALSE(point.obstructed);
    CHECK(point.sheltered == in_house);
    sheltered += point.sheltered ? 1U : 0U;
  }
  CHECK(sheltered == 2);
  const io::HeatMap picture = io::map_picture(maps.front(), simulator.scene(), simulator.scene().frame_at(0.0), 3.5e9);
  CHECK(std::count(picture.hatched.begin(), picture.hatched.end(), char{1}) == 2);
  CHECK(picture.hatched_label.find("roof") != std::string::npos);
  CHECK(combine_maps(maps).points.at(8).sheltered);
}

TEST_CASE("on a map of the indoors a room that nothing reaches is what is looked for") {
  Simulator simulator = simulator_of(Vec3(30, 5, 3));
  const std::vector<RadioMap> maps = maps_of(simulator);
  REQUIRE(maps.size() == 1);
  for (const RadioMapPoint& point : maps.front().points) CHECK_FALSE(point.sheltered);
}

}  // namespace test_shelter
