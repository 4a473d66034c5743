#include <string_view>

#include "dcem/io/optional_libraries.hpp"
#include "dcem/io/src/exchange/calendar_time.hpp"
#include "dcem/io/src/scenario/scenario_parts.hpp"

namespace dcem::io {

namespace {

/// Whether a file is wanted: `true`, or its settings.
bool is_file_wanted(const JsonObject& output, const std::string& key) {
  const auto value = output.find(key);
  return value && (value->is_object() || value->boolean());
}

/// Refuses a file that this build cannot write.
void require_library(const JsonObject& output, const std::string& key, bool can_write, std::string_view problem,
                     std::string_view expectation) {
  if (!can_write) output.at(key).fail(std::string(problem) + "; expected " + std::string(expectation));
}

KmlSettings read_kml(const JsonObject& object) {
  KmlSettings settings;
  if (const auto range = object.find("range_dbm")) {
    const std::vector<JsonValue> ends = range->elements();
    settings.range_dbm = {ends[0].number(), ends[1].number()};
    if (!(settings.range_dbm[0] < settings.range_dbm[1])) range->fail("no range; expected the lower end first");
  }
  settings.metres_per_db = object.number("metres_per_db", settings.metres_per_db);
  if (const auto start = object.find("start")) {
    const auto instant_us = calendar_microseconds(start->line());
    if (!instant_us) start->fail("no date and time in UTC; expected one as \"2026-05-04T12:00:00Z\"");
    settings.start_us = *instant_us;
  }
  return settings;
}

GltfSettings read_gltf(const JsonObject& object) {
  GltfSettings settings;
  if (const auto frame = object.find("frame")) settings.frame = static_cast<std::size_t>(frame->integer());
  settings.max_rays = object.count("max_rays", settings.max_rays);
  settings.range_db = object.number("range_db", settings.range_db);
  return settings;
}

Hdf5Settings read_hdf5(const JsonObject& object) {
  Hdf5Settings settings;
  if (const auto columns = object.find("columns")) {
    for (const JsonValue& column : columns->elements()) settings.columns.push_back(column.word());
  }
  if (const auto precision = object.find("precision")) settings.single = precision->word() == "single";
  return settings;
}

/// The settings of a file, if there are any.
std::optional<JsonObject> settings_of(const JsonObject& output, const std::string& key) {
  const auto value = output.find(key);
  return value && value->is_object() ? std::optional(value->object()) : std::nullopt;
}

}  // namespace

void require_place(const JsonValue& place) {
  place.fail(
      "the scene has no place on the Earth; expected the block geo with origin_lat_deg and origin_lon_deg, or with crs "
      "and offset_m");
}

ExchangeSettings read_exchange(const JsonObject& object, bool has_place) {
  ExchangeSettings exchange;
  exchange.mat = object.boolean("mat", false);
  if (exchange.mat) require_library(object, "mat", can_write_mat(), no_mat, mat_expected);
  exchange.qd = object.boolean("qd", false);
  exchange.p2m = object.boolean("p2m", false);
  exchange.deepmimo = object.boolean("deepmimo", false);
  exchange.hdf5 = is_file_wanted(object, "hdf5");
  if (exchange.hdf5) require_library(object, "hdf5", can_write_hdf5(), no_hdf5, hdf5_expected);
  if (const auto hdf5 = settings_of(object, "hdf5")) exchange.hdf5_settings = read_hdf5(*hdf5);
  exchange.gltf = is_file_wanted(object, "gltf");
  if (const auto gltf = settings_of(object, "gltf")) exchange.gltf_settings = read_gltf(*gltf);
  exchange.kml = is_file_wanted(object, "kml");
  if (exchange.kml && !has_place) require_place(object.at("kml"));
  if (const auto kml = settings_of(object, "kml")) exchange.kml_settings = read_kml(*kml);
  return exchange;
}

}  // namespace dcem::io
