#include "dcem/io/combined_map_writer.hpp"

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "dcem/io/esri_grid.hpp"
#include "dcem/io/src/maps/map_arrays.hpp"
#include "dcem/io/src/pictures/map_picture_parts.hpp"
#include "dcem/io/src/text/number_text.hpp"
#include "dcem/io/src/text/sheet.hpp"
#include "dcem/io/text_table.hpp"

namespace dcem::io {
namespace {

/// What links can use: below, none decodes; above, all do. The same in every map, so that maps can be compared.
constexpr ValueRange sinr_colours_db{-10.0, 30.0};

using Value = std::optional<double> CombinedMapPoint::*;

void write_csv(AtomicFile& file, const CombinedMap& map, std::string_view header, Value first, Value second) {
  std::vector<std::string> names;
  for (const std::string& id : map.transmitters) names.push_back(csv_field(id));
  std::string text = std::string(header) + '\n';
  for (const CombinedMapPoint& point : map.points) {
    CsvLine line(text);
    line.number(point.position_m.x).number(point.position_m.y).number(point.position_m.z);
    line.prepared(point.server ? names[*point.server] : std::string());
    line.number(point.*first).number(point.*second).end();
    if (text.size() >= sheet_bytes) file.write(std::exchange(text, {}));
  }
  file.write(text);
}

void write_npz(AtomicFile& file, const CombinedMap& map, const char* first_name, Value first, const char* second_name,
               Value second) {
  MapArrays arrays(map.places, map.points);
  arrays.add_counts("tx", [](const CombinedMapPoint& point) { return point.server.value_or(0); });
  arrays.add_flags("served", [](const CombinedMapPoint& point) { return point.server.has_value(); });
  arrays.add_flags("obstructed", [](const CombinedMapPoint& point) { return point.obstructed; });
  arrays.add_flags("sheltered", [](const CombinedMapPoint& point) { return point.sheltered; });
  arrays.add_numbers(first_name, [&](const CombinedMapPoint& point) { return point.*first; });
  arrays.add_numbers(second_name, [&](const CombinedMapPoint& point) { return point.*second; });
  arrays.writer().add("tx_id", {map.transmitters.size()}, std::span<const std::string>(map.transmitters));
  arrays.writer().write(file);
}

std::optional<double> server_number(const CombinedMapPoint& point) {
  return point.server ? std::optional(static_cast<double>(*point.server)) : std::nullopt;
}

template <typename Get>
std::vector<double> values_of(const CombinedMap& map, Get&& get) {
  std::vector<double> values;
  values.reserve(map.points.size());
  for (const CombinedMapPoint& point : map.points) values.push_back(get(point).value_or(no_value_db));
  return values;
}

HeatMap picture_without_values(const CombinedMap& map, const MapOccasion& occasion, const std::string& what) {
  HeatMap picture = empty_map_picture(map.grid(), occasion, map.places.id() + ": " + what);
  for (const CombinedMapPoint& point : map.points) hatch_point(picture, point);
  return picture;
}

}  // namespace

void write_best_server_csv(AtomicFile& file, const CombinedMap& map) {
  write_csv(file, map, best_server_csv_header, &CombinedMapPoint::power_dbm, &CombinedMapPoint::power_incoherent_dbm);
}

void write_sinr_csv(AtomicFile& file, const CombinedMap& map) {
  write_csv(file, map, sinr_csv_header, &CombinedMapPoint::sinr_db, &CombinedMapPoint::snr_db);
}

void write_best_server_npz(AtomicFile& file, const CombinedMap& map) {
  write_npz(file, map, "power_dbm", &CombinedMapPoint::power_dbm, "power_incoherent_dbm",
            &CombinedMapPoint::power_incoherent_dbm);
}

void write_sinr_npz(AtomicFile& file, const CombinedMap& map) {
  write_npz(file, map, "sinr_db", &CombinedMapPoint::sinr_db, "snr_db", &CombinedMapPoint::snr_db);
}

void write_best_server_asc(AtomicFile& file, const CombinedMap& map) {
  write_esri_grid(file, map.grid(), values_of(map, server_number));
}

void write_sinr_asc(AtomicFile& file, const CombinedMap& map) {
  write_esri_grid(file, map.grid(), values_of(map, [](const CombinedMapPoint& point) { return point.sinr_db; }));
}

HeatMap best_server_picture(const CombinedMap& map, const Scene& scene, const Frame& frame, double frequency_hz,
                            std::optional<double> time_s) {
  HeatMap picture = picture_without_values(map, {scene, frame, frequency_hz, time_s}, "best server");
  picture.values = values_of(map, server_number);
  picture.categories = map.transmitters;
  return picture;
}

HeatMap sinr_picture(const CombinedMap& map, const Scene& scene, const Frame& frame, double frequency_hz,
                     bool has_noise, std::optional<double> time_s) {
  const std::string ratio = has_noise ? "SINR" : "SIR (no noise)";
  HeatMap picture = picture_without_values(map, {scene, frame, frequency_hz, time_s}, ratio + " of the best server");
  picture.values = values_of(map, [](const CombinedMapPoint& point) { return point.sinr_db; });
  picture.label = ratio;
  picture.unit = "dB";
  picture.range = sinr_colours_db;
  return picture;
}

}  // namespace dcem::io
