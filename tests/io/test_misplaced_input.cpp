/// Input that can hardly be meant is named, once, with its frames; what may be meant is not.
#include <doctest/doctest.h>

#include <array>
#include <fstream>
#include <string>
#include <vector>

#include "dcem/io/inspection.hpp"
#include "dcem/io/placement_watch.hpp"
#include "dcem/io/scenario.hpp"
#include "dcem/io/src/checks/frame_ranges.hpp"
#include "dcem/sim/simulator.hpp"
#include "tests/io/temporary_folder.hpp"

namespace test_misplaced_input {

using namespace dcem;
using dcem::test::TemporaryFolder;

namespace {

/// An OBJ whose corners are scaled, axis by axis, and may be turned.
class ObjText {
 public:
  explicit ObjText(Vec3 scale = Vec3(1.0), bool y_up = false) : scale_(scale), y_up_(y_up) {}

  void add_quad(const std::array<Vec3, 4>& corners_m) {
    for (const Vec3& corner_m : corners_m) {
      const Vec3 turned = y_up_ ? Vec3(corner_m.x, corner_m.z, -corner_m.y) : corner_m;
      const Vec3 v = turned * scale_;
      text_ += "v " + std::to_string(v.x) + " " + std::to_string(v.y) + " " + std::to_string(v.z) + "\n";
    }
    const std::size_t first = 4 * quads_++ + 1;
    text_ += "f";
    for (std::size_t corner = 0; corner < 4; ++corner) text_ += " " + std::to_string(first + corner);
    text_ += "\n";
  }
  void add_ground(const Vec3& low_m, const Vec3& high_m) {
    add_quad(
        {low_m, Vec3(high_m.x, low_m.y, low_m.z), Vec3(high_m.x, high_m.y, low_m.z), Vec3(low_m.x, high_m.y, low_m.z)});
  }
  /// With vertices of its own for each face: they are welded when the scene is read.
  void add_box(const Vec3& a, const Vec3& b) {
    add_quad({Vec3(a.x, a.y, a.z), Vec3(b.x, a.y, a.z), Vec3(b.x, b.y, a.z), Vec3(a.x, b.y, a.z)});
    add_quad({Vec3(a.x, a.y, b.z), Vec3(b.x, a.y, b.z), Vec3(b.x, b.y, b.z), Vec3(a.x, b.y, b.z)});
    add_quad({Vec3(a.x, a.y, a.z), Vec3(b.x, a.y, a.z), Vec3(b.x, a.y, b.z), Vec3(a.x, a.y, b.z)});
    add_quad({Vec3(a.x, b.y, a.z), Vec3(b.x, b.y, a.z), Vec3(b.x, b.y, b.z), Vec3(a.x, b.y, b.z)});
    add_quad({Vec3(a.x, a.y, a.z), Vec3(a.x, b.y, a.z), Vec3(a.x, b.y, b.z), Vec3(a.x, a.y, b.z)});
    add_quad({Vec3(b.x, a.y, a.z), Vec3(b.x, b.y, a.z), Vec3(b.x, b.y, b.z), Vec3(b.x, a.y, b.z)});
  }
  std::string text() const { return "usemtl wall\n" + text_; }

 private:
  Vec3 scale_;
  bool y_up_;
  std::string text_;
  std::size_t quads_ = 0;
};

/// A ground with a house of 20 x 20 x 10 m whose nearest corner is (20, 20), and a lower ground far away.
ObjText village() {
  ObjText obj;
  obj.add_ground(Vec3(-100, -100, 0), Vec3(100, 100, 0));
  obj.add_ground(Vec3(200, -100, -5), Vec3(300, 100, -5));
  obj.add_box(Vec3(20, 20, 0), Vec3(40, 40, 10));
  return obj;
}

/// Thirty houses of different heights on a kilometre of ground.
ObjText city(const Vec3& scale, bool y_up = false) {
  ObjText obj(scale, y_up);
  obj.add_ground(Vec3(0), Vec3(1000, 800, 0));
  for (int house = 0; house < 30; ++house) {
    const Vec3 corner(30.0 * house + 5.0, 25.0 * (house % 7) + 300.0, 0.0);
    obj.add_box(corner, corner + Vec3(22, 18, 12.0 + house));
  }
  return obj;
}

struct Wanted {
  std::string obj = village().text();
  std::string material = R"({"model": "constant", "reflection": 0.7})";
  std::string transmitter_m = "[0, 0, 8]", receiver_m = "[10, 5, 1.5]";
  std::string grid = {}, objects = {};
  std::string more = {};  ///< blocks, each with a comma behind it
  int frames = 1;
};

std::string scenario_text(const Wanted& wanted) {
  const std::string grid = wanted.grid.empty() ? ""
                                               : R"(, {"id": "area", "grid": {"origin_m": )" + wanted.grid +
                                                     R"(, "spacing_m": [2, 2], "count": [5, 5]}})";
  return R"({"format": "dcem-scenario/1", )" + wanted.more +
         R"("scene": {"obj": "village.obj"}, "materials": {"wall": )" + wanted.material +
         R"(}, "frequency_hz": 5.9e9, "time": {"step_s": 1, "frames": )" + std::to_string(wanted.frames) +
         R"(}, "objects": [)" + wanted.objects + R"(], "transmitters": [{"id": "bs", "position_m": )" +
         wanted.transmitter_m + R"(, "power_dbm": 20}], "receivers": [{"id": "ue", "position_m": )" +
         wanted.receiver_m + "}" + grid + "]}";
}

/// What is said of a scenario when it is read, and of its frames.
std::vector<std::string> warnings_of(const Wanted& wanted,
                                     io::PlacementWatch::Links links = io::PlacementWatch::Links::chosen) {
  const TemporaryFolder folder;
  std::ofstream(folder / "village.obj") << wanted.obj;
  std::ofstream(folder / "village.json") << scenario_text(wanted);
  const io::Scenario scenario = io::load_scenario(folder / "village.json");
  std::vector<std::string> all = scenario.warnings;
  Simulator simulator(scenario.scene, scenario.settings);
  io::PlacementWatch watch("village.json", simulator, simulator.scene().receivers(), scenario.grids, links);
  for (std::size_t frame = 0; frame < scenario.time.frames; ++frame) {
    const Frame instant = simulator.scene().frame_at(scenario.time_s(frame), frame);
    simulator.move_to(instant);
    watch.look(instant);
  }
  const std::vector<std::string> placed = watch.warnings();
  all.insert(all.end(), placed.begin(), placed.end());
  return all;
}

/// The only warning there is.
std::string warning_of(const Wanted& wanted) {
  const std::vector<std::string> all = warnings_of(wanted);
  CHECK(all.size() == 1);
  return all.empty() ? std::string() : all.front();
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("nothing is said of a village in which all is in its place") {
  CHECK(warnings_of({}).empty());
}

TEST_CASE("devices kilometres outside are named, but not what flies above") {
  Wanted wanted;
  wanted.receiver_m = "[5100, 0, 1.5]";
  CHECK(contains(warning_of(wanted), "village.json: receiver 'ue' is up to 4.8 km outside the box of the scenery"));
  wanted.receiver_m = "[5100, 0, 500000]";
  CHECK(warnings_of(wanted).empty());
  wanted.receiver_m = "[1200, 0, 1.5]";  // 900 m
  CHECK(warnings_of(wanted).empty());
}

TEST_CASE("what is far away and far up is named where nobody is near, or where nothing flies") {
  Wanted wanted;
  wanted.receiver_m = "[20000, 10000, 25000]";  // an aeroplane, by its height
  CHECK(warnings_of(wanted).empty());
  wanted.transmitter_m = "[1000, 8000, 20000]";  // but both of them?
  const std::vector<std::string> both = warnings_of(wanted);
  REQUIRE(both.size() == 2);
  CHECK(contains(both[0], "transmitter 'bs' is up to 21.5 km outside the box of the scenery"));
  CHECK(contains(both[1], "receiver 'ue' is up to 33.3 km outside the box of the scenery"));
  wanted.grid = "[0, 0, 1.5]";
  CHECK(warnings_of(wanted).empty());
  wanted.grid.clear();
  wanted.transmitter_m = "[0, 0, 8]";
  wanted.receiver_m = "[5000, 0, 80000]";  // above balloons, below satellites
  CHECK(contains(warning_of(wanted), "receiver 'ue' is up to 80.1 km outside the box of the scenery"));
  wanted.receiver_m = "[900, 0, 900000000]";
  CHECK(contains(warning_of(wanted), "receiver 'ue' is up to 900000 km outside the box of the scenery"));
}

TEST_CASE("satellites and aeroplanes are meant where the last of many transmitters stands on the ground") {
  Wanted wanted;
  const std::string sky_m = "[1000, 8000, 500000]";
  wanted.receiver_m = "[20000, 10000, 25000]";
  wanted.transmitter_m = sky_m;
  for (int number = 0; number < 80; ++number) {
    wanted.transmitter_m +=
        R"(, "power_dbm": 20}, {"id": "satellite )" + std::to_string(number) + R"(", "position_m": )" + sky_m;
  }
  CHECK_FALSE(warnings_of(wanted).empty());
  wanted.transmitter_m += R"(, "power_dbm": 20}, {"id": "gateway", "position_m": [0, 0, 8])";
  CHECK(warnings_of(wanted).empty());
}

TEST_CASE(
    "a receiver at the very point of a transmitter is named, unless no direct path is wanted or they have no link") {
  Wanted wanted;
  wanted.receiver_m = wanted.transmitter_m;
  wanted.frames = 2;
  CHECK(warning_of(wanted) ==
        "village.json: receiver 'ue' is at the very point of transmitter 'bs', and their link has no direct path "
        "(frames 0 to 1)");
  wanted.more = R"("propagation": {"line_of_sight": false}, )";
  CHECK(warnings_of(wanted).empty());
  wanted.more = R"("links": {"pairs": [["lamp", "ue"]]}, )";
  wanted.transmitter_m += R"(, "power_dbm": 20}, {"id": "lamp", "position_m": [5, 5, 8])";
  CHECK(warnings_of(wanted).empty());
  CHECK(warnings_of(wanted, io::PlacementWatch::Links::all).size() == 1);  // maps
  wanted.more = R"("links": {"pairs": [["bs", "ue"]], "range_m": 5}, )";
  CHECK(warnings_of(wanted).size() == 1);
  wanted.receiver_m = "[0, 0, 8.000001]";
  CHECK(warnings_of(wanted).empty());
}

TEST_CASE("devices below everything, and under the ground, are named") {
  Wanted wanted;
  wanted.transmitter_m = "[0, 0, -8]";
  CHECK(contains(warning_of(wanted), "transmitter 'bs' is up to 3.00 m below everything in the scenery"));
  wanted.transmitter_m = "[0, 0, -1.5]";  // above the lower ground, but not over it
  CHECK(contains(warning_of(wanted), "transmitter 'bs' has a broad surface above it and none below"));
}

TEST_CASE("under a slope is under the ground, beside a sunk house, too; over it, and in a house on it, is not") {
  Wanted wanted;
  ObjText slope;  // rises by one metre in five
  slope.add_quad({Vec3(-100, -100, -20), Vec3(100, -100, 20), Vec3(100, 100, 20), Vec3(-100, 100, -20)});
  slope.add_quad({Vec3(-300, -100, -60), Vec3(-100, -100, -20), Vec3(-100, 100, -20), Vec3(-300, 100, -60)});
  slope.add_box(Vec3(-80, 40, -16), Vec3(-60, 80, 0));  // down the slope
  wanted.obj = slope.text();
  wanted.transmitter_m = "[0, 0, 8]";
  for (const double depth_m : {0.5, 2.0, 15.0}) {
    CAPTURE(depth_m);
    wanted.receiver_m = "[10, 5, " + std::to_string(2.0 - depth_m) + "]";
    CHECK(contains(warning_of(wanted), "receiver 'ue' has a broad surface above it and none below"));
  }
  wanted.receiver_m = "[10, 60, -13]";  // a wall of the house is as deep as this
  CHECK(contains(warning_of(wanted), "receiver 'ue' has a broad surface above it and none below"));
  wanted.receiver_m = "[10, 5, 3.5]";
  CHECK(warnings_of(wanted).empty());
  wanted.receiver_m = "[-70, 60, -8]";  // in the house, which stands on the slope and has a floor of its own
  wanted.material = R"({"model": "constant", "reflection": 0.7, "penetration_loss_db": 10})";
  CHECK(warnings_of(wanted).empty());
}

TEST_CASE("a vehicle under the ground is named, also one that stands") {
  Wanted wanted;
  wanted.objects = R"({"id": "car1", "box_m": [4, 2, 1.5], "material": "wall", "motion": {"position_m": [1, 3, -2]}})";
  CHECK(contains(warning_of(wanted), "object 'car1' has a broad surface above it and none below"));
  wanted.objects = R"({"id": "car1", "box_m": [4, 2, 1.5], "material": "wall", "motion": {"position_m": [1, 3, -9]}})";
  CHECK(contains(warning_of(wanted), "object 'car1' is up to 3.25 m below everything in the scenery"));
  wanted.objects =
      R"({"id": "car1", "box_m": [4, 2, 1.5], "material": "wall", "motion": {"position_m": [1, 3, -0.1]}})";
  CHECK(warnings_of(wanted).empty());  // wheels in the ground
}

TEST_CASE("a room without a floor is no ground") {
  Wanted wanted;
  ObjText hall;
  hall.add_ground(Vec3(0, 0, 4), Vec3(60, 40, 4));  // its ceiling
  hall.add_ground(Vec3(100, 0, -2), Vec3(120, 40, -2));
  hall.add_quad({Vec3(0, 0, 0), Vec3(60, 0, 0), Vec3(60, 0, 4), Vec3(0, 0, 4)});
  hall.add_quad({Vec3(0, 40, 0), Vec3(60, 40, 0), Vec3(60, 40, 4), Vec3(0, 40, 4)});
  hall.add_quad({Vec3(0, 0, 0), Vec3(0, 40, 0), Vec3(0, 40, 4), Vec3(0, 0, 4)});
  wanted.obj = hall.text();
  wanted.transmitter_m = "[20, 20, 3]";
  wanted.receiver_m = "[30, 12, 1]";
  CHECK(warnings_of(wanted).empty());
}

TEST_CASE("a receiver in a house that lets nothing through is named, unless a transmitter or the wall makes it heard") {
  Wanted wanted;
  wanted.receiver_m = "[31, 32, 1.5]";
  CHECK(contains(warning_of(wanted),
                 "receiver 'ue' is inside a closed part of the scenery (of 'wall'), which lets "
                 "nothing through, and no transmitter is in there (frame 0)"));
  wanted.transmitter_m = "[25, 26, 3]";
  CHECK(warnings_of(wanted).empty());
  wanted.transmitter_m = "[0, 0, 8]";
  wanted.material = R"({"model": "constant", "reflection": 0.7, "penetration_loss_db": 10})";
  CHECK(warnings_of(wanted).empty());
}

TEST_CASE("a transmitter that is shut in while most receivers are outside is named") {
  Wanted wanted;
  wanted.transmitter_m = "[31, 32, 1.5]";
  CHECK(contains(warning_of(wanted),
                 "transmitter 'bs' is inside a closed part of the scenery (of 'wall'), which lets "
                 "nothing through, and no receiver is in there"));
  wanted.grid = "[24, 24, 1.5]";  // 25 points in the house beside the receiver outside
  CHECK(warnings_of(wanted).empty());
}

TEST_CASE("a vehicle that drives through a house is named with its frames, and one that passes it is not") {
  Wanted wanted;
  wanted.frames = 12;
  wanted.objects = R"({"id": "car1", "box_m": [4, 2, 1.5], "material": "wall",
                       "motion": {"position_m": [1, 30.3, 0.1], "velocity_mps": [5, 0, 0]}})";
  // x is 21 in frame 4 and 36 in frame 7; in frame 8 it is 41, outside again.
  CHECK(contains(warning_of(wanted),
                 "object 'car1' is with its middle inside a closed part of the scenery (of 'wall'), which "
                 "lets nothing through; is its way meant? (frames 4 to 7)"));
  wanted.objects = R"({"id": "car1", "box_m": [4, 2, 1.5], "material": "wall",
                       "motion": {"position_m": [1, 15.3, 0.1], "velocity_mps": [5, 0, 0]}})";
  CHECK(warnings_of(wanted).empty());
}

TEST_CASE("what goes through a wall that waves pass is named; what stays inside of it, or drives under trees, is not") {
  Wanted wanted;
  wanted.frames = 12;
  wanted.material = R"({"model": "constant", "reflection": 0.7, "penetration_loss_db": 10})";
  wanted.objects = R"({"id": "car1", "box_m": [4, 2, 1.5], "material": "wall",
                       "motion": {"position_m": [1, 30.3, 0.1], "velocity_mps": [5, 0, 0]}})";
  CHECK(contains(warning_of(wanted),
                 "object 'car1' goes through a wall of a closed part of the scenery (of 'wall'); is its way meant? "
                 "(frames 4 and 8)"));
  wanted.objects = R"({"id": "robot", "box_m": [0.5, 0.5, 1.5], "material": "wall",
                       "motion": {"position_m": [22, 30.3, 0.1], "velocity_mps": [1, 0, 0]}})";
  CHECK(warnings_of(wanted).empty());
  wanted.material = R"({"model": "constant", "reflection": 0.7})";
  wanted.objects = R"({"id": "car1", "box_m": [4, 2, 1.5], "material": "wall",
                       "motion": {"position_m": [1, 5, 0.1], "velocity_mps": [5, 0, 0]}},
                      {"id": "trees", "box_m": [30, 9, 6], "foliage": true, "motion": {"position_m": [20, 5, 0]}})";
  wanted.receiver_m = "[20, 6, 2]";  // in their shade
  CHECK(warnings_of(wanted).empty());
  wanted.objects = R"({"id": "trees", "box_m": [30, 9, 6], "foliage": true, "motion": {"position_m": [20, 5, -4.5]}})";
  CHECK(warnings_of(wanted).empty());  // the middle of all woods of a hilly town may be under a hill
}

TEST_CASE("vehicles far outside are named, also where devices ride on them; what flies high is not") {
  Wanted wanted;
  wanted.objects =
      R"({"id": "car1", "box_m": [4, 2, 1.5], "material": "wall", "motion": {"position_m": [50000, 0, 0.1]}})";
  CHECK(contains(warning_of(wanted), "object 'car1' is up to 49.7 km outside the box of the scenery"));
  wanted.objects.clear();
  wanted.receiver_m = "[1000000, 0, 550000]";  // a satellite at 29 degrees
  CHECK(warnings_of(wanted).empty());
}

TEST_CASE("what is mounted on a wall or a ceiling is not inside") {
  Wanted wanted;
  for (const char* place : {"[20, 30, 5]", "[40, 30, 5]", "[30, 20, 5]", "[30, 30, 10]"}) {  // on faces of the house
    CAPTURE(place);
    wanted.receiver_m = place;
    CHECK(warnings_of(wanted).empty());
  }
  wanted.receiver_m = "[10, 5, 1.5]";
  wanted.transmitter_m = "[20, 31, 6]";
  CHECK(warnings_of(wanted).empty());
}

TEST_CASE("nothing is under the ground beneath a bridge, a canopy or the vehicle that carries it") {
  Wanted wanted;
  ObjText bridge;
  bridge.add_box(Vec3(-100, -5, 6), Vec3(100, 5, 7));
  wanted.obj = bridge.text();
  wanted.transmitter_m = "[0, 0, 3]";
  wanted.receiver_m = "[30, 2, 1.5]";
  CHECK(warnings_of(wanted).empty());
}

TEST_CASE("a grid far away or under everything is named; its points may lie in houses") {
  Wanted wanted;
  wanted.grid = "[4000, 0, 1.5]";
  CHECK(contains(warning_of(wanted), "grid 'area' is up to 3.7 km outside the box of the scenery"));
  wanted.grid = "[0, 0, -9]";
  CHECK(contains(warning_of(wanted), "grid 'area' is up to 4.00 m below everything in the scenery"));
  wanted.grid = "[16, 16, 1.5]";
  CHECK(warnings_of(wanted).empty());
}

TEST_CASE("of many that are misplaced alike five are named") {
  const TemporaryFolder folder;
  std::ofstream(folder / "village.obj") << village().text();
  Wanted wanted;
  std::string text = scenario_text(wanted);
  const std::string one = R"("id": "ue", "position_m": [10, 5, 1.5])";
  std::string positions;
  for (int index = 0; index < 9; ++index)
    positions += (index == 0 ? "[" : ", [") + std::to_string(9000 + index) + ", 0, 1.5]";
  text.replace(text.find(one), one.size(), R"("id": "ue", "positions_m": [)" + positions + "]");
  std::ofstream(folder / "village.json") << text;
  const io::Scenario scenario = io::load_scenario(folder / "village.json");
  Simulator simulator(scenario.scene, scenario.settings);
  io::PlacementWatch watch("village.json", simulator, simulator.scene().receivers(), {});
  watch.look(simulator.scene().frame_at(0.0, 0));
  const std::vector<std::string> all = watch.warnings();
  REQUIRE(all.size() == 6);
  CHECK(all.back() == "village.json: 4 more are far outside the scenery");
}

TEST_CASE("a mesh in millimetres, in degrees, or with another axis up is noticed; a city in metres is not") {
  Wanted wanted;
  wanted.transmitter_m = "[500, 200, 30]";
  wanted.receiver_m = "[510, 250, 1.5]";
  wanted.obj = city(Vec3(1.0)).text();
  CHECK(warnings_of(wanted).empty());
  const auto doubts = [&](const ObjText& obj) {
    const TemporaryFolder folder;
    std::ofstream(folder / "city.obj") << obj.text();
    const std::vector<std::string> all = io::inspect_obj(folder / "city.obj").warnings;
    std::string joined;
    for (const std::string& line : all) joined += line + "\n";
    return joined;
  };
  CHECK(contains(doubts(city(Vec3(1000.0))), "is it in millimetres (unit_m 0.001) or"));
  CHECK(contains(doubts(city(Vec3(100.0))), "or centimetres (unit_m 0.01)?"));
  CHECK(contains(doubts(city(Vec3(1.3e-5, 9e-6, 1.0))), "are x and y in degrees?"));
  CHECK(contains(doubts(city(Vec3(1.0), true)), "flat along y; does another axis of the file point up (up)?"));
  CHECK_FALSE(contains(doubts(city(Vec3(1.0))), "mesh is"));
  CHECK_FALSE(contains(doubts(village()), "mesh is"));
}

TEST_CASE(
    "an office in centimetres, in millimetres or on its side is noticed; one in metres, a tunnel or an alley is not") {
  const auto doubts = [](const ObjText& obj) {
    const TemporaryFolder folder;
    std::ofstream(folder / "office.obj") << obj.text();
    std::string joined;
    for (const std::string& line : io::inspect_obj(folder / "office.obj").warnings) joined += line + "\n";
    return joined;
  };
  const auto office = [](const Vec3& scale, bool y_up) {
    ObjText obj(scale, y_up);
    obj.add_box(Vec3(0), Vec3(14, 9, 2.8));
    for (int desk = 0; desk < 4; ++desk) obj.add_box(Vec3(3.0 * desk + 1, 3, 0), Vec3(3.0 * desk + 2.5, 4, 0.75));
    return obj;
  };
  CHECK(doubts(office(Vec3(1.0), false)).empty());
  CHECK(contains(doubts(office(Vec3(100.0), false)),
                 "office.obj: the mesh is 1400 x 900 x 280 m in size with a ceiling over all of it; is it in "
                 "centimetres (unit_m 0.01)"));
  CHECK(contains(doubts(office(Vec3(1000.0), false)), "is it in millimetres (unit_m 0.001)"));
  CHECK(contains(doubts(office(Vec3(1.0), true)), "flat along y; does another axis of the file point up (up)?"));
  ObjText tunnel;
  for (int part = 0; part < 5; ++part) tunnel.add_box(Vec3(20.0 * part, 0, 0), Vec3(20.0 * part + 20, 4.4, 6.5));
  CHECK(doubts(tunnel).empty());
  ObjText alley;  // as wide as a storey is high
  alley.add_ground(Vec3(0, 0, 0), Vec3(60, 4, 0));
  for (int house = 0; house < 12; ++house) {
    for (const double y_m : {0.0, 4.0}) {
      alley.add_quad({Vec3(5.0 * house, y_m, 0), Vec3(5.0 * house + 5, y_m, 0), Vec3(5.0 * house + 5, y_m, 15),
                      Vec3(5.0 * house, y_m, 15)});
    }
  }
  CHECK(doubts(alley).empty());
  ObjText hangar;
  for (int part = 0; part < 4; ++part) hangar.add_box(Vec3(40.0 * part, 0, 0), Vec3(40.0 * part + 40, 120, 60));
  CHECK(doubts(hangar).empty());
}

TEST_CASE("an object of half a kilometre is noticed, and what scatters while nobody adds it up") {
  Wanted wanted;
  wanted.objects =
      R"({"id": "car1", "box_m": [4400, 1.8, 1.5], "material": "wall", "motion": {"position_m": [0, -50, 0.1]}})";
  CHECK(
      contains(warning_of(wanted), "village.json:1: objects[0]: the object 'car1' is 4400 x 1.800 x 1.500 m in size"));
  // All woods of a town are one object.
  wanted.objects = R"({"id": "woods", "box_m": [4400, 9, 6], "foliage": true, "motion": {"position_m": [0, -50, 0]}})";
  CHECK(warnings_of(wanted).empty());
  wanted.objects.clear();
  wanted.material = R"({"model": "constant", "reflection": 0.7, "scattering": 0.4})";
  CHECK(contains(warning_of(wanted),
                 "material 'wall' scatters, which weakens its mirror, and propagation.diffuse is off"));
}

TEST_CASE("frames in words") {
  const auto runs = [](std::initializer_list<std::size_t> frames) {
    io::FrameRuns of;
    for (const std::size_t frame : frames) of.add(frame);
    return of;
  };
  CHECK(runs({3}).words() == "frame 3");
  CHECK(runs({3, 3}).words() == "frame 3");
  CHECK(runs({3, 4, 5}).words() == "frames 3 to 5");
  CHECK(runs({1, 3, 4}).words() == "frames 1 and 3 to 4");
  CHECK(runs({0, 2, 4, 6, 8, 10}).words() == "frames 0, 2, 4 and others, 6 in all");
  CHECK(runs({5, 3}).words() == "frames 3 and 5");
  CHECK(runs({5, 6, 5, 2, 3}).words() == "frames 2 to 3 and 5 to 6");
  io::FrameRuns both = runs({1, 2, 7});
  both.add(runs({0, 3, 9}));
  CHECK(both.words() == "frames 0 to 3, 7 and 9");
  CHECK(both.first() == 0);
}

}  // namespace test_misplaced_input
