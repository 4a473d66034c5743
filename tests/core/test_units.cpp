#include <doctest/doctest.h>

#include <cmath>

#include "dcem/core/units.hpp"

namespace test_units {

using namespace dcem;

// Two or three roundings in log10 and pow, a few units in the last place each.
static doctest::Approx near(double value) {
  return doctest::Approx(value).epsilon(1e-14).scale(0.0);
}

TEST_CASE("a power ratio carries 10 log10, an amplitude ratio 20 log10") {
  CHECK(power_ratio_to_db(1000.0) == near(30.0));
  CHECK(power_ratio_to_db(0.5) == near(-3.010'299'956'639'812));
  CHECK(amplitude_ratio_to_db(1000.0) == near(60.0));
  CHECK(amplitude_ratio_to_db(0.8) == near(-1.938'200'260'161'1284));
  CHECK(db_to_power_ratio(3.0) == near(1.995'262'314'968'879'5));
  CHECK(db_to_amplitude_ratio(6.0) == near(1.995'262'314'968'879'5));
  CHECK(power_ratio_to_db(0.3 * 0.3) == near(amplitude_ratio_to_db(0.3)));
}

TEST_CASE("one milliwatt is 0 dBm, and the paper's 36.99 dBm are 5 W") {
  CHECK(watt_to_dbm(1e-3) == doctest::Approx(0.0).epsilon(1e-13));
  CHECK(watt_to_dbm(5.0) == near(36.989'700'043'360'19));
  CHECK(dbm_to_watt(30.0) == near(1.0));
  CHECK(dbm_to_watt(-30.0) == near(1e-6));
}

TEST_CASE("there and back is where it began") {
  for (double value = 1e-12; value < 1e12; value *= 7.3) {
    // The logarithm of 1e-12 has the size 120: its last place is 120·1.1e-16, times ln(10)/10.
    CHECK(db_to_power_ratio(power_ratio_to_db(value)) == doctest::Approx(value).epsilon(1e-13).scale(0.0));
    CHECK(db_to_amplitude_ratio(amplitude_ratio_to_db(value)) == doctest::Approx(value).epsilon(1e-13).scale(0.0));
    CHECK(dbm_to_watt(watt_to_dbm(value)) == doctest::Approx(value).epsilon(1e-13).scale(0.0));
    CHECK(radians_to_degrees(degrees_to_radians(value)) == near(value));
  }
}

TEST_CASE("half a turn is 180 degrees") {
  static_assert(degrees_to_radians(180.0) == pi);
  CHECK(degrees_to_radians(-90.0) == -pi / 2);
  CHECK(radians_to_degrees(pi / 6) == near(30.0));
}

}  // namespace test_units
