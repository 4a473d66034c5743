#pragma once
/// Random numbers that are the same on every machine: integer hashing only, no state shared between threads.
#include <cstdint>
#include <string_view>

namespace dcem {

/// FNV-1a, 64 bit: the hash of a text, stable across platforms.
/// Source: Fowler, Noll, Vo; draft-eastlake-fnv (offset basis and prime for 64 bit).
constexpr std::uint64_t hash_text(std::string_view text, std::uint64_t hash = 0xcbf29ce484222325ULL) {
  for (const char character : text) {
    hash ^= static_cast<unsigned char>(character);
    hash *= 0x100000001b3ULL;
  }
  return hash;
}

/// SplitMix64 (Steele, Lea, Flood 2014): a small generator whose state may start at any value.
class RandomStream {
 public:
  constexpr explicit RandomStream(std::uint64_t seed) : state_(seed) {}

  constexpr std::uint64_t next() {
    state_ += 0x9e3779b97f4a7c15ULL;
    std::uint64_t bits = state_;
    bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9ULL;
    bits = (bits ^ (bits >> 27)) * 0x94d049bb133111ebULL;
    return bits ^ (bits >> 31);
  }

  /// Uniform in [0, 1), 53 random bits.
  constexpr double uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }

 private:
  std::uint64_t state_;
};

/// One 64-bit value from several: the order of the arguments matters.
template <typename... Values>
constexpr std::uint64_t hash_values(std::uint64_t first, Values... rest) {
  std::uint64_t hash = RandomStream(first).next();
  ((hash = RandomStream(hash ^ static_cast<std::uint64_t>(rest)).next()), ...);
  return hash;
}

}  // namespace dcem
