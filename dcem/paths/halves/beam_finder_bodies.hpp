#pragma once
/// Bodies of beam_finder.hpp.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "dcem/core/build_mode.hpp"
#include "dcem/core/thread_pool.hpp"
#include "dcem/paths/halves/beam_finder.hpp"
#include "dcem/paths/halves/edge_looker.hpp"
#include "dcem/paths/halves/facet_edges.hpp"

namespace dcem {

/// Halves a stretch of an edge again and again, as long as something of it shows, down to pieces of half a metre or a
/// pixel of the view: calls `visit(from, to)` for what shows, neighbours in one.
template <typename Visit>
void BeamFinder::for_each_shown(const Sight& sight, WedgeId id, const EdgePart& part, int most_pieces,
                                Visit&& visit) const {
  const Wedge& edge = source_.scene.wedge(id).edge;
  const double from_m = part.from, to_m = part.to;
  const Vec3 direction = edge_direction(edge);
  const int pieces =
      static_cast<int>(std::clamp<double>(std::ceil((to_m - from_m) / least_piece_m(sight, part)), 1.0, most_pieces));
  const auto place_m = [&](int piece) { return from_m + (to_m - from_m) * piece / pieces; };
  int first = 0;  // of those that show, up to where it has been looked
  const auto ask = [&](const auto& ask_again, int begin, int end) -> void {
    const bool shows = sight.shows(source_.scene, source_.outlines, id, edge.start_m + place_m(begin) * direction,
                                   edge.start_m + place_m(end) * direction);
    if (shows && end - begin > 1) {
      const int middle = (begin + end) / 2;
      ask_again(ask_again, begin, middle);
      return ask_again(ask_again, middle, end);
    }
    if (shows) return;
    if (first < begin) visit(static_cast<float>(place_m(first)), static_cast<float>(place_m(begin)));
    first = end;
  };
  ask(ask, 0, pieces);
  if (first < pieces) visit(static_cast<float>(place_m(first)), static_cast<float>(place_m(pieces)));
}

/// The shortest piece that is worth asking about: half a metre, or what a pixel holds where the part is nearest to the
/// point that looks.
DCEM_INLINE double BeamFinder::least_piece_m(const Sight& sight, const EdgePart& part) {
  constexpr double shortest_m = 0.5;
  const double aside_m = std::max({part.from - part.place, part.place - part.to, 0.0F});
  return std::max(shortest_m, sight.map().pixel_width() * std::hypot(static_cast<double>(part.distance), aside_m));
}

DCEM_INLINE void BeamFinder::find_parts(const HalfLayer& layer, int most_pieces, BeamFinds& finds) const {
  constexpr std::size_t block = 256;
  const std::span<const WedgeId> edges = layer.edges;
  const std::size_t blocks = (edges.size() + block - 1) / block;
  if (source_.pool == nullptr || blocks <= 1) return find_parts_of(edges, most_pieces, finds.parts);
  std::vector<std::vector<EdgePart>> found(blocks);
  source_.pool->for_each(blocks, [&](std::size_t number, unsigned) {
    const std::size_t from = number * block;
    find_parts_of(edges.subspan(from, std::min(block, edges.size() - from)), most_pieces, found[number]);
  });
  for (const std::vector<EdgePart>& one : found) finds.parts.insert(finds.parts.end(), one.begin(), one.end());
}

DCEM_INLINE void BeamFinder::find_parts_of(std::span<const WedgeId> edges, int most_pieces,
                                           std::vector<EdgePart>& parts) const {
  const Sight& sight = source_.half.sight();
  for (const WedgeId id : edges) {
    const Wedge& edge = source_.scene.wedge(id).edge;
    EdgePart part = whole_edge(id.value, edge, source_.half.position_m());
    cut_to_contact(part, contact_at(id, source_.settings.rules));
    if (part.from > part.to) continue;
    for_each_shown(sight, id, part, most_pieces, [&](float from, float to) {
      part.from = from;
      part.to = to;
      parts.push_back(part);
    });
  }
}

DCEM_INLINE void BeamFinder::look_over_edges(std::span<const EdgePart> parts, std::size_t first, std::size_t last,
                                             std::vector<std::array<std::uint32_t, 2>>& lit) const {
  const std::size_t block = std::clamp<std::size_t>((last - first) / 16, 1, 16);  // and what else is of its last edge
  std::vector<std::size_t> starts{first};
  for (std::size_t at = first; at < last; ++at) {
    if (at - starts.back() >= block && parts[at].edge != parts[at - 1].edge) starts.push_back(at);
  }
  starts.push_back(last);
  std::vector<std::vector<std::array<std::uint32_t, 2>>> found(starts.size() - 1);
  const auto look = [&](std::size_t number, unsigned) {
    EdgeLooker looker(source_.scene, source_.outlines, source_.settings.sheets == 0);
    for (std::size_t from = starts[number], to = from; from < starts[number + 1]; from = to) {
      while (to < starts[number + 1] && parts[to].edge == parts[from].edge) ++to;
      looker.look_over(parts, from, to, found[number]);
    }
  };
  if (source_.pool == nullptr) {
    for (std::size_t number = 0; number < found.size(); ++number) look(number, 0);
  } else {
    source_.pool->for_each(found.size(), look);
  }
  for (const auto& one : found) lit.insert(lit.end(), one.begin(), one.end());
}

/// The part of an edge that an image may light through its mirror; its end lies before its beginning where there is
/// none.
DCEM_INLINE EdgePart BeamFinder::lit_part(WedgeId id, std::uint32_t mirror) const {
  const Wedge& edge = source_.scene.wedge(id).edge;
  const Vec3& origin_m = source_.lanes.origin_m();
  EdgePart part = whole_edge(mirror, edge, mirrors_[mirror].image_m + origin_m);
  cut_to_contact(part, contact_at(id, source_.settings.rules));
  cut_to_cone(part, edge, origin_m, mirrors_[mirror].cone);
  return part;
}

/// Notes the parts of the edges of some facets that a mirror may light. `for_each(edge, part, visit)` calls
/// `visit(from, to)` for what of a part is to be kept.
template <typename ForEach>
void BeamFinder::find_lit_parts(std::uint32_t mirror, std::span<const FacetId> facets, ForEach&& for_each,
                                BeamFinds& finds) const {
  const HalfSettings& settings = source_.settings;
  if (!settings.edges) return;
  std::vector<WedgeId> edges;
  collect_edges(source_.scene, facets, edges);
  const FacetId facet = mirrors_[mirror].facet;
  const Vec3 image_m = mirrors_[mirror].image_m + source_.lanes.origin_m();
  for (const WedgeId id : edges) {
    const WorldWedge& wedge = source_.scene.wedge(id);
    if (!diffracts(wedge, settings.rules) || is_embedded(id, settings.rules)) continue;
    if (wedge.facets[0] == facet || wedge.facets[1] == facet) continue;  // that is in the wedge's own terms
    EdgePart part = lit_part(id, mirror);
    if (part.from > part.to || !may_face(wedge.edge, image_m - wedge.edge.start_m)) continue;
    for_each(id, part, [&](float from, float to) {
      part.from = from;
      part.to = to;
      finds.lit.push_back(part);
      finds.lit_edges.push_back(id.value);
    });
  }
}

DCEM_INLINE void BeamFinder::look_through(std::size_t first, std::size_t last, bool bodies, int most_pieces,
                                          BeamFinds& finds) const {
  const std::size_t block = std::clamp<std::size_t>((last - first) / 16, 2, 16);
  const std::size_t blocks = (last - first + block - 1) / block;
  if (source_.pool == nullptr || blocks <= 1) return look_through_block(first, last, bodies, most_pieces, finds);
  std::vector<BeamFinds> found(blocks);
  source_.pool->for_each(blocks, [&](std::size_t number, unsigned) {
    const std::size_t from = first + number * block;
    look_through_block(from, std::min(last, from + block), bodies, most_pieces, found[number]);
  });
  for (const BeamFinds& one : found) finds.append(one);
}

DCEM_INLINE void BeamFinder::look_through_block(std::size_t first, std::size_t last, bool bodies, int most_pieces,
                                                BeamFinds& finds) const {
  Sight sight(view_pixels);
  std::vector<FacetId> facets;
  const auto show = [&](WedgeId id, const EdgePart& part, auto&& visit) {
    for_each_shown(sight, id, part, most_pieces, visit);
  };
  for (std::size_t at = first; at < last; ++at) {
    const auto mirror = static_cast<std::uint32_t>(at);
    const Vec3 image_m = mirrors_[at].image_m + source_.lanes.origin_m();
    sight.look_through(source_.scene, source_.outlines, mirrors_[at].facet, image_m, ignored_body());
    sight.find_facets(source_.scene, source_.outlines, source_.settings, bodies, facets);
    for (const FacetId seen : facets) finds.pairs.push_back({seen.value, mirror});
    find_lit_parts(mirror, facets, show, finds);
  }
}

DCEM_INLINE void BeamFinder::take_from(const Place& place, BeamFinds& finds) const {
  const Scene& scene = source_.scene;
  const Vec3& position_m = source_.half.position_m();
  std::vector<char> is_beside(place.mirrors().size());
  for (std::size_t at = 0; at < is_beside.size(); ++at) {
    const PlaceMirror& mirror = place.mirrors()[at];
    is_beside[at] = mirror.side * signed_distance_m(scene.facet(mirror.facet).plane, position_m) > 0.0;
  }
  const auto for_each_before = [&](auto lit, auto&& visit) {
    for (const std::uint32_t at : place.beams()->mirrors_before(lit)) {
      if (is_beside[at] != 0) visit(place.mirrors()[at].number);
    }
  };
  for (std::uint32_t facet = 0; facet < scene.facets().size(); ++facet) {
    for_each_before(FacetId(facet), [&](std::uint32_t mirror) { finds.pairs.push_back({facet, mirror}); });
  }
  for (std::uint32_t number = 0; number < scene.wedges().size(); ++number) {
    const Wedge& edge = scene.wedge(WedgeId(number)).edge;
    for_each_before(WedgeId(number), [&](std::uint32_t mirror) {
      const EdgePart part = lit_part(WedgeId(number), mirror);
      const Vec3 image_m = mirrors_[mirror].image_m + source_.lanes.origin_m();
      if (part.from > part.to || !may_face(edge, image_m - edge.start_m)) return;
      finds.lit.push_back(part);
      finds.lit_edges.push_back(number);
    });
  }
}

DCEM_INLINE void BeamFinder::reach_bodies(std::size_t first, std::size_t last, const BodyChoice& bodies,
                                          BeamFinds& finds) const {
  const std::span<const FacetOutlines::BodyFacets> facets_of = source_.outlines.bodies();
  const Vec3& origin_m = source_.lanes.origin_m();
  const auto is_beside = [&](FacetId id, std::span<const HalfSpace> cone) {
    const std::span<const Vec3> hull_m = source_.scene.hull_m(source_.scene.facet(id));
    return std::ranges::any_of(cone, [&](const HalfSpace& plane) {
      return std::ranges::all_of(hull_m, [&](const Vec3& corner_m) {
        return glm::dot(Vec3(plane.x, plane.y, plane.z), corner_m - origin_m) < plane.offset;
      });
    });
  };
  const auto whole = [](WedgeId, const EdgePart& part, auto&& visit) { visit(part.from, part.to); };
  std::vector<FacetId> facets;
  for (auto mirror = static_cast<std::uint32_t>(first); mirror < last; ++mirror) {
    facets.clear();
    source_.outlines.for_each_body_in(mirrors_[mirror].cone, [&](BodyId body) {
      if (!bodies.takes(body.value)) return;
      const FacetOutlines::BodyFacets& of = facets_of[body.value - 1];
      for (std::uint32_t index = of.first; index < of.first + of.count; ++index) {
        const WorldFacet& facet = source_.scene.facet(FacetId(index));
        if (!facet.present || FacetId(index) == mirrors_[mirror].facet) continue;
        if (is_beside(FacetId(index), mirrors_[mirror].cone)) continue;
        facets.push_back(FacetId(index));
        finds.pairs.push_back({index, mirror});
      }
    });
    if (!facets.empty()) find_lit_parts(mirror, facets, whole, finds);
  }
}

}  // namespace dcem
