/// `dcem run`: every frame of a scenario, all links.
#include <iostream>

#include "dcem/io/frame_source.hpp"
#include "dcem/io/result_writer.hpp"
#include "program_job.hpp"

namespace dcem::program {
namespace {

void solve_frames(Simulator<>& simulator, const Job& job, io::ProgressMode progress, io::FrameSource& frames,
                  io::ResultWriter& writer, io::RunSummary& summary) {
  io::ProgressBar bar("frames", job.frames.count(), progress);
  for (std::size_t frame = job.frames.first; frame < job.frames.last; ++frame) {
    const FrameResult result = simulator.advance(frames.frame(simulator.scene(), frame));
    writer.write(result);
    summary.add(io::figures_of(result));
    bar.advance();
  }
}

}  // namespace

void run_scenario(const ScenarioOptions& options) {
  Job job = prepare_job(options);
  expand_grids(job.scenario, options.scenario);
  io::FrameSource frames(job.scenario);
  Simulator<> simulator = make_simulator(job, options);
  const auto receivers = simulator.scene().receivers();
  io::OutputFolder folder(job.folder);
  io::ResultWriter writer(folder, simulator.scene(), receivers, simulator.discovery(), job.scenario.output);
  io::RunSummary summary(run_facts(job, simulator, receivers.size()), simulator.scene());
  print_warnings(job, options);
  solve_frames(simulator, job, progress_mode(options), frames, writer, summary);
  folder.open("summary.json").write(summary.json());
  folder.commit();
  if (!options.quiet) std::cout << summary.table(folder.path());
}

}  // namespace dcem::program
