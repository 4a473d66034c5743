#include "dcem/io/compiled_simulator.hpp"

template class dcem::Simulator<>;
template class dcem::Simulator<dcem::MaterialTable, dcem::BruteForce<double>>;
template class dcem::Verifier<>;
