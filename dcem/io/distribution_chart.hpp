#pragma once
/// How values spread: a histogram above, the cumulated shares below.
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "dcem/io/line_chart.hpp"

namespace dcem::io {

/// Values of one kind, as of the points of one map.
struct Distribution {
  std::string name;
  std::vector<double> values;     ///< in any order; not finite: no value
  std::size_t without_value = 0;  ///< further members that have no value, such as points where nothing arrives
};

/// What the values are.
struct DistributionLabels {
  std::string title;
  std::string label;  ///< of the values
  std::string unit;   ///< of the values
  std::string members = "points";
};

/// Pairs of charts for `write_line_charts`: the histogram as steps, in at most 60 bins whose width is 1, 2 or 5 · 10^n,
/// and the share of members whose value is at most x, both in percent of all members. Members without a value count as
/// lower than any: then the cumulated share begins above zero, and the bins sum to less than 100 %. All pairs have the
/// same bins; a pair shows up to `maximum_chart_series` distributions. A distribution without values has no line, and
/// without any distribution with values there is no chart.
std::vector<LineChart> distribution_charts(const DistributionLabels& labels, std::span<const Distribution> parts);

}  // namespace dcem::io
