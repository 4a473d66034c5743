/// Runs in parts, and what `dcem merge` makes of them.
#include <doctest/doctest.h>

#include <csignal>
#include <filesystem>
#include <regex>
#include <string>
#include <vector>

#include "dcem/io/shards.hpp"
#include "tests/io/drawing_needed.hpp"
#include "tests/io/program_case.hpp"
#include "tests/io/result_files.hpp"
#include "tests/io/running_program.hpp"
#include "tests/support/all_tests.hpp"

namespace test_shards {

using namespace dcem::test;

namespace {

const std::string town = DCEM_DATA_DIR "/town_drive.json";

/// Files beside which no other is checked, and of which the viewer, where it is built, is the last.
const std::string all_outputs = std::string("paths,links,pdp,cfr,doppler,npz") + (dcem::io::can_draw() ? ",plots" : "");

std::string part_name(const std::string& result, int part, int parts) {
  return result + '.' + std::to_string(part) + '.' + std::to_string(parts);
}

/// Runs all parts, each with a number of threads of its own, and merges them, the last one first.
Outcome run_in_parts(const TemporaryFolder& folder, const std::string& run, const std::string& result, int parts) {
  std::string merge = "merge";
  for (int part = 0; part < parts; ++part) {
    const std::string name = part_name(result, part, parts);
    const Outcome outcome =
        dcem_program(folder, run + " --shard " + std::to_string(part) + '/' + std::to_string(parts) + " --threads " +
                                 std::to_string(1 + part % 3) + " -o " + name);
    CAPTURE(outcome.error);
    REQUIRE(outcome.exit_code == 0);
    CHECK(names_in(folder / name) == std::vector<std::string>{"run.journal", "summary.json"});
  }
  for (int part = parts - 1; part >= 0; --part) merge += ' ' + part_name(result, part, parts);
  return dcem_program(folder, merge + " -o " + result);
}

/// In two, seven and, with all tests, one and three parts the run has the bytes that it has as a whole.
void check_parts(const TemporaryFolder& folder, const std::string& run) {
  REQUIRE(dcem_program(folder, run + " -o whole").exit_code == 0);
  for (const int parts : all_or<std::vector<int>>({1, 2, 3, 7}, {2, 7})) {
    CAPTURE(parts);
    const std::string result = "merged" + std::to_string(parts);
    const Outcome outcome = run_in_parts(folder, run, result, parts);
    CAPTURE(outcome.error);
    REQUIRE(outcome.exit_code == 0);
    check_same_files(folder / result, folder / "whole");
  }
}

/// Cars in a row, each with a device, that come and go.
void write_traffic(const TemporaryFolder& folder) {
  write_scene(folder);
  write(folder / "types.xml", R"(<additional><vType id="car" length="4" width="2" height="1.5"/></additional>)");
  std::string trace = "<fcd-export>\n";
  for (int step = 0; step < 4; ++step) {
    trace += "<timestep time=\"" + std::to_string(step) + "\">\n";
    for (int car = step; car < 5 + step; ++car) {
      trace += "<vehicle id=\"c" + std::to_string(car) + "\" x=\"" + std::to_string(8 * car - 30 + step) + "\" y=\"" +
               std::to_string(car % 3 - 1) + "\" angle=\"90\" type=\"car\" speed=\"1\"/>\n";
    }
    trace += "</timestep>\n";
  }
  write(folder / "trace.xml", trace + "</fcd-export>\n");
  write(folder / "traffic.json",
        R"({"format":"dcem-scenario/1","scene":{"obj":"street.obj"},"frequency_hz":28e9,)"
        R"("materials":{"metal":{"model":"pec"}},"mobility":{"sumo_fcd":"trace.xml","vehicle_types":"types.xml",)"
        R"("material":"metal","devices":{"vehicles":"all","power_dbm":23}},"links":{"range_m":20},)"
        R"("transmitters":[{"id":"bs","position_m":[-20,1.25,5],"power_dbm":30}],)"
        R"("receivers":[{"id":"ue","position_m":[15,2,1.5]}],)"
        R"("propagation":{"max_reflections":1,"max_diffractions":1,"max_transmissions":0}})");
}

std::string grown(const std::string& text, const std::string& from, const std::string& to) {
  REQUIRE(text.find(from) != std::string::npos);
  return std::string(text).replace(text.find(from), from.size(), to);
}

}  // namespace

TEST_CASE("parts that are merged have the bytes of the run as a whole: every kind of result") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  check_parts(folder, "run " + town + " --frames 3:8 --output " + all_outputs);
}

TEST_CASE("parts that are merged have the bytes of the run as a whole: links alone, with each cache") {
  DCEM_NEEDS_PROGRAM();
  for (const std::string cache : {"off", "exact"}) {
    CAPTURE(cache);
    const TemporaryFolder folder;
    check_parts(folder, "run " + town + " --frames 0:4 --output links --cache " + cache);
  }
}

TEST_CASE("parts that are merged have the bytes of the run as a whole: rays, and what they are said to miss") {
  DCEM_NEEDS_PROGRAM();
  for (const std::string cache : {"off", "seed"}) {
    CAPTURE(cache);
    const TemporaryFolder folder;
    check_parts(folder, "run " + town + " --frames 0:5 --output links --discovery sampled --rays 500 --cache " + cache);
    CHECK(file_bytes(folder / "merged2/summary.json").find("\"missing_p95_db\"") != std::string::npos);
  }
}

TEST_CASE("parts that are merged have the bytes of the run as a whole: vehicles that come and go, links by range") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  write_traffic(folder);
  check_parts(folder, "run traffic.json --output links,paths");
  // Each link once: a table without lines would merge, too.
  const std::string links = file_bytes(folder / "whole/links.csv");
  CHECK(std::count(links.begin(), links.end(), '\n') > 20);
}

TEST_CASE("parts that are merged have the bytes of the run as a whole: grids, and pairs") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  write_scenario(folder, moving_receiver + ',' + grid_receiver);
  check_parts(folder, "run street.json");
  const TemporaryFolder other;
  write_scenario(other, moving_receiver + R"(,{"id":"probe","positions_m":[[0,1,1.5],[5,1,1.5],[9,2,1.5]]})",
                 R"(,"links":{"pairs":[["bs","ue"],["bs","probe[0]"],["bs","probe[2]"]]})");
  check_parts(other, "run street.json");
}

TEST_CASE("a part that was killed is run again alone, or goes on, and merges all the same") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  const std::string run = "run " + town + " --frames 0:12 --progress json";
  REQUIRE(dcem_program(folder, run + " -o whole").exit_code == 0);
  REQUIRE(dcem_program(folder, run + " --shard 1/2 -o one").exit_code == 0);
  for (const std::string how : {"", " --resume"}) {
    CAPTURE(how);
    int code = 0;
    for (int attempt = 0; code == 0 && attempt < 20; ++attempt) {
      std::filesystem::remove_all(folder / "zero");
      RunningProgram program(folder,
                             {"run", town, "--frames", "0:12", "--progress", "json", "--shard", "0/2", "-o", "zero"});
      REQUIRE(program.wait_for(R"({"stage":"frames","done":1,)"));
      program.send(SIGKILL);
      code = program.end();
    }
    REQUIRE(code == 1000 + SIGKILL);
    check_refused(folder, "merge zero one -o both", "zero: holds a part that is not whole");
    REQUIRE(dcem_program(folder, run + " --shard 0/2 -o zero" + how).exit_code == 0);
    REQUIRE(dcem_program(folder, "merge zero one -o both").exit_code == 0);
    check_same_files(folder / "both", folder / "whole");
    std::filesystem::remove_all(folder / "both");
  }
  // What is whole is left as it is.
  const Outcome again = dcem_program(folder, run + " --shard 0/2 -o zero --resume");
  CHECK(again.exit_code == 0);
  CHECK(again.error.find("zero: the part is complete; nothing is left to resume") != std::string::npos);
}

TEST_CASE("Ctrl-C leaves a part that goes on") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  const std::string run = "run " + town + " --frames 0:12";
  int code = 0;
  for (int attempt = 0; code == 0 && attempt < 20; ++attempt) {
    RunningProgram program(folder,
                           {"run", town, "--frames", "0:12", "--progress", "json", "--shard", "0/1", "-o", "part"});
    REQUIRE(program.wait_for(R"({"stage":"frames","done":1,)"));
    program.send(SIGINT);
    code = program.end();
    if (code != 0) CHECK(program.last_line().ends_with("'dcem run' with the same options and --resume goes on"));
  }
  REQUIRE(code == 130);
  check_refused(folder, "merge part -o all", "part: holds a part that is not whole");
  REQUIRE(dcem_program(folder, run + " --shard 0/1 -o part --resume").exit_code == 0);
  REQUIRE(dcem_program(folder, "merge part -o all").exit_code == 0);
  REQUIRE(dcem_program(folder, run + " -o whole").exit_code == 0);
  check_same_files(folder / "all", folder / "whole");
}

TEST_CASE("what are no parts of one run is refused in one line") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  write_scenario(folder, moving_receiver + ',' + grid_receiver);
  const auto part = [&](const std::string& shard, const std::string& more) {
    REQUIRE(dcem_program(folder, "run street.json --shard " + shard + " -o " + more).exit_code == 0);
  };
  part("0/2", "zero");
  part("1/2", "one");
  part("1/2", "one-again");
  part("1/2", "other --output links");
  part("1/2", "fewer --frames 0:2");
  part("2/3", "of-three");
  REQUIRE(dcem_program(folder, "run street.json -o whole").exit_code == 0);
  check_refused(folder, "merge zero", "zero: part 1/2 is in none of the folders; expected each of the 2 parts once");
  check_refused(folder, "merge zero one one-again", "one-again: holds part 1/2 as one does");
  for (const std::string name : {"other", "fewer", "of-three"}) {
    check_refused(folder, "merge zero " + name, name + ": is of another run than zero");
  }
  check_refused(folder, "merge zero whole", "whole: holds no part of a run");
  check_refused(folder, "merge zero nowhere", "nowhere: holds no part of a run");
  check_refused(folder, "merge zero one -o one", "one: is the folder of a part");
  check_refused(folder, "merge zero one --scenario gone.json", "gone.json: is not there");

  const std::string journal = file_bytes(folder / "one/run.journal");
  write(folder / "one/run.journal", journal.substr(0, journal.size() - 5));
  check_refused(folder, "merge zero one", "one: holds 3 whole frames; expected all 4");
  const std::size_t middle = journal.size() / 2;
  write(folder / "one/run.journal", journal.substr(0, middle) + '\1' + journal.substr(middle + 1));
  check_refused(folder, "merge zero one", "one/run.journal: is damaged");
  write(folder / "one/run.journal", journal);
  const std::string summary = file_bytes(folder / "one/summary.json");
  write(folder / "one/summary.json", grown(summary, "\"part\": 1", "\"part\": \"one\""));
  check_refused(folder, "merge zero one", "summary.json: is damaged");
  write(folder / "one/summary.json", summary.substr(0, summary.size() / 2));
  check_refused(folder, "merge zero one", "one: holds no part of a run");
  write(folder / "one/summary.json", summary);
  write(folder / "street.json", file_bytes(folder / "street.json") + "\n");
  check_refused(folder, "merge zero one", "is not as it was when the run began");
}

TEST_CASE("a scenario that has moved is found where --scenario says") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  write_scenario(folder, moving_receiver);
  REQUIRE(dcem_program(folder, "run street.json -o whole").exit_code == 0);
  REQUIRE(dcem_program(folder, "run street.json --shard 0/1 -o part").exit_code == 0);
  std::filesystem::create_directory(folder / "there");
  for (const std::string name : {"street.json", "street.obj", "street.mtl"}) {
    std::filesystem::rename(folder / name, folder / "there" / name);
  }
  CHECK(dcem_program(folder, "merge part -o lost").exit_code == 2);
  REQUIRE(dcem_program(folder, "merge part --scenario there/street.json -o all").exit_code == 0);
  check_same_files(folder / "all", folder / "whole");
}

TEST_CASE("a part has a folder of its own by default, and says what it is") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  write_scenario(folder, moving_receiver);
  const Outcome outcome = dcem_program(folder, "run street.json --shard 0/2");
  CHECK(outcome.exit_code == 0);
  CHECK(outcome.output.find("0/2") != std::string::npos);
  CHECK(std::filesystem::exists(folder / "out/street.shard-0-of-2/run.journal"));
  // More parts than receivers: the others have no links.
  REQUIRE(dcem_program(folder, "run street.json --shard 1/2").exit_code == 0);
  REQUIRE(dcem_program(folder, "merge out/street.shard-0-of-2 out/street.shard-1-of-2").exit_code == 0);
  REQUIRE(dcem_program(folder, "run street.json -o whole").exit_code == 0);
  check_same_files(folder / "out/street", folder / "whole");
}

TEST_CASE("what is no part is bad usage") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  write_scenario(folder, moving_receiver);
  for (const std::string shard : {"2/2", "0/0", "1", "a/b", "1/2x", "-1/2", "1/2/3", "0/1000001", "1/99999999999"}) {
    check_refused(folder, "run street.json --shard=" + shard, "--shard ");
  }
}

TEST_CASE("frames that differ are not one frame") {
  std::vector<dcem::io::JournalEntry> parts(2);
  parts[1].figures.index = 1;
  CHECK_THROWS_AS(dcem::io::joined_entry(std::move(parts)), std::invalid_argument);
}

}  // namespace test_shards
