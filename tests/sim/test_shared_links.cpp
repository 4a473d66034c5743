/// The links of a receiver are shared among threads: the bits of each are the same for any number of them, whatever is
/// remembered, however ends and bodies come and go, and one receiver's work falls into as many parts as it has links.
#include <doctest/doctest.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "dcem/core/work_times.hpp"
#include "tests/paths/halves/small_town.hpp"
#include "tests/support/all_tests.hpp"
#include "tests/support/memory_trial.hpp"

namespace test_shared_links {

using namespace dcem;
using namespace dcem::test;

namespace {

constexpr std::size_t frames = 9, senders = 11;

/// A small town with cars; many transmitters, of which some stand, some walk and some ride, and few receivers.
Scene town_of_senders(std::uint64_t seed, std::size_t receivers) {
  Draw draw(seed);
  Scene scene = small_town(draw);
  for (const std::string name : {"first", "second"}) {
    TriangleMesh car;
    add_box_faces(car, Vec3(-2, -0.9, 0.1), Vec3(2, 0.9, 1.5), "metal");
    const double side = name == "first" ? 1.0 : -1.0;
    scene.add_object(name, car, straight_way(frames, Vec3(-14 * side, 2 * side, 0), Vec3(10 * side, side, 0)));
  }
  for (std::size_t number = 0; number < senders; ++number) {
    const std::string id = "sender" + std::to_string(number);
    const Vec3 at_m = draw.inside(Vec3(-18, -18, 1), Vec3(18, 18, 12));
    if (number % 4 == 1) scene.add_transmitter(moving_device(id, straight_way(frames, at_m, at_m + Vec3(1, 0.5, 0))));
    if (number % 4 == 3) scene.add_transmitter(riding_device(id, number == 3 ? "first" : "second", Vec3(0, 0, 1.6)));
    if (number % 2 == 0) scene.add_transmitter(device_at(id, at_m, 30.0));
  }
  scene.add_receiver(moving_device("walker", straight_way(frames, Vec3(-6, 3, 1.5), Vec3(-4.5, 3.3, 1.5))));
  if (receivers > 1) scene.add_receiver(device_at("post", Vec3(5, -3, 1.3)));
  if (receivers > 2) scene.add_receiver(riding_device("passenger", "first", Vec3(0.2, 0, 1.7)));
  return scene;
}

/// What all frames of a drive say; in some of them a car is away, two are as the one before.
std::vector<std::string> drive(const Scene& scene, SimulationSettings settings, unsigned threads) {
  settings.threads = threads;
  Simulator simulator(scene, settings);
  std::vector<std::string> told;
  for (std::size_t index = 0; index < frames; ++index) {
    Frame frame = scene.frame_at(index == 5 ? 4.0 : static_cast<double>(index), index);
    if (index == 3 || index == 4) frame.bodies[1].present = false;
    if (index == 7) frame.bodies[2].present = false;
    const FrameResult result = simulator.advance(frame);
    const CacheCounters& cache = result.cache;
    told.push_back(bits(scene, result.links) + " born " + std::to_string(cache.born) + " died " +
                   std::to_string(cache.died) + " kept " + std::to_string(cache.taken_over + cache.reused) + " gone " +
                   std::to_string(cache.expired) + " work " + std::to_string(work_of(result)) + ' ' +
                   std::to_string(result.work.sequences_proposed) + ' ' + std::to_string(result.work.paths) + ' ' +
                   std::to_string(result.work.nodes_visited) + ' ' + std::to_string(result.work.diffuse_tiles));
  }
  return told;
}

void check_threads(const Scene& scene, const SimulationSettings& settings) {
  const std::vector<std::string> alone = drive(scene, settings, 1);
  for (const unsigned threads : {2U, 5U}) {
    CAPTURE(threads);
    const std::vector<std::string> shared = drive(scene, settings, threads);
    for (std::size_t frame = 0; frame < frames; ++frame) {
      CAPTURE(frame);
      CHECK((shared[frame] == alone[frame]));  // not shown: thousands of bytes
    }
  }
}

}  // namespace

TEST_CASE("one receiver and many transmitters: the same for any number of threads, remembered or not") {
  for (const MemoryOrders& orders : {MemoryOrders{2, 0, 1, 2}, {2, 1, 0, 2}, {1, 0, 2, 2}, {2, 0, 1, 3}}) {
    for (const CacheMode cache : {CacheMode::exact, CacheMode::off}) {
      CAPTURE(orders.interactions);
      for (const std::size_t receivers : all_or<std::vector<std::size_t>>({1, 3}, {3})) {
        check_threads(town_of_senders(7 + receivers, receivers), with_cache(memory_settings(orders), cache));
      }
    }
  }
}

TEST_CASE("so with links that a range or pairs choose, among them some that come and go") {
  const Scene scene = town_of_senders(21, 3);
  SimulationSettings by_range = memory_settings({2, 0, 1, 2}), by_pairs = by_range;
  by_range.links.range_m = 17.0;
  auto& pairs = by_pairs.links.pairs.emplace();
  for (std::size_t number = 0; number < senders; number += 2) {
    pairs.emplace_back("sender" + std::to_string(number), number % 3 == 0 ? "post" : "walker");
  }
  for (const CacheMode cache : {CacheMode::exact, CacheMode::off}) {
    check_threads(scene, with_cache(by_range, cache));
    check_threads(scene, with_cache(by_pairs, cache));
  }
}

TEST_CASE("so with diffuse power, and where rays look for paths") {
  const Scene scene = town_of_senders(22, 2);
  SimulationSettings diffuse = memory_settings({1, 0, 0, 1}), sampled = memory_settings({3, 0, 1, 4});
  diffuse.propagation.diffuse.enabled = true;
  sampled.propagation.discovery = Discovery::sampled;
  sampled.propagation.rays = 300;
  check_threads(scene, with_cache(diffuse, CacheMode::exact));
  check_threads(scene, with_cache(diffuse, CacheMode::off));
  check_threads(scene, with_cache(sampled, CacheMode::seed));
}

TEST_CASE("what threads share is what each link alone would be: against a search from scratch") {
  SimulationSettings settings = memory_settings({2, 0, 1, 2});
  settings.threads = 5;
  MemoryTrial trial(town_of_senders(23, 3), settings);
  trial.follow(frames);
  CHECK(trial.tally().different == 0);
  CHECK(trial.tally().paths > trial.tally().frames);
}

TEST_CASE("the work of one receiver falls into at least as many parts as it has links") {
  const Scene scene = town_of_senders(24, 1);
  for (const CacheMode cache : {CacheMode::exact, CacheMode::off}) {
    SimulationSettings settings = with_cache(memory_settings({2, 0, 1, 2}), cache);
    settings.propagation.discovery = Discovery::exact;
    for (const unsigned threads : {1U, 2U}) {
      settings.threads = threads;
      Simulator simulator(scene, settings);
      const bool tries_all = simulator.plan().joined == 0;  // sequences are then tried on all links in one go
      for (std::size_t index = 0; index < frames; ++index) {
        const WorkTimes before = work_times();
        const std::size_t links = simulator.advance(scene.frame_at(static_cast<double>(index), index)).links.size();
        CHECK(links == senders);
        if (!tries_all) CHECK((work_times() - before).tasks >= links);
      }
    }
  }
}

}  // namespace test_shared_links
