#pragma once
/// A ray or, with a finite `t_max`, a segment.
#include <concepts>
#include <limits>

#include "dcem/geometry/vector.hpp"

namespace dcem {

/// The points origin + t·direction for t_min ≤ t ≤ t_max. The direction need not be of unit length; a segment from a to
/// b has direction b − a and t_max = 1.
template <std::floating_point Scalar>
struct Ray {
  Vector3<Scalar> origin{0};
  Vector3<Scalar> direction{0};
  Scalar t_min = 0;
  Scalar t_max = std::numeric_limits<Scalar>::infinity();

  Vector3<Scalar> at(Scalar t) const { return origin + t * direction; }
};

template <std::floating_point Scalar>
Ray<Scalar> segment_between(const Vector3<Scalar>& from, const Vector3<Scalar>& to) {
  return {from, to - from, Scalar(0), Scalar(1)};
}

}  // namespace dcem
