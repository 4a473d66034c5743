#include "dcem/io/line_chart.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "dcem/io/src/pictures/chart_plan.hpp"
#include "tests/io/drawing_needed.hpp"
#include "tests/io/picture_checks.hpp"
#include "tests/io/temporary_folder.hpp"

namespace test_line_chart {

using namespace dcem::io;
using dcem::io::detail::ChartPiece;
using dcem::io::detail::ChartPlan;
using dcem::io::detail::ChartSheet;
using dcem::test::area_of;
using dcem::test::file_bytes;
using dcem::test::RecordedCanvas;
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

ChartPlan plan_of(const LineChart& chart) {
  return detail::plan_line_charts({&chart, 1}).charts.at(0);
}

RecordedCanvas drawn(const ChartSheet& sheet) {
  RecordedCanvas canvas;
  detail::draw_charts(canvas, sheet);
  return canvas;
}

RecordedCanvas drawn(const LineChart& chart) {
  return drawn(detail::plan_line_charts({&chart, 1}));
}

// Every text lies within the picture, and none upon another.
void check_texts(const ChartSheet& sheet) {
  const RecordedCanvas canvas = drawn(sheet);
  const PixelRect whole{0, 0, sheet.width_px, sheet.height_px};
  for (std::size_t one = 0; one < canvas.texts.size(); ++one) {
    CAPTURE(canvas.texts[one].text);
    const PixelRect area = area_of(canvas.texts[one]);
    CHECK(intersection(area, whole) == area);
    for (std::size_t other = 0; other < one; ++other) {
      const PixelRect shared = intersection(area, area_of(canvas.texts[other]));
      CHECK((shared.width == 0 || shared.height == 0));
    }
  }
}

bool is_finite(const ChartPlan& plan) {
  bool finite = true;
  for (const ChartPiece& piece : plan.pieces) {
    for (const PixelPoint& point : piece.points) finite = finite && std::isfinite(point.x) && std::isfinite(point.y);
  }
  return finite;
}

}  // namespace

TEST_CASE("line chart: a point stands where its values say between round ends of the axes") {
  const ChartPlan plan = plan_of(chart_of({{"one", {0.0, 5.0, 10.0}, {0.0, 1.0, 4.0}}}));
  const PixelRect& plot = plan.frame.plot;
  // Both axes end at the outermost values, which are round: half and whole of the width, a quarter and whole of the
  // height.
  const std::vector<PixelPoint>& points = plan.pieces.at(0).points;
  REQUIRE(points.size() == 3);
  CHECK(points[0].x == doctest::Approx(plot.x));
  CHECK(points[0].y == doctest::Approx(plot.bottom()));
  CHECK(points[1].x == doctest::Approx(plot.x + plot.width / 2.0));
  CHECK(points[1].y == doctest::Approx(plot.y + plot.height * 3 / 4.0));
  CHECK(points[2].x == doctest::Approx(plot.right()));
  CHECK(points[2].y == doctest::Approx(plot.y));
}

TEST_CASE("line chart: ends of an axis are rounded outwards") {
  const ChartPlan plan = plan_of(chart_of({{"one", {0.0, 10.0}, {0.3, 3.9}}}));
  const PixelRect& plot = plan.frame.plot;
  // From 0 to 4, whatever the step, as 1, 0.5 and 2 all divide both.
  CHECK(plan.pieces.at(0).points[0].y == doctest::Approx(plot.y + plot.height * (1.0 - 0.3 / 4.0)));
  CHECK(plan.pieces.at(0).points[1].y == doctest::Approx(plot.y + plot.height * (1.0 - 3.9 / 4.0)));
}

TEST_CASE("line chart: zero is on an axis that starts there") {
  LineChart chart = chart_of({{"one", {0.0, 10.0}, {3.0, 4.0}}});
  chart.y_scale = ChartScale::linear_from_zero;
  const ChartPlan plan = plan_of(chart);
  CHECK(plan.pieces.at(0).points[0].y == doctest::Approx(plan.frame.plot.y + plan.frame.plot.height / 4.0));
  CHECK(plan.pieces.at(0).points[1].y == doctest::Approx(plan.frame.plot.y));
}

TEST_CASE("line chart: on a logarithmic axis equal factors are equal lengths") {
  LineChart chart = chart_of({{"one", {0.0, 1.0, 2.0}, {1.0, 10.0, 1000.0}}});
  chart.y_scale = ChartScale::logarithmic;
  const ChartPlan plan = plan_of(chart);
  const PixelRect& plot = plan.frame.plot;
  CHECK(plan.pieces.at(0).points[0].y == doctest::Approx(plot.bottom()));
  CHECK(plan.pieces.at(0).points[1].y == doctest::Approx(plot.y + plot.height * 2 / 3.0));
  CHECK(plan.pieces.at(0).points[2].y == doctest::Approx(plot.y));
  const RecordedCanvas canvas = drawn(chart);
  for (const char* label : {"1", "10", "100", "1000"}) CHECK(canvas.count(label) >= 1);
}

TEST_CASE("line chart: NaN leaves a gap, and a value alone is a dot") {
  const LineChart chart = chart_of({{"one", {0, 1, 2, 3, 4, 5, 6, 7}, {1.0, 2.0, gap, 3.0, gap, gap, 1.0, 2.0}}});
  const ChartPlan plan = plan_of(chart);
  REQUIRE(plan.pieces.size() == 3);
  CHECK(plan.pieces[0].points.size() == 2);
  CHECK(plan.pieces[1].points.size() == 1);
  CHECK(plan.pieces[2].points.size() == 2);
  CHECK(is_finite(plan));
  const RecordedCanvas canvas = drawn(chart);
  REQUIRE(canvas.discs.size() == 1);
  CHECK(canvas.discs[0].x == plan.pieces[1].points[0].x);
}

TEST_CASE("line chart: every line has a colour and dashes of its own, the same in plot and legend") {
  std::vector<LineChart::Series> series;
  for (std::size_t index = 0; index < maximum_chart_series; ++index) {
    series.push_back({"line " + std::to_string(index), {0.0, 1.0}, {double(index), double(index)}});
  }
  const RecordedCanvas canvas = drawn(chart_of(series));
  for (std::size_t one = 0; one < series.size(); ++one) {
    const Stroke look = detail::series_stroke(one);
    const auto alike = [&](const RecordedCanvas::Line& line) {
      return line.stroke.colour == look.colour && line.stroke.dashes_px == look.dashes_px;
    };
    CHECK(std::count_if(canvas.lines.begin(), canvas.lines.end(), alike) == 2);
    for (std::size_t other = 0; other < one; ++other) {
      CHECK_FALSE(look.colour == detail::series_stroke(other).colour);
      CHECK(look.dashes_px != detail::series_stroke(other).dashes_px);
    }
    CHECK(canvas.count("line " + std::to_string(one)) == 1);
  }
}

TEST_CASE("line chart: labels name quantity and unit, and no unit where there is none") {
  const RecordedCanvas canvas = drawn(chart_of({{"one", {0.0, 1.0}, {0.0, 1.0}}}));
  CHECK(canvas.count("time (s)") == 1);
  CHECK(canvas.count("steps per ray") == 1);
  CHECK(canvas.count("test") == 1);
}

TEST_CASE("line chart: any text can be drawn, in every format") {
  DCEM_NEEDS_DRAWING();
  LineChart chart = chart_of(
      {{"a < b & \"c\" > 'd'\n\x01", {0.0, 1.0}, {0.0, 1.0}}, {"\xc2\xb5]]>\xff\xc3", {0.0, 1.0}, {1.0, gap}}});
  chart.title = "<script>&amp; (\\) \xf0\x9f";
  chart.y_unit = "dB & <W>";
  const TemporaryFolder folder;
  for (const char* name : {"chart.svg", "chart.pdf", "chart.png"}) write_line_charts({&chart, 1}, folder / name);
  CHECK(dcem::test::is_xml(folder / "chart.svg"));
  CHECK(dcem::test::is_pdf(file_bytes(folder / "chart.pdf")));
  CHECK(file_bytes(folder / "chart.png").starts_with("\x89PNG"));
  std::ofstream(folder / "broken.svg") << file_bytes(folder / "chart.svg") << '&';
  CHECK_FALSE(dcem::test::is_xml(folder / "broken.svg"));  // the check sees errors
  CHECK_FALSE(dcem::test::is_pdf(file_bytes(folder / "chart.pdf").substr(1)));
}

TEST_CASE("line chart: no values, one value and far values make a chart of finite numbers") {
  for (const ChartScale scale : {ChartScale::linear, ChartScale::linear_from_zero, ChartScale::logarithmic}) {
    for (const std::vector<double>& values :
         {std::vector<double>{gap, gap}, {7.0, 7.0}, {1e-99, 1e99}, {1.0, 1.0 + 1e-15}, {3e-7, 3.1e-7}}) {
      LineChart chart = chart_of({{"one", {2.0, 2.0}, values}});
      chart.y_scale = scale;
      CHECK(is_finite(plan_of(chart)));
      const RecordedCanvas canvas = drawn(chart);
      CHECK(canvas.texts.size() < 40);  // no endless ticks
      CHECK(canvas.count("-") == 0);    // what a number that is not finite is written as
      check_texts(detail::plan_line_charts({&chart, 1}));
    }
  }
}

TEST_CASE("line chart: several charts stand one below the other") {
  const LineChart chart = chart_of({{"one", {0.0, 1.0}, {0.0, 1.0}}});
  const std::vector<LineChart> two{chart, chart};
  const ChartSheet alone = detail::plan_line_charts({&chart, 1}), both = detail::plan_line_charts(two);
  CHECK(both.height_px == 2 * alone.height_px);
  CHECK(both.width_px == alone.width_px);
  CHECK(both.charts[1].frame.plot.y - both.charts[0].frame.plot.y == alone.height_px);
  check_texts(both);
}

TEST_CASE("panels share one x axis, labelled once, and a page 17 cm wide; no text lies upon another") {
  std::vector<LineChart> charts{chart_of({{"coherent", {0.0, 5.0}, {-70.0, -40.0}}, {"incoherent", {0.0}, {-60.0}}}),
                                chart_of({{"alone", {2.0, 9.7}, {0.0, 1e6}}}),
                                chart_of({{"mean", {0.0, 1.0}, {-1500.0, 2000.0}}, {"rms", {gap}, {gap}}})};
  charts[2].series[1].x = {0.5};
  for (LineChart& chart : charts) chart.title = "received power";
  const ChartSheet sheet = detail::plan_panels("mast to car", charts);
  CHECK(sheet.width_px / 192.0 * 2.54 == doctest::Approx(17.0).epsilon(1e-3));
  REQUIRE(sheet.charts.size() == 3);
  for (std::size_t panel = 1; panel < 3; ++panel) {
    const PixelRect &above = sheet.charts[panel - 1].frame.plot, &below = sheet.charts[panel].frame.plot;
    CHECK(above.x == below.x);
    CHECK(above.width == below.width);
    CHECK(above.bottom() < below.y);
  }
  // The same instant stands at the same place in every panel: 0 and 10 s are the ends.
  CHECK(sheet.charts[0].pieces[0].points[1].x - sheet.charts[0].frame.plot.x ==
        doctest::Approx(0.5 * sheet.charts[0].frame.plot.width));
  CHECK(sheet.charts[1].pieces[0].points[0].x - sheet.charts[1].frame.plot.x ==
        doctest::Approx(0.2 * sheet.charts[1].frame.plot.width));
  const RecordedCanvas canvas = drawn(sheet);
  CHECK(canvas.count("time (s)") == 1);
  CHECK(canvas.count("mast to car") == 1);
  for (const char* title : {"(a) received power", "(b) received power", "(c) received power"}) {
    CHECK(canvas.count(title) == 1);
  }
  CHECK(canvas.count("incoherent") == 1);
  CHECK(canvas.count("alone") == 0);  // the panel's title names a single line
  check_texts(sheet);
}

TEST_CASE("line chart: the same chart gives the same bytes, whatever was drawn before") {
  DCEM_NEEDS_DRAWING();
  const TemporaryFolder folder;
  const std::vector<LineChart> charts{chart_of({{"one", {0.0, 1.0}, {0.0, 1.0}}})};
  const std::vector<LineChart> others{chart_of({{"other", {0.0, 1.0}, {3.0, 1.0}}})};
  for (const std::string format : {"png", "svg", "pdf"}) {
    write_line_charts(charts, folder / ("a." + format));
    write_line_charts(others, folder / ("b." + format));
    write_line_charts(charts, folder / ("c." + format));
    CHECK(file_bytes(folder / ("a." + format)) == file_bytes(folder / ("c." + format)));
    CHECK(file_bytes(folder / ("a." + format)) != file_bytes(folder / ("b." + format)));
  }
  CHECK(file_bytes(folder / "a.pdf").find("Date") == std::string::npos);
  CHECK(folder.names().size() == 9);
}

TEST_CASE("line chart: what cannot be drawn is refused") {
  const double infinite = std::numeric_limits<double>::infinity();
  const auto refused = [](const LineChart& chart) { CHECK_THROWS_AS(plan_of(chart), std::invalid_argument); };
  refused(chart_of({}));
  refused(chart_of({{"lengths", {0.0, 1.0}, {0.0}}}));
  refused(chart_of({{"descends", {1.0, 0.0}, {0.0, 0.0}}}));
  refused(chart_of({{"x", {gap}, {0.0}}}));
  refused(chart_of({{"x", {infinite}, {0.0}}}));
  refused(chart_of({{"y", {0.0}, {infinite}}}));
  refused(chart_of({{"y", {0.0}, {-1e101}}}));
  refused(chart_of(std::vector<LineChart::Series>(maximum_chart_series + 1, {"many", {0.0}, {0.0}})));
  LineChart logarithmic = chart_of({{"y", {0.0, 1.0}, {1.0, 0.0}}});
  logarithmic.y_scale = ChartScale::logarithmic;
  refused(logarithmic);
  CHECK_THROWS_AS(detail::plan_line_charts({}), std::invalid_argument);
  const TemporaryFolder folder;
  const LineChart chart = chart_of({{"y", {0.0}, {0.0}}});
  CHECK_THROWS_AS(write_line_charts({&chart, 1}, folder / "chart.gif"), std::invalid_argument);
  CHECK(folder.names().empty());
}

TEST_CASE("line chart: endless names and titles leave a picture its size") {
  DCEM_NEEDS_DRAWING();
  const std::string endless = "base" + std::string(190, '-') + "station";
  LineChart chart = chart_of({{endless, {0.0, 1.0}, {0.0, 1.0}}, {"b", {0.0, 1.0}, {1.0, 0.0}}});
  chart.title = "power of " + endless + ", t = 1.000 s";
  std::vector<LineChart> charts{chart, chart};
  const ChartSheet sheet = detail::plan_line_charts(charts);
  CHECK(sheet.width_px < 2100);
  check_texts(sheet);
  const ChartPlan& plan = sheet.charts.at(1);
  CHECK(plan.legend.at(0).text.starts_with("base--"));
  CHECK(plan.legend.at(0).text.ends_with("--station"));
  CHECK(plan.title.text == "power of");
  CHECK(plan.title.second_line.ends_with("--station, t = 1.000 s"));
  for (LineChart& panel : charts) {
    panel.title = "power";
    panel.series[1].name = "phase";
  }
  const ChartSheet panels = detail::plan_panels(chart.title, charts);
  CHECK(panels.title.second_line.ends_with("--station, t = 1.000 s"));
  check_texts(panels);
}

}  // namespace test_line_chart
