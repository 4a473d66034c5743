#include <algorithm>
#include <array>
#include <string_view>

#include "dcem/io/import.hpp"
#include "dcem/io/input_error.hpp"
#include "dcem/io/src/import/import_draft.hpp"
#include "dcem/io/src/import/osm_heights.hpp"
#include "dcem/io/src/import/sumo_files.hpp"
#include "dcem/io/src/text/text_input.hpp"
#include "dcem/io/src/traffic/trace_survey.hpp"

namespace dcem::io {

namespace {

constexpr std::size_t most_points = 10;

/// Outermost elements of files that SUMO and its tools write. SUMO itself takes any.
constexpr std::array<std::string_view, 4> usual_roots{"additional", "add", "routes", "shapes"};

bool is_forest(const std::string& type) {
  return type == "forest" || type == "wood" || type == "natural.wood" || type == "landuse.forest";
}

class SumoImport {
 public:
  SumoImport(const SumoFiles& files, const std::filesystem::path& folder, const ImportSettings& settings)
      : files_(files), folder_(folder), settings_(settings) {
    draft_.importer = "sumo";
  }

  ImportReport run() {
    read_configuration();
    const SumoContents network = read_network();
    location_ = network.location;
    read_polygons();
    place_on_earth();
    if (polygons_.empty()) throw InputError(place_of_polygons(), "no polygons; expected buildings (--poly FILE)");
    const Vec2 low_m = location_->low_m, high_m = location_->high_m;
    const std::vector<TownPart> parts = build_town(sort_polygons(), low_m, high_m, settings_, files_.polygons, draft_);
    draft_.scenario["propagation"] = town_propagation_json();
    if (files_.trace.empty()) {
      add_probes(network.lanes, parts);
    } else {
      add_traffic(parts);
    }
    return write_import(std::move(draft_), folder_, settings_);
  }

 private:
  /// What the user names counts; the configuration says the rest.
  void read_configuration() {
    named_ = files_.additional;
    std::string name = files_.network.filename().string();
    if (name.find(".sumocfg") == std::string::npos) return;
    const SumoConfiguration configuration = read_sumo_configuration(files_.network);
    draft_.sources.push_back(files_.network);
    if (configuration.networks.size() != 1) {
      throw InputError(files_.network.string(),
                       "names " + std::to_string(configuration.networks.size()) + " networks; expected one net-file");
    }
    files_.network = configuration.networks.front();
    std::error_code ignored;
    if (files_.trace.empty() && !configuration.traces.empty() &&
        std::filesystem::exists(configuration.traces.front(), ignored)) {
      files_.trace = configuration.traces.front();
    }
    for (const auto* list : {&configuration.additional, &configuration.routes}) {
      files_.additional.insert(files_.additional.end(), list->begin(), list->end());
    }
  }

  SumoContents read_network() {
    draft_.sources.push_back(files_.network);
    SumoContents network = read_sumo_file(files_.network, "expected a SUMO network (.net.xml) or configuration");
    if (!network.location) {
      throw InputError(files_.network.string(), "holds no location; expected a SUMO network with netOffset");
    }
    if (network.root != "net") {
      throw InputError(files_.network.string(), "the root element is " + in_quotes(network.root) +
                                                    "; expected net, a SUMO network, or a .sumocfg by its name");
    }
    draft_.report.read["lanes"] = network.lanes.size();
    return network;
  }

  void read_polygons() {
    if (!files_.polygons.empty() && add_contents(files_.polygons) == 0) {
      throw InputError(files_.polygons.string(), "holds no polygons; expected SUMO's (poly elements)");
    }
    for (const std::filesystem::path& file : files_.additional) add_contents(file);
    if (files_.polygons.empty()) files_.polygons = files_.network;  // what messages speak of
  }

  /// What a configuration names may be of no interest here; what the user names is meant.
  void check_of_use(const std::filesystem::path& file, const SumoContents& contents) {
    if (contents.says_something() || std::ranges::count(named_, file) == 0) return;
    if (std::ranges::count(usual_roots, contents.root) == 0) {
      throw InputError(file.string(), "the root element is " + in_quotes(contents.root) +
                                          "; expected additional or routes, with polygons or vehicle types");
    }
    ++draft_.report.skipped["additional files without polygons and vehicle types"];
  }

  /// Returns how many polygons the file holds.
  std::size_t add_contents(const std::filesystem::path& file) {
    SumoContents contents = read_sumo_file(file, "expected a SUMO additional file");
    check_of_use(file, contents);
    draft_.sources.push_back(file);
    const Vec2 shift_m = shift_of(contents);
    for (SumoPolygon& polygon : contents.polygons) {
      if (!polygon.is_geo) {
        for (Vec2& corner : polygon.shape) corner += shift_m;
      }
      polygons_.push_back(std::move(polygon));
    }
    if (contents.points_of_interest > 0) draft_.report.skipped["points of interest"] += contents.points_of_interest;
    add_types(file, contents.vehicle_types);
    return contents.polygons.size();
  }

  /// Polygons may have been made with another offset than the network.
  Vec2 shift_of(const SumoContents& contents) {
    if (!contents.location || contents.location->projection != location_->projection) return Vec2(0.0);
    const Vec2 shift_m = location_->net_offset_m - contents.location->net_offset_m;
    if (shift_m != Vec2(0.0)) draft_.report.repaired["files of polygons with another netOffset"] += 1;
    return shift_m;
  }

  /// Routes repeat types that additional files define: a file that brings nothing new is left out.
  void add_types(const std::filesystem::path& file, const std::set<std::string>& types) {
    const bool brings_new =
        std::any_of(types.begin(), types.end(), [&](const std::string& type) { return !known_types_.contains(type); });
    if (!brings_new) return;
    known_types_.insert(types.begin(), types.end());
    type_files_.push_back(file);
  }

  void place_on_earth() {
    zone_ = location_->zone();
    if (!zone_ || !knows_utm()) {
      draft_.report.notes.push_back(zone_ ? "The place on the Earth is not worked out: this build has no GeographicLib."
                                          : "The place on the Earth is not known: the projection is not UTM.");
      zone_.reset();
      return;
    }
    draft_.geo = geo_json(*zone_, -location_->net_offset_m, files_.network, "location: netOffset");
  }

  std::string place_of_polygons() const { return files_.polygons.string(); }

  FoundTown sort_polygons() {
    FoundTown town;
    for (SumoPolygon& polygon : polygons_) {
      const bool is_house = polygon.type.starts_with("building") || polygon.parameters.contains("building");
      if (!is_house && !is_forest(polygon.type)) {
        ++draft_.report.skipped["polygons of type '" + polygon.type + "'"];
        continue;
      }
      if (polygon.is_geo && !to_plane(polygon)) continue;
      FoundHouse found{polygon.id, {std::move(polygon.shape)}, {}};
      if (is_house) {
        apply_tags(polygon.parameters, settings_, found, draft_.report);
        town.houses.push_back(std::move(found));
      } else {
        found.height_m = tree_height_m(polygon.parameters, settings_, draft_.report);
        found.wall = found.roof = "foliage";
        town.forests.push_back(std::move(found));
      }
    }
    return town;
  }

  bool to_plane(SumoPolygon& polygon) {
    if (!zone_) {
      ++draft_.report.skipped["polygons in longitude and latitude"];
      return false;
    }
    for (Vec2& corner : polygon.shape) {
      if (std::abs(corner.x) > 180.0 || std::abs(corner.y) > 84.0) {
        throw InputError(
            place_of_polygons(),
            "poly '" + polygon.id + "': a corner is no longitude and latitude; expected " + "degrees, with geo=\"1\"");
      }
      corner = utm_m({corner.y, corner.x}, *zone_) + location_->net_offset_m;
    }
    return true;
  }

  VehicleTypes vehicle_types() const {
    VehicleTypes types;
    for (const std::filesystem::path& file : type_files_) types.read(file);
    return types;
  }

  void add_traffic(const std::vector<TownPart>& parts) {
    draft_.sources.push_back(files_.trace);
    nlohmann::ordered_json mobility{{"sumo_fcd", name_from(folder_, files_.trace)}, {"material", "metal"}};
    for (const auto& file : type_files_) mobility["vehicle_types"].push_back(name_from(folder_, file));
    const TraceSurvey survey = survey_trace(files_.trace, vehicle_types(), {{}, true, anchor()});
    FcdStep first;
    FcdReader(files_.trace, xml_chunk_bytes, survey.traffic.degrees).next(first);
    if (first.vehicles.empty()) {
      throw InputError(files_.trace.string(), first.line,
                       "no vehicle in the first step; expected some to carry devices");
    }
    for (const auto& [id, type] : survey.traffic.types_of_vehicles) draft_.vehicles.insert(id);
    draft_.report.read["steps of the trace"] = survey.step_times_s.size();
    draft_.report.read["types of vehicles in the trace"] = survey.traffic.types.size();
    mobility["devices"] = {{"vehicles", equipped(survey.traffic.types_of_vehicles.size())},
                           {"height_above_roof_m", 0.1},
                           {"power_dbm", 23}};
    draft_.scenario["links"] = {{"range_m", 150}};
    draft_.scenario["transmitters"] = nlohmann::ordered_json::array({mast_json(draft_, parts, middle_of(first))});
    draft_.scenario["mobility"] = std::move(mobility);
  }

  /// Where the network lies on the Earth, as far as that is known.
  std::optional<GeoAnchor> anchor() const {
    if (!zone_) return std::nullopt;
    return UtmFrame{zone_->number, zone_->is_north, {-location_->net_offset_m.x, -location_->net_offset_m.y}};
  }

  /// All of a few vehicles, some 40 of many.
  nlohmann::ordered_json equipped(std::size_t vehicles) {
    constexpr std::size_t most = 40;
    const bool all = vehicles <= most;
    draft_.report.notes.push_back("A mast and devices on " + std::string(all ? "all" : "a share of the") + " " +
                                  std::to_string(vehicles) +
                                  " vehicles, with links within 150 m, were chosen for a start: edit transmitters, "
                                  "mobility.devices and links.");
    if (all) return "all";
    return {{"share", static_cast<double>(most) / static_cast<double>(vehicles)}, {"seed", 1}};
  }

  static Vec2 middle_of(const FcdStep& step) {
    std::vector<double> x_m, y_m;
    for (const FcdVehicle& vehicle : step.vehicles) {
      x_m.push_back(vehicle.x_m);
      y_m.push_back(vehicle.y_m);
    }
    const auto median = [](std::vector<double>& values) {
      const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
      std::nth_element(values.begin(), middle, values.end());
      return *middle;
    };
    return {median(x_m), median(y_m)};
  }

  /// Without traffic: receivers on streets.
  void add_probes(const std::vector<Ring>& lanes, const std::vector<TownPart>& parts) {
    if (lanes.empty()) throw InputError(files_.network.string(), "holds no lane; expected a network with streets");
    nlohmann::ordered_json points = nlohmann::ordered_json::array();
    const std::size_t stride = std::max<std::size_t>(1, lanes.size() / most_points);
    for (std::size_t lane = 0; lane < lanes.size() && points.size() < most_points; lane += stride) {
      const Vec2 middle = 0.5 * (lanes[lane][0] + lanes[lane][1]);
      points.push_back({middle.x, middle.y, ground_m(draft_, middle) + 1.5});
    }
    const Vec2 middle = 0.5 * (location_->low_m + location_->high_m);
    draft_.scenario["transmitters"] = nlohmann::ordered_json::array({mast_json(draft_, parts, middle)});
    draft_.scenario["receivers"] = nlohmann::ordered_json::array({{{"id", "street"}, {"positions_m", points}}});
    draft_.report.notes.push_back(
        "One mast and points on streets were chosen for a start: edit transmitters and receivers.");
  }

  SumoFiles files_;
  std::filesystem::path folder_;
  const ImportSettings& settings_;
  ImportDraft draft_;
  std::optional<SumoLocation> location_;
  std::optional<UtmZone> zone_;
  std::vector<SumoPolygon> polygons_;
  std::set<std::string> known_types_;
  std::vector<std::filesystem::path> type_files_;
  std::vector<std::filesystem::path> named_;  ///< additional files that the user names
};

}  // namespace

ImportReport import_sumo(const SumoFiles& files, const std::filesystem::path& folder, const ImportSettings& settings) {
  check_settings(settings, files.network);
  require_outlines(files.network);
  return SumoImport(files, folder, settings).run();
}

}  // namespace dcem::io
