#pragma once
/// How far the ends of a link and all bodies may move before any path of the link appears or vanishes: a lower bound
/// that holds for every motion.
///
/// Each way is asked for the largest distance for which a proof is found that it stays open, or shut; the smallest of
/// these holds for all. A proof for a distance holds for every smaller one.
#include <algorithm>
#include <span>
#include <unordered_set>
#include <vector>

#include "dcem/paths/lifetime/vague_joiner.hpp"
#include "dcem/paths/lifetime/way_legs.hpp"

namespace dcem {

/// What is the same for all links.
struct LifetimeSettings {
  double limit_m = 1.0;  ///< larger distances are not looked for
  JoinOrders orders{};
  EdgeRules edges{};
  int max_transmissions = 0;
  bool direct = true;  ///< the direct way counts
};

/// Of a scene as it stands in a frame.
struct LifetimeScene {
  const FacetOutlines& outlines;
  const FacetRims& rims;
  const std::vector<BodyShape>& shapes;
};

template <typename Index>
class LinkLifetime {
 public:
  LinkLifetime(const SceneTracer<Index>& tracer, const LifetimeScene& known, const LifetimeSettings& settings,
               const LinkEnd& transmitter, const LinkEnd& receiver)
      : tracer_(tracer), known_(known), settings_(settings), transmitter_(transmitter), receiver_(receiver) {}

  /// For how long all of some sequences, which carry paths now, surely do: they are all that do.
  double open_until_m(std::span<const Sequence> open) {
    open_.clear();
    // Two ends in one point have no path between them.
    const double apart_m = glm::distance(transmitter_.position_m, receiver_.position_m) - lifetime_guard_m;
    double until_m = std::clamp(0.5 * apart_m, 0.0, settings_.limit_m);
    for (const LinkEnd* const end : {&transmitter_, &receiver_}) until_m = clearance_m(*end, until_m);
    for (const Sequence& sequence : open) {
      open_.insert(sequence);
      until_m = largest(until_m, sequence, [&](const Ways& ways) { return ways.stays_open(sequence); });
    }
    return until_m;
  }

  /// For how long, and no longer than `until_m`, no other sequence surely carries a path. The places must be for as
  /// much. `open_until_m` must have been asked.
  double shut_until_m(const VaguePlace& transmitter, const VaguePlace& receiver, double until_m) {
    VagueJoiner joiner(tracer_.scene(), known_.outlines, settings_.orders, ignored());
    asked_ = 0;
    joiner.for_each(receiver, transmitter, [&](const Sequence& sequence) {
      if (!(until_m > 0.0) || (sequence.empty() && !settings_.direct) || open_.contains(sequence)) return;
      ++asked_;
      until_m = largest(until_m, sequence,
                        [&](const Ways& ways) { return ways.stays_shut(sequence, transmitter, receiver); });
    });
    return until_m;
  }
  /// How many were asked in the last call.
  std::size_t asked() const { return asked_; }

 private:
  /// All that is asked for one distance.
  struct Ways {
    Ways(const LinkLifetime& link, double moved_m, BodyId frame)
        : vague(link.tracer_.scene(), link.known_.shapes, moved_m, frame),
          outlines(link.known_.outlines),
          aim(vague, link.transmitter_.position_m, link.receiver_.position_m),
          gates(vague, link.known_.outlines, link.known_.rims, link.settings_.edges),
          legs(vague, link.tracer_, gates, link.ignored(), link.settings_.max_transmissions) {}

    bool stays_open(const Sequence& sequence) const {
      VagueWay way;
      return aim.aim(sequence, way) && gates.stay_open(sequence, way) && legs.stay_free(way);
    }
    bool stays_shut(const Sequence& sequence, const VaguePlace& from, const VaguePlace& to) const {
      VagueWay way;
      return gates.never_meet(sequence) || !aim.aim(sequence, way) || gates.are_shut(way) ||
             is_hidden(sequence.empty() ? nullptr : &sequence.back(), way.first, from) ||
             is_hidden(sequence.empty() ? nullptr : &sequence.front(), way.last, to) || legs.stay_blocked(way);
    }
    /// Of what moves it is not known how far it is lifted in front of what hides it.
    bool is_hidden(const SequenceElement* element, const VaguePoint& point, const VaguePlace& place) const {
      if (element == nullptr) return false;
      const Scene& scene = vague.scene();
      const BodyId body = element->is_edge() ? scene.wedge(element->edge()).body : scene.facet(element->mirror()).body;
      return body.value == 0 && place.hides(scene, outlines, *element, point);
    }

    VagueScene vague;
    const FacetOutlines& outlines;
    WayAim aim;
    WayGates gates;
    WayLegs<Index> legs;
  };

  IgnoredBodies ignored() const { return {transmitter_.ignored_body, receiver_.ignored_body}; }
  double clearance_m(const LinkEnd& end, double most_m) const {
    if (!end.mounted_on.empty()) return 0.0;
    const Ways ways(*this, 0.0, BodyId(0));
    return ways.legs.clearance_m(end.position_m, most_m);
  }

  /// What is over one body alone is seen from it: its elements then do not move against each other.
  BodyId frame_for(const Sequence& sequence) const {
    const Scene& scene = tracer_.scene();
    const auto body_of = [&](SequenceElement element) {
      return element.is_edge() ? scene.wedge(element.edge()).body : scene.facet(element.mirror()).body;
    };
    return sequence.empty() || body_of(sequence.front()) != body_of(sequence.back()) ? BodyId(0)
                                                                                     : body_of(sequence.front());
  }

  /// The largest distance up to `most_m` for which a proof is found, to a sixteenth of itself; 0 below a tenth of a
  /// millimetre.
  template <typename Holds>
  double largest(double most_m, const Sequence& sequence, Holds&& holds) const {
    constexpr double smallest_m = 1e-4;
    const BodyId frame = frame_for(sequence);
    const auto is_proved = [&](double moved_m) { return holds(Ways(*this, moved_m, frame)); };
    if (!(most_m > 0.0) || is_proved(most_m)) return most_m;
    double low_m = 0.5 * most_m, high_m = most_m;
    while (low_m >= smallest_m && !is_proved(low_m)) {
      high_m = low_m;
      low_m *= 0.5;
    }
    if (low_m < smallest_m) return 0.0;
    for (int step = 0; step < 4; ++step) {
      const double middle_m = 0.5 * (low_m + high_m);
      (is_proved(middle_m) ? low_m : high_m) = middle_m;
    }
    return low_m;
  }

  const SceneTracer<Index>& tracer_;
  LifetimeScene known_;
  LifetimeSettings settings_;
  LinkEnd transmitter_, receiver_;
  std::unordered_set<Sequence, SequenceHash> open_;
  std::size_t asked_ = 0;
};

}  // namespace dcem
