#pragma once
/// Eight lanes that wait, the one with the smallest number first: chosen without branches, which no processor would
/// foresee.
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

#include "dcem/core/simd.hpp"

namespace dcem {

inline namespace DCEM_ISA {

/// A lane's key is a number from zero on, as an integer of the same bits, the last three of which tell the lane.
/// Integers have the order of such numbers; here to eight units of the last place. The key of a lane that does not wait
/// is the largest integer.
class LaneKeys {
 public:
  LaneKeys() = default;  // no initial value: a stack of them would be cleared
  /// All lanes wait but those that are `left_out`.
  [[gnu::always_inline]] LaneKeys(const Float8& numbers, const Mask8& left_out) : LaneKeys(numbers) {
    keys_.with(std::bit_cast<detail::SimdLanes<detail::UintPart>>(left_out),
               [](auto& part, const auto& out) { part |= out; });
  }
  /// All lanes wait.
  [[gnu::always_inline]] explicit LaneKeys(const Float8& numbers)
      : keys_(std::bit_cast<detail::SimdLanes<detail::UintPart>>(numbers)) {
    keys_.with(std::bit_cast<detail::SimdLanes<detail::UintPart>>(lane_numbers),
               [](auto& part, const auto& lane) { part = (part & ~lane_bits) | lane; });
  }

  /// Eight keys that lie one after another in memory.
  [[gnu::always_inline]] static LaneKeys load(const std::uint32_t* keys) {
    LaneKeys result;
    std::memcpy(&result.keys_, keys, sizeof result.keys_);
    return result;
  }

  /// How many keys are smaller, for each lane: its place when all are in order.
  [[gnu::always_inline]] std::array<std::int32_t, simd_lanes> ranks() const {
    const auto all = std::bit_cast<std::array<std::uint32_t, simd_lanes>>(keys_);
    detail::SimdLanes<detail::IntPart> ranks{};
    for (const std::uint32_t key : all) {
      ranks.with(keys_, [key](auto& rank, const auto& own) { rank -= own > key; });
    }
    return std::bit_cast<std::array<std::int32_t, simd_lanes>>(ranks);
  }

  /// The smallest key; one that is within no limit when no lane waits.
  [[gnu::always_inline]] std::uint32_t least() const {
#if defined(__AVX__)
    const Uint4 low = __builtin_shufflevector(keys_.low, keys_.low, 0, 1, 2, 3);
    const Uint4 high = __builtin_shufflevector(keys_.low, keys_.low, 4, 5, 6, 7);
#else
    const Uint4 low = keys_.low, high = keys_.high;
#endif
    const Uint4 four = smaller(low, high);
    const Uint4 two = smaller(four, __builtin_shufflevector(four, four, 2, 3, 2, 3));
    return smaller(two, __builtin_shufflevector(two, two, 1, 1, 1, 1))[0];
  }
  /// Bit i: the number of lane i may be within a limit from zero on.
  [[gnu::always_inline]] std::uint32_t within(float limit) const {
    Mask8 mask;
    mask.lanes.with(keys_, [bits = std::bit_cast<std::uint32_t>(limit)](auto& part, const auto& key) {
      part = (key & ~lane_bits) <= bits;
    });
    return mask.bits();
  }
  /// The lane of a key waits no longer.
  [[gnu::always_inline]] void remove(std::uint32_t key) {
    keys_.each([key](auto& part) { part |= static_cast<detail::UintPart>(part == key); });
  }

  static std::uint32_t lane(std::uint32_t key) {
    return key & lane_bits;
  }
  /// The number of a key, rounded down by up to eight units of the last place.
  static float number(std::uint32_t key) {
    return std::bit_cast<float>(key & ~lane_bits);
  }
  /// Of a lane that does not wait.
  static constexpr std::uint32_t none = 0xffffffffU;
  /// False where the number of a key is surely above a limit from zero on.
  static bool may_be_within(std::uint32_t key, float limit) {
    return (key & ~lane_bits) <= std::bit_cast<std::uint32_t>(limit);
  }

 private:
  using Uint4 = std::uint32_t __attribute__((vector_size(16)));

  static constexpr std::uint32_t lane_bits = 7;
  static constexpr std::array<std::uint32_t, simd_lanes> lane_numbers{0, 1, 2, 3, 4, 5, 6, 7};

  [[gnu::always_inline]] static Uint4 smaller(const Uint4& one, const Uint4& other) {
    return one < other ? one : other;
  }

  detail::SimdLanes<detail::UintPart> keys_;
};

}  // namespace DCEM_ISA

}  // namespace dcem
