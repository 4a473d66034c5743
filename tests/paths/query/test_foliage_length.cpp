/// How far a leg runs inside foliage, and that foliage does nothing else to a path. Lengths are compared with the
/// clipping of the leg by half spaces, which counts no crossing.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "dcem/paths/discover/exact_search.hpp"
#include "dcem/paths/discover/path_cache.hpp"
#include "dcem/paths/discover/ray_launcher.hpp"
#include "dcem/paths/path_id.hpp"
#include "dcem/paths/query/foliage_length.hpp"
#include "dcem/paths/query/obstruction.hpp"
#include "dcem/sim/discovery.hpp"
#include "dcem/sim/simulator.hpp"
#include "dcem/sim/verify/same_bits.hpp"
#include "dcem/sim/verify/verifier.hpp"
#include "tests/paths/small_scenes.hpp"

namespace test_foliage_length {

using namespace dcem;
using namespace dcem::test;

namespace {

constexpr double leaves_db_per_m = 2.0, needles_db_per_m = 7.0;
/// Of lengths of some metres: coordinates of some tens of metres have 4e-15 m of rounding, a leg at an angle of
/// 1e-4 to a face makes 1e-10 m of it.
constexpr double rounding_m = 1e-9;

Scene scene_with_foliage(double db_per_m = leaves_db_per_m) {
  Scene scene = scene_of_materials();
  scene.add_material({"leaves", Foliage{db_per_m}});
  scene.add_material({"needles", Foliage{needles_db_per_m}});
  return scene;
}

Motion standing(const Pose& pose) {
  return LinearMotion{pose, Vec3(0.0), 0.0};
}

/// A crown between two corners, in the mesh's own coordinates.
TriangleMesh block(const Vec3& low_m, const Vec3& high_m, const std::string& material = "leaves") {
  TriangleMesh mesh;
  add_box_faces(mesh, low_m, high_m, material);
  return mesh;
}

/// A scene with one crown.
Scene scene_with(const TriangleMesh& crown, const Pose& pose = {}) {
  Scene scene = scene_with_foliage();
  scene.add_object("crown", crown, standing(pose));
  return scene;
}

double inside_m(const Scene& scene, const Vec3& from_m, const Vec3& to_m, const std::string& material = "leaves",
                const IgnoredBodies& ignored = {}) {
  std::vector<FoliageLength> foliage;
  add_foliage_along(scene, from_m, to_m, ignored, foliage);
  double sum_m = 0.0;
  std::set<std::string> seen;
  for (const FoliageLength& part : foliage) {
    const std::string& name = scene.material(part.material).name;
    CHECK(seen.insert(name).second);  // one entry per material
    CHECK(part.length_m > 0.0);
    if (name == material) sum_m += part.length_m;
  }
  return sum_m;
}

/// A half space: points with dot(normal, point) ≤ offset.
struct SolidSide {
  Vec3 normal;
  double offset;
};

/// The length of a leg within all half spaces (Cyrus and Beck).
double clipped_m(const std::vector<SolidSide>& convex, const Vec3& from_m, const Vec3& to_m) {
  double enter = 0.0, leave = 1.0;
  for (const SolidSide& half : convex) {
    const double outside = glm::dot(half.normal, from_m) - half.offset;
    const double slope = glm::dot(half.normal, to_m - from_m);
    if (slope > 0.0) leave = std::min(leave, -outside / slope);
    if (slope < 0.0) enter = std::max(enter, -outside / slope);
    if (slope == 0.0 && outside > 0.0) return 0.0;
  }
  return std::max(0.0, leave - enter) * glm::distance(from_m, to_m);
}

std::vector<SolidSide> half_spaces(const Vec3& low_m, const Vec3& high_m) {
  std::vector<SolidSide> all;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 normal(0.0);
    normal[axis] = 1.0;
    all.push_back({normal, high_m[axis]});
    all.push_back({-normal, -low_m[axis]});
  }
  return all;
}

/// The half spaces of a convex mesh around the origin.
std::vector<SolidSide> half_spaces(const TriangleMesh& convex) {
  std::vector<SolidSide> all;
  for (const TriangleMesh::Triangle& triangle : convex.triangles) {
    const Vec3 &a = convex.vertices_m[triangle.vertices[0]], &b = convex.vertices_m[triangle.vertices[1]],
               &c = convex.vertices_m[triangle.vertices[2]];
    Vec3 normal = glm::normalize(glm::cross(b - a, c - a));
    if (glm::dot(normal, a) < 0.0) normal = -normal;
    all.push_back({normal, glm::dot(normal, a)});
  }
  return all;
}

/// The octahedron of `radius_m` with its sides halved again and again and the corners put on the sphere.
TriangleMesh ball(double radius_m, int halvings) {
  const std::vector<Vec3> poles{{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  std::vector<std::array<Vec3, 3>> faces;
  for (std::size_t side = 0; side < 4; ++side) {
    for (std::size_t pole = 4; pole < 6; ++pole) faces.push_back({poles[side], poles[(side + 1) % 4], poles[pole]});
  }
  for (int round = 0; round < halvings; ++round) {
    std::vector<std::array<Vec3, 3>> finer;
    for (const auto& [a, b, c] : faces) {
      const Vec3 ab = glm::normalize(a + b), bc = glm::normalize(b + c), ca = glm::normalize(c + a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    faces = finer;
  }
  TriangleMesh mesh;
  const std::uint32_t material = material_index(mesh, "leaves");
  for (const auto& face : faces) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices_m.size());
    for (const Vec3& corner : face) mesh.vertices_m.push_back(radius_m * corner);
    mesh.triangles.push_back({{first, first + 1, first + 2}, material});
  }
  return mesh;
}

/// A U of five cells, seen along y: two arms of two cells, one cell between their feet.
struct LetterU {
  static constexpr std::array<std::array<int, 2>, 5> cells{{{0, 0}, {1, 0}, {2, 0}, {0, 1}, {2, 1}}};
  static bool has(int i, int k) {
    return std::any_of(cells.begin(), cells.end(), [&](const auto& cell) { return cell[0] == i && cell[1] == k; });
  }
  static Vec3 corner_m(int i, int j, int k) { return {2.0 * i - 3.0, 3.0 * j - 1.5, 2.5 * k}; }

  static TriangleMesh mesh() {
    TriangleMesh mesh;
    for (const auto& [i, k] : cells) {
      const auto quad = [&](bool wanted, const std::array<Vec3, 4>& corners_m) {
        if (wanted) add_quad(mesh, corners_m, "leaves");
      };
      const auto p = [i = i, k = k](int a, int b, int c) { return corner_m(i + a, b, k + c); };
      quad(!has(i - 1, k), {p(0, 0, 0), p(0, 1, 0), p(0, 1, 1), p(0, 0, 1)});
      quad(!has(i + 1, k), {p(1, 0, 0), p(1, 1, 0), p(1, 1, 1), p(1, 0, 1)});
      quad(!has(i, k - 1), {p(0, 0, 0), p(1, 0, 0), p(1, 1, 0), p(0, 1, 0)});
      quad(!has(i, k + 1), {p(0, 0, 1), p(1, 0, 1), p(1, 1, 1), p(0, 1, 1)});
      quad(true, {p(0, 0, 0), p(1, 0, 0), p(1, 0, 1), p(0, 0, 1)});
      quad(true, {p(0, 1, 0), p(1, 1, 0), p(1, 1, 1), p(0, 1, 1)});
    }
    return mesh;
  }

  static double clipped_m(const Vec3& from_m, const Vec3& to_m) {
    double sum_m = 0.0;
    for (const auto& [i, k] : cells) {
      sum_m += test_foliage_length::clipped_m(half_spaces(corner_m(i, 0, k), corner_m(i + 1, 1, k + 1)), from_m, to_m);
    }
    return sum_m;
  }
};

Vec3 local_m(const Pose& pose, const Vec3& world_m) {
  return glm::transpose(rotation_matrix(pose)) * (world_m - pose.position_m);
}

Vec3 world_m(const Pose& pose, const Vec3& local_m) {
  return pose.position_m + rotation_matrix(pose) * local_m;
}

Pose drawn_pose(Draw& draw) {
  return {draw.inside(Vec3(-20), Vec3(20)), draw.between(-pi, pi), draw.between(-1.5, 1.5), draw.between(-pi, pi)};
}

/// Legs of which many meet what lies within `reach_m` of the origin, and many begin or end in it.
std::pair<Vec3, Vec3> drawn_leg(Draw& draw, double reach_m) {
  const auto point = [&] { return draw.inside(Vec3(-reach_m), Vec3(reach_m)); };
  const Vec3 middle_m = point(), along = draw.direction();
  switch (draw.below(3)) {
    case 0:
      return {point(), point()};
    case 1:
      return {middle_m, middle_m + draw.between(0.1, 10.0) * reach_m * along};
    default:
      return {middle_m - 5.0 * reach_m * along, middle_m + 7.0 * reach_m * along};
  }
}

}  // namespace

TEST_CASE("a leg loses by its length inside a box, wherever it begins and ends") {
  const Vec3 low_m(-2, -1, 0.5), high_m(1, 3, 4);
  const Scene scene = scene_with(block(low_m, high_m));
  const auto reference = half_spaces(low_m, high_m);
  Draw draw(1);
  const auto holds = [&](const Vec3& point_m) {
    return std::all_of(reference.begin(), reference.end(),
                       [&](const SolidSide& half) { return glm::dot(half.normal, point_m) < half.offset; });
  };
  int through = 0, one_end = 0, both_ends = 0;
  for (int trial = 0; trial < 5000; ++trial) {
    const auto [from_m, to_m] = drawn_leg(draw, 5.0);
    const double expected_m = clipped_m(reference, from_m, to_m);
    CHECK(std::abs(inside_m(scene, from_m, to_m) - expected_m) < rounding_m);
    through += expected_m > 0.0;
    one_end += holds(from_m) != holds(to_m);
    both_ends += holds(from_m) && holds(to_m);
  }
  CHECK(through > 800);
  CHECK(one_end > 100);
  CHECK(both_ends > 3);
}

TEST_CASE("lengths by hand: through, from inside, into it, from inside to inside, beside") {
  const Scene scene = scene_with(block(Vec3(0, 0, 0), Vec3(4, 3, 2)));
  const auto length_m = [&](const Vec3& from, const Vec3& to) { return inside_m(scene, from, to); };
  CHECK(length_m({-5, 1, 1.25}, {9, 1, 1.25}) == doctest::Approx(4.0).epsilon(1e-14));
  CHECK(length_m({1, 1, 1.25}, {9, 1, 1.25}) == doctest::Approx(3.0).epsilon(1e-14));
  CHECK(length_m({-5, 1, 1.25}, {1, 1, 1.25}) == doctest::Approx(1.0).epsilon(1e-14));
  CHECK(length_m({1, 1, 1.25}, {2.5, 1, 1.25}) == doctest::Approx(1.5).epsilon(1e-14));
  CHECK(length_m({1, 1, 0.25}, {1, 2, 1.25}) == doctest::Approx(std::sqrt(2.0)).epsilon(1e-14));
  // Away from it, up to it, beside it.
  CHECK(length_m({-5, 1, 1.25}, {-1, 1, 1.25}) == 0.0);
  CHECK(length_m({-1, 1, 1.25}, {-5, 1, 1.25}) == 0.0);
  CHECK(length_m({-5, 3.5, 1.25}, {9, 3.5, 1.25}) == 0.0);
  // From its skin: outwards, inwards, and up to it.
  CHECK(length_m({0, 1, 1.25}, {-5, 1, 1.25}) == 0.0);
  CHECK(length_m({0, 1, 1.25}, {9, 1, 1.25}) == doctest::Approx(4.0).epsilon(1e-14));
  CHECK(length_m({-5, 1, 1.25}, {0, 1, 1.25}) == 0.0);
  CHECK(length_m({1, 1, 1.25}, {0, 1, 1.25}) == doctest::Approx(1.0).epsilon(1e-14));
}

TEST_CASE("a leg and its reverse run through the same foliage") {
  Scene scene = scene_with_foliage();
  scene.add_object("a", LetterU::mesh(), standing({Vec3(0, 0, 0), 0.4, 0.2, 0.1}));
  scene.add_object("b", block(Vec3(-1), Vec3(2), "needles"), standing({Vec3(1, 1, 1), 2.0}));
  Draw draw(2);
  for (int trial = 0; trial < 2000; ++trial) {
    const auto [from_m, to_m] = drawn_leg(draw, 5.0);
    for (const char* material : {"leaves", "needles"}) {
      CHECK(std::abs(inside_m(scene, from_m, to_m, material) - inside_m(scene, to_m, from_m, material)) < rounding_m);
    }
  }
}

TEST_CASE("a turned object is the same crown in its own coordinates") {
  const Vec3 size_m(3, 2, 5);
  const auto reference = half_spaces(Vec3(-1.5, -1, 0), Vec3(1.5, 1, 5));
  Draw draw(3);
  int through = 0;
  for (int object = 0; object < 60; ++object) {
    const Pose pose = drawn_pose(draw);
    const Scene scene = scene_with(make_box(size_m, "leaves"), pose);
    for (int trial = 0; trial < 50; ++trial) {
      const auto [from_m, to_m] = drawn_leg(draw, 4.0);
      const double expected_m = clipped_m(reference, from_m, to_m);
      CHECK(std::abs(inside_m(scene, world_m(pose, from_m), world_m(pose, to_m)) - expected_m) < rounding_m);
      CHECK(glm::distance(local_m(pose, world_m(pose, from_m)), from_m) < 1e-12);  // the pose is what it says
      through += expected_m > 0.0;
    }
  }
  CHECK(through > 300);
}

TEST_CASE("a ball of triangles: the chord of its half spaces, and that of the sphere to what the triangles cut off") {
  const double radius_m = 3.0;
  const TriangleMesh mesh = ball(radius_m, 3);
  const auto reference = half_spaces(mesh);
  const Scene scene = scene_with(mesh);
  // The nearest a face comes to the centre; beyond it a leg may or may not meet the ball.
  double least_m = radius_m;
  for (const SolidSide& half : reference) least_m = std::min(least_m, half.offset);
  CHECK(least_m > 0.97 * radius_m);
  Draw draw(4);
  int through = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const auto [from_m, to_m] = drawn_leg(draw, 4.0);
    const double expected_m = clipped_m(reference, from_m, to_m);
    const double found_m = inside_m(scene, from_m, to_m);
    CHECK(std::abs(found_m - expected_m) < rounding_m);
    through += expected_m > 0.0;
    const Vec3 along = glm::normalize(to_m - from_m);
    const double from = glm::dot(from_m, along), to = glm::dot(to_m, along);
    const double passes_m = glm::length(from_m - from * along);
    const auto chord_m = [&](double r) {
      const double half = passes_m < r ? std::sqrt(r * r - passes_m * passes_m) : 0.0;
      return std::max(0.0, std::min(to, half) - std::max(from, -half));
    };
    CHECK(found_m <= chord_m(radius_m) + rounding_m);
    CHECK(found_m >= chord_m(least_m) - rounding_m);
  }
  CHECK(through > 500);
}

TEST_CASE("a crown with a hollow between two arms counts each arm, not what is between them") {
  const Scene scene = scene_with(LetterU::mesh());
  CHECK(scene.foliage().size() == 1);
  // Across both arms of 2 m each; down into the hollow.
  CHECK(inside_m(scene, Vec3(-9, 0.3, 4), Vec3(9, 0.3, 4.1)) == doctest::Approx(4.0).epsilon(1e-3));
  CHECK(inside_m(scene, Vec3(0.1, 0.2, 9), Vec3(0.1, 0.2, 3)) == 0.0);
  Draw draw(5);
  int twice = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    const auto [from_m, to_m] = drawn_leg(draw, 5.0);
    const double expected_m = LetterU::clipped_m(from_m, to_m);
    CHECK(std::abs(inside_m(scene, from_m, to_m) - expected_m) < rounding_m);
    const double whole_m = clipped_m(half_spaces(LetterU::corner_m(0, 0, 0), LetterU::corner_m(3, 1, 2)), from_m, to_m);
    twice += expected_m > 0.1 && expected_m < whole_m - 0.1;
  }
  CHECK(twice > 100);
}

TEST_CASE("a leg through an edge of a crown is as long inside as one beside it") {
  const Scene scene = scene_with(block(Vec3(-1), Vec3(1)));
  const auto length_m = [&](const Vec3& from, const Vec3& to) { return inside_m(scene, from, to); };
  // Every number here is exact in binary, so the legs meet the edges, not a place beside them.
  CHECK(length_m({-5, -5, 0.25}, {5, 5, 0.25}) == doctest::Approx(2.0 * std::sqrt(2.0)));  // edge to edge
  CHECK(length_m({-5, -3, 0.25}, {5, 2, 0.25}) == doctest::Approx(std::sqrt(5.0)));        // edge to face
  CHECK(length_m({5, 2, 0.25}, {-5, -3, 0.25}) == doctest::Approx(std::sqrt(5.0)));        // face to edge
  CHECK(length_m({0, 0, 0}, {4, 4, 0}) == doctest::Approx(std::sqrt(2.0)));                // out through an edge
  CHECK(length_m({4, 4, 0}, {0, 0, 0}) == doctest::Approx(std::sqrt(2.0)));                // in through an edge
  CHECK(length_m({-5, -5, 0.25}, {0, 0, 0.25}) == doctest::Approx(std::sqrt(2.0)));
  CHECK(length_m({-5, 0, 0}, {5, 0, 0}) == doctest::Approx(2.0));  // the diagonals of two faces, where they cross
  CHECK(length_m({-5, 0.5, 0.5}, {5, 0.5, 0.5}) == doctest::Approx(2.0));
}

TEST_CASE("a leg through a corner of a crown is as long inside as one beside it") {
  const Scene scene = scene_with(block(Vec3(-1), Vec3(1)));
  const auto length_m = [&](const Vec3& from, const Vec3& to) { return inside_m(scene, from, to); };
  CHECK(length_m({-3, -3, -3}, {3, 3, 3}) == doctest::Approx(2.0 * std::sqrt(3.0)));
  CHECK(length_m({-5, -3, -2}, {7, 3, 1}) == doctest::Approx(std::sqrt(5.25)));  // in at a corner, out at (1, 0, −0.5)
  CHECK(length_m({7, 3, 1}, {-5, -3, -2}) == doctest::Approx(std::sqrt(5.25)));
  CHECK(length_m({0, 0, 0}, {3, 3, 3}) == doctest::Approx(std::sqrt(3.0)));
  CHECK(length_m({1, 1, 1}, {-3, -3, -3}) == doctest::Approx(2.0 * std::sqrt(3.0)));
  CHECK(length_m({1, 1, 1}, {3, 3, 3}) == doctest::Approx(0.0));
}

TEST_CASE("a leg that only touches an edge or a corner of a crown loses nothing") {
  const Scene scene = scene_with(block(Vec3(-1), Vec3(1)));
  const auto length_m = [&](const Vec3& from, const Vec3& to) { return inside_m(scene, from, to); };
  // What a leg that misses the edge by the rounding of its coordinates may find.
  const double nearly_m = 1e-6;
  CHECK(length_m({-3, 1, 0.25}, {1, 5, 0.25}) < nearly_m);   // never within
  CHECK(length_m({-3, -1, 0.25}, {1, 3, 0.25}) < nearly_m);  // touches the edge at (−1, 1)
  CHECK(length_m({-3, 3, 0.25}, {3, -3, 0.25}) > 2.0);       // as a counter-check: this one crosses
  CHECK(length_m({-1, -3, 3}, {3, 1, -1}) < nearly_m);       // touches the corner (1, −1, 1)
  CHECK(length_m({-1, 3, 3}, {3, -1, -1}) < nearly_m);       // touches the corner (1, 1, 1)
}

TEST_CASE("through every corner of a ball, from pole to pole and across") {
  const TriangleMesh mesh = ball(2.0, 2);
  const auto reference = half_spaces(mesh);
  const Scene scene = scene_with(mesh);
  double worst_m = 0.0;
  for (std::size_t one = 0; one < mesh.vertices_m.size(); one += 5) {
    for (std::size_t other = 1; other < mesh.vertices_m.size(); other += 31) {
      const Vec3 through_m = mesh.vertices_m[one], beyond_m = -1.7 * mesh.vertices_m[other];
      if (glm::distance(through_m, beyond_m) < 1.0) continue;
      const Vec3 from_m = through_m + 2.0 * (through_m - beyond_m), to_m = beyond_m;
      // The ball bulges: what is left of a chord of nearly no length is decided by rounding.
      worst_m = std::max(worst_m, std::abs(inside_m(scene, from_m, to_m) - clipped_m(reference, from_m, to_m)));
    }
  }
  CHECK(worst_m < 1e-5);
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 along(0.0);
    along[axis] = 1.0;
    CHECK(inside_m(scene, -8.0 * along, 5.0 * along) == doctest::Approx(4.0));
    CHECK(inside_m(scene, Vec3(0.0), 5.0 * along) == doctest::Approx(2.0));
  }
}

TEST_CASE("a leg in the plane of a face is inside all the way along it or not at all") {
  const Scene scene = scene_with(block(Vec3(-1), Vec3(1)));
  const auto none_or = [&](const Vec3& from, const Vec3& to, double length_m) {
    const double found_m = inside_m(scene, from, to);
    CAPTURE(found_m);
    CHECK((std::abs(found_m) < 1e-6 || std::abs(found_m - length_m) < 1e-6));
  };
  none_or({-5, 0.25, 1}, {5, 0.25, 1}, 2.0);                      // across the top
  none_or({-5, -5, 1}, {5, 5, 1}, 2.0 * std::sqrt(2.0));          // along its diagonal
  none_or({-5, -3, 1}, {5, 2, 1}, std::sqrt(5.0));                // across it, from a corner
  none_or({-5, 1, 1}, {5, 1, 1}, 2.0);                            // along an edge
  none_or({0.25, 0.25, 1}, {5, 0.25, 1}, 0.75);                   // from a point of the top
  none_or({0.25, 0.25, 1}, {-0.5, -0.25, 1}, std::sqrt(0.8125));  // from one to another
  none_or({1, 1, -5}, {1, 1, 5}, 2.0);
}

TEST_CASE("two crowns in a row add up, and materials are kept apart") {
  Scene scene = scene_with_foliage();
  scene.add_object("near", make_box(Vec3(2, 2, 2), "leaves"), standing({Vec3(5, 0, 0)}));
  scene.add_object("far", make_box(Vec3(3, 2, 2), "leaves"), standing({Vec3(15, 0, 0)}));
  scene.add_object("fir", make_box(Vec3(1.5, 2, 2), "needles"), standing({Vec3(25, 0, 0)}));
  const Vec3 from_m(0, 0.25, 1.25), to_m(40, 0.25, 1.25);
  CHECK(inside_m(scene, from_m, to_m) == doctest::Approx(5.0).epsilon(1e-14));
  CHECK(inside_m(scene, from_m, to_m, "needles") == doctest::Approx(1.5).epsilon(1e-14));
  CHECK(inside_m(scene, from_m, Vec3(20, 0.25, 1.25), "needles") == 0.0);
  // A path's list is carried from leg to leg.
  std::vector<FoliageLength> foliage;
  add_foliage_along(scene, from_m, to_m, {}, foliage);
  add_foliage_along(scene, to_m, from_m, {}, foliage);
  REQUIRE(foliage.size() == 2);
  std::map<std::string, double> by_name;
  for (const FoliageLength& part : foliage) by_name[scene.material(part.material).name] = part.length_m;
  CHECK(by_name["leaves"] == doctest::Approx(10.0).epsilon(1e-14));
  CHECK(by_name["needles"] == doctest::Approx(3.0).epsilon(1e-14));
}

TEST_CASE("two shells of one mesh are two crowns; where crowns of two materials overlap both count") {
  TriangleMesh row;
  add_box_faces(row, Vec3(0, -1, 0), Vec3(2, 1, 2), "leaves");
  add_box_faces(row, Vec3(3, -1, 0), Vec3(4, 1, 2), "leaves");
  add_box_faces(row, Vec3(1, -1, 0), Vec3(3.5, 1, 2), "needles");
  Scene scene = scene_with_foliage();
  scene.set_scenery(row);
  CHECK(scene.foliage().size() == 3);
  const Vec3 from_m(-5, 0.25, 0.75), to_m(9, 0.25, 0.75);
  CHECK(inside_m(scene, from_m, to_m) == doctest::Approx(3.0).epsilon(1e-14));
  CHECK(inside_m(scene, from_m, to_m, "needles") == doctest::Approx(2.5).epsilon(1e-14));
  // From within both.
  CHECK(inside_m(scene, Vec3(1.5, 0.25, 0.75), to_m) == doctest::Approx(1.5).epsilon(1e-14));
  CHECK(inside_m(scene, Vec3(1.5, 0.25, 0.75), to_m, "needles") == doctest::Approx(2.0).epsilon(1e-14));
}

TEST_CASE("how a crown is cut into triangles, and in which order they come, changes no length") {
  const Vec3 low_m(-2, -1.5, -1), high_m(2, 1.5, 1);
  TriangleMesh fine;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      Vec3 middle_m(0.0), u(0.0), v(0.0);
      middle_m[axis] = side * high_m[axis];
      u[(axis + 1) % 3] = high_m[(axis + 1) % 3];
      v[(axis + 2) % 3] = high_m[(axis + 2) % 3];
      add_tiled_sheet(fine, middle_m, u, v, 4, "leaves");
    }
  }
  TriangleMesh backwards = fine;
  std::reverse(backwards.triangles.begin(), backwards.triangles.end());
  for (std::size_t index = 0; index < backwards.triangles.size(); index += 3) {
    std::swap(backwards.triangles[index].vertices[0], backwards.triangles[index].vertices[1]);  // winding means nothing
  }
  const Scene coarse = scene_with(block(low_m, high_m)), tiled = scene_with(fine), turned = scene_with(backwards);
  Draw draw(6);
  for (int trial = 0; trial < 1500; ++trial) {
    auto [from_m, to_m] = drawn_leg(draw, 3.0);
    if (trial % 3 == 0) {  // through the corners of the tiles
      for (int axis = 0; axis < 3; ++axis) {
        from_m[axis] = std::round(from_m[axis]);
        to_m[axis] = std::round(to_m[axis]) + 0.5;
      }
    }
    const double expected_m = inside_m(coarse, from_m, to_m);
    CHECK(std::abs(inside_m(tiled, from_m, to_m) - expected_m) < rounding_m);
    CHECK(std::abs(inside_m(turned, from_m, to_m) - expected_m) < rounding_m);
  }
}

TEST_CASE("a world that is turned and moved as a whole has the same lengths") {
  Draw draw(7);
  for (int round = 0; round < 20; ++round) {
    const Pose whole = drawn_pose(draw), tree{Vec3(1, 2, 0), 0.7};
    const TriangleMesh mesh = round % 2 == 0 ? LetterU::mesh() : ball(2.5, 2);
    TriangleMesh moved = mesh;
    for (Vec3& vertex : moved.vertices_m) vertex = world_m(whole, world_m(tree, vertex));
    const Scene upright = scene_with(mesh, tree), tilted = scene_with(moved);
    for (int trial = 0; trial < 100; ++trial) {
      const auto [from_m, to_m] = drawn_leg(draw, 5.0);
      const double expected_m = inside_m(upright, from_m, to_m);
      CHECK(std::abs(inside_m(tilted, world_m(whole, from_m), world_m(whole, to_m)) - expected_m) < rounding_m);
    }
  }
}

TEST_CASE("only shells that are closed, and of one foliage all around, are foliage") {
  Scene scene = scene_with_foliage();
  const auto refused = [&](const TriangleMesh& mesh, const char* material) {
    CAPTURE(material);
    try {
      scene.add_object("bad", mesh, LinearMotion{});
      FAIL_CHECK("accepted");
    } catch (const std::invalid_argument& error) {
      CHECK(std::string(error.what()).find(material) != std::string::npos);
    }
    CHECK(scene.bodies().size() == 1);
    CHECK(scene.foliage().empty());
  };
  TriangleMesh sheet;
  add_sheet_across_x(sheet, 0.0, 2.0, "leaves");
  refused(sheet, "leaves");
  for (const std::size_t face : {1U, 2U, 3U, 4U, 5U}) {
    CAPTURE(face);
    TriangleMesh open = make_box(Vec3(2, 2, 2), "leaves");
    open.triangles.erase(open.triangles.begin() + static_cast<std::ptrdiff_t>(2 * face),
                         open.triangles.begin() + static_cast<std::ptrdiff_t>(2 * face + 2));
    refused(open, "leaves");
  }
}

TEST_CASE("a crown that is open below encloses nothing that could be measured: refused") {
  // A house without a floor stands on the ground; a crown does not.
  TriangleMesh open = make_box(Vec3(2, 2, 2), "leaves");
  open.triangles.erase(open.triangles.begin(), open.triangles.begin() + 2);
  Scene scene = scene_with_foliage();
  bool refused = false;
  try {
    scene.add_object("crown", open, standing({Vec3(0, 0, 3)}));
  } catch (const std::invalid_argument&) {
    refused = true;
  }
  // Accepted, it must at least not count the air below: 2 m of crown over 50 m of air.
  const bool right = refused || std::abs(inside_m(scene, Vec3(0.1, 0.2, -50), Vec3(0.1, 0.2, 50)) - 2.0) < 1e-6;
  CHECK(right);
}

TEST_CASE("a shell that is partly foliage and partly something else is refused") {
  for (const char* other : {"glass", "needles"}) {
    CAPTURE(other);
    TriangleMesh mixed = make_box(Vec3(2, 2, 2), "leaves");
    const std::uint32_t index = material_index(mixed, other);
    mixed.triangles[10].material = mixed.triangles[11].material = index;
    Scene scene = scene_with_foliage();
    bool refused = false;
    try {
      scene.add_object("crown", mixed, LinearMotion{});
    } catch (const std::invalid_argument&) {
      refused = true;
    }
    // Accepted, it must at least measure the 2 m between its faces.
    const Vec3 from_m(-5, 0.1, 0.75), to_m(5, 0.2, 0.8);
    const bool right = refused || std::abs(inside_m(scene, from_m, to_m) + inside_m(scene, from_m, to_m, "needles") -
                                           glm::distance(from_m, to_m) * 0.2) < 1e-6;
    CHECK(right);
  }
}

namespace {

/// Ground, two houses, a screen of glass: surfaces and edges for every kind of path.
TriangleMesh street() {
  TriangleMesh mesh;
  add_sheet(mesh, Vec3(0, 0, 0), Vec3(40, 0, 0), Vec3(0, 30, 0), "opaque");
  add_box_faces(mesh, Vec3(-8, 6, 0.5), Vec3(8, 12, 9), "opaque");
  add_box_faces(mesh, Vec3(-6, -12, 0.5), Vec3(9, -7, 7), "metal");
  add_sheet(mesh, Vec3(3, 0, 2), Vec3(0, 3, 0), Vec3(0, 0, 1.5), "glass");
  return mesh;
}

/// Crowns in the street: one over the transmitter, one over a receiver, one that cuts into a house and the ground, one
/// around an edge, one with the screen in it.
void add_crowns(Scene& scene) {
  scene.add_object("t1", ball(2.0, 2), standing({Vec3(-15, 1, 4)}));
  scene.add_object("t2", ball(1.5, 1), standing({Vec3(14, -2, 1.5)}));
  scene.add_object("t3", make_box(Vec3(6, 6, 6), "leaves"), standing({Vec3(-5, 6, -1), 0.5}));
  scene.add_object("t4", make_box(Vec3(3, 3, 4), "needles"), standing({Vec3(8, 6, 0), 0.2}));
  scene.add_object("t5", make_box(Vec3(2, 4, 5), "leaves"), standing({Vec3(3, 0.3, 0), 0.1}));
}

const std::vector<Vec3> receivers_m{{14, -2, 1.5}, {12, 3, 2.2}, {-3, 20, 1.5}, {0.5, -3, 1.2}, {11, 11, 1.5}};

Simulator street_simulator(bool with_crowns, const SimulationSettings& settings, double db_per_m = leaves_db_per_m) {
  Scene scene;
  for (const char* name : {"opaque", "metal", "glass"}) {
    Material material{name, ConstantReflection{0.8, std::nullopt}};
    if (name == std::string("metal")) material.model = PerfectConductor{};
    if (name == std::string("glass")) material.model = ConstantReflection{0.74, 5.0};
    material.scattering.coefficient = settings.propagation.diffuse.enabled ? 0.4 : 0.0;
    scene.add_material(material);
  }
  scene.add_material({"leaves", Foliage{db_per_m}});
  scene.add_material({"needles", Foliage{db_per_m}});
  scene.set_scenery(street());
  if (with_crowns) add_crowns(scene);
  scene.add_transmitter(device_at("tx", Vec3(-15.2, 1.3, 4.1)));
  for (std::size_t index = 0; index < receivers_m.size(); ++index) {
    scene.add_receiver(device_at("rx" + std::to_string(index), receivers_m[index]));
  }
  return {std::move(scene), settings};
}

SimulationSettings street_settings(Discovery discovery) {
  SimulationSettings settings;
  settings.frequency_hz = 28e9;
  settings.propagation.max_reflections = 2;
  settings.propagation.max_transmissions = 2;
  settings.propagation.max_diffractions = 1;
  settings.propagation.diffraction.free_edges = true;
  settings.propagation.discovery = discovery;
  settings.propagation.rays = 20'000;
  settings.threads = 2;
  return settings;
}

/// What a path is, but for its foliage and its field.
std::string geometry_of(const Scene& scene, const Path& path) {
  std::string text = path_id(scene, path);
  const auto append = [&](double number) { text.append(reinterpret_cast<const char*>(&number), sizeof number); };
  append(path.length_m);
  for (const Interaction& interaction : path.interactions) {
    for (int axis = 0; axis < 3; ++axis) append(interaction.point_m[axis]);
    text += interaction.in_shadow ? 's' : 'l';
  }
  return text;
}

}  // namespace

TEST_CASE("foliage neither reflects, blocks nor diffracts, and is nowhere listed: the paths are those without it") {
  for (const Discovery discovery : {Discovery::exact, Discovery::sampled}) {
    CAPTURE(static_cast<int>(discovery));
    Simulator bare = street_simulator(false, street_settings(discovery));
    Simulator green = street_simulator(true, street_settings(discovery));
    const FrameResult without = bare.advance_to(0.0), with = green.advance_to(0.0);
    REQUIRE(without.links.size() == receivers_m.size());
    REQUIRE(with.links.size() == receivers_m.size());
    CHECK(with.work.rays == without.work.rays);
    CHECK(with.work.sequences_proposed == without.work.sequences_proposed);
    CHECK(with.work.legs == without.work.legs);
    std::size_t paths = 0, through = 0, diffracted = 0;
    for (std::size_t link = 0; link < with.links.size(); ++link) {
      REQUIRE(with.links[link].paths.size() == without.links[link].paths.size());
      for (std::size_t index = 0; index < with.links[link].paths.size(); ++index) {
        const Path& path = with.links[link].paths[index].path;
        CHECK(geometry_of(green.scene(), path) == geometry_of(bare.scene(), without.links[link].paths[index].path));
        for (const Interaction& at : path.interactions) CHECK_FALSE(green.scene().facet(at.facet).is_foliage);
        CHECK(without.links[link].paths[index].path.foliage.empty());
        ++paths;
        through += !path.foliage.empty();
        diffracted += kinds(path).find('D') != std::string::npos;
      }
    }
    CHECK(paths > 50);
    CHECK(through > 30);
    CHECK(diffracted > 10);
  }
}

TEST_CASE("a path's foliage is that of its legs, each clipped on its own") {
  Simulator green = street_simulator(true, street_settings(Discovery::exact));
  const FrameResult frame = green.advance_to(0.0);
  const Scene& scene = green.scene();
  for (const LinkResult& link : frame.links) {
    for (const PathContribution& one : link.paths) {
      std::vector<Vec3> points_m{Vec3(-15.2, 1.3, 4.1)};
      for (const Interaction& at : one.path.interactions) points_m.push_back(at.point_m);
      points_m.push_back(receivers_m[link.receiver]);
      std::map<std::string, double> expected_m;
      for (std::size_t leg = 0; leg + 1 < points_m.size(); ++leg) {
        const Vec3 &from_m = points_m[leg], &to_m = points_m[leg + 1];
        const auto add = [&](const char* body, const std::vector<SolidSide>& convex, const char* material) {
          const Pose& pose = scene.body_state(*scene.find_body(body)).placement.pose;
          expected_m[material] += clipped_m(convex, local_m(pose, from_m), local_m(pose, to_m));
        };
        add("t1", half_spaces(ball(2.0, 2)), "leaves");
        add("t2", half_spaces(ball(1.5, 1)), "leaves");
        add("t3", half_spaces(Vec3(-3, -3, 0), Vec3(3, 3, 6)), "leaves");
        add("t4", half_spaces(Vec3(-1.5, -1.5, 0), Vec3(1.5, 1.5, 4)), "needles");
        add("t5", half_spaces(Vec3(-1, -2, 0), Vec3(1, 2, 5)), "leaves");
      }
      for (const auto& [material, length_m] : expected_m) {
        double found_m = 0.0;
        for (const FoliageLength& part : one.path.foliage) {
          if (scene.material(part.material).name == material) found_m += part.length_m;
        }
        CHECK(std::abs(found_m - length_m) < 1e-8);  // sheets cut the legs, and their points are rounded
      }
    }
  }
}

TEST_CASE("foliage does not scatter, and foliage of 0 dB/m changes no diffuse power by a single bit") {
  SimulationSettings settings = street_settings(Discovery::exact);
  settings.propagation.max_diffractions = 0;
  settings.propagation.diffuse.enabled = true;
  settings.propagation.diffuse.list_paths = true;
  settings.propagation.diffuse.tolerance_db = 0.5;
  Simulator bare = street_simulator(false, settings), green = street_simulator(true, settings, 0.0);
  const FrameResult without = bare.advance_to(0.0), with = green.advance_to(0.0);
  CHECK(with.work.diffuse_tiles == without.work.diffuse_tiles);
  CHECK(with.work.diffuse_tiles > 0);
  bool through = false;
  for (std::size_t link = 0; link < with.links.size(); ++link) {
    const DiffusePower &green_power = with.links[link].diffuse, &bare_power = without.links[link].diffuse;
    CHECK(green_power.power_ratio == bare_power.power_ratio);
    CHECK(green_power.power_ratio > 0.0);
    REQUIRE(green_power.tiles.size() == bare_power.tiles.size());
    for (std::size_t tile = 0; tile < green_power.tiles.size(); ++tile) {
      CHECK(green_power.tiles[tile].sample.power_ratio == bare_power.tiles[tile].sample.power_ratio);
      CHECK_FALSE(green.scene().facet(green_power.tiles[tile].path.interactions.at(0).facet).is_foliage);
      through = through || !green_power.tiles[tile].path.foliage.empty();
    }
  }
  CHECK(through);
}

TEST_CASE("foliage that claims to scatter, or to be rough, stays without surfaces") {
  Scene scene = scene_of_materials();
  scene.add_material({"leaves", Foliage{1.0}, 0.0, {0.5}});
  TriangleMesh ground;
  add_sheet(ground, Vec3(0, 0, -5), Vec3(50, 0, 0), Vec3(0, 50, 0), "opaque");
  scene.set_scenery(ground);
  scene.add_object("crown", make_box(Vec3(3, 3, 3), "leaves"), LinearMotion{});
  for (const WorldFacet& facet : scene.facets()) {
    if (!facet.is_foliage) continue;
    CHECK_FALSE(facet.present);
    CHECK_FALSE(facet.scatters);
  }
  scene.add_transmitter(device_at("tx", Vec3(-10, 0.1, 1)));
  scene.add_receiver(device_at("rx", Vec3(10, 0.2, 1)));
  SimulationSettings settings = street_settings(Discovery::exact);
  settings.propagation.diffuse.enabled = true;
  Simulator simulator(std::move(scene), settings);
  const FrameResult frame = simulator.advance_to(0.0);
  CHECK(frame.links.at(0).diffuse.tiles.empty());
  CHECK_FALSE(frame.links[0].statistics.power_diffuse_dbm.has_value());
}

TEST_CASE("rays and the exact search find the same paths where foliage stands") {
  Simulator exact = street_simulator(true, street_settings(Discovery::exact));
  SimulationSettings many = street_settings(Discovery::sampled);
  many.propagation.rays = 100'000;
  Simulator rays = street_simulator(true, many);
  const FrameResult all = exact.advance_to(0.0), found = rays.advance_to(0.0);
  Recall recall;
  for (std::size_t link = 0; link < all.links.size(); ++link) {
    recall += recall_of(found.links[link].paths, all.links[link].paths);
    for (const PathContribution& path : found.links[link].paths) {
      const auto same =
          std::find_if(all.links[link].paths.begin(), all.links[link].paths.end(),
                       [&](const PathContribution& other) { return same_sequence(other.path, path.path); });
      REQUIRE(same != all.links[link].paths.end());  // rays find nothing that is not there
      REQUIRE(same->path.foliage.size() == path.path.foliage.size());
      for (std::size_t part = 0; part < path.path.foliage.size(); ++part) {
        CHECK(same->path.foliage[part].length_m == path.path.foliage[part].length_m);
      }
      CHECK(same->power_ratio == path.power_ratio);
    }
  }
  CHECK(static_cast<double>(recall.paths_found) >= 0.95 * static_cast<double>(recall.paths_there));
}

TEST_CASE("a crown of many triangles leaves the exact search as cheap, and as much offered, as it is without it") {
  PropagationSettings by_name, automatic;
  by_name.discovery = Discovery::exact;
  Scene scene = scene_with_foliage();
  scene.set_scenery(street());
  CHECK(resolve_discovery(automatic, scene) == Discovery::exact);
  scene.add_object("crown", ball(2.0, 4), standing({Vec3(-15, 1, 4)}));  // 2048 triangles, none of them a mirror
  CHECK(resolve_discovery(automatic, scene) == Discovery::exact);
  CHECK_NOTHROW(resolve_discovery(by_name, scene));
}

TEST_CASE("a ray goes through foliage as if it were not there") {
  const auto sequences = [](bool with_crowns) {
    Scene scene = scene_with_foliage();
    scene.set_scenery(street());
    if (with_crowns) add_crowns(scene);
    TracedScene<> traced(std::move(scene));
    std::set<Sequence> proposed;
    RayLauncher<WideIndex> launcher(traced.tracer, {5000, 2, 2});
    launcher.for_each_sequence(traced.end(receivers_m[0]), Mat3(1.0),
                               [&](const Sequence& sequence, const std::vector<Vec3>&) { proposed.insert(sequence); });
    return std::pair(proposed, launcher.rays());
  };
  const auto bare = sequences(false), green = sequences(true);
  CHECK(bare.first.size() > 5);
  CHECK(bare.first == green.first);
  CHECK(bare.second == green.second);
}

TEST_CASE("no tree, a tree without anything in it and a tree with all in it give the same crossing of a crown") {
  // Scenery of foliage alone: nothing that a ray could hit.
  Scene scene = scene_with_foliage();
  scene.set_scenery(block(Vec3(-1, -2, 0), Vec3(1, 2, 3)));
  scene.add_transmitter(device_at("tx", Vec3(-9, 0.5, 1)));
  scene.add_receiver(device_at("rx", Vec3(11, 0.5, 1)));
  SimulationSettings settings = street_settings(Discovery::sampled);
  settings.propagation.rays = 500;
  Simulator simulator(std::move(scene), settings);
  const LinkResult link = simulator.advance_to(0.0).links.at(0);
  REQUIRE(link.paths.size() == 1);
  REQUIRE(link.paths[0].path.foliage.size() == 1);
  CHECK(link.paths[0].path.foliage[0].length_m == doctest::Approx(2.0));
}

TEST_CASE("no point of a map is hidden by foliage: not within a crown, not on its skin, not in a hedge on the ground") {
  Scene scene = scene_with_foliage();
  TriangleMesh ground;
  add_sheet(ground, Vec3(0, 0, 0), Vec3(30, 0, 0), Vec3(0, 30, 0), "opaque");
  scene.set_scenery(ground);
  scene.add_object("hedge", make_box(Vec3(6, 2, 2), "leaves"), LinearMotion{});
  TracedScene<> traced(std::move(scene));
  const ObstructionTest<WideIndex> test(traced.tracer, traced.index, {Vec3(-20, 0, 5)});
  for (const Vec3& point_m : {Vec3(0, 0, 1), Vec3(3, 0.5, 1), Vec3(1, 1, 1), Vec3(1, 0.5, 2), Vec3(3, 1, 2)}) {
    CHECK_FALSE(test.obstructed(point_m));
    CHECK(traced.end(point_m).mounted_on.empty());
  }
  CHECK(test.obstructed(Vec3(1, 0.5, 0)));  // the ground under it is a surface
  Scene same = traced.scene;
  same.add_transmitter(device_at("tx", Vec3(-20, 0.3, 1)));
  Simulator simulator(std::move(same), street_settings(Discovery::exact));
  const RadioMap map = simulator.radio_maps({"area", Vec3(-3, 0.3, 1), {1.0, 1.0}, {7, 1}, {}}).at(0);
  for (std::size_t column = 0; column < 7; ++column) {
    const RadioMapPoint& point = map.points.at(column);
    CHECK_FALSE(point.obstructed);
    CHECK(point.statistics.path_count >= 2);
    CHECK(point.statistics.line_of_sight == (column == 0));  // the first point stands on the skin, before the hedge
    // Friis at 28 GHz by hand, −20 log10(4π·d·f/c), and 2 dB for each metre inside.
    const double distance_m = 17.0 + double(column);
    const double friis_db = -20.0 * std::log10(4.0 * pi * distance_m * 28e9 / 299'792'458.0);
    CHECK(*point.statistics.power_los_dbm == doctest::Approx(friis_db - 2.0 * double(column)).epsilon(1e-9));
  }
}

TEST_CASE("a crown that moves is where it is now") {
  Scene scene = scene_with_foliage();
  scene.add_object("truck", make_box(Vec3(4, 2, 3), "leaves"),
                   LinearMotion{{Vec3(-20, 0, 0), 0.3, 0.1, 0.2}, Vec3(5, 0.5, 0.1), 0.0});
  const auto reference = half_spaces(Vec3(-2, -1, 0), Vec3(2, 1, 3));
  const Vec3 from_m(0.5, -30, 1), to_m(-0.5, 30, 1.5);
  std::size_t through = 0;
  for (const double time_s : {0.0, 1.0, 3.5, 3.8, 4.0, 4.2, 4.5, 6.0, 4.0, 0.0}) {
    const Frame frame = scene.frame_at(time_s);
    scene.apply(frame);
    const Pose& pose = frame.bodies[1].placement.pose;
    const double expected_m = clipped_m(reference, local_m(pose, from_m), local_m(pose, to_m));
    CHECK(std::abs(inside_m(scene, from_m, to_m) - expected_m) < rounding_m);
    through += expected_m > 0.5;
  }
  CHECK(through >= 4);
}

TEST_CASE("memory from frame to frame holds no foliage: a run gives what each frame gives alone") {
  const auto make = [](CacheMode cache) {
    Scene scene = scene_with_foliage();
    scene.set_scenery(street());
    scene.add_object("truck", ball(2.0, 1), LinearMotion{{Vec3(-12, 1, 2)}, Vec3(20, 0, 0), 0.0});
    scene.add_object("car", make_box(Vec3(4, 2, 1.5), "metal"), LinearMotion{{Vec3(-20, -3, 0.3)}, Vec3(10, 0, 0), 0});
    scene.add_transmitter(device_at("tx", Vec3(-15, 1, 4)));
    scene.add_receiver(device_at("rx", receivers_m[0]));
    SimulationSettings settings = street_settings(Discovery::sampled);
    settings.propagation.rays = 3000;
    settings.propagation.cache = cache;
    return Simulator(std::move(scene), settings);
  };
  Simulator run = make(CacheMode::seed);
  std::size_t compared = 0;
  std::set<double> lengths_m;
  for (std::size_t index = 0; index < 8; ++index) {
    const double time_s = 0.2 * double(index);
    const FrameResult remembered = run.advance_to(time_s, index);
    Simulator fresh = make(CacheMode::off);
    fresh.advance_to(time_s, index);
    for (const PathContribution& path : remembered.links.at(0).paths) {
      const auto again = fresh.solve_path(0, 0, sequence_of(path.path));
      REQUIRE(again);
      CHECK(detail::same_bits(*again, path));
      ++compared;
      for (const FoliageLength& part : path.path.foliage) lengths_m.insert(part.length_m);
    }
  }
  CHECK(compared > 40);
  CHECK(lengths_m.size() > 8);
}

TEST_CASE("a place of foliage is there while somebody stands in it") {
  Scene scene = scene_with_foliage();
  scene.add_body_pool(2, make_box(Vec3(2, 2, 2), "leaves"));
  const Vec3 from_m(-20, 0.25, 0.75), to_m(20, 0.25, 0.75);
  CHECK(inside_m(scene, from_m, to_m) == 0.0);
  const auto put = [&](bool first, bool second) {
    Frame frame = scene.frame_at(0.0);
    if (first) frame.bodies[1] = {true, {Pose{Vec3(-5, 0, 0)}, {}}, "a"};
    if (second) frame.bodies[2] = {true, {Pose{Vec3(5, 0, 0)}, {}}, "b"};
    scene.apply(frame);
    return inside_m(scene, from_m, to_m);
  };
  CHECK(put(true, false) == doctest::Approx(2.0));
  CHECK(put(true, true) == doctest::Approx(4.0));
  CHECK(put(false, true) == doctest::Approx(2.0));
  CHECK(put(false, false) == 0.0);
  CHECK(put(true, true) == doctest::Approx(4.0));
}

TEST_CASE("for a device that rides in foliage, that foliage does not exist unless it sees its own body") {
  Scene scene = scene_with_foliage();
  scene.add_object("hay", make_box(Vec3(4, 2, 2), "leaves"), LinearMotion{});
  scene.add_object("tree", make_box(Vec3(1, 4, 4), "leaves"), standing({Vec3(8, 0, 0)}));
  for (const bool sees : {false, true}) {
    Device device = device_at(sees ? "seeing" : "blind", Vec3(0.0));
    device.attachment = Attachment{"hay", Vec3(0, 0.25, 1), sees};
    scene.add_receiver(device);
  }
  scene.add_transmitter(device_at("tx", Vec3(20, 0.25, 1)));
  Simulator simulator(std::move(scene), street_settings(Discovery::exact));
  const FrameResult frame = simulator.advance_to(0.0);
  const auto length_m = [&](std::size_t link) { return frame.links.at(link).paths.at(0).path.foliage.at(0).length_m; };
  CHECK(length_m(0) == doctest::Approx(1.0));
  CHECK(length_m(1) == doctest::Approx(3.0));
}

}  // namespace test_foliage_length
