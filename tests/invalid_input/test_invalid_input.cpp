/// Every case of expected.txt that concerns files: refused with one line that names file, place and expectation.
/// run_program.sh puts the same cases to the program.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "dcem/io/input_error.hpp"
#include "dcem/io/scenario.hpp"

namespace test_invalid_input {

using namespace dcem;

namespace {

const std::filesystem::path folder = std::filesystem::path(DCEM_SOURCE_DIR) / "tests/invalid_input";

struct InvalidCase {
  std::string name, how;
  std::vector<std::string> pieces;
};

std::vector<InvalidCase> all_cases() {
  std::vector<InvalidCase> cases;
  std::ifstream file(folder / "expected.txt");
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with('#')) continue;
    std::vector<std::string> fields;
    const std::string separator = " | ";
    for (std::size_t start = 0; start != std::string::npos;) {
      const std::size_t end = line.find(separator, start);
      fields.push_back(line.substr(start, end == std::string::npos ? end : end - start));
      start = end == std::string::npos ? end : end + separator.size();
    }
    REQUIRE(fields.size() >= 3);
    cases.push_back({fields[0], fields[1], {fields.begin() + 2, fields.end()}});
  }
  return cases;
}

std::string error_of(const std::string& name) {
  try {
    io::load_scenario(folder / "cases" / name / "scenario.json");
  } catch (const io::InputError& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace

TEST_CASE("bad input is refused in one line that names file, place and expectation") {
  std::size_t loaded = 0;
  for (const InvalidCase& invalid : all_cases()) {
    if (invalid.how != "load") continue;
    ++loaded;
    const std::string message = error_of(invalid.name);
    CAPTURE(invalid.name);
    CAPTURE(message);
    for (const std::string& piece : invalid.pieces) {
      CAPTURE(piece);
      CHECK(message.find(piece) != std::string::npos);
    }
    CHECK(message.starts_with((folder / "cases" / invalid.name).string()));
    const bool says_what_to_do =
        message.find("; expected ") != std::string::npos || message.find("nearest known one") != std::string::npos;
    CHECK(says_what_to_do);
    CHECK(message.find("from 0 to 0") == std::string::npos);  // the range of what is no number
    CHECK(std::none_of(message.begin(), message.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; }));
    // Long enough for any path, short enough to read.
    CHECK(message.size() < 2 * folder.string().size() + 400);
  }
  CHECK(loaded >= 230);
}

TEST_CASE("every folder of a case is in the list") {
  const std::vector<InvalidCase> cases = all_cases();
  for (const auto& entry : std::filesystem::directory_iterator(folder / "cases")) {
    const std::string name = entry.path().filename().string();
    CAPTURE(name);
    CHECK(std::any_of(cases.begin(), cases.end(), [&](const InvalidCase& invalid) {
      return invalid.name == (invalid.how == "load" ? name : "cases/" + name);
    }));
  }
}

TEST_CASE("the scenarios that the cases are made from are good") {
  CHECK_NOTHROW(io::load_scenario(folder / "good/scenario.json"));
  CHECK_NOTHROW(io::load_scenario(folder / "good_traffic/scenario.json"));
  CHECK_NOTHROW(io::load_scenario(folder / "good_antenna/scenario.json"));
}

}  // namespace test_invalid_input
