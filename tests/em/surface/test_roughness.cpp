#include <doctest/doctest.h>

#include "dcem/em/surface/roughness.hpp"

namespace test_roughness {

using namespace dcem;

TEST_CASE("roughness: Ament and Miller-Brown at points worked out by hand") {
  // g = 2kσ·cos θ with k = 2π/0.01 m, σ = 1 mm, θ = 60°: 2 · 628.3185 · 0.001 · 0.5.
  const double g = roughness_phase_spread_rad(2.0 * pi / 0.01, 1e-3, 0.5);
  CHECK(std::abs(g - 0.2 * pi) <= 1e-15);
  // exp(−(0.2π)²/2) = exp(−0.19739209) = 0.82086872.
  CHECK(std::abs(ament_factor(g) - 0.82086872) <= 1e-8);
  // I0(2) = 2.2795853023360673 and I0(50)·e^{−50} = 0.05656162665 (mpmath.besseli, 25 digits).
  CHECK(std::abs(miller_brown_factor(2.0) - std::exp(-2.0) * 2.2795853023360673) <= 1e-14);
  CHECK(std::abs(miller_brown_factor(10.0) - 0.05656162665) <= 1e-10);
}

TEST_CASE("roughness: a smooth surface reflects all, a rough one never more, Ament never more than Miller-Brown") {
  CHECK(ament_factor(0.0) == 1.0);
  CHECK(miller_brown_factor(0.0) == 1.0);
  double before = 1.0;
  for (int step = 1; step < 400; ++step) {
    const double g = 0.05 * step;
    const double factor = miller_brown_factor(g);
    REQUIRE(factor < before);
    REQUIRE(factor >= ament_factor(g));
    before = factor;
  }
  // Small g: both are 1 − g²/2.
  CHECK(std::abs(miller_brown_factor(1e-3) - (1.0 - 5e-7)) <= 1e-12);
  CHECK(std::abs(ament_factor(1e-3) - (1.0 - 5e-7)) <= 1e-12);
}

TEST_CASE("roughness: the series and the asymptotic series of I0 meet, and large arguments stay finite") {
  // x = g²/2 = 30 is the seam; the function itself changes by 3e-11 of its value over the step taken here.
  const double seam = std::sqrt(60.0);
  const double below = miller_brown_factor(seam * (1.0 - 1e-11));
  const double above = miller_brown_factor(seam * (1.0 + 1e-11));
  CHECK(std::abs(above / below - 1.0) <= 3e-11);
  // 1/(g√π) for large g.
  CHECK(std::abs(miller_brown_factor(1e6) * 1e6 * std::sqrt(pi) - 1.0) <= 1e-12);
  CHECK(miller_brown_factor(1e200) == 0.0);
  CHECK(ament_factor(1e200) == 0.0);
}

TEST_CASE("roughness: Rayleigh's criterion is σ = λ/(8 cos θ)") {
  const double wavelength_m = 0.01;
  const double limit_m = wavelength_m / (8.0 * 0.7);
  CHECK(is_smooth(roughness_phase_spread_rad(2.0 * pi / wavelength_m, 0.999 * limit_m, 0.7)));
  CHECK_FALSE(is_smooth(roughness_phase_spread_rad(2.0 * pi / wavelength_m, 1.001 * limit_m, 0.7)));
}

}  // namespace test_roughness
