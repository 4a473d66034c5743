#pragma once
/// A hash of everything that a frame says about its paths, or a map about its points: two runs agree if and only if
/// (but for chance) all numbers agree to the last bit.
#include <bit>
#include <cstdint>
#include <optional>
#include <string>

#include "dcem/channel/radio_map.hpp"
#include "dcem/core/random.hpp"
#include "dcem/sim/frame_result.hpp"

namespace dcem::bench {

inline std::uint64_t hash_of(double value) {
  return std::bit_cast<std::uint64_t>(value);
}

inline std::uint64_t hash_of(const PathContribution& contribution, std::uint64_t hash) {
  for (const Interaction& interaction : contribution.path.interactions) {
    hash = hash_values(hash, static_cast<std::uint64_t>(interaction.kind), interaction.facet.value,
                       hash_of(interaction.point_m.x), hash_of(interaction.point_m.y), hash_of(interaction.point_m.z));
  }
  for (const auto& row : contribution.transfer.entries) {
    for (const Complex& entry : row) hash = hash_values(hash, hash_of(entry.real()), hash_of(entry.imag()));
  }
  return hash_values(hash, hash_of(contribution.path.length_m), hash_of(contribution.doppler_hz));
}

/// The hash of a frame's links, chained to that of the frames before.
inline std::uint64_t hash_of(const FrameResult& frame, std::uint64_t hash) {
  for (const LinkResult& link : frame.links) {
    hash = hash_values(hash, link.transmitter, link.receiver, link.paths.size());
    for (const PathContribution& contribution : link.paths) hash = hash_of(contribution, hash);
  }
  return hash;
}

inline std::uint64_t hash_of(const LinkStatistics& link, std::uint64_t hash) {
  hash = hash_values(hash, link.line_of_sight ? 1U : 0U, link.path_count);
  for (const std::optional<double>& value :
       {link.power_dbm, link.power_incoherent_dbm, link.power_los_dbm, link.power_reflected_dbm,
        link.power_transmitted_dbm, link.power_diffracted_dbm, link.power_diffuse_dbm, link.path_gain_db,
        link.first_delay_s, link.mean_delay_s, link.rms_delay_spread_s, link.k_factor_db,
        link.azimuth_spread_arrival_rad, link.azimuth_spread_departure_rad, link.zenith_spread_arrival_rad,
        link.zenith_spread_departure_rad, link.mean_doppler_hz, link.rms_doppler_spread_hz}) {
    hash = hash_values(hash, value ? 1U : 0U, hash_of(value.value_or(0.0)));
  }
  return hash;
}

inline std::uint64_t hash_of(const RadioMapPoint& point, std::uint64_t hash) {
  hash = hash_values(hash, point.obstructed ? 1U : 0U, hash_of(point.position_m.x), hash_of(point.position_m.y),
                     hash_of(point.position_m.z), point.strongest_kinds.size());
  for (const char kind : point.strongest_kinds) hash = hash_values(hash, kind);
  return hash_of(point.statistics, hash);
}

}  // namespace dcem::bench
