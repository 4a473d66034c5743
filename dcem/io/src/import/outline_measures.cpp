#include <cmath>

#include "dcem/io/src/import/outlines.hpp"

namespace dcem::io {

namespace {

double perimeter_m(const Ring& ring) {
  double sum_m = 0.0;
  for (std::size_t index = 0; index < ring.size(); ++index) {
    sum_m += glm::length(ring[(index + 1) % ring.size()] - ring[index]);
  }
  return sum_m;
}

/// Whether a ray from the point towards +x meets the ring an odd number of times.
bool is_around(const Ring& ring, const Vec2& point_m) {
  bool inside = false;
  for (std::size_t index = 0; index < ring.size(); ++index) {
    const Vec2 &a = ring[index], &b = ring[(index + 1) % ring.size()];
    if ((a.y > point_m.y) == (b.y > point_m.y)) continue;
    if (point_m.x < a.x + (b.x - a.x) * (point_m.y - a.y) / (b.y - a.y)) inside = !inside;
  }
  return inside;
}

}  // namespace

double signed_area_m2(const Ring& ring) {
  double twice_m2 = 0.0;  // relative to a corner: far from the origin the products lose their digits
  for (std::size_t index = 1; index + 1 < ring.size(); ++index) {
    const Vec2 a = ring[index] - ring[0], b = ring[index + 1] - ring[0];
    twice_m2 += a.x * b.y - a.y * b.x;
  }
  return 0.5 * twice_m2;
}

double area_m2(const Area& area) {
  double sum_m2 = std::abs(signed_area_m2(area.outer));
  for (const Ring& hole : area.holes) sum_m2 -= std::abs(signed_area_m2(hole));
  return sum_m2;
}

double area_m2(const Areas& areas) {
  double sum_m2 = 0.0;
  for (const Area& area : areas) sum_m2 += area_m2(area);
  return sum_m2;
}

double perimeter_m(const Area& area) {
  double sum_m = perimeter_m(area.outer);
  for (const Ring& hole : area.holes) sum_m += perimeter_m(hole);
  return sum_m;
}

bool holds_point(const Area& area, const Vec2& point_m) {
  if (!is_around(area.outer, point_m)) return false;
  for (const Ring& hole : area.holes) {
    if (is_around(hole, point_m)) return false;
  }
  return true;
}

}  // namespace dcem::io
