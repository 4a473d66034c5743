#pragma once
/// Everything a simulation can be told, one sentence, unit and default per field.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dcem/accel/wide/settings.hpp"
#include "dcem/em/diffraction/lossy_wedge.hpp"
#include "dcem/em/medium/atmosphere.hpp"
#include "dcem/em/medium/path_loss.hpp"
#include "dcem/em/surface/itu_settings.hpp"
#include "dcem/field/diffuse/diffuse_settings.hpp"

namespace dcem {

/// How paths are found.
enum class Discovery {
  automatic,  ///< exact as far as that is offered; beyond, rays look for longer paths, and the result says so
  exact,      ///< every valid path within the declared orders
  sampled     ///< rays shot from the receiver propose sequences; completeness is not promised
};

/// What is remembered from frame to frame.
enum class CacheMode {
  automatic,  ///< exact where discovery is exact, seed where it is sampled
  off,        ///< each frame is solved from scratch
  seed,       ///< goes with sampled: found sequences are solved again in each frame, few rays look for new ones
  exact       ///< goes with exact: only what has changed is worked out; each frame is as from scratch, bit for bit
};

/// How the elements of antenna arrays differ from each other.
enum class ArrayChannel {
  plane_wave,  ///< in phase alone, by the path between the arrays' centres
  exact        ///< each pair of elements has a path of its own
};

/// Exact discovery beyond three interactions tries sequences of facets; this version offers it up to this many facets.
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
  std::uint32_t rays = 20'000;                 ///< rays per receiver in sampled discovery, in a frame without history
  std::optional<std::uint32_t> rays_steady;  ///< the same in a later frame of a cached run; default: a tenth of `rays`
  CacheMode cache = CacheMode::automatic;    ///< what is remembered from frame to frame
  /// Links get a proved `valid_until_m` of at most this, metres, where the cache is exact; default: none is looked for.
  std::optional<double> valid_until_limit_m;
  std::uint64_t seed = 1;                  ///< turns the sphere of rays, with receiver id and frame number
  std::optional<double> min_path_gain_db;  ///< paths weaker than this are dropped after their field is known, dB
  /// Paths longer than this are neither looked for nor reported, metres; none: of any length. Scattered power has all.
  std::optional<double> max_path_length_m;
  AnyPathLoss path_loss{};                                ///< a real factor beside free-space spreading
  std::optional<Atmosphere> atmosphere{};                 ///< gases and rain; default: none
  ArrayChannel antenna_array = ArrayChannel::plane_wave;  ///< how the elements of arrays differ from each other
  DiffuseSettings diffuse{};                              ///< power that rough surfaces scatter
};

/// Which links there are. A device never has one to itself.
/// One of `of` parts of the receivers of a frame (sim/receiver_part.hpp), counted from 0.
struct ReceiverPart {
  std::uint32_t part = 0;
  std::uint32_t of = 1;
};

struct LinkSettings {
  /// Only between ends that are at most so far apart in this frame, metres; none: at any distance.
  std::optional<double> range_m{};
  /// Only these, by the ids of transmitter and receiver, of two transceivers in any order; none: all.
  std::optional<std::vector<std::pair<std::string, std::string>>> pairs{};
  /// Only of these receivers; none: of all. What each link brings does not depend on it.
  std::optional<ReceiverPart> receivers{};
};

struct SimulationSettings {
  double frequency_hz = 30e9;
  ItuSettings itu{};  ///< revision of the material tables, and whether they may be extrapolated
  PropagationSettings propagation{};
  LinkSettings links{};        ///< which links a frame has; maps have all of theirs
  WideTreeSettings tree{};     ///< how the tree is built, and kept while the scene moves. Never changes a result
  unsigned threads = 0;        ///< 0: all cores. Never changes a result
  bool share_map_work = true;  ///< work that is the same at all points of a map is done once. Never changes a result
  /// What is kept from frame to frame of what receivers see, where the cache is exact, may take about so many bytes:
  /// 2 to 5 MB for a receiver, and 1 MB for each of its links with a transmitter that stands. It is kept of the first
  /// ones of those that are there; links of others are worked out from scratch where anything has changed. What is left
  /// of it goes to places that receivers have been in, for those who come after them. Never changes a result.
  double most_remembered_bytes = std::numeric_limits<double>::infinity();
  /// How many frames there will be, where that is known. To list what a transmitter that stands reaches takes half a
  /// second in a city and spares work in all frames after. It is begun at once, then, or, where they are too few,
  /// never. None, or no exact cache: it is begun when it would have paid by then. Never changes a result.
  std::optional<std::size_t> expected_frames{};
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
void validate(const SimulationSettings& settings);

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/sim/settings_bodies.hpp"
#endif
