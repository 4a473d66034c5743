#pragma once
/// A hit of a ray on a triangle, and which hits count.
#include <array>
#include <concepts>
#include <cstdint>
#include <limits>
#include <span>

#include "dcem/geometry/ray.hpp"
#include "dcem/geometry/vector.hpp"

namespace dcem {

/// Where a ray meets a triangle.
struct TriangleHit {
  double t = 0.0;  ///< where it meets the triangle's plane, in units of the ray's direction
  std::uint32_t triangle = 0xffffffffU;

  friend bool operator==(const TriangleHit&, const TriangleHit&) = default;
};

/// Which hits of one ray count. By default all do.
///
/// A function is asked about a hit only where it may refuse: the caller says from where to where it surely does not. A
/// leg that leaves a wall, for instance, may ignore what it meets on that wall, and so within a hair of its beginning;
/// whatever it meets beyond that blocks it, and the tree need not ask, nor work out exactly where that is.
struct HitFilter {
  static constexpr std::uint32_t no_object = 0xffffffffU;

  /// A hit with sure_from < t < sure_to counts without being asked about (units of the ray's direction). To be rounded
  /// towards each other: what is asked about for nothing is only slower.
  float sure_from = -std::numeric_limits<float>::infinity();
  float sure_to = std::numeric_limits<float>::infinity();
  /// Whether any other hit counts. Called with the number of a triangle and its exact t. Null: it does.
  bool (*counts)(const void* context, const TriangleHit& hit) = nullptr;
  const void* context = nullptr;
  /// Triangles of these objects are not there.
  std::array<std::uint32_t, 2> ignored_objects{no_object, no_object};

  bool is_sure(double first, double last) const { return first > sure_from && last < sure_to; }
  bool passes(const TriangleHit& hit) const {
    return is_sure(hit.t, hit.t) || counts == nullptr || counts(context, hit);
  }
  bool ignores(std::uint32_t object) const { return object == ignored_objects[0] || object == ignored_objects[1]; }
};

/// The filter that asks `counts(hit) -> bool` about every hit. The function must outlive the filter.
template <std::predicate<const TriangleHit&> Counts>
HitFilter filter_by(const Counts& counts) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  return {infinity,
          -infinity,
          [](const void* context, const TriangleHit& hit) { return (*static_cast<const Counts*>(context))(hit); },
          &counts,
          {HitFilter::no_object, HitFilter::no_object}};
}

/// One ray of many, with its own filter.
struct alignas(32) RayQuery {
  Ray<double> ray;
  HitFilter filter{};
};

/// Rays from one point without end, with one filter for all of them: 24 bytes a ray instead of the 96 of a `RayQuery`.
/// Fastest where those that point in similar directions follow one another. What it refers to must outlive the
/// question.
struct RayFan {
  Vec3 origin{0.0};
  std::span<const Vec3> directions;  ///< of any length; t, that of the filter too, is in units of each ray's own
  HitFilter filter{};
};

namespace detail {

/// Is shown every hit; true: no more.
struct HitVisitor {
  bool (*visit)(void* context, const TriangleHit& hit);
  void* context;

  bool operator()(const TriangleHit& hit) const { return visit(context, hit); }
};

}  // namespace detail

}  // namespace dcem
