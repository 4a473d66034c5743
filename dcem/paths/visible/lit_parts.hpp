#pragma once
/// What a transmitter sees of surfaces, kept for all receivers of a frame.
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <utility>
#include <vector>

#include "dcem/core/ids.hpp"
#include "dcem/paths/visible/part_list.hpp"

namespace dcem {

/// The parts of a piece of a surface that a transmitter sees.
struct LitParts {
  PartList parts;
  bool are_too_many = false;   ///< the piece is to be halved; `parts` says nothing
  std::vector<BodyId> bodies;  ///< other than the scenery, that take something of it
};

/// For several threads at once. What is found does not depend on who asks first, as it depends on the piece alone.
class LitPartsCache {
 public:
  /// So many pieces are kept; what is asked for beyond is worked out again each time.
  static constexpr std::size_t most_pieces = 400'000;

  /// Part `place` of a triangle (as in `Tile`): what is kept, or what `find(LitParts&)` finds. The result lives as long
  /// as this, or until `spare` is used again.
  template <typename Find>
  const LitParts& of(std::uint32_t triangle, std::uint64_t place, LitParts& spare, Find&& find) {
    const Key key{triangle, place};
    Drawer& drawer = drawers_[Hash{}(key) % drawers_.size()];
    {
      const std::scoped_lock lock(drawer.mutex);
      const auto found = drawer.pieces.find(key);
      if (found != drawer.pieces.end()) return *found->second;
    }
    find(spare);
    if (count_.load(std::memory_order_relaxed) >= most_pieces) return spare;
    auto kept = std::make_unique<const LitParts>(spare);
    const std::scoped_lock lock(drawer.mutex);
    const auto [entry, is_new] = drawer.pieces.try_emplace(key, std::move(kept));
    if (is_new) count_.fetch_add(1, std::memory_order_relaxed);
    return *entry->second;
  }

 private:
  struct Key {
    std::uint32_t triangle;
    std::uint64_t place;
    bool operator==(const Key&) const = default;
  };
  struct Hash {
    std::size_t operator()(const Key& key) const {
      return (key.place * 0x9e3779b97f4a7c15ULL ^ key.triangle * 0xc2b2ae3d27d4eb4fULL) * 0x9e3779b97f4a7c15ULL >> 24U;
    }
  };
  struct Drawer {
    std::mutex mutex;
    std::unordered_map<Key, std::unique_ptr<const LitParts>, Hash> pieces;
  };

  std::array<Drawer, 64> drawers_;
  std::atomic<std::size_t> count_{0};
};

}  // namespace dcem
