#pragma once
/// What a run did and what it took: `summary.json`, and the table on the console at its end.
#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "dcem/core/work_times.hpp"
#include "dcem/io/scenario.hpp"
#include "dcem/io/shard_facts.hpp"
#include "dcem/scene/scene.hpp"
#include "dcem/sim/frame_result.hpp"
#include "dcem/sim/settings.hpp"
#include "dcem/sim/verify/sampling_check.hpp"

namespace dcem {

class ThreadPool;

}  // namespace dcem

namespace dcem::io {

/// What is known before the first frame.
struct RunFacts {
  std::string version;   ///< of the program
  std::string scenario;  ///< its name
  SimulationSettings settings;
  Discovery discovery = Discovery::sampled;  ///< how paths are found: exact or sampled
  CacheMode cache = CacheMode::off;          ///< what is remembered from frame to frame
  TimeSettings time;
  std::size_t receivers = 0;          ///< points of grids included
  std::vector<std::string> warnings;  ///< one line each
  int exact_interactions = 0;         ///< up to which all paths are found
  std::string sampled_kinds{};        ///< what rays look for; empty where nothing is left to them
};

/// A run that was ended before its last frame.
struct Interruption {
  std::string signal;            ///< "SIGINT" or "SIGTERM"
  std::size_t next_frame = 0;    ///< the first that is not there
  std::size_t beyond_frame = 0;  ///< behind the last that was asked for
};

/// What is kept of a frame after its results are written.
struct FrameFigures {
  std::size_t index = 0;
  double time_s = 0.0;
  std::size_t links = 0;
  std::size_t links_with_line_of_sight = 0;
  std::size_t paths = 0;
  double update_time_s = 0.0;  ///< wall-clock time to move scene and tree
  double solve_time_s = 0.0;   ///< wall-clock time to find paths and compute fields
  TreeUpdateReport tree;
  CacheCounters cache;
  WorkCounters work;
};

/// The threads of `pool` count where links are many.
FrameFigures figures_of(const FrameResult& frame, ThreadPool* pool = nullptr);

/// Collects the figures of a run. The scene must outlive it.
class RunSummary {
 public:
  RunSummary(RunFacts facts, const Scene& scene);

  void add(const FrameFigures& frame) { frames_.push_back(frame); }
  /// What was not known before the first frame.
  void add_late_warning(std::string line) { late_warnings_.push_back(std::move(line)); }
  /// What is missing on links that were searched again.
  void set_sampling(SamplingReport report) { sampling_ = std::move(report); }
  const SamplingReport& sampling() const { return sampling_; }
  /// Where the run is a part of one.
  void set_shard(ShardFacts shard) { shard_ = std::move(shard); }
  /// What the frames, and writing them, have taken.
  void set_work_times(const WorkTimes& times) { work_times_ = times; }
  void set_interruption(Interruption interruption) { interruption_ = std::move(interruption); }
  /// What the run is of, as `RunIdentity::text` has it, and the names of all its files, the summary among them.
  void set_files(std::string identity, std::vector<std::string> names) {
    identity_ = std::move(identity);
    files_ = std::move(names);
  }

  /// The text of `summary.json`: `version`, `scenario`, `identity`, `files`, `interrupted`, `shard` (of a part alone),
  /// `scene`, `settings`, `warnings`, `sampling` (null where nothing is left to rays), `totals`, `frames`. Times differ
  /// from run to run; everything else is the same for the same input.
  [[nodiscard]] std::string json() const;
  /// The same in parts, a frame at a time.
  void write_json(const std::function<void(std::string_view)>& write) const;

  /// What is known only after the last frame; one line each.
  [[nodiscard]] std::vector<std::string> late_warnings() const;

  /// The table for the console. `folder` is where the results are.
  [[nodiscard]] std::string table(const std::filesystem::path& folder) const;

 private:
  [[nodiscard]] std::string cache_text(const CacheCounters& cache) const;
  [[nodiscard]] std::vector<std::string> warnings() const;
  [[nodiscard]] std::string diffuse_text(const FrameFigures& sum) const;

  RunFacts facts_;
  const Scene& scene_;
  std::vector<FrameFigures> frames_;
  SamplingReport sampling_{};
  WorkTimes work_times_{};
  std::vector<std::string> late_warnings_{};
  std::optional<Interruption> interruption_;
  std::optional<ShardFacts> shard_;
  std::string identity_;
  std::vector<std::string> files_;
};

/// What the summary of a former result says of it.
struct FormerResult {
  std::string scenario;  ///< its name
  std::string identity;
  std::vector<std::string> files;  ///< names that were written; empty where it does not say
  bool is_interrupted = false;
};

/// Nothing where there is no summary, or where it is none of this program.
std::optional<FormerResult> read_former_result(const std::filesystem::path& summary);

}  // namespace dcem::io
