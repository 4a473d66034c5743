#pragma once
/// SUMO's networks, polygons and configurations, as far as a scene is made of them. Private to dcem::io.
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "dcem/io/src/geo/utm.hpp"
#include "dcem/io/src/import/outlines.hpp"

namespace dcem::io {

/// How a file's coordinates lie on the Earth.
struct SumoLocation {
  Vec2 net_offset_m{0.0};  ///< added to projected coordinates
  Vec2 low_m{0.0}, high_m{0.0};
  std::string projection;  ///< "+proj=utm +zone=32 …", or "!"

  /// Nothing where it is no UTM.
  std::optional<UtmZone> zone() const;
};

struct SumoPolygon {
  std::string id, type;
  Ring shape;  ///< in metres, or degrees where `is_geo`
  bool is_geo = false;
  std::map<std::string, std::string> parameters;  ///< `param` elements: OpenStreetMap's tags
};

/// What stands in a network, a file of polygons or an additional file.
struct SumoContents {
  std::string root;  ///< the outermost element
  std::optional<SumoLocation> location;
  std::vector<SumoPolygon> polygons;
  std::vector<Ring> lanes;              ///< shapes of lanes outside of junctions
  std::set<std::string> vehicle_types;  ///< ids
  std::size_t points_of_interest = 0;

  /// Whether anything in it goes into a scene, or is left out by name.
  bool says_something() const { return !polygons.empty() || !vehicle_types.empty() || points_of_interest > 0; }
};

/// Reads the file, plain or .gz. Throws InputError with the line.
SumoContents read_sumo_file(const std::filesystem::path& file, const std::string& expectation);

/// Files that a .sumocfg names, relative to it.
struct SumoConfiguration {
  std::vector<std::filesystem::path> networks, routes, additional, traces;
};
SumoConfiguration read_sumo_configuration(const std::filesystem::path& file);

}  // namespace dcem::io
