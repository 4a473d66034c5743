#pragma once
/// From a sequence of mirrors and edges and two ends to a valid path, or none. All discoveries use this one class, so a
/// path has the same bits whoever proposed its sequence.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "dcem/core/error.hpp"
#include "dcem/paths/path.hpp"
#include "dcem/paths/query/link_end.hpp"
#include "dcem/paths/sequence.hpp"
#include "dcem/paths/solve/chain_points.hpp"
#include "dcem/paths/solve/edge_rules.hpp"
#include "dcem/paths/solve/face_leg.hpp"
#include "dcem/paths/solve/image_method.hpp"
#include "dcem/paths/solve/leg_walker.hpp"
#include "dcem/paths/solve/solver_counters.hpp"

namespace dcem {

/// Holds scratch memory: one per thread.
template <typename Index>
class PathSolver {
 public:
  PathSolver(const SceneTracer<Index>& tracer, int max_transmissions, const EdgeRules& rules = {})
      : tracer_(tracer), legs_(tracer, max_transmissions), rules_(rules) {}

  /// The path over `sequence` (from the receiver outwards). Where facets overlap in one plane, the path that comes back
  /// is the one over the facets that stand for the others.
  std::optional<Path> solve(const LinkEnd& transmitter, const LinkEnd& receiver, const Sequence& sequence) {
    return solve(transmitter, receiver, sequence, nullptr);
  }
  /// The same for mirrors alone, whose images of the receiver are known: images_m[i] is the image after mirror i.
  std::optional<Path> solve(const LinkEnd& transmitter, const LinkEnd& receiver, const Sequence& mirrors,
                            const std::vector<Vec3>& images_m) {
    return solve(transmitter, receiver, mirrors, &images_m);
  }

  /// Whether what came back last hangs on ways over other facets, too, that lie on top of the path's own.
  bool had_choice() const { return had_choice_; }

  const SolverCounters& counters() const { return counters_; }
  SolverCounters& counters() { return counters_; }

 private:
  const Scene& scene() const { return tracer_.scene(); }
  const WorldFacet& facet(FacetId id) const { return scene().facet(id); }

  std::optional<Path> solve(const LinkEnd& transmitter, const LinkEnd& receiver, const Sequence& sequence,
                            const std::vector<Vec3>* images_m) {
    ++counters_.sequences_solved;
    had_choice_ = false;
    std::optional<Path> path = solve_as_given(transmitter, receiver, sequence, images_m);
    if (!path || sequence.empty()) return path;
    std::optional<std::pair<Sequence, Path>> better = preferred_duplicate(transmitter, receiver, sequence, *path);
    while (better) {
      path = std::move(better->second);
      better = preferred_duplicate(transmitter, receiver, better->first, *path);
    }
    return path;
  }

  std::optional<Path> solve_as_given(const LinkEnd& transmitter, const LinkEnd& receiver, const Sequence& sequence,
                                     const std::vector<Vec3>* images_m) {
    if (!points_.find(scene(), transmitter.position_m, receiver.position_m, sequence, images_m)) return std::nullopt;
    const IgnoredBodies ignored{transmitter.ignored_body, receiver.ignored_body};
    if (sees_what_it_is_mounted_on(transmitter, receiver, sequence)) return std::nullopt;
    in_shadow_.assign(sequence.size(), false);
    for (std::size_t index = 0; index < sequence.size(); ++index) {
      const SequenceElement element = sequence[sequence.size() - 1 - index];  // points run from the transmitter
      const bool holds = element.is_edge() ? touches_edge(index, transmitter, receiver, sequence, ignored)
                                           : touches_mirror(element.mirror(), index, sequence, ignored);
      if (!holds) return std::nullopt;
    }
    // What touches an edge takes longer to ask than whether the legs are free.
    const Path* const path = legs_.follow(transmitter, receiver, sequence, points_.points_m(), in_shadow_, counters_);
    if (path == nullptr) return std::nullopt;
    for (std::size_t index = 0; index < sequence.size(); ++index) {
      const SequenceElement element = sequence[sequence.size() - 1 - index];
      if (!element.is_edge()) continue;
      if (touches_third(element.edge(), index, ignored) || leaves_face(index, sequence)) return std::nullopt;
    }
    return *path;
  }

  /// Whether an end is mounted on the first surface that it would see: such a mirror does not reflect for it, and along
  /// such a face it is at grazing, where the wedge's field is that of the face.
  bool sees_what_it_is_mounted_on(const LinkEnd& transmitter, const LinkEnd& receiver, const Sequence& sequence) const {
    const auto mounted = [&](const LinkEnd& end, SequenceElement element) {
      const auto on = [&](FacetId id) { return std::binary_search(end.mounted_on.begin(), end.mounted_on.end(), id); };
      if (!element.is_edge()) return on(element.mirror());
      const WorldWedge& wedge = scene().wedge(element.edge());
      return on(wedge.facets[0]) || on(wedge.facets[1]);
    };
    return !sequence.empty() && (mounted(receiver, sequence.front()) || mounted(transmitter, sequence.back()));
  }

  /// Whether the path's point `index`, counted from the transmitter, lies where the mirror reflects.
  bool touches_mirror(FacetId id, std::size_t index, const Sequence& sequence, const IgnoredBodies& ignored) {
    if (!facet(id).present || tracer_.is_ignored(facet(id).body, ignored)) return false;
    const Vec3& point_m = points_.points_m()[index];
    if (!tracer_.reflects_at(id, point_m, ignored, counters_.traversal)) return false;
    const std::size_t from_receiver = sequence.size() - 1 - index;
    for (const std::size_t next : {from_receiver + 1, from_receiver - 1}) {  // the smaller one wraps around at 0
      if (next >= sequence.size()) continue;
      if (sequence[next].is_edge()) {
        const WorldWedge& wedge = scene().wedge(sequence[next].edge());
        if (wedge.facets[0] == id || wedge.facets[1] == id) return false;  // its mesh may stray from its plane
        if (holds_edge(facet(id).plane, wedge.edge, scene().settings().weld_tolerance_m)) return false;
      } else if (next > from_receiver &&
                 lies_along(scene(), facet(id), facet(sequence[next].mirror()).plane, point_m)) {
        return false;  // nothing bounces between two coplanar patches that are a hair apart
      }
    }
    return true;
  }

  /// Whether the wedge diffracts at the path's point `index`: both neighbours in its exterior, or on an edge of one of
  /// its faces.
  bool touches_edge(std::size_t index, const LinkEnd& transmitter, const LinkEnd& receiver, const Sequence& sequence,
                    const IgnoredBodies& ignored) {
    const WedgeId id = sequence[sequence.size() - 1 - index].edge();
    const WorldWedge& wedge = scene().wedge(id);
    if (!diffracts(wedge, rules_) || tracer_.is_ignored(wedge.body, ignored)) return false;
    const std::vector<Vec3>& points_m = points_.points_m();
    const Vec3& here_m = points_m[index];
    if (contact_at(id, rules_).is_touched(along_edge_m(wedge.edge, here_m))) return false;
    const Vec3& before_m = index == 0 ? transmitter.position_m : points_m[index - 1];
    const Vec3& after_m = index + 1 == points_m.size() ? receiver.position_m : points_m[index + 1];
    const std::optional<FacetId> from = index > 0 ? face_between(index - 1, sequence) : std::nullopt;
    const std::optional<FacetId> to = index + 1 < sequence.size() ? face_between(index, sequence) : std::nullopt;
    if (from && to) return false;  // the terms of such an edge cancel down to rounding
    const double before_rad = azimuth_rad(wedge, before_m - here_m, from);
    if (!from && !clear_of_faces(wedge.edge, before_m - here_m, before_rad)) return false;
    const double after_rad = azimuth_rad(wedge, after_m - here_m, to);
    if (!to && !clear_of_faces(wedge.edge, after_m - here_m, after_rad)) return false;
    const double turn_rad = before_rad - after_rad;
    in_shadow_[index] = from || to ? std::abs(turn_rad) > pi : hides(wedge, before_m, after_m, std::abs(turn_rad));
    return !rules_.shadow_only || in_shadow_[index];
  }

  /// The face along which the leg from point `index` to the next one leads: both are on edges of it.
  std::optional<FacetId> face_between(std::size_t index, const Sequence& sequence) const {
    const SequenceElement here = sequence[sequence.size() - 1 - index], next = sequence[sequence.size() - 2 - index];
    if (!here.is_edge() || !next.is_edge()) return std::nullopt;
    return common_face(scene().wedge(here.edge()), scene().wedge(next.edge()));
  }

  /// Whether the leg from point `index` leads along a face and beyond its rim in between.
  bool leaves_face(std::size_t index, const Sequence& sequence) const {
    if (index + 1 >= sequence.size()) return false;
    const std::optional<FacetId> face = face_between(index, sequence);
    if (!face) return false;
    const auto stray_m = [&](std::size_t at) {
      return scene().wedge(sequence[sequence.size() - 1 - at].edge()).edge.stray_m;
    };
    const double tolerance_m = scene().settings().weld_tolerance_m + std::max(stray_m(index), stray_m(index + 1));
    return !lies_on_facet(scene(), *face, points_.points_m()[index], points_.points_m()[index + 1], tolerance_m);
  }

  /// Whether a third facet is at the path's point `index`, on an edge: then nothing diffracts there.
  bool touches_third(WedgeId id, std::size_t index, const IgnoredBodies& ignored) {
    const WorldWedge& wedge = scene().wedge(id);
    if (contact_at(id, rules_).is_free(along_edge_m(wedge.edge, points_.points_m()[index]))) return false;
    const double tolerance_m = scene().settings().weld_tolerance_m + wedge.edge.stray_m;
    tracer_.facets_near(points_.points_m()[index], tolerance_m, ignored, near_, counters_.traversal);
    return std::any_of(near_.begin(), near_.end(),
                       [&](FacetId facet) { return facet != wedge.facets[0] && facet != wedge.facets[1]; });
  }

  /// Whether the wedge stands between two points that it turns into each other. Within rounding of the shadow boundary
  /// the azimuths cannot say; there the test decides that decides of the straight leg between the two, so that exactly
  /// one of the direct and the shadowed field is taken.
  bool hides(const WorldWedge& wedge, const Vec3& before_m, const Vec3& after_m, double turn_rad) const {
    if (std::abs(turn_rad - pi) > shadow_boundary_rad) return turn_rad > pi;
    return tracer_.meets(wedge.facets[0], before_m, after_m) || tracer_.meets(wedge.facets[1], before_m, after_m);
  }

  /// In the exterior, and off both faces by more than rounding. `angle_rad`: the azimuth of the direction.
  static bool clear_of_faces(const Wedge& wedge, const Vec3& away_m, double angle_rad) {
    if (!(angle_rad > 0.0 && angle_rad < wedge.exterior_angle_rad)) return false;
    const double across_m = std::hypot(glm::dot(away_m, wedge.tangent), glm::dot(away_m, wedge.normal));
    return across_m * std::min(angle_rad, wedge.exterior_angle_rad - angle_rad) > in_plane_guard_m;
  }

  /// The first valid sequence, before this one in order of precedence, over facets that lie on top of the path's own
  /// ones at its reflection points.
  std::optional<std::pair<Sequence, Path>> preferred_duplicate(const LinkEnd& transmitter, const LinkEnd& receiver,
                                                               const Sequence& sequence, const Path& path) {
    const auto stands_alone = [&](SequenceElement element) {
      return element.is_edge() || is_unstacked(element.mirror(), rules_);
    };
    if (std::all_of(sequence.begin(), sequence.end(), stands_alone)) return std::nullopt;
    const IgnoredBodies ignored{transmitter.ignored_body, receiver.ignored_body};
    choices_.clear();
    bool any = false;
    for (auto interaction = path.interactions.rbegin(); interaction != path.interactions.rend(); ++interaction) {
      if (interaction->kind == InteractionKind::transmission) continue;
      choice_.assign(1, sequence[choices_.size()]);
      if (interaction->kind == InteractionKind::reflection) prefer_mirrors(interaction->point_m, ignored);
      choices_.add(choice_);
      any = any || choice_.size() > 1;
    }
    if (!any) return std::nullopt;
    had_choice_ = true;
    Sequence candidate = sequence;
    return first_valid(transmitter, receiver, sequence, 0, candidate);
  }

  /// Puts coplanar facets at a point that stand before the one mirror of `choice_` in front of it, in order.
  void prefer_mirrors(const Vec3& point_m, const IgnoredBodies& ignored) {
    const FacetId own = choice_.front().mirror();
    tracer_.facets_near(point_m, scene().settings().weld_tolerance_m, ignored, near_, counters_.traversal);
    std::erase_if(near_, [&](FacetId other) {
      return other == own || !tracer_.precedes(other, own) || !tracer_.parallel(other, own);
    });
    std::sort(near_.begin(), near_.end(), [&](FacetId a, FacetId b) { return tracer_.precedes(a, b); });
    choice_.insert(choice_.begin(), near_.begin(), near_.end());
  }

  std::optional<std::pair<Sequence, Path>> first_valid(const LinkEnd& transmitter, const LinkEnd& receiver,
                                                       const Sequence& sequence, std::size_t index,
                                                       Sequence& candidate) {
    if (index == sequence.size()) {
      if (candidate == sequence) return std::nullopt;  // nothing stands before the path itself
      std::optional<Path> path = solve_as_given(transmitter, receiver, candidate, nullptr);
      if (!path) return std::nullopt;
      return std::pair(candidate, std::move(*path));
    }
    for (const SequenceElement choice : choices_[index]) {
      candidate[index] = choice;
      if (auto found = first_valid(transmitter, receiver, sequence, index + 1, candidate)) return found;
    }
    return std::nullopt;
  }

  const SceneTracer<Index>& tracer_;
  LegWalker<Index> legs_;
  EdgeRules rules_;
  SolverCounters counters_;
  ChainPoints points_;
  std::vector<bool> in_shadow_;
  std::vector<FacetId> near_;
  SequenceList choices_;  ///< by element of a sequence: what may stand in its place, in order of precedence
  Sequence choice_;
  bool had_choice_ = false;
};

}  // namespace dcem
