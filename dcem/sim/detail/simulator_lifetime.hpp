#pragma once
/// How a `BasicSimulator` finds how far everything may move before a path of a link appears or vanishes; included by
/// basic_simulator.hpp.
#include <span>
#include <utility>
#include <vector>

#include "dcem/paths/lifetime/lifetime_finder.hpp"
#include "dcem/sim/basic_simulator.hpp"

namespace dcem {

/// Whether it is asked for, and can be proved.
template <SurfaceModel Surface, SpatialIndex Index>
bool BasicSimulator<Surface, Index>::finds_lifetimes() const {
  const PropagationSettings& propagation = settings_.propagation;
  if (!propagation.valid_until_limit_m || !change_ || plan_.joined == 0) return false;
  return why_no_lifetimes(propagation, plan_.discovery).empty();
}

/// Those of links that are as they were are known.
template <SurfaceModel Surface, SpatialIndex Index>
void BasicSimulator<Surface, Index>::find_lifetimes(std::vector<LinkResult>& links,
                                                    const TransmitterEnds& transmitters) {
  if (!rims_) rims_.emplace(scene_);
  const PropagationSettings& propagation = settings_.propagation;
  const PathSearchSettings search = search_settings();
  const Tracer tracer(scene_, index_);
  const LifetimeSettings settings{*propagation.valid_until_limit_m, joined_orders(search), search.edges,
                                  propagation.max_transmissions, propagation.line_of_sight};
  LifetimeFinder<Index> finder(tracer, *outlines_, *rims_, settings, half_settings(search), transmitters.link);
  std::vector<std::vector<LinkResult*>> by_receiver(receivers_.size());
  for (LinkResult& link : links) {
    if (!link.valid_until_m) by_receiver[link.receiver].push_back(&link);
  }
  pool_->for_each(by_receiver.size(), [&](std::size_t index, unsigned) {
    if (by_receiver[index].empty()) return;
    typename LifetimeFinder<Index>::Receiver receiver(finder, *receivers_[index].end);
    for (LinkResult* const link : by_receiver[index]) {
      std::vector<Sequence> open;
      for (const PathContribution& path : link->paths) open.push_back(sequence_of(path.path));
      link->valid_until_m = receiver.valid_until_m(link->transmitter, open);
      receivers_[index].link(link->transmitter).result->valid_until_m = link->valid_until_m;
    }
  });
}

}  // namespace dcem
