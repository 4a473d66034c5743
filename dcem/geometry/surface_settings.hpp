#pragma once
/// The two tolerances that turn a triangle soup into surfaces.

namespace dcem {

struct SurfaceSettings {
  /// Vertices closer than this are one vertex, metres. Also how close a device must be to a facet to be mounted on it.
  double weld_tolerance_m = 1e-4;
  /// How far a corner may lie from its neighbour's plane for both to be one facet, metres.
  double planarity_tolerance_m = 1e-3;
};

}  // namespace dcem
