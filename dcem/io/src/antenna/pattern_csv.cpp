#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "dcem/io/antenna_files.hpp"
#include "dcem/io/atomic_file.hpp"
#include "dcem/io/input_error.hpp"
#include "dcem/io/src/text/csv_reader.hpp"
#include "dcem/io/src/text/number_text.hpp"
#include "dcem/io/src/text/text_input.hpp"

namespace dcem::io {

namespace {

enum PatternColumn : std::size_t { azimuth_column, zenith_column, gain_column };
const std::string pattern_header = "azimuth_deg,zenith_deg,gain_dbi";

/// Angles are compared in millionths of a degree: files round them.
using MicroDegrees = std::int64_t;
constexpr MicroDegrees whole_turn = 360'000'000, half_turn = 180'000'000;

std::string degrees_text(MicroDegrees angle) {
  return number_text(static_cast<double>(angle) / 1e6);
}

/// One line of the file.
struct Node {
  MicroDegrees azimuth = 0;  ///< in [0, 360) degrees
  MicroDegrees zenith = 0;
  MicroDegrees written_azimuth = 0;
  double gain_dbi = 0.0;
  std::size_t line = 0;
};

Node read_node(const CsvReader& row) {
  const auto angle = [&](PatternColumn column, const NumberRange& range) {
    return static_cast<MicroDegrees>(std::llround(row.number(column, range) * 1e6));
  };
  const MicroDegrees azimuth = angle(azimuth_column, {-360.0, 360.0});
  const double highest_dbi = PatternTable::highest_gain_dbi;
  return {(azimuth + whole_turn) % whole_turn, angle(zenith_column, {0.0, 180.0}), azimuth,
          row.number(gain_column, {-highest_dbi, highest_dbi}), row.line()};
}

std::vector<Node> read_nodes(const std::string& name, std::string_view text) {
  CsvReader row(name, text, {{"azimuth_deg"}, {"zenith_deg"}, {"gain_dbi"}}, "a header " + pattern_header,
                CsvReader::OtherColumns::refused, CsvReader::EmptyLines::anywhere);
  std::vector<Node> nodes;
  while (row.next()) nodes.push_back(read_node(row));
  if (nodes.empty()) throw InputError(name, "holds no gain; expected lines of " + pattern_header);
  return nodes;
}

/// The distinct values, ascending.
template <typename Angle>
std::vector<MicroDegrees> distinct(const std::vector<Node>& nodes, Angle&& angle) {
  std::vector<MicroDegrees> angles;
  for (const Node& node : nodes) angles.push_back(angle(node));
  std::sort(angles.begin(), angles.end());
  angles.erase(std::unique(angles.begin(), angles.end()), angles.end());
  return angles;
}

/// The angles must be even steps from 0; the next one after the last would be `end`. An angle may be off its place by a
/// hundredth of a step.
void check_even(const std::string& name, const std::string& column, const std::vector<MicroDegrees>& angles,
                MicroDegrees end, const std::string& expectation) {
  MicroDegrees smallest = end;
  for (std::size_t index = 0; index < angles.size(); ++index) {
    const MicroDegrees next = index + 1 < angles.size() ? angles[index + 1] : end;
    smallest = std::min(smallest, next - angles[index]);
  }
  const auto steps = static_cast<MicroDegrees>(std::llround(static_cast<double>(end) / static_cast<double>(smallest)));
  const double step = static_cast<double>(end) / static_cast<double>(steps);
  for (std::size_t index = 0; index < static_cast<std::size_t>(steps); ++index) {
    const double place = static_cast<double>(index) * step;
    if (index < angles.size() && std::abs(static_cast<double>(angles[index]) - place) <= 0.01 * step) continue;
    throw InputError(name, column + ": " + degrees_text(std::llround(place)) + " is missing; expected " + expectation +
                               " in even steps, here of " + degrees_text(std::llround(step)) + " degrees");
  }
}

class TableBuilder {
 public:
  TableBuilder(std::string name, std::vector<Node> nodes)
      : name_(std::move(name)),
        nodes_(std::move(nodes)),
        azimuths_(distinct(nodes_, [](const Node& node) { return node.azimuth; })),
        zeniths_(distinct(nodes_, [](const Node& node) { return node.zenith; })) {}

  PatternTable build() {
    if (azimuths_.size() < 2) throw InputError(name_, "azimuth_deg: one azimuth is a cut; expected a whole turn");
    check_even(name_, "azimuth_deg", azimuths_, whole_turn, "a whole turn from 0");
    if (zeniths_.back() != half_turn) throw InputError(name_, "zenith_deg: 180 is missing; expected 0 to 180");
    check_even(name_, "zenith_deg", {zeniths_.begin(), zeniths_.end() - 1}, half_turn, "0 to 180");
    sort_out_doubles();
    check_complete();
    std::vector<double> gains;
    for (const Node& node : nodes_) gains.push_back(node.gain_dbi);
    return {azimuths_.size(), zeniths_.size(), std::move(gains)};
  }

 private:
  static std::string direction_text(MicroDegrees azimuth, MicroDegrees zenith) {
    return "azimuth " + degrees_text(azimuth) + ", zenith " + degrees_text(zenith);
  }

  /// Brings the nodes into the order of the table, without the repeated first azimuth.
  void sort_out_doubles() {
    std::stable_sort(nodes_.begin(), nodes_.end(), [](const Node& a, const Node& b) {
      return std::pair(a.zenith, a.azimuth) < std::pair(b.zenith, b.azimuth);
    });
    const auto same = [&](const Node& first, const Node& second) {
      if (first.zenith != second.zenith || first.azimuth != second.azimuth) return false;
      if (first.written_azimuth != second.written_azimuth && first.gain_dbi == second.gain_dbi) return true;
      throw InputError(name_, second.line,
                       direction_text(second.written_azimuth, second.zenith) + ": there already in line " +
                           std::to_string(first.line) + "; expected each direction once");
    };
    nodes_.erase(std::unique(nodes_.begin(), nodes_.end(), same), nodes_.end());
  }

  void check_complete() const {
    std::size_t node = 0;
    for (const MicroDegrees zenith : zeniths_) {
      for (const MicroDegrees azimuth : azimuths_) {
        const bool there = node < nodes_.size() && nodes_[node].azimuth == azimuth && nodes_[node].zenith == zenith;
        if (!there) {
          throw InputError(name_, direction_text(azimuth, zenith) +
                                      ": missing; expected a gain for each pair of the azimuths and zeniths");
        }
        ++node;
      }
    }
  }

  std::string name_;
  std::vector<Node> nodes_;
  std::vector<MicroDegrees> azimuths_, zeniths_;
};

}  // namespace

PatternTable read_pattern_csv(const std::filesystem::path& file) {
  const std::string text = read_text_file(file, "expected a table of gains");
  return TableBuilder(file.string(), read_nodes(file.string(), text)).build();
}

void write_pattern_csv(const PatternTable& table, const std::filesystem::path& file) {
  std::string text = pattern_header + '\n';
  for (std::size_t zenith = 0; zenith < table.zenith_count(); ++zenith) {
    for (std::size_t azimuth = 0; azimuth < table.azimuth_count(); ++azimuth) {
      const auto share = [](std::size_t index, std::size_t count, double whole_deg) {
        return whole_deg * static_cast<double>(index) / static_cast<double>(count);
      };
      CsvLine line(text);
      line.number(share(azimuth, table.azimuth_count(), 360.0));
      line.number(share(zenith, table.zenith_count() - 1, 180.0));
      line.number(table.node_dbi(azimuth, zenith)).end();
    }
  }
  AtomicFile out(file);
  out.write(text);
  out.commit();
}

}  // namespace dcem::io
