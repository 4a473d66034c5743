#pragma once
/// Vector types. Lengths, points of interaction and phases are always double; only trees may be float.
#include <cmath>
#include <concepts>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace dcem {

template <std::floating_point Scalar>
using Vector3 = glm::vec<3, Scalar, glm::defaultp>;

using Vec2 = glm::vec<2, double, glm::defaultp>;
using Vec3 = Vector3<double>;
using Mat3 = glm::mat<3, 3, double, glm::defaultp>;

inline bool is_finite(const Vec3& vector) {
  return std::isfinite(vector.x) && std::isfinite(vector.y) && std::isfinite(vector.z);
}

/// Lexicographic order, x first: the order in which points are sorted wherever order must not depend on the input's.
inline bool lexicographic_less(const Vec3& a, const Vec3& b) {
  if (a.x != b.x) return a.x < b.x;
  if (a.y != b.y) return a.y < b.y;
  return a.z < b.z;
}

}  // namespace dcem
