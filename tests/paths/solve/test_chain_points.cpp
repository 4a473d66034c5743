/// The points of a path over mirrors and edges obey the law of reflection and Keller's law, whichever end they are
/// counted from.
#include "dcem/paths/solve/chain_points.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "tests/paths/small_scenes.hpp"

namespace test_chain_points {

using namespace dcem;
using namespace dcem::test;

namespace {

/// Sheets of all tilts; their rims are the edges.
Scene tilted_sheets(Draw& draw, std::size_t count) {
  TriangleMesh mesh;
  for (std::size_t index = 0; index < count; ++index) {
    const Vec3 u = draw.direction(), v = glm::normalize(glm::cross(u, draw.direction()));
    add_sheet(mesh, draw.inside(Vec3(-12), Vec3(12)), 40.0 * u, 25.0 * v, "opaque");
  }
  return scene_of(mesh);
}

/// Up to three edges with up to two mirrors before, between and after them.
Sequence any_sequence(Draw& draw, const Scene& scene) {
  Sequence sequence;
  const std::size_t edges = 1 + draw.below(3);
  for (std::size_t edge = 0; edge <= edges; ++edge) {
    for (std::size_t mirror = draw.below(3); mirror > 0; --mirror) {
      const FacetId next(draw.below(scene.facets().size()));
      if (sequence.empty() || sequence.back() != SequenceElement(next)) sequence.emplace_back(next);
    }
    if (edge < edges) sequence.emplace_back(WedgeId(draw.below(scene.wedges().size())));
  }
  return sequence;
}

/// From the transmitter on: R and D.
std::string letters(const Sequence& sequence) {
  std::string text;
  for (auto element = sequence.rbegin(); element != sequence.rend(); ++element) text += element->is_edge() ? 'D' : 'R';
  return text;
}

/// The largest departure from both laws, as a difference of unit vectors' components, and from the surfaces, in metres.
struct Defect {
  double law = 0.0, off_surface_m = 0.0, shortest_leg_m = 1e300;
};

Defect defect_of(const Scene& scene, const Vec3& from_m, const std::vector<Vec3>& points_m, const Vec3& to_m,
                 const Sequence& sequence) {
  Defect defect;
  for (std::size_t index = 0; index < points_m.size(); ++index) {
    const Vec3& before_m = index == 0 ? from_m : points_m[index - 1];
    const Vec3& after_m = index + 1 == points_m.size() ? to_m : points_m[index + 1];
    const Vec3 in = glm::normalize(points_m[index] - before_m), out = glm::normalize(after_m - points_m[index]);
    const SequenceElement element = sequence[sequence.size() - 1 - index];
    defect.shortest_leg_m = std::min(
        {defect.shortest_leg_m, glm::distance(points_m[index], before_m), glm::distance(points_m[index], after_m)});
    if (element.is_edge()) {
      const Wedge& edge = scene.wedge(element.edge()).edge;
      const Vec3 along = glm::normalize(edge.end_m - edge.start_m);
      const double place_m = glm::dot(points_m[index] - edge.start_m, along);
      defect.law = std::max(defect.law, std::abs(glm::dot(in - out, along)));
      defect.off_surface_m =
          std::max(defect.off_surface_m, glm::distance(points_m[index], edge.start_m + place_m * along));
      CHECK(place_m > 0.0);
      CHECK(place_m < glm::distance(edge.start_m, edge.end_m));
    } else {
      const Plane& plane = scene.facet(element.mirror()).plane;
      const Vec3 reflected = in - 2.0 * glm::dot(in, plane.normal) * plane.normal;
      defect.law = std::max(defect.law, glm::length(out - reflected));
      defect.off_surface_m = std::max(defect.off_surface_m, std::abs(signed_distance_m(plane, points_m[index])));
      CHECK(signed_distance_m(plane, before_m) * signed_distance_m(plane, after_m) > 0.0);
    }
  }
  return defect;
}

}  // namespace

TEST_CASE("mirrors before, between and after edges: both laws hold at every point, and the way back is the same") {
  Draw draw(31);
  std::map<std::string, int> found;
  ChainPoints there, back;
  int either = 0, one_only = 0;
  for (int world = 0; world < 60; ++world) {
    const Scene scene = tilted_sheets(draw, 6);
    REQUIRE(scene.wedges().size() == 24);
    for (int round = 0; round < 1500; ++round) {
      CAPTURE(world);
      CAPTURE(round);
      const Vec3 from_m = draw.inside(Vec3(-20), Vec3(20)), to_m = draw.inside(Vec3(-20), Vec3(20));
      const Sequence sequence = any_sequence(draw, scene);
      const Sequence reversed(sequence.rbegin(), sequence.rend());
      const bool forth = there.find(scene, from_m, to_m, sequence, nullptr);
      const bool again = back.find(scene, to_m, from_m, reversed, nullptr);
      either += forth || again;
      one_only += forth != again;
      CHECK(forth == again);
      if (!forth || !again) continue;
      const std::vector<Vec3>& points_m = there.points_m();
      REQUIRE(points_m.size() == sequence.size());
      REQUIRE(back.points_m().size() == sequence.size());
      CAPTURE(letters(sequence));
      const Defect defect = defect_of(scene, from_m, points_m, to_m, sequence);
      if (defect.shortest_leg_m < 1e-3) continue;  // directions of legs of a millimetre have few digits
      ++found[letters(sequence)];
      CHECK(defect.law < 1e-9);
      CHECK(defect.off_surface_m < 1e-10);
      for (std::size_t index = 0; index < points_m.size(); ++index) {
        // Flat crossings of a mirror magnify the rounding of 1e-14 m: seldom by more than 1e4.
        CHECK(glm::distance(points_m[index], back.points_m()[points_m.size() - 1 - index]) < 1e-9);
      }
    }
  }
  MESSAGE(either << " chains, " << one_only << " from one side only, " << found.size() << " patterns");
  for (const char* pattern : {"D", "RD", "DR", "RDR", "RRDRR", "DD", "DRD", "RDRDR", "DDD", "DRDRD", "RDDR"}) {
    CAPTURE(pattern);
    CHECK(found[pattern] > 3);
  }
}

TEST_CASE("without edges the points are those of the image method, to the last bit") {
  Draw draw(32);
  const Scene scene = tilted_sheets(draw, 6);
  ChainPoints own, given;
  int found = 0;
  for (int round = 0; round < 3000; ++round) {
    const Vec3 from_m = draw.inside(Vec3(-20), Vec3(20)), to_m = draw.inside(Vec3(-20), Vec3(20));
    Sequence mirrors;
    for (std::size_t index = 0; index < 1 + draw.below(3); ++index) mirrors.emplace_back(FacetId(draw.below(6)));
    std::vector<Vec3> images_m{to_m};
    for (const SequenceElement mirror : mirrors) append_image(images_m, scene.facet(mirror.mirror()).plane);
    const bool there = own.find(scene, from_m, to_m, mirrors, nullptr);
    CHECK(given.find(scene, from_m, to_m, mirrors, &images_m) == there);
    if (!there) continue;
    ++found;
    CHECK(own.points_m() == given.points_m());
  }
  CHECK(found > 100);
}

TEST_CASE("four edges are one too many, and no points are left from the chain before") {
  Draw draw(33);
  const Scene scene = tilted_sheets(draw, 2);
  ChainPoints points;
  const Sequence four{WedgeId(0), WedgeId(1), WedgeId(4), WedgeId(5)};
  CHECK_FALSE(points.find(scene, Vec3(-20, 1, 2), Vec3(20, 2, 1), four, nullptr));
  CHECK(points.find(scene, Vec3(-20, 1, 2), Vec3(20, 2, 1), {}, nullptr));
  CHECK(points.points_m().empty());
}

}  // namespace test_chain_points
