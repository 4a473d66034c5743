#include "dcem/io/src/import/import_draft.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "dcem/io/atomic_file.hpp"
#include "dcem/io/input_error.hpp"
#include "dcem/io/scenario.hpp"
#include "dcem/io/src/import/import_report.hpp"
#include "dcem/io/src/import/town_mesh.hpp"
#include "dcem/io/src/scenario/keys/blocks.hpp"
#include "dcem/io/src/scenario/limits.hpp"
#include "dcem/io/src/text/text_input.hpp"
#include "dcem/io/src/text/unwritten_files.hpp"

namespace dcem::io {

namespace {

constexpr double v2x_frequency_hz = 5.9e9;

struct Look {
  std::string_view beginning, colour;
};

/// Colours of materials, for programs that show the scene.
constexpr std::array<Look, 4> looks{
    {{"roof", "0.55 0.33 0.28"}, {"ground", "0.35 0.38 0.33"}, {"metal", "0.6 0.65 0.7"}, {"wall", "0.75 0.72 0.66"}}};

/// A material by its name: what stands behind `_` is the ITU's ("wall_brick"), without it concrete, whose table reaches
/// from 1 to 100 GHz.
MaterialDraft usual_material(const std::string& name, const std::string& place) {
  std::string colour;
  for (const Look& look : looks) {
    if (name.starts_with(look.beginning)) colour = "Kd " + std::string(look.colour) + '\n';
  }
  MaterialDraft material(name, place, colour);
  material.add("model", name == "metal" ? "pec" : "itu");
  const std::size_t mark = name.find('_');
  if (name != "metal") material.add("itu", mark == std::string::npos ? "concrete" : name.substr(mark + 1));
  return material;
}

/// Where messages say that the frequency comes from.
std::string frequency_place(const ImportDraft& draft, const ImportSettings& settings) {
  const bool is_own = !settings.frequency_hz && !draft.frequency_source.empty();
  return (is_own ? draft.frequency_source : draft.sources.front()).string();
}

double frequency_hz(const ImportDraft& draft, const ImportSettings& settings) {
  return settings.frequency_hz.value_or(draft.frequency_hz.value_or(v2x_frequency_hz));
}

std::string mtl_text(const ImportDraft& draft, const ImportSettings& settings) {
  std::string text = "# Made by dcem import " + draft.importer + '\n';
  std::set<std::string> names = draft.scene.materials();
  if (draft.scenario.contains("mobility") || draft.scenario.contains("objects")) names.insert("metal");
  for (const std::string& name : names) {
    const auto own = draft.materials.find(name);
    const MaterialDraft material =
        own == draft.materials.end() ? usual_material(name, draft.sources.front().string()) : own->second;
    material.check(frequency_hz(draft, settings), frequency_place(draft, settings));
    text += "newmtl " + name + '\n' + material.lines();
  }
  return text;
}

void widen(const std::vector<TownPart>& parts, Vec2& low_m, Vec2& high_m) {
  for (const TownPart& part : parts) {
    for (const Area& area : part.areas) {
      for (const Vec2& corner : area.outer) {
        low_m = glm::min(low_m, corner);
        high_m = glm::max(high_m, corner);
      }
    }
  }
}

/// Forests without the houses in them: a shell of leaves around a house would count twice.
std::vector<TownPart> plan_forests(std::vector<FoundHouse>&& forests, const std::vector<TownPart>& houses,
                                   const ImportSettings& settings, ImportReport& report) {
  std::vector<TownPart> parts = plan_town(std::move(forests), settings, "forests", report);
  std::vector<Areas> outlines, taken;
  for (TownPart& part : parts) outlines.push_back(std::move(part.areas));
  for (const TownPart& house : houses) taken.push_back(house.areas);
  subtract_outlines(outlines, taken);
  std::vector<FoundHouse> rest;
  for (std::size_t index = 0; index < parts.size(); ++index) {
    for (Area& area : outlines[index]) {
      rest.push_back({parts[index].id,
                      {std::move(area.outer)},
                      std::move(area.holes),
                      parts[index].top_m,
                      parts[index].wall,
                      parts[index].roof});
    }
  }
  ImportReport again;  // all faults were counted the first time
  return plan_town(std::move(rest), settings, "forests", again);
}

nlohmann::ordered_json scenario_json(ImportDraft& draft, const ImportSettings& settings) {
  nlohmann::ordered_json scenario{{"format", "dcem-scenario/1"},
                                  {"scene", {{"obj", "scene.obj"}}},
                                  {"frequency_hz", frequency_hz(draft, settings)}};
  if (!draft.geo.is_null()) scenario["geo"] = draft.geo;
  if (!draft.vegetation.empty()) {
    draft.scenario["objects"].push_back(
        {{"id", free_id(draft, "vegetation")}, {"obj", "vegetation.obj"}, {"foliage", true}});
  }
  for (auto& [key, block] : draft.scenario.items()) scenario[key] = std::move(block);
  return scenario;
}

nlohmann::ordered_json whole_report(const ImportDraft& draft, const ImportSettings& settings) {
  nlohmann::ordered_json json{{"format", "dcem-import/1"}, {"importer", draft.importer}};
  for (const auto& source : draft.sources) json["sources"].push_back(source.filename().string());
  json["settings"] = settings_json(settings);
  json["libraries"] = import_libraries();
  json["geo"] = draft.geo;
  json.update(report_json(draft.report));
  return json;
}

/// Where the place on the Earth is known, the grid is in UTM, as such grids are; otherwise in the scene's coordinates.
void read_ground(const std::filesystem::path& file, const Vec2& low_m, const Vec2& high_m, ImportDraft& draft) {
  Terrain terrain = read_terrain(file);
  draft.sources.push_back(file);
  if (!draft.geo.is_null()) {
    terrain.low_m -= Vec2(draft.geo["offset_m"][0].get<double>(), draft.geo["offset_m"][1].get<double>());
  }
  const Vec2 end_m = terrain.high_m();
  if (end_m.x < low_m.x || end_m.y < low_m.y || terrain.low_m.x > high_m.x || terrain.low_m.y > high_m.y) {
    throw InputError(file.string(),
                     "lies elsewhere than the town; expected coordinates in UTM or, where the place on the "
                     "Earth is not known, those of the scene");
  }
  if (terrain.low_m.x > low_m.x || terrain.low_m.y > low_m.y || end_m.x < high_m.x || end_m.y < high_m.y) {
    draft.report.notes.push_back("The terrain does not reach as far as the town: beyond its rim there is no ground.");
  }
  if (terrain.without_value > 0) draft.report.repaired["cells of the terrain without a height"] = terrain.without_value;
  draft.report.notes.push_back("Height 0 of the scene is " + number_text(terrain.lowest_m) + " m of the terrain.");
  draft.terrain = std::move(terrain);
}

std::vector<TownPart> build_outlines(FoundTown&& town, Vec2 low_m, Vec2 high_m, const ImportSettings& settings,
                                     const std::filesystem::path& source, ImportDraft& draft) {
  ImportReport& report = draft.report;
  report.read["houses"] += town.houses.size();
  if (!town.forests.empty()) report.read["forests"] += town.forests.size();
  std::vector<TownPart> parts = plan_town(std::move(town.houses), settings, "houses", report);
  if (parts.empty()) throw InputError(source.string(), "holds no building with an area; expected at least one");
  std::vector<TownPart> forests = plan_forests(std::move(town.forests), parts, settings, report);
  widen(parts, low_m, high_m);
  widen(forests, low_m, high_m);
  low_m -= Vec2(settings.ground_margin_m);
  high_m += Vec2(settings.ground_margin_m);
  if (glm::length(glm::max(glm::abs(low_m), glm::abs(high_m))) > farthest_coordinate_m) {
    throw InputError(source.string(), "reaches farther than 1e9 m from its origin; expected a town");
  }
  if (settings.terrain.empty()) {
    add_flat_ground(low_m, high_m, draft.scene);
  } else {
    read_ground(settings.terrain, low_m, high_m, draft);
    settle(parts, *draft.terrain);
    settle(forests, *draft.terrain);
    add_terrain(*draft.terrain, low_m, high_m, draft.scene);
  }
  add_town(parts, Foot::open, draft.scene, report);
  ImportReport of_forests;
  add_town(forests, Foot::closed, draft.vegetation, of_forests);
  if (!forests.empty()) report.made["forests"] = forests.size();
  return parts;
}

using NamedTexts = std::vector<std::pair<std::string, std::string>>;

/// All files in the order in which they appear.
NamedTexts all_texts(ImportDraft& draft, const ImportSettings& settings) {
  const std::string comment = "Made by dcem import " + draft.importer;
  NamedTexts texts{{"scene.obj", draft.scene.text(comment, "scene.mtl")}, {"scene.mtl", mtl_text(draft, settings)}};
  if (!draft.vegetation.empty()) texts.emplace_back("vegetation.obj", draft.vegetation.text(comment, "scene.mtl"));
  draft.report.made["triangles or polygons"] = draft.scene.faces() + draft.vegetation.faces();
  texts.emplace_back("scenario.json", scenario_json(draft, settings).dump(1) + '\n');
  texts.emplace_back("report.json", whole_report(draft, settings).dump(1) + '\n');
  return texts;
}

/// Importers look at what they read where it stands. What they overlook must not become a scenario that does not run.
void check_loads(const ImportDraft& draft, const NamedTexts& texts, const std::filesystem::path& folder) {
  UnwrittenFiles::Texts files;
  for (const auto& [name, text] : texts) files.emplace(folder / name, text);
  const UnwrittenFiles unwritten(std::move(files));
  try {
    load_scenario(folder / "scenario.json");
  } catch (const InputError& error) {
    const std::string more = draft.sources.size() > 1 ? "and what was read with it " : "";
    throw InputError(draft.sources.front().string(), more + "would become a scenario that does not run (" +
                                                         std::string(error.what()) +
                                                         "); expected a source of one that does");
  }
}

}  // namespace

std::vector<TownPart> build_town(FoundTown&& town, Vec2 low_m, Vec2 high_m, const ImportSettings& settings,
                                 const std::filesystem::path& source, ImportDraft& draft) {
  try {
    return build_outlines(std::move(town), low_m, high_m, settings, source, draft);
  } catch (const InputError&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw InputError(source.string(),
                     "outlines that cannot be joined (" + printable(error.what()) + "); expected a map of a town");
  }
}

ImportReport write_import(ImportDraft&& draft, const std::filesystem::path& folder, const ImportSettings& settings) {
  OutputFolder files(folder);
  const NamedTexts texts = all_texts(draft, settings);
  check_loads(draft, texts, files.path());
  for (const auto& [name, text] : texts) files.open(name).write(text);
  files.commit(draft.vegetation.empty() ? std::vector<std::string>{"vegetation.obj"} : std::vector<std::string>{});
  return std::move(draft.report);
}

void require_outlines(const std::filesystem::path& source) {
  if (can_shape_outlines()) return;
  throw InputError(source.string(),
                   "this build cannot import outlines of buildings; expected GEOS (libgeos-dev) when DCEM was built");
}

void check_settings(const ImportSettings& settings, const std::filesystem::path& source) {
  const auto check = [&](const char* name, double value, NumberRange range) {
    if (range.holds(value)) return;
    throw InputError(source.string(),
                     std::string(name) + ": found " + number_text(value) + "; expected " + range.text());
  };
  check("default height", settings.default_height_m, {0.0, 1000.0, true});
  check("height of a storey", settings.level_height_m, {0.0, 100.0, true});
  check("height of trees", settings.tree_height_m, {0.0, 200.0, true});
  check("margin of the ground", settings.ground_margin_m, {0.0, 1e5});
  check("snap tolerance", settings.snap_tolerance_m, {0.001, 10.0});
  check("smallest house", settings.smallest_house_m2, {0.01, 1e6});
  const keys::KeyRule* frequency = keys::find_key(keys::scenario_block(), "frequency_hz");
  check("frequency", settings.frequency_hz.value_or(v2x_frequency_hz),
        keys::find_form(frequency->forms, keys::ValueKind::number)->range);
}

nlohmann::ordered_json geo_json(const UtmZone& zone, const Vec2& utm_m, const std::filesystem::path& source,
                                const std::string& place) {
  GeoPoint origin;
  try {
    origin = geo_point(utm_m, zone);
  } catch (const std::invalid_argument& error) {
    throw InputError(source.string(), place + ": " + error.what());
  }
  return {{"origin_lat_deg", origin.latitude_deg},
          {"origin_lon_deg", origin.longitude_deg},
          {"crs", zone.name()},
          {"offset_m", {utm_m.x, utm_m.y}}};
}

double roof_height_m(const std::vector<TownPart>& parts, const Vec2& point_m) {
  for (const TownPart& part : parts) {
    for (const Area& area : part.areas) {
      if (holds_point(area, point_m)) return part.top_m;
    }
  }
  return 0.0;
}

double ground_m(const ImportDraft& draft, const Vec2& point_m) {
  return draft.terrain ? draft.terrain->height_m(point_m) : 0.0;
}

nlohmann::ordered_json mast_json(const ImportDraft& draft, const std::vector<TownPart>& parts, const Vec2& point_m) {
  const double height_m = std::max(ground_m(draft, point_m) + 25.0, roof_height_m(parts, point_m) + 5.0);
  return {{"id", free_id(draft, "mast")}, {"position_m", {point_m.x, point_m.y, height_m}}, {"power_dbm", 30}};
}

nlohmann::ordered_json town_propagation_json() {
  return {{"max_reflections", 2}, {"max_transmissions", 0}, {"max_diffractions", 1}, {"max_interactions", 2}};
}

std::string free_id(const ImportDraft& draft, std::string id) {
  while (draft.vehicles.contains(id)) id += '_';
  return id;
}

std::string name_from(const std::filesystem::path& folder, const std::filesystem::path& file) {
  std::error_code ignored;  // where links cannot be followed, the names alone count
  const auto real = [&](const std::filesystem::path& path) {
    const std::filesystem::path plain = std::filesystem::absolute(path);  // '..' leads back from where a link leads
    const std::filesystem::path followed = std::filesystem::weakly_canonical(plain, ignored);
    return ignored ? plain.lexically_normal() : followed;
  };
  const std::filesystem::path from = real(folder.empty() ? "." : folder);
  return (real(std::filesystem::absolute(file).parent_path()) / file.filename())
      .lexically_relative(from)
      .generic_string();
}

}  // namespace dcem::io
