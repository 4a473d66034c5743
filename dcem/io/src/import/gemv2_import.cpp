#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <stdexcept>

#include "dcem/io/import.hpp"
#include "dcem/io/input_error.hpp"
#include "dcem/io/src/import/import_draft.hpp"
#include "dcem/io/src/text/csv_reader.hpp"
#include "dcem/io/src/text/unicode.hpp"

namespace dcem::io {

namespace {

constexpr NumberRange any_place_m{-1e7, 1e7};

/// GEMV²'s default heights of vehicles; the long ones are vans, lorries and buses.
constexpr double car_height_m = 1.5, lorry_height_m = 3.0, longest_car_m = 8.0;
/// GEMV²: antennas stand so high above the roof.
constexpr double antenna_above_roof_m = 0.1;

struct NamedRing {
  std::string name;
  Ring ring;
};

struct LinkEnd {
  Vec2 place_m{0.0};
  double antenna_height_m = 0.0;
};

struct LinkTable {
  std::filesystem::path file;
  double frequency_hz = 0.0;
};

/// What stands in a column of names, which JSON is to hold.
std::string name_in(const CsvReader& table, std::size_t column) {
  const std::string name = printable(table.text(column));
  try {
    decoded(name);
  } catch (const std::invalid_argument&) {
    table.fail("a name that is no UTF-8; expected text in UTF-8");
  }
  return name;
}

/// Rows with the same id, one below the other, are the corners of an outline.
std::vector<NamedRing> read_rings(const std::filesystem::path& file, const std::string& id_column) {
  const std::string expectation = "a header " + id_column + ",x_m,y_m";
  const std::string text = read_text_file(file, "expected a table of outlines");
  CsvReader table(file.string(), text, {{id_column}, {"x_m"}, {"y_m"}}, expectation, CsvReader::OtherColumns::refused,
                  CsvReader::EmptyLines::anywhere);
  std::vector<NamedRing> rings;
  while (table.next()) {
    const std::string name = name_in(table, 0);
    if (name.empty()) table.fail(id_column + ": found nothing; expected the outline's id");
    if (rings.empty() || rings.back().name != name) rings.push_back({name, {}});
    rings.back().ring.emplace_back(table.number(1, any_place_m), table.number(2, any_place_m));
  }
  return rings;
}

class Gemv2Import {
 public:
  Gemv2Import(const std::filesystem::path& source, const std::filesystem::path& folder, const ImportSettings& settings)
      : source_(source), folder_(folder), settings_(settings) {
    draft_.importer = "gemv2";
  }

  ImportReport run() {
    find_files();
    FoundTown town;
    for (NamedRing& found : read_rings(buildings_, "building_id")) {
      town.houses.push_back({"building_" + found.name, {std::move(found.ring)}, {}, settings_.default_height_m});
    }
    draft_.report.read["heights by default"] = town.houses.size();
    read_links();
    std::vector<NamedRing> vehicles;
    if (!vehicles_.empty()) vehicles = read_rings(vehicles_, "vehicle_index_1based");
    Vec2 low_m(any_place_m.maximum), high_m(any_place_m.minimum);
    for (const auto& [name, end] : ends_) {
      low_m = glm::min(low_m, end.place_m);
      high_m = glm::max(high_m, end.place_m);
    }
    read_origin();
    build_town(std::move(town), low_m, high_m, settings_, buildings_, draft_);
    draft_.scenario["propagation"] = town_propagation_json();
    add_vehicles(vehicles);
    add_devices();
    draft_.scenario["frequency_hz"] = settings_.frequency_hz.value_or(links_.front().frequency_hz);
    return write_import(std::move(draft_), folder_, settings_);
  }

 private:
  void find_files() {
    std::error_code trouble;
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(source_, trouble)) files.push_back(entry.path());
    if (trouble) throw InputError(source_.string(), "is no folder that can be read; expected a folder of GEMV2 tables");
    std::sort(files.begin(), files.end());
    for (const std::filesystem::path& file : files) {
      const std::string name = file.filename().string();
      if (name.ends_with("buildings_xy.csv")) buildings_ = file;
      if (name.ends_with("vehicles_xy.csv")) vehicles_ = file;
      if (name.ends_with("_origin.json")) origin_ = file;
      if (name.ends_with("GHz.csv")) links_.push_back({file, frequency_hz(name)});
    }
    require(buildings_.empty(), "*buildings_xy.csv");
    require(links_.empty(), "*_<frequency>GHz.csv, a table of links");
    std::sort(links_.begin(), links_.end(),
              [](const LinkTable& a, const LinkTable& b) { return a.frequency_hz < b.frequency_hz; });
    for (const auto& file : {buildings_, vehicles_, links_.front().file, origin_}) {
      if (!file.empty()) draft_.sources.push_back(file);
    }
  }

  void require(bool is_missing, const std::string& name) const {
    if (is_missing) throw InputError(source_.string(), "holds no " + name + "; expected the tables of a GEMV2 run");
  }

  /// "gemv2_porto_5.89GHz.csv"
  double frequency_hz(const std::string& name) const {
    const std::size_t begin = name.rfind('_') + 1;
    const std::optional<double> number = parse_number(name.substr(begin, name.size() - begin - 7));
    if (number && *number > 0.0 && *number <= 1e6) return std::round(*number * 1e9);
    throw InputError((source_ / name).string(), "no frequency in the name; expected one as in links_5.89GHz.csv");
  }

  void read_links() {
    const std::filesystem::path& file = links_.front().file;
    const std::string text = read_text_file(file, "expected a table of links");
    CsvReader table(file.string(), text,
                    {{"veh_i"}, {"veh_j"}, {"x_i"}, {"y_i"}, {"h_ant_i"}, {"x_j"}, {"y_j"}, {"h_ant_j"}},
                    "a header veh_i,veh_j,x_i,y_i,h_ant_i,x_j,y_j,h_ant_j", CsvReader::OtherColumns::ignored,
                    CsvReader::EmptyLines::anywhere);
    while (table.next()) {
      const std::string first = add_end(table, 0, 2), second = add_end(table, 1, 5);
      if (first == second) table.fail("a link of '" + first + "' with itself; expected two vehicles");
      pairs_.push_back({first, second});
    }
    if (pairs_.empty()) throw InputError(file.string(), "holds no link; expected at least one");
    draft_.report.read["links"] = pairs_.size();
    for (std::size_t other = 1; other < links_.size(); ++other) {
      draft_.report.notes.push_back("The links are those of " + file.filename().string() + "; " +
                                    links_[other].file.filename().string() +
                                    " was not read: change frequency_hz for its frequency.");
    }
  }

  std::string add_end(const CsvReader& table, std::size_t name_column, std::size_t first_column) {
    const std::string name = name_in(table, name_column);
    if (name.empty() || name.find('/') != std::string::npos) {
      table.fail("found " + in_quotes(name) + " for a vehicle; expected its number");
    }
    const LinkEnd end{{table.number(first_column, any_place_m), table.number(first_column + 1, any_place_m)},
                      table.number(first_column + 2, {0.0, 1000.0, true})};
    ends_.emplace(name, end);
    return name;
  }

  double vehicle_height_m(const std::string& name, double length_m) const {
    const auto end = ends_.find(name);
    if (end == ends_.end()) return length_m > longest_car_m ? lorry_height_m : car_height_m;
    return std::max(0.1, end->second.antenna_height_m - antenna_above_roof_m);
  }

  void add_vehicles(std::vector<NamedRing>& vehicles) {
    draft_.report.read["vehicles"] = vehicles.size();
    for (NamedRing& vehicle : vehicles) {
      const TurnedRectangle box = vehicle.ring.size() < 3 ? TurnedRectangle{} : rectangle_around(vehicle.ring);
      if (box.width_m < 0.1 || boxes_.contains(vehicle.name)) {
        ++draft_.report.skipped[boxes_.contains(vehicle.name) ? "vehicles there already" : "vehicles without area"];
        continue;
      }
      boxes_.emplace(vehicle.name, box);
      const double height_m = rounded(vehicle_height_m(vehicle.name, box.length_m));
      draft_.scenario["objects"].push_back(
          {{"id", "vehicle_" + vehicle.name},
           {"box_m", {rounded(box.length_m), rounded(box.width_m), height_m}},
           {"material", "metal"},
           {"motion",
            {{"position_m",
              {rounded(box.centre_m.x), rounded(box.centre_m.y), rounded(ground_m(draft_, box.centre_m))}},
             {"yaw_deg", yaw_deg(box)}}}});
    }
    draft_.report.made["vehicles"] = boxes_.size();
  }

  static double rounded(double value) { return std::round(value * 1e4) / 1e4; }
  static double yaw_deg(const TurnedRectangle& box) { return rounded(box.yaw_rad * 180.0 / std::numbers::pi); }

  /// A device rides on its vehicle, whose body then is not in its way.
  nlohmann::ordered_json device_json(const std::string& name) const {
    const LinkEnd& end = ends_.at(name);
    nlohmann::ordered_json device{{"id", "on_" + name}};
    const auto box = boxes_.find(name);
    if (box == boxes_.end()) {
      device["position_m"] = {end.place_m.x, end.place_m.y, ground_m(draft_, end.place_m) + end.antenna_height_m};
    } else {
      const double yaw_rad = box->second.yaw_rad;
      const Vec2 offset_m = end.place_m - box->second.centre_m;
      device["attach_to"] = "vehicle_" + name;
      device["offset_m"] = {rounded(offset_m.x * std::cos(yaw_rad) + offset_m.y * std::sin(yaw_rad)),
                            rounded(offset_m.y * std::cos(yaw_rad) - offset_m.x * std::sin(yaw_rad)),
                            end.antenna_height_m};
    }
    device["antenna"] = {{"pattern", "isotropic"}, {"gain_dbi", 1}, {"polarization", "V"}};
    return device;
  }

  void add_devices() {
    std::set<std::string> first, second;
    nlohmann::ordered_json pairs = nlohmann::ordered_json::array();
    for (const auto& [a, b] : pairs_) {
      first.insert(a);
      second.insert(b);
      pairs.push_back({"on_" + a, "on_" + b});
    }
    for (const std::string& name : first) {
      nlohmann::ordered_json device = device_json(name);
      device["power_dbm"] = 12;
      draft_.scenario["transmitters"].push_back(std::move(device));
    }
    for (const std::string& name : second) draft_.scenario["receivers"].push_back(device_json(name));
    draft_.scenario["links"] = {{"pairs", std::move(pairs)}};
    draft_.report.made["transmitters"] = first.size();
    draft_.report.made["receivers"] = second.size();
  }

  /// {"origin_utm29n": [easting, northing]}
  void read_origin() {
    if (origin_.empty() || !knows_utm()) return;
    const auto document = nlohmann::json::parse(read_text_file(origin_, "expected the origin of the tables"), nullptr,
                                                false);  // no exceptions
    if (!document.is_object()) {
      throw InputError(origin_.string(), "is no JSON object; expected one with origin_utm<zone>");
    }
    for (const auto& [key, value] : document.items()) {
      UtmZone zone;
      if (!key.starts_with("origin_utm") || key.size() < 12 || !value.is_array() || value.size() != 2) continue;
      zone.number = static_cast<int>(parse_integer(key.substr(10, key.size() - 11)).value_or(0));
      zone.is_north = key.back() != 's';
      if (zone.number < 1 || zone.number > 60 || !value[0].is_number() || !value[1].is_number()) continue;
      draft_.geo = geo_json(zone, {value[0].get<double>(), value[1].get<double>()}, origin_, key);
    }
  }

  std::filesystem::path source_, folder_;
  const ImportSettings& settings_;
  ImportDraft draft_;
  std::filesystem::path buildings_, vehicles_, origin_;
  std::vector<LinkTable> links_;
  std::map<std::string, LinkEnd> ends_;
  std::vector<std::pair<std::string, std::string>> pairs_;
  std::map<std::string, TurnedRectangle> boxes_;
};

}  // namespace

ImportReport import_gemv2(const std::filesystem::path& source, const std::filesystem::path& folder,
                          const ImportSettings& settings) {
  check_settings(settings, source);
  require_outlines(source);
  return Gemv2Import(source, folder, settings).run();
}

}  // namespace dcem::io
