#pragma once
/// Boxes, rays and exact little shapes for the tests of trees.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "dcem/core/random.hpp"
#include "dcem/geometry/aabb.hpp"
#include "dcem/geometry/ray.hpp"

namespace dcem_test {

template <class Scalar>
using Boxes = std::vector<dcem::Aabb<Scalar>>;

inline double between(dcem::RandomStream& random, double low, double high) {
  return low + (high - low) * random.uniform();
}

/// A point of a cube; every fourth coordinate is a whole number, so that planes and origins coincide often.
template <class Scalar>
dcem::Vector3<Scalar> random_point(dcem::RandomStream& random, double half_size) {
  dcem::Vector3<Scalar> point;
  for (int axis = 0; axis < 3; ++axis) {
    const double value = between(random, -half_size, half_size);
    point[axis] = static_cast<Scalar>(random.uniform() < 0.25 ? std::round(value) : value);
  }
  return point;
}

/// Small boxes in a cube of 20 m, some of them flat, some points, some large.
template <class Scalar>
dcem::Aabb<Scalar> random_box(dcem::RandomStream& random) {
  const auto corner = random_point<Scalar>(random, 10.0);
  dcem::Aabb<Scalar> box{corner, corner};
  const double size = random.uniform() < 0.05 ? 8.0 : 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    if (random.uniform() < 0.2) continue;
    box.max[axis] += static_cast<Scalar>(size * random.uniform());
  }
  return box;
}

template <class Scalar>
Boxes<Scalar> random_boxes(std::size_t count, std::uint64_t seed) {
  dcem::RandomStream random(seed);
  Boxes<Scalar> boxes(count);
  for (auto& box : boxes) box = random_box<Scalar>(random);
  return boxes;
}

/// Rays and segments, a third of their direction components zero (with either sign).
template <class Scalar>
dcem::Ray<Scalar> random_ray(dcem::RandomStream& random) {
  dcem::Ray<Scalar> ray;
  ray.origin = random_point<Scalar>(random, 12.0);
  ray.direction = random_point<Scalar>(random, 3.0);
  for (int axis = 0; axis < 3; ++axis) {
    if (random.uniform() < 0.33) ray.direction[axis] = random.uniform() < 0.5 ? Scalar(0) : -Scalar(0);
  }
  const double kind = random.uniform();
  if (kind < 0.4) ray.t_max = static_cast<Scalar>(between(random, 0.0, 8.0));
  if (kind < 0.1) ray.t_max = 0;
  if (kind > 0.9) ray.t_min = static_cast<Scalar>(between(random, -4.0, 4.0));
  return ray;
}

/// Where a ray meets the plane of constant `axis` at the box's lower side within the box, computed from the box's own
/// numbers: the shape lies in the box exactly. NaN for a miss.
template <class Scalar>
Scalar meet_square(const dcem::Aabb<Scalar>& box, int axis, const dcem::Ray<Scalar>& ray) {
  constexpr Scalar miss = std::numeric_limits<Scalar>::quiet_NaN();
  if (box.empty() || ray.direction[axis] == 0) return miss;
  const Scalar t = (box.min[axis] - ray.origin[axis]) / ray.direction[axis];
  for (int side = 0; side < 3; ++side) {
    if (side == axis) continue;
    const Scalar at = ray.origin[side] + t * ray.direction[side];
    if (!(at >= box.min[side] && at <= box.max[side])) return miss;
  }
  return t >= ray.t_min && t <= ray.t_max ? t : miss;
}

/// ClosestHit square over all boxes and, on a tie, the lowest primitive: through any tree with the query `closest`.
template <class Scalar>
struct NearestSquare {
  Scalar t = std::numeric_limits<Scalar>::infinity();
  std::uint32_t primitive = 0xffffffffU;
  friend bool operator==(const NearestSquare&, const NearestSquare&) = default;
};

template <class Scalar, class Tree>
NearestSquare<Scalar> nearest_square(const Tree& tree, const Boxes<Scalar>& boxes, const dcem::Ray<Scalar>& ray) {
  NearestSquare<Scalar> closest_hit;
  tree.closest(ray, [&](std::uint32_t primitive, Scalar& t_max) {
    const Scalar t = meet_square(boxes[primitive], static_cast<int>(primitive % 3), ray);
    if (!(t < closest_hit.t || (t == closest_hit.t && primitive < closest_hit.primitive))) return;
    closest_hit = {t, primitive};
    t_max = t;
  });
  return closest_hit;
}

/// The primitives that a query reports, in ascending order; a primitive reported twice stands there twice.
template <class Query>
std::vector<std::uint32_t> reported(Query&& query) {
  std::vector<std::uint32_t> primitives;
  query([&](std::uint32_t primitive) { primitives.push_back(primitive); });
  std::ranges::sort(primitives);
  return primitives;
}

}  // namespace dcem_test
