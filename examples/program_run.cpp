/// `dcem run`: every frame of a scenario, all links.
#include <iostream>

#include "dcem/io/input_error.hpp"
#include "dcem/io/result_writer.hpp"
#include "program_job.hpp"

namespace dcem::program {
namespace {

// Every point of every grid becomes a receiver.
void expand_grids(io::Scenario& scenario, const std::string& file) {
  for (const ReceiverGrid& grid : scenario.grids) {
    for (std::size_t row = 0; row < grid.rows(); ++row) {
      for (std::size_t column = 0; column < grid.columns(); ++column) {
        try {
          scenario.scene.add_receiver(grid_receiver(grid, row, column));
        } catch (const std::invalid_argument& error) {
          throw io::InputError(file, error.what());
        }
      }
    }
  }
}

void solve_frames(Simulator<>& simulator, const Job& job, io::ProgressMode progress, io::ResultWriter& writer,
                  io::RunSummary& summary) {
  io::ProgressBar bar("frames", job.frames.count(), progress);
  for (std::size_t frame = job.frames.first; frame < job.frames.last; ++frame) {
    const FrameResult result = simulator.advance_to(job.scenario.time_s(frame), frame);
    writer.write(result);
    summary.add(io::figures_of(result));
    bar.advance();
  }
}

}  // namespace

void run_scenario(const ScenarioOptions& options) {
  Job job = prepare_job(options);
  expand_grids(job.scenario, options.scenario);
  Simulator<> simulator = make_simulator(job, options);
  const auto receivers = simulator.scene().receivers();
  io::OutputFolder folder(job.folder);
  io::ResultWriter writer(folder, simulator.scene(), receivers, simulator.discovery(), job.scenario.output);
  io::RunSummary summary(run_facts(job, simulator, receivers.size()), simulator.scene());
  print_warnings(job, options);
  solve_frames(simulator, job, progress_mode(options), writer, summary);
  folder.open("summary.json").write(summary.json());
  folder.commit();
  if (!options.quiet) std::cout << summary.table(folder.path());
}

}  // namespace dcem::program
