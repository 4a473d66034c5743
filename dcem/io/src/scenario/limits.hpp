#pragma once
/// Limits that scenarios and the tables that they name have in common. Private to dcem::io.
#include <cstddef>

#include "dcem/io/src/text/text_input.hpp"

namespace dcem::io {

inline constexpr double farthest_coordinate_m = 1e9;
inline constexpr std::size_t longest_identifier_bytes = 200;
inline constexpr NumberRange any_instant_s{-1e9, 1e9};
inline constexpr NumberRange any_angle_deg{-1e6, 1e6};

}  // namespace dcem::io
