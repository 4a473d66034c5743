/// What a frame says of paths that came and went, held against the paths that there are.
#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include "dcem/core/random.hpp"
#include "dcem/sim/simulator.hpp"
#include "tests/support/memory_trial.hpp"

namespace test_births {

using namespace dcem;
using namespace dcem::test;

namespace {

/// Cars that are somewhere else in each frame, on a ground between two walls; each carries a device.
Scene traffic(std::size_t cars, std::size_t frames, std::uint64_t seed) {
  Scene scene;
  scene.add_material({"metal", PerfectConductor{}});
  TriangleMesh ground;
  add_quad(ground, {Vec3(-60, -60, 0), {60, -60, 0}, {60, 60, 0}, {-60, 60, 0}}, "metal");
  add_quad(ground, {Vec3(-60, 25, 0), {60, 25, 0}, {60, 25, 8}, {-60, 25, 8}}, "metal");
  add_quad(ground, {Vec3(-60, -25, 0), {60, -25, 0}, {60, -25, 8}, {-60, -25, 8}}, "metal");
  scene.set_scenery(ground);
  RandomStream random(seed);
  for (std::size_t index = 0; index < cars; ++index) {
    const std::string name = "car" + std::to_string(index);
    scene.add_object(name, make_box(Vec3(4.4, 1.8, 1.5), "metal"), way_of(frames, [&](double) {
                       return Pose{Vec3(100.0 * random.uniform() - 50.0, 60.0 * random.uniform() - 30.0, 0.1), 0, 0, 0};
                     }));
    scene.add_transceiver(riding_device(name, name, Vec3(0, 0, 1.6)));
  }
  return scene;
}

std::size_t paths_of(const FrameResult& frame) {
  std::size_t count = 0;
  for (const LinkResult& link : frame.links) count += link.paths.size();
  return count;
}

}  // namespace

TEST_CASE("births less deaths are what there is more: as links come into range and go, and cars come and leave") {
  constexpr std::size_t frames = 12;
  for (const MemoryOrders& orders : {MemoryOrders{0, 0, 0, 0}, MemoryOrders{1, 0, 0, 1}, MemoryOrders{1, 0, 1, 2}}) {
    CAPTURE(orders.interactions);
    for (const bool gives_back : {false, true}) {
      const Scene scene = traffic(orders.interactions == 0 ? 110 : 12, frames, 11);
      SimulationSettings settings = memory_settings(orders);
      settings.links.range_m = 45.0;
      Simulator simulator(scene, settings);
      REQUIRE(simulator.cache() == CacheMode::exact);
      RandomStream random(5);
      std::size_t before = 0;
      std::uint64_t born = 0, died = 0;
      for (std::size_t index = 0; index < frames; ++index) {
        // Every other frame is the one before once more, with some of the cars gone or back.
        Frame frame = scene.frame_at(static_cast<double>(index / 2), index);
        for (std::size_t body = 1; body < frame.bodies.size(); ++body) {
          frame.bodies[body].present = index % 3 == 0 || random.uniform() < 0.8;
        }
        FrameResult result = simulator.advance(frame);
        const std::size_t now = paths_of(result);
        CHECK(result.cache.born + before == result.cache.died + now);
        born += result.cache.born;
        died += result.cache.died;
        before = now;
        if (gives_back) simulator.give_back(std::move(result));
      }
      CHECK(born > 100);
      CHECK(died > 100);
    }
  }
}

}  // namespace test_births
