#include "ranks.hpp"

#include <array>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <string_view>
#include <thread>

#include "failure.hpp"

namespace dcem::program {
namespace {

/// What Open MPI's `mpirun` says to those it starts, and what those of MPICH's kind do.
constexpr std::array size_names{"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"};
constexpr std::array rank_names{"OMPI_COMM_WORLD_RANK", "PMI_RANK"};

unsigned number_in_environment(const std::array<const char*, 2>& names, unsigned absent) {
  for (const char* name : names) {
    const char* const value = std::getenv(name);
    if (value == nullptr) continue;
    const std::string_view text = value;
    unsigned number = absent;
    std::from_chars(text.data(), text.data() + text.size(), number);
    return number;
  }
  return absent;
}

}  // namespace

unsigned job_size() {
  return number_in_environment(size_names, 1);
}

unsigned job_rank() {
  return number_in_environment(rank_names, 0);
}

void end_behind_first() {
  std::this_thread::sleep_for(std::chrono::seconds(2));
  throw EndedElsewhere{exit_bad_input};
}

void Ranks::say_together(const std::function<void()>& action) const {
  try {
    action();
  } catch (const EndedElsewhere&) {
    throw;
  } catch (...) {
    throw EndedElsewhere{fail(current_failure())};
  }
}

}  // namespace dcem::program
