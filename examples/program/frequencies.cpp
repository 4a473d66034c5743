#include "frequencies.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>

#include "dcem/em/surface/material_table.hpp"
#include "dcem/io/input_error.hpp"
#include "dcem/io/run_journal.hpp"
#include "job.hpp"
#include "run_on_ranks.hpp"

namespace dcem::program {
namespace {

namespace fs = std::filesystem;

bool has_begun(const ScenarioOptions& run) {
  const auto is_there = [&](const fs::path& name) { return fs::exists(fs::path(run.folder) / name); };
  return is_there(io::journal_name) || is_there("summary.json") || is_there(parts_folder);
}

/// Where nobody says where results go.
fs::path folder_of(const ScenarioOptions& options) {
  const fs::path folder = fs::path("out") / fs::path(options.scenario).stem();
  return options.shard ? fs::path(folder) += shard_ending(*options.shard) : folder;
}

/// Reads the scenario at a frequency, before anything is computed at another. Throws InputError where it cannot be run.
void require_materials(const ScenarioOptions& run) {
  const Job job = prepare_job(run);
  const std::span<const Material> materials = job.scenario.scene.materials();
  try {
    MaterialTable({materials.begin(), materials.end()}, job.scenario.settings.frequency_hz, job.scenario.settings.itu);
  } catch (const std::invalid_argument& error) {
    throw io::InputError(run.scenario, error.what());
  }
}

}  // namespace

std::string frequency_text(double frequency_hz) {
  std::array<char, 32> digits{};
  return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), frequency_hz).ptr};
}

std::vector<ScenarioOptions> by_frequency(const ScenarioOptions& options) {
  if (options.frequencies_hz.empty()) return {options};
  const fs::path folder = options.folder.empty() ? folder_of(options) : fs::path(options.folder);
  std::vector<ScenarioOptions> runs(options.frequencies_hz.size(), options);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    runs[i].frequencies_hz.clear();
    runs[i].overrides.frequency_hz = options.frequencies_hz[i];
    runs[i].folder = (folder / (frequency_text(options.frequencies_hz[i] / 1e9) + "GHz")).string();
  }
  if (std::ranges::any_of(runs, has_begun))
    for (ScenarioOptions& run : runs) run.resume = run.resume && has_begun(run);
  for (const ScenarioOptions& run : runs) require_materials(run);
  return runs;
}

}  // namespace dcem::program
