#include "resume.hpp"

#include <string>

#include "dcem/io/input_error.hpp"

namespace dcem::program {

std::optional<io::JournalReader> open_journal(const std::filesystem::path& folder, const Job& job,
                                              const ScenarioOptions& options, const io::RunIdentity& identity,
                                              const Simulator& simulator) {
  if (!options.resume) return std::nullopt;
  if (simulator.cache() != CacheMode::seed) {
    return std::optional<io::JournalReader>(std::in_place, folder, identity, options.scenario);
  }
  print_warnings({"--resume: the run begins again with frame " + std::to_string(job.frames.first) +
                  ", because with cache seed a frame needs what those before it have remembered"},
                 options);
  return std::nullopt;
}

void require_frame(const std::filesystem::path& folder, const io::FrameFigures& figures, std::size_t index,
                   const TreeUpdateReport& tree) {
  if (figures.index == index && figures.tree == tree) return;
  throw io::InputError((folder / io::journal_name).string(),
                       "does not fit frame " + std::to_string(index) + "; expected the journal of this run");
}

}  // namespace dcem::program
