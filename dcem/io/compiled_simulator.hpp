#pragma once
/// The simulator with the scene's own materials, compiled once in `dcem::io`. A program that links `dcem::io` may
/// include this in place of `dcem/sim/simulator.hpp` and compiles in a fraction of the time; nothing else differs.
#include "dcem/sim/simulator.hpp"

extern template class dcem::Simulator<>;
