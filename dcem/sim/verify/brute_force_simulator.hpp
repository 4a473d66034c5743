#pragma once
/// The simulator that asks every triangle: slow, and nothing in it that a tree could have missed.
#include "dcem/accel/brute_force_index.hpp"
#include "dcem/sim/basic_simulator.hpp"

namespace dcem {

using BruteForceSimulator = BasicSimulator<MaterialTable, BruteForceIndex>;

}  // namespace dcem

#if defined(DCEM_ENGINE)
extern template class dcem::BasicSimulator<dcem::MaterialTable, dcem::BruteForceIndex>;
#endif
