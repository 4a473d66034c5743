#pragma once
/// Links in a city, chosen at random: a street sees a street, or a mast on a roof sees it.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "dcem/core/random.hpp"
#include "tests/paths/halves/city_triangles.hpp"

namespace dcem::test {

struct CityLink {
  Vec3 from_m, to_m;
};

class CityLinks {
 public:
  CityLinks(const CityTriangles& city, std::uint64_t seed) : city_(city), random_(seed) {}

  /// Both ends over open ground, 10 to 60 m apart.
  CityLink along_street() {
    const Vec3 from_m = street_m(2.0);
    return {from_m, street_near_m(from_m, 10.0, 60.0)};
  }

  /// From 10 to 30 m over open ground to open ground, 30 to 150 m away.
  CityLink from_mast() {
    const Vec3 mast_m = street_m(10.0 + 20.0 * random_.uniform());
    return {mast_m, street_near_m(mast_m, 30.0, 150.0)};
  }

  /// From 2 m over a roof that is at least 8 m high to open ground, 30 to 150 m away.
  CityLink from_roof() {
    while (true) {
      Vec3 mast_m = anywhere_m();
      mast_m.z = highest_m(mast_m) + 2.0;
      if (mast_m.z >= 10.0 && is_off_everything(mast_m)) return {mast_m, street_near_m(mast_m, 30.0, 150.0)};
    }
  }

 private:
  /// In the middle half of the city, at height 0.
  Vec3 anywhere_m() {
    const double along = 0.25 + 0.5 * random_.uniform(), across = 0.25 + 0.5 * random_.uniform();
    const Vec3 size_m = city_.high_m() - city_.low_m();
    return {city_.low_m().x + along * size_m.x, city_.low_m().y + across * size_m.y, 0.0};
  }

  Vec3 street_m(double height_m) {
    while (true) {
      const Vec3 place_m = anywhere_m() + Vec3(0, 0, height_m);
      if (is_street(place_m)) return place_m;
    }
  }

  Vec3 street_near_m(const Vec3& from_m, double nearest_m, double farthest_m) {
    while (true) {
      const double turn = 6.283 * random_.uniform();
      const double away_m = nearest_m + (farthest_m - nearest_m) * random_.uniform();
      const Vec3 place_m(from_m.x + away_m * std::cos(turn), from_m.y + away_m * std::sin(turn), 1.5);
      if (is_street(place_m)) return place_m;
    }
  }

  bool is_street(const Vec3& place_m) const { return highest_m(place_m) < 0.5 && is_off_everything(place_m); }

  /// Devices that touch a facet do not see it: there are none of them here.
  bool is_off_everything(const Vec3& place_m) const {
    return std::none_of(city_.triangles().begin(), city_.triangles().end(),
                        [&](const FlatTriangle& triangle) { return triangle.distance_m(place_m) < 0.2; });
  }

  /// Where a plumb line from the sky ends.
  double highest_m(const Vec3& place_m) const {
    double height_m = 0.0;
    for (const FlatTriangle& triangle : city_.triangles()) {
      if (std::abs(triangle.normal.z) < 0.1 || place_m.x < triangle.low_m.x || place_m.x > triangle.high_m.x ||
          place_m.y < triangle.low_m.y || place_m.y > triangle.high_m.y) {
        continue;
      }
      const Vec3 floor_m(place_m.x, place_m.y, 0.0);
      const Vec3 there_m(place_m.x, place_m.y, -triangle.above_m(floor_m) / triangle.normal.z);
      if (triangle.inside_m(there_m) >= 0.0) height_m = std::max(height_m, there_m.z);
    }
    return height_m;
  }

  const CityTriangles& city_;
  RandomStream random_;
};

}  // namespace dcem::test
