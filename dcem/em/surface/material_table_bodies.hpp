#pragma once
/// Bodies of material_table.hpp.
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

#include "dcem/core/build_mode.hpp"
#include "dcem/core/error.hpp"
#include "dcem/core/ids.hpp"
#include "dcem/core/units.hpp"
#include "dcem/em/surface/itu_p2040.hpp"
#include "dcem/em/surface/itu_settings.hpp"
#include "dcem/em/surface/material.hpp"
#include "dcem/em/surface/material_table.hpp"
#include "dcem/em/surface/multilayer.hpp"
#include "dcem/em/surface/roughness.hpp"
#include "dcem/em/surface/slab.hpp"
#include "dcem/em/surface/user_surface.hpp"

namespace dcem {

DCEM_INLINE MaterialTable::MaterialTable(std::vector<Material> materials, double frequency_hz, const ItuSettings& itu)
    : materials_(std::move(materials)), frequency_hz_(frequency_hz), itu_(itu) {
  if (!(frequency_hz > 0.0) || !std::isfinite(frequency_hz))
    throw std::invalid_argument("frequency must be positive and finite");
  prepare_all();
}

DCEM_INLINE void MaterialTable::prepare_all() {
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
DCEM_INLINE void MaterialTable::check_own(const Material& material, const OwnModel& own) {
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

DCEM_INLINE bool MaterialTable::extrapolates(const Material& material) const {
  const std::vector<std::string> names = itu_names(material);
  return std::any_of(names.begin(), names.end(), [this](const std::string& name) {
    return itu_properties(name, frequency_hz_, itu_).extrapolated;
  });
}

DCEM_INLINE double MaterialTable::phase_spread_at_normal_rad(const Material& material) const {
  if (material.roughness_rms_m == 0.0) return 0.0;
  // Finite, so that at grazing incidence the product with cos θ = 0 is 0.
  return std::min(roughness_phase_spread_rad(wave_number_rad_per_m(frequency_hz_), material.roughness_rms_m, 1.0),
                  std::numeric_limits<double>::max());
}

DCEM_INLINE bool MaterialTable::representable(const PreparedSurface& surface) {
  const auto fits = [](const auto& medium) { return std::abs(medium.permittivity) <= 1e300; };
  if (const auto* half_space = std::get_if<HalfSpace>(&surface)) return fits(*half_space);
  if (const auto* slab = std::get_if<Slab>(&surface)) return fits(*slab);
  const auto* stack = std::get_if<Stack>(&surface);
  return !stack || std::all_of(stack->layers.begin(), stack->layers.end(), fits);
}

DCEM_INLINE MaterialTable::PreparedSurface MaterialTable::prepare(const PerfectConductor&) const {
  return SurfaceResponse{perfect_conductor_reflection(), {}};
}

DCEM_INLINE MaterialTable::PreparedSurface MaterialTable::prepare(const Foliage&) const {
  return SurfaceResponse{{}, {1.0, 1.0}};
}

DCEM_INLINE MaterialTable::PreparedSurface MaterialTable::prepare(const UserSurface& surface) const {
  return OwnModel{surface.model.get(), frequency_hz_};
}

DCEM_INLINE MaterialTable::PreparedSurface MaterialTable::prepare(const ConstantReflection& model) const {
  const double rho = model.reflection_amplitude;
  const double through = model.penetration_loss_db ? db_to_amplitude_ratio(-*model.penetration_loss_db) : 0.0;
  return SurfaceResponse{{-rho, rho}, {through, through}};
}

DCEM_INLINE MaterialTable::PreparedSurface MaterialTable::prepare(const Dielectric& model) const {
  const Complex eta = complex_permittivity(model.relative_permittivity, model.conductivity_s_per_m, frequency_hz_);
  if (!model.thickness_m) return HalfSpace{eta};
  return Slab{eta, wave_number_rad_per_m(frequency_hz_) * *model.thickness_m, false};
}

DCEM_INLINE MaterialTable::PreparedSurface MaterialTable::prepare(const ItuMaterial& model) const {
  const ItuProperties properties = itu_properties(model.name, frequency_hz_, itu_);
  const PreparedSurface prepared =
      prepare(Dielectric{properties.relative_permittivity, properties.conductivity_s_per_m, model.thickness_m});
  if (!model.thickness_m || detail::model_transmits(model)) return prepared;
  Slab slab = std::get<Slab>(prepared);
  slab.opaque = true;
  return slab;
}

DCEM_INLINE MaterialTable::PreparedSurface MaterialTable::prepare(const Multilayer& model) const {
  Stack stack{{}, !detail::model_transmits(model)};
  for (const MaterialLayer& layer : model.layers) {
    // A medium with a thickness is prepared as a slab.
    const Slab slab = std::visit([this](const auto& medium) { return std::get<Slab>(prepare(medium)); }, layer);
    stack.layers.push_back({slab.permittivity, slab.thickness_rad});
  }
  return stack;
}

DCEM_INLINE SurfaceResponse MaterialTable::respond(const HalfSpace& half_space, double cos_incidence) {
  return {half_space_reflection(half_space.permittivity, cos_incidence), {}};
}

DCEM_INLINE SurfaceResponse MaterialTable::respond(const OwnModel& own, double cos_incidence) {
  return own.model->response(own.frequency_hz, cos_incidence);
}

DCEM_INLINE SurfaceResponse MaterialTable::respond(const Slab& slab, double cos_incidence) {
  SurfaceResponse response = slab_response(slab.permittivity, slab.thickness_rad, cos_incidence);
  if (slab.opaque) response.transmission = {};
  return response;
}

DCEM_INLINE SurfaceResponse MaterialTable::respond(const Stack& stack, double cos_incidence) {
  SurfaceResponse response = multilayer_response(stack.layers, cos_incidence);
  if (stack.opaque) response.transmission = {};
  return response;
}

DCEM_INLINE SurfaceResponse MaterialTable::smooth_response(MaterialId material, double cos_incidence) const {
  DCEM_ASSERT(material.value < surfaces_.size());
  return std::visit([cos_incidence](const auto& surface) { return respond(surface, cos_incidence); },
                    surfaces_[material.value]);
}

DCEM_INLINE SurfaceResponse MaterialTable::response(MaterialId material, double cos_incidence) const {
  SurfaceResponse response = smooth_response(material, cos_incidence);
  const double factor = specular_factor(material, cos_incidence);
  if (factor == 1.0) return response;
  response.reflection.te *= factor;
  response.reflection.tm *= factor;
  return response;
}

DCEM_INLINE PolarizedCoefficients MaterialTable::smooth_reflection(MaterialId material, double cos_incidence) const {
  return smooth_response(material, cos_incidence).reflection;
}

DCEM_INLINE double MaterialTable::specular_factor(MaterialId material, double cos_incidence) const {
  const double spread_at_normal_rad = phase_spreads_at_normal_rad_[material.value];
  if (spread_at_normal_rad == 0.0) return specular_share(materials_[material.value].scattering);
  return ament_factor(spread_at_normal_rad * std::clamp(cos_incidence, 0.0, 1.0));
}

DCEM_INLINE const Material& MaterialTable::material(MaterialId id) const {
  DCEM_ASSERT(id.value < materials_.size());
  return materials_[id.value];
}

DCEM_INLINE std::optional<Complex> MaterialTable::permittivity(MaterialId id) const {
  DCEM_ASSERT(id.value < surfaces_.size());
  if (const auto* half_space = std::get_if<HalfSpace>(&surfaces_[id.value])) return half_space->permittivity;
  if (const auto* slab = std::get_if<Slab>(&surfaces_[id.value])) return slab->permittivity;
  return std::nullopt;
}

}  // namespace dcem
