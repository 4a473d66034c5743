#pragma once
/// What an image of an end may see through its mirror, as half spaces, and many points tested against them at once.
///
/// All in single precision around an origin in the middle of the scene, with room for its rounding: what a cone leaves
/// out cannot be reached.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "dcem/core/simd.hpp"
#include "dcem/geometry/aabb.hpp"
#include "dcem/geometry/plane.hpp"
#include "dcem/paths/halves/cone_kernels.hpp"

namespace dcem {

/// Whether some point within a radius of a point may lie in a cone.
inline bool may_hold(std::span<const HalfSpace> cone, const Vec3& point, float radius_m) {
  const auto x = static_cast<float>(point.x), y = static_cast<float>(point.y), z = static_cast<float>(point.z);
  return std::none_of(cone.begin(), cone.end(), [&](const HalfSpace& plane) {
    return plane.x * x + plane.y * y + plane.z * z + radius_m < plane.offset;
  });
}

/// Adds half spaces mirrored in a plane, each wider by `slack_m`. All count from `origin_m`.
inline void add_mirrored(std::span<const HalfSpace> cone, const Plane& mirror, const Vec3& origin_m, double slack_m,
                         std::vector<HalfSpace>& result) {
  const Vec3& normal = mirror.normal;
  const double offset_m = glm::dot(normal, mirror.point_m - origin_m);
  for (const HalfSpace& side : cone) {
    const Vec3 own(side.x, side.y, side.z);
    const double along = glm::dot(own, normal);
    const Vec3 turned = own - 2.0 * along * normal;
    result.push_back({static_cast<float>(turned.x), static_cast<float>(turned.y), static_cast<float>(turned.z),
                      static_cast<float>(side.offset - 2.0 * offset_m * along - slack_m)});
  }
}

/// Calls `visit(normal)`, inwards and of length 1, for the planes through an apex and the sides of a convex window. A
/// side that hardly says where it is is left out: the cone is wider.
template <typename Visit>
void for_each_cone_side(const Vec3& apex_m, std::span<const Vec3> window_m, Visit&& visit) {
  Vec3 centre_m(0.0);
  for (const Vec3& corner : window_m) centre_m += corner / static_cast<double>(window_m.size());
  for (std::size_t index = 0; index < window_m.size(); ++index) {
    const Vec3 from = window_m[index] - apex_m, to = window_m[(index + 1) % window_m.size()] - apex_m;
    const Vec3 across = glm::cross(from, to);
    const double length = glm::length(across);
    if (!(length > 1e-6 * glm::length(from) * glm::length(to))) continue;
    visit((glm::dot(across, centre_m - apex_m) < 0.0 ? -across : across) / length);
  }
}

/// Adds the sides of the cone with its apex at an image, through a convex window on the mirror, beyond the mirror. All
/// counted from `origin_m`.
inline void add_cone(const Vec3& origin_m, const Vec3& apex_m, const Plane& mirror, std::span<const Vec3> window_m,
                     std::vector<HalfSpace>& planes) {
  const double side = signed_distance_m(mirror, apex_m) > 0.0 ? -1.0 : 1.0;
  // The farther away the apex, the coarser its coordinates in single precision.
  const double slack_m = 5e-3 + 1e-6 * glm::length(apex_m - origin_m);
  const auto add = [&](const Vec3& normal, const Vec3& point_m) {
    planes.push_back({static_cast<float>(normal.x), static_cast<float>(normal.y), static_cast<float>(normal.z),
                      static_cast<float>(glm::dot(normal, point_m - origin_m) - slack_m)});
  };
  for_each_cone_side(apex_m, window_m, [&](const Vec3& normal) { add(normal, apex_m); });
  add(side * mirror.normal, mirror.point_m);  // last: it keeps more than the others do
}

/// Cones of many images, one after another.
class ConeList {
 public:
  void clear() {
    planes_.clear();
    first_.assign(1, 0);
  }
  std::size_t size() const { return first_.size() - 1; }
  std::span<const HalfSpace> operator[](std::size_t cone) const {
    return std::span(planes_).subspan(first_[cone], first_[cone + 1] - first_[cone]);
  }

  /// As `add_cone` has it.
  void add(const Vec3& origin_m, const Vec3& apex_m, const Plane& mirror, std::span<const Vec3> window_m) {
    add_cone(origin_m, apex_m, mirror, window_m, planes_);
    first_.push_back(planes_.size());
  }

 private:
  std::vector<HalfSpace> planes_;
  std::vector<std::size_t> first_{0};
};

/// Items, each with a box, in clusters of eight, clusters in groups of eight, and groups in blocks of eight: those that
/// a cone may hold.
class ConeClusters {
 public:
  /// `box_of(item)` for the items 0 … count − 1, counted from the origin of the cones.
  template <typename BoxOf>
  void build(std::size_t count, BoxOf&& box_of) {
    std::vector<Vec3> centre(count);
    std::vector<std::uint32_t> items(count);
    for (std::uint32_t item = 0; item < count; ++item) {
      items[item] = item;
      centre[item] = box_of(item).center();
    }
    items_.clear();
    arrange(items, centre);
    std::vector<Aabb<double>> boxes(items_.size() / simd_lanes);
    for (std::size_t at = 0; at < items_.size(); ++at) {
      if (items_[at] != nothing) boxes[at / simd_lanes].extend(box_of(items_[at]));
    }
    clusters_ = in_eights(boxes);
    boxes = around_eights(boxes);
    boxes_.clear();
    for (const Aabb<double>& group : boxes) boxes_.push_back(ConeClusters::box_of(group));
    groups_ = in_eights(boxes);
    blocks_ = in_eights(around_eights(boxes));
    item_boxes_.clear();
  }
  /// The same, and each item can be asked by itself.
  template <typename BoxOf>
  void build_for_items(std::size_t count, BoxOf&& box_of) {
    build(count, box_of);
    item_boxes_.assign(items_.size() / simd_lanes, EightBoxes{});
    for (std::size_t at = 0; at < items_.size(); ++at) {
      if (items_[at] != nothing) set(item_boxes_[at / simd_lanes], at % simd_lanes, box_of(items_[at]));
    }
  }

  static constexpr std::uint32_t nothing = 0xffffffffU;
  /// With room for rounding.
  static CentredBox box_of(const Aabb<double>& box) {
    CentredBox result{};
    for (int axis = 0; axis < 3; ++axis) {
      const auto at = static_cast<std::size_t>(axis);
      result.centre[at] = static_cast<float>(0.5 * (box.min[axis] + box.max[axis]));
      const double size = std::max(std::abs(box.min[axis]), std::abs(box.max[axis]));
      result.half[at] = static_cast<float>(0.5 * (box.max[axis] - box.min[axis]) + 1e-3 + 1e-6 * size);
    }
    return result;
  }
  /// Boxes of 64 items each.
  std::span<const CentredBox> boxes() const { return boxes_; }
  /// The items in the order of the clusters, eight to a cluster, the last places of which may hold `nothing`.
  std::span<const std::uint32_t> items() const { return items_; }

  BoxTree tree() const { return {blocks_, groups_, clusters_}; }

  /// Calls `visit(item)` for those of eight items, from `first` on, whose bits are set.
  template <typename Visit>
  void for_each_of(std::size_t first, std::uint32_t lanes, Visit&& visit) const {
    for (; lanes != 0; lanes &= lanes - 1) {
      const std::uint32_t item = items_[first + static_cast<std::size_t>(std::countr_zero(lanes))];
      if (item != nothing) visit(item);
    }
  }

  /// Calls `visit(item)` for each item that a cone may reach, where they can be asked.
  template <typename Visit>
  void for_each_item_in(std::span<const HalfSpace> cone, Visit&& visit) const {
    const auto visit_eight = [&](std::size_t first, std::uint32_t lanes) { for_each_of(first, lanes, visit); };
    detail::cone_kernels().boxes(tree(), item_boxes_, cone, told_to(visit_eight));
  }

 private:
  static void set(EightBoxes& boxes, std::size_t lane, const Aabb<double>& box) {
    const CentredBox own = box_of(box);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      boxes.corner[axis][lane] = own.centre[axis] - own.half[axis];
      boxes.corner[axis + 3][lane] = own.centre[axis] + own.half[axis];
    }
    boxes.used |= 1U << lane;
  }

  static std::vector<EightBoxes> in_eights(const std::vector<Aabb<double>>& boxes);
  /// Boxes around eight of them each.
  static std::vector<Aabb<double>> around_eights(const std::vector<Aabb<double>>& boxes);
  /// Halves along the longest side, at whole clusters and, where there are many, at whole groups.
  void arrange(std::span<std::uint32_t> items, const std::vector<Vec3>& centre);

  std::vector<std::uint32_t> items_;
  std::vector<EightBoxes> clusters_, groups_, blocks_, item_boxes_;
  std::vector<CentredBox> boxes_;
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/halves/cone_bodies.hpp"
#endif
