#pragma once
/// The report of an import as JSON. Private to dcem::io.
#include <nlohmann/json.hpp>

#include "dcem/io/import.hpp"

namespace dcem::io {

/// Settings that bear on the result, with what they mean.
nlohmann::ordered_json settings_json(const ImportSettings& settings);
nlohmann::ordered_json report_json(const ImportReport& report);

}  // namespace dcem::io
