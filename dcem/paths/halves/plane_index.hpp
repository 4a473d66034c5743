#pragma once
/// Which of many planes pass near a point: a city has ten thousands, and a view asks for each point that looks.
///
/// A plane is a point in four dimensions, its normal and its offset. Those that are near each other there stand in
/// eights, and these in groups of eight, each with a box around them: over such a box the distance of a point from the
/// plane is a sum of four intervals.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "dcem/core/ids.hpp"
#include "dcem/core/simd.hpp"
#include "dcem/geometry/plane.hpp"

namespace dcem {

class PlaneIndex {
 public:
  struct Item {
    FacetId facet;
    Plane plane;
    double lift_m;
  };

  /// `middle_m`: of the scene.
  void build(std::span<const Item> items, const Vec3& middle_m);

  /// Calls `visit(facet)` for planes that may be no farther than `times` their lift from a point, or from what is
  /// within `radius_m` of it, and for some more.
  template <typename Visit>
  void for_each_near(const Vec3& point_m, double radius_m, double times, Visit&& visit) const {
    const Numbers at(point_m - middle_m_);
    const auto room = static_cast<float>(radius_m + slack_m(point_m)), share = static_cast<float>(1.001 * times);
    for_each(
        visit, [&](const auto& eight) __attribute__((always_inline)) {
          return simd::absolute(off(eight, at)) <= Float8(eight.lift) * share + room + spread(eight, at);
        });
  }
  /// The same for the nearest point between two.
  template <typename Visit>
  void for_each_between(const Vec3& from_m, const Vec3& to_m, double times, Visit&& visit) const {
    const Numbers from(from_m - middle_m_), to(to_m - middle_m_);
    const auto room = static_cast<float>(std::max(slack_m(from_m), slack_m(to_m))),
               share = static_cast<float>(1.001 * times);
    for_each(
        visit, [&](const auto& eight) __attribute__((always_inline)) {
          const Float8 first = off(eight, from), last = off(eight, to);
          const Float8 reach =
              Float8(eight.lift) * share + room + simd::maximum(spread(eight, from), spread(eight, to));
          return (simd::minimum(first, last) <= reach) & (-reach <= simd::maximum(first, last));
        });
  }

 private:
  using Eight = std::array<float, simd_lanes>;
  /// In single precision, counted from the middle, with the lift; lanes that are left have one that nothing is within.
  struct Planes {
    Eight x{}, y{}, z{}, offset{}, lift{};
  };
  /// Boxes around planes, by their middle.
  struct Boxes : Planes {
    Eight half_x{}, half_y{}, half_z{}, half_offset{};
  };
  struct Numbers {
    float x, y, z;
    explicit Numbers(const Vec3& of)
        : x(static_cast<float>(of.x)), y(static_cast<float>(of.y)), z(static_cast<float>(of.z)) {}
  };
  static constexpr std::size_t group = std::size_t{simd_lanes} * simd_lanes;

  /// How far planes may be off in single precision.
  double slack_m(const Vec3& point_m) const { return 1e-2 + 1e-6 * glm::length(point_m - middle_m_); }
  [[gnu::always_inline]] static Float8 off(const Planes& eight, const Numbers& at) {
    return Float8(eight.x) * at.x + Float8(eight.y) * at.y + Float8(eight.z) * at.z - Float8(eight.offset);
  }
  [[gnu::always_inline]] static Float8 spread(const Planes&, const Numbers&) { return Float8(0.0F); }
  [[gnu::always_inline]] static Float8 spread(const Boxes& eight, const Numbers& at) {
    return Float8(eight.half_x) * std::abs(at.x) + Float8(eight.half_y) * std::abs(at.y) +
           Float8(eight.half_z) * std::abs(at.z) + Float8(eight.half_offset);
  }

  /// Visits those of which `asked(eight)` has lanes, wherever it has their groups and eights, too.
  template <typename Visit, typename Asked>
  void for_each(Visit& visit, Asked&& asked) const {
    const auto for_each_lane = [](std::size_t of, std::uint32_t lanes, auto&& next) __attribute__((always_inline)) {
      for (; lanes != 0; lanes &= lanes - 1) next(of * simd_lanes + static_cast<std::size_t>(std::countr_zero(lanes)));
    };
    for (std::size_t block = 0; block < groups_.size(); ++block) {
      for_each_lane(block, asked(groups_[block]).bits(), [&](std::size_t number) {
        for_each_lane(number, asked(eights_[number]).bits(), [&](std::size_t eight) {
          for_each_lane(eight, asked(planes_[eight]).bits(), [&](std::size_t place) { visit(facets_[place]); });
        });
      });
    }
  }

  using Place = std::array<double, 4>;  ///< normal and offset, as far as a point of the scene feels each
  static void arrange(std::span<std::uint32_t> items, std::span<const Place> places);
  static void set(Planes& planes, std::size_t lane, const Plane& plane, const Vec3& middle_m, double lift_m);
  template <typename Inner>
  static std::vector<Boxes> around(const std::vector<Inner>& inner);

  Vec3 middle_m_{0.0};
  std::vector<Boxes> groups_, eights_;
  std::vector<Planes> planes_;
  std::vector<FacetId> facets_;  ///< of the planes
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/halves/plane_index_bodies.hpp"
#endif
