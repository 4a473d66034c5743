/// Where third facets touch edges, and what lies on top of what: it follows from where the boxes stand, and is what the
/// scene says when it is asked at a point.
#include "dcem/paths/query/edge_contacts.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "dcem/accel/wide_index.hpp"
#include "dcem/geometry/triangle_mesh.hpp"
#include "dcem/paths/query/scene_contacts.hpp"
#include "tests/paths/small_scenes.hpp"

namespace test_edge_contacts {

using namespace dcem;
using namespace dcem::test;

namespace {

/// A box 4 × 2 × 3 m whose floor has its middle at `place_m`, on a ground of 20 × 20 m, in one body.
Scene box_on_ground(const Vec3& place_m) {
  TriangleMesh mesh;
  add_quad(mesh, {Vec3(-10, -10, 0), Vec3(10, -10, 0), Vec3(10, 10, 0), Vec3(-10, 10, 0)}, "metal");
  Scene scene;
  scene.add_material({"metal", PerfectConductor{}});
  const auto add_face = [&](const std::array<Vec3, 4>& face) {
    std::array<Vec3, 4> moved = face;
    for (Vec3& corner : moved) corner += place_m;
    add_quad(mesh, moved, "metal");
  };
  add_face({Vec3(-2, -1, 0), Vec3(-2, 1, 0), Vec3(2, 1, 0), Vec3(2, -1, 0)});
  add_face({Vec3(-2, -1, 3), Vec3(2, -1, 3), Vec3(2, 1, 3), Vec3(-2, 1, 3)});
  add_face({Vec3(-2, -1, 0), Vec3(2, -1, 0), Vec3(2, -1, 3), Vec3(-2, -1, 3)});
  add_face({Vec3(-2, 1, 0), Vec3(-2, 1, 3), Vec3(2, 1, 3), Vec3(2, 1, 0)});
  add_face({Vec3(-2, -1, 0), Vec3(-2, -1, 3), Vec3(-2, 1, 3), Vec3(-2, 1, 0)});
  add_face({Vec3(2, -1, 0), Vec3(2, 1, 0), Vec3(2, 1, 3), Vec3(2, -1, 3)});
  scene.set_scenery(mesh);
  return scene;
}

/// How many edges are covered, and whether all of them lie in the ground.
struct Covered {
  std::size_t edges = 0;
  bool all_in_ground = true;
};

EdgeRules all_edges() {
  EdgeRules rules;
  rules.free_edges = true;
  return rules;
}

std::vector<EdgeContact> contacts_in(const TracedScene<>& traced) {
  ThreadPool pool(1);
  std::vector<EdgeContact> contacts = edge_contacts(traced.scene, traced.index, all_edges(), pool);
  REQUIRE(contacts.size() == traced.scene.wedges().size());
  return contacts;
}

Covered covered_in(Scene scene) {
  const TracedScene<> traced(std::move(scene));
  Covered result;
  const std::vector<EdgeContact> contacts = contacts_in(traced);
  for (std::size_t wedge = 0; wedge < contacts.size(); ++wedge) {
    if (!contacts[wedge].is_touched_all_along()) continue;
    const Wedge& edge = traced.scene.wedges()[wedge].edge;
    ++result.edges;
    result.all_in_ground = result.all_in_ground && std::abs(edge.start_m.z) < 1e-3 && std::abs(edge.end_m.z) < 1e-3;
  }
  return result;
}

}  // namespace

TEST_CASE("the foot of a box on the ground is covered, also across the seam of the ground's triangles") {
  const Covered middle = covered_in(box_on_ground({0.3, 0.2, 0}));  // over the diagonal
  CHECK(middle.edges == 4);
  CHECK(middle.all_in_ground);
}

TEST_CASE("a box above the ground, or half beyond its rim, has free edges there") {
  CHECK(covered_in(box_on_ground({0, 0, 0.01})).edges == 0);
  // The long edges stand out by half; of the short ones that over the ground is covered, the other is in the air.
  const Covered rim = covered_in(box_on_ground({10, 3, 0}));
  CHECK(rim.edges == 1);
  CHECK(rim.all_in_ground);
}

TEST_CASE("an edge half over the ground is touched up to the rim of the ground and free beyond") {
  const TracedScene<> traced(box_on_ground({10, 3, 0}));
  const std::vector<EdgeContact> contacts = contacts_in(traced);
  std::size_t found = 0;
  for (std::size_t number = 0; number < contacts.size(); ++number) {
    const Wedge& edge = traced.scene.wedges()[number].edge;
    if (std::abs(edge.start_m.z) > 1e-3 || std::abs(edge.end_m.z) > 1e-3 || std::abs(edge_direction(edge).x) < 0.9) {
      continue;
    }
    if (edge_length_m(edge) > 5.0) continue;  // the ground's own rim
    ++found;
    const bool from_inside = edge.start_m.x < edge.end_m.x;
    const EdgeContact& contact = contacts[number];
    const double rim_m = 2.0;  // of the four metres two are over the ground
    CHECK(contact.is_touched(from_inside ? 1.99 : 2.01));
    CHECK(!contact.is_touched(from_inside ? 2.01 : 1.99));
    // Where the box ends, the corner of its third side touches.
    CHECK(contact.is_free(from_inside ? rim_m + 0.1 : rim_m - 0.1));
    CHECK(!contact.is_free(from_inside ? rim_m - 0.001 : rim_m + 0.001));
  }
  CHECK(found == 2);
}

namespace {

/// Boxes that stand on a ground of tiles, on each other, beside each other and through each other, and sheets that lie
/// on things; much of it to the last bit.
TriangleMesh pile(Draw& draw) {
  TriangleMesh mesh;
  add_tiled_sheet(mesh, Vec3(0.0), Vec3(20, 0, 0), Vec3(0, 20, 0), 1 + static_cast<int>(draw.below(5)), "opaque");
  const auto step = [&](double high) {
    return 0.5 * static_cast<double>(draw.below(static_cast<std::size_t>(2 * high)));
  };
  const std::size_t boxes = 1 + draw.below(6);
  for (std::size_t box = 0; box < boxes; ++box) {
    const Vec3 low_m(step(20) - 10, step(20) - 10, draw.below(3) == 0 ? step(6) : 0.0);
    add_box_faces(mesh, low_m, low_m + Vec3(0.5 + step(8), 0.5 + step(8), 0.5 + step(6)), "metal");
  }
  for (std::size_t sheet = draw.below(4); sheet > 0; --sheet) {
    // Some lie by a share of the weld tolerance, 1e-4, over what they lie on, or leave it along their length.
    const double over_m = draw.below(2) == 0 ? draw.between(-1.2e-4, 1.2e-4) : 0.0;
    const Vec3 middle_m(step(20) - 10, step(20) - 10, step(6) + over_m);
    const double slope = draw.below(3) == 0 ? draw.between(-1e-4, 1e-4) : 0.0;
    const Vec3 along = draw.below(3) > 0 ? Vec3(1, 0, slope) : draw.direction();
    const Vec3 across = draw.below(2) == 0 ? Vec3(0, 1, 0) : draw.direction();
    if (glm::length(glm::cross(along, across)) < 0.1) continue;
    add_sheet(mesh, middle_m, draw.between(0.2, 5) * along, draw.between(0.2, 5) * across, "glass");
  }
  return mesh;
}

}  // namespace

TEST_CASE("what is known of an edge is what the scene says at each of its points") {
  std::size_t touched = 0, free = 0, unknown = 0, wrong = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    CAPTURE(seed);
    Draw draw(seed);
    TracedScene<> traced(scene_of(pile(draw)));
    const std::vector<EdgeContact> contacts = contacts_in(traced);
    for (std::size_t number = 0; number < contacts.size(); ++number) {
      const WorldWedge& wedge = traced.scene.wedges()[number];
      const double reach_m = traced.scene.settings().weld_tolerance_m + wedge.edge.stray_m;
      for (int place = 0; place < 24; ++place) {
        // Half of them close to where something begins.
        const double length_m = edge_length_m(wedge.edge), any_m = draw.between(0.0, length_m);
        const double near_m = 0.5 * std::round(2.0 * any_m) + draw.between(-2.0, 2.0) * reach_m;
        const double along_m = std::clamp(place % 2 == 0 ? any_m : near_m, 0.0, length_m);
        const Vec3 point_m = wedge.edge.start_m + along_m * edge_direction(wedge.edge);
        const std::vector<FacetId> near = traced.tracer.facets_near(point_m, reach_m, {}, traced.counters);
        const bool has_third = std::ranges::any_of(
            near, [&](FacetId facet) { return facet != wedge.facets[0] && facet != wedge.facets[1]; });
        const bool is_touched = contacts[number].is_touched(along_m), is_free = contacts[number].is_free(along_m);
        wrong += (is_touched && !has_third) || (is_free && has_third) ? 1 : 0;
        touched += is_touched ? 1 : 0;
        free += is_free ? 1 : 0;
        unknown += is_touched || is_free ? 0 : 1;
      }
    }
  }
  CHECK(wrong == 0);
  CHECK(touched > 10'000);
  CHECK(free > 50'000);
  CHECK(unknown < (touched + free) / 3);
}

TEST_CASE("where bodies may move, no edge is known to be free and no facet to lie alone") {
  Scene scene = box_on_ground({0, 0, 0});
  TriangleMesh car;
  add_quad(car, {Vec3(-1, -1, 0), Vec3(1, -1, 0), Vec3(1, 1, 0), Vec3(-1, 1, 0)}, "metal");
  scene.add_object("car", car, Motion{});
  const TracedScene<> traced(std::move(scene));
  ThreadPool pool(1);
  CHECK(stacked_facets(traced.scene, traced.index, pool).empty());
  for (const EdgeContact& contact : contacts_in(traced)) {
    for (const double along_m : {0.0, 0.5, 1.0, 1.5, 2.0}) CHECK(!contact.is_free(along_m));
  }
}

TEST_CASE("nothing lies on top of a facet that is said to be alone") {
  std::size_t alone = 0, stacked = 0, wrong = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    CAPTURE(seed);
    Draw draw(seed);
    TracedScene<> traced(scene_of(pile(draw)));
    ThreadPool pool(1);
    const std::vector<char> on_top = stacked_facets(traced.scene, traced.index, pool);
    for (std::uint32_t number = 0; number < on_top.size(); ++number) {
      const FacetId id(number);
      const WorldFacet& facet = traced.scene.facet(id);
      for (int place = 0; place < 20; ++place) {
        const auto triangle = static_cast<std::uint32_t>(facet.first_triangle + draw.below(facet.triangle_count));
        const std::array<Vec3, 3> corners_m = traced.scene.corners_m(triangle);
        const double a = draw.between(0, 1), b = draw.between(0, 1 - a);
        const Vec3 point_m = corners_m[0] + a * (corners_m[1] - corners_m[0]) + b * (corners_m[2] - corners_m[0]);
        const std::vector<FacetId> near =
            traced.tracer.facets_near(point_m, traced.scene.settings().weld_tolerance_m, {}, traced.counters);
        const bool has_other =
            std::ranges::any_of(near, [&](FacetId other) { return other != id && traced.tracer.parallel(other, id); });
        wrong += has_other && on_top[number] == 0 ? 1 : 0;
        stacked += has_other ? 1 : 0;
      }
      alone += on_top[number] == 0 ? 1 : 0;
    }
  }
  CHECK(wrong == 0);
  CHECK(alone > 1'000);
  CHECK(stacked > 500);
}

}  // namespace test_edge_contacts
