#pragma once
/// Work that must be done by some frame, spread over the frames before it: none of them is to wait for all of it.
#include <algorithm>
#include <cstddef>
#include <numeric>
#include <span>

namespace dcem {

constexpr int sum_of(std::span<const int> work) {
  return std::accumulate(work.begin(), work.end(), 0);
}

/// Steps that are taken one after the other, and what each takes: in tenths of a millisecond, as they were measured in
/// Munich. Where they take more or less than that, all do, and shares stay shares.
class WorkSteps {
 public:
  /// The array must outlive it.
  explicit constexpr WorkSteps(std::span<const int> work) : work_(work) {}

  int count() const { return static_cast<int>(work_.size()); }
  /// What the first of the last `steps_left` steps takes.
  int next(int steps_left) const { return work_[work_.size() - static_cast<std::size_t>(steps_left)]; }
  int left(int steps_left) const { return sum_of(work_.last(static_cast<std::size_t>(steps_left))); }

 private:
  std::span<const int> work_;
};

/// What it takes to find the candidates of a place (`CandidatePool`), and those of three elements (`TriplePool`).
inline constexpr int candidates_work = 20, triples_work = 1290;

/// What a frame does of work that is to be done within this many frames: an even share of what is left and of what the
/// frame has spent already.
inline int even_share(int left, int spent, int frames) {
  frames = std::max(1, frames);
  return (left + spent + frames - 1) / frames;
}

/// Whether a frame takes one more step: rather than not if half of it fits into its share.
inline bool fits(int next, int spent, int share) {
  return 2 * spent + next <= 2 * share;
}

}  // namespace dcem
