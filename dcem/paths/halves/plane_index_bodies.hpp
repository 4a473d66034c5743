#pragma once
/// Bodies of plane_index.hpp.
#include <numeric>
#include <type_traits>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/halves/plane_index.hpp"

namespace dcem {

DCEM_INLINE void PlaneIndex::build(std::span<const Item> items, const Vec3& middle_m) {
  constexpr double usual_distance_m = 300.0;  // of points that look: there a turned normal is held against offsets
  middle_m_ = middle_m;
  std::vector<Plane> planes;
  std::vector<Place> places;
  for (const Item& item : items) {
    Plane plane = item.plane;
    const Vec3& normal = plane.normal;
    const double sign = normal.x + 0.5 * normal.y + 0.25 * normal.z;  // a plane has two normals: most take one of them
    if (sign < 0.0) plane.normal = -normal;
    planes.push_back(plane);
    places.push_back({usual_distance_m * plane.normal.x, usual_distance_m * plane.normal.y,
                      usual_distance_m * plane.normal.z, glm::dot(plane.normal, plane.point_m - middle_m)});
  }
  std::vector<std::uint32_t> order(items.size());
  std::iota(order.begin(), order.end(), 0U);
  arrange(order, places);
  planes_.assign((items.size() + group - 1) / group * simd_lanes, {});
  for (Planes& eight : planes_) eight.lift.fill(-std::numeric_limits<float>::infinity());
  facets_.clear();
  for (std::size_t at = 0; at < order.size(); ++at) {
    const std::uint32_t item = order[at];
    set(planes_[at / simd_lanes], at % simd_lanes, planes[item], middle_m, items[item].lift_m);
    facets_.push_back(items[item].facet);
  }
  eights_ = around(planes_);
  groups_ = around(eights_);
}

/// Puts those that are near each other side by side: halves, along the axis on which they are farthest apart, of whole
/// groups, and of whole eights within one.
DCEM_INLINE void PlaneIndex::arrange(std::span<std::uint32_t> items, std::span<const Place> places) {
  if (items.size() <= simd_lanes) return;
  Place low = places[items.front()], high = low;
  for (const std::uint32_t item : items) {
    for (std::size_t axis = 0; axis < low.size(); ++axis) {
      low[axis] = std::min(low[axis], places[item][axis]);
      high[axis] = std::max(high[axis], places[item][axis]);
    }
  }
  std::size_t widest = 0;
  for (std::size_t axis = 1; axis < low.size(); ++axis) {
    if (high[axis] - low[axis] > high[widest] - low[widest]) widest = axis;
  }
  const std::size_t unit = items.size() > group ? group : simd_lanes;
  const std::size_t first = std::max<std::size_t>(1, (items.size() + unit - 1) / unit / 2) * unit;
  std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(first), items.end(),
                   [&](std::uint32_t one, std::uint32_t other) {
                     const double a = places[one][widest], b = places[other][widest];
                     return a != b ? a < b : one < other;
                   });
  arrange(items.first(first), places);
  arrange(items.subspan(first), places);
}

DCEM_INLINE void PlaneIndex::set(Planes& planes, std::size_t lane, const Plane& plane, const Vec3& middle_m,
                                 double lift_m) {
  planes.x[lane] = static_cast<float>(plane.normal.x);
  planes.y[lane] = static_cast<float>(plane.normal.y);
  planes.z[lane] = static_cast<float>(plane.normal.z);
  planes.offset[lane] = static_cast<float>(glm::dot(plane.normal, plane.point_m - middle_m));
  planes.lift[lane] = static_cast<float>(lift_m);
}

/// The box around each eight, with room for rounding.
template <typename Inner>
std::vector<PlaneIndex::Boxes> PlaneIndex::around(const std::vector<Inner>& inner) {
  std::vector<Boxes> outer((inner.size() + simd_lanes - 1) / simd_lanes);
  for (Boxes& boxes : outer) boxes.lift.fill(-std::numeric_limits<float>::infinity());
  const auto half_of = [](const auto& eight, Eight Boxes::*half, std::size_t lane) {
    if constexpr (std::is_same_v<Inner, Boxes>) return (eight.*half)[lane];
    return 0.0F;
  };
  for (std::size_t at = 0; at < inner.size(); ++at) {
    Boxes& boxes = outer[at / simd_lanes];
    const std::size_t to = at % simd_lanes;
    const auto fit = [&](Eight Planes::*middle, Eight Boxes::*half) {
      float low = std::numeric_limits<float>::infinity(), high = -low;
      for (std::size_t lane = 0; lane < simd_lanes; ++lane) {
        if (!(inner[at].lift[lane] >= 0.0F)) continue;
        const float own = (inner[at].*middle)[lane], own_half = half_of(inner[at], half, lane);
        low = std::min(low, own - own_half);
        high = std::max(high, own + own_half);
      }
      if (low > high) return;
      (boxes.*middle)[to] = 0.5F * (low + high);
      (boxes.*half)[to] = 0.5F * (high - low) + 1e-6F * std::max(std::abs(low), std::abs(high));
    };
    fit(&Planes::x, &Boxes::half_x);
    fit(&Planes::y, &Boxes::half_y);
    fit(&Planes::z, &Boxes::half_z);
    fit(&Planes::offset, &Boxes::half_offset);
    for (const float lift : inner[at].lift) boxes.lift[to] = std::max(boxes.lift[to], lift);
  }
  return outer;
}

}  // namespace dcem
