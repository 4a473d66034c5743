/// Joining two ends over two edges refuses most pairs, and none that carries a path.
#include "dcem/paths/discover/half_pairs.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>
#include <vector>

#include "tests/paths/halves/small_town.hpp"

namespace test_half_pairs {

using namespace dcem;
using namespace dcem::test;

namespace {

struct Joined {
  std::set<Sequence> chains;
  std::size_t count = 0;
  PairCounters work;
};

Joined join(const Scene& scene, const ChainLimits& limits, const ReachingEnd& receiver,
            const ReachingEnd& transmitter) {
  Joined joined;
  SequenceList list;
  join_edge_pairs(scene, limits, receiver, transmitter, list, joined.work);
  joined.count = list.size();
  for (std::size_t number = 0; number < list.size(); ++number) {
    joined.chains.emplace(list[number].begin(), list[number].end());
  }
  return joined;
}

bool are_over_two_edges(const Sequence& chain) {
  return edge_count(chain) == 2;
}

}  // namespace

TEST_CASE("half pairs: no path over two edges is lost, and few pairs are left") {
  std::size_t paths = 0, pairs = 0, proposed = 0, over_mirrors = 0;
  for (std::uint64_t seed = 1; seed <= 25; ++seed) {
    CAPTURE(seed);
    Draw draw(33'000 + seed);
    TracedScene<> traced(small_town(draw));
    const LinkEnd from = traced.end(draw.inside(Vec3(-25, -25, 0.5), Vec3(25, 25, 14)));
    const LinkEnd to = traced.end(draw.inside(Vec3(-25, -25, 0.5), Vec3(25, 25, 3)));
    PathSearchSettings settings;
    settings.max_reflections = 1;
    settings.max_diffractions = 2;
    settings.max_interactions = 3;
    settings.max_transmissions = 0;
    EdgeReach near = reach_of(traced, to, settings), far = reach_of(traced, from, settings);
    for (const EdgeReach::Edge& edge : near.edges()) {
      for (std::uint32_t facet = 0; facet < traced.scene.facets().size(); ++facet) {
        near.note_view(edge.id, FacetId(facet));
      }
    }
    const ReachedEdges near_edges = near.edges(), far_edges = far.edges();
    const Joined joined =
        join(traced.scene, chain_limits(settings), {to.position_m, near_edges}, {from.position_m, far_edges});
    CHECK(joined.chains.size() == joined.count);  // each once
    CHECK(std::all_of(joined.chains.begin(), joined.chains.end(), are_over_two_edges));
    PathSolver<WideIndex> solver(traced.tracer, 0);
    ChainJoiner all(traced.scene, chain_limits(settings));
    all.for_each_chain(near_edges, far_edges, [&](const Sequence& chain) {
      if (!are_over_two_edges(chain)) return;
      ++pairs;
      if (!solver.solve(from, to, chain)) return;
      ++paths;
      over_mirrors += !chain[1].is_edge() && chain.size() == 3 && chain[0].is_edge() ? 1U : 0U;
      CHECK(joined.chains.contains(chain));
    });
    proposed += joined.count;
  }
  MESSAGE(paths << " paths, " << over_mirrors << " with a mirror between; " << proposed << " of " << pairs
                << " pairs proposed");
  CHECK(paths > 1000);
  CHECK(over_mirrors > 100);
  CHECK(proposed * 8 < pairs);
}

TEST_CASE("half pairs: edges are refused by the boxes around them, many at once") {
  // Two ends before a house; far behind it, lower than its roof, rows of small houses that the transmitter reaches.
  TriangleMesh mesh;
  add_box_faces(mesh, Vec3(-4, -4, 0), Vec3(4, 4, 10), "metal");
  for (int row = 0; row < 12; ++row) {
    for (int column = 0; column < 12; ++column) {
      const Vec3 low_m(100.0 + 6.0 * column, 6.0 * row - 30.0, 0.0);
      add_box_faces(mesh, low_m, low_m + Vec3(3, 3, 3), "metal");
    }
  }
  TracedScene<> traced(scene_of(mesh));
  EdgeReach near, far;
  for (std::uint32_t id = 0; id < traced.scene.wedges().size(); ++id) {
    const Wedge& edge = traced.scene.wedge(WedgeId(id)).edge;
    (std::max(edge.start_m.x, edge.end_m.x) < 50.0 ? near : far).add({}, WedgeId(id));
  }
  const ReachedEdges near_edges = near.edges(), far_edges = far.edges();
  const Joined joined = join(traced.scene, {0, 2, 2}, {Vec3(-20, 1, 1), near_edges}, {Vec3(130, 1, 20), far_edges});
  const std::size_t pairs = near_edges.size() * far_edges.size();
  MESSAGE(near_edges.size() << " and " << far_edges.size() << " edges: " << joined.work.boxes_asked << " boxes, "
                            << joined.work.packs_asked << " packs, " << joined.count << " pairs left of " << pairs);
  CHECK(joined.work.boxes_asked * 40 < pairs);
  CHECK(joined.work.packs_asked * 60 < pairs);
  CHECK(joined.count * 20 < pairs);
}

}  // namespace test_half_pairs
