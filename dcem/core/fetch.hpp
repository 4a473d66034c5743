#pragma once
/// Asks for memory that is soon read. In a large scene each element lies somewhere else, and waiting for it takes
/// longer than most of what is asked about it. It changes no result.
#include <cstddef>
#include <span>

namespace dcem {

inline constexpr std::size_t cache_line_bytes = 64;

// Inlined always, as all that does nothing but fetch must be: g++ 12 takes a call of such a function for one without
// any effect, and leaves it out.

/// All cache lines of some bytes.
[[gnu::always_inline]] inline void fetch_bytes(const void* from, std::size_t bytes) {
  const auto* const first = static_cast<const char*>(from);
  for (std::size_t at = 0; at < bytes; at += cache_line_bytes) __builtin_prefetch(first + at);
  if (bytes > 1) __builtin_prefetch(first + bytes - 1);
}

template <typename Item>
[[gnu::always_inline]] inline void fetch(const Item& item) {
  fetch_bytes(&item, sizeof item);
}
template <typename Item>
[[gnu::always_inline]] inline void fetch(std::span<Item> items) {
  fetch_bytes(items.data(), items.size_bytes());
}

}  // namespace dcem
