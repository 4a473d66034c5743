#pragma once
/// OpenStreetMap's binary format. Private to dcem::io.
#include <filesystem>
#include <string>

#include "dcem/io/src/import/osm_data.hpp"

namespace dcem::io {

bool can_read_pbf();
/// "libosmium 2.19.0", or that there is none.
std::string pbf_library();

/// Throws InputError. Without libosmium std::logic_error: importers ask `can_read_pbf` first.
OsmData read_osm_pbf(const std::filesystem::path& file);

}  // namespace dcem::io
