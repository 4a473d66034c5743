#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "dcem/core/random.hpp"
#include "dcem/world/motion.hpp"

namespace test_motion {

using namespace dcem;

namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

Pose pose_deg(const Vec3& position_m, double yaw_deg, double pitch_deg = 0.0, double roll_deg = 0.0) {
  return {position_m, degrees_to_radians(yaw_deg), degrees_to_radians(pitch_deg), degrees_to_radians(roll_deg)};
}

/// The largest difference of two rotation matrices: angles may differ by whole turns.
double rotation_gap(const Pose& a, const Pose& b) {
  const Mat3 one = rotation_matrix(a), other = rotation_matrix(b);
  double gap = 0.0;
  for (int column = 0; column < 3; ++column) gap = std::max(gap, glm::length(one[column] - other[column]));
  return gap;
}

/// 10 m to the east in 2 s, a stop of 1 s, then a turn to the left while climbing.
WaypointMotion drive() {
  return {{{1.0, pose_deg(Vec3(0, 0, 0), 0)},
           {3.0, pose_deg(Vec3(10, 0, 0), 0)},
           {4.0, pose_deg(Vec3(10, 0, 0), 0)},
           {8.0, pose_deg(Vec3(14, 8, 2), 60, -20, 8)}}};
}

}  // namespace

TEST_CASE("a linear motion holds its pose at the reference time and moves from there without turning") {
  const LinearMotion motion{pose_deg(Vec3(1, 2, 3), 30, 5, -4), Vec3(10, 0, -1), 2.0};
  CHECK(placement_at(motion, 2.0).pose == motion.pose);
  const Placement later = placement_at(motion, 5.0);
  CHECK(later.pose.position_m == Vec3(31, 2, 0));
  CHECK(later.pose.yaw_rad == motion.pose.yaw_rad);
  CHECK(later.pose.pitch_rad == motion.pose.pitch_rad);
  CHECK(later.pose.roll_rad == motion.pose.roll_rad);
  CHECK(later.velocity == RigidVelocity{Vec3(10, 0, -1), Vec3(0.0)});
  CHECK(placement_at(motion, 0.0).pose.position_m == Vec3(-19, 2, 5));
}

TEST_CASE("waypoints are met exactly, and between them position is linear") {
  const WaypointMotion motion = drive();
  for (std::size_t index = 0; index + 1 < motion.waypoints.size(); ++index) {
    CHECK(placement_at(motion, motion.waypoints[index].time_s).pose == motion.waypoints[index].pose);
  }
  CHECK(placement_at(motion, 1.5).pose.position_m == Vec3(2.5, 0, 0));
  const Pose halfway = placement_at(motion, 6.0).pose;
  CHECK(halfway.position_m == Vec3(12, 4, 1));
  CHECK(halfway.yaw_rad == doctest::Approx(degrees_to_radians(30)).epsilon(1e-15));
  CHECK(halfway.pitch_rad == doctest::Approx(degrees_to_radians(-10)).epsilon(1e-15).scale(0.0));
  CHECK(halfway.roll_rad == doctest::Approx(degrees_to_radians(4)).epsilon(1e-15).scale(0.0));
}

TEST_CASE("the pose is held before the first and after the last waypoint, at rest") {
  const WaypointMotion motion = drive();
  for (const double time_s : {-1e9, 0.0, std::nextafter(1.0, 0.0)}) {
    CHECK(placement_at(motion, time_s) == Placement{motion.waypoints.front().pose, {}});
  }
  for (const double time_s : {std::nextafter(8.0, 9.0), 9.0, 1e9}) {
    CHECK(placement_at(motion, time_s) == Placement{motion.waypoints.back().pose, {}});
  }
}

TEST_CASE("at a waypoint the velocity is that of the segment that starts there; at the last, of the one that ends") {
  const WaypointMotion motion = drive();
  CHECK(placement_at(motion, 1.0).velocity.linear_mps == Vec3(5, 0, 0));
  CHECK(placement_at(motion, 3.0).velocity.linear_mps == Vec3(0, 0, 0));
  CHECK(placement_at(motion, 4.0).velocity.linear_mps == Vec3(1, 2, 0.5));
  // No segment starts at 8 s, and the last one holds the instant.
  CHECK(placement_at(motion, 8.0).velocity.linear_mps == Vec3(1, 2, 0.5));
}

TEST_CASE("the last waypoint is reached to the last bit: an object that arrived does not move once more") {
  RandomStream random(40);
  int missed = 0, moved_again = 0;
  for (int repeat = 0; repeat < 200; ++repeat) {
    const auto coordinate = [&] { return 1000.0 * (random.uniform() - 0.5); };
    const double x0 = coordinate(), y0 = coordinate(), x1 = coordinate(), y1 = coordinate();
    const double end_s = 0.1 + random.uniform();
    const WaypointMotion motion{{{0.0, pose_deg(Vec3(x0, y0, 0), 10)}, {end_s, pose_deg(Vec3(x1, y1, 0), 20)}}};
    missed += !(placement_at(motion, end_s).pose == motion.waypoints[1].pose);
    moved_again += !(placement_at(motion, end_s).pose == placement_at(motion, end_s + 1.0).pose);
  }
  CHECK(missed == 0);
  CHECK(moved_again == 0);
}

TEST_CASE("one waypoint is a place at rest for all times") {
  const WaypointMotion motion{{{5.0, pose_deg(Vec3(1, 2, 3), 45)}}};
  for (const double time_s : {0.0, 5.0, 10.0})
    CHECK(placement_at(motion, time_s) == Placement{motion.waypoints[0].pose, {}});
}

TEST_CASE("angles take the shortest arc, also across 180 degrees and after whole turns") {
  const auto between = [](double from_deg, double to_deg) {
    const WaypointMotion motion{{{0.0, pose_deg(Vec3(0), from_deg)}, {1.0, pose_deg(Vec3(0), to_deg)}}};
    const Placement halfway = placement_at(motion, 0.5);
    CHECK(rotation_gap(placement_at(motion, 1.0).pose, pose_deg(Vec3(0), to_deg)) < 1e-14);  // a few turns' rounding
    return std::pair(radians_to_degrees(halfway.pose.yaw_rad),
                     radians_to_degrees(halfway.velocity.angular_rad_per_s.z));
  };
  const auto check = [&](double from_deg, double to_deg, double halfway_deg, double rate_deg) {
    const auto [yaw_deg, got_rate_deg] = between(from_deg, to_deg);
    CHECK(std::abs(std::remainder(yaw_deg - halfway_deg, 360.0)) < 1e-11);
    CHECK(std::abs(got_rate_deg - rate_deg) < 1e-11);
  };
  check(170, -170, 180, 20);
  check(-170, 170, 180, -20);
  check(350, 10, 0, 20);
  check(10, 350, 0, -20);
  check(0, 179, 89.5, 179);
  check(0, 181, -89.5, -179);
  check(0, 360, 0, 0);
  check(720 + 5, 15, 10, 10);
  check(-1000, -1000 + 90, -955, 90);
  // Half a turn has two shortest arcs; the convention says which: to the left.
  check(0, 180, 90, 180);
  check(180, 0, 270, 180);
  check(-90, 90, 0, 180);
}

TEST_CASE("pitch and roll take the shortest arc too") {
  const WaypointMotion motion{{{0.0, pose_deg(Vec3(0), 0, 350, -175)}, {1.0, pose_deg(Vec3(0), 0, 10, 175)}}};
  CHECK(rotation_gap(placement_at(motion, 0.5).pose, pose_deg(Vec3(0), 0, 0, 180)) < 1e-14);
}

TEST_CASE("velocity is the finite difference of position, for every point of the body, with all three angles turning") {
  RandomStream random(41);
  const auto coordinate = [&](double size) { return 2.0 * size * (random.uniform() - 0.5); };
  for (int repeat = 0; repeat < 300; ++repeat) {
    WaypointMotion motion;
    for (int point = 0; point < 4; ++point) {
      const double x = coordinate(20), y = coordinate(20), z = coordinate(5);
      const double yaw = coordinate(400), pitch = coordinate(60), roll = coordinate(60);
      motion.waypoints.push_back({2.0 * point, pose_deg(Vec3(x, y, z), yaw, pitch, roll)});
    }
    const double x = coordinate(3), y = coordinate(1), z = coordinate(2);
    const Vec3 local_m(x, y, z);
    const double time_s = 0.1 + 1.8 * random.uniform() + 2.0 * static_cast<double>(random.next() % 3);
    const auto point_at = [&](double instant_s) {
      const Pose pose = placement_at(motion, instant_s).pose;
      return pose.position_m + rotation_matrix(pose) * local_m;
    };
    constexpr double step_s = 1e-5;
    const Vec3 difference = (point_at(time_s + step_s) - point_at(time_s - step_s)) / (2 * step_s);
    const Placement now = placement_at(motion, time_s);
    // Central difference: step²/6·ω³·r = 1e-10·1.6³·4/6, and coordinates of 20 m rounded at 4e-15 over 2e-5 s.
    CHECK(glm::distance(velocity_at(now.velocity, now.pose.position_m, point_at(time_s)), difference) < 5e-9);
  }
}

TEST_CASE("motions with numbers that are none, without waypoints, or with times that stand still are refused") {
  const auto refused = [](const Motion& motion, const char* what) {
    try {
      validate(motion);
      FAIL("accepted");
    } catch (const std::invalid_argument& error) {
      CHECK(std::string(error.what()).find(what) != std::string::npos);
    }
  };
  CHECK_NOTHROW(validate(LinearMotion{}));
  CHECK_NOTHROW(validate(drive()));
  refused(WaypointMotion{}, "waypoint");
  for (int part = 0; part < 8; ++part) {
    LinearMotion motion;
    double* const numbers[] = {&motion.pose.position_m.x, &motion.pose.position_m.z, &motion.pose.yaw_rad,
                               &motion.pose.pitch_rad,    &motion.pose.roll_rad,     &motion.velocity_mps.y,
                               &motion.velocity_mps.z,    &motion.reference_time_s};
    *numbers[part] = part % 2 == 0 ? not_a_number : std::numeric_limits<double>::infinity();
    refused(motion, "finite");
  }
  WaypointMotion motion = drive();
  motion.waypoints[2].time_s = 3.0;
  refused(motion, "waypoint 2");
  motion.waypoints[2].time_s = 2.0;
  refused(motion, "waypoint 2");
  motion.waypoints[2].time_s = not_a_number;
  refused(motion, "waypoint 2");
  motion = drive();
  motion.waypoints[3].pose.roll_rad = not_a_number;
  refused(motion, "waypoint 3");
}

}  // namespace test_motion
