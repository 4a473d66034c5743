#pragma once
/// What several points side by side, or all of a box, light over each of their mirrors, listed by what is lit.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/paths/halves/sight.hpp"

namespace dcem {

/// A mirror, for those of the points that are on one side of it.
struct SharedMirror {
  FacetId facet;
  std::span<const HalfSpace> cone;  ///< what any of them may see through it
  std::span<const Vec3> images_m;   ///< of the points, in space
};

/// Holds scratch memory: one per thread.
class SharedBeams {
 public:
  /// From now on mirrors are looked through for other points: for these alone, or for `all_between`, too: for the
  /// convex body of which they are the corners.
  void begin(bool all_between);
  /// Looks through a mirror, the place of which is noted; `bodies`: at what moves, too. The cone counts from
  /// `origin_m`.
  void look_through(const Scene& scene, const FacetOutlines& outlines, const Vec3& origin_m,
                    const HalfSettings& settings, const SharedMirror& mirror, std::uint32_t place, bool bodies) {
    find_lit_facets(scene, outlines, settings, mirror, place, bodies);
    find_lit_edges(scene, outlines, origin_m, settings, mirror, place);
  }
  /// The same in two parts, the first of which takes three times as long.
  void find_lit_facets(const Scene& scene, const FacetOutlines& outlines, const HalfSettings& settings,
                       const SharedMirror& mirror, std::uint32_t place, bool bodies);
  void find_lit_edges(const Scene& scene, const FacetOutlines& outlines, const Vec3& origin_m,
                      const HalfSettings& settings, const SharedMirror& mirror, std::uint32_t place);
  /// All mirrors have been looked through.
  void lay_out(const Scene& scene);
  /// What has been found stays, room to look is given back.
  void fit();

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
    void fit() {
      found_ = {};
      mirrors_.shrink_to_fit();
    }
    std::span<const std::uint32_t> of(std::size_t lit) const {
      return std::span(mirrors_).subspan(first_[lit], first_[lit + 1] - first_[lit]);
    }

   private:
    std::vector<std::array<std::uint32_t, 2>> found_;
    std::vector<std::uint32_t> first_, mirrors_;
  };

  static bool may_light(const Scene& scene, const HalfSettings& settings, const SharedMirror& mirror, WedgeId id);

  static constexpr int view_pixels = 128;
  Sight sight_{view_pixels};
  bool all_between_ = false;
  Lists pairs_, lit_;
  std::vector<FacetId> seen_;
  std::vector<WedgeId> edges_;
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/halves/shared_beams_bodies.hpp"
#endif
