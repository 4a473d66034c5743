/// A frame that was given back leaves its room to the next one, and nothing else.
#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "dcem/sim/detail/frame_links.hpp"
#include "dcem/sim/detail/receiver_memory.hpp"
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
    "links stand by transmitter, then receiver, each receiver's at places of their own; those of a smaller frame leave "
    "nothing of a larger one, and what was at their places is their room") {
  ThreadPool pool(3);
  std::vector<LinkResult> room;
  std::size_t reused = 0;
  for (const std::size_t receivers : {150U, 90U, 3U, 0U, 120U, 130U}) {
    std::vector<std::vector<std::uint32_t>> lists(receivers);
    std::size_t count = 0;
    for (std::size_t receiver = 0; receiver < receivers; ++receiver) {
      const std::size_t step = receiver % 7 == 5 ? 100 : 1 + receiver % 2;  // some have one link, or none
      for (std::size_t transmitter = receiver % 7; transmitter < 100 - receiver % 7; transmitter += step) {
        lists[receiver].push_back(static_cast<std::uint32_t>(transmitter));
      }
      count += lists[receiver].size();
    }
    detail::FrameLinks links(lists, std::move(room), pool);
    for (std::size_t receiver = 0; receiver < receivers; ++receiver) {
      const detail::LinkSlots slots = links.of(receiver);
      REQUIRE(slots.size() == lists[receiver].size());
      for (std::size_t number = 0; number < slots.size(); ++number) {
        reused += slots[number].paths.empty() ? 0 : 1;
        slots[number] = {};
        slots[number].transmitter = lists[receiver][number];
        slots[number].receiver = receiver;
        slots[number].paths.resize(receiver % 4);
      }
    }
    std::vector<LinkResult> all = std::move(links).take();
    REQUIRE(all.size() == count);
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

TEST_CASE(
    "a frame in which nothing has changed takes direct paths over from the one before; of very many transmitters from "
    "the second such frame on") {
  for (const std::size_t devices : {std::size_t{12}, detail::very_many_transmitters}) {
    const bool are_very_many = devices > 12;
    CAPTURE(devices);
    const Scene scene = crowd(devices);
    SimulationSettings settings = direct_paths(2);
    settings.links.range_m = 30.0;
    Simulator simulator(scene, settings);
    Simulator expected(scene, with_cache(settings, CacheMode::off));
    REQUIRE(simulator.cache() == CacheMode::exact);
    const auto step = [&](double time_s, std::size_t index) {
      FrameResult result = simulator.advance_to(time_s, index);
      CHECK((bits(scene, result.links) == bits(scene, expected.advance_to(time_s, index).links)));
      return result;
    };
    CHECK(step(0.0, 0).work.legs > 0);
    CHECK(step(0.0, 1).work.legs == 0);
    CHECK(step(0.1, 2).work.legs > 0);
    const FrameResult moved = step(0.2, 3);
    CHECK(moved.work.legs > 0);
    const FrameResult still = step(0.2, 4);
    CHECK(still.work.legs == (are_very_many ? moved.work.legs : 0));
    CHECK(still.cache.born + still.cache.died == 0);
    const FrameResult still_again = step(0.2, 5);
    CHECK(still_again.work.legs == 0);
    CHECK(still_again.cache.taken_over == still_again.work.paths);
    CHECK(step(0.3, 6).work.legs > 0);
  }
}

TEST_CASE("each receiver is taken once, those with most links first") {
  const std::vector<std::vector<std::uint32_t>> chosen{{1}, {}, {1, 2, 3}, {4, 5}, {7}};
  CHECK(detail::busiest_first(chosen) == std::vector<std::size_t>{2, 3, 0, 4, 1});
  const std::vector<std::vector<std::uint32_t>> alike(3, {0});
  CHECK(detail::busiest_first(alike) == std::vector<std::size_t>{0, 1, 2});
  CHECK(detail::busiest_first({}).empty());
  std::vector<std::vector<std::uint32_t>> very_many(5000);
  very_many.back().push_back(0);
  const std::vector<std::size_t> many = detail::busiest_first(very_many);
  for (std::size_t place = 0; place < many.size(); ++place) REQUIRE(many[place] == place);
}

}  // namespace test_frame_room
