#pragma once
/// Ways over one edge, from a place to an end that stands or to its image: many of them, asked eight at a time which a
/// device at a point of the place may take.
///
/// Directly, or over a mirror next to the device: then the edge is mirrored, and the way from the device to the
/// mirrored edge must cross the mirror. All in single precision around the middle of the place; each number carries how
/// far it may be off.
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/paths/halves/edge_parts.hpp"
#include "dcem/paths/halves/facet_outlines.hpp"
#include "dcem/paths/memory/candidate_kernels.hpp"

namespace dcem {

class EdgeCandidates {
 public:
  explicit EdgeCandidates(const Vec3& origin_m) : origin_m_(origin_m) {}

  /// A part of an edge as the standing end, or its image, sees it.
  void add(const Wedge& edge, const EdgePart& part);

  /// What is added over a mirror from now on is over this one.
  void begin_mirror(const Plane& mirror, std::span<const HullSide> outline);
  /// A part of an edge, over the mirror that was begun last.
  void add_over(const Plane& mirror, const Wedge& edge, const EdgePart& part);

  /// Nothing more is added: gives back room for it.
  void fit();

  std::size_t direct_count() const { return direct_count_; }
  std::size_t mirrored_count() const { return mirrored_count_; }

  /// Calls `visit(number)` for those added without a mirror, in the order in which they were, that a device at a point
  /// may take.
  template <typename Visit>
  void for_each_direct(const Vec3& point_m, Visit&& visit) const {
    const auto pass = passing(direct_count_, visit);
    detail::candidate_kernels().over_edges(direct_, around_origin(point_m), told_to(pass));
  }
  /// The same of those over mirrors.
  template <typename Visit>
  void for_each_mirrored(const Vec3& point_m, Visit&& visit) const {
    const auto pass = passing(mirrored_count_, visit);
    detail::candidate_kernels().over_mirrors(mirrored_, mirrors_, around_origin(point_m), told_to(pass));
  }

 private:
  /// Of the largest number: four sums of four numbers, each rounded to 6e-8.
  static constexpr float rounding = 1.6e-6F;

  void set(std::vector<EightCandidates>& all, std::size_t number, const Vec3& start_m, const Vec3& along,
           const EdgePart& part) const;
  CandidateMirror::Plane around_origin(const Vec3& normal, double offset_m) const;
  CandidatePoint around_origin(const Vec3& point_m) const {
    const Vec3 at = point_m - origin_m_;
    return {static_cast<float>(at.x), static_cast<float>(at.y), static_cast<float>(at.z)};
  }
  /// Of the last eight some may stand for nothing.
  template <typename Visit>
  static auto passing(std::size_t count, Visit& visit) {
    return [count, &visit](std::size_t first, std::uint32_t lanes) {
      for (; lanes != 0; lanes &= lanes - 1) {
        const std::size_t number = first + static_cast<std::size_t>(std::countr_zero(lanes));
        if (number < count) visit(number);
      }
    };
  }

  Vec3 origin_m_;
  std::vector<EightCandidates> direct_, mirrored_;
  std::vector<CandidateMirror> mirrors_;
  std::size_t direct_count_ = 0, mirrored_count_ = 0;
  std::size_t last_begins_at_ = 0;  ///< the number of the first candidate over the last mirror
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/memory/edge_candidates_bodies.hpp"
#endif
