/// Cells of a map that are sampled at several points: what their mean is, and of what.
#include "dcem/channel/cell_average.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

namespace test_cell_average {

using namespace dcem;

namespace {

RadioMapPoint sample(double power_dbm, double delay_s, std::size_t paths = 1, const std::string& kinds = "R") {
  RadioMapPoint point{Vec3(1.0, 2.0, 3.0), false, {}, kinds};
  LinkStatistics& values = point.statistics;
  values.path_count = paths;
  values.power_dbm = power_dbm + 2.0;
  values.power_incoherent_dbm = power_dbm;
  values.path_gain_db = power_dbm - 28.0;
  values.first_delay_s = delay_s;
  values.mean_delay_s = delay_s;
  values.rms_delay_spread_s = 0.1 * delay_s;
  return point;
}

RadioMapPoint silent() {
  return {Vec3(0.0), false, {}, {}};
}

RadioMapPoint obstructed() {
  return {Vec3(0.0), true, {}, {}};
}

bool same_bits(const std::optional<double>& one, const std::optional<double>& other) {
  return one.has_value() == other.has_value() && (!one || std::memcmp(&*one, &*other, sizeof(double)) == 0);
}

void check_same_values(const RadioMapPoint& one, const RadioMapPoint& other) {
  const LinkStatistics &a = one.statistics, &b = other.statistics;
  CHECK(one.obstructed == other.obstructed);
  CHECK(one.strongest_kinds == other.strongest_kinds);
  CHECK(a.line_of_sight == b.line_of_sight);
  CHECK(a.path_count == b.path_count);
  for (const auto value : {&LinkStatistics::power_dbm, &LinkStatistics::power_incoherent_dbm,
                           &LinkStatistics::path_gain_db, &LinkStatistics::first_delay_s, &LinkStatistics::mean_delay_s,
                           &LinkStatistics::rms_delay_spread_s, &LinkStatistics::power_diffracted_dbm}) {
    CHECK(same_bits(a.*value, b.*value));
  }
}

}  // namespace

TEST_CASE("the mean over a cell of one sample is the sample") {
  RadioMapPoint lit = sample(-61.234567, 3.3e-8, 4, "RD");
  lit.statistics.line_of_sight = true;
  lit.statistics.power_diffracted_dbm = -71.1;
  for (const RadioMapPoint& one : {lit, silent(), obstructed()}) {
    const RadioMapPoint cell = cell_average(Vec3(7, 8, 9), std::vector{one});
    check_same_values(cell, one);
    CHECK(cell.position_m == Vec3(7, 8, 9));
  }
}

TEST_CASE("the mean of equal samples is each of them, and obstructed ones have no say") {
  const RadioMapPoint lit = sample(-61.234567, 0x1p-25);
  for (const std::size_t count : {2U, 3U, 16U}) {
    std::vector<RadioMapPoint> samples(count, lit);
    samples.insert(samples.begin(), obstructed());
    const LinkStatistics mean = cell_average(Vec3(0.0), samples).statistics;
    CHECK(mean.power_dbm == lit.statistics.power_dbm);
    CHECK(mean.power_incoherent_dbm == lit.statistics.power_incoherent_dbm);
    CHECK(mean.mean_delay_s == lit.statistics.mean_delay_s);
    CHECK(mean.rms_delay_spread_s.value() ==
          doctest::Approx(*lit.statistics.rms_delay_spread_s).epsilon(1e-15).scale(0.0));
  }
  CHECK_FALSE(cell_average(Vec3(0.0), std::vector{obstructed(), silent()}).obstructed);
  CHECK(cell_average(Vec3(0.0), std::vector{obstructed(), obstructed()}).obstructed);
}

TEST_CASE("powers are averaged in watts, and where nothing arrives is no power") {
  const auto mean = [](const std::vector<RadioMapPoint>& samples) {
    return cell_average(Vec3(0.0), samples).statistics;
  };
  // (1 + 0.1)/2, (1 + 0)/2 and (1 + 1 + 0 + 0)/4 of -60 dBm.
  CHECK(mean({sample(-60, 1e-8), sample(-70, 1e-8)}).power_incoherent_dbm.value() ==
        doctest::Approx(-60.0 + 10.0 * std::log10(0.55)).epsilon(1e-14));
  CHECK(mean({sample(-60, 1e-8), silent()}).power_dbm.value() ==
        doctest::Approx(-58.0 + 10.0 * std::log10(0.5)).epsilon(1e-14));
  CHECK(mean({sample(-60, 1e-8), silent(), sample(-60, 1e-8), silent()}).path_gain_db.value() ==
        doctest::Approx(-88.0 + 10.0 * std::log10(0.5)).epsilon(1e-14));
  CHECK(mean({sample(-5000, 1e-8), sample(-5000, 1e-8)}).power_incoherent_dbm == -5000.0);  // 0 W in a double
  CHECK_FALSE(mean({silent(), silent()}).power_dbm.has_value());
}

TEST_CASE("delays are weighted by power, and the spread is what receivers have, not how they differ") {
  const LinkStatistics mean =
      cell_average(Vec3(0.0), std::vector{sample(-60, 100e-9), sample(-70, 200e-9), silent()}).statistics;
  CHECK(mean.mean_delay_s.value() == doctest::Approx((100e-9 + 0.1 * 200e-9) / 1.1).epsilon(1e-14).scale(0.0));
  CHECK(mean.rms_delay_spread_s.value() == doctest::Approx((10e-9 + 0.1 * 20e-9) / 1.1).epsilon(1e-14).scale(0.0));
  CHECK(mean.first_delay_s == 100e-9);
}

TEST_CASE("count and kinds are those of the strongest sample, line of sight that of any") {
  std::vector<RadioMapPoint> samples{sample(-80, 1e-8, 9, "D"), sample(-60, 1e-8, 3, "RT"), silent()};
  samples[0].statistics.line_of_sight = true;
  const RadioMapPoint cell = cell_average(Vec3(0.0), samples);
  CHECK(cell.statistics.path_count == 3);
  CHECK(cell.strongest_kinds == "RT");
  CHECK(cell.statistics.line_of_sight);
}

TEST_CASE("samples lie evenly and symmetrically in their cells; one sample is the grid point to the last bit") {
  ReceiverGrid grid{"area", {-0.35, 2.1, 1.5}, {0.7, 2.0}, {3, 2}, {}, {1, 1}};
  const ReceiverGrid same = sample_grid(grid);
  CHECK(same.origin_m == grid.origin_m);
  CHECK(same.spacing_m == grid.spacing_m);
  CHECK(same.count == grid.count);
  grid.samples = {2, 5};
  const ReceiverGrid fine = sample_grid(grid);
  CHECK(fine.columns() == 6);
  CHECK(fine.rows() == 10);
  CHECK(fine.samples_per_cell() == 1);
  CHECK(glm::distance(grid_point_m(fine, 0, 0), Vec3(-0.35 - 0.175, 2.1 - 0.8, 1.5)) < 1e-12);
  CHECK(glm::distance(grid_point_m(fine, 9, 5), Vec3(-0.35 + 1.4 + 0.175, 2.1 + 2.0 + 0.8, 1.5)) < 1e-12);
  // Every cell gets its own samples: those that lie around its grid point, and their mean is that point.
  RadioMap map{fine, "bs", {}};
  std::vector<Vec3> means_m(grid.size(), Vec3(0.0));
  for (std::size_t at = 0; at < fine.size(); ++at) {
    const Vec3 point_m = grid_point_m(fine, at / fine.columns(), at % fine.columns());
    const Vec3 steps = (point_m - grid.origin_m) / Vec3(grid.spacing_m[0], grid.spacing_m[1], 1.0);
    const std::size_t cell =
        static_cast<std::size_t>(std::lround(steps.x)) + 3 * static_cast<std::size_t>(std::lround(steps.y));
    means_m[cell] += point_m / 10.0;
    map.points.push_back(sample(-60.0 - static_cast<double>(cell), 1e-8));
  }
  const RadioMap averages = cell_averages(grid, map);
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    CHECK(averages.points[cell].statistics.power_incoherent_dbm == -60.0 - static_cast<double>(cell));
    CHECK(glm::distance(means_m[cell], grid_point_m(grid, cell / 3, cell % 3)) < 1e-12);
  }
}

TEST_CASE("cells come from the map of their samples and from no other") {
  const ReceiverGrid grid{"area", {0, 0, 1}, {1, 1}, {2, 1}, {}, {2, 1}};
  RadioMap fine{sample_grid(grid), "bs", {sample(-60, 1e-8), silent(), obstructed(), sample(-50, 1e-8)}};
  const RadioMap map = cell_averages(grid, fine);
  CHECK(map.transmitter == "bs");
  REQUIRE(map.points.size() == 2);
  CHECK(map.points[0].statistics.power_incoherent_dbm.value() == doctest::Approx(-60.0 + 10.0 * std::log10(0.5)));
  CHECK(map.points[1].statistics.power_incoherent_dbm == -50.0);
  CHECK(map.points[1].position_m == Vec3(1, 0, 1));
  fine.points.pop_back();
  CHECK_THROWS_AS(cell_averages(grid, fine), std::invalid_argument);
}

}  // namespace test_cell_average
