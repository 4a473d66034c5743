#pragma once
/// A propagation path is geometry and nothing else: which surfaces it touches, where, and how long it is. It knows no
/// material constant, no frequency and no gain; those are computed anew from it in the room `channel`.
#include <algorithm>
#include <string>
#include <vector>

#include "dcem/core/ids.hpp"
#include "dcem/geometry/vector.hpp"

namespace dcem {

enum class InteractionKind : char { reflection = 'R', transmission = 'T', diffraction = 'D', scattering = 'S' };

/// This close to a shadow boundary, in azimuth about the edge, rounding would decide whether a wedge hides its two
/// sides from each other; there `Interaction::in_shadow` says it, for the field as well.
inline constexpr double shadow_boundary_rad = 1e-9;

/// One touch of a surface.
struct Interaction {
  InteractionKind kind = InteractionKind::reflection;
  FacetId facet;  ///< of a diffraction: face 0 of the wedge
  Vec3 point_m{0.0};
  WedgeId wedge{};         ///< of a diffraction
  bool in_shadow = false;  ///< of a diffraction: the wedge itself hides one neighbour from the other
};

/// What a path runs through of one kind of foliage.
struct FoliageLength {
  MaterialId material;
  double length_m = 0.0;
};

/// A path from a transmitter to a receiver, solved for the current frame.
struct Path {
  std::vector<Interaction> interactions;  ///< in order from the transmitter to the receiver; empty: line of sight
  double length_m = 0.0;                  ///< sum of the legs
  std::vector<FoliageLength> foliage{};   ///< by material; empty where the path crosses none
};

/// One letter per interaction, from transmitter to receiver; empty for the line of sight.
inline std::string kinds(const Path& path) {
  std::string letters;
  for (const Interaction& interaction : path.interactions) letters.push_back(static_cast<char>(interaction.kind));
  return letters;
}

/// The order in which the paths of a link are reported: by length (hence delay), then kinds, then point coordinates;
/// should all of that be equal, by what they touch.
bool reported_before(const Path& a, const Path& b);

/// Whether two paths are the same: same kinds on the same facets and edges in the same order.
inline bool same_sequence(const Path& a, const Path& b) {
  return std::equal(a.interactions.begin(), a.interactions.end(), b.interactions.begin(), b.interactions.end(),
                    [](const Interaction& x, const Interaction& y) {
                      return x.kind == y.kind && x.facet == y.facet && x.wedge == y.wedge;
                    });
}

namespace detail {

/// Puts paths in the order in which they are reported, each once.
void sort_and_drop_repeated(std::vector<Path>& paths);

}  // namespace detail

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/path_bodies.hpp"
#endif
