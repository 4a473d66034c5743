#pragma once
/// What every test program parses once: doctest, and the headers that most tests include themselves. That headers stand
/// alone is checked elsewhere (tests/packaging).
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "dcem/accel/wide_index.hpp"
#include "dcem/dcem.hpp"
#include "dcem/em/surface/material_table.hpp"
#include "dcem/field/field_evaluator.hpp"
#include "dcem/paths/path_finder.hpp"
