/// Three interactions: what is remembered changes no bit, wherever in a sequence what has moved stands. From scratch
/// these small streets are searched by trying all sequences.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "tests/paths/halves/small_street.hpp"
#include "tests/support/memory_trial.hpp"

namespace test_memory_of_triples {

using namespace dcem;
using namespace dcem::test;

namespace {

constexpr std::size_t frames = 14;

/// How many paths of three interactions there were over bodies: by kind (RRR, DRR, RDR, RRD) and by which of their
/// elements, from the transmitter, are of a body.
struct Places {
  std::array<std::array<std::size_t, 8>, 4> count{};

  void add(const Scene& scene, const Path& path) {
    std::size_t elements = 0, kind = 0, on_bodies = 0;
    for (const Interaction& interaction : path.interactions) {
      if (interaction.kind == InteractionKind::transmission) continue;
      const bool is_edge = interaction.kind == InteractionKind::diffraction;
      const BodyId body = is_edge ? scene.wedge(interaction.wedge).body : scene.facet(interaction.facet).body;
      if (is_edge) kind = elements + 1;
      if (body != BodyId(0)) on_bodies |= std::size_t{1} << elements;
      ++elements;
    }
    if (elements == 3) ++count[kind][on_bodies];
  }
  void add(const Scene& scene, const std::vector<LinkResult>& links) {
    for (const LinkResult& link : links) {
      for (const PathContribution& path : link.paths) add(scene, path.path);
    }
  }
  /// Of all kinds and of each place of a body alone the smallest number.
  std::size_t least() const {
    std::size_t least = count[0][1];
    for (const auto& kind : count) {
      for (const std::size_t alone : {1U, 2U, 4U}) least = std::min(least, kind[alone]);
    }
    return least;
  }
  /// Paths over bodies in two elements or more.
  std::size_t over_several() const {
    std::size_t sum = 0;
    for (const auto& kind : count) sum += kind[3] + kind[5] + kind[6] + kind[7];
    return sum;
  }
};

/// A car that drives, turns, stops for a while and jumps.
WaypointMotion drive(Draw& draw, double largest_step_m) {
  double step_m = draw.magnitude(1e-3, largest_step_m);
  Pose pose{draw.inside(Vec3(-9, -3, 0.02), Vec3(9, 3, 0.03)), draw.between(-pi, pi), 0, 0};
  bool stops = draw.below(2) == 0;
  return way_of(frames + 1, [&](double) {
    const Pose now = pose;
    if (draw.below(4) == 0) stops = !stops;
    if (draw.below(10) == 0) pose.position_m = draw.inside(Vec3(-9, -3, 0.02), Vec3(9, 3, 0.03));
    if (stops) return now;
    pose.yaw_rad += draw.between(-0.1, 0.1);
    pose.position_m += step_m * Vec3(std::cos(pose.yaw_rad), std::sin(pose.yaw_rad), 0.0);
    return now;
  });
}

/// Stands still, walks, and stands still again.
WaypointMotion stroll(Draw& draw, double step_m) {
  Vec3 at_m = draw.inside(Vec3(-8, -3, 0.5), Vec3(8, 3, 2));
  const Vec3 ahead = draw.direction();
  const std::size_t first = 3 + draw.below(4), last = first + 1 + draw.below(4);
  std::size_t frame = 0;
  return way_of(frames + 1, [&](double) {
    if (++frame > first && frame <= last) at_m += step_m * Vec3(ahead.x, ahead.y, 0.0);
    return Pose{at_m, 0, 0, 0};
  });
}

Scene busy_street(Draw& draw) {
  Scene scene = small_street(draw);
  for (const char* name : {"two", "three"}) {
    TriangleMesh car;
    add_box_faces(car, Vec3(-1.5, -0.8, 0), Vec3(1.5, 0.8, 1.4), draw.below(4) == 0 ? "glass" : "metal");
    scene.add_object(name, car, drive(draw, 1.0));
  }
  scene.add_transmitter(device_at("mast", draw.inside(Vec3(-8, -3, 2), Vec3(8, 3, 9)), 30.0));
  scene.add_receiver(device_at("post", draw.inside(Vec3(-8, -3, 0.3), Vec3(8, 3, 4))));
  if (draw.below(3) == 0) scene.add_transmitter(moving_device("sender", stroll(draw, 0.3)));
  if (draw.below(3) == 0) scene.add_receiver(riding_device("rider", "two", Vec3(0, 0, 1.6), draw.below(2) == 0));
  scene.add_receiver(moving_device("walker", stroll(draw, draw.magnitude(0.01, 0.5))));
  return scene;
}

struct Sums {
  MemoryTally tally;
  Places places;
};

void follow_drive(std::uint64_t seed, Sums& sums) {
  Draw draw(seed);
  const Scene scene = busy_street(draw);
  const std::vector<MemoryOrders> orders{{3, 0, 1, 3}, {2, 0, 1, 3}, {2, 1, 1, 3}, {3, 0, 0, 3}, {2, 0, 1, 3, true}};
  SimulationSettings settings = memory_settings(orders[draw.below(orders.size())]);
  settings.threads = draw.below(3) == 0 ? 2 : 1;
  MemoryTrial trial(scene, settings);
  REQUIRE(trial.own().cache() == CacheMode::exact);
  std::vector<bool> away(scene.bodies().size(), false);
  CAPTURE(seed);
  double time_s = 0.0;
  for (std::size_t index = 0; index < frames; ++index) {
    if (draw.below(8) != 0) time_s += draw.below(4) == 0 ? 0.25 : 1.0;
    Frame frame = scene.frame_at(std::min(time_s, static_cast<double>(frames)), index);
    for (std::size_t body = 1; body < away.size(); ++body) {
      if (draw.below(16) == 0) away[body] = !away[body];
      frame.bodies[body].present = !away[body];
    }
    if (draw.below(12) == 0) trial.own().move_to(scene.frame_at(draw.between(0, frames), index));
    const FrameResult expected = trial.advance(frame);
    sums.places.add(scene, expected.links);
  }
  sums.tally += trial.tally();
}

/// A street in which two cars drive beside one that is parked, between a lamp and a post.
Scene quiet_street(std::size_t count) {
  TriangleMesh mesh;
  add_sheet(mesh, Vec3(0.0), Vec3(30, 0, 0), Vec3(0, 30, 0), "opaque");
  add_box_faces(mesh, Vec3(-9, 4, 0), Vec3(5, 9, 7), "metal");
  add_box_faces(mesh, Vec3(-7, -9, 0), Vec3(8, -4.5, 5), "metal");
  Scene scene = scene_of(mesh);
  TriangleMesh car;
  add_box_faces(car, Vec3(-1.5, -0.8, 0.02), Vec3(1.5, 0.8, 1.4), "metal");
  scene.add_object("parked", car, LinearMotion{{Vec3(2, 2.5, 0), 0.05, 0, 0}});
  scene.add_object("left", car, straight_way(count, Vec3(-9, -1.5, 0), Vec3(6, -1, 0)));
  scene.add_object("right", car, straight_way(count, Vec3(9, 0.8, 0), Vec3(-5, 1, 0)));
  return scene;
}

const MemoryOrders three{2, 0, 1, 3};

}  // namespace

TEST_CASE("over three interactions, small steps end in the bits of large ones, from one thread or two") {
  Scene scene = quiet_street(8);
  scene.add_transmitter(device_at("lamp", Vec3(-6, 0, 4), 30.0));
  scene.add_receiver(device_at("post", Vec3(5, -3, 1.2)));
  scene.add_receiver(device_at("bench", Vec3(-4, 3, 0.8)));
  SimulationSettings settings = memory_settings(three);
  MemoryTrial large(scene, settings);
  settings.threads = 2;
  MemoryTrial small(scene, settings);
  for (std::size_t step = 0; step <= 28; ++step) {
    const FrameResult frame = small.advance_to(0.25 * static_cast<double>(step), step);
    if (step % 4 != 0) continue;
    const Frame same = scene.frame_at(0.25 * static_cast<double>(step), step);
    CHECK((bits(scene, large.advance(same).links) == bits(scene, frame.links)));
  }
  CHECK(small.has_remembered());
  CHECK(4 * small.tally().taken_over > small.tally().paths);
  CHECK(small.tally().paths > 20 * small.tally().links);
}

TEST_CASE("over three interactions, swapped ends have the same paths while cars drive") {
  Scene there = quiet_street(24), back = quiet_street(24);
  const Vec3 lamp_m(-6, 0, 4), post_m(5, -3, 1.2);
  there.add_transmitter(device_at("lamp", lamp_m));
  there.add_receiver(device_at("post", post_m));
  back.add_transmitter(device_at("post", post_m));
  back.add_receiver(device_at("lamp", lamp_m));
  MemoryTrial one(there, memory_settings(three)), other(back, memory_settings(three));
  const auto touched = [](const FrameResult& frame, bool turned) {
    std::multiset<std::vector<std::uint32_t>> all;
    for (const PathContribution& path : frame.links.at(0).paths) {
      std::vector<std::uint32_t> names;
      for (const SequenceElement element : sequence_of(path.path)) names.push_back(element.code());
      if (turned) std::ranges::reverse(names);
      all.insert(names);
    }
    return all;
  };
  for (std::size_t index = 0; index < 24; ++index) {
    const auto time_s = static_cast<double>(index);
    CHECK((touched(one.advance_to(time_s, index), false) == touched(other.advance_to(time_s, index), true)));
  }
  CHECK(one.tally().work < one.tally().work_anew);
  CHECK(other.tally().work < other.tally().work_anew);
}

TEST_CASE("a receiver steps aside and back while cars drive, and looks where they are now") {
  Scene scene = quiet_street(30);
  scene.add_transmitter(moving_device("sender", straight_way(30, Vec3(-6, 0, 4), Vec3(-5, 1, 4))));
  scene.add_receiver(moving_device("post", way_of(30, [](double at) {
                                     return Pose{Vec3(std::fmod(at, 6) == 3 ? 4.5 : 5, -3, 1.2), 0, 0, 0};
                                   })));
  MemoryTrial trial(scene, memory_settings(three));
  for (std::size_t index = 0; index < 24; ++index) {
    Frame frame = scene.frame_at(static_cast<double>(index), index);
    // In every other frame the sender alone moves on.
    frame.bodies = scene.frame_at(static_cast<double>(index / 2), index).bodies;
    trial.advance(frame);
  }
  CHECK(trial.tally().different == 0);
  CHECK(trial.tally().paths > 20 * trial.tally().frames);
}

TEST_CASE("memory changes no bit of drives through random streets, over three interactions") {
  Sums sums;
  for (std::uint64_t seed = 1; seed <= 24; ++seed) follow_drive(seed, sums);
  const MemoryTally& tally = sums.tally;
  MESSAGE(tally.frames << " frames, " << tally.links << " links, " << tally.paths << " paths, " << tally.taken_over
                       << " taken over, work " << tally.work << " of " << tally.work_anew << "; over one body "
                       << sums.places.least() << " of a kind at least, over several " << sums.places.over_several());
  CHECK(tally.different == 0);
  CHECK(tally.taken_over > 1000);
  CHECK(tally.work < tally.work_anew);  // or nothing was remembered
  CHECK(sums.places.least() > 5);       // a body in every place of every kind
  CHECK(sums.places.over_several() > 100);
}

}  // namespace test_memory_of_triples
