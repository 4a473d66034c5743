#pragma once
/// Where the field gets its reflection and transmission coefficients from: a concept for models of the user's own, and
/// the table of the built-in materials.
#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>
#include <variant>
#include <vector>

#include "dcem/core/error.hpp"
#include "dcem/core/ids.hpp"
#include "dcem/core/units.hpp"
#include "dcem/em/surface/itu_p2040.hpp"
#include "dcem/em/surface/itu_settings.hpp"
#include "dcem/em/surface/material.hpp"
#include "dcem/em/surface/multilayer.hpp"
#include "dcem/em/surface/roughness.hpp"
#include "dcem/em/surface/slab.hpp"
#include "dcem/em/surface/user_surface.hpp"

namespace dcem {

/// Answers, at the frequency for which it was prepared, what a surface of `material` does to a wave that meets it under
/// `cos_incidence` = |k·n| in 0…1. Signs and phase reference: em/surface/fresnel.hpp and em/surface/slab.hpp.
template <typename Model>
concept SurfaceModel = requires(const Model& model, MaterialId material, double cos_incidence) {
  { model.response(material, cos_incidence) } -> std::same_as<SurfaceResponse>;
};

/// A surface model that scatters, too. Its response() holds the mirror's share, √(1 − S²)·Γ; Γ itself is asked for by
/// smooth_reflection(). A model without these two functions has no diffuse power.
template <typename Model>
concept ScatteringModel = SurfaceModel<Model> && requires(const Model& model, MaterialId material, double cos) {
  { model.smooth_reflection(material, cos) } -> std::convertible_to<PolarizedCoefficients>;
  { model.scattering(material) } -> std::convertible_to<Scattering>;
};

/// The built-in surface model: materials resolved once for one frequency.
class MaterialTable {
 public:
  /// `materials` in the order of their ids; `frequency_hz` > 0. Throws std::invalid_argument for what validate()
  /// refuses, for a frequency outside an ITU table (unless `itu` allows it) and for |η| > 1e300 there.
  MaterialTable(std::vector<Material> materials, double frequency_hz, const ItuSettings& itu = {});

  /// Coefficients of a material, the reflection with the reduction for its roughness or its diffuse scattering;
  /// `cos_incidence` is clamped to 0…1. Never NaN.
  SurfaceResponse response(MaterialId material, double cos_incidence) const;
  /// The reflection of the same surface if it were smooth.
  PolarizedCoefficients smooth_reflection(MaterialId material, double cos_incidence) const;
  /// How the surface scatters.
  const Scattering& scattering(MaterialId id) const { return material(id).scattering; }

  const Material& material(MaterialId id) const;
  std::size_t size() const { return materials_.size(); }
  double frequency_hz() const { return frequency_hz_; }

  /// η of a dielectric or ITU material at this frequency; nothing for the other models.
  std::optional<Complex> permittivity(MaterialId id) const;

  /// Materials whose ITU properties were taken outside the table's frequency intervals: worth a warning.
  const std::vector<MaterialId>& extrapolated() const { return extrapolated_; }

 private:
  struct HalfSpace {
    Complex permittivity;
  };
  struct Slab {
    Complex permittivity;
    double thickness_rad;
    bool opaque;
  };
  struct Stack {
    std::vector<Layer> layers;
    bool opaque;
  };
  struct OwnModel {
    const UserSurfaceModel* model;  ///< kept by the material
    double frequency_hz;
  };
  using PreparedSurface = std::variant<SurfaceResponse, HalfSpace, Slab, Stack, OwnModel>;

  PreparedSurface prepare(const PerfectConductor&) const { return SurfaceResponse{perfect_conductor_reflection(), {}}; }
  PreparedSurface prepare(const ConstantReflection& model) const;
  PreparedSurface prepare(const Dielectric& model) const;
  PreparedSurface prepare(const ItuMaterial& model) const;
  PreparedSurface prepare(const Multilayer& model) const;
  PreparedSurface prepare(const Foliage&) const { return SurfaceResponse{{}, {1.0, 1.0}}; }
  PreparedSurface prepare(const UserSurface& surface) const { return OwnModel{surface.model.get(), frequency_hz_}; }
  void prepare_all();
  static void check_own(const Material& material, const OwnModel& own);
  bool extrapolates(const Material& material) const;
  double phase_spread_at_normal_rad(const Material& material) const;
  static bool representable(const PreparedSurface& surface);

  /// What the roughness or the scattering of a material leaves of its mirror.
  double specular_factor(MaterialId material, double cos_incidence) const;
  SurfaceResponse smooth_response(MaterialId material, double cos_incidence) const {
    DCEM_ASSERT(material.value < surfaces_.size());
    return std::visit([cos_incidence](const auto& surface) { return respond(surface, cos_incidence); },
                      surfaces_[material.value]);
  }

  static SurfaceResponse respond(const SurfaceResponse& constant, double) { return constant; }
  static SurfaceResponse respond(const HalfSpace& half_space, double cos_incidence) {
    return {half_space_reflection(half_space.permittivity, cos_incidence), {}};
  }
  static SurfaceResponse respond(const OwnModel& own, double cos_incidence) {
    return own.model->response(own.frequency_hz, cos_incidence);
  }
  static SurfaceResponse respond(const Slab& slab, double cos_incidence);
  static SurfaceResponse respond(const Stack& stack, double cos_incidence);

  std::vector<Material> materials_;
  double frequency_hz_;
  ItuSettings itu_;
  std::vector<PreparedSurface> surfaces_;
  std::vector<double> phase_spreads_at_normal_rad_;  // of the roughness; 0: smooth
  std::vector<MaterialId> extrapolated_;
};

inline MaterialTable::MaterialTable(std::vector<Material> materials, double frequency_hz, const ItuSettings& itu)
    : materials_(std::move(materials)), frequency_hz_(frequency_hz), itu_(itu) {
  if (!(frequency_hz > 0.0) || !std::isfinite(frequency_hz))
    throw std::invalid_argument("frequency must be positive and finite");
  prepare_all();
}

inline void MaterialTable::prepare_all() {
  surfaces_.reserve(materials_.size());
  for (const Material& material : materials_) {
    validate(material);
    const MaterialId id(surfaces_.size());
    surfaces_.push_back(std::visit([this](const auto& model) { return prepare(model); }, material.model));
    if (!representable(surfaces_.back()))
      throw std::invalid_argument("material '" + material.name + "': its permittivity at this frequency is too large");
    if (const auto* own = std::get_if<OwnModel>(&surfaces_.back())) check_own(material, *own);
    phase_spreads_at_normal_rad_.push_back(phase_spread_at_normal_rad(material));
    if (extrapolates(material)) extrapolated_.push_back(id);
  }
}

/// A model of the caller's own is tried at some angles: what would be a silent mistake is an error.
inline void MaterialTable::check_own(const Material& material, const OwnModel& own) {
  constexpr int steps = 16;
  for (int step = 0; step <= steps; ++step) {
    const SurfaceResponse response = respond(own, static_cast<double>(step) / steps);
    const auto require = [&](bool holds, const char* what) {
      if (!holds) throw std::invalid_argument("material '" + material.name + "': its own model " + what);
    };
    for (const Complex& value :
         {response.reflection.te, response.reflection.tm, response.transmission.te, response.transmission.tm}) {
      require(is_finite(value), "gives a coefficient that is not finite");
    }
    require(transmits(material) || (response.transmission.te == 0.0 && response.transmission.tm == 0.0),
            "lets a wave through, but is not said to transmit");
  }
}

inline bool MaterialTable::extrapolates(const Material& material) const {
  const std::vector<std::string> names = itu_names(material);
  return std::any_of(names.begin(), names.end(), [this](const std::string& name) {
    return itu_properties(name, frequency_hz_, itu_).extrapolated;
  });
}

inline double MaterialTable::phase_spread_at_normal_rad(const Material& material) const {
  if (material.roughness_rms_m == 0.0) return 0.0;
  // Finite, so that at grazing incidence the product with cos θ = 0 is 0.
  return std::min(roughness_phase_spread_rad(wave_number_rad_per_m(frequency_hz_), material.roughness_rms_m, 1.0),
                  std::numeric_limits<double>::max());
}

inline bool MaterialTable::representable(const PreparedSurface& surface) {
  const auto fits = [](const auto& medium) { return std::abs(medium.permittivity) <= 1e300; };
  if (const auto* half_space = std::get_if<HalfSpace>(&surface)) return fits(*half_space);
  if (const auto* slab = std::get_if<Slab>(&surface)) return fits(*slab);
  const auto* stack = std::get_if<Stack>(&surface);
  return !stack || std::all_of(stack->layers.begin(), stack->layers.end(), fits);
}

inline MaterialTable::PreparedSurface MaterialTable::prepare(const ConstantReflection& model) const {
  const double rho = model.reflection_amplitude;
  const double through = model.penetration_loss_db ? db_to_amplitude_ratio(-*model.penetration_loss_db) : 0.0;
  return SurfaceResponse{{-rho, rho}, {through, through}};
}

inline MaterialTable::PreparedSurface MaterialTable::prepare(const Dielectric& model) const {
  const Complex eta = complex_permittivity(model.relative_permittivity, model.conductivity_s_per_m, frequency_hz_);
  if (!model.thickness_m) return HalfSpace{eta};
  return Slab{eta, wave_number_rad_per_m(frequency_hz_) * *model.thickness_m, false};
}

inline MaterialTable::PreparedSurface MaterialTable::prepare(const ItuMaterial& model) const {
  const ItuProperties properties = itu_properties(model.name, frequency_hz_, itu_);
  const PreparedSurface prepared =
      prepare(Dielectric{properties.relative_permittivity, properties.conductivity_s_per_m, model.thickness_m});
  if (!model.thickness_m || detail::model_transmits(model)) return prepared;
  Slab slab = std::get<Slab>(prepared);
  slab.opaque = true;
  return slab;
}

inline MaterialTable::PreparedSurface MaterialTable::prepare(const Multilayer& model) const {
  Stack stack{{}, !detail::model_transmits(model)};
  for (const MaterialLayer& layer : model.layers) {
    // A medium with a thickness is prepared as a slab.
    const Slab slab = std::visit([this](const auto& medium) { return std::get<Slab>(prepare(medium)); }, layer);
    stack.layers.push_back({slab.permittivity, slab.thickness_rad});
  }
  return stack;
}

inline SurfaceResponse MaterialTable::respond(const Slab& slab, double cos_incidence) {
  SurfaceResponse response = slab_response(slab.permittivity, slab.thickness_rad, cos_incidence);
  if (slab.opaque) response.transmission = {};
  return response;
}

inline SurfaceResponse MaterialTable::respond(const Stack& stack, double cos_incidence) {
  SurfaceResponse response = multilayer_response(stack.layers, cos_incidence);
  if (stack.opaque) response.transmission = {};
  return response;
}

inline SurfaceResponse MaterialTable::response(MaterialId material, double cos_incidence) const {
  SurfaceResponse response = smooth_response(material, cos_incidence);
  const double factor = specular_factor(material, cos_incidence);
  if (factor == 1.0) return response;
  response.reflection.te *= factor;
  response.reflection.tm *= factor;
  return response;
}

inline PolarizedCoefficients MaterialTable::smooth_reflection(MaterialId material, double cos_incidence) const {
  return smooth_response(material, cos_incidence).reflection;
}

inline double MaterialTable::specular_factor(MaterialId material, double cos_incidence) const {
  const double spread_at_normal_rad = phase_spreads_at_normal_rad_[material.value];
  if (spread_at_normal_rad == 0.0) return specular_share(materials_[material.value].scattering);
  return ament_factor(spread_at_normal_rad * std::clamp(cos_incidence, 0.0, 1.0));
}

inline const Material& MaterialTable::material(MaterialId id) const {
  DCEM_ASSERT(id.value < materials_.size());
  return materials_[id.value];
}

inline std::optional<Complex> MaterialTable::permittivity(MaterialId id) const {
  DCEM_ASSERT(id.value < surfaces_.size());
  if (const auto* half_space = std::get_if<HalfSpace>(&surfaces_[id.value])) return half_space->permittivity;
  if (const auto* slab = std::get_if<Slab>(&surfaces_[id.value])) return slab->permittivity;
  return std::nullopt;
}

static_assert(SurfaceModel<MaterialTable> && ScatteringModel<MaterialTable>);

}  // namespace dcem
