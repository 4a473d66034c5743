#pragma once
/// Bodies of known_places.hpp.
#include <algorithm>
#include <cmath>
#include <utility>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/halves/known_places.hpp"

namespace dcem {

DCEM_INLINE std::shared_ptr<const Place> KnownPlaces::find(const Vec3& at_m, const Vec3& step_m,
                                                           bool over_mirrors) const {
  const double step_length_m = glm::length(step_m);
  if (!(step_length_m > 0.0)) return nullptr;
  const double long_enough_m = 0.5 * PlaceBox::length_for_m(step_length_m);
  const Vec3 towards = step_m / step_length_m;
  const Farthest best = farthest(at_m, towards, over_mirrors);
  if (best.known == nullptr) return nullptr;
  if (best.way_m < long_enough_m) {
    const Vec3 out_m = at_m + (std::floor(best.way_m / step_length_m) + 1.0) * step_m;
    if (farthest(out_m, towards, over_mirrors).way_m < long_enough_m) return nullptr;
  }
  return best.known->place;
}

DCEM_INLINE KnownPlaces::Farthest KnownPlaces::farthest(const Vec3& at_m, const Vec3& towards,
                                                        bool over_mirrors) const {
  Farthest best;
  for (std::size_t at = first_from(at_m.x - reach_m_); at < places_.size(); ++at) {
    const Known& known = places_[at];
    if (known.place->box().middle_m.x > at_m.x + reach_m_) break;
    if ((known.place->beams() != nullptr) != over_mirrors) continue;
    const double way_m = known.place->box().way_out_m(at_m, towards);
    const bool is_older = best.known != nullptr && known.number < best.known->number;
    if (way_m > best.way_m || (way_m == best.way_m && is_older)) best = {&known, way_m};
  }
  return best;
}

DCEM_INLINE void KnownPlaces::note(const std::shared_ptr<const Place>& place) {
  const std::size_t known = find_it(*place);
  if (known != places_.size()) {
    places_[known].last_frame = frame_;
    last_shared_frame_ = frame_;
    return;
  }
  const PlaceBox& box = place->box();
  if (overlaps_one(box)) last_shared_frame_ = frame_;
  const auto before = places_.begin() + static_cast<std::ptrdiff_t>(first_from(box.middle_m.x));
  places_.insert(before, {place, noted_++, frame_});
  reach_m_ = std::max(reach_m_, std::hypot(box.half_m.x, box.half_m.y));
}

DCEM_INLINE bool KnownPlaces::overlaps_one(const PlaceBox& box) const {
  const Vec3 end_m = 0.9 * box.half_m.x * box.ahead;
  const double reach_m = reach_m_ + box.half_m.x;
  for (std::size_t at = first_from(box.middle_m.x - reach_m); at < places_.size(); ++at) {
    const PlaceBox& other = places_[at].place->box();
    if (other.middle_m.x > box.middle_m.x + reach_m) break;
    if (other.holds(box.middle_m) || other.holds(box.middle_m - end_m) || other.holds(box.middle_m + end_m))
      return true;
  }
  return false;
}

DCEM_INLINE bool KnownPlaces::next_frame(std::size_t most) {
  ++frame_;
  const auto is_old = [&](const Known& known) { return known.last_frame + lifetime_frames < frame_; };
  bool any = std::erase_if(places_, is_old) > 0;
  if (places_.size() <= most) return any;
  using Age = std::pair<std::uint64_t, std::uint64_t>;
  const auto age = [](const Known& known) { return Age(known.last_frame, known.number); };
  std::vector<Age> ages;
  for (const Known& known : places_) ages.push_back(age(known));
  const std::size_t surplus = places_.size() - most;
  std::ranges::nth_element(ages, ages.begin() + static_cast<std::ptrdiff_t>(surplus - 1));
  std::erase_if(places_, [&](const Known& known) { return age(known) <= ages[surplus - 1]; });
  return true;
}

DCEM_INLINE std::size_t KnownPlaces::find_it(const Place& place) const {
  const double middle_x_m = place.box().middle_m.x;
  for (std::size_t at = first_from(middle_x_m); at < places_.size(); ++at) {
    if (places_[at].place.get() == &place) return at;
    if (places_[at].place->box().middle_m.x > middle_x_m) break;
  }
  return places_.size();
}

DCEM_INLINE std::size_t KnownPlaces::first_from(double middle_x_m) const {
  const auto x_m = [](const Known& known) { return known.place->box().middle_m.x; };
  return static_cast<std::size_t>(std::ranges::lower_bound(places_, middle_x_m, {}, x_m) - places_.begin());
}

}  // namespace dcem
