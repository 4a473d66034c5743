#pragma once
/// The table of tests/reference/em_reference.py: half spaces and slabs in 50 digits.
#include <array>
#include <vector>

#include "dcem/em/surface/fresnel.hpp"

namespace dcem::test {

struct EmReferenceRow {
  double relative_permittivity, conductivity_s_per_m, frequency_hz, thickness_m, cos_incidence;
  Complex half_space_te, half_space_tm;
  Complex slab_te, slab_tm, insertion_te, insertion_tm;

  Complex permittivity() const {
    return complex_permittivity(relative_permittivity, conductivity_s_per_m, frequency_hz);
  }
  double thickness_rad() const { return wave_number_rad_per_m(frequency_hz) * thickness_m; }
};

inline const std::vector<EmReferenceRow>& em_reference_rows() {
  static const std::vector<EmReferenceRow> rows{
#include "tests/reference/em_reference.inc"
  };
  return rows;
}

/// |got − expected|, relative to |expected|; absolute where 0 is expected.
inline double relative_difference(const Complex& got, const Complex& expected) {
  const double size = std::abs(expected);
  return std::abs(got - expected) / (size > 0.0 ? size : 1.0);
}

}  // namespace dcem::test
