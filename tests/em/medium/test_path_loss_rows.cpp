#include <doctest/doctest.h>

#include <cmath>

#include "dcem/core/units.hpp"
#include "dcem/em/medium/path_loss.hpp"

namespace test_path_loss_rows {

using namespace dcem;

// How the rows were made (25 digits; any pocket calculator gives the first ten):
//   c = 299792458 m/s, FSPL(f, d) = 20·log10(4π·d·f/c) = FSPL(1 GHz, 1 m) + 20·log10 f_GHz + 20·log10 d.
//   FSPL(1 GHz, 1 m): 4π·1e9/c = 41.9169004304, log10 = 1.62238916100, · 20 = 32.4477832219 dB.
//   20·log10 f:  5.9 → 15.4170402328, 28 → 28.9431606268, 30 → 29.5424250944, 60 → 35.5630250077, 77 → 37.7298145034.

namespace {

struct FriisRow {
  double frequency_hz, length_m, loss_db;
};

struct CloseInRow {
  double frequency_hz, exponent, attenuation_db_per_m, length_m;
  double loss_db;
  double excess_amplitude;
};

}  // namespace

TEST_CASE("Friis by hand at 5.9, 28, 30, 60 and 77 GHz") {
  // 1 m: 32.4477832219 + 20·log10 f. Every factor of ten in length adds 20 dB; 257.3 m adds 20·log10 257.3
  // = 48.2087957245.
  const FriisRow rows[] = {
      {5.9e9, 1.0, 47.8648234547}, {5.9e9, 257.3, 96.0736191789}, {5.9e9, 1000.0, 107.8648234547},
      {28e9, 1.0, 61.3909438487},  {28e9, 257.3, 109.5997395730}, {28e9, 1000.0, 121.3909438487},
      {30e9, 1.0, 61.9902083163},  {30e9, 257.3, 110.1990040400}, {30e9, 1000.0, 121.9902083163},
      {60e9, 1.0, 68.0108082296},  {60e9, 257.3, 116.2196039540}, {60e9, 1000.0, 128.0108082296},
      {77e9, 1.0, 70.1775977253},  {77e9, 257.3, 118.3863934500}, {77e9, 1000.0, 130.1775977253},
  };
  for (const FriisRow& row : rows) {
    CAPTURE(row.frequency_hz);
    CAPTURE(row.length_m);
    // Printed to 1e-9 and better.
    CHECK(std::abs(free_space_path_loss_db(row.length_m, row.frequency_hz) - row.loss_db) <= 1e-9);
    CHECK(std::abs(close_in_path_loss_db(CloseIn{}, row.length_m, row.frequency_hz) - row.loss_db) <= 1e-9);
  }
}

TEST_CASE("close-in by hand: FSPL(1 m) + 10·n·log10 L + α·L, exponents as measured in streets, halls and factories") {
  // Exponents: NYUSIM as re-implemented for ns-3 (urban microcell 3.2 at 28 GHz and 2.9 at 140 GHz without line of
  // sight, factory 1.7 and 3.1, office 2.7) and Rappaport et al. 2014 (3.4 omnidirectional, 4.5 directional).
  const CloseInRow rows[] = {
      // 61.3909438487 + 32·2; the excess is 12·2 = 24 dB: 10^−1.2.
      {28e9, 3.2, 0.0, 100.0, 125.3909438487, 0.06309573444802},
      // 68.0108082296 + 20·2.30102999566 + 0.015·200 = 68.0108082296 + 46.0205999133 + 3; 10^−0.15.
      {60e9, 2.0, 0.015, 200.0, 117.0314081428, 0.7079457843841},
      // 32.4477832219 + 20·log10 140 = 75.3703439355; + 29·2.54406804435 = 73.7779732862; + 0.035.
      {140e9, 2.9, 0.0001, 350.0, 149.1833172216, 0.07135417349979},
      // Below free space: 61.3909438487 + 17·1.69897000434 = 61.3909438487 + 28.8824900737; excess −3·1.699 = −5.097
      // dB.
      {28e9, 1.7, 0.0, 50.0, 90.2734339224, 1.798231084396},
      // 61.9902083163 + 31·1.09691001301 = 61.9902083163 + 34.0042104032.
      {30e9, 3.1, 0.0, 12.5, 95.9944187195, 0.24928692059},
      // 70.1775977253 + 27·1.90308998699 + 0.02·80 = 70.1775977253 + 51.3834296488 + 1.6.
      {77e9, 2.7, 0.02, 80.0, 123.1610273741, 0.1794396876302},
      // 61.3909438487 + 34·2.17609125906 = 61.3909438487 + 73.9871028079.
      {28e9, 3.4, 0.0, 150.0, 135.3780466566, 0.02997340753653},
      // 61.3909438487 + 45·1.77815125038 = 61.3909438487 + 80.0168062673.
      {28e9, 4.5, 0.0, 60.0, 141.4077501160, 0.005988401866051},
  };
  for (const CloseInRow& row : rows) {
    CAPTURE(row.frequency_hz);
    CAPTURE(row.exponent);
    const CloseIn model{row.exponent, row.attenuation_db_per_m};
    CHECK(std::abs(close_in_path_loss_db(model, row.length_m, row.frequency_hz) - row.loss_db) <= 1e-9);
    CHECK(std::abs(model.excess_amplitude(row.length_m) / row.excess_amplitude - 1.0) <= 1e-12);
    CHECK(std::abs(AnyPathLoss{model}.excess_amplitude(row.length_m) / row.excess_amplitude - 1.0) <= 1e-12);
    // Field and decibels are one model: Friis times the square of the factor.
    const double from_field_db = free_space_path_loss_db(row.length_m, row.frequency_hz) -
                                 amplitude_ratio_to_db(model.excess_amplitude(row.length_m));
    CHECK(std::abs(from_field_db - row.loss_db) <= 1e-9);
  }
}

TEST_CASE("the line of sight of TR 37.885 on highways is Friis with its constant rounded to 32.4 dB") {
  // 3GPP TR 37.885, Table 6.2.1-1: 32.4 + 20·log10 d + 20·log10 f, d in m, f in GHz; Friis has 32.4478.
  for (const double frequency_ghz : {5.9, 30.0, 63.0})
    for (const double length_m : {10.0, 100.0, 500.0}) {
      const double table_db = 32.4 + 20.0 * std::log10(length_m) + 20.0 * std::log10(frequency_ghz);
      CHECK(std::abs(free_space_path_loss_db(length_m, frequency_ghz * 1e9) - table_db - 0.04778322) <= 1e-8);
    }
}

}  // namespace test_path_loss_rows
