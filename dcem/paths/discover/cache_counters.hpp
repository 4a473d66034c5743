#pragma once
/// Books of the memory of paths.
#include <cstdint>

namespace dcem {

/// What became of the remembered sequences in a frame; sums over links.
struct CacheCounters {
  std::uint64_t taken_over = 0;   ///< paths that nothing which has moved can have touched: they are those of before
  std::uint64_t revalidated = 0;  ///< remembered sequences that were solved again
  std::uint64_t reused = 0;       ///< of these, sequences that carry a path again
  std::uint64_t expired = 0;      ///< remembered sequences that do not, or that led over an object that is gone
  std::uint64_t born = 0;         ///< paths whose sequence was not among the link's paths in the frame before
  std::uint64_t died = 0;         ///< sequences of the frame before without a path now

  CacheCounters& operator+=(const CacheCounters& other) {
    taken_over += other.taken_over;
    revalidated += other.revalidated;
    reused += other.reused;
    expired += other.expired;
    born += other.born;
    died += other.died;
    return *this;
  }
  friend bool operator==(const CacheCounters&, const CacheCounters&) = default;
};

}  // namespace dcem
