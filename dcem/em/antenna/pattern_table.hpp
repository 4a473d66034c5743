#pragma once
/// A measured or computed antenna pattern: gains on a regular grid over the whole sphere.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "dcem/core/constants.hpp"
#include "dcem/core/units.hpp"

namespace dcem {

/// Gains in dBi at azimuths i·2π/n, i = 0 … n − 1, counted from local +x towards +y, and zeniths j·π/(m − 1),
/// j = 0 … m − 1, counted from local +z.
///
/// Between nodes the gain is bilinear in dB over (azimuth, zenith): g = (1−u)(1−v)·g00 + u(1−v)·g10 + (1−u)v·g01 +
/// u·v·g11, with u, v the shares of the cell; around the turn the last azimuth is followed by the first. A pole is one
/// direction and has one gain: where its nodes differ they are replaced by the mean of their powers.
class PatternTable {
 public:
  /// `gain_dbi` holds the nodes row by row, zenith after zenith. Throws std::invalid_argument unless there are at least
  /// one azimuth and two zeniths, one gain for each pair, all within ±`highest_gain_dbi`.
  PatternTable(std::size_t azimuth_count, std::size_t zenith_count, std::vector<double> gain_dbi);

  /// The bound of every gain, up and down: whatever is beyond it is a damaged file.
  static constexpr double highest_gain_dbi = 200.0;

  std::size_t azimuth_count() const { return azimuth_count_; }
  std::size_t zenith_count() const { return zenith_count_; }
  /// The gain of a node, dBi.
  double node_dbi(std::size_t azimuth, std::size_t zenith) const {
    return gain_dbi_[zenith * azimuth_count_ + azimuth];
  }
  /// The largest gain of all nodes, and so of all directions, dBi.
  double peak_dbi() const { return peak_dbi_; }
  /// The gain towards a direction, dBi: any azimuth, zenith in [0, π].
  double gain_dbi(double azimuth_rad, double zenith_rad) const;

  friend bool operator==(const PatternTable&, const PatternTable&) = default;

 private:
  void unite_pole(std::size_t zenith);
  /// Between two azimuths of one row, `share` from the first to the next.
  double along_row_dbi(std::size_t zenith, std::size_t azimuth, double share) const;

  std::size_t azimuth_count_, zenith_count_;
  std::vector<double> gain_dbi_;
  double peak_dbi_ = 0.0;
};

// ---------------------------------------------------------------------------------------------------------------------

inline double PatternTable::along_row_dbi(std::size_t zenith, std::size_t azimuth, double share) const {
  const double here = node_dbi(azimuth, zenith);
  return here + share * (node_dbi((azimuth + 1) % azimuth_count_, zenith) - here);
}

inline double PatternTable::gain_dbi(double azimuth_rad, double zenith_rad) const {
  const auto columns = static_cast<double>(azimuth_count_);
  const double turns = azimuth_rad / (2.0 * pi);
  const double column = (turns - std::floor(turns)) * columns;  // in [0, columns]: the difference may round to 1
  const double row = std::clamp(zenith_rad / pi, 0.0, 1.0) * static_cast<double>(zenith_count_ - 1);
  const std::size_t upper = std::min(static_cast<std::size_t>(row), zenith_count_ - 2);
  const double azimuth_share = column - std::floor(column);
  const std::size_t azimuth = static_cast<std::size_t>(column) % azimuth_count_;
  const double above = along_row_dbi(upper, azimuth, azimuth_share);
  const double below = along_row_dbi(upper + 1, azimuth, azimuth_share);
  return above + (row - static_cast<double>(upper)) * (below - above);
}

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/em/antenna/pattern_table_bodies.hpp"
#endif
