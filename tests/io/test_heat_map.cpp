#include "dcem/io/heat_map.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "dcem/io/src/pictures/colour_map.hpp"
#include "dcem/io/src/pictures/contours.hpp"
#include "dcem/io/src/pictures/heat_map_plan.hpp"
#include "tests/io/drawing_needed.hpp"
#include "tests/io/picture_checks.hpp"
#include "tests/io/png_reader.hpp"
#include "tests/io/temporary_folder.hpp"

namespace test_heat_map {

using namespace dcem::io;
using dcem::test::Png;
using dcem::test::TemporaryFolder;

namespace {

constexpr double no_value = std::numeric_limits<double>::quiet_NaN();
constexpr Colour no_value_ground{243, 243, 243};

// Entries of the original viridis table (Matplotlib 3.8.4, _cm_listed.py, times 255 and rounded), none of them one of
// the control points of the code.
struct TableEntry {
  int index;  // of 255
  std::array<int, 3> colour;
};
constexpr std::array<TableEntry, 9> viridis_table{{{8, {71, 13, 96}},
                                                   {40, {69, 55, 129}},
                                                   {77, {52, 96, 141}},
                                                   {100, {42, 118, 142}},
                                                   {127, {33, 144, 141}},
                                                   {128, {33, 145, 140}},
                                                   {160, {40, 174, 128}},
                                                   {200, {112, 207, 87}},
                                                   {222, {168, 219, 52}}}};

int difference(Colour colour, const std::array<int, 3>& other) {
  return std::max(
      {std::abs(colour.red - other[0]), std::abs(colour.green - other[1]), std::abs(colour.blue - other[2])});
}

// CIE 1976 lightness L* of an sRGB colour (IEC 61966-2-1 for the linear parts, D65 white).
double lightness(Colour colour) {
  const auto linear = [](std::uint8_t channel) {
    const double share = channel / 255.0;
    return share <= 0.04045 ? share / 12.92 : std::pow((share + 0.055) / 1.055, 2.4);
  };
  const double luminance = 0.2126 * linear(colour.red) + 0.7152 * linear(colour.green) + 0.0722 * linear(colour.blue);
  return luminance > 216.0 / 24389.0 ? 116.0 * std::cbrt(luminance) - 16.0 : luminance * 24389.0 / 27.0;
}

HeatMap plain_map(std::size_t columns, std::size_t rows, double value) {
  HeatMap map;
  map.title = "test";
  map.columns = columns;
  map.rows = rows;
  map.values.assign(columns * rows, value);
  return map;
}

// A room of 20 m × 12 m, points every half metre, levels that rise to the upper right.
HeatMap room() {
  HeatMap map = plain_map(40, 24, 0.0);
  map.spacing_x_m = 0.5;
  map.spacing_y_m = 0.5;
  map.origin_x_m = 0.25;
  map.origin_y_m = 0.25;
  for (std::size_t i = 0; i < map.values.size(); ++i) {
    map.values[i] = -100.0 + static_cast<double>(i % 40) + static_cast<double>(i / 40);
  }
  return map;
}

Png drawn(const HeatMap& map) {
  const TemporaryFolder folder;
  write_heat_map(map, folder / "map.png");
  CHECK(folder.names() == std::vector<std::string>{"map.png"});
  return dcem::test::read_png(folder / "map.png");
}

// The pixels of one cell, without those at its rim.
PixelRect cell_area(const HeatMap& map, const HeatMapLayout& layout, std::size_t column, std::size_t row) {
  const double x_m = map.origin_x_m + static_cast<double>(column) * map.spacing_x_m;
  const double y_m = map.origin_y_m + static_cast<double>(row) * map.spacing_y_m;
  const PixelPoint low = layout.point(x_m - 0.5 * map.spacing_x_m, y_m + 0.5 * map.spacing_y_m);
  const PixelPoint high = layout.point(x_m + 0.5 * map.spacing_x_m, y_m - 0.5 * map.spacing_y_m);
  const int x = static_cast<int>(std::lround(low.x));
  const int y = static_cast<int>(std::lround(low.y));
  return {x, y, static_cast<int>(std::lround(high.x)) - x, static_cast<int>(std::lround(high.y)) - y};
}

Colour colour_at(const Png& png, const HeatMapLayout& layout, double x_m, double y_m) {
  const PixelPoint place = layout.point(x_m, y_m);
  return png.at(static_cast<int>(place.x), static_cast<int>(place.y));
}

long count_colour(const Png& png, const PixelRect& area, Colour colour) {
  long count = 0;
  for (int y = area.y; y < area.bottom(); ++y) {
    for (int x = area.x; x < area.right(); ++x) count += png.at(x, y) == colour ? 1 : 0;
  }
  return count;
}

// Groups of ink along a row of labels, at least `gap_px` blank columns apart.
int groups_of_ink(const Png& png, const PixelRect& strip, int gap_px) {
  int groups = 0;
  int blank = gap_px;
  for (int x = strip.x; x < strip.right(); ++x) {
    bool ink = false;
    for (int y = strip.y; y < strip.bottom(); ++y) ink = ink || lightness(png.at(x, y)) < 50.0;
    if (ink && blank >= gap_px) ++groups;
    blank = ink ? 0 : blank + 1;
  }
  return groups;
}

}  // namespace

TEST_CASE("the colours are those of the viridis table") {
  for (const TableEntry& entry : viridis_table) {
    // Straight lines between every fifteenth entry of the table stray from it by at most 4.9, and rounding adds a half.
    CHECK(difference(viridis(entry.index / 255.0), entry.colour) <= 5);
  }
  CHECK(viridis(0.0) == Colour{68, 1, 84});
  CHECK(viridis(1.0) == Colour{253, 231, 37});
  CHECK(viridis(-3.0) == viridis(0.0));
  CHECK(viridis(1e9) == viridis(1.0));
}

TEST_CASE("lightness grows with the value, in even steps") {
  for (int i = 1; i <= 64; ++i) {
    const double step = lightness(viridis(i / 64.0)) - lightness(viridis((i - 1) / 64.0));
    // L* runs from about 15 to 91: 1.2 per step. Viridis is even to about a third, 8-bit channels add some 0.2.
    CHECK(step > 0.6);
    CHECK(step < 1.8);
  }
}

TEST_CASE("each cell is one block in the colour of its value") {
  DCEM_NEEDS_DRAWING();
  HeatMap map = plain_map(3, 3, 0.0);
  map.range = ValueRange{-100.0, -49.0};
  for (std::size_t i = 0; i < 9; ++i) map.values[i] = -100.0 + 51.0 * viridis_table[i].index / 255.0;
  const HeatMapLayout layout = heat_map_layout(map);
  const Png png = drawn(map);
  for (std::size_t i = 0; i < 9; ++i) {
    const PixelRect area = cell_area(map, layout, i % 3, i / 3);
    REQUIRE(area.width > 100);
    CHECK(area.width == area.height);
    const Colour colour = png.at(area.x, area.y);
    CHECK(difference(colour, viridis_table[i].colour) <= 5);  // as in the test of the table
    for (int y = area.y; y < area.bottom(); ++y) {
      for (int x = area.x; x < area.right(); ++x) REQUIRE(png.at(x, y) == colour);
    }
  }
}

TEST_CASE("values beyond the range take its end colours, and the bar says so by a tip") {
  DCEM_NEEDS_DRAWING();
  HeatMap map = plain_map(2, 1, -60.0);
  map.range = ValueRange{-70.0, -50.0};
  const HeatMapLayout layout = heat_map_layout(map);
  const int middle = layout.bar.x + layout.bar.width / 2;
  const Png without = drawn(map);
  CHECK(without.at(middle, layout.bar.bottom() + 10) == Colour{255, 255, 255});
  CHECK(without.at(middle, layout.bar.y - 10) == Colour{255, 255, 255});
  map.values = {-300.0, 20.0};
  const Png png = drawn(map);
  CHECK(colour_at(png, layout, 0.0, 0.0) == viridis(0.0));
  CHECK(colour_at(png, layout, 1.0, 0.0) == viridis(1.0));
  CHECK(png.at(middle, layout.bar.bottom() + 10) == viridis(0.0));
  CHECK(png.at(middle, layout.bar.y - 10) == viridis(1.0));
}

TEST_CASE("the colour bar runs from the lowest colour to the highest without a step back") {
  DCEM_NEEDS_DRAWING();
  const HeatMap map = room();
  const HeatMapLayout layout = heat_map_layout(map);
  const Png png = drawn(map);
  const int x = layout.bar.x + layout.bar.width / 2;
  for (int y = layout.bar.y + 1; y < layout.bar.bottom(); ++y) {
    // Rounding of a channel to 8 bits can take back at most 0.3 of lightness.
    CHECK(lightness(png.at(x, y)) <= lightness(png.at(x, y - 1)) + 0.3);
  }
  CHECK(difference(png.at(x, layout.bar.y), {253, 231, 37}) <= 2);
  CHECK(difference(png.at(x, layout.bar.bottom() - 1), {68, 1, 84}) <= 2);
}

TEST_CASE("metres are as long upwards as sideways, and cells are whole pixels") {
  const HeatMap map = room();
  const HeatMapLayout layout = heat_map_layout(map);
  CHECK(layout.to_scale);
  CHECK(layout.plot.width == 1280);  // 40 cells of 32 pixels
  CHECK(layout.plot.height == 768);
  CHECK(layout.horizontal_px_per_m == layout.vertical_px_per_m);
  CHECK(std::max(layout.width_px, layout.height_px) <= 1800);
  HeatMap oblong = plain_map(10, 30, -60.0);
  oblong.spacing_x_m = 0.73;
  oblong.spacing_y_m = 0.31;
  const HeatMapLayout other = heat_map_layout(oblong);
  // The sides are rounded to whole pixels, half a pixel of some 600 to 800.
  CHECK(other.horizontal_px_per_m == doctest::Approx(other.vertical_px_per_m).epsilon(0.001));
}

TEST_CASE("empty cells are grey, cells in objects are hatched, and the legend tells of what occurs") {
  DCEM_NEEDS_DRAWING();
  HeatMap map = room();
  CHECK(count_colour(drawn(map), heat_map_layout(map).plot, no_value_ground) == 0);
  const int plain_height = heat_map_layout(map).height_px;
  map.values[5 * 40 + 7] = no_value;
  map.values[6 * 40 + 7] = -std::numeric_limits<double>::infinity();
  const HeatMapLayout layout = heat_map_layout(map);
  CHECK(layout.height_px > plain_height);
  const Png grey = drawn(map);
  CHECK(colour_at(grey, layout, 3.75, 2.75) == no_value_ground);
  CHECK(colour_at(grey, layout, 3.75, 3.25) == no_value_ground);
  CHECK(count_colour(grey, layout.plot, no_value_ground) == 2 * 32 * 32);

  map.hatched.assign(map.values.size(), 0);
  map.hatched[10 * 40 + 20] = 1;
  const Png hatched = drawn(map);
  const PixelRect area = cell_area(map, heat_map_layout(map), 20, 10);
  double ink = 0.0;
  for (int y = area.y; y < area.bottom(); ++y) {
    for (int x = area.x; x < area.right(); ++x) {
      const Colour colour = hatched.at(x, y);
      REQUIRE((colour.red == colour.green && colour.green == colour.blue));
      ink += (245.0 - colour.red) / (245.0 - 105.0);
    }
  }
  REQUIRE(area.width == 32);
  CHECK(ink / (32.0 * 32.0) ==
        doctest::Approx(2.0 / 13.0).epsilon(0.2).scale(0.0));         // lines of 2 px, every 13 px; cut at the rim
  CHECK(colour_at(hatched, layout, 10.75, 5.25) != no_value_ground);  // the neighbour keeps its colour
}

TEST_CASE("a value in a hatched cell counts for nothing") {
  HeatMap map = plain_map(10, 10, -60.0);
  map.hatched.assign(100, 0);
  map.hatched[3] = 1;
  map.values[3] = 500.0;
  CHECK(default_value_range(map)->high <= -55.0);
}

TEST_CASE("walls are dark lines within the plot") {
  DCEM_NEEDS_DRAWING();
  HeatMap map = room();
  map.walls_m = {{-100.0, 6.0, 100.0, 6.0}, {4.0, 1.0, 9.0, 4.0}};
  const HeatMapLayout layout = heat_map_layout(map);
  const Png png = drawn(map);
  for (double x_m = 0.1; x_m < 20.0; x_m += 0.7) {
    const PixelPoint place = layout.point(x_m, 6.0);
    CHECK(lightness(png.at(static_cast<int>(place.x), static_cast<int>(std::lround(place.y)))) < 10.0);
  }
  // Of the pixels around a point of a slanting wall at least one is covered in full.
  double darkest = 100.0;
  const PixelPoint slanting = layout.point(6.5, 2.5);
  for (int i = 0; i < 9; ++i) {
    darkest = std::min(
        darkest, lightness(png.at(static_cast<int>(slanting.x) - 1 + i % 3, static_cast<int>(slanting.y) - 1 + i / 3)));
  }
  CHECK(darkest < 10.0);
  const double untouched =
      lightness(viridis((map.values[8 * 40 + 13] - layout.range->low) / (layout.range->high - layout.range->low)));
  CHECK(lightness(colour_at(png, layout, 6.75, 4.25)) == untouched);
  // Left of the frame and its tick marks nothing of the long wall is seen.
  const PixelPoint edge = layout.point(0.0, 6.0);
  CHECK(png.at(static_cast<int>(edge.x) - 12, static_cast<int>(edge.y) - 12) == Colour{255, 255, 255});
  CHECK(png.at(layout.plot.right() + 4, static_cast<int>(edge.y)) == Colour{255, 255, 255});
}

TEST_CASE("windows do not look like walls: a pale line between two dark ones, in grey as well") {
  DCEM_NEEDS_DRAWING();
  HeatMap map = room();
  map.walls_m = {{0.0, 6.0, 8.0, 6.0}};
  map.windows_m = {{8.0, 6.0, 20.0, 6.0}};
  const HeatMapLayout layout = heat_map_layout(map);
  const Png png = drawn(map);
  const auto across = [&](double x_m) {
    std::vector<double> tones;
    const PixelPoint place = layout.point(x_m, 6.0);
    for (int dy = -5; dy <= 5; ++dy) {
      tones.push_back(lightness(png.at(static_cast<int>(place.x), static_cast<int>(std::lround(place.y)) + dy)));
    }
    return tones;
  };
  for (const double x_m : {9.5, 14.25, 18.0}) {
    const std::vector<double> tones = across(x_m);
    CHECK(*std::max_element(tones.begin() + 3, tones.end() - 3) > 85.0);
    CHECK(*std::min_element(tones.begin(), tones.begin() + 5) < 30.0);
    CHECK(*std::min_element(tones.end() - 5, tones.end()) < 30.0);
  }
  const std::vector<double> wall = across(4.25);
  CHECK(*std::max_element(wall.begin() + 4, wall.end() - 5) < 10.0);
}

TEST_CASE("walls between hatched cells are thin and grey: they hide no street") {
  DCEM_NEEDS_DRAWING();
  HeatMap map = room();
  map.hatched.assign(map.values.size(), 0);
  for (std::size_t cell = 0; cell < map.values.size(); ++cell) map.hatched[cell] = cell % map.columns < 20 ? 1 : 0;
  const auto darkest_at = [&](double x_m, bool with_wall) {
    map.walls_m.clear();
    if (with_wall) map.walls_m = {{x_m, 2.0, x_m, 10.0}};
    const HeatMapLayout layout = heat_map_layout(map);
    const Png png = drawn(map);
    const PixelPoint place = layout.point(x_m, 6.0);
    double darkest = 100.0;
    for (int dx = -2; dx <= 2; ++dx) {
      darkest = std::min(darkest, lightness(png.at(static_cast<int>(place.x) + dx, static_cast<int>(place.y))));
    }
    return darkest;
  };
  CHECK(darkest_at(5.0, true) > 35.0);   // between two houses
  CHECK(darkest_at(10.0, true) < 10.0);  // between a house and a street
}

TEST_CASE("transmitters are marked where they stand") {
  DCEM_NEEDS_DRAWING();
  HeatMap map = room();
  map.transmitters = {{5.0, 5.0, "tx1"}, {19.9, 11.9, "tx2"}, {500.0, 5.0, "far"}};
  const HeatMapLayout layout = heat_map_layout(map);
  const Png png = drawn(map);
  const Colour centre = colour_at(png, layout, 5.0, 5.0);
  CHECK(centre.red > 180);
  CHECK(centre.green < 80);
  CHECK(colour_at(png, layout, 19.9, 11.9) == centre);
  // The label of the second one finds its place to the lower left, the other ways being cut by the rim.
  const PixelPoint corner = layout.point(19.9, 11.9);
  CHECK(groups_of_ink(png, {static_cast<int>(corner.x) - 74, static_cast<int>(corner.y) + 20, 54, 30}, 30) == 1);
  HeatMap bare = room();
  const Png without = drawn(bare);
  const HeatMapLayout without_layout = heat_map_layout(bare);
  CHECK(count_colour(without, without_layout.plot, centre) == 0);
}

TEST_CASE("labels of transmitters do not cover one another or a marker") {
  DCEM_NEEDS_DRAWING();
  HeatMap map = room();
  for (int i = 0; i < 60; ++i) {
    map.transmitters.push_back({8.0 + 0.35 * (i % 8), 4.0 + 0.35 * (i / 8), "transmitter " + std::to_string(i)});
  }
  const HeatMapLayout layout = heat_map_layout(map);
  const Png png = drawn(map);
  const Colour centre = colour_at(png, layout, 8.0, 4.0);
  for (const auto& transmitter : map.transmitters) {
    CHECK(colour_at(png, layout, transmitter.x_m, transmitter.y_m) == centre);
  }
}

TEST_CASE("a label gives way to one that was placed before") {
  DCEM_NEEDS_DRAWING();
  HeatMap map = room();
  map.values.assign(map.values.size(), 0.0);
  map.range = ValueRange{-1.0, 0.0};  // all cells are bright
  map.transmitters = {{10.0, 5.0, "first"}};
  HeatMap both = map;
  both.transmitters.push_back({10.0, 5.4, "next"});  // 26 pixels higher: beside it the label would reach the first one
  const HeatMapLayout layout = heat_map_layout(both);
  const PixelPoint place = layout.point(10.0, 5.4);
  const PixelRect left{static_cast<int>(place.x) - 95, static_cast<int>(place.y) - 9, 70, 18};
  CHECK(groups_of_ink(drawn(map), left, 20) == 0);
  CHECK(groups_of_ink(drawn(both), left, 20) == 1);
}

TEST_CASE("every tick has its own label, apart from its neighbours") {
  DCEM_NEEDS_DRAWING();
  for (const double origin_m : {0.0, -1000.0, 691'000.25, 5'334'000.0}) {
    for (const double spacing_m : {0.05, 0.1, 1.0, 7.3, 250.0}) {
      HeatMap map = plain_map(90, 30, -60.0);
      map.origin_x_m = origin_m;
      map.spacing_x_m = spacing_m;
      map.spacing_y_m = spacing_m;
      const HeatMapLayout layout = heat_map_layout(map);
      const Png png = drawn(map);
      const int ticks = groups_of_ink(png, {layout.plot.x - 1, layout.plot.bottom() + 4, layout.plot.width + 2, 1}, 2);
      // Digits of one label are at most 12 pixels apart, labels at least 40.
      const int labels = groups_of_ink(png, {0, layout.plot.bottom() + 18, layout.bar.x - 8, 26}, 24);
      CHECK(ticks >= 2);
      CHECK(ticks <= 14);
      CHECK(labels == ticks);
    }
  }
}

TEST_CASE("the colour range runs from the second percentile to the maximum, rounded outwards to 5 dB") {
  HeatMap map = plain_map(100, 1, 0.0);
  for (std::size_t i = 0; i < 100; ++i) map.values[i] = -101.5 + static_cast<double>(i);  // -101.5 ... -2.5
  ValueRange range = *default_value_range(map);
  CHECK(range.low == -100.0);  // the third lowest of 100 is -99.5
  CHECK(range.high == 0.0);
  map.values[0] = -400.0;  // one deep fade changes nothing
  CHECK(default_value_range(map)->low == -100.0);
  map.values.assign(100, -60.0);
  range = *default_value_range(map);
  CHECK(range.low == -65.0);
  CHECK(range.high == -55.0);
  map.values.assign(100, no_value);
  CHECK_FALSE(default_value_range(map).has_value());
  map.unit = "ns";
  for (std::size_t i = 0; i < 100; ++i) map.values[i] = 0.031 * static_cast<double>(i);  // 0.062 ... 3.069
  range = *default_value_range(map);
  CHECK(range.low == 0.0);  // a tenth of the span, rounded: 0.5
  CHECK(range.high == 3.5);
}

TEST_CASE("odd maps give a sound picture") {
  DCEM_NEEDS_DRAWING();
  std::vector<HeatMap> maps;
  maps.push_back(plain_map(1, 1, -60.0));
  maps.push_back(plain_map(1, 1, no_value));
  maps.push_back(plain_map(500, 1, -60.0));
  maps.push_back(plain_map(1, 500, -60.0));
  maps.push_back(plain_map(1'000'000, 1, -60.0));
  maps.push_back(plain_map(1000, 1000, no_value));
  maps.push_back(plain_map(4000, 20, -60.0));
  maps.push_back(plain_map(1, 1, no_value));
  maps.back().hatched = {1};
  maps.back().origin_y_m = 5'334'000.3;  // long labels leave little room for the legend
  maps.back().transmitters = {{50.0, 0.0, "far"}};
  maps.push_back(plain_map(2, 2, 1e300));
  maps.push_back(plain_map(2, 2, -1e100));
  maps.push_back(plain_map(2, 2, 0.0));
  maps.push_back(plain_map(30, 20, 1e-9));
  maps.back().unit = "s";
  maps.push_back(plain_map(30, 20, -60.0));
  maps.back().values[0] = std::nextafter(-60.0, 0.0);
  maps.push_back(plain_map(30, 20, -60.0));
  maps.back().values = std::vector<double>(600, 1e99);
  maps.back().values[0] = -1e99;
  maps.push_back(plain_map(30, 20, -60.0));
  maps.back().hatched.assign(600, 1);
  maps.push_back(plain_map(30, 20, -60.0));
  maps.back().origin_x_m = 1e9;
  maps.back().spacing_x_m = 0.01;
  maps.push_back(plain_map(30, 20, -60.0));
  maps.back().spacing_x_m = 1e9;
  maps.back().spacing_y_m = 1e-6;
  maps.push_back(plain_map(30, 20, -60.0));
  maps.back().range = ValueRange{-60.0, std::nextafter(-60.0, 0.0)};
  maps.push_back(plain_map(30, 20, -60.0));
  maps.back().title = std::string(500, 'T');
  maps.back().label = std::string(50, 'l');
  maps.back().transmitters = {{5.0, 5.0, std::string(300, 'x')}, {5.0, 6.0, ""}};
  for (const HeatMap& map : maps) {
    CAPTURE(map.columns);
    CAPTURE(map.rows);
    const HeatMapLayout layout = heat_map_layout(map);
    const Png png = drawn(map);
    const PixelRect whole{0, 0, png.width, png.height};
    CHECK(png.width >= 600);
    CHECK(png.height >= 300);
    CHECK(png.width <= 2900);
    CHECK(png.height <= 2900);
    CHECK(intersection(layout.plot, whole) == layout.plot);
    CHECK(intersection(layout.bar, whole) == layout.bar);
    CHECK(layout.plot.right() < png.width);
    // Nothing is cut at the rim: a seam of twelve pixels is left blank.
    for (int y = 0; y < png.height; ++y) {
      for (int x = 0; x < png.width; ++x) {
        const bool in_seam = std::min({x, y, png.width - 1 - x, png.height - 1 - y}) < 12;
        if (in_seam) REQUIRE(png.at(x, y) == Colour{255, 255, 255});
      }
    }
  }
}

TEST_CASE("a million cells are drawn one by one") {
  DCEM_NEEDS_DRAWING();
  HeatMap map = plain_map(1000, 1000, 0.0);
  map.range = ValueRange{0.0, 1.0};
  for (std::size_t i = 0; i < map.values.size(); ++i) map.values[i] = static_cast<double>((i % 1000 + i / 1000) % 2);
  const HeatMapLayout layout = heat_map_layout(map);
  REQUIRE(layout.plot.width == 1000);
  const Png png = drawn(map);
  long wrong = 0;
  for (int y = 0; y < 1000; ++y) {
    for (int x = 0; x < 1000; ++x) {
      const double value = (x + (999 - y)) % 2;
      wrong += png.at(layout.plot.x + x, layout.plot.y + y) == viridis(value) ? 0 : 1;
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("maps that do not fit together are refused") {
  const auto refused = [](const auto& change) {
    HeatMap map = plain_map(4, 3, -60.0);
    change(map);
    CHECK_THROWS_AS(heat_map_layout(map), std::invalid_argument);
  };
  refused([](HeatMap& map) { map.columns = 0; });
  refused([](HeatMap& map) { map.rows = 0; });
  refused([](HeatMap& map) { map.values.push_back(0.0); });
  refused([](HeatMap& map) { map.columns = std::numeric_limits<std::size_t>::max(); });
  refused([](HeatMap& map) { map.hatched.resize(3); });
  refused([](HeatMap& map) { map.spacing_x_m = 0.0; });
  refused([](HeatMap& map) { map.spacing_y_m = -1.0; });
  refused([](HeatMap& map) { map.spacing_y_m = no_value; });
  refused([](HeatMap& map) { map.origin_x_m = no_value; });
  refused([](HeatMap& map) { map.origin_y_m = 1e15; });
  refused([](HeatMap& map) { map.range = ValueRange{1.0, 1.0}; });
  refused([](HeatMap& map) { map.range = ValueRange{no_value, 1.0}; });
  refused([](HeatMap& map) { map.walls_m.push_back({0.0, 0.0, no_value, 1.0}); });
  refused([](HeatMap& map) { map.windows_m.push_back({0.0, no_value, 0.0, 1.0}); });
  refused([](HeatMap& map) { map.contour_step = 0.0; });
  refused([](HeatMap& map) { map.relief = {2, 2, {0.5F}}; });
  refused([](HeatMap& map) { map.transmitters.push_back({no_value, 0.0, "tx"}); });
}

TEST_CASE("the same map gives the same bytes in every format, and a place that cannot be written keeps nothing") {
  const TemporaryFolder folder;
  OutputFolder results(folder / "results");
  const auto formats = can_draw() ? std::vector{PictureFormat::png, PictureFormat::svg, PictureFormat::pdf}
                                  : std::vector{PictureFormat::png};
  for (const PictureFormat format : formats) {
    const std::string name = "a." + std::string(word_of(format));
    write_heat_map(room(), folder / name);
    write_heat_map(room(), results.open(name), format);
  }
  results.commit();
  for (const std::string& name : results.names()) {
    CHECK(dcem::test::file_bytes(folder / name) == dcem::test::file_bytes(folder / "results" / name));
  }
  CHECK_THROWS_AS(write_heat_map(room(), folder / "absent/map.png"), OutputError);
  CHECK_THROWS_AS(write_heat_map(room(), folder / "map.jpg"), std::invalid_argument);
  if (!can_draw()) {
    CHECK_THROWS_AS(write_heat_map(room(), folder / "map.svg"), OutputError);
    return;
  }
  CHECK(folder.names() == std::vector<std::string>{"a.pdf", "a.png", "a.svg", "results"});
  CHECK(dcem::test::is_xml(folder / "a.svg"));
  CHECK(dcem::test::is_pdf(dcem::test::file_bytes(folder / "a.pdf")));
}

TEST_CASE("cells alone are those of the picture's plot") {
  HeatMap map = room();
  map.values[7] = no_value;
  map.hatched.assign(map.values.size(), 0);
  map.hatched[90] = 1;
  const HeatMapLayout layout = heat_map_layout(map);
  const Image cells = draw_cells(map);
  REQUIRE(cells.width() == layout.plot.width);
  REQUIRE(cells.height() == layout.plot.height);
  DCEM_NEEDS_DRAWING();
  const Png png = drawn(map);
  long wrong = 0;
  for (int y = 0; y < cells.height(); ++y) {
    for (int x = 0; x < cells.width(); ++x) {
      wrong += png.at(layout.plot.x + x, layout.plot.y + y) == cells.pixel(x, y) ? 0 : 1;
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("finer cells have the points' values in the points, and lie on a straight line between two of them") {
  HeatMap map = plain_map(3, 2, 0.0);
  map.values = {-60.0, -50.0, no_value, -90.0, -80.0, -70.0};
  map.origin_x_m = 5.0;
  map.spacing_x_m = 2.0;
  const HeatMap fine = refined(map, 3);
  REQUIRE(fine.columns == 9);
  REQUIRE(fine.rows == 6);
  const auto at = [&](std::size_t column, std::size_t row) { return fine.values[row * 9 + column]; };
  const auto x_m = [&](std::size_t column) { return fine.origin_x_m + static_cast<double>(column) * fine.spacing_x_m; };
  CHECK(x_m(1) == doctest::Approx(5.0));
  CHECK(x_m(4) == doctest::Approx(7.0));
  CHECK(at(1, 1) == -60.0);
  CHECK(at(4, 4) == -80.0);
  CHECK(at(2, 1) == doctest::Approx(-60.0 + 10.0 / 3.0));
  CHECK(at(1, 2) == doctest::Approx(-60.0 - 30.0 / 3.0));
  CHECK(at(2, 2) == doctest::Approx(-60.0 + 10.0 / 3.0 - 30.0 / 3.0));
  CHECK(at(0, 0) == -60.0);                                                       // towards the rim as at the point
  CHECK(at(5, 1) == -50.0);                                                       // towards a cell without a value, too
  for (std::size_t row = 0; row < 3; ++row) CHECK(std::isnan(at(6 + row, row)));  // which stays empty
  CHECK(at(7, 4) == -70.0);
  // The whole covers the same ground.
  const HeatMapLayout coarse = heat_map_layout(map), finer = heat_map_layout(fine);
  CHECK(coarse.left_m == doctest::Approx(finer.left_m));
  CHECK(coarse.plot.width / coarse.horizontal_px_per_m ==
        doctest::Approx(finer.plot.width / finer.horizontal_px_per_m));
  CHECK_THROWS_AS(refined(map, 0), std::invalid_argument);
  map.values.assign(6, 0.0);
  map.categories = {"a"};
  CHECK_THROWS_AS(refined(map, 2), std::invalid_argument);
}

TEST_CASE("every point of a contour lies between two grid points where the value is the level") {
  HeatMap map = plain_map(40, 30, 0.0);
  map.spacing_x_m = 0.5;
  map.origin_y_m = -7.0;
  for (std::size_t i = 0; i < map.values.size(); ++i) {
    const double x = static_cast<double>(i % 40), y = static_cast<double>(i / 40);
    map.values[i] = 20.0 * std::sin(0.4 * x) * std::cos(0.3 * y) + 0.1 * x;
  }
  map.values[500] = no_value;
  const auto lines = detail::contour_lines(map, {-30.0, 30.0}, 5.0);
  REQUIRE(lines.size() > 20);
  for (const detail::ContourLine& line : lines) {
    CHECK(std::fmod(line.level, 5.0) == 0.0);
    for (const auto& [x_m, y_m] : line.points) {
      const double column = (x_m - map.origin_x_m) / map.spacing_x_m, row = (y_m - map.origin_y_m) / map.spacing_y_m;
      const bool lies_along_x = std::abs(row - std::round(row)) < 1e-9;
      REQUIRE((lies_along_x || std::abs(column - std::round(column)) < 1e-9));
      const double along = lies_along_x ? column : row, across = std::round(lies_along_x ? row : column);
      const double low = std::min(std::floor(along), lies_along_x ? 38.0 : 28.0), share = along - low;
      const auto value = [&](double place) {
        const double x = lies_along_x ? place : across, y = lies_along_x ? across : place;
        return map.values[static_cast<std::size_t>(y) * 40 + static_cast<std::size_t>(x)];
      };
      CHECK((1.0 - share) * value(low) + share * value(low + 1.0) == doctest::Approx(line.level).epsilon(1e-9));
    }
  }
}

TEST_CASE("contours of a hill are closed, as many as it has levels, and go with its height") {
  HeatMap map = plain_map(41, 41, 0.0);
  for (std::size_t i = 0; i < map.values.size(); ++i) {
    map.values[i] = -std::hypot(static_cast<double>(i % 41) - 20.0, static_cast<double>(i / 41) - 20.0);
  }
  const auto lines = detail::contour_lines(map, {-16.0, 0.0}, 5.0);
  REQUIRE(lines.size() == 4);  // -15, -10, -5; at 0 the top alone
  for (std::size_t level = 0; level < 3; ++level) {
    const auto& points = lines[level].points;
    CHECK(points.front() == points.back());
    const double radius = -lines[level].level;
    for (const auto& [x_m, y_m] : points) {
      // A chord between two grid points is at most 1/8 of its square over the radius off.
      CHECK(std::hypot(x_m - 20.0, y_m - 20.0) == doctest::Approx(radius).epsilon(0.125 * 2.0 / radius / radius));
    }
  }
  CHECK(detail::contour_lines(map, {-16.0, 0.0}, 1e-9).empty());  // no endless levels
}

TEST_CASE("contours are drawn where they lie, dark on any colour") {
  DCEM_NEEDS_DRAWING();
  HeatMap map = plain_map(40, 24, 0.0);
  for (std::size_t i = 0; i < map.values.size(); ++i) map.values[i] = -100.0 + static_cast<double>(i % 40);
  const Png without = drawn(map);
  map.contour_step = 10.0;
  const HeatMapLayout layout = heat_map_layout(map);
  const Png png = drawn(map);
  for (const double x_m : {10.0, 20.0, 30.0}) {
    const PixelPoint place = layout.point(x_m, 3.0);
    CHECK(lightness(png.at(static_cast<int>(place.x), static_cast<int>(place.y))) < 20.0);
  }
  const PixelPoint between = layout.point(15.0, 3.0);
  const int x = static_cast<int>(between.x), y = static_cast<int>(between.y);
  CHECK(png.at(x, y) == without.at(x, y));
}

TEST_CASE("axes that have nothing in common each fill the picture, and are named with their units") {
  DCEM_NEEDS_DRAWING();
  HeatMap map = plain_map(60, 30, -60.0);
  map.spacing_x_m = 0.1;
  map.spacing_y_m = 250.0;
  map.origin_y_m = 1000.0;
  map.axes = {"time", "s", "delay", "ns", false};
  const HeatMapLayout layout = heat_map_layout(map);
  CHECK_FALSE(layout.to_scale);
  CHECK(layout.plot.width % 60 == 0);
  CHECK(layout.plot.height % 30 == 0);
  CHECK(std::abs(layout.plot.width - 1280) < 60);
  CHECK(std::abs(layout.plot.height - 640) < 30);
  CHECK(layout.point(map.origin_x_m - 0.05, 875.0).x == doctest::Approx(layout.plot.x));
  CHECK(layout.point(map.origin_x_m - 0.05, 875.0).y == doctest::Approx(layout.plot.bottom()));
  // No note that the scales differ: nobody expects them to agree. The names take other ink than "x / m".
  HeatMap metres = map;
  metres.axes = {"x", "m", "y", "m", false};
  const Png named = drawn(map), plain = drawn(metres);
  CHECK(named.height == plain.height);
  CHECK(named.pixels != plain.pixels);
}

TEST_CASE("a title that is too long goes on in a second line, and only what is still too long loses its middle") {
  DCEM_NEEDS_DRAWING();
  HeatMap map = room();
  map.title = "floor, transmitter tx: incoherent power, 30 GHz, z = 1.50 m";
  const detail::HeatMapPlan plain = detail::plan_heat_map(map);
  CHECK(plain.title.text == map.title);
  CHECK(plain.title.second_line.empty());
  const std::string end = ": incoherent power, 30 GHz, z = 1.50 m";
  const auto check_lines = [&](const detail::HeatMapPlan& plan) {
    for (const std::string* line : {&plan.title.text, &plan.title.second_line}) {
      CHECK(plan.left_px + text_width_px(*line, plan.title.style) <= plan.layout.width_px - detail::margin_px);
    }
    CHECK(plan.title.second_line.ends_with(" 30 GHz, z = 1.50 m"));
    CHECK(plan.layout.plot.y == plain.layout.plot.y + plan.title.more_px());
    CHECK(plan.title.more_px() > 26);
    CHECK(plan.layout.width_px == plain.layout.width_px);
  };
  map.title =
      "a grid of the whole third floor of the northern wing, transmitter base-station-of-the-entrance-hall" + end;
  const detail::HeatMapPlan wrapped = detail::plan_heat_map(map);
  check_lines(wrapped);
  CHECK(wrapped.title.text + " " + wrapped.title.second_line == map.title);
  map.title = "floor, transmitter " + std::string(190, 'b') + end;
  const detail::HeatMapPlan cut = detail::plan_heat_map(map);
  check_lines(cut);
  CHECK(cut.title.text == "floor, transmitter");
  CHECK(cut.title.second_line.find("b...b") != std::string::npos);
}

TEST_CASE("a text that is cut keeps both ends, whole characters and the width that it may have") {
  DCEM_NEEDS_DRAWING();
  const TextStyle style{26.0};
  CHECK(detail::fit_text("short", style, 500) == "short");
  std::string umlauts;
  for (int i = 0; i < 60; ++i) umlauts += "\xc3\xa4\xe2\x82\xac";
  for (const std::string& text : {"first" + std::string(100, '-') + "last", umlauts}) {
    const std::string fitted = detail::fit_text(text, style, 300);
    CHECK(text_width_px(fitted, style) <= 300.0);
    CHECK(text_width_px(fitted, style) > 250.0);
    CHECK(drawable_text(fitted) == fitted);
    CHECK(fitted.substr(0, 5) == text.substr(0, 5));
    CHECK(fitted.substr(fitted.size() - 3) == text.substr(text.size() - 3));
  }
}

TEST_CASE("twenty-five transmitters in a row all have their names, none upon another or upon a symbol") {
  DCEM_NEEDS_DRAWING();
  HeatMap map = room();
  for (int i = 0; i < 25; ++i) map.transmitters.push_back({1.0 + 0.75 * i, 6.1, "transmitter-" + std::to_string(i)});
  map.transmitters.back().label = std::string(190, 'x');
  const detail::HeatMapPlan plan = detail::plan_heat_map(map);
  REQUIRE(plan.markers.size() == 25);
  std::vector<PixelRect> areas;
  for (const detail::SeenMarker& marker : plan.markers) {
    CAPTURE(marker.label);
    REQUIRE(marker.plate.has_value());
    CHECK(intersection(*marker.plate, plan.layout.plot) == *marker.plate);
    for (const detail::SeenMarker& other : plan.markers) {
      CHECK(intersection(*marker.plate, detail::marker_area(other.centre)).width *
                intersection(*marker.plate, detail::marker_area(other.centre)).height ==
            0);
    }
    for (const PixelRect& area : areas) {
      const PixelRect shared = intersection(*marker.plate, area);
      CHECK(shared.width * shared.height == 0);
    }
    areas.push_back(*marker.plate);
  }
}

TEST_CASE("the legend counts transmitters without room for a name") {
  DCEM_NEEDS_DRAWING();
  HeatMap map = room();
  for (int i = 0; i < 90; ++i) map.transmitters.push_back({10.0 + 0.01 * i, 6.1, "transmitter-" + std::to_string(i)});
  const detail::HeatMapPlan plan = detail::plan_heat_map(map);
  const auto named = std::count_if(plan.markers.begin(), plan.markers.end(),
                                   [](const detail::SeenMarker& marker) { return marker.plate.has_value(); });
  CHECK(named >= 8);
  CHECK(named < 90);
  const std::string said = "transmitters without room for a name: " + std::to_string(90 - named);
  CHECK(std::any_of(plan.legend.begin(), plan.legend.end(), [&](const auto& item) { return item.text == said; }));
  CHECK(plan.markers.front().plate.has_value());  // who comes first chooses first
}

TEST_CASE("the legend names walls and windows where some are drawn") {
  DCEM_NEEDS_DRAWING();
  HeatMap map = room();
  const auto has = [&](detail::Symbol symbol) {
    const auto legend = detail::plan_heat_map(map).legend;
    return std::any_of(legend.begin(), legend.end(), [&](const auto& item) { return item.symbol == symbol; });
  };
  map.walls_m = {{-1.0, 13.0, 21.0, 13.0}, {-3.0, 0.0, -3.0, 12.0}};  // the room is 20 m by 12 m
  map.windows_m = {{-1.0, -1.0, 21.0, -1.0}};
  CHECK_FALSE(has(detail::Symbol::wall));
  CHECK_FALSE(has(detail::Symbol::window));
  map.walls_m.push_back({0.0, 0.0, 20.0, 0.0});  // along the rim
  map.windows_m.push_back({3.0, 11.0, 3.0, 30.0});
  CHECK(has(detail::Symbol::wall));
  CHECK(has(detail::Symbol::window));
  map.walls_m = {{5.0, 2.0, 5.0, 10.0}};
  CHECK(has(detail::Symbol::wall));
  map.hatched.assign(map.values.size(), 1);  // within a house it is thin and grey
  CHECK_FALSE(has(detail::Symbol::wall));
}

}  // namespace test_heat_map
