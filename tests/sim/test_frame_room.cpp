/// A frame that was given back leaves its room to the next one, and nothing else.
#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "dcem/sim/detail/gather_links.hpp"
#include "dcem/sim/simulator.hpp"
#include "tests/support/memory_trial.hpp"

namespace test_frame_room {

using namespace dcem;
using namespace dcem::test;

namespace {

constexpr std::size_t frames = 4;

/// Of so many devices each has links with all others; they move, and some ride on cars that block.
Scene crowd(std::size_t devices) {
  Scene scene;
  scene.add_material({"metal", PerfectConductor{}});
  TriangleMesh ground;
  add_quad(ground, {Vec3(-80, -80, 0), {80, -80, 0}, {80, 80, 0}, {-80, 80, 0}}, "metal");
  scene.set_scenery(ground);
  for (std::size_t index = 0; index < devices; ++index) {
    const Vec3 from_m(-60.0 + 9.0 * static_cast<double>(index % 12), -40.0 + 8.0 * static_cast<double>(index / 12),
                      0.1);
    const std::string name = "car" + std::to_string(index);
    scene.add_object(name, make_box(Vec3(4.4, 1.8, 1.5), "metal"),
                     straight_way(frames, from_m, from_m + Vec3(5, 1, 0)));
    scene.add_transceiver(riding_device(name, name, Vec3(0, 0, 1.6)));
  }
  return scene;
}

SimulationSettings direct_paths(unsigned threads) {
  SimulationSettings settings = memory_settings({1, 0, 0, 0});
  settings.threads = threads;
  return settings;
}

}  // namespace

TEST_CASE("frames from room that was given back are those of fresh memory, for any number of threads") {
  for (const std::size_t devices : {std::size_t{12}, std::size_t{96}}) {
    const Scene scene = crowd(devices);
    Simulator fresh(scene, direct_paths(1));
    for (const unsigned threads : {1U, 2U, 5U}) {
      Simulator simulator(scene, direct_paths(threads));
      for (std::size_t index = 0; index < frames; ++index) {
        const double time_s = 0.1 * static_cast<double>(index);
        FrameResult result = simulator.advance_to(time_s, index);
        const FrameResult expected = fresh.advance_to(time_s, index);
        CHECK(result.links.size() == devices * (devices - 1) / 2);
        CHECK((bits(scene, result.links) == bits(scene, expected.links)));
        simulator.give_back(std::move(result));
      }
    }
  }
}

TEST_CASE(
    "links are gathered by transmitter, then receiver; those of a smaller frame leave nothing of a larger one, "
    "and what was in their place goes to the receivers") {
  ThreadPool pool(3);
  std::vector<LinkResult> room;
  std::size_t reused = 0;
  for (const std::size_t receivers : {150U, 90U, 3U, 0U, 120U}) {
    std::vector<std::vector<LinkResult>> by_receiver(receivers);
    std::size_t count = 0;
    for (std::size_t receiver = 0; receiver < receivers; ++receiver) {
      for (std::size_t transmitter = receiver % 3; transmitter < 100; transmitter += 1 + receiver % 2) {
        LinkResult& link = by_receiver[receiver].emplace_back();
        link.transmitter = transmitter;
        link.receiver = receiver;
        link.paths.resize(receiver % 4);
        ++count;
      }
    }
    const std::size_t held = room.size();
    std::vector<LinkResult> all = detail::gather_links(by_receiver, std::move(room), pool);
    REQUIRE(all.size() == count);
    std::size_t left = 0;
    for (const std::vector<LinkResult>& links : by_receiver) {
      left += links.size();
      for (const LinkResult& link : links) reused += link.paths.empty() ? 0 : 1;
    }
    CHECK(left == (held == 0 ? 0 : count));
    for (std::size_t link = 0; link < count; ++link) {
      REQUIRE(all[link].paths.size() == all[link].receiver % 4);
      if (link == 0) continue;
      const auto ends_of = [&](std::size_t at) { return std::pair(all[at].transmitter, all[at].receiver); };
      REQUIRE(ends_of(link - 1) < ends_of(link));
    }
    room = detail::room_of(std::move(all), pool);
    for (const LinkResult& link : room) REQUIRE(link.paths.capacity() <= detail::paths_kept_as_room);
  }
  CHECK(reused > 1000);  // or no room has gone round
}

TEST_CASE("each receiver is taken once, those with most links first") {
  const std::vector<std::vector<std::uint32_t>> chosen{{1}, {}, {1, 2, 3}, {4, 5}, {7}};
  CHECK(detail::busiest_first(5, chosen) == std::vector<std::size_t>{2, 3, 0, 4, 1});
  CHECK(detail::busiest_first(3, {}) == std::vector<std::size_t>{0, 1, 2});
  CHECK(detail::busiest_first(0, {}).empty());
  const std::vector<std::size_t> many = detail::busiest_first(5000, std::vector<std::vector<std::uint32_t>>(5000));
  for (std::size_t place = 0; place < many.size(); ++place) REQUIRE(many[place] == place);
}

}  // namespace test_frame_room
