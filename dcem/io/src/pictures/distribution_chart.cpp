#include "dcem/io/distribution_chart.hpp"

#include <algorithm>
#include <cmath>

#include "dcem/io/src/pictures/axis_ticks.hpp"

namespace dcem::io {
namespace {

constexpr double most_bins = 60.0;
constexpr std::size_t cumulated_slots = 400;

struct Bins {
  double low = 0.0, width = 1.0;
  std::size_t count = 1;

  double edge(std::size_t index) const { return low + static_cast<double>(index) * width; }
  std::size_t of(double value) const {
    const double place = std::floor((value - low) / width);
    return std::min(count - 1, static_cast<std::size_t>(std::max(0.0, place)));
  }
};

/// The values of a distribution, ascending, and how many members it has.
struct Sorted {
  std::string name;
  std::vector<double> values;
  double members = 0.0;
};

std::vector<Sorted> sorted_parts(std::span<const Distribution> parts) {
  std::vector<Sorted> sorted;
  for (const Distribution& part : parts) {
    Sorted one{part.name, {}, static_cast<double>(part.values.size() + part.without_value)};
    std::copy_if(part.values.begin(), part.values.end(), std::back_inserter(one.values),
                 [](double value) { return std::isfinite(value); });
    std::sort(one.values.begin(), one.values.end());
    if (!one.values.empty()) sorted.push_back(std::move(one));
  }
  return sorted;
}

Bins choose_bins(std::span<const Sorted> parts) {
  double low = parts.front().values.front(), high = parts.front().values.back();
  for (const Sorted& part : parts) {
    low = std::min(low, part.values.front());
    high = std::max(high, part.values.back());
  }
  // Values that differ by rounding alone are one bin of a width of their own size.
  const double least = 1e-9 * std::max(std::abs(low), std::abs(high));
  const double span = high - low > least ? high - low : std::max(1e-3 * std::abs(high), 1e-12);
  Bins bins;
  bins.width = detail::round_step_at_least(span / (most_bins - 1.0));
  bins.low = bins.width * std::floor(low / bins.width);
  bins.count = static_cast<std::size_t>(std::floor((high - bins.low) / bins.width)) + 1;
  return bins;
}

LineChart::Series histogram(const Sorted& part, const Bins& bins) {
  std::vector<std::size_t> counts(bins.count);
  for (const double value : part.values) ++counts[bins.of(value)];
  LineChart::Series line{part.name};
  const auto add = [&](std::size_t edge, double share_percent) {
    line.x.push_back(bins.edge(edge));
    line.y.push_back(share_percent);
  };
  add(0, 0.0);
  for (std::size_t bin = 0; bin < bins.count; ++bin) {
    const double share_percent = 100.0 * static_cast<double>(counts[bin]) / part.members;
    add(bin, share_percent);
    add(bin + 1, share_percent);
  }
  add(bins.count, 0.0);
  return line;
}

LineChart::Series cumulated(const Sorted& part, const Bins& bins) {
  LineChart::Series line{part.name};
  const double without_value = part.members - static_cast<double>(part.values.size());
  const double step = (bins.edge(bins.count) - bins.low) / static_cast<double>(cumulated_slots);
  for (std::size_t place = 0; place <= cumulated_slots; ++place) {
    const double x = bins.low + static_cast<double>(place) * step;
    const auto below = std::upper_bound(part.values.begin(), part.values.end(), x) - part.values.begin();
    line.x.push_back(x);
    line.y.push_back(100.0 * (without_value + static_cast<double>(below)) / part.members);
  }
  return line;
}

LineChart empty_chart(const DistributionLabels& labels, const std::string& title, const std::string& y_label) {
  LineChart chart;
  chart.title = title;
  chart.x_label = labels.label;
  chart.x_unit = labels.unit;
  chart.y_label = y_label;
  chart.y_unit = "%";
  chart.y_scale = ChartScale::linear_from_zero;
  return chart;
}

}  // namespace

std::vector<LineChart> distribution_charts(const DistributionLabels& labels, std::span<const Distribution> parts) {
  const std::vector<Sorted> sorted = sorted_parts(parts);
  std::vector<LineChart> charts;
  if (sorted.empty()) return charts;
  const Bins bins = choose_bins(sorted);
  for (std::size_t first = 0; first < sorted.size(); first += maximum_chart_series) {
    LineChart shares = empty_chart(labels, labels.title, "share of " + labels.members);
    LineChart sums = empty_chart(labels, labels.title + ", cumulated", "share up to x");
    for (std::size_t index = first; index < std::min(sorted.size(), first + maximum_chart_series); ++index) {
      shares.series.push_back(histogram(sorted[index], bins));
      sums.series.push_back(cumulated(sorted[index], bins));
    }
    charts.push_back(std::move(shares));
    charts.push_back(std::move(sums));
  }
  return charts;
}

}  // namespace dcem::io
