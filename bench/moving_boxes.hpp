#pragma once
/// Scenes with cars for benchmarks of the tree, and the rays that are sent through them.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "dcem/core/random.hpp"
#include "dcem/geometry/ray.hpp"
#include "dcem/geometry/triangle_mesh.hpp"
#include "dcem/io/obj_reader.hpp"
#include "dcem/scene/scene.hpp"

namespace dcem::bench {

inline constexpr double step_s = 0.1;        ///< ten frames a second
inline constexpr double fastest_mps = 14.0;  ///< a little over 50 km/h
inline constexpr double short_leg_m = 30.0;  ///< the longest of the short segments

inline double between(RandomStream& random, double low, double high) {
  return low + random.uniform() * (high - low);
}

/// A point over the footprint of a box, from `low_m` to `high_m` above its lowest z.
inline Vec3 point_over(const Aabb<double>& box, double low_m, double high_m, RandomStream& random) {
  const double x = between(random, box.min.x, box.max.x), y = between(random, box.min.y, box.max.y);
  return {x, y, box.min.z + between(random, low_m, high_m)};
}

inline Vec3 direction_on_sphere(RandomStream& random) {
  const double z = between(random, -1.0, 1.0), azimuth_rad = between(random, -pi, pi);
  const double level = std::sqrt(1.0 - z * z);
  return {level * std::cos(azimuth_rad), level * std::sin(azimuth_rad), z};
}

/// A town of plain leaves: 20 × 20 houses of random size and height along streets 12 m wide, on one ground.
inline TriangleMesh generated_town(std::uint64_t seed) {
  constexpr int rows = 20;
  constexpr double pitch_m = 40.0, street_m = 12.0, side_m = rows * pitch_m;
  RandomStream random(seed);
  TriangleMesh town;
  add_quad(town, {Vec3(0, 0, 0), Vec3(side_m, 0, 0), Vec3(side_m, side_m, 0), Vec3(0, side_m, 0)}, "ground");
  for (int house = 0; house < rows * rows; ++house) {
    const double room_m = pitch_m - street_m;
    const Vec3 size_m(between(random, 10.0, room_m), between(random, 10.0, room_m), between(random, 6.0, 24.0));
    const Vec3 centre_m((house % rows + 0.5) * pitch_m, (house / rows + 0.5) * pitch_m, 0.0);
    const TriangleMesh box = make_box(size_m, "wall");
    const auto first = static_cast<std::uint32_t>(town.vertices_m.size());
    const std::uint32_t material = material_index(town, "wall");
    for (const Vec3& vertex : box.vertices_m) town.vertices_m.push_back(centre_m + vertex);
    for (const TriangleMesh::Triangle& triangle : box.triangles) {
      const auto& [a, b, c] = triangle.vertices;
      town.triangles.push_back({{first + a, first + b, first + c}, material});
    }
  }
  return town;
}

/// From a random point of the footprint straight towards another, at a constant speed of up to 14 m/s, no further than
/// there within the time.
inline Motion straight_drive(const Aabb<double>& bounds, double duration_s, RandomStream& random) {
  const Vec3 start_m = point_over(bounds, 0.0, 0.0, random), goal_m = point_over(bounds, 0.0, 0.0, random);
  const Vec3 way_m = goal_m - start_m;
  const double length_m = std::min(glm::length(way_m), between(random, 0.0, fastest_mps) * duration_s);
  const double yaw_rad = std::atan2(way_m.y, way_m.x);
  const Vec3 end_m = start_m + length_m * glm::normalize(way_m);
  return WaypointMotion{{{0.0, {start_m, yaw_rad}}, {duration_s, {end_m, yaw_rad}}}};
}

/// The scenery with cars, boxes of 12 triangles, that drive for `duration_s`. No devices, and materials by name only.
inline Scene scene_with_cars(const TriangleMesh& scenery, std::size_t cars, double duration_s, std::uint64_t seed) {
  Scene scene;
  for (const std::string& name : scenery.material_names) scene.add_material({name, PerfectConductor{}});
  if (!scene.find_material("car")) scene.add_material({"car", PerfectConductor{}});
  scene.set_scenery(scenery);
  Aabb<double> bounds;
  for (const Vec3& vertex : scene.vertices_m()) bounds.extend(vertex);
  RandomStream random(seed);
  for (std::size_t car = 0; car < cars; ++car) {
    scene.add_object("car" + std::to_string(car), make_box({4.4, 1.8, 1.5}, "car"),
                     straight_drive(bounds, duration_s, random));
  }
  return scene;
}

/// What is sent through the scene in every frame, all from 0.5 to 3 m above the lowest point.
struct RaySet {
  std::vector<Ray<double>> bounces;     ///< in all directions, for the closest hit
  std::vector<Ray<double>> short_legs;  ///< segments of up to 30 m between two such points, for any hit
};

inline RaySet random_rays(const Aabb<double>& bounds, std::size_t count, std::uint64_t seed) {
  RandomStream random(seed);
  RaySet rays;
  for (std::size_t ray = 0; ray < count; ++ray) {
    const Vec3 from_m = point_over(bounds, 0.5, 3.0, random), start_m = point_over(bounds, 0.5, 3.0, random);
    rays.bounces.push_back({from_m, direction_on_sphere(random)});
    const double azimuth_rad = between(random, -pi, pi), length_m = between(random, 1.0, short_leg_m);
    const Vec3 end_m(start_m.x + length_m * std::cos(azimuth_rad), start_m.y + length_m * std::sin(azimuth_rad),
                     bounds.min.z + between(random, 0.5, 3.0));
    rays.short_legs.push_back(segment_between(start_m, end_m));
  }
  return rays;
}

}  // namespace dcem::bench
