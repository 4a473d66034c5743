#include "dcem/io/src/scenario/settings_json.hpp"

#include <optional>
#include <string>

#include "dcem/core/instruction_set.hpp"
#include "dcem/core/thread_pool.hpp"
#include "dcem/io/src/scenario/enum_words.hpp"
#include "dcem/io/src/text/json_values.hpp"
#include "dcem/sim/discovery.hpp"

namespace dcem::io {

namespace {

using Json = nlohmann::ordered_json;

Json path_loss_json(const AnyPathLoss& path_loss) {
  const auto* close_in = std::get_if<CloseIn>(&path_loss.model);
  if (std::holds_alternative<UserPathLoss>(path_loss.model)) return {{"model", "user"}};
  if (close_in == nullptr) return {{"model", "free_space"}};
  return {{"model", "close_in"},
          {"exponent", close_in->exponent},
          {"attenuation_db_per_m", close_in->attenuation_db_per_m}};
}

Json diffraction_json(const DiffractionSettings& settings) {
  return {{"lossy_wedge", word_of(settings.lossy_wedge)},
          {"region", word_of(settings.region)},
          {"free_edges", settings.free_edges},
          {"min_exterior_angle_deg", settings.min_exterior_angle_deg}};
}

Json diffuse_json(const DiffuseSettings& settings) {
  return {{"enabled", settings.enabled},           {"tile_max_m", optional_json(settings.tile_max_m)},
          {"tolerance_db", settings.tolerance_db}, {"phases", word_of(settings.phases)},
          {"list_paths", settings.list_paths},     {"tile_budget", settings.tile_budget}};
}

Json atmosphere_json(const std::optional<Atmosphere>& atmosphere) {
  if (!atmosphere) return nullptr;
  return {{"gas", atmosphere->gas},
          {"temperature_k", atmosphere->temperature_k},
          {"dry_pressure_hpa", atmosphere->dry_pressure_hpa},
          {"water_vapour_g_per_m3", atmosphere->water_vapour_g_per_m3},
          {"rain_mm_per_h", atmosphere->rain_mm_per_h}};
}

Json links_json(const LinkSettings& settings) {
  if (!settings.range_m && !settings.pairs) return "all";
  Json links = Json::object();
  if (settings.range_m) links["range_m"] = *settings.range_m;
  if (settings.pairs) links["pairs"] = settings.pairs->size();
  return links;
}

Json propagation_json(const RunFacts& facts) {
  const PropagationSettings& settings = facts.settings.propagation;
  const bool sampled = facts.discovery == Discovery::sampled;
  const bool cached = facts.cache == CacheMode::seed;
  return {{"line_of_sight", settings.line_of_sight},
          {"max_reflections", settings.max_reflections},
          {"max_transmissions", settings.max_transmissions},
          {"max_diffractions", settings.max_diffractions},
          {"max_interactions", interaction_order(settings)},
          {"diffraction", diffraction_json(settings.diffraction)},
          {"discovery", word_of(facts.discovery)},
          {"discovery_asked_for", word_of(settings.discovery)},
          {"exact_interactions", facts.exact_interactions},
          {"rays", sampled ? Json(settings.rays) : Json(nullptr)},
          {"rays_steady", cached ? Json(steady_rays(settings)) : Json(nullptr)},
          {"seed", sampled ? Json(settings.seed) : Json(nullptr)},
          {"cache", word_of(facts.cache)},
          {"antenna_array", word_of(settings.antenna_array)},
          {"diffuse", diffuse_json(settings.diffuse)},
          {"path_loss", path_loss_json(settings.path_loss)},
          {"atmosphere", atmosphere_json(settings.atmosphere)},
          {"min_path_gain_db", optional_json(settings.min_path_gain_db)},
          {"max_path_length_m", optional_json(settings.max_path_length_m)},
          {"valid_until_limit_m", optional_json(settings.valid_until_limit_m)}};
}

}  // namespace

nlohmann::ordered_json settings_json(const RunFacts& facts) {
  const SimulationSettings& settings = facts.settings;
  const std::size_t exact_limit = automatic_exact_facet_limit(settings.propagation);
  return {{"frequency_hz", settings.frequency_hz},
          {"itu", {{"revision", settings.itu.revision}, {"allow_extrapolation", settings.itu.allow_extrapolation}}},
          {"threads", resolve_thread_count(settings.threads)},
          {"tree_policy", word_of(settings.tree.policy)},
          {"tree",
           {{"quality", word_of(settings.tree.build.quality)},
            {"build_threads", settings.tree.build.threads},
            {"huge_pages", settings.tree.build.huge_pages}}},
          {"instructions", name_of(instruction_set())},
          {"time", {{"start_s", facts.time.start_s}, {"step_s", facts.time.step_s}, {"frames", facts.time.frames}}},
          {"links", links_json(settings.links)},
          {"propagation", propagation_json(facts)},
          {"defaults_of_this_version",
           {{"cache", "exact with exact discovery, seed with sampled"},
            {"discovery", "exact up to three interactions, one of them a diffraction, or two diffractions, and up to " +
                              std::to_string(exact_limit) + " facets; else sampled beyond"}}}};
}

}  // namespace dcem::io
