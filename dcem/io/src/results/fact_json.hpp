#pragma once
/// Materials and mended meshes as JSON, for the summary and the inspection. Private to dcem::io.
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <variant>

#include "dcem/em/surface/material.hpp"
#include "dcem/geometry/surfaces/surface_mesh.hpp"

namespace dcem::io {

namespace detail {

inline nlohmann::ordered_json model_json(const PerfectConductor&) {
  return {{"model", "pec"}};
}
inline nlohmann::ordered_json model_json(const ConstantReflection& model) {
  nlohmann::ordered_json json{{"model", "constant"}, {"reflection", model.reflection_amplitude}};
  if (model.penetration_loss_db) json["penetration_loss_db"] = *model.penetration_loss_db;
  return json;
}
inline nlohmann::ordered_json model_json(const Dielectric& model) {
  nlohmann::ordered_json json{{"model", "dielectric"},
                              {"relative_permittivity", model.relative_permittivity},
                              {"conductivity_s_per_m", model.conductivity_s_per_m}};
  if (model.thickness_m) json["thickness_m"] = *model.thickness_m;
  return json;
}
inline nlohmann::ordered_json model_json(const ItuMaterial& model) {
  nlohmann::ordered_json json{{"model", "itu"}, {"itu", model.name}};
  if (model.thickness_m) json["thickness_m"] = *model.thickness_m;
  return json;
}
inline nlohmann::ordered_json model_json(const Multilayer& model) {
  nlohmann::ordered_json layers = nlohmann::ordered_json::array();
  for (const MaterialLayer& layer : model.layers) {
    layers.push_back(std::visit([](const auto& medium) { return model_json(medium); }, layer));
  }
  return {{"model", "multilayer"}, {"layers", std::move(layers)}};
}

inline nlohmann::ordered_json model_json(const UserSurface& surface) {
  return {{"model", "user"}, {"transmits", surface.transmits}};
}
inline nlohmann::ordered_json model_json(const Foliage& model) {
  if (model.attenuation_db_per_m) return {{"foliage_db_per_m", *model.attenuation_db_per_m}};
  return {{"foliage_db_per_m", "auto"},
          {"foliage_source", "0.79·f^0.61 dB/m, f in GHz (GEMV2, after Goldhirsh & Vogel 1998)"}};
}

inline void add_scattering(const Scattering& scattering, nlohmann::ordered_json& json) {
  json["scattering"] = scattering.coefficient;
  const bool back = scattering.pattern == ScatteringPattern::backscattering;
  const bool lambertian = scattering.pattern == ScatteringPattern::lambertian;
  json["scattering_pattern"] = lambertian ? "lambertian" : back ? "backscattering" : "directive";
  if (lambertian) return;
  json["scattering_lobe"] = scattering.lobe;
  if (!back) return;
  json["scattering_back_lobe"] = scattering.back_lobe;
  json["scattering_forward_share"] = scattering.forward_share;
}

}  // namespace detail

/// The keys of the scenario file's `materials` entry, and whether paths may cross the surface.
inline nlohmann::ordered_json material_json(const Material& material) {
  nlohmann::ordered_json json = std::visit([](const auto& model) { return detail::model_json(model); }, material.model);
  if (material.roughness_rms_m > 0.0) json["roughness_rms_m"] = material.roughness_rms_m;
  if (scatters(material)) detail::add_scattering(material.scattering, json);
  json["opaque"] = !transmits(material);
  return json;
}

inline nlohmann::ordered_json surface_report_json(const SurfaceReport& report) {
  return {{"vertices_read", report.vertices_read},
          {"vertices_welded", report.vertices_welded},
          {"triangles_read", report.triangles_read},
          {"triangles_without_area", report.triangles_without_area},
          {"triangles_repeated", report.triangles_repeated},
          {"open_edges", report.open_edges},
          {"crowded_edges", report.crowded_edges},
          {"uneven_sets", report.uneven_sets},
          {"closed_shells", report.closed_shells},
          {"standing_shells", report.standing_shells},
          {"wedges", report.wedges},
          {"free_edges", report.free_edges}};
}

/// The document as text that ends with a line feed. Bytes of names that are not UTF-8 become replacement characters.
inline std::string json_text(const nlohmann::ordered_json& document) {
  return document.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + '\n';
}

}  // namespace dcem::io
