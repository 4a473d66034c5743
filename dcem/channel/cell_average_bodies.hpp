#pragma once
/// Bodies of cell_average.hpp.
#include <algorithm>
#include <cstddef>
#include <iterator>
#include <optional>
#include <span>
#include <stdexcept>
#include <vector>

#include "dcem/channel/cell_average.hpp"
#include "dcem/channel/link_statistics.hpp"
#include "dcem/core/build_mode.hpp"
#include "dcem/core/units.hpp"

namespace dcem {

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

DCEM_INLINE ReceiverGrid sample_grid(const ReceiverGrid& grid) {
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

DCEM_INLINE RadioMapPoint cell_average(const Vec3& position_m, std::span<const RadioMapPoint> samples) {
  std::vector<RadioMapPoint> open;
  std::ranges::copy_if(samples, std::back_inserter(open), [](const RadioMapPoint& at) { return !at.obstructed; });
  return open.empty() ? RadioMapPoint{position_m, true, {}, {}} : detail::open_cell(position_m, open);
}

DCEM_INLINE RadioMap cell_averages(const ReceiverGrid& grid, const RadioMap& samples) {
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
