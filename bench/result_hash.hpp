#pragma once
/// A hash of everything that a frame says about its paths: two runs agree if and only if (but for chance) all numbers
/// agree to the last bit.
#include <bit>
#include <cstdint>

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

}  // namespace dcem::bench
