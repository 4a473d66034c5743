#pragma once
/// What `dcem run`, `dcem map` and `dcem verify` have in common.
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "dcem/io/summary.hpp"
#include "dcem/io/viewer_writer.hpp"
#include "dcem/sim/simulator.hpp"
#include "options.hpp"

namespace dcem::program {

/// A scenario as the command line wants it. Throws InputError and UsageError.
struct Job {
  io::Scenario scenario;
  FrameRange frames;
  std::filesystem::path folder;
};
Job prepare_job(const ScenarioOptions& options);

/// Throws InputError, with the memory that it would take, where `points` of a grid or a list that take `point_bytes`
/// each are more than this machine holds. `what` as in "grid 'area'".
void require_memory(const std::string& file, const std::string& what, std::size_t points, double point_bytes);

/// Every point of every grid becomes a receiver of the scene, of a cell with several samples its centre, which is a
/// warning. Throws InputError with the name of the scenario file.
void expand_grids(io::Scenario& scenario, const std::string& file);

/// Takes the scene out of the job. What the simulator refuses is an InputError that names the scenario file.
Simulator make_simulator(Job& job, const ScenarioOptions& options);

io::RunFacts run_facts(const Job& job, const Simulator& simulator, const SearchPlan& plan, std::size_t receivers);

/// One line per warning on the error stream, unless the user wants quiet. Called when nothing in the input can be wrong
/// any more, because an error is to be the only line.
void print_warnings(const std::vector<std::string>& warnings, const ScenarioOptions& options);

/// The page of results, where the scenario asks for it; otherwise nothing.
std::unique_ptr<io::ViewerWriter> make_viewer(io::OutputFolder& folder, const Job& job, const Simulator& simulator,
                                              std::size_t map_points_per_frame = 0);

/// Writes the page; what it leaves out is a warning of the summary.
void finish_viewer(io::ViewerWriter* viewer, io::RunSummary& summary);

/// The progress bar's mode, which is never when the user wants quiet.
io::ProgressMode progress_mode(const ScenarioOptions& options);

}  // namespace dcem::program
