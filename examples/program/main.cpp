/// The program `dcem`: command line in, exit code out. 0 done; 1 the run failed; 2 bad input or bad usage; 130 and 143
/// ended by SIGINT and SIGTERM.
#include <CLI/CLI.hpp>
#include <iostream>
#include <string>
#include <vector>

#include "command_options.hpp"
#include "completion.hpp"
#include "dcem/core/instruction_set.hpp"
#include "dcem/io/import.hpp"
#include "dcem/io/optional_libraries.hpp"
#include "dcem/io/picture_format.hpp"
#include "failure.hpp"
#include "help_text.hpp"
#include "options.hpp"
#include "ranks.hpp"
#include "run_on_ranks.hpp"
#include "stop_signal.hpp"

#ifndef DCEM_VERSION
#define DCEM_VERSION "unknown"
#endif

namespace dcem::program {
namespace {

constexpr const char* command_names = "run, merge, map, verify, inspect, compare, import, keys, schema or completion";

struct Options {
  ScenarioOptions scenario;
  MergeOptions merge;
  InspectOptions inspect;
  CompareOptions compare;
  ImportOptions imports;
  KeysOptions keys;
  std::string shell;
};

std::string version_text() {
  return "dcem " DCEM_VERSION "\nrays are traced with: " + std::string(name_of(instruction_set())) +
         "\npictures are drawn with: " + io::drawing_library() +
         "\nfiles for other programs with: " + io::exchange_libraries() +
         "\nscenes are imported with: " + io::import_libraries() + "\nprocesses work together with: " + rank_library();
}

void add_commands(CLI::App& app, Options& options) {
  app.set_version_flag(
      "--version", version_text,
      "Print the version, which instructions trace rays, and which libraries draw, write, import and share work");
  app.require_subcommand(1);
  CLI::App* run = app.add_subcommand("run", "Every frame of a scenario: paths, received power, delay profiles");
  add_run_options(*run, options.scenario);
  run->callback([&] { run_scenario(options.scenario); });
  CLI::App* merge = app.add_subcommand("merge", "The parts of a run (dcem run --shard i/N) as one result");
  add_merge_options(*merge, options.merge);
  merge->callback([&] { merge_shards(options.merge); });
  CLI::App* map =
      app.add_subcommand("map", "Coverage maps for each transmitter over the scenario's grids and lists of points");
  add_map_options(*map, options.scenario);
  map->callback([&] { map_scenario(options.scenario); });
  CLI::App* inspect = app.add_subcommand(
      "inspect", "What the engine sees in an OBJ: triangles, facets, diffracting edges, materials, box, defects");
  add_inspect_options(*inspect, options.inspect);
  inspect->callback([&] { inspect_scene(options.inspect); });
  CLI::App* verify = app.add_subcommand(
      "verify", "Solve every reported path again on its own, and compare with exhaustive search where it is possible");
  add_verify_options(*verify, options.scenario);
  verify->callback([&] { verify_scenario(options.scenario); });
  CLI::App* compare = app.add_subcommand("compare", "How far two maps of the same places are apart");
  add_compare_options(*compare, options.compare);
  compare->callback([&] { compare_maps(options.compare); });
  CLI::App* importing = app.add_subcommand(
      "import", "Make a scenario from SUMO, GEMV2, Sionna or OpenStreetMap: scene, materials, scenario, report");
  add_import_options(*importing, options.imports);
  importing->callback([&] { import_scene(options.imports); });
  CLI::App* keys = app.add_subcommand("keys", "The keys of a scenario: meaning, range, unit, default, example");
  add_keys_options(*keys, options.keys);
  keys->callback([&] { print_keys(options.keys); });
  app.add_subcommand("schema", "The JSON Schema (2020-12) of a scenario")->callback(print_schema);
  CLI::App* completion =
      app.add_subcommand("completion", "Print the script that completes the command line in a shell");
  completion->add_option("shell", options.shell, "Which shell")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh", "fish"}))
      ->type_name("SHELL");
  completion->callback([&] { std::cout << completion_script(app, options.shell) << std::flush; });
  app.set_help_all_flag("--help-all", "Print the help of all commands and exit");  // last: of the program alone
}

// Without this, a mistyped command reads "a subcommand is required".
void check_command(const CLI::App& app, int argument_count, char** arguments) {
  if (argument_count < 2 || arguments[1][0] == '-') return;
  const auto commands = app.get_subcommands([&](const CLI::App* command) { return command->check_name(arguments[1]); });
  if (commands.empty()) throw UsageError("'" + std::string(arguments[1]) + "' is no command", command_names);
}

/// The library's own text has them from the last to the first.
std::string unexpected_text(const std::vector<std::string>& arguments) {
  std::string list;
  for (const std::string& argument : arguments) list += (list.empty() ? "'" : ", '") + argument + "'";
  return list + (arguments.size() == 1 ? " is" : " are") + " not expected";
}

/// What `mpirun` has started several times is done together, or not at all.
void check_job(int argument_count, char** arguments) {
  const std::string command = argument_count < 2 ? "" : arguments[1];
  if (job_size() < 2 || command == "run") return;
  refuse_on_ranks(command);
}

int run(int argument_count, char** arguments) {
  end_on_signals();
  CLI::App app("Electromagnetic ray tracing in scenes that move", "dcem");
  app.formatter(std::make_shared<HelpText>());
  Options options;
  add_commands(app, options);
  try {
    check_command(app, argument_count, arguments);
    check_job(argument_count, arguments);
    app.parse(argument_count, arguments);
    return 0;
  } catch (const CLI::ExtrasError&) {
    return fail({UsageError(unexpected_text(app.remaining(true)), what_help_lists).what(), exit_bad_input});
  } catch (const CLI::Success& request) {  // --help and --version
    return app.exit(request);
  } catch (const EndedElsewhere& end) {
    return end.exit_code;
  } catch (...) {
    return fail(current_failure());
  }
}

}  // namespace
}  // namespace dcem::program

int main(int argument_count, char** arguments) {
  return dcem::program::run(argument_count, arguments);
}
