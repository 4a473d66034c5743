#pragma once
/// The parts of a run as one.
#include <cstddef>
#include <filesystem>
#include <span>

#include "dcem/io/run_journal.hpp"
#include "job.hpp"

namespace dcem::program {

/// Holds the folder of the result from its beginning on, so that what cannot be written there is known before it is
/// solved.
class Merger {
 public:
  /// `job` and `options` are those of the whole run, grids are points already, and the scene's first `devices`
  /// receivers are the scenario's own. Both must outlive it; the job's warnings get what `dcem run` warns of, and are
  /// printed. Throws what `dcem run` throws before its first frame.
  Merger(Job& job, const ScenarioOptions& options, std::size_t devices, io::RunIdentity identity);

  /// Whether the folder holds the result of this run already.
  bool is_complete();
  /// Writes the result of the parts in these folders. Throws InputError where they are not those of the run.
  void merge(std::span<const std::filesystem::path> folders);

 private:
  Job& job_;
  const ScenarioOptions& options_;
  std::size_t devices_;
  io::RunIdentity identity_;
  Simulator simulator_;
  ResultFolder results_;
};

}  // namespace dcem::program
