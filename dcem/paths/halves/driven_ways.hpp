#pragma once
/// Where devices have driven lately, and who drives after whom.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "dcem/core/random.hpp"
#include "dcem/geometry/vector.hpp"

namespace dcem {

/// A device follows another one while it comes, frame after frame, to where that one has been some frames before, so
/// close by and so much in the same direction that one place would hold both. Told after each frame, device by device,
/// and asked in the next one.
class DrivenWays {
 public:
  /// A device is at a point; none: it is not there, or of no interest.
  void note(std::size_t device, const std::optional<Vec3>& at_m);
  void next_frame();

  /// Somebody drives after it …
  bool has_followers(std::size_t device) const { return lasts(devices_, device, &Driver::followed); }
  /// … or it after somebody.
  bool follows(std::size_t device) const { return lasts(devices_, device, &Driver::follows); }
  /// Pieces of ways that are remembered.
  std::size_t size() const { return cells_.size(); }

 private:
  /// A way is remembered no longer than the places on it are known: six for each receiver, each for four frames at
  /// 1.4 m (`known_places_per_receiver`); for who comes later they would be made in vain. It takes some frames until
  /// somebody counts as a follower, who then does so a little longer than he is seen.
  static constexpr std::uint64_t lifetime_frames = 24, least_frames = 3, lasting_frames = 10;
  static constexpr double longest_step_m = 2.0;  ///< of those who take over places
  static constexpr double cell_m = 1.0;
  static constexpr double beside_m = 0.4, above_m = 0.1, least_cosine = 0.94;  ///< one place holds both: 20 degrees

  struct Cell {
    std::int32_t x, y;

    friend bool operator==(const Cell&, const Cell&) = default;
  };
  struct Hash {
    std::size_t operator()(const Cell& cell) const noexcept {
      const std::uint64_t x = static_cast<std::uint32_t>(cell.x), y = static_cast<std::uint32_t>(cell.y);
      return static_cast<std::size_t>(hash_values(x << 32U | y));
    }
  };
  /// Who came by last.
  struct Passed {
    std::size_t device;
    std::uint64_t frame;
    Vec3 at_m, towards;
  };
  /// Frames one after the other in which something was so, and until when it counts.
  struct Streak {
    std::uint64_t count = 0, last_frame = 0, until = 0;

    void note(std::uint64_t frame);
  };
  struct Driver {
    std::optional<Vec3> last_m{};
    Streak followed{}, follows{};
  };

  bool lasts(const std::vector<Driver>& devices, std::size_t device, Streak Driver::*streak) const {
    return device < devices.size() && frame_ <= (devices[device].*streak).until;
  }
  static Cell cell_of(const Vec3& at_m);
  /// Looks who has been at a place, in cells beside it as well.
  void look_who_passed(const Vec3& at_m, const Vec3& towards, std::size_t device);
  bool is_same_way(const Passed& passed, const Vec3& at_m, const Vec3& towards) const;

  std::unordered_map<Cell, Passed, Hash> cells_;
  std::vector<Driver> devices_;
  std::uint64_t frame_ = 1;
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/halves/driven_ways_bodies.hpp"
#endif
