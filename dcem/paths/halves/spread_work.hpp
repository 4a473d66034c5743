#pragma once
/// Work that must be done by some frame, spread over the frames before it: none of them is to wait for all of it.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>
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
inline constexpr int candidates_work = 24, triples_work = 1170;

/// Where a frame stands with work that some frames share.
struct WorkAhead {
  int frames = 1;      ///< that are left for it, this one among them
  int spent = 0;       ///< by this frame, on other parts of it
  double early = 0.5;  ///< as `early_of` has it
};

/// How much a frame may do of work that is to be done within some frames: an even share of what is left, and what the
/// frames before have not done of theirs. What they have done beyond it is taken off.
class WorkAllowance {
 public:
  /// Another frame begins, the first of so many in which what is left is to be done.
  void next_frame(int left, int frames) { allowed_ += (left - allowed_) / std::max(1, frames); }
  void spend(int work) { allowed_ -= work; }

  /// Whether the next step may be taken; `early` is what of it may still be missing, from 0 to 1.
  bool covers(int step, double early) const { return allowed_ >= (1.0 - early) * step; }

 private:
  double allowed_ = 0.0;
};

/// How much of its lists a device that stands may make in a frame. They take long and pay late: where it is known how
/// many frames there will be they are made in the first ones, or not at all.
struct ListPace {
  static constexpr double least = 0.1;

  std::optional<std::size_t> frames_left{};  ///< the one at hand among them; none: nobody knows
  double spared = 0.0;  ///< of what its links take from scratch, by what is known of places: from 0 to 1

  /// For each link that takes so long from scratch, where later frames may never ask for it: no frame is to take much
  /// longer than from scratch.
  double careful_us(double from_scratch_us) const { return (least + spared) * from_scratch_us; }
};

/// Which share of a step a device takes early. Where all take as much, all that have set out together take their steps
/// in the same frames, with nothing in those between: no two of a few are close to each other here.
inline double early_of(std::size_t device) {
  constexpr double golden = 0.6180339887498949;
  const double turns = 0.5 + golden * static_cast<double>(device);
  return turns - std::floor(turns);
}

}  // namespace dcem
