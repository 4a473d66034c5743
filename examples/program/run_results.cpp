#include "run_results.hpp"

#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "dcem/io/input_error.hpp"
#include "dcem/io/sampling_text.hpp"
#include "dcem/sim/discovery.hpp"
#include "dcem/sim/link_choice.hpp"

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
                              job.scenario.geo,
                              &simulator.pool()};
  try {
    return {folder, simulator.scene(), simulator.scene().receivers(), facts, job.scenario.output};
  } catch (const std::invalid_argument& error) {
    throw io::InputError(options.scenario, error.what());
  }
}

/// What the pictures leave out is said, not left to be found out.
void warn_of_plots(Job& job, std::size_t links) {
  const io::OutputSettings& output = job.scenario.output;
  if (!output.plots || links <= output.plots_max_links) return;
  job.scenario.warnings.push_back("output.plots: the first " + std::to_string(output.plots_max_links) + " of " +
                                  std::to_string(links) + " links have pictures (output.plots.max_links)");
}

}  // namespace

void prepare_results(Job& job, const Simulator& simulator, const ResultFolder& folder) {
  if (job.scenario.output.html) folder.require_free("viewer.html");
  if (takes_all_links(simulator.scene(), simulator.settings().links)) {
    warn_of_plots(job, io::plotted_links(simulator.scene(), simulator.scene().receivers()));
  }
  const auto receivers = simulator.scene().receivers();
  if (!receivers.empty()) warn_of_slow_search(job, simulator, receivers.front(), links_at_most(simulator));
}

bool holds_result(ResultFolder& folder, const io::RunIdentity& identity) {
  const auto& former = folder.former();
  return former && !former->is_interrupted && former->identity == identity.text() &&
         !std::filesystem::exists(folder.files().path() / io::journal_name);
}

RunResults::RunResults(const Job& job, const ScenarioOptions& options, Simulator& simulator, ResultFolder& folder,
                       std::size_t devices)
    : job_(job),
      options_(options),
      simulator_(simulator),
      writer_(make_writer(folder.files(), job, simulator, options)),
      viewer_(make_viewer(folder.files(), job, simulator)),
      summary_(run_facts(job, simulator, simulator.plan(), simulator.scene().receivers().size()), simulator.scene()),
      watch_(options.scenario, simulator, simulator.scene().receivers().first(devices), job.scenario.grids),
      begun_(work_times()),
      needs_paths_(io::needs_paths(job.scenario.output)) {}

void RunResults::add(const Frame& instant, FrameResult&& result, io::RunJournal* journal, const StopRequest& stop) {
  watch_.look(instant);
  const io::FrameFigures figures = io::figures_of(result, &simulator_.pool());
  if (needs_paths_) {
    write(instant, result);
    if (journal != nullptr) journal->add(result);
  } else {
    const io::LinePieces lines = writer_.link_lines(result);
    writer_.write_lines(lines);
    if (journal != nullptr) journal->add(figures, result.links, lines);
  }
  summary_.add(figures);
  check(instant, &result.links, result.work.sequences_proposed, stop);
  simulator_.give_back(std::move(result));
}

void RunResults::add(const Frame& instant, io::JournalEntry&& entry, const StopRequest& stop) {
  watch_.look(instant);
  summary_.add(entry.figures);
  const bool has_links = needs_paths_ || !entry.links.empty();
  const FrameResult result = entry.take_result();
  check(instant, has_links ? &result.links : nullptr, result.work.sequences_proposed, stop);
  has_links ? write(instant, result) : writer_.write_lines(entry.link_lines);
}

void RunResults::add(const Frame& instant, const io::FrameFigures& figures, const StopRequest& stop) {
  watch_.look(instant);
  summary_.add(figures);
  check(instant, nullptr, figures.work.sequences_proposed, stop);
}

/// Parts that were searched with rays hold links, for what rays lack is asked of these.
bool RunResults::writes_lines_alone() const {
  return job_.scenario.output.links && !needs_paths_ && simulator_.discovery() == Discovery::exact;
}

io::RunSummary& RunResults::finish(std::size_t frames) {
  const io::ProgressStage stage("writing results", progress_mode(options_));
  if (job_.scenario.output.plots && frames < 2) {
    summary_.add_late_warning("output.plots: one frame alone has its power delay profile and no pictures over time");
  }
  for (const std::string& line : watch_.warnings()) summary_.add_late_warning(line);
  const std::vector<std::string> notes = io::sampling_notes(sampling_);
  writer_.finish(notes.empty() ? std::string() : notes.front());
  finish_viewer(viewer_.get(), summary_, notes);
  summary_.set_work_times(work_times() - begun_);
  return summary_;
}

/// What the settings of an output cannot do with the delays of a frame is an error of the scenario.
void RunResults::write(const Frame& instant, const FrameResult& result) {
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
/// Without `links`, where only their lines are known, they are solved once more.
void RunResults::check(const Frame& instant, const std::vector<LinkResult>* links, std::uint64_t sequences,
                       const StopRequest& stop) {
  const std::size_t first = job_.frames.first, last = job_.frames.last - 1, index = instant.index;
  const bool is_chosen = index == first || index == (first + last) / 2 || index == last;
  if (simulator_.discovery() == Discovery::exact || !is_chosen || stop.signal() != 0) return;
  const auto receivers = simulator_.scene().receivers();
  std::vector<LinkResult> own;
  if (links == nullptr) own = simulator_.solve(receivers);
  SamplingReport report = check_sampling(simulator_, instant, {receivers, links ? *links : own, sequences});
  if (simulator_.cache() == CacheMode::seed) report.rays_steady = steady_rays(simulator_.settings().propagation);
  sampling_.add(report);
  summary_.set_sampling(sampling_);
}

}  // namespace dcem::program
