#pragma once
/// The settings of a run as JSON, for the summary. Private to dcem::io.
#include <nlohmann/json.hpp>

#include "dcem/io/summary.hpp"

namespace dcem::io {

/// What was really in force, with the defaults of this version.
nlohmann::ordered_json settings_json(const RunFacts& facts);

}  // namespace dcem::io
