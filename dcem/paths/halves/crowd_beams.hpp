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
    void lay_out(std::size_t count) {
      first_.assign(count + 1, 0);
      for (const auto& pair : found_) ++first_[pair[0] + 1];
      for (std::size_t lit = 1; lit < first_.size(); ++lit) first_[lit] += first_[lit - 1];
      std::ranges::stable_sort(found_, {}, [](const auto& pair) { return pair[0]; });
      mirrors_.clear();
      for (const auto& pair : found_) mirrors_.push_back(pair[1]);
    }
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

// ---------------------------------------------------------------------------------------------------------------------

inline void CrowdBeams::look_from(const Scene& scene, const FacetOutlines& outlines, const LaneScene& lanes,
                                  const Crowd& crowd, const HalfSettings& settings) {
  take_mirrors(scene, outlines, lanes, crowd);
  pairs_.clear();
  lit_.clear();
  for (std::uint32_t place = 0; place < mirrors_.size(); ++place) {
    sight_.look_through(scene, outlines, mirrors_[place].facet, mirrors_[place].images_m);
    sight_.find_facets(scene, outlines, settings, true, seen_);
    for (const FacetId seen : seen_) pairs_.add(seen.value, place);
    if (settings.edges) find_lit_edges(scene, outlines, lanes, settings, place);
  }
  pairs_.lay_out(scene.facets().size());
  lit_.lay_out(scene.wedges().size());
}

inline void CrowdBeams::take_mirrors(const Scene& scene, const FacetOutlines& outlines, const LaneScene& lanes,
                                     const Crowd& crowd) {
  struct Extent {
    std::size_t first_plane, first_image;
  };
  std::vector<Extent> extents;
  std::vector<HalfSpace> cone;
  std::vector<Vec3> points_m;
  mirrors_.clear();
  planes_.clear();
  images_m_.clear();
  for (const SeenLayer& layer : crowd.layers()) {
    for (const FacetId facet : layer.mirrors) {
      const Plane& plane = scene.facet(facet).plane;
      for (const double side : {1.0, -1.0}) {
        if (!crowd.cone(outlines, facet, plane, side, cone)) continue;
        crowd.points_beside(plane, side, points_m);
        extents.push_back({planes_.size(), images_m_.size()});
        planes_.insert(planes_.end(), cone.begin(), cone.end());
        for (const Vec3& point_m : points_m) images_m_.push_back(mirrored(plane, point_m));
        const Vec3 middle_m = mirrored(plane, crowd.sight().position_m()) - lanes.origin_m();
        mirrors_.push_back({facet, side, middle_m, {}, {}});
      }
    }
  }
  extents.push_back({planes_.size(), images_m_.size()});
  for (std::size_t place = 0; place < mirrors_.size(); ++place) {
    const auto [plane, image] = extents[place];
    mirrors_[place].cone = std::span(planes_).subspan(plane, extents[place + 1].first_plane - plane);
    mirrors_[place].images_m = std::span(images_m_).subspan(image, extents[place + 1].first_image - image);
  }
}

/// Of the edges of what has been seen through a mirror, those of which a part may be.
inline void CrowdBeams::find_lit_edges(const Scene& scene, const FacetOutlines& outlines, const LaneScene& lanes,
                                       const HalfSettings& settings, std::uint32_t mirror) {
  edges_.clear();
  for (const FacetId seen : seen_) {
    for (const WedgeId id : scene.wedges_of_facet(seen)) edges_.push_back(id);
  }
  std::ranges::sort(edges_);
  edges_.erase(std::unique(edges_.begin(), edges_.end()), edges_.end());
  for (const WedgeId id : edges_) {
    if (!may_light(scene, settings, mirrors_[mirror], id)) continue;
    const Wedge& edge = scene.wedge(id).edge;
    EdgePart part = whole_edge(id.value, edge, sight_.position_m());
    cut_to_cone(part, edge, lanes.origin_m(), mirrors_[mirror].cone);
    if (part.from > part.to) continue;
    const Vec3 direction = edge_direction(edge);
    const Vec3 from_m = edge.start_m + static_cast<double>(part.from) * direction;
    const Vec3 to_m = edge.start_m + static_cast<double>(part.to) * direction;
    if (sight_.shows(scene, outlines, id, from_m, to_m)) lit_.add(id.value, mirror);
  }
}

inline bool CrowdBeams::may_light(const Scene& scene, const HalfSettings& settings, const CrowdMirror& mirror,
                                  WedgeId id) const {
  const WorldWedge& wedge = scene.wedge(id);
  if (!diffracts(wedge, settings.rules) || is_embedded(id, settings.rules)) return false;
  if (wedge.facets[0] == mirror.facet || wedge.facets[1] == mirror.facet) return false;  // in the wedge's own terms
  return std::ranges::any_of(mirror.images_m,
                             [&](const Vec3& image_m) { return may_face(wedge.edge, image_m - wedge.edge.start_m); });
}

}  // namespace dcem
