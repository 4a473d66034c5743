#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>

#include "dcem/core/units.hpp"
#include "dcem/em/medium/rain_attenuation.hpp"
#include "tests/em/csv_rows.hpp"
#include "tests/support/shared_data.hpp"

namespace test_rain_attenuation {

using namespace dcem;

namespace {

const double horizontal_rad = 0.0;
const double circular_rad = 0.25 * pi;
const double vertical_rad = 0.5 * pi;

/// The message of the std::invalid_argument that the call throws; empty if it throws none.
template <typename Call>
std::string refusal(Call call) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST_CASE("rain: the validation rows of the ITU, slanted paths with either polarization") {
  DCEM_NEEDS_SHARED();
  const auto rows = test::number_rows("itu/itur_rpy/ITURP838-3_rain_specific_attenuation.csv");
  CHECK(rows.size() == 64);
  for (const auto& row : rows) {  // elevation, f, R, tilt, k, α, γ
    REQUIRE(row.size() == 7);
    CAPTURE(row[0]);
    CAPTURE(row[1]);
    const double elevation_rad = degrees_to_radians(row[0]);
    const double tilt_rad = degrees_to_radians(row[3]);
    const RainPowerLaw law = rain_power_law(rain_coefficients(row[1] * 1e9), elevation_rad, tilt_rad);
    CHECK(std::abs(law.k - row[4]) <= 5.1e-9);  // eight decimals are printed
    CHECK(std::abs(law.alpha - row[5]) <= 5.1e-9);
    // R and γ are printed to eight decimals.
    CHECK(std::abs(rain_attenuation_db_per_km(row[1] * 1e9, row[2], elevation_rad, tilt_rad) - row[6]) <= 1e-8);
  }
}

TEST_CASE("rain: the rows from 28 to 77 GHz on level paths") {
  DCEM_NEEDS_SHARED();
  const auto rows = test::number_rows("itu/p838-3_28to77GHz.csv");
  CHECK(rows.size() == 8);
  for (const auto& row : rows) {  // f, k_H, α_H, k_V, α_V, γ_H at 5, 25 and 50 mm/h, γ_V at 25 mm/h
    REQUIRE(row.size() == 9);
    CAPTURE(row[0]);
    const double frequency_hz = row[0] * 1e9;
    const RainCoefficients coefficients = rain_coefficients(frequency_hz);
    CHECK(std::abs(coefficients.horizontal.k - row[1]) <= 5.1e-6);  // half a unit of the last decimal printed
    CHECK(std::abs(coefficients.horizontal.alpha - row[2]) <= 5.1e-6);
    CHECK(std::abs(coefficients.vertical.k - row[3]) <= 5.1e-6);
    CHECK(std::abs(coefficients.vertical.alpha - row[4]) <= 5.1e-6);
    CHECK(std::abs(rain_attenuation_db_per_km(frequency_hz, 5.0, 0.0, horizontal_rad) - row[5]) <= 5.1e-5);
    CHECK(std::abs(rain_attenuation_db_per_km(frequency_hz, 25.0, 0.0, horizontal_rad) - row[6]) <= 5.1e-5);
    CHECK(std::abs(rain_attenuation_db_per_km(frequency_hz, 50.0, 0.0, horizontal_rad) - row[7]) <= 5.1e-5);
    CHECK(std::abs(rain_attenuation_db_per_km(frequency_hz, 25.0, 0.0, vertical_rad) - row[8]) <= 5.1e-5);
  }
}

TEST_CASE("rain: Table 5 of the Recommendation, and heavy rain by heart") {
  const double rows[][5] = {{1, 0.0000259, 0.9691, 0.0000308, 0.8592}, {2, 0.0000847, 1.0664, 0.0000998, 0.9490},
                            {6, 0.0007056, 1.5900, 0.0004878, 1.5728}, {8, 0.004115, 1.3905, 0.003450, 1.3797},
                            {10, 0.01217, 1.2571, 0.01129, 1.2156},    {20, 0.09164, 1.0568, 0.09611, 0.9847},
                            {30, 0.2403, 0.9485, 0.2291, 0.9129},      {60, 0.8606, 0.7656, 0.8515, 0.7486},
                            {100, 1.3671, 0.6815, 1.3680, 0.6765}};
  for (const auto& row : rows) {
    const auto& [frequency_ghz, k_h, alpha_h, k_v, alpha_v] = row;
    CAPTURE(row[0]);
    const RainCoefficients coefficients = rain_coefficients(frequency_ghz * 1e9);
    // Half a unit of the last digit: four digits are printed, three at the two lowest frequencies.
    const double k_tolerance = frequency_ghz < 4.0 ? 2e-3 : 5e-4;
    CHECK(std::abs(coefficients.horizontal.k / k_h - 1.0) <= k_tolerance);
    CHECK(std::abs(coefficients.vertical.k / k_v - 1.0) <= k_tolerance);
    CHECK(std::abs(coefficients.horizontal.alpha - alpha_h) <= 5.1e-5);
    CHECK(std::abs(coefficients.vertical.alpha - alpha_v) <= 5.1e-5);
  }
  CHECK(std::abs(rain_attenuation_db_per_km(28e9, 25.0, 0.0, horizontal_rad) - 4.62) <= 5e-3);
  CHECK(std::abs(rain_attenuation_db_per_km(60e9, 25.0, 0.0, horizontal_rad) - 10.1) <= 5e-2);
}

TEST_CASE("rain: none is no loss, more is more loss, by a power law") {
  for (const double frequency_ghz : {1.0, 5.9, 28.0, 77.0, 300.0, 1000.0})
    for (const double tilt_rad : {horizontal_rad, circular_rad, vertical_rad}) {
      CAPTURE(frequency_ghz);
      double before = rain_attenuation_db_per_km(frequency_ghz * 1e9, 0.0, 0.3, tilt_rad);
      double factor = 0.0;
      CHECK(before == 0.0);
      for (double rain_mm_per_h = 0.25; rain_mm_per_h <= 1000.0; rain_mm_per_h *= 2.0) {
        const double now = rain_attenuation_db_per_km(frequency_ghz * 1e9, rain_mm_per_h, 0.3, tilt_rad);
        CHECK(now > before);
        // A power law: twice the rain is one and the same factor for all rain.
        if (factor > 0.0) CHECK(std::abs(now / before / factor - 1.0) <= 1e-13);
        if (before > 0.0) factor = now / before;
        before = now;
      }
    }
}

TEST_CASE("rain: drops are flat, so horizontal loses more than vertical on a level path") {
  for (double frequency_ghz = 5.0; frequency_ghz <= 100.0; frequency_ghz += 1.0)
    for (const double rain_mm_per_h : {5.0, 25.0, 100.0}) {
      CAPTURE(frequency_ghz);
      const double h = rain_attenuation_db_per_km(frequency_ghz * 1e9, rain_mm_per_h, 0.0, horizontal_rad);
      const double v = rain_attenuation_db_per_km(frequency_ghz * 1e9, rain_mm_per_h, 0.0, vertical_rad);
      CHECK(h > v);
      // Between the two for every tilt in between.
      const double slanted = rain_attenuation_db_per_km(frequency_ghz * 1e9, rain_mm_per_h, 0.0, 0.5);
      CHECK(slanted < h);
      CHECK(slanted > v);
    }
}

TEST_CASE("rain: on a level path tilt 0 is the horizontal law and tilt 90 degrees the vertical one") {
  const RainCoefficients coefficients = rain_coefficients(38e9);
  const RainPowerLaw horizontal = rain_power_law(coefficients, 0.0, horizontal_rad);
  const RainPowerLaw vertical = rain_power_law(coefficients, 0.0, vertical_rad);
  // Sums and differences of numbers of one size.
  CHECK(std::abs(horizontal.k / coefficients.horizontal.k - 1.0) <= 1e-15);
  CHECK(std::abs(horizontal.alpha / coefficients.horizontal.alpha - 1.0) <= 1e-15);
  CHECK(std::abs(vertical.k / coefficients.vertical.k - 1.0) <= 1e-15);
  CHECK(std::abs(vertical.alpha / coefficients.vertical.alpha - 1.0) <= 1e-15);
}

TEST_CASE("rain: circular polarization has the mean k and the mean of alpha weighted by k, at every elevation") {
  // cos 90° = 0 leaves k = (k_H + k_V)/2 and α = (k_H·α_H + k_V·α_V)/(k_H + k_V).
  const RainCoefficients coefficients{{0.4, 0.9}, {0.2, 0.6}};
  for (const double elevation_rad : {-1.5, -0.3, 0.0, 0.7, 1.2}) {
    const RainPowerLaw law = rain_power_law(coefficients, elevation_rad, circular_rad);
    CHECK(std::abs(law.k - 0.3) <= 1e-15);
    CHECK(std::abs(law.alpha - 0.8) <= 1e-15);  // (0.36 + 0.12)/0.6
  }
}

TEST_CASE("rain: on a vertical path the tilt does not matter; up and down are the same") {
  const RainCoefficients coefficients = rain_coefficients(30e9);
  const RainPowerLaw circular = rain_power_law(coefficients, 0.0, circular_rad);
  for (const double elevation_rad : {0.5 * pi, -0.5 * pi})
    for (const double tilt_rad : {0.0, 0.4, 1.0, vertical_rad, 3.0}) {
      const RainPowerLaw law = rain_power_law(coefficients, elevation_rad, tilt_rad);
      CHECK(std::abs(law.k / circular.k - 1.0) <= 1e-15);
      CHECK(std::abs(law.alpha / circular.alpha - 1.0) <= 1e-15);
    }
  for (const double elevation_rad : {0.1, 0.5, 1.4})
    CHECK(rain_power_law(coefficients, elevation_rad, 0.3) == rain_power_law(coefficients, -elevation_rad, 0.3));
}

TEST_CASE("rain: ranges are closed, and bad values are refused by name") {
  const double infinity = std::numeric_limits<double>::infinity();
  CHECK_NOTHROW(rain_coefficients(1e9));
  CHECK_NOTHROW(rain_coefficients(1000e9));
  CHECK_NOTHROW(rain_attenuation_db_per_km(30e9, 1000.0, 0.0, 0.0));
  for (const double bad : {0.999e9, 1000.001e9, 0.0, -30e9, infinity, std::nan("")})
    CHECK_THROWS_AS(rain_coefficients(bad), std::invalid_argument);
  for (const double bad : {-0.001, 1000.001, infinity, std::nan("")})
    CHECK_THROWS_AS(rain_attenuation_db_per_km(30e9, bad, 0.0, 0.0), std::invalid_argument);
  for (const double bad : {infinity, std::nan("")}) {
    CHECK_THROWS_AS(rain_attenuation_db_per_km(30e9, 1.0, bad, 0.0), std::invalid_argument);
    CHECK_THROWS_AS(rain_attenuation_db_per_km(30e9, 1.0, 0.0, bad), std::invalid_argument);
  }
  CHECK(refusal([] { rain_coefficients(0.5e9); }) ==
        "frequency of the attenuation by rain (ITU-R P.838) is 0.5; expected 1 to 1000 GHz");
  CHECK(refusal([] { rain_attenuation_db_per_km(30e9, -1.0, 0.0, 0.0); }) ==
        "rain_mm_per_h is -1; expected 0 to 1000 mm/h");
}

}  // namespace test_rain_attenuation
