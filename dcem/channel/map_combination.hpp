#pragma once
/// Several transmitters over one grid or list of points: which one serves a point, and what the others and the noise
/// leave of it.
///
/// All sums are over incoherent powers: transmitters are not in phase with each other, and over a cell of a map each of
/// them shows its mean.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "dcem/channel/radio_map.hpp"
#include "dcem/core/units.hpp"

namespace dcem {

/// A point as all transmitters together serve it. Without a server nothing arrives, and no value is defined.
struct CombinedMapPoint {
  Vec3 position_m{0.0};
  bool obstructed = false;
  std::optional<std::size_t> server;           ///< number of the transmitter of the highest incoherent power
  std::optional<double> power_dbm;             ///< the server's coherent power; absent where its paths cancel
  std::optional<double> power_incoherent_dbm;  ///< the server's incoherent power
  std::optional<double> sinr_db;               ///< over the others and the noise; absent where there is neither
  std::optional<double> snr_db;                ///< over the noise alone; absent without noise
  bool sheltered = false;                      ///< as in the maps
};

/// The maps of all transmitters over one grid or list, taken together; points in the order of the maps.
struct CombinedMap {
  MapPlaces places;
  std::vector<std::string> transmitters;
  std::vector<CombinedMapPoint> points;

  const ReceiverGrid& grid() const { return places.grid(); }  ///< as there
};

/// 10·log10(Σ 10^(p/10)): the sum of powers, dBm. Counted from the largest one, so that no power is too weak or too
/// strong for it. Nothing where there is no power.
inline std::optional<double> power_sum_dbm(std::span<const double> powers_dbm) {
  if (powers_dbm.empty()) return std::nullopt;
  const double largest_dbm = *std::max_element(powers_dbm.begin(), powers_dbm.end());
  double sum = 0.0;
  for (const double power_dbm : powers_dbm) sum += db_to_power_ratio(power_dbm - largest_dbm);
  return largest_dbm + power_ratio_to_db(sum);
}

/// The best server of each point and its SINR: S/(Σ I + N) with S the incoherent power of the best server, I those of
/// all other transmitters and N the noise; without `noise_power_dbm` N is zero and the ratio is S/Σ I (SIR). Of
/// transmitters with the same power the first one serves. Throws std::invalid_argument without a map and for maps of
/// different points.
CombinedMap combine_maps(std::span<const RadioMap> maps, std::optional<double> noise_power_dbm = {});

// ---------------------------------------------------------------------------------------------------------------------

namespace detail {

inline bool same_points(const RadioMap& one, const RadioMap& other) {
  return one.places.shape() == other.places.shape() &&
         std::ranges::equal(one.points, other.points, {}, &RadioMapPoint::position_m, &RadioMapPoint::position_m);
}

inline std::optional<std::size_t> best_server(std::span<const RadioMap> maps, std::size_t cell) {
  std::optional<std::size_t> best;
  double highest_dbm = -std::numeric_limits<double>::infinity();
  for (std::size_t index = 0; index < maps.size(); ++index) {
    const std::optional<double>& power_dbm = maps[index].points[cell].statistics.power_incoherent_dbm;
    if (!power_dbm || !(*power_dbm > highest_dbm)) continue;
    best = index;
    highest_dbm = *power_dbm;
  }
  return best;
}

inline CombinedMapPoint combine_point(std::span<const RadioMap> maps, std::size_t cell,
                                      std::optional<double> noise_power_dbm) {
  const RadioMapPoint& any = maps.front().points[cell];
  CombinedMapPoint point{any.position_m, any.obstructed, best_server(maps, cell), {}, {}, {}, {}, any.sheltered};
  if (!point.server) return point;
  const LinkStatistics& served = maps[*point.server].points[cell].statistics;
  point.power_dbm = served.power_dbm;
  point.power_incoherent_dbm = served.power_incoherent_dbm;
  if (noise_power_dbm) point.snr_db = *served.power_incoherent_dbm - *noise_power_dbm;
  std::vector<double> against_dbm;
  if (noise_power_dbm) against_dbm.push_back(*noise_power_dbm);
  for (std::size_t index = 0; index < maps.size(); ++index) {
    const std::optional<double>& power_dbm = maps[index].points[cell].statistics.power_incoherent_dbm;
    if (index != *point.server && power_dbm) against_dbm.push_back(*power_dbm);
  }
  if (const auto sum_dbm = power_sum_dbm(against_dbm)) point.sinr_db = *served.power_incoherent_dbm - *sum_dbm;
  return point;
}

}  // namespace detail

inline CombinedMap combine_maps(std::span<const RadioMap> maps, std::optional<double> noise_power_dbm) {
  if (maps.empty()) throw std::invalid_argument("combine_maps: expected at least one map");
  CombinedMap combined{maps.front().places, {}, {}};
  for (const RadioMap& map : maps) {
    if (!detail::same_points(map, maps.front()) || map.points.size() != combined.places.size()) {
      throw std::invalid_argument("combine_maps: expected maps of the same points");
    }
    combined.transmitters.push_back(map.transmitter);
  }
  combined.points.reserve(combined.places.size());
  for (std::size_t cell = 0; cell < combined.places.size(); ++cell) {
    combined.points.push_back(detail::combine_point(maps, cell, noise_power_dbm));
  }
  return combined;
}

}  // namespace dcem
