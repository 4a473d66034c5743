#include "dcem/io/src/antenna/pattern_cuts.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "dcem/core/units.hpp"
#include "dcem/io/input_error.hpp"
#include "dcem/io/src/text/text_input.hpp"

namespace dcem::io {

namespace {

constexpr double widest_gap_deg = 90.0;

/// In [0, 360).
double wrapped_deg(double angle_deg) {
  const double wrapped = angle_deg - 360.0 * std::floor(angle_deg / 360.0);
  return wrapped >= 360.0 ? 0.0 : wrapped;
}

bool is_multiple(double angle_deg, double step_deg) {
  const double steps = angle_deg / step_deg;
  return std::abs(steps - std::round(steps)) < 1e-6;
}

/// The attenuations of a cut at even steps from 0.
std::vector<double> sampled(const PatternCut& cut, std::size_t count) {
  std::vector<double> attenuations_db;
  for (std::size_t index = 0; index < count; ++index) {
    attenuations_db.push_back(cut.attenuation_db(360.0 * static_cast<double>(index) / static_cast<double>(count)));
  }
  return attenuations_db;
}

std::size_t steps_of_turn(const PatternCut& cut) {
  return static_cast<std::size_t>(std::llround(360.0 / cut.step_deg()));
}

}  // namespace

PatternCut::PatternCut(const std::string& name, const std::string& cut, std::vector<Point> points)
    : points_(std::move(points)) {
  if (points_.empty()) throw InputError(name, cut + ": no point; expected a whole turn");
  // To a millionth of a degree: −0.1 and 359.9 are one direction.
  for (Point& point : points_) point.angle_deg = wrapped_deg(std::round(wrapped_deg(point.angle_deg) * 1e6) / 1e6);
  std::stable_sort(points_.begin(), points_.end(),
                   [](const Point& a, const Point& b) { return a.angle_deg < b.angle_deg; });
  for (std::size_t index = 1; index < points_.size(); ++index) {
    const Point &before = points_[index - 1], &point = points_[index];
    if (before.angle_deg == point.angle_deg && before.attenuation_db != point.attenuation_db) {
      throw InputError(name, point.line,
                       cut + ": " + number_text(point.angle_deg) + " degrees: there already in line " +
                           std::to_string(before.line) + "; expected each angle once");
    }
  }
  const auto same = [](const Point& a, const Point& b) { return a.angle_deg == b.angle_deg; };
  points_.erase(std::unique(points_.begin(), points_.end(), same), points_.end());
  for (std::size_t index = 0; index < points_.size(); ++index) {
    const bool last = index + 1 == points_.size();
    const double from_deg = points_[index].angle_deg;
    const double to_deg = last ? points_.front().angle_deg + 360.0 : points_[index + 1].angle_deg;
    if (to_deg - from_deg <= widest_gap_deg) continue;
    throw InputError(name, points_[index].line,
                     cut + ": nothing between " + number_text(from_deg) + " and " + number_text(wrapped_deg(to_deg)) +
                         " degrees; expected a whole turn with gaps of at most 90 degrees");
  }
}

double PatternCut::attenuation_db(double angle_deg) const {
  const double angle = wrapped_deg(angle_deg);
  const auto after = std::upper_bound(points_.begin(), points_.end(), angle,
                                      [](double value, const Point& point) { return value < point.angle_deg; });
  const Point& to = after == points_.end() ? points_.front() : *after;
  const Point& from = after == points_.begin() ? points_.back() : *(after - 1);
  const double past_deg = wrapped_deg(angle - from.angle_deg), gap_deg = wrapped_deg(to.angle_deg - from.angle_deg);
  return from.attenuation_db + past_deg / gap_deg * (to.attenuation_db - from.attenuation_db);
}

double PatternCut::step_deg() const {
  constexpr double finest_deg = 0.1;
  for (const double step_deg : {1.0, 0.5, 0.25}) {
    const auto has_place = [&](const Point& point) { return is_multiple(point.angle_deg, step_deg); };
    if (std::all_of(points_.begin(), points_.end(), has_place)) return step_deg;
  }
  return finest_deg;
}

PatternTable table_from_cuts(double gain_dbi, const PatternCut& horizontal, const PatternCut& vertical) {
  const std::size_t columns = steps_of_turn(horizontal), turn = steps_of_turn(vertical), rows = turn / 2 + 1;
  const std::vector<double> around_db = sampled(horizontal, columns), over_db = sampled(vertical, turn);
  const double front_db = around_db[0], back_db = around_db[columns / 2];
  const double least_db = std::min(*std::min_element(around_db.begin(), around_db.end()),
                                   *std::min_element(over_db.begin(), over_db.end()));
  std::vector<double> gains_dbi;
  gains_dbi.reserve(rows * columns);
  for (std::size_t row = 0; row < rows; ++row) {  // from zenith to nadir
    const double elevation_rad = pi * (0.5 - static_cast<double>(row) / static_cast<double>(rows - 1));
    const double ahead_db = over_db[(turn - turn / 4 + row) % turn], behind_db = over_db[turn - turn / 4 - row];
    for (std::size_t column = 0; column < columns; ++column) {  // counter-clockwise, as azimuths are
      const std::size_t off = std::min(column, columns - column);
      const double w = 2.0 * static_cast<double>(off) / static_cast<double>(columns);
      const double added_db = around_db[(columns - column) % columns] - (1.0 - w) * front_db - w * back_db;
      const double attenuation_db = (1.0 - w) * ahead_db + w * behind_db + std::cos(elevation_rad) * added_db;
      gains_dbi.push_back(std::max(gain_dbi - std::max(attenuation_db, least_db), -PatternTable::highest_gain_dbi));
    }
  }
  return {columns, rows, std::move(gains_dbi)};
}

}  // namespace dcem::io
