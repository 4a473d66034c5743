#include "failure.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <sstream>

#include "dcem/io/atomic_file.hpp"
#include "dcem/io/input_error.hpp"
#include "options.hpp"
#include "stop_signal.hpp"

namespace dcem::program {

namespace {

/// The library lists them from the last to the first.
std::string unexpected_text(const CLI::ExtrasError& error) {
  const std::string text = error.what();
  const std::size_t colon = text.find(": ");
  if (colon == std::string::npos) return text;
  std::istringstream words(text.substr(colon + 2));
  std::string list;
  for (std::string word; words >> word;) list = word + (list.empty() ? "" : " ") + list;
  return text.substr(0, colon + 2) + list;
}

}  // namespace

Failure current_failure() {
  const std::string expectation = "what 'dcem --help' and 'dcem COMMAND --help' list";
  try {
    throw;
  } catch (const CLI::ExtrasError& error) {
    return {UsageError(unexpected_text(error), expectation).what(), exit_bad_input};
  } catch (const CLI::ParseError& error) {
    return {UsageError(error.what(), expectation).what(), exit_bad_input};
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
