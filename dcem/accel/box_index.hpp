#pragma once
/// A tree of boxes, which knows boxes and numbers only, as a `SpatialIndex` over triangles: see `binary_index.hpp` and
/// `brute_force_index.hpp`.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "dcem/accel/binary/sah_settings.hpp"
#include "dcem/accel/detail/box_check.hpp"
#include "dcem/accel/exact_hit.hpp"
#include "dcem/accel/spatial_index.hpp"

namespace dcem {

/// See `SpatialIndex`. `Tree` is `Bvh<double>` or `BruteForce<double>`, and `Updater` what keeps it while boxes move.
template <typename Tree, typename Updater>
class BoxIndex {
 public:
  /// Throws std::invalid_argument for settings out of range.
  explicit BoxIndex(const TreeUpdateSettings& settings = {}, const SahSettings& build = {})
      : build_settings_(build), updater_(settings) {}

  void build(const TriangleView& mesh, std::span<const Aabb<double>> boxes,
             std::span<const std::uint32_t> object_first) {
    if (mesh.size() != boxes.size()) throw std::invalid_argument("one box per triangle is needed");
    require_valid_boxes(boxes);
    boxes_.assign(boxes.begin(), boxes.end());
    for (Aabb<double>& box : boxes_) box = with_room(box);
    tree_.build_objects(boxes_, object_first, build_settings_);
    vertices_m_.assign(mesh.vertices_m.begin(), mesh.vertices_m.end());
    triangles_.assign(mesh.triangles.begin(), mesh.triangles.end());
    object_of_triangle_.assign(triangles_.size(), 0);
    for (std::size_t object = 0; object < object_first.size(); ++object) {
      std::fill(object_of_triangle_.begin() + object_first[object], object_of_triangle_.end(),
                static_cast<std::uint32_t>(object));
    }
  }
  TreeUpdateReport update(const TriangleView& mesh, std::span<const Aabb<double>> boxes,
                          std::span<const std::uint32_t> moved) {
    if (mesh.size() != triangles_.size() || mesh.vertices_m.size() != vertices_m_.size()) {
      throw std::invalid_argument("update: expected the triangles and vertices that the index was built over");
    }
    if (boxes.size() != triangles_.size()) throw std::invalid_argument("one box per triangle is needed");
    for (const std::uint32_t triangle : moved) {
      if (triangle >= boxes.size()) {
        throw std::invalid_argument("triangle " + std::to_string(triangle) + " is not in the index");
      }
      require_valid_box(boxes[triangle], triangle);
    }
    for (const std::uint32_t triangle : moved) boxes_[triangle] = with_room(boxes[triangle]);
    const TreeUpdateReport report = updater_.update(tree_, moved, boxes_);
    for (const std::uint32_t triangle : moved) {
      for (const std::uint32_t vertex : triangles_[triangle]) vertices_m_[vertex] = mesh.vertices_m[vertex];
    }
    return report;
  }
  void note_rays(const TraversalCounters&, std::uint64_t) {}

  std::optional<TriangleHit> closest_hit(const Ray<double>& ray, const HitFilter& filter = {},
                                         TraversalCounters* counters = nullptr) const {
    std::optional<TriangleHit> best;
    if (!has_direction(ray)) return best;
    const WatertightRay prepared(ray);
    const auto look_at = [&](std::uint32_t triangle, double& t_max) {
      const std::optional<TriangleHit> hit = hit_on(triangle, prepared, ray, filter);
      if (!hit) return;
      detail::take_nearer(*hit, best);
      t_max = std::min(t_max, later(best->t));
    };
    tree_.closest(with_room(ray), look_at, counters);
    return best;
  }
  void closest_hits(std::span<const RayQuery> queries, std::span<std::optional<TriangleHit>> hits,
                    TraversalCounters* counters = nullptr) const {
    if (queries.size() != hits.size()) throw std::invalid_argument("closest_hits: one place for each ray is needed");
    for (std::size_t index = 0; index < queries.size(); ++index) {
      hits[index] = closest_hit(queries[index].ray, queries[index].filter, counters);
    }
  }
  void closest_hits(const RayFan& fan, std::span<std::optional<TriangleHit>> hits,
                    TraversalCounters* counters = nullptr) const {
    if (fan.directions.size() != hits.size()) {
      throw std::invalid_argument("closest_hits: one place for each ray is needed");
    }
    for (std::size_t index = 0; index < hits.size(); ++index) {
      hits[index] = closest_hit({fan.origin, fan.directions[index]}, fan.filter, counters);
    }
  }
  bool occluded(const Ray<double>& ray, const HitFilter& filter = {}, TraversalCounters* counters = nullptr) const {
    return visit_hits(
        ray, filter, [](const TriangleHit&) { return true; }, counters);
  }
  template <typename Visit>
  bool visit_hits(const Ray<double>& ray, const HitFilter& filter, Visit&& visit,
                  TraversalCounters* counters = nullptr) const {
    if (!has_direction(ray)) return false;
    const WatertightRay prepared(ray);
    const auto look_at = [&](std::uint32_t triangle) {
      const std::optional<TriangleHit> hit = hit_on(triangle, prepared, ray, filter);
      return hit && visit(*hit);
    };
    return tree_.any(with_room(ray), look_at, counters);
  }
  template <typename Visit>
  void overlapping(const Aabb<double>& box, Visit&& visit, TraversalCounters* counters = nullptr) const {
    const Aabb<double> region = canonical_box(box);
    const auto look_at = [&](std::uint32_t triangle) {
      if (region.overlaps(box_of(triangle))) visit(triangle);
    };
    tree_.overlapping(region, look_at, counters);
  }
  template <typename Keep, typename Visit>
  void visit(Keep&& keep, Visit&& visit, TraversalCounters* counters = nullptr) const {
    const auto look_at = [&](std::uint32_t triangle) {
      if (keep(box_of(triangle))) visit(triangle);
    };
    tree_.visit(keep, look_at, counters);
  }

  const Tree& tree() const { return tree_; }

 private:
  /// A box test must not decide against exact_hit_t. A ray that touches a triangle may pass its box at a rounding's
  /// distance; and a ray close along a triangle meets its plane at a quotient of roundings, which may lie outside the
  /// box, no farther than this share of the way: where it is closer along, exact_hit_t asks the corners.
  static constexpr double room = 1e-9, room_m = 1e-6;

  static double later(double t) { return t + room * std::abs(t); }
  static Ray<double> with_room(const Ray<double>& ray) {
    return {ray.origin, ray.direction, ray.t_min - room * std::abs(ray.t_min), later(ray.t_max)};
  }
  static Aabb<double> with_room(const Aabb<double>& box) {
    if (box.empty()) return {};
    const Vec3 farthest_m = glm::max(glm::abs(box.min), glm::abs(box.max));
    return inflated(box, room_m + room * std::max({farthest_m.x, farthest_m.y, farthest_m.z}));
  }
  Aabb<double> box_of(std::uint32_t triangle) const {
    Aabb<double> box;
    for (const std::uint32_t vertex : triangles_[triangle]) box.extend(vertices_m_[vertex]);
    return box;
  }

  std::optional<TriangleHit> hit_on(std::uint32_t triangle, const WatertightRay& prepared, const Ray<double>& ray,
                                    const HitFilter& filter) const {
    if (filter.ignores(object_of_triangle_[triangle])) return std::nullopt;
    const TriangleCorners corners_m = TriangleView{vertices_m_, triangles_}.corners_m(triangle);
    const std::optional<double> t = exact_hit_t(plane_of(corners_m), corners_m, prepared, ray);
    const bool counts = t && filter.passes({*t, triangle});
    return counts ? std::optional(TriangleHit{*t, triangle}) : std::nullopt;
  }

  SahSettings build_settings_;
  Tree tree_;
  Updater updater_;
  std::vector<Aabb<double>> boxes_;  ///< with room; empty for triangles that are not there
  std::vector<Vec3> vertices_m_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::vector<std::uint32_t> object_of_triangle_;
};

}  // namespace dcem
