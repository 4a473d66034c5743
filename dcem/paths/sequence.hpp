#pragma once
/// The discrete identity of a candidate: which mirrors and edges, in which order, counted from the receiver.
///
/// Transmissions are no part of it: which sheets a path crosses follows from where its legs run.
#include <algorithm>
#include <compare>
#include <cstdint>
#include <span>
#include <unordered_set>
#include <vector>

#include "dcem/core/error.hpp"
#include "dcem/core/ids.hpp"
#include "dcem/core/random.hpp"

namespace dcem {

/// A mirror, or an edge that diffracts.
class SequenceElement {
 public:
  SequenceElement(FacetId mirror) : code_(mirror.value) { DCEM_ASSERT(mirror.value < edge_bit); }  // NOLINT: implicit
  SequenceElement(WedgeId edge) : code_(edge.value | edge_bit) { DCEM_ASSERT(edge.value < edge_bit); }  // NOLINT

  bool is_edge() const { return (code_ & edge_bit) != 0; }
  FacetId mirror() const { return FacetId(code_); }
  WedgeId edge() const { return WedgeId(code_ & ~edge_bit); }
  std::uint32_t code() const { return code_; }  ///< different for different elements

  friend auto operator<=>(const SequenceElement&, const SequenceElement&) = default;

 private:
  static constexpr std::uint32_t edge_bit = 0x80000000U;
  std::uint32_t code_;
};

/// From the receiver outwards; empty: the direct path.
using Sequence = std::vector<SequenceElement>;

inline std::size_t edge_count(std::span<const SequenceElement> sequence) {
  return static_cast<std::size_t>(
      std::count_if(sequence.begin(), sequence.end(), [](SequenceElement element) { return element.is_edge(); }));
}

/// Many sequences, one after another.
class SequenceList {
 public:
  void add(std::span<const SequenceElement> sequence) {
    elements_.insert(elements_.end(), sequence.begin(), sequence.end());
    ends_.push_back(elements_.size());
  }
  std::size_t size() const { return ends_.size(); }
  std::span<const SequenceElement> operator[](std::size_t index) const {
    const std::size_t first = index == 0 ? 0 : ends_[index - 1];
    return std::span(elements_).subspan(first, ends_[index] - first);
  }

 private:
  std::vector<SequenceElement> elements_;
  std::vector<std::size_t> ends_;
};

struct SequenceHash {
  std::size_t operator()(const Sequence& sequence) const noexcept {
    std::uint64_t hash = sequence.size();
    for (const SequenceElement element : sequence) hash = hash_values(hash, element.code());
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
