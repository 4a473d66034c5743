#pragma once
/// Ways over one edge, from a place to an end that stands or to its image: many of them, asked eight at a time which a
/// device at a point of the place may take.
///
/// Directly, or over a mirror next to the device: then the edge is mirrored, and the way from the device to the
/// mirrored edge must cross the mirror. All in single precision around the middle of the place; each number carries how
/// far it may be off.
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/core/simd.hpp"
#include "dcem/paths/halves/edge_parts.hpp"
#include "dcem/paths/halves/facet_outlines.hpp"

namespace dcem {

class EdgeCandidates {
 public:
  explicit EdgeCandidates(const Vec3& origin_m) : origin_m_(origin_m) {}

  /// A part of an edge as the standing end, or its image, sees it.
  void add(const Wedge& edge, const EdgePart& part) {
    Pack& pack = next(direct_, direct_count_++);
    set(pack, (direct_count_ - 1) % simd_lanes, edge.start_m, edge_direction(edge), part);
  }
  /// The same over a mirror.
  void add(const Wedge& edge, const EdgePart& part, const Plane& mirror, std::span<const HullSide> outline) {
    MirrorPack& pack = next(mirrored_, mirrored_count_++);
    const std::size_t lane = (mirrored_count_ - 1) % simd_lanes;
    const Vec3 along = edge_direction(edge);
    set(pack.edges, lane, mirrored(mirror, edge.start_m), along - 2.0 * glm::dot(along, mirror.normal) * mirror.normal,
        part);
    set(pack.plane, lane, mirror.normal, glm::dot(mirror.normal, mirror.point_m - origin_m_));
    for (std::size_t side = 0; side < std::min(outline.size(), pack.sides.size()); ++side) {
      set(pack.sides[side], lane, outline[side].normal,
          outline[side].offset_m - glm::dot(outline[side].normal, origin_m_));
    }
  }

  /// Nothing more is added: gives back room for it.
  void fit() {
    direct_.shrink_to_fit();
    mirrored_.shrink_to_fit();
  }

  std::size_t direct_count() const { return direct_count_; }
  std::size_t mirrored_count() const { return mirrored_count_; }

  /// Calls `visit(number)` for those added without a mirror, in the order in which they were, that a device at a point
  /// may take.
  template <typename Visit>
  void for_each_direct(const Vec3& point_m, Visit&& visit) const {
    const Point point(point_m - origin_m_);
    for (std::size_t pack = 0; pack < direct_.size(); ++pack) {
      pass(direct_[pack].meet(point).lanes, pack, direct_count_, visit);
    }
  }
  /// The same of those over mirrors.
  template <typename Visit>
  void for_each_mirrored(const Vec3& point_m, Visit&& visit) const {
    const Point point(point_m - origin_m_);
    for (std::size_t pack = 0; pack < mirrored_.size(); ++pack) {
      pass(mirrored_[pack].meet(point), pack, mirrored_count_, visit);
    }
  }

 private:
  using Lanes = EightFloats;
  /// Eight times normal·x − offset.
  struct PlaneLanes {
    std::array<Lanes, 3> normal{};
    Lanes offset{};
  };
  struct Point {
    float x, y, z;
    explicit Point(const Vec3& at)
        : x(static_cast<float>(at.x)), y(static_cast<float>(at.y)), z(static_cast<float>(at.z)) {}
  };
  struct Met {
    Float8 x, y, z, error;
    std::uint32_t lanes;
  };
  static constexpr float beside_m = 2e-3F;  ///< points this far beside an edge or a mirror are left to the solver
  static constexpr float rounding =
      1.6e-6F;  ///< of the largest number: four sums of four numbers, each rounded to 6e-8

  struct Pack {
    EightParts parts;
    Lanes error{};

    Met meet(const Point& point) const {
      const Float8 sx(parts.start[0]), sy(parts.start[1]), sz(parts.start[2]);
      const Float8 dx = Float8(point.x) - sx, dy = Float8(point.y) - sy, dz = Float8(point.z) - sz;
      const Float8 ex(parts.direction[0]), ey(parts.direction[1]), ez(parts.direction[2]);
      const Float8 own_place(parts.place), own_distance(parts.distance);
      const Float8 at = dx * ex + dy * ey + dz * ez;
      const Float8 x = dx - at * ex, y = dy - at * ey, z = dz - at * ez;
      const Float8 sum = own_distance + simd::square_root(x * x + y * y + z * z);
      const Float8 between = at - own_place, inverse = Float8(1.0F) / sum;
      const Float8 met = own_place + between * (own_distance * inverse);
      const Float8 off = Float8(error) * (Float8(1.0F) + simd::absolute(between) * inverse);
      const Float8 room = off + beside_m;
      // Asked for so that NaN, of both ends on the edge's line, passes.
      const std::uint32_t out = ((met + room < Float8(parts.from)) | (Float8(parts.to) + room < met)).bits();
      return {sx + met * ex, sy + met * ey, sz + met * ez, off, ~out & 0xffU};
    }
  };

  struct MirrorPack {
    Pack edges;
    PlaneLanes plane;
    std::array<PlaneLanes, 4> sides;

    /// With p and q the distances of device and mirrored point from the mirror, and s and t those inside a side, the
    /// way crosses the mirror inside the side where s |q| + t |p| ≥ 0.
    std::uint32_t meet(const Point& point) const {
      const Met met = edges.meet(point);
      std::uint32_t left = met.lanes;
      if (left == 0) return 0;
      const auto at_point = [&](const PlaneLanes& of) {
        return Float8(of.normal[0]) * point.x + Float8(of.normal[1]) * point.y + Float8(of.normal[2]) * point.z -
               Float8(of.offset);
      };
      const auto at_met = [&](const PlaneLanes& of) {
        return Float8(of.normal[0]) * met.x + Float8(of.normal[1]) * met.y + Float8(of.normal[2]) * met.z -
               Float8(of.offset);
      };
      const Float8 own = at_point(plane), other = at_met(plane), error = met.error;
      left &= ~(((error < own) & (error < other)) | ((own < -error) & (other < -error))).bits();
      const Float8 p = simd::absolute(own) + error, q = simd::absolute(other) + error,
                   room = (error + beside_m) * (p + q);
      for (const PlaneLanes& side : sides) {
        if (left == 0) break;
        const Float8 s = at_point(side), t = at_met(side);
        const Float8 inside = s * q + t * p + room + error * (simd::absolute(s) + simd::absolute(t)) * 2.0F;
        left &= ~(inside < Float8(0.0F)).bits();
      }
      return left;
    }
  };

  template <typename Of>
  static Of& next(std::vector<Of>& packs, std::size_t number) {
    if (number % simd_lanes == 0) packs.emplace_back();
    return packs.back();
  }
  void set(Pack& pack, std::size_t lane, const Vec3& start_m, const Vec3& along, const EdgePart& part) const {
    const Vec3 start = start_m - origin_m_;
    set_part(pack.parts, lane, part, start, along);
    const auto largest = static_cast<float>(glm::length(start)) + std::abs(part.place) + part.distance +
                         std::abs(part.from) + std::abs(part.to);
    pack.error[lane] = rounding * (largest + 100.0F);
  }
  static void set(PlaneLanes& lanes, std::size_t lane, const Vec3& normal, double offset) {
    for (int axis = 0; axis < 3; ++axis) {
      lanes.normal[static_cast<std::size_t>(axis)][lane] = static_cast<float>(normal[axis]);
    }
    lanes.offset[lane] = static_cast<float>(offset);
  }
  template <typename Visit>
  static void pass(std::uint32_t lanes, std::size_t pack, std::size_t count, Visit& visit) {
    for (; lanes != 0; lanes &= lanes - 1) {
      const std::size_t number = pack * simd_lanes + static_cast<std::size_t>(std::countr_zero(lanes));
      if (number < count) visit(number);
    }
  }

  Vec3 origin_m_;
  std::vector<Pack> direct_;
  std::vector<MirrorPack> mirrored_;
  std::size_t direct_count_ = 0, mirrored_count_ = 0;
};

}  // namespace dcem
