#pragma once
/// The distribution of the power over the points of a grid or a list, for each transmitter and for the best server.
#include <optional>
#include <span>
#include <vector>

#include "dcem/channel/map_combination.hpp"
#include "dcem/io/line_chart.hpp"

namespace dcem::io {

/// Charts: how the incoherent power in dBm is distributed over the points that are neither obstructed nor sheltered, in
/// percent of them, with a line for each map and, where there are several, one for the best server. `time_s` goes into
/// the title where it is given. Where nothing arrives anywhere there is an empty chart that says so.
std::vector<LineChart> map_distribution_charts(std::span<const RadioMap> maps, const CombinedMap& combined,
                                               std::optional<double> time_s = {});

}  // namespace dcem::io
