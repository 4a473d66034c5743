#pragma once
/// What an OpenStreetMap file holds, as far as buildings and forests are made of it. Private to dcem::io.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <unordered_map>
#include <vector>

#include "dcem/io/src/geo/utm.hpp"

namespace dcem::io {

using OsmTags = std::map<std::string, std::string>;

struct OsmWay {
  std::int64_t id = 0;
  std::vector<std::int64_t> nodes;
  OsmTags tags;
};

/// A multipolygon, or a building with its parts.
struct OsmRelation {
  struct Member {
    std::int64_t way = 0;
    std::string role;
  };
  std::int64_t id = 0;
  std::vector<Member> members;
  OsmTags tags;
};

struct OsmData {
  std::unordered_map<std::int64_t, GeoPoint> nodes;
  std::vector<OsmWay> ways;
  std::vector<OsmRelation> relations;
};

/// Reads XML, plain or .gz. Throws InputError with the line.
OsmData read_osm_xml(const std::filesystem::path& file);

/// Whether tags speak of anything that is kept: buildings, their parts, what grows.
bool is_kept(const OsmTags& tags);
/// Keys that are kept of a way or a relation; nodes have none.
bool is_kept_key(const std::string& key);

}  // namespace dcem::io
