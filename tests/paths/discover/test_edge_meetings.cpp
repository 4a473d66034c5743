/// Joining two ends at the edges that both reach refuses most chains, and none that carries a path.
#include "dcem/paths/discover/edge_meetings.hpp"

#include <doctest/doctest.h>

#include <cstdint>
#include <set>

#include "tests/paths/halves/small_town.hpp"

namespace test_edge_meetings {

using namespace dcem;
using namespace dcem::test;

TEST_CASE("no path over one edge is lost, and few chains are left") {
  std::size_t paths = 0, chains = 0, proposed = 0, over_mirrors = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    CAPTURE(seed);
    Draw draw(47'000 + seed);
    TracedScene<> traced(draw.below(3) == 0 ? town_on_grid(draw) : small_town(draw));
    const bool on_grid = draw.below(3) == 0;  // in planes of walls, above edges
    const auto place = [&](const Vec3& point_m) { return on_grid ? glm::round(point_m) + Vec3(0, 0, 0.5) : point_m; };
    const LinkEnd from = traced.end(place(draw.inside(Vec3(-25, -25, 0.5), Vec3(25, 25, 14))));
    const LinkEnd to = traced.end(place(draw.inside(Vec3(-25, -25, 0.5), Vec3(25, 25, 3))));
    PathSearchSettings settings;
    settings.edges.free_edges = draw.below(2) == 0;
    settings.max_reflections = static_cast<int>(3 - draw.below(4));
    settings.max_diffractions = 1;
    settings.max_interactions = 3 - static_cast<int>(draw.below(2));
    settings.max_transmissions = 0;
    EdgeReach near = reach_of(traced, to, settings), far = reach_of(traced, from, settings);
    const ReachedEdges near_edges = near.edges(), far_edges = far.edges();
    const ChainLimits limits = chain_limits(settings);
    SequenceList list;
    EdgeMeetings().join(traced.scene, limits, {to.position_m, near_edges}, {from.position_m, far_edges}, list);
    std::set<Sequence> joined;
    for (std::size_t number = 0; number < list.size(); ++number) {
      joined.emplace(list[number].begin(), list[number].end());
    }
    CHECK(joined.size() == list.size());  // each once
    std::size_t known = 0;
    PathSolver<WideIndex> solver(traced.tracer, 0, settings.edges);
    ChainJoiner(traced.scene, limits).for_each_chain(near_edges, far_edges, [&](const Sequence& chain) {
      ++chains;
      known += joined.contains(chain) ? 1U : 0U;
      if (!solver.solve(from, to, chain)) return;
      ++paths;
      over_mirrors += chain.size() == 3 ? 1U : 0U;
      CHECK(joined.contains(chain));
    });
    CHECK(known == joined.size());  // and no other
    proposed += list.size();
  }
  MESSAGE(paths << " paths, " << over_mirrors << " over two mirrors; " << proposed << " of " << chains
                << " chains proposed");
  CHECK(paths > 300);
  CHECK(over_mirrors > 50);
  CHECK(proposed * 8 < chains);
  CHECK(proposed < 6 * paths);  // 5.4: without any one of the gates 6.4 or more
}

}  // namespace test_edge_meetings
