#include "dcem/io/map_distribution.hpp"

#include <vector>

#include "dcem/io/distribution_chart.hpp"
#include "dcem/io/text_table.hpp"

namespace dcem::io {
namespace {

template <typename Points, typename Get>
Distribution distribution_of(const std::string& name, const Points& points, Get&& get) {
  Distribution distribution{name, {}, 0};
  for (const auto& point : points) {
    if (point.obstructed || point.sheltered) continue;
    const std::optional<double> power_dbm = get(point);
    power_dbm ? distribution.values.push_back(*power_dbm) : void(++distribution.without_value);
  }
  return distribution;
}

// A chart with one series of no values: axes, and the title that says why.
LineChart chart_of_nothing(const std::string& title) {
  LineChart chart;
  chart.title = title + ": nothing arrives";
  chart.x_label = "incoherent power";
  chart.x_unit = "dBm";
  chart.y_label = "share of points";
  chart.y_unit = "%";
  chart.series.push_back({"none"});
  return chart;
}

}  // namespace

std::vector<LineChart> map_distribution_charts(std::span<const RadioMap> maps, const CombinedMap& combined,
                                               std::optional<double> time_s) {
  std::vector<Distribution> parts;
  for (const RadioMap& map : maps) {
    parts.push_back(distribution_of(map.transmitter, map.points,
                                    [](const RadioMapPoint& point) { return point.statistics.power_incoherent_dbm; }));
  }
  if (maps.size() > 1) {
    parts.push_back(distribution_of("best server", combined.points,
                                    [](const CombinedMapPoint& point) { return point.power_incoherent_dbm; }));
  }
  std::string title = combined.places.id() + ": received power";
  if (time_s) title += ", t = " + format_fixed(*time_s, 3) + " s";
  std::vector<LineChart> charts = distribution_charts({title, "incoherent power", "dBm"}, parts);
  if (charts.empty()) charts.push_back(chart_of_nothing(title));
  return charts;
}

}  // namespace dcem::io
