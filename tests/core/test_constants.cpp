#include <doctest/doctest.h>

#include <cmath>

#include "dcem/core/constants.hpp"

namespace test_constants {

using namespace dcem;

TEST_CASE("the constants of the vacuum belong together") {
  CHECK(speed_of_light_mps == 299792458.0);  // the definition of the metre
  // μ0 = 1.256 637 062 12e-6 N/A² (CODATA 2018, a number the header does not hold). CODATA prints twelve digits.
  const double permeability_h_per_m = 1.256'637'062'12e-6;
  CHECK(1.0 / std::sqrt(permeability_h_per_m * vacuum_permittivity_f_per_m) ==
        doctest::Approx(speed_of_light_mps).epsilon(1e-10));
  CHECK(std::sqrt(permeability_h_per_m / vacuum_permittivity_f_per_m) ==
        doctest::Approx(free_space_impedance_ohm).epsilon(1e-10));
  CHECK(pi == std::acos(-1.0));
}

}  // namespace test_constants
