#include "dcem/io/scatter_chart.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>
#include <tuple>

namespace test_scatter_chart {

using namespace dcem::io;

namespace {

// Relative luminance of an sRGB colour (WCAG 2.1, after IEC 61966-2-1).
double luminance(Colour colour) {
  const auto linear = [](std::uint8_t channel) {
    const double share = channel / 255.0;
    return share <= 0.04045 ? share / 12.92 : std::pow((share + 0.055) / 1.055, 2.4);
  };
  return 0.2126 * linear(colour.red) + 0.7152 * linear(colour.green) + 0.0722 * linear(colour.blue);
}

long count_colour(const Image& image, Colour colour) {
  long count = 0;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) count += image.pixel(x, y) == colour ? 1 : 0;
  }
  return count;
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
  ScatterChart chart = chart_of({{0.0, 10.0, -50.0, 1}, {1.0, 20.0, -50.0, 2}});
  std::uint64_t other = 2;
  while (trace_colour(other) == trace_colour(1)) ++other;
  chart.dots[1].trace = other;
  const Image equal = draw_scatter_chart(chart);
  chart.dots[1].value = -80.0;
  const Image weaker = draw_scatter_chart(chart);
  CHECK(count_colour(equal, trace_colour(1)) == count_colour(equal, trace_colour(other)));
  CHECK(count_colour(weaker, trace_colour(1)) == count_colour(equal, trace_colour(1)));
  CHECK(count_colour(weaker, trace_colour(other)) < count_colour(equal, trace_colour(other)) / 2);
  CHECK(count_colour(weaker, trace_colour(other)) > 0);
}

TEST_CASE("a line joins the dots of a trace where they belong together, and only there") {
  ScatterChart apart = chart_of({{0.0, 10.0, -50.0, 7}, {1.0, 20.0, -50.0, 7}});
  ScatterChart joined = apart;
  joined.dots[1].joins_last = true;
  const Image without = draw_scatter_chart(apart), with = draw_scatter_chart(joined);
  long changed = 0;
  for (int y = 0; y < with.height(); ++y) {
    for (int x = 0; x < with.width(); ++x) changed += with.pixel(x, y) == without.pixel(x, y) ? 0 : 1;
  }
  CHECK(changed > 700);  // nearly across the plot of 860 pixels
}

TEST_CASE("odd charts give a picture, and what cannot be drawn is refused") {
  CHECK(draw_scatter_chart(chart_of({{0.0, 0.0, 0.0, 0}})).width() > 800);
  CHECK(draw_scatter_chart(chart_of({{5.0, 266.0, -3000.0, 0}, {5.0, 266.0, -60.0, 1}})).height() > 400);
  CHECK_THROWS_AS(draw_scatter_chart(ScatterChart{}), std::invalid_argument);
  const double infinite = std::numeric_limits<double>::infinity(), none = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(draw_scatter_chart(chart_of({{infinite, 0.0, 0.0, 0}})), std::invalid_argument);
  CHECK_THROWS_AS(draw_scatter_chart(chart_of({{0.0, none, 0.0, 0}})), std::invalid_argument);
  CHECK_THROWS_AS(draw_scatter_chart(chart_of({{0.0, 0.0, 1e101, 0}})), std::invalid_argument);
}

}  // namespace test_scatter_chart
