/// `dcem keys` and `dcem schema`: what may stand in a scenario.
#include <iostream>

#include "dcem/io/scenario_keys.hpp"
#include "options.hpp"

namespace dcem::program {

namespace {

void print(const std::string& text) {
  std::cout << text << std::flush;
  if (!std::cout) throw std::runtime_error("the output stream does not take the result");
}

}  // namespace

void print_keys(const KeysOptions& options) {
  if (options.markdown) return print(io::scenario_reference());
  const std::string text = io::scenario_keys(options.word);
  if (text.empty()) {
    throw UsageError("no key of a scenario has to do with '" + options.word + "'",
                     "a piece of a key's path or meaning; 'dcem keys' lists all");
  }
  print(text);
}

void print_schema() {
  print(io::scenario_schema());
}

}  // namespace dcem::program
