/// Places on the Earth, against published values and against what is known of the ellipsoid.
#include "dcem/io/geo_anchor.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <stdexcept>

namespace test_geo_anchor {

using namespace dcem::io;

TEST_CASE("the origin is where it is said to be, and north is up") {
  const GeoPlace place = place_on_earth(GeoOrigin{50.868, 9.708}, 0.0, 0.0);
  CHECK(place.lat_deg == doctest::Approx(50.868).epsilon(1e-13));
  CHECK(place.lon_deg == doctest::Approx(9.708).epsilon(1e-13));
  CHECK(std::abs(place.north_deg) < 1e-12);
}

TEST_CASE("a degree of longitude at the equator, and of latitude, is as long as on WGS 84") {
  // 1852 m are a minute but for some metres: a·π/10800 = 1855.325 m along the equator, 1842.905 m along the meridian
  // there.
  const GeoPlace east = place_on_earth(GeoOrigin{0.0, 10.0}, 1855.3248, 0.0);
  CHECK(east.lon_deg == doctest::Approx(10.0 + 1.0 / 60.0).epsilon(1e-9));
  const GeoPlace north = place_on_earth(GeoOrigin{0.0, 10.0}, 0.0, 1842.9046);
  CHECK(north.lat_deg == doctest::Approx(1.0 / 60.0).epsilon(1e-6).scale(0.0));
}

TEST_CASE("longitudes go on beyond the date line, and y points west of north east of the origin") {
  CHECK(place_on_earth(GeoOrigin{40.0, 179.9999}, 1000.0, 0.0).lon_deg < -179.9);
  CHECK(place_on_earth(GeoOrigin{40.0, 10.0}, 1000.0, 0.0).north_deg < 0.0);
  CHECK(place_on_earth(GeoOrigin{-40.0, 10.0}, 1000.0, 0.0).north_deg > 0.0);
}

TEST_CASE("UTM, in a build that knows it") {
  const UtmFrame frame{32, true, {500000.0, 0.0}};
  if (!knows_utm()) {
    CHECK_THROWS_AS(place_on_earth(frame, 0.0, 0.0), std::logic_error);
    return;
  }
  const GeoPlace middle = place_on_earth(frame, 0.0, 0.0);  // the central meridian of zone 32 on the equator
  CHECK(std::abs(middle.lat_deg) < 1e-12);
  CHECK(middle.lon_deg == doctest::Approx(9.0));
  // The tower in Toronto that guides to UTM take for an example: 17N 630084 m E, 4833438 m N is 43°38′33.24″ N
  // 79°23′13.7″ W.
  const GeoPlace tower = place_on_earth(UtmFrame{17, true, {630000.0, 4833000.0}}, 84.0, 438.0);
  CHECK(std::abs(tower.lat_deg - (43.0 + 38.0 / 60.0 + 33.24 / 3600.0)) < 2e-5);
  CHECK(std::abs(tower.lon_deg + (79.0 + 23.0 / 60.0 + 13.7 / 3600.0)) < 2e-5);
  CHECK_THROWS_AS(place_on_earth(frame, 5e6, 0.0), std::invalid_argument);
}

TEST_CASE("a place leads back to its point of the scene") {
  const auto check = [](const GeoAnchor& anchor) {
    for (const double x_m : {-21000.0, -3.25, 0.0, 740.5, 9000.0}) {
      for (const double y_m : {-15000.0, 0.0, 12.125, 8400.0}) {
        const GeoPlace place = place_on_earth(anchor, x_m, y_m);
        const auto [back_x_m, back_y_m] = point_in_scene_m(anchor, place.lat_deg, place.lon_deg);
        CHECK(std::abs(back_x_m - x_m) < 2e-6);  // what Bowring's formula and UTM's series leave out
        CHECK(std::abs(back_y_m - y_m) < 2e-6);
      }
    }
  };
  check(GeoOrigin{50.868, 9.708});
  check(GeoOrigin{-33.9, 179.99});
  CHECK_THROWS_AS(point_in_scene_m(GeoOrigin{50.0, 9.0}, 10.0, 150.0), std::invalid_argument);
  if (!knows_utm()) return;
  check(UtmFrame{32, true, {543074.33, 5627577.65}});
  CHECK_THROWS_AS(point_in_scene_m(UtmFrame{32, true, {0.0, 0.0}}, 50.0, 150.0), std::invalid_argument);
}

}  // namespace test_geo_anchor
