#pragma once
/// Lines of equal value. Private to dcem::io.
#include <array>
#include <vector>

#include "dcem/io/heat_map.hpp"

namespace dcem::io::detail {

/// A line along which the value is `level`, in the axes' units. A closed one ends where it begins.
struct ContourLine {
  double level = 0.0;
  std::vector<std::array<double, 2>> points{};
};

/// The lines at multiples of `step` within the range, level by level. Every point lies between two neighbouring grid
/// points, where the value, linear from one to the other, is the level (marching squares; where a square has two ways
/// to be cut, the mean of its corners decides). A square with a corner without a value has no line.
std::vector<ContourLine> contour_lines(const HeatMap& map, const ValueRange& range, double step);

}  // namespace dcem::io::detail
