#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "dcem/accel/ray_order.hpp"
#include "dcem/accel/wide_bvh.hpp"
#include "tests/accel/wide/wide_scenes.hpp"
#include "tests/accel/wide/wide_traffic.hpp"

namespace test_fuzz_slow {

using namespace dcem;
using dcem_test::between;
using dcem_test::infinity;
using dcem_test::nodes_of;
using dcem_test::random_direction;
using dcem_test::random_in_cube;
using dcem_test::text_of;
using dcem_test::WideMesh;

namespace {

using Real = long double;
using RealVec = std::array<Real, 3>;

// The reference: signed volumes in long double, with nothing of the tree's formulas.

RealVec difference(const Vec3& to, const Vec3& from) {
  return {Real(to.x) - Real(from.x), Real(to.y) - Real(from.y), Real(to.z) - Real(from.z)};
}
RealVec cross(const RealVec& one, const RealVec& other) {
  return {one[1] * other[2] - one[2] * other[1], one[2] * other[0] - one[0] * other[2],
          one[0] * other[1] - one[1] * other[0]};
}
Real dot(const RealVec& one, const RealVec& other) {
  return one[0] * other[0] + one[1] * other[1] + one[2] * other[2];
}
Real length(const RealVec& of) {
  return std::sqrt(dot(of, of));
}

enum class Meeting { no, perhaps, surely };

struct Reference {
  Meeting meeting = Meeting::no;
  Real t = 0, room = 0;  ///< how far a t in double precision may be off
};

/// Whether a ray meets a triangle from t_min to t_max; "perhaps" where double precision may say either.
Reference reference_of(const Ray<double>& ray, const TriangleCorners& corners) {
  const RealVec d = difference(ray.direction, Vec3(0));
  const RealVec a = difference(corners[0], ray.origin), b = difference(corners[1], ray.origin),
                c = difference(corners[2], ray.origin);
  const Real reach = std::max({length(a), length(b), length(c)}), speed = length(d);
  const RealVec bc = cross(b, c), ca = cross(c, a), ab = cross(a, b);
  const Real u = dot(d, bc), v = dot(d, ca), w = dot(d, ab);
  const RealVec e1 = difference(corners[1], corners[0]), e2 = difference(corners[2], corners[0]);
  const RealVec normal = cross(e1, e2);
  const Real size = std::max({length(e1), length(e2), length(difference(corners[2], corners[1]))});
  // A corner as the ray sees it is off by roundings of its distance; a volume by that times an edge.
  const Real room =
      64 * 1.2e-16L * speed * reach * std::max(size, reach * 1e-12L) + 64 * 1.5e-32L * speed * reach * reach;
  Reference result;
  const bool outside = std::min({u, v, w}) < -room && std::max({u, v, w}) > room;
  if (outside) return result;
  const Real slope = dot(normal, d), height = dot(normal, a);
  if (slope == 0) {
    result.meeting = Meeting::perhaps;
    result.room = infinity;
    return result;
  }
  result.t = height / slope;
  const Real area = length(normal), sine = std::abs(slope) / (area * speed);
  const Real normal_room = 16 * 1.2e-16L * size * size / std::max(area, Real(1e-300L));
  result.room = (normal_room * reach + 16 * 1.2e-16L * reach) / (sine * speed);
  if (normal_room > 0.1L * sine || area < 1e-130L) result.room = infinity;
  const bool inside = (std::min({u, v, w}) > room || std::max({u, v, w}) < -room);
  const bool surely_in_range = result.t - result.room > Real(ray.t_min) && result.t + result.room < Real(ray.t_max);
  const bool perhaps_in_range = result.t + result.room >= Real(ray.t_min) && result.t - result.room <= Real(ray.t_max);
  if (!perhaps_in_range) return result;
  result.meeting = inside && surely_in_range ? Meeting::surely : Meeting::perhaps;
  return result;
}

// Scenes.

struct Scale {
  double size = 1.0;
  Vec3 at{0.0};
  double far = 0.0;  ///< how far away a second cluster lies
};

/// Two triangles over a quadrilateral, drawn in any rotation and any winding, bent by up to `bend`.
void add_pair(WideMesh& mesh, RandomStream& random, double bend) {
  const Vec3 at = random_in_cube(random, 8.0);
  const Vec3 along = random_direction(random) * between(random, 0.5, 3.0);
  const double thin = std::pow(10.0, between(random, -7, 0));
  const Vec3 across = random_direction(random) * (random.uniform() < 0.7 ? 1.0 : thin);
  const Vec3 normal = glm::cross(along, across) / (glm::length(glm::cross(along, across)) + 1e-300);
  const std::uint32_t a = mesh.add_vertex(at), b = mesh.add_vertex(at + across * between(random, 0.3, 1.5)),
                      c = mesh.add_vertex(at + along + across * between(random, 0.8, 1.2)),
                      d = mesh.add_vertex(at + along * between(random, 0.6, 1.0) - 0.5 * across +
                                          normal * between(random, -bend, bend));
  const auto draw = [&](std::array<std::uint32_t, 3> corners) {
    std::rotate(corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(random.next() % 3), corners.end());
    if (random.uniform() < 0.5) std::swap(corners[1], corners[2]);
    mesh.add(corners[0], corners[1], corners[2]);
  };
  draw({a, b, c});
  draw({a, c, d});
}

class Scene {
 public:
  Scene(std::uint64_t seed, const Scale& scale) : random_(seed), scale_(scale) {
    add_object(dcem_test::bent_ground(10, 1e-4, seed));
    const std::uint32_t objects = static_cast<std::uint32_t>(5 + random_.next() % 40);
    for (std::uint32_t object = 0; object < objects; ++object) {
      WideMesh part;
      switch (random_.next() % 6) {
        case 0:
          part = dcem_test::box_mesh(Vec3(-1, -0.5, 0), Vec3(1, 0.5, 1));
          break;
        case 1:
          part = dcem_test::ball(Vec3(0), 1.0, 4);
          break;
        case 2:
          part = dcem_test::dirty_mesh(1, random_.next()).changed([](const Vec3& v) { return 0.2 * v; });
          break;
        case 3:
          part = dcem_test::bent_ground(3, 0.05, random_.next());
          break;
        case 4:
          part.add(Vec3(0), Vec3(1, 0, 0), Vec3(0, 1, 0));
          break;
        default:
          for (int pair = 0; pair < 6; ++pair) add_pair(part, random_, std::pow(10.0, between(random_, -5, 0)));
          part = part.changed([](const Vec3& v) { return 0.3 * v; });
      }
      add_object(part);
    }
    mesh.absent.assign(mesh.triangles.size(), false);
    rest_ = mesh.vertices;
    place_all();
  }

  /// Some objects move, bend, collapse, vanish in whole or in part.
  void step() {
    moved.clear();
    for (std::size_t object = 0; object < offset_.size(); ++object) {
      if (random_.uniform() < 0.6) continue;
      change(object);
    }
    boxes = mesh.boxes();
  }
  void all_absent(bool absent) {
    moved.clear();
    for (std::uint32_t triangle = 0; triangle < mesh.triangles.size(); ++triangle) {
      mesh.absent[triangle] = absent;
      moved.push_back(triangle);
    }
    boxes = mesh.boxes();
  }

  WideBvh built(double flatness, WideQuality quality, std::uint32_t object_subtree_limit = 60) const {
    WideBuildSettings settings;
    settings.pair_flatness = flatness;
    settings.quality = quality;
    settings.object_subtree_limit = object_subtree_limit;
    WideBvh tree;
    tree.build_objects(mesh.view(), boxes, object_first, settings);
    return tree;
  }
  /// A ray of some kind, in the scene's scale.
  Ray<double> ray() {
    const auto on_mesh = [&](std::uint32_t triangle) {
      const auto& [a, b, c] = mesh.corners(triangle);
      double u = random_.uniform(), v = random_.uniform();
      if (u + v > 1) u = 1 - u, v = 1 - v;
      const double kind = random_.uniform();
      if (kind < 0.1) u = 0;
      if (kind > 0.9) v = 0;
      if (kind > 0.98) u = 0;
      return a + u * (b - a) + v * (c - a);
    };
    const auto triangle = static_cast<std::uint32_t>(random_.next() % mesh.triangles.size());
    const Vec3 target = on_mesh(triangle);
    const auto& [a, b, c] = mesh.corners(triangle);
    const Vec3 normal = glm::cross(b - a, c - a);
    Ray<double> ray;
    const double kind = random_.uniform();
    if (kind < 0.35) {  // from nearby
      ray.origin = target + scale_.size * std::pow(10.0, between(random_, -4, 1.5)) * random_direction(random_);
      ray.direction = target - ray.origin;
    } else if (kind < 0.55) {  // along the surface, nearly
      const double slant = std::pow(10.0, between(random_, -9, -0.5));
      const Vec3 across = normal / (glm::length(normal) + 1e-300);
      const Vec3 along = (b - a) + between(random_, -1, 1) * (c - a) + glm::length(b - a) * slant * across;
      ray.origin = target - between(random_, 0.1, 5) * along;
      ray.direction = target - ray.origin;
    } else if (kind < 0.8) {  // from another surface
      ray.origin = on_mesh(static_cast<std::uint32_t>(random_.next() % mesh.triangles.size()));
      ray.direction = target - ray.origin;
    } else {
      ray.origin = target;
      ray.direction = random_direction(random_);
    }
    if (random_.uniform() < 0.1) ray.direction[static_cast<int>(random_.next() % 3)] = 0.0;
    if (random_.uniform() < 0.3) ray.t_max = between(random_, 0.5, 1.5);
    if (random_.uniform() < 0.2) ray.t_min = between(random_, 0, 1.0) * std::min(ray.t_max, 2.0);
    if (random_.uniform() < 0.3) {  // another unit of t
      const double by = std::pow(10.0, between(random_, -5, 5));
      ray.direction *= by;
      ray.t_min /= by;
      ray.t_max /= by;
    }
    return ray;
  }

  WideMesh mesh;
  std::vector<std::uint32_t> object_first, moved;
  std::vector<Aabb<double>> boxes;

 private:
  void add_object(const WideMesh& part) {
    object_first.push_back(static_cast<std::uint32_t>(mesh.triangles.size()));
    vertex_first_.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
    mesh.append(part);
    offset_.push_back(object_first.size() == 1 ? Vec3(0.0) : random_in_cube(random_, 6.0));
  }
  std::uint32_t vertex_end(std::size_t object) const {
    return object + 1 < vertex_first_.size() ? vertex_first_[object + 1] : static_cast<std::uint32_t>(rest_.size());
  }
  void place(std::size_t object, double bend, double shrink) {
    for (std::uint32_t vertex = vertex_first_[object]; vertex < vertex_end(object); ++vertex) {
      const Vec3 local =
          shrink * rest_[vertex] + offset_[object] + (bend > 0 ? random_in_cube(random_, bend) : Vec3(0));
      const Vec3 away = object % 2 == 1 ? Vec3(scale_.far, 0, 0) : Vec3(0);
      mesh.vertices[vertex] = scale_.at + away + scale_.size * local;
    }
  }
  void place_all() {
    for (std::size_t object = 0; object < offset_.size(); ++object) place(object, 0.0, 1.0);
    boxes = mesh.boxes();
  }
  void change(std::size_t object) {
    const double kind = random_.uniform();
    if (object > 0) offset_[object] += random_in_cube(random_, kind < 0.1 ? 6.0 : 0.3);
    place(object, kind > 0.7 ? std::pow(10.0, between(random_, -4, 0)) : 0.0, kind > 0.65 && kind < 0.7 ? 0.0 : 1.0);
    const auto end = object + 1 < object_first.size() ? object_first[object + 1] : mesh.triangles.size();
    const bool goes = random_.uniform() < 0.1, comes = random_.uniform() < 0.3, in_part = random_.uniform() < 0.1;
    for (std::uint32_t triangle = object_first[object]; triangle < end; ++triangle) {
      if (comes) mesh.absent[triangle] = false;
      if (goes || (in_part && random_.uniform() < 0.3)) mesh.absent[triangle] = true;
      moved.push_back(triangle);
    }
  }

  RandomStream random_;
  Scale scale_;
  std::vector<Vec3> rest_, offset_;
  std::vector<std::uint32_t> vertex_first_;
};

// Checks.

std::string shape_of(const Scene& scene, std::uint32_t triangle) {
  if (triangle >= scene.mesh.triangles.size()) return "none";
  const auto& [a, b, c] = scene.mesh.corners(triangle);
  const double size = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
  char text[500];
  std::snprintf(text, sizeof text,
                "tri %u area/size2 %.3g size %.3g (%.17g %.17g %.17g) (%.17g %.17g %.17g) (%.17g %.17g %.17g)",
                triangle, glm::length(glm::cross(b - a, c - a)) / (size * size), size, a.x, a.y, a.z, b.x, b.y, b.z,
                c.x, c.y, c.z);
  return text;
}
std::string show(const std::optional<TriangleHit>& hit) {
  if (!hit) return "none";
  char text[80];
  std::snprintf(text, sizeof text, "%.17g on %u", hit->t, hit->triangle);
  return text;
}

/// What is wrong with an answer, against the reference; empty where nothing is.
std::string fault_of(const Scene& scene, const Ray<double>& ray, const std::optional<TriangleHit>& hit, bool occluded) {
  std::vector<Reference> all(scene.mesh.triangles.size());
  for (std::uint32_t triangle = 0; triangle < all.size(); ++triangle) {
    if (scene.mesh.is_there(triangle)) all[triangle] = reference_of(ray, scene.mesh.corners(triangle));
  }
  bool surely = false, perhaps = false;
  for (const Reference& one : all) {
    surely = surely || one.meeting == Meeting::surely;
    perhaps = perhaps || one.meeting != Meeting::no;
  }
  if (occluded && !perhaps) return "occluded by nothing";
  if (!occluded && surely) return "not occluded";
  if (hit.has_value() && !perhaps) return "nothing is met";
  if (!hit && surely) return "nothing found";
  if (!hit) return {};
  const Reference& own = all[hit->triangle];
  if (own.meeting == Meeting::no) return "a triangle that is not met: " + show(hit);
  if (std::abs(own.t - Real(hit->t)) > own.room) return "another t: " + show(hit);
  for (std::uint32_t triangle = 0; triangle < all.size(); ++triangle) {
    const Reference& other = all[triangle];
    if (other.meeting == Meeting::surely && other.t + other.room < Real(hit->t)) {
      return show(hit) + " but " + std::to_string(triangle) +
             " is nearer: " + std::to_string(static_cast<double>(other.t));
    }
  }
  return {};
}

/// Whether a triangle is all but a line, or a ray runs in its plane: what double precision says there is rounding
/// alone.
bool is_noise(const TriangleCorners& corners, const Ray<double>& ray) {
  const auto& [a, b, c] = corners;
  const Vec3 across = glm::cross(b - a, c - a);
  const double size = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
  const double area = glm::length(across);
  return !(area > 1e-12 * size * size) ||
         !(std::abs(glm::dot(across, ray.direction)) > 1e-12 * size * size * glm::length(ray.direction));
}

struct Tally {
  int hits = 0, misses = 0;
};

void check_ray(const Scene& scene, const std::vector<const WideBvh*>& trees, const Ray<double>& ray, Tally& tally) {
  INFO(text_of(ray));
  const WideBvh& tree = *trees[0];
  const auto hit = tree.closest_hit(ray);
  const bool occluded = tree.occluded(ray);
  CHECK(fault_of(scene, ray, hit, occluded) == "");
  const auto is_noisy = [&](const std::optional<TriangleHit>& one) {
    return one && is_noise(scene.mesh.corners(one->triangle), ray);
  };
  for (std::size_t index = 1; index < trees.size(); ++index) {
    if (is_noisy(hit) || is_noisy(trees[index]->closest_hit(ray))) continue;
    const auto other = trees[index]->closest_hit(ray);
    INFO(shape_of(scene, hit ? hit->triangle : other ? other->triangle : 0));
    INFO("tree " << index << ": " << show(other) << " instead of " << show(hit));
    // The sign of t = 0 is that of the quad's order of corners.
    CHECK(hit.has_value() == other.has_value());
    if (hit && other) {
      CHECK(hit->t == other->t);
      CHECK(hit->triangle == other->triangle);
    }
    CHECK(trees[index]->occluded(ray) == occluded);
  }
  CHECK(occluded == hit.has_value());
  (hit ? tally.hits : tally.misses) += 1;
  std::vector<TriangleHit> expected = dcem_test::exact_hits(scene.mesh, ray), visited;
  tree.visit_hits(ray, {}, [&](const TriangleHit& one) { return visited.push_back(one), false; });
  const auto is_noise_hit = [&](const TriangleHit& one) { return is_noise(scene.mesh.corners(one.triangle), ray); };
  std::erase_if(expected, is_noise_hit);
  std::erase_if(visited, is_noise_hit);
  std::ranges::sort(visited, [](const TriangleHit& one, const TriangleHit& other) {
    return one.t != other.t ? one.t < other.t : one.triangle < other.triangle;
  });
  CHECK(visited == expected);
}

void check_boxes(const Scene& scene, const WideBvh& tree, RandomStream& random) {
  const std::size_t count = scene.boxes.size();
  const auto one = scene.boxes[random.next() % count], other = scene.boxes[random.next() % count];
  Aabb<double> region = one;
  if (random.uniform() < 0.3) region.extend(other);
  if (!region.empty() && random.uniform() < 0.5)
    region.max[0] = region.min[0] = random.uniform() < 0.5 ? region.min[0] : region.max[0];
  std::vector<int> seen(count, 0), visited(count, 0);
  tree.overlapping(region, [&](std::uint32_t triangle) { ++seen[triangle]; });
  const Vec3 normal = random_direction(random);
  const double depth = one.empty() ? 0.0 : glm::dot(normal, one.center());
  const auto keep = [&](const Aabb<double>& box) {
    double most = 0.0;
    for (int axis = 0; axis < 3; ++axis) most += std::max(normal[axis] * box.min[axis], normal[axis] * box.max[axis]);
    return most >= depth;
  };
  tree.visit(keep, [&](std::uint32_t triangle) { ++visited[triangle]; });
  for (std::size_t triangle = 0; triangle < count; ++triangle) {
    const Aabb<double>& box = scene.boxes[triangle];
    const bool right = seen[triangle] == (!region.empty() && !box.empty() && region.overlaps(box) ? 1 : 0);
    if (!right) CHECK_MESSAGE(right, "overlapping " << triangle);
    const bool kept = visited[triangle] == (!box.empty() && keep(box) ? 1 : 0);
    if (!kept) CHECK_MESSAGE(kept, "visit " << triangle);
  }
}

/// What is broken. Of a tree of which nothing is there the tracked sum is what roundings left of it: it weighs nothing.
std::string defect_of(const WideBvh& tree, const Scene& scene) {
  const std::string defect = tree.validate(scene.boxes);
  return tree.bounds().empty() && defect == "the sum of areas is off" ? "" : defect;
}

void edit(Scene& scene, WideBvh& tree, RandomStream& random) {
  const auto chance = [&](double of) { return random.uniform() < of; };
  if (chance(0.1)) tree.watch({chance(0.5), chance(0.5), chance(0.5)});
  if (chance(0.02)) {
    scene.all_absent(chance(0.7));
  } else {
    scene.step();
  }
  if (chance(0.05)) {
    tree.rebuild(scene.mesh.view(), scene.boxes);
  } else {
    tree.refit(scene.moved, scene.mesh.view(), scene.boxes);
  }
  REQUIRE(defect_of(tree, scene) == "");
  if (chance(0.6)) {
    const std::array limits{1.0, 1.1, 3.0, infinity};
    const std::array<std::uint32_t, 3> turns{0, 1, 50};
    tree.reinsert_moved(limits[random.next() % 4], turns[random.next() % 3]);
    REQUIRE(defect_of(tree, scene) == "");
  }
  if (chance(0.4)) {
    tree.rotate_touched(static_cast<std::uint32_t>(1 + random.next() % 9));
    REQUIRE(defect_of(tree, scene) == "");
  }
  if (chance(0.3)) tree.measure();
  for (int turn = 0; turn < 3 && chance(0.4); ++turn) {
    const std::vector<std::uint32_t> nodes = nodes_of(tree.arrays());
    const std::array shares{infinity, 1.0, 0.9, 1e-300};
    tree.rebuild_subtree(nodes[random.next() % nodes.size()], shares[random.next() % 4]);
    REQUIRE(defect_of(tree, scene) == "");
  }
}

/// DCEM_FUZZ=20 runs twenty times as many scenes.
int times() {
  const char* given = std::getenv("DCEM_FUZZ");
  return given != nullptr ? std::max(1, std::atoi(given)) : 1;
}

void drive(const Scale& scale, int scenes, int frames, int rays, std::uint64_t seed) {
  Tally tally;
  for (int number = 0; number < scenes * times(); ++number) {
    const std::uint64_t own_seed = seed + static_cast<std::uint64_t>(number);
    CAPTURE(own_seed);
    Scene scene(own_seed, scale);
    RandomStream random(own_seed + 1000);
    WideBvh tree = scene.built(1e-3, static_cast<WideQuality>(number % 3), number % 2 == 0 ? 60 : 500);
    for (int frame = 0; frame < frames; ++frame) {
      CAPTURE(frame);
      if (frame > 0) edit(scene, tree, random);
      REQUIRE(defect_of(tree, scene) == "");
      const WideBvh fresh = scene.built(1e-3, WideQuality::good), alone = scene.built(-1.0, WideQuality::fast);
      const WideBvh high = scene.built(0.5, WideQuality::high, 0);
      REQUIRE(high.validate(scene.boxes) == "");
      for (int turn = 0; turn < rays; ++turn) check_ray(scene, {&tree, &alone, &fresh, &high}, scene.ray(), tally);
      for (int turn = 0; turn < 4; ++turn) check_boxes(scene, tree, random);
    }
  }
  MESSAGE("hits " << tally.hits << ", misses " << tally.misses);
  CHECK(tally.hits > 100);
  CHECK(tally.misses > 100);
}

}  // namespace

TEST_CASE("fuzz 1 m: a tree under any edits answers as long double does, with the bits of trees built now") {
  drive({}, 6, 12, 60, 1);
}
TEST_CASE("fuzz 1 um: a tree under any edits answers as long double does, with the bits of trees built now") {
  drive({1e-6, Vec3(0), 0.0}, 4, 10, 60, 101);
}
TEST_CASE("fuzz 1e7 m away: a tree under any edits answers as long double does, with the bits of trees built now") {
  drive({1.0, Vec3(1e7, -2e7, 3e6), 0.0}, 4, 10, 60, 201);
}
TEST_CASE("fuzz 1e7 m large: a tree under any edits answers as long double does, with the bits of trees built now") {
  drive({1e6, Vec3(0), 0.0}, 4, 10, 60, 301);
}
TEST_CASE("fuzz two places 1e5 m apart: answers as long double, with the bits of trees built now") {
  drive({1.0, Vec3(0), 1e5}, 4, 10, 60, 401);
}
TEST_CASE("fuzz 1 mm at places 2e5 m apart: answers as long double, with the bits of trees built now") {
  drive({1e-3, Vec3(-1e5, 0, 0), 2e5}, 3, 6, 60, 501);
}
TEST_CASE("fuzz 1e-15 m: answers as long double, with the bits of trees built now") {
  drive({1e-15, Vec3(0), 0.0}, 3, 6, 60, 601);
}

TEST_CASE("rays that begin on one axis are sorted along it") {
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<Ray<double>> rays(64);
    for (std::size_t index = 0; index < rays.size(); ++index) {
      rays[index].origin[axis] = static_cast<double>(index * 37 % 64);
      rays[index].direction = Vec3(1.0);
    }
    RayOrder order;
    double before = -1.0;
    for (const std::uint32_t ray : order.sort(rays)) {
      CHECK(rays[ray].origin[axis] == before + 1.0);
      before = rays[ray].origin[axis];
    }
  }
}

}  // namespace test_fuzz_slow
