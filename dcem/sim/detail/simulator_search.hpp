#pragma once
/// How a `BasicSimulator` finds the paths of one receiver; included by basic_simulator.hpp.
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "dcem/sim/basic_simulator.hpp"
#include "dcem/sim/detail/link_work.hpp"

namespace dcem {

/// How the paths of one receiver's links are found: all in one go, or each link's by itself.
template <SurfaceModel Surface, SpatialIndex Index>
struct BasicSimulator<Surface, Index>::ReceiverSearch {
  ReceiverSearch(const BasicSimulator& simulator, const Device& receiver, const LinkEnd& at,
                 const TransmitterEnds& ends, const Proposals& from)
      : scene(simulator.scene_),
        outlines(simulator.outlines_ ? &*simulator.outlines_ : nullptr),
        lanes(simulator.lanes_.get()),
        tracer(simulator.scene_, simulator.index_),
        search(simulator.search_settings(ends.contacts.known())),
        key{receiver.id, simulator.frame_.index},
        transmitters(ends),
        end(at),
        proposals(from),
        transmitter_ends(simulator.ends_beside(receiver, ends, others)) {
    if (simulator.plan_.joined == 0 || !proposals.joined.empty()) return;
    joins = true;
    known = transmitters.half_of(receiver.id, end, joins_triples(search));
    if (known == nullptr) look_from(scene, search, *outlines, *lanes, end, *proposals.room);
  }

  std::vector<LinkPaths> find_together(PathCache* cache, SearchCounters& counters) const {
    std::vector<SequenceList> own;
    if (joins) own = join_halves(scene, search, halves(), transmitter_ends);
    return find_paths(tracer, search, end, key, transmitter_ends, counters, cache, transmitters.reached,
                      joins ? std::span<const SequenceList>(own) : proposals.joined);
  }

  LinkPaths find_apart(std::size_t transmitter, WorkCounters& work) const {
    SequenceList own;
    if (joins) own = join_link(scene, search, halves(), transmitter);
    const SequenceList& sequences = joins ? own : proposals.joined[transmitter];
    SearchCounters counters;
    std::vector<LinkPaths> paths =
        find_paths(tracer, search, end, key, transmitter_ends.subspan(transmitter, 1), counters, nullptr,
                   std::span(transmitters.reached).subspan(transmitter, 1), std::span(&sequences, 1));
    detail::add_search_work(counters, work);
    return std::move(paths.front());
  }

  LinkHalves halves() const {
    const ReceiverRoom& room = *proposals.room;
    return {*outlines, *lanes, transmitters.halves, known ? known->half() : room.half,
            known && known->lists() ? *known->lists() : room.lists};
  }

  const Scene& scene;
  const FacetOutlines* outlines;  ///< these two only where the plan has halves
  const LaneScene* lanes;
  Tracer tracer;
  PathSearchSettings search;
  SphereKey key;
  const TransmitterEnds& transmitters;
  const LinkEnd& end;
  const Proposals& proposals;
  bool joins = false;               ///< halves are joined here; otherwise that has been done, or is not
  const KeptHalf* known = nullptr;  ///< the receiver's, where it transmits, too
  std::vector<std::optional<LinkEnd>> others;
  std::span<const std::optional<LinkEnd>> transmitter_ends;
};

}  // namespace dcem
