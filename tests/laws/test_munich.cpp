/// A real city, 38,936 triangles, dirty as found: rays from the receiver must not miss what anybody can compute by
/// hand.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "dcem/dcem.hpp"
#include "dcem/io/obj_reader.hpp"
#include "tests/support/shared_data.hpp"

namespace test_munich {

namespace {

using namespace dcem;

/// Every triangle of the city, asked one after the other; nothing of the engine but the list of corners.
class AllTriangles {
 public:
  explicit AllTriangles(const Scene& scene) {
    for (std::uint32_t triangle = 0; triangle < scene.triangles().size(); ++triangle) {
      const auto corners = scene.corners_m(triangle);
      const bool ground = std::max({corners[0].z, corners[1].z, corners[2].z}) < 1e-3 &&
                          scene.facet(scene.facet_of_triangle(triangle)).triangle_count == 2;
      (ground ? ground_ : city_).push_back(corners);
    }
  }

  std::size_t ground_triangles() const { return ground_.size(); }

  /// Whether the open segment crosses a triangle that is not ground (Möller and Trumbore, 1997).
  bool blocked(const Vec3& from, const Vec3& to) const {
    return std::any_of(city_.begin(), city_.end(), [&](const auto& c) { return crosses(c, from, to); });
  }
  bool on_ground(const Vec3& point) const {
    const Vec3 above = point + Vec3(0, 0, 1), below = point - Vec3(0, 0, 1);
    return std::any_of(ground_.begin(), ground_.end(), [&](const auto& c) { return crosses(c, above, below); });
  }

 private:
  static bool crosses(const std::array<Vec3, 3>& c, const Vec3& from, const Vec3& to) {
    const Vec3 direction = to - from, e1 = c[1] - c[0], e2 = c[2] - c[0], p = glm::cross(direction, e2);
    const double determinant = glm::dot(e1, p);
    if (determinant == 0.0) return false;
    const Vec3 offset = from - c[0], q = glm::cross(offset, e1);
    const double u = glm::dot(offset, p) / determinant, v = glm::dot(direction, q) / determinant;
    const double t = glm::dot(e2, q) / determinant;
    return u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0 && t < 1.0;
  }

  std::vector<std::array<Vec3, 3>> ground_, city_;
};

/// A point of the inner city with nothing above it: in a street, not in a house.
Vec3 point_in_the_open(RandomStream& random, const AllTriangles& triangles, double height_m) {
  while (true) {
    const Vec3 point{-250.0 + 500.0 * random.uniform(), -250.0 + 500.0 * random.uniform(), height_m};
    if (!triangles.blocked(point - Vec3(0, 0, height_m - 0.01), point + Vec3(0, 0, 200))) return point;
  }
}

bool has_path(const std::vector<PathContribution>& paths, const char* letters, std::optional<Vec3> point_m) {
  return std::any_of(paths.begin(), paths.end(), [&](const PathContribution& candidate) {
    return kinds(candidate.path) == letters &&
           (!point_m || glm::distance(candidate.path.interactions.at(0).point_m, *point_m) < 1e-6);
  });
}

}  // namespace

TEST_CASE("Munich, 2000 rays: every unobstructed pair has its line of sight and its ground reflection") {
  DCEM_NEEDS_SHARED();
  Scene scene;
  const TriangleMesh mesh = io::read_obj(dcem::test::shared_path("scenes/munich.obj")).mesh;
  for (const std::string& name : mesh.material_names) scene.add_material({name, PerfectConductor{}});
  scene.set_scenery(mesh);
  const AllTriangles triangles(scene);
  REQUIRE(triangles.ground_triangles() == 2);

  RandomStream random(2026);
  constexpr int receivers = 20, transmitters = 10;  // 200 pairs
  std::vector<Vec3> from, to;
  for (int index = 0; index < transmitters; ++index) {
    from.push_back(point_in_the_open(random, triangles, 2.0 + 3.0 * index));
    scene.add_transmitter(device_at("tx" + std::to_string(index), from.back()));
  }
  for (int index = 0; index < receivers; ++index) {
    // Two receivers stand within 40 m of each transmitter, or hardly a pair would see each other.
    Vec3 point = point_in_the_open(random, triangles, 1.5);
    while (glm::distance(point, from[static_cast<std::size_t>(index / 2)]) > 40.0) {
      point = point_in_the_open(random, triangles, 1.5);
    }
    to.push_back(point);
    scene.add_receiver(device_at("rx" + std::to_string(index), point));
  }
  SimulationSettings settings;
  settings.propagation.max_transmissions = 0;
  settings.propagation.discovery = Discovery::sampled;
  Simulator simulator(std::move(scene), settings);
  const FrameResult frame = simulator.advance_to(0.0);

  int sights = 0, ground_reflections = 0;
  for (const LinkResult& link : frame.links) {
    const Vec3 &a = from[link.transmitter], &b = to[link.receiver];
    const bool free = !triangles.blocked(a, b);
    CHECK(link.statistics.line_of_sight == free);
    CHECK(has_path(link.paths, "", std::nullopt) == free);
    const Vec3 foot = a + a.z / (a.z + b.z) * (Vec3(b.x, b.y, -b.z) - a);  // mirror the receiver in z = 0
    const bool reflected = triangles.on_ground(foot) && !triangles.blocked(a, foot) && !triangles.blocked(foot, b);
    CHECK(has_path(link.paths, "R", foot) == reflected);
    sights += free;
    ground_reflections += reflected;
  }
  MESSAGE("of 200 pairs " << sights << " see each other, " << ground_reflections << " by way of the ground");
  CHECK(frame.links.size() == 200);
  CHECK(sights >= 20);
  CHECK(ground_reflections >= 20);
}

}  // namespace test_munich
