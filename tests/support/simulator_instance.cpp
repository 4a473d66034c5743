/// The simulator that most tests use, compiled once for all files of all test programs (see precompiled.hpp).
#include "dcem/dcem.hpp"

template class dcem::Simulator<>;
