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
  /// Of the view through a mirror.
  static constexpr int beam_pixels = 128;

  /// `half` must stay as it is. `both`: look for ways over a mirror and what
  /// comes after it.
  MastLists(const Scene& scene, const FacetOutlines& outlines, const LaneScene& lanes, const PathHalf& half,
            const HalfSettings& settings, bool both);

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

  /// The places of the mirrors over which the transmitter may light a facet.
  std::span<const std::uint32_t> mirrors_before(FacetId facet) const {
    return std::span(before_).subspan(first_before_[facet.value],
                                      first_before_[facet.value + 1] - first_before_[facet.value]);
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
  template <typename Shows, typename Visit>
  static void for_each_shown(const Wedge& edge, double from_m, double to_m, Shows&& shows, Visit&& visit);
  void look_through_mirrors(const Scene& scene, const FacetOutlines& outlines, const LaneScene& lanes,
                            const HalfSettings& settings);
  void list_lit_parts(const Scene& scene, std::vector<EdgePart>& found, std::span<const std::uint32_t> edges);
  EdgePart lit_part(const Scene& scene, const LaneScene& lanes, WedgeId edge, std::uint32_t mirror) const;

  const PathHalf& half_;
  Vec3 position_m_;
  std::vector<Mirror> mirrors_;
  std::vector<std::uint32_t> mirror_of_;
  std::vector<std::uint32_t> before_;
  std::vector<std::size_t> first_before_;
  std::vector<EdgePart> parts_;
  std::vector<std::size_t> first_part_, first_lit_;
  EdgeClusters part_clusters_;
  std::vector<LitLanes> lit_;
};

// ---------------------------------------------------------------------------------------------------------------------

inline MastLists::MastLists(const Scene& scene, const FacetOutlines& outlines, const LaneScene& lanes,
                            const PathHalf& half, const HalfSettings& settings, bool both)
    : half_(half), position_m_(half.position_m() - lanes.origin_m()), mirror_of_(scene.facets().size(), nothing) {
  for (const HalfLayer& layer : half.layers()) {
    for (std::size_t at = 0; at < layer.mirrors.size(); ++at) {
      mirror_of_[layer.mirrors[at].value] = static_cast<std::uint32_t>(mirrors_.size());
      mirrors_.push_back({layer.mirrors[at], layer.images_m[at] - lanes.origin_m(), layer.cones[at]});
    }
  }
  lay_out_parts(scene, outlines, lanes);
  first_before_.assign(scene.facets().size() + 1, 0);
  first_lit_.assign(scene.wedges().size() + 1, 0);
  if (both) look_through_mirrors(scene, outlines, lanes, settings);
}

/// Pieces of a stretch of an edge, half a metre long, are looked up one by one: calls `visit(from, to)` for what shows,
/// neighbours in one.
template <typename Shows, typename Visit>
void MastLists::for_each_shown(const Wedge& edge, double from_m, double to_m, Shows&& shows, Visit&& visit) {
  constexpr double piece_m = 0.5, most_pieces = 64.0;
  const Vec3 direction = edge_direction(edge);
  const int pieces = static_cast<int>(std::clamp(std::ceil((to_m - from_m) / piece_m), 1.0, most_pieces));
  const auto place_m = [&](int piece) { return from_m + (to_m - from_m) * piece / pieces; };
  for (int first = 0, piece = 0; piece <= pieces; ++piece) {
    const bool shown = piece < pieces &&
                       shows(edge.start_m + place_m(piece) * direction, edge.start_m + place_m(piece + 1) * direction);
    if (shown) continue;
    if (first < piece) visit(static_cast<float>(place_m(first)), static_cast<float>(place_m(piece)));
    first = piece + 1;
  }
}

inline void MastLists::lay_out_parts(const Scene& scene, const FacetOutlines& outlines, const LaneScene& lanes) {
  std::vector<WedgeId> edges;
  for (const HalfLayer& layer : half_.layers()) edges.insert(edges.end(), layer.edges.begin(), layer.edges.end());
  std::ranges::sort(edges);
  Sight sight = half_.sight();  // looking needs scratch memory
  first_part_.assign(scene.wedges().size() + 1, 0);
  for (const WedgeId id : edges) {
    const Wedge& edge = scene.wedge(id).edge;
    EdgePart part = whole_edge(id.value, edge, half_.position_m());
    const auto shows = [&](const Vec3& from_m, const Vec3& to_m) {
      return sight.shows(scene, outlines, id, from_m, to_m);
    };
    for_each_shown(edge, 0.0, edge_length_m(edge), shows, [&](float from, float to) {
      part.from = from;
      part.to = to;
      parts_.push_back(part);
      ++first_part_[id.value + 1];
    });
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

/// What the transmitter lights over one mirror: facets, and parts of edges.
inline void MastLists::look_through_mirrors(const Scene& scene, const FacetOutlines& outlines, const LaneScene& lanes,
                                            const HalfSettings& settings) {
  const auto may_light = [](const Wedge& wedge, const Vec3& from_m) {  // not clearly from between the faces
    const double azimuth = azimuth_rad(wedge, from_m - wedge.start_m);
    return azimuth <= wedge.exterior_angle_rad + 1e-6 || azimuth >= 2.0 * pi - 1e-6;
  };
  Sight sight(beam_pixels);
  std::vector<FacetId> facets;
  std::vector<WedgeId> edges;
  std::vector<std::array<std::uint32_t, 2>> pairs;
  std::vector<EdgePart> lit;
  std::vector<std::uint32_t> lit_edges;
  for (std::uint32_t mirror = 0; mirror < mirrors_.size(); ++mirror) {
    const FacetId facet = mirrors_[mirror].facet;
    const Vec3 image_m = mirrors_[mirror].image_m + lanes.origin_m();
    sight.look_through(scene, outlines, facet, image_m, ignored_body());
    sight.find_facets(scene, outlines, settings, facets);
    edges.clear();
    for (const FacetId seen : facets) {
      pairs.push_back({seen.value, mirror});
      if (!settings.edges) continue;
      for (const WedgeId id : scene.wedges_of_facet(seen)) edges.push_back(id);
    }
    std::ranges::sort(edges);
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    for (const WedgeId id : edges) {
      const WorldWedge& wedge = scene.wedge(id);
      if (!diffracts(wedge, settings.rules) || is_embedded(id, settings.rules)) continue;
      if (wedge.facets[0] == facet || wedge.facets[1] == facet) continue;  // that is in the wedge's own terms
      EdgePart part = lit_part(scene, lanes, id, mirror);
      if (part.from > part.to || !may_light(wedge.edge, image_m)) continue;
      const auto shows = [&](const Vec3& from_m, const Vec3& to_m) {
        return sight.shows(scene, outlines, id, from_m, to_m);
      };
      for_each_shown(wedge.edge, part.from, part.to, shows, [&](float from, float to) {
        part.from = from;
        part.to = to;
        lit.push_back(part);
        lit_edges.push_back(id.value);
      });
    }
  }
  first_before_.assign(scene.facets().size() + 1, 0);
  std::ranges::stable_sort(pairs, {}, [](const auto& pair) { return pair[0]; });
  for (const auto& [seen, mirror] : pairs) {
    ++first_before_[seen + 1];
    before_.push_back(mirror);
  }
  for (std::size_t seen = 1; seen < first_before_.size(); ++seen) first_before_[seen] += first_before_[seen - 1];
  list_lit_parts(scene, lit, lit_edges);
}

/// Lays out parts in eights, edge by edge; `edges` says for each part whose it is.
inline void MastLists::list_lit_parts(const Scene& scene, std::vector<EdgePart>& found,
                                      std::span<const std::uint32_t> edges) {
  std::vector<std::uint32_t> order(found.size());
  for (std::uint32_t at = 0; at < order.size(); ++at) order[at] = at;
  std::ranges::stable_sort(order, {}, [&](std::uint32_t at) { return edges[at]; });
  std::vector<std::size_t> count(scene.wedges().size(), 0);
  for (const std::uint32_t at : order) {
    const std::size_t lane = count[edges[at]]++ % simd_lanes;
    if (lane == 0) {
      lit_.emplace_back();
      lit_.back().to.fill(-1e30F);
      lit_.back().mirror.fill(nothing);
    }
    LitLanes& eight = lit_.back();
    eight.from[lane] = found[at].from;
    eight.to[lane] = found[at].to;
    eight.place[lane] = found[at].place;
    eight.distance[lane] = found[at].distance;
    eight.mirror[lane] = found[at].edge;
  }
  first_lit_.assign(1, 0);
  for (const std::size_t parts : count) first_lit_.push_back(first_lit_.back() + (parts + simd_lanes - 1) / simd_lanes);
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
    const Float8 reach = edge_point_reach_m(own_distance, sum, between, radius_m) +
                         edge_point_error_m(own_place, own_distance) + slack_m;
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
