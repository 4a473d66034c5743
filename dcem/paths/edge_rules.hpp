#pragma once
/// Which edges diffract, and where around them.
#include "dcem/core/units.hpp"
#include "dcem/scene/world_geometry.hpp"

namespace dcem {

struct EdgeRules {
  double min_exterior_angle_rad = degrees_to_radians(190.0);  ///< flatter edges do not diffract
  bool free_edges = false;                                    ///< the rims of open sheets diffract as half planes
  bool shadow_only = false;  ///< only where the wedge itself hides one neighbour from the other
};

inline bool diffracts(const WorldWedge& wedge, const EdgeRules& rules) {
  return wedge.present &&
         (is_free(wedge.edge) ? rules.free_edges : wedge.edge.exterior_angle_rad >= rules.min_exterior_angle_rad);
}

}  // namespace dcem
