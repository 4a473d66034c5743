#pragma once
/// What receivers side by side find together, and what each of them finds by trying every sequence.
#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "dcem/paths/halves/crowd_joiner.hpp"
#include "dcem/paths/halves/crowd_triples.hpp"
#include "tests/paths/halves/small_town.hpp"

namespace dcem::test {

inline HalfSettings half_settings_of(const Asked& asked) {
  HalfSettings settings{asked.diffractions > 0, asked.transmissions, {}};
  settings.rules.free_edges = asked.free_edges;
  return settings;
}

/// The paths from one end to each point of a crowd.
inline std::vector<std::vector<Path>> found_together(TracedScene<>& traced, const LinkEnd& from,
                                                     const std::vector<Vec3>& points_m, const Asked& asked,
                                                     int pixels) {
  const FacetOutlines outlines(traced.scene);
  const LaneScene lanes(traced.scene, outlines);
  PathHalf half(pixels);
  half.find_scenery(traced.scene, outlines, from, half_settings_of(asked));
  half.find_bodies(traced.scene, outlines, half_settings_of(asked));
  BeamLists mast;
  mast.find_all({traced.scene, outlines, lanes, half, half_settings_of(asked), true});
  Crowd crowd(pixels);
  crowd.look_from(traced.scene, outlines, lanes, points_m, half_settings_of(asked));
  SolverCounters counters;
  Blockers blockers;
  CrowdGates<WideIndex> gates(traced.tracer, outlines, lanes, crowd, mast, blockers, counters);
  const JoinOrders orders{asked.reflections, asked.diffractions, asked.interactions};
  CrowdJoiner<WideIndex> joiner(gates, orders);
  PathSolver<WideIndex> solver(traced.tracer, asked.transmissions, half_settings_of(asked).rules);
  std::vector<std::vector<Path>> paths(points_m.size());
  const auto solve = [&](const Sequence& sequence, std::size_t point) {
    if (auto path = solver.solve(from, traced.end(points_m[point]), sequence)) paths[point].push_back(std::move(*path));
  };
  for (std::size_t point = 0; point < points_m.size(); ++point) solve({}, point);
  joiner.for_each_sequence(solve);
  if (asked.interactions >= 3) {
    CrowdBeams beams;
    beams.look_from(traced.scene, outlines, lanes, crowd, half_settings_of(asked));
    CrowdTriples<WideIndex>(gates, beams, orders).for_each_sequence(solve);
  }
  for (std::vector<Path>& link : paths) dcem::detail::sort_and_drop_repeated(link);
  return paths;
}

inline std::vector<Vec3> points_beside(Draw& draw, const Vec3& middle_m, const Vec3& size_m, std::size_t count) {
  std::vector<Vec3> points_m;
  for (std::size_t point = 0; point < count; ++point) {
    points_m.push_back(middle_m + draw.inside(-0.5 * size_m, 0.5 * size_m));
  }
  return points_m;
}

/// 1 to 16 points in a box of up to `most_m`, flat or half as high, somewhere in a region.
inline std::vector<Vec3> some_crowd(Draw& draw, double most_m, const Vec3& low_m, const Vec3& high_m) {
  const double size_m = draw.between(0.1, most_m);
  const Vec3 middle_m = draw.inside(low_m, high_m);
  const double height_m = draw.below(2) == 0 ? 0.0 : 0.5 * size_m;
  const std::size_t count = 1 + draw.below(16);
  return points_beside(draw, middle_m, Vec3(size_m, size_m, height_m), count);
}

/// Checks what a crowd finds against each of its points by itself; returns how many paths there are.
inline std::size_t check_crowd(TracedScene<>& traced, const LinkEnd& from, const std::vector<Vec3>& points_m,
                               const Asked& asked, int pixels) {
  const std::vector<std::vector<Path>> together = found_together(traced, from, points_m, asked, pixels);
  std::size_t found = 0;
  for (std::size_t point = 0; point < points_m.size(); ++point) {
    CAPTURE(point);
    const std::vector<Path> expected = all_sequences(traced, from, traced.end(points_m[point]), asked);
    CHECK(same_paths(together[point], expected));
    found += expected.size();
  }
  return found;
}

/// Checks a crowd in a random town for every seed; returns how many paths there are. `asked_of(draw)`: what is asked.
template <typename AskedOf>
std::size_t check_town_crowds(std::uint64_t first_seed, std::uint64_t end_seed, AskedOf&& asked_of) {
  std::size_t found = 0;
  for (std::uint64_t seed = first_seed; seed < end_seed; ++seed) {
    Draw draw(seed);
    TracedScene<> traced(small_town(draw));
    const LinkEnd from = somewhere(traced, draw);
    const Asked asked = asked_of(draw);
    const std::vector<Vec3> points_m = some_crowd(draw, 8.0, Vec3(-20, -20, 0.3), Vec3(20, 20, 14));
    CAPTURE(seed);
    found += check_crowd(traced, from, points_m, asked, draw.below(2) == 0 ? 256 : 64);
  }
  MESSAGE(found << " paths");
  return found;
}

}  // namespace dcem::test
