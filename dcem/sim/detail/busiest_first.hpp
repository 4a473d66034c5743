#pragma once
/// In which order threads take receivers.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace dcem::detail {

/// Receivers by how many links they have, most first, so that no thread begins with the longest when all others are
/// done. Where they are very many it does not matter, and they stay in their order.
inline std::vector<std::size_t> busiest_first(std::size_t receivers,
                                              const std::vector<std::vector<std::uint32_t>>& transmitters_of) {
  constexpr std::size_t very_many = 1024;
  std::vector<std::size_t> order(receivers);
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (transmitters_of.size() != receivers || receivers > very_many) return order;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t one, std::size_t other) {
    return transmitters_of[one].size() > transmitters_of[other].size();
  });
  return order;
}

}  // namespace dcem::detail
