/// Sampled search finds the way round one house, to a wall that neither end sees, and round another house; with memory
/// it keeps it, and the bits do not depend on threads.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "tests/support/law_scenes.hpp"

namespace test_mirror_between_edges {

using namespace dcem;
using namespace dcem::test;

namespace {

SimulationSettings over_two_edges(Discovery discovery) {
  SimulationSettings settings = law_settings(1, 0, discovery);
  settings.propagation.max_diffractions = 2;
  settings.propagation.max_interactions = 3;
  return settings;
}

/// Two high houses, and a wall 15 m behind them that is seen from between them only. The ends stand at z = 0 before the
/// houses, each five metres beside and before a corner.
Patches two_houses_and_a_wall() {
  Patches patches = box_faces(Vec3(-20, 0, -60), Vec3(-10, 5, 60), "pec");
  for (const Patch& face : box_faces(Vec3(10, 0, -60), Vec3(20, 5, 60), "pec")) patches.push_back(face);
  patches.push_back({{Vec3(-5, 20, -40), Vec3(5, 20, -40), Vec3(5, 20, 40), Vec3(-5, 20, 40)}, "pec"});
  return patches;
}

Scene scene_with_ends() {
  Scene scene = scene_through_files(two_houses_and_a_wall());
  scene.add_transmitter(device_at("tx", Vec3(-15, -5, 0), 0.0, antenna(PolarizationKind::dual)));
  scene.add_receiver(device_at("rx", Vec3(15, -5, 0), 0.0, antenna(PolarizationKind::dual)));
  return scene;
}

/// By name, the paths of the one link.
std::map<std::string, PathContribution> by_id(const Scene& scene, const LinkResult& link) {
  std::map<std::string, PathContribution> paths;
  for (const PathContribution& path : link.paths) paths.emplace(path_id(scene, path.path), path);
  return paths;
}

/// Over the corners at x = ∓10, y = 0 and the middle of the wall: 2·√(5² + 5²) + 2·√(10² + 20²).
bool is_round_both_houses(const PathContribution& path) {
  const double length_m = 2.0 * std::sqrt(50.0) + 2.0 * std::sqrt(500.0);
  return kinds(path) == "DRD" && std::abs(path.path.length_m - length_m) < 1e-9 &&
         glm::distance(path.path.interactions[1].point_m, Vec3(0, 20, 0)) < 1e-9;
}

}  // namespace

TEST_CASE("a mirror between two edges is found by rays that leave the edges") {
  const Scene scene = scene_with_ends();
  Simulator exact(scene, over_two_edges(Discovery::exact)), sampled(scene, over_two_edges(Discovery::sampled));
  const auto all = by_id(scene, exact.advance_to(0.0).links.at(0));
  const auto found = by_id(scene, sampled.advance_to(0.0).links.at(0));
  const auto count = [](const auto& paths) {
    return std::count_if(paths.begin(), paths.end(), [](const auto& one) { return is_round_both_houses(one.second); });
  };
  CHECK(count(all) == 1);
  CHECK(count(found) == 1);
  for (const auto& [id, path] : found) {
    REQUIRE_MESSAGE(all.contains(id), id);
    CHECK(all_numbers(path) == all_numbers(all.at(id)));
  }
}

TEST_CASE("what edges see is remembered, and found alike by any number of threads") {
  const Scene scene = scene_with_ends();
  std::vector<std::vector<double>> numbers;
  for (const unsigned threads : {1U, 2U, 5U}) {
    SimulationSettings settings = over_two_edges(Discovery::sampled);
    settings.propagation.cache = CacheMode::seed;
    settings.propagation.rays_steady = 20;
    settings.threads = threads;
    Simulator simulator(scene, settings);
    numbers.emplace_back();
    for (std::size_t frame = 0; frame < 4; ++frame) {
      const LinkResult link = simulator.advance_to(0.1 * static_cast<double>(frame), frame).links.at(0);
      CHECK(std::any_of(link.paths.begin(), link.paths.end(), is_round_both_houses));
      for (const PathContribution& path : link.paths) {
        for (const double number : all_numbers(path)) numbers.back().push_back(number);
      }
    }
  }
  CHECK(numbers[0] == numbers[1]);
  CHECK(numbers[0] == numbers[2]);
}

}  // namespace test_mirror_between_edges
