#include "dcem/io/src/traffic/vehicle_types.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include "dcem/io/input_error.hpp"
#include "dcem/io/known_names.hpp"
#include "dcem/io/src/text/text_input.hpp"
#include "dcem/io/src/traffic/xml_reader.hpp"

namespace dcem::io {

namespace {

struct ClassDefault {
  std::string_view vehicle_class;
  double length_m, width_m, height_m;
};

/// Length, width and height by vClass. Source: SUMO user documentation, "Vehicle Type Parameter Defaults"
/// (https://sumo.dlr.de/docs/Vehicle_Type_Parameter_Defaults.html), first line of each class; classes that it does not
/// list take the values of `passenger`, as it says.
constexpr std::array<ClassDefault, 36> class_defaults{{
    {"pedestrian", 0.215, 0.478, 1.719},
    {"bicycle", 1.6, 0.65, 1.7},
    {"moped", 2.1, 0.8, 1.7},
    {"motorcycle", 2.2, 0.9, 1.5},
    {"scooter", 1.2, 0.5, 1.7},
    {"wheelchair", 1.03, 0.62, 0.905},
    {"passenger", 5.0, 1.8, 1.5},
    {"taxi", 5.0, 1.8, 1.5},
    {"evehicle", 5.0, 1.8, 1.5},
    {"emergency", 6.5, 2.16, 2.86},
    {"delivery", 6.5, 2.16, 2.86},
    {"truck", 7.1, 2.4, 2.4},
    {"trailer", 16.5, 2.55, 4.0},
    {"bus", 12.0, 2.5, 3.4},
    {"coach", 14.0, 2.6, 4.0},
    {"tram", 22.0, 2.4, 3.2},
    {"rail_urban", 3 * 36.5, 3.0, 3.6},
    {"subway", 98.7, 2.65, 3.4},
    {"rail", 2 * 67.5, 2.84, 3.75},
    {"rail_electric", 8 * 25.0, 2.95, 3.89},
    {"rail_fast", 8 * 25.0, 2.95, 3.89},
    {"ship", 17.0, 4.0, 4.0},
    {"aircraft", 70.51, 60.0, 19.33},
    {"container", 6.058, 2.43, 2.59},
    {"drone", 0.294, 0.373, 0.101},
    {"cable_car", 5.0, 1.8, 1.5},
    {"private", 5.0, 1.8, 1.5},
    {"authority", 5.0, 1.8, 1.5},
    {"army", 5.0, 1.8, 1.5},
    {"vip", 5.0, 1.8, 1.5},
    {"hov", 5.0, 1.8, 1.5},
    {"custom1", 5.0, 1.8, 1.5},
    {"custom2", 5.0, 1.8, 1.5},
    {"ignoring", 5.0, 1.8, 1.5},
    {"public_transport", 12.0, 2.5, 3.4},  // SUMO's old name of `bus`
    {"transport", 7.1, 2.4, 2.4},          // SUMO's old name of `truck`
}};

/// SUMO's types that need no definition.
constexpr std::array<std::pair<std::string_view, std::string_view>, 6> default_types{{
    {"DEFAULT_VEHTYPE", "passenger"},
    {"DEFAULT_TAXITYPE", "taxi"},
    {"DEFAULT_BIKETYPE", "bicycle"},
    {"DEFAULT_RAILTYPE", "rail"},
    {"DEFAULT_PEDTYPE", "pedestrian"},
    {"DEFAULT_CONTAINERTYPE", "container"},
}};

const ClassDefault* find_class(std::string_view name) {
  const auto found = std::find_if(class_defaults.begin(), class_defaults.end(),
                                  [&](const ClassDefault& entry) { return entry.vehicle_class == name; });
  return found == class_defaults.end() ? nullptr : &*found;
}

Vec3 size_of(const ClassDefault& entry) {
  return {entry.length_m, entry.width_m, entry.height_m};
}

}  // namespace

/// Reads the types of one file.
class VehicleTypeFile : private XmlHandler {
 public:
  VehicleTypeFile(const std::filesystem::path& file, VehicleTypes& types)
      : name_(file.string()), reader_(file, "expected an XML file with vType elements", *this), types_(types) {}

  void read() {
    reader_.read_on();
    if (count_ == 0) throw InputError(name_, "holds no vType; expected SUMO's vehicle types");
  }

 private:
  void start_element(std::string_view name, const XmlAttributes& attributes) override {
    if (name != "vType") return;
    ++count_;
    read_id(attributes);
    const ClassDefault& defaults = read_class(attributes);
    const Vec3 size_m{length_m(attributes, "length", defaults.length_m),
                      length_m(attributes, "width", defaults.width_m),
                      length_m(attributes, "height", defaults.height_m)};
    VehicleTypes::Type& type = types_.types_[id_];
    if (!type.place.empty()) reader_.fail(about("there already in " + type.place + "; expected a new id"));
    type = {size_m, name_ + ":" + std::to_string(reader_.line())};
  }

  void end_element(std::string_view) override {}

  void read_id(const XmlAttributes& attributes) {
    const auto id = attributes.find("id");
    if (!id || id->empty() || !is_printable(*id)) {
      reader_.fail("vType: id: " + (id ? "found " + in_quotes(*id) : "missing") + "; expected a name on one line");
    }
    id_ = *id;
  }

  const ClassDefault& read_class(const XmlAttributes& attributes) const {
    const std::string_view name = attributes.find("vClass").value_or("passenger");
    const ClassDefault* const known = find_class(name);
    if (known != nullptr) return *known;
    std::vector<std::string> names;
    for (const ClassDefault& entry : class_defaults) names.emplace_back(entry.vehicle_class);
    reader_.fail(about("vClass: unknown class " + in_quotes(name) + expected_names(name, names, 10)));
  }

  double length_m(const XmlAttributes& attributes, const char* attribute, double absent_m) const {
    const auto text = attributes.find(attribute);
    if (!text) return absent_m;
    constexpr NumberRange range{0.0, 1e6, true};
    const std::optional<double> value = parse_number(*text);
    if (!value || !range.holds(*value)) {
      reader_.fail(about(std::string(attribute) + ": found " + in_quotes(*text) + "; expected " + range.text()));
    }
    return *value;
  }

  std::string about(const std::string& what) const { return "vType " + in_quotes(id_) + ": " + what; }

  std::string name_;
  XmlReader reader_;
  VehicleTypes& types_;
  std::string id_;
  std::size_t count_ = 0;
};

VehicleTypes::VehicleTypes() {
  for (const auto& [id, vehicle_class] : default_types) {
    types_.emplace(id, Type{size_of(*find_class(vehicle_class)), ""});
  }
}

void VehicleTypes::read(const std::filesystem::path& file) {
  VehicleTypeFile(file, *this).read();
}

const Vec3* VehicleTypes::find_size_m(const std::string& id) const {
  const auto found = types_.find(id);
  return found == types_.end() ? nullptr : &found->second.size_m;
}

std::vector<std::string> VehicleTypes::ids() const {
  std::vector<std::string> result;
  for (const auto& [id, type] : types_) result.push_back(id);
  return result;
}

}  // namespace dcem::io
