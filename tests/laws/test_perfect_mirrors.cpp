/// At perfect mirrors the field needs no polarizations: E_r = 2(n·E)n − E. The whole transfer matrix of every path of a
/// room of mirrors follows from this alone.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <complex>

#include "tests/laws/independent_tracer.hpp"

namespace test_perfect_mirrors {

using namespace dcem;
using namespace dcem::test;

namespace {

/// θ̂ and φ̂ of a direction (ISO 80000-2).
std::array<LongVec, 2> polarizations(const LongVec& direction) {
  const long double rho = std::hypot(direction.x, direction.y);
  const long double cp = direction.x / rho, sp = direction.y / rho;
  return {LongVec(direction.z * cp, direction.z * sp, -rho), LongVec(-sp, cp, 0.0L)};
}

}  // namespace

TEST_CASE("perfect mirrors: the transfer matrix of every path is that of 2(n·E)n − E, row receives, column sends") {
  std::size_t checked = 0;
  double largest_cross = 0.0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    RandomRoom room = random_room(90'000 + seed, 4, 1);
    const Mat3 turn = rotation_about(Vec3(0.2, 0.9, -0.4), 0.1 * static_cast<double>(seed));
    const auto map = [&](const Vec3& p) { return turn * p; };
    room.patches = mapped(room.patches, map);
    for (Patch& patch : room.patches) patch.material = "pec";
    const Vec3 from_m = map(room.transmitter_m), to_m = map(room.receiver_m);
    const Scene scene = scene_through_files(room.patches);
    const auto patch_of = patch_of_facet(scene, room.patches);
    const auto patches = long_patches(room.patches);
    for (const PathContribution& found : paths_between(scene, from_m, to_m, law_settings(4, 0))) {
      const OwnPath path = in_patches(found.path, patch_of);
      const LongVec first = path.points.empty() ? LongVec(to_m) : path.points.front();
      const LongVec last = path.points.empty() ? LongVec(from_m) : path.points.back();
      const auto sent = polarizations(glm::normalize(first - LongVec(from_m)));
      const auto received = polarizations(glm::normalize(last - LongVec(to_m)));
      const long double wavelength = 299'792'458.0L / static_cast<long double>(law_frequency_hz);
      const long double phase = -2.0L * 3.14159265358979323846L * std::fmod(path.length / wavelength, 1.0L);
      const long double spreading = wavelength / (4.0L * 3.14159265358979323846L * path.length);
      for (std::size_t in = 0; in < 2; ++in) {
        LongVec field = sent[in];
        for (const std::size_t mirror : path.patches) {
          const LongVec& n = patches[mirror].normal;
          field = 2.0L * glm::dot(n, field) * n - field;
        }
        for (std::size_t out = 0; out < 2; ++out) {
          const long double size = spreading * glm::dot(field, received[out]);
          const std::complex<double> expected(static_cast<double>(size * std::cos(phase)),
                                              static_cast<double>(size * std::sin(phase)));
          // 1e-10: the phase of a length rounded to 1e-14 m at k = 590 rad/m; field vectors are good to 1e-14.
          CHECK(std::abs(found.transfer(out, in) - expected) < 1e-10 * static_cast<double>(spreading));
        }
      }
      const double cross = std::abs(found.transfer(0, 1) - found.transfer(1, 0));
      largest_cross = std::max(largest_cross, cross / static_cast<double>(spreading));
      ++checked;
    }
  }
  CHECK(checked > 1500);
  // Rows and columns must be told apart by at least some of the paths.
  CHECK(largest_cross > 0.5);
}

}  // namespace test_perfect_mirrors
