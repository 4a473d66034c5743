/// `dcem run`: every frame of a scenario, all links.
#include <iostream>
#include <limits>
#include <optional>
#include <stdexcept>

#include "dcem/io/frame_source.hpp"
#include "dcem/io/input_error.hpp"
#include "dcem/io/placement_watch.hpp"
#include "dcem/io/result_writer.hpp"
#include "dcem/io/run_journal.hpp"
#include "dcem/sim/discovery.hpp"
#include "dcem/sim/link_choice.hpp"
#include "job.hpp"
#include "stop_signal.hpp"

namespace dcem::program {
namespace {

io::ResultWriter make_writer(io::OutputFolder& folder, const Job& job, const Simulator& simulator,
                             const ScenarioOptions& options) {
  const DiffuseSettings& diffuse = simulator.settings().propagation.diffuse;
  const io::ResultFacts facts{simulator.discovery(),
                              simulator.settings().frequency_hz,
                              diffuse.enabled,
                              diffuse.enabled && diffuse.list_paths,
                              job.frames.count(),
                              job.frames.first,
                              exactly_searched_interactions(simulator.settings().propagation, simulator.plan()),
                              options.memory_limit_bytes.value_or(std::numeric_limits<double>::infinity()),
                              takes_all_links(simulator.scene(), simulator.settings().links),
                              job.scenario.geo};
  try {
    return {folder, simulator.scene(), simulator.scene().receivers(), facts, job.scenario.output};
  } catch (const std::invalid_argument& error) {
    throw io::InputError(options.scenario, error.what());
  }
}

std::string frames_text(std::size_t first, std::size_t beyond) {
  return "frames " + std::to_string(first) + " to " + std::to_string(beyond - 1);
}

/// A run from frame to frame. What it has written after some frames depends on these frames alone, so that it may end
/// behind any of them, and go on there.
class Run {
 public:
  /// The scene's first `devices` receivers are of the scenario's own, the others are points of its grids.
  Run(Job& job, const ScenarioOptions& options, Simulator& simulator, ResultFolder& folder, std::size_t devices)
      : job_(job),
        options_(options),
        simulator_(simulator),
        frames_(job.scenario),
        writer_(make_writer(folder.files(), job, simulator, options)),
        viewer_(make_viewer(folder.files(), job, simulator)),
        summary_(run_facts(job, simulator, simulator.plan(), simulator.scene().receivers().size()), simulator.scene()),
        watch_(options.scenario, simulator, simulator.scene().receivers().first(devices), job.scenario.grids),
        next_(job.frames.first),
        needs_paths_(io::needs_paths(job.scenario.output)) {}

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
      if (entry->figures.index != next_ || tree != entry->figures.tree) {
        throw io::InputError((job_.folder / io::journal_name).string(),
                             "does not fit frame " + std::to_string(next_) + "; expected the journal of this run");
      }
      watch_.look(instant);
      summary_.add(entry->figures);
      check(instant, nullptr, entry->figures.work.sequences_proposed, stop);
      needs_paths_ ? write(instant, entry->take_result()) : writer_.write_lines(entry->link_lines);
      ++next_;
      bar.advance();
    }
  }

  /// Solves the frames that are left, until a signal comes.
  void solve(io::RunJournal* journal, const StopRequest& stop) {
    io::ProgressBar bar("frames", job_.frames.last - next_, progress_mode(options_));
    for (; next_ < job_.frames.last && stop.signal() == 0; ++next_) {
      const Frame instant = frames_.frame(simulator_.scene(), next_);
      const FrameResult result = simulator_.advance(instant);
      watch_.look(instant);
      if (needs_paths_) {
        write(instant, result);
        if (journal != nullptr) journal->add(result);
      } else {
        const std::string lines = writer_.link_lines(result);
        writer_.write_lines(lines);
        if (journal != nullptr) journal->add(result, lines);
      }
      summary_.add(io::figures_of(result));
      check(instant, &result.links, result.work.sequences_proposed, stop);
      bar.advance();
    }
  }

  std::size_t next_frame() const { return next_; }

  /// Writes what is complete only now.
  io::RunSummary& finish() {
    const io::ProgressStage stage("writing results", progress_mode(options_));
    if (job_.scenario.output.plots && next_ - job_.frames.first < 2) {
      summary_.add_late_warning("output.plots: one frame alone has its power delay profile and no pictures over time");
    }
    for (const std::string& line : watch_.warnings()) summary_.add_late_warning(line);
    writer_.finish();
    finish_viewer(viewer_.get(), summary_);
    return summary_;
  }

 private:
  /// What the settings of an output cannot do with the delays of a frame is an error of the scenario.
  void write(const Frame& instant, const FrameResult& result) {
    try {
      writer_.write(result);
    } catch (const std::invalid_argument& error) {
      const std::string problem = error.what();
      const bool says_what = problem.find("; expected ") != std::string::npos;
      throw io::InputError(options_.scenario, problem + (says_what ? "" : "; expected wider bins"));
    }
    if (viewer_ != nullptr) viewer_->add(instant, result);
  }

  /// What rays lack on some links, in three of the frames. Not where the run is to end, whatever it has still to say.
  void check(const Frame& instant, const std::vector<LinkResult>* links, std::uint64_t sequences,
             const StopRequest& stop) {
    const std::size_t first = job_.frames.first, last = job_.frames.last - 1;
    const bool is_chosen = next_ == first || next_ == (first + last) / 2 || next_ == last;
    if (simulator_.discovery() == Discovery::exact || !is_chosen || stop.signal() != 0) return;
    const auto receivers = simulator_.scene().receivers();
    std::vector<LinkResult> own;
    if (links == nullptr) own = simulator_.solve(receivers);  // the journal has lines alone; nothing is remembered
    SamplingReport report = check_sampling(simulator_, instant, {receivers, links ? *links : own, sequences});
    if (simulator_.cache() == CacheMode::seed) report.rays_steady = steady_rays(simulator_.settings().propagation);
    sampling_.add(report);
    summary_.set_sampling(sampling_);
  }

  const Job& job_;
  const ScenarioOptions& options_;
  Simulator& simulator_;
  io::FrameSource frames_;
  io::ResultWriter writer_;
  std::unique_ptr<io::ViewerWriter> viewer_;
  io::RunSummary summary_;
  io::PlacementWatch watch_;
  SamplingReport sampling_;
  std::size_t next_;
  const bool needs_paths_;
};

/// What the pictures leave out is said, not left to be found out.
void warn_of_plots(Job& job, std::size_t links) {
  const io::OutputSettings& output = job.scenario.output;
  if (!output.plots || links <= output.plots_max_links) return;
  job.scenario.warnings.push_back("output.plots: the first " + std::to_string(output.plots_max_links) + " of " +
                                  std::to_string(links) + " links have pictures (output.plots.max_links)");
}

/// With --resume: the journal to go on with; nothing where a run begins anew, since its frames need what the frames
/// before have remembered.
std::optional<io::JournalReader> open_journal(const Job& job, const ScenarioOptions& options,
                                              const io::RunIdentity& identity, const Simulator& simulator) {
  if (!options.resume) return std::nullopt;
  if (simulator.cache() != CacheMode::seed) {
    return std::optional<io::JournalReader>(std::in_place, job.folder, identity, options.scenario);
  }
  print_warnings({"--resume: the run begins again with frame " + std::to_string(job.frames.first) +
                  ", because with cache seed a frame needs what those before it have remembered"},
                 options);
  return std::nullopt;
}

bool is_complete(const Job& job, const ResultFolder& folder, const io::RunIdentity& identity) {
  const auto& former = folder.former();
  return former && !former->is_interrupted && former->identity == identity.text() &&
         !std::filesystem::exists(job.folder / io::journal_name);
}

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
  if (former) return std::optional<io::RunJournal>(std::in_place, job.folder, former->bytes());
  std::error_code ignored;
  std::filesystem::remove(job.folder / io::journal_name, ignored);
  if (simulator.cache() == CacheMode::seed || job.frames.count() < 2) return std::nullopt;
  return std::optional<io::RunJournal>(std::in_place, job.folder, identity);
}

/// Writes what is there as the result, where that is a frame at least, and says so where frames are left.
void write_result(Run& run, const Job& job, const ScenarioOptions& options, ResultFolder& folder,
                  const io::RunIdentity& identity, io::RunJournal* journal, int signal) {
  const bool is_cut = run.next_frame() < job.frames.last;
  if (is_cut && run.next_frame() == job.frames.first) end_interrupted(signal, job, run.next_frame(), false);
  io::RunSummary& summary = run.finish();
  if (is_cut) summary.set_interruption({signal_name(signal), run.next_frame(), job.frames.last});
  folder.commit(summary, identity.text());
  if (journal != nullptr) is_cut ? journal->keep() : journal->remove();
  print_warnings(summary.late_warnings(), options);
  if (!options.quiet) std::cout << summary.table(job.folder) << std::flush;
  if (is_cut) end_interrupted(signal, job, run.next_frame(), journal != nullptr);
}

/// Solves the frames that are left.
void go_on(Run& run, const Job& job, const ScenarioOptions& options, ResultFolder& folder,
           const io::RunIdentity& identity, io::RunJournal* journal, const StopRequest& stop) {
  try {
    run.solve(journal, stop);
    write_result(run, job, options, folder, identity, journal, stop.signal());
  } catch (const io::OutputError&) {
    if (journal != nullptr) journal->keep();  // a disk that is full today has room tomorrow
    throw;
  }
}

}  // namespace

void run_scenario(const ScenarioOptions& options) {
  Job job = prepare_job(options);
  const std::size_t devices = job.scenario.scene.receivers().size();
  expand_grids(job.scenario, options);
  Simulator simulator = make_simulator(job, options);
  require_effect(options, simulator);
  const io::RunIdentity identity = run_identity(job, options);
  ResultFolder folder(job.folder, "summary.json", "map_summary.json");
  if (job.scenario.output.html) folder.require_free("viewer.html");
  if (options.resume && is_complete(job, folder, identity)) {
    std::cerr << job.folder.string() << ": the run is complete; nothing is left to resume\n";
    return;
  }
  if (takes_all_links(simulator.scene(), simulator.settings().links)) {
    warn_of_plots(job, io::plotted_links(simulator.scene(), simulator.scene().receivers()));
  }
  const auto receivers = simulator.scene().receivers();
  if (!receivers.empty()) warn_of_slow_search(job, simulator, receivers.front(), receivers.size());
  std::optional<io::JournalReader> former = open_journal(job, options, identity, simulator);
  Run run(job, options, simulator, folder, devices);
  print_warnings(job.scenario.warnings, options);
  const StopRequest stop;
  if (former) run.replay(*former, stop);
  std::optional<io::RunJournal> journal = begin_journal(job, identity, simulator, former);
  go_on(run, job, options, folder, identity, journal ? &*journal : nullptr, stop);
}

}  // namespace dcem::program
