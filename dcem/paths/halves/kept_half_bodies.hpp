#pragma once
/// Bodies of kept_half.hpp.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/halves/kept_half.hpp"

namespace dcem {

namespace detail {

/// A place that leaves a gap to the last one begins so far behind where the device comes into it.
inline constexpr double least_behind_m = 0.25;
/// Frames over which the work on the next place is spread: of a device in a place, of one that looks itself, and of one
/// that no candidates are found for, to which a place brings less.
inline constexpr int most_frames = 8, frames_of_looking = 12, most_frames_of_looking = 24;
/// What a link takes from scratch in Munich, and so what an end that stands spends on its lists in a frame, for each of
/// them, where that is known to pay; and on those over edges where links are over three interactions, which take 80 ms.
inline constexpr double link_us = 2000.0, list_work_of_triples_us = 10'000.0;
/// Lists are made for links to come where so much of these would pay for them, by measurement in Munich and the town.
inline constexpr double surely_paid = 2.0 / 3.0;
/// For how many parts of edges lists over these have paid after a join: of a map over three interactions it spares 2.6
/// ms, of links 4 to 5.
inline constexpr double parts_a_join = 2.0, parts_a_join_of_triples = 16.0;

}  // namespace detail

DCEM_INLINE void KeptHalf::update(const Scene& scene, const FacetOutlines& outlines, const LinkEnd& end,
                                  const HalfSettings& asked, const HalfLists& wanted, std::span<const char> moved) {
  HalfSettings settings = asked;
  settings.pairs = settings.pairs || wanted.lanes != nullptr;  // lists are of what images may see
  const bool is_followed = end_.has_value();
  const bool stands = end_ == end;
  const Vec3 step_m = is_followed ? end.position_m - end_->position_m : Vec3(0.0);
  note(end, wanted.receivers);
  const bool is_known =
      has_scenery_ && has_bodies_ && !moved.empty() && std::ranges::none_of(moved, [](char has) { return has != 0; });
  const bool closer = wanted.lanes != nullptr && wanted.at_once;
  if (!has_lists_ && frames_standing_ == 0 && !wanted.at_once) lists_ = {};  // those of where it stood
  const bool lists_follow = has_bodies_ && has_listed_bodies_ && !moved.empty();
  if (!stands) step_m_ = glm::length(step_m);
  const bool goes_on = !stands && is_followed && !closer && note_whether_it_pays(end.position_m, step_m);
  if (!stands && !goes_on) leave_places();
  if (!has_scenery_ && !(goes_on && follow(scene, outlines, end, step_m, settings))) {
    find_scenery(scene, outlines, end, settings, closer, goes_on ? nullptr : wanted.pool);
  }
  const bool makes_lists = wanted.lanes != nullptr && !has_lists_ && (wanted.at_once || (!places_ && have_paid()));
  if (makes_lists) leave_places();
  if (makes_lists && !is_closer_) find_scenery(scene, outlines, end, settings, true, wanted.pool);
  if (!is_known) half_.find_bodies(scene, outlines, settings, moved, wanted.pool);
  has_bodies_ = true;
  has_listed_bodies_ = has_listed_bodies_ && is_known;
  if (wanted.lanes == nullptr) return;
  const BeamSource source{scene,       outlines,          *wanted.lanes, half_, settings, wanted.over_mirrors,
                          wanted.pool, wanted.most_pieces};
  if (makes_lists) {
    half_.settle();
    lists_.find_scenery(source);
  }
  has_lists_ = has_lists_ || makes_lists;
  has_edges_ = has_edges_ && !makes_lists;
  if (places_ && !has_lists_) go_on_with_lists(source, wanted);
  if (has_lists_ && !has_edges_ && wanted.over_mirrors) go_on_over_edges(source, wanted);
  if (!wanted.at_once || outlines.bodies().empty() || (!makes_lists && is_known && has_listed_bodies_)) return;
  half_.settle();
  lists_.find_bodies(source, moved, lists_follow && !makes_lists);
  has_listed_bodies_ = true;
}

DCEM_INLINE bool KeptHalf::update_in_place(const Scene& scene, const FacetOutlines& outlines, const LinkEnd& end,
                                           const HalfSettings& settings, std::span<const char> moved) {
  const bool is_followed = end_.has_value();
  const Vec3 step_m = is_followed ? end.position_m - end_->position_m : Vec3(0.0);
  note(end, 0);
  forget_views();  // those from where it stood, too, if it has gone away and come back since it was asked about
  lists_ = {};
  step_m_ = glm::length(step_m);
  if (!is_followed || !note_whether_it_pays(end.position_m, step_m)) {
    leave_places();
  } else if (follow(scene, outlines, end, step_m, settings)) {
    half_.find_bodies(scene, outlines, settings, moved);
    has_bodies_ = true;
    return true;
  }
  half_ = PathHalf(half_.map_pixels());
  return false;
}

DCEM_INLINE bool KeptHalf::note_whether_it_pays(const Vec3& now_m, const Vec3& moved_m) {
  is_on_shared_way_ = false;
  if (!places_) return false;
  const double length_m = glm::length(moved_m);
  if (length_m <= places_->longest_step_m) return true;
  const auto takes_over = [&] {
    return place_ || next_ ||
           (places_->known != nullptr && places_->known->find(now_m, moved_m, places_->over_mirrors));
  };
  is_on_shared_way_ =
      length_m <= places_->longest_shared_step_m && (places_->leads || (places_->follows && takes_over()));
  return is_on_shared_way_;
}

DCEM_INLINE void KeptHalf::forget() {
  if (!end_) return;
  KeptHalf nothing(half_.map_pixels());
  nothing.places_ = places_;
  *this = std::move(nothing);
}

DCEM_INLINE void KeptHalf::go_on_with_lists(const BeamSource& source, const HalfLists& wanted) {
  const bool waits = !wanted.pace.frames_left || end_->ignored_body;
  if ((waits && !have_paid()) || (wanted.pace.frames_left && !pay(detail::surely_paid * joins_of_run(wanted)))) return;
  ++frames_standing_;
  if (frames_standing_ == 2) {
    half_.settle();
    lists_.begin_scenery(source);
  }
  if (frames_standing_ <= 2) return;
  list_credit_us_ += detail::link_us * static_cast<double>(wanted.receivers);
  has_lists_ = lists_.go_on(source, list_credit_us_);
}

DCEM_INLINE void KeptHalf::go_on_over_edges(const BeamSource& source, const HalfLists& wanted) {
  const auto parts = static_cast<double>(lists_.tables()[BeamLists::of_scenery].parts().size());
  const auto receivers = static_cast<double>(wanted.receivers);
  const double parts_a_join = wanted.for_triples ? detail::parts_a_join_of_triples : detail::parts_a_join;
  const bool is_known = wanted.pace.frames_left.has_value();
  if (parts_a_join * (is_known ? detail::surely_paid * joins_of_run(wanted) : static_cast<double>(joins_)) < parts)
    return;
  const double of_pair_us = is_known ? detail::link_us : wanted.pace.careful_us(detail::link_us);
  const double of_link_us = wanted.for_triples ? detail::list_work_of_triples_us : of_pair_us;
  const bool at_once = parts_a_join * receivers >= parts;
  list_credit_us_ = at_once ? std::numeric_limits<double>::infinity() : list_credit_us_ + of_link_us * receivers;
  has_edges_ = lists_.go_on_over_edges(source, list_credit_us_);
}

DCEM_INLINE bool KeptHalf::follow(const Scene& scene, const FacetOutlines& outlines, const LinkEnd& end,
                                  const Vec3& step_m, const HalfSettings& settings) {
  const Vec3 before_m = std::exchange(moved_m_, step_m);
  turns_by_m_ = step_m_ > 0.0 ? glm::length(glm::cross(before_m, step_m)) / step_m_ : 0.0;
  HalfSettings of_place = settings;
  if (!places_->over_mirrors) of_place.closer_from = very_many;  // it takes as long as it saves, or longer
  const bool enters = enter(scene, outlines, end.position_m, step_m, of_place);
  has_entered_ = has_entered_ || enters;
  prepare_next(scene, outlines, end.position_m, step_m, enters, of_place);
  if (!place_) return false;
  is_closer_ = false;
  has_scenery_ = true;
  half_.take_scenery(scene, outlines, end, of_place, *place_);
  if (places_->images_at_once) half_.lay_out_images(scene, outlines);
  return true;
}

DCEM_INLINE bool KeptHalf::enter(const Scene& scene, const FacetOutlines& outlines, const Vec3& now_m,
                                 const Vec3& step_m, const HalfSettings& settings) {
  const auto is_in = [&](const auto& place) { return place && place->box().holds(now_m); };
  if (is_in(place_)) return false;
  place_.reset();
  // A device that hardly moves is in the place long before it is known: it comes into it when that is wanted.
  if (is_in(next_) && frames_to_next_ <= 1) {
    while (!next_->is_known()) made_->go_on(scene, outlines, settings);
    place_ = std::move(next_);
  } else if (places_->known != nullptr) {
    place_ = places_->known->find(now_m, step_m, places_->over_mirrors);
  }
  if (!place_) return false;
  next_.reset();
  made_.reset();
  return true;
}

DCEM_INLINE void KeptHalf::prepare_next(const Scene& scene, const FacetOutlines& outlines, const Vec3& now_m,
                                        const Vec3& step_m, bool enters, const HalfSettings& settings) {
  // What pools of candidates take, and to go over to those of the place that is entered.
  const int work_of_others = places_->candidates ? candidates_work + (places_->over_mirrors ? triples_work : 0) : 0;
  const int work_of_entering = places_->over_mirrors ? 350 : 7;
  if (enters) pause_ = misses_ = 0;
  see_whether_next_is_met(now_m, step_m);
  work_on_next_ = enters ? work_of_entering : 0;
  if (pause_ > 0 && pause_-- > 0) return;
  if (!place_ && !next_) frames_to_next_ = frames_of_looking();  // through its mirrors, too, if places do
  if (place_ && frames_to_next_ > detail::most_frames) return;
  if (!next_) begin_next(now_m, step_m);
  if (!next_) return;
  allowance_.next_frame(next_->work_left() + work_of_others, frames_to_next_);
  while (!next_->is_known() && allowance_.covers(next_->next_work(), places_->early)) {
    allowance_.spend(next_->next_work());
    work_on_next_ += next_->next_work();
    made_->go_on(scene, outlines, settings);
  }
}

DCEM_INLINE void KeptHalf::see_whether_next_is_met(const Vec3& now_m, const Vec3& step_m) {
  constexpr int longest_pause = 16;
  const auto drop = [&] {
    next_.reset();
    made_.reset();
  };
  if (place_) {
    frames_to_next_ = frames_until_out(place_->box(), now_m, step_m, detail::most_frames);
  } else if (next_ && !next_->box().holds(now_m)) {
    const int until_in = frames_until_in(next_->box(), now_m, step_m, 2 * detail::most_frames_of_looking);
    frames_to_next_ = until_in > 0 ? std::max(until_in, frames_to_next_ - 1) : 0;  // it may wait in it
  } else if (--frames_to_next_ > 0 && next_ &&
             frames_until_out(next_->box(), now_m, step_m, frames_to_next_) <= frames_to_next_) {
    drop();  // faster than when it was begun, the device is out again before it is known
  }
  if (!next_ || (frames_to_next_ > 0 && leads_by(next_->box(), now_m, frames_to_next_, step_m))) return;
  drop();
  pause_ = std::min(1 << misses_++, longest_pause);
}

DCEM_INLINE void KeptHalf::begin_next(const Vec3& now_m, const Vec3& step_m) {
  const Vec3 then_m = now_m + static_cast<double>(frames_to_next_) * step_m;
  if (places_->known != nullptr) next_ = places_->known->find(then_m, step_m, places_->over_mirrors);
  const bool pays_alone = step_m_ <= places_->longest_step_m || places_->leads;
  if (next_ || !pays_alone) return;
  made_ = std::make_shared<Place>(place_ahead(then_m - step_m, then_m, behind_m(now_m, then_m)), places_->over_mirrors);
  next_ = made_;
  allowance_ = {};
  allowance_.spend(work_on_next_);  // on entering the one before
}

DCEM_INLINE double KeptHalf::behind_m(const Vec3& now_m, const Vec3& then_m) const {
  const double way_m = glm::distance(now_m, then_m);
  const bool leaves_gaps = places_->known == nullptr || !places_->known->are_shared();
  if (!place_ || leaves_gaps || !(way_m > 0.0)) return detail::least_behind_m;
  const double out_m = place_->box().way_out_m(now_m, (then_m - now_m) / way_m);
  return std::max(detail::least_behind_m, way_m - out_m + 0.1);
}

DCEM_INLINE int KeptHalf::frames_until_out(const PlaceBox& box, const Vec3& now_m, const Vec3& step_m, int most) {
  int frames = 1;
  while (frames <= most && box.holds(now_m + static_cast<double>(frames) * step_m)) ++frames;
  return frames;
}

DCEM_INLINE int KeptHalf::frames_of_looking() const {
  constexpr double aside_m = 0.25;  // half of what a place leaves to each side
  const auto leads_into_it = [&](int frames) { return 0.5 * frames * (frames + 1) * turns_by_m_ <= aside_m; };
  if (!places_->candidates && leads_into_it(detail::most_frames_of_looking)) return detail::most_frames_of_looking;
  if (leads_into_it(detail::frames_of_looking)) return detail::frames_of_looking;
  return places_->over_mirrors ? 8 : 4;
}

DCEM_INLINE int KeptHalf::frames_until_in(const PlaceBox& box, const Vec3& now_m, const Vec3& step_m, int most) {
  int frames = 1;
  while (frames <= most && !box.holds(now_m + static_cast<double>(frames) * step_m)) ++frames;
  return frames <= most ? frames : 0;
}

DCEM_INLINE bool KeptHalf::leads_by(const PlaceBox& box, const Vec3& now_m, int frames, const Vec3& step_m) {
  const Vec3 away_m = now_m + static_cast<double>(frames) * step_m - box.middle_m;
  return std::abs(glm::dot(away_m, box.aside())) <= box.half_m.y && std::abs(away_m.z) <= box.half_m.z;
}

DCEM_INLINE PlaceBox KeptHalf::place_ahead(const Vec3& before_m, const Vec3& now_m, double behind_m) {
  constexpr double half_width_m = 0.5, half_height_m = 0.1;
  const Vec3 moved_m = now_m - before_m;
  const double level_m = std::hypot(moved_m.x, moved_m.y);
  const Vec3 ahead = level_m > 0.0 ? Vec3(moved_m.x / level_m, moved_m.y / level_m, 0.0) : Vec3(1.0, 0.0, 0.0);
  const double climb = moved_m.z / std::max(level_m, 1e-3 + std::abs(moved_m.z));
  const double ahead_m = PlaceBox::length_for_m(glm::length(moved_m)) - detail::least_behind_m;
  const double half_length_m = 0.5 * (behind_m + ahead_m), to_middle_m = half_length_m - behind_m;
  return {now_m + to_middle_m * ahead + Vec3(0.0, 0.0, to_middle_m * climb),
          ahead,
          {half_length_m, half_width_m, half_height_m + half_length_m * std::abs(climb)}};
}

DCEM_INLINE void KeptHalf::find_scenery(const Scene& scene, const FacetOutlines& outlines, const LinkEnd& end,
                                        const HalfSettings& settings, bool closer, ThreadPool* pool) {
  place_.reset();
  half_.find_scenery(scene, outlines, end, looked_at_twice_from(settings, closer), pool);
  is_closer_ = closer;
  has_scenery_ = true;
}

DCEM_INLINE void KeptHalf::leave_places() {
  place_.reset();
  next_.reset();
  made_.reset();
  moved_m_ = Vec3(0.0);
  has_entered_ = is_on_shared_way_ = false;
}

DCEM_INLINE std::vector<KeptHalf> kept_halves(std::size_t count, int map_pixels) {
  return std::vector<KeptHalf>(count, KeptHalf(map_pixels));
}

}  // namespace dcem
