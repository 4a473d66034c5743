#pragma once
/// The discrete identity of a candidate: which mirrors and edges, in which order, counted from the receiver.
///
/// Transmissions are no part of it: which sheets a path crosses follows from where its legs run.
#include <algorithm>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
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
  void clear() {
    elements_.clear();
    ends_.clear();
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
  std::size_t operator()(std::span<const SequenceElement> sequence) const noexcept {
    std::uint64_t hash = sequence.size();
    for (const SequenceElement element : sequence) hash = hash_values(hash, element.code());
    return static_cast<std::size_t>(hash);
  }
};

/// Sequences seen so far, each once, in the order in which they came. Two are the same only if all their members are: a
/// hash collision loses nothing. One that is cleared and filled again asks for no memory that it has had.
class SequenceTable {
 public:
  /// True when the sequence was not there before.
  bool insert(std::span<const SequenceElement> sequence) {
    while (2 * (size() + 1) > places_.size()) grow();
    std::uint32_t& place = places_[place_of(sequence)];
    if (place != nobody) return false;
    place = static_cast<std::uint32_t>(size());
    list_.add(sequence);
    return true;
  }
  /// Adds one that is known to be new, to a table that nobody asks for one.
  void append(std::span<const SequenceElement> sequence) { list_.add(sequence); }
  /// Its number.
  std::optional<std::size_t> find(std::span<const SequenceElement> sequence) const {
    const std::uint32_t number = places_.empty() ? nobody : places_[place_of(sequence)];
    return number == nobody ? std::nullopt : std::optional<std::size_t>(number);
  }
  bool contains(std::span<const SequenceElement> sequence) const { return find(sequence).has_value(); }

  std::size_t size() const { return list_.size(); }
  std::span<const SequenceElement> operator[](std::size_t number) const { return list_[number]; }
  void clear() {
    list_.clear();
    std::fill(places_.begin(), places_.end(), nobody);
  }
  /// Drops those for which `gone(sequence)` holds; the others close up.
  template <typename Gone>
  void erase_if(Gone&& gone) {
    SequenceTable kept;
    std::size_t number = 0;
    while (number < size() && !gone(list_[number])) ++number;
    if (number == size()) return;
    for (number = 0; number < size(); ++number) {
      if (!gone(list_[number])) kept.insert(list_[number]);
    }
    *this = std::move(kept);
  }

 private:
  static constexpr std::uint32_t nobody = 0xffffffffU;

  void grow() {
    places_.assign(std::max<std::size_t>(16, 2 * places_.size()), nobody);
    if (2 * size() > places_.size()) return;  // some have been appended: once more
    for (std::size_t number = 0; number < size(); ++number) {
      places_[place_of(list_[number])] = static_cast<std::uint32_t>(number);
    }
  }
  /// Where a sequence stands, or the free place where it would.
  std::size_t place_of(std::span<const SequenceElement> sequence) const {
    const std::size_t mask = places_.size() - 1;
    std::size_t place = SequenceHash{}(sequence)&mask;
    while (places_[place] != nobody && !std::ranges::equal(list_[places_[place]], sequence)) place = (place + 1) & mask;
    return place;
  }

  SequenceList list_;
  std::vector<std::uint32_t> places_;  ///< numbers, by hash; a power of two, at most half of them taken
};

}  // namespace dcem
