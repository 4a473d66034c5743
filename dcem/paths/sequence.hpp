#pragma once
/// The discrete identity of a candidate: which mirrors, in which order, counted from the receiver.
///
/// Transmissions are no part of it: which sheets a path crosses follows from where its legs run.
#include <cstdint>
#include <span>
#include <unordered_set>
#include <vector>

#include "dcem/core/ids.hpp"
#include "dcem/core/random.hpp"

namespace dcem {

/// Mirrors from the receiver outwards; empty: the direct path.
using Sequence = std::vector<FacetId>;

struct SequenceHash {
  std::size_t operator()(const Sequence& sequence) const noexcept {
    std::uint64_t hash = sequence.size();
    for (const FacetId facet : sequence) hash = hash_values(hash, facet.value);
    return static_cast<std::size_t>(hash);
  }
};

/// Sequences seen so far. Two sequences are the same only if all their members are: a hash collision loses nothing.
class SequenceTable {
 public:
  /// True when the sequence was not there before.
  bool insert(const Sequence& sequence) { return sequences_.insert(sequence).second; }
  bool contains(const Sequence& sequence) const { return sequences_.contains(sequence); }
  std::size_t size() const { return sequences_.size(); }

 private:
  std::unordered_set<Sequence, SequenceHash> sequences_;
};

}  // namespace dcem
