#pragma once
/// Two maps of the same places, such as a computed and a measured one, or an exact and a sampled run.
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "dcem/io/heat_map.hpp"
#include "dcem/io/line_chart.hpp"

namespace dcem::io {

/// The values of one CSV file at points.
struct MapColumn {
  struct Row {
    double x_m = 0.0, y_m = 0.0;
    double value_db = 0.0;  ///< NaN: empty
  };
  std::string name;  ///< of the column
  std::vector<Row> rows;
};

/// Reads `x_m`, `y_m` and `column` (its name ends with `_dbm` or `_db`) from any CSV file with a header; other columns
/// are passed over. Throws InputError with the line: a column that is missing or there twice, a field that is no
/// number, rows of different lengths, two rows of one place.
MapColumn read_map_column(const std::filesystem::path& file, const std::string& column);

/// Where the two files have a value each, and how far these are apart.
struct MapComparison {
  std::size_t points = 0;             ///< places with a value in both
  std::size_t only_first = 0;         ///< places with a value in the first file alone
  std::size_t only_second = 0;        ///< places with a value in the second file alone
  std::size_t without_value = 0;      ///< places of either file that have a value in none
  std::vector<double> relative;       ///< |a − b|/|b| of the linear powers, b of the second file; ascending
  std::vector<double> difference_db;  ///< a − b in dB, ascending
};

/// Places are rounded to whole micrometres and then compared. Without a place that has two values both lists are empty.
MapComparison compare_maps(const MapColumn& first, const MapColumn& second);

/// Charts for `write_line_charts`: the distribution of |a − b|/|b|, whose last bin holds everything above 2, and that
/// of a − b in dB. Precondition: at least one place has two values.
std::vector<LineChart> comparison_charts(const MapComparison& comparison, const std::string& title);

/// A picture of a − b in dB where the places are those of a regular grid, up to four million cells of which one in
/// fifty is there; nothing otherwise, and where no place has two values.
std::optional<HeatMap> difference_map(const MapColumn& first, const MapColumn& second, const std::string& title);

}  // namespace dcem::io
