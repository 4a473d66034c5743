#pragma once
/// Broken invariants: `DCEM_ASSERT(condition)`. The macro can be replaced before the first include; by default it
/// throws `dcem::InvariantError`, so a test can see it fire. Errors in values that a program passes in are
/// `std::invalid_argument`, thrown once at the border (`Scene::add_*`, `Simulator`). Errors in files are
/// `dcem::io::InputError`. The library never prints, aborts or exits.
#include <stdexcept>
#include <string>

#if defined(__FAST_MATH__)
#error "DCEM promises identical results bit for bit; -ffast-math (and -Ofast) break that promise"
#endif

namespace dcem {

/// A promise that the code makes to itself was broken: a defect of the program, not of its input.
class InvariantError : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

[[noreturn]] inline void throw_invariant_error(const char* condition, const char* file, int line) {
  throw InvariantError(std::string(file) + ":" + std::to_string(line) + ": broken invariant: " + condition);
}

}  // namespace dcem

#ifndef DCEM_ASSERT
#define DCEM_ASSERT(condition) \
  (static_cast<bool>(condition) ? static_cast<void>(0) : ::dcem::throw_invariant_error(#condition, __FILE__, __LINE__))
#endif
