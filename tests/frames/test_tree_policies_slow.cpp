/// Every policy of keeping a tree answers every question as the oracle does, in every frame of randomized drives.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "dcem/accel/binary/updater.hpp"
#include "dcem/accel/brute_force.hpp"
#include "tests/accel/random_boxes.hpp"

namespace test_tree_policies_slow {

using namespace dcem;
using dcem_test::between;
using dcem_test::nearest_square;
using dcem_test::reported;

namespace {

using Numbers = std::vector<std::uint32_t>;

/// How a drive looks.
struct Traffic {
  std::size_t objects = 12;
  std::size_t largest = 14;  ///< primitives of one object
  double roam_m = 10.0;
  double teleports = 0.03, leaves = 0.03, comes = 0.2, stands = 0.3, deforms = 0.1;  ///< chances per object and frame
};

template <class Scalar>
class Drive {
 public:
  using Boxes = dcem_test::Boxes<Scalar>;

  Drive(const Traffic& traffic, std::uint64_t seed) : traffic_(traffic), random_(seed) {
    for (std::size_t index = 0; index < traffic.objects; ++index) {
      first_.push_back(static_cast<std::uint32_t>(shapes_.size()));
      const std::uint64_t primitives = random_.next() % (traffic.largest + 1);  // none, too
      for (std::uint64_t part = 0; part < primitives; ++part) shapes_.push_back(dcem_test::random_box<Scalar>(random_));
      at_m_.push_back(somewhere());
      step_m_.push_back(dcem_test::random_point<Scalar>(random_, traffic.roam_m / 30));
      present_.push_back(random_.uniform() < 0.7);
    }
    for (Aabb<Scalar>& shape : shapes_) {  // a shape is small and near its own origin
      const Vector3<Scalar> low = shape.min * Scalar(0.1), size = shape.max - shape.min;
      shape = {low, low + size};
    }
    boxes_.resize(shapes_.size());
    for (std::size_t index = 0; index < traffic.objects; ++index) place(index);
  }

  const Boxes& boxes() const { return boxes_; }
  const Numbers& first() const { return first_; }

  /// One frame; returns the primitives that moved.
  Numbers step() {
    Numbers moved;
    for (std::size_t index = 0; index < first_.size(); ++index) {
      const double chance = random_.uniform();
      if (!present_[index]) {
        present_[index] = chance < traffic_.comes;
        if (!present_[index]) continue;
        at_m_[index] = somewhere();
      } else if (chance < traffic_.leaves) {
        present_[index] = false;
      } else if (chance < traffic_.leaves + traffic_.teleports) {
        at_m_[index] = somewhere();
      } else if (chance < traffic_.leaves + traffic_.teleports + traffic_.stands) {
        continue;
      } else {
        at_m_[index] += step_m_[index];
      }
      if (random_.uniform() < traffic_.deforms) deform(index);
      place(index);
      for (std::uint32_t primitive = first_[index]; primitive < end(index); ++primitive) moved.push_back(primitive);
    }
    return moved;
  }

  /// Most aim at a box that is there, from anywhere or from within another.
  Ray<Scalar> ray() {
    Ray<Scalar> ray = dcem_test::random_ray<Scalar>(random_);
    const Aabb<Scalar> from = any_box(), to = any_box();
    if (random_.uniform() < 0.2 || from.empty() || to.empty()) return ray;
    ray.origin = random_.uniform() < 0.5 ? from.center() : somewhere();
    ray.direction = within(to) - ray.origin;
    if (random_.uniform() < 0.3) ray.t_max = 1;
    return ray;
  }
  /// Most lie about a box that is there.
  Aabb<Scalar> region() {
    const Aabb<Scalar> box = any_box();
    const Aabb<Scalar> region = dcem_test::random_box<Scalar>(random_);
    const Vector3<Scalar> at = box.empty() || random_.uniform() < 0.2 ? somewhere() : within(box);
    return {at, at + (region.max - region.min)};
  }

 private:
  std::size_t end(std::size_t index) const { return index + 1 < first_.size() ? first_[index + 1] : shapes_.size(); }
  Vector3<Scalar> somewhere() { return dcem_test::random_point<Scalar>(random_, traffic_.roam_m); }

  Aabb<Scalar> any_box() { return boxes_.empty() ? Aabb<Scalar>{} : boxes_[random_.next() % boxes_.size()]; }
  Vector3<Scalar> within(const Aabb<Scalar>& box) {
    const auto share = static_cast<Scalar>(random_.uniform());
    return box.min + share * (box.max - box.min);
  }

  /// As a turned object: its boxes are others, in other places.
  void deform(std::size_t index) {
    for (std::size_t primitive = first_[index]; primitive < end(index); ++primitive) {
      const Vector3<Scalar> size = shapes_[primitive].max - shapes_[primitive].min;
      const auto low = dcem_test::random_point<Scalar>(random_, 1.5);
      shapes_[primitive] = {low, low + Vector3<Scalar>(size.y, size.z, size.x)};
    }
  }
  void place(std::size_t index) {
    for (std::size_t primitive = first_[index]; primitive < end(index); ++primitive) {
      boxes_[primitive] = {};
      if (!present_[index]) continue;
      boxes_[primitive] = {shapes_[primitive].min + at_m_[index], shapes_[primitive].max + at_m_[index]};
    }
  }

  Traffic traffic_;
  RandomStream random_;
  Boxes shapes_, boxes_;
  Numbers first_;
  std::vector<Vector3<Scalar>> at_m_, step_m_;
  std::vector<bool> present_;
};

constexpr std::array policies{TreePolicy::rebuild_always, TreePolicy::refit_only, TreePolicy::adaptive};

/// What a drive has put to the test.
struct Tally {
  std::uint64_t frames = 0, hits = 0, occluded = 0, found = 0, regional = 0, rebuilt = 0, roots = 0;

  Tally& operator+=(const Tally& other) {
    frames += other.frames;
    hits += other.hits;
    occluded += other.occluded;
    found += other.found;
    regional += other.regional;
    rebuilt += other.rebuilt;
    roots += other.roots;
    return *this;
  }
};

template <class Scalar>
Tally follow(const Traffic& traffic, std::uint64_t seed, int frames, int questions) {
  Drive<Scalar> drive(traffic, seed);
  BruteForce<Scalar> oracle;
  BruteForceUpdater<Scalar> oracle_maintainer;
  oracle.build_objects(drive.boxes(), drive.first());
  std::array<Bvh<Scalar>, policies.size()> trees;
  std::vector<BvhUpdater<Scalar>> updaters;
  for (std::size_t index = 0; index < policies.size(); ++index) {
    TreeUpdateSettings settings;
    settings.policy = policies[index];
    updaters.emplace_back(settings);
    trees[index].build_objects(drive.boxes(), drive.first());
  }
  Tally tally;
  for (int frame = 0; frame < frames; ++frame, ++tally.frames) {
    CAPTURE(frame);
    const Numbers moved = drive.step();
    const auto& boxes = drive.boxes();
    oracle_maintainer.update(oracle, moved, boxes);
    for (std::size_t index = 0; index < trees.size(); ++index) {
      const TreeUpdateReport report = updaters[index].update(trees[index], moved, boxes);
      if (policies[index] == TreePolicy::adaptive) {
        tally.rebuilt += report.subtrees_rebuilt;
        tally.roots += report.root_rebuilt ? 1U : 0U;
      }
      REQUIRE(trees[index].validate(boxes) == "");
    }
    for (int question = 0; question < questions; ++question) {
      const Ray<Scalar> ray = drive.ray();
      const Aabb<Scalar> region = drive.region();
      const auto leaves = [&](std::uint32_t primitive) {
        return !std::isnan(dcem_test::meet_square(boxes[primitive], static_cast<int>(primitive % 3), ray));
      };
      const auto closest_hit = nearest_square(oracle, boxes, ray);
      const bool any = oracle.any(ray, leaves);
      const Numbers all = reported([&](auto leaf) { oracle.all(ray, leaf); });
      const Numbers inside = reported([&](auto leaf) { oracle.overlapping(region, leaf); });
      tally.hits += closest_hit.primitive != 0xffffffffU ? 1U : 0U;
      tally.occluded += any ? 1U : 0U;
      tally.found += all.size();
      tally.regional += inside.size();
      for (const Bvh<Scalar>& tree : trees) {
        REQUIRE(nearest_square(tree, boxes, ray).t == closest_hit.t);
        REQUIRE(tree.any(ray, leaves) == any);
        REQUIRE(reported([&](auto leaf) { tree.all(ray, leaf); }) == all);
        REQUIRE(reported([&](auto leaf) { tree.overlapping(region, leaf); }) == inside);
      }
    }
  }
  return tally;
}

/// Questions that all miss prove nothing.
void check_that_something_was_met(const Tally& tally) {
  CHECK(tally.hits > tally.frames / 2);
  CHECK(tally.occluded >= tally.hits);
  CHECK(tally.found > tally.frames);
  CHECK(tally.regional > tally.frames);
  CHECK(tally.rebuilt > 0);
  CHECK(tally.roots < tally.rebuilt);
}

}  // namespace

TEST_CASE_TEMPLATE("small scenes: every policy equals the oracle in every frame", Scalar, float, double) {
  Tally tally;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    CAPTURE(seed);
    Traffic traffic;
    traffic.objects = 1 + seed % 16;
    traffic.largest = seed % 5 == 0 ? 1 : 4 + seed % 20;
    tally += follow<Scalar>(traffic, seed, 80, 8);
  }
  CHECK(tally.frames == 2400);
  check_that_something_was_met(tally);
}

TEST_CASE("a town's worth of objects on a long drive") {
  Traffic traffic;
  traffic.objects = 150;
  traffic.largest = 12;
  traffic.roam_m = 40.0;
  traffic.teleports = 0.002;
  traffic.leaves = traffic.comes = 0.01;
  const Tally tally = follow<double>(traffic, 77, 400, 12);
  check_that_something_was_met(tally);
}

TEST_CASE("everything comes and goes all the time") {
  Tally tally;
  for (std::uint64_t seed = 200; seed < 210; ++seed) {
    Traffic traffic;
    traffic.comes = 0.5;
    traffic.leaves = 0.5;
    traffic.stands = 0.0;
    tally += follow<double>(traffic, seed, 100, 8);
  }
  check_that_something_was_met(tally);
}

TEST_CASE_TEMPLATE("coordinates as large and as small as a tree accepts", Scalar, float, double) {
  // A float's squares end at 1e38 and begin at 1e-45: surfaces there are zero, and questions are answered all the same.
  for (const double roam_m : {1e14, 1e9, 1e-6, 1e-30}) {
    CAPTURE(roam_m);
    Tally tally;
    for (std::uint64_t seed = 300; seed < 304; ++seed) {
      CAPTURE(seed);
      Traffic traffic;
      traffic.roam_m = roam_m;
      tally += follow<Scalar>(traffic, seed, 60, 6);
    }
    CHECK(tally.frames == 240);
    CHECK(tally.hits > tally.frames / 2);
  }
}

TEST_CASE("tiny boxes: surfaces below the smallest number, ratios beyond the largest") {
  RandomStream random(5);
  for (const double scale : {1e-80, 1e-156, 1e-160, 1e-300}) {
    CAPTURE(scale);
    dcem_test::Boxes<double> boxes(60);
    Numbers first, all;
    for (std::uint32_t primitive = 0; primitive < 60; ++primitive) {
      if (primitive % 3 == 0) first.push_back(primitive);
      all.push_back(primitive);
    }
    const auto draw = [&] {
      for (auto& box : boxes) {
        const double far = random.uniform() < 0.3 ? 1e14 : scale;
        const Vec3 at = far * dcem_test::random_point<double>(random, 1.0);
        box = {at, at + scale * Vec3(random.uniform(), random.uniform(), random.uniform())};
      }
    };
    draw();
    Bvh<double> tree;
    BruteForce<double> oracle;
    tree.build_objects(boxes, first);
    oracle.build_objects(boxes, first);
    BvhUpdater<double> updater;
    for (int frame = 0; frame < 40; ++frame) {
      draw();
      const TreeUpdateReport report = updater.update(tree, all, boxes);
      oracle.refit_all(boxes);
      CHECK(std::isfinite(report.sah_cost));
      CHECK(tree.validate(boxes) == "");
      for (int question = 0; question < 5; ++question) {
        const Vec3 aim = boxes[random.next() % 60].center(), from = boxes[random.next() % 60].center();
        const Ray<double> ray = segment_between(from, aim);
        REQUIRE(reported([&](auto leaf) { tree.all(ray, leaf); }) ==
                reported([&](auto leaf) { oracle.all(ray, leaf); }));
      }
    }
  }
}

}  // namespace test_tree_policies_slow
