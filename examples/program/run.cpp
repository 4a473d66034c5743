/// `dcem run`: every frame of a scenario, all links.
#include <iostream>
#include <optional>
#include <utility>

#include "dcem/core/thread_pool.hpp"
#include "dcem/io/frame_source.hpp"
#include "dcem/io/frames_ahead.hpp"
#include "dcem/io/run_journal.hpp"
#include "frequencies.hpp"
#include "job.hpp"
#include "ranks.hpp"
#include "resume.hpp"
#include "run_on_ranks.hpp"
#include "run_results.hpp"
#include "stop_signal.hpp"

namespace dcem::program {
namespace {

std::string frames_text(std::size_t first, std::size_t beyond) {
  return "frames " + std::to_string(first) + " to " + std::to_string(beyond - 1);
}

/// A run from frame to frame, which may end behind any of them and go on there.
class Run {
 public:
  Run(const Job& job, const ScenarioOptions& options, Simulator& simulator, RunResults& results)
      : job_(job),
        options_(options),
        simulator_(simulator),
        results_(results),
        frames_(job.scenario),
        next_(job.frames.first) {}

  /// Takes over the frames of a journal. Nothing is changed where a signal comes meanwhile.
  void replay(io::JournalReader& journal, const StopRequest& stop) {
    io::ProgressBar bar("frames kept", journal.frames(), progress_mode(options_));
    while (auto entry = journal.next()) {
      if (stop.signal() != 0) {
        throw Interrupted(stop.signal(), "interrupted by " + signal_name(stop.signal()) +
                                             " before the first new frame: everything is as it was");
      }
      const Frame instant = frames_.frame(simulator_.scene(), next_);
      const TreeUpdateReport tree = simulator_.pass(instant, entry->figures.work);
      require_frame(job_.folder, entry->figures, next_, tree);
      results_.add(instant, std::move(*entry), stop);
      ++next_;
      bar.advance();
    }
  }

  /// Solves the frames that are left, until a signal comes.
  void solve(io::RunJournal* journal, const StopRequest& stop) {
    io::FramesAhead frames(frames_, simulator_.scene(), next_, job_.frames.last, simulator_.pool().size() > 1);
    io::ProgressBar bar("frames", job_.frames.last - next_, progress_mode(options_));
    for (; next_ < job_.frames.last && stop.signal() == 0; ++next_) {
      const Frame instant = frames.next();
      results_.add(instant, simulator_.advance(instant), journal, stop);
      bar.advance();
    }
    if (journal != nullptr) journal->wait();
  }

  std::size_t next_frame() const { return next_; }

 private:
  const Job& job_;
  const ScenarioOptions& options_;
  Simulator& simulator_;
  RunResults& results_;
  io::FrameSource frames_;
  std::size_t next_;
};

/// Where the run was ended by a signal: what is there, and what is not.
[[noreturn]] void end_interrupted(int signal, const Job& job, std::size_t next_frame, bool has_journal) {
  const std::string by = "interrupted by " + signal_name(signal);
  if (next_frame == job.frames.first) {
    throw Interrupted(signal, by + " before the first frame was whole: nothing is written");
  }
  const std::string how = has_journal ? "'dcem run' with the same options and --resume goes on"
                                      : "with cache seed it cannot go on, only begin again";
  throw Interrupted(signal, by + ": " + job.folder.string() + " holds " + frames_text(job.frames.first, next_frame) +
                                " of " + frames_text(job.frames.first, job.frames.last) + "; " + how);
}

/// The journal that the run writes; none where it would be of no use.
std::optional<io::RunJournal> begin_journal(const Job& job, const io::RunIdentity& identity, const Simulator& simulator,
                                            const std::optional<io::JournalReader>& former) {
  if (former) return std::optional<io::RunJournal>(std::in_place, job.folder, former->bytes(), &simulator.pool());
  std::error_code ignored;
  std::filesystem::remove(job.folder / io::journal_name, ignored);
  std::filesystem::remove_all(job.folder / parts_folder, ignored);
  if (simulator.cache() == CacheMode::seed || job.frames.count() < 2) return std::nullopt;
  return std::optional<io::RunJournal>(std::in_place, job.folder, identity, &simulator.pool());
}

/// Writes what is there as the result, where that is a frame at least, and says so where frames are left.
void write_result(const Run& run, RunResults& results, const Job& job, const ScenarioOptions& options,
                  ResultFolder& folder, const io::RunIdentity& identity, io::RunJournal* journal, int signal) {
  const bool is_cut = run.next_frame() < job.frames.last;
  if (is_cut && run.next_frame() == job.frames.first) end_interrupted(signal, job, run.next_frame(), false);
  io::RunSummary& summary = results.finish(run.next_frame() - job.frames.first);
  if (is_cut) summary.set_interruption({signal_name(signal), run.next_frame(), job.frames.last});
  folder.commit(summary, identity.text());
  if (journal != nullptr) is_cut ? journal->keep() : journal->remove();
  print_warnings(summary.late_warnings(), options);
  if (!options.quiet) std::cout << summary.table(job.folder) << std::flush;
  if (is_cut) end_interrupted(signal, job, run.next_frame(), journal != nullptr);
}

/// Solves the frames that are left.
void go_on(Run& run, RunResults& results, const Job& job, const ScenarioOptions& options, ResultFolder& folder,
           const io::RunIdentity& identity, io::RunJournal* journal, const StopRequest& stop) {
  try {
    run.solve(journal, stop);
    write_result(run, results, job, options, folder, identity, journal, stop.signal());
  } catch (const io::OutputError&) {
    if (journal != nullptr) journal->keep();  // a disk that is full today has room tomorrow
    throw;
  }
}

/// A run of one frequency, by this process alone.
void run_alone(const ScenarioOptions& options) {
  Job job = prepare_job(options);
  const std::size_t devices = job.scenario.scene.receivers().size();
  expand_grids(job.scenario, options);
  Simulator simulator = make_simulator(job, options);
  require_effect(options, simulator);
  const io::RunIdentity identity = run_identity(job, options);
  ResultFolder folder(job.folder, job.scenario.name, "summary.json", "map_summary.json");
  if (options.resume && holds_result(folder, identity)) {
    std::cerr << job.folder.string() << ": the run is complete; nothing is left to resume\n";
    return;
  }
  prepare_results(job, simulator, folder);
  std::optional<io::JournalReader> former = open_journal(job.folder, job, options, identity, simulator);
  RunResults results(job, options, simulator, folder, devices);
  Run run(job, options, simulator, results);
  print_warnings(job.scenario.warnings, options);
  const StopRequest stop;
  if (former) run.replay(*former, stop);
  std::optional<io::RunJournal> journal = begin_journal(job, identity, simulator, former);
  go_on(run, results, job, options, folder, identity, journal ? &*journal : nullptr, stop);
}

}  // namespace

void run_scenario(const ScenarioOptions& options) {
  if (options.shard) return run_shard(options);
  if (job_size() > 1) return run_on_ranks(options);
  for (const ScenarioOptions& one : by_frequency(options)) run_alone(one);
}

}  // namespace dcem::program
