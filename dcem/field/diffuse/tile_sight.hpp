#pragma once
/// What certainly stands between an end of a link and a whole tile of a surface.
///
/// A triangle that the segments from a point to all three corners of a tile cross hides the whole tile from that point:
/// what lies behind a convex patch, seen from a point, is convex.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "dcem/field/diffuse/adaptive_tiles.hpp"
#include "dcem/paths/query/link_end.hpp"
#include "dcem/paths/query/scene_tracer.hpp"

namespace dcem {

/// For the tiles of one link, whose sources are triangles of the scene. The ends and the tracer must outlive it.
template <typename Index>
class TileSight {
 public:
  TileSight(const SceneTracer<Index>& tracer, const LinkEnd& transmitter, const LinkEnd& receiver)
      : tracer_(tracer), ends_{&transmitter, &receiver}, ignored_{transmitter.ignored_body, receiver.ignored_body} {}

  /// The sheets that every path over the tile crosses, each once. False where an opaque triangle hides the tile from
  /// one of the ends.
  bool crossed_by_all(const Tile& tile, std::vector<FacetId>& sheets, TraversalCounters& counters) const {
    sheets.clear();
    return add_sheets(*ends_[0], tile, sheets, counters) && add_sheets(*ends_[1], tile, sheets, counters);
  }

 private:
  /// Adds the sheets between one end and the tile; false where something opaque hides it.
  bool add_sheets(const LinkEnd& end, const Tile& tile, std::vector<FacetId>& sheets,
                  TraversalCounters& counters) const {
    const Scene& scene = tracer_.scene();
    const std::array<FacetId, 1> facets{scene.facet_of_triangle(tile.source)};
    const Plane* plane = &scene.facet(facets[0]).plane;
    const std::array<WatertightRay, 3> corners{WatertightRay(segment_between(end.position_m, tile.corners_m[0])),
                                               WatertightRay(segment_between(end.position_m, tile.corners_m[1])),
                                               WatertightRay(segment_between(end.position_m, tile.corners_m[2]))};
    const auto hides_all = [&](std::uint32_t triangle) {
      return std::all_of(corners.begin(), corners.end(), [&](const WatertightRay& corner) {
        const std::optional<double> t = corner.intersect(scene.corners_m(triangle));
        return t && *t >= 0.0 && *t <= 1.0;
      });
    };
    const std::size_t first = sheets.size();
    const bool hidden = tracer_.any_triangle_between(
        end.position_m, tile.centroid_m(), {end.mounted_on, {}}, {facets, {plane, plane}}, ignored_,
        [&](std::uint32_t triangle) {
          if (!hides_all(triangle)) return false;
          const FacetId facet = scene.facet_of_triangle(triangle);
          if (!scene.facet(facet).transmits) return true;
          // Parallel sheets might lie on top of each other, and then count once; so they count once here.
          const bool may_be_one = std::any_of(sheets.begin() + static_cast<std::ptrdiff_t>(first), sheets.end(),
                                              [&](FacetId other) { return tracer_.parallel(other, facet); });
          if (!may_be_one) sheets.push_back(facet);
          return false;
        },
        counters);
    return !hidden;
  }

  const SceneTracer<Index>& tracer_;
  std::array<const LinkEnd*, 2> ends_;
  IgnoredBodies ignored_;
};

}  // namespace dcem
