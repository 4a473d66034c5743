// The verifier, what tells what rays lack, and the simulator that asks every triangle.
#include "dcem/sim/verify/sampling_check_bodies.hpp"
#include "dcem/sim/verify/verification_report_bodies.hpp"
#include "dcem/sim/verify/verifier_bodies.hpp"

template class dcem::BasicSimulator<dcem::MaterialTable, dcem::BruteForceIndex>;
