/// What an edge's image along Keller's cones calls hidden is hidden: no way over the edge ever meets it.
#include "dcem/paths/halves/keller_view.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <stdexcept>
#include <vector>

#include "tests/paths/halves/keller_heaps.hpp"
#include "tests/paths/halves/keller_ways.hpp"

namespace test_keller_view {

using namespace dcem;
using namespace dcem::test;

namespace {

using Listed = std::vector<std::array<std::uint32_t, 2>>;

/// An end beside an edge: on its line or far from it, before it, behind it or far away.
KellerEnd some_end(Draw& draw, const Wedge& edge) {
  const double length_m = edge_length_m(edge), far_m = draw.below(4) == 0 ? 3e6 : 30.0 * length_m;
  const double beside_m = draw.below(3) == 0 ? 0.0 : draw.between(-1, 1) * draw.magnitude(0.1 * length_m, far_m);
  return {edge, draw.between(0, 1) * length_m + beside_m, draw.magnitude(1e-3, far_m), draw.between(-pi, pi)};
}

/// All of an edge, or up to four parts of it with gaps between them.
std::vector<EdgePart> some_parts(Draw& draw, std::uint32_t number, const Wedge& edge, const Vec3& end_m) {
  const EdgePart whole = whole_edge(number, edge, end_m);
  std::vector<EdgePart> parts;
  std::vector<double> shares;
  const std::size_t count = draw.below(5);
  if (count == 0) return {whole};
  for (std::size_t share = 0; share < 2 * count; ++share) shares.push_back(draw.between(0, 1));
  std::ranges::sort(shares);
  for (std::size_t part = 0; part < count; ++part) {
    parts.push_back(whole);
    parts.back().from = static_cast<float>(shares[2 * part]) * whole.to;
    parts.back().to = static_cast<float>(shares[2 * part + 1]) * whole.to;
  }
  return parts;
}

Vec3 some_point(Draw& draw, const Scene& scene) {
  const auto triangle = static_cast<std::uint32_t>(draw.below(scene.triangles().size()));
  const auto corners_m = scene.corners_m(triangle);
  const double u = draw.between(0, 1), v = draw.between(0, 1 - u);
  return corners_m[0] + u * (corners_m[1] - corners_m[0]) + v * (corners_m[2] - corners_m[0]);
}

/// Ways over parts of an edge: every other one to a point of a facet, one in eight along a face of the wedge.
class SomeWays {
 public:
  SomeWays(const Scene& scene, const Wedge& edge, const KellerEnd& end, std::span<const EdgePart> parts)
      : scene_(scene), edge_(edge), end_(end), parts_(parts) {}

  KellerWay next(Draw& draw) const {
    for (int tries = 0; draw.below(2) == 0 && tries < 10; ++tries) {
      const KellerWay way = end_.way_to(some_point(draw, scene_));
      if (way.azimuth_rad < edge_.exterior_angle_rad && is_lit(way.place_m)) return way;
    }
    const EdgePart& part = parts_[draw.below(parts_.size())];
    double azimuth_rad = draw.between(0, edge_.exterior_angle_rad);
    if (draw.below(8) == 0) azimuth_rad = draw.magnitude(1e-6, 0.05);
    if (draw.below(16) == 0) azimuth_rad = edge_.exterior_angle_rad - draw.magnitude(1e-6, 0.05);
    return end_.way(draw.between(part.from, part.to), azimuth_rad);
  }

 private:
  bool is_lit(double place_m) const {
    return std::ranges::any_of(parts_,
                               [&](const EdgePart& part) { return part.from <= place_m && place_m <= part.to; });
  }

  const Scene& scene_;
  const Wedge& edge_;
  const KellerEnd& end_;
  std::span<const EdgePart> parts_;
};

/// Whether a facet is listed for a part that holds a place.
bool is_listed(const Listed& lit, std::span<const EdgePart> parts, FacetId facet, double place_m) {
  return std::ranges::any_of(lit, [&](const std::array<std::uint32_t, 2>& one) {
    return one[0] == facet.value && parts[one[1]].from <= place_m && place_m <= parts[one[1]].to;
  });
}

/// A look over an edge from somewhere.
struct Look {
  WedgeId edge;
  KellerEnd end;
  std::vector<EdgePart> parts;
  bool stops_at_sheets;
  Listed lit;
};

Look look_over(const Scene& scene, const FacetOutlines& outlines, WedgeId edge, const KellerEnd& end,
               const std::vector<EdgePart>& parts, bool stops_at_sheets) {
  Look look{edge, end, parts, stops_at_sheets, {}};
  EdgeLooker(scene, outlines, stops_at_sheets).look_over(parts, 0, parts.size(), look.lit);
  return look;
}

Look some_look(Draw& draw, const Scene& scene, const FacetOutlines& outlines, WedgeId id) {
  const Wedge& edge = scene.wedge(id).edge;
  const KellerEnd end = some_end(draw, edge);
  const std::vector<EdgePart> parts = some_parts(draw, id.value, edge, end.position_m());
  return look_over(scene, outlines, id, end, parts, draw.below(2) == 0);
}

struct Counts {
  std::size_t looks = 0, met = 0, lost = 0;  ///< met and lost: facets by ways
  std::size_t listed = 0, all = 0;           ///< facets by looks
};

/// Holds a look against ways over the edge: calls `report(way, facet)` for what they meet that is not listed.
template <typename Report>
void follow_ways(Draw& draw, const Scene& scene, const Look& look, int count, Counts& counts, Report&& report) {
  const SomeWays ways(scene, scene.wedge(look.edge).edge, look.end, look.parts);
  KellerJudge judge(scene, look.edge, look.stops_at_sheets);
  for (int number = 0; number < count; ++number) {
    const KellerWay way = ways.next(draw);
    for (const FacetId facet : judge.lit_by(way)) {
      ++counts.met;
      if (is_listed(look.lit, look.parts, facet, way.place_m) || judge.is_touched(way)) continue;
      ++counts.lost;
      report(way, facet);
    }
  }
}

/// The facets of a list, each once.
std::vector<std::uint32_t> facets_in(const Listed& lit) {
  std::vector<std::uint32_t> facets;
  for (const auto& one : lit) facets.push_back(one[0]);
  std::ranges::sort(facets);
  facets.erase(std::ranges::unique(facets).begin(), facets.end());
  return facets;
}

/// Everything about a heap that a number stands for: `report(scene, look, way, facet)`.
template <typename Report>
void look_over_heap(std::uint64_t seed, int ways, Counts& counts, Report&& report) {
  Draw draw(seed);
  const KellerHeap heap(draw);
  const Scene scene = heap.scene();
  const FacetOutlines outlines(scene);
  for (const WedgeId edge : heap.edges_of(scene)) {
    for (int end = 0; end < 2; ++end) {
      const Look look = some_look(draw, scene, outlines, edge);
      ++counts.looks;
      counts.listed += facets_in(look.lit).size();
      counts.all += scene.facets().size();
      follow_ways(draw, scene, look, ways, counts,
                  [&](const KellerWay& way, FacetId facet) { report(scene, look, way, facet); });
    }
  }
}

/// Over all of an edge.
Look look_from(const Scene& scene, const FacetOutlines& outlines, WedgeId id, const Vec3& end_m) {
  const Wedge& edge = scene.wedge(id).edge;
  const EdgePart whole = whole_edge(id.value, edge, end_m);
  const KellerEnd end(edge, glm::dot(end_m - edge.start_m, edge_direction(edge)), whole.distance,
                      azimuth_rad(edge, end_m - edge.start_m));
  return look_over(scene, outlines, id, end, {whole}, true);
}

/// The edge of a solid whose middle is at a point.
WedgeId edge_at(const Scene& scene, const Vec3& point_m) {
  for (std::uint32_t number = 0; number < scene.wedges().size(); ++number) {
    const Wedge& edge = scene.wedge(WedgeId(number)).edge;
    if (!is_free(edge) && glm::distance(0.5 * (edge.start_m + edge.end_m), point_m) < 0.01) return WedgeId(number);
  }
  throw std::logic_error("no edge is there");
}

/// The facets that ways meet, each once.
std::vector<std::uint32_t> facets_met(Draw& draw, const Scene& scene, const Look& look, int count) {
  Counts counts;
  Listed met;
  Look nothing = look;
  nothing.lit.clear();
  follow_ways(draw, scene, nothing, count, counts, [&](const KellerWay&, FacetId facet) {
    met.push_back({facet.value, 0});
  });
  return facets_in(met);
}

constexpr auto say_nothing = [](const auto&...) {};

}  // namespace

TEST_CASE("ways over an edge never meet what its image calls hidden") {
  Counts counts;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    CAPTURE(seed);
    const std::size_t before = counts.lost;
    look_over_heap(seed, 250, counts, say_nothing);
    CHECK(counts.lost == before);
  }
  MESSAGE(counts.met << " facets met, " << counts.listed << " of " << counts.all << " listed by " << counts.looks
                     << " looks");
  CHECK(counts.met > 50'000);
  CHECK(counts.listed < counts.all * 3 / 4);  // or nothing was tested
}

TEST_CASE("what passes an edge by some centimetres is seen where only its side is") {
  for (const std::uint64_t seed : {87U, 253U, 1453U, 2053U, 2225U}) {  // such are rare among random heaps
    CAPTURE(seed);
    Counts counts;
    look_over_heap(seed, 1000, counts, say_nothing);
    CHECK(counts.lost == 0);
  }
}

namespace {

/// Two rows of houses of different heights along a street, and what stands in the yards behind them.
Scene street_canyon() {
  TriangleMesh mesh;
  add_sheet(mesh, Vec3(0.0), Vec3(100, 0, 0), Vec3(0, 100, 0), "opaque");
  for (int house = -4; house < 4; ++house) {
    for (const double side : {-1.0, 1.0}) {
      const double x = 14.0 * house + (side < 0 ? 3.0 : 0.0), height_m = 12.0 + (5 * house * house + 3 * house) % 7;
      for (const double y : {13.0, 35.0}) {
        add_box_faces(mesh, Vec3(x, side * y - 6, 0.0), Vec3(x + 13.0, side * y + 6, height_m), "metal");
      }
      add_box_faces(mesh, Vec3(x + 4, side * 22 - 1, 0.0), Vec3(x + 8, side * 22 + 1, 3.0), "metal");
    }
  }
  return scene_of(mesh);
}

}  // namespace

TEST_CASE("of a street an edge's image shows no more than a half") {
  const Scene scene = street_canyon();
  const FacetOutlines outlines(scene);
  Draw draw(3);
  std::size_t looks = 0, listed = 0, lit_facets = 0;
  for (std::uint32_t number = 0; number < scene.wedges().size(); ++number) {
    const WorldWedge& wedge = scene.wedge(WedgeId(number));
    const Vec3 middle_m = 0.5 * (wedge.edge.start_m + wedge.edge.end_m);
    if (!diffracts(wedge, {}) || std::abs(std::abs(middle_m.y) - 7.0) > 0.1) continue;  // those along the street
    const Look look = look_from(scene, outlines, WedgeId(number), Vec3(1.0, -2.0, 1.5));
    ++looks;
    listed += facets_in(look.lit).size();
    lit_facets += facets_met(draw, scene, look, 300).size();
  }
  MESSAGE(looks << " looks at " << scene.facets().size() << " facets: " << listed << " listed, " << lit_facets
                << " met");
  CHECK(looks > 30);
  CHECK(2 * listed < looks * scene.facets().size());  // or the image is not worth having
  CHECK(lit_facets > looks);
}

TEST_CASE("a facet that is not listed though ways meet it would be noticed") {
  std::size_t noticed = 0;
  for (std::uint64_t seed = 500; seed < 520; ++seed) {
    Draw draw(seed);
    const KellerHeap heap(draw);
    const Scene scene = heap.scene();
    const FacetOutlines outlines(scene);
    Look look = some_look(draw, scene, outlines, heap.edges_of(scene).back());
    Draw again = draw;
    const std::vector<std::uint32_t> met = facets_met(again, scene, look, 300);
    if (met.empty()) continue;
    std::erase_if(look.lit, [&](const std::array<std::uint32_t, 2>& one) { return one[0] == met.front(); });
    Counts counts;
    follow_ways(draw, scene, look, 300, counts, [&](const KellerWay&, FacetId facet) { CHECK(facet.value == met[0]); });
    CHECK(counts.lost > 0);
    ++noticed;
  }
  CHECK(noticed > 10);
}

TEST_CASE("what a wall hides is missed where the wall is not") {
  TriangleMesh mesh;
  add_box_faces(mesh, Vec3(-4, -3, -8), Vec3(0, 3, 0), "metal");
  for (int sheet = 0; sheet < 8; ++sheet) {  // as many as the box with the wall has, so that they are visited after it
    const Vec3 middle_m(30.0 + 0.1 * sheet, 4.0 * (sheet % 4) - 6.0, 3.0 + 4.0 * (sheet / 4));
    add_sheet(mesh, middle_m, Vec3(0, 1.5, 0), Vec3(0, 0, 1.5), "metal");
  }
  const Scene without = scene_of(mesh);
  add_sheet(mesh, Vec3(5, 0, 2), Vec3(0, 9, 0), Vec3(0, 0, 9), "metal");
  const Scene with = scene_of(mesh);
  REQUIRE(with.facets().size() == without.facets().size() + 1);
  const FacetOutlines outlines(with);
  Look look = look_from(with, outlines, edge_at(with, Vec3(0.0)), Vec3(-10, 1, 5));
  Draw draw(1);
  Counts there, gone;
  follow_ways(draw, with, look, 1000, there, say_nothing);
  look.edge = edge_at(without, Vec3(0.0));
  follow_ways(draw, without, look, 1000, gone, say_nothing);
  CHECK(there.met > 100);
  CHECK(there.lost == 0);
  CHECK(gone.lost > 100);
}

TEST_CASE("a sheet that passes an edge closer than its corners are is seen from the edge") {
  std::size_t met = 0;
  for (const double off_m : {0.02, 0.04, 0.055, 0.07, 0.3, 0.6}) {
    for (const double lean : {-2.0, -0.5, 0.0, 0.5, 2.0}) {
      TriangleMesh mesh;
      add_box_faces(mesh, Vec3(-4, -0.4, -8), Vec3(0, 0.4, 0), "metal");
      const double half_m = 19.0 * off_m;  // to both sides: it spans 175 degrees about the edge
      const Vec3 up(1, lean, 1), aside(1, 0, -1), low_m(off_m / std::sqrt(2.0), 0.1, off_m / std::sqrt(2.0));
      add_quad(mesh,
               {low_m - half_m * aside, low_m + half_m * aside, low_m + half_m * aside + 3.0 * up,
                low_m - half_m * aside + 3.0 * up},
               "metal");
      const Scene scene = scene_of(mesh);
      const FacetOutlines outlines(scene);
      CAPTURE(off_m);
      CAPTURE(lean);
      Draw draw(1);
      Counts counts;
      const Look look = look_from(scene, outlines, edge_at(scene, Vec3(0.0)), Vec3(-10, 3, 5));
      follow_ways(draw, scene, look, 300, counts, say_nothing);
      CHECK(counts.lost == 0);
      met += counts.met;
    }
  }
  CHECK(met > 1'000);
}

namespace {

/// An edge of its own, and a triangle beside it.
struct Beside {
  Wedge edge;
  std::array<Vec3, 3> corners_m;
  Plane plane;

  explicit Beside(Draw& draw) {
    const Axes axes = any_axes(draw);
    edge.start_m = draw.magnitude(1.0, 1e4) * draw.direction();
    edge.tangent = axes[0];
    edge.normal = axes[1];
    edge.end_m = edge.start_m + draw.magnitude(0.1, 50.0) * axes[2];
    const double away_m = draw.magnitude(1.0, 60.0);
    const Vec3 middle_m = 0.5 * (edge.start_m + edge.end_m) + away_m * (axes[0] + draw.between(-2, 2) * axes[1]);
    for (Vec3& corner_m : corners_m) corner_m = middle_m + draw.magnitude(1.0, 20.0) * away_m * draw.direction();
    plane = {corners_m[0], glm::normalize(glm::cross(corners_m[1] - corners_m[0], corners_m[2] - corners_m[0]))};
  }

  /// A point of it, often close to its rim; or a little beyond that.
  Vec3 point_m(Draw& draw) const {
    const double off = draw.magnitude(1e-5, 1e-2);
    const double u = std::array{draw.between(0, 1), off, -off}[draw.below(3)];
    const double v = draw.between(0, 1) * (1 - u);
    const std::size_t first = draw.below(3);
    return (1 - u - v) * corners_m[(first + 1) % 3] + u * corners_m[first] + v * corners_m[(first + 2) % 3];
  }
};

/// Whether one of some cells holds a place along the edge.
bool holds_place(const KellerView& view, std::uint32_t cells, double place_m) {
  for (std::uint32_t cell = 0; cell < 16; ++cell) {
    const bool holds = view.from_m(cell) <= place_m && place_m <= view.to_m(cell);
    if ((cells >> cell & 1U) != 0 && holds) return true;
  }
  return false;
}

/// Whether a patch across a way is seen from where the way leaves the edge, so far along it.
bool shows_patch(KellerView& view, const Wedge& edge, const KellerWay& way, double along) {
  const Vec3 middle_m = way.ray.at(along), normal = glm::normalize(way.ray.direction);
  const Vec3 u = glm::normalize(glm::cross(normal, edge.tangent + 0.1 * edge_direction(edge)));
  const Vec3 v = glm::cross(normal, u);
  const double half_m = 1e-3 * along;
  const std::array<Vec3, 4> corners_m{middle_m - half_m * (u + v), middle_m + half_m * (u - v),
                                      middle_m + half_m * (u + v), middle_m - half_m * (u - v)};
  const std::uint32_t cells = view.look_at(corners_m, {middle_m, normal}, 2e-4);
  return holds_place(view, cells, way.place_m);
}

}  // namespace

TEST_CASE("what legs ignore in front of a mirror does not hide it") {
  Draw draw(10);
  KellerView view;
  std::size_t along = 0, lost = 0;
  for (int round = 0; round < 20'000; ++round) {
    Beside thing(draw);
    const double off_m = draw.magnitude(1e-3, 1.0);  // so close the edge is to the plane, the corners are not
    const Vec3 direction = edge_direction(thing.edge);
    for (Vec3& corner_m : thing.corners_m) {
      const Vec3 away_m = corner_m - thing.edge.start_m;
      corner_m += thing.edge.normal * (off_m - glm::dot(away_m, thing.edge.normal));
    }
    thing.plane = {thing.corners_m[0], thing.edge.normal};
    const KellerEnd end = some_end(draw, thing.edge);
    const EdgePart whole = whole_edge(0, thing.edge, end.position_m());
    view.look_from(thing.edge, std::array{whole});
    view.cover(thing.corners_m, thing.plane, 2e-4, 0.0);
    const Vec3 behind_m = 1e-4 * thing.edge.normal;  // the weld tolerance, which a lift of twice as much is of
    const Vec3 point_m = thing.point_m(draw);
    const KellerWay way = end.way_to(point_m + behind_m);
    if (way.place_m < 0.0 || way.place_m > whole.to) continue;
    const double half_m = 1e-4 * glm::distance(point_m, way.ray.origin);
    const Vec3 u = half_m * direction, v = half_m * thing.edge.tangent, middle_m = point_m + behind_m;
    const std::array<Vec3, 4> corners_m{middle_m - u - v, middle_m + u - v, middle_m + u + v, middle_m - u + v};
    const std::uint32_t cells = view.look_at(corners_m, {middle_m, thing.edge.normal}, 2e-4);
    lost += holds_place(view, cells, way.place_m) ? 0 : 1;
    ++along;
  }
  CHECK(lost == 0);
  CHECK(along > 1'000);
}

TEST_CASE("patches just before what hides, or beside it, are seen") {
  Draw draw(9);
  KellerView view;
  std::size_t before = 0, beside = 0, hidden = 0, lost = 0;
  for (int round = 0; round < 20'000; ++round) {
    const Beside thing(draw);
    const KellerEnd end = some_end(draw, thing.edge);
    const EdgePart whole = whole_edge(0, thing.edge, end.position_m());
    view.look_from(thing.edge, std::array{whole});
    view.cover(thing.corners_m, thing.plane, 2e-4, 0.0);
    for (int patch = 0; patch < 10; ++patch) {
      const KellerWay way = end.way_to(thing.point_m(draw));
      if (way.place_m < 0.0 || way.place_m > whole.to) continue;
      const double slope = glm::dot(thing.plane.normal, way.ray.direction);
      const double along = -signed_distance_m(thing.plane, way.ray.origin) / slope;
      if (!(along > 0.05)) continue;
      const bool meets = WatertightRay(way.ray).intersect(thing.corners_m).has_value();
      const double share = draw.magnitude(1e-4, 0.05);
      const bool shown = shows_patch(view, thing.edge, way, meets ? (1.0 - share) * along : 2.0 * along);
      before += meets ? 1 : 0;
      beside += meets ? 0 : 1;
      lost += shown ? 0 : 1;
      hidden += meets && !shows_patch(view, thing.edge, way, 1.5 * along) ? 1 : 0;
    }
  }
  MESSAGE(before << " before, " << beside << " beside, " << hidden << " hidden behind");
  CHECK(lost == 0);
  CHECK(before > 10'000);
  CHECK(beside > 5'000);
  CHECK(20 * hidden > before);  // or nothing was tested
}

}  // namespace test_keller_view
