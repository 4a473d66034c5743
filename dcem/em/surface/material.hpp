#pragma once
/// Named surface materials: a closed set of models, chosen at run time because one scene mixes them.
#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "dcem/core/units.hpp"
#include "dcem/em/surface/effective_roughness.hpp"
#include "dcem/em/surface/itu_p2040.hpp"

namespace dcem {

/// Perfect electric conductor: R_te = −1, R_tm = +1, nothing passes.
struct PerfectConductor {
  friend bool operator==(const PerfectConductor&, const PerfectConductor&) = default;
};

/// An engineering surface with one amplitude at every angle: R_te = −ρ, R_tm = +ρ (the phase of a perfect conductor,
/// so ρ = 1 is one), and T = 10^(−loss/20) for both polarizations without a phase beyond that of the straight path.
struct ConstantReflection {
  double reflection_amplitude = 1.0;          ///< ρ in 0…1, of the field: ρ = 0.8 loses 1.94 dB
  std::optional<double> penetration_loss_db;  ///< of one crossing, ≥ 0; absent: opaque

  friend bool operator==(const ConstantReflection&, const ConstantReflection&) = default;
};

/// A homogeneous non-magnetic medium, the same numbers at every frequency.
struct Dielectric {
  double relative_permittivity = 1.0;   ///< ε' ≥ 1
  double conductivity_s_per_m = 0.0;    ///< σ ≥ 0
  std::optional<double> thickness_m{};  ///< > 0: a slab; absent: a half space, opaque

  friend bool operator==(const Dielectric&, const Dielectric&) = default;
};

/// A material of the table of ITU-R P.2040 (em/itu_p2040.hpp), by its canonical name, e.g. "concrete".
struct ItuMaterial {
  std::string name;
  std::optional<double> thickness_m{};  ///< > 0: a slab; absent: a half space, opaque

  friend bool operator==(const ItuMaterial&, const ItuMaterial&) = default;
};

/// One layer of a wall: a medium with its thickness, which must be there.
using MaterialLayer = std::variant<Dielectric, ItuMaterial>;

/// Layers one behind the other, between air and air (em/multilayer.hpp). Surfaces are two-sided sheets without a front:
/// whichever side a wave comes from, it meets the first layer first. The transmission does not depend on that order,
/// nor does the reflected power where nothing is lost.
struct Multilayer {
  std::vector<MaterialLayer> layers;  ///< at least one

  friend bool operator==(const Multilayer&, const Multilayer&) = default;
};

/// Leaves and twigs: no surface that reflects, but a loss for every metre inside. A closed shell of it is a tree or a
/// hedge; paths go straight through, and what they lose is counted on their length inside.
struct Foliage {
  std::optional<double> attenuation_db_per_m{};  ///< ≥ 0; absent: by frequency (em/foliage.hpp)

  friend bool operator==(const Foliage&, const Foliage&) = default;
};

using MaterialModel = std::variant<PerfectConductor, ConstantReflection, Dielectric, ItuMaterial, Multilayer, Foliage>;

struct Material {
  std::string name;
  MaterialModel model;
  /// Standard deviation of the surface height, ≥ 0; 0: smooth. It reduces what is reflected (em/roughness.hpp, Ament),
  /// with every model; what passes is not changed.
  double roughness_rms_m = 0.0;
  /// Diffuse scattering; the mirror keeps √(1 − S²). Not together with a roughness: both would take the same power.
  Scattering scattering{};

  friend bool operator==(const Material&, const Material&) = default;
};

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
inline bool model_transmits(const ItuMaterial& model) {
  return model.thickness_m.has_value() && model.name != "metal";
}
inline bool model_transmits(const Multilayer& model) {
  return std::all_of(model.layers.begin(), model.layers.end(), [](const MaterialLayer& layer) {
    return std::visit([](const auto& medium) { return model_transmits(medium); }, layer);
  });
}

inline bool model_transmits(const Foliage&) {
  return true;
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

/// Whether paths may cross a surface of this material. A constant surface: if it has a penetration loss. A dielectric
/// and an ITU material: if it has a thickness. A multilayer: always, but for layers of metal. A perfect conductor
/// never, and the ITU's "metal" never either, whatever its thickness: its skin depth is 5 µm at 1 GHz and 0.5 µm at 100
/// GHz, so that no wall or car body lets anything through that a double could hold.
inline bool transmits(const Material& material) {
  return std::visit([](const auto& model) { return detail::model_transmits(model); }, material.model);
}

inline bool is_foliage(const Material& material) {
  return std::holds_alternative<Foliage>(material.model);
}

/// Whether a surface of this material scatters at all.
inline bool scatters(const Material& material) {
  return material.scattering.coefficient > 0.0 && !is_foliage(material);
}

/// Names of the ITU materials that a material is made of, each once: one for an ITU material, those of the layers of a
/// multilayer, none for the other models. Their tables limit the frequencies at which it may be used.
inline std::vector<std::string> itu_names(const Material& material) {
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

/// Throws std::invalid_argument, naming the material, when a number is not finite or out of range: amplitude outside
/// 0…1, loss < 0, ε' < 1, σ < 0, thickness ≤ 0, ρ² + 10^(−loss/10) > 1, roughness < 0, a name that no table of the ITU
/// holds, no layer at all or one without a thickness, a scattering that validate() refuses, scattering and roughness
/// both.
inline void validate(const Material& material) {
  const detail::MaterialCheck check(material.name);
  std::visit(check, material.model);
  check.require(std::isfinite(material.roughness_rms_m) && material.roughness_rms_m >= 0.0,
                "roughness must be finite and not negative");
  check(material.scattering);
  check.require(material.roughness_rms_m == 0.0 || material.scattering.coefficient == 0.0,
                "roughness and scattering both reduce the mirror; give one of them");
}

}  // namespace dcem
