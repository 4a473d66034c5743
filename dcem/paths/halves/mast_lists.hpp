#pragma once
/// What a transmitter reaches, laid out for many receivers: worked out once, used by all.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "dcem/paths/halves/lanes.hpp"
#include "dcem/paths/halves/path_half.hpp"
#include "dcem/paths/solve/edge_rules.hpp"

namespace dcem {

/// Of scenery and bodies alike: they stand still meanwhile.
class MastLists {
 public:
  /// A mirror of the transmitter, and the image in it.
  struct Mirror {
    FacetId facet;
    Vec3 image_m;  ///< from the scene's origin
    std::span<const HalfSpace> cone;
  };

  static constexpr std::uint32_t nothing = 0xffffffffU;

  /// `half` must stay as it is. `both`: look for ways over a mirror and an edge.
  MastLists(const Scene& scene, const FacetOutlines& outlines, const LaneScene& lanes, const PathHalf& half,
            const EdgeRules& rules, bool both);

  const PathHalf& half() const { return half_; }
  const Vec3& position_m() const { return position_m_; }
  /// The body that the transmitter rides on.
  const std::optional<BodyId>& ignored_body() const { return half_.sight().ignored_body(); }
  std::span<const Mirror> mirrors() const { return mirrors_; }
  /// The place of a facet among the mirrors, or `nothing`.
  std::uint32_t mirror_of(FacetId facet) const { return mirror_of_[facet.value]; }
  /// The parts of edges that the transmitter may see, edge by edge; `EdgePart::edge` is the number of a wedge.
  std::span<const EdgePart> parts() const { return parts_; }
  std::span<const EdgePart> parts_of(WedgeId edge) const {
    return std::span(parts_).subspan(first_part_[edge.value], first_part_[edge.value + 1] - first_part_[edge.value]);
  }

  /// Calls `visit(mirror)` for mirrors whose image may lie in a cone and that may see a point through the
  /// mirror, or what is within `radius_m` of it.
  template <typename Visit>
  void for_each_image_in(std::span<const HalfSpace> cone, const Vec3& point_m, float radius_m, Visit&& visit) const {
    for (std::size_t layer = 0; layer < first_mirror_.size(); ++layer) {
      half_.layers()[layer].for_each_image_in(cone, point_m, radius_m,
                                              [&](std::uint32_t mirror) { visit(first_mirror_[layer] + mirror); });
    }
  }
  /// Calls `visit(part)` for parts on which the point that diffracts between the transmitter and an apex may lie in a
  /// cone, for the apex at `apex` or within `radius_m` of it.
  template <typename Visit>
  void for_each_part_in(std::span<const HalfSpace> cone, const Vec3& apex, float radius_m, Visit&& visit) const {
    part_clusters_.for_each_in(cone, apex, radius_m, visit);
  }
  /// Calls `visit(part, mirror)` for the parts of an edge that mirrors may light, where the point that diffracts
  /// towards `point`, or what is within `radius_m` of it, may lie on the part.
  template <typename Visit>
  void for_each_lit_part(WedgeId edge, const LaneEdge& line, const Vec3& point, float radius_m, Visit&& visit) const;

 private:
  using Lanes = std::array<float, simd_lanes>;
  /// Eight parts of one edge, each lit by the image in a mirror.
  struct LitLanes {
    Lanes from{}, to{}, place{}, distance{};
    std::array<std::uint32_t, simd_lanes> mirror{};
  };

  void lay_out_parts(const Scene& scene, const FacetOutlines& outlines, const LaneScene& lanes);
  void list_lit_parts(const Scene& scene, const LaneScene& lanes, const EdgeRules& rules);
  EdgePart lit_part(const Scene& scene, const LaneScene& lanes, WedgeId edge, std::uint32_t mirror) const;

  const PathHalf& half_;
  Vec3 position_m_;
  std::vector<Mirror> mirrors_;
  std::vector<std::uint32_t> mirror_of_;
  std::vector<std::uint32_t> first_mirror_;  ///< of each layer
  std::vector<EdgePart> parts_;
  std::vector<std::size_t> first_part_, first_lit_;
  EdgeClusters part_clusters_;
  std::vector<LitLanes> lit_;
};

// ---------------------------------------------------------------------------------------------------------------------

inline MastLists::MastLists(const Scene& scene, const FacetOutlines& outlines, const LaneScene& lanes,
                            const PathHalf& half, const EdgeRules& rules, bool both)
    : half_(half), position_m_(half.position_m() - lanes.origin_m()), mirror_of_(scene.facets().size(), nothing) {
  for (const HalfLayer& layer : half.layers()) {
    first_mirror_.push_back(static_cast<std::uint32_t>(mirrors_.size()));
    for (std::size_t at = 0; at < layer.mirrors.size(); ++at) {
      mirror_of_[layer.mirrors[at].value] = static_cast<std::uint32_t>(mirrors_.size());
      mirrors_.push_back({layer.mirrors[at], layer.images_m[at] - lanes.origin_m(), layer.cones[at]});
    }
  }
  lay_out_parts(scene, outlines, lanes);
  first_lit_.assign(scene.wedges().size() + 1, 0);
  if (both) list_lit_parts(scene, lanes, rules);
}

/// Pieces of an edge, half a metre long, are looked up one by one; neighbours that show make one part.
inline void MastLists::lay_out_parts(const Scene& scene, const FacetOutlines& outlines, const LaneScene& lanes) {
  constexpr double piece_m = 0.5, most_pieces = 64.0;
  std::vector<WedgeId> edges;
  for (const HalfLayer& layer : half_.layers()) edges.insert(edges.end(), layer.edges.begin(), layer.edges.end());
  std::ranges::sort(edges);
  ViewMap map = half_.sight().map();  // looking needs scratch memory
  first_part_.assign(scene.wedges().size() + 1, 0);
  for (const WedgeId id : edges) {
    const Wedge& edge = scene.wedge(id).edge;
    const EdgePart whole = whole_edge(id.value, edge, half_.position_m());
    const double nearer = half_.sight().nearer_on(scene, outlines, id);
    const int pieces = static_cast<int>(std::clamp(std::ceil(edge_length_m(edge) / piece_m), 1.0, most_pieces));
    bool open = false;
    for (int piece = 0; piece < pieces; ++piece) {
      const double from = static_cast<double>(piece) / pieces, to = static_cast<double>(piece + 1) / pieces;
      const Vec3 way_m = edge.end_m - edge.start_m;
      if (!map.shows(edge.start_m + from * way_m, edge.start_m + to * way_m, nearer)) {
        open = false;
        continue;
      }
      const auto length = static_cast<float>(edge_length_m(edge));
      if (!open) {
        parts_.push_back(whole);
        parts_.back().from = static_cast<float>(from) * length;
        ++first_part_[id.value + 1];
      }
      parts_.back().to = static_cast<float>(to) * length;
      open = true;
    }
  }
  for (std::size_t edge = 1; edge < first_part_.size(); ++edge) first_part_[edge] += first_part_[edge - 1];
  part_clusters_.build(parts_, lanes.origin_m(),
                       [&](const EdgePart& part) -> const Wedge& { return scene.wedge(WedgeId(part.edge)).edge; });
}

/// The part of an edge that an image may light through its mirror; its end lies before its beginning where there is
/// none.
inline EdgePart MastLists::lit_part(const Scene& scene, const LaneScene& lanes, WedgeId id,
                                    std::uint32_t mirror) const {
  const Wedge& edge = scene.wedge(id).edge;
  EdgePart part = whole_edge(mirror, edge, mirrors_[mirror].image_m + lanes.origin_m());
  const Vec3 start = edge.start_m - lanes.origin_m(), direction = edge_direction(edge);
  for (const HalfSpace& plane : mirrors_[mirror].cone) {  // which has room for rounding
    const Vec3 normal(plane.x, plane.y, plane.z);
    const double inside = glm::dot(normal, start) - plane.offset, slope = glm::dot(normal, direction);
    if (slope > 1e-9) {
      part.from = std::max(part.from, static_cast<float>(-inside / slope));
    } else if (slope < -1e-9) {
      part.to = std::min(part.to, static_cast<float>(-inside / slope));
    } else if (inside < 0.0) {
      part.to = -1e30F;
    }
  }
  return part;
}

inline void MastLists::list_lit_parts(const Scene& scene, const LaneScene& lanes, const EdgeRules& rules) {
  std::vector<WedgeId> all;
  for (std::uint32_t index = 0; index < scene.wedges().size(); ++index) {
    if (diffracts(scene.wedges()[index], rules) && !is_embedded(WedgeId(index), rules)) all.push_back(WedgeId(index));
  }
  ConeClusters clusters;
  clusters.build(all.size(), [&](std::uint32_t edge) {
    Aabb<double> box;
    box.extend(scene.wedge(all[edge]).edge.start_m - lanes.origin_m());
    box.extend(scene.wedge(all[edge]).edge.end_m - lanes.origin_m());
    return box;
  });
  const auto may_light = [](const Wedge& wedge, const Vec3& from_m) {  // not clearly from between the faces
    const double azimuth = azimuth_rad(wedge, from_m - wedge.start_m);
    return azimuth <= wedge.exterior_angle_rad + 1e-6 || azimuth >= 2.0 * pi - 1e-6;
  };
  struct Lit {
    std::uint32_t edge;
    EdgePart part;
  };
  std::vector<Lit> found;
  for (std::uint32_t mirror = 0; mirror < mirrors_.size(); ++mirror) {
    const FacetId facet = mirrors_[mirror].facet;
    const Vec3 image_m = mirrors_[mirror].image_m + lanes.origin_m();
    clusters.for_each_in(mirrors_[mirror].cone, [&](std::size_t first) {
      for (const std::uint32_t item : clusters.items().subspan(first, simd_lanes)) {
        if (item == ConeClusters::nothing) continue;
        const WorldWedge& wedge = scene.wedge(all[item]);
        if (wedge.facets[0] == facet || wedge.facets[1] == facet) continue;  // that is in the wedge's own terms
        const EdgePart part = lit_part(scene, lanes, all[item], mirror);
        if (part.from <= part.to && may_light(wedge.edge, image_m)) found.push_back({all[item].value, part});
      }
    });
  }
  std::stable_sort(found.begin(), found.end(), [](const Lit& a, const Lit& b) { return a.edge < b.edge; });
  for (std::size_t at = 0; at < found.size(); ++at) {
    const std::size_t first = at > 0 && found[at - 1].edge == found[at].edge ? first_lit_[found[at].edge + 1] : 0;
    const std::size_t lane = first % simd_lanes;  // counted in entries while the edge goes on
    if (lane == 0) {
      lit_.emplace_back();
      lit_.back().to.fill(-1e30F);
      lit_.back().mirror.fill(nothing);
    }
    LitLanes& eight = lit_.back();
    const EdgePart& part = found[at].part;
    eight.from[lane] = part.from;
    eight.to[lane] = part.to;
    eight.place[lane] = part.place;
    eight.distance[lane] = part.distance;
    eight.mirror[lane] = part.edge;
    first_lit_[found[at].edge + 1] = first + 1;
  }
  for (std::size_t edge = 1; edge < first_lit_.size(); ++edge) {
    first_lit_[edge] = first_lit_[edge - 1] + (first_lit_[edge] + simd_lanes - 1) / simd_lanes;
  }
}

template <typename Visit>
void MastLists::for_each_lit_part(WedgeId edge, const LaneEdge& line, const Vec3& point, float radius_m,
                                  Visit&& visit) const {
  const Vec3 away = point - Vec3(line.start[0], line.start[1], line.start[2]);
  const Vec3 direction(line.direction[0], line.direction[1], line.direction[2]);
  const double place_m = glm::dot(away, direction);
  const Float8 place(static_cast<float>(place_m)),
      distance(static_cast<float>(glm::length(away - place_m * direction)));
  const float slack_m = 5e-3F + 2e-6F * static_cast<float>(glm::length(point) + glm::length(away));
  for (std::size_t at = first_lit_[edge.value]; at < first_lit_[edge.value + 1]; ++at) {
    const LitLanes& eight = lit_[at];
    const Float8 own_place(eight.place), own_distance(eight.distance);
    const Float8 sum = own_distance + distance, between = place - own_place;
    const Float8 met = own_place + between * (own_distance / sum);
    const Float8 reach = edge_point_reach_m(own_distance, sum, between, radius_m) + slack_m;
    std::uint32_t left = ~((met + reach < Float8(eight.from)) | (Float8(eight.to) + reach < met)).bits() & 0xffU;
    for (; left != 0; left &= left - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(left));
      if (eight.mirror[lane] == nothing) continue;
      visit(EdgePart{edge.value, eight.from[lane], eight.to[lane], eight.place[lane], eight.distance[lane]},
            eight.mirror[lane]);
    }
  }
}

}  // namespace dcem
