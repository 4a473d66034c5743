#pragma once
/// Arrays of equal antennas: linear and planar, evenly spaced.
///
/// The elements stand in the local y-z plane, columns along local y and rows along local z, centred on the antenna's
/// point. Elements are numbered row by row: element = row·columns + column. Row 0 is the lowest (smallest z); column 0
/// has the smallest y, which is on the right of who looks along the boresight +x.
#include <cmath>
#include <cstddef>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "dcem/core/constants.hpp"
#include "dcem/core/error.hpp"
#include "dcem/em/complex.hpp"
#include "dcem/geometry/vector.hpp"

namespace dcem {

struct AntennaArray {
  std::size_t rows = 1;
  std::size_t columns = 1;
  double spacing_wavelengths = 0.5;  ///< between neighbours, along rows and columns alike

  std::size_t size() const { return rows * columns; }
  bool is_single() const { return size() == 1; }

  friend bool operator==(const AntennaArray&, const AntennaArray&) = default;
};

/// More elements than this are an error.
inline constexpr std::size_t most_array_elements = 4096;

/// Where an element stands from the centre, in wavelengths, in the antenna's axes. `element` < size().
Vec3 element_offset_wavelengths(const AntennaArray& array, std::size_t element);

/// Where an element stands from the centre, in metres, in the antenna's axes.
inline Vec3 element_offset_m(const AntennaArray& array, std::size_t element, double wavelength_m) {
  return wavelength_m * element_offset_wavelengths(array, element);
}

/// What the place of an element does to a plane wave, against the same element at the centre: exp(+jk·r·d).
///
/// An end that is displaced by r along the outgoing unit direction d of a path shortens the path by r·d, so that
/// exp(−jk(L − r·d)) = exp(−jkL)·exp(+jk·r·d): the same at both ends, because d points out of either. r is the offset
/// of the element, d the direction in the antenna's axes. A wave of curvature 1/L has a phase that differs by at most
/// k·|r|²·sin²(r, d)/2L, and terms of higher order in r/L.
Complex element_phasor(const AntennaArray& array, std::size_t element, const Vec3& local_direction);

/// The phasors of all elements, in their order.
std::vector<Complex> element_phasors(const AntennaArray& array, const Vec3& local_direction);

/// Field of the array towards a direction over that of one element: Σ w_e·exp(+jk·r_e·d). One weight per element, else
/// std::invalid_argument. For N equal weights of 1 along a line |array factor| = |sin(N·x)/sin(x)|, x = π·s·cos γ, with
/// the spacing s in wavelengths and γ the angle to the line.
Complex array_factor(const AntennaArray& array, std::span<const Complex> weights, const Vec3& local_direction);

/// Throws std::invalid_argument for no element, more than `most_array_elements` and spacings that are not above 0 and
/// at most 1000 wavelengths.
void validate(const AntennaArray& array);

// ---------------------------------------------------------------------------------------------------------------------

inline Vec3 element_offset_wavelengths(const AntennaArray& array, std::size_t element) {
  DCEM_ASSERT(element < array.size());
  const auto from_centre = [](std::size_t index, std::size_t count) {
    return static_cast<double>(index) - 0.5 * static_cast<double>(count - 1);
  };
  return array.spacing_wavelengths * Vec3(0.0, from_centre(element % array.columns, array.columns),
                                          from_centre(element / array.columns, array.rows));
}

inline Complex element_phasor(const AntennaArray& array, std::size_t element, const Vec3& local_direction) {
  const double cycles = glm::dot(element_offset_wavelengths(array, element), local_direction);
  return unit_phasor(2.0 * pi * (cycles - std::round(cycles)));
}

inline std::vector<Complex> element_phasors(const AntennaArray& array, const Vec3& local_direction) {
  std::vector<Complex> phasors;
  phasors.reserve(array.size());
  for (std::size_t element = 0; element < array.size(); ++element) {
    phasors.push_back(element_phasor(array, element, local_direction));
  }
  return phasors;
}

inline Complex array_factor(const AntennaArray& array, std::span<const Complex> weights, const Vec3& local_direction) {
  if (weights.size() != array.size()) throw std::invalid_argument("array factor: expected one weight per element");
  Complex sum{};
  for (std::size_t element = 0; element < array.size(); ++element) {
    sum += weights[element] * element_phasor(array, element, local_direction);
  }
  return sum;
}

inline void validate(const AntennaArray& array) {
  const bool has_elements = array.rows >= 1 && array.columns >= 1;
  if (!has_elements || array.rows > most_array_elements / array.columns) {
    throw std::invalid_argument("antenna array: expected 1 to " + std::to_string(most_array_elements) + " elements");
  }
  if (!(array.spacing_wavelengths > 0.0 && array.spacing_wavelengths <= 1000.0)) {
    throw std::invalid_argument("antenna array: expected a spacing above 0, at most 1000 wavelengths");
  }
}

}  // namespace dcem
