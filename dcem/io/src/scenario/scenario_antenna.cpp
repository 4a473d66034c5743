#include <algorithm>
#include <string>
#include <utility>

#include "dcem/core/units.hpp"
#include "dcem/io/antenna_files.hpp"
#include "dcem/io/src/scenario/scenario_parts.hpp"
#include "dcem/io/src/text/text_input.hpp"

namespace dcem::io {

namespace {

Polarization read_polarization(const JsonValue& value) {
  if (value.is_object()) {
    const double slant_deg = value.object({"slant_deg"}).at("slant_deg").number({-1e6, 1e6});
    return {PolarizationKind::slant, degrees_to_radians(slant_deg)};
  }
  static const std::map<std::string, PolarizationKind> kinds{{"V", PolarizationKind::vertical},
                                                             {"H", PolarizationKind::horizontal},
                                                             {"RHC", PolarizationKind::right_circular},
                                                             {"LHC", PolarizationKind::left_circular},
                                                             {"VH", PolarizationKind::dual}};
  const auto kind = value.is_string() ? kinds.find(value.text()) : kinds.end();
  if (kind == kinds.end()) value.fail("unknown polarization; expected V, H, RHC, LHC, VH or {\"slant_deg\": angle}");
  return {kind->second, 0.0};
}

Orientation read_orientation(const JsonValue& value) {
  const Vec3 angles_deg = value.vector3(any_angle_deg.maximum);
  return {degrees_to_radians(angles_deg.x), degrees_to_radians(angles_deg.y), degrees_to_radians(angles_deg.z)};
}

AntennaArray read_array(const JsonValue& value) {
  const JsonObject object = value.object({"rows", "columns", "spacing_wavelengths"});
  const auto count = [&](const char* key) {
    return static_cast<std::size_t>(object.integer(key, 1, 1, static_cast<long long>(most_array_elements)));
  };
  const AntennaArray array{count("rows"), count("columns"),
                           object.number("spacing_wavelengths", 0.5, {0.0, 1000.0, true})};
  if (array.size() > most_array_elements) {
    value.fail(std::to_string(array.size()) + " elements; expected at most " + std::to_string(most_array_elements));
  }
  return array;
}

}  // namespace

Antenna AntennaReader::read(const JsonObject& owner) {
  const auto value = owner.find("antenna");
  if (!value) return {};
  const JsonObject object = value->object({"pattern", "gain_dbi", "polarization", "orientation_deg", "array"});
  Antenna antenna;
  if (const auto pattern = object.find("pattern")) antenna.pattern = read_pattern(*pattern);
  antenna.gain_dbi = object.number("gain_dbi", 0.0, {-200.0, 200.0});
  if (const auto polarization = object.find("polarization")) antenna.polarization = read_polarization(*polarization);
  if (const auto orientation = object.find("orientation_deg")) antenna.orientation = read_orientation(*orientation);
  if (const auto array = object.find("array")) antenna.array = read_array(*array);
  return antenna;
}

AntennaPattern AntennaReader::read_pattern(const JsonValue& value) {
  if (value.is_object()) return TabulatedPattern{read_table(value.object({"csv", "msi"}))};
  if (!value.is_string()) value.fail("found no pattern; expected a name, {\"csv\": file} or {\"msi\": file}");
  const std::string name = value.one_of({"isotropic", "half_wave_dipole", "tr38901"});
  if (name == "half_wave_dipole") return HalfWaveDipole{};
  if (name == "tr38901") return Tr38901Element{};
  return IsotropicPattern{};
}

std::shared_ptr<const PatternTable> AntennaReader::read_table(const JsonObject& file) {
  const std::string format = file.exactly_one_of({"csv", "msi"});
  const JsonValue name = file.at(format);
  std::shared_ptr<const PatternTable>& table = tables_[{format, name.text()}];
  if (!table) {
    const std::filesystem::path path = existing_file(name, folder_, "expected an antenna pattern");
    table = std::make_shared<const PatternTable>(format == "csv" ? read_pattern_csv(path) : read_msi(path));
  }
  return table;
}

}  // namespace dcem::io
