#pragma once
/// What every test program has compiled once: the engine, doctest, and the simulator that most tests use. Headers that stand
/// alone are checked elsewhere (tests/packaging).
#include <doctest/doctest.h>

#include "dcem/dcem.hpp"

extern template class dcem::Simulator<>;  // compiled in simulator_instance.cpp
