#pragma once
/// How a run goes on with the journal of one that was ended.
#include <cstddef>
#include <filesystem>
#include <optional>

#include "dcem/io/run_journal.hpp"
#include "job.hpp"

namespace dcem::program {

/// With --resume: the journal to go on with; nothing where a run begins anew, since its frames need what the frames
/// before have remembered, which is said.
std::optional<io::JournalReader> open_journal(const std::filesystem::path& folder, const Job& job,
                                              const ScenarioOptions& options, const io::RunIdentity& identity,
                                              const Simulator& simulator);

/// Throws InputError where a frame of a journal is not the one that comes next, or the tree has not followed as it had.
void require_frame(const std::filesystem::path& folder, const io::FrameFigures& figures, std::size_t index,
                   const TreeUpdateReport& tree);

}  // namespace dcem::program
