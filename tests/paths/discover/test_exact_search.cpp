/// The exhaustive search misses nothing that trying every sequence of facets would find.
#include "dcem/paths/discover/exact_search.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <set>
#include <vector>

#include "tests/paths/small_scenes.hpp"

namespace test_exact_search {

using namespace dcem;
using namespace dcem::test;

namespace {

struct Visited {
  std::set<Sequence> sequences;
  int repeated = 0;
  double worst_image_m = 0.0;
};

/// Mirror image by its definition, in more digits than the code has.
glm::vec<3, long double, glm::defaultp> image_of(const Plane& plane, const glm::vec<3, long double, glm::defaultp>& p) {
  using Long = glm::vec<3, long double, glm::defaultp>;
  const Long normal(plane.normal), offset = p - Long(plane.point_m);
  return p - 2.0L * glm::dot(normal, offset) / glm::dot(normal, normal) * normal;
}

Visited visit_all(const Scene& scene, const LinkEnd& receiver, int order) {
  Visited visited;
  ExactSearch(scene, order)
      .for_each_sequence(receiver, [&](const Sequence& sequence, const std::vector<Vec3>& images_m) {
        visited.repeated += !visited.sequences.insert(sequence).second;
        REQUIRE(images_m.size() == sequence.size() + 1);
        CHECK(images_m.front() == receiver.position_m);
        glm::vec<3, long double, glm::defaultp> image_m(receiver.position_m);
        for (std::size_t index = 0; index < sequence.size(); ++index) {
          image_m = image_of(scene.facet(sequence[index].mirror()).plane, image_m);
          const double error_m = static_cast<double>(glm::distance(image_m, decltype(image_m)(images_m[index + 1])));
          visited.worst_image_m = std::max(visited.worst_image_m, error_m);
        }
      });
  return visited;
}

/// Calls `visit` with every sequence of facets up to an order, no facet twice in a row.
template <typename Visit>
void for_every_sequence(std::size_t facets, std::size_t order, Sequence& sequence, Visit&& visit) {
  visit(sequence);
  if (sequence.size() == order) return;
  for (std::size_t facet = 0; facet < facets; ++facet) {
    if (!sequence.empty() && sequence.back() == FacetId(facet)) continue;
    sequence.push_back(FacetId(facet));
    for_every_sequence(facets, order, sequence, visit);
    sequence.pop_back();
  }
}

/// Whether the image method has points for a sequence and all of them lie on their facets, whatever is in the way: the
/// search knows nothing of occlusion.
bool touches_all(TracedScene<>& traced, const Vec3& transmitter_m, const Vec3& receiver_m, const Sequence& sequence) {
  std::vector<Vec3> images_m{receiver_m}, points_m;
  for (const SequenceElement element : sequence) append_image(images_m, traced.scene.facet(element.mirror()).plane);
  const auto plane = [&](std::size_t index) -> const Plane& {
    return traced.scene.facet(sequence[index].mirror()).plane;
  };
  if (!reflection_points(transmitter_m, images_m, sequence.size(), plane, points_m)) return false;
  for (std::size_t index = 0; index < sequence.size(); ++index) {
    const FacetId id = sequence[sequence.size() - 1 - index].mirror();
    if (!traced.tracer.reflects_at(id, points_m[index], {}, traced.counters)) return false;
  }
  return true;
}

/// A wall with a window in it: four strips around a hole, one facet.
void add_frame(TriangleMesh& mesh, const Vec3& centre_m, const Vec3& u, const Vec3& v, const std::string& material) {
  const auto at = [&](double a, double b) { return centre_m + a * u + b * v; };
  add_quad(mesh, {at(-1, -1), at(1, -1), at(0.4, -0.4), at(-0.4, -0.4)}, material);
  add_quad(mesh, {at(1, -1), at(1, 1), at(0.4, 0.4), at(0.4, -0.4)}, material);
  add_quad(mesh, {at(1, 1), at(-1, 1), at(-0.4, 0.4), at(0.4, 0.4)}, material);
  add_quad(mesh, {at(-1, 1), at(-1, -1), at(-0.4, -0.4), at(-0.4, 0.4)}, material);
}

/// A room whose ceiling has a hole, with tilted sheets and odd triangles in the air: 9 to 12 facets.
TriangleMesh random_room(Draw& draw) {
  TriangleMesh mesh;
  add_box_faces(mesh, Vec3(0.0), Vec3(8, 6, 3), "opaque");
  add_frame(mesh, Vec3(4, 3, 2.5), Vec3(2.5, 0, 0), Vec3(0, 2, 0), "glass");
  for (std::size_t sheet = 2 + draw.below(3); sheet > 0; --sheet) {
    const Vec3 u = draw.direction(), v = glm::normalize(glm::cross(u, draw.direction()));
    add_sheet(mesh, draw.inside(Vec3(1, 1, 0.5), Vec3(7, 5, 2)), draw.between(0.3, 1.5) * u, draw.between(0.3, 1.5) * v,
              "wall");
  }
  const std::uint32_t first = static_cast<std::uint32_t>(mesh.vertices_m.size());
  for (int corner = 0; corner < 3; ++corner) mesh.vertices_m.push_back(draw.inside(Vec3(1, 1, 0.5), Vec3(7, 5, 2.5)));
  mesh.triangles.push_back({{first, first + 1, first + 2}, material_index(mesh, "glass")});
  return mesh;
}

}  // namespace

TEST_CASE("every sequence whose points lie on their facets is visited, none twice, with the receiver's images") {
  Draw draw(7);
  std::map<std::size_t, int> solvable;
  for (int trial = 0; trial < 12; ++trial) {
    TracedScene<> traced(scene_of(random_room(draw)));
    const Vec3 receiver_m = draw.inside(Vec3(0.1), Vec3(7.9, 5.9, 2.9));
    const Visited visited = visit_all(traced.scene, traced.end(receiver_m), 3);
    CHECK(visited.repeated == 0);
    CHECK(visited.worst_image_m < 1e-12);  // a dozen roundings of numbers up to 50 m
    for (int transmitter = 0; transmitter < 4; ++transmitter) {
      const Vec3 transmitter_m = draw.inside(Vec3(0.1), Vec3(7.9, 5.9, 2.9));
      Sequence sequence;
      for_every_sequence(traced.scene.facets().size(), 3, sequence, [&](const Sequence& tried) {
        if (!touches_all(traced, transmitter_m, receiver_m, tried)) return;
        ++solvable[tried.size()];
        CHECK(visited.sequences.count(tried) == 1);
      });
    }
  }
  CHECK(solvable[1] > 250);
  CHECK(solvable[2] > 900);
  CHECK(solvable[3] > 2500);
}

TEST_CASE("beams discard what no ray can reach") {
  // Two sheets side by side, both facing up: neither is ever seen in the other.
  TriangleMesh mesh;
  add_sheet(mesh, Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), "opaque");
  add_sheet(mesh, Vec3(10, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), "opaque");
  add_sheet(mesh, Vec3(0, 0, -5), Vec3(1, 0, 0), Vec3(0, 1, 0), "opaque");  // below the first
  TracedScene<> traced(scene_of(mesh));
  const Visited visited = visit_all(traced.scene, traced.end(Vec3(0, 0, 2)), 2);
  const FacetId near = traced.facet_at(Vec3(0.5, 0.5, 0), "opaque"), under = traced.facet_at(Vec3(0, 0, -5), "opaque");
  CHECK(visited.sequences.count(Sequence{near}) == 1);
  CHECK(visited.sequences.count(Sequence{near, under}) == 0);
  CHECK(visited.sequences.count(Sequence{under, near}) == 1);  // between the two there is room for it
}

TEST_CASE("no mirror follows itself: what leaves a plane does not come back to it") {
  Draw draw(8);
  TracedScene<> traced(scene_of(random_room(draw)));
  for (const Sequence& sequence : visit_all(traced.scene, traced.end(Vec3(3, 2, 1)), 3).sequences) {
    CHECK(std::adjacent_find(sequence.begin(), sequence.end()) == sequence.end());
  }
}

TEST_CASE("order 0 is the direct path alone") {
  TriangleMesh mesh;
  add_sheet_across_x(mesh, 1.0, 1.0, "opaque");
  TracedScene<> traced(scene_of(mesh));
  const Visited visited = visit_all(traced.scene, traced.end(Vec3(0.0)), 0);
  CHECK(visited.sequences == std::set<Sequence>{{}});
}

TEST_CASE("a mirror in whose plane the receiver lies, on an absent body or on the receiver's own is left out") {
  Scene scene = scene_of_materials();
  const BodyId car =
      scene.add_object("car", make_box(Vec3(2, 2, 2), "metal"), LinearMotion{{Vec3(5, 0, 0)}, Vec3(0.0), 0});
  scene.add_object("bus", make_box(Vec3(2, 2, 2), "metal"), LinearMotion{{Vec3(-5, 0, 0)}, Vec3(0.0), 0});
  TracedScene<> traced(std::move(scene));
  const auto count = [&](const LinkEnd& end) { return visit_all(traced.scene, end, 1).sequences.size(); };
  CHECK(count(traced.end(Vec3(0, 9, 1.5))) == 13);      // the direct path and 12 faces
  CHECK(count(traced.end(Vec3(0, 9, 1.5), car)) == 7);  // those of the bus
  CHECK(count(traced.end(Vec3(0, 9, 2.0))) == 11);      // both roofs lie in the receiver's plane
  Frame frame = traced.scene.frame_at(0.0);
  frame.bodies[2].present = false;
  traced.scene.apply(frame);
  CHECK(count(traced.end(Vec3(0, 9, 1.5))) == 7);
}

}  // namespace test_exact_search
