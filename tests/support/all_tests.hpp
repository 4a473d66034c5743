#pragma once
/// How much of what a test may repeat is repeated: all of it with `tests/run.sh --all`, otherwise what a contributor
/// waits for.
#include <cstdlib>

namespace dcem::test {

/// Whether everything is run: CTest says so in the environment of each test.
inline bool runs_all() {
  return std::getenv("DCEM_TEST_ALL") != nullptr;
}

/// `all` where everything is run, else `few`.
template <typename Value>
Value all_or(Value all, Value few) {
  return runs_all() ? all : few;
}

}  // namespace dcem::test
