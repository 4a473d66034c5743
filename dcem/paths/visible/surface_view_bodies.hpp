#pragma once
/// Bodies of surface_view.hpp.
#include <algorithm>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/visible/surface_view.hpp"

namespace dcem {

DCEM_INLINE SurfaceView look_at_surfaces(Sight& sight, const Scene& scene, const FacetOutlines& outlines,
                                         const LinkEnd& end, int max_transmissions) {
  SurfaceView view;
  sight.look_from(end);
  sight.find_facets(scene, outlines, {false, max_transmissions}, true, view.facets);
  std::ranges::sort(view.facets);
  view.shades = Shades(scene, outlines, end, view.facets);
  return view;
}

}  // namespace dcem
