#include <cstdint>
#include <set>

#include "dcem/io/src/scenario/enum_words.hpp"
#include "dcem/io/src/scenario/keys/blocks.hpp"
#include "dcem/io/src/scenario/scenario_parts.hpp"
#include "dcem/io/src/text/text_input.hpp"
#include "dcem/io/viewer_writer.hpp"

namespace dcem::io {

namespace {

/// The value from the command line, or else the one from the file.
std::optional<JsonValue> chosen(const JsonObject& command_line, const std::string& option,
                                const std::optional<JsonObject>& file, const std::string& key) {
  const std::optional<JsonValue> overriding = command_line.find(option);
  if (overriding || !file) return overriding;
  return file->find(key);
}

std::optional<JsonObject> find_object(const JsonObject& parent, const std::string& key) {
  const std::optional<JsonValue> value = parent.find(key);
  return value ? std::optional(value->object()) : std::nullopt;
}

/// The value of a key that may also be null, which says as much as no key.
std::optional<JsonValue> find_unless_null(const JsonObject& parent, const std::string& key) {
  const std::optional<JsonValue> value = parent.find(key);
  return value && !value->is_null() ? value : std::nullopt;
}

AnyPathLoss read_path_loss(const JsonValue& value) {
  const JsonObject object = value.object();
  if (object.at("model").word() == "free_space") {
    for (const char* key : {"exponent", "attenuation_db_per_m"}) {
      if (object.has(key)) object.at(key).fail("does not go with model 'free_space'; expected no such key");
    }
    return {FreeSpace{}};
  }
  CloseIn model;
  model.exponent = object.number("exponent", model.exponent);
  model.attenuation_db_per_m = object.number("attenuation_db_per_m", model.attenuation_db_per_m);
  return {reported_at(value, [&] { return validate(model), model; })};
}

DiffractionSettings read_diffraction(const JsonValue& value) {
  const JsonObject object = value.object();
  DiffractionSettings settings;
  settings.lossy_wedge = read_word(object, "lossy_wedge", settings.lossy_wedge);
  settings.region = read_word(object, "region", settings.region);
  settings.free_edges = object.boolean("free_edges", settings.free_edges);
  settings.min_exterior_angle_deg = object.number("min_exterior_angle_deg", settings.min_exterior_angle_deg);
  return settings;
}

DiffuseSettings read_diffuse(const JsonValue& value) {
  const JsonObject object = value.object();
  DiffuseSettings settings;
  settings.enabled = object.boolean("enabled", true);
  if (const auto longest = find_unless_null(object, "tile_max_m")) settings.tile_max_m = longest->number();
  settings.tolerance_db = object.number("tolerance_db", settings.tolerance_db);
  settings.phases = read_word(object, "phases", settings.phases);
  settings.list_paths = object.boolean("list_paths", settings.list_paths);
  settings.tile_budget = object.count("tile_budget", settings.tile_budget);
  return settings;
}

Atmosphere read_atmosphere(const JsonValue& value) {
  const JsonObject object = value.object();
  Atmosphere atmosphere;
  atmosphere.gas = object.boolean("gas", atmosphere.gas);
  atmosphere.temperature_k = object.number("temperature_k", atmosphere.temperature_k);
  atmosphere.dry_pressure_hpa = object.number("dry_pressure_hpa", atmosphere.dry_pressure_hpa);
  atmosphere.water_vapour_g_per_m3 = object.number("water_vapour_g_per_m3", atmosphere.water_vapour_g_per_m3);
  atmosphere.rain_mm_per_h = object.number("rain_mm_per_h", atmosphere.rain_mm_per_h);
  return reported_at(value, [&] { return validate(atmosphere), atmosphere; });
}

/// Whether a file is wanted: `true`, or its settings.
bool is_wanted(const JsonValue& value) {
  return value.is_boolean() ? value.boolean() : true;
}

void read_paths(const JsonValue& value, OutputSettings& output) {
  output.paths = is_wanted(value);
  if (value.is_boolean()) return;
  const JsonObject object = value.object();
  if (const auto top = object.find("top")) output.paths_top = static_cast<std::size_t>(top->integer());
  output.paths_gzip = object.boolean("gzip", output.paths_gzip);
}

void read_pdp(const JsonValue& value, OutputSettings& output) {
  output.pdp = is_wanted(value);
  if (value.is_boolean()) return;
  const JsonObject object = value.object();
  output.pdp_bin_s = object.number("bin_s", output.pdp_bin_s);
  output.pdp_mode = read_word(object, "mode", output.pdp_mode);
}

void read_cfr(const JsonValue& value, OutputSettings& output) {
  output.cfr = is_wanted(value);
  if (value.is_boolean()) return;
  const JsonObject object = value.object();
  output.cfr_bandwidth_hz = object.at("bandwidth_hz").number();
  output.cfr_points = static_cast<std::size_t>(object.at("points").integer());
}

void read_doppler(const JsonValue& value, OutputSettings& output) {
  output.doppler = is_wanted(value);
  if (!value.is_boolean()) output.doppler_bin_hz = value.object().number("bin_hz", output.doppler_bin_hz);
}

[[noreturn]] void refuse_drawing(const JsonValue& value) {
  value.fail(std::string(no_drawing) + "; expected " + std::string(drawing_expected));
}

/// Formats of pictures, each once, in the order of the enumeration; other words are none.
std::vector<PictureFormat> read_formats(const JsonValue& list) {
  std::vector<PictureFormat> formats;
  for (const PictureFormat format : {PictureFormat::png, PictureFormat::svg, PictureFormat::pdf}) {
    for (const JsonValue& word : list.elements()) {
      if (picture_format(word.word()) != format) continue;
      if (!can_draw() && format != PictureFormat::png) refuse_drawing(word);
      if (formats.empty() || formats.back() != format) formats.push_back(format);
    }
  }
  return formats;
}

void read_plots(const JsonValue& value, OutputSettings& output) {
  output.plots = is_wanted(value);
  if (output.plots && !can_draw()) refuse_drawing(value);
  if (value.is_boolean()) return;
  const JsonObject object = value.object();
  output.plots_max_links = object.count("max_links", output.plots_max_links);
  if (const auto frame = object.find("pdp_frame")) output.plots_pdp_frame = static_cast<std::size_t>(frame->integer());
  if (const auto formats = object.find("formats")) output.plots_formats = read_formats(*formats);
}

/// Which endings are wanted.
MapOutputs read_map_files(const JsonValue& list) {
  std::set<std::string> wanted;
  for (const JsonValue& ending : list.elements()) wanted.insert(ending.word());
  return {wanted.contains("csv"), wanted.contains("npz"), wanted.contains("asc"), read_formats(list),
          wanted.contains("kml")};
}

ValueRange read_range(const JsonValue& value) {
  const std::vector<JsonValue> ends = value.elements();
  const ValueRange range{ends[0].number(), ends[1].number()};
  if (!(range.low < range.high)) value.fail("no range; expected the lower end first");
  return range;
}

/// `true`, a list of endings, or both and how maps are drawn.
void read_map(const JsonValue& value, OutputSettings& output) {
  if (value.is_boolean()) return void(value.boolean());
  if (value.raw().is_array()) return void(output.map = read_map_files(value));
  const JsonObject object = value.object();
  MapPictureSettings& pictures = output.map_pictures;
  if (const auto files = object.find("files")) output.map = read_map_files(*files);
  if (const auto range = object.find("range_dbm")) pictures.range_dbm = read_range(*range);
  if (const auto step = object.find("contours_db")) pictures.contours_db = step->number();
  pictures.finer_cells = object.count("finer_cells", pictures.finer_cells);
  pictures.hillshade = object.boolean("hillshade", pictures.hillshade);
}

void read_html(const JsonValue& value, OutputSettings& output) {
  output.html = is_wanted(value);
  if (output.html && !viewer_is_built_in()) {
    value.fail("this build has no viewer; expected three.js (libjs-three) when DCEM was built");
  }
  if (value.is_boolean()) return;
  const JsonObject object = value.object();
  output.viewer.max_rays = object.count("max_rays", output.viewer.max_rays);
  output.viewer.max_frames = object.count("max_frames", output.viewer.max_frames);
}

OutputSettings read_output_keys(const JsonValue& value, bool links_unless_said, bool has_place) {
  const JsonObject object = value.object();
  OutputSettings output;
  if (const auto paths = object.find("paths")) read_paths(*paths, output);
  output.links = object.boolean("links", links_unless_said);
  if (const auto pdp = object.find("pdp")) read_pdp(*pdp, output);
  if (const auto cfr = object.find("cfr")) read_cfr(*cfr, output);
  if (const auto doppler = object.find("doppler")) read_doppler(*doppler, output);
  output.npz = object.boolean("npz", false);
  if (const auto plots = object.find("plots")) read_plots(*plots, output);
  if (const auto map = object.find("map")) {
    read_map(*map, output);
    if (output.map.kml && !has_place) require_place(*map);
  }
  if (const auto html = object.find("html")) read_html(*html, output);
  output.exchange = read_exchange(object, has_place);
  return output;
}

void read_orders(const JsonObject& file, PropagationSettings& settings) {
  const auto order = [&](const char* key, int absent) { return static_cast<int>(file.integer(key, absent)); };
  settings.line_of_sight = file.boolean("line_of_sight", settings.line_of_sight);
  settings.max_reflections = order("max_reflections", settings.max_reflections);
  settings.max_transmissions = order("max_transmissions", settings.max_transmissions);
  settings.max_diffractions = order("max_diffractions", settings.max_diffractions);
  if (const auto value = file.find("max_interactions")) settings.max_interactions = static_cast<int>(value->integer());
}

void read_fields(const JsonObject& file, PropagationSettings& settings) {
  if (const auto value = file.find("diffraction")) settings.diffraction = read_diffraction(*value);
  if (const auto value = file.find("diffuse")) settings.diffuse = read_diffuse(*value);
  if (const auto value = file.find("path_loss")) settings.path_loss = read_path_loss(*value);
  if (const auto value = find_unless_null(file, "atmosphere")) settings.atmosphere = read_atmosphere(*value);
  if (const auto value = find_unless_null(file, "antenna_array")) {
    settings.antenna_array = read_word<ArrayChannel>(*value);
  }
  if (const auto value = find_unless_null(file, "min_path_gain_db")) settings.min_path_gain_db = value->number();
  if (const auto value = find_unless_null(file, "max_path_length_m")) settings.max_path_length_m = value->number();
  if (const auto value = find_unless_null(file, "valid_until_limit_m")) settings.valid_until_limit_m = value->number();
}

}  // namespace

TimeSettings read_time(const JsonObject& scenario) {
  constexpr double shortest_step_s = 1e-12;
  TimeSettings time;
  const auto object = find_object(scenario, "time");
  if (!object) return time;
  time.start_s = object->number("start_s", time.start_s);
  time.step_s = object->number("step_s", time.step_s);
  time.frames = object->count("frames", time.frames);
  const double last_s = time.time_s(time.frames - 1);
  if (time.frames > 1 && !(time.step_s >= shortest_step_s && last_s > time.time_s(time.frames - 2))) {
    (object->has("step_s") ? object->at("step_s") : object->at("start_s"))
        .fail("frames of one and the same instant; expected steps of a picosecond at least that count beside " +
              number_text(last_s) + " s");
  }
  return time;
}

ItuSettings read_itu(const JsonObject& scenario) {
  ItuSettings itu;
  const auto object = find_object(scenario, "itu");
  if (!object) return itu;
  itu.revision = static_cast<int>(object->integer("revision", itu.revision));
  itu.allow_extrapolation = object->boolean("allow_extrapolation", itu.allow_extrapolation);
  return itu;
}

WideTreeSettings read_tree(const JsonObject& scenario) {
  WideTreeSettings tree;
  const auto object = find_object(scenario, "tree");
  if (!object) return tree;
  tree.policy = read_word(*object, "policy", tree.policy);
  tree.build.quality = read_word(*object, "quality", tree.build.quality);
  tree.build.threads = static_cast<unsigned>(object->integer("build_threads", tree.build.threads));
  tree.build.huge_pages = object->boolean("huge_pages", tree.build.huge_pages);
  return tree;
}

SurfaceSettings read_surface_settings(const JsonObject& scene) {
  SurfaceSettings settings;
  settings.weld_tolerance_m = scene.number("weld_tolerance_m", settings.weld_tolerance_m);
  settings.planarity_tolerance_m = scene.number("planarity_tolerance_m", settings.planarity_tolerance_m);
  return settings;
}

PropagationSettings read_propagation(const JsonObject& scenario, const JsonObject& command_line) {
  PropagationSettings settings;
  const auto file = find_object(scenario, "propagation");
  if (file) {
    read_orders(*file, settings);
    read_fields(*file, settings);
    if (const auto value = file->find("rays_steady")) {
      settings.rays_steady = static_cast<std::uint32_t>(value->integer());
    }
  }
  if (const auto value = chosen(command_line, "--cache", file, "cache")) {
    settings.cache = read_word<CacheMode>(*value);
  }
  if (const auto value = chosen(command_line, "--discovery", file, "discovery")) {
    settings.discovery = read_word<Discovery>(*value);
  }
  if (const auto value = chosen(command_line, "--rays", file, "rays")) {
    settings.rays = static_cast<std::uint32_t>(value->integer());
  }
  if (const auto value = chosen(command_line, "--seed", file, "seed")) {
    settings.seed = static_cast<std::uint64_t>(value->integer());
  }
  return settings;
}

OutputSettings read_output(const JsonObject& scenario, const JsonObject& command_line) {
  const bool has_place = scenario.has("geo");
  if (const auto value = command_line.find("--output")) return read_output_keys(*value, false, has_place);
  const auto value = scenario.find("output");
  return value ? read_output_keys(*value, true, has_place) : OutputSettings{};
}

std::optional<NoiseSettings> read_noise(const JsonObject& scenario) {
  const auto object = find_object(scenario, "noise");
  if (!object) return std::nullopt;
  NoiseSettings noise;
  noise.bandwidth_hz = object->at("bandwidth_hz").number();
  noise.noise_figure_db = object->number("noise_figure_db", noise.noise_figure_db);
  noise.temperature_k = object->number("temperature_k", noise.temperature_k);
  return noise;
}

}  // namespace dcem::io
