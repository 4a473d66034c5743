#pragma once
/// What lies between the surfaces of a path and weakens it: air, and foliage by the metre.
#include <cmath>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "dcem/core/units.hpp"
#include "dcem/em/medium/atmosphere.hpp"
#include "dcem/em/medium/foliage.hpp"
#include "dcem/em/surface/material.hpp"
#include "dcem/field/path_contribution.hpp"
#include "dcem/paths/path.hpp"

namespace dcem {

/// Prepared once for one frequency. Default-constructed it takes nothing: every factor is exactly 1.
class MediumLoss {
 public:
  MediumLoss() = default;

  /// `materials` in the order of their ids. Throws std::invalid_argument for what validate(Atmosphere) refuses, and
  /// where air or foliage has no model at the frequency.
  MediumLoss(const std::optional<Atmosphere>& atmosphere, std::span<const Material> materials, double frequency_hz);

  /// A transfer matrix after air and foliage.
  ComplexMatrix2 damped(const ComplexMatrix2& transfer, const Path& path, const Direction& departure,
                        const Direction& arrival) const {
    const ComplexMatrix2 after_air = air_.damped(transfer, path.length_m, departure.zenith_rad, arrival.zenith_rad);
    return path.foliage.empty() ? after_air : Complex(db_to_amplitude_ratio(-foliage_loss_db(path))) * after_air;
  }

  /// Whether a path is weakened in foliage of a material.
  bool takes_of(MaterialId foliage) const { return foliage_db_per_m_[foliage.value] > 0.0; }

  /// Whether a path keeps all of its power in air and foliage.
  bool takes_nothing_of(const Path& path) const { return air_.is_lossless() && path.foliage.empty(); }

  /// The power factor of a wave without a fixed polarization: the mean of both ends' in air, and the foliage's.
  double unpolarized_power(const Path& path, const Direction& departure, const Direction& arrival) const {
    if (takes_nothing_of(path)) return 1.0;
    const double sent = air_.unpolarized_power(path.length_m, 0.5 * pi - departure.zenith_rad);
    const double received = air_.unpolarized_power(path.length_m, 0.5 * pi - arrival.zenith_rad);
    return std::sqrt(sent * received) * db_to_power_ratio(-foliage_loss_db(path));
  }

 private:
  double foliage_loss_db(const Path& path) const {
    double loss_db = 0.0;
    for (const FoliageLength& part : path.foliage) {
      loss_db += foliage_db_per_m_[part.material.value] * part.length_m;
    }
    return loss_db;
  }

  AirLoss air_;
  std::vector<double> foliage_db_per_m_;  ///< by material; empty where none is foliage
};

inline MediumLoss::MediumLoss(const std::optional<Atmosphere>& atmosphere, std::span<const Material> materials,
                              double frequency_hz) {
  if (atmosphere) air_ = AirLoss(*atmosphere, frequency_hz);
  for (std::size_t index = 0; index < materials.size(); ++index) {
    const auto* foliage = std::get_if<Foliage>(&materials[index].model);
    if (foliage == nullptr) continue;
    foliage_db_per_m_.resize(materials.size());
    foliage_db_per_m_[index] =
        foliage->attenuation_db_per_m ? *foliage->attenuation_db_per_m : foliage_attenuation_db_per_m(frequency_hz);
  }
}

}  // namespace dcem
