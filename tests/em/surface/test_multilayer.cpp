#include <doctest/doctest.h>

#include <array>
#include <limits>
#include <vector>

#include "dcem/em/surface/multilayer.hpp"
#include "tests/reference/em_reference.hpp"

namespace test_multilayer {

using namespace dcem;

namespace {

struct MultilayerRow {
  double real_1, imaginary_1, thickness_1, real_2, imaginary_2, thickness_2, real_3, imaginary_3, thickness_3;
  double cos_incidence;
  Complex te, tm, insertion_te, insertion_tm;

  std::array<Layer, 3> layers() const {
    return {Layer{{real_1, imaginary_1}, thickness_1}, Layer{{real_2, imaginary_2}, thickness_2},
            Layer{{real_3, imaginary_3}, thickness_3}};
  }
};

// tests/reference/utd_reference.py: ABCD matrices in up to 1000 digits.
const std::vector<MultilayerRow> rows{
#include "tests/reference/utd_multilayer.inc"
};

double worst_difference(const SurfaceResponse& a, const SurfaceResponse& b) {
  return std::max({test::relative_difference(a.reflection.te, b.reflection.te),
                   test::relative_difference(a.reflection.tm, b.reflection.tm),
                   test::relative_difference(a.transmission.te, b.transmission.te),
                   test::relative_difference(a.transmission.tm, b.transmission.tm)});
}

bool finite(const SurfaceResponse& response) {
  return is_finite(response.reflection.te) && is_finite(response.reflection.tm) &&
         is_finite(response.transmission.te) && is_finite(response.transmission.tm);
}

double power_te(const SurfaceResponse& response) {
  return std::norm(response.reflection.te) + std::norm(response.transmission.te);
}
double power_tm(const SurfaceResponse& response) {
  return std::norm(response.reflection.tm) + std::norm(response.transmission.tm);
}

}  // namespace

TEST_CASE("multilayer: three layers against the chain matrix in many digits") {
  REQUIRE(rows.size() == 42);
  for (const MultilayerRow& row : rows) {
    CAPTURE(row.real_1);
    CAPTURE(row.cos_incidence);
    const auto layers = row.layers();
    const SurfaceResponse got = multilayer_response(layers, row.cos_incidence);
    const SurfaceResponse expected{{row.te, row.tm}, {row.insertion_te, row.insertion_tm}};
    // Phases of up to 2000 rad have a rounding of 2e-13 of their own.
    CHECK(worst_difference(got, expected) <= 1e-12);
  }
}

TEST_CASE("multilayer: one layer is the slab, and so are its pieces") {
  for (const auto& row : test::em_reference_rows()) {
    CAPTURE(row.relative_permittivity);
    CAPTURE(row.thickness_m);
    CAPTURE(row.cos_incidence);
    const SurfaceResponse slab = slab_response(row.permittivity(), row.thickness_rad(), row.cos_incidence);
    const Layer whole{row.permittivity(), row.thickness_rad()};
    CHECK(worst_difference(multilayer_response({&whole, 1}, row.cos_incidence), slab) <= 1e-12);
    // Pieces of a quarter, a quarter and a half have exact thicknesses.
    const std::array<Layer, 3> pieces{Layer{row.permittivity(), 0.25 * row.thickness_rad()},
                                      Layer{row.permittivity(), 0.25 * row.thickness_rad()},
                                      Layer{row.permittivity(), 0.5 * row.thickness_rad()}};
    CHECK(worst_difference(multilayer_response(pieces, row.cos_incidence), slab) <= 2e-12);
  }
}

TEST_CASE("multilayer: nothing there leaves the straight path as it is") {
  for (const double cos_incidence : {0.0, 1e-300, 1e-9, 0.4, 1.0}) {
    CAPTURE(cos_incidence);
    CHECK(multilayer_response({}, cos_incidence) == SurfaceResponse{{0.0, 0.0}, {1.0, 1.0}});
    const std::array<Layer, 2> air{Layer{1.0, 3.0}, Layer{1.0, 20.0}};
    const SurfaceResponse response = multilayer_response(air, cos_incidence);
    CHECK(response.reflection == PolarizedCoefficients{0.0, 0.0});
    CHECK(std::abs(response.transmission.te - 1.0) <= 1e-14);
    CHECK(std::abs(response.transmission.tm - 1.0) <= 1e-14);
  }
}

TEST_CASE("energy: a lossless stack returns or passes everything, a lossy one less, at every angle") {
  for (int step = 1; step <= 50; ++step) {
    const double cos_incidence = step / 50.0;
    const std::array<Layer, 4> lossless{Layer{2.73, 8.2}, Layer{1.0, 33.0}, Layer{81.0, 3.0}, Layer{6.31, 0.4}};
    const SurfaceResponse all = multilayer_response(lossless, cos_incidence);
    REQUIRE(std::abs(power_te(all) - 1.0) <= 1e-13);
    REQUIRE(std::abs(power_tm(all) - 1.0) <= 1e-13);
    std::array<Layer, 4> lossy = lossless;
    lossy[1].permittivity = Complex(1.0, -0.01);
    REQUIRE(power_te(multilayer_response(lossy, cos_incidence)) < 1.0 - 1e-4);
    REQUIRE(power_tm(multilayer_response(lossy, cos_incidence)) < 1.0 - 1e-4);
  }
}

TEST_CASE("reciprocity: turned about, a stack has the same transmission and another reflection") {
  const std::array<Layer, 3> stack{Layer{{5.24, -0.4}, 3.0}, Layer{1.0, 5.0}, Layer{{2.0, -0.1}, 7.0}};
  const std::array<Layer, 3> turned{stack[2], stack[1], stack[0]};
  for (const double cos_incidence : {1e-6, 0.1, 0.5, 0.9, 1.0}) {
    const SurfaceResponse there = multilayer_response(stack, cos_incidence);
    const SurfaceResponse back = multilayer_response(turned, cos_incidence);
    CHECK(test::relative_difference(there.transmission.te, back.transmission.te) <= 1e-13);
    CHECK(test::relative_difference(there.transmission.tm, back.transmission.tm) <= 1e-13);
    if (cos_incidence > 0.05) CHECK(std::abs(there.reflection.te - back.reflection.te) > 1e-3);
  }
}

TEST_CASE("quarter-wave layers: the admittance at normal incidence is v²/y after each") {
  // √ε·kd = π/2 in every layer. Symmetric: y = 1 → 4/1 → 16/4 → 4/4 = 1, matched.
  const std::array<Layer, 3> matched{Layer{4.0, 0.25 * pi}, Layer{16.0, 0.125 * pi}, Layer{4.0, 0.25 * pi}};
  CHECK(std::abs(multilayer_response(matched, 1.0).reflection.te) <= 1e-14);
  CHECK(std::abs(std::abs(multilayer_response(matched, 1.0).transmission.te) - 1.0) <= 1e-14);
  // Two of them, from the back: y = 1 → 4/1 → 16/4 = 4, R = (1 − 4)/(1 + 4).
  const std::array<Layer, 2> mirror{Layer{16.0, 0.125 * pi}, Layer{4.0, 0.25 * pi}};
  CHECK(std::abs(multilayer_response(mirror, 1.0).reflection.te + 0.6) <= 1e-14);
  // Turned about: y = 1 → 16/1 → 4/16 = 1/4, R = (1 − 1/4)/(1 + 1/4).
  const std::array<Layer, 2> turned{mirror[1], mirror[0]};
  CHECK(std::abs(multilayer_response(turned, 1.0).reflection.te - 0.6) <= 1e-14);
}

TEST_CASE("a thick lossy layer hides what lies behind it, finite at any thickness and contrast") {
  const Complex metal = complex_permittivity(1.0, 1e7, 100e9);
  for (const double thickness_rad : {1e3, 1e10, 1e300, std::numeric_limits<double>::max()})
    for (const double cos_incidence : {0.0, 1e-6, 0.5, 1.0}) {
      const std::array<Layer, 2> wall{Layer{metal, thickness_rad}, Layer{3.0, 7.0}};
      const SurfaceResponse response = multilayer_response(wall, cos_incidence);
      const auto half_space = half_space_reflection(metal, cos_incidence);
      REQUIRE(finite(response));
      CHECK(std::abs(response.reflection.te - half_space.te) <= 1e-14);
      CHECK(std::abs(response.reflection.tm - half_space.tm) <= 1e-14);
      CHECK(response.transmission == PolarizedCoefficients{0.0, 0.0});
    }
}

TEST_CASE("multilayer: no NaN for any finite media, thickness and angle") {
  const double huge = std::numeric_limits<double>::max();
  const double tiny = std::numeric_limits<double>::denorm_min();
  const std::array<double, 4> permittivities{1.0, 1.0 + 1e-16, 4.0, 1e300};
  for (const double first : permittivities)
    for (const double second : permittivities)
      for (const double loss : {0.0, tiny, 1.0, 1e300})
        for (const double thickness_rad : {0.0, tiny, 1e-3, pi, 1e10, huge})
          for (const double cos_incidence : {0.0, tiny, 1e-200, 1e-8, 0.5, 1.0}) {
            CAPTURE(first);
            CAPTURE(second);
            CAPTURE(loss);
            CAPTURE(thickness_rad);
            CAPTURE(cos_incidence);
            const std::array<Layer, 4> stack{Layer{{first, -loss}, thickness_rad}, Layer{second, thickness_rad},
                                             Layer{{first, -loss}, 1.0}, Layer{{second, -loss}, 2.0}};
            const SurfaceResponse response = multilayer_response(stack, cos_incidence);
            REQUIRE(finite(response));
            REQUIRE(power_te(response) <= 1.0 + 1e-13);
            REQUIRE(power_tm(response) <= 1.0 + 1e-13);
          }
}

}  // namespace test_multilayer
