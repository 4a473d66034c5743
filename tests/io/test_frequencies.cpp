/// `--frequency`: another carrier frequency than the scenario's, or several of them in one run.
#include <doctest/doctest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/io/program_case.hpp"
#include "tests/io/result_files.hpp"

namespace test_frequencies {

using namespace dcem::test;

namespace {

const std::string town = DCEM_DATA_DIR "/town_drive.json";

std::string with_frequency(std::string scenario, const std::string& frequency_hz) {
  const std::string key = "\"frequency_hz\": ";
  const std::size_t begin = scenario.find(key);
  REQUIRE(begin != std::string::npos);
  return scenario.replace(begin + key.size(), scenario.find(',', begin) - begin - key.size(), frequency_hz);
}

void run(const TemporaryFolder& folder, const std::string& arguments) {
  CAPTURE(arguments);
  const Outcome outcome = dcem_program(folder, arguments);
  CAPTURE(outcome.error);
  REQUIRE(outcome.exit_code == 0);
}

}  // namespace

TEST_CASE("several frequencies are as many runs: each has the files that it has alone, in a folder of its own") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  const std::string drive = "run " + town + " --frames 0:2 --output paths,links,npz";
  run(folder, drive + " --frequency 5.89e9,30e9 -o both");
  run(folder, drive + " --frequency 5.89e9 -o low");
  run(folder, drive + " --frequency 3e10 -o high");
  check_same_files(folder / "both/5.89GHz", folder / "low");
  check_same_files(folder / "both/30GHz", folder / "high");
  CHECK(file_bytes(folder / "low/links.csv") != file_bytes(folder / "high/links.csv"));
}

TEST_CASE("of several frequencies one that cannot be computed is told before another one is") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  for (const char* command : {"run", "verify"}) {
    const bool has_folder = std::string(command) == "run";
    const Outcome outcome = dcem_program(
        folder, std::string(command) + ' ' + town + " --frequency 30e9,200e9" + (has_folder ? " -o out" : ""));
    CHECK(outcome.exit_code == 2);
    CHECK(outcome.output.empty());
    CHECK_MESSAGE(outcome.error.find("200 GHz") != std::string::npos, outcome.error);
    CHECK_FALSE(std::filesystem::exists(folder / "out"));
  }
}

TEST_CASE("a frequency on the command line is that of a scenario that says it") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  const std::filesystem::path data = DCEM_DATA_DIR;
  for (const char* file : {"first_path.json", "crossing.obj", "crossing.mtl"})
    std::filesystem::copy_file(data / file, folder / file);
  run(folder, "run first_path.json --frequency 5.89e9 -o asked");
  write(folder / "first_path.json", with_frequency(file_bytes(folder / "first_path.json"), "5.89e9"));
  run(folder, "run first_path.json -o said");
  for (const char* file : {"paths.jsonl", "links.csv"})
    CHECK(file_bytes(folder / "asked" / file) == file_bytes(folder / "said" / file));
}

TEST_CASE("parts of a run keep the frequency that was asked for") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  const std::string drive = "run " + town + " --frames 0:2 --output links --frequency 5.89e9";
  run(folder, drive + " -o whole");
  run(folder, drive + " --shard 0/2 -o a");
  run(folder, drive + " --shard 1/2 -o b");
  run(folder, "merge a b -o merged");
  check_same_files(folder / "merged", folder / "whole");
}

TEST_CASE("parts of a run of several frequencies are merged to the same files, a frequency in a folder") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  const std::string drive = "run " + town + " --frames 0:2 --output paths,links --frequency 5.89e9,30e9";
  run(folder, drive + " -o whole");
  run(folder, drive + " --shard 0/2");  // without -o: each part has a folder of its own
  run(folder, drive + " --shard 1/2");
  const std::string parts = "out/town_drive.shard-0-of-2 out/town_drive.shard-1-of-2";
  run(folder, "merge " + parts + " -o merged");
  run(folder, "merge " + parts);
  for (const std::string frequency : {"/5.89GHz", "/30GHz"}) {
    check_same_files(folder / ("merged" + frequency), folder / ("whole" + frequency));
    check_same_files(folder / ("out/town_drive" + frequency), folder / ("whole" + frequency));
  }
  // Whichever part lacks a frequency, be it that it was ended before it was whole: nothing is left out without a word.
  for (const std::string part : {"out/town_drive.shard-0-of-2", "out/town_drive.shard-1-of-2"}) {
    CAPTURE(part);
    std::filesystem::rename(folder / part / "30GHz/summary.json", folder / "kept.json");
    const Outcome ended = dcem_program(folder, "merge " + parts + " -o lacking");
    CHECK(ended.exit_code == 2);
    CHECK(ended.error.find(part + "/30GHz") != std::string::npos);
    std::filesystem::rename(folder / "kept.json", folder / part / "30GHz/summary.json");
    std::filesystem::rename(folder / part / "30GHz", folder / "kept");
    const Outcome lacking = dcem_program(folder, "merge " + parts + " -o lacking");
    CHECK(lacking.exit_code == 2);
    CHECK(lacking.error.find(part + "/30GHz") != std::string::npos);
    std::filesystem::rename(folder / "kept", folder / part / "30GHz");
  }
}

TEST_CASE("--resume goes on with several frequencies: what is whole stays, what has not begun begins") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  const std::string drive = "run " + town + " --frames 0:2 --output links --frequency 5.89e9,30e9 -o both";
  CHECK(dcem_program(folder, drive + " --resume").error.find("nothing to resume; expected ") != std::string::npos);
  run(folder, drive);
  std::filesystem::copy(folder / "both/30GHz", folder / "high", std::filesystem::copy_options::recursive);
  std::filesystem::remove_all(folder / "both/30GHz");
  const Outcome again = dcem_program(folder, drive + " --resume");
  CHECK(again.exit_code == 0);
  CHECK(again.error.find("both/5.89GHz: the run is complete") != std::string::npos);
  check_same_files(folder / "both/30GHz", folder / "high");
}

TEST_CASE("what is no frequency is refused in one line, and nothing is written") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& frequencies, const std::string& said) {
    CAPTURE(frequencies);
    for (const std::string command : {"run", "map", "verify"}) {
      const Outcome outcome = dcem_program(folder, command + ' ' + town + " --frequency " + frequencies);
      CAPTURE(outcome.error);
      CHECK(outcome.exit_code == 2);
      CHECK(outcome.error.find("command line: --frequency") == 0);
      CHECK(outcome.error.find(said) != std::string::npos);
      CHECK(outcome.error.find("; expected ") != std::string::npos);
      CHECK(outcome.error.find('\n') == outcome.error.size() - 1);
      CHECK(folder.names().empty());
    }
  };
  for (const char* frequencies : {"5.89GHz", "5.89e9,", ",", "5e9,5e9", "nan", "''", "1e999"})
    refused(frequencies, "no frequencies");
  for (const char* frequencies : {"0", "1e16", "0,5e9"}) refused(frequencies, "expected a number above 0");
}

}  // namespace test_frequencies
