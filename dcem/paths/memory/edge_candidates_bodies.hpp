#pragma once
/// Bodies of edge_candidates.hpp.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/memory/edge_candidates.hpp"

namespace dcem {

DCEM_INLINE void EdgeCandidates::add(const Wedge& edge, const EdgePart& part) {
  set(direct_, direct_count_++, edge.start_m, edge_direction(edge), part);
}

DCEM_INLINE void EdgeCandidates::begin_mirror(const Plane& mirror, std::span<const HullSide> outline) {
  if (mirrors_.empty() || mirrors_.back().end > last_begins_at_) mirrors_.emplace_back();
  last_begins_at_ = mirrored_count_;
  CandidateMirror& last = mirrors_.back();
  last = {};
  last.end = mirrored_count_;
  last.plane = around_origin(mirror.normal, glm::dot(mirror.normal, mirror.point_m));
  for (std::size_t side = 0; side < std::min(outline.size(), last.sides.size()); ++side) {
    last.sides[side] = around_origin(outline[side].normal, outline[side].offset_m);
  }
}

DCEM_INLINE void EdgeCandidates::add_over(const Plane& mirror, const Wedge& edge, const EdgePart& part) {
  const Vec3 along = edge_direction(edge);
  set(mirrored_, mirrored_count_++, mirrored(mirror, edge.start_m),
      along - 2.0 * glm::dot(along, mirror.normal) * mirror.normal, part);
  mirrors_.back().end = mirrored_count_;
}

DCEM_INLINE void EdgeCandidates::fit() {
  direct_.shrink_to_fit();
  mirrored_.shrink_to_fit();
  mirrors_.shrink_to_fit();
}

DCEM_INLINE void EdgeCandidates::set(std::vector<EightCandidates>& all, std::size_t number, const Vec3& start_m,
                                     const Vec3& along, const EdgePart& part) const {
  const std::size_t lane = number % simd_lanes;
  if (lane == 0) all.emplace_back();
  const Vec3 start = start_m - origin_m_;
  set_part(all.back().parts, lane, part, start, along);
  const auto largest = static_cast<float>(glm::length(start)) + std::abs(part.place) + part.distance +
                       std::abs(part.from) + std::abs(part.to);
  all.back().error[lane] = rounding * (largest + 100.0F);
}

DCEM_INLINE CandidateMirror::Plane EdgeCandidates::around_origin(const Vec3& normal, double offset_m) const {
  return {static_cast<float>(normal.x), static_cast<float>(normal.y), static_cast<float>(normal.z),
          static_cast<float>(offset_m - glm::dot(normal, origin_m_))};
}

}  // namespace dcem
