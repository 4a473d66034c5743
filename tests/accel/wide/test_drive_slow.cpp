#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <new>
#include <string>
#include <vector>

#include "dcem/accel/wide/update/updater.hpp"
#include "dcem/accel/wide_bvh.hpp"
#include "tests/accel/wide/wide_scenes.hpp"
#include "tests/support/counted_allocations.hpp"
#include "tests/support/shared_data.hpp"

namespace test_drive_slow {

using namespace dcem;
using dcem_test::allocations;
using dcem_test::any_ray;
using dcem_test::between;
using dcem_test::fault_of_closest;
using dcem_test::hits_on_line;
using dcem_test::infinity;
using dcem_test::random_in_cube;
using dcem_test::text_of;
using dcem_test::WideMesh;

namespace {

enum class Policy { refit_only, reinsert, reinsert_late, reinsert_never, rebuild };

/// A ground, and objects of triangles that drive about, bend, go and come back.
class Drive {
 public:
  /// `deforms`: some of the objects change their shape.
  Drive(std::uint32_t object_count, bool deforms, std::uint64_t seed) : random_(seed), deforms_(deforms) {
    append(dcem_test::bent_ground(12, 1e-4, seed));
    for (std::uint32_t object = 1; object <= object_count; ++object) {
      const double size = between(random_, 0.2, 1.5);
      if (object % 5 == 0) {
        append(dcem_test::ball(Vec3(0), size, 4));
      } else if (object % 5 == 1) {
        append(dcem_test::soup(20, object, 1.0).changed([](const Vec3& vertex) { return 0.1 * vertex; }));
      } else {
        append(dcem_test::box_mesh(Vec3(-size, -0.5 * size, 0.01), Vec3(size, 0.5 * size, size)));
      }
    }
    object_first_.pop_back();
    mesh.absent.assign(mesh.triangles.size(), false);
    at_rest_ = mesh.vertices;
    state_.resize(object_first_.size());
    for (State& state : state_) {
      state.position = random_in_cube(random_, 8.0) * Vec3(1, 1, 0.1);
      state.speed = random_in_cube(random_, 0.3) * Vec3(1, 1, 0.1);
    }
    for (std::uint32_t object = 1; object < object_first_.size(); ++object) place(object);
    boxes = mesh.boxes();
  }

  /// One frame: a third of the objects move, some vanish, some return.
  void step() {
    moved.clear();
    for (std::uint32_t object = 1; object < object_first_.size(); ++object) {
      State& state = state_[object];
      const double kind = random_.uniform();
      if (kind > 0.4) continue;
      if (kind < 0.03) state.is_gone = !state.is_gone;
      if (kind > 0.39) state.position = random_in_cube(random_, 20.0);
      state.position += state.speed;
      for (int axis = 0; axis < 3; ++axis) {
        if (std::abs(state.position[axis]) > 12.0) state.speed[axis] = -std::copysign(0.2, state.position[axis]);
      }
      state.turn += 0.1;
      place(object);
    }
  }

  void build(WideBvh& tree) const {
    WideBuildSettings settings;
    settings.object_subtree_limit = 100;  // the ground is larger: it is mixed with the objects
    tree.build_objects(mesh.view(), boxes, object_first_, settings);
  }

  WideMesh mesh;
  std::vector<Aabb<double>> boxes;
  std::vector<std::uint32_t> moved;

 private:
  struct State {
    Vec3 position{0.0}, speed{0.0};
    double turn = 0.0;
    bool is_gone = false;
  };

  void append(const WideMesh& part) {
    mesh.append(part);
    object_first_.push_back(static_cast<std::uint32_t>(mesh.triangles.size()));
    vertex_first_.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
  }
  std::uint32_t last_triangle(std::uint32_t object) const {
    return object + 1 < object_first_.size() ? object_first_[object + 1]
                                             : static_cast<std::uint32_t>(mesh.triangles.size());
  }

  void place(std::uint32_t object) {
    const State& state = state_[object];
    const double cosine = std::cos(state.turn), sine = std::sin(state.turn);
    const bool bends = deforms_ && object % 3 == 0;
    for (std::uint32_t vertex = vertex_first_[object - 1]; vertex < vertex_first_[object]; ++vertex) {
      const Vec3 own = at_rest_[vertex] + (bends ? random_in_cube(random_, 0.4) : Vec3(0.0));
      mesh.vertices[vertex] =
          state.position + Vec3(cosine * own.x - sine * own.y, sine * own.x + cosine * own.y, own.z);
    }
    for (std::uint32_t triangle = object_first_[object]; triangle < last_triangle(object); ++triangle) {
      mesh.absent[triangle] = state.is_gone;
      moved.push_back(triangle);
      if (boxes.empty()) continue;
      boxes[triangle] = {};
      if (state.is_gone) continue;
      for (const Vec3& corner : mesh.corners(triangle)) boxes[triangle].extend(corner);
    }
  }

  RandomStream random_;
  bool deforms_;
  std::vector<std::uint32_t> object_first_{0};
  std::vector<std::uint32_t> vertex_first_;
  std::vector<Vec3> at_rest_;
  std::vector<State> state_;
};

void follow(WideBvh& tree, Policy policy, const Drive& drive) {
  if (policy == Policy::rebuild) {
    tree.rebuild(drive.mesh.view(), drive.boxes);
    return;
  }
  tree.refit(drive.moved, drive.mesh.view(), drive.boxes);
  if (policy == Policy::reinsert) tree.reinsert_moved(1.0);
  if (policy == Policy::reinsert_late) tree.reinsert_moved(1.1);
  if (policy == Policy::reinsert_never) REQUIRE(tree.reinsert_moved(infinity, 0) == 0);
}

constexpr Policy policies[] = {Policy::refit_only, Policy::reinsert, Policy::reinsert_late, Policy::reinsert_never,
                               Policy::rebuild};

/// The levels of nodes below the root, itself counted.
std::uint32_t depth_of(const WideArrays& arrays, std::uint32_t node = 0) {
  std::uint32_t deepest = 0;
  for (const WideChild child : arrays.nodes[node].child) {
    if (!child.is_none() && !child.is_leaf()) deepest = std::max(deepest, depth_of(arrays, child.index()));
  }
  return deepest + 1;
}

bool same_bits(const std::optional<TriangleHit>& one, const std::optional<TriangleHit>& other) {
  if (one.has_value() != other.has_value()) return false;
  return !one || (std::bit_cast<std::uint64_t>(one->t) == std::bit_cast<std::uint64_t>(other->t) &&
                  one->triangle == other->triangle);
}

/// All trees give the oracle's answers, and the same bits.
void check_frame(const std::vector<WideBvh>& trees, const Drive& drive, int rays, RandomStream& random) {
  Aabb<double> bounds;
  for (const WideBvh& tree : trees) REQUIRE(tree.validate(drive.boxes) == "");
  for (const Aabb<double>& box : drive.boxes) bounds.extend(box);
  for (const WideBvh& tree : trees) {
    const Vec3 low = bounds.min - tree.arrays().origin_m, high = bounds.max - tree.arrays().origin_m;
    for (int axis = 0; axis < 3; ++axis) {
      REQUIRE(static_cast<double>(tree.arrays().extent_m) >= std::max(std::abs(low[axis]), std::abs(high[axis])));
    }
  }
  for (int trial = 0; trial < rays; ++trial) {
    const Ray<double> ray = any_ray(random, drive.mesh, bounds);
    INFO(text_of(ray));
    const auto line = hits_on_line(drive.mesh, ray);
    const auto first = trees[0].closest_hit(ray);
    const int in_the_way = dcem_test::oracle_occluded(line, ray);
    for (std::size_t tree = 0; tree < trees.size(); ++tree) {
      CAPTURE(tree);
      const auto hit = trees[tree].closest_hit(ray);
      REQUIRE(fault_of_closest(line, ray, hit) == "");
      REQUIRE(same_bits(hit, first));
      if (in_the_way >= 0) REQUIRE(trees[tree].occluded(ray) == (in_the_way == 1));
    }
  }
}

void drive_for(int frames, int rays, bool deforms, std::uint64_t seed) {
  Drive drive(50, deforms, seed);
  std::vector<WideBvh> trees(std::size(policies));
  for (WideBvh& tree : trees) drive.build(tree);
  RandomStream random(seed + 1);
  for (int frame = 0; frame < frames; ++frame) {
    CAPTURE(frame);
    drive.step();
    for (std::size_t tree = 0; tree < trees.size(); ++tree) follow(trees[tree], policies[tree], drive);
    check_frame(trees, drive, rays, random);
  }
}

}  // namespace

TEST_CASE("rigid objects that drive, go and return: the oracle's answers, the same bits whatever the tree") {
  drive_for(200, 40, false, 1);
}

TEST_CASE("objects that bend: the oracle's answers, the same bits whatever the tree") {
  drive_for(200, 40, true, 2);
}

TEST_CASE("3,000 frames: no deeper, no larger, and nothing is allocated") {
  Drive drive(50, false, 11);
  std::vector<WideBvh> trees(4);
  for (WideBvh& tree : trees) drive.build(tree);
  RandomStream random(12);
  const std::uint32_t depth_at_build = depth_of(trees[0].arrays());
  std::vector<std::size_t> nodes_early(4, 0);
  std::vector<std::size_t> spent(4, 0);
  std::size_t reinserted = 0;
  for (int frame = 0; frame < 3000; ++frame) {
    drive.step();
    for (std::size_t tree = 0; tree < 4; ++tree) {
      const std::size_t before = allocations;
      const WideRefitReport report = trees[tree].refit(drive.moved, drive.mesh.view(), drive.boxes);
      if (policies[tree] == Policy::reinsert) reinserted += trees[tree].reinsert_moved(1.0);
      if (policies[tree] == Policy::reinsert_late) trees[tree].reinsert_moved(1.1);
      if (frame >= 1500) spent[tree] += allocations - before;
      REQUIRE(report.leaves_written <= drive.moved.size());
      if (frame == 1500) nodes_early[tree] = trees[tree].arrays().nodes.size();
    }
    if (frame % 100 == 0) check_frame(trees, drive, 20, random);
  }
  CHECK(reinserted > 1000);
  for (std::size_t tree = 0; tree < 4; ++tree) {
    CAPTURE(tree);
    REQUIRE(trees[tree].validate(drive.boxes) == "");
    // The heap of branches may still grow to its longest once or twice.
    CHECK(spent[tree] <= (policies[tree] == Policy::reinsert || policies[tree] == Policy::reinsert_late ? 2U : 0U));
    // Free nodes are used again: what grows is the largest number that one frame needed, and seldom.
    CHECK(trees[tree].arrays().nodes.size() <= nodes_early[tree] + 2);
    CHECK(depth_of(trees[tree].arrays()) <= depth_at_build + 6);
  }
  CHECK(trees[1].sah_cost() < trees[0].sah_cost());
}

TEST_CASE("3,000 frames as the updater keeps it, parts built anew: next to nothing is allocated") {
  Drive drive(50, false, 13);
  WideBvh tree;
  drive.build(tree);
  WideUpdateSettings settings;
  settings.renewal_ratio = 8.0;
  settings.check_interval = 5;
  settings.sah_growth_limit = settings.deformation_limit = 1.1;
  WideUpdater updater(settings);
  std::size_t spent = 0;
  std::uint64_t rebuilt_in_place = 0;
  for (int frame = 0; frame < 3000; ++frame) {
    drive.step();
    const std::size_t before = allocations;
    const TreeUpdateReport report = updater.update(tree, drive.moved, drive.mesh.view(), drive.boxes);
    if (frame < 1500) continue;
    spent += allocations - before;
    rebuilt_in_place += report.rebuilt_in_place;
  }
  CHECK(rebuilt_in_place > 100);
  // The lists may still grow to their longest once or twice; each part built anew would take a dozen.
  CHECK(spent <= 8);
  CHECK(tree.validate(drive.boxes) == "");
}

TEST_CASE("the counter of allocations counts") {
  const std::size_t before = allocations;
  // Called by name: compilers leave out a new and delete that nobody would miss.
  void* memory = ::operator new(400);
  ::operator delete(memory);
  CHECK(allocations > before);
  std::vector<QuadLeaf> aligned(3);
  CHECK(reinterpret_cast<std::uintptr_t>(aligned.data()) % 64 == 0);
}

TEST_CASE("a million triangles: the oracle's answers") {
  for (const double size : {0.05, 1.0}) {
    const WideMesh mesh = dcem_test::soup(1'000'000, 21, size);
    const auto boxes = mesh.boxes();
    WideBvh tree;
    tree.build(mesh.view(), boxes);
    REQUIRE(tree.validate(boxes) == "");
    RandomStream random(22);
    const Aabb<double> bounds = tree.bounds();
    for (int trial = 0; trial < 60; ++trial) {
      const Ray<double> ray = any_ray(random, mesh, bounds);
      INFO(text_of(ray));
      const auto line = hits_on_line(mesh, ray);
      REQUIRE(fault_of_closest(line, ray, tree.closest_hit(ray)) == "");
      const int in_the_way = dcem_test::oracle_occluded(line, ray);
      if (in_the_way >= 0) REQUIRE(tree.occluded(ray) == (in_the_way == 1));
    }
  }
}

TEST_CASE("a million rays at edges and corners of closed meshes, through all trees of a drive: none leaks") {
  for (const WideMesh& mesh : {dcem_test::box_mesh(Vec3(-1.1, -0.7, -0.3), Vec3(0.9, 1.3, 0.77)),
                               dcem_test::ball(Vec3(3e3, 2e3, 10), 1.0, 30), dcem_test::ball(Vec3(0.1), 1.0, 5)}) {
    WideBvh tree;
    tree.build(mesh.view(), mesh.boxes());
    RandomStream random(31);
    Aabb<double> bounds = tree.bounds();
    for (int trial = 0; trial < 350000; ++trial) {
      const auto corners = mesh.corners(static_cast<std::uint32_t>(random.next() % mesh.triangles.size()));
      const double along = trial % 3 == 0 ? 0.0 : random.uniform();
      const Vec3 from = bounds.center() + random_in_cube(random, 0.2);
      const Ray<double> ray{from, corners[0] + along * (corners[1] - corners[0]) - from};
      const auto hit = tree.closest_hit(ray);
      if (hit && std::abs(hit->t - 1.0) < 1e-9 && tree.occluded(ray)) continue;
      INFO(text_of(ray));
      FAIL("a ray leaks");
    }
  }
}

}  // namespace test_drive_slow
