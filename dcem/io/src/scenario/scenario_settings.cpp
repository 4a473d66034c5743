#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <set>

#include "dcem/io/src/scenario/enum_words.hpp"
#include "dcem/io/src/scenario/scenario_parts.hpp"
#include "dcem/io/viewer_writer.hpp"

namespace dcem::io {

namespace {

constexpr long long highest_order = 10, highest_diffraction_order = 3;

/// The keys of `output` that this version does not write.
const std::vector<std::string> later_outputs{"mat", "qd", "p2m", "deepmimo", "kml", "gltf"};

/// The value from the command line, or else the one from the file.
std::optional<JsonValue> chosen(const JsonObject& command_line, const std::string& option,
                                const std::optional<JsonObject>& file, const std::string& key) {
  const std::optional<JsonValue> overriding = command_line.find(option);
  if (overriding || !file) return overriding;
  return file->find(key);
}

std::optional<JsonObject> find_object(const JsonObject& parent, const std::string& key,
                                      const std::vector<std::string>& known_keys) {
  const std::optional<JsonValue> value = parent.find(key);
  return value ? std::optional(value->object(known_keys)) : std::nullopt;
}

CacheMode read_cache(const JsonValue& value) {
  if (value.one_of({"off", "seed", "exact"}) == "exact") value.not_in_this_version("off or seed");
  return read_word<CacheMode>(value);
}

AnyPathLoss read_path_loss(const JsonValue& value) {
  const JsonObject object = value.object({"model", "exponent", "attenuation_db_per_m"});
  if (object.at("model").one_of({"free_space", "close_in"}) == "free_space") {
    for (const char* key : {"exponent", "attenuation_db_per_m"}) {
      if (object.has(key)) object.at(key).fail("does not go with model 'free_space'; expected no such key");
    }
    return {FreeSpace{}};
  }
  const CloseIn model{object.number("exponent", 2.0, {0.0, 10.0, true}),
                      object.number("attenuation_db_per_m", 0.0, {0.0, 1000.0})};
  return {reported_at(value, [&] { return validate(model), model; })};
}

DiffractionSettings read_diffraction(const JsonValue& value) {
  const JsonObject object = value.object({"lossy_wedge", "region", "free_edges", "min_exterior_angle_deg"});
  DiffractionSettings settings;
  settings.lossy_wedge = read_word(object, "lossy_wedge", settings.lossy_wedge);
  settings.region = read_word(object, "region", settings.region);
  settings.free_edges = object.boolean("free_edges", settings.free_edges);
  settings.min_exterior_angle_deg =
      object.number("min_exterior_angle_deg", settings.min_exterior_angle_deg, {180.0, 360.0, true});
  return settings;
}

DiffuseSettings read_diffuse(const JsonValue& value) {
  const JsonObject object =
      value.object({"enabled", "tile_max_m", "tolerance_db", "phases", "list_paths", "tile_budget"});
  DiffuseSettings settings;
  settings.enabled = object.boolean("enabled", true);
  if (const auto longest = object.find("tile_max_m"); longest && !longest->is_null()) {
    settings.tile_max_m = longest->number({1e-3, 1e6});
  }
  settings.tolerance_db = object.number("tolerance_db", settings.tolerance_db, {1e-4, 10.0});
  settings.phases = read_word(object, "phases", settings.phases);
  settings.list_paths = object.boolean("list_paths", settings.list_paths);
  settings.tile_budget = static_cast<std::size_t>(
      object.integer("tile_budget", static_cast<long long>(settings.tile_budget), 1, 100'000'000));
  return settings;
}

Atmosphere read_atmosphere(const JsonValue& value) {
  const JsonObject object =
      value.object({"gas", "temperature_k", "dry_pressure_hpa", "water_vapour_g_per_m3", "rain_mm_per_h"});
  Atmosphere atmosphere;
  const NumberRange any{-1e9, 1e9};
  atmosphere.gas = object.boolean("gas", atmosphere.gas);
  atmosphere.temperature_k = object.number("temperature_k", atmosphere.temperature_k, any);
  atmosphere.dry_pressure_hpa = object.number("dry_pressure_hpa", atmosphere.dry_pressure_hpa, any);
  atmosphere.water_vapour_g_per_m3 = object.number("water_vapour_g_per_m3", atmosphere.water_vapour_g_per_m3, any);
  atmosphere.rain_mm_per_h = object.number("rain_mm_per_h", atmosphere.rain_mm_per_h, any);
  return reported_at(value, [&] { return validate(atmosphere), atmosphere; });
}

void read_pdp(const JsonValue& value, OutputSettings& output) {
  output.pdp = value.is_boolean() ? value.boolean() : true;
  if (value.is_boolean()) return;
  const JsonObject object = value.object({"bin_s", "mode"});
  output.pdp_bin_s = object.number("bin_s", output.pdp_bin_s, {1e-15, 1.0});
  output.pdp_mode = read_word(object, "mode", PdpMode::incoherent);
}

void read_cfr(const JsonValue& value, OutputSettings& output) {
  output.cfr = value.is_boolean() ? value.boolean() : true;
  if (value.is_boolean()) return;
  const JsonObject object = value.object({"bandwidth_hz", "points"});
  output.cfr_bandwidth_hz = object.at("bandwidth_hz").number({0.0, 1e12});
  output.cfr_points = static_cast<std::size_t>(object.at("points").integer(1, 1'000'000));
}

void read_doppler(const JsonValue& value, OutputSettings& output) {
  output.doppler = value.is_boolean() ? value.boolean() : true;
  if (value.is_boolean()) return;
  output.doppler_bin_hz = value.object({"bin_hz"}).number("bin_hz", output.doppler_bin_hz, {1e-6, 1e9});
}

void read_plots(const JsonValue& value, OutputSettings& output) {
  output.plots = value.is_boolean() ? value.boolean() : true;
  if (value.is_boolean()) return;
  const JsonObject object = value.object({"max_links", "pdp_frame"});
  output.plots_max_links =
      static_cast<std::size_t>(object.integer("max_links", static_cast<long long>(output.plots_max_links), 1, 10'000));
  if (const auto frame = object.find("pdp_frame")) {
    output.plots_pdp_frame = static_cast<std::size_t>(frame->integer(0, 999'999'999));
  }
}

/// `true`, or a list of the endings of the files that are wanted.
MapOutputs read_map_outputs(const JsonValue& value) {
  const std::vector<std::string> endings{"csv", "png", "npz", "asc", "svg"};
  MapOutputs outputs;
  if (value.is_boolean()) {
    if (!value.boolean()) value.fail("is false; expected true, or a list of csv, png, npz, asc, svg");
    return outputs;
  }
  std::set<std::string> wanted;
  for (const JsonValue& ending : value.elements()) wanted.insert(ending.one_of(endings));
  if (wanted.empty()) value.fail("is an empty list; expected some of csv, png, npz, asc, svg");
  const auto has = [&](const char* ending) { return wanted.contains(ending); };
  return {has("csv"), has("png"), has("npz"), has("asc"), has("svg")};
}

void read_html(const JsonValue& value, OutputSettings& output) {
  output.html = value.is_boolean() ? value.boolean() : true;
  if (output.html && !viewer_is_built_in()) {
    value.fail("this build has no viewer; expected three.js (libjs-three) when DCEM was built");
  }
  if (value.is_boolean()) return;
  const JsonObject object = value.object({"max_rays", "max_frames"});
  const auto count = [&](const char* key, std::size_t absent, long long most) {
    return static_cast<std::size_t>(object.integer(key, static_cast<long long>(absent), 1, most));
  };
  output.viewer.max_rays = count("max_rays", output.viewer.max_rays, 10'000'000);
  output.viewer.max_frames = count("max_frames", output.viewer.max_frames, 1'000'000);
}

OutputSettings read_output_keys(const JsonValue& value, bool links_unless_said) {
  std::vector<std::string> known{"paths", "links", "pdp", "cfr", "doppler", "npz", "plots", "map", "html"};
  known.insert(known.end(), later_outputs.begin(), later_outputs.end());
  const JsonObject object = value.object(known);
  for (const std::string& key : later_outputs) {
    const auto later = object.find(key);
    if (later && !(later->is_boolean() && !later->boolean())) later->not_in_this_version("false");
  }
  OutputSettings output;
  output.paths = object.boolean("paths", false);
  output.links = object.boolean("links", links_unless_said);
  if (const auto pdp = object.find("pdp")) read_pdp(*pdp, output);
  if (const auto cfr = object.find("cfr")) read_cfr(*cfr, output);
  if (const auto doppler = object.find("doppler")) read_doppler(*doppler, output);
  output.npz = object.boolean("npz", false);
  if (const auto plots = object.find("plots")) read_plots(*plots, output);
  if (const auto map = object.find("map")) output.map = read_map_outputs(*map);
  if (const auto html = object.find("html")) read_html(*html, output);
  return output;
}

}  // namespace

TimeSettings read_time(const JsonObject& scenario) {
  TimeSettings time;
  const auto object = find_object(scenario, "time", {"start_s", "step_s", "frames"});
  if (!object) return time;
  time.start_s = object->number("start_s", time.start_s, any_instant_s);
  time.step_s = object->number("step_s", time.step_s, {0.0, 1e9, true});
  time.frames = static_cast<std::size_t>(object->integer("frames", 1, 1, 1'000'000'000));
  return time;
}

ItuSettings read_itu(const JsonObject& scenario) {
  ItuSettings itu;
  const auto object = find_object(scenario, "itu", {"revision", "allow_extrapolation"});
  if (!object) return itu;
  itu.revision = static_cast<int>(object->integer("revision", itu.revision, 3, 4));
  itu.allow_extrapolation = object->boolean("allow_extrapolation", itu.allow_extrapolation);
  return itu;
}

WideTreeSettings read_tree(const JsonObject& scenario) {
  WideTreeSettings tree;
  const auto object = find_object(scenario, "tree", {"policy", "quality", "build_threads", "huge_pages"});
  if (!object) return tree;
  tree.policy = read_word(*object, "policy", tree.policy);
  tree.build.quality = read_word(*object, "quality", tree.build.quality);
  tree.build.threads = static_cast<unsigned>(object->integer("build_threads", tree.build.threads, 0, 4096));
  tree.build.huge_pages = object->boolean("huge_pages", tree.build.huge_pages);
  return tree;
}

SurfaceSettings read_surface_settings(const JsonObject& scene) {
  const NumberRange tolerance_m{1e-9, 1.0};
  SurfaceSettings settings;
  settings.weld_tolerance_m = scene.number("weld_tolerance_m", settings.weld_tolerance_m, tolerance_m);
  settings.planarity_tolerance_m = scene.number("planarity_tolerance_m", settings.planarity_tolerance_m, tolerance_m);
  return settings;
}

PropagationSettings read_propagation(const JsonObject& scenario, const JsonObject& command_line) {
  PropagationSettings settings;
  const auto file = find_object(scenario, "propagation",
                                {"line_of_sight", "max_reflections", "max_transmissions", "max_diffractions",
                                 "max_interactions", "discovery", "rays", "rays_steady", "seed", "cache", "diffraction",
                                 "diffuse", "path_loss", "atmosphere", "antenna_array", "min_path_gain_db"});
  if (file) {
    settings.line_of_sight = file->boolean("line_of_sight", settings.line_of_sight);
    settings.max_reflections =
        static_cast<int>(file->integer("max_reflections", settings.max_reflections, 0, highest_order));
    settings.max_transmissions =
        static_cast<int>(file->integer("max_transmissions", settings.max_transmissions, 0, highest_order));
    settings.max_diffractions =
        static_cast<int>(file->integer("max_diffractions", settings.max_diffractions, 0, highest_diffraction_order));
    if (const auto value = file->find("diffraction")) settings.diffraction = read_diffraction(*value);
    if (const auto value = file->find("max_interactions")) {
      settings.max_interactions = static_cast<int>(value->integer(0, highest_order + highest_diffraction_order));
    }
    if (const auto value = file->find("rays_steady")) {
      settings.rays_steady = static_cast<std::uint32_t>(value->integer(1, 100'000'000));
    }
    if (const auto value = file->find("antenna_array"); value && !value->is_null()) {
      settings.antenna_array = read_word<ArrayChannel>(*value);
    }
    if (const auto value = file->find("diffuse")) settings.diffuse = read_diffuse(*value);
    if (const auto value = file->find("atmosphere"); value && !value->is_null()) {
      settings.atmosphere = read_atmosphere(*value);
    }
    if (const auto value = file->find("path_loss")) settings.path_loss = read_path_loss(*value);
    if (const auto value = file->find("min_path_gain_db"); value && !value->is_null()) {
      settings.min_path_gain_db = value->number({-10'000.0, 1000.0});
    }
  }
  if (const auto value = chosen(command_line, "--cache", file, "cache")) {
    settings.cache = read_cache(*value);
  }
  if (const auto value = chosen(command_line, "--discovery", file, "discovery")) {
    settings.discovery = read_word<Discovery>(*value);
  }
  if (const auto value = chosen(command_line, "--rays", file, "rays")) {
    settings.rays = static_cast<std::uint32_t>(value->integer(1, 100'000'000));
  }
  if (const auto value = chosen(command_line, "--seed", file, "seed")) {
    settings.seed = static_cast<std::uint64_t>(value->integer(0, 9'000'000'000'000'000'000));
  }
  return settings;
}

OutputSettings read_output(const JsonObject& scenario, const JsonObject& command_line) {
  if (const auto value = command_line.find("--output")) return read_output_keys(*value, false);
  const auto value = scenario.find("output");
  return value ? read_output_keys(*value, true) : OutputSettings{};
}

std::optional<NoiseSettings> read_noise(const JsonObject& scenario) {
  const auto object = find_object(scenario, "noise", {"bandwidth_hz", "noise_figure_db", "temperature_k"});
  if (!object) return std::nullopt;
  NoiseSettings noise;
  noise.bandwidth_hz = object->at("bandwidth_hz").number({0.0, 1e12, true});
  noise.noise_figure_db = object->number("noise_figure_db", noise.noise_figure_db, {0.0, 100.0});
  noise.temperature_k = object->number("temperature_k", noise.temperature_k, {0.0, 1e6, true});
  return noise;
}

void refuse_later_blocks(const JsonObject& scenario) {
  if (scenario.has("geo")) scenario.at("geo").not_in_this_version("no such key");
  const auto links = scenario.find("links");
  if (links && !(links->is_string() && links->text() == "all")) links->not_in_this_version("\"all\"");
}

}  // namespace dcem::io
