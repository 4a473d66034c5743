/// Runs that are ended by signals, killed, and gone on with.
#include <doctest/doctest.h>
#include <zlib.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "tests/io/drawing_needed.hpp"
#include "tests/io/program_case.hpp"
#include "tests/io/result_files.hpp"
#include "tests/io/running_program.hpp"
#include "tests/support/all_tests.hpp"

namespace test_long_runs {

using namespace dcem::test;

namespace {

const std::string town = DCEM_DATA_DIR "/town_drive.json";
const std::string first_frame_done = R"({"stage":"frames","done":1,)";

std::vector<std::string> words(const std::string& text) {
  std::vector<std::string> list;
  std::istringstream stream(text);
  for (std::string word; stream >> word;) list.push_back(word);
  return list;
}

/// The number behind a key of a summary.
std::size_t number_in(const std::filesystem::path& summary, const std::string& key) {
  const std::string text = file_bytes(summary);
  const std::size_t at = text.find("\"" + key + "\": ");
  REQUIRE(at != std::string::npos);
  return std::stoul(text.substr(at + key.size() + 4));
}

const std::string arrays_and_lines = "paths,links,pdp,cfr,doppler,npz";
const std::string all_outputs = arrays_and_lines + (dcem::io::can_draw() ? ",plots" : "");
/// To draw takes as long as all the rest: where not everything is run, once is enough.
const std::string most_outputs = all_or(all_outputs, arrays_and_lines);
constexpr std::size_t frames = 12;

std::string run_town(const std::string& folder, std::size_t beyond = frames, const std::string& output = all_outputs) {
  return "run " + town + " --frames 0:" + std::to_string(beyond) + " --output " + output + " --progress json -o " +
         folder;
}

/// Starts a run and sends it a signal behind its first frame, once more where it was quicker than the signal.
int end_behind_first_frame(const TemporaryFolder& folder, const std::string& arguments, const std::string& result,
                           int signal, std::string* last_line = nullptr) {
  for (int attempt = 0; attempt < 20; ++attempt) {
    std::filesystem::remove_all(folder / result);
    RunningProgram program(folder, words(arguments + " -o " + result));
    REQUIRE(program.wait_for(first_frame_done));
    program.send(signal);
    const int code = program.end();
    if (last_line != nullptr) *last_line = program.last_line();
    if (code != 0) return code;
  }
  return 0;
}

int end_town(const TemporaryFolder& folder, const std::string& result, int signal,
             const std::string& output = all_outputs, std::string* last_line = nullptr) {
  const std::string arguments =
      "run " + town + " --frames 0:" + std::to_string(frames) + " --output " + output + " --progress json";
  return end_behind_first_frame(folder, arguments, result, signal, last_line);
}

/// The town's scenario with other settings of its list of paths.
std::string town_with(const std::string& paths) {
  std::string text = std::regex_replace(file_bytes(town), std::regex("\"obj\": *\""), "$&" DCEM_DATA_DIR "/");
  const std::string old_paths = "\"paths\": true";
  REQUIRE(text.find(old_paths) != std::string::npos);
  return text.replace(text.find(old_paths), old_paths.size(), "\"paths\": " + paths);
}

/// What a file that is compressed holds; empty where it is not whole.
std::string unpacked(const std::filesystem::path& path) {
  const gzFile file = gzopen(path.c_str(), "rb");
  if (file == nullptr) return {};
  std::string text;
  std::vector<char> block(1 << 16);
  int count = 0;
  while ((count = gzread(file, block.data(), static_cast<unsigned>(block.size()))) > 0) {
    text.append(block.data(), static_cast<std::size_t>(count));
  }
  return gzclose(file) == Z_OK && count == 0 ? text : std::string();
}

}  // namespace

TEST_CASE("Ctrl-C leaves a run that ends at its last whole frame; --resume makes it that of all frames") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  std::string said;
  REQUIRE(end_town(folder, "cut", SIGINT, all_outputs, &said) == 130);
  const std::size_t next = number_in(folder / "cut/summary.json", "next_frame");
  REQUIRE(next >= 1);
  REQUIRE(next < frames);
  CHECK(said == "interrupted by SIGINT: cut holds frames 0 to " + std::to_string(next - 1) +
                    " of frames 0 to 11; 'dcem run' with the same options and --resume goes on");

  // The same as if no more had been asked for, but for what the summary says of it.
  REQUIRE(dcem_program(folder, run_town("short", next)).exit_code == 0);
  auto cut = files_of(folder / "cut"), whole = files_of(folder / "short");
  CHECK(cut.erase("run.journal") == 1);
  for (auto* files : {&cut, &whole}) {
    std::string& summary = files->at("summary.json");
    summary =
        std::regex_replace(summary, std::regex("\"interrupted\": (null|\\{[^}]*\\})|\"identity\": \"[0-9a-f]*\""), "");
  }
  CHECK((cut == whole));

  REQUIRE(dcem_program(folder, run_town("cut") + " --resume").exit_code == 0);
  REQUIRE(dcem_program(folder, run_town("all") + " --threads 1").exit_code == 0);
  auto resumed = files_of(folder / "cut"), all = files_of(folder / "all");
  for (auto* files : {&resumed, &all}) {
    std::string& summary = files->at("summary.json");
    summary = std::regex_replace(summary, std::regex("\"threads\": [0-9]+"), "");
  }
  CHECK(names_in(folder / "cut") == names_in(folder / "all"));
  CHECK((resumed == all));
  CHECK(folder.names() == std::vector<std::string>{"all", "cut", "short"});
}

TEST_CASE("SIGTERM ends a run like Ctrl-C; where links.csv is all, its lines are what is kept") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  REQUIRE(end_town(folder, "cut", SIGTERM, "links") == 143);
  CHECK(names_in(folder / "cut") == std::vector<std::string>{"links.csv", "run.journal", "summary.json"});
  // Little more than the lines: a run of links alone must not need room for all paths.
  CHECK(std::filesystem::file_size(folder / "cut/run.journal") <
        2 * std::filesystem::file_size(folder / "cut/links.csv"));
  REQUIRE(dcem_program(folder, run_town("cut", frames, "links") + " --resume").exit_code == 0);
  REQUIRE(dcem_program(folder, run_town("all", frames, "links")).exit_code == 0);
  check_same_files(folder / "cut", folder / "all");
}

TEST_CASE("compressed lists of the strongest paths go on, too, and hold the lines of the plain file") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  const auto run = [&](const std::string& scenario, const std::string& more) {
    return dcem_program(folder, "run " + scenario + " --frames 0:12 --output paths --progress json -o " + more);
  };
  write(folder / "plain.json", town_with(R"({"top": 5})"));
  write(folder / "packed.json", town_with(R"({"top": 5, "gzip": true})"));
  REQUIRE(run("plain.json", "all").exit_code == 0);
  const std::string lines = file_bytes(folder / "all/paths.jsonl");
  REQUIRE(lines.find("\"paths_in_all\":") != std::string::npos);
  REQUIRE(end_behind_first_frame(folder, "run packed.json --frames 0:12 --output paths --progress json", "cut",
                                 SIGINT) == 130);
  CHECK(names_in(folder / "cut") == std::vector<std::string>{"paths.jsonl.gz", "run.journal", "summary.json"});
  const std::string part = unpacked(folder / "cut/paths.jsonl.gz");  // whole, as far as it goes
  CHECK((!part.empty() && part.size() < lines.size() && lines.starts_with(part)));
  REQUIRE(run("packed.json", "cut --resume").exit_code == 0);
  REQUIRE(run("packed.json", "all --threads 1").exit_code == 0);  // in place of the plain file
  CHECK(names_in(folder / "all") == std::vector<std::string>{"paths.jsonl.gz", "summary.json"});
  CHECK(names_in(folder / "cut") == names_in(folder / "all"));
  const std::string packed = file_bytes(folder / "all/paths.jsonl.gz");
  CHECK((packed == file_bytes(folder / "cut/paths.jsonl.gz")));
  CHECK((unpacked(folder / "all/paths.jsonl.gz") == lines));
  CHECK(packed.size() < lines.size() / 2);
  // Neither a name nor a time; which system packed it is not told.
  CHECK(packed.substr(3, 5) == std::string(5, '\0'));
  CHECK(packed[9] == '\xff');
}

TEST_CASE("a run may be ended and gone on with as often as one likes") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  REQUIRE(end_town(folder, "cut", SIGINT, most_outputs) == 130);
  const std::size_t first = number_in(folder / "cut/summary.json", "next_frame");
  {
    RunningProgram program(folder, words(run_town("cut", frames, most_outputs) + " --resume"));
    REQUIRE(program.wait_for(first_frame_done));
    program.send(SIGTERM);
    const int code = program.end();
    CHECK((code == 143 || code == 0));
    if (code == 143) CHECK(number_in(folder / "cut/summary.json", "next_frame") > first);
  }
  REQUIRE(dcem_program(folder, run_town("cut", frames, most_outputs) + " --resume").exit_code == 0);
  REQUIRE(dcem_program(folder, run_town("all", frames, most_outputs)).exit_code == 0);
  check_same_files(folder / "cut", folder / "all");
}

TEST_CASE("a run that is killed leaves nothing that looks finished, goes on all the same, or begins again") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  REQUIRE(dcem_program(folder, run_town("all", frames, most_outputs)).exit_code == 0);
  for (const std::string& how : all_or<std::vector<std::string>>({"", " --resume"}, {" --resume"})) {
    CAPTURE(how);
    REQUIRE(end_town(folder, "killed", SIGKILL, most_outputs) == 1000 + SIGKILL);
    for (const std::string& name : names_in(folder / "killed")) {
      CAPTURE(name);
      CHECK((name == "run.journal" || (name.starts_with('.') && name.ends_with(".part"))));
    }
    CHECK(holds(names_in(folder / "killed"), ".part"));
    REQUIRE(dcem_program(folder, run_town("killed", frames, most_outputs) + how).exit_code == 0);
    check_same_files(folder / "killed", folder / "all");
  }
}

TEST_CASE("a run that is killed spares the results of the run before it, as a whole") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  write_scenario(folder, moving_receiver);
  for (int attempt = 0;; ++attempt) {
    REQUIRE(attempt < 20);
    REQUIRE(dcem_program(folder, "run street.json -o out").exit_code == 0);
    const auto before = files_of(folder / "out");
    RunningProgram program(folder, words(run_town("out")));
    REQUIRE(program.wait_for(first_frame_done));
    program.send(SIGKILL);
    if (program.end() == 0) continue;
    auto after = files_of(folder / "out");
    std::erase_if(after, [](const auto& file) { return file.first.ends_with(".part") || file.first == "run.journal"; });
    CHECK((after == before));
    return;
  }
}

TEST_CASE("a second Ctrl-C ends at once, and the next run clears away what is left") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  // One long frame: the whole is one request away from its end.
  write_scenario(folder, R"({"id":"area","grid":{"origin_m":[-30,-9,1.5],"spacing_m":[0.1,0.1],"count":[600,180]}})");
  // Once more where the run had come to its end in order before the second signal was handed to it.
  int code = 0;
  for (int attempt = 0; attempt == 0 || std::filesystem::exists(folder / "out/summary.json"); ++attempt) {
    REQUIRE(attempt < 20);
    std::filesystem::remove_all(folder / "out");
    RunningProgram program(folder, words("run street.json --progress json -o out"));
    REQUIRE(program.wait_for(R"({"stage":"frames","done":0,)"));
    program.send(SIGINT);
    // Signals of one kind that wait are one: the second is another.
    program.send(SIGTERM);
    code = program.end();
  }
  CHECK((code == 130 || code == 143));
  CHECK_FALSE(std::filesystem::exists(folder / "out/links.csv"));
  for (const std::string& name : names_in(folder / "out")) CHECK(name.find(".part") == std::string::npos);
  write_scenario(folder, moving_receiver);
  REQUIRE(dcem_program(folder, "run street.json -o out").exit_code == 0);
  CHECK(names_in(folder / "out") == std::vector<std::string>{"links.csv", "paths.jsonl", "pdp.csv", "summary.json"});
}

TEST_CASE("a signal before the first frame ends the program, with the exit code of the signal") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  RunningProgram program(folder, words("run " + town + " --progress json -o out"));
  REQUIRE(program.wait_for(R"({"stage":"reading scenario","done":0,)"));
  program.send(SIGTERM);
  CHECK(program.end() == 143);
}

TEST_CASE("a map ends between its points: what is whole is written, and of one frame alone nothing") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  write_scenario(folder, R"({"id":"area","grid":{"origin_m":[-30,-9,1.5],"spacing_m":[0.2,0.2],"count":[300,90]}})");
  constexpr std::size_t points = 27'000;  // of a frame
  for (int code = 0, attempt = 0; code == 0; ++attempt) {
    REQUIRE(attempt < 20);
    std::filesystem::remove_all(folder / "one");
    RunningProgram program(folder, words("map street.json --frames 0:1 --progress json --output csv -o one"));
    // The second line says that points are done, and comes with the first of them.
    const auto is_at_work = [](const std::string& said) {
      const std::size_t first = said.find(R"({"stage":"points",)");
      return first != std::string::npos && said.find(R"({"stage":"points",)", first + 1) != std::string::npos;
    };
    REQUIRE(program.wait_until(is_at_work));
    program.send(SIGINT);
    code = program.end();
    if (code == 0) continue;
    CHECK(code == 130);
    CHECK(program.last_line() == "interrupted by SIGINT before the first frame was whole: nothing is written");
    CHECK_FALSE(std::filesystem::exists(folder / "one"));
  }
  // Of four frames at least one and not all: lines come ten times a second, so that the number is not known before.
  for (int attempt = 0;; ++attempt) {
    REQUIRE(attempt < 20);
    RunningProgram program(folder, words("map street.json --progress json --output csv -o many"));
    const auto first_is_whole = [](const std::string& said) {
      const std::string key = R"({"stage":"points","done":)";
      const std::size_t last = said.rfind('\n'), at = said.rfind(key, last == std::string::npos ? 0 : last);
      return at != std::string::npos && at < last && std::stoul(said.substr(at + key.size())) >= points;
    };
    program.wait_until(first_is_whole);
    program.send(SIGTERM);
    const int code = program.end();
    if (code == 0) continue;
    CHECK(code == 143);
    const std::size_t next = number_in(folder / "many/map_summary.json", "next_frame");
    CHECK(next >= 1);
    REQUIRE(dcem_program(folder, "map street.json --quiet --output csv -o all").exit_code == 0);
    for (std::size_t frame = 0; frame < 4; ++frame) {
      const std::string name = "map_area_bs_" + std::to_string(frame) + ".csv";
      CHECK(std::filesystem::exists(folder.path() / "many" / name) == (frame < next));
      if (frame < next) CHECK((file_bytes(folder.path() / "many" / name) == file_bytes(folder.path() / "all" / name)));
    }
    CHECK_FALSE(holds(names_in(folder / "many"), ".part"));
    return;
  }
}

TEST_CASE("a verification that is ended says how much it has verified") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  RunningProgram program(folder, words("verify " + town + " --progress json"));  // a quarter of a second a frame
  REQUIRE(program.wait_for(first_frame_done));
  program.send(SIGINT);
  CHECK(program.end() == 130);
  CHECK(std::regex_match(program.last_line(), std::regex("interrupted by SIGINT: [0-9]+ of 100 frames are verified")));
}

TEST_CASE("--resume wants the run that was ended: another scenario, other options and an empty folder are refused") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  std::filesystem::copy(DCEM_DATA_DIR "/town.obj", folder / "town.obj");
  std::filesystem::copy(DCEM_DATA_DIR "/town.mtl", folder / "town.mtl");
  const std::string text = file_bytes(town);
  write(folder / "drive.json", text);
  const std::string run = "run drive.json --frames 0:12 --progress json";
  REQUIRE(end_behind_first_frame(folder, run, "cut", SIGINT) == 130);
  const std::string resume = "run drive.json --frames 0:12 --resume --quiet -o ";
  const auto before = files_of(folder / "cut");
  check_refused(folder, "run drive.json --frames 0:13 --resume --quiet -o cut", "is of a run with other options");
  check_refused(folder, "run drive.json --frames 0:12 --resume --quiet --output links -o cut", "--frames 0:12)");
  check_refused(folder, resume + "empty", "nothing to resume");
  write(folder / "drive.json", text + "\n");
  check_refused(folder, resume + "cut", "drive.json: is not as it was when the run began");
  write(folder / "drive.json", text);
  const std::string walls = file_bytes(folder / "town.mtl");
  write(folder / "town.mtl", walls + "# by hand\n");
  check_refused(folder, resume + "cut", "or a file that it names is not");
  write(folder / "town.mtl", walls);
  CHECK((files_of(folder / "cut") == before));
  // The number of threads may be another.
  CHECK(dcem_program(folder, resume + "cut --threads 1").exit_code == 0);
  const Outcome again = dcem_program(folder, resume + "cut");
  CHECK(again.exit_code == 0);
  CHECK(again.error == "cut: the run is complete; nothing is left to resume\n");
  // Complete is only what was asked for.
  check_refused(folder, "run drive.json --frames 0:13 --resume --quiet -o cut", "nothing to resume");
}

TEST_CASE("a run whose frames need what was remembered says that it begins again") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  const std::string run = "run " + town + " --frames 0:12 --discovery sampled --rays 2000 --progress json";
  std::string said;
  REQUIRE(end_behind_first_frame(folder, run, "cut", SIGINT, &said) == 130);
  CHECK(said.find("with cache seed it cannot go on, only begin again") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(folder / "cut/run.journal"));
  const Outcome outcome = dcem_program(folder, run + " --resume -o cut");
  CHECK(outcome.exit_code == 0);
  CHECK(outcome.error.find("--resume: the run begins again with frame 0") != std::string::npos);
  REQUIRE(dcem_program(folder, run + " -o all").exit_code == 0);
  check_same_files(folder / "cut", folder / "all");
}

TEST_CASE("a run replaces the files of the run before it, all of them and no others") {
  DCEM_NEEDS_DRAWING();
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  write_scenario(folder, moving_receiver + "," + grid_receiver);
  REQUIRE(dcem_program(folder, "run street.json --output paths,links,npz,plots -o out").exit_code == 0);
  REQUIRE(dcem_program(folder, "map street.json --frames 0:1 --output csv -o out").exit_code == 0);
  write(folder / "out/notes.txt", "mine");
  write(folder / "out/plot_bs_mine.svg", "mine too");
  CHECK(holds(names_in(folder / "out"), "taps_bs_ue.png"));
  REQUIRE(dcem_program(folder, "run street.json --output pdp -o out").exit_code == 0);
  CHECK(names_in(folder / "out") == std::vector<std::string>{"map_area_best_server.csv", "map_area_bs.csv",
                                                             "map_summary.json", "notes.txt", "pdp.csv",
                                                             "plot_bs_mine.svg", "summary.json"});
  // A summary may say what it likes: no file outside of the folder is touched.
  write(folder / "victim.txt", "stays");
  write(folder / "out/summary.json", R"({"version":"1","totals":{},"files":["../victim.txt","pdp.csv",7,"absent"]})");
  REQUIRE(dcem_program(folder, "run street.json --output links -o out").exit_code == 0);
  CHECK(std::filesystem::exists(folder / "victim.txt"));
  CHECK_FALSE(std::filesystem::exists(folder / "out/pdp.csv"));
}

TEST_CASE("a full disk ends a run, which goes on when there is room again") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  const std::string limited = "cd " + quoted(folder.path()) + " && ( ulimit -f 4000; trap '' XFSZ; " +
                              quoted(DCEM_PROGRAM) + " run " + quoted(std::filesystem::path(town)) +
                              " --frames 0:12 --output paths --quiet -o out ) > .said 2>&1";
  const int status = std::system(limited.c_str());
  CHECK(WEXITSTATUS(status) == 2);
  CHECK(file_bytes(folder / ".said").find("; expected ") != std::string::npos);
  CHECK(names_in(folder / "out") == std::vector<std::string>{"run.journal"});
  REQUIRE(dcem_program(folder, "run " + town + " --frames 0:12 --output paths --quiet --resume -o out").exit_code == 0);
  REQUIRE(dcem_program(folder, "run " + town + " --frames 0:12 --output paths --quiet -o all").exit_code == 0);
  check_same_files(folder / "out", folder / "all");
}

}  // namespace test_long_runs
