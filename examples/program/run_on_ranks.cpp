/// `mpirun -n N dcem run`: the parts of a run, handed out to whoever is idle, and merged by the first process.
#include "run_on_ranks.hpp"

#include <sched.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "failure.hpp"
#include "frequencies.hpp"
#include "job.hpp"
#include "merge.hpp"
#include "ranks.hpp"
#include "shard.hpp"

namespace dcem::program {
namespace {

namespace fs = std::filesystem;

/// More parts than processes: those whose parts are light take more of them.
constexpr std::size_t parts_per_process = 4;
/// What a process writes at once of lines that all write, unless a frame is more.
constexpr std::size_t piece_bytes = std::size_t{16} << 20U;

/// Cores that this process may use, shared with its neighbours where each may use all.
unsigned fair_threads(unsigned neighbours) {
  const unsigned all = std::max(1U, std::thread::hardware_concurrency());
  cpu_set_t own;
  const bool knows = sched_getaffinity(0, sizeof own, &own) == 0;
  const unsigned usable = knows ? static_cast<unsigned>(CPU_COUNT(&own)) : all;
  return usable < all ? usable : std::max(1U, all / neighbours);
}

/// The number of parts of a job that was ended; 0 where there is none.
std::uint64_t parts_begun(const fs::path& folder) {
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder / parts_folder, ignored)) {
    const std::string name = entry.path().filename().string();
    const std::size_t of = name.find("-of-");
    if (of != std::string::npos) return std::stoull(name.substr(of + 4));
  }
  return 0;
}

/// What each process does of a job.
class JobOnRanks {
 public:
  JobOnRanks(const ScenarioOptions& options, const Ranks& ranks) : options_(options), ranks_(ranks) {
    options_.quiet = options.quiet || !ranks.is_first();
  }

  void run() {
    ranks_.together([&] { prepare(); });
    ranks_.together([&] { begin(); });
    const std::uint64_t parts = ranks_.of_first(parts_);
    if (parts == 0) return;
    solve(static_cast<std::uint32_t>(parts));
    finish(folders_of(static_cast<std::uint32_t>(parts)));
  }

 private:
  void prepare() {
    job_ = prepare_job(options_);
    devices_ = job_.scenario.scene.receivers().size();
    expand_grids(job_.scenario, options_);
    if (job_.scenario.settings.threads == 0) job_.scenario.settings.threads = fair_threads(ranks_.here());
    identity_ = run_identity(job_, options_);
  }

  /// The first process sees whether there is anything to do, and takes the folder.
  void begin() {
    if (!ranks_.is_first()) return;
    merger_ = std::make_unique<Merger>(job_, options_, devices_, identity_);
    if (options_.resume && merger_->is_complete()) {
      std::cerr << job_.folder.string() << ": the run is complete; nothing is left to resume\n";
      return;
    }
    parts_ = options_.resume ? parts_begun(job_.folder) : 0;
    if (parts_ > 0) return;
    fs::remove_all(job_.folder / parts_folder);
    const std::size_t receivers = std::max<std::size_t>(1, job_.scenario.scene.receivers().size());
    parts_ = std::min(receivers, parts_per_process * ranks_.count());
  }

  fs::path folder_of(const ReceiverPart& part) const { return job_.folder / parts_folder / part_name(part); }

  void solve(std::uint32_t parts) {
    ScenarioOptions quiet = options_;
    quiet.quiet = true;
    std::optional<io::ProgressBar> bar;
    if (ranks_.is_first()) bar.emplace("parts", parts, progress_mode(options_));
    const StopRequest stop;
    const auto work = [&](std::size_t number) {
      const ReceiverPart part{static_cast<std::uint32_t>(number), parts};
      quiet.resume = fs::exists(folder_of(part) / io::journal_name);
      SimulationSettings settings = job_.scenario.settings;
      settings.links.receivers = part;
      Simulator simulator(job_.scenario.scene, settings);
      solve_part({job_, quiet, folder_of(part), identity_, part}, simulator, stop);
    };
    ranks_.share(parts, work, [&] { bar->advance(); });
  }

  std::vector<fs::path> folders_of(std::uint32_t parts) const {
    std::vector<fs::path> folders;
    for (std::uint32_t part = 0; part < parts; ++part) folders.push_back(folder_of({part, parts}));
    return folders;
  }

  /// The first process writes the result; the others help where that is lines alone.
  void finish(const std::vector<fs::path>& folders) {
    bool lines_alone = false;
    ranks_.together([&] {
      if (!ranks_.is_first()) return;
      merger_->begin(folders);
      lines_alone = merger_->writes_lines_alone();
    });
    const bool is_shared = ranks_.count() > 1 && ranks_.of_first(lines_alone ? 1U : 0U) != 0;
    if (is_shared) write_lines(folders);
    ranks_.together([&] {
      if (!ranks_.is_first()) return;
      merger_->finish(is_shared);
      fs::remove_all(job_.folder / parts_folder);
    });
  }

  void write_lines(const std::vector<fs::path>& folders) {
    std::string file;
    std::size_t at_once = 1;
    std::optional<io::ShardReader> shards;  // of the first process the merger has them
    const std::size_t frames = job_.frames.count();
    ranks_.together([&] {
      if (!ranks_.is_first()) return shards.emplace(open_shards(folders, job_, options_, identity_)), void();
      file = merger_->lines_file().string();
      const std::size_t fair = (frames + ranks_.count() - 1) / ranks_.count();
      const std::size_t bytes = std::max<std::size_t>(1, merger_->bytes_a_frame());
      at_once = std::clamp<std::size_t>(piece_bytes / bytes, 1, fair);
    });
    at_once = ranks_.of_first(at_once);
    std::size_t passed = 0;
    const auto piece = [&](std::size_t number) {
      if (ranks_.is_first()) return merger_->lines(number * at_once, at_once);
      for (; passed < number * at_once; ++passed) shards->pass();
      std::string lines;
      for (; passed < std::min(frames, (number + 1) * at_once); ++passed) lines += shards->next().value().link_lines;
      return lines;
    };
    ranks_.append(ranks_.of_first(file), job_.folder / "links.csv", (frames + at_once - 1) / at_once, piece);
    shards.reset();
    ranks_.together([] {});  // before the parts are removed
  }

  ScenarioOptions options_;
  const Ranks& ranks_;
  Job job_;
  std::size_t devices_ = 0;
  io::RunIdentity identity_;
  std::uint64_t parts_ = 0;
  std::unique_ptr<Merger> merger_;  ///< of the first process
};

}  // namespace

void run_on_ranks(const ScenarioOptions& options) {
  const Ranks ranks;
  ranks.say_together([&] {
    for (const ScenarioOptions& one : by_frequency(options)) JobOnRanks(one, ranks).run();
  });
}

void refuse_on_ranks(const std::string& command) {
  const Ranks ranks;
  if (ranks.is_first()) {
    const std::string problem = "mpirun with 'dcem " + command + "': each process would do all of it";
    fail({UsageError(problem, "'dcem run', or no mpirun").what(), exit_bad_input});
  }
  throw EndedElsewhere{exit_bad_input};
}

}  // namespace dcem::program
