#pragma once
/// What `dcem run`, `dcem map` and `dcem verify` have in common.
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dcem/io/run_journal.hpp"
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

/// Throws InputError, with the memory that it would take, where so many points or links that take `each_bytes` are more
/// than this machine holds, or than --memory-limit. `what` as in "grid 'area': 39 points".
void require_memory(const ScenarioOptions& options, const std::string& what, std::size_t count, double each_bytes);

/// "grid 'area': 39 points".
std::string points_text(const std::string& kind, const std::string& id, std::size_t points);

/// Every point of every grid becomes a receiver of the scene, of a cell with several samples its centre, which is a
/// warning. Throws InputError with the name of the scenario file, also where the links of a frame would take too much
/// memory.
void expand_grids(io::Scenario& scenario, const ScenarioOptions& options);

/// Takes the scene out of the job. What the simulator refuses is an InputError that names the scenario file.
Simulator make_simulator(Job& job, const ScenarioOptions& options);
/// The same of a scene that is handed over.
Simulator make_simulator(Scene scene, const SimulationSettings& settings, const ScenarioOptions& options);

io::RunFacts run_facts(const Job& job, const Simulator& simulator, const SearchPlan& plan, std::size_t receivers);

/// Of a frame of `dcem run`; where links have a range there are fewer.
std::size_t links_at_most(const Simulator& simulator);

/// Where a sampled search would take hours for so many links of a frame, a warning says so. `receiver`: one of those
/// that are searched for.
void warn_of_slow_search(Job& job, const Simulator& simulator, const Device& receiver, std::size_t links);

/// One line per warning on the error stream, an object where progress is told in JSON; nothing where the user wants
/// quiet. Called when nothing in the input can be wrong
/// any more, because an error is to be the only line.
void print_warnings(const std::vector<std::string>& warnings, const ScenarioOptions& options);

/// The page of results, where the scenario asks for it; otherwise nothing.
std::unique_ptr<io::ViewerWriter> make_viewer(io::OutputFolder& folder, const Job& job, const Simulator& simulator,
                                              std::size_t map_values_per_frame = 0);

/// Writes the page, with these notes; what it leaves out is a warning of the summary.
void finish_viewer(io::ViewerWriter* viewer, io::RunSummary& summary, const std::vector<std::string>& notes);

/// How progress is shown, which is not at all when the user wants quiet.
io::ProgressMode progress_mode(const ScenarioOptions& options);

/// What a run goes on with has to be of the same; of a part that of the whole run.
io::RunIdentity run_identity(const Job& job, const ScenarioOptions& options);

/// As part of the name of a folder: "0-of-4".
std::string part_name(const ReceiverPart& part);

/// What ends the name of the folder of a part, where nobody says where it is: ".shard-0-of-4".
std::string shard_ending(const ReceiverPart& part);

/// That of a part of the run.
io::RunIdentity part_identity(io::RunIdentity whole, const ReceiverPart& part);

/// Throws UsageError for an option that changes nothing: rays and their seed where no ray is shot.
void require_effect(const ScenarioOptions& options, const Simulator& simulator);

/// The folder of the results of one command, with those of a former run of it there.
class ResultFolder {
 public:
  /// `summary` is the name of the command's own summary, `other_summary` that of the command that may share the folder.
  /// Throws InputError where that one has the results of another scenario there.
  ResultFolder(std::filesystem::path folder, const std::string& scenario, const char* summary,
               const char* other_summary);

  io::OutputFolder& files() { return files_; }
  const std::optional<io::FormerResult>& former() const { return former_; }
  /// Throws InputError where the result of the other command has a file of this name.
  void require_free(const std::string& name) const;
  /// Writes the summary, and all files in place of those of the former run.
  void commit(io::RunSummary& summary, const std::string& identity);

 private:
  io::OutputFolder files_;
  std::string summary_;
  std::optional<io::FormerResult> former_, other_;
};

}  // namespace dcem::program
