/// What an end lists over its mirrors: the same whether it is listed at once or a little at a time.
#include "dcem/paths/halves/beam_lists.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "dcem/core/thread_pool.hpp"
#include "tests/paths/halves/small_town.hpp"

namespace test_beam_lists {

using namespace dcem;
using namespace dcem::test;

namespace {

/// An end in a scene, and what it sees.
struct Mast {
  Mast(const TracedScene<>& of, const LinkEnd& end) : traced(of), half(64) {
    half.find_scenery(traced.scene, outlines, end, settings);
    half.find_bodies(traced.scene, outlines, settings);
    half.settle();
  }
  BeamSource source(ThreadPool* pool) const { return {traced.scene, outlines, lanes, half, settings, true, pool}; }
  /// Lists that grow by so much at a time, and how often they had to.
  std::pair<BeamLists, std::size_t> lists(double work_us, ThreadPool* pool = nullptr) const {
    BeamLists lists;
    lists.begin_scenery(source(pool));
    std::size_t times = 1;
    for (double left_us = work_us; !lists.go_on(source(pool), left_us); left_us = work_us) ++times;
    return {std::move(lists), times};
  }

  const TracedScene<>& traced;
  HalfSettings settings{};
  FacetOutlines outlines{traced.scene};
  LaneScene lanes{traced.scene, outlines};
  PathHalf half;
};

/// All that is listed of the scenery, as numbers.
std::vector<float> numbers_in(const Scene& scene, const BeamLists& lists) {
  std::vector<float> numbers;
  const BeamTable& table = lists.tables()[BeamLists::of_scenery];
  for (std::uint32_t facet = 0; facet < scene.facets().size(); ++facet) {
    for (const std::uint32_t mirror : table.mirrors_before(FacetId(facet))) {
      numbers.insert(numbers.end(), {static_cast<float>(facet), static_cast<float>(mirror)});
    }
  }
  const auto note = [&](const EdgePart& part, std::uint32_t mirror) {
    numbers.insert(numbers.end(), {static_cast<float>(part.edge), part.from, part.to, static_cast<float>(mirror)});
  };
  for (const EdgePart& part : table.parts()) note(part, 0);
  for (const std::uint32_t edge : table.lit_edges()) table.for_each_lit_part(WedgeId(edge), note);
  return numbers;
}

}  // namespace

TEST_CASE("lists that are made a little at a time, or by several threads, are those that are made at once") {
  ThreadPool pool(3);
  std::size_t listed = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    CAPTURE(seed);
    Draw draw(seed);
    TracedScene<> traced(small_town(draw));
    const Mast mast(traced, traced.end(draw.inside(Vec3(-25, -25, 0.5), Vec3(25, 25, 20))));
    BeamLists at_once;
    at_once.find_scenery(mast.source(nullptr));
    const std::vector<float> expected = numbers_in(traced.scene, at_once);
    listed += expected.size();
    const auto [slow, times] = mast.lists(1.0);
    CHECK(times >= at_once.mirrors().size());
    CHECK(numbers_in(traced.scene, slow) == expected);
    const auto [quick, fewer] = mast.lists(500.0, &pool);
    CHECK(fewer <= times);
    CHECK(numbers_in(traced.scene, quick) == expected);
  }
  CHECK(listed > 10'000);
}

TEST_CASE("an edge of which all shows is listed whole, and one that is hidden half not beyond") {
  TriangleMesh mesh;
  add_sheet(mesh, Vec3(0.0), Vec3(40, 0, 0), Vec3(0, 40, 0), "opaque");
  add_box_faces(mesh, Vec3(8, -6, 0), Vec3(10, 6, 8), "metal");
  add_box_faces(mesh, Vec3(4, 0, 0), Vec3(5, 40, 20), "metal");  // hides the half at y > 0 from an end at y = 0
  TracedScene<> traced(scene_of(mesh));
  const Mast mast(traced, traced.end(Vec3(-10, 0, 5)));
  BeamLists lists;
  lists.find_scenery(mast.source(nullptr));
  const BeamTable& table = lists.tables()[BeamLists::of_scenery];
  std::size_t looked_at = 0;
  for (const EdgePart& part : table.parts()) {
    const Wedge& edge = traced.scene.wedge(WedgeId(part.edge)).edge;
    const auto lies_at = [](const Vec3& point_m) { return point_m.x == 8.0 && point_m.z == 8.0; };
    if (!lies_at(edge.start_m) || !lies_at(edge.end_m)) continue;
    ++looked_at;
    const Vec3 along = edge_direction(edge);
    const double from_m = (edge.start_m + static_cast<double>(part.from) * along).y,
                 to_m = (edge.start_m + static_cast<double>(part.to) * along).y;
    // From the end, x = 4 and 5 hide y > 0; a pixel of the view is 0.6 m wide there, and a piece no longer.
    CHECK(std::min(from_m, to_m) == doctest::Approx(-6.0));
    CHECK(std::max(from_m, to_m) >= 0.0);
    CHECK(std::max(from_m, to_m) <= 1.5);
  }
  CHECK(looked_at == 1);
}

}  // namespace test_beam_lists
