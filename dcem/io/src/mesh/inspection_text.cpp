#include "dcem/io/inspection.hpp"
#include "dcem/io/src/results/fact_json.hpp"
#include "dcem/io/src/text/json_values.hpp"
#include "dcem/io/text_table.hpp"

namespace dcem::io {
namespace {

using Json = nlohmann::ordered_json;

Json response_json(const InspectedMaterial::Response& response) {
  return {{"relative_permittivity", optional_json(response.relative_permittivity)},
          {"conductivity_s_per_m", optional_json(response.conductivity_s_per_m)},
          {"reflection_loss_db", response.reflection_loss_db},  // a surface that reflects nothing: infinite, so null
          {"penetration_loss_db", optional_json(response.penetration_loss_db)},
          {"extrapolated", response.extrapolated}};
}

Json wedges_json(const InspectedWedges& wedges) {
  return {{"min_exterior_angle_deg", wedges.min_exterior_angle_deg},
          {"count", wedges.wedges},
          {"length_m", wedges.wedge_length_m},
          {"free_edges", wedges.free_edges},
          {"free_edge_length_m", wedges.free_edge_length_m}};
}

Json inspected_material_json(const InspectedMaterial& entry) {
  Json json{{"name", entry.name}, {"defined", entry.material.has_value()}};
  if (entry.material) json.update(material_json(*entry.material));
  json["facets"] = entry.facets;
  json["triangles"] = entry.triangles;
  json["area_m2"] = entry.area_m2;
  if (entry.response) json["at_frequency"] = response_json(*entry.response);
  return json;
}

std::string point_text(const Vec3& point, int decimals) {
  return format_fixed(point.x, decimals) + ", " + format_fixed(point.y, decimals) + ", " +
         format_fixed(point.z, decimals);
}

// "constant, reflection 0.8, opaque true" from the words of the scenario file.
std::string model_text(const InspectedMaterial& entry) {
  if (!entry.material) return "undefined";
  const Json model = material_json(*entry.material);
  std::string text;
  for (const auto& [key, value] : model.items()) {
    if (key == "model") {
      text += value.get<std::string>();
    } else if (key == "opaque") {
      text += value.get<bool>() ? ", opaque" : "";
    } else {
      text += (text.empty() ? "" : ", ") + key + " " + (value.is_string() ? value.get<std::string>() : value.dump());
    }
  }
  return text;
}

std::string response_text(const InspectedMaterial& entry) {
  if (!entry.response) return "-";
  const InspectedMaterial::Response& response = *entry.response;
  std::string text = "R " + format_fixed(-response.reflection_loss_db, 2) + " dB";
  if (response.penetration_loss_db) text += ", T " + format_fixed(-*response.penetration_loss_db, 2) + " dB";
  return response.extrapolated ? text + " (outside the table)" : text;
}

std::string wedge_remark(const InspectedWedges& wedges) {
  return "edges of two facets from " + format_fixed(wedges.min_exterior_angle_deg, 0) + " degrees outside, " +
         format_fixed(wedges.wedge_length_m, 1) + " m in all";
}

std::string facts_table(const Inspection& inspection) {
  const SurfaceReport& report = inspection.report;
  TextTable table({{"", TextTable::Align::left}, {""}, {"", TextTable::Align::left}});
  const auto row = [&](const char* name, std::size_t count, const std::string& remark) {
    table.add_row({name, std::to_string(count), remark});
  };
  row("triangles", inspection.triangles, "after mending");
  row("facets", inspection.facets, "connected coplanar triangles of one material");
  row("wedges", inspection.wedges.wedges, wedge_remark(inspection.wedges));
  row("free edges", inspection.wedges.free_edges,
      "rims of open sheets, " + format_fixed(inspection.wedges.free_edge_length_m, 1) + " m in all");
  row("triangles read", report.triangles_read, "");
  row("triangles without area", report.triangles_without_area, "dropped");
  row("triangles repeated", report.triangles_repeated, "dropped");
  row("vertices welded", report.vertices_welded, "into another one");
  row("open edges", report.open_edges, "of one triangle only");
  row("crowded edges", report.crowded_edges, "of more than two triangles");
  row("uneven sets", report.uneven_sets, "that bend too far to be one facet");
  row("closed shells", report.closed_shells, "without open or crowded edges");
  row("standing shells", report.standing_shells, "open at the foot only: houses without a floor");
  row("overlapping facet pairs", inspection.overlapping_facet_pairs, "coplanar, one on top of the other");
  return table.str();
}

std::string materials_table(const Inspection& inspection) {
  TextTable table({{"material", TextTable::Align::left},
                   {"facets"},
                   {"triangles"},
                   {"area m2"},
                   {"model", TextTable::Align::left},
                   {"at normal incidence", TextTable::Align::left}});
  for (const InspectedMaterial& entry : inspection.materials) {
    table.add_row({entry.name, std::to_string(entry.facets), std::to_string(entry.triangles),
                   format_fixed(entry.area_m2, 1), model_text(entry), response_text(entry)});
  }
  return table.str();
}

std::string facets_table(const Inspection& inspection) {
  TextTable table({{"largest facets", TextTable::Align::left},
                   {"area m2"},
                   {"triangles"},
                   {"centre m", TextTable::Align::left},
                   {"normal", TextTable::Align::left}});
  for (const InspectedFacet& facet : inspection.largest_facets) {
    table.add_row({facet.material, format_fixed(facet.area_m2, 1), std::to_string(facet.triangles),
                   point_text(facet.plane.point_m, 2), point_text(facet.plane.normal, 3)});
  }
  return table.str();
}

}  // namespace

std::string inspection_json(const Inspection& inspection) {
  Json materials = Json::array(), facets = Json::array();
  for (const InspectedMaterial& entry : inspection.materials) materials.push_back(inspected_material_json(entry));
  for (const InspectedFacet& facet : inspection.largest_facets) {
    facets.push_back({{"material", facet.material},
                      {"area_m2", facet.area_m2},
                      {"triangles", facet.triangles},
                      {"centre_m", point_json(facet.plane.point_m)},
                      {"normal", point_json(facet.plane.normal)}});
  }
  Json box;
  if (!inspection.box.empty()) {
    box = {{"min_m", point_json(inspection.box.min)}, {"max_m", point_json(inspection.box.max)}};
  }
  return json_text({{"file", inspection.file},
                    {"triangles", inspection.triangles},
                    {"facets", inspection.facets},
                    {"wedges", wedges_json(inspection.wedges)},
                    {"bounding_box", box},
                    {"surfaces", surface_report_json(inspection.report)},
                    {"overlapping_facet_pairs", inspection.overlapping_facet_pairs},
                    {"materials", materials},
                    {"largest_facets", facets},
                    {"warnings", inspection.warnings}});
}

std::string inspection_table(const Inspection& inspection) {
  std::string text = inspection.file + '\n';
  if (!inspection.box.empty()) {
    text += "from (" + point_text(inspection.box.min, 3) + ") to (" + point_text(inspection.box.max, 3) + ") m\n";
  }
  return text + '\n' + facts_table(inspection) + '\n' + materials_table(inspection) + '\n' + facets_table(inspection);
}

}  // namespace dcem::io
