/// Results of a run do not depend on the number of threads: not where thousands of links are moved, told and kept in
/// pieces, vehicles come and go, and some are where they can hardly be meant to be.
#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <filesystem>
#include <map>
#include <regex>
#include <string>

#include "tests/io/program_case.hpp"
#include "tests/io/traffic_case.hpp"

namespace test_many_threads {

using namespace dcem::test;

namespace {

/// A fleet of so many vehicles over a ground, 5,000 links a frame; one is kilometres away, every fifth comes and goes.
void add_fleet(TrafficCase& files, std::size_t vehicles, const std::string& more) {
  for (std::size_t frame = 0; frame < 4; ++frame) {
    std::string there;
    for (std::size_t number = 0; number < vehicles; ++number) {
      if (number % 5 == 4 && (number / 5 + frame) % 3 == 0) continue;
      const double away_m = number == 7 ? 5000.0 : 0.0, along_m = static_cast<double>(frame);
      const std::string x = std::to_string(9.0 * static_cast<double>(number % 10) + along_m + away_m);
      const std::string y = std::to_string(5.0 * std::floor(static_cast<double>(number) / 10.0));
      there += vehicle("v" + std::to_string(number), "x=\"" + x + "\" y=\"" + y + "\" angle=\"90\" speed=\"10\"");
    }
    files.trace_lines += step(std::to_string(0.1 * static_cast<double>(frame)), there);
  }
  files.mobility =
      R"({"sumo_fcd": "trace.xml", "vehicle_types": "types.xml", "material": "metal", "devices": {"vehicles": "all", "power_dbm": 23}})";
  files.more = "," + more;
}

/// Every file of a folder; of a summary without what clocks and the number of threads say.
std::map<std::string, std::string> results_of(const std::filesystem::path& folder) {
  static const std::regex by_clock(
      R"re("(threads|[a-z_]+_time_s|real_time_factor|frame_time_[a-z0-9]+_s)": ?[^,}]*)re");
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string bytes = file_bytes(entry.path());
    const bool is_summary = entry.path().filename() == "summary.json";
    files[entry.path().filename()] = is_summary ? std::regex_replace(bytes, by_clock, "") : bytes;
  }
  return files;
}

void check_threads(const TrafficCase& files, const std::string& options) {
  write_text(files.folder / "trace.xml", trace(files.trace_lines));
  files.write_scenario();
  for (const std::string threads : {"1", "2", "5"}) {
    const std::string result = "t" + threads;
    const Outcome outcome =
        dcem_program(files.folder, "run case.json --quiet " + options + " --threads " + threads + " -o " + result);
    CAPTURE(outcome.error);
    REQUIRE(outcome.exit_code == 0);
    const auto found = results_of(files.folder / result), expected = results_of(files.folder / "t1");
    CHECK(found.size() == expected.size());
    for (const auto& [name, bytes] : expected) {
      CAPTURE(name);
      CHECK((found.contains(name) && found.at(name) == bytes));  // not shown: megabytes
    }
  }
}

const std::string direct = R"("propagation": {"max_reflections": 2, "max_transmissions": 0, "max_interactions": 0})";
const std::string mirrored = R"("propagation": {"max_reflections": 1, "max_transmissions": 0, "max_interactions": 1})";

}  // namespace

TEST_CASE("thousands of links: tables") {
  DCEM_NEEDS_PROGRAM();
  TrafficCase files;
  add_fleet(files, 105, direct);
  check_threads(files, "--output links");
  const std::string summary = file_bytes(files.folder / "t2/summary.json");
  CHECK(holds(summary, "vehicle 'v7' is up to 5.1 km outside"));  // the warning about the one that is far away
}

TEST_CASE("thousands of links: lists of paths, profiles and what is remembered of frames") {
  DCEM_NEEDS_PROGRAM();
  TrafficCase many, few;
  add_fleet(many, 104, direct);
  check_threads(many, "--output paths,links,pdp,doppler");
  add_fleet(few, 20, mirrored);
  check_threads(few, "--output paths,links,pdp,doppler,npz");
}

}  // namespace test_many_threads
