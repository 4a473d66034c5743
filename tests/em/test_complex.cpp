#include <doctest/doctest.h>

#include <limits>

#include "dcem/em/complex.hpp"

namespace test_complex {

using namespace dcem;

namespace {
// Rounding of one or two products of numbers of order one.
constexpr double rounding = 1e-15;
}  // namespace

TEST_CASE("exp(z) - 1 keeps its digits for small z and its value for large z") {
  // Taylor series: z + z²/2 + z³/6; the next term is 1e-32 of the first.
  const Complex small(-1e-8, 2e-8);
  const Complex series = small + small * small / 2.0 + small * small * small / 6.0;
  CHECK(std::abs(exp_minus_one(small) - series) <= rounding * std::abs(series));
  // e^(−1 + jπ/3) = e^−1 (1/2 + j√3/2).
  const Complex expected = std::exp(-1.0) * Complex(0.5, std::sqrt(3.0) / 2.0) - 1.0;
  CHECK(std::abs(exp_minus_one({-1.0, std::acos(-1.0) / 3.0}) - expected) <= rounding);
}

TEST_CASE("decayed exponentials are zero, never NaN") {
  const double huge = std::numeric_limits<double>::max();
  for (const double real : {-1000.0, -huge, -std::numeric_limits<double>::infinity()})
    for (const double imaginary : {0.0, -1e5, -huge, -std::numeric_limits<double>::infinity()}) {
      CHECK(decaying_exponential({real, imaginary}) == Complex(0.0));
      CHECK(std::abs(exp_minus_one({real, imaginary}) + 1.0) <= rounding);
    }
  CHECK(decaying_exponential({0.0, huge * 10.0}) == Complex(0.0));
  CHECK(decaying_exponential(0.0) == Complex(1.0));
}

TEST_CASE("a quotient times its divisor is the dividend, whichever part of the divisor is larger") {
  for (const double size : {1e-100, 1e-3, 1.0, 1e7, 1e100}) {
    for (const Complex& direction :
         {Complex(1, 0), Complex(0, 1), Complex(-3, 2), Complex(1e-9, -1), Complex(5, 1e-12)})
      for (const Complex& dividend : {Complex(1, 0), Complex(0, -2), Complex(0.3, 7), Complex(-4, 1e-15)}) {
        const Complex divisor = size * direction;
        // Smith's algorithm is off by a few roundings of the modulus.
        CHECK(std::abs(quotient(dividend, divisor) * divisor - dividend) <= 4.0 * rounding * std::abs(dividend));
      }
  }
  CHECK(quotient(Complex(1, 3), Complex(2, 0)) == Complex(0.5, 1.5));
  CHECK(quotient(Complex(1, 3), Complex(0, 2)) == Complex(1.5, -0.5));
}

TEST_CASE("a product of matrices acts as one after the other, and transposes in reverse order") {
  const ComplexMatrix2 a{{{{Complex(1, 2), Complex(0, -1)}, {Complex(3, 0), Complex(-2, 1)}}}};
  const ComplexMatrix2 b{{{{Complex(0, 1), Complex(4, 0)}, {Complex(-1, 1), Complex(2, 2)}}}};
  const ComplexVector2 v{Complex(1, -1), Complex(0, 2)};
  // Whole numbers: every operation is exact.
  CHECK((a * b) * v == a * (b * v));
  CHECK(transposed(a * b) == transposed(b) * transposed(a));
  CHECK((a * b)(0, 1) == Complex(6, 6));  // (1+2j)·4 + (−j)(2+2j), by hand
  CHECK(a + Complex(-1) * a == ComplexMatrix2{});
  CHECK(diagonal_matrix(1.0, 1.0) * a == a);
  CHECK(norm_squared(a) == 1 + 4 + 1 + 9 + 4 + 1);
}

TEST_CASE("a field along a direction has its whole amplitude there and none across") {
  const Vec3 direction(2.0 / 3.0, -1.0 / 3.0, 2.0 / 3.0);
  const Complex amplitude(0.3, -0.4);
  const ComplexVector3 field = scaled(direction, amplitude);
  CHECK(std::abs(dot(field, direction) - amplitude) <= rounding);
  CHECK(std::abs(dot(field, Vec3(1, 2, 0))) <= rounding);
  CHECK(std::abs(norm_squared(field) - 0.25) <= rounding);
  CHECK(field + Complex(-1) * field == field - field);
  CHECK(ComplexVector3(Vec3(1, 2, 3)) == ComplexVector3(1, 2, 3));
  CHECK(is_finite(Complex(1, 2)));
  CHECK_FALSE(is_finite(Complex(1, std::numeric_limits<double>::quiet_NaN())));
}

}  // namespace test_complex
