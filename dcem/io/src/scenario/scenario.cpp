#include "dcem/io/scenario.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>

#include "dcem/field/medium_loss.hpp"
#include "dcem/io/src/scenario/keys/blocks.hpp"
#include "dcem/io/src/scenario/scenario_parts.hpp"
#include "dcem/io/src/text/read_log.hpp"
#include "dcem/io/src/text/text_input.hpp"
#include "dcem/sim/discovery.hpp"

namespace dcem::io {

namespace {

/// `--output KEY[,KEY…]` as the `output` block that it stands for. A key that has settings in the file keeps them.
nlohmann::json output_block(std::string_view list, const nlohmann::json& file_output) {
  nlohmann::json block = nlohmann::json::object();
  while (true) {
    const std::size_t comma = std::min(list.find(','), list.size());
    const std::string key(trimmed(list.substr(0, comma)));
    const bool has_settings = file_output.is_object() && file_output.contains(key) && file_output[key].is_structured();
    block[key] = has_settings ? file_output[key] : nlohmann::json(true);
    if (comma == list.size()) return block;
    list.remove_prefix(comma + 1);
  }
}

nlohmann::json command_line_values(const ScenarioOverrides& overrides, const nlohmann::json& file) {
  nlohmann::json values = nlohmann::json::object();
  if (overrides.frequency_hz) values["--frequency"] = *overrides.frequency_hz;
  if (overrides.discovery) values["--discovery"] = *overrides.discovery;
  if (overrides.cache) values["--cache"] = *overrides.cache;
  if (overrides.rays) values["--rays"] = *overrides.rays;
  if (overrides.seed) values["--seed"] = *overrides.seed;
  if (overrides.output) {
    const bool has_output = file.is_object() && file.contains("output");
    values["--output"] = output_block(*overrides.output, has_output ? file["output"] : nlohmann::json());
  }
  return values;
}

/// What is asked for by name and cannot be done is refused, never weakened.
void check_exact_discovery(const Scenario& scenario, const JsonObject& file, const JsonObject& command_line) {
  if (scenario.settings.propagation.discovery != Discovery::exact) return;
  const auto option = command_line.find("--discovery");
  const JsonValue place = option ? *option : file.at("propagation").member("discovery");
  reported_at(place, [&] { plan_search(scenario.settings.propagation, scenario.scene); });
}

/// Where the frequency is: on the command line, or in the file.
JsonValue frequency_in(const JsonObject& file, const JsonObject& command_line) {
  const auto option = command_line.find("--frequency");
  return option ? *option : file.at("frequency_hz");
}

/// Air and foliage must fit the frequency.
void check_frequency(const Scenario& scenario, const JsonValue& place) {
  const SimulationSettings& settings = scenario.settings;
  reported_at(place,
              [&] { MediumLoss(settings.propagation.atmosphere, scenario.scene.materials(), settings.frequency_hz); });
}

/// The band of a frequency response must lie above 0.
void check_band(const Scenario& scenario, const JsonObject& file, const JsonObject& command_line) {
  const double bandwidth_hz = scenario.output.cfr_bandwidth_hz, frequency_hz = scenario.settings.frequency_hz;
  if (!scenario.output.cfr || bandwidth_hz <= 2.0 * frequency_hz) return;
  const auto option = command_line.find("--output");
  const JsonValue output = option ? *option : file.at("output");
  output.member("cfr")
      .member("bandwidth_hz")
      .fail(number_text(bandwidth_hz) + " Hz around " + number_text(frequency_hz) +
            " Hz reach below 0; expected at most twice the frequency");
}

/// A mirror loses what it scatters; where nobody adds that up, power is missing.
void warn_of_lost_scattering(const std::filesystem::path& file, Scenario& scenario) {
  if (scenario.settings.propagation.diffuse.enabled) return;
  for (const Material& material : scenario.scene.materials()) {
    if (!scatters(material)) continue;
    scenario.warnings.push_back(file.string() + ": material " + in_quotes(material.name) +
                                " scatters, which weakens its mirror, and propagation.diffuse is off: what it scatters "
                                "is missing from all powers");
  }
}

/// Links that are longer than any path may be have none: hardly what is meant.
void warn_of_links_without_paths(const std::filesystem::path& file, Scenario& scenario) {
  const auto &range_m = scenario.settings.links.range_m, &longest_m = scenario.settings.propagation.max_path_length_m;
  if (!range_m || !longest_m || *range_m <= *longest_m) return;
  scenario.warnings.push_back(file.string() + ": links.range_m is " + number_text(*range_m) +
                              ", propagation.max_path_length_m " + number_text(*longest_m) +
                              ": longer links have no path, the direct one neither");
}

/// Why a key of the block `propagation` has no effect, and what would give it one; empty where it has one.
std::string_view why_idle(const std::string& key, const PropagationSettings& propagation, Discovery discovery) {
  if (key == "valid_until_limit_m") return why_no_lifetimes(propagation, discovery);
  if (key == "seed" && propagation.diffuse.enabled && propagation.diffuse.phases == DiffusePhases::seeded) return {};
  if (discovery == Discovery::exact) return "discovery is exact, and no ray is shot; expected discovery sampled";
  const bool is_steady = propagation.cache != CacheMode::off;
  return key != "rays_steady" || is_steady ? "" : "the cache is off; expected cache seed";
}

/// What the file says for a discovery or a cache that the command line has replaced was not said for this run.
void warn_of_idle_keys(const JsonObject& file, const JsonObject& command_line, Scenario& scenario) {
  const auto block = file.find("propagation");
  if (!block || command_line.has("--discovery") || command_line.has("--cache")) return;
  std::optional<Discovery> discovery;
  for (const char* key : {"rays", "rays_steady", "seed", "valid_until_limit_m"}) {
    const auto value = block->object().find(key);
    if (!value || value->is_null()) continue;
    if (!discovery) discovery = resolve_discovery(scenario.settings.propagation, scenario.scene);
    const std::string_view why = why_idle(key, scenario.settings.propagation, *discovery);
    if (why.empty()) continue;
    scenario.warnings.push_back(value->place() + ": " + value->path() + " has no effect: " + std::string(why));
  }
}

/// JSON of another kind: better told than by the first key that is unknown.
void check_is_scenario(const JsonValue& root) {
  if (!root.is_object()) root.fail_expected("an object {...}");
  if (!root.raw().contains("format")) {
    root.fail("the key 'format' is missing, this is no scenario; expected \"format\": \"dcem-scenario/1\" in it");
  }
}

Scenario read_scenario(const std::filesystem::path& file, const JsonObject& root, const JsonObject& command_line) {
  root.at("format").word();
  if (const auto schema = root.find("$schema")) schema->text();
  Scenario result;
  result.name = file.stem().string();
  root.at("frequency_hz").number();
  const JsonValue frequency = frequency_in(root, command_line);
  result.settings.frequency_hz = frequency.number();
  result.settings.itu = read_itu(root);
  result.settings.tree = read_tree(root);
  result.settings.propagation = read_propagation(root, command_line);
  result.time = read_time(root);
  result.geo = read_geo(root);
  result.output = read_output(root, command_line);
  result.noise = read_noise(root);
  read_mobility(root, file.parent_path(), result);
  MotionReader motions(file.parent_path(), result.time.start_s);
  BodyLoader(root, file.parent_path(), motions, result).load();
  AntennaReader antennas(file.parent_path());
  read_devices(root, file.parent_path(), motions, antennas, result);
  motions.check_all_taken();
  result.settings.links = read_links(root, result.scene);
  reported_at(root.value(), [&] { validate(result.settings); });
  check_exact_discovery(result, root, command_line);
  check_frequency(result, frequency);
  check_band(result, root, command_line);
  warn_of_lost_scattering(file, result);
  warn_of_links_without_paths(file, result);
  warn_of_idle_keys(root, command_line, result);
  return result;
}

}  // namespace

Scenario load_scenario(const std::filesystem::path& file, const ScenarioOverrides& overrides) {
  const ReadLog log;
  const JsonDocument document(file);
  const JsonDocument command_line("command line", command_line_values(overrides, document.root().raw()));
  check_is_scenario(document.root());
  Scenario scenario = read_scenario(file, document.root().object(keys::scenario_block()),
                                    command_line.root().object(keys::command_line_block()));
  scenario.files = log.files();
  return scenario;
}

std::vector<ReceiverList> take_point_lists(Scenario& scenario) {
  std::vector<Device> receivers = scenario.scene.take_receivers();
  std::vector<ReceiverList> lists;
  std::size_t next = 0;
  const auto put_back_until = [&](std::size_t end) {
    for (; next < end; ++next) scenario.scene.add_receiver(std::move(receivers[next]));
  };
  for (const PointList& list : scenario.point_lists) {
    put_back_until(list.first);
    lists.push_back({list.id, {}});
    for (; next < list.first + list.count; ++next) lists.back().receivers.push_back(std::move(receivers[next]));
  }
  put_back_until(receivers.size());
  scenario.point_lists.clear();
  return lists;
}

}  // namespace dcem::io
