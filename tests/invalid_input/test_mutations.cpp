/// Random damage to good files: whatever stands in a file, reading it ends in a result or in an InputError.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include "dcem/io/frame_source.hpp"
#include "dcem/io/input_error.hpp"
#include "dcem/io/scenario.hpp"
#include "tests/io/temporary_folder.hpp"

namespace test_mutations {

using namespace dcem;

namespace {

/// The same damage on every machine: only the engine of <random> is specified, its distributions are not.
class Damage {
 public:
  explicit Damage(std::uint32_t seed) : engine_(seed) {}

  std::string apply(std::string text) {
    const std::size_t count = below(3) == 0 ? 1 + below(3) : 1;
    for (std::size_t index = 0; index < count && !text.empty(); ++index) damage_once(text);
    return text;
  }

 private:
  std::size_t below(std::size_t bound) { return engine_() % bound; }

  char letter() {
    constexpr std::string_view telling = "0123456789-+.eE/# \n\r\t\\\"{}[]:,vfnux";
    return below(4) == 0 ? static_cast<char>(below(256)) : telling[below(telling.size())];
  }

  void damage_once(std::string& text) {
    const std::size_t place = below(text.size());
    const std::size_t length = std::min(1 + below(12), text.size() - place);
    switch (below(6)) {
      case 0:
        replace_digit(text, place);
        break;
      case 1:
        text[place] = letter();
        break;
      case 2:
        text.insert(place, 1, letter());
        break;
      case 3:
        text.erase(place, length);
        break;
      case 4:
        text.insert(below(text.size()), text.substr(place, length));
        break;
      default:
        text.resize(place);
    }
  }

  /// Keeps the grammar whole, so that the checks behind it get their share.
  void replace_digit(std::string& text, std::size_t from) {
    const std::size_t digit = text.find_first_of("0123456789", from);
    if (digit != std::string::npos) text[digit] = static_cast<char>('0' + below(10));
  }

  std::mt19937 engine_;
};

struct Outcomes {
  std::size_t read = 0, refused = 0;
};

/// Damages one file of a good scenario again and again; the other files stay whole.
Outcomes damage_file(const std::string& scenario, const std::string& name, std::uint32_t rounds) {
  const auto root = std::filesystem::path(DCEM_SOURCE_DIR) / "tests/invalid_input";
  const test::TemporaryFolder both;
  for (const char* part : {"good", "good_traffic", "good_antenna"}) std::filesystem::copy(root / part, both / part);
  const std::filesystem::path folder = both / scenario;
  const std::string text = test::file_bytes(folder / name);
  Outcomes outcomes;
  for (std::uint32_t round = 0; round < rounds; ++round) {
    CAPTURE(round);
    std::filesystem::remove(folder / name);  // some file systems wait for the disk when a file is overwritten
    std::ofstream(folder / name, std::ios::binary) << Damage(round).apply(text);
    try {
      const io::Scenario loaded = io::load_scenario(folder / "scenario.json");
      io::FrameSource(loaded).frame(loaded.scene, 0);
      ++outcomes.read;
    } catch (const io::InputError& error) {
      const std::string message = error.what();
      CHECK(std::none_of(message.begin(), message.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; }));
      ++outcomes.refused;
    }  // any other exception fails the test
  }
  return outcomes;
}

}  // namespace

TEST_CASE("damaged files never do worse than an InputError") {
  for (const std::string file : {"scenario.json", "room.obj", "room.mtl"}) {
    CAPTURE(file);
    const Outcomes outcomes = damage_file("good", file, 1000);
    // Both must happen, or the damage is too rough or too slight to try anything.
    CHECK(outcomes.read > 50);
    CHECK(outcomes.refused > 300);
  }
}

TEST_CASE("damaged files of traffic never do worse than an InputError") {
  for (const std::string file : {"scenario.json", "trace.fcd.xml", "vtypes.add.xml", "poses.csv"}) {
    CAPTURE(file);
    const Outcomes outcomes = damage_file("good_traffic", file, 1000);
    CHECK(outcomes.read > 50);
    CHECK(outcomes.refused > 300);
  }
}

TEST_CASE("damaged antennas never do worse than an InputError") {
  for (const std::string file : {"scenario.json", "pattern.csv", "pattern.msi", "pattern.nsm"}) {
    CAPTURE(file);
    const Outcomes outcomes = damage_file("good_antenna", file, 1000);
    CHECK(outcomes.read > 20);  // a table of twelve lines forgives little
    CHECK(outcomes.refused > 300);
  }
}

}  // namespace test_mutations
