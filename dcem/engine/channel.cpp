// What is made of paths.
#include "dcem/channel/cell_average_bodies.hpp"
#include "dcem/channel/link_statistics_bodies.hpp"
#include "dcem/field/diffuse/scatter_ways_bodies.hpp"
