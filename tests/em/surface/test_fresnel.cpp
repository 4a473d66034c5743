#include <doctest/doctest.h>

#include <limits>

#include "dcem/em/surface/fresnel.hpp"
#include "tests/reference/em_reference.hpp"

namespace test_fresnel {

using namespace dcem;

namespace {

// A few roundings: a square root, two divisions, three products.
constexpr double rounding = 4e-15;

bool finite(const PolarizedCoefficients& coefficients) {
  return is_finite(coefficients.te) && is_finite(coefficients.tm);
}

}  // namespace

TEST_CASE("half space: continuity of the tangential fields, against 50 digits") {
  double worst = 0.0;
  for (const auto& row : test::em_reference_rows()) {
    const auto got = half_space_reflection(row.permittivity(), row.cos_incidence);
    worst = std::max({worst, test::relative_difference(got.te, row.half_space_te),
                      test::relative_difference(got.tm, row.half_space_tm)});
  }
  // Relative even where the surface is hardly there (η = 1.000001, R = 2.5e-7).
  CHECK(worst <= rounding);
}

TEST_CASE("permittivity: the imaginary part is negative, by hand") {
  // σ/(2π f ε₀) for σ = 1 S/m at 1 GHz: 1/(2π · 8.8541878128e-3) = 17.975103.
  const Complex eta = complex_permittivity(5.0, 1.0, 1e9);
  CHECK(eta.real() == 5.0);
  CHECK(eta.imag() == doctest::Approx(-17.975103).epsilon(1e-7));  // the digits printed above
  CHECK(wavelength_m(299'792'458.0) == 1.0);
  CHECK(wave_number_rad_per_m(299'792'458.0) == doctest::Approx(6.283185307179586).epsilon(1e-15));  // one rounding
}

TEST_CASE("the root decays into the medium on every side of the branch cut") {
  for (const Complex value : {Complex(4, 0), Complex(4, -0.0), Complex(-4, 0), Complex(-4, -0.0), Complex(-4, 1e-20),
                              Complex(3, -4), Complex(3, 4), Complex(0, 0)}) {
    const Complex root = decaying_square_root(value);
    CHECK(root.imag() <= 0.0);
    CHECK(std::abs(root * root - value) <= rounding * 4.0);
  }
  CHECK(decaying_square_root(-4.0).imag() == -2.0);
}

TEST_CASE("Brewster: R_tm vanishes at tan θ = √ε and only there") {
  for (const double permittivity : {1.5, 2.25, 5.24, 81.0}) {
    const double cos_brewster = 1.0 / std::sqrt(1.0 + permittivity);
    const auto reflection = half_space_reflection(permittivity, cos_brewster);
    CHECK(std::abs(reflection.tm) <= rounding);
    // There the reflected and refracted rays are at right angles: R_te = (1 − ε)/(1 + ε).
    CHECK(std::abs(reflection.te - (1.0 - permittivity) / (1.0 + permittivity)) <= rounding);
    // R_tm is positive nearer to the normal and negative nearer to grazing.
    CHECK(half_space_reflection(permittivity, cos_brewster + 0.01).tm.real() > 1e-4);
    CHECK(half_space_reflection(permittivity, cos_brewster - 0.01).tm.real() < -1e-4);
  }
}

TEST_CASE("normal incidence: R_te = −R_tm = (1 − √η)/(1 + √η)") {
  for (const Complex eta : {Complex(4, 0), Complex(5.24, -0.4), Complex(15, -0.6), Complex(1, -1e7)}) {
    const auto reflection = half_space_reflection(eta, 1.0);
    CHECK(std::abs(reflection.te + reflection.tm) <= rounding);
    CHECK(std::abs(reflection.te - (1.0 - std::sqrt(eta)) / (1.0 + std::sqrt(eta))) <= rounding);
  }
  CHECK(std::abs(half_space_reflection(4.0, 1.0).te + 1.0 / 3.0) <= rounding);
}

TEST_CASE("grazing incidence: everything comes back with its sign turned, unless there is no surface") {
  for (const Complex eta : {Complex(1.0 + 1e-15, 0), Complex(5.24, -0.4), Complex(1, -1e-300), Complex(1, -1e9)}) {
    CHECK(std::abs(half_space_reflection(eta, 0.0).te + 1.0) <= rounding);
    CHECK(std::abs(half_space_reflection(eta, 0.0).tm + 1.0) <= rounding);
  }
  for (const double cos_incidence : {0.0, 1e-300, 1e-160, 1e-9, 0.3, 1.0})
    CHECK(half_space_reflection(1.0, cos_incidence) == PolarizedCoefficients{0.0, 0.0});
}

TEST_CASE("conductor: the half space goes over into R_te = −1, R_tm = +1 as 1/√|η|") {
  CHECK(perfect_conductor_reflection() == PolarizedCoefficients{-1.0, 1.0});
  for (const double loss : {1e6, 1e10, 1e14, 1e300}) {
    const auto reflection = half_space_reflection({1.0, -loss}, 0.5);
    // Leontovich: R_te ≈ −1 + 2 cos/√η, R_tm ≈ 1 − 2/(√η cos); at cos = 1/2 both within 4/√|η|.
    CHECK(std::abs(reflection.te + 1.0) <= 4.0 / std::sqrt(loss) + rounding);
    CHECK(std::abs(reflection.tm - 1.0) <= 4.0 / std::sqrt(loss) * 1.01 + rounding);
  }
}

TEST_CASE("a passive half space never returns more than it receives") {
  for (const double permittivity : {1.0, 1.0 + 1e-12, 2.0, 5.24, 81.0})
    for (const double loss : {0.0, 1e-300, 1e-12, 0.01, 1.0, 1e8, 1e300})
      for (int step = 0; step <= 100; ++step) {
        const auto reflection = half_space_reflection({permittivity, -loss}, step / 100.0);
        REQUIRE(finite(reflection));
        REQUIRE(std::abs(reflection.te) <= 1.0 + rounding);
        REQUIRE(std::abs(reflection.tm) <= 1.0 + rounding);
      }
}

TEST_CASE("a cosine beyond its range by rounding counts as its end") {
  const Complex eta(5.24, -0.4);
  CHECK(half_space_reflection(eta, 1.0 + 1e-12) == half_space_reflection(eta, 1.0));
  CHECK(half_space_reflection(eta, -1e-12) == half_space_reflection(eta, 0.0));
}

}  // namespace test_fresnel
