#pragma once
/// Items that stand in rows under numbers, such as mirrors under the facets that they light.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/core/fetch.hpp"

namespace dcem {

class RowIndex {
 public:
  /// Places of a row, from the first to one past the last.
  struct Row {
    std::uint32_t first = 0, last = 0;
  };

  /// Lays out `items` items, `number_of(item)` each, all below `numbers`: those of one number side by side, in their
  /// order, from a multiple of `unit` on. Calls `put(item, place)` for each.
  template <typename NumberOf, typename Put>
  void build(std::size_t numbers, std::size_t items, std::uint32_t unit, NumberOf&& number_of, Put&& put);

  /// How many places there are, those between rows among them.
  std::size_t size() const { return first_.empty() ? 0 : first_.back(); }
  /// The numbers under which something stands, ascending.
  std::span<const std::uint32_t> used() const { return used_; }
  /// The places under a number.
  Row row(std::uint32_t number) const {
    if (!rows_.empty()) return rows_[number];
    const auto at = std::ranges::lower_bound(used_, number);
    if (at == used_.end() || *at != number) return {};
    const auto place = static_cast<std::size_t>(at - used_.begin());
    return {first_[place], first_[place + 1]};
  }
  /// Asks for a row that is soon read.
  [[gnu::always_inline]] void fetch(std::uint32_t number) const {
    if (!rows_.empty()) dcem::fetch(rows_[number]);
  }

 private:
  std::vector<std::uint32_t> used_, first_;
  std::vector<Row> rows_;  ///< by number; none where few are used, and looked for
};

// ---------------------------------------------------------------------------------------------------------------------

template <typename NumberOf, typename Put>
void RowIndex::build(std::size_t numbers, std::size_t items, std::uint32_t unit, NumberOf&& number_of, Put&& put) {
  constexpr std::size_t few = 16;  // of so many numbers one is used, and a table of all costs more than it saves
  used_.clear();
  first_.clear();
  rows_.clear();
  if (items == 0) return;
  std::vector<std::uint32_t> next(numbers, 0);
  for (std::size_t item = 0; item < items; ++item) ++next[number_of(item)];
  std::uint32_t place = 0;
  for (std::uint32_t number = 0; number < numbers; ++number) {
    const std::uint32_t count = next[number];
    next[number] = place;
    if (count == 0) continue;
    used_.push_back(number);
    first_.push_back(place);
    place += (count + unit - 1) / unit * unit;
  }
  first_.push_back(place);
  for (std::size_t item = 0; item < items; ++item) put(item, next[number_of(item)]++);
  if (used_.size() * few < numbers) return;
  rows_.resize(numbers);
  for (std::size_t at = 0; at < used_.size(); ++at) rows_[used_[at]] = {first_[at], first_[at + 1]};
}

}  // namespace dcem
