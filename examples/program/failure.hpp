#pragma once
/// What the program says and returns where something was thrown.
#include <string>

namespace dcem::program {

inline constexpr const char* what_help_lists = "what 'dcem --help' and 'dcem COMMAND --help' list";

inline constexpr int exit_failed = 1;
inline constexpr int exit_bad_input = 2;

struct Failure {
  std::string line;  ///< without an end of line
  int exit_code;
};

/// Of the exception that is being handled.
Failure current_failure();

/// Prints the line and gives the exit code.
int fail(const Failure& failure);

}  // namespace dcem::program
