/// What receivers remember from frame to frame asks for memory while it grows, and no more once as much comes as goes.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "dcem/paths/discover/path_cache.hpp"
#include "dcem/paths/discover/ray_launcher.hpp"
#include "dcem/paths/path_finder.hpp"
#include "tests/paths/halves/small_town.hpp"
#include "tests/paths/sequences.hpp"
#include "tests/support/counted_allocations.hpp"

namespace test_steady_memory {

using namespace dcem;
using namespace dcem::test;
using dcem_test::allocations;

namespace {

/// What `action` allocates from its `after`-th call on, of `calls`.
template <typename Action>
std::size_t allocated(std::size_t after, std::size_t calls, Action&& action) {
  std::size_t before = allocations;
  for (std::size_t call = 0; call < calls; ++call) {
    if (call == after) before = allocations;
    action(call);
  }
  return allocations - before;
}

}  // namespace

TEST_CASE("proposals and edges within reach come and go in the room of those before") {
  ProposalMemory proposals;
  EdgeReach reach;
  std::vector<Sequence> drawn;
  for (std::size_t number = 0; number < 400; ++number) drawn.push_back(over({number % 9, number, number / 2}));
  std::size_t listed = 0;
  const std::size_t spent = allocated(40, 400, [&](std::size_t frame) {
    for (std::size_t number = 0; number < 50; ++number) {
      const Sequence& sequence = drawn[(frame * 7 + number) % drawn.size()];
      proposals.note(sequence);
      reach.add(sequence, WedgeId((frame + number) % 120));
      reach.note_view(WedgeId((frame + number) % 120), FacetId(number));
    }
    proposals.next_frame(5);
    reach.next_frame(5);
    for (const EdgeReach::Edge& edge : reach.edges()) listed += edge.mirrors.size();
  });
  CHECK(listed > 400 * 50);
  CHECK(spent == 0);
}

TEST_CASE("the sequences of links are written anew in the room of the list before the last") {
  std::vector<Path> paths(60);
  for (std::size_t number = 0; number < paths.size(); ++number) {
    paths[number].interactions.push_back({InteractionKind::reflection, FacetId(number), {}});
  }
  PathCache cache;
  const std::size_t spent = allocated(2, 50, [&](std::size_t frame) {
    cache.begin_frame(3);
    for (std::size_t link = 0; link < 3; ++link) {
      cache.remember(link, std::span(paths).first(frame < 2 || (frame + link) % 2 == 1 ? 60 : 55));
    }
  });
  CHECK(cache.sequences(2)->size() >= 55);
  CHECK(spent == 0);
}

TEST_CASE("rays that leave again ask for nothing") {
  Draw draw(52'003);
  TracedScene<> traced(small_town(draw));
  const LinkEnd receiver = traced.end(Vec3(18, 4, 1.5));
  RayLauncher<WideIndex> launcher(traced.tracer, {2000, 2, 2});
  std::size_t sequences = 0;
  const std::size_t spent = allocated(1, 4, [&](std::size_t) {
    launcher.for_each_sequence(receiver, Mat3(1.0), [&](const Sequence&, const std::vector<Vec3>&) { ++sequences; });
  });
  CHECK(sequences > 40);
  CHECK(spent == 0);
}

TEST_CASE("joining two ends asks for nothing, and solving for the paths that there are alone") {
  Draw draw(52'001);
  TracedScene<> traced(small_town(draw));
  const LinkEnd from = traced.end(Vec3(-20, 3, 9));
  const std::vector<LinkEnd> receivers{traced.end(Vec3(18, 4, 1.5)), traced.end(Vec3(19, -6, 1.5))};
  PathSearchSettings settings;
  settings.max_reflections = 2;
  settings.max_diffractions = 1;
  settings.max_interactions = 3;
  settings.max_transmissions = 0;
  EdgeReach far = reach_of(traced, from, settings);
  std::vector<EdgeReach> near;
  for (const LinkEnd& receiver : receivers) near.push_back(reach_of(traced, receiver, settings));
  JoinRoom room;
  PathSolver<WideIndex> solver(traced.tracer, 0);
  Sequence sequence;
  std::size_t chains = 0, paths = 0;
  const std::size_t spent = allocated(4, 20, [&](std::size_t frame) {
    const std::size_t receiver = frame % receivers.size();
    room.chains.clear();
    room.meetings.join(traced.scene, chain_limits(settings), {receivers[receiver].position_m, near[receiver].edges()},
                       {from.position_m, far.edges()}, room.chains);
    for (std::size_t number = 0; number < room.chains.size(); ++number) {
      sequence.assign(room.chains[number].begin(), room.chains[number].end());
      const std::optional<Path> path = solver.solve(from, receivers[receiver], sequence);
      if (frame < 4) continue;
      ++chains;
      paths += path ? 1U : 0U;
    }
  });
  MESSAGE(paths << " paths of " << chains << " chains, " << spent << " allocations");
  CHECK(paths > 40);
  CHECK(chains > 2 * paths);
  CHECK(spent == paths);  // the list of what each has met
}

}  // namespace test_steady_memory
