#include "dcem/io/map_comparison.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "dcem/core/units.hpp"
#include "dcem/io/distribution_chart.hpp"
#include "dcem/io/input_error.hpp"
#include "dcem/io/src/text/csv_reader.hpp"
#include "dcem/io/src/text/text_input.hpp"

namespace dcem::io {
namespace {

constexpr double farthest_place_m = 1e9;
constexpr double largest_value_db = 1e6;
constexpr double most_relative_shown = 2.0;

using Place = std::pair<long long, long long>;  // micrometres

Place place_of(const MapColumn::Row& row) {
  return {std::llround(row.x_m * 1e6), std::llround(row.y_m * 1e6)};
}

enum ReadColumn : std::size_t { x_column, y_column, value_column };

MapColumn::Row read_row(const CsvReader& row) {
  const NumberRange place_m{-farthest_place_m, farthest_place_m};
  const double value_db = row.text(value_column).empty()
                              ? std::numeric_limits<double>::quiet_NaN()
                              : row.number(value_column, {-largest_value_db, largest_value_db});
  return {row.number(x_column, place_m), row.number(y_column, place_m), value_db};
}

std::map<Place, double> values_by_place(const MapColumn& column) {
  std::map<Place, double> values;
  for (const MapColumn::Row& row : column.rows) values.emplace(place_of(row), row.value_db);
  return values;
}

}  // namespace

MapColumn read_map_column(const std::filesystem::path& file, const std::string& column) {
  if (!column.ends_with("_dbm") && !column.ends_with("_db")) {
    throw InputError(file.string(),
                     "column " + in_quotes(column) + "; expected a power whose name ends with _dbm or _db");
  }
  const std::string text = read_text_file(file, "expected a table with x_m, y_m and " + column);
  CsvReader rows(file.string(), text, {{"x_m"}, {"y_m"}, {column}}, "a header with x_m, y_m and " + column,
                 CsvReader::OtherColumns::ignored, CsvReader::EmptyLines::anywhere);
  MapColumn result{column, {}};
  std::map<Place, bool> seen;
  while (rows.next()) {
    const MapColumn::Row row = read_row(rows);
    if (!seen.emplace(place_of(row), true).second) rows.fail("a second row at this place; expected one row per place");
    result.rows.push_back(row);
  }
  return result;
}

MapComparison compare_maps(const MapColumn& first, const MapColumn& second) {
  const std::map<Place, double> first_db = values_by_place(first);
  std::map<Place, double> second_db = values_by_place(second);
  MapComparison result;
  const auto count = [&](double a_db, double b_db) {
    const bool has_a = std::isfinite(a_db), has_b = std::isfinite(b_db);
    if (has_a && has_b) {
      ++result.points;
      result.difference_db.push_back(a_db - b_db);
      result.relative.push_back(std::abs(db_to_power_ratio(a_db - b_db) - 1.0));
    } else {
      ++(has_a ? result.only_first : has_b ? result.only_second : result.without_value);
    }
  };
  const double absent_db = std::numeric_limits<double>::quiet_NaN();
  for (const auto& [place, value_db] : first_db) {
    const auto other = second_db.find(place);
    count(value_db, other == second_db.end() ? absent_db : other->second);
    if (other != second_db.end()) second_db.erase(other);
  }
  for (const auto& [place, value_db] : second_db) count(absent_db, value_db);
  std::sort(result.relative.begin(), result.relative.end());
  std::sort(result.difference_db.begin(), result.difference_db.end());
  return result;
}

std::vector<LineChart> comparison_charts(const MapComparison& comparison, const std::string& title) {
  Distribution relative{"|a - b|/|b|", comparison.relative, 0};
  for (double& value : relative.values) value = std::min(value, most_relative_shown);
  const Distribution difference{"a - b", comparison.difference_db, 0};
  std::vector<LineChart> charts = distribution_charts(
      {title + ": linear power", "|a - b|/|b|, 2 stands for 2 and more", ""}, std::span(&relative, 1));
  for (LineChart& chart : distribution_charts({title + ": difference", "a - b", "dB"}, std::span(&difference, 1))) {
    charts.push_back(std::move(chart));
  }
  return charts;
}

}  // namespace dcem::io
