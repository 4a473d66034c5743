/// What is remembered of a receiver's links, as the choice of links changes.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "dcem/sim/detail/frame_change.hpp"
#include "dcem/sim/detail/receiver_memory.hpp"
#include "tests/support/memory_trial.hpp"

namespace test_receiver_memory {

using namespace dcem;
using namespace dcem::test;
using Numbers = std::vector<std::uint32_t>;

namespace {

/// A link over each of the first facets by itself, the direct path instead of the first one.
LinkResult link_over(std::size_t paths) {
  LinkResult link;
  link.paths.resize(paths);
  for (std::size_t index = 1; index < paths; ++index) {
    link.paths[index].path.interactions.push_back({InteractionKind::reflection, FacetId(index)});
  }
  return link;
}

/// Gives each link as many paths as its transmitter's number says; of every other one no more is remembered than these.
void solve(detail::ReceiverMemory& memory) {
  for (std::size_t place = 0; place < memory.links.size(); ++place) {
    const LinkResult link = link_over(memory.numbers[place]);
    memory.numbers[place] % 2 == 0 ? memory.links[place].keep(link) : memory.links[place].keep_paths(link);
  }
}

}  // namespace

TEST_CASE("links keep what is known of them as others come and go, and what is gone is counted once") {
  detail::ReceiverMemory memory;
  CHECK(memory.select(Numbers{1, 4, 7}, 3) == 0);
  solve(memory);
  CHECK(memory.select(Numbers{1, 4, 7}, 3) == 0);  // the same
  CHECK(memory.link(4).result->paths.size() == 4);
  CHECK(memory.select(Numbers{1, 4, 8}, 3) == 7);  // as many, but others
  CHECK(memory.link(8).path_count() == 0);
  solve(memory);
  CHECK(memory.select(Numbers{0, 4, 5, 9}, 4) == 9);  // 1 and 8 are gone
  CHECK(memory.links.size() == 4);
  CHECK(memory.link(4).result->paths.size() == 4);
  for (const std::size_t fresh : {0U, 5U, 9U}) CHECK(memory.link(fresh).path_count() == 0);
  solve(memory);
  CHECK(detail::path_count(memory.links) == 18);
  CHECK(memory.select(Numbers{}, 0) == 18);
  CHECK(memory.links.empty());
  CHECK(memory.select(Numbers{3}, 1) == 0);
  CHECK(memory.link(3).path_count() == 0);
}

TEST_CASE("births and deaths are the same, whether links are remembered or their paths alone") {
  for (std::size_t before = 0; before < 6; ++before) {
    for (std::size_t now = 0; now < 6; ++now) {
      for (const bool first_is_gone : {false, true}) {
        LinkResult link = link_over(now);
        if (first_is_gone && now > 0) link.paths.erase(link.paths.begin());
        const std::size_t present = link.paths.size(), gone = now - present;
        const std::size_t kept = std::min(before, now) - std::min(before, gone);
        for (const bool whole : {false, true}) {
          detail::LinkMemory memory;
          whole ? memory.keep(link_over(before)) : memory.keep_paths(link_over(before));
          CacheCounters counters;
          memory.count_births(link, counters);
          CHECK(counters.born == present - kept);
          CHECK(counters.died == before - kept);
        }
      }
    }
  }
}

TEST_CASE("a direct path that a pane comes before, or leaves, is the same path") {
  LinkResult open = link_over(1), through_pane = link_over(1);
  through_pane.paths[0].path.interactions.push_back({InteractionKind::transmission, FacetId(3)});
  for (const bool whole : {false, true}) {
    for (const bool comes : {false, true}) {
      const LinkResult& before = comes ? open : through_pane;
      detail::LinkMemory memory;
      whole ? memory.keep(before) : memory.keep_paths(before);
      CacheCounters counters;
      memory.count_births(comes ? through_pane : open, counters);
      CHECK(counters.born + counters.died == 0);
    }
  }
}

TEST_CASE("where bodies are many, only who stays in a place for long is followed through places") {
  CHECK(detail::longest_pooled_step_m(0) == 2.0);
  CHECK(detail::longest_pooled_step_m(20) >= 1.4);    // a street with some cars, at 50 km/h
  CHECK(detail::longest_pooled_step_m(190) >= 1.4);   // a town full of them
  CHECK(detail::longest_pooled_step_m(500) >= 0.14);  // a jam: who walks
  CHECK(detail::longest_pooled_step_m(500) < 1.0);    // and not who drives
  for (std::size_t bodies = 0; bodies < 500; ++bodies) {
    REQUIRE(detail::longest_pooled_step_m(bodies + 1) <= detail::longest_pooled_step_m(bodies));
  }
}

TEST_CASE("bodies that are there are counted, whether they move or not, and the scenery is none") {
  Scene scene;
  scene.add_material({"metal", PerfectConductor{}});
  TriangleMesh ground;
  add_quad(ground, {Vec3(-9, -9, 0), {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}}, "metal");
  scene.set_scenery(ground);
  for (const char* name : {"a", "b", "c"}) {
    scene.add_object(name, make_box(Vec3(1.0), "metal"), straight_way(3, Vec3(0, 0, 1), Vec3(2, 0, 1)));
  }
  detail::FrameChange change(scene, true);
  Frame now = scene.frame_at(0.0), next = now;
  change.note(now, next);
  CHECK(change.bodies_there() == 3);
  CHECK(!change.any());
  next.bodies[2].present = false;
  change.note(now, next);
  CHECK(change.bodies_there() == 2);
  CHECK(change.any_moved());
  CHECK(!change.boxes().empty());
  detail::FrameChange without(scene, false);
  without.note(now, next);
  CHECK(without.any_moved());
  CHECK(without.boxes().empty());
}

}  // namespace test_receiver_memory
