#pragma once
/// Where the field gets its reflection and transmission coefficients from: a concept for models of the user's own, and
/// the table of the built-in materials.
#include <cmath>
#include <concepts>
#include <cstddef>
#include <optional>
#include <stdexcept>
#include <utility>
#include <variant>
#include <vector>

#include "dcem/core/error.hpp"
#include "dcem/core/ids.hpp"
#include "dcem/em/material.hpp"
#include "dcem/em/slab.hpp"

namespace dcem {

/// Answers, at the frequency for which it was prepared, what a surface of `material` does to a wave that meets it under
/// `cos_incidence` = |k·n| in 0…1. Signs and phase reference: em/fresnel.hpp and em/slab.hpp.
template <typename Model>
concept SurfaceModel = requires(const Model& model, MaterialId material, double cos_incidence) {
  { model.response(material, cos_incidence) } -> std::same_as<SurfaceResponse>;
};

/// The built-in surface model: materials resolved once for one frequency.
class MaterialTable {
 public:
  /// `materials` in the order of their ids; `frequency_hz` > 0. Throws std::invalid_argument for what validate()
  /// refuses, for a frequency outside an ITU table (unless `itu` allows it) and for |η| > 1e300 there.
  MaterialTable(std::vector<Material> materials, double frequency_hz, const ItuSettings& itu = {});

  /// Coefficients of a material; `cos_incidence` is clamped to 0…1. Never NaN.
  SurfaceResponse response(MaterialId material, double cos_incidence) const;

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
  using PreparedSurface = std::variant<SurfaceResponse, HalfSpace, Slab>;

  PreparedSurface prepare(const PerfectConductor&) const { return SurfaceResponse{perfect_conductor_reflection(), {}}; }
  PreparedSurface prepare(const ConstantReflection& model) const;
  PreparedSurface prepare(const Dielectric& model) const;
  PreparedSurface prepare(const ItuMaterial& model) const;
  void prepare_all();

  static SurfaceResponse respond(const SurfaceResponse& constant, double) { return constant; }
  static SurfaceResponse respond(const HalfSpace& half_space, double cos_incidence) {
    return {half_space_reflection(half_space.permittivity, cos_incidence), {}};
  }
  static SurfaceResponse respond(const Slab& slab, double cos_incidence);

  std::vector<Material> materials_;
  double frequency_hz_;
  ItuSettings itu_;
  std::vector<PreparedSurface> surfaces_;
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
    const std::optional<Complex> eta = permittivity(id);
    if (eta && !(std::abs(*eta) <= 1e300))
      throw std::invalid_argument("material '" + material.name + "': its permittivity at this frequency is too large");
    const auto* itu_model = std::get_if<ItuMaterial>(&material.model);
    if (itu_model && itu_properties(itu_model->name, frequency_hz_, itu_).extrapolated) extrapolated_.push_back(id);
  }
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

inline SurfaceResponse MaterialTable::respond(const Slab& slab, double cos_incidence) {
  SurfaceResponse response = slab_response(slab.permittivity, slab.thickness_rad, cos_incidence);
  if (slab.opaque) response.transmission = {};
  return response;
}

inline SurfaceResponse MaterialTable::response(MaterialId material, double cos_incidence) const {
  DCEM_ASSERT(material.value < surfaces_.size());
  return std::visit([cos_incidence](const auto& surface) { return respond(surface, cos_incidence); },
                    surfaces_[material.value]);
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

static_assert(SurfaceModel<MaterialTable>);

}  // namespace dcem
