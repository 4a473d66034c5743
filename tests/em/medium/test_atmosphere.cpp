#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>

#include "dcem/core/units.hpp"
#include "dcem/em/medium/atmosphere.hpp"

namespace test_atmosphere {

using namespace dcem;

namespace {

const double vertical_rad = 0.5 * pi;

/// A transfer matrix without any symmetry.
const ComplexMatrix2 transfer{{{{Complex(1.0, -2.0), Complex(0.3, 0.4)}, {Complex(-0.5, 0.25), Complex(-3.0, 1e-9)}}}};

Atmosphere rainy(double rain_mm_per_h) {
  Atmosphere atmosphere;
  atmosphere.rain_mm_per_h = rain_mm_per_h;
  return atmosphere;
}

Atmosphere rain_alone(double rain_mm_per_h) {
  Atmosphere atmosphere = rainy(rain_mm_per_h);
  atmosphere.gas = false;
  return atmosphere;
}

/// The message of the std::invalid_argument that validate() throws; empty if it throws none.
std::string refusal(const Atmosphere& atmosphere) {
  try {
    validate(atmosphere);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST_CASE("air: no atmosphere, and one without gas and rain, change nothing, bit for bit") {
  Atmosphere nothing;
  nothing.gas = false;
  Atmosphere vacuum;
  vacuum.dry_pressure_hpa = 0.0;
  vacuum.water_vapour_g_per_m3 = 0.0;
  // 300 MHz: where nothing attenuates the frequency does not matter.
  for (const AirLoss& air : {AirLoss{}, AirLoss{nothing, 0.3e9}, AirLoss{vacuum, 60e9}}) {
    CHECK(air.is_lossless());
    for (const double length_m : {0.0, 1.0, 1234.5, 1e300}) {
      CHECK(air.loss_db(length_m, 0.3, 0.7) == 0.0);
      CHECK(air.amplitude(length_m, 0.3, 0.7) == 1.0);
      CHECK(air.unpolarized_power(length_m, 0.3) == 1.0);
      CHECK(air.damped(transfer, length_m, 1.0, 2.0) == transfer);
    }
  }
  CHECK_FALSE(AirLoss(Atmosphere{}, 60e9).is_lossless());
  CHECK_FALSE(AirLoss(rain_alone(1.0), 60e9).is_lossless());
}

TEST_CASE("air: a path of no length loses nothing") {
  const AirLoss air(rainy(50.0), 60e9);
  CHECK(air.loss_db(0.0, 0.1, 0.0) == 0.0);
  CHECK(air.amplitude(0.0, 0.1, 0.0) == 1.0);
  CHECK(air.damped(transfer, 0.0, 1.0, 2.0) == transfer);
}

TEST_CASE("air: by hand, 500 m at 60 GHz in standard air lose 7.389 dB, in rain of 25 mm/h 12.4 dB") {
  // 14.7783166 dB/km (P.676-13 validation row at 60 GHz) · 0.5 km = 7.3891583 dB; 10^(−7.3891583/20) = 0.4271123.
  const AirLoss dry(Atmosphere{}, 60e9);
  CHECK(std::abs(dry.loss_db(500.0, 0.0, 0.0) - 7.3891583) <= 1e-7);
  CHECK(std::abs(dry.amplitude(500.0, 0.0, 0.0) - 0.4271123) <= 1e-7);
  CHECK(dry.loss_db(500.0, 0.0, 0.0) == dry.loss_db(500.0, 1.0, 0.5));  // gases know no polarization
  // Rain: 10.1185 dB/km horizontal, 9.4764 vertical (P.838-3 at 60 GHz, 25 mm/h), on top of the gas.
  const AirLoss wet(rainy(25.0), 60e9);
  CHECK(std::abs(wet.loss_db(500.0, 0.0, 0.0) - (7.3891583 + 5.05925)) <= 3e-5);
  CHECK(std::abs(wet.loss_db(500.0, 0.0, vertical_rad) - (7.3891583 + 4.7382)) <= 3e-5);
}

TEST_CASE("air: losses of gas and rain add, and so do those of two lengths") {
  const AirLoss both(rainy(30.0), 77e9);
  const AirLoss gas(Atmosphere{}, 77e9);
  const AirLoss rain(rain_alone(30.0), 77e9);
  for (const double tilt_rad : {0.0, 0.6, vertical_rad}) {
    const double sum_db = gas.loss_db(800.0, 0.2, tilt_rad) + rain.loss_db(800.0, 0.2, tilt_rad);
    CHECK(std::abs(both.loss_db(800.0, 0.2, tilt_rad) / sum_db - 1.0) <= 1e-15);
    const double parts_db = both.loss_db(300.0, 0.2, tilt_rad) + both.loss_db(500.0, 0.2, tilt_rad);
    CHECK(std::abs(parts_db / both.loss_db(800.0, 0.2, tilt_rad) - 1.0) <= 1e-15);
    const double product = both.amplitude(300.0, 0.2, tilt_rad) * both.amplitude(500.0, 0.2, tilt_rad);
    CHECK(std::abs(product / both.amplitude(800.0, 0.2, tilt_rad) - 1.0) <= 1e-14);
  }
  // The matrix likewise: two stretches of air are one.
  const ComplexMatrix2 at_once = both.damped(transfer, 800.0, 1.2, 1.9);
  const ComplexMatrix2 in_two = both.damped(both.damped(transfer, 300.0, 1.2, 1.9), 500.0, 1.2, 1.9);
  for (std::size_t row = 0; row < 2; ++row)
    for (std::size_t column = 0; column < 2; ++column)
      CHECK(std::abs(in_two(row, column) / at_once(row, column) - 1.0) <= 1e-14);
}

TEST_CASE("air: the reverse link has the transposed matrix, bit for bit") {
  const AirLoss air(rainy(60.0), 38e9);
  for (const double departure_zenith_rad : {0.0, 0.4, 1.5, 2.8})
    for (const double arrival_zenith_rad : {0.1, 1.2, pi}) {
      const ComplexMatrix2 forward = air.damped(transfer, 2345.6, departure_zenith_rad, arrival_zenith_rad);
      const ComplexMatrix2 reverse = air.damped(transposed(transfer), 2345.6, arrival_zenith_rad, departure_zenith_rad);
      CHECK(reverse == transposed(forward));
    }
}

TEST_CASE("air: on a line of sight each polarization loses what it loses by itself") {
  const AirLoss air(rainy(40.0), 28e9);
  const double elevation_rad = 0.35;
  // Out of the transmitter upwards, out of the receiver back down: zeniths π/2 − ε and π/2 + ε.
  const ComplexMatrix2 damped = air.damped(transfer, 1500.0, 0.5 * pi - elevation_rad, 0.5 * pi + elevation_rad);
  const double theta = air.amplitude(1500.0, elevation_rad, vertical_rad);
  const double phi = air.amplitude(1500.0, elevation_rad, 0.0);
  CHECK(phi < theta);
  CHECK(std::abs(damped(0, 0) / transfer(0, 0) - theta) <= 1e-14);
  CHECK(std::abs(damped(1, 1) / transfer(1, 1) - phi) <= 1e-14);
  // A field that turns on its way has half the loss of each: the geometric mean of the factors.
  CHECK(std::abs(damped(0, 1) / transfer(0, 1) - std::sqrt(theta * phi)) <= 1e-14);
  CHECK(std::abs(damped(1, 0) / transfer(1, 0) - std::sqrt(theta * phi)) <= 1e-14);
}

TEST_CASE("air: columns are the transmitter's, rows the receiver's") {
  // Level at the transmitter, where the polarizations differ; straight up at the receiver, where they do not.
  const AirLoss air(rain_alone(100.0), 20e9);
  const ComplexMatrix2 ones{{{{1.0, 1.0}, {1.0, 1.0}}}};
  const ComplexMatrix2 damped = air.damped(ones, 1000.0, 0.5 * pi, 0.0);
  CHECK(std::abs(damped(0, 0) - damped(1, 0)) <= 1e-15);
  CHECK(std::abs(damped(0, 1) - damped(1, 1)) <= 1e-15);
  CHECK(damped(0, 1).real() < 0.99 * damped(0, 0).real());
  // Half of the way each: ε = 0 with τ = 0, and 90° with any.
  const double expected_db = 0.5 * (air.loss_db(1000.0, 0.0, 0.0) + air.loss_db(1000.0, 0.5 * pi, 0.7));
  CHECK(std::abs(amplitude_ratio_to_db(damped(0, 1).real()) + expected_db) <= 1e-12);
}

TEST_CASE("air: without rain all entries lose the same, the zeniths do not matter and phases stay") {
  const AirLoss air(Atmosphere{}, 60e9);
  const double factor = air.amplitude(700.0, 0.0, 0.0);
  for (const double zenith_rad : {0.0, 0.5, 3.0}) {
    const ComplexMatrix2 damped = air.damped(transfer, 700.0, zenith_rad, 1.0);
    for (std::size_t row = 0; row < 2; ++row)
      for (std::size_t column = 0; column < 2; ++column)
        CHECK(std::abs(damped(row, column) - factor * transfer(row, column)) <= 1e-16);
  }
}

TEST_CASE("air: more rain, more loss; horizontal above vertical on a level path; none of it matters straight up") {
  double before_db = AirLoss(Atmosphere{}, 28e9).loss_db(1000.0, 0.0, 0.0);
  for (const double rain_mm_per_h : {1.0, 5.0, 25.0, 150.0, 1000.0}) {
    const AirLoss air(rainy(rain_mm_per_h), 28e9);
    CHECK(air.loss_db(1000.0, 0.0, 0.0) > before_db);
    before_db = air.loss_db(1000.0, 0.0, 0.0);
    CHECK(air.loss_db(1000.0, 0.0, 0.0) > air.loss_db(1000.0, 0.0, 0.25 * pi));
    CHECK(air.loss_db(1000.0, 0.0, 0.25 * pi) > air.loss_db(1000.0, 0.0, vertical_rad));
    CHECK(std::abs(air.loss_db(1000.0, 0.5 * pi, 0.0) / air.loss_db(1000.0, 0.5 * pi, vertical_rad) - 1.0) <= 1e-15);
    CHECK(air.loss_db(1000.0, 0.4, 0.3) == air.loss_db(1000.0, -0.4, 0.3));
  }
}

TEST_CASE("air: an unpolarized wave keeps the mean of what both polarizations keep") {
  const AirLoss air(rainy(80.0), 30e9);
  const double h = air.amplitude(2000.0, 0.1, 0.0);
  const double v = air.amplitude(2000.0, 0.1, vertical_rad);
  CHECK(std::abs(air.unpolarized_power(2000.0, 0.1) / (0.5 * (h * h + v * v)) - 1.0) <= 1e-14);
  // The mean of powers is not below the power at the mean loss.
  const double mean_db = 0.5 * (air.loss_db(2000.0, 0.1, 0.0) + air.loss_db(2000.0, 0.1, vertical_rad));
  CHECK(air.unpolarized_power(2000.0, 0.1) > db_to_power_ratio(-mean_db));
  // Straight up both are the same.
  const double up = air.amplitude(2000.0, 0.5 * pi, 0.3);
  CHECK(std::abs(air.unpolarized_power(2000.0, 0.5 * pi) / (up * up) - 1.0) <= 1e-14);
}

TEST_CASE("air: where nothing is left the factor is 0, never a NaN") {
  const AirLoss air(rainy(1000.0), 556.935985e9);
  for (const double length_m : {1e6, 1e300, std::numeric_limits<double>::max()}) {
    CHECK(air.amplitude(length_m, 0.0, 0.0) == 0.0);
    CHECK(air.unpolarized_power(length_m, 0.0) == 0.0);
    CHECK(air.damped(transfer, length_m, 1.0, 1.0) == ComplexMatrix2{});
  }
}

TEST_CASE("air: bad atmospheres, frequencies, lengths and angles are refused") {
  const double infinity = std::numeric_limits<double>::infinity();
  CHECK(refusal(Atmosphere{}).empty());
  CHECK(refusal({true, 150.0, 0.0, 0.0, 0.0}).empty());  // the ranges are closed
  CHECK(refusal({true, 350.0, 1200.0, 100.0, 1000.0}).empty());
  CHECK(refusal({true, 20.0, 1013.25, 7.5, 0.0}) == "temperature_k is 20; expected 150 to 350 K");
  CHECK(refusal({true, 288.15, 101325.0, 7.5, 0.0}) == "dry_pressure_hpa is 101325; expected 0 to 1200 hPa");
  CHECK(refusal({true, 288.15, 1013.25, 7500.0, 0.0}) == "water_vapour_g_per_m3 is 7500; expected 0 to 100 g/m3");
  CHECK(refusal({true, 288.15, 1013.25, 7.5, -5.0}) == "rain_mm_per_h is -5; expected 0 to 1000 mm/h");
  CHECK_FALSE(refusal({false, 20.0, 1013.25, 7.5, 0.0}).empty());  // even where gas is off
  for (const double bad : {infinity, -infinity, std::nan("")}) {
    CHECK_FALSE(refusal({true, bad, 1013.25, 7.5, 0.0}).empty());
    CHECK_FALSE(refusal({true, 288.15, bad, 7.5, 0.0}).empty());
    CHECK_FALSE(refusal({true, 288.15, 1013.25, bad, 0.0}).empty());
    CHECK_FALSE(refusal({true, 288.15, 1013.25, 7.5, bad}).empty());
    CHECK_THROWS_AS(AirLoss(Atmosphere{}, bad), std::invalid_argument);
  }
  CHECK_THROWS_AS(AirLoss(Atmosphere{true, 20.0, 1013.25, 7.5, 0.0}, 30e9), std::invalid_argument);
  CHECK_THROWS_AS(AirLoss(Atmosphere{}, 0.5e9), std::invalid_argument);
  CHECK_THROWS_AS(AirLoss(rain_alone(1.0), 1001e9), std::invalid_argument);
  for (const AirLoss& air : {AirLoss{}, AirLoss{rainy(10.0), 30e9}}) {
    for (const double bad_m : {-1.0, infinity, std::nan("")}) {
      CHECK_THROWS_AS(air.loss_db(bad_m, 0.0, 0.0), std::invalid_argument);
      CHECK_THROWS_AS(air.amplitude(bad_m, 0.0, 0.0), std::invalid_argument);
      CHECK_THROWS_AS(air.unpolarized_power(bad_m, 0.0), std::invalid_argument);
      CHECK_THROWS_AS(air.damped(transfer, bad_m, 1.0, 1.0), std::invalid_argument);
    }
    for (const double bad_rad : {infinity, std::nan("")}) {
      CHECK_THROWS_AS(air.loss_db(1.0, bad_rad, 0.0), std::invalid_argument);
      CHECK_THROWS_AS(air.loss_db(1.0, 0.0, bad_rad), std::invalid_argument);
      CHECK_THROWS_AS(air.unpolarized_power(1.0, bad_rad), std::invalid_argument);
      CHECK_THROWS_AS(air.damped(transfer, 1.0, bad_rad, 1.0), std::invalid_argument);
      CHECK_THROWS_AS(air.damped(transfer, 1.0, 1.0, bad_rad), std::invalid_argument);
    }
  }
}

TEST_CASE("air: two atmospheres are equal when every field is") {
  CHECK(Atmosphere{} == Atmosphere{});
  CHECK(rainy(1.0) != Atmosphere{});
  CHECK(rainy(1.0) != rain_alone(1.0));
  CHECK(Atmosphere{true, 300.0} != Atmosphere{});
  CHECK(Atmosphere{true, 288.15, 900.0} != Atmosphere{});
  CHECK(Atmosphere{true, 288.15, 1013.25, 1.0} != Atmosphere{});
}

}  // namespace test_atmosphere
