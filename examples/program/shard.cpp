/// `dcem run --shard i/N`: the links of some of the receivers, for `dcem merge`.
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dcem/core/thread_pool.hpp"
#include "dcem/io/frame_source.hpp"
#include "dcem/io/frames_ahead.hpp"
#include "dcem/io/link_lines.hpp"
#include "dcem/io/result_writer.hpp"
#include "dcem/io/run_journal.hpp"
#include "dcem/io/shard_facts.hpp"
#include "frequencies.hpp"
#include "job.hpp"
#include "resume.hpp"
#include "shard.hpp"
#include "stop_signal.hpp"

namespace dcem::program {
namespace {

/// A part from frame to frame.
class ShardRun {
 public:
  ShardRun(const PartOrder& order, Simulator& simulator)
      : order_(order),
        job_(order.job),
        simulator_(simulator),
        frames_(job_.scenario),
        lines_(simulator.scene(), simulator.scene().receivers()),
        summary_(run_facts(job_, simulator, simulator.plan(), simulator.scene().receivers().size()), simulator.scene()),
        next_(job_.frames.first),
        begun_(work_times()),
        keeps_links_(io::needs_paths(job_.scenario.output) || simulator.discovery() == Discovery::sampled) {}

  /// Passes the frames of a journal.
  void replay(io::JournalReader& journal) {
    io::ProgressBar bar("frames kept", journal.frames(), progress_mode(order_.options));
    for (auto entry = journal.next(); entry; entry = journal.next()) {
      const TreeUpdateReport tree = simulator_.pass(frames_.frame(simulator_.scene(), next_), entry->figures.work);
      require_frame(order_.folder, entry->figures, next_, tree);
      summary_.add(entry->figures);
      ++next_;
      bar.advance();
    }
  }

  /// Solves the frames that are left, until a signal comes.
  void solve(io::RunJournal& journal, const StopRequest& stop) {
    ThreadPool& pool = simulator_.pool();
    io::FramesAhead frames(frames_, simulator_.scene(), next_, job_.frames.last, pool.size() > 1);
    io::ProgressBar bar("frames", job_.frames.last - next_, progress_mode(order_.options));
    for (; next_ < job_.frames.last && stop.signal() == 0; ++next_) {
      FrameResult result = simulator_.advance(frames.next());
      const io::FrameFigures figures = io::figures_of(result, &pool);
      keeps_links_ ? journal.add(result) : journal.add(figures, result.links, lines_of(result));
      summary_.add(figures);
      simulator_.give_back(std::move(result));
      bar.advance();
    }
    journal.wait();
    summary_.set_work_times(work_times() - begun_);
  }

  std::size_t next_frame() const { return next_; }
  io::RunSummary& summary() { return summary_; }

 private:
  io::LinePieces lines_of(const FrameResult& result) const {
    if (job_.scenario.output.links) return lines_.pieces(result, simulator_.pool());
    return std::make_shared<std::vector<std::string>>();
  }

  const PartOrder& order_;
  const Job& job_;
  Simulator& simulator_;
  io::FrameSource frames_;
  io::LinkLines lines_;
  io::RunSummary summary_;
  std::size_t next_;
  const WorkTimes begun_;
  const bool keeps_links_;  ///< where lines of links do not say all that is to be written or checked
};

io::ShardFacts shard_facts(const PartOrder& order) {
  const FrameRange& frames = order.job.frames;
  return {order.part, std::filesystem::absolute(order.options.scenario).lexically_normal().string(),
          std::to_string(frames.first) + ':' + std::to_string(frames.last), order.options.overrides};
}

/// Whether the folder holds this part already, whole.
bool is_there(const PartOrder& order, const ResultFolder& results, const io::RunIdentity& identity) {
  const auto& former = results.former();
  return former && former->identity == identity.text() && std::filesystem::exists(order.folder / io::journal_name);
}

/// The journal that the part writes. What the folder said of a former part holds no more.
io::RunJournal begin_journal(const std::filesystem::path& folder, const io::RunIdentity& identity,
                             const std::optional<io::JournalReader>& former, ThreadPool& pool) {
  if (former) return {folder, former->bytes(), &pool};
  if (std::filesystem::exists(folder / io::journal_name)) std::filesystem::remove(folder / "summary.json");
  return {folder, identity, &pool};
}

[[noreturn]] void end_interrupted(const PartOrder& order, std::size_t frames, int signal) {
  throw Interrupted(signal, "interrupted by " + signal_name(signal) + ": " + order.folder.string() + " holds " +
                                std::to_string(frames) + " of " + std::to_string(order.job.frames.count()) +
                                " frames; 'dcem run' with the same options and --resume goes on");
}

}  // namespace

void solve_part(const PartOrder& order, Simulator& simulator, const StopRequest& stop) {
  const io::RunIdentity identity = part_identity(order.whole, order.part);
  ResultFolder results(order.folder, order.job.scenario.name, "summary.json", "map_summary.json");
  if (order.options.resume && is_there(order, results, identity)) {
    if (!order.options.quiet)
      std::cerr << order.folder.string() << ": the part is complete; nothing is left to resume\n";
    return;
  }
  std::optional<io::JournalReader> former = open_journal(order.folder, order.job, order.options, identity, simulator);
  ShardRun run(order, simulator);
  if (former) run.replay(*former);
  io::RunJournal journal = begin_journal(order.folder, identity, former, simulator.pool());
  try {
    run.solve(journal, stop);
  } catch (const io::OutputError&) {
    journal.keep();  // a disk that is full today has room tomorrow
    throw;
  }
  journal.keep();
  const FrameRange& frames = order.job.frames;
  if (run.next_frame() < frames.last) end_interrupted(order, run.next_frame() - frames.first, stop.signal());
  run.summary().set_shard(shard_facts(order));
  results.commit(run.summary(), identity.text());
  if (!order.options.quiet) std::cout << run.summary().table(order.folder) << std::flush;
}

namespace {

/// Of one frequency.
void run_one(const ScenarioOptions& options) {
  Job job = prepare_job(options);
  expand_grids(job.scenario, options);
  Simulator simulator = make_simulator(job, options);
  require_effect(options, simulator);
  const auto receivers = simulator.scene().receivers();
  if (!receivers.empty()) {
    warn_of_slow_search(job, simulator, receivers.front(), links_at_most(simulator) / options.shard->of + 1);
  }
  print_warnings(job.scenario.warnings, options);
  const StopRequest stop;
  solve_part({job, options, job.folder, run_identity(job, options), *options.shard}, simulator, stop);
}

}  // namespace

void run_shard(const ScenarioOptions& options) {
  for (const ScenarioOptions& one : by_frequency(options)) run_one(one);
}

}  // namespace dcem::program
