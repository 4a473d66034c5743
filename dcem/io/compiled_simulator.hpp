#pragma once
/// The simulator and its verifier with the scene's own materials, compiled once in `dcem::io`. A program that links
/// `dcem::io` may include this in place of `dcem/sim/simulator.hpp` and `dcem/sim/verifier.hpp` and compiles in a
/// fraction of the time; nothing else differs.
#include "dcem/sim/verify/verifier.hpp"

extern template class dcem::Simulator<>;
extern template class dcem::Simulator<dcem::MaterialTable, dcem::BruteForce<double>>;
extern template class dcem::Verifier<>;
