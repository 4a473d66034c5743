/// What a user asks of the pictures of maps: formats, colours, lines, finer cells; through the program.
#include <doctest/doctest.h>

#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "dcem/io/heat_map.hpp"
#include "dcem/io/src/pictures/colour_map.hpp"
#include "tests/io/drawing_needed.hpp"
#include "tests/io/picture_checks.hpp"
#include "tests/io/png_reader.hpp"
#include "tests/io/program_case.hpp"

namespace test_map_pictures {

using namespace dcem::test;
using dcem::io::can_draw;

namespace {

using Names = std::vector<std::string>;

/// Two transmitters, one of them weaker and in a hurry, so that each map alone would have colours of its own.
void write_two(const TemporaryFolder& folder, const std::string& map) {
  write_scene(folder);
  std::string text = scenario(grid_receiver + "," + moving_receiver);
  const std::string list = R"("transmitters":[)", paths = R"("output":{"paths":true,)";
  text.replace(text.find(list), list.size(),
               list + R"({"id":"weak","position_m":[30,-2,3],"velocity_mps":[400,0,0],"power_dbm":-17},)");
  text.replace(text.find(paths), paths.size(), R"("output":{"map":)" + map + ",");
  write(folder / "street.json", text);
}

Names names_in(const std::filesystem::path& folder) {
  Names names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

/// Incoherent powers of a map's table, in its order; NaN where there is none.
std::vector<double> powers_dbm(const std::filesystem::path& csv) {
  std::vector<double> powers;
  std::istringstream lines(file_bytes(csv));
  std::string line, field;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    std::istringstream fields(line);
    for (int column = 0; column < 5; ++column) std::getline(fields, field, ',');
    powers.push_back(field.empty() ? std::nan("") : std::stod(field));
  }
  return powers;
}

/// Points whose cell in the PNG has another colour than its value in the CSV says, with the ends of the colours given;
/// points without a value are left out, and so are those under a wall or a symbol.
int wrong_cells(const std::filesystem::path& map, const dcem::io::ValueRange& range) {
  dcem::io::HeatMap grid;
  grid.origin_x_m = -5.0;
  grid.origin_y_m = -12.0;
  grid.spacing_x_m = grid.spacing_y_m = 2.0;
  grid.columns = 3;
  grid.rows = 13;
  grid.values.assign(39, 0.0);
  const dcem::io::HeatMapLayout layout = dcem::io::heat_map_layout(grid);
  const Png png = read_png(map.string() + ".png");
  const std::vector<double> powers = powers_dbm(map.string() + ".csv");
  int wrong = 0;
  for (std::size_t point = 0; point < powers.size(); ++point) {
    if (std::isnan(powers[point])) continue;
    const double share = (powers[point] - range.low) / (range.high - range.low);
    const auto place = layout.point(-5.0 + 2.0 * double(point % 3) + 0.5, -12.0 + 2.0 * double(point / 3) + 0.5);
    wrong += png.at(int(place.x), int(place.y)) == dcem::io::viridis(share) ? 0 : 1;
  }
  return wrong;
}

}  // namespace

TEST_CASE("all maps of a run have the colours of its first frame with a value") {
  DCEM_NEEDS_PROGRAM();
  DCEM_NEEDS_DRAWING();
  const TemporaryFolder folder;
  write_two(folder, R"(["csv","png"])");
  REQUIRE(dcem_program(folder, "map street.json --frames 1:3 --quiet -o m").exit_code == 0);
  const auto range_of = [&](const std::vector<std::string>& maps) {
    std::vector<double> values;
    for (const std::string& map : maps) {
      for (const double power_dbm : powers_dbm(folder / "m" / (map + ".csv"))) {
        if (!std::isnan(power_dbm)) values.push_back(power_dbm);
      }
    }
    return dcem::io::value_range(values, "dBm").value();
  };
  const dcem::io::ValueRange range = range_of({"map_area_weak_1", "map_area_bs_1"});
  CHECK(range_of({"map_area_weak_2", "map_area_bs_2"}).low < range.low);  // the second frame alone would have others
  CHECK(range_of({"map_area_bs_1"}).low > range.low);                     // and so would one transmitter
  for (const char* map : {"map_area_weak_1", "map_area_bs_1", "map_area_weak_2", "map_area_bs_2"}) {
    CAPTURE(map);
    CHECK(wrong_cells(folder / "m" / map, range) == 0);
  }
  CHECK(wrong_cells(folder / "m" / "map_area_weak_1", {range.low - 5.0, range.high}) > 20);  // which the check sees
  CHECK(range.high - range.low > 40.0);
}

TEST_CASE("the ends of the colours are those that the scenario asks for") {
  DCEM_NEEDS_PROGRAM();
  DCEM_NEEDS_DRAWING();
  const TemporaryFolder folder;
  write_two(folder, R"({"files":["csv","png"],"range_dbm":[-97.5,-31]})");
  REQUIRE(dcem_program(folder, "map street.json --frames 1:2 --quiet -o m").exit_code == 0);
  for (const char* map : {"map_area_weak", "map_area_bs"}) CHECK(wrong_cells(folder / "m" / map, {-97.5, -31.0}) == 0);
  write_two(folder, R"({"range_dbm":[-31,-97.5]})");
  check_refused(folder, "map street.json -o n", "output.map.range_dbm: no range");
}

TEST_CASE("each picture is there in every format that is asked for, sound and without its neighbours") {
  DCEM_NEEDS_PROGRAM();
  DCEM_NEEDS_DRAWING();
  const TemporaryFolder folder;
  write_two(folder, "true");
  REQUIRE(dcem_program(folder, "map street.json --frames 0:1 --quiet -o m --output pdf,svg").exit_code == 0);
  Names expected{"map_summary.json"};
  for (const char* map : {"weak", "bs", "best_server", "sinr", "distribution"}) {
    for (const char* ending : {".pdf", ".svg"}) expected.push_back("map_area_" + std::string(map) + ending);
  }
  std::sort(expected.begin(), expected.end());
  CHECK(names_in(folder / "m") == expected);
  for (const std::string& name : expected) {
    CAPTURE(name);
    if (name.ends_with(".svg")) CHECK(is_xml(folder / "m" / name));
    if (name.ends_with(".pdf")) CHECK(is_pdf(file_bytes(folder / "m" / name)));
  }
  REQUIRE(dcem_program(folder, "map street.json --frames 0:1 --quiet -o again --output pdf,svg").exit_code == 0);
  for (const std::string& name : expected) {
    if (name != "map_summary.json") CHECK(file_bytes(folder / "m" / name) == file_bytes(folder / "again" / name));
  }
  // Without a word each in its usual one.
  REQUIRE(dcem_program(folder, "map street.json --frames 0:1 --quiet -o usual").exit_code == 0);
  for (const std::string& name : names_in(folder / "usual")) {
    CHECK_FALSE(name.ends_with(".pdf"));
    CHECK(name.ends_with(".svg") == (name == "map_area_distribution.svg"));
  }
}

TEST_CASE("lines, finer cells and relief change the picture and nothing else") {
  DCEM_NEEDS_PROGRAM();
  DCEM_NEEDS_DRAWING();
  const TemporaryFolder folder;
  const auto made = [&](const std::string& name, const std::string& more) {
    write_two(folder, R"({"files":["csv","png","asc"])" + more + "}");
    REQUIRE(dcem_program(folder, "map street.json --frames 0:1 --quiet -o " + name).exit_code == 0);
    return folder / name;
  };
  const auto plain = made("plain", "");
  for (const char* more : {R"(,"contours_db":5)", R"(,"finer_cells":4)"}) {
    const auto other = made("other", more);
    CHECK(file_bytes(plain / "map_area_bs.csv") == file_bytes(other / "map_area_bs.csv"));
    CHECK(file_bytes(plain / "map_area_bs.asc") == file_bytes(other / "map_area_bs.asc"));
    CHECK(file_bytes(plain / "map_area_bs.png") != file_bytes(other / "map_area_bs.png"));
    CHECK(file_bytes(plain / "map_area_best_server.png") == file_bytes(other / "map_area_best_server.png"));
  }
}

TEST_CASE("pictures of links and of a comparison come in the formats that are asked for") {
  DCEM_NEEDS_PROGRAM();
  DCEM_NEEDS_DRAWING();
  const TemporaryFolder folder;
  write_two(folder, R"(true,"plots":{"formats":["pdf"],"max_links":1},"paths":true)");
  REQUIRE(dcem_program(folder, "run street.json --quiet -o r").exit_code == 0);
  std::size_t pictures = 0;
  for (const std::string& name : names_in(folder / "r")) {
    CHECK_FALSE((name.ends_with(".png") || name.ends_with(".svg")));
    pictures += name.ends_with(".pdf") ? 1 : 0;
  }
  CHECK(pictures == 5);
  write(folder / "a.csv", "x_m,y_m,power_incoherent_dbm\n0,0,-60\n1,0,-70\n");
  REQUIRE(dcem_program(folder, "compare a.csv a.csv -o c --output png,pdf").exit_code == 0);
  CHECK(names_in(folder / "c") == Names{"comparison.pdf", "comparison.png"});
  check_refused(folder, "compare a.csv a.csv -o d --output gif", "'gif' is no file of 'dcem compare'");
}

TEST_CASE("a build without Cairo makes plain maps, and says so; what it cannot draw it refuses") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  const std::string version = dcem_program(folder, "--version").output;
  CHECK((version.find("pictures are drawn with: Cairo ") != std::string::npos) == can_draw());
  if (can_draw()) return;
  CHECK(version.find("no Cairo") != std::string::npos);
  write_two(folder, "true");
  const Outcome outcome = dcem_program(folder, "map street.json --frames 0:1 --progress never -o m");
  CHECK(outcome.exit_code == 0);
  CHECK(outcome.error.find("maps are plain rasters") != std::string::npos);
  CHECK(read_png(folder / "m" / "map_area_bs.png").width > 100);
  CHECK_FALSE(std::filesystem::exists(folder / "m" / "map_area_distribution.svg"));
  check_refused(folder, "map street.json -o n --output svg", "draws no charts");
  check_refused(folder, "run street.json -o n --output plots", "draws no charts");
  write_two(folder, R"(["csv","pdf"])");
  check_refused(folder, "map street.json -o n", "draws no charts");
  write(folder / "a.csv", "x_m,y_m,power_incoherent_dbm\n0,0,-60\n1,0,-70\n");
  CHECK(dcem_program(folder, "compare a.csv a.csv -o c").exit_code == 0);
}

}  // namespace test_map_pictures
