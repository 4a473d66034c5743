#include "dcem/io/src/traffic/poses_csv.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <string>

#include "dcem/io/scenario.hpp"
#include "tests/io/temporary_folder.hpp"
#include "tests/io/trace_files.hpp"

namespace test_poses_csv {

using namespace dcem;
using test::holds;

namespace {

const std::string header = "t_s,id,x_m,y_m,z_m,yaw_deg,pitch_deg,roll_deg\n";

WaypointMotion motion_of(const std::string& text, const std::string& id) {
  const test::TemporaryFolder folder;
  test::write_text(folder / "poses.csv", text);
  io::PosesCsv poses(folder / "poses.csv");
  const WaypointMotion* motion = poses.take(id);
  REQUIRE(motion != nullptr);
  return *motion;
}

std::string error_of(const std::string& text) {
  const test::TemporaryFolder folder;
  test::write_text(folder / "poses.csv", text);
  return test::input_error_of([&] { io::PosesCsv(folder / "poses.csv"); });
}

/// Two objects and a device in a scenario, all moved by one file unless a test says otherwise.
struct PosesCase {
  test::TemporaryFolder folder;
  std::string poses = header + "0,box,1,2,0,0,0,0\n0,rx,5,0,1,0,0,0\n0,bus,3,4,0,90,0,0\n10,box,11,2,0,90,0,0\n";
  std::string box_motion = R"({"poses_csv": "poses.csv"})";

  io::Scenario load() const {
    test::write_text(folder / "poses.csv", poses);
    test::write_text(folder / "ground.obj", "v -9 -9 0\nv 9 -9 0\nv 9 9 0\nv -9 9 0\nusemtl metal\nf 1 2 3 4\n");
    test::write_text(
        folder / "case.json",
        R"({"format": "dcem-scenario/1", "frequency_hz": 30e9, "scene": {"obj": "ground.obj"},)"
        R"("materials": {"metal": {"model": "pec"}}, "objects": [)"
        R"({"id": "box", "box_m": [1, 1, 1], "material": "metal", "motion": )" +
            box_motion +
            R"(},{"id": "bus", "box_m": [9, 2, 3], "material": "metal", "motion": {"poses_csv": "poses.csv"}}],)"
            R"("transmitters": [{"id": "tx", "position_m": [0, 0, 10], "power_dbm": 30}],)"
            R"("receivers": [{"id": "rx", "motion": {"poses_csv": "poses.csv"}}]})");
    return io::load_scenario(folder / "case.json");
  }
  std::string error() const {
    return test::input_error_of([&] { load(); });
  }
};

}  // namespace

TEST_CASE("rows of an id become its waypoints") {
  const WaypointMotion motion = motion_of(header + "0,a,1,2,3,90,10,-20\n1,b,0,0,0,0,0,0\n2.5,a,4,5,6,180,0,0\n", "a");
  REQUIRE(motion.waypoints.size() == 2);
  CHECK(motion.waypoints[0].time_s == 0.0);
  CHECK(motion.waypoints[0].pose.position_m == Vec3(1, 2, 3));
  CHECK(motion.waypoints[0].pose.yaw_rad == doctest::Approx(std::acos(0.0)));
  CHECK(motion.waypoints[0].pose.pitch_rad == doctest::Approx(std::acos(-1.0) / 18).scale(0.0));
  CHECK(motion.waypoints[0].pose.roll_rad == doctest::Approx(-std::acos(-1.0) / 9).scale(0.0));
  CHECK(motion.waypoints[1].time_s == 2.5);
  CHECK(motion.waypoints[1].pose.position_m == Vec3(4, 5, 6));
}

TEST_CASE("columns are found by name, in any order; pitch and roll may be missing") {
  const WaypointMotion motion = motion_of("yaw_deg,z_m,y_m,x_m,id,t_s\n0,3,2,1,a,7\n", "a");
  CHECK(motion.waypoints.at(0).time_s == 7.0);
  CHECK(motion.waypoints.at(0).pose == Pose{{1, 2, 3}});
}

TEST_CASE("line ends of all kinds, a byte order mark, quotes and empty lines at the end are read") {
  CHECK(motion_of("\xEF\xBB\xBFt_s,id,x_m,y_m,z_m,yaw_deg\r\n0,a,1,2,3,0\r\n\r\n \r\n", "a").waypoints.size() == 1);
  CHECK(motion_of("t_s,id,x_m,y_m,z_m,yaw_deg\r0,a,1,2,3,0", "a").waypoints.size() == 1);
  CHECK(motion_of("\"t_s\",id,x_m,y_m,z_m,yaw_deg\n\"0\",\"a, \"\"b\"\"\",1,2,3,0\n", "a, \"b\"").waypoints.size() ==
        1);
  CHECK(motion_of("t_s, id, x_m, y_m, z_m, yaw_deg\n0,a, 1, 2, 3, 0\n", "a").waypoints.size() == 1);
}

TEST_CASE("what is wrong with a table is refused with the line") {
  CHECK(holds(error_of(""), "poses.csv: is empty; expected a header"));
  CHECK(holds(error_of("\n0,a,1,2,3,0\n"), "is empty"));
  CHECK(holds(error_of("t_s,id,x_m,y_m,z_m,yaw_dg\n"),
              "poses.csv:1: unknown column 'yaw_dg' (did you mean 'yaw_deg'?); expected one of t_s, "));
  CHECK(holds(error_of("t_s,id,x_m,y_m,z_m\n"), "poses.csv:1: the column 'yaw_deg' is missing"));
  CHECK(holds(error_of("t_s,id,x_m,y_m,z_m,yaw_deg,x_m\n"), "poses.csv:1: column 'x_m' is there twice"));
  CHECK(holds(error_of(header + "0,a,1,2,3,0\n"), "poses.csv:2: 6 fields; expected 8"));
  CHECK(holds(error_of(header + "0,a,1,2,3,0,0,0\n\n1,a,1,2,3,0,0,0\n"), "poses.csv:3: an empty line"));
  CHECK(holds(error_of(header + "0,a,1,2,3,north,0,0\n"), "poses.csv:2: yaw_deg: found 'north'"));
  CHECK(holds(error_of(header + "0,a,1,nan,3,0,0,0\n"), "poses.csv:2: y_m: found 'nan'"));
  CHECK(holds(error_of(header + "0,a,1e10,2,3,0,0,0\n"), "poses.csv:2: x_m: found '1e10'"));
  CHECK(holds(error_of(header + "0,,1,2,3,0,0,0\n"), "poses.csv:2: id: empty"));
  CHECK(holds(error_of(header + "0,\"a,1,2,3,0,0,0\n"), "poses.csv:2: a quote is not closed"));
  CHECK(holds(error_of(header + "1,a,1,2,3,0,0,0\n0,b,1,2,3,0,0,0\n1,a,1,2,3,0,0,0\n"),
              "poses.csv:4: t_s: not later than the row of 'a' before"));
}

TEST_CASE("one file moves objects and devices") {
  const io::Scenario scenario = PosesCase().load();
  const Frame frame = scenario.scene.frame_at(5.0);
  CHECK(glm::length(frame.bodies[1].placement.pose.position_m - Vec3(6, 2, 0)) < 1e-12);  // halfway, rounded
  CHECK(frame.bodies[1].placement.pose.yaw_rad == doctest::Approx(std::acos(-1.0) / 4));
  CHECK(frame.bodies[1].placement.velocity.linear_mps.x == doctest::Approx(1.0));
  CHECK(frame.bodies[2].placement.pose.position_m == Vec3(3, 4, 0));
  CHECK(scenario.scene.device_state(scenario.scene.receivers()[0], frame).position_m == Vec3(5, 0, 1));
}

TEST_CASE("every row moves something, and everything has a row") {
  PosesCase files;
  files.poses += "0,car,0,0,0,0,0,0\n";
  CHECK(holds(files.error(), "poses.csv:6: id: 'car' moves nothing"));
  files.poses = header + "0,box,1,2,0,0,0,0\n0,rx,5,0,1,0,0,0\n";
  CHECK(holds(files.error(), "objects[1].motion.poses_csv: no row of 'bus' in 'poses.csv'"));
  files.poses = header;
  CHECK(holds(files.error(), "no row of 'box'"));
  files.poses = header + "0,rx,5,0,1,0,0,0\n0,bus,3,4,0,90,0,0\n0,box,5,0,1,0,0,0\n";
  files.box_motion = R"({"position_m": [0, 0, 0]})";
  CHECK(holds(files.error(), "poses.csv:4: id: 'box' moves nothing"));
  files.box_motion = R"({"poses_csv": "poses.csv", "yaw_deg": 3})";
  CHECK(holds(files.error(), "motion.yaw_deg: does not go with poses_csv"));
  files.box_motion = R"({"poses_csv": "pose.csv"})";
  CHECK(holds(files.error(), "motion.poses_csv: 'pose.csv' is not there"));
}

}  // namespace test_poses_csv
