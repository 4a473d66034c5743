#pragma once
/// What receivers side by side light over each of their mirrors, listed by what is lit.
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/paths/halves/crowd.hpp"
#include "dcem/paths/halves/shared_beams.hpp"

namespace dcem {

/// A mirror of a crowd, for those of its points that are on one side of it.
struct CrowdMirror : SharedMirror {
  double side;    ///< 1 or −1
  Vec3 middle_m;  ///< the image of the crowd's middle, from the origin of the numbers in single precision
};

/// Holds scratch memory: one per thread.
class CrowdBeams {
 public:
  /// Looks through all mirrors of a crowd, which must stay as it is.
  void look_from(const Scene& scene, const FacetOutlines& outlines, const LaneScene& lanes, const Crowd& crowd,
                 const HalfSettings& settings);

  std::span<const CrowdMirror> mirrors() const { return mirrors_; }
  /// The places of the mirrors over which some point may light a facet …
  std::span<const std::uint32_t> mirrors_before(FacetId facet) const { return beams_.mirrors_before(facet); }
  /// … or a part of an edge.
  std::span<const std::uint32_t> mirrors_before(WedgeId edge) const { return beams_.mirrors_before(edge); }

 private:
  void take_mirrors(const Scene& scene, const FacetOutlines& outlines, const LaneScene& lanes, const Crowd& crowd);

  std::vector<CrowdMirror> mirrors_;
  std::vector<HalfSpace> planes_;
  std::vector<Vec3> images_m_;
  SharedBeams beams_;
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/halves/crowd_beams_bodies.hpp"
#endif
