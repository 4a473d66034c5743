/// What the program foresees of the memory that it will take is what it then takes.
#include <doctest/doctest.h>

#include <regex>
#include <string>
#include <vector>

#include "tests/io/program_case.hpp"
#include "tests/io/running_program.hpp"

namespace test_foreseen_memory {

using namespace dcem::test;

namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool is_sanitized = true;  // freed memory is kept for a while
#else
constexpr bool is_sanitized = false;
#endif

struct Memory {
  double foreseen_bytes = 0.0, peak_bytes = 0.0;
};

/// What a map of so many points needs, by the refusal of a limit that is too low and by what it takes.
Memory memory_of_map(const TemporaryFolder& folder, int columns, int rows) {
  const std::string count = std::to_string(columns) + "," + std::to_string(rows);
  write_scenario(folder,
                 R"({"id":"area","grid":{"origin_m":[-30,-8,1.5],"spacing_m":[0.1,0.05],"count":[)" + count + R"(]}})");
  Memory memory;
  const Outcome refused = dcem_program(folder, "map street.json --frames 0:1 --memory-limit 1K");
  REQUIRE(refused.exit_code == 2);
  std::smatch found;
  static const std::regex amount(R"(points need (\d+) (kB|MB);)");
  REQUIRE(std::regex_search(refused.error, found, amount));
  memory.foreseen_bytes = std::stod(found[1]) * (found[2] == "kB" ? 1e3 : 1e6);
  RunningProgram program(
      folder, {"map", "street.json", "--frames", "0:1", "--threads", "1", "--quiet", "--output", "csv", "-o", "out"});
  REQUIRE(program.end() == 0);
  memory.peak_bytes = program.peak_bytes();
  return memory;
}

}  // namespace

TEST_CASE("a map of more points takes as much more memory as was foreseen") {
  DCEM_NEEDS_PROGRAM();
  if (is_sanitized) return;
  const TemporaryFolder folder;
  const Memory small = memory_of_map(folder, 20, 20), large = memory_of_map(folder, 300, 200);
  const double foreseen_bytes = large.foreseen_bytes - small.foreseen_bytes;
  const double taken_bytes = large.peak_bytes - small.peak_bytes;
  CAPTURE(foreseen_bytes);
  CAPTURE(taken_bytes);
  REQUIRE(foreseen_bytes > 15e6);
  // The lines of the table come on top, some tens of bytes a point; below, the small map has room for work that the
  // large one has used again.
  CHECK(taken_bytes > 0.8 * foreseen_bytes);
  CHECK(taken_bytes < 1.4 * foreseen_bytes);
}

}  // namespace test_foreseen_memory
