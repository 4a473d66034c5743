/// Two maps of the same places, compared by hand.
#include "dcem/io/map_comparison.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <fstream>

#include "dcem/core/statistics.hpp"
#include "dcem/io/input_error.hpp"
#include "tests/io/temporary_folder.hpp"

namespace test_map_comparison {

using namespace dcem;

namespace {

io::MapColumn read(const test::TemporaryFolder& folder, const std::string& text, const std::string& column = "p_dbm") {
  std::ofstream(folder / "map.csv") << text;
  return io::read_map_column(folder / "map.csv", column);
}

std::string refusal(const std::string& text, const std::string& column = "p_dbm") {
  const test::TemporaryFolder folder;
  try {
    read(folder, text, column);
  } catch (const io::InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("maps are compared where both have a value, on linear power and in dB") {
  const test::TemporaryFolder folder;
  const auto first = read(folder, "x_m,y_m,p_dbm,kinds\n0,0,-60,\"a,b\"\n1,0,-70,\n2,0,,\n3,0,-80,\n5,0,,\n");
  // Rows in another order, another column first, places as another program would print them.
  const auto second =
      read(folder, "p_dbm,y_m,x_m\n-73.0102999566398,0,1.0000000001\n-60,0.0,0\n-90,0,2\n-80,0,4\n,0,5\n");
  const io::MapComparison comparison = io::compare_maps(first, second);
  CHECK(comparison.points == 2);
  CHECK(comparison.only_first == 1);
  CHECK(comparison.only_second == 2);
  CHECK(comparison.without_value == 1);
  REQUIRE(comparison.relative.size() == 2);
  CHECK(comparison.relative[0] == 0.0);
  CHECK(comparison.relative[1] == doctest::Approx(1.0).epsilon(1e-12));  // twice the power
  CHECK(comparison.difference_db[1] == doctest::Approx(3.0102999566398));
  CHECK(mean(comparison.relative) == doctest::Approx(0.5));
}

TEST_CASE("differences over a grid are a map of its cells, whatever the order of its places") {
  const test::TemporaryFolder folder;
  const auto first = read(folder, "x_m,y_m,p_dbm\n0,10,-60\n0.333333,10,-61\n0.666667,10,-62\n0,12,-63\n1,12,-65\n");
  const auto second = read(folder, "x_m,y_m,p_dbm\n1,12,-66\n0,12,-63.5\n0.666667,10,\n0.333333,10,-60\n0,10,-60\n");
  const auto map = io::difference_map(first, second, "two maps");
  REQUIRE(map.has_value());
  CHECK(map->columns == 4);
  CHECK(map->rows == 2);
  CHECK(map->origin_y_m == 10.0);
  CHECK(map->spacing_x_m == doctest::Approx(1.0 / 3.0).epsilon(1e-5));
  CHECK(map->spacing_y_m == 2.0);
  const std::vector<double> expected{0.0, -1.0, 1e9, 1e9, 0.5, 1e9, 1e9, 1.0};
  for (std::size_t cell = 0; cell < expected.size(); ++cell) {
    CAPTURE(cell);
    if (expected[cell] == 1e9)
      CHECK(std::isnan(map->values[cell]));
    else
      CHECK(map->values[cell] == expected[cell]);
  }
  CHECK(map->range->low == -map->range->high);
  CHECK(map->range->high == 1.0);
  const auto lower = read(folder, "x_m,y_m,p_dbm\n0,10,-63\n0.333333,10,-63.4\n0,12,-63.5\n1,12,-70\n");
  const auto one_sided = io::difference_map(lower, first, "what one lacks");
  REQUIRE(one_sided.has_value());
  CHECK(one_sided->range->low == -5.0);
  CHECK(one_sided->range->high == 0.0);
}

TEST_CASE("differences at scattered places, or along one line, are no map") {
  const test::TemporaryFolder folder;
  const auto scattered = read(folder, "x_m,y_m,p_dbm\n0,0,-60\n1.37,5.1,-61\n9.2,2.3,-62\n4.4,8.8,-62\n");
  CHECK_FALSE(io::difference_map(scattered, scattered, "").has_value());
  const auto line = read(folder, "x_m,y_m,p_dbm\n0,0,-60\n1,0,-61\n2,0,-62\n");
  CHECK_FALSE(io::difference_map(line, line, "").has_value());
  const auto far = read(folder, "x_m,y_m,p_dbm\n0,0,-60\n1,1,-61\n900000,900000,-62\n");
  CHECK_FALSE(io::difference_map(far, far, "").has_value());
}

TEST_CASE("a field of two quotes is an empty one, and a quote within quotes is doubled") {
  const test::TemporaryFolder folder;
  const auto map = read(folder, "x_m,y_m,p_dbm,kinds\n0,0,\"\",\"a \"\"b\"\", c\"\n\"1\",0,\"-70\",\"\"\n");
  REQUIRE(map.rows.size() == 2);
  CHECK(std::isnan(map.rows[0].value_db));
  CHECK(map.rows[1].x_m == 1.0);
  CHECK(map.rows[1].value_db == -70.0);
}

TEST_CASE("the charts of a comparison hold every place, however far apart the maps are") {
  const test::TemporaryFolder folder;
  const auto first = read(folder, "x_m,y_m,p_dbm\n0,0,-60\n1,0,40\n");
  const auto second = read(folder, "x_m,y_m,p_dbm\n0,0,-61\n1,0,-200\n");
  const auto charts = io::comparison_charts(io::compare_maps(first, second), "a & b");
  REQUIRE(charts.size() == 4);
  CHECK(charts[0].series.at(0).x.back() <= 2.5);  // 10^24 is shown as 2
  CHECK(charts[1].series.at(0).y.back() == 100.0);
  CHECK(charts[3].series.at(0).y.back() == 100.0);
  CHECK(charts[2].x_unit == "dB");
}

TEST_CASE("a file that cannot be compared is refused with its line") {
  CHECK(refusal("").find("is empty; expected") != std::string::npos);
  CHECK(
      refusal("x_m,y_m,pp_dbm\n0,0,1\n")
          .find(
              ":1: the column 'p_dbm' is missing; expected a header with x_m, y_m and p_dbm, where the nearest one is "
              "'pp_dbm'") != std::string::npos);
  CHECK(refusal("x_m,y_m,p_dbm,p_dbm\n").find("is there twice") != std::string::npos);
  CHECK(refusal("x_m,y_m,p_dbm\n0,0,1\n0,0\n").find(":3: 2 fields; expected 3") != std::string::npos);
  CHECK(refusal("x_m,y_m,p_dbm\n0,0,nan\n").find(":2: p_dbm: found 'nan'; expected") != std::string::npos);
  CHECK(refusal("x_m,y_m,p_dbm\n0,,1\n").find(":2: y_m: found ''; expected") != std::string::npos);
  CHECK(refusal("x_m,y_m,p_dbm\n0,0,1\n0.0,0,2\n").find(":3: a second row") != std::string::npos);
  CHECK(refusal("x_m,y_m,p\n", "p").find("; expected a power whose name ends with _dbm or _db") != std::string::npos);
}

}  // namespace test_map_comparison
