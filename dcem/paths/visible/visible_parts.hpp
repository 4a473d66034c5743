#pragma once
/// Which parts of a flat surface an end of a link sees, to the edges of the shadows.
///
/// A point of a surface is hidden where a patch stands between it and the end. Seen from the end, what a convex patch
/// hides is a cone, and a cone meets a plane in a convex polygon: what is left of a convex part is cut into convex
/// parts. Only patches that the end sees need be asked: what hides a point first is seen.
#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "dcem/paths/query/scene_tracer.hpp"
#include "dcem/paths/visible/part_cutter.hpp"
#include "dcem/paths/visible/shades.hpp"
#include "dcem/paths/visible/sheet_crosser.hpp"

namespace dcem {

/// Holds scratch memory: one per thread.
template <typename Index>
class PartFinder {
 public:
  PartFinder(const PartFinder&) = delete;
  PartFinder& operator=(const PartFinder&) = delete;

  /// A surface in more parts than this is to be halved first: each part costs a test of each shade.
  static constexpr std::size_t most_parts = 48;

  PartFinder(const SceneTracer<Index>& tracer, int max_transmissions)
      : tracer_(tracer),
        scene_(tracer.scene()),
        cutter_(scene_.settings().weld_tolerance_m),
        sheets_(tracer, cutter_, static_cast<std::size_t>(max_transmissions)) {}

  /// What follows is asked of a triangle of a facet, or of a piece of one.
  void turn_to(FacetId facet, const TriangleCorners& corners_m) {
    facet_ = facet;
    plane_ = scene_.facet(facet).plane;
    // A triangle may stray from the plane of its facet.
    const Vec3 across = glm::cross(corners_m[1] - corners_m[0], corners_m[2] - corners_m[0]);
    const double twice_m2 = glm::length(across);
    if (twice_m2 > 0.0) plane_ = {corners_m[0], across / twice_m2};
  }

  /// Leaves out where other facets lie in the same plane and stand for this one: of patches that overlap the one whose
  /// material's name comes first scatters, as it reflects. Calls `note(body)` for the bodies of those that might.
  template <typename Note>
  bool leave_to_others(const IgnoredBodies& ignored, PartList& parts, TraversalCounters& counters, Note&& note);

  /// Leaves out what the shades of an end hide, and notes sheets that are crossed. False: there are too many parts. A
  /// shade of a body that is ignored casts none. Calls `note(body)` for the bodies of shades that take something.
  template <typename Note>
  bool leave_visible(const Shades& shades, ScatterLeg leg, const std::optional<BodyId>& ignored, PartList& parts,
                     Note&& note);

 private:
  /// The half space before the surface. What lies along it hides nothing within the weld tolerance, as legs ignore it
  /// there; what stands on it hides from its foot on.
  HullSide front(const Vec3& from_m, const Shades::Shade& shade) const {
    const double side = signed_distance_m(plane_, from_m) < 0.0 ? -1.0 : 1.0;
    const bool is_along = std::abs(glm::dot(plane_.normal, shade.normal)) > lies_along_cosine;
    return {side * plane_.normal,
            side * glm::dot(plane_.normal, plane_.point_m) + (is_along ? scene_.settings().weld_tolerance_m : 0.0)};
  }
  /// The sides of the cone behind a shade, of which what is not before the surface is cut off; none: it hides nothing.
  std::span<const HullSide> sides_before(const Shades& shades, std::uint32_t index, const HullSide& front);
  bool is_behind(const Shades::Shade& shade, const PartList& parts) const {
    const std::span<const Vec3> corners_m = parts.all_corners_m();
    return std::any_of(corners_m.begin(), corners_m.end(),
                       [&](const Vec3& corner_m) { return glm::dot(shade.normal, corner_m) - shade.offset_m > 0.0; });
  }
  /// Sheets come after what hides, the nearest plane first: a stack of sheets is then met one after the other.
  void put_sheets_last(const Shades& shades) {
    if (!scene_.has_sheets()) return;
    const auto first = std::stable_partition(found_.begin(), found_.end(),
                                             [&](std::uint32_t index) { return !shades[index].transmits; });
    const auto distance_m = [&](std::uint32_t index) {
      return std::abs(signed_distance_m(scene_.facet(shades[index].facet).plane, shades.from_m()));
    };
    std::sort(first, found_.end(), [&](std::uint32_t one, std::uint32_t other) {
      const double one_m = distance_m(one), other_m = distance_m(other);
      return one_m != other_m ? one_m < other_m : one < other;
    });
  }
  /// The sides of what of a triangle is no farther from the surface than that, as planes across the surface.
  void find_flat_sides(const TriangleCorners& corners_m, double tolerance_m) {
    sides_.clear();
    clipped_m_.assign(corners_m.begin(), corners_m.end());
    const Vec3& up = plane_.normal;
    const double offset_m = glm::dot(up, plane_.point_m);
    cutter_.keep_inside(clipped_m_, {up, offset_m - tolerance_m});
    cutter_.keep_inside(clipped_m_, {-up, -offset_m - tolerance_m});
    if (clipped_m_.size() < 3) return;
    Vec3 middle_m(0.0);
    for (const Vec3& corner_m : clipped_m_) middle_m += corner_m / static_cast<double>(clipped_m_.size());
    for (std::size_t index = 0; index < clipped_m_.size(); ++index) {
      const Vec3 &here_m = clipped_m_[index], &next_m = clipped_m_[index + 1 == clipped_m_.size() ? 0 : index + 1];
      const Vec3 across = glm::cross(up, next_m - here_m);
      const double length = glm::length(across);
      if (!(length > PartCutter::on_side_m)) continue;
      const Vec3 inwards = (glm::dot(across, middle_m - here_m) < 0.0 ? -1.0 : 1.0) / length * across;
      sides_.push_back({inwards, glm::dot(inwards, here_m)});
    }
  }

  const SceneTracer<Index>& tracer_;
  const Scene& scene_;
  FacetId facet_{};
  Plane plane_;  ///< of the triangle
  PartCutter cutter_;
  SheetCrosser<Index> sheets_;
  std::vector<std::uint32_t> found_;
  std::vector<Vec3> clipped_m_;
  std::vector<HullSide> sides_;
};

// ---------------------------------------------------------------------------------------------------------------------

template <typename Index>
template <typename Note>
bool PartFinder<Index>::leave_to_others(const IgnoredBodies& ignored, PartList& parts, TraversalCounters& counters,
                                        Note&& note) {
  const double tolerance_m = scene_.settings().weld_tolerance_m;
  std::vector<std::uint32_t> over;
  Aabb<double> box;
  for (const Vec3& corner_m : parts.all_corners_m()) box.extend(corner_m);
  tracer_.index().overlapping(
      inflated(box, tolerance_m),
      [&](std::uint32_t triangle) {
        const FacetId other = scene_.facet_of_triangle(triangle);
        if (other == facet_ || !tracer_.parallel(other, facet_)) return;
        if (tracer_.is_ignored(scene_.facet(other).body, ignored) || !tracer_.precedes(other, facet_)) return;
        over.push_back(triangle);
      },
      &counters);
  std::ranges::sort(over);
  for (const std::uint32_t triangle : over) {
    find_flat_sides(scene_.corners_m(triangle), tolerance_m);
    if (sides_.size() < 3) continue;
    note(scene_.facet(scene_.facet_of_triangle(triangle)).body);
    cutter_.cut(parts, sides_, [](std::size_t, std::span<const Vec3>, PartList&) {});
    if (parts.size() > most_parts) return false;
  }
  return true;
}

template <typename Index>
template <typename Note>
bool PartFinder<Index>::leave_visible(const Shades& shades, ScatterLeg leg, const std::optional<BodyId>& ignored,
                                      PartList& parts, Note&& note) {
  if (parts.empty()) return true;
  const DirectionCone cone = DirectionCone::around(shades.from_m(), parts.all_corners_m());
  double farthest_m = 0.0;
  for (const Vec3& corner_m : parts.all_corners_m()) {
    farthest_m = std::max(farthest_m, glm::distance(corner_m, shades.from_m()));
  }
  shades.find(cone, farthest_m, found_);
  put_sheets_last(shades);
  for (const std::uint32_t index : found_) {
    const Shades::Shade& shade = shades[index];
    if (shade.facet == facet_ || ignored == shade.body || !is_behind(shade, parts)) continue;
    const std::span<const HullSide> sides = sides_before(shades, index, front(shades.from_m(), shade));
    if (sides.size() < 3) continue;
    note(shade.body);
    if (shade.transmits) {
      sheets_.cross(shade.facet, shades.from_m(), leg, sides, parts);
    } else {
      cutter_.cut(parts, sides, [](std::size_t, std::span<const Vec3>, PartList&) {});
    }
    if (parts.empty()) return true;
    if (parts.size() > most_parts) return false;
  }
  if (scene_.has_sheets()) sheets_.leave_crossable(parts);
  return true;
}

template <typename Index>
std::span<const HullSide> PartFinder<Index>::sides_before(const Shades& shades, std::uint32_t index,
                                                          const HullSide& front) {
  const std::span<const Vec3> corners_m = shades.corners_m(shades[index]);
  bool any = false, all = true;
  for (const Vec3& corner_m : corners_m) {
    const bool is_before = glm::dot(front.normal, corner_m) > front.offset_m;
    any = any || is_before;
    all = all && is_before;
  }
  if (!any) return {};
  if (all) return shades.sides(index);
  clipped_m_.assign(corners_m.begin(), corners_m.end());
  cutter_.keep_inside(clipped_m_, front);
  sides_.clear();
  // Of less than that rounding would say where its sides are.
  if (cutter_.is_piece(clipped_m_)) Shades::add_sides(shades.from_m(), clipped_m_, sides_);
  return sides_;
}

}  // namespace dcem
