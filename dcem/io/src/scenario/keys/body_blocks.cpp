#include "dcem/core/constants.hpp"
#include "dcem/io/src/scenario/keys/blocks.hpp"
#include "dcem/io/src/scenario/keys/rule_words.hpp"

namespace dcem::io::keys {

namespace {

KeyRule angle_deg(const std::string& name, const std::string& meaning, const std::string& example) {
  return {name, {number(any_angle_deg, "deg")}, standard(0.0), meaning, example};
}

std::vector<KeyRule> pose_keys(const Absence& position) {
  return {{"position_m", {position_m()}, position, "Where the local origin is.", "[5, 3, 0]"},
          angle_deg("yaw_deg", "Turn about z, from x towards y.", "90"),
          angle_deg("pitch_deg", "Then about y, nose down positive.", "0"),
          angle_deg("roll_deg", "Then about x.", "0")};
}

const BlockRule& waypoint_block() {
  static const BlockRule rule = [] {
    BlockRule waypoint{"motion.waypoints[]",
                       "Linear in position, shortest arc in angle, held at both ends.",
                       {{"t_s", {number(any_instant_s, "s")}, required(), "Later than the waypoint before.", "10"}}};
    for (KeyRule& key : pose_keys(required())) waypoint.keys.push_back(std::move(key));
    return waypoint;
  }();
  return rule;
}

}  // namespace

const BlockRule& motion_block() {
  static const BlockRule rule = [] {
    BlockRule motion{"motion", "Of an object or a device: a pose that may have a velocity, or waypoints, or a file.",
                     pose_keys(chosen())};
    motion.keys.push_back({"velocity_mps",
                           {three_numbers({-speed_of_light_mps, speed_of_light_mps}, "m/s")},
                           told("it stands"),
                           "Moves the pose, which holds at time.start_s; slower than light.",
                           "[0, -8, 0]"});
    motion.keys.push_back({"waypoints",
                           {list(block(waypoint_block()), 1, "waypoint")},
                           chosen(),
                           "Poses at instants; pose and velocity stand there, not beside it.",
                           ""});
    motion.keys.push_back({"poses_csv",
                           {file()},
                           chosen(),
                           "A table t_s,id,x_m,y_m,z_m,yaw_deg[,pitch_deg,roll_deg] with rows of this id.",
                           R"("poses.csv")"});
    motion.choices = {{"form", {"position_m", "waypoints", "poses_csv"}}};
    return motion;
  }();
  return rule;
}

const BlockRule& object_block() {
  static const ObjSettings standards{};
  static const BlockRule rule{
      "objects[]",
      "A mesh or a box, in axes of its own: x forward, z up.",
      {{"id", {identifier()}, required(), "Its name, once.", R"("car1")"},
       {"obj", {file()}, chosen(), "A mesh, an OBJ file.", R"("car.obj")"},
       {"up", {word<UpAxis>()}, standard(standards.up), "As in scene; goes with obj only.", R"("z")"},
       {"unit_m", {number({1e-9, 1e6}, "m")}, standard(standards.unit_m), "As in scene; goes with obj only.", "1"},
       {"box_m",
        {three_numbers({0.0, 1e6, true}, "m", "three lengths [along x, along y, along z]")},
        chosen(),
        "A closed box that stands on z = 0 with its centre over the local origin.",
        "[4.4, 1.8, 1.5]"},
       {"material",
        {line()},
        required("with box_m, unless foliage is true"),
        "What the box is made of; a mesh has its materials from its file.",
        R"("metal")"},
       {"motion", {block(motion_block())}, told("it stands at the origin"), "Where it is, and how it moves.", ""},
       {"foliage",
        {boolean()},
        standard(false),
        "All of it is the skin of leaves and twigs that paths lose power in by the metre.",
        "true"}},
      {{"shape", {"obj", "box_m"}}}};
  return rule;
}

}  // namespace dcem::io::keys
