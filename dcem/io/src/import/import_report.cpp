#include "dcem/io/src/import/import_report.hpp"

#include "dcem/io/src/geo/utm.hpp"
#include "dcem/io/src/import/osm_pbf.hpp"
#include "dcem/io/src/import/outlines.hpp"
#include "dcem/io/text_table.hpp"

namespace dcem::io {

nlohmann::ordered_json settings_json(const ImportSettings& settings) {
  return {{"default_height_m", settings.default_height_m},
          {"level_height_m", settings.level_height_m},
          {"tree_height_m", settings.tree_height_m},
          {"ground_margin_m", settings.ground_margin_m},
          {"snap_tolerance_m", settings.snap_tolerance_m},
          {"smallest_house_m2", settings.smallest_house_m2},
          {"touching_houses", settings.touching == TouchingHouses::unite ? "union" : "snap"}};
}

nlohmann::ordered_json report_json(const ImportReport& report) {
  nlohmann::ordered_json json;
  const auto put = [&](const char* key, const auto& counts) {
    json[key] = nlohmann::ordered_json::object();
    for (const auto& [reason, count] : counts) json[key][reason] = count;
  };
  put("read", report.read);
  put("repaired", report.repaired);
  put("skipped", report.skipped);
  put("made", report.made);
  for (const auto& [name, size] : report.sizes) json["made"][name] = size;
  json["notes"] = report.notes;
  return json;
}

std::string import_text(const ImportReport& report) {
  std::string text;
  const auto put = [&](const char* heading, const ImportReport::Counts& counts) {
    if (counts.empty()) return;
    text += std::string(heading) + '\n';
    for (const auto& [reason, count] : counts) {
      std::string number = std::to_string(count);
      text += "  " + std::string(number.size() < 8 ? 8 - number.size() : 0, ' ') + number + "  " + reason + '\n';
    }
  };
  put("read", report.read);
  put("repaired", report.repaired);
  put("skipped", report.skipped);
  put("made", report.made);
  for (const std::string& note : report.notes) text += "note: " + note + '\n';
  return text;
}

std::string import_libraries() {
  return outline_library() + ", " + utm_library() + ", " + pbf_library();
}

}  // namespace dcem::io
