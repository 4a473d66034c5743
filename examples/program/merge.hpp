#pragma once
/// The parts of a run as one.
#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "dcem/io/run_journal.hpp"
#include "dcem/io/shards.hpp"
#include "job.hpp"

namespace dcem::program {

class Merging;

/// The journals of the parts in these folders. Throws InputError where they are not those of the run, whose options and
/// identity these are.
io::ShardReader open_shards(std::span<const std::filesystem::path> folders, const Job& job,
                            const ScenarioOptions& options, const io::RunIdentity& identity);

/// Holds the folder of the result from its beginning on, so that what cannot be written there is known before it is
/// solved.
class Merger {
 public:
  /// `job` and `options` are those of the whole run, grids are points already, and the scene's first `devices`
  /// receivers are the scenario's own. Both must outlive it; the job's warnings get what `dcem run` warns of, and are
  /// printed. Throws what `dcem run` throws before its first frame.
  Merger(Job& job, const ScenarioOptions& options, std::size_t devices, io::RunIdentity identity);
  ~Merger();

  /// Whether the folder holds the result of this run already.
  bool is_complete();
  /// Writes the result of the parts in these folders: `begin`, and what is left after it. Throws InputError where they
  /// are not those of the run.
  void merge(std::span<const std::filesystem::path> folders);

  /// For several processes: opens the parts.
  void begin(std::span<const std::filesystem::path> folders);
  /// Whether `links.csv` is all that is written of a frame: processes can share that.
  bool writes_lines_alone() const;
  /// Of the journals.
  std::size_t bytes_a_frame() const;
  /// `links.csv` as it is begun, where processes append to it, and its place aside.
  std::filesystem::path lines_file();
  /// The lines of the next frames after `first` of them. Frames before that others have written are passed over.
  std::string lines(std::size_t first, std::size_t count);
  /// Writes what no one else has written, and gives the files their names.
  void finish(bool others_write_lines);

 private:
  Job& job_;
  const ScenarioOptions& options_;
  std::size_t devices_;
  io::RunIdentity identity_;
  Simulator simulator_;
  ResultFolder results_;
  std::unique_ptr<Merging> merging_;  ///< once it has begun
};

}  // namespace dcem::program
