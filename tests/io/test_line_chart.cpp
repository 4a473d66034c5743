#include "dcem/io/line_chart.hpp"

#include <doctest/doctest.h>

#include <cstdlib>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/io/temporary_folder.hpp"

namespace test_line_chart {

using dcem::io::ChartScale;
using dcem::io::line_chart_svg;
using dcem::io::LineChart;
using dcem::test::TemporaryFolder;

namespace {

constexpr double gap = std::numeric_limits<double>::quiet_NaN();

LineChart chart_of(std::vector<LineChart::Series> series) {
  LineChart chart;
  chart.title = "test";
  chart.y_label = "steps per ray";
  chart.series = std::move(series);
  return chart;
}

std::size_t occurrences(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

// The elements that carry class="...", in order, without the brackets.
std::vector<std::string> elements_of_class(const std::string& svg, const std::string& name) {
  std::vector<std::string> elements;
  const std::string mark = " class=\"" + name + "\"";
  for (std::size_t at = svg.find(mark); at != std::string::npos; at = svg.find(mark, at + 1)) {
    const std::size_t first = svg.rfind('<', at);
    elements.push_back(svg.substr(first, svg.find('>', at) - first));
  }
  return elements;
}

std::string attribute(const std::string& element, const std::string& name) {
  const std::string mark = " " + name + "=\"";
  const std::size_t at = element.find(mark);
  if (at == std::string::npos) return {};
  const std::size_t first = at + mark.size();
  return element.substr(first, element.find('"', first) - first);
}

struct PlotFrame {
  double left, top, width, height;

  explicit PlotFrame(const std::string& svg) {
    const std::string frame = elements_of_class(svg, "plot").at(0);
    left = std::stod(attribute(frame, "x"));
    top = std::stod(attribute(frame, "y"));
    width = std::stod(attribute(frame, "width"));
    height = std::stod(attribute(frame, "height"));
  }
};

// The numbers of a list such as "1,2 3,4", in order.
std::vector<double> numbers(std::string text) {
  for (char& letter : text) letter = letter == ',' ? ' ' : letter;
  std::vector<double> values;
  for (std::size_t at = 0, used = 0; at < text.size(); at += used + 1) {
    values.push_back(std::stod(text.substr(at), &used));
  }
  return values;
}

// Coordinates are written with two decimals.
doctest::Approx written(double pixels) {
  return doctest::Approx(pixels).epsilon(0.006 / (1.0 + pixels));
}

bool is_xml(const std::string& text) {
  const TemporaryFolder folder;
  std::ofstream(folder / "chart.svg", std::ios::binary) << text;
  const std::string file = (folder / "chart.svg").string();
  return std::system(("python3 -c \"import sys, xml.dom.minidom as d; d.parse(sys.argv[1])\" '" + file +
                      "' > /dev/null 2> /dev/null")
                         .c_str()) == 0;
}

}  // namespace

TEST_CASE("line chart: a point stands where its values say between round ends of the axes") {
  LineChart chart = chart_of({{"one", {0.0, 5.0, 10.0}, {0.0, 1.0, 4.0}}});
  const std::string svg = line_chart_svg(chart);
  const PlotFrame plot(svg);
  // Both axes end at the outermost values, which are round: half and whole of the width, a quarter and whole of the
  // height.
  const std::vector<double> points = numbers(attribute(elements_of_class(svg, "series").at(0), "points"));
  REQUIRE(points.size() == 6);
  CHECK(points[0] == written(plot.left));
  CHECK(points[1] == written(plot.top + plot.height));
  CHECK(points[2] == written(plot.left + plot.width / 2));
  CHECK(points[3] == written(plot.top + plot.height * 3 / 4));
  CHECK(points[4] == written(plot.left + plot.width));
  CHECK(points[5] == written(plot.top));
}

TEST_CASE("line chart: ends of an axis are rounded outwards") {
  const std::string svg = line_chart_svg(chart_of({{"one", {0.0, 10.0}, {0.3, 3.9}}}));
  const PlotFrame plot(svg);
  const std::vector<double> points = numbers(attribute(elements_of_class(svg, "series").at(0), "points"));
  // From 0 to 4, whatever the step, as 1, 0.5 and 2 all divide both.
  CHECK(points[1] == written(plot.top + plot.height * (1.0 - 0.3 / 4.0)));
  CHECK(points[3] == written(plot.top + plot.height * (1.0 - 3.9 / 4.0)));
}

TEST_CASE("line chart: zero is on an axis that starts there") {
  LineChart chart = chart_of({{"one", {0.0, 10.0}, {3.0, 4.0}}});
  chart.y_scale = ChartScale::linear_from_zero;
  const std::string svg = line_chart_svg(chart);
  const PlotFrame plot(svg);
  const std::vector<double> points = numbers(attribute(elements_of_class(svg, "series").at(0), "points"));
  CHECK(points[1] == written(plot.top + plot.height / 4));
  CHECK(points[3] == written(plot.top));
}

TEST_CASE("line chart: on a logarithmic axis equal factors are equal lengths") {
  LineChart chart = chart_of({{"one", {0.0, 1.0, 2.0}, {1.0, 10.0, 1000.0}}});
  chart.y_scale = ChartScale::logarithmic;
  const std::string svg = line_chart_svg(chart);
  const PlotFrame plot(svg);
  const std::vector<double> points = numbers(attribute(elements_of_class(svg, "series").at(0), "points"));
  CHECK(points[1] == written(plot.top + plot.height));
  CHECK(points[3] == written(plot.top + plot.height * 2 / 3));
  CHECK(points[5] == written(plot.top));
  for (const char* label : {">1<", ">10<", ">100<", ">1000<"}) CHECK(svg.find(label) != std::string::npos);
}

TEST_CASE("line chart: NaN leaves a gap, and a value alone is a dot") {
  const std::string svg =
      line_chart_svg(chart_of({{"one", {0, 1, 2, 3, 4, 5, 6, 7}, {1.0, 2.0, gap, 3.0, gap, gap, 1.0, 2.0}}}));
  const std::vector<std::string> pieces = elements_of_class(svg, "series");
  REQUIRE(pieces.size() == 3);
  CHECK(numbers(attribute(pieces[0], "points")).size() == 4);
  CHECK(pieces[1].rfind("<circle", 0) == 0);
  CHECK(numbers(attribute(pieces[2], "points")).size() == 4);
  CHECK(svg.find("nan") == std::string::npos);
}

TEST_CASE("line chart: every line has a colour and dashes of its own, the same in plot and legend") {
  std::vector<LineChart::Series> series;
  for (std::size_t index = 0; index < dcem::io::maximum_chart_series; ++index) {
    series.push_back({"line " + std::to_string(index), {0.0, 1.0}, {double(index), double(index)}});
  }
  const std::string svg = line_chart_svg(chart_of(series));
  const std::vector<std::string> lines = elements_of_class(svg, "series");
  REQUIRE(lines.size() == series.size());
  for (std::size_t one = 0; one < lines.size(); ++one) {
    const std::string colour = attribute(lines[one], "stroke"), dashes = attribute(lines[one], "stroke-dasharray");
    CHECK(occurrences(svg, "stroke=\"" + colour + "\"") == 2);
    for (std::size_t other = 0; other < one; ++other) {
      CHECK(colour != attribute(lines[other], "stroke"));
      CHECK(dashes != attribute(lines[other], "stroke-dasharray"));
    }
    CHECK(svg.find(">line " + std::to_string(one) + "<") != std::string::npos);
  }
}

TEST_CASE("line chart: labels name quantity and unit, and no unit where there is none") {
  const std::string svg = line_chart_svg(chart_of({{"one", {0.0, 1.0}, {0.0, 1.0}}}));
  CHECK(svg.find(">time (s)<") != std::string::npos);
  CHECK(svg.find(">steps per ray<") != std::string::npos);
  CHECK(svg.find(">test<") != std::string::npos);
}

TEST_CASE("line chart: any text makes XML") {
  LineChart chart = chart_of({{"a < b & \"c\" > 'd'\n\x01", {0.0, 1.0}, {0.0, 1.0}}, {"µ]]>", {0.0, 1.0}, {1.0, gap}}});
  chart.title = "<script>&amp;";
  chart.y_unit = "dB & <W>";
  const std::string svg = line_chart_svg(chart);
  CHECK(is_xml(svg));
  CHECK_FALSE(is_xml(svg + "&"));  // the check sees errors
  CHECK(svg.find("&lt;script&gt;&amp;amp;") != std::string::npos);
}

TEST_CASE("line chart: no values, one value and far values make a chart of finite numbers") {
  for (const ChartScale scale : {ChartScale::linear, ChartScale::linear_from_zero, ChartScale::logarithmic}) {
    for (const std::vector<double>& values :
         {std::vector<double>{gap, gap}, {7.0, 7.0}, {1e-99, 1e99}, {1.0, 1.0 + 1e-15}, {3e-7, 3.1e-7}}) {
      LineChart chart = chart_of({{"one", {2.0, 2.0}, values}});
      chart.y_scale = scale;
      const std::string svg = line_chart_svg(chart);
      CHECK(is_xml(svg));
      CHECK(svg.find("nan") == std::string::npos);
      CHECK(svg.find("inf") == std::string::npos);
      CHECK(svg.find("\"-\"") == std::string::npos);  // what a number that is not finite is written as
      CHECK(svg.size() < 20000);                      // no endless ticks
    }
  }
}

TEST_CASE("line chart: several charts stand one below the other") {
  const LineChart chart = chart_of({{"one", {0.0, 1.0}, {0.0, 1.0}}});
  const std::vector<LineChart> two{chart, chart};
  const std::string alone = line_chart_svg(chart), both = line_chart_svg(two);
  CHECK(is_xml(both));
  CHECK(elements_of_class(both, "plot").size() == 2);
  CHECK(std::stod(attribute(both, "height")) == 2 * std::stod(attribute(alone, "height")));
}

TEST_CASE("line chart: the file holds the text, and the same chart gives the same bytes") {
  const TemporaryFolder folder;
  const std::vector<LineChart> charts{chart_of({{"one", {0.0, 1.0}, {0.0, 1.0}}})};
  dcem::io::write_line_chart_svg(charts, folder / "chart.svg");
  std::ifstream file(folder / "chart.svg", std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  CHECK(bytes == line_chart_svg(charts.front()));
  CHECK(folder.names() == std::vector<std::string>{"chart.svg"});
}

TEST_CASE("line chart: what cannot be drawn is refused") {
  const double infinite = std::numeric_limits<double>::infinity();
  const auto refused = [](const LineChart& chart) { CHECK_THROWS_AS(line_chart_svg(chart), std::invalid_argument); };
  refused(chart_of({}));
  refused(chart_of({{"lengths", {0.0, 1.0}, {0.0}}}));
  refused(chart_of({{"descends", {1.0, 0.0}, {0.0, 0.0}}}));
  refused(chart_of({{"x", {gap}, {0.0}}}));
  refused(chart_of({{"x", {infinite}, {0.0}}}));
  refused(chart_of({{"y", {0.0}, {infinite}}}));
  refused(chart_of({{"y", {0.0}, {-1e101}}}));
  refused(chart_of(std::vector<LineChart::Series>(dcem::io::maximum_chart_series + 1, {"many", {0.0}, {0.0}})));
  LineChart logarithmic = chart_of({{"y", {0.0, 1.0}, {1.0, 0.0}}});
  logarithmic.y_scale = ChartScale::logarithmic;
  refused(logarithmic);
  CHECK_THROWS_AS(line_chart_svg(std::vector<LineChart>{}), std::invalid_argument);
}

}  // namespace test_line_chart
