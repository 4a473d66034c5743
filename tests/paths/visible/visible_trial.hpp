#pragma once
/// What a link sees of triangles, worked out in parts, and what rays say of single points of them.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "dcem/field/diffuse/adaptive_tiles.hpp"
#include "dcem/paths/halves/facet_outlines.hpp"
#include "dcem/paths/visible/may_scatter.hpp"
#include "dcem/paths/visible/surface_view.hpp"
#include "dcem/paths/visible/visible_parts.hpp"
#include "tests/paths/small_scenes.hpp"
#include "tests/support/scatter_solver.hpp"

namespace dcem::test {

/// Rough surfaces, `rough` and `slab` (opaque), `board` and `film` (sheets); smooth ones, `metal` and `opaque`, and the
/// sheets `alpha` and `glass`; `hedge` is foliage. Their order as materials is not that of their names.
inline Scene scene_of_rough_materials(const SurfaceSettings& settings = {}) {
  Scene scene(settings);
  const Scattering half{0.5};
  scene.add_material({"slab", ConstantReflection{0.7, std::nullopt}, 0.0, half});
  scene.add_material({"rough", ConstantReflection{0.7, std::nullopt}, 0.0, half});
  scene.add_material({"film", ConstantReflection{0.6, 10.0}, 0.0, half});
  scene.add_material({"board", ConstantReflection{0.6, 10.0}, 0.0, half});
  scene.add_material({"metal", PerfectConductor{}});
  scene.add_material({"opaque", ConstantReflection{0.8, std::nullopt}});
  scene.add_material({"glass", ConstantReflection{0.74, 5.0}});
  scene.add_material({"alpha", ConstantReflection{0.5, 3.0}});
  scene.add_material({"hedge", Foliage{1.0}});
  return scene;
}

inline Scene rough_scene_of(const TriangleMesh& mesh, const SurfaceSettings& settings = {}) {
  Scene scene = scene_of_rough_materials(settings);
  scene.set_scenery(mesh);
  return scene;
}

inline double area_of_m2(const PartList& parts) {
  double area_m2 = 0.0;
  for (std::size_t part = 0; part < parts.size(); ++part) area_m2 += 0.5 * twice_area_m2(parts.corners_m(part));
  return area_m2;
}

inline double area_of_m2(const TriangleCorners& corners_m) {
  return 0.5 * glm::length(glm::cross(corners_m[1] - corners_m[0], corners_m[2] - corners_m[0]));
}

inline double distance_to_segment_m(const Vec3& point_m, const Vec3& start_m, const Vec3& end_m) {
  const Vec3 along_m = end_m - start_m, away_m = point_m - start_m;
  const double squared = glm::dot(along_m, along_m);
  const double share = squared > 0.0 ? std::clamp(glm::dot(away_m, along_m) / squared, 0.0, 1.0) : 0.0;
  return glm::length(away_m - share * along_m);
}

/// How far a point in the plane of a convex polygon is from its rim; negative outside.
inline double inside_m(std::span<const Vec3> corners_m, const Vec3& point_m) {
  Vec3 normal(0.0);
  for (std::size_t index = 1; index + 1 < corners_m.size(); ++index) {
    normal += glm::cross(corners_m[index] - corners_m[0], corners_m[index + 1] - corners_m[0]);
  }
  bool is_inside = true;
  double rim_m = std::numeric_limits<double>::infinity();
  for (std::size_t index = 0; index < corners_m.size(); ++index) {
    const Vec3 &here_m = corners_m[index], &next_m = corners_m[(index + 1) % corners_m.size()];
    is_inside = is_inside && glm::dot(normal, glm::cross(next_m - here_m, point_m - here_m)) >= 0.0;
    rim_m = std::min(rim_m, distance_to_segment_m(point_m, here_m, next_m));
  }
  return is_inside ? rim_m : -rim_m;
}

/// A piece of a triangle that was not halved any more, and its parts that both ends see.
struct SeenPiece {
  TriangleCorners corners_m;
  PartList parts;
};

/// Where a point is among the parts of a triangle.
struct PlaceAmongParts {
  const SeenPiece* piece = nullptr;                        ///< none: in no part
  std::size_t part = 0, found = 0;                         ///< how many parts it is in
  double rim_m = std::numeric_limits<double>::infinity();  ///< to the nearest rim of any part
};

inline PlaceAmongParts place_of(std::span<const SeenPiece> pieces, const Vec3& point_m) {
  PlaceAmongParts place;
  for (const SeenPiece& piece : pieces) {
    for (std::size_t part = 0; part < piece.parts.size(); ++part) {
      const double inside = inside_m(piece.parts.corners_m(part), point_m);
      place.rim_m = std::min(place.rim_m, std::abs(inside));
      if (inside < 0.0) continue;
      place.piece = &piece;
      place.part = part;
      ++place.found;
    }
  }
  return place;
}

/// One link: its parts as the diffuse power finds them, and its rays.
template <typename World>
class LinkView {
 public:
  LinkView(World& world, const LinkEnd& transmitter, const LinkEnd& receiver, int max_transmissions)
      : from(transmitter),
        to(receiver),
        tracer_(world.tracer),
        finder_(world.tracer, max_transmissions),
        solver_(world.tracer, max_transmissions) {
    const FacetOutlines outlines(scene());
    static Sight sight(256);  // the memory of its map costs more than most views
    lit = look_at_surfaces(sight, scene(), outlines, from, max_transmissions);
    seen = look_at_surfaces(sight, scene(), outlines, to, max_transmissions);
  }
  LinkView(const LinkView&) = delete;
  LinkView& operator=(const LinkView&) = delete;

  const Scene& scene() const { return tracer_.scene(); }

  /// Whether anything is looked for on a facet.
  bool asks(FacetId facet) const {
    const auto is_in = [&](const SurfaceView& view) { return std::ranges::binary_search(view.facets, facet); };
    return is_in(lit) && is_in(seen) && may_scatter(scene(), from, to, facet);
  }

  /// What the transmitter sees of a piece, for a receiver that rides on `ridden`.
  LitParts find_lit(FacetId facet, const TriangleCorners& corners_m, const std::optional<BodyId>& ridden) {
    LitParts found;
    const auto note = [&](BodyId body) {
      if (body != BodyId{}) found.bodies.push_back(body);
    };
    finder_.turn_to(facet, corners_m);
    found.parts.add(corners_m, {});
    found.are_too_many = !finder_.leave_to_others({from.ignored_body, ridden}, found.parts, counters_, note) ||
                         !finder_.leave_visible(lit.shades, ScatterLeg::from_transmitter, ridden, found.parts, note);
    return found;
  }

  /// What both ends see of a piece; nothing where it is to be halved.
  std::optional<PartList> find_parts(FacetId facet, const TriangleCorners& corners_m) {
    LitParts found = find_lit(facet, corners_m, to.ignored_body);
    if (found.are_too_many) return std::nullopt;
    finder_.turn_to(facet, corners_m);
    const bool are_few =
        finder_.leave_visible(seen.shades, ScatterLeg::to_receiver, from.ignored_body, found.parts, [](BodyId) {});
    return are_few ? std::optional(std::move(found.parts)) : std::nullopt;
  }

  std::vector<SeenPiece> pieces_of(std::uint32_t triangle) {
    const FacetId facet = scene().facet_of_triangle(triangle);
    std::vector<SeenPiece> pieces;
    if (!asks(facet)) return pieces;
    std::vector<Tile> waiting{{scene().corners_m(triangle), triangle}};
    while (!waiting.empty()) {
      const Tile tile = waiting.back();
      waiting.pop_back();
      if (std::optional<PartList> parts = find_parts(facet, tile.corners_m)) {
        pieces.push_back({tile.corners_m, std::move(*parts)});
        continue;
      }
      ++halvings;
      REQUIRE(tile.place < (std::uint64_t{1} << 40U));  // it comes to an end
      for (const Tile& half : tile.halves()) waiting.push_back(half);
    }
    return pieces;
  }

  /// Whether rays are to be asked of a facet at all.
  bool traces(FacetId facet) const { return solver_.may_scatter(from, to, facet); }
  /// What rays say of a point; nothing where it does not scatter.
  std::optional<Path> traced(FacetId facet, const Vec3& point_m) {
    Path path;
    if (!solver_.may_scatter(from, to, facet) || !solver_.solve(from, to, facet, point_m, path)) return std::nullopt;
    return path;
  }

  /// Whether at a point another facet lies along that of a triangle so close to the tolerance that it depends on the
  /// plane, the triangle's or the mean one of its facet, whether it lies within.
  bool is_at_tolerance(FacetId facet, const Vec3& point_m) {
    const double tolerance_m = scene().settings().weld_tolerance_m;
    for (const FacetId other : tracer_.facets_near(point_m, 3.0 * tolerance_m, {}, counters_)) {
      const WorldFacet& near = scene().facet(other);
      if (other == facet || std::abs(glm::dot(near.plane.normal, scene().facet(facet).plane.normal)) < 0.99) continue;
      const double between_m = stray_m(facet) + stray_m(other) + 0.02 * tolerance_m;
      for (std::uint32_t index = 0; index < near.triangle_count; ++index) {
        const double off_m = distance_to_triangle_m(scene().corners_m(near.first_triangle + index), point_m);
        if (std::abs(off_m - tolerance_m) <= between_m) return true;
      }
    }
    return false;
  }

  LinkEnd from, to;
  SurfaceView lit, seen;
  std::size_t halvings = 0;

 private:
  double stray_m(FacetId id) const {
    const WorldFacet& facet = scene().facet(id);
    double stray_m = 0.0;
    for (std::uint32_t index = 0; index < facet.triangle_count; ++index) {
      for (const Vec3& corner_m : scene().corners_m(facet.first_triangle + index)) {
        stray_m = std::max(stray_m, std::abs(signed_distance_m(facet.plane, corner_m)));
      }
    }
    return stray_m;
  }

  const SceneTracer<WideIndex>& tracer_;
  PartFinder<WideIndex> finder_;
  ScatterSolver<WideIndex> solver_;
  TraversalCounters counters_;
};

/// How points have come out.
struct Tally {
  std::size_t visible = 0, hidden = 0, through = 0;  ///< `through`: of the visible ones, through sheets
  std::size_t doubtful = 0;                          ///< too close to a rim
  std::size_t narrow = 0;                            ///< differs in a gap or a shadow that is narrower than what counts
  std::size_t at_tolerance = 0;  ///< differs where what is decided by the weld tolerance is just as far away
  std::size_t wrong = 0;
  std::size_t halvings = 0;  ///< of triangles with too many parts
};

/// Sheets of the legs before and after the scattering.
inline std::array<std::set<FacetId>, 2> sheets_of(const Path& path) {
  std::array<std::set<FacetId>, 2> sheets;
  std::size_t leg = 0;
  for (const Interaction& at : path.interactions) {
    if (at.kind == InteractionKind::scattering) leg = 1;
    if (at.kind == InteractionKind::transmission) sheets[leg].insert(at.facet);
  }
  return sheets;
}

inline std::array<std::set<FacetId>, 2> sheets_of(const PartList& parts, std::size_t part) {
  std::array<std::set<FacetId>, 2> sheets;
  for (std::size_t leg = 0; leg < 2; ++leg) {
    const std::span<const FacetId> list = parts.sheets(parts.crossed(part)[leg]);
    sheets[leg] = {list.begin(), list.end()};
    CHECK(sheets[leg].size() == list.size());
  }
  return sheets;
}

/// Compares the parts with rays to points, one point after the other.
template <typename View>
class PointJudge {
 public:
  PointJudge(View& view, Tally& tally) : view_(view), tally_(tally) {}

  /// Points nearer than `margin_m` to a rim do not count. `excuses`: nor do those that differ at a tolerance.
  void judge(std::uint32_t triangle, std::span<const SeenPiece> pieces, const Vec3& point_m, double margin_m,
             bool excuses = true) {
    const FacetId facet = view_.scene().facet_of_triangle(triangle);
    const TriangleCorners corners_m = view_.scene().corners_m(triangle);
    const PlaceAmongParts place = place_of(pieces, point_m);
    if (place.rim_m < margin_m || inside_m(corners_m, point_m) < margin_m) {
      ++tally_.doubtful;
      return;
    }
    const std::optional<Path> path = view_.traced(facet, point_m);
    const bool are_same = place.found <= 1 && path.has_value() == (place.piece != nullptr) &&
                          (!path || sheets_of(*path) == sheets_of(place.piece->parts, place.part));
    if (are_same) {
      ++(path ? tally_.visible : tally_.hidden);
      if (path && path->interactions.size() > 1) ++tally_.through;
    } else if (excuses && place.found <= 1 && is_narrow(facet, corners_m, point_m, path)) {
      ++tally_.narrow;
    } else if (excuses && place.found <= 1 && view_.is_at_tolerance(facet, point_m)) {
      ++tally_.at_tolerance;
    } else {
      report(triangle, point_m, place, path);
    }
  }

 private:
  /// The cutter drops what is narrower than the weld tolerance; a triangle of that mean width is twice as wide.
  bool is_narrow(FacetId facet, const TriangleCorners& corners_m, const Vec3& point_m,
                 const std::optional<Path>& path) {
    const Vec3 along = glm::normalize(corners_m[1] - corners_m[0]);
    const Vec3 normal = glm::normalize(glm::cross(along, corners_m[2] - corners_m[0]));
    const Vec3 across = glm::cross(normal, along);
    const double narrow_m = 3.0 * view_.scene().settings().weld_tolerance_m;
    constexpr int around = 16;
    for (int step = 0; step < around; ++step) {
      const double turn_rad = 2.0 * pi * step / around;
      const Vec3 beside_m = point_m + narrow_m * (std::cos(turn_rad) * along + std::sin(turn_rad) * across);
      const std::optional<Path> other = view_.traced(facet, beside_m);
      if (other.has_value() != path.has_value()) return true;
      if (path && sheets_of(*other) != sheets_of(*path)) return true;
    }
    return false;
  }

  void report(std::uint32_t triangle, const Vec3& point_m, const PlaceAmongParts& place,
              const std::optional<Path>& path) {
    if (++tally_.wrong > 5) return;  // these say enough
    const auto text = [](const std::array<std::set<FacetId>, 2>& sheets) {
      std::string all;
      for (const auto& leg : sheets) {
        all += "|";
        for (const FacetId sheet : leg) all += " " + std::to_string(sheet.value);
      }
      return all;
    };
    const std::string parts = place.piece ? text(sheets_of(place.piece->parts, place.part)) : "hidden";
    const std::string rays = path ? text(sheets_of(*path)) : "hidden";
    const std::string number =
        std::to_string(triangle) + " of facet " + std::to_string(view_.scene().facet_of_triangle(triangle).value);
    CAPTURE(view_.from.position_m.x);
    CAPTURE(view_.from.position_m.y);
    CAPTURE(view_.from.position_m.z);
    CAPTURE(view_.to.position_m.x);
    CAPTURE(view_.to.position_m.y);
    CAPTURE(view_.to.position_m.z);
    CAPTURE(point_m.x);
    CAPTURE(point_m.y);
    CAPTURE(point_m.z);
    CAPTURE(place.rim_m);
    FAIL_CHECK("triangle " << number << " in " << place.found << " parts: " << parts << ", by rays: " << rays);
  }

  View& view_;
  Tally& tally_;
};

/// An even draw of a triangle's points.
inline Vec3 point_of(const TriangleCorners& corners_m, Draw& draw) {
  const double root = std::sqrt(draw.between(0, 1)), share = draw.between(0, 1);
  return (1.0 - root) * corners_m[0] + root * (1.0 - share) * corners_m[1] + root * share * corners_m[2];
}

}  // namespace dcem::test
