#pragma once
/// Diffuse power of a link: the visible parts of scattering surfaces in tiles, refined until their sum has converged.
///
/// One bounce only: what is scattered and then reflected, diffracted or scattered again is left out. Tiles are refined
/// by what they bring to the link; nothing is remembered from frame to frame, and what a transmitter sees of a surface
/// is worked out once for all receivers of a frame.
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "dcem/core/random.hpp"
#include "dcem/core/units.hpp"
#include "dcem/field/diffuse/adaptive_tiles.hpp"
#include "dcem/field/diffuse/diffuse_contribution.hpp"
#include "dcem/field/diffuse/diffuse_settings.hpp"
#include "dcem/field/diffuse/scatter_ways.hpp"
#include "dcem/field/diffuse/scattered_power.hpp"
#include "dcem/paths/halves/in_both.hpp"
#include "dcem/paths/visible/may_scatter.hpp"
#include "dcem/paths/visible/surface_view.hpp"
#include "dcem/paths/visible/visible_parts.hpp"

namespace dcem {

/// Which random phases a link gets: the same in every frame, so that phases follow the lengths.
struct DiffuseKey {
  std::uint64_t seed = 1;
  std::string_view transmitter, receiver;
};

/// One end of a link whose diffuse power is summed.
template <typename View>
struct DiffuseEnd {
  const LinkEnd& link;
  const RadioEnd& radio;
  View& view;
};
using DiffuseTransmitter = DiffuseEnd<LitSurfaces>;
using DiffuseReceiver = DiffuseEnd<const SurfaceView>;

/// Computes links one after the other; one per thread. Everything named must outlive it.
template <typename Index, SurfaceModel Surface, PathLossModel Loss>
class DiffuseIntegral {
 public:
  DiffuseIntegral(const SceneTracer<Index>& tracer, const ScatteredPower<Surface, Loss>& scattered,
                  const DiffuseSettings& settings, int max_transmissions)
      : tracer_(tracer),
        scene_(tracer.scene()),
        scattered_(scattered),
        settings_(settings),
        finder_(tracer, max_transmissions) {}

  /// Nothing is looked at but the facets that both ends may see.
  DiffusePower evaluate(const DiffuseTransmitter& transmitter, const DiffuseReceiver& receiver, const DiffuseKey& key) {
    Integrand integrand{*this, transmitter, receiver, ScatterWays(scene_, transmitter.link, receiver.link)};
    AdaptiveTiles<Integrand> tiles(
        {relative_tolerance(), settings_.tile_max_m.value_or(std::numeric_limits<double>::infinity()),
         settings_.tile_budget},
        integrand);
    const std::span<const FacetId> lit(transmitter.view.view.facets), seen(receiver.view.facets);
    for_each_in_both(lit, seen, [&](std::size_t place) {
      if (may_scatter(scene_, transmitter.link, receiver.link, lit[place])) add_facet(tiles, lit[place]);
    });
    tiles.refine();
    return collect(tiles, integrand, key);
  }

 private:
  /// The domain of one link, for AdaptiveTiles.
  struct Integrand {
    DiffuseIntegral& integral;
    const DiffuseTransmitter& transmitter;
    const DiffuseReceiver& receiver;
    ScatterWays ways;
    PartList parts{};
    LitParts lit{};
    TraversalCounters traversal{};

    double limit_per_m2(const Tile& tile) const {
      const RadioEnd &from = transmitter.radio, &to = receiver.radio;
      const double from_m = least_distance_m(tile, from.position_m), to_m = least_distance_m(tile, to.position_m);
      return integral.scattered_.limit_per_m2(integral.facet_of(tile), tile.centroid_m(), tile.radius_m(), from_m, to_m,
                                              from, to) *
             passed_limit(tile);
    }

    /// Power density changes over a distance; lobes, beams and fringes within their width. Seven points show what
    /// changes over half of a tile (docs/design/diffuse.md).
    double resolution_m(const Tile& tile) const {
      const auto& scattered = integral.scattered_;
      const auto distance_m = [&](const RadioEnd& end) {
        return least_distance_m(tile, end.position_m) * scattered.beam_width_rad(end.antenna);
      };
      const MaterialId material = integral.facet_of(tile).material;
      double width_rad = std::min(scattered.pattern_width_rad(material), scattered.reflection_width_rad(material));
      for (const FacetId sheet : ways.sheets(tile.part)) {
        width_rad = std::min(width_rad, scattered.transmission_width_rad(integral.scene_.facet(sheet)));
      }
      return 2.0 * std::min(distance_m(transmitter.radio), distance_m(receiver.radio)) * width_rad;
    }

    /// Foliage weakens a leg by its length in it, which changes from point to point.
    bool is_smooth(const Tile& tile) const {
      return std::ranges::none_of(integral.scene_.foliage(), [&](const FoliageShell& shell) {
        if (!integral.scattered_.is_weakened_by(shell.material)) return false;
        return meets_leg(shell.box, tile, transmitter.radio.position_m) ||
               meets_leg(shell.box, tile, receiver.radio.position_m);
      });
    }

    template <typename Visit>
    bool visit_parts(const Tile& piece, Visit&& visit) {
      integral.finder_.turn_to(integral.scene_.facet_of_triangle(piece.source), piece.corners_m);
      const LitParts& seen = parts_lit(piece);
      if (seen.are_too_many) return false;
      parts = seen.parts;
      const bool are_few = integral.finder_.leave_visible(receiver.view.shades, ScatterLeg::to_receiver,
                                                          transmitter.link.ignored_body, parts, [](BodyId) {});
      if (!are_few) return false;
      for (std::size_t part = 0; part < parts.size(); ++part) {
        visit(parts.corners_m(part), ways.number_of(parts, part));
      }
      return true;
    }

    double density(const Tile& tile, const Vec3& point_m) {
      const FacetId facet = integral.scene_.facet_of_triangle(tile.source);
      return integral.scattered_.power_per_m2(ways.over(tile.part, facet, point_m), transmitter.radio, receiver.radio);
    }

    /// What the transmitter sees of a piece, and no other facet stands for. Kept, unless it is in the shadow of what
    /// the receiver rides on.
    const LitParts& parts_lit(const Tile& piece) {
      const auto find = [&](const std::optional<BodyId>& ridden, LitParts& found) {
        integral.find_lit(transmitter, ridden, piece.corners_m, found, traversal);
      };
      const LitParts& kept = transmitter.view.parts.of(piece.source, piece.place, lit,
                                                       [&](LitParts& found) { find(std::nullopt, found); });
      const std::optional<BodyId>& ridden = receiver.link.ignored_body;
      if (!ridden || std::find(kept.bodies.begin(), kept.bodies.end(), *ridden) == kept.bodies.end()) return kept;
      find(ridden, lit);
      return lit;
    }

    double passed_limit(const Tile& tile) const {
      double passed = 1.0;
      for (const FacetId sheet : ways.sheets(tile.part)) {
        passed *= integral.scattered_.transmission_limit(integral.scene_.facet(sheet));
      }
      return passed;
    }

    static bool meets_leg(const Aabb<double>& box, const Tile& tile, const Vec3& end_m) {
      Aabb<double> legs;
      legs.extend(end_m);
      for (const Vec3& corner_m : tile.corners_m) legs.extend(corner_m);
      return legs.overlaps(box);
    }

    /// No more than the distance of a point from any point of the tile; a micrometre at least.
    static double least_distance_m(const Tile& tile, const Vec3& point_m) {
      const double radius_m = tile.radius_m();
      const double outside_m = glm::distance(tile.centroid_m(), point_m) - radius_m;
      // The sphere around the tile is a cheap bound, and a good one only from far away.
      const double distance_m = outside_m > radius_m ? outside_m : distance_to_triangle_m(tile.corners_m, point_m);
      return std::max(distance_m, 1e-6);
    }
  };

  /// Half of what is promised: errors are estimates.
  double relative_tolerance() const { return 0.5 * (db_to_power_ratio(settings_.tolerance_db) - 1.0); }

  const WorldFacet& facet_of(const Tile& tile) const { return scene_.facet(scene_.facet_of_triangle(tile.source)); }

  void add_facet(AdaptiveTiles<Integrand>& tiles, FacetId id) const {
    const WorldFacet& facet = scene_.facet(id);
    for (std::uint32_t index = 0; index < facet.triangle_count; ++index) {
      const std::uint32_t triangle = facet.first_triangle + index;
      tiles.add(scene_.corners_m(triangle), triangle);
    }
  }

  void find_lit(const DiffuseTransmitter& transmitter, const std::optional<BodyId>& ridden,
                const TriangleCorners& corners_m, LitParts& found, TraversalCounters& traversal) {
    found.bodies.clear();
    const auto note = [&](BodyId body) {
      if (body != BodyId{} && std::find(found.bodies.begin(), found.bodies.end(), body) == found.bodies.end())
        found.bodies.push_back(body);
    };
    found.parts.clear();
    found.parts.add(corners_m, {});
    found.are_too_many =
        !finder_.leave_to_others({transmitter.link.ignored_body, ridden}, found.parts, traversal, note) ||
        !finder_.leave_visible(transmitter.view.view.shades, ScatterLeg::from_transmitter, ridden, found.parts, note);
    if (found.are_too_many) found.parts.clear();
  }

  /// √P with the phase of the way, −kL, on top of one that belongs to the place on its body.
  Complex random_amplitude(const DiffuseContribution& one, double length_m, const DiffuseKey& key) const {
    const BodyId body = scene_.facet(scene_.facet_of_triangle(one.triangle)).body;
    const std::uint64_t number = one.triangle - scene_.triangle_range(body).first;
    const std::uint64_t seed = hash_values(key.seed, hash_text(key.transmitter), hash_text(key.receiver),
                                           hash_text(scene_.body_name(body)), number, one.place);
    const Complex random = unit_phasor(2.0 * pi * RandomStream(seed).uniform());
    return std::sqrt(one.sample.power_ratio) * random * propagation_phasor(length_m, scattered_.frequency_hz());
  }

  DiffusePower collect(const AdaptiveTiles<Integrand>& tiles, Integrand& integrand, const DiffuseKey& key) const {
    DiffusePower result;
    const RadioEnd &from = integrand.transmitter.radio, &to = integrand.receiver.radio;
    // A dual-polarized end has no single sum that a phase could enter.
    const bool has_phases =
        settings_.phases == DiffusePhases::seeded && !from.antenna.is_dual() && !to.antenna.is_dual();
    tiles.for_each_point([&](const Tile& tile, const Vec3& point_m, double area_m2, double density) {
      if (!(density > 0.0)) return;
      const FacetId facet = scene_.facet_of_triangle(tile.source);
      const Path& path = integrand.ways.over(tile.part, facet, point_m);
      DiffuseContribution one;
      one.sample = scattered_.sample(path, from, to, area_m2 * density);
      one.triangle = tile.source;
      one.area_m2 = area_m2;
      one.place = has_phases || settings_.list_paths ? place_within(tile, point_m) : tile.place;
      if (has_phases) one.amplitude = random_amplitude(one, path.length_m, key);
      if (settings_.list_paths) one.path = integrand.ways.listed(path);
      result.tiles.push_back(std::move(one));
    });
    for (const DiffuseContribution& one : result.tiles) result.power_ratio += one.sample.power_ratio;
    result.residual_ratio = 2.0 * tiles.error();
    result.tiles_evaluated = tiles.evaluated();
    result.traversal = integrand.traversal;
    // The running sums of the refinement differ from these by rounding.
    result.converged = result.residual_ratio <= 2.0 * relative_tolerance() * result.power_ratio * (1.0 + 1e-9);
    return result;
  }

  /// So small a piece of the triangle that each point of the tile has its own.
  std::uint64_t place_within(const Tile& tile, const Vec3& point_m) const {
    return place_around(scene_.corners_m(tile.source), point_m, 1e-8 * tile.longest_edge_m());
  }

  const SceneTracer<Index>& tracer_;
  const Scene& scene_;
  const ScatteredPower<Surface, Loss>& scattered_;
  DiffuseSettings settings_;
  PartFinder<Index> finder_;
};

}  // namespace dcem
