#pragma once
/// What every test program parses once: the engine, doctest, and the simulator that most tests use, compiled in
/// dcem::io. That headers stand alone is checked elsewhere (tests/packaging).
#include <doctest/doctest.h>

#include "dcem/dcem.hpp"
#include "dcem/io/compiled_simulator.hpp"
