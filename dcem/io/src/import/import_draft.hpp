#pragma once
/// What every importer puts together and writes. Private to dcem::io.
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "dcem/io/import.hpp"
#include "dcem/io/src/geo/utm.hpp"
#include "dcem/io/src/import/city_plan.hpp"
#include "dcem/io/src/import/material_draft.hpp"
#include "dcem/io/src/import/obj_draft.hpp"
#include "dcem/io/src/import/terrain.hpp"

namespace dcem::io {

struct ImportDraft {
  std::string importer;                        ///< "sumo"
  std::vector<std::filesystem::path> sources;  ///< files that were read
  ObjDraft scene, vegetation;
  std::set<std::string> vehicles;                  ///< of a trace: ids that nothing else may have
  std::map<std::string, MaterialDraft> materials;  ///< by their names; others are made by their names
  std::optional<double> frequency_hz;              ///< as the source says, or the program that it is for
  std::filesystem::path frequency_source;          ///< the file that says it; empty: the first source
  nlohmann::ordered_json scenario;                 ///< blocks of the importer's own
  nlohmann::ordered_json geo;                      ///< where the scene lies; null where that is not known
  ImportReport report;
  std::optional<Terrain> terrain;  ///< in the scene's coordinates; absent: flat
};

/// What stands and grows in a town.
struct FoundTown {
  std::vector<FoundHouse> houses;
  std::vector<FoundHouse> forests;
};

/// Parts with walls and roofs, vegetation, and the ground around these and the box from `low_m` to `high_m`. Returns
/// the parts. `draft.geo` must be known before. Throws InputError with the name of `source` where nothing stands there.
std::vector<TownPart> build_town(FoundTown&& town, Vec2 low_m, Vec2 high_m, const ImportSettings& settings,
                                 const std::filesystem::path& source, ImportDraft& draft);

/// `scene`, `frequency_hz`, `objects` for vegetation and so on around the importer's blocks; all files appear at once.
/// The scenario is read before, as for a run: what `dcem run` would refuse to load is not written. Throws OutputError,
/// and InputError with the name of a source.
ImportReport write_import(ImportDraft&& draft, const std::filesystem::path& folder, const ImportSettings& settings);

/// Throws InputError where this build has no GEOS.
void require_outlines(const std::filesystem::path& source);
/// Throws InputError where settings make no sense for any file.
void check_settings(const ImportSettings& settings, const std::filesystem::path& source);

/// Where the scene's (0, 0) lies; `utm_m` are its easting and northing, which `place` of the source says. Throws
/// InputError where the zone has no such place.
nlohmann::ordered_json geo_json(const UtmZone& zone, const Vec2& utm_m, const std::filesystem::path& source,
                                const std::string& place);

/// The height of the part that holds a point; 0 in the open.
double roof_height_m(const std::vector<TownPart>& parts, const Vec2& point_m);

/// The height of the ground; 0 where it is flat.
double ground_m(const ImportDraft& draft, const Vec2& point_m);

/// A transmitter above the roof at this point, at least 25 m above the ground.
nlohmann::ordered_json mast_json(const ImportDraft& draft, const std::vector<TownPart>& parts, const Vec2& point_m);
/// Orders of paths that a town can be run with at once.
nlohmann::ordered_json town_propagation_json();

/// This id, or one like it that no vehicle has.
std::string free_id(const ImportDraft& draft, std::string id);

/// A file's name as a scenario in `folder` refers to it.
std::string name_from(const std::filesystem::path& folder, const std::filesystem::path& file);

}  // namespace dcem::io
