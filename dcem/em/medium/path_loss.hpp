#pragma once
/// Large-scale path loss beside free space. A model acts on the total unfolded length of a path, never leg by leg:
/// charging the loss of the first metre for every leg would add about 62 dB per bounce at 30 GHz.
#include <cmath>
#include <concepts>
#include <memory>
#include <stdexcept>
#include <utility>
#include <variant>

#include "dcem/core/constants.hpp"

namespace dcem {

/// A real factor on the field beside free space λ/(4πL), for a path of total length L ≥ 0 in metres.
template <typename Model>
concept PathLossModel = requires(const Model& model, double total_length_m) {
  { model.excess_amplitude(total_length_m) } -> std::same_as<double>;
};

/// Friis: no excess.
struct FreeSpace {
  double excess_amplitude(double) const { return 1.0; }
  friend bool operator==(const FreeSpace&, const FreeSpace&) = default;
};

/// The close-in model with a reference distance of 1 m (Sun, Rappaport et al., IEEE Trans. Veh. Technol. 65(5), 2016):
///   PL = FSPL(f, 1 m) + 10·n·log10(L/1 m) + α·L   in dB,
/// kept here as its excess over free space, (n − 2)·10·log10(L) + α·L. For L < 1 m the exponent adds nothing. With
/// n = 2 and α = 0 the excess is exactly 1. The model describes regional means: with n ≠ 2 powers make sense, the
/// interference pattern does not. Shadow fading is not part of a deterministic engine.
struct CloseIn {
  double exponent = 2.0;              ///< n
  double attenuation_db_per_m = 0.0;  ///< α, on the total length

  double excess_loss_db(double total_length_m) const {
    const double exponent_db = total_length_m < 1.0 ? 0.0 : (exponent - 2.0) * (10.0 * std::log10(total_length_m));
    return exponent_db + attenuation_db_per_m * total_length_m;
  }
  double excess_amplitude(double total_length_m) const {
    return std::pow(10.0, -excess_loss_db(total_length_m) / 20.0);
  }
  friend bool operator==(const CloseIn&, const CloseIn&) = default;
};

/// Throws std::invalid_argument unless the exponent is positive, the attenuation not negative, and both finite.
inline void validate(const CloseIn& model) {
  if (!std::isfinite(model.exponent) || !(model.exponent > 0.0))
    throw std::invalid_argument("close-in path loss: the exponent must be finite and positive");
  if (!std::isfinite(model.attenuation_db_per_m) || model.attenuation_db_per_m < 0.0)
    throw std::invalid_argument("close-in path loss: the attenuation must be finite and not negative");
}

/// A model of the caller's own, from any type that models the concept above. Called from several threads at once.
class UserPathLoss {
 public:
  template <PathLossModel Model>
  requires(!std::same_as<Model, UserPathLoss>) explicit UserPathLoss(Model model)
      : model_(std::make_shared<const Model>(std::move(model))), ask_([](const void* own, double total_length_m) {
          return static_cast<const Model*>(own)->excess_amplitude(total_length_m);
        }) {}

  double excess_amplitude(double total_length_m) const { return ask_(model_.get(), total_length_m); }
  friend bool operator==(const UserPathLoss& one, const UserPathLoss& other) { return one.model_ == other.model_; }

 private:
  std::shared_ptr<const void> model_;
  double (*ask_)(const void* model, double total_length_m);
};

/// A built-in model or one of the caller's own, chosen at run time; models the same concept.
struct AnyPathLoss {
  std::variant<FreeSpace, CloseIn, UserPathLoss> model{};

  double excess_amplitude(double total_length_m) const {
    return std::visit([total_length_m](const auto& chosen) { return chosen.excess_amplitude(total_length_m); }, model);
  }
  friend bool operator==(const AnyPathLoss&, const AnyPathLoss&) = default;
};

static_assert(PathLossModel<FreeSpace> && PathLossModel<CloseIn> && PathLossModel<AnyPathLoss>);

/// Free-space path loss between isotropic antennas, 20·log10(4πL·f/c) in dB. `length_m` > 0, `frequency_hz` > 0, both
/// finite, else std::invalid_argument. Below λ/(4π) the far-field formula gives a gain; it is returned as it is.
inline double free_space_path_loss_db(double length_m, double frequency_hz) {
  if (!(length_m > 0.0) || !std::isfinite(length_m) || !(frequency_hz > 0.0) || !std::isfinite(frequency_hz))
    throw std::invalid_argument("path loss: length and frequency must be finite and positive");
  return 20.0 * std::log10(4.0 * pi * length_m * frequency_hz / speed_of_light_mps);
}

/// Close-in path loss in dB: free space plus the model's excess. Arguments as for free_space_path_loss_db.
inline double close_in_path_loss_db(const CloseIn& model, double length_m, double frequency_hz) {
  return free_space_path_loss_db(length_m, frequency_hz) + model.excess_loss_db(length_m);
}

}  // namespace dcem
