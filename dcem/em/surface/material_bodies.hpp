#pragma once
/// Bodies of material.hpp.
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string_view>

#include "dcem/core/build_mode.hpp"
#include "dcem/core/units.hpp"
#include "dcem/em/surface/itu_p2040.hpp"
#include "dcem/em/surface/material.hpp"

namespace dcem {

namespace detail {

inline bool model_transmits(const PerfectConductor&) {
  return false;
}
inline bool model_transmits(const ConstantReflection& model) {
  return model.penetration_loss_db.has_value();
}
inline bool model_transmits(const Dielectric& model) {
  return model.thickness_m.has_value();
}
DCEM_INLINE bool model_transmits(const ItuMaterial& model) {
  return model.thickness_m.has_value() && model.name != "metal";
}
DCEM_INLINE bool model_transmits(const Multilayer& model) {
  return std::all_of(model.layers.begin(), model.layers.end(), [](const MaterialLayer& layer) {
    return std::visit([](const auto& medium) { return model_transmits(medium); }, layer);
  });
}

inline bool model_transmits(const Foliage&) {
  return true;
}
inline bool model_transmits(const UserSurface& model) {
  return model.transmits;
}

/// Collects the wording of errors: "material 'wall': …".
class MaterialCheck {
 public:
  explicit MaterialCheck(const std::string& material_name) : material_name_(material_name) {}

  void require(bool condition, std::string_view expectation) const {
    if (!condition) throw std::invalid_argument("material '" + material_name_ + "': " + std::string(expectation));
  }

  void operator()(const PerfectConductor&) const {}

  void operator()(const ConstantReflection& model) const {
    const double amplitude = model.reflection_amplitude;
    require(amplitude >= 0.0 && amplitude <= 1.0, "reflection amplitude must lie in 0 to 1");
    if (!model.penetration_loss_db) return;
    require(std::isfinite(*model.penetration_loss_db) && *model.penetration_loss_db >= 0.0,
            "penetration loss must be finite and not negative");
    // The allowance is for losses that were computed from an amplitude, 10^(−loss/10) = 1 − ρ² up to rounding.
    require(amplitude * amplitude + db_to_power_ratio(-*model.penetration_loss_db) <= 1.0 + 1e-12,
            "reflected and transmitted power together exceed the incident power");
  }

  void operator()(const Dielectric& model) const {
    require(std::isfinite(model.relative_permittivity) && model.relative_permittivity >= 1.0,
            "relative permittivity must be finite and at least 1");
    require(std::isfinite(model.conductivity_s_per_m) && model.conductivity_s_per_m >= 0.0,
            "conductivity must be finite and not negative");
    require_thickness(model.thickness_m);
  }

  void operator()(const ItuMaterial& model) const {
    require(canonical_itu_name(model.name) == model.name, "'" + model.name + "' is not a material of ITU-R P.2040");
    require_thickness(model.thickness_m);
  }

  void operator()(const Multilayer& model) const {
    require(!model.layers.empty(), "a multilayer must have at least one layer");
    for (const MaterialLayer& layer : model.layers) {
      std::visit(*this, layer);
      const bool thick = std::visit([](const auto& medium) { return medium.thickness_m.has_value(); }, layer);
      require(thick, "every layer must have a thickness");
    }
  }

  void operator()(const Foliage& model) const {
    if (!model.attenuation_db_per_m) return;
    require(std::isfinite(*model.attenuation_db_per_m) && *model.attenuation_db_per_m >= 0.0,
            "loss per metre of foliage must be finite and not negative");
  }

  void operator()(const UserSurface& surface) const { require(surface.model != nullptr, "its own model is missing"); }

  void operator()(const Scattering& scattering) const {
    try {
      dcem::validate(scattering);
    } catch (const std::invalid_argument& error) {
      require(false, error.what());
    }
  }

 private:
  void require_thickness(const std::optional<double>& thickness_m) const {
    if (thickness_m)
      require(std::isfinite(*thickness_m) && *thickness_m > 0.0, "thickness must be finite and positive");
  }

  const std::string& material_name_;
};

}  // namespace detail

DCEM_INLINE bool transmits(const Material& material) {
  return std::visit([](const auto& model) { return detail::model_transmits(model); }, material.model);
}

DCEM_INLINE bool is_foliage(const Material& material) {
  return std::holds_alternative<Foliage>(material.model);
}

DCEM_INLINE bool scatters(const Material& material) {
  return material.scattering.coefficient > 0.0 && !is_foliage(material);
}

DCEM_INLINE std::vector<std::string> itu_names(const Material& material) {
  std::vector<std::string> names;
  const auto collect = [&names](const ItuMaterial* model) {
    if (model && std::find(names.begin(), names.end(), model->name) == names.end()) names.push_back(model->name);
  };
  collect(std::get_if<ItuMaterial>(&material.model));
  if (const auto* stack = std::get_if<Multilayer>(&material.model)) {
    for (const MaterialLayer& layer : stack->layers) collect(std::get_if<ItuMaterial>(&layer));
  }
  return names;
}

DCEM_INLINE void validate(const Material& material) {
  const detail::MaterialCheck check(material.name);
  std::visit(check, material.model);
  check.require(std::isfinite(material.roughness_rms_m) && material.roughness_rms_m >= 0.0,
                "roughness must be finite and not negative");
  check(material.scattering);
  check.require(material.roughness_rms_m == 0.0 || material.scattering.coefficient == 0.0,
                "roughness and scattering both reduce the mirror; give one of them");
}

}  // namespace dcem
