/// Field strength, computed by hand.
#include "dcem/channel/radio_map.hpp"

#include <doctest/doctest.h>

namespace test_radio_map {

using namespace dcem;

TEST_CASE("field strength at an isotropic receiver") {
  // ITU-R P.525, equation (8): Pr/dBW = E/(dBµV/m) - 20·log10(f/GHz) - 167.2 (printed to 0.1 dB; its derivation,
  // 10·log10(λ²/(4π·Z0)) with Z0 = 376.73 Ω, gives 167.22).
  CHECK(field_strength_dbuv_per_m(30.0, 1e9) == doctest::Approx(167.2).epsilon(0.05 / 167.2));
  CHECK(field_strength_dbuv_per_m(-70.0, 30e9) == doctest::Approx(-100.0 + 167.2 + 29.54).epsilon(0.05 / 96.0));
  // 1 W at λ = 1 m: E = sqrt(4π·376.730313668) = 68.8050 V/m, 156.7524 dBµV/m.
  CHECK(field_strength_dbuv_per_m(30.0, 299'792'458.0) == doctest::Approx(156.7524043120986).epsilon(1e-12));
}

TEST_CASE("5 W isotropic at 1 km: field strength from the Friis power equals sqrt(30 P)/d") {
  // The engine's power is P (λ/(4πd))². The textbook field is sqrt(Z0 P/(4π))/d = 0.0122432 V/m, that is 81.758 dBµV/m
  // (sqrt(30 P)/d with Z0 = 120π is 0.012247).
  const double frequency_hz = 2e9, wavelength_m = 299'792'458.0 / frequency_hz;
  const double received_dbm = 36.98970004336019 + 20.0 * std::log10(wavelength_m / (4.0 * pi * 1000.0));
  CHECK(field_strength_dbuv_per_m(received_dbm, frequency_hz) ==
        doctest::Approx(20.0 * std::log10(std::sqrt(376.730313668 * 5.0 / (4.0 * pi)) / 1000.0 * 1e6)).epsilon(1e-12));
  CHECK(field_strength_dbuv_per_m(received_dbm, frequency_hz) == doctest::Approx(81.758).epsilon(1e-5));
}

TEST_CASE("a new map point knows nothing") {
  const RadioMapPoint point;
  CHECK_FALSE(point.obstructed);
  CHECK(point.statistics.path_count == 0);
  CHECK_FALSE(point.statistics.power_dbm.has_value());
  CHECK(point.strongest_kinds.empty());
}

}  // namespace test_radio_map
