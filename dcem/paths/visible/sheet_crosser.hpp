#pragma once
/// Which sheets lie between an end of a link and the parts of a surface.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "dcem/paths/query/scene_tracer.hpp"
#include "dcem/paths/visible/part_cutter.hpp"

namespace dcem {

/// Which leg of a path over a surface.
enum class ScatterLeg : std::uint8_t { from_transmitter, to_receiver };

/// Notes on parts which sheets they are behind; those that lie on each other count once, as on any leg.
template <typename Index>
class SheetCrosser {
 public:
  /// All must outlive it.
  SheetCrosser(const SceneTracer<Index>& tracer, PartCutter& cutter, std::size_t max_transmissions)
      : tracer_(tracer), scene_(tracer.scene()), cutter_(cutter), max_transmissions_(max_transmissions) {}

  /// What is behind a sheet, inside of the sides of the cone over it, stays if the sheet may be crossed.
  void cross(FacetId sheet, const Vec3& from_m, ScatterLeg leg, std::span<const HullSide> sides, PartList& parts);
  /// Leaves out parts behind too many sheets.
  void leave_crossable(PartList& parts) const;

 private:
  /// Cuts where two sheets that are almost parallel are as far from each other, along the way from a point, as sheets
  /// that count once may be.
  void cut_between(FacetId one, FacetId other, const Vec3& from_m, std::vector<std::vector<Vec3>>& polygons);
  /// No more than the sheets that will count where others are met, too: what lies almost on each other may yet be one.
  std::size_t least_count(const std::vector<FacetId>& met, const Vec3& from_m, std::span<const Vec3> polygon) const;
  bool may_be_one(FacetId one, FacetId other, const Vec3& from_m, std::span<const Vec3> polygon) const;
  /// The sheets that count of those that a way to the middle of a polygon meets.
  std::vector<FacetId> counted(const std::vector<FacetId>& met, const Vec3& from_m,
                               std::span<const Vec3> polygon) const;

  const SceneTracer<Index>& tracer_;
  const Scene& scene_;
  PartCutter& cutter_;
  std::size_t max_transmissions_;
};

// ---------------------------------------------------------------------------------------------------------------------

template <typename Index>
void SheetCrosser<Index>::cross(FacetId sheet, const Vec3& from_m, ScatterLeg leg, std::span<const HullSide> sides,
                                PartList& parts) {
  const auto which = static_cast<std::size_t>(leg);
  std::vector<std::vector<Vec3>> polygons;
  cutter_.cut(parts, sides, [&](std::size_t part, std::span<const Vec3> polygon, PartList& next) {
    PartList::CrossedLists crossed = parts.crossed(part);
    const std::span<const FacetId> before = parts.met(crossed[which]);
    std::vector<FacetId> met(before.begin(), before.end());
    polygons.assign(1, {polygon.begin(), polygon.end()});
    for (const FacetId other : met) cut_between(sheet, other, from_m, polygons);
    met.push_back(sheet);
    const std::size_t on_other_leg = parts.sheets(crossed[1 - which]).size();
    for (const std::vector<Vec3>& piece : polygons) {
      std::vector<FacetId> sheets = counted(met, from_m, piece);
      if (least_count(met, from_m, piece) + on_other_leg > max_transmissions_) continue;
      crossed[which] = parts.add_list(met, std::move(sheets));
      next.add(piece, crossed);
    }
  });
}

/// Ways that meet the planes at shares t₁ and t₂ with (t₁ − t₂)·|n₁·way| = ±tolerance are in the planes through the
/// start with the normals (s₂ ± tolerance)·n₁ − s₁·n₂, s the start's distances from the planes.
template <typename Index>
void SheetCrosser<Index>::cut_between(FacetId one, FacetId other, const Vec3& from_m,
                                      std::vector<std::vector<Vec3>>& polygons) {
  if (!tracer_.parallel(one, other)) return;
  const Plane &first = scene_.facet(one).plane, &second = scene_.facet(other).plane;
  const double first_m = signed_distance_m(first, from_m), second_m = signed_distance_m(second, from_m);
  for (const double sign : {-1.0, 1.0}) {
    const Vec3 normal = (second_m + sign * scene_.settings().weld_tolerance_m) * first.normal - first_m * second.normal;
    const double length = glm::length(normal);
    if (!(length > 0.0)) continue;
    cutter_.cut_apart(polygons, {normal / length, glm::dot(normal, from_m) / length});
  }
}

template <typename Index>
std::vector<FacetId> SheetCrosser<Index>::counted(const std::vector<FacetId>& met, const Vec3& from_m,
                                                  std::span<const Vec3> polygon) const {
  if (met.size() == 1) return met;
  Vec3 middle_m(0.0);
  for (const Vec3& corner_m : polygon) middle_m += corner_m / static_cast<double>(polygon.size());
  std::vector<Crossing> crossings;
  for (const FacetId sheet : met) {
    const Plane& plane = scene_.facet(sheet).plane;
    const double from = signed_distance_m(plane, from_m), to = signed_distance_m(plane, middle_m);
    crossings.push_back({sheet, from == to ? 0.0 : from / (from - to)});
  }
  tracer_.merge_in_order(crossings, middle_m - from_m);
  std::vector<FacetId> sheets;
  for (const Crossing& crossing : crossings) sheets.push_back(crossing.facet);
  return sheets;
}

template <typename Index>
std::size_t SheetCrosser<Index>::least_count(const std::vector<FacetId>& met, const Vec3& from_m,
                                             std::span<const Vec3> polygon) const {
  std::size_t count = 0;
  for (std::size_t index = 0; index < met.size(); ++index) {
    const auto is_near = [&](FacetId other) { return may_be_one(met[index], other, from_m, polygon); };
    if (std::none_of(met.begin(), met.begin() + static_cast<std::ptrdiff_t>(index), is_near)) ++count;
  }
  return count;
}

/// Sheets between them may make one of two that are no farther from each other than a few tolerances.
template <typename Index>
bool SheetCrosser<Index>::may_be_one(FacetId one, FacetId other, const Vec3& from_m,
                                     std::span<const Vec3> polygon) const {
  constexpr double tolerances = 16.0;
  if (!tracer_.parallel(one, other)) return false;
  const auto share = [&](FacetId sheet, const Vec3& to_m) {
    const Plane& plane = scene_.facet(sheet).plane;
    const double from = signed_distance_m(plane, from_m), to = signed_distance_m(plane, to_m);
    return from == to ? 0.0 : from / (from - to);
  };
  return std::any_of(polygon.begin(), polygon.end(), [&](const Vec3& corner_m) {
    const double across_m = std::abs(glm::dot(scene_.facet(one).plane.normal, corner_m - from_m));
    return std::abs(share(one, corner_m) - share(other, corner_m)) * across_m <=
           tolerances * scene_.settings().weld_tolerance_m;
  });
}

template <typename Index>
void SheetCrosser<Index>::leave_crossable(PartList& parts) const {
  PartList kept = parts;
  kept.clear_parts();
  for (std::size_t part = 0; part < parts.size(); ++part) {
    const auto [first, second] = parts.crossed(part);
    if (parts.sheets(first).size() + parts.sheets(second).size() > max_transmissions_) continue;
    kept.add(parts.corners_m(part), parts.crossed(part));
  }
  parts.swap_parts(kept);
}

}  // namespace dcem
