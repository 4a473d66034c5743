#pragma once
/// How a `BasicSimulator` finds the paths of a link whose ends stand, from what it has noted of it; included by
/// basic_simulator.hpp.
#include <optional>
#include <utility>

#include "dcem/paths/halves/half_joiner.hpp"
#include "dcem/paths/halves/triple_joiner.hpp"
#include "dcem/paths/memory/standing_link.hpp"
#include "dcem/sim/basic_simulator.hpp"
#include "dcem/sim/detail/simulator_memory.hpp"

namespace dcem {

/// What a sequence brings between ends that stand. Notes it where it may carry a path as long as they do; where the
/// scenery stops it, it does not, and need not be solved.
template <SurfaceModel Surface, SpatialIndex Index>
std::optional<PathContribution> BasicSimulator<Surface, Index>::note_standing(FollowedLink& link,
                                                                              const Sequence& sequence) const {
  std::optional<StandingWay> way = link.ways.find(link.from(), link.of.end, sequence, link.counters.solver);
  if (!way) return std::nullopt;
  std::optional<PathContribution> found = link.solve(sequence);
  link.memory.standing.add({std::move(*way), found, link.solver.had_choice()});
  return found;
}

template <SurfaceModel Surface, SpatialIndex Index>
std::vector<PathContribution> BasicSimulator<Surface, Index>::paths_of_standing(FollowedLink& link,
                                                                                bool fields_stay) const {
  StandingLink<PathContribution>& standing = link.memory.standing;
  const Following& following = link.of;
  const auto has_moved = [&](SequenceElement element) {
    const BodyId body = element.is_edge() ? scene_.wedge(element.edge()).body : scene_.facet(element.mirror()).body;
    return change_->moved()[body.value] != 0;
  };
  if (change_->any_moved()) standing.drop(has_moved);
  for (auto& entry : standing.entries()) {
    if ((entry.has_choice && change_->any()) || change_->boxes().meet(entry.way.points_m, entry.way.around)) {
      ++link.cache.revalidated;
      const bool was = entry.outcome.has_value();
      entry.outcome = link.solve(entry.way.sequence);
      entry.has_choice = link.solver.had_choice();
      ++(entry.outcome ? link.cache.reused : link.cache.expired);
      if (!was && !entry.outcome) --link.cache.expired;
    } else if (entry.outcome) {
      ++link.cache.taken_over;
      if (!fields_stay) {
        entry.outcome = following.field.evaluate(std::move(entry.outcome->path),
                                                 following.transmitters.radio_of(link.transmitter), following.radio);
      }
    }
  }
  if (change_->any_moved() && following.search.max_interactions > 0) {
    const auto add = [&](const Sequence& sequence) {
      ++link.counters.sequences_proposed;
      note_standing(link, sequence);
    };
    const JoinOrders orders = joined_orders(following.search);
    const KeptHalf& mast = following.transmitters.halves[link.transmitter];
    HalfJoiner(scene_, *outlines_, orders).for_each_moved_sequence(*following.half, mast.half(), add, mast.lists());
    if (joins_triples(following.search)) {
      TripleJoiner(scene_, *outlines_, *lanes_, orders).for_each_moved_sequence(*following.lists, *mast.lists(), add);
    }
  }
  std::vector<PathContribution> paths;
  for (const auto& entry : standing.entries()) {
    if (entry.outcome) paths.push_back(*entry.outcome);
  }
  return paths;
}

}  // namespace dcem
