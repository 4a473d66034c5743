/// The image method against closed forms and against the law of reflection itself.
#include "dcem/paths/solve/image_method.hpp"

#include <doctest/doctest.h>

#include <vector>

#include "tests/paths/small_scenes.hpp"

namespace test_image_method {

using namespace dcem;
using namespace dcem::test;

namespace {

/// Images and points for mirrors counted from the receiver; nothing where the method says that there are none.
struct Solved {
  std::vector<Vec3> images_m, points_m;
  bool valid = false;
};

Solved solve(const Vec3& transmitter_m, const Vec3& receiver_m, const std::vector<Plane>& planes) {
  Solved solved;
  solved.images_m = {receiver_m};
  for (const Plane& plane : planes) append_image(solved.images_m, plane);
  const auto plane_of = [&](std::size_t index) -> const Plane& { return planes[index]; };
  solved.valid = reflection_points(transmitter_m, solved.images_m, planes.size(), plane_of, solved.points_m);
  return solved;
}

}  // namespace

TEST_CASE("one mirror: the point divides the ground track in the ratio of the heights") {
  Draw draw(1);
  for (int trial = 0; trial < 200; ++trial) {
    const double one_m = draw.magnitude(1e-3, 1e3), other_m = draw.magnitude(1e-3, 1e3), d = draw.magnitude(1, 1e4);
    const Solved solved = solve({0, 3, one_m}, {d, 3, other_m}, {{Vec3(7, 7, 0), Vec3(0, 0, -1)}});
    REQUIRE(solved.valid);
    REQUIRE(solved.points_m.size() == 1);
    CHECK(solved.images_m[1] == Vec3(d, 3, -other_m));
    // A handful of roundings of numbers up to 1e4.
    CHECK(solved.points_m[0].x == doctest::Approx(d * one_m / (one_m + other_m)).epsilon(1e-14).scale(0.0));
    CHECK(solved.points_m[0].y == 3.0);
    CHECK(std::abs(solved.points_m[0].z) < 1e-12);
  }
}

TEST_CASE("two parallel mirrors: unfolded, ten reflections are equally spaced crossings") {
  // Between x = 0 and x = a, T at x = 0.3, R at x = 0.6. The path to the k-th image crosses the planes x = a, 2a, … of
  // the unfolded space; y grows in proportion to the unfolded x.
  const double a = 1.0, y = 40.0;
  const Plane low{Vec3(0.0), Vec3(1, 0, 0)}, high{Vec3(a, 0, 0), Vec3(1, 0, 0)};
  for (std::size_t order = 1; order <= 10; ++order) {
    std::vector<Plane> from_transmitter;
    for (std::size_t k = 0; k < order; ++k) from_transmitter.push_back(k % 2 == 0 ? high : low);
    const std::vector<Plane> planes(from_transmitter.rbegin(), from_transmitter.rend());
    const Solved solved = solve({0.3, 0, 0}, {0.6, y, 0}, planes);
    REQUIRE(solved.valid);
    const double unfolded_x =
        order % 2 == 0 ? static_cast<double>(order) * a + 0.6 : static_cast<double>(order + 1) * a - 0.6;
    for (std::size_t k = 0; k < order; ++k) {
      const double crossed_x = static_cast<double>(k + 1) * a;
      CHECK(solved.points_m[k].x == doctest::Approx(k % 2 == 0 ? a : 0.0).epsilon(1e-13));
      CHECK(solved.points_m[k].y == doctest::Approx(y * (crossed_x - 0.3) / (unfolded_x - 0.3)).epsilon(1e-13));
    }
  }
}

TEST_CASE("random mirrors: points obey the law of reflection, and the path is as long as the way to the last image") {
  Draw draw(2);
  int valid = 0;
  for (int trial = 0; trial < 20'000; ++trial) {
    std::vector<Plane> planes;
    for (std::size_t k = 1 + draw.below(4); k > 0; --k) {
      planes.push_back({draw.inside(Vec3(-50), Vec3(50)), draw.direction()});
    }
    const Vec3 transmitter_m = draw.inside(Vec3(-50), Vec3(50)), receiver_m = draw.inside(Vec3(-50), Vec3(50));
    const Solved solved = solve(transmitter_m, receiver_m, planes);
    if (!solved.valid) continue;
    ++valid;
    std::vector<Vec3> way_m{transmitter_m};
    way_m.insert(way_m.end(), solved.points_m.begin(), solved.points_m.end());
    way_m.push_back(receiver_m);
    double length_m = 0.0, shortest_m = 1e9;
    for (std::size_t leg = 1; leg < way_m.size(); ++leg) {
      length_m += glm::distance(way_m[leg - 1], way_m[leg]);
      shortest_m = std::min(shortest_m, glm::distance(way_m[leg - 1], way_m[leg]));
    }
    // Some hundred roundings of numbers up to a few kilometres, 2e-13 m each.
    CHECK(std::abs(length_m - glm::distance(transmitter_m, solved.images_m.back())) < 1e-10);
    if (shortest_m < 1e-3) continue;
    for (std::size_t k = 0; k < planes.size(); ++k) {
      const Plane& plane = planes[planes.size() - 1 - k];
      const Vec3 in = glm::normalize(way_m[k + 1] - way_m[k]), out = glm::normalize(way_m[k + 2] - way_m[k + 1]);
      CHECK(std::abs(signed_distance_m(plane, way_m[k + 1])) < 1e-10);
      const Vec3 change = out - in;  // along the normal, twice the normal component
      // The same roundings over a leg of at least 1 mm.
      CHECK(glm::length(change + 2.0 * glm::dot(in, plane.normal) * plane.normal) < 1e-7);
      // Both legs are on one side: the points before and behind have distances of one sign.
      CHECK(signed_distance_m(plane, way_m[k]) * signed_distance_m(plane, way_m[k + 2]) > 0.0);
    }
  }
  CHECK(valid > 2000);
}

TEST_CASE("no reflection between two sides of a mirror, in its plane, or in the wrong order of a corner") {
  const Plane floor{Vec3(0.0), Vec3(0, 0, 1)}, wall{Vec3(0.0), Vec3(1, 0, 0)};
  CHECK(solve({0, 0, 1}, {5, 0, 1}, {floor}).valid);
  CHECK_FALSE(solve({0, 0, 1}, {5, 0, -1}, {floor}).valid);
  CHECK_FALSE(solve({0, 0, 0}, {5, 0, 1}, {floor}).valid);
  CHECK_FALSE(solve({0, 0, 1}, {5, 0, 0}, {floor}).valid);
  CHECK_FALSE(solve({0, 0, 1}, {5, 0, 9e-10}, {floor}).valid);  // nearer than the guard is in the plane
  CHECK(solve({0, 0, 1}, {5, 0, 2e-9}, {floor}).valid);
  // A right-angled corner: both orders have one image, one order is a path. Mirrors count from the receiver.
  CHECK(solve({5, 0, 1}, {1, 0, 2}, {wall, floor}).valid);
  CHECK_FALSE(solve({5, 0, 1}, {1, 0, 2}, {floor, wall}).valid);
}

TEST_CASE("the direct path has no points") {
  const Solved solved = solve({0, 0, 1}, {5, 0, 1}, {});
  CHECK(solved.valid);
  CHECK(solved.points_m.empty());
}

}  // namespace test_image_method
