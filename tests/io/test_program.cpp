#include <doctest/doctest.h>
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/io/drawing_needed.hpp"
#include "tests/io/program_case.hpp"

namespace test_program {

using namespace dcem::test;

namespace {

std::vector<std::string> sorted_lines(const std::filesystem::path& path) {
  std::vector<std::string> lines;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  std::sort(lines.begin(), lines.end());
  return lines;
}

std::size_t line_count(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

}  // namespace

TEST_CASE("a run writes a line per frame and link, and all files at once") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  write_scenario(folder, moving_receiver);
  const Outcome outcome = dcem_program(folder, "run street.json -o result");
  CAPTURE(outcome.error);
  REQUIRE(outcome.exit_code == 0);
  const auto result = folder / "result";
  CHECK(line_count(file_bytes(result / "paths.jsonl")) == 4);
  CHECK(line_count(file_bytes(result / "links.csv")) == 1 + 4);
  CHECK(line_count(file_bytes(result / "pdp.csv")) > 4);
  CHECK(file_bytes(result / "summary.json").find("\"discovery\": \"exact\"") != std::string::npos);
  CHECK(outcome.output.find("real-time factor") != std::string::npos);
  CHECK(std::distance(std::filesystem::directory_iterator(result), {}) == 4);
}

TEST_CASE("--frames picks frames and keeps their numbers; --quiet says nothing; --output picks files") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  write_scenario(folder, moving_receiver);
  const Outcome outcome = dcem_program(folder, "run street.json --frames 1:3 --quiet --output links");
  CHECK(outcome.exit_code == 0);
  CHECK(outcome.output.empty());
  CHECK(outcome.error.empty());
  const auto result = folder.path() / "out" / "street";  // the default folder
  CHECK_FALSE(std::filesystem::exists(result / "paths.jsonl"));
  const std::string links = file_bytes(result / "links.csv");
  CHECK(line_count(links) == 1 + 2);
  CHECK(links.find("\n1,0.5,bs,ue,") != std::string::npos);
  CHECK(links.find("\n2,1,bs,ue,") != std::string::npos);
}

TEST_CASE("the number of threads changes no byte") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  write_scenario(folder, moving_receiver + "," + grid_receiver);
  for (const std::string threads : {"1", "2", "5"}) {
    const Outcome outcome =
        dcem_program(folder, "run street.json --quiet --discovery sampled --threads " + threads + " -o t" + threads);
    CAPTURE(outcome.error);
    REQUIRE(outcome.exit_code == 0);
    for (const char* file : {"paths.jsonl", "links.csv", "pdp.csv"}) {
      CHECK(file_bytes(folder.path() / ("t" + threads) / file) == file_bytes(folder.path() / "t1" / file));
    }
  }
}

TEST_CASE("the order of the devices changes no line") {
  DCEM_NEEDS_PROGRAM();
  TemporaryFolder folder;
  write_scene(folder);
  const std::string one = R"({"id":"a","position_m":[10,2,1.5]})", other = R"({"id":"b","position_m":[3,-4,2]})";
  write(folder / "forward.json", scenario(one + "," + other));
  write(folder / "backward.json", scenario(other + "," + one));
  for (const std::string name : {"forward", "backward"}) {
    const Outcome run = dcem_program(folder, "run " + name + ".json --quiet --discovery sampled -o " + name);
    REQUIRE(run.exit_code == 0);
  }
  for (const char* file : {"paths.jsonl", "links.csv", "pdp.csv"}) {
    CAPTURE(file);
    CHECK(sorted_lines(folder.path() / "forward" / file) == sorted_lines(folder.path() / "backward" / file));
  }
}

TEST_CASE("a map has a CSV and a picture, and its values are those of a run at its points") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  write_scenario(folder, grid_receiver);
  REQUIRE(dcem_program(folder, "map street.json --frames 0:1 --quiet -o m").exit_code == 0);
  REQUIRE(dcem_program(folder, "run street.json --frames 0:1 --quiet -o r").exit_code == 0);
  const std::string map = file_bytes(folder.path() / "m" / "map_area_bs.csv");
  const std::string links = file_bytes(folder.path() / "r" / "links.csv");
  CHECK(file_bytes(folder.path() / "m" / "map_area_bs.png").starts_with("\x89PNG"));
  CHECK(line_count(map) == 1 + 3 * 13);
  CHECK(line_count(links) == 1 + 3 * 13);
  // Row 4, column 1: x = -5 + 2, y = -12 + 8. The powers stand in columns 4 and 5 there, 9 and 10 here.
  const std::size_t point = map.find("\n-3,-4,1.5,"), link = links.find(",\"area[4,1]\",");
  REQUIRE(point != std::string::npos);
  REQUIRE(link != std::string::npos);
  const std::string powers = map.substr(point + 11, map.find(',', map.find(',', point + 11) + 1) - point - 11);
  CHECK(powers.size() > 20);
  CHECK(links.find("," + powers + ",", link) < links.find('\n', link));
  // y = -10 and y = 10 are walls; beyond them nothing arrives, for lack of diffraction.
  CHECK(map.find("\n-3,-10,1.5,,,,,,,,,\n") != std::string::npos);
  CHECK(map.find("\n-3,-12,1.5,,,,,,,0,0,\n") != std::string::npos);
}

TEST_CASE("a list of points has tables with the values of a run, line by line, and no pictures") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  write(folder / "route.csv", "note,z_m,x_m,y_m\na,1.5,-3,-4\nb,1.5,-2.5,-4\n,1.5,-2,-9.5\n");
  write_scenario(folder, moving_receiver + R"(,{"id":"route","points_csv":"route.csv"},)" +
                             R"({"id":"probe","positions_m":[[1,2,3]]})");
  REQUIRE(dcem_program(folder, "map street.json --frames 0:1 --quiet -o m").exit_code == 0);
  REQUIRE(dcem_program(folder, "run street.json --frames 0:1 --quiet -o r").exit_code == 0);
  for (const char* name : {"map_route_bs.csv", "map_route_bs.npz", "map_route_best_server.csv", "map_probe_bs.csv",
                           "map_route_best_server.npz"}) {
    CHECK(std::filesystem::exists(folder.path() / "m" / name));
  }
  CHECK(std::filesystem::exists(folder.path() / "m" / "map_route_distribution.svg") == dcem::io::can_draw());
  for (const char* name : {"map_route_bs.png", "map_route_bs.asc", "map_route_best_server.png"}) {
    CHECK_FALSE(std::filesystem::exists(folder.path() / "m" / name));
  }
  const std::string map = file_bytes(folder.path() / "m" / "map_route_bs.csv");
  const std::string links = file_bytes(folder.path() / "r" / "links.csv");
  CHECK(line_count(map) == 1 + 3);
  CHECK(line_count(links) == 1 + 1 + 3 + 1);
  std::size_t line = map.find('\n') + 1;
  for (const char* id : {"route[0]", "route[1]", "route[2]"}) {
    std::size_t begin = line;
    for (int column = 0; column < 3; ++column) begin = map.find(',', begin) + 1;
    const std::string powers = map.substr(begin, map.find(',', map.find(',', begin) + 1) - begin);
    CHECK(powers.size() > 20);
    const std::size_t link = links.find(",\"" + std::string(id) + "\",");
    const std::size_t plain = links.find("," + std::string(id) + ",");
    const std::size_t found = std::min(link, plain);
    REQUIRE(found != std::string::npos);
    CHECK(links.find("," + powers + ",", found) < links.find('\n', found));
    line = map.find('\n', line) + 1;
  }
  CHECK(map.find("\n-3,-4,1.5,") != std::string::npos);
}

TEST_CASE("a map of cells with one sample is the map of points, byte by byte; a run takes their centres and says so") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  const auto with_samples = [](const std::string& samples) {
    std::string text = grid_receiver;
    return text.insert(text.rfind("}}"), ",\"samples\":" + samples);
  };
  write_scenario(folder, grid_receiver);
  REQUIRE(dcem_program(folder, "map street.json --frames 0:1 --quiet -o points").exit_code == 0);
  write_scenario(folder, with_samples("[1,1]"));
  REQUIRE(dcem_program(folder, "map street.json --frames 0:1 --quiet -o one").exit_code == 0);
  write_scenario(folder, with_samples("[3,2]"));
  const Outcome outcome = dcem_program(folder, "map street.json --frames 0:1 --progress always -o six");
  REQUIRE(outcome.exit_code == 0);
  CHECK(outcome.error.find("points: 234 of 234 in ") != std::string::npos);  // 3 x 13 cells of 3 x 2
  for (const char* name : {"map_area_bs.csv", "map_area_bs.png", "map_area_bs.npz", "map_area_bs.asc"}) {
    CAPTURE(name);
    const std::string points = file_bytes(folder.path() / "points" / name);
    CHECK(points == file_bytes(folder.path() / "one" / name));
    CHECK(points != file_bytes(folder.path() / "six" / name));
  }
  // The rows at y = -10 and 10 are walls; of the cells around them, no sample is.
  const std::string six = file_bytes(folder.path() / "six" / "map_area_bs.csv");
  CHECK(line_count(six) == 1 + 3 * 13);
  CHECK(six.find(",,,,,,,,,") == std::string::npos);
  const Outcome run = dcem_program(folder, "run street.json --frames 0:1 --progress never -o run");
  CHECK(run.exit_code == 0);
  CHECK(run.error.find("warning: grid 'area': samples are for maps") != std::string::npos);
}

TEST_CASE("a map of several frames has the frame in its file names") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  write_scenario(folder, grid_receiver);
  REQUIRE(dcem_program(folder, "map street.json --frames 1:3 --quiet -o m").exit_code == 0);
  for (const char* name : {"map_area_bs_1.csv", "map_area_bs_2.png"}) {
    CHECK(std::filesystem::exists(folder.path() / "m" / name));
  }
  CHECK_FALSE(std::filesystem::exists(folder.path() / "m" / "map_area_bs.csv"));
}

TEST_CASE("inspect shows a scene whose materials are not defined") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  write_scene(folder);
  write(folder / "street.mtl", "newmtl wall\nKd 1 1 1\n");
  const Outcome table = dcem_program(folder, "inspect street.obj --frequency-hz 30e9");
  CHECK(table.exit_code == 0);
  CHECK(table.output.find("undefined") != std::string::npos);
  const Outcome json = dcem_program(folder, "inspect street.obj --json --up y --unit-m 2");
  CHECK(json.exit_code == 0);
  CHECK(json.output.find("\"facets\": 3") != std::string::npos);
  CHECK(json.output.find("\"defined\": false") != std::string::npos);
  // In the file's units: two walls 80 long and 12 high meet a ground 20 wide; one unit is two metres.
  for (const char* fact :
       {"\"count\": 2", "\"length_m\": 320.0", "\"free_edges\": 8", "\"free_edge_length_m\": 496.0"}) {
    INFO(fact);
    CHECK(json.output.find(fact) != std::string::npos);
  }
  CHECK(table.output.find("from 190 degrees outside, 160.0 m in all") != std::string::npos);
}

TEST_CASE("a map brings tables, pictures, arrays, rasters and distributions, also over all transmitters") {
  DCEM_NEEDS_DRAWING();
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  write_scenario(folder, grid_receiver);
  REQUIRE(dcem_program(folder, "map street.json --frames 0:1 --quiet -o m").exit_code == 0);
  // One transmitter and no noise: nothing to weigh it against.
  const auto names_in = [&](const std::string& name) {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder / name)) {
      names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
  };
  CHECK(names_in("m") == std::vector<std::string>{"map_area_best_server.asc", "map_area_best_server.csv",
                                                  "map_area_best_server.npz", "map_area_best_server.png",
                                                  "map_area_bs.asc", "map_area_bs.csv", "map_area_bs.npz",
                                                  "map_area_bs.png", "map_area_distribution.svg", "map_summary.json"});
  write_scenario(folder, grid_receiver, R"(,"noise":{"bandwidth_hz":1e8,"noise_figure_db":7})");
  REQUIRE(dcem_program(folder, "map street.json --frames 0:1 --quiet -o noisy").exit_code == 0);
  const std::string ratios = file_bytes(folder.path() / "noisy" / "map_area_sinr.csv");
  const std::string powers = file_bytes(folder.path() / "noisy" / "map_area_bs.csv");
  // -173.975 dBm per hertz, 80 dB for the bandwidth, 7 dB noise figure.
  const std::size_t at = ratios.find("\n-3,-4,1.5,bs,"), same = powers.find("\n-3,-4,1.5,");
  REQUIRE(at != std::string::npos);
  const double sinr_db = std::stod(ratios.substr(at + 14));
  const double incoherent_dbm = std::stod(powers.substr(powers.find(',', same + 11) + 1));
  CHECK(std::abs(sinr_db - (incoherent_dbm + 173.975 - 87.0)) < 1e-3);
  write(folder / "few.json", scenario(grid_receiver + "," + moving_receiver, R"(,"noise":{"bandwidth_hz":1e6})"));
  std::string few = file_bytes(folder / "few.json");
  few.replace(few.find(R"("output":{)"), 10, R"("output":{"map":["csv","svg"],)");
  write(folder / "few.json", few);
  REQUIRE(dcem_program(folder, "map few.json --frames 1:3 --quiet -o few").exit_code == 0);
  std::vector<std::string> expected{"map_area_distribution_1.svg", "map_area_distribution_2.svg", "map_summary.json"};
  for (const char* map : {"map_area_best_server", "map_area_bs", "map_area_sinr"}) {
    for (const char* end : {"_1.csv", "_2.csv", "_1.svg", "_2.svg"}) expected.push_back(std::string(map) + end);
  }
  std::sort(expected.begin(), expected.end());
  CHECK(names_in("few") == expected);
}

TEST_CASE("two maps are compared place by place") {
  DCEM_NEEDS_DRAWING();
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  write(folder / "a.csv", "x_m,y_m,power_incoherent_dbm\n0,0,-60\n1,0,-70\n2,0,\n");
  write(folder / "b.csv", "x_m,y_m,p_db\n0,0,-60\n1,0,-60\n2,0,-60\n");
  const Outcome outcome = dcem_program(folder, "compare a.csv b.csv --second-column p_db -o c");
  CAPTURE(outcome.error);
  REQUIRE(outcome.exit_code == 0);
  CHECK(outcome.output.find("2 places with two values") != std::string::npos);
  CHECK(outcome.output.find("0.4500") != std::string::npos);  // mean of 0 and 0.9
  CHECK(file_bytes(folder.path() / "c" / "comparison.svg").starts_with("<?xml"));
  check_refused(folder, "compare a.csv b.csv -o d", "b.csv:1: the column");
  write(folder / "far.csv", "x_m,y_m,power_incoherent_dbm\n10,0,-60\n");
  check_refused(folder, "compare a.csv far.csv -o d", "no place has a value");
}

TEST_CASE("a map that cannot be written or held says so in one line") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  write_scenario(folder, R"({"id":"area","grid":{"origin_m":[0,0,1],"spacing_m":[1,1],"count":[100000,10000]}})");
  check_refused(folder, "map street.json", "1000000000 points need 376 GB");
  write_scenario(folder, R"({"id":"area","grid":{"origin_m":[0,0,1],"spacing_m":[1,1],"count":[0,5]}})");
  check_refused(folder, "map street.json", "count");
  write_scenario(folder, R"({"id":"area","grid":{"origin_m":[0,0,1],"spacing_m":[1e-7,1],"count":[1,5]}})");
  check_refused(folder, "map street.json", "spacing_m[0]");
  write_scenario(folder, grid_receiver, R"(,"noise":{"noise_figure_db":3})");
  check_refused(folder, "map street.json", "bandwidth_hz");
  write_scenario(folder, grid_receiver, R"(,"noise":{"bandwidth_hz":-1})");
  check_refused(folder, "map street.json", "noise.bandwidth_hz");
  write_scenario(folder, grid_receiver, R"(,"noise":{"bandwidth_hz":1,"noise_figure_db":1000})");
  check_refused(folder, "map street.json", "noise.noise_figure_db");
  write_scenario(folder, grid_receiver, R"(,"noise":{"bandwidth_hz":1,"temperature_k":0})");
  check_refused(folder, "map street.json", "noise.temperature_k");
  write_scenario(folder, R"({"id":"area","grid":{"origin_m":[0,0,1],"spacing_m":[1,1],"count":[2,2]}})");
  std::string text = file_bytes(folder / "street.json");
  text.replace(text.find(R"("id":"bs")"), 9, R"("id":"sinr")");
  write(folder / "street.json", text);
  check_refused(folder, "map street.json", "map_area_sinr");
  for (const char* keys : {R"("map":[])", R"("map":false)", R"("map":["gif"])"}) {
    write_scenario(folder, grid_receiver);
    std::string file = file_bytes(folder / "street.json");
    file.replace(file.find(R"("output":{)"), 10, std::string(R"("output":{)") + keys + ",");
    write(folder / "street.json", file);
    check_refused(folder, "map street.json", "output.map");
  }
  // A folder that is no folder stands for one that cannot be written, which a privileged user never meets.
  write_scenario(folder, grid_receiver);
  write(folder / "full", "a file where a folder should be");
  check_refused(folder, "map street.json -o full/result", "full");
  check_refused(folder, "map street.json -o /proc/maps", "/proc/maps");
  // Where no file may grow beyond a few kilobytes the pictures do not fit, as on a full disk.
  const auto before = folder.names();
  const std::string limited = "cd " + quoted(folder.path()) + " && ( ulimit -f 4; trap '' XFSZ; " +
                              quoted(DCEM_PROGRAM) + " map street.json --frames 0:1 --quiet -o m ) > /dev/null 2> " +
                              quoted(folder / ".error");
  const int status = std::system(limited.c_str());
  const std::string error = file_bytes(folder / ".error");
  std::filesystem::remove(folder / ".error");
  CAPTURE(error);
  CHECK(WEXITSTATUS(status) == 2);
  CHECK(std::count(error.begin(), error.end(), '\n') == 1);
  CHECK(error.find("; expected ") != std::string::npos);
  CHECK(folder.names() == before);
}

TEST_CASE("a grid that is beyond the machine's memory is refused with the memory it would need") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  write_scenario(folder, R"({"id":"area","grid":{"origin_m":[0,0,1],"spacing_m":[1e-3,1e-3],"count":[10000,10000]}})");
  // A thousand transmitters: tens of terabytes.
  std::string text = file_bytes(folder / "street.json"), more;
  for (int index = 0; index < 1000; ++index) {
    more += R"({"id":"t)" + std::to_string(index) + R"(","position_m":[-20,1,5],"power_dbm":30},)";
  }
  text.insert(text.find(R"({"id":"bs")"), more);
  write(folder / "street.json", text);
  for (const char* command : {"map", "run", "verify"}) {
    check_refused(folder, std::string(command) + " street.json", "grid 'area': 100000000 points need ");
  }
}

TEST_CASE("maps without a value, or of equal values, are sound") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  // Behind the wall nothing arrives; on the wall nothing can stand; the whole grid within a few micrometres.
  const std::vector<std::pair<std::string, std::string>> grids{
      {"nothing", R"("origin_m":[-5,12,1.5],"spacing_m":[2,2],"count":[6,4])"},
      {"obstructed", R"("origin_m":[-5,10,1.5],"spacing_m":[2,1e-6],"count":[6,4])"},
      {"equal", R"("origin_m":[-5,2,1.5],"spacing_m":[1e-6,1e-6],"count":[6,4])"},
      {"single", R"("origin_m":[-5,2,1.5],"spacing_m":[1,1],"count":[1,1])"}};
  for (const auto& one : grids) {
    const std::string &name = one.first, &grid = one.second;
    CAPTURE(name);
    write_scenario(folder, R"({"id":"area","grid":{)" + grid + "}}");
    const Outcome outcome = dcem_program(folder, "map street.json --frames 0:1 --quiet -o " + name);
    CHECK(outcome.exit_code == 0);
    CHECK(outcome.error.empty());
    const auto result = folder / name;
    CHECK(file_bytes(result / "map_area_bs.png").starts_with("\x89PNG"));
    CHECK(file_bytes(result / "map_area_best_server.png").starts_with("\x89PNG"));
    for (const auto& file : std::filesystem::directory_iterator(result)) {
      const std::string extension = file.path().extension().string();
      if (extension != ".csv" && extension != ".asc" && extension != ".svg") continue;
      const std::string bytes = file_bytes(file.path());
      CAPTURE(file.path().string());
      CHECK(bytes.size() > 30);
      CHECK(bytes.find("nan") == std::string::npos);
      CHECK(bytes.find("inf") == std::string::npos);
    }
  }
}

TEST_CASE("bad usage and bad input end with one line, exit code 2 and no output") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  write_scenario(folder, moving_receiver);
  write(folder / "full", "a file where a folder should be");
  check_refused(folder, "", "command line: ");
  check_refused(folder, "fly street.json", "command line: 'fly'");
  check_refused(folder, "run", "command line: ");
  check_refused(folder, "run absent.json", "absent.json");
  check_refused(folder, "run street.json --frames 3:3", "frame out of range");
  check_refused(folder, "run street.json --frames 0:5", "frame out of range");
  check_refused(folder, "run street.json --frames 1", "--frames 1");
  check_refused(folder, "run street.json --frames 1:2x", "--frames 1:2x");
  check_refused(folder, "run street.json --threads none", "--threads");
  check_refused(folder, "run street.json --cache exact --discovery sampled", "cache exact");
  check_refused(folder, "run street.json --discovery guess", "--discovery");
  check_refused(folder, "run street.json --output kml", "no place on the Earth");
  check_refused(folder, "run street.json --rays 0", "rays");
  check_refused(folder, "run street.json -o full/result", "full");
  check_refused(folder, "map street.json", "grid");
  check_refused(folder, "inspect absent.obj", "absent.obj");
  for (const char* number : {"nan", "inf", "0", "-1", "1e300"}) {
    check_refused(folder, std::string("inspect absent.obj --frequency-hz ") + number, "expected a number above 0");
    check_refused(folder, std::string("inspect absent.obj --unit-m ") + number, "expected a number above 0");
  }
  check_refused(folder, "import sumo town.sumocfg -o town", "town.sumocfg");
  check_refused(folder, "import maps town.osm -o town", "maps");
  check_refused(folder, "import osm town.osm -o town --fcd trace.xml", "--fcd");
}

TEST_CASE("a folder where a file of results belongs is told in one line") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  write_scenario(folder, moving_receiver);
  std::filesystem::create_directories(folder / "one/summary.json");
  check_refused(folder, "run street.json -o one", "summary.json: is a folder");
  std::filesystem::create_directories(folder / "other/run.journal");
  check_refused(folder, "run street.json -o other --resume", "run.journal: is no file");
}

TEST_CASE("a verification that nobody can read has failed") {
  DCEM_NEEDS_PROGRAM();
  if (!std::filesystem::exists("/dev/full")) return;
  const TemporaryFolder folder;
  write_scenario(folder, moving_receiver);
  CHECK(dcem_program(folder, "verify street.json").exit_code == 0);
  CHECK(shell_line(folder, "(" + quoted(DCEM_PROGRAM) + " verify street.json >/dev/full)").exit_code == 1);
}

TEST_CASE("version and help are no errors") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  const Outcome version = dcem_program(folder, "--version");
  CHECK(version.exit_code == 0);
  CHECK(version.output.starts_with("dcem "));
  CHECK(dcem_program(folder, "map --help").exit_code == 0);
}

}  // namespace test_program
