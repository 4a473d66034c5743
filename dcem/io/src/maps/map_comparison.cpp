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

/// Splits the rows of a file whose header names the columns.
class MapRows {
 public:
  MapRows(std::string file, std::string_view text, const std::string& column) : file_(std::move(file)), lines_(text) {
    if (!lines_.next()) throw InputError(file_, "is empty; expected a header with x_m, y_m and " + column);
    split();
    columns_ = fields_.size();
    const std::array<std::string, 3> wanted{"x_m", "y_m", column};
    for (std::size_t index = 0; index < wanted.size(); ++index) field_of_[index] = find(wanted[index]);
  }

  /// Moves to the next row that is not empty; false at the end.
  bool next() {
    do {
      if (!lines_.next()) return false;
    } while (trimmed(lines_.line()).empty());
    split();
    if (fields_.size() != columns_) {
      fail(std::to_string(fields_.size()) + " fields; expected " + std::to_string(columns_) + " as in the header");
    }
    return true;
  }

  MapColumn::Row row() const {
    const auto number = [&](std::size_t index, const NumberRange& range) {
      const std::string& text = fields_[field_of_[index]];
      const std::optional<double> value = parse_number(trimmed(text));
      if (!value || !range.holds(*value)) fail("found " + in_quotes(text) + "; expected " + range.text());
      return *value;
    };
    const NumberRange place_m{-farthest_place_m, farthest_place_m};
    const bool empty = trimmed(fields_[field_of_[2]]).empty();
    return {number(0, place_m), number(1, place_m),
            empty ? std::numeric_limits<double>::quiet_NaN() : number(2, {-largest_value_db, largest_value_db})};
  }

  [[noreturn]] void fail(const std::string& what) const { throw InputError(file_, lines_.number(), what); }

 private:
  std::size_t find(const std::string& column) const {
    const auto is_column = [&](const std::string& name) { return trimmed(name) == column; };
    const auto found = std::find_if(fields_.begin(), fields_.end(), is_column);
    if (found == fields_.end()) {
      fail("no column " + in_quotes(column) + "; expected it in the header, where the nearest one is " +
           in_quotes(nearest_name(column, fields_)));
    }
    if (std::find_if(found + 1, fields_.end(), is_column) != fields_.end()) {
      fail("column " + in_quotes(column) + " is there twice; expected it once");
    }
    return static_cast<std::size_t>(found - fields_.begin());
  }

  /// The fields of the line: RFC 4180, but for line ends in quotes.
  void split() {
    fields_.assign(1, "");
    bool quoted = false;
    const std::string_view line = lines_.line();
    for (std::size_t index = 0; index < line.size(); ++index) {
      const char character = line[index];
      if (quoted && character == '"' && index + 1 < line.size() && line[index + 1] == '"') {
        fields_.back().push_back(line[++index]);
      } else if (character == '"' && (quoted || fields_.back().empty())) {
        quoted = !quoted;
      } else if (character == ',' && !quoted) {
        fields_.emplace_back();
      } else {
        fields_.back().push_back(character);
      }
    }
    if (quoted) fail("a quote is not closed; expected quotes in pairs");
  }

  std::string file_;
  LineReader lines_;
  std::vector<std::string> fields_;
  std::size_t columns_ = 0;
  std::array<std::size_t, 3> field_of_{};
};

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
  MapRows rows(file.string(), text, column);
  MapColumn result{column, {}};
  std::map<Place, bool> seen;
  while (rows.next()) {
    const MapColumn::Row row = rows.row();
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
