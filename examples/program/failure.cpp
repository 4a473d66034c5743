#include "failure.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>

#include "dcem/io/atomic_file.hpp"
#include "dcem/io/input_error.hpp"
#include "options.hpp"
#include "stop_signal.hpp"

namespace dcem::program {

Failure current_failure() {
  try {
    throw;
  } catch (const CLI::ParseError& error) {
    return {UsageError(error.what(), what_help_lists).what(), exit_bad_input};
  } catch (const UsageError& error) {
    return {error.what(), exit_bad_input};
  } catch (const Interrupted& end) {
    return {end.what(), end.exit_code()};
  } catch (const io::InputError& error) {
    return {error.what(), exit_bad_input};
  } catch (const io::OutputError& error) {
    return {error.what(), exit_bad_input};
  } catch (const std::exception& error) {
    return {std::string("dcem: ") + error.what(), exit_failed};
  }
}

int fail(const Failure& failure) {
  std::string line = failure.line;
  std::replace(line.begin(), line.end(), '\n', ' ');
  std::cerr << line << '\n';
  return failure.exit_code;
}

}  // namespace dcem::program
