/// Corners of mirrors send a wave back where it came from.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <vector>

#include "tests/support/law_scenes.hpp"

namespace test_corner_reflectors {

using namespace dcem;
using namespace dcem::test;

namespace {

/// The planes x = 0, y = 0 and, for a trihedral, z = 0, as quarters of a plane; the open side is all coordinates > 0.
Patches corner(int planes, const std::string& material) {
  const Patches box = box_faces(Vec3(0.0, 0.0, planes == 3 ? 0.0 : -30.0), Vec3(30.0), material);
  Patches result{box[0], box[2]};
  if (planes == 3) result.push_back(box[4]);
  return result;
}

/// λ/(4πL)·e^{−jkL}, in long double.
std::complex<double> free_space_field(const Vec3& from_m, const Vec3& to_m) {
  using Long = long double;
  const glm::vec<3, Long, glm::defaultp> difference =
      glm::vec<3, Long, glm::defaultp>(to_m) - glm::vec<3, Long, glm::defaultp>(from_m);
  const Long length =
      std::sqrt(difference.x * difference.x + difference.y * difference.y + difference.z * difference.z);
  const Long wavelength = 299'792'458.0L / static_cast<Long>(law_frequency_hz);
  const Long phase = -2.0L * 3.14159265358979323846264L * std::fmod(length / wavelength, 1.0L);
  return {static_cast<double>(wavelength / (12.566370614359172954L * length) * std::cos(phase)),
          static_cast<double>(wavelength / (12.566370614359172954L * length) * std::sin(phase))};
}

/// Points where the straight line from p to −q (in the mirrored coordinates) meets the coordinate planes, folded back.
std::vector<Vec3> retro_points(const Vec3& p, const Vec3& q, int planes) {
  std::vector<std::pair<double, int>> shares;
  for (int axis = 0; axis < planes; ++axis) shares.emplace_back(p[axis] / (p[axis] + q[axis]), axis);
  std::sort(shares.begin(), shares.end());
  Vec3 image = q;
  for (int axis = 0; axis < planes; ++axis) image[axis] = -q[axis];
  std::vector<Vec3> points;
  for (const auto& [share, axis] : shares) {
    Vec3 point = p + share * (image - p);
    for (int other = 0; other < planes; ++other) point[other] = std::abs(point[other]);
    points.push_back(point);
  }
  return points;
}

const PathContribution& the_only(const std::vector<PathContribution>& paths, int order) {
  const auto is = [&](const PathContribution& path) { return reflections(path) == order; };
  REQUIRE(std::count_if(paths.begin(), paths.end(), is) == 1);
  return *std::find_if(paths.begin(), paths.end(), is);
}

void check_transfer(const PathContribution& path, const ComplexMatrix2& expected) {
  for (std::size_t entry = 0; entry < 4; ++entry) {
    const std::complex<double> difference = path.transfer(entry / 2, entry % 2) - expected(entry / 2, entry % 2);
    // 1e-10: k·L is about 1e4 rad and L is good to 1e-15, so the phase is good to 1e-11 rad.
    CHECK(std::abs(difference) < 1e-10 * std::sqrt(norm_squared(expected)));
  }
}

}  // namespace

TEST_CASE("a trihedral corner has 1+3+3+1 paths, and the triple bounce comes back as it left") {
  const Scene scene = scene_through_files(corner(3, "pec"));
  Dice dice(31);
  for (int trial = 0; trial < 20; ++trial) {
    const Vec3 p = dice.inside(Vec3(1.0), Vec3(9.0)), q = p + dice.inside(Vec3(-0.9), Vec3(0.9));
    const auto paths = paths_between(scene, p, q, law_settings(5, 0));
    const std::array<int, 6> expected{1, 3, 3, 1, 0, 0};
    for (int order = 0; order <= 5; ++order) {
      CHECK(std::count_if(paths.begin(), paths.end(), [&](const auto& path) { return reflections(path) == order; }) ==
            expected[static_cast<std::size_t>(order)]);
    }
    const PathContribution& retro = the_only(paths, 3);
    CHECK(retro.path.length_m == doctest::Approx(glm::length(p + q)).epsilon(1e-14));
    const std::vector<Vec3> points = retro_points(p, q, 3);
    // 1e-12 m: rounding of coordinates of some 10 m, magnified a little by the folding.
    for (std::size_t index = 0; index < 3; ++index) {
      CHECK(glm::distance(retro.path.interactions[index].point_m, points[index]) < 1e-12);
    }
    // Three perfect conductors: (2xxᵀ − 1)(2yyᵀ − 1)(2zzᵀ − 1) = 1, and the wave leaves against where it came from.
    const std::complex<double> field = free_space_field(p, -q);
    check_transfer(retro, diagonal_matrix(field, field));
    CHECK(retro.departure.azimuth_rad == doctest::Approx(retro.arrival.azimuth_rad).epsilon(1e-12));
    CHECK(retro.departure.zenith_rad == doctest::Approx(retro.arrival.zenith_rad).epsilon(1e-12));
  }
}

TEST_CASE("a right-angled dihedral has 1+2+1 paths, and the double bounce is the mirror image in its edge") {
  const Scene scene = scene_through_files(corner(2, "pec"));
  Dice dice(32);
  for (int trial = 0; trial < 20; ++trial) {
    const Vec3 p = dice.inside(Vec3(1.0), Vec3(9.0)), q = dice.inside(Vec3(1.0), Vec3(9.0));
    const auto paths = paths_between(scene, p, q, law_settings(5, 0));
    CHECK(paths.size() == 4);
    const PathContribution& retro = the_only(paths, 2);
    CHECK(retro.path.length_m == doctest::Approx(std::hypot(p.x + q.x, p.y + q.y, p.z - q.z)).epsilon(1e-14));
    const std::vector<Vec3> points = retro_points(p, q, 2);
    for (std::size_t index = 0; index < 2; ++index) {
      CHECK(glm::distance(retro.path.interactions[index].point_m, points[index]) < 1e-12);  // rounding, as above
    }
    // (2xxᵀ − 1)(2yyᵀ − 1) = diag(−1, −1, 1). Seen from outside, departure and arrival have the same azimuth, and
    // zeniths θ and π − θ; θ̂ turns to −(θ̂'s horizontal part) with the same vertical one: V comes back as V, H against
    // φ̂.
    const std::complex<double> field = free_space_field(p, Vec3(-q.x, -q.y, q.z));
    check_transfer(retro, diagonal_matrix(field, -field));
  }
}

TEST_CASE("mirrors that meet at 180°/n show 2n − 1 images") {
  for (const int n : {2, 3, 4, 5}) {
    CAPTURE(n);
    const double angle_rad = pi / n;
    const Patches wedge{{{Vec3(0, 0, -50), Vec3(60, 0, -50), Vec3(60, 0, 50), Vec3(0, 0, 50)}, "pec"},
                        {{Vec3(0, 0, -50), 60.0 * Vec3(std::cos(angle_rad), std::sin(angle_rad), 0) - Vec3(0, 0, 50),
                          60.0 * Vec3(std::cos(angle_rad), std::sin(angle_rad), 0) + Vec3(0, 0, 50), Vec3(0, 0, 50)},
                         "pec"}};
    const auto at = [&](double radius, double share, double z) {
      return Vec3(radius * std::cos(share * angle_rad), radius * std::sin(share * angle_rad), z);
    };
    const Vec3 p = at(5.0, 0.37, 0.2), q = at(6.1, 0.58, 0.9);
    const auto paths = paths_between(scene_through_files(wedge), p, q, law_settings(8, 0));
    std::vector<double> found, expected;
    for (const PathContribution& path : paths) found.push_back(path.path.length_m);
    // The images of q stand on a circle, at the azimuths 2mα ± φ.
    for (int m = 0; m < n; ++m) {
      for (const double share : {0.58, -0.58}) expected.push_back(glm::distance(p, at(6.1, 2.0 * m + share, 0.9)));
    }
    std::sort(expected.begin(), expected.end());
    REQUIRE(found.size() == expected.size());
    // 1e-13: rounding of up to 9 legs.
    for (std::size_t i = 0; i < found.size(); ++i) CHECK(found[i] == doctest::Approx(expected[i]).epsilon(1e-13));
  }
}

}  // namespace test_corner_reflectors
