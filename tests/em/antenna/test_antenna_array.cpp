#include "dcem/em/antenna/antenna_array.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "dcem/core/random.hpp"

namespace test_antenna_array {

using namespace dcem;

namespace {

Vec3 random_direction(RandomStream& random) {
  const double z = 2.0 * random.uniform() - 1.0, azimuth = 2.0 * pi * random.uniform();
  return {std::sqrt(1.0 - z * z) * std::cos(azimuth), std::sqrt(1.0 - z * z) * std::sin(azimuth), z};
}

/// |sin(N x)/sin(x)|, the sum of N phasors 2x apart.
double comb(std::size_t count, double x) {
  if (std::abs(std::sin(x)) < 1e-12) return static_cast<double>(count);
  return std::abs(std::sin(static_cast<double>(count) * x) / std::sin(x));
}

}  // namespace

TEST_CASE("elements are numbered row by row from below, columns along y, centred on the antenna") {
  const AntennaArray array{2, 3, 0.5};
  REQUIRE(array.size() == 6);
  const std::vector<Vec3> expected{{0, -0.5, -0.25}, {0, 0, -0.25}, {0, 0.5, -0.25},
                                   {0, -0.5, 0.25},  {0, 0, 0.25},  {0, 0.5, 0.25}};
  Vec3 sum(0.0);
  for (std::size_t element = 0; element < 6; ++element) {
    CHECK(element_offset_wavelengths(array, element) == expected[element]);
    CHECK(element_offset_m(array, element, 0.01) == 0.01 * expected[element]);
    sum += expected[element];
  }
  CHECK(sum == Vec3(0.0));
  CHECK_THROWS_AS(element_offset_wavelengths(array, 6), InvariantError);
}

TEST_CASE("a single element stands at the centre and changes nothing, to the bit") {
  CHECK(AntennaArray{}.is_single());
  CHECK(element_phasor({}, 0, Vec3(0.6, 0, 0.8)) == Complex(1.0, 0.0));
}

TEST_CASE("the phase of an element is that of its distance to a far point, up to k r² sin²/2d") {
  // |p − r| = d·√(1 − 2xc + x²) with x = r/d, c the cosine: d − r·c + d·x²(1 − c²)/2·(1 + x·c + …), and for x < 0.02
  // the bracket is below 1.03. So the plane wave is ahead by at most k·r²·sin²/2d·1.03, and by no less than 0.97 of it.
  constexpr double wavelength_m = 0.0107, wave_number = 2.0 * pi / wavelength_m;
  RandomStream random(3);
  int clear = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const AntennaArray array{1 + random.next() % 8, 1 + random.next() % 8, 0.2 + random.uniform()};
    const Vec3 direction = random_direction(random);
    const double distance_m = 4.0 + 40.0 * random.uniform();
    const std::vector<Complex> phasors = element_phasors(array, direction);
    for (std::size_t element = 0; element < array.size(); ++element) {
      const Vec3 place_m = element_offset_m(array, element, wavelength_m);
      const double exact_m = glm::distance(distance_m * direction, place_m) - distance_m;
      const double difference = std::arg(phasors[element] * unit_phasor(wave_number * exact_m));
      const double along_m = glm::dot(place_m, direction);
      const double bound = wave_number * (glm::dot(place_m, place_m) - along_m * along_m) / (2.0 * distance_m);
      REQUIRE(glm::length(place_m) < 0.02 * distance_m);
      // The difference of two lengths of 44 m is good to 7e-15 m.
      CHECK(difference <= 1.03 * bound + 1e-11);
      CHECK(difference >= 0.97 * bound - 1e-11);
      clear += bound > 1e-3;
    }
  }
  CHECK(clear > 1000);  // most of them are far above the rounding
}

TEST_CASE("a broadside beam is sin(Nx)/sin(x) in rows and columns") {
  RandomStream random(4);
  for (const AntennaArray& array : {AntennaArray{1, 8, 0.5}, AntennaArray{5, 1, 0.7}, AntennaArray{8, 8, 0.5}}) {
    const std::vector<Complex> equal(array.size(), 1.0);
    CHECK(std::abs(array_factor(array, equal, Vec3(1, 0, 0))) ==
          doctest::Approx(static_cast<double>(array.size())).epsilon(1e-14));
    for (int trial = 0; trial < 100; ++trial) {
      const Vec3 d = random_direction(random);
      const double across = pi * array.spacing_wavelengths * d.y, up = pi * array.spacing_wavelengths * d.z;
      const double expected = comb(array.columns, across) * comb(array.rows, up);
      // Up to 64 phasors, each rounded at 1e-15.
      CHECK(std::abs(array_factor(array, equal, d)) == doctest::Approx(expected).epsilon(1e-12));
    }
  }
}

TEST_CASE("8 x 8 elements half a wavelength apart: first zeros at 14.48 degrees, none fed the other way round") {
  const AntennaArray array{8, 8, 0.5};
  const std::vector<Complex> equal(64, 1.0);
  const double zero = std::asin(2.0 / 8.0);  // N·x = π
  CHECK(std::abs(array_factor(array, equal, Vec3(std::cos(zero), std::sin(zero), 0))) < 1e-12);
  CHECK(std::abs(array_factor(array, equal, Vec3(std::cos(zero), 0, -std::sin(zero)))) < 1e-12);
  // Weights of the opposite phase gather the whole array in any direction.
  RandomStream random(5);
  for (int trial = 0; trial < 20; ++trial) {
    const Vec3 d = random_direction(random);
    std::vector<Complex> weights = element_phasors(array, d);
    for (Complex& weight : weights) weight = std::conj(weight);
    CHECK(std::abs(array_factor(array, weights, d) - 64.0) < 1e-12);
  }
  CHECK_THROWS_AS(array_factor(array, std::vector<Complex>(63, 1.0), Vec3(1, 0, 0)), std::invalid_argument);
}

TEST_CASE("the sense of the phase: an element towards the other end is ahead") {
  // Column 1 of two stands a quarter of a wavelength towards +y: towards +y its wave has a quarter of a turn less to
  // go.
  const AntennaArray array{1, 2, 0.5};
  CHECK(std::abs(element_phasor(array, 1, Vec3(0, 1, 0)) - Complex(0, 1)) < 1e-15);
  CHECK(std::abs(element_phasor(array, 1, Vec3(0, -1, 0)) - Complex(0, -1)) < 1e-15);
  CHECK(std::abs(element_phasor(array, 0, Vec3(0, 1, 0)) - Complex(0, -1)) < 1e-15);
}

}  // namespace test_antenna_array
