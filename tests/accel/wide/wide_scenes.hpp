#pragma once
/// Meshes, rays and the oracle for the tests of wide trees.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <functional>
#include <iomanip>
#include <limits>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "dcem/accel/brute_force.hpp"
#include "dcem/accel/exact_hit.hpp"
#include "dcem/accel/hit_filter.hpp"
#include "dcem/accel/wide_bvh.hpp"
#include "dcem/core/random.hpp"
#include "dcem/geometry/triangle.hpp"
#include "tests/accel/random_boxes.hpp"

namespace dcem_test {

using dcem::Aabb;
using dcem::RandomStream;
using dcem::Ray;
using dcem::TriangleCorners;
using dcem::Vec3;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

// Meshes.

struct WideMesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<bool> absent;  ///< triangles that are not there; empty: all are

  dcem::TriangleView view() const { return {vertices, triangles}; }
  TriangleCorners corners(std::uint32_t triangle) const { return view().corners_m(triangle); }
  bool is_there(std::uint32_t triangle) const { return absent.empty() || !absent[triangle]; }

  std::vector<Aabb<double>> boxes() const {
    std::vector<Aabb<double>> result(triangles.size());
    for (std::uint32_t triangle = 0; triangle < triangles.size(); ++triangle) {
      if (!is_there(triangle)) continue;
      for (const Vec3& corner : corners(triangle)) result[triangle].extend(corner);
    }
    return result;
  }

  std::uint32_t add_vertex(const Vec3& position) {
    vertices.push_back(position);
    return static_cast<std::uint32_t>(vertices.size() - 1);
  }
  void add(std::uint32_t a, std::uint32_t b, std::uint32_t c) { triangles.push_back({a, b, c}); }
  void add(const Vec3& a, const Vec3& b, const Vec3& c) {
    const std::uint32_t first = add_vertex(a);
    add_vertex(b);
    add_vertex(c);
    add(first, first + 1, first + 2);
  }
  void append(const WideMesh& other) {
    const auto first = static_cast<std::uint32_t>(vertices.size());
    vertices.insert(vertices.end(), other.vertices.begin(), other.vertices.end());
    for (const auto& [a, b, c] : other.triangles) add(first + a, first + b, first + c);
  }
  template <typename Change>
  WideMesh changed(Change&& change) const {
    WideMesh result = *this;
    for (Vec3& vertex : result.vertices) vertex = change(vertex);
    return result;
  }
};

inline Vec3 random_in_cube(RandomStream& random, double half_size) {
  const double x = between(random, -half_size, half_size), y = between(random, -half_size, half_size);
  return {x, y, between(random, -half_size, half_size)};
}

inline Vec3 random_direction(RandomStream& random) {
  while (true) {
    const Vec3 point = random_in_cube(random, 1.0);
    const double length = glm::length(point);
    if (length > 0.05 && length < 1.0) return point / length;
  }
}

/// Triangles without common vertices in a cube of 20 m.
inline WideMesh soup(std::size_t count, std::uint64_t seed, double size = 3.0) {
  RandomStream random(seed);
  WideMesh mesh;
  for (std::size_t index = 0; index < count; ++index) {
    const Vec3 at = random_point<double>(random, 10.0);
    const Vec3 b = at + random_in_cube(random, size), c = at + random_in_cube(random, size);
    mesh.add(at, b, c);
  }
  return mesh;
}

/// A box of eight vertices and twelve triangles.
inline WideMesh box_mesh(const Vec3& low, const Vec3& high) {
  WideMesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    mesh.add_vertex(
        {(corner & 1) != 0 ? high.x : low.x, (corner & 2) != 0 ? high.y : low.y, (corner & 4) != 0 ? high.z : low.z});
  }
  const std::array<std::array<std::uint32_t, 4>, 6> sides{
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  for (const auto& [a, b, c, d] : sides) {
    mesh.add(a, b, c);
    mesh.add(a, c, d);
  }
  return mesh;
}

inline WideMesh boxes_mesh(std::size_t count, std::uint64_t seed) {
  RandomStream random(seed);
  WideMesh mesh;
  for (std::size_t index = 0; index < count; ++index) {
    const Vec3 low = random_point<double>(random, 10.0);
    mesh.append(box_mesh(low, low + Vec3(0.2 + 3 * random.uniform(), 0.2 + 3 * random.uniform(), 1.0)));
  }
  return mesh;
}

/// A closed ball: rings of triangles between two poles. Its quadrilaterals are flat only about the axis.
inline WideMesh ball(const Vec3& centre, double radius, std::uint32_t rings) {
  WideMesh mesh;
  const std::uint32_t sides = 2 * rings;
  for (std::uint32_t ring = 1; ring < rings; ++ring) {
    const double zenith = M_PI * ring / rings;
    for (std::uint32_t side = 0; side < sides; ++side) {
      const double azimuth = 2 * M_PI * side / sides;
      mesh.add_vertex(centre + radius * Vec3(std::sin(zenith) * std::cos(azimuth), std::sin(zenith) * std::sin(azimuth),
                                             std::cos(zenith)));
    }
  }
  const std::uint32_t top = mesh.add_vertex(centre + Vec3(0, 0, radius));
  const std::uint32_t bottom = mesh.add_vertex(centre - Vec3(0, 0, radius));
  for (std::uint32_t side = 0; side < sides; ++side) {
    const std::uint32_t next = (side + 1) % sides, last = (rings - 2) * sides;
    mesh.add(top, side, next);
    mesh.add(bottom, last + next, last + side);
    for (std::uint32_t ring = 0; ring + 2 < rings; ++ring) {
      const std::uint32_t here = ring * sides, below = here + sides;
      mesh.add(here + side, below + side, below + next);
      mesh.add(here + side, below + next, here + next);
    }
  }
  return mesh;
}

/// A ground of count x count quadrilaterals of 1 m, each bent by up to `bend_m`.
inline WideMesh bent_ground(std::uint32_t count, double bend_m, std::uint64_t seed) {
  RandomStream random(seed);
  WideMesh mesh;
  for (std::uint32_t row = 0; row <= count; ++row) {
    for (std::uint32_t column = 0; column <= count; ++column) {
      mesh.add_vertex({column - 0.5 * count + between(random, -0.2, 0.2),
                       row - 0.5 * count + between(random, -0.2, 0.2), between(random, -bend_m, bend_m)});
    }
  }
  for (std::uint32_t row = 0; row < count; ++row) {
    for (std::uint32_t column = 0; column < count; ++column) {
      const std::uint32_t a = row * (count + 1) + column, b = a + 1, c = b + count + 1, d = a + count + 1;
      mesh.add(a, b, c);
      random.uniform() < 0.5 ? mesh.add(a, c, d) : mesh.add(c, a, d);
    }
  }
  return mesh;
}

/// Needles, triangles without area, repeated points, and triangles drawn twice, among sound ones.
inline WideMesh dirty_mesh(std::size_t count, std::uint64_t seed) {
  RandomStream random(seed);
  WideMesh mesh = soup(count, seed + 1);
  for (std::size_t index = 0; index < count; ++index) {
    const Vec3 a = random_point<double>(random, 10.0), along = random_in_cube(random, 3.0);
    mesh.add(a, a + along, a + 0.3 * along + 1e-6 * random_in_cube(random, 3.0));
    mesh.add(a, a + along, a + 0.5 * along);
    mesh.add(a, a, a + along);
    mesh.add(a, a, a);
    const std::uint32_t one = mesh.add_vertex(a), two = mesh.add_vertex(a + along);
    mesh.add(one, two, one);
    const std::uint32_t three = mesh.add_vertex(a + random_in_cube(random, 3.0));
    mesh.add(one, two, three);
    if (index % 3 == 0) mesh.add(two, three, one);
    if (index % 3 == 1) mesh.add(one, two, mesh.add_vertex(mesh.vertices[three]));
    if (index % 3 == 2) mesh.add(one, two, mesh.add_vertex(mesh.vertices[three] + 0.5 * along));
  }
  return mesh;
}

/// Triangles of an OBJ file, each of its faces as a fan.
inline WideMesh read_obj(const std::string& path) {
  WideMesh mesh;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string key;
    words >> key;
    if (key == "v") {
      Vec3 vertex;
      words >> vertex.x >> vertex.y >> vertex.z;
      mesh.vertices.push_back(vertex);
    }
    if (key != "f") continue;
    std::vector<std::uint32_t> corners;
    for (std::string word; words >> word;) corners.push_back(static_cast<std::uint32_t>(std::stoul(word) - 1));
    for (std::size_t corner = 2; corner < corners.size(); ++corner) {
      mesh.add(corners[0], corners[corner - 1], corners[corner]);
    }
  }
  return mesh;
}

// Rays.

inline Vec3 random_on(RandomStream& random, const TriangleCorners& corners) {
  const double kind = random.uniform(), along = random.uniform();
  if (kind < 0.15) return corners[random.next() % 3];
  const Vec3 on_edge = corners[0] + along * (corners[1] - corners[0]);
  if (kind < 0.3) return on_edge;
  if (kind < 0.4) return corners[1] + along * (corners[2] - corners[1]);
  return on_edge + random.uniform() * (corners[2] - on_edge);
}

/// A ray of any kind near a mesh: aimed at triangles, their edges and corners, or from them, along axes, as segments.
inline Ray<double> any_ray(RandomStream& random, const WideMesh& mesh, const Aabb<double>& bounds) {
  const auto on_mesh = [&] {
    return random_on(random, mesh.corners(static_cast<std::uint32_t>(random.next() % mesh.triangles.size())));
  };
  const double reach = 0.6 * glm::length(bounds.extent()) + 1e-300;
  Ray<double> ray;
  ray.origin = random.uniform() < 0.15 ? on_mesh() : bounds.center() + random_in_cube(random, reach);
  const double kind = random.uniform();
  if (kind < 0.6) ray.direction = on_mesh() - ray.origin;
  if (kind >= 0.6 || ray.direction == Vec3(0)) ray.direction = reach * random_direction(random);
  if (random.uniform() < 0.15) {
    const Vec3 at = on_mesh();
    const int axis = static_cast<int>(random.next() % 3);
    for (int other = 0; other < 3; ++other) {
      if (other == axis) continue;
      ray.origin[other] = at[other];
      ray.direction[other] = random.uniform() < 0.5 ? 0.0 : -0.0;
    }
    if (ray.direction[axis] == 0.0) ray.direction[axis] = reach;
  }
  const double range = random.uniform();
  if (range < 0.3) ray.t_max = 2.0 * random.uniform();
  if (range < 0.15) ray.t_min = 0.7 * ray.t_max;
  if (range > 0.95) ray.t_max = 0.0;
  return ray;
}

// The oracle.

/// One triangle that the line of a ray meets, by double precision alone.
struct OracleHit {
  double t;
  std::uint32_t triangle;
  double tolerance;  ///< how far two computations of t may be apart
};

/// Two ways to compute t differ by the rounding of the triangle's normal, which grows with the ratio of its length to
/// its height, over the sine of the angle of incidence; 1e-9 of the distance is what the tree promises beside that.
inline double tolerance_of(const TriangleCorners& corners, const Ray<double>& ray, double t) {
  const auto& [a, b, c] = corners;
  const Vec3 across = glm::cross(b - a, c - a);
  const double area = glm::length(across), speed = glm::length(ray.direction);
  const double size = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
  const double distance = glm::distance(a, ray.origin) + size;
  if (!(area > 0.0)) return infinity;
  const double sine = std::abs(glm::dot(across / area, ray.direction / speed));
  const double rounding = 4e-15 * (1.0 + size * size / area) * distance / (sine * speed);
  return 1e-9 * std::abs(t) + rounding / std::min(1.0, 1e3 * sine);
}

/// All triangles that the line of a ray meets, found without any tree.
inline std::vector<OracleHit> hits_on_line(const WideMesh& mesh, const Ray<double>& ray) {
  std::vector<OracleHit> hits;
  const dcem::WatertightRay exact(ray);
  for (std::uint32_t triangle = 0; triangle < mesh.triangles.size(); ++triangle) {
    if (!mesh.is_there(triangle)) continue;
    const TriangleCorners corners = mesh.corners(triangle);
    const auto t = exact.intersect(corners);
    if (t && std::isfinite(*t)) hits.push_back({*t, triangle, tolerance_of(corners, ray, *t)});
  }
  std::ranges::sort(hits, {}, &OracleHit::t);
  return hits;
}

/// Whether a triangle is all but a line: in which plane it lies then, rounding alone decides.
inline bool is_line(const TriangleCorners& corners) {
  const auto& [a, b, c] = corners;
  const double size = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
  return !(glm::length(glm::cross(b - a, c - a)) > 1e-12 * size * size);
}

/// All hits of a ray that pass a filter, by exact_hit_t alone, nearest first: what every index must say, to the last
/// bit. `object_of`: of a triangle, as the index was built.
inline std::vector<dcem::TriangleHit> exact_hits(
    const WideMesh& mesh, const Ray<double>& ray, const dcem::HitFilter& filter = {},
    const std::function<std::uint32_t(std::uint32_t)>& object_of = [](std::uint32_t) { return 0U; }) {
  std::vector<dcem::TriangleHit> hits;
  if (!dcem::has_direction(ray)) return hits;
  const dcem::WatertightRay prepared(ray);
  for (std::uint32_t triangle = 0; triangle < mesh.triangles.size(); ++triangle) {
    if (!mesh.is_there(triangle) || filter.ignores(object_of(triangle))) continue;
    const TriangleCorners corners = mesh.corners(triangle);
    const auto t = dcem::exact_hit_t(dcem::plane_of(corners), corners, prepared, ray);
    if (t && filter.passes({*t, triangle})) hits.push_back({*t, triangle});
  }
  std::ranges::sort(hits, [](const dcem::TriangleHit& one, const dcem::TriangleHit& other) {
    return one.t != other.t ? one.t < other.t : one.triangle < other.triangle;
  });
  return hits;
}

/// What is wrong with the answers of an index to one ray, against exact_hits; empty when all are right.
template <typename Index>
std::string fault_of_hits(const Index& index, const std::vector<dcem::TriangleHit>& expected, const Ray<double>& ray,
                          const dcem::HitFilter& filter = {}) {
  const auto hit = index.closest_hit(ray, filter);
  if (hit.has_value() != !expected.empty()) return "closest_hit: found or not";
  if (hit && !(*hit == expected.front())) return "closest_hit: another hit";
  if (index.occluded(ray, filter) != !expected.empty()) return "occluded";
  std::vector<dcem::TriangleHit> visited;
  const bool stopped = index.visit_hits(ray, filter, [&](const dcem::TriangleHit& one) {
    visited.push_back(one);
    return false;
  });
  const auto by_triangle = [](const dcem::TriangleHit& one, const dcem::TriangleHit& other) {
    return one.triangle < other.triangle;
  };
  auto sorted = expected;
  std::ranges::sort(sorted, by_triangle);
  std::ranges::sort(visited, by_triangle);
  if (stopped || visited != sorted) return "visit_hits: other hits";
  std::size_t calls = 0;
  const bool ended = index.visit_hits(ray, filter, [&](const dcem::TriangleHit&) { return ++calls == 1; });
  if (ended == expected.empty() || calls != (expected.empty() ? 0 : 1)) return "visit_hits: did not stop";
  return {};
}

/// What is wrong with an answer to "which is the closest", empty when it is right. A hit whose t could be on either
/// side of t_min, t_max or of another hit by rounding may be taken or left.
inline std::string fault_of_closest(const std::vector<OracleHit>& line, const Ray<double>& ray,
                                    const std::optional<dcem::TriangleHit>& found) {
  const auto surely_inside = [&](const OracleHit& hit) {
    return hit.t - hit.tolerance > ray.t_min && hit.t + hit.tolerance < ray.t_max;
  };
  const auto show = [](double value) { return (std::ostringstream() << std::setprecision(17) << value).str(); };
  if (found) {
    if (!(found->t >= ray.t_min && found->t <= ray.t_max)) return "t " + show(found->t) + " is out of range";
    const auto same = std::ranges::find(line, found->triangle, &OracleHit::triangle);
    const bool is_hit = std::ranges::any_of(line, [&](const OracleHit& hit) {
      return std::abs(hit.t - found->t) <= hit.tolerance && (same == line.end() || hit.triangle == found->triangle);
    });
    if (!is_hit) {
      return "triangle " + std::to_string(found->triangle) + " at t " + show(found->t) + " is not met there, but " +
             (same == line.end() ? "nowhere" : "at " + show(same->t));
    }
  }
  for (const OracleHit& hit : line) {
    if (!surely_inside(hit)) continue;
    if (!found) return "triangle " + std::to_string(hit.triangle) + " at t " + show(hit.t) + " was not found";
    if (found->t > hit.t + hit.tolerance) {
      return "triangle " + std::to_string(hit.triangle) + " at t " + show(hit.t) + " is nearer than " + show(found->t);
    }
  }
  return {};
}

/// Whether something is in the way: 1 surely, 0 surely not, -1 where rounding decides.
inline int oracle_occluded(const std::vector<OracleHit>& line, const Ray<double>& ray) {
  int answer = 0;
  for (const OracleHit& hit : line) {
    if (hit.t - hit.tolerance > ray.t_min && hit.t + hit.tolerance < ray.t_max) return 1;
    if (hit.t + hit.tolerance >= ray.t_min && hit.t - hit.tolerance <= ray.t_max) answer = -1;
  }
  return answer;
}

inline std::string text_of(const Ray<double>& ray) {
  std::ostringstream text;
  text << std::setprecision(17) << "origin " << ray.origin.x << ", " << ray.origin.y << ", " << ray.origin.z
       << " direction " << ray.direction.x << ", " << ray.direction.y << ", " << ray.direction.z << " t " << ray.t_min
       << " to " << ray.t_max;
  return text.str();
}

}  // namespace dcem_test
