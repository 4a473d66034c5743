#pragma once
/// The half of a device from frame to frame: what it sees of the scenery is worked out again only where the device has
/// moved, or has left its place.
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "dcem/paths/halves/beam_lists.hpp"
#include "dcem/paths/halves/known_places.hpp"
#include "dcem/paths/halves/path_half.hpp"
#include "dcem/paths/halves/place.hpp"
#include "dcem/paths/halves/spread_work.hpp"

namespace dcem {

/// What is worked out beside a half itself.
struct HalfLists {
  const LaneScene* lanes = nullptr;  ///< none: no lists
  bool over_mirrors = false;         ///< what is reached over mirrors, too
  bool at_once = false;              ///< all of it, now; otherwise of the scenery, when it has become worth while
  std::size_t receivers = 0;         ///< that join the half every time
  ThreadPool* pool = nullptr;        ///< for views, lists and bodies: as in `Sight` and `BeamSource`
  int most_pieces = BeamFinder::many_pieces;  ///< the same
  bool for_triples = false;                   ///< for links over three interactions
  ListPace pace{};                            ///< of lists that are not made at once
};

/// How a device makes use of places.
struct PlaceUse {
  double longest_step_m = 0.0;         ///< for itself alone one that moves by more from frame to frame does not
  bool images_at_once = false;         ///< images are laid out at once, or when they are asked for
  bool over_mirrors = false;           ///< places know what is seen through their mirrors, too
  bool candidates = true;              ///< of links are found meanwhile: work is shared out with them
  const KnownPlaces* known = nullptr;  ///< the device takes over those that lie on its way; they must outlive it
  /// The longest step of one whose way others come: of one that leads them, and makes places for all, and of one that
  /// follows, as long as it can take places over.
  double longest_shared_step_m = 0.0;
  bool leads = false, follows = false;
  double early = 0.5;  ///< what of a step of work may be done ahead of time (`early_of`)
};

class KeptHalf {
 public:
  explicit KeptHalf(int map_pixels = PathHalf::default_pixels) : half_(map_pixels) {}

  /// From now on a device that moves takes what it may see from the places that it is in.
  void keep_places(const PlaceUse& use) { places_ = use; }
  /// As `PathHalf` has it.
  void lay_out_images(const Scene& scene, const FacetOutlines& outlines) { half_.lay_out_images(scene, outlines); }

  /// Brings the half to where the device is, and to where the bodies are. The settings are those of the time before.
  /// `moved`, by body: which of them have moved since then; empty: that is not known.
  void update(const Scene& scene, const FacetOutlines& outlines, const LinkEnd& end, const HalfSettings& settings,
              const HalfLists& wanted = {}, std::span<const char> moved = {});

  /// The same of a device that has moved, and of which nothing is kept but the places on its way. False: it is in none,
  /// and nothing has been looked at.
  bool update_in_place(const Scene& scene, const FacetOutlines& outlines, const LinkEnd& end,
                       const HalfSettings& settings, std::span<const char> moved = {});

  /// Notes a frame whose links are known already: what `update` would do for it is left to the next `update`, which
  /// then finds what it would have found.
  void pass(const LinkEnd& end, std::size_t receivers) {
    note(end, receivers);
    forget_bodies();
  }
  /// Bodies have been moved without a word of which.
  void forget_bodies() { has_bodies_ = false; }
  /// The device has left, or need not be remembered: frees all that is known.
  void forget();

  const PathHalf& half() const { return half_; }
  /// Whether it is known where the device was in the frame before.
  bool is_followed() const { return end_.has_value(); }
  /// Whether it has been brought to where device and bodies are, since somebody has said that they moved.
  bool is_of_frame() const { return has_scenery_ && has_bodies_; }
  /// What the device reaches; none where that is not known.
  const BeamLists* lists() const { return has_lists_ ? &lists_ : nullptr; }
  /// Whether the device takes what it sees from places, or will soon.
  bool is_in_places() const { return places_ && end_ && (step_m_ <= places_->longest_step_m || is_on_shared_way_); }
  /// By how much it has moved from the frame before.
  double step_m() const { return step_m_; }
  /// Where the device is on its way; none where it looks itself.
  const std::shared_ptr<const Place>& place() const { return place_; }
  /// Where it will be soon, and in how many frames; none where that is not known.
  std::shared_ptr<const Place> next_place() const { return next_ && next_->is_known() ? next_ : nullptr; }
  /// The place that it has come into; told once.
  std::shared_ptr<const Place> take_entered() { return std::exchange(has_entered_, false) ? place_ : nullptr; }
  /// What the frame at hand has spent on the next one, and on entering the place that the device is in now.
  int work_on_next() const { return work_on_next_; }
  /// What others may do for it.
  WorkAhead work_ahead() const { return {frames_to_next_, work_on_next_, places_->early}; }

 private:
  void note(const LinkEnd& end, std::size_t receivers) {
    const bool stands = end_ == end;
    if (!stands) forget_views();
    joins_ += receivers;
    end_ = end;
  }
  void forget_views() {
    has_scenery_ = has_bodies_ = has_lists_ = has_listed_bodies_ = has_edges_ = false;
    joins_ = frames_standing_ = 0;
    list_credit_us_ = 0.0;
  }

  /// Whether lists would have paid by now: they cost 13 ms, most of that for the ground, and 60 µs for each mirror, and
  /// save 0.3 ms and 0.28 µs for each mirror per join, by measurement in Munich. At worst both are paid.
  bool pay(double joins) const {
    const auto mirrors = static_cast<double>(half_.layers()[0].mirrors.size());
    return joins * (0.3 + 0.28e-3 * mirrors) >= 13.0 + 0.06 * mirrors;
  }
  bool have_paid() const { return pay(static_cast<double>(joins_)); }
  /// Joins since the device stands, those of the frame at hand among them, and those to come.
  double joins_of_run(const HalfLists& wanted) const {
    const auto frames = static_cast<double>(std::max<std::size_t>(1, wanted.pace.frames_left.value_or(1)));
    return static_cast<double>(joins_) + static_cast<double>(wanted.receivers) * (frames - 1.0);
  }

  /// Of a device that has stood for a while, looks through some mirrors more in each frame: as many as take the time
  /// that its links do, for fewer let all frames wait for what lists spare. It begins where they would have paid by
  /// then; where it is known how many frames there will be, at once, if two thirds of these would pay, or never. One
  /// that rides on a body may drive off at any moment, and waits in any case.
  void go_on_with_lists(const BeamSource& source, const HalfLists& wanted);

  /// Where lists are known, looks over some of the edges that are seen, for the facets before them: a part of an edge
  /// costs a third of a millisecond, once, and all of them spare a join 0.2 to 1.5, or 3 to 5 over three interactions,
  /// by measurement in Munich. So it begins when there were half as many joins as there are parts, or a sixteenth, or
  /// where there will be half as many again; of links over two interactions by the pace, unless it is known to pay.
  /// For very many joins in a frame, all of it at once.
  void go_on_over_edges(const BeamSource& source, const HalfLists& wanted);

  /// Of a device that has moved a little: whether it is in a place, from which it takes what it sees.
  bool follow(const Scene& scene, const FacetOutlines& outlines, const LinkEnd& end, const Vec3& step_m,
              const HalfSettings& settings);

  /// Works on the next place, as much in each frame, so that it is known, with time for what others prepare, when the
  /// device comes into it. The frame that `enters` one has spent some time on that. Who turns away from it gets the
  /// next one after a pause, which is twice as long each time: in a bend all would be in vain.
  void prepare_next(const Scene& scene, const FacetOutlines& outlines, const Vec3& now_m, const Vec3& step_m,
                    bool enters, const HalfSettings& settings);

  /// Goes over to another place, if it is in none and one is there.
  bool enter(const Scene& scene, const FacetOutlines& outlines, const Vec3& now_m, const Vec3& step_m,
             const HalfSettings& settings);
  /// Takes over the place that the device will come into, or begins one: not for itself alone if it is fast.
  void begin_next(const Vec3& now_m, const Vec3& step_m);

  /// After how many frames a device that moves on like this is in a place no more: `most` + 1 where it is longer.
  static int frames_until_out(const PlaceBox& box, const Vec3& now_m, const Vec3& step_m, int most);

  /// Counts the frames until the device comes into the next place, and drops that if it will not.
  void see_whether_next_is_met(const Vec3& now_m, const Vec3& step_m);

  /// In how many frames a device that is in no place is to come into one: the more, the less each of them takes on top
  /// of looking itself, but who turns is soon elsewhere.
  int frames_of_looking() const;
  /// After how many it is in a box; 0 where it takes more than `most`, or does not come into it.
  static int frames_until_in(const PlaceBox& box, const Vec3& now_m, const Vec3& step_m, int most);
  /// Whether it is then no farther aside than the box is wide.
  static bool leads_by(const PlaceBox& box, const Vec3& now_m, int frames, const Vec3& step_m);

  /// Notes whether a device that has moved so far to where it is will be in a place for some frames, or others will.
  bool note_whether_it_pays(const Vec3& now_m, const Vec3& moved_m);

  /// A place that begins so far behind a device and lies where it is going.
  static PlaceBox place_ahead(const Vec3& before_m, const Vec3& now_m, double behind_m);
  /// How far behind a device that will be at a point the next place begins: where others come the same way, there where
  /// the last one ends, so that they are in one of them at any moment.
  double behind_m(const Vec3& now_m, const Vec3& then_m) const;

  HalfSettings looked_at_twice_from(HalfSettings settings, bool closer) const {
    if (places_ && places_->over_mirrors) return settings;
    if (closer || !places_) settings.closer_from = closer ? 0 : very_many;
    return settings;
  }

  /// Looks from where the device is. `closer`: for lists, which take so long for each mirror that it pays to look
  /// twice. Others look twice where they see very much, from above large cities.
  void find_scenery(const Scene& scene, const FacetOutlines& outlines, const LinkEnd& end, const HalfSettings& settings,
                    bool closer, ThreadPool* pool);
  /// Of a device that is new, has jumped or moves too fast for places, or makes lists where it stands.
  void leave_places();

  static constexpr std::size_t very_many = 20'000;  ///< small facets: more than there are in view over one city

  PathHalf half_;
  BeamLists lists_;
  bool has_scenery_ = false, has_bodies_ = false, has_lists_ = false, has_edges_ = false, is_closer_ = false,
       has_listed_bodies_ = false;
  std::optional<PlaceUse> places_;   ///< none: it looks itself
  std::size_t joins_ = 0;            ///< since the device stands
  std::size_t frames_standing_ = 0;  ///< in which lists have been worked on
  double list_credit_us_ = 0.0;      ///< what frames were allowed for lists and have not spent
  std::optional<LinkEnd> end_;       ///< whose half it is; none yet: nobody's
  std::shared_ptr<const Place> place_, next_;
  std::shared_ptr<Place> made_;  ///< the next one, as long as it is being made
  bool has_entered_ = false;
  int frames_to_next_ = 0, work_on_next_ = 0;
  WorkAllowance allowance_;     ///< for the next place
  int misses_ = 0, pause_ = 0;  ///< places that were not come into, one after the other; frames to wait after the last
  double step_m_ = 0.0;         ///< from the frame before
  bool is_on_shared_way_ = false;  ///< where longer steps pay
  Vec3 moved_m_{0.0};              ///< in the frame before, on the way through places
  double turns_by_m_ = 0.0;        ///< how far the last step has led aside from where the one before it led
};

/// So many, each with maps of this many pixels a side.
std::vector<KeptHalf> kept_halves(std::size_t count, int map_pixels);

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/halves/kept_half_bodies.hpp"
#endif
