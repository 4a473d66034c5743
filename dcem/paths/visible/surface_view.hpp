#pragma once
/// What an end of a link sees of the surfaces of a scene: which facets, and what stands before them.
#include <algorithm>
#include <span>
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
inline SurfaceView look_at_surfaces(Sight& sight, const Scene& scene, const FacetOutlines& outlines, const LinkEnd& end,
                                    int max_transmissions) {
  SurfaceView view;
  sight.look_from(end);
  sight.find_facets(scene, outlines, {false, max_transmissions}, true, view.facets);
  std::ranges::sort(view.facets);
  view.shades = Shades(scene, outlines, end, view.facets);
  return view;
}

/// The view of a transmitter, with what it sees of single surfaces as receivers ask for it.
struct LitSurfaces {
  SurfaceView view;
  LitPartsCache parts;
};

}  // namespace dcem
