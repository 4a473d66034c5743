/// Runs that several processes of `mpirun` share.
#include <doctest/doctest.h>

#include <filesystem>
#include <regex>
#include <string>
#include <vector>

#include "tests/io/drawing_needed.hpp"
#include "tests/io/program_case.hpp"
#include "tests/io/result_files.hpp"
#include "tests/support/all_tests.hpp"

namespace test_ranks {

using namespace dcem::test;

namespace {

const std::string town = DCEM_DATA_DIR "/town_drive.json";

/// As root, and with more processes than cores: in containers there is no other way.
/// Open MPI unloads its plugins before a process ends: no name is left by which a leak sanitizer could be told to leave
/// out what they keep. Other tests look for leaks of the same code.
const std::string mpirun =
    "ASAN_OPTIONS=\"$ASAN_OPTIONS:detect_leaks=0\" OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 "
    "mpirun --oversubscribe --quiet -n ";

Outcome on_ranks(const TemporaryFolder& folder, int ranks, const std::string& arguments) {
  return shell_line(folder, mpirun + std::to_string(ranks) + ' ' + quoted(DCEM_PROGRAM) + ' ' + arguments);
}

bool has_ranks(const TemporaryFolder& folder) {
  const bool is_built = dcem_program(folder, "--version").output.find("MPI ") != std::string::npos;
  const bool can_start = is_built && shell_line(folder, mpirun + "2 true").exit_code == 0;
  if (!is_built || !can_start) {
    MESSAGE("skipped: " << (is_built ? "mpirun starts no processes here" : "this build has no MPI"));
  }
  return can_start;
}

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

/// Without how many threads each process had.
std::string without_threads(std::string summary) {
  return std::regex_replace(summary, std::regex("\"threads\": [0-9]+"), "");
}

void check_same_run(const TemporaryFolder& folder, const std::string& result, const std::string& expected) {
  CHECK(names_in(folder / result) == names_in(folder / expected));
  auto files = files_of(folder / result), others = files_of(folder / expected);
  for (auto* of_one : {&files, &others}) of_one->at("summary.json") = without_threads(of_one->at("summary.json"));
  CHECK((files == others));
}

}  // namespace

TEST_CASE("any number of processes leaves the bytes of the run as a whole") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  if (!has_ranks(folder)) return;
  const std::string output = std::string("paths,links,pdp,npz") + (dcem::io::can_draw() ? ",plots" : "");
  const std::string run = "run " + town + " --frames 2:6 --output " + output;
  REQUIRE(dcem_program(folder, run + " -o whole").exit_code == 0);
  for (const int ranks : all_or<std::vector<int>>({1, 2, 3, 5}, {3})) {
    CAPTURE(ranks);
    const std::string result = "shared" + std::to_string(ranks);
    const Outcome outcome = on_ranks(folder, ranks, run + " -o " + result);
    CAPTURE(outcome.error);
    REQUIRE(outcome.exit_code == 0);
    CHECK(count_of(outcome.output, "frames") == 1);  // one table
    check_same_run(folder, result, "whole");
  }
}

TEST_CASE("lines alone are written by all processes together") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  if (!has_ranks(folder)) return;
  const std::string run = "run " + town + " --frames 0:7 --output links";
  REQUIRE(dcem_program(folder, run + " -o whole").exit_code == 0);
  for (const int ranks : all_or<std::vector<int>>({1, 2, 3, 5, 9}, {2})) {
    CAPTURE(ranks);
    const std::string result = "shared" + std::to_string(ranks);
    const Outcome outcome = on_ranks(folder, ranks, run + " -o " + result);
    CAPTURE(outcome.error);
    REQUIRE(outcome.exit_code == 0);
    CHECK(outcome.error.empty());
    check_same_run(folder, result, "whole");
  }
}

TEST_CASE("several processes do several frequencies, one after the other, with the bytes of one process") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  if (!has_ranks(folder)) return;
  const std::string run = "run " + town + " --frames 0:2 --output links --frequency 5.89e9,30e9 --quiet --threads 1";
  REQUIRE(dcem_program(folder, run + " -o whole").exit_code == 0);
  REQUIRE(on_ranks(folder, 2, run + " -o shared").exit_code == 0);
  for (const char* frequency : {"5.89GHz", "30GHz"}) {
    check_same_files(folder / "shared" / frequency, folder / "whole" / frequency);
  }
}

TEST_CASE("rays and what they remember are the same on three processes") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  if (!has_ranks(folder)) return;
  const std::string run = "run " + town + " --frames 0:4 --discovery sampled --rays 500 --output links";
  REQUIRE(dcem_program(folder, run + " -o whole").exit_code == 0);
  REQUIRE(on_ranks(folder, 3, run + " -o shared").exit_code == 0);
  check_same_run(folder, "shared", "whole");
}

TEST_CASE("a process that is killed ends the job without a result; --resume makes it, on other processes, too") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  if (!has_ranks(folder)) return;
  const std::string run = "run " + town + " --frames 0:12 --output links";
  REQUIRE(dcem_program(folder, run + " -o whole").exit_code == 0);
  // The second process kills itself as soon as there is a journal.
  write(
      folder / "rank.sh",
      "if [ \"$OMPI_COMM_WORLD_RANK\" = 1 ]; then\n"
      "  (until ls shared/run.parts/*/run.journal > list 2>&1; do sleep 0.01; done; kill -9 $$) &\nfi\nexec \"$@\"\n");
  const Outcome killed =
      shell_line(folder, mpirun + "3 sh rank.sh " + quoted(DCEM_PROGRAM) + ' ' + run + " --threads 1 -o shared");
  if (killed.exit_code != 0) {  // otherwise it was quicker than who was to kill it
    CHECK_FALSE(std::filesystem::exists(folder / "shared/links.csv"));
    CHECK_FALSE(std::filesystem::exists(folder / "shared/summary.json"));
  }
  const Outcome resumed = on_ranks(folder, 2, run + " --resume -o shared");
  CAPTURE(resumed.error);
  REQUIRE(resumed.exit_code == 0);
  check_same_run(folder, "shared", "whole");
  // A run that nobody goes on with leaves nothing behind for the next.
  std::filesystem::create_directories(folder / "shared/run.parts/0-of-9");
  REQUIRE(dcem_program(folder, run + " -o shared").exit_code == 0);
  check_same_run(folder, "shared", "whole");
}

TEST_CASE("bad input is one line of one process, with exit code 2 and nothing written") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  if (!has_ranks(folder)) return;
  const auto check_one_line = [&](const std::string& arguments, const std::string& said) {
    CAPTURE(arguments);
    const Outcome outcome = on_ranks(folder, 3, arguments);
    CAPTURE(outcome.error);
    CHECK(outcome.exit_code == 2);
    CHECK(count_of(outcome.error, "; expected ") == 1);
    CHECK(outcome.error.find(said) != std::string::npos);
    CHECK(folder.names().empty());
  };
  check_one_line("run nowhere.json -o out", "nowhere.json: is not there");
  check_one_line("run " + town + " --frames 7:7 -o out", "--frames 7:7");
  check_one_line("run " + town + " --rays 7 -o out", "--rays has no effect");
  check_one_line("map " + town + " -o out", "each process would do all of it");
}

}  // namespace test_ranks
