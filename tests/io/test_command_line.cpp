/// What the command line takes: help, options without effect, completion.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "tests/io/program_case.hpp"

namespace test_command_line {

using namespace dcem::test;

namespace {

using Words = std::set<std::string>;

/// "--threads" and the like, as the help has them at the start of its lines.
Words options_in_help(const std::string& help) {
  static const std::regex line(R"((?:^|\n)  (-[^ ]+))"), name("--?[a-z][a-z-]*");
  Words names;
  for (std::sregex_iterator at(help.begin(), help.end(), line), end; at != end; ++at) {
    const std::string text = (*at)[1];
    for (std::sregex_iterator one(text.begin(), text.end(), name); one != end; ++one) names.insert(one->str());
  }
  return names;
}

Words commands_in_help(const std::string& help) {
  static const std::regex line(R"(\n  ([a-z]+) )");
  Words names;
  const std::string list = help.substr(help.find("Subcommands:"));
  for (std::sregex_iterator at(list.begin(), list.end(), line), end; at != end; ++at) names.insert((*at)[1]);
  return names;
}

Words operator+(Words words, const Words& more) {
  words.insert(more.begin(), more.end());
  return words;
}

const Words common{"-h",     "--help", "--threads",   "--memory-limit", "--frames",   "--discovery",
                   "--rays", "--seed", "--frequency", "--instructions", "--progress", "--quiet"};

std::string script_of(const TemporaryFolder& folder, const std::string& shell) {
  const Outcome outcome = dcem_program(folder, "completion " + shell);
  REQUIRE(outcome.exit_code == 0);
  CHECK(outcome.error.empty());
  return outcome.output;
}

/// What bash offers behind these words, the last of which is not yet finished; `told` of it is printed.
std::string offered(const TemporaryFolder& folder, const std::string& line,
                    const std::string& told = "${COMPREPLY[*]}") {
  const std::string command = "cd " + quoted(folder.path()) +
                              " && bash -c 'files=yes; compopt() { [[ \"$*\" != \"+o default\" ]] || files=; }; " +
                              "source dcem.bash; COMP_WORDS=(dcem " + line +
                              "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _dcem; " + "echo \"" + told + "\"' > offered";
  CHECK(std::system(command.c_str()) == 0);
  std::string words = file_bytes(folder / "offered");
  if (!words.empty()) words.pop_back();
  return words;
}

/// Whether the shell is left to offer files.
bool offers_files(const TemporaryFolder& folder, const std::string& line) {
  return offered(folder, line).empty() && offered(folder, line, "$files") == "yes";
}

bool has_program(const std::string& name) {
  return std::system(("command -v " + name + " > /dev/null 2>&1").c_str()) == 0;
}

}  // namespace

TEST_CASE("the help of each command lists exactly what it takes") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  const std::vector<std::pair<std::string, Words>> expected{
      {"run", common + Words{"--cache", "-o", "--output", "--resume", "--shard"}},
      {"merge", {"-h", "--help", "-o", "--scenario", "--threads", "--memory-limit", "--progress", "--quiet"}},
      {"map", common + Words{"-o", "--output"}},
      {"verify", common + Words{"--cache"}},
      {"inspect", {"-h", "--help", "--json", "--up", "--unit-m", "--frequency-hz"}},
      {"compare", {"-h", "--help", "-o", "--output", "--column", "--second-column"}},
      {"completion", {"-h", "--help"}}};
  const Words commands = commands_in_help(dcem_program(folder, "--help").output);
  for (const auto& one : expected) {
    CAPTURE(one.first);
    CHECK(commands.contains(one.first));
    CHECK(options_in_help(dcem_program(folder, one.first + " --help").output) == one.second);
  }
  const std::string run = dcem_program(folder, "run --help").output, map = dcem_program(folder, "map --help").output;
  CHECK(run.find("{paths,links,pdp,cfr,doppler,npz,mat,hdf5,qd,p2m,deepmimo,kml,gltf,plots,html}") !=
        std::string::npos);
  CHECK(map.find("{csv,png,npz,asc,svg,pdf,kml,html}") != std::string::npos);
  CHECK(dcem_program(folder, "inspect --help").output.find("not in this version") == std::string::npos);
}

TEST_CASE("an option that would change nothing is refused, not ignored") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  write_scenario(folder, moving_receiver + "," + grid_receiver);  // asks for exact discovery
  for (const std::string command : {"run", "map", "verify"}) {
    check_refused(folder, command + " street.json --rays 100", "--rays has no effect");
    check_refused(folder, command + " street.json --seed 7", "--seed has no effect");
    check_refused(folder, command + " street.json --quiet --progress json", "--quiet");
  }
  check_refused(folder, "map street.json --cache off", "--cache");
  check_refused(folder, "map street.json --resume", "--resume");
  check_refused(folder, "verify street.json --resume", "--resume");
  check_refused(folder, "verify street.json -o out", "-o");
  check_refused(folder, "verify street.json --output links", "--output");
  for (const char* key : {"links", "map", "pdp", ""}) {
    check_refused(folder, "map street.json --output 'csv," + std::string(key) + "'", "is no file of 'dcem map'");
  }
  write_scenario(folder, R"({"id":"probe","positions_m":[[1,2,3]]})");
  check_refused(folder, "map street.json --output asc", "--output has no effect");
  for (const std::string option : {"--level-height-m 4", "--tree-height-m 4", "--poly street.json", "--fcd street.json",
                                   "--additional street.json"}) {
    check_refused(folder, "import gemv2 . -o made " + option, option.substr(0, option.find(' ')) + " has no effect");
  }
  // What has an effect gets as far as the folder, which holds nothing of GEMV2.
  for (const char* option :
       {"--default-height-m 4", "--touching snap", "--ground-margin-m 4", "--snap-tolerance-m 1"}) {
    const Outcome outcome = dcem_program(folder, "import gemv2 . -o made " + std::string(option));
    CHECK(outcome.exit_code == 2);
    CHECK(outcome.error.find("has no effect") == std::string::npos);
  }
  for (const char* option :
       {"--touching snap", "--ground-margin-m 4", "--snap-tolerance-m 1", "--smallest-house-sqm 4"}) {
    check_refused(folder, "import sionna street.json -o made " + std::string(option), "has no effect on 'sionna'");
  }
  check_refused(folder, "run street.json --output links,map",
                "--output: 'map' is no file of 'dcem run' (did you mean 'mat'?); expected some of paths, links");
  check_refused(folder, "run street.json --output foo",
                "'foo' is no file of 'dcem run'; expected some of paths, links");
  check_refused(folder, "run street.json --output paths,links,paths",
                "'paths' is there twice; expected each word once");
  check_refused(folder, "map street.json --output png,png", "'png' is there twice; expected each word once");
  check_refused(folder, "run street.json --fast 'two words'", "'--fast', 'two words' are not expected");
  check_refused(folder, "completion tcsh", "tcsh");
  // Where rays are shot they have an effect.
  const Outcome sampled =
      dcem_program(folder, "run street.json --discovery sampled --rays 100 --seed 7 --quiet --frames 0:1 -o out");
  CHECK(sampled.exit_code == 0);
}

TEST_CASE("numbers that are none and names that are empty are refused by the option's name") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  write_scenario(folder, moving_receiver + "," + grid_receiver);
  const std::string huge = "99999999999999999999999";
  for (const std::string command : {"run", "map", "verify"}) {
    for (const std::string option : {"--seed", "--rays"}) {
      const std::string call = command + " street.json " + option + ' ';
      check_refused(folder, call + huge,
                    "command line: " + option + ": found '" + huge + "'; expected a whole number of");
      check_refused(folder, call + "-" + huge,
                    option + ": found '-" + huge + "'; expected a whole number of at most 18");
      check_refused(folder, call + "abc", option + ": found 'abc'; expected a whole number");
      check_refused(folder, call + "1.5", option + ": found '1.5'; expected a whole number");
    }
    for (const std::string& threads :
         {huge, std::string("-1"), std::string("0"), std::string("4097"), std::string("x")}) {
      check_refused(folder, command + " street.json --threads " + threads,
                    "--threads: found '" + threads + "'; expected a whole number from 1 to 4096");
    }
    check_refused(folder, command + " ''", "scenario: an empty name; expected the name of a file or folder");
  }
  for (const char* const call :
       {"run street.json", "map street.json", "merge street.json", "compare a.csv b.csv", "import osm street.json"}) {
    check_refused(folder, std::string(call) + " -o ''", "command line: -o: an empty name; expected the name of a");
  }
  check_refused(folder, "import sumo '' -o made", "source: an empty name");
  check_refused(folder, "import sumo street.json -o made --poly ''", "--poly: an empty name");
  check_refused(folder, "import sumo street.json -o made --terrain ''", "--terrain: an empty name");
  check_refused(folder, "import osm street.json -o made --tree-height-m x",
                "--tree-height-m: found 'x'; expected a number");
  check_refused(folder, "import osm street.json -o made --frequency-hz 1e999",
                "--frequency-hz: found '1e999'; expected");
}

TEST_CASE("what is foreseen to take more than --memory-limit is refused, with both figures") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  write_scenario(folder, moving_receiver + "," + grid_receiver);
  for (const std::string command : {"run", "map", "verify"}) {
    check_refused(folder, command + " street.json --memory-limit 10K", "grid 'area': 39 points need ");
    check_refused(folder, command + " street.json --memory-limit 10240", "expected at most 10 kB, the --memory-limit");
    CHECK(dcem_program(folder, command + " street.json --frames 0:1 --memory-limit 1M").exit_code == 0);
    std::filesystem::remove_all(folder / "out");
    for (const char* amount : {"0", "-1", "1T", "1.5G", "G", "10KB", "9999999999999G", "''"}) {
      check_refused(folder, command + " street.json --memory-limit " + amount, "--memory-limit");
    }
  }
  // Many receivers without a grid, and arrays.
  std::string points = "[0,0,1]";
  for (int index = 1; index < 100; ++index) points += ",[" + std::to_string(index) + ",0,1]";
  write_scenario(folder, R"({"id":"probe","positions_m":[)" + points + "]}");
  check_refused(folder, "map street.json --memory-limit 10K", "list 'probe': 100 points need ");
  for (const std::string command : {"run", "verify"}) {
    check_refused(folder, command + " street.json --memory-limit 10K", "100 links of a frame need ");
  }
  check_refused(folder, "run street.json --output cfr --memory-limit 1M",
                "the responses of this run need 1638 kB; expected at most 1049 kB, the limit of memory");
}

TEST_CASE("the lines of --help fit a terminal") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  for (const char* command : {"--help", "run --help", "map --help", "import --help", "--help-all"}) {
    const Outcome help = dcem_program(folder, command);
    CHECK(help.exit_code == 0);
    CHECK(help.output.size() > 500);
    std::istringstream lines(help.output);
    for (std::string line; std::getline(lines, line);) {
      CAPTURE(line);
      // Words of an option that are one word for the shell are not broken.
      CHECK((line.size() <= 105 || line.find(' ', 105) == std::string::npos));
    }
  }
}

TEST_CASE("a folder holds results of one scenario, whichever command writes there") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  write_scenario(folder, R"({"id":"ue","positions_m":[[1,2,3]]})");
  std::filesystem::copy_file(folder / "street.json", folder / "other.json");
  REQUIRE(dcem_program(folder, "run street.json -o out --quiet").exit_code == 0);
  check_refused(
      folder, "map other.json -o out",
      "out/summary.json: belongs to the results of scenario 'street', not of 'other'; expected another folder (-o)");
  REQUIRE(dcem_program(folder, "map street.json -o out --quiet").exit_code == 0);
  check_refused(folder, "run other.json -o out", "out/map_summary.json: belongs to the results of scenario 'street'");
}

TEST_CASE("a run of more frames than memory has room for is refused before it begins") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  write_scenario(folder, R"({"id":"ue","position_m":[1,2,3]})");
  std::string text = file_bytes(folder / "street.json");
  const std::size_t begin = text.find("\"frames\"");
  REQUIRE(begin != std::string::npos);
  text.replace(begin, text.find_first_of(",}", begin) - begin, "\"frames\": 1000000000");
  write(folder / "street.json", text);
  check_refused(folder, "run street.json --memory-limit 1G", "1000000000 frames need ");
}

TEST_CASE("--output of a map picks its files") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  write_scenario(folder, grid_receiver);
  REQUIRE(dcem_program(folder, "map street.json --frames 0:1 --quiet --output npz,asc -o out").exit_code == 0);
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "out")) {
    names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  CHECK(names == std::vector<std::string>{"map_area_best_server.asc", "map_area_best_server.npz", "map_area_bs.asc",
                                          "map_area_bs.npz", "map_summary.json"});
}

TEST_CASE("completions know every command and every option, since they come from where the help comes from") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  const Words commands = commands_in_help(dcem_program(folder, "--help").output);
  REQUIRE(commands.size() >= 6);
  for (const std::string shell : {"bash", "zsh", "fish"}) {
    CAPTURE(shell);
    const std::string script = script_of(folder, shell);
    for (const std::string& command : commands) {
      CAPTURE(command);
      CHECK(std::regex_search(script, std::regex("\\b" + command + "\\b")));
      const Words options = options_in_help(dcem_program(folder, command + " --help").output);
      CHECK(options.size() >= 2);
      // The part of the script that is about this command.
      const std::string begin = shell == "bash"  ? "    " + command + ") options="
                                : shell == "zsh" ? "      " + command + ")\n"
                                                 : "";
      const std::size_t first = script.find(begin);
      REQUIRE(first != std::string::npos);
      const std::string part = shell == "fish" ? script : script.substr(first, script.find(";;", first) - first);
      for (const std::string& option : options) {
        CAPTURE(option);
        const std::string in_fish = "__fish_seen_subcommand_from " + command + "'[^\n]*" +
                                    (option.starts_with("--") ? " -l " + option.substr(2) : " -s " + option.substr(1)) +
                                    "\\b";
        CHECK(std::regex_search(part, std::regex(shell == "fish" ? in_fish : "[' \"]" + option + "['\\[ \"]")));
      }
    }
  }
}

TEST_CASE("bash completes commands, options, words and lists of words") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  write(folder / "dcem.bash", script_of(folder, "bash"));
  if (!has_program("bash")) return;
  CHECK(offered(folder, "ver") == "verify");
  CHECK(offered(folder, "--v") == "--version");
  CHECK(offered(folder, "run --res") == "--resume");
  CHECK(offered(folder, "map --res").empty());
  CHECK(offered(folder, "run street.json --discovery \"\"") == "exact sampled");
  CHECK(offered(folder, "run street.json --progress j") == "json");
  CHECK(offered(folder, "run street.json --output p") == "paths pdp p2m plots");
  CHECK(offered(folder, "run street.json --output links,pd") == "links,pdp");
  CHECK(offered(folder, "map street.json --output links,dop").empty());
  CHECK(offered(folder, "completion \"\"") == "bash zsh fish");
  CHECK(offered(folder, "import \"\"") == "sumo gemv2 sionna osm");
  CHECK(offers_files(folder, "run str"));
  CHECK(offers_files(folder, "import sumo ne"));
  CHECK(offers_files(folder, "import sumo net.xml --poly po"));
  CHECK(offers_files(folder, "merge one two --scenario st"));
  CHECK_FALSE(offers_files(folder, "run street.json --threads \"\""));
}

TEST_CASE("zsh and fish read their scripts") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  for (const std::string shell : {"zsh", "fish"}) {
    if (!has_program(shell)) {
      MESSAGE("skipped: there is no " << shell);
      continue;
    }
    write(folder / "script", script_of(folder, shell));
    CHECK(std::system((shell + " -n " + quoted(folder / "script")).c_str()) == 0);
  }
}

TEST_CASE("programs hear of every stage, in order") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  write_scenario(folder, moving_receiver + "," + grid_receiver);
  const auto stages_of = [&](const std::string& arguments) {
    const Outcome outcome = dcem_program(folder, arguments + " --progress json");
    CHECK(outcome.exit_code == 0);
    static const std::regex line(
        R"re(\{"stage":"([a-z ]+)","done":[0-9]+,"total":[0-9]+,"elapsed_s":[0-9]+\.[0-9]{3},"remaining_s":(?:null|[0-9]+\.[0-9]{3})\}\n)re");
    CHECK(std::regex_replace(outcome.error, line, "").empty());
    std::vector<std::string> stages;
    for (std::sregex_iterator at(outcome.error.begin(), outcome.error.end(), line), end; at != end; ++at) {
      if (stages.empty() || stages.back() != (*at)[1]) stages.push_back((*at)[1]);
    }
    return stages;
  };
  using Stages = std::vector<std::string>;
  CHECK(stages_of("run street.json -o r") == Stages{"reading scenario", "building tree", "frames", "writing results"});
  CHECK(stages_of("map street.json --frames 0:1 --output csv -o m") ==
        Stages{"reading scenario", "building tree", "points", "writing results"});
  CHECK(stages_of("verify street.json --frames 0:1") == Stages{"reading scenario", "building tree", "frames"});
}

}  // namespace test_command_line
