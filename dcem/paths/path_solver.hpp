#pragma once
/// From a sequence of mirrors and two ends to a valid path, or none. Both discoveries use this one function, so a path
/// has the same bits whoever proposed its sequence.
#include <algorithm>
#include <cstdint>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "dcem/core/error.hpp"
#include "dcem/paths/image_method.hpp"
#include "dcem/paths/link_end.hpp"
#include "dcem/paths/path.hpp"
#include "dcem/paths/sequence.hpp"

namespace dcem {

struct SolverCounters {
  std::uint64_t sequences_solved = 0;
  std::uint64_t legs = 0;
  TraversalCounters traversal;

  SolverCounters& operator+=(const SolverCounters& other) {
    sequences_solved += other.sequences_solved;
    legs += other.legs;
    traversal += other.traversal;
    return *this;
  }
};

/// Holds scratch memory: one per thread.
template <typename Tree>
class PathSolver {
 public:
  PathSolver(const SceneTracer<Tree>& tracer, int max_transmissions)
      : tracer_(tracer), max_transmissions_(static_cast<std::size_t>(max_transmissions)) {}

  /// The path over `mirrors` (from the receiver outwards), with `images_m` as in `reflection_points`. Where facets
  /// overlap in one plane, the path that comes back is the one over the facets that stand for the others.
  std::optional<Path> solve(const LinkEnd& transmitter, const LinkEnd& receiver, const Sequence& mirrors,
                            const std::vector<Vec3>& images_m) {
    ++counters_.sequences_solved;
    std::optional<Path> path = solve_as_given(transmitter, receiver, mirrors, images_m);
    if (!path || mirrors.empty()) return path;
    Sequence chosen = mirrors;
    while (std::optional<std::pair<Sequence, Path>> better = preferred_twin(transmitter, receiver, chosen, *path)) {
      std::tie(chosen, *path) = std::move(*better);
    }
    return path;
  }

  const SolverCounters& counters() const { return counters_; }
  SolverCounters& counters() { return counters_; }

 private:
  const WorldFacet& facet(FacetId id) const { return tracer_.scene().facet(id); }

  std::optional<Path> solve_as_given(const LinkEnd& transmitter, const LinkEnd& receiver, const Sequence& mirrors,
                                     const std::vector<Vec3>& images_m) {
    const auto plane = [&](std::size_t index) -> const Plane& { return facet(mirrors[index]).plane; };
    if (!reflection_points(transmitter.position_m, images_m, mirrors.size(), plane, points_m_)) return std::nullopt;
    const IgnoredBodies ignored{transmitter.ignored_body, receiver.ignored_body};
    if (!touches_its_mirrors(transmitter, receiver, mirrors, ignored)) return std::nullopt;
    return follow(transmitter, receiver, mirrors, ignored);
  }

  /// Whether each point of `points_m_` lies on its facet, and no end is mounted on the first mirror that it would see.
  bool touches_its_mirrors(const LinkEnd& transmitter, const LinkEnd& receiver, const Sequence& mirrors,
                           const IgnoredBodies& ignored) {
    const auto mounted = [](const LinkEnd& end, FacetId id) {
      return std::binary_search(end.mounted_on.begin(), end.mounted_on.end(), id);
    };
    if (!mirrors.empty() && (mounted(receiver, mirrors.front()) || mounted(transmitter, mirrors.back()))) return false;
    for (std::size_t index = 0; index < mirrors.size(); ++index) {
      const FacetId id =
          mirrors[mirrors.size() - 1 - index];  // points run from the transmitter, mirrors from the receiver
      if (!facet(id).present || tracer_.is_ignored(facet(id).body, ignored)) return false;
      if (!tracer_.reflects_at(id, points_m_[index], ignored, counters_.traversal)) return false;
      if (index > 0 && tracer_.lies_along(facet(id), facet(mirrors[mirrors.size() - index]).plane, points_m_[index])) {
        return false;  // nothing bounces between two coplanar patches that are a hair apart
      }
    }
    return true;
  }

  /// Walks the legs of `points_m_`, collecting the sheets they cross.
  std::optional<Path> follow(const LinkEnd& transmitter, const LinkEnd& receiver, const Sequence& mirrors,
                             const IgnoredBodies& ignored) {
    Path path;
    std::size_t left = max_transmissions_;
    Vec3 from_m = transmitter.position_m;
    LegEnd start{transmitter.mounted_on, nullptr};
    for (std::size_t leg = 0; leg <= mirrors.size(); ++leg) {
      const bool last = leg == mirrors.size();
      const FacetId* mirror = last ? nullptr : &mirrors[mirrors.size() - 1 - leg];
      const Vec3 to_m = last ? receiver.position_m : points_m_[leg];
      const LegEnd end = last ? LegEnd{receiver.mounted_on, nullptr} : LegEnd{{mirror, 1}, &facet(*mirror).plane};
      const double leg_length_m = glm::distance(from_m, to_m);
      if (!(leg_length_m > in_plane_guard_m)) return std::nullopt;  // two points in one: no direction, no spreading
      ++counters_.legs;
      if (!tracer_.follow_leg(from_m, to_m, start, end, ignored, left, crossings_, counters_.traversal)) {
        return std::nullopt;
      }
      for (const Crossing& crossing : crossings_) {
        path.interactions.push_back(
            {InteractionKind::transmission, crossing.facet, from_m + crossing.t * (to_m - from_m)});
      }
      left -= crossings_.size();
      if (!last) path.interactions.push_back({InteractionKind::reflection, *mirror, to_m});
      path.length_m += leg_length_m;
      from_m = to_m;
      start = end;
    }
    return path;
  }

  /// The first valid sequence, before `mirrors` in order of precedence, over facets that lie on top of the path's own
  /// ones at its reflection points.
  std::optional<std::pair<Sequence, Path>> preferred_twin(const LinkEnd& transmitter, const LinkEnd& receiver,
                                                          const Sequence& mirrors, const Path& path) {
    const IgnoredBodies ignored{transmitter.ignored_body, receiver.ignored_body};
    std::vector<std::vector<FacetId>> choices(mirrors.size());
    bool any = false;
    std::size_t index = mirrors.size();
    for (const Interaction& interaction : path.interactions) {
      if (interaction.kind != InteractionKind::reflection) continue;
      --index;
      choices[index] = preferred_facets(mirrors[index], interaction.point_m, ignored);
      any = any || choices[index].size() > 1;
    }
    if (!any) return std::nullopt;
    Sequence candidate(mirrors.size());
    return first_valid(transmitter, receiver, mirrors, choices, 0, candidate);
  }

  /// Coplanar facets at a point that stand before `own`, in order, and `own` last.
  std::vector<FacetId> preferred_facets(FacetId own, const Vec3& point_m, const IgnoredBodies& ignored) {
    std::vector<FacetId> facets =
        tracer_.facets_near(point_m, tracer_.scene().settings().weld_tolerance_m, ignored, counters_.traversal);
    std::erase_if(facets, [&](FacetId other) {
      return other == own || !tracer_.precedes(other, own) || !tracer_.parallel(other, own);
    });
    std::sort(facets.begin(), facets.end(), [&](FacetId a, FacetId b) { return tracer_.precedes(a, b); });
    facets.push_back(own);
    return facets;
  }

  std::optional<std::pair<Sequence, Path>> first_valid(const LinkEnd& transmitter, const LinkEnd& receiver,
                                                       const Sequence& mirrors,
                                                       const std::vector<std::vector<FacetId>>& choices,
                                                       std::size_t index, Sequence& candidate) {
    if (index == mirrors.size()) {
      if (candidate == mirrors) return std::nullopt;  // nothing stands before the path itself
      std::vector<Vec3> images_m{receiver.position_m};
      for (const FacetId id : candidate) append_image(images_m, facet(id).plane);
      std::optional<Path> path = solve_as_given(transmitter, receiver, candidate, images_m);
      if (!path) return std::nullopt;
      return std::pair(candidate, std::move(*path));
    }
    for (const FacetId choice : choices[index]) {
      candidate[index] = choice;
      if (auto found = first_valid(transmitter, receiver, mirrors, choices, index + 1, candidate)) return found;
    }
    return std::nullopt;
  }

  const SceneTracer<Tree>& tracer_;
  std::size_t max_transmissions_;
  SolverCounters counters_;
  std::vector<Vec3> points_m_;
  std::vector<Crossing> crossings_;
};

}  // namespace dcem
