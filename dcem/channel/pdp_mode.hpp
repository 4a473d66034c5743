#pragma once
/// The ways to sum up power over delay.

namespace dcem {

/// How the paths of one bin are added. Diffuse power is added to theirs in each of them.
enum class PdpMode {
  incoherent,   ///< Σ|h|²
  coherent,     ///< |Σh|²; dual-polarized links, which have no single h, add powers
  band_limited  ///< what a receiver of bandwidth 1/bin sees (channel/band_limited_profile.hpp)
};

}  // namespace dcem
