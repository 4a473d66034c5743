#pragma once
/// Numbers by 64-bit keys, filled once and then asked: much faster than a map of the standard library.
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "dcem/core/random.hpp"

namespace dcem {

class KeyTable {
 public:
  /// Room for so many keys.
  explicit KeyTable(std::size_t count) : entries_(std::bit_ceil(2 * count + 1)), mask_(entries_.size() - 1) {}

  /// Keeps the number that came first for a key, which must not be the largest there is.
  void add(std::uint64_t key, std::uint32_t number) {
    Entry& entry = entries_[place_of(key)];
    if (entry.key == nothing) entry = {key, number};
  }
  std::optional<std::uint32_t> find(std::uint64_t key) const {
    const Entry& entry = entries_[place_of(key)];
    return entry.key == key ? std::optional(entry.number) : std::nullopt;
  }

 private:
  static constexpr std::uint64_t nothing = ~std::uint64_t{0};
  struct Entry {
    std::uint64_t key = nothing;
    std::uint32_t number = 0;
  };

  /// Where a key stands, or the free place where it would.
  std::size_t place_of(std::uint64_t key) const {
    std::size_t place = RandomStream(key).next() & mask_;
    while (entries_[place].key != key && entries_[place].key != nothing) place = (place + 1) & mask_;
    return place;
  }

  std::vector<Entry> entries_;
  std::size_t mask_;
};

}  // namespace dcem
