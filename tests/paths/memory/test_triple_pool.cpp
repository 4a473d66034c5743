/// What a place knows of three interactions: every path over the scenery, from anywhere in it, is among its candidates
/// and refused nowhere near; every path at all is among what its beams and the transmitter's lists are joined to.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <set>
#include <vector>

#include "dcem/paths/discover/path_cache.hpp"
#include "dcem/paths/halves/triple_joiner.hpp"
#include "dcem/paths/memory/pooled_link.hpp"
#include "tests/paths/halves/small_street.hpp"

namespace test_triple_pool {

using namespace dcem;
using namespace dcem::test;

namespace {

struct Tally {
  std::size_t paths = 0, over_bodies = 0, missed = 0, not_listed = 0, wrongly_refused = 0;
  std::size_t asked = 0, refused = 0, refused_ahead = 0;
  std::size_t points = 0, too_far = 0, nearly = 0;
};

/// A street, a mast with its lists and a place with its candidates.
struct PlaceInStreet {
  PlaceInStreet(Draw& draw, const Asked& all)
      : traced(small_street(draw)),
        outlines(traced.scene),
        lanes(traced.scene, outlines),
        from(traced.end(draw.inside(Vec3(-8, -3, 0.3), Vec3(8, 3, 9)))) {
    settings.exhaustive = false;
    settings.joined = settings.max_reflections = settings.max_interactions = 3;
    settings.rays = 0;
    settings.max_diffractions = 1;
    settings.max_transmissions = all.transmissions;
    settings.edges.free_edges = all.free_edges;
    mast.update(scene(), outlines, from, seen(), {&lanes, true, true, 1000});
    const double turn_rad = draw.between(-pi, pi);
    const Vec3 half_m = draw.below(2) == 0 ? Vec3(2, 0.5, 0.1)
                                           : Vec3(draw.between(0.5, 3), draw.between(0.2, 1.5), draw.between(0.1, 1.5));
    const PlaceBox box{
        draw.inside(Vec3(-8, -4, 0.2), Vec3(8, 4, 5)), {std::cos(turn_rad), std::sin(turn_rad), 0}, half_m};
    place = std::make_shared<const Place>(scene(), outlines, box, seen(), true);
    TriplePool pool(place, *mast.lists(), joined_orders(settings));
    while (pool.steps_left() > 0) pool.go_on(scene(), outlines, lanes);
    candidates = {pool.candidates().begin(), pool.candidates().end()};
  }

  const Scene& scene() const { return traced.scene; }
  HalfSettings seen() const { return half_settings(settings); }
  /// A point in the place, one in three in one of its faces.
  Vec3 point_m(Draw& draw) const {
    Vec3 at = 0.99999 * draw.inside(Vec3(-1), Vec3(1));
    if (draw.below(3) == 0) at[static_cast<int>(draw.below(3))] = draw.below(2) == 0 ? 0.99999 : -0.99999;
    const PlaceBox& box = place->box();
    return box.middle_m + at.x * box.half_m.x * box.ahead + at.y * box.half_m.y * box.aside() +
           Vec3(0, 0, at.z * box.half_m.z);
  }
  /// All that is joined to what the place knows, for a receiver at a point of it.
  std::set<Sequence> joined(const LinkEnd& to, bool bodies_have_moved) const {
    PathHalf half(64);
    half.take_scenery(scene(), outlines, to, seen(), *place);
    const std::vector<char> moved(scene().bodies().size(), bodies_have_moved ? 1 : 0);
    half.find_bodies(scene(), outlines, seen(), moved);
    half.lay_out_images(scene(), outlines);
    BeamLists lists;
    lists.find_from({scene(), outlines, lanes, half, seen(), true}, *place, moved);
    std::set<Sequence> all;
    TripleJoiner(scene(), outlines, lanes, joined_orders(settings))
        .for_each_sequence(lists, *mast.lists(), [&](const Sequence& sequence) { all.insert(sequence); });
    return all;
  }
  bool is_scenery(const Sequence& sequence) const {
    for (const SequenceElement element : sequence) {
      const BodyId body = element.is_edge() ? scene().wedge(element.edge()).body : scene().facet(element.mirror()).body;
      if (body != BodyId(0)) return false;
    }
    return true;
  }

  TracedScene<> traced;
  FacetOutlines outlines;
  LaneScene lanes;
  LinkEnd from;
  PathSearchSettings settings;
  KeptHalf mast;
  std::shared_ptr<const Place> place;
  std::set<Triple> candidates;
};

/// From where the receiver is now to where it gets to the points of a way move no farther than was said.
void compare_points(const PlaceInStreet& in, const Vec3& here_m, const Vec3& there_m, const Triple& path,
                    const Drift& drift, Tally& tally) {
  const JoinGates gates(in.scene(), in.outlines);
  TripleWays here(gates, in.outlines, here_m, in.place->sight(), *in.mast.lists());
  TripleWays there(gates, in.outlines, there_m, in.place->sight(), *in.mast.lists());
  if (!here.work_out(path, Drift()) || !here.has_points()) return;
  if (!there.work_out(path, Drift()) || !there.has_points()) return;
  here.work_out(path, drift);
  const WayReach reach = here.reach();
  for (std::size_t at = 0; at < reach.size(); ++at) {
    if (!reach[at].is_known()) continue;
    const double moved_m = glm::distance(here.points_m()[at], there.points_m()[at]);
    ++tally.points;
    tally.too_far += moved_m > reach[at].most_m() * (1.0 + 1e-6) + 1e-6 ? 1 : 0;
    tally.nearly += moved_m > 0.5 * reach[at].most_m() ? 1 : 0;
  }
}

/// A receiver somewhere in the place asks whether what leads to another point may be forgotten until it gets there.
void ask_from_elsewhere(const PlaceInStreet& in, Draw& draw, const Vec3& to_m, const std::vector<Triple>& paths,
                        Tally& tally) {
  const JoinGates gates(in.scene(), in.outlines);
  for (int at = 0; at < 6; ++at) {
    const Vec3 here_m = at < 3 ? in.point_m(draw) : to_m + draw.magnitude(1e-3, 2) * draw.direction();
    if (!in.place->box().holds(here_m)) continue;
    TripleWays ways(gates, in.outlines, here_m, in.place->sight(), *in.mast.lists());
    const double away_m = glm::distance(here_m, to_m) * 1.000001 + 1e-9, aside_m = draw.magnitude(1e-3, 0.2);
    // Any way, and along a line that leads there, or a little past it.
    const Vec3 ahead = glm::normalize(to_m - here_m + draw.between(0, aside_m) * draw.direction());
    const std::array<Drift, 3> drifts{Drift(away_m), Drift(away_m, ahead, aside_m), Drift(away_m, -ahead, aside_m)};
    for (const Triple& path : paths) {
      for (const Drift& drift : drifts) {
        tally.wrongly_refused += ways.refuses(path, drift) ? 1 : 0;
        compare_points(in, here_m, to_m, path, drift, tally);
      }
    }
    for (const Triple& candidate : in.candidates) {
      ++tally.asked;
      tally.refused += ways.refuses(candidate, Drift(0.5)) ? 1 : 0;
      tally.refused_ahead += ways.refuses(candidate, {0.5, ahead, 0.05}) ? 1 : 0;
    }
  }
}

void try_place(std::uint64_t seed, Tally& tally) {
  Draw draw(seed);
  const Asked all{static_cast<int>(draw.below(3)), 3, 1, 3, draw.below(4) == 0};
  PlaceInStreet in(draw, all);
  for (int receiver = 0; receiver < 3; ++receiver) {
    const Vec3 to_m = in.point_m(draw);
    if (!in.place->box().holds(to_m)) continue;
    const LinkEnd to = in.traced.end(to_m);
    const std::set<Sequence> joined = in.joined(to, draw.below(2) == 0);
    std::vector<Triple> over_scenery;
    for (const Path& path : all_sequences(in.traced, in.from, to, all)) {
      const Sequence sequence = sequence_of(path);
      if (sequence.size() != 3) continue;
      ++tally.paths;
      tally.not_listed += joined.contains(sequence) ? 0 : 1;
      if (!in.is_scenery(sequence)) {
        ++tally.over_bodies;
        continue;
      }
      over_scenery.push_back({sequence[0], sequence[1], sequence[2]});
      tally.missed += in.candidates.contains(over_scenery.back()) ? 0 : 1;
    }
    ask_from_elsewhere(in, draw, to_m, over_scenery, tally);
  }
}

}  // namespace

TEST_CASE("all paths of three interactions in a place are among what it knows") {
  Tally tally;
  for (std::uint64_t seed = 1; seed <= 120; ++seed) try_place(7919 * seed, tally);
  MESSAGE(tally.paths << " paths, " << tally.over_bodies << " over bodies; of " << tally.asked << " candidates "
                      << tally.refused << " are refused for half a metre any way, " << tally.refused_ahead
                      << " straight on");
  CHECK(tally.missed == 0);
  CHECK(tally.not_listed == 0);
  CHECK(tally.wrongly_refused == 0);
  CHECK(tally.too_far == 0);
  CHECK(tally.points > 20'000);
  CHECK(tally.nearly > tally.points / 20);  // or too much is said
  CHECK(tally.paths > 4'000);
  CHECK(tally.over_bodies > 1'000);
  CHECK(tally.refused > tally.asked / 20);
  CHECK(tally.refused_ahead > tally.refused);
}

}  // namespace test_triple_pool
