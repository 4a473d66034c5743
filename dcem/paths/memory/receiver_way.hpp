#pragma once
/// The way that a receiver comes, and until when on it what was asked at one of its points need not be asked again.
#include <algorithm>
#include <optional>

#include "dcem/geometry/vector.hpp"
#include "dcem/paths/memory/course.hpp"
#include "dcem/paths/memory/way_reach.hpp"

namespace dcem {

/// Of something that held: until when it surely does.
struct Refusal {
  double until_m = 0.0;       ///< of the way that the receiver has come
  float ahead_m = 0.5F;       ///< for how far ahead that is asked the next time
  bool is_on_course = false;  ///< it holds no longer than the receiver stays on its course, either

  /// The receiver has left the course.
  void forget_course() {
    if (is_on_course) until_m = 0.0;
  }
};

class ReceiverWay {
 public:
  /// The receiver is at a point now. False where it has left the course along which it was asked: all refusals must be
  /// told.
  bool go_on(const Vec3& at_m);

  bool is_refused(const Refusal& refusal) const { return come_m_ < refusal.until_m; }

  /// What is known of something for as far ahead as would be asked first: nothing, or that it does not hold; what may
  /// move holds for now alone.
  enum class Ahead { unknown, fails, not_asked };

  /// Whether something holds for as far ahead as is asked for next; notes it.
  template <typename Holds>
  bool holds_ahead(Refusal& refusal, Holds&& holds) const {
    const float moved_m = std::min(refusal.ahead_m, longest_ahead_m);
    if (moved_m < shortest_ahead_m() || !holds(drift(moved_m))) return false;
    refuse(refusal, moved_m);
    refusal.ahead_m = 2.0F * moved_m;
    return true;
  }

  /// Whether something holds now; if it does for some while, too, notes until when: `holds(drift)` is asked for all
  /// places that the receiver may have moved to.
  template <typename Holds>
  bool holds_for_a_while(Refusal& refusal, Holds&& holds, Ahead ahead = Ahead::unknown) const {
    if (!holds(Drift())) return false;
    // Twice as far as the last time that it held, a quarter as far as the last time that it did not.
    const float shortest_m = shortest_ahead_m();
    for (int attempt = 0; attempt < 2 && ahead != Ahead::not_asked; ++attempt) {
      const float moved_m = std::min(refusal.ahead_m, longest_ahead_m);
      if (moved_m < shortest_m) break;
      const bool held = (attempt > 0 || ahead != Ahead::fails) && holds(drift(moved_m));
      if (held) refuse(refusal, moved_m);
      refusal.ahead_m = held ? 2.0F * moved_m : 0.25F * moved_m;
      if (held) break;
    }
    if (refusal.ahead_m < shortest_m) refusal.ahead_m *= 1.25F;  // it may be asked again some day
    return true;
  }

 private:
  static constexpr float longest_ahead_m = 4.0F;
  /// It pays to ask for no less than the frame after the next one.
  float shortest_ahead_m() const { return static_cast<float>(1.5 * step_m_); }

  /// Where the receiver gets to on `moved_m` more of its way: along its course, where it has one.
  Drift drift(double moved_m) const {
    const Vec3* const ahead = course_.ahead();
    return ahead != nullptr ? Drift(moved_m, *ahead, Course::aside_m) : Drift(moved_m);
  }
  void refuse(Refusal& refusal, double moved_m) const {
    refusal.until_m = come_m_ + moved_m;
    refusal.is_on_course = course_.ahead() != nullptr;
  }

  double come_m_ = 0.0, step_m_ = 0.0;  ///< that the receiver has come, in all and since the frame before
  std::optional<Vec3> before_m_;
  Course course_;
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/memory/receiver_way_bodies.hpp"
#endif
