#pragma once
/// Sorting by small whole numbers, in time proportional to how many there are.
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace dcem {

/// Sorts numbered things by a key each, digit by digit from the last one: no comparisons, of which no processor would
/// foresee how they end. The memory is kept from call to call.
class KeyOrder {
 public:
  struct Entry {
    std::uint32_t key, index;
  };
  std::vector<Entry> entries;

  /// By the lowest `key_bits` of the keys, rising; those with equal keys stay in the order given.
  void sort(std::uint32_t key_bits = 32) {
    for (std::uint32_t shift = 0; shift < key_bits; shift += digit_bits) sort_by_digit(shift);
  }

 private:
  static constexpr std::uint32_t digit_bits = 8, digits = 1U << digit_bits;

  void sort_by_digit(std::uint32_t shift) {
    std::array<std::uint32_t, digits + 1> first{};
    const auto digit = [shift](const Entry& entry) { return entry.key >> shift & (digits - 1); };
    for (const Entry& entry : entries) ++first[digit(entry) + 1];
    for (std::size_t index = 1; index <= digits; ++index) first[index] += first[index - 1];
    sorted_.resize(entries.size());
    for (const Entry& entry : entries) sorted_[first[digit(entry)]++] = entry;
    entries.swap(sorted_);
  }

  std::vector<Entry> sorted_;
};

}  // namespace dcem
