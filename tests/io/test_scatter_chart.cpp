#include "dcem/io/scatter_chart.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>
#include <tuple>

#include "tests/io/drawing_needed.hpp"
#include "tests/io/picture_checks.hpp"
#include "tests/io/png_reader.hpp"

namespace test_scatter_chart {

using namespace dcem::io;
using dcem::test::Png;
using dcem::test::TemporaryFolder;

namespace {

// Relative luminance of an sRGB colour (WCAG 2.1, after IEC 61966-2-1).
double luminance(Colour colour) {
  const auto linear = [](std::uint8_t channel) {
    const double share = channel / 255.0;
    return share <= 0.04045 ? share / 12.92 : std::pow((share + 0.055) / 1.055, 2.4);
  };
  return 0.2126 * linear(colour.red) + 0.7152 * linear(colour.green) + 0.0722 * linear(colour.blue);
}

Png drawn(const ScatterChart& chart) {
  const TemporaryFolder folder;
  write_scatter_chart(chart, folder / "chart.png");
  return dcem::test::read_png(folder / "chart.png");
}

long count_colour(const Png& png, Colour colour) {
  return std::count(png.pixels.begin(), png.pixels.end(), colour);
}

ScatterChart chart_of(std::vector<ScatterChart::Dot> dots) {
  ScatterChart chart;
  chart.title = "delays";
  chart.dots = std::move(dots);
  return chart;
}

}  // namespace

TEST_CASE("traces have many colours, of several lightnesses, all visible on white") {
  std::set<std::tuple<int, int, int>> colours;
  double darkest = 1.0, brightest = 0.0;
  for (std::uint64_t trace = 0; trace < 1000; ++trace) {
    const Colour colour = trace_colour(trace);
    colours.insert({colour.red, colour.green, colour.blue});
    darkest = std::min(darkest, luminance(colour));
    brightest = std::max(brightest, luminance(colour));
  }
  CHECK(colours.size() == 24);
  CHECK(1.05 / (brightest + 0.05) > 1.5);  // contrast with white; below 1.2 it is hard to see
  CHECK(luminance({255, 255, 255}) / darkest > 20.0);
  CHECK(trace_colour(42) == trace_colour(42));
}

TEST_CASE("a stronger dot covers more of the paper than a weak one") {
  DCEM_NEEDS_DRAWING();
  ScatterChart chart = chart_of({{0.0, 10.0, -50.0, 1}, {1.0, 20.0, -50.0, 2}});
  std::uint64_t other = 2;
  while (trace_colour(other) == trace_colour(1)) ++other;
  chart.dots[1].trace = other;
  const Png equal = drawn(chart);
  chart.dots[1].value = -80.0;
  const Png weaker = drawn(chart);
  // Discs of one radius cover as many whole pixels, but for where their middles lie within one.
  CHECK(std::abs(count_colour(equal, trace_colour(1)) - count_colour(equal, trace_colour(other))) < 10);
  CHECK(count_colour(weaker, trace_colour(1)) == count_colour(equal, trace_colour(1)));
  CHECK(count_colour(weaker, trace_colour(other)) < count_colour(equal, trace_colour(other)) / 2);
  CHECK(count_colour(weaker, trace_colour(other)) > 0);
}

TEST_CASE("a line joins the dots of a trace where they belong together, and only there") {
  DCEM_NEEDS_DRAWING();
  ScatterChart apart = chart_of({{0.0, 10.0, -50.0, 7}, {1.0, 20.0, -50.0, 7}});
  ScatterChart joined = apart;
  joined.dots[1].joins_last = true;
  const Png without = drawn(apart), with = drawn(joined);
  long changed = 0;
  for (std::size_t i = 0; i < with.pixels.size(); ++i) changed += with.pixels[i] == without.pixels[i] ? 0 : 1;
  CHECK(changed > 1100);  // nearly across the plot of 1280 pixels
}

TEST_CASE("odd charts give a picture, and what cannot be drawn is refused") {
  DCEM_NEEDS_DRAWING();
  CHECK(drawn(chart_of({{0.0, 0.0, 0.0, 0}})).width > 1200);
  CHECK(drawn(chart_of({{5.0, 266.0, -3000.0, 0}, {5.0, 266.0, -60.0, 1}})).height > 800);
  CHECK_THROWS_AS(drawn(ScatterChart{}), std::invalid_argument);
  const double infinite = std::numeric_limits<double>::infinity(), none = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(drawn(chart_of({{infinite, 0.0, 0.0, 0}})), std::invalid_argument);
  CHECK_THROWS_AS(drawn(chart_of({{0.0, none, 0.0, 0}})), std::invalid_argument);
  CHECK_THROWS_AS(drawn(chart_of({{0.0, 0.0, 1e101, 0}})), std::invalid_argument);
}

TEST_CASE("a chart of dots is sound in every format") {
  DCEM_NEEDS_DRAWING();
  const TemporaryFolder folder;
  const ScatterChart chart = chart_of({{0.0, 10.0, -50.0, 1}, {1.0, 20.0, -50.0, 2}});
  write_scatter_chart(chart, folder / "chart.svg");
  write_scatter_chart(chart, folder / "chart.pdf");
  CHECK(dcem::test::is_xml(folder / "chart.svg"));
  CHECK(dcem::test::is_pdf(dcem::test::file_bytes(folder / "chart.pdf")));
}

}  // namespace test_scatter_chart
