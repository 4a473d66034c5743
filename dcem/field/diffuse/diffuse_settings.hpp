#pragma once
/// How the diffuse power of a link is summed.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>

namespace dcem {

enum class DiffusePhases : std::uint8_t {
  incoherent,  ///< tiles add in power
  seeded       ///< each tile has a phase drawn from a seed, and adds to the coherent sum
};

struct DiffuseSettings {
  bool enabled = false;
  std::optional<double> tile_max_m{};  ///< no tile has a longer edge, m; absent: as the sum needs
  double tolerance_db = 0.1;           ///< to which the sum has converged, above 0
  DiffusePhases phases = DiffusePhases::incoherent;
  bool list_paths = false;           ///< points keep their paths, to be listed
  std::size_t tile_budget = 20'000;  ///< tiles evaluated for one link; where they do not suffice the result says so

  friend bool operator==(const DiffuseSettings&, const DiffuseSettings&) = default;
};

/// Throws std::invalid_argument, naming the field, where a value is out of range.
inline void validate(const DiffuseSettings& settings) {
  const auto check = [](bool holds, const char* message) {
    if (!holds) throw std::invalid_argument(message);
  };
  check(!settings.tile_max_m || (*settings.tile_max_m > 0.0 && std::isfinite(*settings.tile_max_m)),
        "tile_max_m: expected a finite number above 0");
  check(settings.tolerance_db > 0.0 && settings.tolerance_db <= 10.0, "tolerance_db: expected above 0, at most 10");
  check(settings.tile_budget >= 1, "tile_budget: expected at least 1");
}

}  // namespace dcem
