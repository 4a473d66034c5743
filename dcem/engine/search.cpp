// What an end of a link sees and lists, and how a scene is searched.
#include "dcem/paths/halves/beam_finder_bodies.hpp"
#include "dcem/paths/halves/crowd_beams_bodies.hpp"
#include "dcem/paths/halves/facet_outlines_bodies.hpp"
#include "dcem/paths/halves/sight_bodies.hpp"
#include "dcem/paths/halves/view_map_bodies.hpp"
#include "dcem/sim/discovery_bodies.hpp"
#include "dcem/sim/link_choice_bodies.hpp"
#include "dcem/sim/search_size_bodies.hpp"
