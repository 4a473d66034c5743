#pragma once
/// Over what change of frequency, or of time, a channel stays alike: coherence bandwidth and coherence time.
///
/// The correlation of the channel at a distance Δf in frequency, and at Δt in time, for contributions of powers P,
/// delays τ and Doppler shifts f with independent phases:
///   R(Δf) = Σ P exp(−j2πΔf τ),  R(Δt) = Σ P exp(j2π f Δt).
/// The coherence bandwidth is the smallest Δf > 0 where |R(Δf)|/R(0) falls to a level, the coherence time the smallest
/// such Δt. Conventions differ in the level; 0.5 is the default here.
///
/// Both are one task: with weights p = P/ΣP, the delays (or shifts) centred on their mean and divided by their standard
/// deviation, x, find the first u > 0 with g(u) = |Σ p e^{jux}| = c. Then Δf = u/(2π·spread).
///
/// Where to start. g(u) ≥ cos u for 0 ≤ u ≤ π/2, so nothing happens before u = arccos c. Proof: g ≥ Σ p cos(ux), and
/// the means of x and x² are 0 and 1. With w = x², cos(u√w) lies above its tangent at w = 1 for every w ≥ 0: it is
/// convex up to u√w = 4.49, and beyond, where the tangent's slope −u·sin(u)/2 ≤ −u²/π has taken it below −1, it is
/// above anyway. The mean over that tangent is its value at w = 1, cos u. Two equal contributions reach the bound. Cf.
/// Fleury, An uncertainty relation for WSS processes and its application to WSSUS systems, IEEE Trans. Commun. 44,
/// 1996: the same bound, Δf ≥ arccos(c)/(2π·spread).
///
/// How far to step. (g²)'' = −Σ Σ p p' (x − x')² cos(u(x − x')) ≥ −2, so from a point with the value F and the slope F'
/// of g² the curve stays above F + F's − s². Up to where that parabola meets c² no crossing can be missed; near a
/// crossing this is Newton's method from one side, over a shallow dip the steps shrink and grow again.
///
/// Under a strong path there is often no crossing at all. That is told sooner at equal distances of u, where from one
/// to the next each phasor turns by the same angle: what two neighbours say about the way between them is enough.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <stdexcept>
#include <vector>

#include "dcem/core/constants.hpp"
#include "dcem/field/power_sample.hpp"

namespace dcem {

/// The search ends at this multiple of the lower bound arccos(level)/(2π·spread).
inline constexpr double coherence_search_multiple = 64.0;

/// It takes at most this many steps, each of one sum over the samples; in practice below a thousand, and some fifteen
/// to refine a crossing. To keep this bound a step is at least coherence_search_multiple·arccos(level)/this long, below
/// 1e-4 in u: what it can jump over is a dip in which g² comes less than 2.4e-9 below level².
inline constexpr int coherence_search_steps = 1 << 20;

/// Coherence bandwidth: the smallest Δf > 0 at which |R(Δf)|/R(0) is `level`, to the precision of the sums.
/// Nothing where there is no power, where all delays are equal, and where the level is not reached up to
/// coherence_search_multiple times the lower bound (for instance under a dominant path, which never lets |R|/R(0) fall
/// below twice its share of the power minus one). Independent of a common delay. Throws std::invalid_argument unless
/// 0 < level < 1.
std::optional<double> coherence_bandwidth_hz(std::span<const PowerSample> samples, double level = 0.5);

/// Coherence time: the smallest Δt > 0 at which |R(Δt)|/R(0) is `level`. As coherence_bandwidth_hz, of Doppler shifts;
/// independent of a common shift.
std::optional<double> coherence_time_s(std::span<const PowerSample> samples, double level = 0.5);

// ---------------------------------------------------------------------------------------------------------------------

namespace detail {

/// Weights that add up to 1 at abscissas with mean 0 and mean square 1.
class StandardDistribution {
 public:
  /// g² and its derivative.
  struct Square {
    double value = 1.0, slope = 0.0;
  };

  /// Of the samples' powers at `abscissa(sample)`; without points where these do not differ or there is no power.
  template <typename Abscissa>
  StandardDistribution(std::span<const PowerSample> samples, Abscissa&& abscissa) {
    double total = 0.0;
    for (const PowerSample& sample : samples) total += sample.power_ratio;
    if (!(total > 0.0)) return;
    // From a sample with power on: where all are equal their deviation is then 0, not a rounding.
    const auto has_power = [](const PowerSample& sample) { return sample.power_ratio > 0.0; };
    const double origin = abscissa(*std::find_if(samples.begin(), samples.end(), has_power));
    const auto excess = [&](const PowerSample& sample) { return abscissa(sample) - origin; };
    const double mean = weighted_mean(samples, total, excess);
    deviation_ = weighted_deviation(samples, total, mean, excess);
    if (!(deviation_ > 0.0)) return;
    for (const PowerSample& sample : samples) {
      if (has_power(sample)) points_.push_back({sample.power_ratio / total, (excess(sample) - mean) / deviation_});
    }
  }

  struct Point {
    double weight = 0.0, x = 0.0;
  };
  std::span<const Point> points() const { return points_; }
  bool empty() const { return points_.empty(); }
  /// Of the abscissas before they were divided by it.
  double deviation() const { return deviation_; }

  Square square_at(double u) const {
    double real = 0.0, imaginary = 0.0, real_slope = 0.0, imaginary_slope = 0.0;
    for (const Point& point : points_) {
      const double c = point.weight * std::cos(u * point.x), s = point.weight * std::sin(u * point.x);
      real += c;
      imaginary += s;
      real_slope -= point.x * s;
      imaginary_slope += point.x * c;
    }
    return {real * real + imaginary * imaginary, 2.0 * (real * real_slope + imaginary * imaginary_slope)};
  }

  /// g ≥ this everywhere: the other phasors together cannot cancel more of the largest than they are long.
  double least() const {
    double largest = 0.0;
    for (const Point& point : points_) largest = std::max(largest, point.weight);
    return 2.0 * largest - 1.0;
  }

 private:
  std::vector<Point> points_;
  double deviation_ = 0.0;
};

/// g² and its derivative at equal distances.
class TurningPhasors {
 public:
  TurningPhasors(const StandardDistribution& distribution, double from, double distance) {
    phasors_.reserve(distribution.points().size());
    for (const StandardDistribution::Point& point : distribution.points()) {
      const double here = from * point.x, turned = distance * point.x;
      phasors_.push_back(
          {point.weight * std::cos(here), point.weight * std::sin(here), std::cos(turned), std::sin(turned), point.x});
    }
  }

  /// Of the place at hand, and goes on to the next.
  StandardDistribution::Square next() {
    double real = 0.0, imaginary = 0.0, real_slope = 0.0, imaginary_slope = 0.0;
    for (Phasor& phasor : phasors_) {
      const auto [c, s, turn_c, turn_s, x] = phasor;
      real += c;
      imaginary += s;
      real_slope -= x * s;
      imaginary_slope += x * c;
      phasor.c = c * turn_c - s * turn_s;
      phasor.s = c * turn_s + s * turn_c;
    }
    return {real * real + imaginary * imaginary, 2.0 * (real * real_slope + imaginary * imaginary_slope)};
  }

 private:
  struct Phasor {
    double c, s, turn_c, turn_s, x;
  };
  std::vector<Phasor> phasors_;
};

/// How far from a place at which g² is `surplus` > 0 above the level's square it stays above: the root of surplus +
/// slope·s − s² = 0; of the two forms of it the one without a difference of equal numbers.
inline double sure_step(double surplus, double slope) {
  const double root = std::sqrt(slope * slope + 4.0 * surplus);
  return slope > 0.0 ? 0.5 * (slope + root) : 2.0 * surplus / (root - slope);
}

/// Whether g surely stays above a level between two places, step by step.
inline bool surely_stays_between(const StandardDistribution& distribution, double level, double from, double to,
                                 double rounding) {
  const double least_step = (to - from) / 256.0;
  for (double u = from; u < to;) {
    const StandardDistribution::Square square = distribution.square_at(u);
    const double surplus = square.value - level * level - rounding;
    const double step = surplus > 0.0 ? sure_step(surplus, square.slope) : 0.0;
    if (step < least_step) return false;
    u += step;
  }
  return true;
}

/// The same all the way, in turns. False says nothing: the search then goes all the way itself, so that the fall that
/// it finds does not depend on how far this came.
inline bool surely_stays_above(const StandardDistribution& distribution, double level, double from, double end) {
  constexpr double distance = 0.3;   // by measurement
  constexpr double rounding = 1e-9;  // of a hundred turns, far above
  TurningPhasors phasors(distribution, from, distance);
  double sure_before = 0.0;
  for (double u = from;; u += distance) {
    const StandardDistribution::Square square = phasors.next();
    const double surplus = square.value - level * level - rounding;
    if (!(surplus > 0.0)) return false;
    const bool is_sure = u == from || sure_before + sure_step(surplus, -square.slope) >= distance;
    if (!is_sure && !surely_stays_between(distribution, level, u - distance, u, rounding)) return false;
    if (u > end) return true;
    sure_before = sure_step(surplus, square.slope);
  }
}

/// The crossing between a point above the level and one at or below it, to the last bit that g² resolves. Newton's
/// method from the end that was found last, a sixteenth too far, so that the other end comes near, too; where that
/// leads out of the bracket, and every fourth time, its middle is taken. Some fifteen steps, where halving alone takes
/// fifty.
inline double enclosed_fall(const StandardDistribution& distribution, double above, double below, double level) {
  constexpr double overshoot = 1.0 + 1.0 / 16.0;
  double trial = above;
  for (int step = 0;; ++step) {
    const bool is_inside = trial > above && trial < below;
    if (!is_inside || step % 4 == 3) trial = above + 0.5 * (below - above);
    if (trial <= above || trial >= below) return below;
    const StandardDistribution::Square square = distribution.square_at(trial);
    const double surplus = square.value - level * level;
    (surplus > 0.0 ? above : below) = trial;
    trial -= overshoot * surplus / square.slope;
  }
}

/// The first u > 0 with g(u) = level. The distribution has points.
inline std::optional<double> first_fall(const StandardDistribution& distribution, double level) {
  if (distribution.least() > level) return std::nullopt;
  const double bound = std::acos(level), end = coherence_search_multiple * bound;
  const double least_step = end / coherence_search_steps;
  if (surely_stays_above(distribution, level, bound, end)) return std::nullopt;
  double above = 0.0, u = bound;
  while (u <= end) {
    const StandardDistribution::Square square = distribution.square_at(u);
    const double surplus = square.value - level * level;
    if (surplus <= 0.0) return enclosed_fall(distribution, above, u, level);
    above = u;
    u += std::max(sure_step(surplus, square.slope), least_step);
  }
  return std::nullopt;
}

/// `first_fall` in the unit of 1/abscissa.
template <typename Abscissa>
std::optional<double> coherence_length(std::span<const PowerSample> samples, double level, Abscissa&& abscissa) {
  if (!(level > 0.0 && level < 1.0)) throw std::invalid_argument("coherence: the level must lie between 0 and 1");
  const StandardDistribution distribution(samples, abscissa);
  if (distribution.empty()) return std::nullopt;
  const std::optional<double> fall = first_fall(distribution, level);
  if (!fall) return std::nullopt;
  const double length = *fall / (2.0 * pi * distribution.deviation());
  return std::isfinite(length) ? std::optional(length) : std::nullopt;
}

}  // namespace detail

inline std::optional<double> coherence_bandwidth_hz(std::span<const PowerSample> samples, double level) {
  return detail::coherence_length(samples, level, [](const PowerSample& sample) { return sample.delay_s; });
}

inline std::optional<double> coherence_time_s(std::span<const PowerSample> samples, double level) {
  return detail::coherence_length(samples, level, [](const PowerSample& sample) { return sample.doppler_hz; });
}

}  // namespace dcem
