/// Cache mode `seed`, frame by frame: what is reported is valid now, the books balance, and nothing but the scene, the
/// frames before and the seed has a say.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "dcem/paths/path_id.hpp"
#include "dcem/sim/simulator.hpp"
#include "dcem/sim/verify/brute_force_simulator.hpp"
#include "tests/paths/small_scenes.hpp"

namespace test_cache {

using namespace dcem;
using namespace dcem::test;

namespace {

/// An office with a trolley that drives and turns, and places for two boxes.
Scene office() {
  TriangleMesh mesh;
  add_box_faces(mesh, Vec3(0.0), Vec3(9, 6, 3), "opaque");
  add_sheet(mesh, Vec3(4, 3, 1.5), Vec3(0, 2.2, 0), Vec3(0, 0, 1.2), "glass");
  add_sheet(mesh, Vec3(6, 4, 1.5), Vec3(1.2, 0.4, 0), Vec3(0, 0, 1.1), "wall");
  Scene scene = scene_of(mesh);
  WaypointMotion motion;
  motion.waypoints = {{0.0, {Vec3(2, 1.5, 0.05), 0.4, 0, 0}},
                      {3.0, {Vec3(6, 2, 0.05), 1.9, 0, 0}},
                      {6.0, {Vec3(7, 3, 0.05), 0.2, 0, 0}}};
  scene.add_object("trolley", make_box(Vec3(1, 0.6, 0.9), "metal"), motion);
  scene.add_body_pool(2, make_box(Vec3(0.8, 0.8, 1.1), "metal"));
  return scene;
}

Device walking(std::string id, const Vec3& from_m, const Vec3& velocity_mps) {
  Device device = device_at(std::move(id), from_m);
  device.motion = LinearMotion{{from_m}, velocity_mps, 0.0};
  return device;
}

Device riding(std::string id, std::string object) {
  Device device = device_at(std::move(id), Vec3(0.0));
  device.attachment = Attachment{std::move(object), Vec3(0, 0, 1.3), false};
  return device;
}

void add_devices(Scene& scene) {
  scene.add_transmitter(device_at("t0", Vec3(1, 1.2, 2)));
  scene.add_transmitter(walking("t1", Vec3(8, 1.3, 2), Vec3(-0.4, 0, 0)));
  scene.add_receiver(device_at("r0", Vec3(7.4, 4.7, 1.1)));
  scene.add_receiver(walking("r1", Vec3(1.3, 5, 1.1), Vec3(1.1, -0.2, 0)));
  scene.add_receiver(riding("r2", "trolley"));
}

SimulationSettings seeded(std::uint32_t rays = 400, std::uint32_t rays_steady = 40) {
  SimulationSettings settings;
  settings.propagation.discovery = Discovery::sampled;
  settings.propagation.rays = rays;
  settings.propagation.rays_steady = rays_steady;
  settings.threads = 1;
  return settings;
}

/// Every number of a path, as bytes.
std::string bits(const PathContribution& path) {
  std::string bytes;
  const auto add = [&](double value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
  for (const double value : {path.path.length_m, path.delay_s, path.doppler_hz, path.power_ratio, path.amplitude.real(),
                             path.amplitude.imag(), path.departure.azimuth_rad, path.departure.zenith_rad,
                             path.arrival.azimuth_rad, path.arrival.zenith_rad}) {
    add(value);
  }
  for (std::size_t entry = 0; entry < 4; ++entry) {
    add(path.transfer(entry / 2, entry % 2).real());
    add(path.transfer(entry / 2, entry % 2).imag());
  }
  for (const Interaction& touch : path.path.interactions) {
    bytes += static_cast<char>(touch.kind) + std::to_string(touch.facet.value);
    for (int axis = 0; axis < 3; ++axis) add(touch.point_m[axis]);
  }
  return bytes;
}

/// All links by the names of their ends.
std::map<std::string, std::string> bits(const Scene& scene, const FrameResult& result) {
  std::map<std::string, std::string> links;
  for (const LinkResult& link : result.links) {
    std::string& bytes = links[scene.transmitters()[link.transmitter].id + ">" + scene.receivers()[link.receiver].id];
    for (const PathContribution& path : link.paths) bytes += path_id(scene, path.path) + bits(path);
  }
  return links;
}

/// The scene solved path by path, with every triangle asked in turn.
struct Oracle {
  BruteForceSimulator simulator;

  Oracle(const Scene& scene, SimulationSettings settings) : simulator(scene, without_cache(settings)) {}
  static SimulationSettings without_cache(SimulationSettings settings) {
    settings.propagation.cache = CacheMode::off;
    return settings;
  }
  void check(const Frame& frame, const FrameResult& result) {
    simulator.move_to(frame);
    for (const LinkResult& link : result.links) {
      std::set<std::string> ids;
      for (const PathContribution& path : link.paths) {
        CHECK(ids.insert(path_id(simulator.scene(), path.path)).second);
        const auto again = simulator.solve_path(link.transmitter, link.receiver, sequence_of(path.path));
        REQUIRE(again.has_value());
        CHECK(bits(*again) == bits(path));
      }
    }
  }
};

/// The books of a run.
struct Books {
  std::uint64_t paths = 0;

  void check(const FrameResult& result) {
    const CacheCounters& cache = result.cache;
    CHECK(cache.reused <= cache.revalidated);
    CHECK(cache.reused + cache.expired >= cache.revalidated);
    CHECK(result.work.paths == paths - cache.died + cache.born);
    paths = result.work.paths;
  }
};

Frame with_box(Frame frame, std::size_t body, const std::string& name, const Vec3& position_m) {
  frame.bodies[body] = {!name.empty(), {Pose{position_m}, {}}, name};
  return frame;
}

}  // namespace

TEST_CASE("every reported path is that path solved from scratch, and the books balance") {
  Scene scene = office();
  add_devices(scene);
  Simulator simulator(scene, seeded());
  REQUIRE(simulator.cache() == CacheMode::seed);
  Oracle oracle(scene, seeded());
  Books books;
  std::uint64_t born = 0, died = 0, reused = 0;
  for (std::size_t index = 0; index < 60; ++index) {
    CAPTURE(index);
    Frame frame = scene.frame_at(0.1 * double(index), index);
    if (index / 10 % 2 == 1) frame = with_box(frame, 2, index > 30 ? "b" : "a", Vec3(3 + 0.02 * double(index), 4.4, 0));
    if (index > 20) frame = with_box(frame, 3, "c", Vec3(5, 0.8, 0));
    const FrameResult result = simulator.advance(frame);
    CHECK(result.links.size() == 6);
    oracle.check(frame, result);
    books.check(result);
    if (index == 0) {
      CHECK(result.cache.born == result.work.paths);
      CHECK(result.cache.revalidated + result.cache.died + result.cache.expired == 0);
    } else {
      born += result.cache.born;
      died += result.cache.died;
      reused += result.cache.reused;
    }
  }
  CHECK(born > 10);
  CHECK(died > 10);
  CHECK(reused > 500);
}

TEST_CASE("reused and expired are what was revalidated, but for what left with its object") {
  Scene scene = office();
  add_devices(scene);
  Simulator simulator(scene, seeded());
  std::uint64_t before = 0;
  for (std::size_t index = 0; index < 20; ++index) {
    const FrameResult result =
        simulator.advance(with_box(scene.frame_at(0.1 * double(index), index), 2, "a", Vec3(3, 4, 0)));
    CHECK(result.cache.reused + result.cache.expired == result.cache.revalidated);
    CHECK(result.cache.revalidated == before);
    before = result.work.paths;
  }
  const FrameResult gone = simulator.advance(scene.frame_at(2.0, 20));
  CHECK(gone.cache.reused + gone.cache.expired == before);
  CHECK(gone.cache.revalidated < before);  // paths over the box are not tried again
}

namespace {

double power(const FrameResult& result) {
  double sum = 0.0;
  for (const LinkResult& link : result.links) {
    for (const PathContribution& path : link.paths) sum += path.power_ratio;
  }
  return sum;
}

}  // namespace

TEST_CASE("a still scene: everything is reused, nothing dies, and births add what rays had missed") {
  for (const int diffractions : {0, 1}) {
    CAPTURE(diffractions);
    Scene scene = office();
    scene.add_transmitter(device_at("t0", Vec3(1, 1.2, 2)));
    scene.add_receiver(device_at("r0", Vec3(7.4, 4.7, 1.1)));
    SimulationSettings settings = seeded(200, 20);
    settings.propagation.max_diffractions = diffractions;
    Simulator simulator(scene, settings);
    FrameResult result = simulator.advance_to(0.0, 0);
    CHECK(result.cache.born == result.work.paths);
    std::uint64_t paths = result.work.paths, born = 0;
    for (std::size_t index = 1; index < 200; ++index) {
      result = simulator.advance(scene.frame_at(0.0, index));  // only the number of the frame goes on
      CHECK(result.cache.revalidated == paths);
      CHECK(result.cache.reused == paths);
      CHECK(result.cache.expired == 0);
      CHECK(result.cache.died == 0);
      CHECK(result.work.paths == paths + result.cache.born);
      CHECK(result.tree.nodes_refit + result.tree.nodes_rebuilt == 0);
      paths = result.work.paths;
      born += result.cache.born;
    }
    CHECK(born > 0);
    settings.propagation.discovery = Discovery::exact;
    settings.propagation.cache = CacheMode::off;
    Simulator all(scene, settings);
    const FrameResult whole = all.advance_to(0.0, 0);
    CHECK(paths <= whole.work.paths);
    // 200 + 199·20 rays have looked around. Of the edges' paths, most of them weak, a good part stays undiscovered:
    // both ends must come by an edge within a few frames. What is missed is weak.
    if (diffractions == 0) CHECK(paths * 10 >= whole.work.paths * 9);
    CHECK(power(result) > 0.9 * power(whole));
  }
}

TEST_CASE("all rays in a frame without history, few later, all again when an end was away") {
  Scene scene = office();
  scene.add_transmitter(device_at("t0", Vec3(1, 1.2, 2)));
  scene.add_transmitter(riding("t1", "a"));
  scene.add_receiver(device_at("r0", Vec3(7.4, 4.7, 1.1)));
  scene.add_receiver(riding("r1", "b"));
  SimulationSettings settings = seeded(500, 50);
  settings.propagation.max_reflections = 1;
  settings.propagation.max_transmissions = 0;  // then each ray is one ray
  settings.propagation.max_diffractions = 0;   // and transmitters shoot none
  Simulator simulator(scene, settings);
  std::size_t index = 0;
  const auto rays = [&](bool a, bool b) {
    Frame frame = scene.frame_at(0.0, index++);
    if (a) frame = with_box(frame, 2, "a", Vec3(2.5, 4.5, 0));
    if (b) frame = with_box(frame, 3, "b", Vec3(5, 1, 0));
    return simulator.advance(frame).work.rays;
  };
  CHECK(rays(false, false) == 500);
  CHECK(rays(false, false) == 50);
  CHECK(rays(true, false) == 500);  // t1 has come
  CHECK(rays(true, false) == 50);
  CHECK(rays(false, false) == 50);      // t1 has gone: nothing new to look for
  CHECK(rays(true, false) == 500);      // and is back
  CHECK(rays(true, true) == 50 + 500);  // r1 has come
  CHECK(rays(true, true) == 50 + 50);
  CHECK(rays(true, false) == 50);
  CHECK(rays(true, true) == 50 + 500);  // r1 was away
}

TEST_CASE("the default of rays_steady is a tenth of rays, and one at least") {
  PropagationSettings propagation;
  CHECK(steady_rays(propagation) == 2000);
  propagation.rays = 7;
  CHECK(steady_rays(propagation) == 1);
  propagation.rays_steady = 9;
  CHECK(steady_rays(propagation) == 9);
  SimulationSettings settings;
  settings.propagation.rays_steady = 0;
  CHECK_THROWS_AS(validate(settings), std::invalid_argument);
}

TEST_CASE("another object at the same place: the paths over the first one die, those over the second are born") {
  Scene scene = office();
  scene.add_transmitter(device_at("t0", Vec3(1, 1.2, 2)));
  scene.add_receiver(device_at("r0", Vec3(7.4, 1.9, 1.3)));
  // The mirror image of r0 in the top of the box, at 1.1 m, is seen at 0.9 / (0.9 + 0.2) of the way.
  const Vec3 above_box_m(6.2, 1.77, 0);
  Simulator simulator(scene, seeded(3000, 3000));
  const auto over = [&](const FrameResult& result, const std::string& name) {
    std::uint64_t count = 0;
    for (const PathContribution& path : result.links[0].paths) {
      const std::string id = path_id(simulator.scene(), path.path);
      count += id.find("@" + name) != std::string::npos ? 1U : 0U;  // the box is opaque: no path crosses it
    }
    return count;
  };
  FrameResult before = simulator.advance(with_box(scene.frame_at(0.0, 0), 2, "a", above_box_m));
  for (std::size_t index = 1; index < 4; ++index) {
    before = simulator.advance(with_box(scene.frame_at(0.0, index), 2, "a", above_box_m));
  }
  const std::uint64_t paths_over_a = over(before, "a");
  REQUIRE(paths_over_a > 0);
  const FrameResult after = simulator.advance(with_box(scene.frame_at(0.0, 4), 2, "b", above_box_m));
  CHECK(over(after, "a") == 0);
  CHECK(over(after, "b") > 0);
  CHECK(after.cache.died == paths_over_a);  // nothing has moved: no other path has
  CHECK(after.cache.born >= over(after, "b"));
  CHECK(after.cache.revalidated == before.work.paths - paths_over_a);
  CHECK(after.work.paths == before.work.paths - after.cache.died + after.cache.born);
  CHECK(after.tree.nodes_refit + after.tree.nodes_rebuilt == 0);
}

TEST_CASE("a device that sends and receives under one id has no link with itself, and no paths in the books") {
  Scene scene = office();
  scene.add_transmitter(device_at("t0", Vec3(1, 1.2, 2)));
  scene.add_transmitter(device_at("both", Vec3(8, 1.3, 2)));
  scene.add_receiver(device_at("both", Vec3(8, 1.3, 2)));
  Simulator simulator(scene, seeded());
  Books books;
  for (std::size_t index = 0; index < 10; ++index) {
    const FrameResult result = simulator.advance_to(0.1 * double(index), index);
    CHECK(result.links.size() == 1);
    books.check(result);
  }
}

TEST_CASE("frames out of order, skipped and repeated do no harm") {
  Scene scene = office();
  add_devices(scene);
  Simulator simulator(scene, seeded());
  Oracle oracle(scene, seeded());
  Books books;
  for (const std::size_t index : {5U, 40U, 3U, 3U, 0U, 59U, 2U, 58U, 58U, 7U}) {
    const Frame frame = with_box(scene.frame_at(0.1 * double(index), index), 2 + index % 2, "a", Vec3(3, 4.5, 0));
    const FrameResult result = simulator.advance(frame);
    CHECK(result.index == index);
    oracle.check(frame, result);
    books.check(result);
  }
}

TEST_CASE("moving without solving, and solving for others' receivers, leave the memory sound") {
  Scene scene = office();
  add_devices(scene);
  Simulator simulator(scene, seeded()), undisturbed(scene, seeded());
  Oracle oracle(scene, seeded());
  const Device guest = device_at("guest", Vec3(5, 5, 1));
  for (std::size_t index = 0; index < 10; ++index) {
    const Frame frame = scene.frame_at(0.1 * double(index), index);
    const FrameResult result = simulator.advance(frame);
    CHECK(bits(scene, result) == bits(scene, undisturbed.advance(frame)));
    oracle.check(frame, result);
    WorkCounters work;
    simulator.solve({&guest, 1}, &work);
    CHECK(work.rays >= 400);  // nothing is remembered of it
  }
  simulator.move_to(with_box(scene.frame_at(5.0, 50), 2, "a", Vec3(3, 4.5, 0)));
  simulator.move_to(scene.frame_at(1.0, 10));
  const Frame frame = scene.frame_at(1.1, 11);
  const FrameResult result = simulator.advance(frame);
  oracle.check(frame, result);
}

TEST_CASE("neither the order of the devices nor the number of threads changes a bit") {
  const auto run = [](bool turned, unsigned threads) {
    Scene scene = office();
    std::vector<Device> transmitters, receivers;
    for (int index = 0; index < 3; ++index) {
      transmitters.push_back(walking("t" + std::to_string(index), Vec3(1 + 3 * index, 1.2, 2), Vec3(0.1, 0, 0)));
    }
    for (int index = 0; index < 7; ++index) {
      receivers.push_back(walking("r" + std::to_string(index), Vec3(0.5 + 1.2 * index, 4.7, 1.1), Vec3(0, -0.3, 0)));
    }
    receivers.push_back(riding("r7", "a"));
    if (turned) {
      std::reverse(transmitters.begin(), transmitters.end());
      std::rotate(receivers.begin(), receivers.begin() + 3, receivers.end());
    }
    for (const Device& device : transmitters) scene.add_transmitter(device);
    for (const Device& device : receivers) scene.add_receiver(device);
    SimulationSettings settings = seeded();
    settings.threads = threads;
    Simulator simulator(scene, settings);
    std::vector<std::pair<std::map<std::string, std::string>, CacheCounters>> frames;
    std::vector<std::uint64_t> work;
    for (std::size_t index = 0; index < 12; ++index) {
      Frame frame = scene.frame_at(0.2 * double(index), index);
      if (index % 5 != 4) frame = with_box(frame, 2, "a", Vec3(3 + 0.1 * double(index), 4.5, 0));
      const FrameResult result = simulator.advance(frame);
      frames.emplace_back(bits(simulator.scene(), result), result.cache);
      work.insert(work.end(), {result.work.rays, result.work.legs, result.work.sequences_proposed,
                               result.work.sequences_solved, result.work.paths, result.work.nodes_visited});
    }
    return std::pair(frames, work);
  };
  const auto one = run(false, 1);
  CHECK(one.first.back().first.size() == 24);
  for (const unsigned threads : {2U, 5U}) CHECK((run(false, threads) == one));
  for (const unsigned threads : {1U, 2U, 5U}) CHECK((run(true, threads).first == one.first));
}

TEST_CASE("no policy of the tree changes a bit") {
  const auto run = [](TreePolicy policy) {
    Scene scene = office();
    add_devices(scene);
    SimulationSettings settings = seeded();
    settings.tree.policy = policy;
    Simulator simulator(scene, settings);
    std::vector<std::map<std::string, std::string>> frames;
    for (std::size_t index = 0; index < 30; ++index) {
      Frame frame = scene.frame_at(0.2 * double(index), index);
      if (index % 7 > 2) frame = with_box(frame, 2, "a", Vec3(3 + 0.1 * double(index), 4.5, 0));
      frames.push_back(bits(scene, simulator.advance(frame)));
      CHECK(simulator.index().tree().validate(simulator.scene().triangle_boxes()) == "");
    }
    return frames;
  };
  const auto adaptive = run(TreePolicy::adaptive);
  CHECK((run(TreePolicy::refit_only) == adaptive));
  CHECK((run(TreePolicy::rebuild_always) == adaptive));
}

TEST_CASE("with the cache off nothing is remembered and nothing is counted") {
  Scene scene = office();
  add_devices(scene);
  SimulationSettings settings = seeded();
  settings.propagation.cache = CacheMode::off;
  Simulator simulator(scene, settings);
  for (std::size_t index = 0; index < 3; ++index) {
    const FrameResult result = simulator.advance_to(0.1 * double(index), index);
    CHECK(result.cache == CacheCounters{});
    CHECK(result.work.rays >= 3 * 400);
  }
}

TEST_CASE("which cache a simulation gets") {
  const Scene scene = office();
  const auto resolved = [&](Discovery discovery, CacheMode cache) {
    SimulationSettings settings;
    settings.propagation.discovery = discovery;
    settings.propagation.cache = cache;
    return Simulator(scene, settings).cache();
  };
  CHECK(resolved(Discovery::sampled, CacheMode::automatic) == CacheMode::seed);
  CHECK(resolved(Discovery::sampled, CacheMode::seed) == CacheMode::seed);
  CHECK(resolved(Discovery::sampled, CacheMode::off) == CacheMode::off);
  CHECK(resolved(Discovery::exact, CacheMode::automatic) == CacheMode::exact);
  CHECK(resolved(Discovery::exact, CacheMode::exact) == CacheMode::exact);
  CHECK(resolved(Discovery::exact, CacheMode::off) == CacheMode::off);
  CHECK(resolved(Discovery::automatic, CacheMode::automatic) == CacheMode::exact);  // the office is small
  CHECK_THROWS_AS(resolved(Discovery::exact, CacheMode::seed), std::invalid_argument);
  CHECK_THROWS_AS(resolved(Discovery::sampled, CacheMode::exact), std::invalid_argument);
  CHECK_THROWS_AS(resolved(Discovery::automatic, CacheMode::seed), std::invalid_argument);
  CHECK(PropagationSettings{}.cache == CacheMode::automatic);
}

TEST_CASE("a frame that is refused leaves the simulation as it was") {
  Scene scene = office();
  add_devices(scene);
  for (const double far_m : {1e16, std::numeric_limits<double>::infinity()}) {
    CAPTURE(far_m);
    Simulator simulator(scene, seeded()), undisturbed(scene, seeded());
    const Frame good = scene.frame_at(0.0, 0);
    simulator.advance(good);
    undisturbed.advance(good);
    // The trolley is where nobody would look for it, a box is where a tree cannot follow.
    const Frame bad = with_box(scene.frame_at(3.0, 1), 2, "a", Vec3(far_m, 0, 0));
    CHECK_THROWS_AS(simulator.advance(bad), std::invalid_argument);
    Frame next = scene.frame_at(0.1, 2);
    next.bodies[1] = bad.bodies[1];
    CHECK((bits(scene, simulator.advance(next)) == bits(scene, undisturbed.advance(next))));
    CHECK(simulator.index().tree().validate(simulator.scene().triangle_boxes()) == "");
  }
}

}  // namespace test_cache
