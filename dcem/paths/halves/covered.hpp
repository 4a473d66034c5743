#pragma once
/// Which sequences and orders the search from two halves covers: of these it misses none.
#include <cstddef>

#include "dcem/paths/path.hpp"
#include "dcem/paths/sequence.hpp"

namespace dcem {

/// Three mirrors and edges at most: one edge among three elements, two where there is nothing else.
inline constexpr int most_joined_interactions = 3, most_joined_edges = 2;

/// Whether all sequences within some orders are covered, where at most `joined` elements are joined. 0: none are.
inline bool halves_cover(int joined, int diffractions, int interactions) {
  return joined > 0 && interactions <= joined && (diffractions <= 1 || interactions <= most_joined_edges);
}
inline bool halves_cover(int joined, const Sequence& sequence) {
  return halves_cover(joined, static_cast<int>(edge_count(sequence)), static_cast<int>(sequence.size()));
}
/// The same of the sequence that a path is over.
inline bool halves_cover(int joined, const Path& path) {
  int reflections = 0, diffractions = 0;
  for (const Interaction& interaction : path.interactions) {
    reflections += interaction.kind == InteractionKind::reflection ? 1 : 0;
    diffractions += interaction.kind == InteractionKind::diffraction ? 1 : 0;
  }
  return halves_cover(joined, diffractions, reflections + diffractions);
}

}  // namespace dcem
