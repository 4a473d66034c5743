#include <doctest/doctest.h>

#include <limits>

#include "dcem/em/antenna/antenna.hpp"

namespace test_antenna {

using namespace dcem;

namespace {
const Vec3 direction(0.6, 0.0, 0.8);
}

TEST_CASE("an isotropic antenna has unit power in every direction, times its gain") {
  const Antenna plain;
  CHECK(plain.jones(direction) == JonesVector{1.0, 0.0});  // 0 dBi, vertical
  for (const auto kind : {PolarizationKind::horizontal, PolarizationKind::slant, PolarizationKind::right_circular}) {
    const Antenna antenna{20.0, {kind, 0.7}};
    CHECK(antenna.port_count() == 1);
    for (const Vec3& d : {direction, Vec3(0, 0, 1), Vec3(-1, 0, 0)}) {
      const JonesVector jones = antenna.jones(d);
      // 20 dBi is a factor of 100 in power; rounding of a few operations.
      CHECK(std::norm(jones[0]) + std::norm(jones[1]) == doctest::Approx(100.0).epsilon(1e-14));
    }
  }
}

TEST_CASE("a dual antenna has two ports, V and H, of the full gain each") {
  const Antenna dual{20.0, {PolarizationKind::dual, 0.0}};
  CHECK(dual.is_dual());
  REQUIRE(dual.port_count() == 2);
  CHECK(dual.port_jones(direction, 0) == JonesVector{10.0, 0.0});
  CHECK(dual.port_jones(direction, 1) == JonesVector{0.0, 10.0});
  CHECK_THROWS_AS(dual.jones(direction), InvariantError);
  CHECK_THROWS_AS(dual.port_jones(direction, 2), InvariantError);
  CHECK_THROWS_AS(Antenna{}.port_jones(direction, 1), InvariantError);
}

TEST_CASE("values that are not finite are refused") {
  CHECK_NOTHROW(validate(Antenna{-3.0, {PolarizationKind::slant, 1.0}}));
  CHECK_THROWS_AS(validate(Antenna{std::numeric_limits<double>::infinity(), {}}), std::invalid_argument);
  CHECK_THROWS_AS(validate(Antenna{0.0, {PolarizationKind::slant, std::nan("")}}), std::invalid_argument);
}

}  // namespace test_antenna
