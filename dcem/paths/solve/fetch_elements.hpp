#pragma once
/// Asks for the elements of sequences that are soon solved.
#include <span>

#include "dcem/core/fetch.hpp"
#include "dcem/paths/sequence.hpp"
#include "dcem/scene/scene.hpp"

namespace dcem {

/// First the elements …
[[gnu::always_inline]] inline void fetch_elements(const Scene& scene, std::span<const SequenceElement> elements) {
  for (const SequenceElement element : elements) {
    if (element.is_edge()) {
      fetch(scene.wedge(element.edge()));
    } else {
      fetch(scene.facet(element.mirror()));
    }
  }
}

/// … and, when they have come, the faces of edges.
[[gnu::always_inline]] inline void fetch_faces(const Scene& scene, std::span<const SequenceElement> elements) {
  for (const SequenceElement element : elements) {
    if (!element.is_edge()) continue;
    for (const FacetId face : scene.wedge(element.edge()).facets) fetch(scene.facet(face));
  }
}

}  // namespace dcem
