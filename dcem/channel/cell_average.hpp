#pragma once
/// Maps whose values are means over cells: each cell of a grid is sampled at several points, which are then taken
/// together. A cell is the rectangle spacing_x × spacing_y around its grid point.
///
/// What is averaged, over the samples where a receiver could stand:
///  * powers and path gain in linear units, a sample where nothing arrives counting as 0: P = Σ P_i / n;
///  * mean delay and delay spread weighted by incoherent power: τ = Σ P_i τ_i / Σ P_i. The spread is the mean of those
///    that receivers in the cell have, not that of their profiles put together: the latter would grow with the cell, in
///    free space, too, where no receiver has any;
///  * `line_of_sight` is whether any sample has it; `first_delay_s` is the least one;
///  * `path_count` and `strongest_kinds` are those of the sample with the highest incoherent power, so that they belong
///    together and to a place: a mean of counts is one that may be found nowhere.
/// What maps do not show (K factor, angles, Doppler) is left out. A cell is obstructed where all of its samples are.
#include <algorithm>
#include <cstddef>
#include <iterator>
#include <optional>
#include <span>
#include <stdexcept>
#include <vector>

#include "dcem/channel/link_statistics.hpp"
#include "dcem/channel/radio_map.hpp"
#include "dcem/core/units.hpp"

namespace dcem {

/// The grid of all samples of a grid's cells: sample i of k along an axis lies at (i + 1/2)/k of the cell, so that one
/// sample is the grid point itself. Its own cells have one sample each.
ReceiverGrid sample_grid(const ReceiverGrid& grid);

/// One cell at `position_m` from its samples.
RadioMapPoint cell_average(const Vec3& position_m, std::span<const RadioMapPoint> samples);

/// The map of a grid from that of its `sample_grid`. Throws std::invalid_argument where the points are not as many.
RadioMap cell_averages(const ReceiverGrid& grid, const RadioMap& samples);

// ---------------------------------------------------------------------------------------------------------------------

namespace detail {

using StatisticsValue = std::optional<double> LinkStatistics::*;

/// 10·log10(Σ 10^(p/10) / n) over all samples, those without a power counting as none. Counted from the largest one,
/// so that no power is too weak or too strong for it, and the mean of equal ones is these, to the last bit.
inline std::optional<double> mean_power_db(std::span<const RadioMapPoint> samples, StatisticsValue value) {
  std::optional<double> largest_db;
  for (const RadioMapPoint& sample : samples) largest_db = std::max(largest_db, sample.statistics.*value);
  if (!largest_db) return std::nullopt;
  double sum = 0.0;
  for (const RadioMapPoint& sample : samples) {
    if (const auto& power_db = sample.statistics.*value) sum += db_to_power_ratio(*power_db - *largest_db);
  }
  return *largest_db + power_ratio_to_db(sum / static_cast<double>(samples.size()));
}

/// Σ P v / Σ P over the samples that have a value, P their incoherent power.
inline std::optional<double> weighted_mean(std::span<const RadioMapPoint> samples, double largest_dbm,
                                           StatisticsValue value) {
  double sum = 0.0, weights = 0.0;
  for (const RadioMapPoint& sample : samples) {
    const LinkStatistics& statistics = sample.statistics;
    if (!(statistics.*value) || !statistics.power_incoherent_dbm) continue;
    const double weight = db_to_power_ratio(*statistics.power_incoherent_dbm - largest_dbm);
    sum += weight * *(statistics.*value);
    weights += weight;
  }
  return weights > 0.0 ? std::optional(sum / weights) : std::nullopt;
}

/// The sample with the highest incoherent power, of equals the first. Precondition: there is one.
inline const RadioMapPoint& strongest_sample(std::span<const RadioMapPoint> samples) {
  return *std::ranges::max_element(samples, {},
                                   [](const RadioMapPoint& sample) { return sample.statistics.power_incoherent_dbm; });
}

inline std::optional<double> least_delay_s(std::span<const RadioMapPoint> samples) {
  std::optional<double> least_s;
  for (const RadioMapPoint& sample : samples) {
    const std::optional<double>& delay_s = sample.statistics.first_delay_s;
    if (delay_s && (!least_s || *delay_s < *least_s)) least_s = delay_s;
  }
  return least_s;
}

/// Precondition: there is a sample, and none is obstructed.
inline RadioMapPoint open_cell(const Vec3& position_m, std::span<const RadioMapPoint> samples) {
  const RadioMapPoint& strongest = strongest_sample(samples);
  LinkStatistics mean;
  mean.line_of_sight =
      std::ranges::any_of(samples, [](const RadioMapPoint& sample) { return sample.statistics.line_of_sight; });
  mean.path_count = strongest.statistics.path_count;
  for (const StatisticsValue value :
       {&LinkStatistics::power_dbm, &LinkStatistics::power_incoherent_dbm, &LinkStatistics::power_los_dbm,
        &LinkStatistics::power_reflected_dbm, &LinkStatistics::power_transmitted_dbm,
        &LinkStatistics::power_diffracted_dbm, &LinkStatistics::power_diffuse_dbm, &LinkStatistics::path_gain_db}) {
    mean.*value = mean_power_db(samples, value);
  }
  mean.first_delay_s = least_delay_s(samples);
  if (const auto& largest_dbm = strongest.statistics.power_incoherent_dbm) {
    mean.mean_delay_s = weighted_mean(samples, *largest_dbm, &LinkStatistics::mean_delay_s);
    mean.rms_delay_spread_s = weighted_mean(samples, *largest_dbm, &LinkStatistics::rms_delay_spread_s);
  }
  return {position_m, false, mean, strongest.strongest_kinds};
}

/// The samples of one cell, row by row.
inline void collect_samples(const ReceiverGrid& grid, std::size_t row, std::size_t column, const RadioMap& map,
                            std::vector<RadioMapPoint>& samples) {
  samples.clear();
  const auto [across, up] = grid.samples;
  for (std::size_t at = 0; at < across * up; ++at) {
    const std::size_t sample_row = row * up + at / across, sample_column = column * across + at % across;
    samples.push_back(map.points[sample_row * grid.columns() * across + sample_column]);
  }
}

}  // namespace detail

inline ReceiverGrid sample_grid(const ReceiverGrid& grid) {
  ReceiverGrid fine = grid;
  for (int axis = 0; axis < 2; ++axis) {
    const auto at = static_cast<std::size_t>(axis);
    if (grid.samples[at] == 1) continue;  // the very point
    const auto samples = static_cast<double>(grid.samples[at]);
    fine.origin_m[axis] += grid.spacing_m[at] * (0.5 / samples - 0.5);
    fine.spacing_m[at] /= samples;
    fine.count[at] *= grid.samples[at];
  }
  fine.samples = {1, 1};
  return fine;
}

inline RadioMapPoint cell_average(const Vec3& position_m, std::span<const RadioMapPoint> samples) {
  std::vector<RadioMapPoint> open;
  std::ranges::copy_if(samples, std::back_inserter(open), [](const RadioMapPoint& at) { return !at.obstructed; });
  return open.empty() ? RadioMapPoint{position_m, true, {}, {}} : detail::open_cell(position_m, open);
}

inline RadioMap cell_averages(const ReceiverGrid& grid, const RadioMap& samples) {
  if (samples.points.size() != grid.size() * grid.samples_per_cell()) {
    throw std::invalid_argument("cell_averages: expected the map of all samples of the grid");
  }
  RadioMap map{grid, samples.transmitter, {}};
  map.points.reserve(grid.size());
  std::vector<RadioMapPoint> of_cell;
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    const std::size_t row = cell / grid.columns(), column = cell % grid.columns();
    detail::collect_samples(grid, row, column, samples, of_cell);
    map.points.push_back(cell_average(grid_point_m(grid, row, column), of_cell));
  }
  return map;
}

}  // namespace dcem
