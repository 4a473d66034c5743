#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "dcem/core/statistics.hpp"
#include "dcem/io/map_comparison.hpp"

namespace dcem::io {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
constexpr double least_filled = 0.02;  ///< of a grid: scattered places are no picture
constexpr std::size_t most_cells = 4'000'000;

using Micrometres = long long;

/// The places of a grid along one axis.
struct Ticks {
  Micrometres first = 0;
  double spacing = 0.0;  ///< such as a third of a metre, which no whole number of micrometres is
  std::size_t count = 0;

  double number(Micrometres place) const { return static_cast<double>(place - first) / spacing; }
  std::size_t nearest(Micrometres place) const { return static_cast<std::size_t>(std::llround(number(place))); }
};

/// Nothing where places are not whole numbers of the smallest distance apart, or where there is one alone.
std::optional<Ticks> ticks_of(const std::set<Micrometres>& places) {
  if (places.size() < 2) return std::nullopt;
  Micrometres smallest = std::numeric_limits<Micrometres>::max();
  for (auto place = std::next(places.begin()); place != places.end(); ++place) {
    smallest = std::min(smallest, *place - *std::prev(place));
  }
  const auto length = static_cast<double>(*places.rbegin() - *places.begin());
  const double steps = std::round(length / static_cast<double>(smallest));
  if (steps >= static_cast<double>(most_cells)) return std::nullopt;
  const Ticks ticks{*places.begin(), length / steps, static_cast<std::size_t>(steps) + 1};
  const auto is_off = [&](Micrometres place) {
    const double number = ticks.number(place);
    return std::abs(number - std::round(number)) * ticks.spacing > 2.0;  // each was rounded to a micrometre
  };
  return std::ranges::any_of(places, is_off) ? std::nullopt : std::optional(ticks);
}

/// 1, 2 or 5 times a power of ten, no less than a value.
double rounded_up(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= value) return factor * power;
  }
  return 10.0 * power;
}

/// As far to either side, so that what is higher and what is lower can be told apart; where next to nothing lies on one
/// side, up to zero.
ValueRange range_db(std::vector<double> values) {
  constexpr double least_db = 0.1, next_to_nothing = 0.02;
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  const double lower_db = std::max(0.0, -quantile(values, 0.01)), higher_db = std::max(0.0, quantile(values, 0.99));
  const double end_db = rounded_up(std::max({least_db, lower_db, higher_db}));
  return {lower_db <= next_to_nothing * higher_db && higher_db > 0.0 ? 0.0 : -end_db,
          higher_db <= next_to_nothing * lower_db && lower_db > 0.0 ? 0.0 : end_db};
}

}  // namespace

std::optional<HeatMap> difference_map(const MapColumn& first, const MapColumn& second, const std::string& title) {
  std::map<std::pair<Micrometres, Micrometres>, std::pair<double, double>> values_db;
  std::set<Micrometres> columns, rows;
  const auto take = [&](const MapColumn& map, double std::pair<double, double>::*side) {
    for (const MapColumn::Row& row : map.rows) {
      const std::pair place{std::llround(row.x_m * 1e6), std::llround(row.y_m * 1e6)};
      values_db.try_emplace(place, nothing, nothing).first->second.*side = row.value_db;
      columns.insert(place.first);
      rows.insert(place.second);
    }
  };
  take(first, &std::pair<double, double>::first);
  take(second, &std::pair<double, double>::second);
  const std::optional<Ticks> across = ticks_of(columns), along = ticks_of(rows);
  if (!across || !along || across->count * along->count > most_cells) return std::nullopt;
  const std::size_t cells = across->count * along->count;
  if (static_cast<double>(values_db.size()) < least_filled * static_cast<double>(cells)) return std::nullopt;

  HeatMap map;
  map.title = title;
  map.label = "a - b";
  map.unit = "dB";
  map.no_value_label = "no value in both";
  map.origin_x_m = 1e-6 * static_cast<double>(across->first);
  map.origin_y_m = 1e-6 * static_cast<double>(along->first);
  map.spacing_x_m = 1e-6 * across->spacing;
  map.spacing_y_m = 1e-6 * along->spacing;
  map.columns = across->count;
  map.rows = along->count;
  map.values.assign(cells, nothing);
  for (const auto& [place, both_db] : values_db) {
    map.values[along->nearest(place.second) * across->count + across->nearest(place.first)] =
        both_db.first - both_db.second;
  }
  if (std::ranges::none_of(map.values, [](double value) { return std::isfinite(value); })) return std::nullopt;
  map.range = range_db(map.values);
  return map;
}

}  // namespace dcem::io
