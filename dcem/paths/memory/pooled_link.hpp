#pragma once
/// A link whose transmitter stands, while its receiver moves through a place: the pool of what may carry a path there,
/// and of each candidate why it carried none, and how far the receiver may move until that has to be asked again.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "dcem/paths/halves/spread_work.hpp"
#include "dcem/paths/memory/known_pools.hpp"
#include "dcem/paths/memory/receiver_way.hpp"
#include "dcem/paths/memory/sure_blocker.hpp"
#include "dcem/paths/memory/triple_ways.hpp"
#include "dcem/paths/memory/way_finder.hpp"

namespace dcem {

/// What the candidates of a link are judged with, in one frame.
template <typename Index>
struct PoolJudge {
  const JoinGates& gates;
  const FacetOutlines& outlines;
  const LinkEnd &transmitter, &receiver;
  const PathHalf& transmitter_half;
  const WayFinder<Index>& ways;
  SolverCounters& counters;
};

/// What the candidates of a link are found with.
struct PoolSource {
  const Scene& scene;
  const FacetOutlines& outlines;
  const LaneScene& lanes;
  const BeamLists& reached;  ///< by the transmitter
  JoinOrders orders;
  const KnownPools& known;  ///< by others, who came into the place before
  std::size_t transmitter;  ///< its number there
};

class PooledLink {
 public:
  void forget();
  bool is_of(const Place& place) const { return of_place_.pool && &of_place_.pool->place() == &place; }

  /// Finds candidates of a place that will be entered after some frames: a share of them.
  void prepare(const PoolSource& source, std::shared_ptr<const Place> place, const WorkAhead& work);

  /// Goes over to another place. What is known of a candidate that both places have is kept.
  void enter(const PoolSource& source, std::shared_ptr<const Place> place);

  /// Where the transmitter has learnt what makes fewer candidates of the place, finds some of them anew, over frames in
  /// which no other place is prepared, and goes over to them.
  void renew(const PoolSource& source, const std::shared_ptr<const Place>& place);

  /// The candidates that were found for this link, once, as soon as it has gone over to them.
  std::optional<PlacePools> news() {
    if (!has_news_) return std::nullopt;
    has_news_ = false;
    return of_place_;
  }

  /// Calls `solve(sequence) -> bool` for candidates that may carry a path; it says whether they do.
  template <typename Index, typename Solve>
  void for_each_open(const PoolJudge<Index>& judge, Solve&& solve) {
    go_on_to(judge.receiver.position_m);
    of_place_.pool->for_each_at(judge.receiver.position_m, [&](std::size_t number) {
      Slot& slot = slots_[number];
      if (receiver_way_.is_refused(slot) ||
          !of_place_.pool->aim(judge.gates, judge.receiver.position_m, number, way_)) {
        return;
      }
      const bool was_open = slot.is_open;
      slot.is_open = was_open && solve(way_.elements);
      const auto reach = [&](const Drift& receiver) {
        return way_reach(judge.gates.scene(), judge.receiver.position_m, way_, receiver);
      };
      if (slot.is_open || is_masked(judge, slot, reach) || is_stopped_by_any(judge, slot, reach) || was_open) return;
      slot.is_open = solve(way_.elements);
    });
  }

  /// The same for candidates of three elements, after the others.
  template <typename Index, typename Solve>
  void for_each_open_triple(const PoolJudge<Index>& judge, const BeamLists& reached, Solve&& solve) {
    if (!of_place_.triples) return;
    TripleWays ways(judge.gates, judge.outlines, judge.receiver.position_m, of_place_.pool->place().sight(), reached);
    const std::span<const Triple> all = of_place_.triples->candidates();
    for (std::size_t number = 0; number < all.size(); ++number) {
      Slot& slot = triple_slots_[number];
      if (receiver_way_.is_refused(slot)) continue;
      const bool was_open = std::exchange(slot.is_open, false);
      const auto refuses = [&](const Drift& receiver) { return ways.refuses(all[number], receiver); };
      // Most are refused, and for as long as they were the last time.
      const bool is_refused = receiver_way_.holds_ahead(slot, refuses) ||
                              receiver_way_.holds_for_a_while(slot, refuses, ReceiverWay::Ahead::fails);
      slot.is_masked = is_refused && ways.is_hidden();
      if (is_refused) continue;
      way_.elements.assign(all[number].begin(), all[number].end());
      way_.points_m = ways.points_m();
      const auto reach = [&](const Drift& receiver) {
        ways.work_out(all[number], receiver);
        return ways.reach();
      };
      if (was_open) slot.is_open = solve(way_.elements);
      if (slot.is_open || (ways.has_points() && is_stopped_by_any(judge, slot, reach)) || was_open) continue;
      slot.is_open = solve(way_.elements);
    }
  }

 private:
  struct Slot : Refusal {
    bool is_known = false, is_open = false, is_masked = false;
    Blocker blocker{};  ///< what stopped it last, where it is known
  };

  /// Takes over the candidates of a place from others, where they are known; `old` ones, too, that hold more than they
  /// would if they were found now. Otherwise makes room for them, unless they are being found already.
  void begin(const PoolSource& source, std::shared_ptr<const Place> place, bool old);
  void go_on(const PoolSource& source);
  int work_left() const { return (made_ ? made_->work_left() : 0) + (made_triples_ ? made_triples_->work_left() : 0); }
  int next_work() const { return made_->steps_left() > 0 ? made_->next_work() : made_triples_->next_work(); }

  /// The receiver is at a point now.
  void go_on_to(const Vec3& receiver_m);

  /// Goes over to the candidates of three elements of the next place.
  void enter_triples(const TriplePool* before);

  /// Whether something opaque surely stops the candidate aimed at; if so, until when, and what it is.
  /// `reach(drift)` says how far the points of the way may move while the receiver does.
  template <typename Index, typename Reach>
  bool is_stopped_by_any(const PoolJudge<Index>& judge, Slot& slot, Reach&& reach) {
    if (slot.is_known && is_stopped(judge, slot, reach)) return true;
    points_m_.assign(way_.points_m.rend() - static_cast<std::ptrdiff_t>(way_.elements.size()), way_.points_m.rend());
    const auto blocker =
        judge.ways.blocker(judge.transmitter, judge.receiver, way_.elements, points_m_, judge.counters);
    if (!blocker) return false;
    slot.blocker = *blocker;
    slot.is_known = true;
    return is_stopped(judge, slot, reach);
  }

  /// Whether an end surely does not see the point of the candidate aimed at that is next to it; if so, until when.
  template <typename Index, typename Reach>
  bool is_masked(const PoolJudge<Index>& judge, Slot& slot, Reach&& reach) const {
    const Scene& scene = judge.gates.scene();
    const Sight &near = of_place_.pool->place().sight(), &far = judge.transmitter_half.sight();
    slot.is_masked = receiver_way_.holds_for_a_while(slot, [&](const Drift& receiver) {
      const WayReach moved = reach(receiver);
      return hides(scene, judge.outlines, near, 0, moved) ||
             hides(scene, judge.outlines, far, way_.elements.size() - 1, moved);
    });
    return slot.is_masked;
  }
  bool hides(const Scene& scene, const FacetOutlines& outlines, const Sight& sight, std::size_t at,
             const WayReach& reach) const;

  template <typename Index, typename Reach>
  bool is_stopped(const PoolJudge<Index>& judge, Slot& slot, Reach&& reach) const {
    const Scene& scene = judge.gates.scene();
    const std::size_t leg = slot.blocker.leg, count = way_.elements.size();
    std::array<FacetId, 4> own;
    std::size_t owned = 0;
    const auto add = [&](SequenceElement element) {
      const std::array<FacetId, 2> facets =
          element.is_edge() ? scene.wedge(element.edge()).facets : std::array{element.mirror(), element.mirror()};
      for (const FacetId facet : facets) own[owned++] = facet;
    };
    if (leg > 0) add(way_.elements[count - leg]);
    if (leg < count) add(way_.elements[count - 1 - leg]);
    const FacetId facet = scene.facet_of_triangle(slot.blocker.triangle);
    const auto touches = [&](const LinkEnd& end) { return std::ranges::binary_search(end.mounted_on, facet); };
    if ((leg == 0 && touches(judge.transmitter)) || (leg == count && touches(judge.receiver))) return false;
    VagueLeg vague{leg == 0 ? judge.transmitter.position_m : way_.points_m[count - leg],
                   leg == count ? judge.receiver.position_m : way_.points_m[count - 1 - leg],
                   Drift(),
                   Drift(),
                   std::span(own).first(owned),
                   {judge.transmitter.ignored_body, judge.receiver.ignored_body}};
    const bool may_move = scene.facet(facet).body != BodyId(0);
    return receiver_way_.holds_for_a_while(
        slot,
        [&](const Drift& receiver) {
          const WayReach moved = reach(receiver);
          vague.from = leg == 0 ? Drift() : moved[count - leg];
          vague.to = leg == count ? receiver : moved[count - 1 - leg];
          return surely_stops(scene, judge.outlines, slot.blocker.triangle, vague);
        },
        may_move ? ReceiverWay::Ahead::not_asked : ReceiverWay::Ahead::unknown);
  }

  PlacePools of_place_, next_;
  // The next ones, as long as they are found for this link.
  std::shared_ptr<CandidatePool> made_;
  std::shared_ptr<TriplePool> made_triples_;
  WorkAllowance allowance_;
  bool has_news_ = false;
  std::vector<Slot> triple_slots_;
  std::vector<Slot> slots_;
  ReceiverWay receiver_way_;
  CandidateWay way_;
  std::vector<Vec3> points_m_;
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/memory/pooled_link_bodies.hpp"
#endif
