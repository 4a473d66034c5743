#pragma once
/// The program `dcem` at work in a folder of its own: a street to run it on, and what came of it.
#include <doctest/doctest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/io/temporary_folder.hpp"
#include "tests/support/last_command.hpp"

namespace dcem::test {

/// What a call of the program gave.
struct Outcome {
  int exit_code = -1;
  std::string output, error;
};

inline std::string quoted(const std::filesystem::path& path) {
  return "'" + path.string() + "'";
}

/// What a line of the shell gives that is said in a folder.
inline Outcome shell_line(const TemporaryFolder& folder, const std::string& line) {
  const auto output = folder / ".stdout", error = folder / ".stderr";
  const std::string command =
      "cd " + quoted(folder.path()) + " && " + line + " > " + quoted(output) + " 2> " + quoted(error);
  const int status = std::system(command.c_str());
  Outcome outcome{WIFEXITED(status) ? WEXITSTATUS(status) : -1, file_bytes(output), file_bytes(error)};
  std::filesystem::remove(output);
  std::filesystem::remove(error);
  last_command() = {line, outcome.error, outcome.exit_code};
  return outcome;
}

inline Outcome dcem_program(const TemporaryFolder& folder, const std::string& arguments) {
  return shell_line(folder, quoted(DCEM_PROGRAM) + " " + arguments);
}

inline void write(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path) << text;
}

// Two walls of a street, with the ground.
inline void write_scene(const TemporaryFolder& folder) {
  write(folder / "street.mtl", "newmtl wall\nem_model constant\nem_reflection 0.8\n");
  write(folder / "street.obj",
        "mtllib street.mtl\nusemtl wall\n"
        "v -40 -10 0\nv 40 -10 0\nv 40 -10 12\nv -40 -10 12\nv -40 10 0\nv 40 10 0\nv 40 10 12\nv -40 10 12\n"
        "f 1 2 3 4\nf 5 6 7 8\nf 1 2 6 5\n");
}

inline std::string scenario(const std::string& receivers, const std::string& more = "") {
  return R"({"format":"dcem-scenario/1","scene":{"obj":"street.obj"},"frequency_hz":28e9,)"
         R"("time":{"start_s":0,"step_s":0.5,"frames":4},)"
         R"("transmitters":[{"id":"bs","position_m":[-20,1.25,5],"power_dbm":30}],)"
         R"("receivers":[)" +
         receivers +
         R"(],"propagation":{"max_reflections":2,"max_transmissions":0,"max_diffractions":0,)"
         R"("discovery":"exact"},"output":{"paths":true,"links":true,"pdp":{"bin_s":1e-9}})" +
         more + "}";
}

inline const std::string moving_receiver = R"({"id":"ue","position_m":[15,2,1.5],"velocity_mps":[3,0,0]})";
inline const std::string grid_receiver =
    R"({"id":"area","grid":{"origin_m":[-5,-12,1.5],"spacing_m":[2,2],"count":[3,13]}})";

inline void write_scenario(const TemporaryFolder& folder, const std::string& receivers, const std::string& more = "") {
  write_scene(folder);
  write(folder / "street.json", scenario(receivers, more));
}

// One line on the error stream, and not a file that was not there before.
inline void check_refused(const TemporaryFolder& folder, const std::string& arguments, const std::string& said) {
  CAPTURE(arguments);
  const auto before = folder.names();
  const Outcome outcome = dcem_program(folder, arguments);
  CAPTURE(outcome.error);
  CHECK(outcome.exit_code == 2);
  CHECK(outcome.output.empty());
  CHECK(std::count(outcome.error.begin(), outcome.error.end(), '\n') == 1);
  CHECK(outcome.error.find(said) != std::string::npos);
  CHECK(outcome.error.find("; expected ") != std::string::npos);
  CHECK(folder.names() == before);
}

}  // namespace dcem::test

#define DCEM_NEEDS_PROGRAM()                                  \
  if (!std::filesystem::exists(DCEM_PROGRAM)) {               \
    MESSAGE("skipped: there is no program at " DCEM_PROGRAM); \
    return;                                                   \
  }                                                           \
  static_assert(true, "asks for a semicolon")
