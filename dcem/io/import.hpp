#pragma once
/// Other people's scenes made into scenarios: SUMO, GEMV², Sionna RT, OpenStreetMap.
///
/// Each importer writes `scene.obj`, `scene.mtl`, `scenario.json` and `report.json` (and `vegetation.obj` where
/// something grows) into a folder, all of them or none; `scenario.json` runs as it is. What is damaged beyond repair is
/// an InputError with file and line; what is merely dirty is repaired or skipped, and counted.
#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace dcem::io {

/// How houses that touch become one block. Either way they share no wall.
enum class TouchingHouses {
  unite,  ///< those of one height and one material become one house; between two heights only the step is a wall
  snap    ///< each keeps its own roof; between two heights only the step is a wall
};

struct ImportSettings {
  double default_height_m = 9.0;   ///< of buildings that say neither height nor levels
  double level_height_m = 3.0;     ///< of a storey
  double tree_height_m = 12.0;     ///< of forests that do not say theirs
  double ground_margin_m = 50.0;   ///< of ground around everything
  double snap_tolerance_m = 0.1;   ///< outlines no further apart touch
  double smallest_house_m2 = 1.0;  ///< footprints below are left out
  TouchingHouses touching = TouchingHouses::unite;
  std::optional<double> frequency_hz;  ///< of the scenario; absent: as the source says, else 5.9 GHz (Sionna: 3.5 GHz)
  std::filesystem::path terrain;       ///< an ASCII grid of ESRI; empty: the ground is flat, at 0. Not for Sionna
};

/// What became of the input, each count by its reason.
struct ImportReport {
  using Counts = std::map<std::string, std::size_t>;
  Counts read, repaired, skipped, made;
  std::map<std::string, double> sizes;  ///< "footprint_area_m2", "volume_m3"
  std::vector<std::string> notes;       ///< one sentence each: what the user should know
};

/// Files of a SUMO scenario; those that are empty are taken from the configuration, where there is one.
struct SumoFiles {
  std::filesystem::path network;   ///< a .sumocfg or a .net.xml
  std::filesystem::path polygons;  ///< .poly.xml
  std::filesystem::path trace;     ///< FCD
  std::vector<std::filesystem::path> additional;
};

// All of these throw InputError and OutputError.

ImportReport import_sumo(const SumoFiles& files, const std::filesystem::path& folder,
                         const ImportSettings& settings = {});
/// A folder with outlines of buildings and vehicles and the links between these, as tables.
ImportReport import_gemv2(const std::filesystem::path& source, const std::filesystem::path& folder,
                          const ImportSettings& settings = {});
/// A scene of Mitsuba (XML with PLY meshes) with radio materials.
ImportReport import_sionna(const std::filesystem::path& scene, const std::filesystem::path& folder,
                           const ImportSettings& settings = {});
/// OpenStreetMap as XML (.osm, .osm.gz) or PBF.
ImportReport import_osm(const std::filesystem::path& map, const std::filesystem::path& folder,
                        const ImportSettings& settings = {});

/// The report for people: a line for each count.
std::string import_text(const ImportReport& report);
/// What this build imports with, for `dcem --version`: "GEOS 3.11.1, GeographicLib 2.1.2, libosmium 2.19.0".
std::string import_libraries();

}  // namespace dcem::io
