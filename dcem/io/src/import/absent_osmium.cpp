// In place of osmium_pbf.cpp where there is no libosmium.
#include <stdexcept>

#include "dcem/io/src/import/osm_pbf.hpp"

namespace dcem::io {

bool can_read_pbf() {
  return false;
}

std::string pbf_library() {
  return "no libosmium (PBF)";
}

OsmData read_osm_pbf(const std::filesystem::path&) {
  throw std::logic_error("read_osm_pbf needs libosmium");
}

}  // namespace dcem::io
