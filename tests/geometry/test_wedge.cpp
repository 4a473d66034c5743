#include <doctest/doctest.h>

#include "dcem/geometry/wedge.hpp"

namespace test_wedge {

using namespace dcem;

TEST_CASE("azimuths stay below a full turn, and along the edge there is none") {
  const Wedge wedge;
  CHECK(azimuth_rad(wedge, Vec3(1, 0, 0)) == 0.0);
  CHECK(azimuth_rad(wedge, Vec3(1, -0.0, 0)) == 0.0);
  CHECK(azimuth_rad(wedge, Vec3(1, -1e-300, 0)) == 0.0);
  CHECK(azimuth_rad(wedge, Vec3(1, -1e-9, 5)) == doctest::Approx(2.0 * pi - 1e-9).epsilon(1e-15));
  CHECK(azimuth_rad(wedge, Vec3(-1, 0, 0)) == pi);
  CHECK(azimuth_rad(wedge, Vec3(0, 0, 1)) == 0.0);
  CHECK(edge_direction(wedge) == Vec3(0, 0, 1));
  CHECK_FALSE(in_exterior(wedge, Vec3(1, 0, 0)));
  CHECK(in_exterior(wedge, Vec3(1, -1e-9, 0)));
}

TEST_CASE("the direction runs from start to end, and a wedge without a second face is free") {
  Wedge wedge;
  CHECK(is_free(wedge));
  wedge.facets = {2, 5};
  CHECK_FALSE(is_free(wedge));
  wedge.start_m = Vec3(1, 2, 3);
  wedge.end_m = Vec3(1, 2, 3.5);
  CHECK(edge_length_m(wedge) == 0.5);
  CHECK(wedge.start_m + edge_length_m(wedge) * edge_direction(wedge) == wedge.end_m);
}

}  // namespace test_wedge
