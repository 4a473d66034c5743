#include "dcem/io/compiled_simulator.hpp"

template class dcem::Simulator<>;
