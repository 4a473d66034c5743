#include <doctest/doctest.h>

#include <bit>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "dcem/accel/wide/update/updater.hpp"
#include "tests/accel/wide/wide_scenes.hpp"
#include "tests/accel/wide/wide_traffic.hpp"

namespace test_wide_updater {

using namespace dcem;
using dcem_test::infinity;
using dcem_test::WideMesh;

namespace {

/// Cubes that drive over a plain, one object each, and the trees over them.
class Traffic {
 public:
  Traffic(std::size_t cars, std::uint64_t seed) : random_(seed) {
    for (std::size_t car = 0; car < cars; ++car) {
      object_first.push_back(static_cast<std::uint32_t>(mesh.triangles.size()));
      const Vec3 low(dcem_test::between(random_, 0, 500), dcem_test::between(random_, 0, 500), 0);
      mesh.append(dcem_test::box_mesh(low, low + Vec3(4, 2, 1.5)));
      speed_.push_back({dcem_test::between(random_, -2, 2), dcem_test::between(random_, -2, 2), 0});
    }
    mesh.absent.assign(mesh.triangles.size(), false);
    boxes = mesh.boxes();
    moved.resize(mesh.triangles.size());
    std::iota(moved.begin(), moved.end(), 0U);
  }

  void step() {
    const std::size_t corners = mesh.vertices.size() / speed_.size();
    for (std::size_t vertex = 0; vertex < mesh.vertices.size(); ++vertex) {
      mesh.vertices[vertex] += speed_[vertex / corners];
    }
    boxes = mesh.boxes();
  }
  WideBvh built() const {
    WideBvh tree;
    tree.build_objects(mesh.view(), boxes, object_first);
    return tree;
  }
  TreeUpdateReport follow(WideBvh& tree, WideUpdater& updater) const {
    const TreeUpdateReport report = updater.update(tree, moved, mesh.view(), boxes);
    REQUIRE(tree.validate(boxes) == "");
    REQUIRE(report.sah_cost == tree.sah_cost());
    REQUIRE(report.subtrees_rebuilt >= report.rebuilt_in_place);
    return report;
  }
  TreeUpdateReport follow(WideBvh& tree, const WideUpdateSettings& settings) const {
    WideUpdater updater(settings);
    return follow(tree, updater);
  }

  WideMesh mesh;
  std::vector<std::uint32_t> object_first, moved;
  std::vector<Aabb<double>> boxes;

 private:
  RandomStream random_;
  std::vector<Vec3> speed_;
};

WideUpdateSettings with(TreePolicy policy) {
  WideUpdateSettings settings;
  settings.policy = policy;
  return settings;
}

/// Adaptive, with everything switched off that can be.
WideUpdateSettings nothing_mends() {
  WideUpdateSettings settings;
  settings.sah_growth_limit = settings.deformation_limit = settings.renewal_ratio = infinity;
  settings.reinsertion_growth = settings.subtree_rebuild_price = settings.rebuild_growth_limit = infinity;
  settings.reinsertion_turn = settings.rotations_per_node = 0;
  settings.check_interval = 1;
  return settings;
}

}  // namespace

TEST_CASE("nothing moved: nothing is touched, whatever the policy") {
  const Traffic traffic(50, 1);
  for (const TreePolicy policy : {TreePolicy::rebuild_always, TreePolicy::refit_only, TreePolicy::adaptive}) {
    WideBvh tree = traffic.built();
    const double sah = tree.sah_cost();
    const TreeUpdateReport report = WideUpdater(with(policy)).update(tree, {}, traffic.mesh.view(), traffic.boxes);
    CHECK(report.nodes_refit + report.nodes_rebuilt + report.subtrees_rebuilt == 0);
    CHECK(report.nodes_kept > 50);  // a leaf for each car, and the nodes above
    CHECK(std::bit_cast<std::uint64_t>(tree.sah_cost()) == std::bit_cast<std::uint64_t>(sah));
  }
}

TEST_CASE("a drive: refit alone degrades out, reinsertion stays near a new tree, and all hit the same bits") {
  Traffic traffic(200, 2);
  WideBvh refitted = traffic.built(), adaptive = traffic.built();
  WideUpdateSettings never_anew = nothing_mends();  // but by reinsertion
  never_anew.reinsertion_growth = WideUpdateSettings{}.reinsertion_growth;
  never_anew.reinsertion_turn = WideUpdateSettings{}.reinsertion_turn;
  RandomStream random(3);
  std::uint64_t reinserted = 0;
  for (int frame = 0; frame < 200; ++frame) {
    traffic.step();
    traffic.follow(refitted, with(TreePolicy::refit_only));
    const TreeUpdateReport report = traffic.follow(adaptive, never_anew);
    reinserted += report.subtrees_rebuilt;
    CHECK(!report.root_rebuilt);
    const WideBvh fresh = traffic.built();
    for (int trial = 0; trial < 20; ++trial) {
      const Ray<double> ray = dcem_test::any_ray(random, traffic.mesh, fresh.bounds());
      const auto expected = fresh.closest_hit(ray);
      for (const WideBvh* tree : {&refitted, &adaptive}) {
        const auto found = tree->closest_hit(ray);
        REQUIRE(found.has_value() == expected.has_value());
        if (!found) continue;
        REQUIRE(std::bit_cast<std::uint64_t>(found->t) == std::bit_cast<std::uint64_t>(expected->t));
        REQUIRE(found->triangle == expected->triangle);
      }
    }
  }
  const double fresh_sah = traffic.built().sah_cost();
  MESSAGE("SAH over a new tree's: refit " << refitted.sah_cost() / fresh_sah << ", reinsertion "
                                          << adaptive.sah_cost() / fresh_sah);
  CHECK(reinserted > 200);
  // Every car has crossed half of the plain: neighbours at the start are strangers now.
  CHECK(refitted.sah_cost() > 2.0 * fresh_sah);
  CHECK(adaptive.sah_cost() < 1.2 * fresh_sah);
}

TEST_CASE("every trick has a switch: all off, adaptive is refit") {
  Traffic traffic(100, 4);
  WideBvh refitted = traffic.built(), switched_off = traffic.built(), off_and_whole = traffic.built();
  WideUpdateSettings whole = nothing_mends();
  whole.subtree_rebuilds = false;
  for (int frame = 0; frame < 50; ++frame) {
    traffic.step();
    const TreeUpdateReport expected = traffic.follow(refitted, with(TreePolicy::refit_only));
    CHECK(traffic.follow(switched_off, nothing_mends()) == expected);
    CHECK(traffic.follow(off_and_whole, whole) == expected);
    CHECK(expected.nodes_rebuilt == 0);
    CHECK(!switched_off.tracked().any());
  }
}

TEST_CASE("each trick by itself mends what refit degrades, and says what it did") {
  using Change = void (*)(WideUpdateSettings&);
  const std::vector<Change> changes{[](WideUpdateSettings& settings) { settings.rotations_per_node = 1; },
                                    [](WideUpdateSettings& settings) { settings.sah_growth_limit = 1.2; },
                                    [](WideUpdateSettings& settings) { settings.deformation_limit = 0.4; },
                                    [](WideUpdateSettings& settings) { settings.renewal_ratio = 16.0; },
                                    [](WideUpdateSettings& settings) { settings.rebuild_growth_limit = 1.2; }};
  for (std::size_t index = 0; index < changes.size(); ++index) {
    CAPTURE(index);
    Traffic traffic(200, 6);
    WideBvh refitted = traffic.built(), mended = traffic.built();
    WideUpdateSettings settings = nothing_mends();
    changes[index](settings);
    WideUpdater updater(settings);
    TreeUpdateReport sum;
    bool part_rebuilt = false;
    for (int frame = 0; frame < 100; ++frame) {
      traffic.step();
      traffic.follow(refitted, with(TreePolicy::refit_only));
      const TreeUpdateReport report = traffic.follow(mended, updater);
      sum.rotated += report.rotated;
      sum.rebuilt_in_place += report.rebuilt_in_place;
      part_rebuilt = part_rebuilt || (report.rebuilt_in_place > 0 && !report.root_rebuilt);
      sum.reinserted += report.reinserted;
      sum.root_rebuilt = sum.root_rebuilt || report.root_rebuilt;
      CHECK(report.nodes_rebuilt >= report.rebuilt_in_place);
    }
    CHECK(mended.sah_cost() < 0.9 * refitted.sah_cost());
    CHECK((sum.rotated > 0) == (index == 0));
    CHECK((sum.rebuilt_in_place > 0) == (index == 1 || index == 2 || index == 3));
    CHECK(sum.reinserted == 0);
    CHECK(part_rebuilt == (index == 1 || index == 2));
    if (index == 3 || index == 4) CHECK(sum.root_rebuilt);
  }
}

TEST_CASE("no subtree stays degraded: past a limit it is rebuilt_in_place in the frame that looks") {
  for (const bool by_sah : {true, false}) {
    Traffic traffic(300, 7);
    WideBvh tree = traffic.built();
    WideUpdateSettings settings = nothing_mends();
    (by_sah ? settings.sah_growth_limit : settings.deformation_limit) = by_sah ? 1.1 : 0.1;
    settings.check_interval = 3;
    WideUpdater updater(settings);
    for (int frame = 1; frame <= 60; ++frame) {
      traffic.step();
      const TreeUpdateReport report = traffic.follow(tree, updater);
      if (frame % 3 != 0) {
        CHECK(report.rebuilt_in_place == 0);
        continue;
      }
      for (const std::uint32_t node : dcem_test::nodes_of(tree.arrays())) {
        // Where a new plan is no better the old part stays, and counts as built now at the next look.
        CHECK((tree.degradation()[node].is_new() || !updater.is_degraded(tree.degradation()[node])));
      }
    }
  }
}

TEST_CASE("renewal: at once, and then once for so many visited nodes") {
  Traffic traffic(200, 14);
  WideBvh tree = traffic.built();
  WideUpdateSettings settings = nothing_mends();
  settings.renewal_ratio = 16.0;
  WideUpdater updater(settings);
  double visited = infinity;
  std::uint64_t renewed = 0;
  for (int frame = 0; frame < 100; ++frame) {
    const WideArrays& arrays = tree.arrays();
    const auto all = static_cast<double>(arrays.nodes.size() - arrays.free_nodes.size() + arrays.leaves.size());
    traffic.step();
    const TreeUpdateReport report = traffic.follow(tree, updater);
    visited += static_cast<double>(report.nodes_refit);
    const bool due = visited > 16.0 * all;
    CHECK((due || !report.root_rebuilt));
    if (due) visited = 0.0;
    renewed += report.rebuilt_in_place;
  }
  CHECK(renewed > 3);
}

TEST_CASE("with reinsertion all nodes are built anew in turns, one child of the root a frame") {
  Traffic traffic(200, 15);
  WideBvh tree = traffic.built();
  WideUpdateSettings settings = nothing_mends();
  settings.renewal_ratio = 16.0;
  settings.reinsertion_growth = 1.1;
  WideUpdater updater(settings);
  int renewed = 0, longest = 0, frames = 0;
  for (int frame = 0; frame < 200; ++frame) {
    traffic.step();
    const TreeUpdateReport report = traffic.follow(tree, updater);
    CHECK(report.rebuilt_in_place <= 1);
    ++frames;
    if (!report.root_rebuilt) continue;
    ++renewed;
    // The first one begins in the first frame, and no root has more than eight entries.
    if (renewed == 1) CHECK(frames <= 8);
    if (renewed == 1) CHECK(frames > 1);
    longest = std::max(longest, frames);
    frames = 0;
  }
  CHECK(renewed > 3);
  CHECK(longest < 100);
  CHECK(tree.validate(traffic.boxes) == "");
}

TEST_CASE("what a node holds can be arranged in one way only where all of it are leaves: it is not degraded") {
  Degradation degradation;
  degradation.area_at_build_m2 = 1.0;
  degradation.area_m2 = 100.0;
  degradation.ratio_growth_sum = 100.0;
  degradation.inner_nodes = 1;
  const WideUpdater updater;
  CHECK(!updater.is_degraded(degradation));
  degradation.inner_nodes = 2;
  CHECK(updater.is_degraded(degradation));
}

TEST_CASE("the meter of steps: the base from the first 10,000 rays, then what is wasted, never less than nothing") {
  WideStepMeter meter;
  CHECK(meter.steps_per_ray() == 0.0);
  CHECK(meter.steps_at_build() == 0.0);
  meter.add({5, 0}, 0);  // no rays
  CHECK(meter.steps_per_ray() == 0.0);
  for (int frame = 0; frame < 10; ++frame) meter.add({10'000, 0}, 1000);
  CHECK(meter.steps_at_build() == 10.0);
  CHECK(meter.wasted_nodes() == 0.0);
  meter.add({13'000, 0}, 1000);
  CHECK(meter.wasted_nodes() == 3000.0);
  CHECK(meter.steps_at_build() == 10.0);
  CHECK(meter.steps_per_ray() == doctest::Approx(10.0 + 3.0 / 8.0));
  meter.add({9'000, 0}, 1000);
  CHECK(meter.wasted_nodes() == 2000.0);
  meter.add({1'000, 0}, 1000);
  CHECK(meter.wasted_nodes() == 0.0);
  meter.restart();
  CHECK(meter.steps_at_build() == 0.0);
}

TEST_CASE("steps per ray: the nodes are built anew in the frame after rays have wasted the price, not before") {
  Traffic traffic(300, 8);
  WideBvh tree = traffic.built();
  WideUpdateSettings settings = nothing_mends();
  settings.subtree_rebuild_price = 20.0;
  WideUpdater updater(settings);
  const double price = 20.0 * static_cast<double>(tree.arrays().leaves.size());
  updater.note_rays({100'000, 0}, 10'000);
  const auto spent = static_cast<std::uint64_t>(price);
  updater.note_rays({spent + 100, 0}, 10);  // 100 is what they should have taken: exactly the price
  traffic.step();
  CHECK(traffic.follow(tree, updater).rebuilt_in_place == 0);
  updater.note_rays({11, 0}, 1);
  traffic.step();
  const TreeUpdateReport report = traffic.follow(tree, updater);
  CHECK(report.rebuilt_in_place == 1);
  CHECK(report.root_rebuilt);
  CHECK(updater.steps().steps_at_build() == 0.0);  // counted anew
  traffic.step();
  CHECK(traffic.follow(tree, updater).rebuilt_in_place == 0);
}

TEST_CASE("real rays in a degraded tree waste what its steps say, and building the nodes anew brings them down") {
  Traffic traffic(300, 9);
  WideBvh tree = traffic.built(), refitted = traffic.built();
  WideUpdateSettings settings = nothing_mends();
  settings.subtree_rebuild_price = 12.0;
  WideUpdater updater(settings);
  RandomStream random(10);
  const auto steps_of = [&](const WideBvh& asked, std::size_t rays) {
    TraversalCounters spent;
    for (std::size_t ray = 0; ray < rays; ++ray) {
      asked.closest_hit(dcem_test::any_ray(random, traffic.mesh, asked.bounds()), {}, &spent);
    }
    return spent;
  };
  std::uint64_t rebuilt_in_place = 0;
  for (int frame = 0; frame < 150; ++frame) {
    traffic.step();
    traffic.follow(refitted, with(TreePolicy::refit_only));
    rebuilt_in_place += traffic.follow(tree, updater).rebuilt_in_place;
    updater.note_rays(steps_of(tree, 1000), 1000);
  }
  CHECK(rebuilt_in_place >= 1);
  CHECK(rebuilt_in_place < 30);
  CHECK(steps_of(tree, 5000).nodes_visited < 0.8 * static_cast<double>(steps_of(refitted, 5000).nodes_visited));
}

TEST_CASE(
    "objects that drive, bend, vanish and return: whatever is switched on, the oracle's answers and the same bits") {
  using Change = void (*)(WideUpdateSettings&);
  const std::vector<Change> changes{[](WideUpdateSettings&) {},
                                    [](WideUpdateSettings& settings) { settings.rotations_per_node = 2; },
                                    [](WideUpdateSettings& settings) { settings.sah_growth_limit = 1.02; },
                                    [](WideUpdateSettings& settings) { settings.deformation_limit = 0.02; },
                                    [](WideUpdateSettings& settings) { settings.subtree_rebuild_price = 0.01; },
                                    [](WideUpdateSettings& settings) { settings.subtree_rebuilds = false; },
                                    [](WideUpdateSettings& settings) { settings.rebuild_growth_limit = 1.01; }};
  for (std::size_t index = 0; index < changes.size(); ++index) {
    CAPTURE(index);
    dcem_test::WideTraffic traffic({60, 12.0, true, true, true}, 20 + index);
    WideBvh tree = traffic.built();
    WideUpdateSettings settings;
    settings.check_interval = index % 2 == 0 ? 1 : 3;
    changes[index](settings);
    WideUpdater updater(settings);
    RandomStream random(30);
    TreeUpdateReport sum;
    for (int frame = 0; frame < 150; ++frame) {
      CAPTURE(frame);
      traffic.step();
      const TreeUpdateReport report = updater.update(tree, traffic.moved, traffic.mesh.view(), traffic.boxes);
      updater.note_rays({static_cast<std::uint64_t>(60'000 + 100 * frame), 0}, 5000);
      sum.rebuilt_in_place += report.rebuilt_in_place;
      sum.rotated += report.rotated;
      dcem_test::check_answers(tree, traffic, frame % 10 == 0 ? 20 : 2, random);
    }
    // Plans differ in their number of nodes; what is freed is used again.
    CHECK(tree.arrays().nodes.size() <= 2 * traffic.built().arrays().nodes.size());
    if (index >= 2 && index <= 4) CHECK(sum.rebuilt_in_place > 10);
    CHECK((sum.rotated > 0) == (index == 1));
  }
}

TEST_CASE("by default no frame of a drive builds the whole tree anew, and none ends worse than a new tree") {
  Traffic traffic(300, 11);
  WideBvh tree = traffic.built();
  WideUpdater updater;
  const double sah_at_build = tree.quality().sah_at_build;
  for (int frame = 0; frame < 300; ++frame) {
    traffic.step();
    traffic.follow(tree, updater);
    REQUIRE(tree.quality().sah_at_build == sah_at_build);
  }
  CHECK(tree.sah_cost() < 1.15 * traffic.built().sah_cost());
}

TEST_CASE("objects that were away and come all at once: the tree is as good as new") {
  Traffic traffic(300, 5);
  traffic.mesh.absent.assign(traffic.mesh.triangles.size(), true);
  traffic.mesh.absent[0] = traffic.mesh.absent[1] = false;  // something is there, so that the tree has a size
  traffic.boxes = traffic.mesh.boxes();
  WideBvh whole = traffic.built(), grown = traffic.built();
  traffic.mesh.absent.assign(traffic.mesh.triangles.size(), false);
  traffic.boxes = traffic.mesh.boxes();
  TreeUpdateReport report = traffic.follow(whole, with(TreePolicy::adaptive));
  CHECK(report.root_rebuilt);
  CHECK(report.sah_cost < 1.02 * traffic.built().sah_cost());
  // What the whole build is not needed for.
  WideUpdateSettings settings = nothing_mends();
  settings.sah_growth_limit = 1.2;
  report = traffic.follow(grown, settings);
  CHECK(report.rebuilt_in_place > 0);
  CHECK(report.sah_cost < 1.02 * traffic.built().sah_cost());
}

TEST_CASE("a large object whose triangles drift apart: its leaves are built anew where nothing else mends them") {
  RandomStream random(12);
  dcem_test::WideMesh mesh = dcem_test::bent_ground(30, 0.0, 13);  // more quads than an object has
  const std::vector<Vec3> at_rest = mesh.vertices;
  std::vector<std::uint32_t> all(mesh.triangles.size());
  std::iota(all.begin(), all.end(), 0U);
  WideBvh tree;
  tree.build(mesh.view(), mesh.boxes());
  WideUpdater updater;
  // Rows and columns change places: neighbours are far apart.
  for (std::size_t vertex = 0; vertex < at_rest.size(); ++vertex) {
    mesh.vertices[vertex] = at_rest[(vertex * 7) % at_rest.size()] + dcem_test::random_in_cube(random, 0.1);
  }
  const TreeUpdateReport report = updater.update(tree, all, mesh.view(), mesh.boxes());
  WideBvh fresh;
  fresh.build(mesh.view(), mesh.boxes());
  CHECK(report.root_rebuilt);
  CHECK(report.sah_cost < 1.05 * fresh.sah_cost());
  CHECK(tree.validate(mesh.boxes()) == "");
}

TEST_CASE("limits that are no limits are refused") {
  const auto refuses = [](auto&& change) {
    WideUpdateSettings settings;
    change(settings);
    CHECK_THROWS_AS(WideUpdater{settings}, std::invalid_argument);
  };
  for (const double growth : {0.9, 0.0, -1.0, dcem_test::not_a_number}) {
    refuses([&](WideUpdateSettings& settings) { settings.reinsertion_growth = growth; });
    refuses([&](WideUpdateSettings& settings) { settings.rebuild_growth_limit = growth; });
    if (growth != 0.9) refuses([&](WideUpdateSettings& settings) { settings.subtree_rebuild_price = growth; });
  }
  refuses([](WideUpdateSettings& settings) { settings.rebuild_growth_limit = 1.0; });
  refuses([](WideUpdateSettings& settings) { settings.check_interval = 0; });
}

}  // namespace test_wide_updater
