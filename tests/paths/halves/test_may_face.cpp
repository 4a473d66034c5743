/// A way that leads into an edge's exterior is never said not to; far from the faces what is said is exact.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "dcem/paths/halves/may_face.hpp"
#include "tests/paths/small_scenes.hpp"

namespace test_may_face {

using namespace dcem;
using namespace dcem::test;

TEST_CASE("whether a way faces an edge is what its azimuth says, up to a millionth of a radian from the faces") {
  Draw draw(7);
  std::size_t near_faces = 0, inside = 0, outside = 0;
  for (int trial = 0; trial < 200'000; ++trial) {
    Wedge wedge;
    wedge.exterior_angle_rad = trial % 7 == 0 ? 2.0 * pi : draw.between(pi, 2.0 * pi);
    // A third of them within a hundredth of a radian of a face, some far closer.
    const double face_rad = draw.below(2) == 0 ? 0.0 : wedge.exterior_angle_rad;
    const double azimuth_of_rad =
        trial % 3 == 0 ? face_rad + draw.between(-1.0, 1.0) * draw.magnitude(1e-8, 1e-2) : draw.between(0.0, 2.0 * pi);
    const double length_m = draw.magnitude(1e-3, 1e4);
    const Vec3 away_m =
        length_m * (std::cos(azimuth_of_rad) * wedge.tangent + std::sin(azimuth_of_rad) * wedge.normal) +
        draw.between(-100.0, 100.0) * edge_direction(wedge);
    const double rad = azimuth_rad(wedge, away_m),
                 beyond_rad = std::min(rad - wedge.exterior_angle_rad, 2.0 * pi - rad);
    if (std::abs(beyond_rad - 1e-6) < 1e-9) continue;  // there rounding decides
    const bool expected = beyond_rad <= 1e-6;
    REQUIRE(may_face(wedge, away_m) == expected);
    near_faces += std::abs(beyond_rad) < 0.005 ? 1 : 0;
    (expected ? inside : outside) += 1;
  }
  CHECK(near_faces > 10'000);
  CHECK(inside > 10'000);
  CHECK(outside > 10'000);
}

}  // namespace test_may_face
