#pragma once
/// The processes of a job that `mpirun` has started: each knows its number and how many they are.
///
/// One of two sources is compiled: ranks_mpi.cpp over MPI, or ranks_absent.cpp, which knows no job.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace dcem::program {

/// What is said where a job was started and this build cannot take part: each process would do all of it.
inline constexpr const char* no_ranks_expected =
    "a build with MPI (libopenmpi-dev), or parts one by one (--shard i/N and dcem merge)";

/// "MPI 3.1", or that there is none.
std::string rank_library();

/// How many processes the job has of which this is one; 1 where there is no job. From the environment alone, so that a
/// program without a job need not begin with MPI.
unsigned job_size();
/// The number of this process in it, from 0.
unsigned job_rank();

/// Why the job ends has been said, by this process or another.
struct EndedElsewhere {
  int exit_code;
};

/// Where processes cannot speak to each other and the first says why the job ends: throws `EndedElsewhere` in the
/// others, after a time in which it has said so.
[[noreturn]] void end_behind_first();

/// Begins with MPI and ends with it: at most one object in a program's life.
class Ranks {
 public:
  Ranks();
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;
  ~Ranks();

  unsigned own() const { return own_; }
  unsigned count() const { return count_; }
  bool is_first() const { return own_ == 0; }
  /// Processes on this machine.
  unsigned here() const { return here_; }

  /// All do it, and wait for each other. Where it throws on some, it throws on all: on the first of these what it threw
  /// there, on the others `EndedElsewhere`.
  void together(const std::function<void()>& action) const;
  /// Does it; what it throws is said while all processes still wait for each other, because `mpirun` ends all as soon
  /// as one has gone. Then throws `EndedElsewhere`.
  void say_together(const std::function<void()>& action) const;
  /// The number or the text that the first process has.
  std::uint64_t of_first(std::uint64_t number) const;
  std::string of_first(std::string text) const;

  /// All append to a file together: `piece(0)`, `piece(1)` and so on below `count`, in this order. Each process makes
  /// every `count()`-th of them, its own in their order. Where one cannot, all throw as in `together`. The file is
  /// there and gets its `name` later.
  void append(const std::filesystem::path& file, const std::filesystem::path& name, std::size_t count,
              const std::function<std::string(std::size_t)>& piece) const;

  /// Hands the numbers below `count` out, each once, to whoever is idle. `finished()` is called on the first process,
  /// by one thread at a time, whenever the work on one is done anywhere. Where work throws, the job is ended at once:
  /// that process says why, and all others are stopped.
  void share(std::size_t count, const std::function<void(std::size_t)>& work,
             const std::function<void()>& finished) const;

 private:
  std::vector<std::uint64_t> of_all(std::uint64_t number) const;

  unsigned own_ = 0, count_ = 1, here_ = 1;
};

}  // namespace dcem::program
