#include <doctest/doctest.h>

#include <bit>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "dcem/accel/wide_maintainer.hpp"
#include "tests/accel/wide_scenes.hpp"

using namespace dcem;
using dcem_test::infinity;
using dcem_test::WideMesh;

namespace {

/// Cubes that drive over a plain, one group each, and the trees over them.
class Traffic {
 public:
  Traffic(std::size_t cars, std::uint64_t seed) : random_(seed) {
    for (std::size_t car = 0; car < cars; ++car) {
      group_first.push_back(static_cast<std::uint32_t>(mesh.triangles.size()));
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
  WideTree built() const {
    WideTree tree;
    tree.build_grouped(mesh.view(), boxes, group_first);
    return tree;
  }
  UpkeepReport follow(WideTree& tree, const UpkeepSettings& settings) const {
    const UpkeepReport report = WideMaintainer(settings).update(tree, moved, mesh.view(), boxes);
    REQUIRE(tree.validate(boxes) == "");
    REQUIRE(report.sah_cost == tree.sah_cost());
    return report;
  }

  WideMesh mesh;
  std::vector<std::uint32_t> group_first, moved;
  std::vector<Aabb<double>> boxes;

 private:
  RandomStream random_;
  std::vector<Vec3> speed_;
};

UpkeepSettings with(TreePolicy policy) {
  UpkeepSettings settings;
  settings.policy = policy;
  return settings;
}

}  // namespace

TEST_CASE("nothing moved: nothing is touched, whatever the policy") {
  const Traffic traffic(50, 1);
  for (const TreePolicy policy : {TreePolicy::rebuild_always, TreePolicy::refit_only, TreePolicy::adaptive}) {
    WideTree tree = traffic.built();
    const double sah = tree.sah_cost();
    const UpkeepReport report = WideMaintainer(with(policy)).update(tree, {}, traffic.mesh.view(), traffic.boxes);
    CHECK(report.nodes_refit + report.nodes_rebuilt + report.subtrees_rebuilt == 0);
    CHECK(report.nodes_kept > 50);  // a block for each car, and the nodes above
    CHECK(std::bit_cast<std::uint64_t>(tree.sah_cost()) == std::bit_cast<std::uint64_t>(sah));
  }
}

TEST_CASE("a drive: refit alone wears out, reinsertion stays near a new tree, and all hit the same bits") {
  Traffic traffic(200, 2);
  WideTree refitted = traffic.built(), adaptive = traffic.built();
  UpkeepSettings never_anew = with(TreePolicy::adaptive);
  never_anew.sah_growth_limit = infinity;  // reinsertion alone
  RandomStream random(3);
  std::uint64_t hung_elsewhere = 0;
  for (int frame = 0; frame < 200; ++frame) {
    traffic.step();
    traffic.follow(refitted, with(TreePolicy::refit_only));
    const UpkeepReport report = traffic.follow(adaptive, never_anew);
    hung_elsewhere += report.subtrees_rebuilt;
    CHECK(!report.root_rebuilt);
    const WideTree fresh = traffic.built();
    for (int trial = 0; trial < 20; ++trial) {
      const Ray<double> ray = dcem_test::any_ray(random, traffic.mesh, fresh.bounds());
      const auto expected = fresh.nearest(ray);
      for (const WideTree* tree : {&refitted, &adaptive}) {
        const auto found = tree->nearest(ray);
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
  CHECK(hung_elsewhere > 200);
  // Every car has crossed half of the plain: neighbours at the start are strangers now.
  CHECK(refitted.sah_cost() > 2.0 * fresh_sah);
  CHECK(adaptive.sah_cost() < 1.2 * fresh_sah);
}

TEST_CASE("both kinds of reinsertion have a switch: off, adaptive is refit") {
  Traffic traffic(100, 4);
  WideTree refitted = traffic.built(), switched_off = traffic.built();
  UpkeepSettings off = with(TreePolicy::adaptive);
  off.reinsertion_growth = off.sah_growth_limit = infinity;
  off.reinsertion_turn = 0;
  for (int frame = 0; frame < 50; ++frame) {
    traffic.step();
    const UpkeepReport expected = traffic.follow(refitted, with(TreePolicy::refit_only));
    CHECK(traffic.follow(switched_off, off) == expected);
    CHECK(expected.nodes_rebuilt == 0);
  }
}

TEST_CASE("objects that were away and come all at once: the tree is built anew and as good as new") {
  Traffic traffic(300, 5);
  traffic.mesh.absent.assign(traffic.mesh.triangles.size(), true);
  traffic.mesh.absent[0] = traffic.mesh.absent[1] = false;  // something is there, so that the tree has a size
  traffic.boxes = traffic.mesh.boxes();
  WideTree tree = traffic.built();
  traffic.mesh.absent.assign(traffic.mesh.triangles.size(), false);
  traffic.boxes = traffic.mesh.boxes();
  const UpkeepReport report = traffic.follow(tree, with(TreePolicy::adaptive));
  CHECK(report.root_rebuilt);
  CHECK(report.sah_cost == doctest::Approx(traffic.built().sah_cost()).epsilon(1e-12));
  CHECK(report.nodes_kept == 0);
}

TEST_CASE("limits that are no limits are refused") {
  for (const double growth : {0.9, 0.0, -1.0, dcem_test::not_a_number}) {
    UpkeepSettings settings;
    settings.reinsertion_growth = growth;
    CHECK_THROWS_AS(WideMaintainer{settings}, std::invalid_argument);
  }
}
