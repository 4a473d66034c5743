#pragma once
/// What tags of OpenStreetMap say of a building. Private to dcem::io.
#include <map>
#include <string>

#include "dcem/io/import.hpp"
#include "dcem/io/src/import/city_plan.hpp"

namespace dcem::io {

/// Height and materials by `height`, `building:levels` (with `roof:levels`), `building:material`, `roof:material`, else
/// the defaults. Counts in the report what the height came from, and what is no height.
void apply_tags(const std::map<std::string, std::string>& tags, const ImportSettings& settings, FoundHouse& house,
                ImportReport& report);

/// The height of what grows: `height`, else the default.
double tree_height_m(const std::map<std::string, std::string>& tags, const ImportSettings& settings,
                     ImportReport& report);

}  // namespace dcem::io
