#pragma once
/// What is in both of two ascending lists.
#include <algorithm>
#include <cstddef>
#include <span>

namespace dcem {

/// Calls `visit(place)`, the place in `one`, for each value that stands in both of two ascending lists without
/// repetition, in ascending order.
template <typename Value, typename Visit>
void for_each_in_both(std::span<const Value> one, std::span<const Value> other, Visit&& visit) {
  constexpr std::size_t much_longer = 16;  // a step of a merge takes 1 ns, a search in a long list 20
  if (one.size() * much_longer < other.size()) {
    for (std::size_t place = 0; place < one.size(); ++place) {
      if (std::ranges::binary_search(other, one[place])) visit(place);
    }
    return;
  }
  if (other.size() * much_longer < one.size()) {
    for (const Value& value : other) {
      const auto found = std::ranges::lower_bound(one, value);
      if (found != one.end() && *found == value) visit(static_cast<std::size_t>(found - one.begin()));
    }
    return;
  }
  for (std::size_t place = 0, beside = 0; place < one.size() && beside < other.size();) {
    const bool is_after = other[beside] < one[place], is_before = one[place] < other[beside];
    if (!is_after && !is_before) visit(place);
    place += is_after ? 0 : 1;
    beside += is_before ? 0 : 1;
  }
}

}  // namespace dcem
