#pragma once
/// Everything a simulation can be told, one sentence, unit and default per field.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <variant>

#include "dcem/accel/binary/updater.hpp"
#include "dcem/em/medium/atmosphere.hpp"
#include "dcem/em/medium/path_loss.hpp"
#include "dcem/em/surface/itu_p2040.hpp"
#include "dcem/field/diffraction_chain.hpp"
#include "dcem/field/diffuse/diffuse_settings.hpp"

namespace dcem {

/// How paths are found.
enum class Discovery {
  automatic,  ///< exact where the scene is small enough for it, else sampled; the result says which
  exact,      ///< every valid path within the declared orders
  sampled     ///< rays shot from the receiver propose sequences; completeness is not promised
};

/// What is remembered from frame to frame.
enum class CacheMode {
  automatic,  ///< seed where discovery is sampled, else off
  off,        ///< each frame is solved from scratch
  seed        ///< goes with sampled: found sequences are solved again in each frame, few rays look for new ones
};

/// How the elements of antenna arrays differ from each other.
enum class ArrayChannel {
  plane_wave,  ///< in phase alone, by the path between the arrays' centres
  exact        ///< each pair of elements has a path of its own
};

/// Exact discovery tries sequences of facets; this version offers it up to this many facets.
inline constexpr std::size_t exact_discovery_facet_limit = 1000;

/// Where around an edge diffracted paths are reported.
enum class DiffractionRegion {
  everywhere,  ///< the total field is continuous
  shadow       ///< only where the wedge itself hides the one side from the other
};

struct DiffractionSettings {
  LossyWedge lossy_wedge = LossyWedge::holm_reciprocal;  ///< how lossy faces enter the coefficient
  DiffractionRegion region = DiffractionRegion::everywhere;
  bool free_edges = false;                ///< the rims of open sheets diffract as half planes
  double min_exterior_angle_deg = 190.0;  ///< flatter edges do not diffract, above 180 and at most 360
};

struct PropagationSettings {
  bool line_of_sight = true;                   ///< report the direct path
  int max_reflections = 2;                     ///< reflections of a path, 0…10
  int max_transmissions = 2;                   ///< sheets a path may cross, 0…10
  int max_diffractions = 1;                    ///< diffractions of a path, 0…3
  std::optional<int> max_interactions;         ///< reflections and diffractions together; default: no further bound
  DiffractionSettings diffraction{};           ///< which edges diffract, and how
  Discovery discovery = Discovery::automatic;  ///< how paths are found
  std::uint32_t rays = 2000;                   ///< rays per receiver in sampled discovery, in a frame without history
  std::optional<std::uint32_t> rays_steady;  ///< the same in a later frame of a cached run; default: a tenth of `rays`
  CacheMode cache = CacheMode::automatic;    ///< what is remembered from frame to frame
  std::uint64_t seed = 1;                    ///< turns the sphere of rays, with receiver id and frame number
  std::optional<double> min_path_gain_db;    ///< paths weaker than this are dropped after their field is known, dB
  AnyPathLoss path_loss{};                   ///< a real factor beside free-space spreading
  std::optional<Atmosphere> atmosphere{};    ///< gases and rain; default: none
  ArrayChannel antenna_array = ArrayChannel::plane_wave;  ///< how the elements of arrays differ from each other
  DiffuseSettings diffuse{};                              ///< power that rough surfaces scatter
};

struct SimulationSettings {
  double frequency_hz = 30e9;
  ItuSettings itu{};  ///< revision of the material tables, and whether they may be extrapolated
  PropagationSettings propagation{};
  TreeUpdateSettings tree_update{};  ///< how the tree is kept while the scene moves. Never changes a result
  unsigned threads = 0;              ///< 0: all cores. Never changes a result
  bool share_map_work = true;  ///< work that is the same at all points of a map is done once. Never changes a result
};

/// Rays per receiver in a frame with history.
inline std::uint32_t steady_rays(const PropagationSettings& propagation) {
  return propagation.rays_steady.value_or(std::max<std::uint32_t>(1, propagation.rays / 10));
}

/// The number of reflections that is really in force.
inline int reflection_order(const PropagationSettings& propagation) {
  const int bound = propagation.max_interactions.value_or(propagation.max_reflections);
  return bound < propagation.max_reflections ? bound : propagation.max_reflections;
}

/// The number of diffractions that is really in force.
inline int diffraction_order(const PropagationSettings& propagation) {
  return std::min(propagation.max_diffractions, propagation.max_interactions.value_or(propagation.max_diffractions));
}

/// Reflections and diffractions together, as they are really bounded.
inline int interaction_order(const PropagationSettings& propagation) {
  const int sum = propagation.max_reflections + propagation.max_diffractions;
  return std::min(sum, propagation.max_interactions.value_or(sum));
}

/// Throws std::invalid_argument, naming the field, where a value is out of range.
inline void validate(const SimulationSettings& settings) {
  const auto check = [](bool holds, const char* message) {
    if (!holds) throw std::invalid_argument(message);
  };
  const PropagationSettings& propagation = settings.propagation;
  check(settings.frequency_hz > 0.0 && settings.frequency_hz <= 1e15, "frequency_hz: expected a number in (0, 1e15]");
  check(propagation.max_reflections >= 0 && propagation.max_reflections <= 10, "max_reflections: expected 0 to 10");
  check(propagation.max_transmissions >= 0 && propagation.max_transmissions <= 10,
        "max_transmissions: expected 0 to 10");
  check(propagation.max_diffractions >= 0 && propagation.max_diffractions <= 3, "max_diffractions: expected 0 to 3");
  const double least_deg = propagation.diffraction.min_exterior_angle_deg;
  check(least_deg > 180.0 && least_deg <= 360.0, "min_exterior_angle_deg: expected above 180, at most 360");
  check(!propagation.max_interactions || *propagation.max_interactions >= 0, "max_interactions: expected 0 or more");
  check(!propagation.min_path_gain_db || std::isfinite(*propagation.min_path_gain_db),
        "min_path_gain_db: expected a finite number");
  if (const auto* close_in = std::get_if<CloseIn>(&propagation.path_loss.model)) validate(*close_in);
  check(propagation.rays >= 1 && propagation.rays <= 100'000'000, "rays: expected 1 to 1e8");
  check(steady_rays(propagation) >= 1 && steady_rays(propagation) <= 100'000'000, "rays_steady: expected 1 to 1e8");
  if (propagation.atmosphere) validate(*propagation.atmosphere);
  validate(propagation.diffuse);
  validate(settings.tree_update);
}

}  // namespace dcem
