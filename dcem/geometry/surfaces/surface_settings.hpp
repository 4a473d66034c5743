#pragma once
/// The two tolerances that turn a triangle soup into surfaces.
#include <stdexcept>

namespace dcem {

struct SurfaceSettings {
  /// Vertices no further apart than this are one vertex, metres, 1e-9 to 1. Also how close a device must be to a facet
  /// to be mounted on it.
  double weld_tolerance_m = 1e-4;
  /// How far a corner may lie from its neighbour's plane for both to be one facet, metres, 1e-9 to 1.
  double planarity_tolerance_m = 1e-3;
};

/// Throws std::invalid_argument where a tolerance is out of range. Below a nanometre coordinates of a city have no
/// digits left; above a metre walls melt into each other.
inline void validate(const SurfaceSettings& settings) {
  const auto in_range = [](double tolerance_m) { return tolerance_m >= 1e-9 && tolerance_m <= 1.0; };
  if (!in_range(settings.weld_tolerance_m)) throw std::invalid_argument("weld_tolerance_m: expected 1e-9 to 1");
  if (!in_range(settings.planarity_tolerance_m))
    throw std::invalid_argument("planarity_tolerance_m: expected 1e-9 to 1");
}

namespace detail {

/// Normals of one facet differ by less than this from triangle to triangle.
inline constexpr double coplanar_cosine = 0.99999847691328769880;  // cos(0.1°)

/// A coplanar set may stray this many planarity tolerances from its mean plane before it falls back to its triangles.
inline constexpr double stray_tolerances = 5.0;

}  // namespace detail

}  // namespace dcem
