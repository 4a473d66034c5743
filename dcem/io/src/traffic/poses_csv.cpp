#include "dcem/io/src/traffic/poses_csv.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "dcem/core/units.hpp"
#include "dcem/io/input_error.hpp"
#include "dcem/io/src/scenario/scenario_parts.hpp"
#include "dcem/io/src/text/text_input.hpp"

namespace dcem::io {

namespace {

enum Column { t_s, id, x_m, y_m, z_m, yaw_deg, pitch_deg, roll_deg };
constexpr std::array<const char*, 8> column_names{"t_s", "id", "x_m", "y_m", "z_m", "yaw_deg", "pitch_deg", "roll_deg"};
constexpr std::size_t required_columns = 6;

/// Splits and reads the rows of a file whose header names the columns.
class RowReader {
 public:
  RowReader(std::string name, std::string_view text) : name_(std::move(name)), lines_(text) {
    if (!lines_.next() || trimmed(lines_.line()).empty()) {
      throw InputError(name_, "is empty; expected a header t_s,id,x_m,y_m,z_m,yaw_deg[,pitch_deg,roll_deg]");
    }
    read_header();
  }

  /// Moves to the next row; false at the end. Empty lines may stand at the end alone.
  bool next() {
    std::optional<std::size_t> empty_line;
    while (lines_.next()) {
      if (trimmed(lines_.line()).empty()) {
        if (!empty_line) empty_line = line();
        continue;
      }
      if (empty_line) throw InputError(name_, *empty_line, "an empty line; expected rows without gaps");
      split();
      if (fields_.size() != places_.size()) {
        fail(std::to_string(fields_.size()) + " fields; expected " + std::to_string(places_.size()) +
             " as in the header");
      }
      return true;
    }
    return false;
  }

  std::size_t line() const { return lines_.number(); }
  [[noreturn]] void fail(const std::string& what) const { throw InputError(name_, line(), what); }

  const std::string& text(Column column) const { return fields_[*field_of_[column]]; }

  double number(Column column, const NumberRange& range) const {
    const std::optional<std::size_t> field = field_of_[column];
    if (!field) return 0.0;
    const std::optional<double> value = parse_number(trimmed(fields_[*field]));
    if (!value || !range.holds(*value)) {
      fail(std::string(column_names[column]) + ": found " + in_quotes(fields_[*field]) + "; expected " + range.text());
    }
    return *value;
  }

 private:
  void read_header() {
    split();
    places_ = fields_;
    const std::vector<std::string> known(column_names.begin(), column_names.end());
    for (std::size_t field = 0; field < fields_.size(); ++field) {
      const std::string name(trimmed(fields_[field]));
      const auto found = std::find(known.begin(), known.end(), name);
      if (found == known.end()) {
        fail("unknown column " + in_quotes(name) + "; the nearest known one is '" + nearest_name(name, known) + "'");
      }
      std::optional<std::size_t>& place = field_of_[static_cast<std::size_t>(found - known.begin())];
      if (place) fail("column '" + name + "' is there twice; expected it once");
      place = field;
    }
    for (std::size_t column = 0; column < required_columns; ++column) {
      if (!field_of_[column]) {
        fail("the column '" + known[column] + "' is missing; expected t_s,id,x_m,y_m,z_m,yaw_deg[,pitch_deg,roll_deg]");
      }
    }
  }

  /// The fields of the line: RFC 4180, but for line ends in quotes.
  void split() {
    fields_.assign(1, "");
    bool quoted = false;
    const std::string_view line = lines_.line();
    for (std::size_t index = 0; index < line.size(); ++index) {
      const char character = line[index];
      if (quoted && character == '"' && index + 1 < line.size() && line[index + 1] == '"') {
        fields_.back().push_back(line[++index]);
      } else if (character == '"' && (quoted || fields_.back().empty())) {
        quoted = !quoted;
      } else if (character == ',' && !quoted) {
        fields_.emplace_back();
      } else {
        fields_.back().push_back(character);
      }
    }
    if (quoted) fail("a quote is not closed; expected quotes in pairs");
  }

  std::string name_;
  LineReader lines_;
  std::vector<std::string> fields_, places_;
  std::array<std::optional<std::size_t>, column_names.size()> field_of_;
};

Pose read_pose(const RowReader& row) {
  const NumberRange coordinate_m{-farthest_coordinate_m, farthest_coordinate_m};
  const auto angle_rad = [&](Column column) { return degrees_to_radians(row.number(column, any_angle_deg)); };
  return {{row.number(x_m, coordinate_m), row.number(y_m, coordinate_m), row.number(z_m, coordinate_m)},
          angle_rad(yaw_deg),
          angle_rad(pitch_deg),
          angle_rad(roll_deg)};
}

}  // namespace

PosesCsv::PosesCsv(const std::filesystem::path& file) : name_(file.string()) {
  const std::string text = read_text_file(file, "expected a table of poses");
  RowReader row(name_, text);
  while (row.next()) {
    const std::string& key = row.text(Column::id);
    if (key.empty()) row.fail("id: empty; expected the id of an object or a device");
    const double time_s = row.number(t_s, any_instant_s);
    Track& track = tracks_[key];
    auto& waypoints = track.motion.waypoints;
    if (waypoints.empty()) track.first_line = row.line();
    if (!waypoints.empty() && !(time_s > waypoints.back().time_s)) {
      row.fail("t_s: not later than the row of " + in_quotes(key) + " before; expected increasing times");
    }
    waypoints.push_back({time_s, read_pose(row)});
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
