#pragma once
/// Diffuse power of a link: the scattering surfaces in tiles, refined until their sum has converged.
///
/// One bounce only: what is scattered and then reflected, diffracted or scattered again is left out. Tiles are refined
/// by what they bring to the link, visibility included; nothing is remembered from link to link or frame to frame.
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
#include "dcem/field/diffuse/scattered_power.hpp"
#include "dcem/field/diffuse/tile_sight.hpp"
#include "dcem/paths/solve/scatter_solver.hpp"

namespace dcem {

/// Which random phases a link gets: the same in every frame, so that phases follow the lengths.
struct DiffuseKey {
  std::uint64_t seed = 1;
  std::string_view transmitter, receiver;
};

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
        max_transmissions_(static_cast<std::size_t>(max_transmissions)),
        solver_(tracer, max_transmissions) {}

  /// `facets`: those that both ends may see, ascending; nothing else is looked at.
  DiffusePower evaluate(const LinkEnd& transmitter, const RadioEnd& from, const LinkEnd& receiver, const RadioEnd& to,
                        std::span<const FacetId> facets, const DiffuseKey& key) {
    Integrand integrand{*this, transmitter, from, receiver, to, TileSight<Index>(tracer_, transmitter, receiver)};
    AdaptiveTiles<Integrand> tiles(
        {relative_tolerance(), settings_.tile_max_m.value_or(std::numeric_limits<double>::infinity()),
         settings_.tile_budget},
        integrand);
    const SolverCounters before = solver_.counters();
    for (const FacetId facet : facets) {
      if (solver_.may_scatter(transmitter, receiver, facet)) add_facet(tiles, facet);
    }
    tiles.refine();
    DiffusePower result = collect(tiles, integrand, key);
    result.legs = solver_.counters().legs - before.legs;
    result.traversal = integrand.traversal;
    result.traversal.nodes_visited += solver_.counters().traversal.nodes_visited - before.traversal.nodes_visited;
    result.traversal.primitives_tested +=
        solver_.counters().traversal.primitives_tested - before.traversal.primitives_tested;
    return result;
  }

 private:
  /// The domain of one link, for AdaptiveTiles.
  struct Integrand {
    DiffuseIntegral& integral;
    const LinkEnd& transmitter;
    const RadioEnd& from;
    const LinkEnd& receiver;
    const RadioEnd& to;
    TileSight<Index> sight;
    std::vector<std::pair<std::size_t, DiffuseContribution>> seen{};  ///< by tile; only those that bring power
    std::vector<FacetId> sheets{};
    TraversalCounters traversal{};
    bool is_free = false;  ///< nothing stands between the ends and the middle of the last tile

    double bound(const Tile& tile) const {
      const double from_m = least_distance_m(tile, from.position_m), to_m = least_distance_m(tile, to.position_m);
      return integral.scattered_.limit_per_m2(integral.facet_of(tile), tile.centroid_m(), tile.radius_m(), from_m, to_m,
                                              from, to) *
             tile.area_m2();
    }

    /// With what certainly stands in the way of the whole tile; what does not stand in the way of its middle does not.
    double tight_bound(const Tile& tile) {
      if (is_free) return tile.bound;
      if (!sight.crossed_by_all(tile, sheets, traversal) || sheets.size() > integral.max_transmissions_) return 0.0;
      double passed = 1.0;
      for (const FacetId sheet : sheets) passed *= integral.scattered_.transmission_limit(integral.scene_.facet(sheet));
      return passed * tile.bound;
    }

    /// Power density changes over a distance, a lobe within its width.
    double resolution_m(const Tile& tile) const {
      const double distance_m =
          std::min(least_distance_m(tile, from.position_m), least_distance_m(tile, to.position_m));
      return distance_m * integral.scattered_.pattern_width_rad(integral.facet_of(tile).material);
    }

    double evaluate(const Tile& tile, std::size_t index) {
      DiffuseContribution one;
      const FacetId facet = integral.scene_.facet_of_triangle(tile.source);
      const bool solved = integral.solver_.solve(transmitter, receiver, facet, tile.centroid_m(), one.path);
      is_free = solved && one.path.interactions.size() == 1;
      if (!solved) return 0.0;
      one.sample = integral.scattered_.per_m2(one.path, from, to);
      one.sample.power_ratio *= tile.area_m2();
      const double power_ratio = one.sample.power_ratio;
      if (power_ratio > 0.0) seen.emplace_back(index, std::move(one));
      return power_ratio;
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

  /// Half of what is promised: errors are estimates, and half as much again is what they were seen to lack.
  double relative_tolerance() const { return 0.5 * (db_to_power_ratio(settings_.tolerance_db) - 1.0); }

  const WorldFacet& facet_of(const Tile& tile) const { return scene_.facet(scene_.facet_of_triangle(tile.source)); }

  void add_facet(AdaptiveTiles<Integrand>& tiles, FacetId id) const {
    const WorldFacet& facet = scene_.facet(id);
    for (std::uint32_t index = 0; index < facet.triangle_count; ++index) {
      const std::uint32_t triangle = facet.first_triangle + index;
      tiles.add(scene_.corners_m(triangle), triangle);
    }
  }

  /// √P with the phase of the way, −kL, on top of one that belongs to the tile.
  Complex random_amplitude(const DiffuseContribution& one, const Tile& tile, const DiffuseKey& key) const {
    const BodyId body = facet_of(tile).body;
    const std::uint64_t number = tile.source - scene_.triangle_range(body).first;
    const std::uint64_t seed = hash_values(key.seed, hash_text(key.transmitter), hash_text(key.receiver),
                                           hash_text(scene_.body_name(body)), number, tile.place);
    const Complex random = unit_phasor(2.0 * pi * RandomStream(seed).uniform());
    return std::sqrt(one.sample.power_ratio) * random *
           propagation_phasor(one.path.length_m, scattered_.frequency_hz());
  }

  DiffusePower collect(const AdaptiveTiles<Integrand>& tiles, Integrand& integrand, const DiffuseKey& key) const {
    DiffusePower result;
    // A dual-polarized end has no single sum that a phase could enter.
    const bool has_phases = settings_.phases == DiffusePhases::seeded && !integrand.from.antenna.is_dual() &&
                            !integrand.to.antenna.is_dual();
    for (auto& [index, one] : integrand.seen) {
      const Tile& tile = tiles.tiles()[index];
      if (tile.is_halved) continue;
      if (has_phases) one.amplitude = random_amplitude(one, tile, key);
      one.triangle = tile.source;
      one.place = tile.place;
      if (!settings_.list_paths) one.path = {};
      result.tiles.push_back(std::move(one));
    }
    result.power_ratio = tiles.total();
    result.residual_ratio = 2.0 * tiles.error();
    result.tiles_evaluated = tiles.evaluated();
    // The running sums of the refinement differ from these by rounding.
    result.converged = result.residual_ratio <= 2.0 * relative_tolerance() * result.power_ratio * (1.0 + 1e-9);
    return result;
  }

  const SceneTracer<Index>& tracer_;
  const Scene& scene_;
  const ScatteredPower<Surface, Loss>& scattered_;
  DiffuseSettings settings_;
  std::size_t max_transmissions_;
  ScatterSolver<Index> solver_;
};

}  // namespace dcem
