#include "dcem/io/src/scenario/points_csv.hpp"

#include <string>

#include "dcem/io/src/scenario/scenario_parts.hpp"
#include "dcem/io/src/text/csv_reader.hpp"
#include "dcem/io/src/text/text_input.hpp"

namespace dcem::io {

std::vector<Vec3> read_points_csv(const std::filesystem::path& file) {
  constexpr NumberRange coordinate_m{-farthest_coordinate_m, farthest_coordinate_m};
  const std::string text = read_text_file(file, "expected a table of points");
  CsvReader row(file.string(), text, {{"x_m"}, {"y_m"}, {"z_m"}}, "a header x_m,y_m,z_m",
                CsvReader::OtherColumns::ignored, CsvReader::EmptyLines::at_the_end);
  std::vector<Vec3> points_m;
  while (row.next()) {
    points_m.emplace_back(row.number(0, coordinate_m), row.number(1, coordinate_m), row.number(2, coordinate_m));
  }
  if (points_m.empty()) row.fail("no point; expected at least one row");
  return points_m;
}

}  // namespace dcem::io
