#pragma once
/// What certainly stands between an end of a link and a whole tile of a surface.
///
/// A triangle that the segments from a point to all three corners of a tile cross hides the whole tile from that point:
/// what lies behind a convex patch, seen from a point, is convex. Corners are looked at once and remembered, so a tile
/// that is halved costs one new look.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

#include "dcem/core/random.hpp"
#include "dcem/geometry/adaptive_tiles.hpp"
#include "dcem/paths/link_end.hpp"
#include "dcem/paths/scene_tracer.hpp"

namespace dcem {

/// For the tiles of one link. The ends and the tracer must outlive it.
template <typename Tree>
class TileSight {
 public:
  TileSight(const SceneTracer<Tree>& tracer, const LinkEnd& transmitter, const LinkEnd& receiver)
      : tracer_(tracer), ends_{&transmitter, &receiver}, ignored_{transmitter.ignored_body, receiver.ignored_body} {}

  /// The sheets that every path over the tile crosses, each once. False where an opaque facet hides the tile from one
  /// of the ends. The tile's source is its triangle.
  bool crossed_by_all(const Tile& tile, std::vector<FacetId>& sheets, TraversalCounters& counters) {
    sheets.clear();
    const std::array<std::size_t, 3> corners{look_at(tile.corners_m[0], tile.source, counters),
                                             look_at(tile.corners_m[1], tile.source, counters),
                                             look_at(tile.corners_m[2], tile.source, counters)};
    return add_common(corners, 0, sheets) && add_common(corners, 1, sheets);
  }

 private:
  struct Blocker {
    std::uint32_t triangle;
    double t;  ///< along the segment from the end to the corner
  };
  using Blockers = std::vector<Blocker>;  ///< by triangle

  struct Corner {
    Vec3 point_m;
    FacetId facet;
    friend bool operator==(const Corner&, const Corner&) = default;
  };
  struct CornerHash {
    std::size_t operator()(const Corner& corner) const noexcept {
      const auto bits = [](double value) { return std::bit_cast<std::uint64_t>(value); };
      return static_cast<std::size_t>(
          hash_values(bits(corner.point_m.x), bits(corner.point_m.y), bits(corner.point_m.z), corner.facet.value));
    }
  };

  std::size_t look_at(const Vec3& corner_m, std::uint32_t source, TraversalCounters& counters) {
    const FacetId facet = tracer_.scene().facet_of_triangle(source);
    const auto [entry, is_new] = known_.try_emplace(Corner{corner_m, facet}, sights_.size());
    if (is_new) {
      sights_.push_back(
          {blockers(*ends_[0], corner_m, facet, counters), blockers(*ends_[1], corner_m, facet, counters)});
    }
    return entry->second;
  }

  Blockers blockers(const LinkEnd& end, const Vec3& corner_m, FacetId facet, TraversalCounters& counters) const {
    const Plane* plane = &tracer_.scene().facet(facet).plane;
    const std::array<FacetId, 1> facets{facet};
    Blockers found;
    tracer_.triangles_between(
        end.position_m, corner_m, {end.mounted_on, {}}, {facets, {plane, plane}}, ignored_,
        [&](std::uint32_t triangle, double t) {
          found.push_back({triangle, t});
        },
        counters);
    std::sort(found.begin(), found.end(), [](const Blocker& a, const Blocker& b) { return a.triangle < b.triangle; });
    return found;
  }

  /// Adds the sheets between one end and all corners; false where one of them is opaque.
  bool add_common(const std::array<std::size_t, 3>& corners, std::size_t end, std::vector<FacetId>& sheets) {
    common_.clear();
    for (const Blocker& blocker : sights_[corners[0]][end]) {
      const bool hides_all =
          contains(sights_[corners[1]][end], blocker.triangle) && contains(sights_[corners[2]][end], blocker.triangle);
      if (hides_all) common_.push_back(blocker);
    }
    std::sort(common_.begin(), common_.end(), [](const Blocker& a, const Blocker& b) { return a.t < b.t; });
    const std::size_t first = sheets.size();
    for (const Blocker& blocker : common_) {
      const FacetId facet = tracer_.scene().facet_of_triangle(blocker.triangle);
      if (!tracer_.scene().facet(facet).transmits) return false;
      // Parallel sheets might lie on top of each other, and then count once; so they count once here.
      const bool may_be_one = std::any_of(sheets.begin() + static_cast<std::ptrdiff_t>(first), sheets.end(),
                                          [&](FacetId other) { return tracer_.parallel(other, facet); });
      if (!may_be_one) sheets.push_back(facet);
    }
    return true;
  }

  static bool contains(const Blockers& blockers, std::uint32_t triangle) {
    const auto at =
        std::lower_bound(blockers.begin(), blockers.end(), triangle,
                         [](const Blocker& blocker, std::uint32_t value) { return blocker.triangle < value; });
    return at != blockers.end() && at->triangle == triangle;
  }

  const SceneTracer<Tree>& tracer_;
  std::array<const LinkEnd*, 2> ends_;
  IgnoredBodies ignored_;
  std::vector<std::array<Blockers, 2>> sights_;
  std::unordered_map<Corner, std::size_t, CornerHash> known_;
  Blockers common_;
};

}  // namespace dcem
