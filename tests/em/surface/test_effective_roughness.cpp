/// The pattern integrals are taken anew by quadrature over directions, with vectors, not with the sums of the header.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dcem/core/random.hpp"
#include "dcem/core/units.hpp"
#include "dcem/em/surface/effective_roughness.hpp"
#include "dcem/em/surface/material_table.hpp"
#include "tests/support/quadrature.hpp"

namespace test_effective_roughness {

using namespace dcem;
using dcem::test::gauss_nodes, dcem::test::QuadratureNode;

namespace {

Vec3 direction(double cos_zenith, double azimuth_rad) {
  const double sine = std::sqrt((1.0 - cos_zenith) * (1.0 + cos_zenith));
  return {sine * std::cos(azimuth_rad), sine * std::sin(azimuth_rad), cos_zenith};
}

/// ∫ over the half space z > 0. A lobe of order α is a polynomial of degree α in the components of the direction: 64
/// nodes in the cosine and 160 in the azimuth integrate it up to α = 100 without an error but rounding.
template <typename Integrand>
double over_half_space(Integrand&& integrand) {
  static const std::vector<QuadratureNode> nodes = gauss_nodes(64);
  constexpr int azimuths = 160;
  double sum = 0.0;
  for (const QuadratureNode& node : nodes) {
    double ring = 0.0;
    for (int step = 0; step < azimuths; ++step) ring += integrand(direction(node.at, 2.0 * pi * step / azimuths));
    sum += node.weight * ring * 2.0 * pi / azimuths;
  }
  return sum;
}

/// The angles at a plane z = 0 for a wave that comes from the direction `from` and is scattered towards `to`.
ScatteringAngles angles_between(const Vec3& from, const Vec3& to) {
  const Vec3 mirrored(-from.x, -from.y, from.z);
  return {from.z, to.z, glm::dot(mirrored, to), glm::dot(from, to)};
}

Scattering scattering(ScatteringPattern pattern, int lobe = 4, int back_lobe = 4, double share = 0.5, double s = 0.4) {
  return {s, pattern, lobe, back_lobe, share};
}

std::vector<Scattering> many_patterns() {
  std::vector<Scattering> patterns{scattering(ScatteringPattern::lambertian)};
  for (const int lobe : {1, 2, 3, 4, 7, 10, 31, 100})
    patterns.push_back(scattering(ScatteringPattern::directive, lobe));
  for (const double share : {0.0, 0.1, 0.5, 0.9, 1.0}) {
    patterns.push_back(scattering(ScatteringPattern::backscattering, 4, 4, share));
    patterns.push_back(scattering(ScatteringPattern::backscattering, 1, 20, share));
    patterns.push_back(scattering(ScatteringPattern::backscattering, 60, 3, share));
  }
  return patterns;
}

constexpr std::array cosines{0.0, 1e-9, 1e-3, 0.02, 0.1, 0.3, 0.5, 0.70710678, 0.9, 0.999, 1.0};

}  // namespace

TEST_CASE("effective roughness: F(α) is the integral of the lobe over the half space, α = 1…50 at any incidence") {
  for (int lobe = 1; lobe <= 50; ++lobe) {
    CAPTURE(lobe);
    for (const double cosine : cosines) {
      CAPTURE(cosine);
      const Vec3 axis = direction(cosine, 0.4);
      const double expected =
          over_half_space([&](const Vec3& to) { return std::pow(0.5 * (1.0 + glm::dot(axis, to)), lobe); });
      // 1e-13: rounding of ten thousand terms of one sign.
      CHECK(scattering_lobe_integral(lobe, cosine) == doctest::Approx(expected).epsilon(1e-13).scale(0.0));
    }
  }
}

TEST_CASE("effective roughness: F(α) at normal and at grazing incidence in closed form, and monotone between") {
  for (int lobe = 0; lobe <= highest_scattering_lobe; ++lobe) {
    CAPTURE(lobe);
    // With u = (1 + cos ψ)/2 the whole sphere has ∫ u^α 4π du = 4π/(α + 1), and at normal incidence u runs from ½ to 1.
    const double sphere = 4.0 * pi / (lobe + 1);
    CHECK(scattering_lobe_integral(lobe, 1.0) ==
          doctest::Approx(sphere * (1.0 - std::pow(0.5, lobe + 1))).epsilon(1e-13).scale(0.0));
    CHECK(scattering_lobe_integral(lobe, 0.0) == doctest::Approx(0.5 * sphere).epsilon(1e-13).scale(0.0));
    double before = 0.0;
    for (int step = 0; step <= 200; ++step) {
      const double integral = scattering_lobe_integral(lobe, step / 200.0);
      CHECK(integral >= before * (1.0 - 1e-13));  // rounding, where the lobe is constant
      before = integral;
    }
  }
}

TEST_CASE("effective roughness: all that is scattered goes somewhere: the density integrates to 1") {
  for (const Scattering& pattern : many_patterns()) {
    CAPTURE(pattern.lobe);
    CAPTURE(pattern.back_lobe);
    CAPTURE(pattern.forward_share);
    for (const double cosine : cosines) {
      CAPTURE(cosine);
      const Vec3 from = direction(cosine, -1.1);
      const double sum =
          over_half_space([&](const Vec3& to) { return scattering_density_per_sr(pattern, angles_between(from, to)); });
      // 1e-12: rounding; the specification asks for 1e-9.
      CHECK(std::abs(sum - 1.0) <= 1e-12);
    }
  }
}

TEST_CASE("effective roughness: the lobes point where they should") {
  const Vec3 from = direction(std::cos(0.9), 2.0), mirrored(-from.x, -from.y, from.z);
  const auto density = [&](const Scattering& pattern, const Vec3& to) {
    return scattering_density_per_sr(pattern, angles_between(from, to));
  };
  for (const int lobe : {1, 4, 40}) {
    const Scattering forward = scattering(ScatteringPattern::directive, lobe);
    const Scattering back = scattering(ScatteringPattern::backscattering, lobe, lobe, 0.0);
    const double highest = 1.0 / scattering_lobe_integral(lobe, from.z);
    CHECK(density(forward, mirrored) == doctest::Approx(highest).epsilon(1e-14).scale(0.0));
    CHECK(density(back, from) == doctest::Approx(highest).epsilon(1e-14).scale(0.0));
    for (int step = 0; step < 100; ++step) {
      const Vec3 to = direction(0.005 + 0.0099 * step, 0.37 * step);
      CHECK(density(forward, to) <= highest);
      CHECK(density(back, to) <= highest);
      // A surface seen from its mirror image: forward and backward change places.
      CHECK(density(forward, to) == doctest::Approx(density(back, Vec3(-to.x, -to.y, to.z))).epsilon(1e-13).scale(0.0));
      const Scattering all_forward = scattering(ScatteringPattern::backscattering, lobe, 7, 1.0);
      CHECK(density(all_forward, to) == doctest::Approx(density(forward, to)).epsilon(1e-14).scale(0.0));
    }
  }
  CHECK(density(scattering(ScatteringPattern::lambertian), Vec3(0, 0, 1)) == doctest::Approx(1.0 / pi).epsilon(1e-15));
  CHECK(density(scattering(ScatteringPattern::lambertian), Vec3(1, 0, 0)) == 0.0);
}

TEST_CASE(
    "effective roughness: a Lambertian surface is reciprocal, and the directive one is not, by its two integrals") {
  RandomStream random(5);
  double largest = 0.0;
  for (int draw = 0; draw < 500; ++draw) {
    const Vec3 one = direction(random.uniform(), 6.3 * random.uniform());
    const Vec3 other = direction(random.uniform(), 6.3 * random.uniform());
    const auto there_and_back = [&](const Scattering& pattern) {
      return std::pair(one.z * scattering_density_per_sr(pattern, angles_between(one, other)),
                       other.z * scattering_density_per_sr(pattern, angles_between(other, one)));
    };
    const auto [there, back] = there_and_back(scattering(ScatteringPattern::lambertian));
    CHECK(there == doctest::Approx(back).epsilon(1e-15).scale(0.0));
    const auto [forth, reverse] = there_and_back(scattering(ScatteringPattern::directive, 6));
    const double expected =
        one.z * scattering_lobe_integral(6, other.z) / (other.z * scattering_lobe_integral(6, one.z));
    CHECK(forth / reverse == doctest::Approx(expected).epsilon(1e-13).scale(0.0));
    largest = std::max(largest, forth / reverse);
  }
  CHECK(largest > 2.0);
}

TEST_CASE("effective roughness: the limit of the density is a limit, and is reached by the Lambertian surface") {
  RandomStream random(17);
  for (const Scattering& pattern : many_patterns()) {
    double closest = 0.0;
    for (int draw = 0; draw < 4000; ++draw) {
      const Vec3 from = direction(random.uniform(), 0.0), to = direction(random.uniform(), 2.0 * pi * random.uniform());
      const ScatteringAngles angles = angles_between(from, to);
      const auto no_smaller = [&](double cosine) {
        return draw % 3 == 0 ? cosine : cosine + (1.0 - cosine) * random.uniform();
      };
      const ScatteringAngles largest{no_smaller(angles.cos_incidence), no_smaller(angles.cos_scattered),
                                     no_smaller(angles.cos_from_mirrored), no_smaller(angles.cos_from_incident)};
      const double density = scattering_density_per_sr(pattern, angles);
      const double limit = scattering_density_limit_per_sr(pattern, largest);
      REQUIRE(density <= limit * (1.0 + 1e-13));  // rounding, where both are the same
      if (limit > 0.0) closest = std::max(closest, density / limit);
    }
    CHECK(closest > 0.8);  // a limit that is far off would make every tile look large
  }
}

TEST_CASE("effective roughness: the width is where the narrowest lobe has fallen to e^(−1/2)") {
  for (const int lobe : {2, 4, 10, 100}) {
    const double width_rad = scattering_width_rad(scattering(ScatteringPattern::directive, lobe));
    // ((1 + cos ψ)/2)^α = cos^{2α}(ψ/2) = e^{−1/2}; the approximation in the header's comment is off by 1/(24·α) of ψ
    // and terms of 1/α².
    const double exact_rad = 2.0 * std::acos(std::exp(-0.25 / lobe));
    CHECK(std::abs(width_rad / exact_rad - 1.0 - 1.0 / (24.0 * lobe)) < 0.01 / (lobe * lobe));
    CHECK(scattering_width_rad(scattering(ScatteringPattern::backscattering, 1, lobe)) == width_rad);
    CHECK(scattering_width_rad(scattering(ScatteringPattern::backscattering, lobe, 1)) == width_rad);
  }
  CHECK(scattering_width_rad(scattering(ScatteringPattern::lambertian, 100, 100)) == 1.0);
  CHECK(scattering_width_rad(scattering(ScatteringPattern::directive, 1, 100)) == 1.0);
}

TEST_CASE("effective roughness: what is out of range is refused, what is at its rim is not") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Scattering& good : {Scattering{0.0}, Scattering{1.0, ScatteringPattern::directive, 1, 100, 0.0},
                                 Scattering{0.5, ScatteringPattern::backscattering, 100, 1, 1.0}}) {
    CHECK_NOTHROW(validate(good));
  }
  for (const Scattering& bad :
       {Scattering{-1e-9}, Scattering{1.0 + 1e-9}, Scattering{nan}, Scattering{0.5, ScatteringPattern::directive, 0},
        Scattering{0.5, ScatteringPattern::directive, 101}, Scattering{0.5, ScatteringPattern::backscattering, 4, 0},
        Scattering{0.5, ScatteringPattern::backscattering, 4, 101},
        Scattering{0.5, ScatteringPattern::backscattering, 4, 4, -0.1},
        Scattering{0.5, ScatteringPattern::backscattering, 4, 4, 1.1},
        Scattering{0.5, ScatteringPattern::backscattering, 4, 4, nan}}) {
    CHECK_THROWS_AS(validate(bad), std::invalid_argument);
  }
}

// The mirror's share --------------------------------------------------------------------------------------------------

namespace {

struct NamedModel {
  std::string name;
  MaterialModel model;
  bool is_lossless;
};

std::vector<NamedModel> all_models() {
  return {{"pec", PerfectConductor{}, true},
          {"mirror", ConstantReflection{1.0, std::nullopt}, true},
          {"constant", ConstantReflection{0.7, 20.0}, false},
          {"beam splitter", ConstantReflection{0.8, -power_ratio_to_db(0.36)}, true},
          {"opaque", ConstantReflection{0.8, std::nullopt}, false},
          {"half space", Dielectric{5.0, 0.3, {}}, false},
          {"clear slab", Dielectric{3.7, 0.0, 0.0123}, true},
          {"thick clear slab", Dielectric{6.0, 0.0, 0.3}, true},
          {"air", Dielectric{1.0, 0.0, 0.05}, true},
          {"lossy slab", Dielectric{5.1, 0.2, 0.02}, false},
          {"concrete", ItuMaterial{"concrete", {}}, false},
          {"thick concrete", ItuMaterial{"concrete", 0.2}, false},
          {"glass", ItuMaterial{"glass", 0.005}, false},
          {"plasterboard", ItuMaterial{"plasterboard", 0.0125}, false},
          {"metal", ItuMaterial{"metal", 0.001}, false},
          {"double glazing",
           Multilayer{{Dielectric{6.3, 0.0, 0.004}, Dielectric{1.0, 0.0, 0.016}, Dielectric{6.3, 0.0, 0.004}}}, true},
          {"wall",
           Multilayer{{ItuMaterial{"plasterboard", 0.0125}, Dielectric{1.0, 0.0, 0.07}, ItuMaterial{"concrete", 0.1}}},
           false},
          {"lined", Multilayer{{Dielectric{2.7, 0.01, 0.02}, ItuMaterial{"metal", 0.001}}}, false},
          {"leaves", Foliage{0.3}, true}};
}

Material rough(const NamedModel& named, double coefficient, ScatteringPattern pattern = ScatteringPattern::directive) {
  return {named.name, named.model, 0.0, {coefficient, pattern, 5, 2, 0.7}};
}

double power(const Complex& coefficient) {
  return std::norm(coefficient);
}

}  // namespace

TEST_CASE("effective roughness: reflected, scattered and transmitted power together are no more than the incident") {
  for (const NamedModel& named : all_models()) {
    CAPTURE(named.name);
    for (const double coefficient : {0.0, 0.2, 0.6, 0.95, 1.0}) {
      CAPTURE(coefficient);
      const MaterialTable table({rough(named, coefficient)}, 30e9);
      for (int step = 0; step <= 100; ++step) {
        const double cosine = step == 1 ? 1e-7 : 0.01 * step;
        CAPTURE(cosine);
        const SurfaceResponse response = table.response(MaterialId(0), cosine);
        const PolarizedCoefficients gamma = table.smooth_reflection(MaterialId(0), cosine);
        // The density integrates to 1, so the scattered share is (S·|Γ|)².
        const double s = table.scattering(MaterialId(0)).coefficient;
        const double te = power(response.reflection.te) + s * s * power(gamma.te) + power(response.transmission.te);
        const double tm = power(response.reflection.tm) + s * s * power(gamma.tm) + power(response.transmission.tm);
        // 1e-12: rounding of the slab's and the stack's own sums.
        CHECK(te <= 1.0 + 1e-12);
        CHECK(tm <= 1.0 + 1e-12);
        if (named.is_lossless) CHECK(te == doctest::Approx(1.0).epsilon(1e-12));
        if (named.is_lossless) CHECK(tm == doctest::Approx(1.0).epsilon(1e-12));
        // What scatters is taken from the mirror, neither more nor less.
        CHECK(std::abs(power(response.reflection.te) + s * s * power(gamma.te) - power(gamma.te)) <=
              1e-14 * power(gamma.te));
        CHECK(std::abs(power(response.reflection.tm) + s * s * power(gamma.tm) - power(gamma.tm)) <=
              1e-14 * power(gamma.tm));
      }
    }
  }
}

TEST_CASE("effective roughness: the mirror keeps √(1 − S²) with its phase, and what passes is not touched") {
  for (const NamedModel& named : all_models()) {
    CAPTURE(named.name);
    const MaterialTable smooth({Material{named.name, named.model}}, 30e9);
    for (const double coefficient : {0.0, 1e-9, 0.3, 0.6, 0.8, 1.0}) {
      const MaterialTable table({rough(named, coefficient)}, 30e9);
      const double share = std::sqrt(1.0 - coefficient * coefficient);
      for (const double cosine : cosines) {
        const SurfaceResponse before = smooth.response(MaterialId(0), cosine),
                              after = table.response(MaterialId(0), cosine);
        CHECK(after.transmission == before.transmission);
        CHECK(std::abs(after.reflection.te - share * before.reflection.te) <= 1e-15);
        CHECK(std::abs(after.reflection.tm - share * before.reflection.tm) <= 1e-15);
        CHECK(table.smooth_reflection(MaterialId(0), cosine) == before.reflection);
        // The two ends of the scale to the last bit: as before this model was there, and no mirror at all.
        if (coefficient == 0.0) CHECK(after == before);
        if (coefficient == 1.0) CHECK(after.reflection == PolarizedCoefficients{0.0, 0.0});
      }
    }
  }
}

TEST_CASE("effective roughness: the share of the mirror has all its digits near S = 1") {
  // 1 − S² = (1 − S)(1 + S): with S = 1 − 2^−40 it is 2^−39·(1 − 2^−41).
  const Scattering nearly{1.0 - 0x1p-40};
  CHECK(specular_share(nearly) == doctest::Approx(std::sqrt(0x1p-39 * (1.0 - 0x1p-41))).epsilon(1e-15).scale(0.0));
  CHECK(specular_share({0.0}) == 1.0);
  CHECK(specular_share({1.0}) == 0.0);
  CHECK(specular_share({0.6}) == doctest::Approx(0.8).epsilon(1e-15));
}

TEST_CASE("effective roughness: a surface has a height or a scattering coefficient, not both; leaves do not scatter") {
  CHECK_THROWS_AS(validate(Material{"wall", PerfectConductor{}, 1e-3, {0.1}}), std::invalid_argument);
  CHECK_THROWS_AS(validate(Material{"wall", PerfectConductor{}, 0.0, {1.1}}), std::invalid_argument);
  CHECK_NOTHROW(validate(Material{"wall", PerfectConductor{}, 1e-3, {0.0}}));
  CHECK(scatters(Material{"wall", PerfectConductor{}, 0.0, {0.1}}));
  CHECK_FALSE(scatters(Material{"wall", PerfectConductor{}}));
  CHECK_FALSE(scatters(Material{"leaves", Foliage{}, 0.0, {0.5}}));
  // A height goes on to work as it did: exp(−g²/2), g = 2kσ·cos θ.
  const MaterialTable table({Material{"wall", PerfectConductor{}, 1e-3}}, 30e9);
  const double g = 2.0 * 2.0 * pi * 30e9 / 299'792'458.0 * 1e-3 * 0.5;
  CHECK(std::abs(table.response(MaterialId(0), 0.5).reflection.tm - std::exp(-0.5 * g * g)) <= 1e-14);
}

}  // namespace test_effective_roughness
