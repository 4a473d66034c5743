#include <doctest/doctest.h>

#include <variant>

#include "dcem/scene/device.hpp"

namespace test_device {

using namespace dcem;

TEST_CASE("a device at a place stands there for all times") {
  const Device device = device_at("bs", Vec3(1, 2, 3), 36.99);
  CHECK(device.id == "bs");
  CHECK(device.power_dbm == 36.99);
  CHECK_FALSE(device.attachment);
  for (const double time_s : {-1e6, 0.0, 1e6}) {
    const Placement placement = placement_at(device.motion, time_s);
    CHECK(placement.pose.position_m == Vec3(1, 2, 3));
    CHECK(placement.velocity.linear_mps == Vec3(0.0));
  }
}

TEST_CASE("a grid runs along x by column and along y by row, and names its points [row,column]") {
  ReceiverGrid grid;
  grid.id = "area";
  grid.origin_m = Vec3(-50, 20, 1.5);
  grid.spacing_m = {2.0, 0.5};
  grid.count = {4, 3};
  CHECK(grid.columns() == 4);
  CHECK(grid.rows() == 3);
  CHECK(grid.size() == 12);
  CHECK(grid_point_m(grid, 0, 0) == Vec3(-50, 20, 1.5));
  CHECK(grid_point_m(grid, 2, 3) == Vec3(-44, 21, 1.5));
  const Device device = grid_receiver(grid, 2, 3);
  CHECK(device.id == "area[2,3]");
  CHECK(placement_at(device.motion, 7.0).pose.position_m == Vec3(-44, 21, 1.5));
}

TEST_CASE("a grid's receivers carry the grid's antenna") {
  ReceiverGrid grid;
  grid.antenna.gain_dbi = 7.5;
  CHECK(grid_receiver(grid, 0, 0).antenna.gain_dbi == 7.5);
}

TEST_CASE("points of a large grid are computed, not summed: the millionth is where it belongs") {
  ReceiverGrid grid;
  grid.spacing_m = {0.1, 0.1};
  CHECK(grid_point_m(grid, 0, 1'000'000).x == 1'000'000 * 0.1);
}

}  // namespace test_device
