#pragma once
/// What an end of a link sees of the surfaces of a scene: which facets, and what stands before them.
#include <vector>

#include "dcem/paths/halves/sight.hpp"
#include "dcem/paths/visible/lit_parts.hpp"
#include "dcem/paths/visible/shades.hpp"

namespace dcem {

struct SurfaceView {
  std::vector<FacetId> facets;  ///< that the end may see, ascending
  Shades shades;
};

/// A view of the same number of pixels gives the same facets.
SurfaceView look_at_surfaces(Sight& sight, const Scene& scene, const FacetOutlines& outlines, const LinkEnd& end,
                             int max_transmissions);

/// The view of a transmitter, with what it sees of single surfaces as receivers ask for it.
struct LitSurfaces {
  SurfaceView view;
  LitPartsCache parts;
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/visible/surface_view_bodies.hpp"
#endif
