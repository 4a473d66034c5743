// The simulator over the wide tree.
#include "dcem/sim/settings_bodies.hpp"
#include "dcem/sim/simulator_bodies.hpp"

template class dcem::BasicSimulator<dcem::MaterialTable, dcem::WideIndex>;
