#pragma once
/// Points side by side, or all points between them, that look together.
#include <vector>

#include "tests/paths/small_scenes.hpp"

namespace dcem::test {

struct PointGroup {
  std::vector<Vec3> points_m;
  bool is_body = false;  ///< all points between them look

  Vec3 some_point_m(Draw& draw) const {
    if (!is_body || draw.below(4) == 0) return points_m[draw.below(points_m.size())];
    std::vector<double> shares(points_m.size());
    double sum = 0.0;
    for (double& share : shares) sum += share = draw.between(0.0, 1.0);
    Vec3 point_m(0.0);
    for (std::size_t corner = 0; corner < shares.size(); ++corner) point_m += shares[corner] / sum * points_m[corner];
    return point_m;
  }
};

/// All points of a box, which may be flat.
inline PointGroup points_of_box(const Vec3& middle_m, const Vec3& half_m) {
  PointGroup group;
  group.is_body = true;
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      group.points_m.push_back(middle_m + half_m * Vec3(x, y, -1.0));
      if (half_m.z > 0.0) group.points_m.push_back(middle_m + half_m * Vec3(x, y, 1.0));
    }
  }
  return group;
}

}  // namespace dcem::test
