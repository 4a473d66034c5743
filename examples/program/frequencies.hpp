#pragma once
/// Several frequencies on one command line.
#include <string>
#include <vector>

#include "options.hpp"

namespace dcem::program {

/// The shortest text that is this frequency and no other.
std::string frequency_text(double frequency_hz);

/// The options of each run that is asked for: these, or for several frequencies one a frequency, with results in a
/// folder of its own, named "5.89GHz". With --resume a run that has not begun begins, where another one has. Of several
/// frequencies each is checked before anything is computed at one of them.
std::vector<ScenarioOptions> by_frequency(const ScenarioOptions& options);

}  // namespace dcem::program
