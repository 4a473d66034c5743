#pragma once
/// Eight lanes that wait, the one with the smallest number first: chosen without branches, which no processor would
/// foresee.
#include <array>
#include <bit>
#include <cstdint>

#include "dcem/core/simd.hpp"

namespace dcem::detail {

/// A lane's key is a number from zero on, as an integer of the same bits, the last three of which tell the lane.
/// Integers have the order of such numbers; here to eight units of the last place.
class LaneKeys {
 public:
  LaneKeys() = default;  // no initial value: a stack of them would be cleared
  [[gnu::always_inline]] LaneKeys(const Float8& numbers, const Mask8& waiting)
      : keys_(std::bit_cast<SimdLanes<IntPart>>(numbers)) {
    keys_.with(std::bit_cast<SimdLanes<IntPart>>(lane_numbers),
               [](auto& part, const auto& lane) { part = (part & ~lane_bits) | lane; });
    keys_.with(waiting.lanes, [](auto& part, const auto& waits) { part = waits ? part : IntPart{} + none; });
  }

  /// All lanes wait.
  [[gnu::always_inline]] explicit LaneKeys(const Float8& numbers) : LaneKeys(numbers, numbers <= numbers) {}

  /// How many keys are smaller, for each lane: its place when all are in order.
  [[gnu::always_inline]] std::array<std::int32_t, simd_lanes> ranks() const {
    const auto all = std::bit_cast<std::array<std::int32_t, simd_lanes>>(keys_);
    SimdLanes<IntPart> ranks{};
    for (const std::int32_t key : all) ranks.with(keys_, [key](auto& rank, const auto& own) { rank -= own > key; });
    return std::bit_cast<std::array<std::int32_t, simd_lanes>>(ranks);
  }

  /// The smallest key; one that is within no limit when no lane waits.
  [[gnu::always_inline]] std::int32_t least() const {
#if defined(__AVX__)
    const Int4 low = __builtin_shufflevector(keys_.low, keys_.low, 0, 1, 2, 3);
    const Int4 high = __builtin_shufflevector(keys_.low, keys_.low, 4, 5, 6, 7);
#else
    const Int4 low = keys_.low, high = keys_.high;
#endif
    const Int4 four = smaller(low, high);
    const Int4 two = smaller(four, __builtin_shufflevector(four, four, 2, 3, 2, 3));
    return smaller(two, __builtin_shufflevector(two, two, 1, 1, 1, 1))[0];
  }
  /// The lane of a key waits no longer.
  [[gnu::always_inline]] void remove(std::int32_t key) {
    keys_.each([key](auto& part) { part = part == key ? IntPart{} + none : part; });
  }

  static std::uint32_t lane(std::int32_t key) {
    return static_cast<std::uint32_t>(key & lane_bits);
  }
  /// False where the number of a key is surely above a limit from zero on.
  static bool may_be_within(std::int32_t key, float limit) {
    return (key & ~lane_bits) <= std::bit_cast<std::int32_t>(limit);
  }

 private:
  static constexpr std::int32_t lane_bits = 7;
  static constexpr std::int32_t none = 0x7fffffff;  ///< above infinity
  static constexpr std::array<std::int32_t, simd_lanes> lane_numbers{0, 1, 2, 3, 4, 5, 6, 7};

  [[gnu::always_inline]] static Int4 smaller(const Int4& one, const Int4& other) {
    return one < other ? one : other;
  }

  SimdLanes<IntPart> keys_;
};

}  // namespace dcem::detail
