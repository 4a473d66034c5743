#pragma once
/// What may carry a path between the places that are known (`KnownPlaces`) and transmitters that stand: found for one
/// receiver, and taken over by whoever comes into the place after it.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "dcem/paths/memory/candidate_pool.hpp"
#include "dcem/paths/memory/triple_pool.hpp"

namespace dcem {

/// All candidates of a place for one transmitter.
struct PlacePools {
  std::shared_ptr<const CandidatePool> pool;
  std::shared_ptr<const TriplePool> triples;  ///< none where no more than two elements are asked for
};

/// As `KnownPlaces`: asked by many threads in a frame, told after it.
class KnownPools {
 public:
  /// None where they are not known.
  const PlacePools* find(const Place& place, std::size_t transmitter) const;
  void note(std::size_t transmitter, PlacePools pools);
  /// Forgets all of which `keeps(place, transmitter)` is false.
  void keep(const std::function<bool(const Place&, std::size_t)>& keeps);
  void clear() { pools_.clear(); }
  std::size_t size() const { return pools_.size(); }

 private:
  struct Known {
    std::size_t transmitter;
    PlacePools pools;  ///< these hold their place
  };

  /// Where the pools of a place for a transmitter stand among all, or would.
  std::size_t place_of(const Place& place, std::size_t transmitter) const;
  bool is_of(std::size_t at, const Place& place, std::size_t transmitter) const {
    return at < pools_.size() && pools_[at].transmitter == transmitter && &pools_[at].pools.pool->place() == &place;
  }

  std::vector<Known> pools_;  ///< by place, as it lies in memory, then by transmitter
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/memory/known_pools_bodies.hpp"
#endif
