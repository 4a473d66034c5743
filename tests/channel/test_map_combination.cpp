/// Best server and SINR, by hand.
#include "dcem/channel/map_combination.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "dcem/channel/thermal_noise.hpp"

namespace test_map_combination {

using namespace dcem;

namespace {

/// One map over a row of points; NaN: nothing arrives.
RadioMap row_map(const std::string& id, const std::vector<double>& powers_dbm) {
  RadioMap map{ReceiverGrid{"row", {0, 0, 1.5}, {1, 1}, {powers_dbm.size(), 1}, {}}, id, {}};
  for (std::size_t column = 0; column < powers_dbm.size(); ++column) {
    RadioMapPoint point{grid_point_m(map.grid(), 0, column), false, {}, {}};
    if (!std::isnan(powers_dbm[column])) {
      point.statistics.power_incoherent_dbm = powers_dbm[column];
      point.statistics.power_dbm = powers_dbm[column] - 1.0;
    }
    map.points.push_back(point);
  }
  return map;
}

const double nothing = std::nan("");

}  // namespace

TEST_CASE("noise of 1 MHz at 290 K is -113.98 dBm, and a noise figure adds to it") {
  // k T B = 1.380649e-23 · 290 · 1e6 = 4.0038821e-15 W, the "-174 dBm per hertz" of the textbooks.
  CHECK(noise_power_dbm({1e6, 0.0, 290.0}) == doctest::Approx(10.0 * std::log10(4.0038821e-12)).epsilon(1e-12));
  CHECK(noise_power_dbm({1.0, 0.0, 290.0}) == doctest::Approx(-173.975).epsilon(1e-5));
  CHECK(noise_power_dbm({20e6, 9.0, 290.0}) == doctest::Approx(-113.9752 + 13.0103 + 9.0).epsilon(1e-6));
  CHECK_THROWS_AS(validate(NoiseSettings{0.0, 0.0, 290.0}), std::invalid_argument);
  CHECK_THROWS_AS(validate(NoiseSettings{1e6, -1.0, 290.0}), std::invalid_argument);
  CHECK_THROWS_AS(validate(NoiseSettings{1e6, 0.0, std::nan("")}), std::invalid_argument);
}

TEST_CASE("the strongest transmitter serves; of equals the first; where nothing arrives none") {
  const std::vector<RadioMap> maps{row_map("a", {-60, -90, -70, nothing}), row_map("b", {-80, -50, -70, nothing})};
  const CombinedMap map = combine_maps(maps);
  CHECK(map.transmitters == std::vector<std::string>{"a", "b"});
  CHECK(map.points[0].server == 0U);
  CHECK(map.points[1].server == 1U);
  CHECK(map.points[2].server == 0U);
  CHECK_FALSE(map.points[3].server.has_value());
  CHECK_FALSE(map.points[3].sinr_db.has_value());
  CHECK(map.points[1].power_incoherent_dbm == -50.0);
  CHECK(map.points[1].power_dbm == -51.0);
  CHECK(map.points[0].sinr_db.value() == doctest::Approx(20.0));
  CHECK(map.points[2].sinr_db.value() == doctest::Approx(0.0));
  CHECK_FALSE(map.points[0].snr_db.has_value());
}

TEST_CASE("SINR weighs the server against the others and the noise together") {
  const std::vector<RadioMap> maps{row_map("a", {-60, -60}), row_map("b", {-70, nothing}),
                                   row_map("c", {-70, nothing})};
  const CombinedMap map = combine_maps(maps, -70.0);
  // 1 / (0.1 + 0.1 + 0.1), and 1 / 0.1 against the noise alone.
  CHECK(map.points[0].sinr_db.value() == doctest::Approx(10.0 * std::log10(1.0 / 0.3)).epsilon(1e-12));
  CHECK(map.points[0].snr_db.value() == doctest::Approx(10.0).epsilon(1e-12));
  CHECK(map.points[1].sinr_db.value() == doctest::Approx(10.0).epsilon(1e-12));
}

TEST_CASE("one transmitter without noise has a server and no ratio") {
  const std::vector<RadioMap> maps{row_map("a", {-60})};
  const CombinedMap map = combine_maps(maps);
  CHECK(map.points[0].server == 0U);
  CHECK_FALSE(map.points[0].sinr_db.has_value());
}

TEST_CASE("powers far below and above what a double holds in watts have a finite ratio") {
  const std::vector<RadioMap> maps{row_map("a", {-5000, 5000}), row_map("b", {-5010, 4000})};
  const CombinedMap map = combine_maps(maps);
  CHECK(map.points[0].sinr_db.value() == doctest::Approx(10.0));
  CHECK(map.points[1].sinr_db.value() == doctest::Approx(1000.0));
}

TEST_CASE("obstructed points stay obstructed, and maps of different grids do not combine") {
  std::vector<RadioMap> maps{row_map("a", {nothing, -60}), row_map("b", {nothing, -70})};
  for (RadioMap& map : maps) map.points[0].obstructed = true;
  CHECK(combine_maps(maps).points[0].obstructed);
  CHECK_FALSE(combine_maps(maps).points[1].obstructed);
  maps[1].points[0].position_m.x = 0.5;
  CHECK_THROWS_AS(combine_maps(maps), std::invalid_argument);
  CHECK_THROWS_AS(combine_maps({}), std::invalid_argument);
}

}  // namespace test_map_combination
