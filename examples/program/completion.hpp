#pragma once
/// Completion of the command line for shells, made from the description that also makes the help.
#include <CLI/CLI.hpp>
#include <string>

namespace dcem::program {

/// The script for a shell. Throws UsageError unless it is "bash", "zsh" or "fish".
std::string completion_script(const CLI::App& app, const std::string& shell);

}  // namespace dcem::program
