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

/// Field just after reflection. `field` is transverse to the unit vector `propagation` of the incident ray, `normal` is
/// of unit length and either sign.
inline ComplexVector3 reflect(const ComplexVector3& field, const Vec3& propagation, const Vec3& normal,
                              const PolarizedCoefficients& reflection) {
  const Vec3 perpendicular = detail::perpendicular_direction(propagation, normal);
  const Vec3 parallel = glm::cross(perpendicular, propagation);
  const Vec3 parallel_after = glm::cross(perpendicular, reflected_direction(propagation, normal));
  return scaled(perpendicular, reflection.te * dot(field, perpendicular)) +
         scaled(parallel_after, reflection.tm * dot(field, parallel));
}

/// Field just after crossing a thin sheet; the direction stays. Arguments as for reflect().
inline ComplexVector3 transmit(const ComplexVector3& field, const Vec3& propagation, const Vec3& normal,
                               const PolarizedCoefficients& transmission) {
  const Vec3 perpendicular = detail::perpendicular_direction(propagation, normal);
  const Vec3 parallel = glm::cross(perpendicular, propagation);
  return scaled(perpendicular, transmission.te * dot(field, perpendicular)) +
         scaled(parallel, transmission.tm * dot(field, parallel));
}

}  // namespace dcem
