#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "dcem/em/medium/foliage.hpp"

namespace test_foliage {

using namespace dcem;

TEST_CASE("foliage: 0.79 dB/m at 1 GHz, and by hand at the frequencies of vehicles") {
  CHECK(foliage_attenuation_db_per_m(1e9) == 0.79);
  // 0.79 · e^{0.61 · ln f}: ln 5.9 = 1.7749524 → e^1.0827209 = 2.9527027; ln 30 = 3.4011974 → e^2.0747304 = 7.9623995;
  // ln 60 = 4.0943446 → e^2.4975502 = 12.1526856.
  CHECK(std::abs(foliage_attenuation_db_per_m(5.9e9) - 2.332635) <= 1e-6);
  CHECK(std::abs(foliage_attenuation_db_per_m(30e9) - 6.290296) <= 1e-6);
  CHECK(std::abs(foliage_attenuation_db_per_m(60e9) - 9.600622) <= 1e-6);
}

TEST_CASE("foliage: a decade of frequency is a factor 10^0.61 = 4.0738") {
  for (const double frequency_hz : {1e9, 3e9, 10e9})
    CHECK(std::abs(foliage_attenuation_db_per_m(10.0 * frequency_hz) / foliage_attenuation_db_per_m(frequency_hz) -
                   4.07380278) <= 1e-8);
}

TEST_CASE("foliage: the range is closed, and what is outside is refused") {
  CHECK_NOTHROW(foliage_attenuation_db_per_m(100e9));
  for (const double bad_hz : {0.999e9, 100.001e9, 0.0, -1e9, std::numeric_limits<double>::infinity(), std::nan("")})
    CHECK_THROWS_AS(foliage_attenuation_db_per_m(bad_hz), std::invalid_argument);
}

}  // namespace test_foliage
