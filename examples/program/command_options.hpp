#pragma once
/// What each command takes. Help, completion and the check of the command line all come from here.
#include <CLI/CLI.hpp>

#include "options.hpp"

namespace dcem::program {

void add_run_options(CLI::App& command, ScenarioOptions& options);
void add_merge_options(CLI::App& command, MergeOptions& options);
void add_map_options(CLI::App& command, ScenarioOptions& options);
void add_verify_options(CLI::App& command, ScenarioOptions& options);
void add_inspect_options(CLI::App& command, InspectOptions& options);
void add_compare_options(CLI::App& command, CompareOptions& options);
void add_import_options(CLI::App& command, ImportOptions& options);
void add_keys_options(CLI::App& command, KeysOptions& options);

}  // namespace dcem::program
