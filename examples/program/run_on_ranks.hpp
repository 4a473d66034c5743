#pragma once
/// `dcem run` under `mpirun`.
#include <string>

#include "options.hpp"

namespace dcem::program {

/// Within the folder of results, while the job goes on.
inline constexpr const char* parts_folder = "run.parts";

/// All processes of a job call it. Where `run_scenario` would throw, one of them says why, and all throw
/// `EndedElsewhere`.
void run_on_ranks(const ScenarioOptions& options);

/// For commands that processes cannot share: one of them says so, and all throw `EndedElsewhere`.
[[noreturn]] void refuse_on_ranks(const std::string& command);

}  // namespace dcem::program
