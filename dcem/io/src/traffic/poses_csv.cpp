#include "dcem/io/src/traffic/poses_csv.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "dcem/core/units.hpp"
#include "dcem/io/input_error.hpp"
#include "dcem/io/known_names.hpp"
#include "dcem/io/src/scenario/scenario_parts.hpp"
#include "dcem/io/src/text/csv_reader.hpp"
#include "dcem/io/src/text/text_input.hpp"
#include "dcem/io/src/traffic/waypoint_speed.hpp"

namespace dcem::io {

namespace {

enum PoseColumn : std::size_t { t_s, id, x_m, y_m, z_m, yaw_deg, pitch_deg, roll_deg };
const std::vector<CsvReader::Column> columns{
    {"t_s"}, {"id"}, {"x_m"}, {"y_m"}, {"z_m"}, {"yaw_deg"}, {"pitch_deg", false}, {"roll_deg", false}};

Pose read_pose(const CsvReader& row) {
  const NumberRange coordinate_m{-farthest_coordinate_m, farthest_coordinate_m};
  const auto angle_rad = [&](PoseColumn column) { return degrees_to_radians(row.number(column, any_angle_deg)); };
  return {{row.number(x_m, coordinate_m), row.number(y_m, coordinate_m), row.number(z_m, coordinate_m)},
          angle_rad(yaw_deg),
          angle_rad(pitch_deg),
          angle_rad(roll_deg)};
}

}  // namespace

PosesCsv::PosesCsv(const std::filesystem::path& file) : name_(file.string()) {
  const std::string text = read_text_file(file, "expected a table of poses");
  CsvReader row(name_, text, columns, "a header t_s,id,x_m,y_m,z_m,yaw_deg[,pitch_deg,roll_deg]",
                CsvReader::OtherColumns::refused, CsvReader::EmptyLines::at_the_end);
  while (row.next()) {
    const std::string key(row.text(PoseColumn::id));
    if (key.empty()) row.fail("id: empty; expected the id of an object or a device");
    const double time_s = row.number(t_s, any_instant_s);
    Track& track = tracks_[key];
    auto& waypoints = track.motion.waypoints;
    if (waypoints.empty()) track.first_line = row.line();
    if (!waypoints.empty() && !(time_s > waypoints.back().time_s)) {
      row.fail("t_s: not later than the row of " + in_quotes(key) + " before; expected increasing times");
    }
    waypoints.push_back({time_s, read_pose(row)});
    if (is_last_faster_than_light(track.motion)) {
      row.fail("x_m: faster than light from the row of " + in_quotes(key) +
               " before; expected less than 299792458 m/s");
    }
  }
}

const WaypointMotion* PosesCsv::take(const std::string& key) {
  const auto found = tracks_.find(key);
  if (found == tracks_.end()) return nullptr;
  found->second.taken = true;
  return &found->second.motion;
}

void PosesCsv::check_all_taken() const {
  const std::pair<const std::string, Track>* first = nullptr;
  for (const auto& track : tracks_) {
    if (!track.second.taken && (first == nullptr || track.second.first_line < first->second.first_line)) first = &track;
  }
  if (first == nullptr) return;
  throw InputError(name_, first->second.first_line,
                   "id: " + in_quotes(first->first) +
                       " moves nothing; expected the id of an object or a device whose motion is this file");
}

std::string PosesCsv::nearest_id(const std::string& key) const {
  std::vector<std::string> ids;
  for (const auto& [known, track] : tracks_) ids.push_back(known);
  return nearest_name(key, ids);
}

}  // namespace dcem::io
