#pragma once
/// Complex values of the field: scalars, 2×2 transfer matrices and Cartesian field vectors.
/// Time dependence exp(+jωt), propagation exp(−jkr): a lag is a negative phase.
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>

#include "dcem/geometry/vector.hpp"

namespace dcem {

using Complex = std::complex<double>;

inline bool is_finite(const Complex& value) {
  return std::isfinite(value.real()) && std::isfinite(value.imag());
}

/// dividend/divisor by Smith's algorithm (Communications of the ACM 5(8), 1962, p. 435). A compiler's own division is a
/// call that guards against numbers near the ends of the range of double, too; here the larger part of the divisor is
/// to be between 1e-150 and 1e300, and no quotient beyond 1e150.
inline Complex quotient(const Complex& dividend, const Complex& divisor) {
  const double a = dividend.real(), b = dividend.imag(), c = divisor.real(), d = divisor.imag();
  if (std::abs(c) < std::abs(d)) {
    const double ratio = c / d, size = c * ratio + d;
    return {(a * ratio + b) / size, (b * ratio - a) / size};
  }
  const double ratio = d / c, size = d * ratio + c;
  return {(b * ratio + a) / size, (b - a * ratio) / size};
}

/// exp(jφ) for a phase in radians.
inline Complex unit_phasor(double phase_rad) {
  return {std::cos(phase_rad), std::sin(phase_rad)};
}

/// exp(z) for an exponent whose real part is ≤ 0. Where the phase exceeds the range of double the result is 0.
inline Complex decaying_exponential(const Complex& exponent) {
  if (!std::isfinite(exponent.imag())) return 0.0;
  return std::exp(exponent.real()) * unit_phasor(exponent.imag());
}

/// exp(z) − 1 without the loss of digits that the subtraction has near z = 0:
/// expm1(a+jb) = expm1(a)·cos b − 2 sin²(b/2) + j·exp(a)·sin b.
/// For exponents with a ≤ 0; where b exceeds the range of double the exponential is 0, as in decaying_exponential.
inline Complex exp_minus_one(const Complex& exponent) {
  const double a = exponent.real();
  const double b = exponent.imag();
  if (!std::isfinite(b)) return {-1.0, 0.0};
  const double half_sine = std::sin(0.5 * b);
  return {std::expm1(a) * std::cos(b) - 2.0 * half_sine * half_sine, std::exp(a) * std::sin(b)};
}

/// Two complex field components of one direction: index 0 is θ̂ (or TE, as stated by the user of the type), 1 is φ̂.
using ComplexVector2 = std::array<Complex, 2>;

/// A 2×2 complex matrix. As a transfer matrix the row is the receive component and the column the transmit component,
/// both in (θ̂, φ̂).
struct ComplexMatrix2 {
  std::array<std::array<Complex, 2>, 2> entries{};

  Complex& operator()(std::size_t row, std::size_t column) { return entries[row][column]; }
  const Complex& operator()(std::size_t row, std::size_t column) const { return entries[row][column]; }
  friend bool operator==(const ComplexMatrix2&, const ComplexMatrix2&) = default;
};

inline ComplexMatrix2 diagonal_matrix(const Complex& first, const Complex& second) {
  return {{{{first, 0.0}, {0.0, second}}}};
}

inline ComplexMatrix2 operator*(const ComplexMatrix2& left, const ComplexMatrix2& right) {
  ComplexMatrix2 product;
  for (std::size_t row = 0; row < 2; ++row)
    for (std::size_t column = 0; column < 2; ++column)
      product(row, column) = left(row, 0) * right(0, column) + left(row, 1) * right(1, column);
  return product;
}

inline ComplexVector2 operator*(const ComplexMatrix2& matrix, const ComplexVector2& vector) {
  return {matrix(0, 0) * vector[0] + matrix(0, 1) * vector[1], matrix(1, 0) * vector[0] + matrix(1, 1) * vector[1]};
}

inline ComplexMatrix2 operator*(const Complex& factor, const ComplexMatrix2& matrix) {
  return {{{{factor * matrix(0, 0), factor * matrix(0, 1)}, {factor * matrix(1, 0), factor * matrix(1, 1)}}}};
}

inline ComplexMatrix2 operator+(const ComplexMatrix2& left, const ComplexMatrix2& right) {
  return {
      {{{left(0, 0) + right(0, 0), left(0, 1) + right(0, 1)}, {left(1, 0) + right(1, 0), left(1, 1) + right(1, 1)}}}};
}

/// The transpose without conjugation: the transfer matrix of the reverse link.
inline ComplexMatrix2 transposed(const ComplexMatrix2& matrix) {
  return {{{{matrix(0, 0), matrix(1, 0)}, {matrix(0, 1), matrix(1, 1)}}}};
}

/// Sum of |entry|² over the four entries.
inline double norm_squared(const ComplexMatrix2& matrix) {
  return std::norm(matrix(0, 0)) + std::norm(matrix(0, 1)) + std::norm(matrix(1, 0)) + std::norm(matrix(1, 1));
}

/// A complex field vector in Cartesian coordinates.
struct ComplexVector3 {
  Complex x, y, z;

  ComplexVector3() = default;
  ComplexVector3(const Complex& x_value, const Complex& y_value, const Complex& z_value)
      : x(x_value), y(y_value), z(z_value) {}
  explicit ComplexVector3(const Vec3& real) : x(real.x), y(real.y), z(real.z) {}
  friend bool operator==(const ComplexVector3&, const ComplexVector3&) = default;
};

inline ComplexVector3 operator+(const ComplexVector3& left, const ComplexVector3& right) {
  return {left.x + right.x, left.y + right.y, left.z + right.z};
}

inline ComplexVector3 operator-(const ComplexVector3& left, const ComplexVector3& right) {
  return {left.x - right.x, left.y - right.y, left.z - right.z};
}

inline ComplexVector3 operator*(const Complex& factor, const ComplexVector3& vector) {
  return {factor * vector.x, factor * vector.y, factor * vector.z};
}

/// A complex amplitude along a real direction.
inline ComplexVector3 scaled(const Vec3& direction, const Complex& amplitude) {
  return {amplitude * direction.x, amplitude * direction.y, amplitude * direction.z};
}

/// Component of the field along a real direction (no conjugation).
inline Complex dot(const ComplexVector3& field, const Vec3& direction) {
  return field.x * direction.x + field.y * direction.y + field.z * direction.z;
}

/// |x|² + |y|² + |z|².
inline double norm_squared(const ComplexVector3& field) {
  return std::norm(field.x) + std::norm(field.y) + std::norm(field.z);
}

}  // namespace dcem
