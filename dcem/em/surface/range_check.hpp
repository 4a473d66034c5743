#pragma once
/// Checks of single values that callers pass in, with one wording for all of them.
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>

namespace dcem::detail {

/// Throws std::invalid_argument "NAME is VALUE; expected LOW to HIGH UNIT" unless low ≤ value ≤ high. NaN is outside.
inline void require_within(std::string_view name, double value, double low, double high, std::string_view unit) {
  if (value >= low && value <= high) return;
  std::ostringstream message;
  message << name << " is " << value << "; expected " << low << " to " << high << ' ' << unit;
  throw std::invalid_argument(message.str());
}

/// Throws std::invalid_argument "NAME is not finite" for infinities and NaN.
inline void require_finite(std::string_view name, double value) {
  if (!std::isfinite(value)) throw std::invalid_argument(std::string(name) + " is not finite");
}

/// Throws std::invalid_argument "length_m is VALUE; expected a finite length of at least 0 m".
inline void require_length(double length_m) {
  if (length_m >= 0.0 && std::isfinite(length_m)) return;
  std::ostringstream message;
  message << "length_m is " << length_m << "; expected a finite length of at least 0 m";
  throw std::invalid_argument(message.str());
}

}  // namespace dcem::detail
