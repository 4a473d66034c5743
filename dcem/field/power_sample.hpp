#pragma once
/// Power that arrives at one delay, with one Doppler shift, from one direction; and the moments of many of them.
///
/// A specular path and a diffuse contribution, which has no phase, look the same here: what is computed from power
/// alone takes samples.
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "dcem/field/path_contribution.hpp"

namespace dcem {

/// A share of the received power. All values finite, power_ratio ≥ 0.
struct PowerSample {
  double power_ratio = 0.0;  ///< received power over the power fed into the transmitting antenna
  double delay_s = 0.0;
  double doppler_hz = 0.0;  ///< positive when the path shortens
  Direction departure;
  Direction arrival;
};

/// What is left of a path without its phase.
inline PowerSample power_sample(const PathContribution& path) {
  return {path.power_ratio, path.delay_s, path.doppler_hz, path.departure, path.arrival};
}

/// Power-weighted moments; the sums run over samples of powers P.
/// Spreads of angles a are √(−2 ln|Σ P e^{ja}/Σ P|), for azimuths and zeniths alike. Source: 3GPP TR 38.901, Annex A.
/// A spread of angles is 0 for one direction, does not change when all azimuths turn together, and grows without bound
/// as the sum of phasors vanishes; it is given as at most 37.2 rad.
struct PowerMoments {
  double power_ratio = 0.0;            ///< Σ P
  double first_delay_s = 0.0;          ///< the smallest delay, also that of a sample without power
  double mean_delay_s = 0.0;           ///< Σ P τ / Σ P
  double rms_delay_spread_s = 0.0;     ///< √(Σ P (τ − mean)² / Σ P), delays counted from the first
  double mean_doppler_hz = 0.0;        ///< Σ P f / Σ P
  double rms_doppler_spread_hz = 0.0;  ///< √(Σ P (f − mean)² / Σ P)
  double azimuth_spread_departure_rad = 0.0;
  double azimuth_spread_arrival_rad = 0.0;
  double zenith_spread_departure_rad = 0.0;
  double zenith_spread_arrival_rad = 0.0;
};

/// The moments of the samples, summed in their order. Nothing where there is no power.
std::optional<PowerMoments> power_moments(std::span<const PowerSample> samples);

/// The smallest delay of all samples, with power or without; nothing where there is none.
inline std::optional<double> first_delay_s(std::span<const PowerSample> samples) {
  if (samples.empty()) return std::nullopt;
  double first_s = samples.front().delay_s;
  for (const PowerSample& sample : samples) first_s = std::min(first_s, sample.delay_s);
  return first_s;
}

// ---------------------------------------------------------------------------------------------------------------------

namespace detail {

/// Σ P q / Σ P for a quantity q of the samples.
template <typename Quantity>
double weighted_mean(std::span<const PowerSample> samples, double total, Quantity&& quantity) {
  double sum = 0.0;
  for (const PowerSample& sample : samples) sum += sample.power_ratio * quantity(sample);
  return sum / total;
}

template <typename Quantity>
double weighted_deviation(std::span<const PowerSample> samples, double total, double mean, Quantity&& quantity) {
  const auto squared = [&](const PowerSample& sample) {
    const double difference = quantity(sample) - mean;
    return difference * difference;
  };
  return std::sqrt(weighted_mean(samples, total, squared));
}

template <typename Angle>
double circular_spread_rad(std::span<const PowerSample> samples, double total, Angle&& angle) {
  const double c = weighted_mean(samples, total, [&](const PowerSample& sample) { return std::cos(angle(sample)); });
  const double s = weighted_mean(samples, total, [&](const PowerSample& sample) { return std::sin(angle(sample)); });
  const double length = std::clamp(std::hypot(c, s), 1e-300, 1.0);
  return std::sqrt(std::max(0.0, -2.0 * std::log(length)));
}

inline void add_angle_spreads(PowerMoments& moments, std::span<const PowerSample> samples) {
  const auto spread_rad = [&](auto&& angle) { return circular_spread_rad(samples, moments.power_ratio, angle); };
  moments.azimuth_spread_departure_rad = spread_rad([](const PowerSample& one) { return one.departure.azimuth_rad; });
  moments.azimuth_spread_arrival_rad = spread_rad([](const PowerSample& one) { return one.arrival.azimuth_rad; });
  moments.zenith_spread_departure_rad = spread_rad([](const PowerSample& one) { return one.departure.zenith_rad; });
  moments.zenith_spread_arrival_rad = spread_rad([](const PowerSample& one) { return one.arrival.zenith_rad; });
}

}  // namespace detail

inline std::optional<PowerMoments> power_moments(std::span<const PowerSample> samples) {
  PowerMoments moments;
  for (const PowerSample& sample : samples) moments.power_ratio += sample.power_ratio;
  const double total = moments.power_ratio;
  if (!(total > 0.0)) return std::nullopt;
  moments.first_delay_s = *first_delay_s(samples);
  // From the first delay on: the square of a delay of a millisecond has no room for nanoseconds.
  const auto excess_s = [&](const PowerSample& sample) { return sample.delay_s - moments.first_delay_s; };
  const auto doppler_hz = [](const PowerSample& sample) { return sample.doppler_hz; };
  const double mean_excess_s = detail::weighted_mean(samples, total, excess_s);
  moments.mean_delay_s = moments.first_delay_s + mean_excess_s;
  moments.rms_delay_spread_s = detail::weighted_deviation(samples, total, mean_excess_s, excess_s);
  moments.mean_doppler_hz = detail::weighted_mean(samples, total, doppler_hz);
  moments.rms_doppler_spread_hz = detail::weighted_deviation(samples, total, moments.mean_doppler_hz, doppler_hz);
  detail::add_angle_spreads(moments, samples);
  return moments;
}

}  // namespace dcem
