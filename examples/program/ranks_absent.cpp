#include <fstream>

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

std::string Ranks::of_first(std::string text) const {
  return text;
}

/// Not called: no job has begun.
void Ranks::append(const std::filesystem::path& file, const std::filesystem::path&, std::size_t count,
                   const std::function<std::string(std::size_t)>& piece) const {
  std::ofstream stream(file, std::ios::binary | std::ios::app);
  for (std::size_t number = 0; number < count; ++number) stream << piece(number);
}

void Ranks::share(std::size_t count, const std::function<void(std::size_t)>& work,
                  const std::function<void()>& finished) const {
  for (std::size_t number = 0; number < count; ++number) {
    work(number);
    finished();
  }
}

}  // namespace dcem::program
