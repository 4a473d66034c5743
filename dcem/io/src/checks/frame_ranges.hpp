#pragma once
/// Frames in words. Private to dcem::io.
#include <cstddef>
#include <string>
#include <vector>

namespace dcem::io {

/// "frame 3", "frames 3 to 17", "frames 3 to 17, 20 and 31 to 40": of ascending numbers; of more than four runs the
/// first three and how many frames there are in all.
inline std::string frame_ranges(const std::vector<std::size_t>& frames) {
  constexpr std::size_t most_runs = 4;
  std::vector<std::string> runs;
  for (std::size_t at = 0; at < frames.size();) {
    std::size_t last = at;
    while (last + 1 < frames.size() && frames[last + 1] == frames[last] + 1) ++last;
    runs.push_back(std::to_string(frames[at]) + (last > at ? " to " + std::to_string(frames[last]) : ""));
    at = last + 1;
  }
  std::string text = frames.size() == 1 ? "frame " : "frames ";
  const bool all = runs.size() <= most_runs;
  const std::size_t named = all ? runs.size() : most_runs - 1;
  for (std::size_t run = 0; run < named; ++run) {
    text += (run == 0 ? "" : all && run + 1 == named ? " and " : ", ") + runs[run];
  }
  return all ? text : text + " and others, " + std::to_string(frames.size()) + " in all";
}

}  // namespace dcem::io
