#pragma once
/// Where the field gets its reflection and transmission coefficients from: a concept for models of the user's own, and
/// the table of the built-in materials.
#include <concepts>
#include <cstddef>
#include <optional>
#include <variant>
#include <vector>

#include "dcem/core/ids.hpp"
#include "dcem/em/surface/itu_settings.hpp"
#include "dcem/em/surface/material.hpp"
#include "dcem/em/surface/multilayer.hpp"
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

  PreparedSurface prepare(const PerfectConductor&) const;
  PreparedSurface prepare(const ConstantReflection& model) const;
  PreparedSurface prepare(const Dielectric& model) const;
  PreparedSurface prepare(const ItuMaterial& model) const;
  PreparedSurface prepare(const Multilayer& model) const;
  PreparedSurface prepare(const Foliage&) const;
  PreparedSurface prepare(const UserSurface& surface) const;
  void prepare_all();
  static void check_own(const Material& material, const OwnModel& own);
  bool extrapolates(const Material& material) const;
  double phase_spread_at_normal_rad(const Material& material) const;
  static bool representable(const PreparedSurface& surface);

  /// What the roughness or the scattering of a material leaves of its mirror.
  double specular_factor(MaterialId material, double cos_incidence) const;
  SurfaceResponse smooth_response(MaterialId material, double cos_incidence) const;

  static SurfaceResponse respond(const SurfaceResponse& constant, double) { return constant; }
  static SurfaceResponse respond(const HalfSpace& half_space, double cos_incidence);
  static SurfaceResponse respond(const OwnModel& own, double cos_incidence);
  static SurfaceResponse respond(const Slab& slab, double cos_incidence);
  static SurfaceResponse respond(const Stack& stack, double cos_incidence);

  std::vector<Material> materials_;
  double frequency_hz_;
  ItuSettings itu_;
  std::vector<PreparedSurface> surfaces_;
  std::vector<double> phase_spreads_at_normal_rad_;  // of the roughness; 0: smooth
  std::vector<MaterialId> extrapolated_;
};

static_assert(SurfaceModel<MaterialTable> && ScatteringModel<MaterialTable>);

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/em/surface/material_table_bodies.hpp"
#endif
