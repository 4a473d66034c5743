// What is made of paths.
#include "dcem/channel/cell_average_bodies.hpp"
