#include "dcem/io/src/import/osm_heights.hpp"

#include <array>
#include <cmath>
#include <optional>

#include "dcem/io/src/text/text_input.hpp"

namespace dcem::io {

namespace {

using Tags = std::map<std::string, std::string>;

constexpr double highest_m = 1000.0, most_levels = 200.0;

/// "12", "12 m", "12.5m", "40 ft", "40'": a length in metres above 0, at most `highest_m`.
std::optional<double> length_of(std::string_view text) {
  text = trimmed(text);
  double unit_m = 1.0;
  for (const auto& [ending, its_m] : {std::pair<std::string_view, double>{"m", 1.0}, {"ft", 0.3048}, {"'", 0.3048}}) {
    if (!text.ends_with(ending)) continue;
    unit_m = its_m;
    text = trimmed(text.substr(0, text.size() - ending.size()));
    break;
  }
  const std::optional<double> number = parse_number(text);
  if (!number || *number <= 0.0 || *number * unit_m > highest_m) return std::nullopt;
  return *number * unit_m;
}

/// A number of storeys; what is there and is none is counted.
std::optional<double> levels_of(const Tags& tags, const char* key, ImportReport& report) {
  const auto found = tags.find(key);
  if (found == tags.end()) return std::nullopt;
  const std::optional<double> number = parse_number(trimmed(found->second));
  if (number && *number >= 0.0 && *number <= most_levels) return number;
  ++report.repaired["numbers of storeys that are none"];
  return std::nullopt;
}

/// `height`; what is there and is none is counted.
std::optional<double> height_of(const Tags& tags, ImportReport& report) {
  const auto found = tags.find("height");
  if (found == tags.end()) return std::nullopt;
  const std::optional<double> height_m = length_of(found->second);
  if (!height_m) ++report.repaired["heights that are no length"];
  return height_m;
}

/// Words of `building:material` and `roof:material` that the ITU has a table for.
constexpr std::array<std::pair<std::string_view, std::string_view>, 12> materials{{{"brick", "brick"},
                                                                                   {"bricks", "brick"},
                                                                                   {"concrete", "concrete"},
                                                                                   {"reinforced_concrete", "concrete"},
                                                                                   {"glass", "glass"},
                                                                                   {"mirror", "glass"},
                                                                                   {"wood", "wood"},
                                                                                   {"timber_framing", "wood"},
                                                                                   {"metal", "metal"},
                                                                                   {"steel", "metal"},
                                                                                   {"marble", "marble"},
                                                                                   {"stone", "marble"}}};

void apply_material(const Tags& tags, const char* key, std::string& material) {
  const auto found = tags.find(key);
  if (found == tags.end()) return;
  for (const auto& [word, itu] : materials) {
    if (found->second == word && itu != "concrete") material += '_' + std::string(itu);
  }
}

/// To the millimetre: neighbours that say the same in other words have roofs in one plane.
double rounded_m(double height_m) {
  return std::round(height_m * 1000.0) / 1000.0;
}

}  // namespace

void apply_tags(const Tags& tags, const ImportSettings& settings, FoundHouse& house, ImportReport& report) {
  const std::optional<double> height_m = height_of(tags, report);
  const std::optional<double> levels = levels_of(tags, "building:levels", report);
  const double roof_levels = levels_of(tags, "roof:levels", report).value_or(0.0);
  if (height_m) {
    house.height_m = rounded_m(*height_m);
    ++report.read["heights from 'height'"];
  } else if (levels && *levels > 0.0) {
    house.height_m = rounded_m((*levels + roof_levels) * settings.level_height_m);
    ++report.read["heights from 'building:levels'"];
  } else {
    house.height_m = settings.default_height_m;
    ++report.read["heights by default"];
  }
  apply_material(tags, "building:material", house.wall);
  apply_material(tags, "roof:material", house.roof);
}

double tree_height_m(const Tags& tags, const ImportSettings& settings, ImportReport& report) {
  const std::optional<double> height_m = height_of(tags, report);
  return height_m ? rounded_m(*height_m) : settings.tree_height_m;
}

}  // namespace dcem::io
