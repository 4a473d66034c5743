#pragma once
/// Checks of single values that callers pass in, with one wording for all of them.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <string_view>

namespace dcem::detail {

/// A number as messages have it: up to six digits.
inline std::string short_number(double value) {
  std::array<char, 32> text{};
  const int length = std::snprintf(text.data(), text.size(), "%g", value);
  return {text.data(), static_cast<std::size_t>(length)};
}

/// Throws std::invalid_argument "NAME is VALUE; expected LOW to HIGH UNIT" unless low ≤ value ≤ high. NaN is outside.
inline void require_within(std::string_view name, double value, double low, double high, std::string_view unit) {
  if (value >= low && value <= high) return;
  throw std::invalid_argument(std::string(name) + " is " + short_number(value) + "; expected " + short_number(low) +
                              " to " + short_number(high) + ' ' + std::string(unit));
}

/// Throws std::invalid_argument "NAME is not finite" for infinities and NaN.
inline void require_finite(std::string_view name, double value) {
  if (!std::isfinite(value)) throw std::invalid_argument(std::string(name) + " is not finite");
}

/// Throws std::invalid_argument "length_m is VALUE; expected a finite length of at least 0 m".
inline void require_length(double length_m) {
  if (length_m >= 0.0 && std::isfinite(length_m)) return;
  throw std::invalid_argument("length_m is " + short_number(length_m) + "; expected a finite length of at least 0 m");
}

}  // namespace dcem::detail
