#pragma once
/// Places that devices have come into lately: whoever comes the same way takes them over.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "dcem/paths/halves/place.hpp"

namespace dcem {

/// Asked by many threads while a frame is solved, and told what is new after it: so it does not matter which of them is
/// first.
class KnownPlaces {
 public:
  /// Of the places that hold a device at a point, that which does so farthest on its way; of equals the older one. None
  /// where there is none, where nobody knows where the device is going, and where it would come out before it has moved
  /// on by half of the length of a new place, unless another one holds it from there on for as long.
  std::shared_ptr<const Place> find(const Vec3& at_m, const Vec3& step_m, bool over_mirrors) const;

  /// A device has come into a place.
  void note(const std::shared_ptr<const Place>& place);
  /// Goes on to the next frame. Forgets places that nobody has come into for a minute or so, and of more than `most`
  /// those that nobody has come into for longest; true where there were any.
  bool next_frame(std::size_t most);

  /// Whether devices have come the same way lately: then it pays that places leave no gaps between them.
  bool are_shared() const { return last_shared_frame_ && *last_shared_frame_ + lifetime_frames >= frame_; }

  bool holds(const Place& place) const { return find_it(place) != places_.size(); }
  std::size_t size() const { return places_.size(); }

 private:
  static constexpr std::uint64_t lifetime_frames = 600;

  struct Known {
    std::shared_ptr<const Place> place;
    std::uint64_t number = 0, last_frame = 0;
  };

  struct Farthest {
    const Known* known = nullptr;
    double way_m = 0.0;
  };

  /// Whether a box is partly where a place is.
  bool overlaps_one(const PlaceBox& box) const;
  Farthest farthest(const Vec3& at_m, const Vec3& towards, bool over_mirrors) const;
  /// Where a place stands among all; their number where it is not one of them.
  std::size_t find_it(const Place& place) const;
  std::size_t first_from(double middle_x_m) const;

  std::vector<Known> places_;  ///< by their middle, from west to east
  double reach_m_ = 0.0;       ///< at most from there
  std::uint64_t frame_ = 0, noted_ = 0;
  std::optional<std::uint64_t> last_shared_frame_;
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/halves/known_places_bodies.hpp"
#endif
