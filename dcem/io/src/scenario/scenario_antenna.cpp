#include <algorithm>
#include <string>
#include <utility>

#include "dcem/core/units.hpp"
#include "dcem/io/antenna_files.hpp"
#include "dcem/io/src/scenario/enum_words.hpp"
#include "dcem/io/src/scenario/scenario_parts.hpp"
#include "dcem/io/src/text/text_input.hpp"

namespace dcem::io {

namespace {

Polarization read_polarization(const JsonValue& value) {
  if (!value.is_object()) return {read_word<PolarizationKind>(value), 0.0};
  return {PolarizationKind::slant, degrees_to_radians(value.object().at("slant_deg").number())};
}

Orientation read_orientation(const JsonValue& value) {
  const Vec3 angles_deg = value.vector3();
  return {degrees_to_radians(angles_deg.x), degrees_to_radians(angles_deg.y), degrees_to_radians(angles_deg.z)};
}

AntennaArray read_array(const JsonValue& value) {
  const JsonObject object = value.object();
  AntennaArray array;
  array.rows = object.count("rows", array.rows);
  array.columns = object.count("columns", array.columns);
  array.spacing_wavelengths = object.number("spacing_wavelengths", array.spacing_wavelengths);
  if (array.size() > most_array_elements) {
    value.fail(std::to_string(array.size()) + " elements; expected at most " + std::to_string(most_array_elements));
  }
  return array;
}

}  // namespace

Antenna AntennaReader::read(const JsonObject& owner) {
  const auto value = owner.find("antenna");
  if (!value) return {};
  const JsonObject object = value->object();
  Antenna antenna;
  if (const auto pattern = object.find("pattern")) antenna.pattern = read_pattern(*pattern);
  antenna.gain_dbi = object.number("gain_dbi", antenna.gain_dbi);
  if (const auto polarization = object.find("polarization")) antenna.polarization = read_polarization(*polarization);
  if (const auto orientation = object.find("orientation_deg")) antenna.orientation = read_orientation(*orientation);
  if (const auto array = object.find("array")) antenna.array = read_array(*array);
  return antenna;
}

AntennaPattern AntennaReader::read_pattern(const JsonValue& value) {
  if (value.is_object()) return TabulatedPattern{read_table(value.object())};
  const std::string name = value.word();
  if (name == "half_wave_dipole") return HalfWaveDipole{};
  if (name == "tr38901") return Tr38901Element{};
  return IsotropicPattern{};
}

std::shared_ptr<const PatternTable> AntennaReader::read_table(const JsonObject& file) {
  const std::string format = file.chosen("file");
  const JsonValue name = file.at(format);
  std::shared_ptr<const PatternTable>& table = tables_[{format, name.text()}];
  if (!table) {
    const std::filesystem::path path = existing_file(name, folder_, "expected an antenna pattern");
    table = std::make_shared<const PatternTable>(format == "csv" ? read_pattern_csv(path) : read_msi(path));
  }
  return table;
}

}  // namespace dcem::io
