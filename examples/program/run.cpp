/// `dcem run`: every frame of a scenario, all links.
#include <iostream>
#include <stdexcept>

#include "dcem/io/frame_source.hpp"
#include "dcem/io/input_error.hpp"
#include "dcem/io/placement_watch.hpp"
#include "dcem/io/result_writer.hpp"
#include "dcem/sim/discovery.hpp"
#include "job.hpp"

namespace dcem::program {
namespace {

/// Writes a frame; what the settings of an output cannot do with its delays is an error of the scenario.
void write_frame(io::ResultWriter& writer, const FrameResult& result, const ScenarioOptions& options) {
  try {
    writer.write(result);
  } catch (const std::invalid_argument& error) {
    const std::string problem = error.what();
    const bool says_what = problem.find("; expected ") != std::string::npos;
    throw io::InputError(options.scenario, problem + (says_what ? "" : "; expected wider bins"));
  }
}

void solve_frames(Simulator& simulator, const Job& job, const ScenarioOptions& options, io::FrameSource& frames,
                  io::ResultWriter& writer, io::ViewerWriter* viewer, io::PlacementWatch& watch,
                  io::RunSummary& summary) {
  io::ProgressBar bar("frames", job.frames.count(), progress_mode(options));
  for (std::size_t frame = job.frames.first; frame < job.frames.last; ++frame) {
    const Frame instant = frames.frame(simulator.scene(), frame);
    const FrameResult result = simulator.advance(instant);
    write_frame(writer, result, options);
    if (viewer != nullptr) viewer->add(instant, result);
    watch.look(instant);
    summary.add(io::figures_of(result));
    bar.advance();
    const bool is_last = frame + 1 == job.frames.last;
    if (is_last) summary.set_sampling(check_sampling(simulator, instant, simulator.scene().receivers(), result.links));
  }
}

io::ResultWriter make_writer(io::OutputFolder& folder, const Job& job, const Simulator& simulator,
                             const ScenarioOptions& options) {
  const DiffuseSettings& diffuse = simulator.settings().propagation.diffuse;
  const io::ResultFacts facts{simulator.discovery(),
                              simulator.settings().frequency_hz,
                              diffuse.enabled,
                              diffuse.enabled && diffuse.list_paths,
                              job.frames.count(),
                              job.frames.first,
                              exactly_searched_interactions(simulator.settings().propagation, simulator.plan())};
  try {
    return {folder, simulator.scene(), simulator.scene().receivers(), facts, job.scenario.output};
  } catch (const std::invalid_argument& error) {
    throw io::InputError(options.scenario, error.what());
  }
}

/// What the pictures leave out is said, not left to be found out.
void warn_of_plots(Job& job, std::size_t links) {
  const io::OutputSettings& output = job.scenario.output;
  if (!output.plots) return;
  std::vector<std::string>& warnings = job.scenario.warnings;
  if (links > output.plots_max_links) {
    warnings.push_back("output.plots: the first " + std::to_string(output.plots_max_links) + " of " +
                       std::to_string(links) + " links have pictures (output.plots.max_links)");
  }
  if (job.frames.count() < 2) {
    warnings.push_back("output.plots: one frame alone has its power delay profile and no pictures over time");
  }
}

}  // namespace

void run_scenario(const ScenarioOptions& options) {
  Job job = prepare_job(options);
  const std::size_t devices = job.scenario.scene.receivers().size();  // the rest are points of grids
  expand_grids(job.scenario, options.scenario);
  io::FrameSource frames(job.scenario);
  Simulator simulator = make_simulator(job, options);
  const auto receivers = simulator.scene().receivers();
  io::OutputFolder folder(job.folder);
  io::ResultWriter writer = make_writer(folder, job, simulator, options);
  warn_of_plots(job, io::plotted_links(simulator.scene(), receivers));
  io::RunSummary summary(run_facts(job, simulator, simulator.plan(), receivers.size()), simulator.scene());
  print_warnings(job.scenario.warnings, options);
  const auto viewer = make_viewer(folder, job, simulator);
  io::PlacementWatch watch(options.scenario, simulator, receivers.first(devices), job.scenario.grids);
  solve_frames(simulator, job, options, frames, writer, viewer.get(), watch, summary);
  for (const std::string& warning : watch.warnings()) summary.add_late_warning(warning);
  writer.finish();
  finish_viewer(viewer.get(), summary);
  folder.open("summary.json").write(summary.json());
  folder.commit();
  print_warnings(summary.late_warnings(), options);
  if (!options.quiet) std::cout << summary.table(folder.path());
}

}  // namespace dcem::program
