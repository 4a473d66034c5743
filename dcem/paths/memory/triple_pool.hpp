#pragma once
/// Every sequence of three elements of the scenery, mirrors and at most one edge, that may carry a path between an end
/// that stands and any point of a place.
///
/// Worked out once for the place, from what both light over each of their mirrors: what `CrowdTriples` does for a few
/// points, for all of a box, and so without asking single points.
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "dcem/paths/halves/beam_lists.hpp"
#include "dcem/paths/halves/double_images.hpp"
#include "dcem/paths/halves/join_orders.hpp"
#include "dcem/paths/halves/place.hpp"
#include "dcem/paths/sequence.hpp"

namespace dcem {

/// From the receiver outwards.
using Triple = std::array<SequenceElement, 3>;

class TriplePool {
 public:
  /// Of which nothing is known yet. The place must know what it lights over its mirrors; what the standing end has
  /// listed must stay as long as the pool is worked on.
  TriplePool(std::shared_ptr<const Place> place, const BeamLists& reached, const JoinOrders& orders)
      : place_(std::move(place)), reached_(reached), orders_(orders) {}

  /// Finds a part of the candidates; `steps_left` of them until all are known.
  void go_on(const Scene& scene, const FacetOutlines& outlines, const LaneScene& lanes);
  int steps_left() const { return steps_left_; }
  /// As `Place` has them.
  int next_work() const { return WorkSteps(step_work).next(steps_left_); }
  int work_left() const { return WorkSteps(step_work).left(steps_left_); }

  /// All of them, each once, in order.
  std::span<const Triple> candidates() const { return candidates_; }

 private:
  struct Finder;

  static constexpr int steps = 12;  ///< the last one puts all of them in order, too
  static constexpr std::array<int, steps> step_work{120, 90, 90, 90, 90, 90, 90, 90, 90, 90, 90, 150};
  static_assert(sum_of(step_work) == triples_work);
  std::shared_ptr<const Place> place_;
  const BeamLists& reached_;
  JoinOrders orders_;
  int steps_left_ = steps;
  std::vector<Triple> candidates_;
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/memory/triple_pool_bodies.hpp"
#endif
