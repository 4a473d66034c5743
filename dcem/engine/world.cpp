// What a scene is made of.
#include "dcem/em/antenna/pattern_table_bodies.hpp"
#include "dcem/em/surface/material_bodies.hpp"
#include "dcem/em/surface/material_table_bodies.hpp"
#include "dcem/geometry/surfaces/build_surface_mesh_bodies.hpp"
#include "dcem/scene/scene_bodies.hpp"
#include "dcem/world/motion_bodies.hpp"
#include "dcem/world/world_geometry_bodies.hpp"
