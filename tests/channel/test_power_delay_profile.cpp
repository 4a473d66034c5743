/// Power over delay: bins, and what is added within one.
#include "dcem/channel/power_delay_profile.hpp"

#include <doctest/doctest.h>

#include <vector>

#include "tests/paths/small_scenes.hpp"

namespace test_power_delay_profile {

using namespace dcem;
using namespace dcem::test;

namespace {

PathContribution tap(double delay_s, const Complex& amplitude, bool has_amplitude = true) {
  PathContribution c;
  c.delay_s = delay_s;
  c.amplitude = has_amplitude ? amplitude : Complex{};
  c.has_amplitude = has_amplitude;
  c.power_ratio = std::norm(amplitude);
  return c;
}

}  // namespace

TEST_CASE("each path falls into the bin that holds its delay, and empty bins are left out") {
  const std::vector<PathContribution> paths{tap(0.5e-9, 1.0), tap(1.25e-9, 2.0), tap(1.75e-9, 3.0), tap(100.5e-9, 4.0)};
  const auto taps = power_delay_profile(paths, 1e-9, PdpMode::incoherent);
  REQUIRE(taps.size() == 3);
  CHECK(taps[0].delay_s == 0.0);
  CHECK(taps[0].power_ratio == 1.0);
  CHECK(taps[1].delay_s == 1e-9);
  CHECK(taps[1].power_ratio == 13.0);
  CHECK(taps[2].delay_s == doctest::Approx(100e-9).epsilon(1e-15).scale(0.0));
  CHECK(taps[2].power_ratio == 16.0);
  CHECK(power_delay_profile({}, 1e-9, PdpMode::coherent).empty());
}

TEST_CASE("a delay on the border of two bins belongs to the later one") {
  for (const double bin_s : {1.0, 0.5, 0.125}) {  // powers of two: no rounding
    const auto taps = power_delay_profile(std::vector{tap(3 * bin_s, 1.0)}, bin_s, PdpMode::incoherent);
    CHECK(taps.at(0).delay_s == 3 * bin_s);
  }
}

TEST_CASE("a delay that is a multiple of the bin as a program computes it is in its own bin") {
  int misplaced = 0;
  for (int n = 1; n <= 2000; ++n) {
    const double delay_s = n * 1e-9;
    misplaced +=
        power_delay_profile(std::vector{tap(delay_s, 1.0)}, 1e-9, PdpMode::incoherent).at(0).delay_s != delay_s;
  }
  CHECK(misplaced == 0);
}

TEST_CASE("coherent bins add fields, incoherent bins add powers") {
  const std::vector<PathContribution> paths{tap(0.1, Complex(1, 0)), tap(0.2, Complex(-1, 0)), tap(0.3, Complex(0, 1)),
                                            tap(1.1, Complex(3, 4)), tap(1.2, Complex(3, 4))};
  const auto coherent = power_delay_profile(paths, 1.0, PdpMode::coherent);
  const auto incoherent = power_delay_profile(paths, 1.0, PdpMode::incoherent);
  CHECK(coherent[0].power_ratio == 1.0);
  CHECK(incoherent[0].power_ratio == 3.0);
  CHECK(coherent[1].power_ratio == 100.0);
  CHECK(incoherent[1].power_ratio == 50.0);
}

TEST_CASE("dual-polarized links have no field to add: their powers add in both modes") {
  const std::vector<PathContribution> paths{tap(0.1, Complex(1, 0), false), tap(0.2, Complex(-1, 0), false)};
  CHECK(power_delay_profile(paths, 1.0, PdpMode::coherent)[0].power_ratio == 2.0);
  CHECK(power_delay_profile(paths, 1.0, PdpMode::incoherent)[0].power_ratio == 2.0);
}

TEST_CASE("incoherent bins hold all the power there is, whatever their width; fine coherent bins do too") {
  Draw draw(1);
  std::vector<PathContribution> paths;
  double total = 0.0;
  for (int path = 0; path < 200; ++path) {
    // One delay per picosecond and more: each has a bin of 0.1 ps for itself.
    paths.push_back(tap(1e-12 * (path + draw.between(0.0, 0.5)), Complex(draw.between(-1, 1), draw.between(-1, 1))));
    total += paths.back().power_ratio;
  }
  for (const double bin_s : {1e-13, 1e-12, 7e-12, 1e-6}) {
    double sum = 0.0, last_s = -1.0;
    for (const PdpTap& one : power_delay_profile(paths, bin_s, PdpMode::incoherent)) {
      sum += one.power_ratio;
      CHECK(one.delay_s > last_s);  // by delay
      last_s = one.delay_s;
    }
    CHECK(sum == doctest::Approx(total).epsilon(1e-13));
  }
  double sum = 0.0;
  for (const PdpTap& one : power_delay_profile(paths, 1e-13, PdpMode::coherent)) sum += one.power_ratio;
  CHECK(sum == doctest::Approx(total).epsilon(1e-13));
}

}  // namespace test_power_delay_profile
