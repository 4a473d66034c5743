#pragma once
/// What `dcem run` and `dcem merge` write.
#include <cstddef>
#include <memory>
#include <vector>

#include "dcem/io/placement_watch.hpp"
#include "dcem/io/result_writer.hpp"
#include "dcem/io/run_journal.hpp"
#include "job.hpp"
#include "stop_signal.hpp"

namespace dcem::program {

/// Before the first frame: adds warnings of what pictures leave out and of a search that takes hours. Throws InputError
/// where the folder has a file of the same name of another command.
void prepare_results(Job& job, const Simulator& simulator, const ResultFolder& folder);

/// Whether the folder holds the whole result of a run already.
bool holds_result(ResultFolder& folder, const io::RunIdentity& identity);

/// The results of a run, frame by frame. What is written after some frames depends on these frames alone.
class RunResults {
 public:
  /// The scene's first `devices` receivers are of the scenario's own, the others are points of its grids. All but the
  /// options must outlive it.
  RunResults(const Job& job, const ScenarioOptions& options, Simulator& simulator, ResultFolder& folder,
             std::size_t devices);

  /// A frame that the simulator has solved; the journal, where there is one, gets it, too.
  void add(const Frame& instant, FrameResult&& result, io::RunJournal* journal, const StopRequest& stop);
  /// A frame of a journal; the simulator is where it was then.
  void add(const Frame& instant, io::JournalEntry&& entry, const StopRequest& stop);
  /// The same where others write its lines, which are all there is to write.
  void add(const Frame& instant, const io::FrameFigures& figures, const StopRequest& stop);
  /// Whether `links.csv` is all that is written of a frame, and each line is known without the others'.
  bool writes_lines_alone() const;
  /// As `ResultWriter` says.
  const io::AtomicFile& links_so_far() { return writer_.links_so_far(); }

  /// Writes what is complete only now, after so many frames.
  io::RunSummary& finish(std::size_t frames);

 private:
  void write(const Frame& instant, const FrameResult& result);
  void check(const Frame& instant, const std::vector<LinkResult>* links, std::uint64_t sequences,
             const StopRequest& stop);

  const Job& job_;
  const ScenarioOptions& options_;
  Simulator& simulator_;
  io::ResultWriter writer_;
  std::unique_ptr<io::ViewerWriter> viewer_;
  io::RunSummary summary_;
  io::PlacementWatch watch_;
  SamplingReport sampling_;
  const WorkTimes begun_;
  const bool needs_paths_;
};

}  // namespace dcem::program
