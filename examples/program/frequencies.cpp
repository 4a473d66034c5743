#include "frequencies.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <string>

#include "dcem/io/run_journal.hpp"

namespace dcem::program {
namespace {

namespace fs = std::filesystem;

bool has_begun(const ScenarioOptions& run) {
  return fs::exists(fs::path(run.folder) / io::journal_name) || fs::exists(fs::path(run.folder) / "summary.json");
}

}  // namespace

std::string frequency_text(double frequency_hz) {
  std::array<char, 32> digits{};
  return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), frequency_hz).ptr};
}

std::vector<ScenarioOptions> by_frequency(const ScenarioOptions& options) {
  if (options.frequencies_hz.empty()) return {options};
  const fs::path folder =
      options.folder.empty() ? fs::path("out") / fs::path(options.scenario).stem() : fs::path(options.folder);
  std::vector<ScenarioOptions> runs(options.frequencies_hz.size(), options);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    runs[i].frequencies_hz.clear();
    runs[i].overrides.frequency_hz = options.frequencies_hz[i];
    runs[i].folder = (folder / (frequency_text(options.frequencies_hz[i] / 1e9) + "GHz")).string();
  }
  if (std::ranges::any_of(runs, has_begun))
    for (ScenarioOptions& run : runs) run.resume = run.resume && has_begun(run);
  return runs;
}

void require_one_frequency(const ScenarioOptions& options, const char* what) {
  if (options.frequencies_hz.empty()) return;
  throw UsageError("--frequency: " + std::string(what) + " has one frequency", "one, and such a run for each");
}

}  // namespace dcem::program
