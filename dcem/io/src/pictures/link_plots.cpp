#include "dcem/io/link_plots.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>

#include "dcem/core/random.hpp"
#include "dcem/core/units.hpp"
#include "dcem/io/src/text/number_text.hpp"
#include "dcem/io/text_table.hpp"
#include "dcem/paths/path_id.hpp"

namespace dcem::io {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t most_columns = 1000;
constexpr double most_range_db = 70.0;
constexpr std::int64_t most_rows = 280, least_rows = 20;

/// A millionth of a unit is nothing that a chart can show, but what is left of a difference would make an axis of
/// 1e-15.
double without_rounding(double value) {
  return std::abs(value) < 1e-6 ? 0.0 : value;
}

std::string bin_text(double bin_s) {
  std::string text = "bins of ";
  append_number(text, std::round(bin_s * 1e15) / 1e6);
  return text + " ns";
}

std::int64_t bin_number(const PdpTap& tap, double bin_s) {
  return std::llround(tap.delay_s / bin_s);
}

bool has_value(const LineChart::Series& series) {
  return std::any_of(series.y.begin(), series.y.end(), [](double y) { return !std::isnan(y); });
}

// Keeps the lines that have a value, and of no line at all the first: a chart needs one.
void drop_empty_lines(LineChart& chart, bool keep_first) {
  std::erase_if(chart.series, [&](const LineChart::Series& one) {
    return !has_value(one) && !(keep_first && &one == &chart.series.front());
  });
}

/// Vertical lines, which a chart draws as lines with gaps; from the top, so that dashes begin there.
/// `place` is where in its bin a bar stands, so that two of them can be told apart.
template <typename Power>
LineChart::Series bars(const char* name, std::span<const PdpTap> taps, double first_ns, double bin_ns, double floor_dbm,
                       Power&& level_dbm) {
  LineChart::Series series{name};
  for (const PdpTap& tap : taps) {
    const double level = level_dbm(tap);
    if (!(level > floor_dbm)) continue;
    for (const double value : {level, floor_dbm, nothing}) {
      series.x.push_back(1e9 * tap.delay_s + first_ns * bin_ns);
      series.y.push_back(value);
    }
  }
  return series;
}

}  // namespace

LineChart profile_chart(std::string title, std::span<const PdpTap> taps, double bin_s, double power_dbm) {
  if (!(bin_s > 0.0)) throw std::invalid_argument("profile_chart: expected bin_s > 0");
  const auto level_dbm = [&](double ratio) { return ratio > 0.0 ? power_dbm + power_ratio_to_db(ratio) : nothing; };
  double highest_dbm = -std::numeric_limits<double>::infinity();
  bool any_diffuse = false;
  for (const PdpTap& tap : taps) {
    if (tap.power_ratio > 0.0) highest_dbm = std::max(highest_dbm, level_dbm(tap.power_ratio));
    any_diffuse = any_diffuse || tap.diffuse_power_ratio > 0.0;
  }
  const double floor_dbm = std::isfinite(highest_dbm) ? 20.0 * std::floor((highest_dbm - 60.0) / 20.0) : 0.0;
  LineChart chart{std::move(title), "delay", "ns", "received power", "dBm"};
  const auto specular = [&](const PdpTap& tap) { return level_dbm(tap.power_ratio - tap.diffuse_power_ratio); };
  const auto diffuse = [&](const PdpTap& tap) { return level_dbm(tap.diffuse_power_ratio); };
  chart.series = {bars("specular paths", taps, any_diffuse ? 0.35 : 0.5, 1e9 * bin_s, floor_dbm, specular)};
  if (any_diffuse) chart.series.push_back(bars("diffuse", taps, 0.65, 1e9 * bin_s, floor_dbm, diffuse));
  return chart;
}

LinkPlots::LinkPlots(LinkNames names, double bin_s, PdpMode mode)
    : names_(std::move(names)), bin_s_(bin_s), mode_(mode) {
  if (!(bin_s > 0.0)) throw std::invalid_argument("LinkPlots: expected bin_s > 0");
}

void LinkPlots::add(const Scene& scene, double time_s, const LinkResult* link) {
  Figures figures;
  std::vector<std::string> ids;
  if (link != nullptr) {
    figures.statistics = link->statistics;
    figures.taps = power_delay_profile(link->paths, power_samples(link->diffuse), bin_s_, mode_);
    for (const PathContribution& path : link->paths) {
      ids.push_back(path_id(scene, path.path));
      if (!(path.power_ratio > 0.0)) continue;  // towards a null of a pattern
      const bool was_there = std::binary_search(ids_.begin(), ids_.end(), ids.back());
      figures.dots.push_back({hash_text(ids.back()), path.delay_s,
                              names_.power_dbm + power_ratio_to_db(path.power_ratio), was_there,
                              path.path.interactions.empty()});
    }
  }
  count_paths(std::move(ids), figures);
  times_s_.push_back(time_s);
  figures_.push_back(std::move(figures));
}

void LinkPlots::count_paths(std::vector<std::string>&& ids, Figures& figures) {
  std::sort(ids.begin(), ids.end());
  std::vector<std::string> kept;
  std::set_intersection(ids.begin(), ids.end(), ids_.begin(), ids_.end(), std::back_inserter(kept));
  if (!figures_.empty()) {
    figures.paths = PathCounts{static_cast<double>(kept.size()), static_cast<double>(ids.size() - kept.size()),
                               static_cast<double>(ids_.size() - kept.size())};
  }
  ids_ = std::move(ids);
}

std::string LinkPlots::title(const std::string& what) const {
  return with_note(names_.transmitter + " to " + names_.receiver + ": " + what);
}

template <typename Value>
LineChart::Series LinkPlots::series(const char* name, double scale, Value&& value) const {
  LineChart::Series line{name, times_s_};
  for (const Figures& one : figures_) {
    const std::optional<double> number = one.statistics ? value(*one.statistics) : std::nullopt;
    line.y.push_back(number ? without_rounding(scale * *number) : nothing);
  }
  return line;
}

LineChart LinkPlots::chart(const char* what, const char* label, const char* unit) const {
  return {title(what), "time", "s", label, unit};
}

LineChart LinkPlots::mechanism_chart() const {
  using Values = LinkStatistics;
  LineChart mechanisms = chart("power by mechanism (incoherent)", "received power", "dBm");
  mechanisms.series = {series("line of sight", 1.0, [](const Values& all) { return all.power_los_dbm; }),
                       series("reflected", 1.0, [](const Values& all) { return all.power_reflected_dbm; }),
                       series("transmitted", 1.0, [](const Values& all) { return all.power_transmitted_dbm; }),
                       series("diffracted", 1.0, [](const Values& all) { return all.power_diffracted_dbm; }),
                       series("diffuse", 1.0, [](const Values& all) { return all.power_diffuse_dbm; })};
  return mechanisms;
}

LineChart LinkPlots::count_chart() const {
  LineChart paths = chart("paths since the frame before, by id", "paths", "");
  paths.y_scale = ChartScale::linear_from_zero;
  const auto counted = [&](const char* name, double PathCounts::*count) {
    LineChart::Series line{name, times_s_};
    for (const Figures& one : figures_) line.y.push_back(one.paths ? (*one.paths).*count : nothing);
    return line;
  };
  paths.series = {counted("kept", &PathCounts::kept), counted("new", &PathCounts::born),
                  counted("gone", &PathCounts::gone)};
  return paths;
}

LineChart LinkPlots::power_chart() const {
  using Values = LinkStatistics;
  LineChart power = chart("received power", "received power", "dBm");
  power.series = {series("coherent", 1.0, [](const Values& all) { return all.power_dbm; }),
                  series("incoherent", 1.0, [](const Values& all) { return all.power_incoherent_dbm; })};
  return power;
}

LineChart LinkPlots::spread_chart() const {
  LineChart delay = chart("rms delay spread", "delay spread", "ns");
  delay.y_scale = ChartScale::linear_from_zero;
  delay.series = {series("rms delay spread", 1e9, [](const LinkStatistics& all) { return all.rms_delay_spread_s; })};
  return delay;
}

LineChart LinkPlots::doppler_chart() const {
  using Values = LinkStatistics;
  LineChart doppler = chart("Doppler shift, weighted by power", "frequency", "Hz");
  doppler.series = {series("mean", 1.0, [](const Values& all) { return all.mean_doppler_hz; }),
                    series("rms spread", 1.0, [](const Values& all) { return all.rms_doppler_spread_hz; })};
  return doppler;
}

std::vector<LineChart> LinkPlots::charts() const {
  LineChart k_factor = chart("K factor (line of sight over the rest)", "K factor", "dB");
  k_factor.series = {series("K factor", 1.0, [](const LinkStatistics& all) { return all.k_factor_db; })};
  std::vector<LineChart> charts{power_chart(), mechanism_chart(), spread_chart(),
                                k_factor,      doppler_chart(),   count_chart()};
  for (LineChart& one : charts) drop_empty_lines(one, &one == &charts.front());
  std::erase_if(charts, [](const LineChart& one) { return one.series.empty(); });
  return charts;
}

std::vector<LineChart> LinkPlots::panels() const {
  std::vector<LineChart> panels{power_chart(), spread_chart(), doppler_chart()};
  panels[0].title = "received power";
  panels[1].title = "rms delay spread";
  panels[2].title = "Doppler shift";
  return panels;
}

LineChart LinkPlots::profile_at(std::size_t frame) const {
  const std::string instant = "t = " + format_fixed(times_s_.at(frame), 3) + " s";
  return profile_chart(title("power delay profile at " + instant + ", " + bin_text(bin_s_)), figures_[frame].taps,
                       bin_s_, names_.power_dbm);
}

namespace {

/// A raster of `columns` × `rows` over time and bins of delay.
struct ProfileGrid {
  double first_s = 0.0, column_s = 1.0;
  std::size_t columns = 1;
  std::int64_t first_bin = 0, bins_per_row = 1, rows = 1;

  std::size_t column_of(double time_s) const {
    const auto column = static_cast<std::size_t>(std::max(0.0, std::round((time_s - first_s) / column_s)));
    return std::min(column, columns - 1);
  }
  std::size_t cell(double time_s, std::int64_t bin) const {
    return static_cast<std::size_t>((bin - first_bin) / bins_per_row) * columns + column_of(time_s);
  }
};

ProfileGrid profile_grid(const std::vector<double>& times_s, std::int64_t lowest, std::int64_t highest) {
  ProfileGrid grid;
  grid.columns = std::min(times_s.size(), most_columns);
  grid.first_s = times_s.front();
  const double intervals = static_cast<double>(std::max<std::size_t>(grid.columns, 2) - 1);
  const double length_s = times_s.back() - times_s.front();
  // A picture knows nothing narrower than this beside its origin.
  grid.column_s = std::max({length_s / intervals, 1e-6, 1e-11 * std::abs(grid.first_s)});
  grid.bins_per_row = (highest - lowest) / most_rows + 1;
  grid.rows = std::max((highest - lowest) / grid.bins_per_row + 1, least_rows);
  grid.first_bin = std::max<std::int64_t>(0, lowest - (grid.rows * grid.bins_per_row - (highest - lowest + 1)) / 2);
  return grid;
}

// Colours over what is there, at most over the range that taps may have, from and to multiples of 5 dB.
void choose_colours(HeatMap& map) {
  double top_dbm = -std::numeric_limits<double>::infinity(), low_dbm = std::numeric_limits<double>::infinity();
  for (const double value : map.values) {
    if (std::isnan(value)) continue;
    top_dbm = std::max(top_dbm, value);
    low_dbm = std::min(low_dbm, value);
  }
  const double high = 5.0 * std::ceil(top_dbm / 5.0);
  const double low = std::min(std::max(5.0 * std::floor(low_dbm / 5.0), high - most_range_db - 5.0), high - 10.0);
  map.range = ValueRange{low, high};
  map.no_value_label = "nothing, or " + format_fixed(most_range_db, 0) + " dB below the strongest";
}

/// The axes of the picture of a grid, without values.
HeatMap empty_picture(const ProfileGrid& grid, double bin_s) {
  HeatMap map;
  map.axes = {"time", "s", "delay", "ns", false};
  map.columns = grid.columns;
  map.rows = static_cast<std::size_t>(grid.rows);
  map.origin_x_m = grid.first_s;
  map.spacing_x_m = grid.column_s;
  const double bottom_ns = 1e9 * bin_s * static_cast<double>(grid.first_bin);
  map.spacing_y_m = std::max({1e9 * bin_s * static_cast<double>(grid.bins_per_row), 1e-6, 1e-11 * bottom_ns});
  map.origin_y_m = bottom_ns + 0.5 * map.spacing_y_m;
  return map;
}

}  // namespace

template <typename Visit>
void LinkPlots::each_strong_tap(Visit&& visit) const {
  double strongest = 0.0;
  for (const Figures& one : figures_) {
    for (const PdpTap& tap : one.taps) strongest = std::max(strongest, tap.power_ratio);
  }
  // Weaker taps would stretch the picture and drown the rest in the darkest colour.
  const double weakest = strongest * db_to_power_ratio(-most_range_db);
  for (std::size_t frame = 0; frame < figures_.size(); ++frame) {
    for (const PdpTap& tap : figures_[frame].taps) {
      if (tap.power_ratio > 0.0 && tap.power_ratio >= weakest) visit(times_s_[frame], tap);
    }
  }
}

std::optional<HeatMap> LinkPlots::profile() const {
  std::int64_t lowest = std::numeric_limits<std::int64_t>::max(), highest = -1;
  each_strong_tap([&](double, const PdpTap& tap) {
    lowest = std::min(lowest, bin_number(tap, bin_s_));
    highest = std::max(highest, bin_number(tap, bin_s_));
  });
  if (highest < lowest) return std::nullopt;
  const ProfileGrid grid = profile_grid(times_s_, lowest, highest);
  std::vector<double> power(grid.columns * static_cast<std::size_t>(grid.rows), 0.0), frames(grid.columns, 0.0);
  for (const double time_s : times_s_) frames[grid.column_of(time_s)] += 1.0;
  each_strong_tap(
      [&](double time_s, const PdpTap& tap) { power[grid.cell(time_s, bin_number(tap, bin_s_))] += tap.power_ratio; });
  HeatMap map = empty_picture(grid, bin_s_);
  map.title = title("power delay profile, " + bin_text(static_cast<double>(grid.bins_per_row) * bin_s_) +
                    (figures_.size() > grid.columns ? ", frames joined" : ""));
  for (std::size_t cell = 0; cell < power.size(); ++cell) {
    const bool holds = power[cell] > 0.0;
    const double mean = holds ? power[cell] / frames[cell % grid.columns] : 0.0;
    map.values.push_back(holds ? names_.power_dbm + power_ratio_to_db(mean) : nothing);
  }
  choose_colours(map);
  return map;
}

std::optional<ScatterChart> LinkPlots::taps() const {
  ScatterChart chart;
  chart.title = title("delays of the paths");
  chart.trace_label = "path id";
  for (std::size_t frame = 0; frame < figures_.size(); ++frame) {
    for (const Dot& dot : figures_[frame].dots) {
      chart.dots.push_back({times_s_[frame], 1e9 * dot.delay_s, dot.power_dbm, dot.id, dot.was_there, dot.is_direct});
      if (dot.is_direct) chart.marked_label = "line of sight";
    }
  }
  return chart.dots.empty() ? std::nullopt : std::optional(std::move(chart));
}

}  // namespace dcem::io
