/// The program `dcem`: command line in, exit code out. 0 done; 1 the run failed; 2 bad input or bad usage.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <map>
#include <string>
#include <vector>

#include "dcem/core/instruction_set.hpp"
#include "dcem/io/atomic_file.hpp"
#include "dcem/io/input_error.hpp"
#include "options.hpp"

#ifndef DCEM_VERSION
#define DCEM_VERSION "unknown"
#endif

namespace dcem::program {
namespace {

constexpr int exit_failed = 1;
constexpr int exit_bad_input = 2;

const std::map<std::string, io::ProgressMode> progress_modes{
    {"auto", io::ProgressMode::automatic}, {"always", io::ProgressMode::always}, {"never", io::ProgressMode::never}};
const std::map<std::string, io::UpAxis> up_axes{{"y", io::UpAxis::y}, {"z", io::UpAxis::z}};

constexpr const char* command_names = "run, map, verify, inspect, compare, keys or schema";

struct Options {
  ScenarioOptions scenario;
  InspectOptions inspect;
  CompareOptions compare;
  KeysOptions keys;
};

// An option that takes one of a few words.
template <typename Value>
CLI::Option* add_choice(CLI::App& command, const std::string& name, const std::string& does,
                        const std::map<std::string, Value>& choices, Value& chosen) {
  std::vector<std::string> words;
  for (const auto& choice : choices) words.push_back(choice.first);
  return command
      .add_option_function<std::string>(
          name, [&](const std::string& word) { chosen = choices.at(word); }, does)
      ->check(CLI::IsMember(words));
}

const std::map<std::string, InstructionSet> instruction_sets{
    {"baseline", InstructionSet::baseline}, {"avx2", InstructionSet::avx2}, {"avx512", InstructionSet::avx512}};

void choose_instructions(const std::string& word) {
  try {
    select_instruction_set(instruction_sets.at(word));
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what(), "a level that this processor has");
  }
}

std::string version_text() {
  return "dcem " DCEM_VERSION "\nrays are traced with: " + std::string(name_of(instruction_set()));
}

void add_common_options(CLI::App& command, ScenarioOptions& options) {
  command.add_option("scenario", options.scenario, "The scenario file (JSON)")->required()->type_name("SCENARIO.json");
  command.add_option("--threads", options.threads, "Number of threads (default: all cores); never changes a result")
      ->check(CLI::Range(1U, 4096U))
      ->type_name("N");
  command.add_option("--frames", options.frames, "Only the frames A to B - 1")->type_name("A:B");
  command
      .add_option("--cache", options.overrides.cache,
                  "What is remembered between frames: off or seed (exact is not in this version)")
      ->check(CLI::IsMember({"off", "seed", "exact"}))
      ->type_name("MODE");
  command.add_option("--discovery", options.overrides.discovery, "How paths are found: exact or sampled")
      ->check(CLI::IsMember({"exact", "sampled"}))
      ->type_name("MODE");
  command
      .add_option("--rays", options.overrides.rays,
                  "Rays per receiver, with --discovery sampled; with --cache seed in the first frame")
      ->type_name("N");
  command.add_option("--seed", options.overrides.seed, "Turns the sphere of rays")->type_name("S");
  command
      .add_option_function<std::string>(
          "--instructions", choose_instructions,
          "Instructions that trace rays (default: the best that the processor has); never changes a result")
      ->check(CLI::IsMember({"baseline", "avx2", "avx512"}))
      ->type_name("LEVEL");
  add_choice(command, "--progress", "Progress bar: auto (on a terminal), always or never", progress_modes,
             options.progress)
      ->type_name("WHEN");
  command.add_flag("--quiet", options.quiet, "No table, no progress bar and no warnings");
}

void add_scenario_options(CLI::App& command, ScenarioOptions& options) {
  add_common_options(command, options);
  command.add_option("-o", options.folder, "Folder for the results (default: out/<scenario name>)")->type_name("DIR");
  command.add_option("--output", options.overrides.output, "Result files: paths, links, pdp")
      ->type_name("KEY[,KEY...]");
}

void add_inspect_options(CLI::App& command, InspectOptions& options) {
  command.add_option("scene", options.obj, "The scene (OBJ)")->required()->type_name("SCENE.obj");
  command.add_flag("--json", options.json, "JSON instead of tables");
  add_choice(command, "--up", "The file's axis that points up: y or z (default: z)", up_axes, options.settings.obj.up)
      ->type_name("AXIS");
  command.add_option("--unit-m", options.settings.obj.unit_m, "Length of one file unit in metres (default: 1)")
      ->check(CLI::PositiveNumber)
      ->type_name("X");
  command.add_option("--frequency-hz", options.settings.frequency_hz, "Evaluate the materials at this frequency")
      ->check(CLI::PositiveNumber)
      ->type_name("F");
}

void add_compare_options(CLI::App& command, CompareOptions& options) {
  command.add_option("first", options.first, "A map (CSV)")->required()->type_name("A.csv");
  command.add_option("second", options.second, "The map it is compared with (CSV)")->required()->type_name("B.csv");
  command.add_option("-o", options.folder, "Folder for the chart (default: out/compare)")->type_name("DIR");
  command.add_option("--column", options.column, "The power to compare (default: power_incoherent_dbm)")
      ->type_name("NAME");
  command.add_option("--second-column", options.second_column, "Its name in the second file, where that differs")
      ->type_name("NAME");
}

void add_keys_options(CLI::App& command, KeysOptions& options) {
  command.add_option("word", options.word, "Only keys whose path or meaning holds this")->type_name("WORD");
  command.add_flag("--markdown", options.markdown, "All of them as a page in Markdown")->excludes("word");
}

// Commands of later versions are known by name, so that the answer is not "unknown".
void add_absent_command(CLI::App& app, const std::string& name, const std::string& does) {
  CLI::App* command = app.add_subcommand(name, does + " (not in this version)");
  command->allow_extras();
  command->callback([name] { throw UsageError("'dcem " + name + "' is not in this version", command_names); });
}

void add_commands(CLI::App& app, Options& options) {
  app.set_version_flag("--version", version_text, "Print the version, and which instructions trace rays");
  app.require_subcommand(1);
  CLI::App* run = app.add_subcommand("run", "Every frame of a scenario: paths, received power, delay profiles");
  add_scenario_options(*run, options.scenario);
  run->callback([&] { run_scenario(options.scenario); });
  CLI::App* map =
      app.add_subcommand("map", "Coverage maps for each transmitter over the scenario's grids and lists of points");
  add_scenario_options(*map, options.scenario);
  map->callback([&] { map_scenario(options.scenario); });
  CLI::App* inspect = app.add_subcommand(
      "inspect",
      "What the engine sees in an OBJ: triangles, facets, materials, box, defects (diffracting edges are "
      "not in this version)");
  add_inspect_options(*inspect, options.inspect);
  inspect->callback([&] { inspect_scene(options.inspect); });
  CLI::App* verify = app.add_subcommand(
      "verify", "Solve every reported path again on its own, and compare with exhaustive search where it is possible");
  add_common_options(*verify, options.scenario);
  verify->callback([&] { verify_scenario(options.scenario); });
  CLI::App* compare = app.add_subcommand("compare", "How far two maps of the same places are apart");
  add_compare_options(*compare, options.compare);
  compare->callback([&] { compare_maps(options.compare); });
  CLI::App* keys = app.add_subcommand("keys", "The keys of a scenario: meaning, range, unit, default, example");
  add_keys_options(*keys, options.keys);
  keys->callback([&] { print_keys(options.keys); });
  app.add_subcommand("schema", "The JSON Schema (2020-12) of a scenario")->callback(print_schema);
  add_absent_command(app, "import", "Make scenarios from SUMO, OpenStreetMap or GEMV2 data");
}

// Without this, a mistyped command reads "a subcommand is required".
void check_command(const CLI::App& app, int argument_count, char** arguments) {
  if (argument_count < 2 || arguments[1][0] == '-') return;
  const auto commands = app.get_subcommands([&](const CLI::App* command) { return command->check_name(arguments[1]); });
  if (commands.empty()) throw UsageError("'" + std::string(arguments[1]) + "' is no command", command_names);
}

int fail(std::string message, int exit_code) {
  std::replace(message.begin(), message.end(), '\n', ' ');
  std::cerr << message << '\n';
  return exit_code;
}

int run(int argument_count, char** arguments) {
  CLI::App app("Electromagnetic ray tracing in scenes that move", "dcem");
  Options options;
  add_commands(app, options);
  try {
    check_command(app, argument_count, arguments);
    app.parse(argument_count, arguments);
    return 0;
  } catch (const CLI::Success& request) {  // --help and --version
    return app.exit(request);
  } catch (const CLI::ParseError& error) {
    return fail(UsageError(error.what(), "what 'dcem --help' and 'dcem COMMAND --help' list").what(), exit_bad_input);
  } catch (const UsageError& error) {
    return fail(error.what(), exit_bad_input);
  } catch (const io::InputError& error) {
    return fail(error.what(), exit_bad_input);
  } catch (const io::OutputError& error) {
    return fail(error.what(), exit_bad_input);
  } catch (const std::exception& error) {
    return fail(std::string("dcem: ") + error.what(), exit_failed);
  }
}

}  // namespace
}  // namespace dcem::program

int main(int argument_count, char** arguments) {
  return dcem::program::run(argument_count, arguments);
}
