#pragma once
/// Which sequences and orders the search from two halves covers: of these it misses none.
#include <cstddef>

#include "dcem/paths/path.hpp"
#include "dcem/paths/sequence.hpp"

namespace dcem {

/// Two mirrors and edges at most, one edge among them.
inline constexpr int most_joined_interactions = 2, most_joined_diffractions = 1;

/// Whether all sequences within some orders are covered.
inline bool halves_cover(int diffractions, int interactions) {
  return diffractions <= most_joined_diffractions && interactions <= most_joined_interactions;
}
inline bool halves_cover(const Sequence& sequence) {
  return halves_cover(static_cast<int>(edge_count(sequence)), static_cast<int>(sequence.size()));
}
/// The same of the sequence that a path is over.
inline bool halves_cover(const Path& path) {
  int reflections = 0, diffractions = 0;
  for (const Interaction& interaction : path.interactions) {
    reflections += interaction.kind == InteractionKind::reflection ? 1 : 0;
    diffractions += interaction.kind == InteractionKind::diffraction ? 1 : 0;
  }
  return halves_cover(diffractions, reflections + diffractions);
}

}  // namespace dcem
