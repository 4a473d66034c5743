/// The channel over a band, against a sum in extended precision and against the impulses.
#include "dcem/channel/frequency_response.hpp"

#include <doctest/doctest.h>

#include <complex>
#include <limits>
#include <vector>

#include "tests/channel/channel_draws.hpp"

namespace test_frequency_response {

using namespace dcem;
using namespace dcem::test;

namespace {

using LongComplex = std::complex<long double>;

/// Σ h exp(−j2πντ) over (h, τ), in extended precision.
Complex transformed(const std::vector<ImpulseTap>& taps, double offset_hz) {
  LongComplex sum;
  for (const ImpulseTap& tap : taps) {
    const long double cycles = static_cast<long double>(offset_hz) * static_cast<long double>(tap.delay_s);
    const long double angle = -2.0L * std::numbers::pi_v<long double> * (cycles - std::round(cycles));
    sum += LongComplex(tap.amplitude) * LongComplex(std::cos(angle), std::sin(angle));
  }
  return Complex(sum);
}

double sum_of_lengths(const std::vector<PathContribution>& paths) {
  double sum = 0.0;
  for (const PathContribution& path : paths) sum += std::abs(path.amplitude);
  return sum;
}

PathContribution path_at(double delay_s, const Complex& amplitude) {
  PathContribution path;
  path.delay_s = delay_s;
  path.amplitude = path.ports(0, 0) = amplitude;
  return path;
}

}  // namespace

TEST_CASE("the frequencies are the middles of equal parts of the band") {
  const FrequencyGrid four{30e9, 400e6, 4};
  CHECK(four.offset_hz(0) == -150e6);
  CHECK(four.offset_hz(1) == -50e6);
  CHECK(four.offset_hz(3) == 150e6);
  CHECK(four.frequency_hz(2) == 30.05e9);
  const FrequencyGrid five{30e9, 400e6, 5};
  CHECK(five.frequency_hz(2) == 30e9);
  CHECK(five.offset_hz(0) == -160e6);
  const FrequencyGrid one{28e9, 100e6, 1};
  CHECK(one.frequency_hz(0) == 28e9);
  for (const std::size_t points : {2u, 7u, 1000u, 1001u}) {
    const FrequencyGrid grid{30e9, 123456789.0, points};
    int uneven = 0;
    for (std::size_t k = 0; k < points; ++k) uneven += grid.offset_hz(k) != -grid.offset_hz(points - 1 - k);
    CHECK(uneven == 0);
  }
}

TEST_CASE("at the centre the response is the sum of the amplitudes, and without paths it is zero") {
  Draw draw(31);
  const auto paths = drawn_paths(draw, 20, 1e-6, 1e-6);
  Complex sum;
  for (const PathContribution& path : paths) sum += path.amplitude;
  CHECK(frequency_response(paths, {30e9, 100e6, 1}).at(0) == sum);
  CHECK(frequency_response(paths, {30e9, 100e6, 11}).at(5) == sum);
  CHECK(frequency_response({}, {30e9, 100e6, 3}) == std::vector<Complex>(3));
  CHECK(port_frequency_response({}, {30e9, 100e6, 3}) == std::vector<ComplexMatrix2>(3));
}

TEST_CASE("two equal paths: zeros where their delays differ by half a period") {
  // |H|² = 2·|h|²·(1 + cos 2πνd) with d = 10 ns: zeros at ±50 MHz, twice the amplitude at ±100 MHz.
  const std::vector<PathContribution> paths{path_at(300e-9, 1e-5), path_at(310e-9, 1e-5)};
  const auto response = frequency_response(paths, {30e9, 250e6, 5});
  CHECK(std::abs(response[0]) == doctest::Approx(2e-5).epsilon(1e-12).scale(0.0));
  CHECK(std::abs(response[1]) <= 1e-17);  // the delays are known to 5e-23 s
  CHECK(std::abs(response[2]) == doctest::Approx(2e-5).epsilon(1e-12).scale(0.0));
  CHECK(std::abs(response[3]) <= 1e-17);
}

TEST_CASE("the response is the Fourier transform of the impulse response, to the last digits after 40 000 cycles") {
  Draw draw(32);
  for (const double first_s : {0.0, 1e-6, 80e-6}) {
    auto paths = drawn_paths(draw, 30, first_s, 2e-6);
    // Delays of at most 43 bits: their products with the offsets fit into the extended format, not into a double.
    for (PathContribution& path : paths) path.delay_s = std::ldexp(std::round(std::ldexp(path.delay_s, 56)), -56);
    const auto taps = impulse_response(paths);
    const FrequencyGrid grid{30e9, 1.024e9, 128};
    const auto response = frequency_response(paths, grid);
    REQUIRE(response.size() == 128);
    double worst = 0.0;
    for (std::size_t k = 0; k < 128; ++k) {
      const double offset_hz = (static_cast<double>(k) - 63.5) * 8e6;  // whole megahertz: no rounding
      REQUIRE(grid.offset_hz(k) == offset_hz);
      worst = std::max(worst, std::abs(response[k] - transformed(taps, offset_hz)));
    }
    // Each phasor is off by the rounding of an angle below π and of its cosine, whatever the number of cycles.
    CHECK(worst <= 1e-15 * sum_of_lengths(paths));
  }
}

TEST_CASE("a common delay turns the response and changes no power") {
  Draw draw(33);
  auto paths = drawn_paths(draw, 12, 0.0, 1e-6);
  const FrequencyGrid grid{30e9, 64e6, 64};
  const auto before = frequency_response(paths, grid);
  for (PathContribution& path : paths) path.delay_s += 0x1.0p-15;
  const auto after = frequency_response(paths, grid);
  for (std::size_t k = 0; k < grid.points; ++k) {
    const Complex turn = unit_phasor(-2.0 * pi * std::fmod(grid.offset_hz(k) * 0x1.0p-15, 1.0));
    // A delay of 3e-5 s is rounded to 3e-21 s: 7e-13 rad at 32 MHz.
    CHECK(std::abs(after[k] - turn * before[k]) <= 1e-12 * sum_of_lengths(paths));
  }
}

TEST_CASE("the impulse response lists the paths by delay") {
  const std::vector<PathContribution> paths{path_at(3e-8, Complex(1, 2)), path_at(1e-8, Complex(3, 4)),
                                            path_at(3e-8, Complex(5, 6))};
  const auto taps = impulse_response(paths);
  REQUIRE(taps.size() == 3);
  CHECK(taps[0].delay_s == 1e-8);
  CHECK(taps[0].amplitude == Complex(3, 4));
  CHECK(taps[1].amplitude == Complex(1, 2));
  CHECK(taps[2].amplitude == Complex(5, 6));
  CHECK(impulse_response({}).empty());
}

TEST_CASE("dual ports: each entry of the matrix is the response of that pair of ports") {
  Draw draw(34);
  const auto dual = drawn_dual_paths(draw, 9, 1e-6, 1e-6);
  const FrequencyGrid grid{28e9, 200e6, 21};
  const auto matrices = port_frequency_response(dual, grid);
  for (std::size_t out = 0; out < 2; ++out) {
    for (std::size_t in = 0; in < 2; ++in) {
      std::vector<PathContribution> single;
      for (const PathContribution& path : dual) single.push_back(path_at(path.delay_s, path.ports(out, in)));
      const auto response = frequency_response(single, grid);
      for (std::size_t k = 0; k < grid.points; ++k) CHECK(matrices[k](out, in) == response[k]);
    }
  }
  const auto plain = drawn_paths(draw, 9, 1e-6, 1e-6);
  const auto plain_matrices = port_frequency_response(plain, grid);
  const auto plain_response = frequency_response(plain, grid);
  for (std::size_t k = 0; k < grid.points; ++k) {
    CHECK(plain_matrices[k] == diagonal_matrix(plain_response[k], 0.0));
  }
}

TEST_CASE("a link with dual ports has no single response, and a grid needs a point and a bandwidth") {
  Draw draw(35);
  const auto dual = drawn_dual_paths(draw, 2, 1e-6, 1e-6);
  CHECK_THROWS_AS(frequency_response(dual, {30e9, 1e6, 4}), std::invalid_argument);
  CHECK_THROWS_AS(impulse_response(dual), std::invalid_argument);
  const double infinity = std::numeric_limits<double>::infinity();
  for (const FrequencyGrid& grid : {FrequencyGrid{30e9, 1e6, 0}, FrequencyGrid{30e9, -1.0, 4},
                                    FrequencyGrid{30e9, infinity, 4}, FrequencyGrid{30e9, std::nan(""), 4}}) {
    CHECK_THROWS_AS(frequency_response({}, grid), std::invalid_argument);
    CHECK_THROWS_AS(port_frequency_response(dual, grid), std::invalid_argument);
  }
}

}  // namespace test_frequency_response
