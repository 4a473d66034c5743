#pragma once
/// A part of a run: the links of some of its receivers.
#include <filesystem>

#include "dcem/io/run_journal.hpp"
#include "job.hpp"
#include "stop_signal.hpp"

namespace dcem::program {

/// All of it must outlive the work.
struct PartOrder {
  const Job& job;  ///< of the run; its grids are points already
  const ScenarioOptions& options;
  std::filesystem::path folder;  ///< of the part
  io::RunIdentity whole;         ///< of the run
  ReceiverPart part;
};

/// Solves all frames of a part, or those that are left where the options say --resume, and leaves its folder as
/// `io::read_shards` wants it. `simulator` has the links of the part alone. Throws InputError, OutputError and, where a
/// signal came, Interrupted.
void solve_part(const PartOrder& order, Simulator& simulator, const StopRequest& stop);

}  // namespace dcem::program
