#pragma once
/// Frames in words. Private to dcem::io.
#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace dcem::io {

/// Frames without the room of each: runs of neighbours, first and last, that ascend.
class FrameRuns {
 public:
  void add(std::size_t frame) {
    if (runs_.empty() || frame > runs_.back().second + 1) {
      runs_.emplace_back(frame, frame);
    } else if (frame >= runs_.back().second) {
      runs_.back().second = frame;
    } else {
      FrameRuns earlier;
      earlier.add(frame);
      add(earlier);
    }
  }

  void add(const FrameRuns& others) {
    runs_.insert(runs_.end(), others.runs_.begin(), others.runs_.end());
    std::ranges::sort(runs_);
    std::vector<Run> joined;
    for (const Run& run : runs_) {
      if (!joined.empty() && run.first <= joined.back().second + 1) {
        joined.back().second = std::max(joined.back().second, run.second);
      } else {
        joined.push_back(run);
      }
    }
    runs_ = std::move(joined);
  }

  std::size_t first() const { return runs_.front().first; }

  /// "frame 3", "frames 3 to 17", "frames 3 to 17, 20 and 31 to 40"; of more than four runs the first three and how
  /// many frames there are in all.
  std::string words() const {
    constexpr std::size_t most_runs = 4;
    const bool all = runs_.size() <= most_runs;
    const std::size_t named = all ? runs_.size() : most_runs - 1;
    std::string text = count() == 1 ? "frame " : "frames ";
    for (std::size_t at = 0; at < named; ++at) {
      const auto& [first, last] = runs_[at];
      text += at == 0 ? "" : all && at + 1 == named ? " and " : ", ";
      text += std::to_string(first) + (last > first ? " to " + std::to_string(last) : "");
    }
    return all ? text : text + " and others, " + std::to_string(count()) + " in all";
  }

 private:
  using Run = std::pair<std::size_t, std::size_t>;

  std::size_t count() const {
    std::size_t frames = 0;
    for (const auto& [first, last] : runs_) frames += last - first + 1;
    return frames;
  }

  std::vector<Run> runs_;
};

}  // namespace dcem::io
