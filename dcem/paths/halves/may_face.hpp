#pragma once
/// Which directions away from an edge lie in its exterior, without an arc tangent for most of them.
#include <cmath>

#include "dcem/core/constants.hpp"
#include "dcem/geometry/wedge.hpp"

namespace dcem {

namespace detail {

/// The angle between a way and its part `along` where `across` is the other, both positive, to within 0.004 rad:
/// arctan x ≈ π/4 x + 0.273 x (1 − x) (Rajan et al., "Efficient approximations for the arctangent function", IEEE
/// Signal Processing Magazine 23 (3), 2006, eq. 9).
inline double rough_angle_rad(double along, double across) {
  const bool is_steep = across > along;
  const double slope = is_steep ? along / across : across / along;
  const double angle_rad = slope * (0.25 * pi + 0.273 * (1.0 - slope));
  return is_steep ? 0.5 * pi - angle_rad : angle_rad;
}

}  // namespace detail

/// Whether a direction away from an edge may lie in its exterior; at grazing the solver decides.
inline bool may_face(const Wedge& wedge, const Vec3& away_m) {
  const double up = glm::dot(away_m, wedge.normal);
  if (up >= 0.0) return true;  // the exterior has more than half a turn
  const double along = glm::dot(away_m, wedge.tangent), off_rad = detail::rough_angle_rad(std::abs(along), -up);
  const double rough_rad = along > 0.0 ? 2.0 * pi - off_rad : pi + off_rad;
  if (rough_rad < wedge.exterior_angle_rad - 0.005) return true;
  if (rough_rad > wedge.exterior_angle_rad + 0.005 && rough_rad < 2.0 * pi - 0.005) return false;
  const double azimuth = azimuth_rad(wedge, away_m);
  return azimuth <= wedge.exterior_angle_rad + 1e-6 || azimuth >= 2.0 * pi - 1e-6;
}

}  // namespace dcem
