#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <string>

#include "dcem/em/medium/gas_attenuation.hpp"
#include "tests/em/csv_rows.hpp"
#include "tests/support/shared_data.hpp"

namespace test_gas_attenuation {

using namespace dcem;

namespace {

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

/// A row (f, p, T, ρ, γ_o, γ_w, γ) of a table of specific attenuations, within `relative` of its numbers plus half a
/// unit of their last decimal.
void check_row(const std::vector<double>& row, double relative, double decimal = 0.0) {
  REQUIRE(row.size() == 7);
  const double frequency_hz = row[0] * 1e9;
  const Air air{row[2], row[1], row[3]};
  CAPTURE(row[0]);
  CHECK(std::abs(oxygen_attenuation_db_per_km(frequency_hz, air) - row[4]) <= relative * row[4] + decimal);
  CHECK(std::abs(water_vapour_attenuation_db_per_km(frequency_hz, air) - row[5]) <= relative * row[5] + decimal);
  CHECK(std::abs(gas_attenuation_db_per_km(frequency_hz, air) - row[6]) <= relative * row[6] + decimal);
}

/// Where the attenuation by one gas has fallen to half of its value at the centre, as a distance in hertz.
template <typename Attenuation>
double half_width_hz(Attenuation attenuation, double centre_hz, double upper_limit_hz) {
  const double half = 0.5 * attenuation(centre_hz);
  double inside_hz = 0.0;
  double outside_hz = upper_limit_hz;
  for (int step = 0; step < 60; ++step) {
    const double middle_hz = 0.5 * (inside_hz + outside_hz);
    (attenuation(centre_hz + middle_hz) > half ? inside_hz : outside_hz) = middle_hz;
  }
  return inside_hz;
}

}  // namespace

TEST_CASE("gases: the validation rows of the ITU, 1 to 350 GHz at the standard ground values") {
  DCEM_NEEDS_SHARED();
  const auto rows = test::number_rows("itu/itur_rpy/ITURP676-13_gamma.csv");
  CHECK(rows.size() == 350);
  // 15 digits are printed; sums of 44 lines of either sign cost a few of them.
  for (const auto& row : rows) check_row(row, 1e-13);

  const auto older_rows = test::number_rows("itu/itur_rpy/ITURP676-12_gamma.csv");
  CHECK(older_rows.size() == 355);
  // Eight decimals in some rows, and γ is the sum of the two rounded parts.
  for (const auto& row : older_rows) check_row(row, 1e-13, 1e-8);
}

TEST_CASE("gases: the rows of the subset at the frequencies of vehicles and base stations") {
  DCEM_NEEDS_SHARED();
  const auto rows = test::number_rows("itu/p676-13_subset.csv");
  CHECK(rows.size() == 13);
  for (const auto& row : rows) {
    REQUIRE(row.size() == 4);
    check_row({row[0], 1013.25, 288.15, 7.5, row[1], row[2], row[3]}, 1e-13);
  }
}

TEST_CASE("gases: both tables of lines are those of the reference data, row by row") {
  DCEM_NEEDS_SHARED();
  const auto oxygen = test::number_rows("itu/p676_lines_oxygen.csv");
  REQUIRE(oxygen.size() == oxygen_lines.size());
  for (std::size_t i = 0; i < oxygen.size(); ++i) {
    const OxygenLine& line = oxygen_lines[i];
    CHECK(oxygen[i] == std::vector<double>{line.frequency_ghz, line.a1, line.a2, line.a3, line.a4, line.a5, line.a6});
  }
  const auto water = test::number_rows("itu/p676_lines_water_vapour.csv");
  REQUIRE(water.size() == water_vapour_lines.size());
  for (std::size_t i = 0; i < water.size(); ++i) {
    const WaterVapourLine& line = water_vapour_lines[i];
    CHECK(water[i] == std::vector<double>{line.frequency_ghz, line.b1, line.b2, line.b3, line.b4, line.b5, line.b6});
  }
}

TEST_CASE("gases: other temperatures, pressures and vapours, as another program has them") {
  // gamma0_exact and gammaw_exact of ITU-Rpy 0.4.0 (P.676-12): f in GHz, p in hPa, T in K, ρ in g/m³, γ_o, γ_w.
  const double rows[][6] = {
      {5.9, 1030, 253.15, 2, 0.011067433561395, 0.000644907916468638},
      {28, 700, 268.15, 3, 0.0109274164929386, 0.0269327358834435},
      {30, 950, 308.15, 25, 0.0159542481370289, 0.243944979772949},
      {60, 500, 243.15, 0.5, 12.0734363711601, 0.00748050077138614},
      {62.4112, 50, 220, 0.01, 3.74372464788944, 2.13288151539117e-05},
      {77, 1080, 318.15, 40, 0.0830518347566722, 1.59829984983224},
      {118.75, 20, 230, 0.005, 2.18230756049689, 1.39400581757901e-05},
      {140, 1013.25, 300, 17, 0.0163746553700736, 2.12930921000786},
      {183.31, 300, 250, 1, 0.00195318317134699, 14.2388635396478},
      {300, 850, 290, 10, 0.017712859571351, 6.22275090910841},
      {557, 10, 200, 0.1, 2.75700687798183e-05, 12816.1516394497},
      {1000, 1013.25, 288.15, 7.5, 0.189040569886926, 695.583141627294},
  };
  for (const auto& row : rows)
    check_row({row[0], row[1], row[2], row[3], row[4], row[5], row[4] + row[5]}, 1e-12);  // 15 digits
}

TEST_CASE("gases: the standard ground values by heart, in dB/km") {
  const double rows[][3] = {{5.9, 0.0094, 5e-5}, {28, 0.102, 5e-4}, {30, 0.094, 5e-4}, {38, 0.117, 5e-4},
                            {60, 14.78, 5e-3},   {72, 0.419, 5e-4}, {77, 0.348, 5e-4}};
  for (const auto& row : rows) {
    const auto& [frequency_ghz, expected_db_per_km, half_a_digit] = row;
    CAPTURE(row[0]);
    CHECK(std::abs(gas_attenuation_db_per_km(frequency_ghz * 1e9) - expected_db_per_km) <= half_a_digit);
  }
}

TEST_CASE("gases: no vapour, no attenuation by vapour; no air, none by oxygen; nothing, nothing") {
  const Air dry{288.15, 1013.25, 0.0};
  const Air steam{288.15, 0.0, 7.5};
  const Air vacuum{288.15, 0.0, 0.0};
  for (const double frequency_ghz : {1.0, 22.235, 60.0, 118.750334, 183.310087, 556.935985, 1000.0}) {
    const double frequency_hz = frequency_ghz * 1e9;
    CHECK(water_vapour_attenuation_db_per_km(frequency_hz, dry) == 0.0);
    CHECK(oxygen_attenuation_db_per_km(frequency_hz, dry) > 0.0);
    CHECK(gas_attenuation_db_per_km(frequency_hz, dry) == oxygen_attenuation_db_per_km(frequency_hz, dry));
    CHECK(oxygen_attenuation_db_per_km(frequency_hz, steam) == 0.0);
    CHECK(water_vapour_attenuation_db_per_km(frequency_hz, steam) > 0.0);
    CHECK(gas_attenuation_db_per_km(frequency_hz, vacuum) == 0.0);
  }
}

TEST_CASE("gases: the pressure of the vapour is that of an ideal gas") {
  // e = ρ·R·T/M with R = 8.314462618 J/(mol K), M = 18.01528 g/mol; 216.7 has four digits.
  const double expected_hpa = 7.5 * 8.314462618 * 288.15 / 18.01528 / 100.0;
  CHECK(std::abs(vapour_pressure_hpa(Air{}) / expected_hpa - 1.0) <= 3e-4);
}

TEST_CASE("gases: far from the lines collisions absorb, with the square of the pressure; on a line the peak stays") {
  // A wing of a Lorentz line is strength (∝ p) times width (∝ p), with the interference of lines and what nitrogen
  // absorbs likewise. 200 GHz is far from all oxygen lines. The Zeeman floor of 1.5 MHz is 1% of the widths at 100 hPa
  // and counts as its square.
  const double thin = oxygen_attenuation_db_per_km(200e9, {288.15, 100.0, 0.0});
  const double double_thin = oxygen_attenuation_db_per_km(200e9, {288.15, 200.0, 0.0});
  CHECK(std::abs(double_thin / thin - 4.0) <= 2e-3);
  // Peak: strength over width. The Zeeman floor lowers the first one a little, what the lines at 60 GHz add grows.
  const double peak = oxygen_attenuation_db_per_km(118.750334e9, {288.15, 150.0, 0.0});
  const double double_peak = oxygen_attenuation_db_per_km(118.750334e9, {288.15, 300.0, 0.0});
  CHECK(std::abs(double_peak / peak - 1.0) <= 3e-3);
}

TEST_CASE("gases: molecules of water collide with each other more effectively than with air") {
  // Twice the vapour is more than twice the attenuation in the window at 90 GHz, and less than four times.
  const double once = water_vapour_attenuation_db_per_km(90e9, {300.0, 1000.0, 10.0});
  const double twice = water_vapour_attenuation_db_per_km(90e9, {300.0, 1000.0, 20.0});
  CHECK(twice > 2.1 * once);
  CHECK(twice < 4.0 * once);
}

TEST_CASE("gases: in thin air a line of water is as wide as its molecules are fast, one of oxygen 1.5 MHz") {
  // Doppler: half width f·√(2·ln 2·k·T/(m·c²)), k = 1.380649e-23 J/K, m = 18.01528 · 1.66053907e-27 kg. The
  // Recommendation has a Lorentz line of that width, and its 2.1316e-12 gives 1.4600e-6 where physics gives 1.4614e-6
  // at 300 K.
  for (const double temperature_k : {200.0, 300.0}) {
    const Air thin{temperature_k, 0.0, 1e-9};
    const double centre_hz = 556.935985e9;
    const double expected_hz =
        centre_hz * std::sqrt(2.0 * std::log(2.0) * 1.380649e-23 * temperature_k / (18.01528 * 1.66053907e-27)) /
        299792458.0;
    const auto attenuation = [&](double f_hz) { return water_vapour_attenuation_db_per_km(f_hz, thin); };
    CHECK(std::abs(half_width_hz(attenuation, centre_hz, 1e8) / expected_hz - 1.0) <= 2e-3);
  }
  // Zeeman: 1.5 MHz whatever the line and the temperature (eq. 6b).
  const Air thin{250.0, 1e-6, 0.0};
  const auto attenuation = [&](double f_hz) { return oxygen_attenuation_db_per_km(f_hz, thin); };
  CHECK(std::abs(half_width_hz(attenuation, 118.750334e9, 1e8) / 1.5e6 - 1.0) <= 1e-4);
}

TEST_CASE("gases: the lines stand where spectroscopy has them, and the windows between") {
  const auto attenuation = [](double frequency_ghz) { return gas_attenuation_db_per_km(frequency_ghz * 1e9); };
  for (const double line_ghz : {22.3, 60.5, 118.75, 183.31, 325.15, 380.2}) {
    CAPTURE(line_ghz);
    CHECK(attenuation(line_ghz) > attenuation(line_ghz - 5.0));
    CHECK(attenuation(line_ghz) > attenuation(line_ghz + 5.0));
  }
  CHECK(attenuation(35.0) < attenuation(22.3));
  CHECK(attenuation(94.0) < attenuation(118.75));
}

TEST_CASE("gases: nothing amplifies, from the ground to space and over the whole range") {
  for (const double temperature_k : {150.0, 220.0, 288.15, 350.0})
    for (const double dry_pressure_hpa : {0.0, 1e-6, 1e-3, 1.0, 50.0, 1013.25, 1200.0})
      for (const double vapour : {0.0, 1e-6, 1.0, 100.0})
        for (int step = 0; step <= 150; ++step) {
          const double frequency_hz = step == 150 ? 1000e9 : 1e9 * std::pow(10.0, 0.02 * step);
          const Air air{temperature_k, dry_pressure_hpa, vapour};
          const double oxygen = oxygen_attenuation_db_per_km(frequency_hz, air);
          const double water = water_vapour_attenuation_db_per_km(frequency_hz, air);
          const bool fine = oxygen >= 0.0 && std::isfinite(oxygen) && water >= 0.0 && std::isfinite(water);
          if (!fine)
            FAIL_CHECK(temperature_k << " K, " << dry_pressure_hpa << " hPa, " << vapour << " g/m3, " << frequency_hz
                                     << " Hz: " << oxygen << ", " << water);
        }
}

TEST_CASE("gases: the range of frequencies is closed, and bad values are refused by name") {
  const double infinity = std::numeric_limits<double>::infinity();
  CHECK_NOTHROW(gas_attenuation_db_per_km(1e9));
  CHECK_NOTHROW(gas_attenuation_db_per_km(1000e9));
  for (const double bad_hz : {0.999e9, 1000.001e9, 0.0, -60e9, infinity, std::nan("")}) {
    CHECK_THROWS_AS(oxygen_attenuation_db_per_km(bad_hz), std::invalid_argument);
    CHECK_THROWS_AS(water_vapour_attenuation_db_per_km(bad_hz), std::invalid_argument);
    CHECK_THROWS_AS(gas_attenuation_db_per_km(bad_hz), std::invalid_argument);
  }
  CHECK(refusal([] { gas_attenuation_db_per_km(0.5e9); }) ==
        "frequency of the attenuation by gases (ITU-R P.676) is 0.5; expected 1 to 1000 GHz");
  CHECK(refusal([] { validate(Air{149.0, 1013.25, 7.5}); }) == "temperature_k is 149; expected 150 to 350 K");
  CHECK(refusal([] { validate(Air{288.15, 1201.0, 7.5}); }) == "dry_pressure_hpa is 1201; expected 0 to 1200 hPa");
  CHECK(refusal([] { validate(Air{288.15, 1013.25, -1.0}); }) == "water_vapour_g_per_m3 is -1; expected 0 to 100 g/m3");
  for (const double bad : {-1.0, infinity, std::nan("")}) {
    CHECK_THROWS_AS(gas_attenuation_db_per_km(30e9, {bad, 1013.25, 7.5}), std::invalid_argument);
    CHECK_THROWS_AS(gas_attenuation_db_per_km(30e9, {288.15, bad, 7.5}), std::invalid_argument);
    CHECK_THROWS_AS(gas_attenuation_db_per_km(30e9, {288.15, 1013.25, bad}), std::invalid_argument);
  }
}

}  // namespace test_gas_attenuation
