#include "dcem/io/map_writer.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

#include "dcem/em/surface/material_table.hpp"
#include "dcem/io/esri_grid.hpp"
#include "dcem/io/src/maps/map_arrays.hpp"
#include "dcem/io/src/pictures/map_picture_parts.hpp"
#include "dcem/io/src/text/file_name.hpp"
#include "dcem/io/src/text/number_text.hpp"
#include "dcem/io/src/text/sheet.hpp"
#include "dcem/io/text_table.hpp"

namespace dcem::io {
namespace {

std::optional<double> field_dbuv_per_m(const RadioMapPoint& point, double frequency_hz) {
  const std::optional<double>& power_dbm = point.statistics.power_dbm;
  return power_dbm ? std::optional(field_strength_dbuv_per_m(*power_dbm, frequency_hz)) : std::nullopt;
}

void append_point(std::string& text, const RadioMapPoint& point, double frequency_hz) {
  CsvLine line(text);
  line.number(point.position_m.x).number(point.position_m.y).number(point.position_m.z);
  if (point.obstructed) {
    line.empty(9).end();
    return;
  }
  const LinkStatistics& values = point.statistics;
  line.number(values.power_dbm).number(values.power_incoherent_dbm).number(values.path_gain_db);
  line.number(field_dbuv_per_m(point, frequency_hz)).number(values.mean_delay_s).number(values.rms_delay_spread_s);
  line.flag(values.line_of_sight).count(values.path_count).prepared(point.strongest_kinds).end();
}

// The point of the edge from a lower to a higher corner at `height_m`. Always taken in this direction, so two triangles
// that share the edge get the same point to the last bit.
Vec2 edge_point_m(const Vec3& low_m, const Vec3& high_m, double height_m) {
  const double share = (height_m - low_m.z) / (high_m.z - low_m.z);
  return {low_m.x + share * (high_m.x - low_m.x), low_m.y + share * (high_m.y - low_m.y)};
}

// One corner is alone on its side of the plane, and the two edges that leave it are cut.
std::optional<std::array<double, 4>> cut(const std::array<Vec3, 3>& corners_m, double height_m) {
  std::array<bool, 3> above{};
  for (std::size_t corner = 0; corner < 3; ++corner) above[corner] = corners_m[corner].z > height_m;
  const auto count = std::count(above.begin(), above.end(), true);
  if (count == 0 || count == 3) return std::nullopt;
  const auto alone = static_cast<std::size_t>(std::find(above.begin(), above.end(), count == 1) - above.begin());
  const auto crossing = [&](std::size_t other) {
    return above[alone] ? edge_point_m(corners_m[other], corners_m[alone], height_m)
                        : edge_point_m(corners_m[alone], corners_m[other], height_m);
  };
  const Vec2 from = crossing((alone + 1) % 3), to = crossing((alone + 2) % 3);
  if (from == to) return std::nullopt;  // only the lone corner touches the plane
  return std::array<double, 4>{from.x, from.y, to.x, to.y};
}

template <typename Counts>
std::vector<std::array<double, 4>> cuts_m(const Scene& scene, double height_m, Counts&& counts) {
  std::vector<std::array<double, 4>> segments_m;
  const auto boxes = scene.triangle_boxes();
  for (std::uint32_t triangle = 0; triangle < boxes.size(); ++triangle) {
    const bool met = boxes[triangle].min.z <= height_m && height_m <= boxes[triangle].max.z;
    if (!met || !counts(scene.facet(scene.facet_of_triangle(triangle)).material)) continue;
    if (const auto segment = cut(scene.corners_m(triangle), height_m)) segments_m.push_back(*segment);
  }
  return segments_m;
}

/// By material: whether more than a tenth of the power passes it upright, as it does windows and doors.
std::vector<bool> lets_much_through(const Scene& scene, double frequency_hz) {
  std::vector<bool> lets;
  for (const Material& material : scene.materials()) {
    const MaterialTable table({material}, frequency_hz, {.revision = 3, .allow_extrapolation = true});
    lets.push_back(std::norm(table.response(MaterialId{}, 1.0).transmission.te) > 0.1);
  }
  return lets;
}

void cut_walls(HeatMap& picture, const MapOccasion& occasion, double height_m) {
  const std::vector<bool> lets = lets_much_through(occasion.scene, occasion.frequency_hz);
  picture.walls_m = cuts_m(occasion.scene, height_m, [&](MaterialId material) { return !lets[material.value]; });
  picture.windows_m = cuts_m(occasion.scene, height_m, [&](MaterialId material) { return lets[material.value]; });
}

}  // namespace

std::string map_name(const std::string& grid, const std::string& transmitter, std::optional<std::size_t> frame) {
  std::string name = "map_" + file_name_part(grid) + "_" + file_name_part(transmitter);
  if (frame) name += "_" + std::to_string(*frame);
  return name;
}

void write_map_csv(AtomicFile& file, const RadioMap& map, double frequency_hz) {
  std::string text = std::string(map_csv_header) + '\n';
  for (const RadioMapPoint& point : map.points) {
    append_point(text, point, frequency_hz);
    if (text.size() >= sheet_bytes) file.write(std::exchange(text, {}));
  }
  file.write(text);
}

void write_map_npz(AtomicFile& file, const RadioMap& map, double frequency_hz) {
  MapArrays arrays(map.places, map.points);
  const auto add = [&](const char* name, std::optional<double> LinkStatistics::*value) {
    arrays.add_numbers(name, [value](const RadioMapPoint& point) { return point.statistics.*value; });
  };
  add("power_dbm", &LinkStatistics::power_dbm);
  add("power_incoherent_dbm", &LinkStatistics::power_incoherent_dbm);
  add("path_gain_db", &LinkStatistics::path_gain_db);
  arrays.add_numbers("field_strength_dbuv_per_m",
                     [&](const RadioMapPoint& point) { return field_dbuv_per_m(point, frequency_hz); });
  add("mean_delay_s", &LinkStatistics::mean_delay_s);
  add("rms_delay_spread_s", &LinkStatistics::rms_delay_spread_s);
  arrays.add_flags("line_of_sight", [](const RadioMapPoint& point) { return point.statistics.line_of_sight; });
  arrays.add_flags("obstructed", [](const RadioMapPoint& point) { return point.obstructed; });
  arrays.add_flags("sheltered", [](const RadioMapPoint& point) { return point.sheltered; });
  arrays.add_counts("path_count", [](const RadioMapPoint& point) { return point.statistics.path_count; });
  arrays.add_texts("strongest_kinds", [](const RadioMapPoint& point) { return point.strongest_kinds; });
  arrays.writer().add("frequency_hz", {}, std::array{frequency_hz});
  arrays.writer().write(file);
}

void write_map_asc(AtomicFile& file, const RadioMap& map) {
  std::vector<double> powers_dbm;
  powers_dbm.reserve(map.points.size());
  for (const RadioMapPoint& point : map.points) powers_dbm.push_back(point.statistics.power_dbm.value_or(no_value_db));
  write_esri_grid(file, map.grid(), powers_dbm);
}

HeatMap map_picture(const RadioMap& map, const Scene& scene, const Frame& frame, double frequency_hz,
                    std::optional<double> time_s) {
  const MapOccasion occasion{scene, frame, frequency_hz, time_s};
  HeatMap picture = empty_map_picture(map.grid(), occasion,
                                      map.places.id() + ", transmitter " + map.transmitter + ": incoherent power");
  picture.label = "incoherent received power";
  // Of those that are drawn it chooses first where its name stands.
  std::stable_partition(picture.transmitters.begin(), picture.transmitters.end(),
                        [&](const auto& other) { return other.label == map.transmitter; });
  for (const RadioMapPoint& point : map.points) {
    picture.values.push_back(point.statistics.power_incoherent_dbm.value_or(no_value_db));
    hatch_point(picture, point);
  }
  return picture;
}

std::string map_title_end(const ReceiverGrid& grid, const MapOccasion& occasion) {
  std::string title = ", ";
  append_number(title, std::round(occasion.frequency_hz / 1e3) / 1e6);
  title += " GHz, z = " + format_fixed(grid.origin_m.z, 2) + " m";
  if (grid.samples_per_cell() > 1) {
    title += ", " + std::to_string(grid.samples[0]) + " x " + std::to_string(grid.samples[1]) + " points a cell";
  }
  if (occasion.time_s) title += ", t = " + format_fixed(*occasion.time_s, 3) + " s";
  return title;
}

HeatMap empty_map_picture(const ReceiverGrid& grid, const MapOccasion& occasion, const std::string& what) {
  HeatMap picture;
  picture.title = what + map_title_end(grid, occasion);
  picture.origin_x_m = grid.origin_m.x;
  picture.origin_y_m = grid.origin_m.y;
  picture.spacing_x_m = grid.spacing_m[0];
  picture.spacing_y_m = grid.spacing_m[1];
  picture.columns = grid.columns();
  picture.rows = grid.rows();
  picture.values.reserve(grid.size());
  picture.hatched.reserve(grid.size());
  cut_walls(picture, occasion, grid.origin_m.z);
  for (const Device& device : occasion.scene.transmitters()) {
    const DeviceState state = occasion.scene.device_state(device, occasion.frame);
    if (state.present) picture.transmitters.push_back({state.position_m.x, state.position_m.y, device.id});
  }
  return picture;
}

std::vector<std::array<double, 4>> walls_at_height_m(const Scene& scene, double height_m) {
  return cuts_m(scene, height_m, [](MaterialId) { return true; });
}

}  // namespace dcem::io
