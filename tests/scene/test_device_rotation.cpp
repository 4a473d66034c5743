/// How the antenna of a device is turned: with the object it rides on, or with its own pose.
#include <doctest/doctest.h>

#include "dcem/scene/scene.hpp"

namespace test_device_rotation {

using namespace dcem;

namespace {

/// Rotation by an angle about an axis (Rodrigues), from no Euler angle.
Mat3 about(const Vec3& axis, double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  const auto column = [&](const Vec3& e) {
    return c * e + s * glm::cross(axis, e) + (1.0 - c) * glm::dot(axis, e) * axis;
  };
  return Mat3(column(Vec3(1, 0, 0)), column(Vec3(0, 1, 0)), column(Vec3(0, 0, 1)));
}

double distance(const Mat3& a, const Mat3& b) {
  return glm::distance(a[0], b[0]) + glm::distance(a[1], b[1]) + glm::distance(a[2], b[2]);
}

const Vec3 x_axis(1, 0, 0), y_axis(0, 1, 0), z_axis(0, 0, 1);

/// Yaw about z, then pitch about the turned y, then roll about the turned x.
Mat3 turned(double yaw, double pitch, double roll) {
  return about(z_axis, yaw) * about(y_axis, pitch) * about(x_axis, roll);
}

Scene with_car(const Motion& motion) {
  Scene scene;
  scene.add_material({"metal", PerfectConductor{}});
  scene.add_object("car", make_box(Vec3(4, 2, 1.5), "metal"), motion);
  return scene;
}

}  // namespace

TEST_CASE("a device that stands is turned by its antenna's orientation alone, and not at all without one") {
  Scene scene = with_car(LinearMotion{});
  scene.add_receiver(device_at("plain", Vec3(1, 2, 3)));
  Device sector = device_at("sector", Vec3(1, 2, 3));
  sector.antenna.orientation = {0.5, 0.2, -0.3};
  scene.add_receiver(sector);
  const Frame frame = scene.frame_at(0.0);
  CHECK(scene.device_state(scene.receivers()[0], frame).rotation == Mat3(1.0));
  CHECK(distance(scene.device_state(scene.receivers()[1], frame).rotation, turned(0.5, 0.2, -0.3)) < 1e-15);
}

TEST_CASE("an attached device turns with its object, and its antenna's orientation is in the object's axes") {
  Scene scene = with_car(WaypointMotion{{{0.0, {Vec3(0.0), 0.2, 0.0, 0.0}}, {1.0, {Vec3(0.0), 1.2, 0.4, -0.6}}}});
  Device sector = device_at("sector", Vec3(0.0));
  sector.attachment = Attachment{"car", Vec3(1, 0, 1.6), false};
  sector.antenna.orientation = {pi / 2, 0.1, 0.0};  // to the left of the car, a little down
  scene.add_transmitter(sector);
  const Device& device = scene.transmitters()[0];
  CHECK(distance(scene.device_state(device, scene.frame_at(0.0)).rotation,
                 about(z_axis, 0.2) * turned(pi / 2, 0.1, 0.0)) < 1e-14);
  CHECK(distance(scene.device_state(device, scene.frame_at(0.5)).rotation,
                 turned(0.7, 0.2, -0.3) * turned(pi / 2, 0.1, 0.0)) < 1e-14);
  // The boresight in the world: left of where the car looks.
  const Vec3 boresight = scene.device_state(device, scene.frame_at(0.0)).rotation[0];
  CHECK(glm::distance(boresight, Vec3(-std::sin(0.2) * std::cos(0.1), std::cos(0.2) * std::cos(0.1), -std::sin(0.1))) <
        1e-15);
}

TEST_CASE("a device with a motion of its own turns with its pose") {
  Scene scene = with_car(LinearMotion{});
  Device walker = device_at("walker", Vec3(0.0));
  walker.motion = WaypointMotion{{{0.0, {Vec3(0.0), 0.0, 0.0, 0.0}}, {2.0, {Vec3(3, 0, 0), 1.0, 0.2, 0.0}}}};
  walker.antenna.orientation = {0.0, 0.0, 0.4};
  scene.add_receiver(walker);
  const DeviceState state = scene.device_state(scene.receivers()[0], scene.frame_at(1.0));
  CHECK(distance(state.rotation, turned(0.5, 0.1, 0.0) * turned(0.0, 0.0, 0.4)) < 1e-14);
}

TEST_CASE("an antenna whose values are no numbers is refused with its device") {
  Scene scene = with_car(LinearMotion{});
  Device device = device_at("ue", Vec3(0.0));
  device.antenna.orientation.roll_rad = std::nan("");
  CHECK_THROWS_AS(scene.add_receiver(device), std::invalid_argument);
  device.antenna = {};
  device.antenna.pattern = TabulatedPattern{};
  CHECK_THROWS_AS(scene.add_receiver(device), std::invalid_argument);
  CHECK(scene.receivers().empty());
}

}  // namespace test_device_rotation
