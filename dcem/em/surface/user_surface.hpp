#pragma once
/// Surfaces of the caller's own, side by side with the built-in ones: one class, and a material that names it.
#include <concepts>
#include <memory>
#include <utility>

#include "dcem/em/surface/material.hpp"
#include "dcem/em/surface/slab.hpp"

namespace dcem {

/// What a surface does to a wave. Called from several threads at once; the same question must get the same answer.
class UserSurfaceModel {
 public:
  virtual ~UserSurfaceModel() = default;

  /// Coefficients of the smooth surface for a wave under `cos_incidence` = |k·n| in 0…1; signs and phase reference as
  /// in em/surface/fresnel.hpp and slab.hpp. The material's roughness or scattering is applied to the reflection
  /// afterwards. Every coefficient finite; transmission zero where the surface is opaque.
  virtual SurfaceResponse response(double frequency_hz, double cos_incidence) const = 0;
};

/// A material's model made of an object of a class derived from `UserSurfaceModel`. `transmits`: paths may cross it.
template <std::derived_from<UserSurfaceModel> Model>
UserSurface user_surface(Model model, bool transmits = false) {
  return {std::make_shared<const Model>(std::move(model)), transmits};
}

}  // namespace dcem
