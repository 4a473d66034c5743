#pragma once
/// What receivers side by side light over each of their mirrors, listed by what is lit.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/paths/halves/crowd.hpp"

namespace dcem {

/// A mirror of a crowd, for those of its points that are on one side of it.
struct CrowdMirror {
  FacetId facet;
  double side;    ///< 1 or −1
  Vec3 middle_m;  ///< the image of the crowd's middle, from the origin of the numbers in single precision
  std::span<const HalfSpace> cone;
  std::span<const Vec3> images_m;  ///< of the points, in space
};

/// Holds scratch memory: one per thread.
class CrowdBeams {
 public:
  /// Looks through all mirrors of a crowd, which must stay as it is.
  void look_from(const Scene& scene, const FacetOutlines& outlines, const LaneScene& lanes, const Crowd& crowd,
                 const HalfSettings& settings);

  std::span<const CrowdMirror> mirrors() const { return mirrors_; }
  /// The places of the mirrors over which some point may light a facet …
  std::span<const std::uint32_t> mirrors_before(FacetId facet) const { return pairs_.of(facet.value); }
  /// … or a part of an edge.
  std::span<const std::uint32_t> mirrors_before(WedgeId edge) const { return lit_.of(edge.value); }

 private:
  /// Mirrors by what they light.
  class Lists {
   public:
    void clear() { found_.clear(); }
    void add(std::uint32_t lit, std::uint32_t mirror) { found_.push_back({lit, mirror}); }
    void lay_out(std::size_t count);
    std::span<const std::uint32_t> of(std::size_t lit) const {
      return std::span(mirrors_).subspan(first_[lit], first_[lit + 1] - first_[lit]);
    }

   private:
    std::vector<std::array<std::uint32_t, 2>> found_;
    std::vector<std::uint32_t> first_, mirrors_;
  };

  void take_mirrors(const Scene& scene, const FacetOutlines& outlines, const LaneScene& lanes, const Crowd& crowd);
  void find_lit_edges(const Scene& scene, const FacetOutlines& outlines, const LaneScene& lanes,
                      const HalfSettings& settings, std::uint32_t mirror);
  bool may_light(const Scene& scene, const HalfSettings& settings, const CrowdMirror& mirror, WedgeId id) const;

  Sight sight_{128};
  std::vector<CrowdMirror> mirrors_;
  std::vector<HalfSpace> planes_;
  std::vector<Vec3> images_m_;
  Lists pairs_, lit_;
  std::vector<FacetId> seen_;
  std::vector<WedgeId> edges_;
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/halves/crowd_beams_bodies.hpp"
#endif
