#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <stdexcept>
#include <string_view>

#include "dcem/io/import.hpp"
#include "dcem/io/input_error.hpp"
#include "dcem/io/src/import/import_draft.hpp"
#include "dcem/io/src/scenario/limits.hpp"
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

/// Names become part of ids, which have a limit.
constexpr std::size_t longest_name_bytes = longest_identifier_bytes - std::string_view("vehicle_").size();

/// What stands in a column of names, which JSON is to hold.
std::string name_in(const CsvReader& table, std::size_t column) {
  const std::string name(table.text(column));
  if (name.empty() || name.size() > longest_name_bytes || !is_printable(name)) {
    table.fail("found " + in_quotes(name) + "; expected a name of at most " + std::to_string(longest_name_bytes) +
               " bytes without control characters");
  }
  try {
    decoded(name);
  } catch (const std::invalid_argument&) {
    table.fail("a name that is no UTF-8; expected text in UTF-8");
  }
  return name;
}

/// The same of a vehicle, whose name stands in the names of files.
std::string vehicle_in(const CsvReader& table, std::size_t column) {
  const std::string name = name_in(table, column);
  if (name.find_first_of("/\\") != std::string::npos) {
    table.fail("found " + in_quotes(name) + " for a vehicle; expected its number");
  }
  return name;
}

/// Rows with the same id, one below the other, are the corners of an outline.
std::vector<NamedRing> read_rings(const std::filesystem::path& file, const std::string& id_column,
                                  std::string (*read_name)(const CsvReader&, std::size_t)) {
  const std::string expectation = "a header " + id_column + ",x_m,y_m";
  const std::string text = read_text_file(file, "expected a table of outlines");
  CsvReader table(file.string(), text, {{id_column}, {"x_m"}, {"y_m"}}, expectation, CsvReader::OtherColumns::refused,
                  CsvReader::EmptyLines::anywhere);
  std::vector<NamedRing> rings;
  while (table.next()) {
    const std::string name = read_name(table, 0);
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
    for (NamedRing& found : read_rings(buildings_, "building_id", name_in)) {
      town.houses.push_back({"building_" + found.name, {std::move(found.ring)}, {}, settings_.default_height_m});
    }
    draft_.report.read["heights by default"] = town.houses.size();
    read_links();
    std::vector<NamedRing> vehicles;
    if (!vehicles_.empty()) vehicles = read_rings(vehicles_, "vehicle_index_1based", vehicle_in);
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
    draft_.frequency_hz = links_.front().frequency_hz;
    draft_.frequency_source = links_.front().file;
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
      if (name.starts_with('.')) continue;  // what archives and editors leave beside files
      if (name.ends_with("buildings_xy.csv")) take(file, buildings_);
      if (name.ends_with("vehicles_xy.csv")) take(file, vehicles_);
      if (name.ends_with("_origin.json")) take(file, origin_);
      if (name.ends_with("GHz.csv")) links_.push_back({file, frequency_hz(name)});
    }
    require(buildings_.empty(), "*buildings_xy.csv");
    require(links_.empty(), "*_<frequency>GHz.csv, a table of links");
    std::stable_sort(links_.begin(), links_.end(),
                     [](const LinkTable& a, const LinkTable& b) { return a.frequency_hz < b.frequency_hz; });
    if (links_.size() > 1 && links_[1].frequency_hz == links_[0].frequency_hz)
      fail_of_two(links_[0].file, links_[1].file);
    for (const auto& file : {buildings_, vehicles_, links_.front().file, origin_}) {
      if (!file.empty()) draft_.sources.push_back(file);
    }
  }

  /// Which of two tables of a kind is meant, nobody can know.
  void take(const std::filesystem::path& file, std::filesystem::path& place) const {
    if (!place.empty()) fail_of_two(place, file);
    place = file;
  }

  [[noreturn]] void fail_of_two(const std::filesystem::path& first, const std::filesystem::path& second) const {
    throw InputError(source_.string(), "holds " + in_quotes(first.filename().string()) + " and " +
                                           in_quotes(second.filename().string()) +
                                           "; expected one table of a kind, those of one GEMV2 run");
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
      const std::string first = vehicle_in(table, 0), second = vehicle_in(table, 1);
      if (first == second) table.fail("a link of '" + first + "' with itself; expected two vehicles");
      add_end(table, first, 2);
      add_end(table, second, 5);
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

  void add_end(const CsvReader& table, const std::string& name, std::size_t first_column) {
    const LinkEnd end{{table.number(first_column, any_place_m), table.number(first_column + 1, any_place_m)},
                      table.number(first_column + 2, {0.0, 1000.0, true})};
    const LinkEnd& before = ends_.emplace(name, end).first->second;
    constexpr double same_m = 0.01;
    if (glm::distance(before.place_m, end.place_m) > same_m ||
        std::abs(before.antenna_height_m - end.antenna_height_m) > same_m) {
      table.fail("vehicle " + in_quotes(name) +
                 " is elsewhere than in a row before; expected the links of one instant");
    }
  }

  double vehicle_height_m(const std::string& name, double length_m) const {
    const auto end = ends_.find(name);
    if (end == ends_.end()) return length_m > longest_car_m ? lorry_height_m : car_height_m;
    return std::max(0.1, end->second.antenna_height_m - antenna_above_roof_m);
  }

  /// A vehicle of links that the table lacks is a device without a body. Where it lacks them all, the two tables are
  /// not of one run.
  void check_vehicles_of_links(const std::vector<NamedRing>& vehicles) {
    if (vehicles_.empty()) return;
    std::set<std::string> known;
    for (const NamedRing& vehicle : vehicles) known.insert(vehicle.name);
    const auto unknown = static_cast<std::size_t>(
        std::ranges::count_if(ends_, [&](const auto& end) { return !known.contains(end.first); }));
    if (unknown == ends_.size()) {
      throw InputError(links_.front().file.string(), "names no vehicle of " + in_quotes(vehicles_.filename().string()) +
                                                         "; expected tables of one GEMV2 run");
    }
    if (unknown > 0) draft_.report.repaired["vehicles of links that the table lacks, left without a body"] = unknown;
  }

  /// Slips of the tables, which would move a device away from its vehicle.
  void check_box(const std::string& name, const TurnedRectangle& box) const {
    constexpr double longest_m = 1000.0, farthest_m = 50.0;
    const std::string vehicle = "vehicle " + in_quotes(name);
    if (box.length_m > longest_m) {
      throw InputError(vehicles_.string(), vehicle + " is " + number_text(rounded(box.length_m)) +
                                               " m long; expected at most " + number_text(longest_m));
    }
    const auto end = ends_.find(name);
    const double away_m = end == ends_.end() ? 0.0 : glm::distance(end->second.place_m, box.centre_m);
    if (away_m <= farthest_m + box.length_m) return;
    throw InputError(vehicles_.string(), vehicle + " is " + number_text(rounded(away_m)) + " m from where " +
                                             in_quotes(links_.front().file.filename().string()) +
                                             " has it; expected tables of one instant");
  }

  void add_vehicles(std::vector<NamedRing>& vehicles) {
    draft_.report.read["vehicles"] = vehicles.size();
    check_vehicles_of_links(vehicles);
    for (NamedRing& vehicle : vehicles) {
      const TurnedRectangle box = vehicle.ring.size() < 3 ? TurnedRectangle{} : rectangle_around(vehicle.ring);
      if (box.width_m < 0.1 || boxes_.contains(vehicle.name)) {
        ++draft_.report.skipped[boxes_.contains(vehicle.name) ? "vehicles there already" : "vehicles without area"];
        continue;
      }
      check_box(vehicle.name, box);
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

  /// {"origin_utm29n": [easting, northing]}; other keys may stand beside it.
  void read_origin() {
    if (origin_.empty() || !knows_utm()) return;
    const auto document = nlohmann::json::parse(read_text_file(origin_, "expected the origin of the tables"), nullptr,
                                                false);  // no exceptions
    if (!document.is_object()) {
      throw InputError(origin_.string(), "is no JSON object; expected one with origin_utm<zone>");
    }
    for (const auto& [key, value] : document.items()) {
      if (key.starts_with("origin_utm")) take_origin(key, value);
    }
    if (draft_.geo.is_null()) {
      throw InputError(origin_.string(), "holds no origin; expected one as in \"origin_utm29n\": [529203, 4555870]");
    }
  }

  void take_origin(const std::string& key, const nlohmann::json& value) {
    const auto fail = [&](const std::string& what) {
      throw InputError(origin_.string(), printable(key) + ": " + what);
    };
    const std::optional<UtmZone> zone =
        utm_zone_named(std::string_view(key).substr(std::string_view("origin_").size()));
    if (!zone) fail("no zone of UTM; expected one from origin_utm1n to origin_utm60n, or with s in the south");
    if (!draft_.geo.is_null()) fail("a second origin; expected one");
    const bool is_place = value.is_array() && value.size() == 2 && value[0].is_number() && value[1].is_number();
    if (!is_place) fail("found something else; expected [easting, northing] in metres");
    draft_.geo = geo_json(*zone, {value[0].get<double>(), value[1].get<double>()}, origin_, key);
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
