/// Lists of what edges light change no path: they only spare sequences that carry none.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "dcem/core/thread_pool.hpp"
#include "dcem/paths/halves/half_joiner.hpp"
#include "tests/paths/halves/crowds.hpp"

namespace test_edges_before_mirrors {

using namespace dcem;
using namespace dcem::test;

namespace {

constexpr double all_of_it = std::numeric_limits<double>::infinity();

/// A transmitter, and what it has listed. It stays where it is in memory.
class Mast {
 public:
  Mast(TracedScene<>& traced, const LinkEnd& from, const Asked& asked, int pixels, bool lists_bodies)
      : traced_(traced), from_(from), asked_(asked), half_(pixels) {
    half_.find_scenery(traced.scene, outlines_, from, half_settings_of(asked));
    half_.find_bodies(traced.scene, outlines_, half_settings_of(asked));
    half_.settle();
    lists_.find_scenery(source(nullptr));
    if (lists_bodies) lists_.find_bodies(source(nullptr));
  }
  Mast(const Mast&) = delete;
  Mast& operator=(const Mast&) = delete;

  /// Lists what is lit over edges, so much of it at a time; returns how often it had to go on.
  std::size_t look_over_edges(double work_us = all_of_it, ThreadPool* pool = nullptr) {
    std::size_t times = 1;
    for (double left_us = work_us; !lists_.go_on_over_edges(source(pool), left_us); left_us = work_us) ++times;
    return times;
  }
  bool go_on_over_edges(double work_us) { return lists_.go_on_over_edges(source(nullptr), work_us); }

  /// The parts of edges that are asked about over each of a receiver's mirrors.
  std::vector<std::vector<EdgePart>> asked_for(const LinkEnd& to) const {
    PathHalf receiver(half_.map_pixels());
    receiver.find_scenery(traced_.scene, outlines_, to, half_settings_of(asked_));
    const HalfLayer& near = receiver.layers()[0];
    std::vector<std::vector<EdgePart>> parts(near.mirrors.size());
    for (std::uint32_t at = 0; at < near.mirrors.size(); ++at) {
      lists_.for_each_part_before(near.mirrors[at], near.cones[at], near.images_m[at] - lists_.origin_m(), 0.0F,
                                  [&](const EdgePart& part) { parts[at].push_back(part); });
    }
    return parts;
  }
  std::vector<EdgePart> parts() const { return lists_.parts(); }

  /// What joining proposes for a receiver.
  std::vector<SequenceList> proposed(const LinkEnd& to) const {
    PathHalf receiver(half_.map_pixels());
    receiver.find_scenery(traced_.scene, outlines_, to, half_settings_of(asked_));
    receiver.find_bodies(traced_.scene, outlines_, half_settings_of(asked_));
    std::vector<SequenceList> lists(1);
    HalfJoiner(traced_.scene, outlines_, joined_orders(joined_settings_of(asked_)))
        .for_each_sequence(
            receiver, half_, [&](const Sequence& sequence) { lists[0].add(sequence); }, &lists_);
    return lists;
  }

  std::vector<Path> paths(const LinkEnd& to, const std::vector<SequenceList>& proposed) const {
    SearchCounters counters;
    const std::vector<std::optional<LinkEnd>> ends{from_};
    const std::vector<ReachedEdges> reached(1);
    return find_paths(traced_.tracer, joined_settings_of(asked_), to, {"rx", 0}, ends, counters, nullptr, reached,
                      proposed)
        .front()
        .paths;
  }

  /// What a crowd finds with it, and how many sequences that takes.
  std::vector<std::vector<Path>> found_by(const std::vector<Vec3>& points_m, std::size_t& sequences) const {
    Crowd crowd(half_.map_pixels());
    crowd.look_from(traced_.scene, outlines_, lanes_, points_m, half_settings_of(asked_));
    SolverCounters counters;
    Blockers blockers;
    CrowdGates<WideIndex> gates(traced_.tracer, outlines_, lanes_, crowd, lists_, blockers, counters);
    PathSolver<WideIndex> solver(traced_.tracer, asked_.transmissions, half_settings_of(asked_).rules);
    std::vector<std::vector<Path>> paths(points_m.size());
    const auto solve = [&](const Sequence& sequence, std::size_t point) {
      ++sequences;
      auto path = solver.solve(from_, traced_.end(points_m[point]), sequence);
      if (path) paths[point].push_back(std::move(*path));
    };
    for (std::size_t point = 0; point < points_m.size(); ++point) solve({}, point);
    CrowdJoiner<WideIndex>(gates, {asked_.reflections, asked_.diffractions, asked_.interactions})
        .for_each_sequence(solve);
    for (std::vector<Path>& link : paths) dcem::detail::sort_and_drop_repeated(link);
    return paths;
  }

 private:
  BeamSource source(ThreadPool* pool) const {
    return {traced_.scene, outlines_, lanes_, half_, half_settings_of(asked_), true, pool};
  }

  TracedScene<>& traced_;
  LinkEnd from_;
  Asked asked_;
  FacetOutlines outlines_{traced_.scene};
  LaneScene lanes_{traced_.scene, outlines_};
  PathHalf half_;
  BeamLists lists_;
};

struct Counts {
  std::size_t paths = 0;
  std::size_t before = 0, after = 0;              ///< sequences that are proposed
  std::size_t asked_before = 0, asked_after = 0;  ///< parts of edges that are asked about
};

bool same_sequences(const SequenceList& one, const SequenceList& other) {
  if (one.size() != other.size()) return false;
  for (std::size_t at = 0; at < one.size(); ++at) {
    if (!std::ranges::equal(one[at], other[at])) return false;
  }
  return true;
}

/// Houses and sheets on a ground, more of them than in a small town, and two cars.
Scene large_town(Draw& draw) {
  TriangleMesh mesh;
  if (draw.below(4) != 0) add_sheet(mesh, Vec3(0.0), Vec3(30, 0, 0), Vec3(0, 30, 0), "opaque");
  for (std::size_t house = 0; house < 8; ++house) {
    const Vec3 low_m(draw.between(-25, 20), draw.between(-25, 20), draw.below(2) == 0 ? 0.0 : 0.01);
    add_box_faces(mesh, low_m, low_m + draw.inside(Vec3(2, 2, 2), Vec3(8, 8, 12)),
                  draw.below(4) == 0 ? "wall" : "metal");
  }
  for (std::size_t sheet = 0; sheet < 6; ++sheet) {
    const Vec3 along = draw.direction(), across = glm::normalize(glm::cross(along, draw.direction()));
    add_sheet(mesh, draw.inside(Vec3(-20, -20, 1), Vec3(20, 20, 10)), draw.magnitude(0.02, 6) * along,
              draw.magnitude(0.02, 4) * across, draw.below(2) == 0 ? "glass" : "opaque");
  }
  Scene scene = scene_of(mesh);
  for (const char* name : {"one", "two"}) {
    TriangleMesh car;
    add_box_faces(car, Vec3(-2, -0.9, 0), Vec3(2, 0.9, 1.5), "metal");
    scene.add_object(name, car, LinearMotion{{draw.inside(Vec3(-20, -20, 0.02), Vec3(20, 20, 0.05)), 1.0, 0, 0}});
  }
  return scene;
}

/// On a wall, the ground or a car, or within the weld tolerance of it.
LinkEnd on_surface(TracedScene<>& traced, Draw& draw) {
  const auto triangle = static_cast<std::uint32_t>(draw.below(traced.scene.triangles().size()));
  const auto corners_m = traced.scene.corners_m(triangle);
  const double u = draw.between(0.1, 0.5), v = draw.between(0.1, 0.4);
  const Vec3 normal = traced.scene.facet(traced.scene.facet_of_triangle(triangle)).plane.normal;
  return traced.end(corners_m[0] + u * (corners_m[1] - corners_m[0]) + v * (corners_m[2] - corners_m[0]) +
                    draw.between(-1.5e-4, 1.5e-4) * normal);
}

LinkEnd on_car(TracedScene<>& traced, Draw& draw) {
  const BodyId car = *traced.scene.find_body("one");
  const Vec3 up_m(0, 0, draw.between(0.2, 1.6));
  return traced.end(traced.scene.body_state(car).placement.pose.position_m + up_m, car);
}

/// In the air, on a surface, or on a car.
LinkEnd some_end(TracedScene<>& traced, Draw& draw) {
  switch (draw.below(4)) {
    case 0:
      return on_surface(traced, draw);
    case 1:
      return on_car(traced, draw);
    default:
      return somewhere(traced, draw);
  }
}

/// Whether a link has the same paths by trying every sequence, without the lists and with them.
bool is_same_link(TracedScene<>& traced, const LinkEnd& from, const LinkEnd& to, const Asked& asked, bool lists_bodies,
                  Counts& counts) {
  Mast without(traced, from, asked, 64, lists_bodies), with(traced, from, asked, 64, lists_bodies);
  with.look_over_edges();
  const std::vector<SequenceList> all = without.proposed(to), fewer = with.proposed(to);
  const std::vector<Path> expected = all_sequences(traced, from, to, asked);
  counts.paths += expected.size();
  counts.before += all[0].size();
  counts.after += fewer[0].size();
  for (const auto& over_one : without.asked_for(to)) counts.asked_before += over_one.size();
  for (const auto& over_one : with.asked_for(to)) counts.asked_after += over_one.size();
  return same_paths(without.paths(to, all), expected) && same_paths(with.paths(to, fewer), expected);
}

/// The same of a crowd.
bool is_same_crowd(TracedScene<>& traced, const LinkEnd& from, const std::vector<Vec3>& points_m, const Asked& asked,
                   Counts& counts) {
  Mast without(traced, from, asked, 64, true), with(traced, from, asked, 64, true);
  with.look_over_edges();
  const auto all = without.found_by(points_m, counts.before), fewer = with.found_by(points_m, counts.after);
  bool is_same = true;
  for (std::size_t point = 0; point < points_m.size(); ++point) {
    const std::vector<Path> expected = all_sequences(traced, from, traced.end(points_m[point]), asked);
    is_same = is_same && same_paths(all[point], expected) && same_paths(fewer[point], expected);
    counts.paths += expected.size();
  }
  return is_same;
}

bool is_same_town_link(std::uint64_t seed, Counts& counts) {
  Draw draw(seed);
  TracedScene<> traced(large_town(draw));
  const LinkEnd from = some_end(traced, draw), to = some_end(traced, draw);
  const Asked asked{static_cast<int>(draw.below(3))};
  return is_same_link(traced, from, to, asked, draw.below(2) == 0, counts);
}

/// Sheets, houses and ends on a grid: mirrors hold edges in their planes, and walls touch edges.
bool is_same_grid_link(std::uint64_t seed, Counts& counts) {
  Draw draw(seed);
  TracedScene<> traced(town_on_grid(draw));
  Asked asked{static_cast<int>(draw.below(2))};
  asked.free_edges = true;
  const LinkEnd from = traced.end(point_on_grid(draw)), to = traced.end(point_on_grid(draw));
  return from.position_m == to.position_m || is_same_link(traced, from, to, asked, true, counts);
}

bool is_same_far_link(std::uint64_t seed, Counts& counts) {
  Draw draw(seed);
  TracedScene<> traced(small_town(draw));
  const LinkEnd from = far_away(traced, draw), to = some_end(traced, draw);
  return is_same_link(traced, from, to, {static_cast<int>(draw.below(3))}, true, counts);
}

bool is_same_town_crowd(std::uint64_t seed, Counts& counts) {
  Draw draw(seed);
  TracedScene<> traced(large_town(draw));
  const LinkEnd from = some_end(traced, draw);
  const Asked asked{static_cast<int>(draw.below(3))};
  const std::vector<Vec3> points_m = some_crowd(draw, 6.0, Vec3(-20, -20, 0.3), Vec3(20, 20, 10));
  return is_same_crowd(traced, from, points_m, asked, counts);
}

/// Checks every seed.
template <typename IsSame>
Counts check_seeds(std::uint64_t first, std::uint64_t end, IsSame&& is_same) {
  Counts counts;
  for (std::uint64_t seed = first; seed < end; ++seed) {
    CAPTURE(seed);
    CHECK(is_same(seed, counts));
  }
  MESSAGE(counts.paths << " paths of " << counts.before << " sequences, with lists of " << counts.after << "; "
                       << counts.asked_before << " parts asked about, with lists " << counts.asked_after);
  return counts;
}

}  // namespace

TEST_CASE("lists of what edges light change no path of a link, and spare questions") {
  const Counts counts = check_seeds(7000, 7080, is_same_town_link);
  CHECK(counts.paths > 300);
  CHECK(counts.after < counts.before);
  CHECK(3 * counts.asked_after < 2 * counts.asked_before);  // or the lists are not worth having
}

TEST_CASE("lists of what edges light change no path where mirrors hold edges and walls touch them") {
  CHECK(check_seeds(7200, 7300, is_same_grid_link).paths > 300);
}

TEST_CASE("lists of what edges light change no path from a transmitter far away") {
  CHECK(check_seeds(7400, 7440, is_same_far_link).paths > 100);
}

TEST_CASE("lists of what edges light change no path of a crowd, and spare sequences") {
  const Counts counts = check_seeds(7600, 7620, is_same_town_crowd);
  CHECK(counts.paths > 500);
  CHECK(counts.after < counts.before);
}

TEST_CASE("edges that are looked over a few at a time, or by several threads, are listed as all at once") {
  ThreadPool pool(3);
  for (std::uint64_t seed = 7800; seed < 7806; ++seed) {
    CAPTURE(seed);
    Draw draw(seed);
    TracedScene<> traced(large_town(draw));
    const LinkEnd from = somewhere(traced, draw), to = somewhere(traced, draw);
    const auto proposed = [&](double work_us, ThreadPool* threads, std::size_t least_times) {
      Mast mast(traced, from, {}, 64, true);
      CHECK(mast.look_over_edges(work_us, threads) >= least_times);
      return mast.proposed(to);
    };
    const std::vector<SequenceList> at_once = proposed(all_of_it, nullptr, 1);
    CHECK(at_once[0].size() > 0);
    CHECK(same_sequences(proposed(1.0, nullptr, 20)[0], at_once[0]));
    CHECK(same_sequences(proposed(600.0, nullptr, 10)[0], at_once[0]));
    CHECK(same_sequences(proposed(1.0, &pool, 20)[0], at_once[0]));
    CHECK(same_sequences(proposed(all_of_it, &pool, 1)[0], at_once[0]));
  }
}

TEST_CASE("no part is asked about that is not listed, not from where numbers count from either") {
  TriangleMesh mesh;
  add_sheet(mesh, Vec3(0.0), Vec3(20, 0, 0), Vec3(0, 20, 0), "opaque");
  add_box_faces(mesh, Vec3(-2, -1, 1), Vec3(2, 3, 5), "metal");
  add_box_faces(mesh, Vec3(3, -8, 1), Vec3(6, -4, 5), "metal");
  TracedScene<> traced(scene_of(mesh));
  const FacetId wall = traced.facet_at(Vec3(0.5, -1, 2.5), "metal");
  const Vec3 middle_m = FacetOutlines(traced.scene).middle_m();
  const LinkEnd from = traced.end(Vec3(-5, -4, 2)), to = traced.end(mirrored(traced.scene.facet(wall).plane, middle_m));
  REQUIRE(mirrored(traced.scene.facet(wall).plane, to.position_m) == middle_m);  // there is its image
  Mast mast(traced, from, {}, 64, true);
  mast.look_over_edges();
  const std::vector<EdgePart> listed = mast.parts();
  const auto count_in = [](const std::vector<EdgePart>& parts, const EdgePart& one) {
    return std::ranges::count_if(parts, [&](const EdgePart& part) {
      return part.edge == one.edge && part.from == one.from && part.to == one.to;
    });
  };
  std::size_t asked = 0, strange = 0;
  for (const std::vector<EdgePart>& parts : mast.asked_for(to)) {
    asked += parts.size();
    for (const EdgePart& part : parts) strange += count_in(listed, part) == 1 && count_in(parts, part) == 1 ? 0 : 1;
  }
  CHECK(asked > 0);
  REQUIRE(strange == 0);
  Counts counts;
  CHECK(is_same_link(traced, from, to, {}, true, counts));
}

TEST_CASE("until all edges are looked over nothing is said to be dark") {
  Draw draw(7900);
  TracedScene<> traced(large_town(draw));
  const LinkEnd from = somewhere(traced, draw), to = somewhere(traced, draw);
  Mast mast(traced, from, {}, 64, true);
  const std::vector<SequenceList> before = mast.proposed(to);
  REQUIRE_FALSE(mast.go_on_over_edges(1000.0));
  CHECK(same_sequences(mast.proposed(to)[0], before[0]));
  mast.look_over_edges(1000.0);
  CHECK(mast.proposed(to)[0].size() <= before[0].size());
}

}  // namespace test_edges_before_mirrors
