#include "options.hpp"
#include "ranks.hpp"

namespace dcem::program {

std::string rank_library() {
  return "nothing (no MPI)";
}

Ranks::Ranks() {
  if (job_rank() > 0) end_behind_first();
  throw UsageError("mpirun: this build has no MPI", no_ranks_expected);
}

Ranks::~Ranks() = default;

void Ranks::together(const std::function<void()>& action) const {
  action();
}

std::uint64_t Ranks::of_first(std::uint64_t number) const {
  return number;
}

void Ranks::share(std::size_t count, const std::function<void(std::size_t)>& work,
                  const std::function<void()>& finished) const {
  for (std::size_t number = 0; number < count; ++number) {
    work(number);
    finished();
  }
}

}  // namespace dcem::program
