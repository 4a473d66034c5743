#pragma once
/// Where devices have driven lately, and whom somebody drives after.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "dcem/core/random.hpp"
#include "dcem/geometry/vector.hpp"

namespace dcem {

/// A device is followed as long as another one comes by where it has been, within a metre or two and going the same
/// way. Told after each frame, device by device, and asked in the next one.
class DrivenWays {
 public:
  /// A device is at a point; none: it is not there any more.
  void note(std::size_t device, const std::optional<Vec3>& at_m);
  void next_frame();

  bool is_followed(std::size_t device) const {
    return device < followed_until_.size() && frame_ <= followed_until_[device];
  }
  /// Pieces of ways that are remembered.
  std::size_t size() const { return cells_.size(); }

 private:
  /// Ways are remembered for a minute or so, and who follows for some seconds.
  static constexpr std::uint64_t lifetime_frames = 600, following_frames = 30;
  static constexpr double cell_m = 1.0, level_m = 4.0;
  static constexpr int sectors = 8;              ///< of headings
  static constexpr double longest_step_m = 5.0;  ///< longer ones are jumps

  struct Cell {
    std::int32_t x, y, level, sector;

    friend bool operator==(const Cell&, const Cell&) = default;
  };
  struct Hash {
    std::size_t operator()(const Cell& cell) const noexcept {
      const auto bits = [](std::int32_t one, std::int32_t other) {
        return std::uint64_t{static_cast<std::uint32_t>(one)} << 32U | static_cast<std::uint32_t>(other);
      };
      return static_cast<std::size_t>(hash_values(bits(cell.x, cell.y), bits(cell.level, cell.sector)));
    }
  };
  struct Passed {
    std::size_t device;
    std::uint64_t frame;
  };

  static Cell cell_of(const Vec3& at_m, const Vec3& step_m);
  void note_followed_at(const Cell& cell, std::size_t device);

  std::unordered_map<Cell, Passed, Hash> cells_;  ///< who came by last
  std::vector<std::optional<Vec3>> last_m_;       ///< by device
  std::vector<std::uint64_t> followed_until_;     ///< frames, by device
  std::uint64_t frame_ = 1;
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/halves/driven_ways_bodies.hpp"
#endif
