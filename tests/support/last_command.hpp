#pragma once
/// What the last program that a test has started said on its error stream: printed where an assertion fails, for most
/// tests look at the exit code alone.
#include <string>

namespace dcem::test {

struct LastCommand {
  std::string line, error;
  int exit_code = 0;
};

inline LastCommand& last_command() {
  static LastCommand last;
  return last;
}

}  // namespace dcem::test
