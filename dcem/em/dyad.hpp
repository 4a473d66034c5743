#pragma once
/// Reflection and transmission of a field given as a Cartesian vector: nothing depends on a basis chosen elsewhere.
///   e⊥ = k × n/|k × n|,  e∥ = e⊥ × k,  k_r = k − 2(k·n)n,  e∥r = e⊥ × k_r
///   E_r = R_te (E·e⊥) e⊥ + R_tm (E·e∥) e∥r,   E_t = T_te (E·e⊥) e⊥ + T_tm (E·e∥) e∥.
/// With the signs of em/surface/fresnel.hpp a perfect conductor gives E_r = 2(n·E)n − E. Both are the same for n and
/// −n.
#include "dcem/em/complex.hpp"
#include "dcem/em/surface/fresnel.hpp"
#include "dcem/geometry/plane.hpp"

namespace dcem {

namespace detail {

/// e⊥ for unit vectors. At normal incidence every direction across the ray will do, because there R_te = −R_tm.
inline Vec3 perpendicular_direction(const Vec3& propagation, const Vec3& normal) {
  const Vec3 cross = glm::cross(propagation, normal);
  const double sine = glm::length(cross);
  if (sine < 1e-9) return plane_basis(propagation).u;
  const Vec3 direction = cross / sine;
  // Close to normal incidence the cross product is known to few digits; what matters is that it stays across the ray.
  return glm::normalize(direction - glm::dot(direction, propagation) * propagation);
}

}  // namespace detail

/// Propagation direction after reflection at a plane with unit normal `normal`.
inline Vec3 reflected_direction(const Vec3& propagation, const Vec3& normal) {
  return propagation - 2.0 * glm::dot(propagation, normal) * normal;
}

/// e⊥, e∥ and e∥r of a ray and a surface.
struct IncidenceBasis {
  Vec3 perpendicular, parallel, parallel_after;
};

/// `propagation` and `normal` are of unit length, the normal of either sign.
inline IncidenceBasis incidence_basis(const Vec3& propagation, const Vec3& normal) {
  const Vec3 perpendicular = detail::perpendicular_direction(propagation, normal);
  return {perpendicular, glm::cross(perpendicular, propagation),
          glm::cross(perpendicular, reflected_direction(propagation, normal))};
}

/// Field just after reflection, from the field before in the basis of its ray and the surface.
inline ComplexVector3 reflect(const ComplexVector3& field, const IncidenceBasis& basis,
                              const PolarizedCoefficients& reflection) {
  return scaled(basis.perpendicular, reflection.te * dot(field, basis.perpendicular)) +
         scaled(basis.parallel_after, reflection.tm * dot(field, basis.parallel));
}

/// Field just after crossing a thin sheet; the direction stays.
inline ComplexVector3 transmit(const ComplexVector3& field, const IncidenceBasis& basis,
                               const PolarizedCoefficients& transmission) {
  return scaled(basis.perpendicular, transmission.te * dot(field, basis.perpendicular)) +
         scaled(basis.parallel, transmission.tm * dot(field, basis.parallel));
}

/// Field just after reflection. `field` is transverse to the unit vector `propagation` of the incident ray, `normal` is
/// of unit length and either sign.
inline ComplexVector3 reflect(const ComplexVector3& field, const Vec3& propagation, const Vec3& normal,
                              const PolarizedCoefficients& reflection) {
  return reflect(field, incidence_basis(propagation, normal), reflection);
}

/// Field just after crossing a thin sheet. Arguments as for reflect().
inline ComplexVector3 transmit(const ComplexVector3& field, const Vec3& propagation, const Vec3& normal,
                               const PolarizedCoefficients& transmission) {
  return transmit(field, incidence_basis(propagation, normal), transmission);
}

}  // namespace dcem
