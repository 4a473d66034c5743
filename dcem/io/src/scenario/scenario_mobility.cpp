#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "dcem/io/src/scenario/scenario_parts.hpp"
#include "dcem/io/src/traffic/trace_survey.hpp"
#include "dcem/io/src/traffic/vehicle_types.hpp"

namespace dcem::io {

namespace {

VehicleTypes read_vehicle_types(const JsonObject& mobility, const std::filesystem::path& folder) {
  VehicleTypes types;
  const auto value = mobility.find("vehicle_types");
  if (!value) return types;
  const std::vector<JsonValue> names = value->is_string() ? std::vector<JsonValue>{*value} : value->elements();
  for (const JsonValue& name : names) types.read(existing_file(name, folder, "expected a file of vehicle types"));
  return types;
}

/// Collects the text under `key` of all entries of a list. What is not as it should be is reported where it is read.
void collect_names(const JsonObject& scenario, const char* list, const char* key, std::set<std::string>& names) {
  const auto value = scenario.find(list);
  if (!value || !value->raw().is_array()) return;
  for (const nlohmann::json& entry : value->raw()) {
    if (entry.is_object() && entry.contains(key) && entry[key].is_string()) names.insert(entry[key]);
  }
}

/// The ids whose presence in the trace matters: those that devices ride on, and those that objects have taken.
std::set<std::string> names_of_interest(const JsonObject& scenario) {
  std::set<std::string> names;
  collect_names(scenario, "transmitters", "attach_to", names);
  collect_names(scenario, "receivers", "attach_to", names);
  collect_names(scenario, "objects", "id", names);
  return names;
}

/// Vehicles that `devices` lists by their ids.
void collect_equipped(const JsonObject& mobility, std::set<std::string>& names) {
  const auto devices = mobility.find("devices");
  if (!devices || !devices->raw().is_object() || !devices->raw().contains("vehicles")) return;
  const nlohmann::json& vehicles = devices->raw()["vehicles"];
  if (!vehicles.is_array()) return;
  for (const nlohmann::json& id : vehicles) {
    if (id.is_string()) names.insert(id);
  }
}

/// An instant without the last digits of a sum of steps: "0.3".
std::string instant_text(double time_s) {
  return number_text(std::round(time_s * 1e6) / 1e6) + " s";
}

/// As many frames as fit into the trace.
std::size_t fitting_frames(const TimeSettings& time, const Traffic& traffic) {
  const double steps = std::floor((traffic.last_s - time.start_s + trace_tolerance_s) / time.step_s);
  return static_cast<std::size_t>(std::clamp(steps, 0.0, 1e9 - 1.0)) + 1;
}

void check_time(const JsonValue& place, const TimeSettings& time, const Traffic& traffic) {
  const auto holds = [&](double time_s) {
    return time_s >= traffic.first_s - trace_tolerance_s && time_s <= traffic.last_s + trace_tolerance_s;
  };
  const double last_s = time.time_s(time.frames - 1);
  if (holds(time.start_s) && holds(last_s)) return;
  place.fail("frames from " + instant_text(time.start_s) + " to " + instant_text(last_s) + "; expected instants from " +
             instant_text(traffic.first_s) + " to " + instant_text(traffic.last_s) + ", the range of the trace");
}

/// What `time` leaves open is taken from the trace; all of it: the trace's own steps.
TimeSettings trace_time(const JsonObject& scenario, const Traffic& traffic, std::vector<double>&& step_times_s) {
  TimeSettings time = read_time(scenario);
  const double median_s = median_step_s(step_times_s);
  const auto block = scenario.find("time");
  const auto given = [&](const char* key) { return block && block->raw().contains(key); };
  if (!given("start_s")) time.start_s = traffic.first_s;
  if (!given("step_s") && median_s > 0.0) time.step_s = median_s;
  if (!block) {
    time.frames = step_times_s.size();
    time.instants_s = std::move(step_times_s);
    return time;
  }
  if (!given("frames")) time.frames = fitting_frames(time, traffic);
  check_time(*block, time, traffic);
  return time;
}

}  // namespace

void read_mobility(const JsonObject& scenario, const std::filesystem::path& folder, Scenario& result) {
  const auto block = scenario.find("mobility");
  if (!block) return;
  const JsonObject mobility = block->object();
  mobility.at("material").line();
  const std::filesystem::path trace = existing_file(mobility.at("sumo_fcd"), folder, "expected SUMO's FCD output");
  const VehicleTypes types = read_vehicle_types(mobility, folder);
  SurveyWishes wishes{names_of_interest(scenario), mobility.has("devices"), result.geo};
  collect_equipped(mobility, wishes.names);
  TraceSurvey survey = survey_trace(trace, types, wishes);
  result.time = trace_time(scenario, survey.traffic, std::move(survey.step_times_s));
  result.traffic = std::move(survey.traffic);
}

}  // namespace dcem::io
