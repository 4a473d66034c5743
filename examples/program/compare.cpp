/// `dcem compare`: how far two maps of the same places are apart.
#include <cmath>
#include <filesystem>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "dcem/core/statistics.hpp"
#include "dcem/io/atomic_file.hpp"
#include "dcem/io/input_error.hpp"
#include "dcem/io/line_chart.hpp"
#include "dcem/io/map_comparison.hpp"
#include "dcem/io/text_table.hpp"
#include "options.hpp"

namespace dcem::program {
namespace {

void add_row(io::TextTable& table, const std::string& name, const std::vector<double>& values) {
  table.add_row({name, io::format_fixed(mean(values), 4), io::format_fixed(median(values), 4),
                 io::format_fixed(quantile(values, 0.95), 4), io::format_fixed(quantile(values, 1.0), 4)});
}

void print(const io::MapComparison& comparison) {
  std::cout << comparison.points << " places with two values; " << comparison.only_first << " in the first file alone, "
            << comparison.only_second << " in the second alone, " << comparison.without_value << " without any\n";
  using Align = io::TextTable::Align;
  io::TextTable table({{"", Align::left}, {"mean"}, {"median"}, {"95 %"}, {"highest"}});
  std::vector<double> size_db = comparison.difference_db;
  for (double& value_db : size_db) value_db = std::abs(value_db);
  add_row(table, "|a - b|/|b|, linear power", comparison.relative);
  add_row(table, "a - b / dB", comparison.difference_db);
  add_row(table, "|a - b| / dB", size_db);
  std::cout << table.str();
}

/// Where the places are those of a grid: the differences as a map.
void draw_map(const std::optional<io::HeatMap>& map, const CompareOptions& options, io::OutputFolder& folder) {
  if (!map) return;
  for (const std::string& word : options.formats) {
    io::write_heat_map(*map, folder.open("difference." + word), io::picture_format(word).value());
  }
}

/// The chart in each format. A build that draws none says so, and the table alone is what there is.
void draw(const io::MapComparison& comparison, const std::string& title, const CompareOptions& options,
          io::OutputFolder& folder) {
  if (!io::can_draw()) {
    std::cerr << "warning: " << io::no_drawing << "; expected " << io::drawing_expected << '\n';
    return;
  }
  const std::vector<io::LineChart> charts = io::comparison_charts(comparison, title);
  for (const std::string& word : options.formats) {
    io::write_line_charts(charts, folder.open("comparison." + word), io::picture_format(word).value());
  }
}

/// The names of both files; where they are the same, as of two runs, with their folders.
std::string title_of(const std::filesystem::path& first, const std::filesystem::path& second) {
  const bool differ = first.filename() != second.filename();
  const auto name = [&](const std::filesystem::path& file) {
    return differ ? file.filename().string() : (file.parent_path().filename() / file.filename()).string();
  };
  return name(first) + " against " + name(second);
}

}  // namespace

void compare_maps(const CompareOptions& options) {
  const std::string second_column = options.second_column.empty() ? options.column : options.second_column;
  const io::MapColumn first = io::read_map_column(options.first, options.column);
  const io::MapColumn second = io::read_map_column(options.second, second_column);
  const io::MapComparison comparison = io::compare_maps(first, second);
  if (comparison.points == 0) {
    throw io::InputError(options.second,
                         "no place has a value here and in " + options.first + "; expected maps of the same places");
  }
  io::OutputFolder folder(options.folder.empty() ? "out/compare" : options.folder);
  const std::string title = title_of(options.first, options.second);
  draw(comparison, title, options, folder);
  if (io::can_draw()) draw_map(io::difference_map(first, second, title), options, folder);
  std::vector<std::string> former;  // the map of a comparison before, where this one has none
  for (const std::string& word : options.formats) former.push_back("difference." + word);
  folder.commit(former);
  print(comparison);
}

}  // namespace dcem::program
