#pragma once
/// Every sequence of one or two elements of the scenery that may carry a path between an end that stands and any point
/// of a place.
///
/// Worked out once for the place, from what the standing end reaches (`BeamLists`) and what the place may see; in each
/// frame the gates of the point at which the device is are asked of all of it.
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "dcem/paths/halves/beam_lists.hpp"
#include "dcem/paths/halves/join_gates.hpp"
#include "dcem/paths/halves/pair_gates.hpp"
#include "dcem/paths/halves/place.hpp"
#include "dcem/paths/halves/spread_work.hpp"
#include "dcem/paths/memory/candidate_way.hpp"
#include "dcem/paths/memory/edge_candidates.hpp"

namespace dcem {

class CandidatePool {
 public:
  /// Of which nothing is known yet. What is known of the place, and what the standing end has listed, must stay as long
  /// as the pool is asked.
  CandidatePool(std::shared_ptr<const Place> place, const BeamLists& reached, const JoinOrders& orders);

  /// Finds a part of the candidates; `steps_left` of them until all are known, and may be asked for.
  void go_on(const Scene& scene, const FacetOutlines& outlines);
  int steps_left() const { return steps_left_; }
  /// As `Place` has them.
  int next_work() const { return WorkSteps(step_work).next(steps_left_); }
  int work_left() const { return WorkSteps(step_work).left(steps_left_); }

  const Place& place() const { return *place_; }
  /// Whether it holds more than it would if it were found now: the standing end knows more.
  bool is_outdated() const { return !knows_edges_ && reached_.knows_edges(); }
  std::size_t size() const { return mirrors_.size() + direct_.size() + over_mirrors_.size(); }

  /// Calls `visit(number)` for candidates of which the edge's point, where there is an edge, may be where it must; of
  /// those over mirrors alone, for all.
  template <typename Visit>
  void for_each_at(const Vec3& receiver_m, Visit&& visit) const {
    for (std::size_t number = 0; number < mirrors_.size(); ++number) visit(number);
    edges_.for_each_direct(receiver_m, [&](std::size_t at) { visit(mirrors_.size() + at); });
    edges_.for_each_mirrored(receiver_m, [&](std::size_t at) { visit(mirrors_.size() + direct_.size() + at); });
  }
  /// Works out the way of a candidate to a receiver in the place; false where its points are not on what they must be.
  bool aim(const JoinGates& gates, const Vec3& receiver_m, std::size_t number, CandidateWay& way) const;

  /// The elements of a candidate, from the receiver outwards, as one number.
  std::uint64_t key(std::size_t number) const;

 private:
  static constexpr std::uint32_t alone = 0xffffffffU;
  /// A mirror of the standing end and, where it is not alone, one of the place.
  struct MirrorCandidate {
    std::uint32_t near, far;  ///< places among the mirrors of the place and of the standing end
  };
  /// An edge, and the mirror over which the standing end lights it, or none.
  struct DirectCandidate {
    WedgeId edge;
    std::uint32_t far;
  };
  /// A mirror of the place, and an edge that the standing end sees.
  struct MirroredCandidate {
    std::uint32_t near;
    WedgeId edge;
  };

  /// What is reached of the scenery: the places of mirrors on bodies change from frame to frame.
  const BeamTable& listed() const { return reached_.tables()[BeamLists::of_scenery]; }
  void find_over_mirror(const Scene& scene, const FacetOutlines& outlines, const PlaceMirror& mirror);
  void find_edges_over(const Scene& scene, const FacetOutlines& outlines, const PlaceMirror& mirror);
  void find_single_mirrors();
  void find_over_edges(const Scene& scene);
  /// All candidates are there: gives back room for more.
  void fit();

  static constexpr int steps = 6;  ///< mirrors in five parts of them, then edges
  static constexpr std::array<int, steps> step_work{7, 4, 3, 4, 4, 2};
  static_assert(sum_of(step_work) == candidates_work);
  std::shared_ptr<const Place> place_;
  const BeamLists& reached_;
  JoinOrders orders_;
  bool knows_edges_;
  int steps_left_ = steps;
  std::vector<MirrorCandidate> mirrors_;
  std::vector<DirectCandidate> direct_;          ///< in the order in which they are in `edges_`
  std::vector<MirroredCandidate> over_mirrors_;  ///< the same
  EdgeCandidates edges_;
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/memory/candidate_pool_bodies.hpp"
#endif
