/// `dcem merge`: the parts of a run as one, with the bytes that the run has as a whole.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "dcem/core/thread_pool.hpp"
#include "dcem/io/frame_source.hpp"
#include "dcem/io/frames_ahead.hpp"
#include "dcem/io/input_error.hpp"
#include "dcem/io/run_journal.hpp"
#include "dcem/io/shards.hpp"
#include "job.hpp"
#include "merge.hpp"
#include "run_results.hpp"
#include "stop_signal.hpp"

namespace dcem::program {
namespace {

namespace fs = std::filesystem;

/// The command line that the whole run would have had.
ScenarioOptions whole_run(const MergeOptions& options, const io::ShardFacts& facts) {
  ScenarioOptions whole;
  whole.scenario = options.scenario.empty() ? facts.scenario : options.scenario;
  whole.folder = options.folder;
  whole.threads = options.threads;
  whole.memory_limit_bytes = options.memory_limit_bytes;
  whole.frames = facts.frames;
  whole.overrides = facts.overrides;
  whole.progress = options.progress;
  whole.quiet = options.quiet;
  if (!std::filesystem::exists(whole.scenario)) {
    throw io::InputError(whole.scenario,
                         "is not there; expected the scenario of the parts (--scenario FILE says where it is now)");
  }
  return whole;
}

std::vector<io::RunIdentity> identities_of(const io::RunIdentity& whole, std::uint32_t parts) {
  std::vector<io::RunIdentity> identities;
  for (std::uint32_t part = 0; part < parts; ++part) {
    identities.push_back(part_identity(whole, {part, parts}));
  }
  return identities;
}

void require_folder_of_its_own(const Job& job, const std::vector<io::ShardFolder>& shards) {
  std::error_code ignored;
  for (const io::ShardFolder& shard : shards) {
    if (!std::filesystem::equivalent(job.folder, shard.folder, ignored)) continue;
    throw io::InputError(job.folder.string(), "is the folder of a part; expected another one (-o)");
  }
}

/// The tree follows as it did in the run, as far as the work of the parts adds up to that of the run.
TreeUpdateReport follow(Simulator& simulator, const Frame& instant, const WorkCounters& spent) {
  return simulator.cache() == CacheMode::seed ? simulator.move_to(instant) : simulator.pass(instant, spent);
}

}  // namespace

io::ShardReader open_shards(std::span<const fs::path> folders, const Job& job, const ScenarioOptions& options,
                            const io::RunIdentity& identity) {
  const std::vector<io::ShardFolder> shards = io::read_shards(folders);
  require_folder_of_its_own(job, shards);
  const auto parts = static_cast<std::uint32_t>(shards.size());
  return {shards, identities_of(identity, parts), options.scenario, job.frames.count()};
}

/// Frame by frame.
class Merging {
 public:
  Merging(io::ShardReader&& shards, const Job& job, const ScenarioOptions& options, Simulator& simulator,
          ResultFolder& folder, std::size_t devices)
      : shards_(std::move(shards)),
        simulator_(simulator),
        results_(job, options, simulator, folder, devices),
        source_(job.scenario),
        frames_(source_, simulator.scene(), job.frames.first, job.frames.last, simulator.pool().size() > 1),
        bar_("frames", job.frames.count(), progress_mode(options)) {}

  /// How many frames have been taken or passed.
  std::size_t taken() const { return taken_; }
  RunResults& results() { return results_; }
  std::size_t bytes_a_frame() const { return shards_.bytes_a_frame(); }
  /// All frames have been taken or passed: what is left is not worth stopping.
  void end() {
    bar_.finish();
    stop_.reset();
  }

  /// False behind the last frame.
  bool take() {
    auto entry = shards_.next();
    if (!entry) return false;
    const Frame instant = go_on(entry->figures);
    results_.add(instant, std::move(*entry), *stop_);
    return true;
  }
  /// The lines of the next frame, which are not written, and nothing where others write them.
  std::string pass(bool lines_are_mine) {
    io::JournalEntry entry;
    lines_are_mine ? void(entry = shards_.next().value()) : void(entry.figures = shards_.pass().value());
    const Frame instant = go_on(entry.figures);
    results_.add(instant, entry.figures, *stop_);
    return std::move(entry.link_lines);
  }

 private:
  /// Where the simulator is then.
  Frame go_on(io::FrameFigures& figures) {
    if (const int signal = stop_->signal(); signal != 0) {
      throw Interrupted(signal, "interrupted by " + signal_name(signal) + ": nothing is written");
    }
    Frame instant = frames_.next();
    figures.tree = follow(simulator_, instant, figures.work);
    ++taken_;
    bar_.advance();
    return instant;
  }

  io::ShardReader shards_;
  Simulator& simulator_;
  RunResults results_;
  io::FrameSource source_;
  io::FramesAhead frames_;
  std::optional<StopRequest> stop_{std::in_place};
  io::ProgressBar bar_;
  std::size_t taken_ = 0;
};

Merger::Merger(Job& job, const ScenarioOptions& options, std::size_t devices, io::RunIdentity identity)
    : job_(job),
      options_(options),
      devices_(devices),
      identity_(std::move(identity)),
      simulator_(make_simulator(job.scenario.scene, job.scenario.settings, options)),  // the job keeps its scene
      results_(job.folder, job.scenario.name, "summary.json", "map_summary.json") {
  require_effect(options, simulator_);
  prepare_results(job, simulator_, results_);
  print_warnings(job.scenario.warnings, options);
}

Merger::~Merger() = default;

bool Merger::is_complete() {
  return holds_result(results_, identity_);
}

void Merger::begin(std::span<const fs::path> folders) {
  merging_ = std::make_unique<Merging>(open_shards(folders, job_, options_, identity_), job_, options_, simulator_,
                                       results_, devices_);
}

bool Merger::writes_lines_alone() const {
  return merging_->results().writes_lines_alone();
}

fs::path Merger::lines_file() {
  return merging_->results().links_so_far().aside();
}

std::size_t Merger::bytes_a_frame() const {
  return merging_->bytes_a_frame();
}

std::string Merger::lines(std::size_t first, std::size_t count) {
  while (merging_->taken() < first) merging_->pass(false);
  std::string lines;
  for (const std::size_t end = std::min(first + count, job_.frames.count()); merging_->taken() < end;) {
    lines += merging_->pass(true);
  }
  return lines;
}

void Merger::finish(bool others_write_lines) {
  if (others_write_lines) lines(job_.frames.count(), 0);
  while (merging_->take()) {
  }
  merging_->end();
  io::RunSummary& summary = merging_->results().finish(job_.frames.count());
  results_.commit(summary, identity_.text());
  print_warnings(summary.late_warnings(), options_);
  if (!options_.quiet) std::cout << summary.table(job_.folder) << std::flush;
  merging_.reset();  // nobody holds the parts' files any more
}

void Merger::merge(std::span<const fs::path> folders) {
  begin(folders);
  finish(false);
}

namespace {

/// Where parts are of several frequencies: the folders that any of them has for one of these; otherwise the folder
/// itself, which has no name then.
std::vector<fs::path> frequencies_of(const std::vector<std::string>& shards) {
  std::error_code ignored;
  const auto holds_part = [&](const fs::path& folder) {
    return fs::exists(folder / "summary.json", ignored) || fs::exists(folder / io::journal_name, ignored);
  };
  std::set<fs::path> names;
  for (const std::string& shard : shards) {
    if (holds_part(shard)) return {{}};
    for (const auto& entry : fs::directory_iterator(shard, ignored)) {
      if (holds_part(entry.path())) names.insert(entry.path().filename());
    }
  }
  if (names.empty()) names.insert(fs::path());
  return {names.begin(), names.end()};
}

void merge_one(const MergeOptions& options, const fs::path& frequency) {
  std::vector<fs::path> folders(options.shards.begin(), options.shards.end());
  if (!frequency.empty()) {
    for (fs::path& folder : folders) folder /= frequency;
  }
  const std::vector<io::ShardFolder> shards = io::read_shards(folders);
  ScenarioOptions whole = whole_run(options, shards.front().facts);
  if (!frequency.empty()) {
    const fs::path folder =
        options.folder.empty() ? fs::path("out") / fs::path(whole.scenario).stem() : fs::path(whole.folder);
    whole.folder = (folder / frequency).string();
  }
  Job job = prepare_job(whole);
  require_folder_of_its_own(job, shards);
  const std::size_t devices = job.scenario.scene.receivers().size();
  expand_grids(job.scenario, whole);
  Merger(job, whole, devices, run_identity(job, whole)).merge(folders);
}

}  // namespace

void merge_shards(const MergeOptions& options) {
  for (const fs::path& frequency : frequencies_of(options.shards)) merge_one(options, frequency);
}

}  // namespace dcem::program
