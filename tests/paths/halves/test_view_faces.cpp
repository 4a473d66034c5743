/// A view is drawn face by face, by whoever has time: that is the view that is drawn at once, and nothing that it shows
/// has been passed over.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "dcem/core/thread_pool.hpp"
#include "dcem/paths/halves/sight.hpp"
#include "dcem/paths/halves/view_map.hpp"
#include "tests/paths/small_scenes.hpp"

namespace test_view_faces {

using namespace dcem;
using namespace dcem::test;

namespace {

struct Patch {
  std::array<Vec3, 4> corners_m;
  Plane plane;
  bool is_sheet;
};

std::vector<Patch> patches_around(Draw& draw, std::size_t count) {
  std::vector<Patch> patches;
  while (patches.size() < count) {
    const Vec3 normal = draw.direction(), u = glm::normalize(glm::cross(normal, draw.direction()));
    const Vec3 v = glm::cross(normal, u), middle_m = draw.between(0.5, 30.0) * draw.direction();
    const Vec3 along_m = draw.between(0.2, 8.0) * u, up_m = draw.between(0.2, 8.0) * v;
    if (std::abs(glm::dot(normal, middle_m)) < 1e-3) continue;
    patches.push_back(
        {{middle_m - along_m - up_m, middle_m + along_m - up_m, middle_m + along_m + up_m, middle_m - along_m + up_m},
         {middle_m, normal},
         draw.below(3) == 0});
  }
  return patches;
}

void cover(ViewMap& map, const std::vector<Patch>& patches, const ViewMap::FaceSpan& on) {
  for (const Patch& patch : patches) {
    if (patch.is_sheet) {
      map.cover_sheet(patch.corners_m, patch.plane, patch.plane, on);
    } else {
      map.cover(patch.corners_m, patch.plane, on);
    }
  }
}

}  // namespace

TEST_CASE("a view drawn by several threads, a face each, is the view drawn at once") {
  Draw draw(5);
  ThreadPool pool(4);
  std::size_t shown = 0, hidden = 0;
  for (int round = 0; round < 20; ++round) {
    const std::vector<Patch> patches = patches_around(draw, 60), asked = patches_around(draw, 400);
    const Vec3 from_m = draw.inside(Vec3(-0.2), Vec3(0.2));
    ViewMap at_once(128), by_face(128);
    at_once.look_from(from_m);
    by_face.look_from(from_m, pool);
    for (ViewMap* const map : {&at_once, &by_face}) map->count_sheets(1 + round % 5, 1e-3);
    cover(at_once, patches, {});
    pool.for_each(6, [&](std::size_t face, unsigned) {
      cover(by_face, patches, {static_cast<int>(face), static_cast<int>(face) + 1});
    });
    for (const Patch& patch : asked) {
      const bool may_be_seen = at_once.shows(patch.corners_m, patch.plane, 1.001);
      bool on_some_face = false;
      for (int face = 0; face < 6; ++face) {
        on_some_face = by_face.shows(patch.corners_m, patch.plane, 1.001, {face, face + 1}) || on_some_face;
      }
      REQUIRE(on_some_face == may_be_seen);
      Aabb<double> box;
      for (const Vec3& corner_m : patch.corners_m) box.extend(corner_m);
      bool on_all_faces = true;
      for (int face = 0; face < 6; ++face) {
        const bool is_hidden = by_face.hides(box, 1.001, {face, face + 1});
        CHECK((is_hidden || !by_face.is_beside(box, face)));
        on_all_faces = on_all_faces && is_hidden;
      }
      REQUIRE(on_all_faces == at_once.hides(box, 1.001));
      (may_be_seen ? shown : hidden) += 1;
    }
  }
  CHECK(shown > 1'000);
  CHECK(hidden > 1'000);  // or nothing was tested
}

namespace {

/// Houses up to 600 m away, and on their walls and roofs posters, most of them within what a leg ignores.
TriangleMesh posters_on_houses(Draw& draw) {
  TriangleMesh mesh;
  add_sheet(mesh, Vec3(0.0), Vec3(800, 0, 0), Vec3(0, 800, 0), "opaque");
  for (int house = 0; house < 40; ++house) {
    const Vec3 low_m = draw.inside(Vec3(-600, -600, 0.1), Vec3(600, 600, 0.2));
    const Vec3 high_m = low_m + draw.inside(Vec3(6, 6, 4), Vec3(30, 30, 12));
    add_box_faces(mesh, low_m, high_m, "metal");
    const Vec3 middle_m = 0.5 * (low_m + high_m);
    for (int poster = 0; poster < 4; ++poster) {
      const double off_m = draw.between(-2e-4, 2e-4), size_m = draw.between(0.3, 1.5);
      add_sheet(mesh, Vec3(low_m.x + off_m, middle_m.y, middle_m.z), Vec3(0, size_m, 0), Vec3(0, 0, size_m), "metal");
      add_sheet(mesh, Vec3(middle_m.x, middle_m.y, high_m.z + off_m), Vec3(size_m, 0, 0), Vec3(0, size_m, 0), "metal");
    }
  }
  return mesh;
}

}  // namespace

TEST_CASE("whatever a finished view shows has been looked at, however close to its plane the end is") {
  Draw draw(6);
  std::size_t grazed = 0, hidden = 0, lost = 0;
  for (int round = 0; round < 16; ++round) {
    TracedScene<> traced(scene_of(posters_on_houses(draw)));
    const FacetOutlines outlines(traced.scene);
    for (int place = 0; place < 12; ++place) {
      // As high as a roof, or beside the plane of a wall: some millimetres, or some decimetres away.
      const FacetId wall(static_cast<std::uint32_t>(draw.below(outlines.size())));
      const Plane& plane = traced.scene.facet(wall).plane;
      Vec3 end_m = draw.inside(Vec3(-500, -500, 1), Vec3(500, 500, 12));
      const double beside_m = draw.between(0.0, 1.0) < 0.5 ? draw.between(2e-3, 2e-2) : draw.between(0.02, 0.5);
      end_m += (beside_m - signed_distance_m(plane, end_m)) * plane.normal;
      if (end_m.z < 0.5) continue;
      Sight sight(128);
      std::vector<Vec3> points_m{end_m};
      if (place % 3 == 2) points_m.push_back(end_m + Vec3(0.2, 0.1, 0.0));
      sight.look_from(points_m);
      std::vector<FacetId> seen;
      sight.find_facets(traced.scene, outlines, {}, false, seen);
      std::ranges::sort(seen);
      REQUIRE(std::ranges::adjacent_find(seen) == seen.end());  // each once
      for (std::uint32_t number = 0; number < outlines.size(); ++number) {
        const FacetId id(number);
        const WorldFacet& facet = traced.scene.facet(id);
        const double nearer = sight.nearer_on(traced.scene, outlines, id);
        const bool shows = sight.map().shows(traced.scene.hull_m(facet), facet.plane, nearer);
        const bool is_seen = std::ranges::binary_search(seen, id);
        lost += shows && !is_seen ? 1U : 0U;
        grazed += shows && nearer > Sight::nearer_boxes ? 1U : 0U;
        hidden += shows ? 0U : 1U;
      }
    }
  }
  MESSAGE(grazed << " facets grazed, " << hidden << " hidden");
  CHECK(lost == 0);
  CHECK(grazed > 500);
  CHECK(hidden > 5'000);  // or nothing was tested
}

}  // namespace test_view_faces
