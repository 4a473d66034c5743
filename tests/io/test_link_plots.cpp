/// Pictures of links over time: what they show of frames made by hand, and which files a run writes.
#include "dcem/io/link_plots.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "dcem/io/result_writer.hpp"
#include "dcem/io/src/pictures/chart_plan.hpp"
#include "tests/io/drawing_needed.hpp"
#include "tests/io/picture_checks.hpp"
#include "tests/io/png_reader.hpp"
#include "tests/io/temporary_folder.hpp"

namespace test_link_plots {

using namespace dcem;
using dcem::test::file_bytes;
using dcem::test::TemporaryFolder;

namespace {

using Names = std::vector<std::string>;

/// A floor of many facets to name paths after.
Scene small_scene() {
  Scene scene;
  scene.add_material({"floor", ConstantReflection{0.5, std::nullopt}});
  TriangleMesh steps;
  for (int step = 0; step < 8; ++step) {
    const double x = 3.0 * step, z = 0.4 * step;
    add_quad(steps, {Vec3(x, 0, z), Vec3(x + 1, 0, z), Vec3(x + 1, 1, z), Vec3(x, 1, z)}, "floor");
  }
  scene.set_scenery(steps);
  scene.add_transmitter(device_at("mast/1", {0, 0, 10}, 30.0));
  scene.add_transmitter(device_at("mast 2", {0, 5, 10}, 30.0));
  scene.add_receiver(device_at("ue:1", {3, 0, 10}));
  scene.add_receiver(device_at("far", {30, 0, 10}));
  scene.add_receiver(device_at("mast 2", {0, 5, 10}));
  return scene;
}

PathContribution path_of(double delay_s, double power_ratio, std::vector<Interaction> interactions = {}) {
  PathContribution path;
  path.path.length_m = 3e8 * delay_s;
  path.path.interactions = std::move(interactions);
  path.power_ratio = power_ratio;
  path.amplitude = std::sqrt(power_ratio);
  path.ports(0, 0) = path.amplitude;
  path.delay_s = delay_s;
  return path;
}

PathContribution reflected(std::uint32_t facet, double delay_s, double power_ratio) {
  return path_of(delay_s, power_ratio, {{InteractionKind::reflection, FacetId(facet), Vec3(0.0)}});
}

LinkResult link_of(std::vector<PathContribution> paths) {
  LinkResult link;
  link.paths = std::move(paths);
  link.statistics = link_statistics(link.paths, 30.0, true);
  return link;
}

io::LinkPlots small_plots(double bin_s = 1e-9) {
  return {{"a", "b", 30.0}, bin_s, PdpMode::incoherent};
}

const io::LineChart* find_chart(const std::vector<io::LineChart>& charts, const std::string& part) {
  const auto found = std::find_if(charts.begin(), charts.end(), [&](const io::LineChart& chart) {
    return chart.title.find(part) != std::string::npos;
  });
  return found == charts.end() ? nullptr : &*found;
}

Names series_names(const io::LineChart& chart) {
  Names names;
  for (const io::LineChart::Series& series : chart.series) names.push_back(series.name);
  return names;
}

FrameResult frame_of(std::size_t index, std::vector<LinkResult> links) {
  FrameResult frame;
  frame.index = index;
  frame.time_s = 0.1 * static_cast<double>(index);
  frame.links = std::move(links);
  return frame;
}

/// The files of a run of frames `first` … `last` − 1 with every link and two paths each.
Names written(const io::OutputSettings& output, std::size_t first, std::size_t last, const TemporaryFolder& folder) {
  const Scene scene = small_scene();
  io::OutputFolder out(folder.path());
  io::ResultFacts facts{Discovery::exact, 30e9};
  facts.frames = last - first;
  facts.first_frame = first;
  io::ResultWriter writer(out, scene, scene.receivers(), facts, output);
  for (std::size_t frame = first; frame < last; ++frame) {
    std::vector<LinkResult> links;
    for (std::size_t transmitter = 0; transmitter < 2; ++transmitter) {
      for (std::size_t receiver = 0; receiver < 3; ++receiver) {
        if (transmitter == 1 && receiver == 2) continue;  // a device to itself
        links.push_back(link_of({path_of(2e-8, 1e-6), reflected(1, 3e-8 + 1e-9 * double(frame), 1e-7)}));
        links.back().transmitter = transmitter;
        links.back().receiver = receiver;
      }
    }
    writer.write(frame_of(frame, std::move(links)));
  }
  writer.finish();
  out.commit();
  return folder.names();
}

io::OutputSettings only_plots() {
  io::OutputSettings output;
  output.links = false;
  output.plots = true;
  return output;
}

bool throws_of(const io::OutputSettings& output, std::size_t first, std::size_t last, const std::string& part) {
  const TemporaryFolder folder;
  try {
    written(output, first, last, folder);
  } catch (const std::invalid_argument& error) {
    return std::string(error.what()).find(part) != std::string::npos;
  }
  return false;
}

}  // namespace

TEST_CASE("paths are kept, new or gone by their ids, whatever their order and delay") {
  const Scene scene = small_scene();
  io::LinkPlots plots = small_plots();
  const auto add = [&](double time_s, const LinkResult& link) { plots.add(scene, time_s, &link); };
  add(0.0, link_of({path_of(1e-8, 1e-6), reflected(1, 2e-8, 1e-7), reflected(2, 3e-8, 1e-7)}));
  add(0.1, link_of({reflected(2, 1e-8, 1e-7), reflected(1, 2e-8, 1e-7), reflected(3, 4e-8, 1e-7)}));
  add(0.2, link_of({}));
  plots.add(scene, 0.3, nullptr);
  add(0.4, link_of({reflected(1, 2e-8, 1e-7)}));
  const std::vector<io::LineChart> charts = plots.charts();
  const io::LineChart* const chart = find_chart(charts, "paths since");
  REQUIRE(chart != nullptr);
  REQUIRE(series_names(*chart) == Names{"kept", "new", "gone"});
  // The first frame has none before it.
  for (const io::LineChart::Series& series : chart->series) CHECK(std::isnan(series.y[0]));
  const auto from_second = [&](std::size_t index) {
    return std::vector<double>(chart->series[index].y.begin() + 1, chart->series[index].y.end());
  };
  CHECK(from_second(0) == std::vector<double>{2, 0, 0, 0});
  CHECK(from_second(1) == std::vector<double>{1, 0, 0, 1});
  CHECK(from_second(2) == std::vector<double>{1, 3, 0, 0});
  CHECK(chart->y_unit.empty());
}

TEST_CASE("a chart is there where it has a value, a line where its mechanism occurs, a gap where there is no link") {
  const Scene scene = small_scene();
  io::LinkPlots plots = small_plots();
  const LinkResult link = link_of({reflected(1, 2e-8, 1e-7), reflected(2, 2e-8, 1e-7)});
  plots.add(scene, 0.0, &link);
  plots.add(scene, 0.1, nullptr);
  plots.add(scene, 0.2, &link);
  const std::vector<io::LineChart> charts = plots.charts();
  CHECK(find_chart(charts, "K factor") == nullptr);  // no line of sight
  const io::LineChart* const mechanisms = find_chart(charts, "mechanism");
  REQUIRE(mechanisms != nullptr);
  CHECK(series_names(*mechanisms) == Names{"reflected"});
  // 30 dBm and twice 1e-7: 30 − 70 + 3.0103 dBm.
  CHECK(mechanisms->series[0].y[0] == doctest::Approx(-36.98970004336).epsilon(1e-12));
  CHECK(std::isnan(mechanisms->series[0].y[1]));
  const io::LineChart* const power = find_chart(charts, ": received power");
  REQUIRE(power != nullptr);
  CHECK(power->y_unit == "dBm");
  CHECK(power->x_unit == "s");
  CHECK(power->series[0].name == "coherent");
  CHECK(power->series[0].y[0] == doctest::Approx(-33.97940008672).epsilon(1e-12));  // both in phase: 6.0206 dB
  CHECK_NOTHROW(io::detail::plan_line_charts(charts));
}

TEST_CASE("a link that never carries anything still has a chart of its power, and no picture of delays") {
  const Scene scene = small_scene();
  io::LinkPlots plots = small_plots();
  plots.add(scene, 0.0, nullptr);
  plots.add(scene, 0.1, nullptr);
  CHECK(find_chart(plots.charts(), "received power") != nullptr);
  CHECK_NOTHROW(io::detail::plan_line_charts(plots.charts()));
  CHECK_NOTHROW(io::detail::plan_panels("a to b", plots.panels()));
  CHECK_FALSE(plots.profile().has_value());
  CHECK_FALSE(plots.taps().has_value());
  const io::LineChart profile = plots.profile_at(1);
  CHECK_NOTHROW(io::detail::plan_line_charts({&profile, 1}));
}

TEST_CASE("every picture of a link that may lack something says so in its title, once") {
  const Scene scene = small_scene();
  const LinkResult link = link_of({path_of(1e-8, 1e-6), reflected(1, 5.1e-6, 3e-6)});
  io::LinkPlots plots = small_plots();
  for (int frame = 0; frame < 2000; ++frame) plots.add(scene, 0.1 * frame, &link);
  CHECK(plots.name() == "a to b");
  plots.set_note("sampled: 10 rays");
  CHECK(plots.name() == "a to b; sampled: 10 rays");
  Names titles{plots.profile().value().title, plots.taps().value().title, plots.profile_at(3).title};
  for (const io::LineChart& chart : plots.charts()) titles.push_back(chart.title);
  CHECK(titles.size() > 5);
  for (const std::string& title : titles) {
    CAPTURE(title);
    CHECK(title.starts_with("a to b: "));
    CHECK(title.ends_with("; sampled: 10 rays"));
    CHECK(title.find("sampled") == title.rfind("sampled"));
  }
}

TEST_CASE("the profile keeps the power of every bin, and where frames or bins are joined, their mean and their sum") {
  const Scene scene = small_scene();
  const auto sum_mw = [](const io::HeatMap& map) {
    double sum = 0.0;
    for (const double value : map.values) sum += std::isnan(value) ? 0.0 : std::pow(10.0, value / 10.0);
    return sum;
  };
  const LinkResult link = link_of({path_of(1e-8, 1e-6), reflected(1, 5.1e-6, 3e-6)});
  io::LinkPlots few = small_plots(), many = small_plots();
  for (int frame = 0; frame < 10; ++frame) few.add(scene, 0.1 * frame, &link);
  for (int frame = 0; frame < 3000; ++frame) many.add(scene, 0.1 * frame, &link);
  const io::HeatMap small = few.profile().value(), large = many.profile().value();
  CHECK(small.columns == 10);
  CHECK(small.rows <= 280);
  CHECK(large.columns == 1000);
  // 1 W: 4e-3 mW in every frame.
  CHECK(sum_mw(small) == doctest::Approx(10 * 4e-3).epsilon(1e-9).scale(0.0));
  CHECK(sum_mw(large) == doctest::Approx(1000 * 4e-3).epsilon(1e-9));
  CHECK(large.title.find("frames joined") != std::string::npos);
  CHECK(small.title.find("frames joined") == std::string::npos);
  CHECK(small.title.find("bins of 19 ns") != std::string::npos);  // 5091 bins in at most 280 rows
  CHECK(io::heat_map_layout(large).sampling == 1);                // no cell is left out of the picture
}

TEST_CASE("the profile of one frame has a bar per bin: specular, and beside it diffuse, down to 60 dB and more") {
  const std::vector<PdpTap> taps{{10e-9, 3e-6, 1e-6}, {12e-9, 1e-7, 1e-7}, {14e-9, 1e-14, 0.0}};
  const io::LineChart chart = io::profile_chart("one", taps, 1e-9, 30.0);
  REQUIRE(series_names(chart) == Names{"specular paths", "diffuse"});
  CHECK(chart.x_unit == "ns");
  // −25.2 dBm is the highest: bars stand on −100; −110 dBm is left out.
  REQUIRE(chart.series[0].y.size() == 3);
  CHECK(chart.series[0].y[1] == -100.0);
  CHECK(chart.series[0].y[0] == doctest::Approx(30.0 + 10.0 * std::log10(2e-6)).epsilon(1e-9));
  CHECK(chart.series[0].x[0] > 10.0);
  CHECK(chart.series[0].x[0] < chart.series[1].x[0]);
  CHECK(chart.series[1].x[0] < 11.0);
  REQUIRE(chart.series[1].y.size() == 6);
  CHECK(chart.series[1].y[3] == doctest::Approx(-40.0).epsilon(1e-12));
  CHECK(series_names(io::profile_chart("two", std::vector<PdpTap>{{1e-8, 1e-6, 0.0}}, 1e-9, 0.0)) ==
        Names{"specular paths"});
  CHECK_THROWS_AS(io::profile_chart("three", taps, 0.0, 30.0), std::invalid_argument);
}

TEST_CASE("a run writes five pictures per link; characters that a file name cannot hold are escaped") {
  DCEM_NEEDS_DRAWING();
  const TemporaryFolder folder;
  const Names names = written(only_plots(), 0, 5, folder);
  Names expected;
  for (const char* link : {"mast 2_far", "mast 2_ue%3A1", "mast%2F1_far", "mast%2F1_mast 2", "mast%2F1_ue%3A1"}) {
    expected.push_back("plot_" + std::string(link) + ".svg");
    expected.push_back("panels_" + std::string(link) + ".pdf");
    expected.push_back("pdp_" + std::string(link) + ".png");
    expected.push_back("taps_" + std::string(link) + ".png");
    expected.push_back("pdp_" + std::string(link) + "_2.svg");
  }
  std::sort(expected.begin(), expected.end());
  CHECK(names == expected);
  CHECK(test::read_png(folder / "taps_mast%2F1_far.png").width > 800);
  CHECK(test::is_xml(folder / "plot_mast%2F1_far.svg"));
  CHECK(test::is_pdf(file_bytes(folder / "panels_mast%2F1_far.pdf")));
}

TEST_CASE("formats that are asked for are those of every picture") {
  DCEM_NEEDS_DRAWING();
  io::OutputSettings output = only_plots();
  output.plots_max_links = 1;
  output.plots_formats = {io::PictureFormat::svg, io::PictureFormat::pdf};
  const TemporaryFolder folder;
  Names expected;
  for (const char* what : {"panels_mast%2F1_ue%3A1", "pdp_mast%2F1_ue%3A1", "pdp_mast%2F1_ue%3A1_1",
                           "plot_mast%2F1_ue%3A1", "taps_mast%2F1_ue%3A1"}) {
    for (const char* ending : {".pdf", ".svg"}) expected.push_back(std::string(what) + ending);
  }
  std::sort(expected.begin(), expected.end());
  CHECK(written(output, 0, 2, folder) == expected);
}

TEST_CASE("the panels of a drive are power, delay spread and Doppler, with the values of the charts") {
  const Scene scene = small_scene();
  io::LinkPlots plots = small_plots();
  const LinkResult link = link_of({path_of(1e-8, 1e-6), reflected(1, 3e-8, 1e-7)});
  plots.add(scene, 0.0, &link);
  plots.add(scene, 0.1, nullptr);
  const std::vector<io::LineChart> panels = plots.panels(), charts = plots.charts();
  REQUIRE(panels.size() == 3);
  CHECK(panels[0].y_unit == "dBm");
  CHECK(panels[1].y_unit == "ns");
  CHECK(panels[2].y_unit == "Hz");
  CHECK(panels[0].series[0].y[0] == find_chart(charts, ": received power")->series[0].y[0]);
  CHECK(panels[1].series[0].y[0] == find_chart(charts, "delay spread")->series[0].y[0]);
  CHECK(std::isnan(panels[2].series[0].y[1]));
  CHECK(plots.name() == "a to b");
}

TEST_CASE("the first links alone have pictures where there are more than the limit") {
  DCEM_NEEDS_DRAWING();
  io::OutputSettings output = only_plots();
  output.plots_max_links = 2;
  const TemporaryFolder folder;
  CHECK(written(output, 0, 2, folder).size() == 10);
  const Scene scene = small_scene();
  CHECK(io::plotted_links(scene, scene.receivers()) == 5);
}

TEST_CASE("one frame alone has its profile and nothing over time") {
  DCEM_NEEDS_DRAWING();
  const TemporaryFolder folder;
  const Names names = written(only_plots(), 7, 8, folder);
  CHECK(names.size() == 5);
  for (const std::string& name : names) CHECK(name.ends_with("_7.svg"));
}

TEST_CASE("the frame of the single profile is counted as in the scenario, and has to be one of the run") {
  DCEM_NEEDS_DRAWING();
  io::OutputSettings output = only_plots();
  output.plots_max_links = 1;
  output.plots_pdp_frame = 11;
  const TemporaryFolder folder;
  const Names names = written(output, 10, 13, folder);
  CHECK(std::count(names.begin(), names.end(), "pdp_mast%2F1_ue%3A1_11.svg") == 1);
  CHECK(throws_of(output, 0, 5, "output.plots.pdp_frame: frame 11 is not among those of this run; expected 0 to 4"));
  CHECK(throws_of(output, 12, 15, "expected 12 to 14"));
}

TEST_CASE("links whose file names would be the same are refused") {
  Scene scene;
  scene.add_transmitter(device_at("a", {0, 0, 10}));
  scene.add_transmitter(device_at("a_b", {0, 0, 10}));
  scene.add_receiver(device_at("b_c", {0, 0, 1}));
  scene.add_receiver(device_at("c", {0, 0, 1}));
  const TemporaryFolder folder;
  io::OutputFolder out(folder.path());
  CHECK_THROWS_WITH_AS(io::ResultWriter(out, scene, scene.receivers(), io::ResultFacts{}, only_plots()),
                       "output.plots: two links give the file name 'plot_a_b_c.svg'; expected ids that keep the names "
                       "apart",
                       std::invalid_argument);
}

TEST_CASE("the same frames give the same bytes") {
  DCEM_NEEDS_DRAWING();
  const TemporaryFolder first, second;
  const Names names = written(only_plots(), 0, 5, first);
  written(only_plots(), 0, 5, second);
  for (const std::string& name : names) CHECK(file_bytes(first / name) == file_bytes(second / name));
}

TEST_CASE("a device that is away for some frames leaves a gap and no line across it") {
  const Scene scene = small_scene();
  io::LinkPlots plots = small_plots();
  const LinkResult link = link_of({path_of(1e-8, 1e-6)});
  plots.add(scene, 0.0, &link);
  plots.add(scene, 0.1, &link);
  plots.add(scene, 0.2, nullptr);
  plots.add(scene, 0.3, &link);
  const io::ScatterChart chart = plots.taps().value();
  REQUIRE(chart.dots.size() == 3);
  CHECK_FALSE(chart.dots[0].joins_last);
  CHECK(chart.dots[1].joins_last);
  CHECK_FALSE(chart.dots[2].joins_last);
  CHECK(chart.dots[0].trace == chart.dots[2].trace);
  CHECK(chart.marked_label == "line of sight");
}

TEST_CASE("taps more than 70 dB below the strongest neither show in the profile nor stretch it") {
  const Scene scene = small_scene();
  io::LinkPlots plots = small_plots();
  const LinkResult link = link_of({path_of(1e-8, 1e-5), reflected(1, 4e-8, 1.01e-12), reflected(2, 9e-6, 0.99e-12)});
  plots.add(scene, 0.0, &link);
  plots.add(scene, 0.1, &link);
  const io::HeatMap map = plots.profile().value();
  CHECK(std::count_if(map.values.begin(), map.values.end(), [](double value) { return !std::isnan(value); }) == 4);
  CHECK(map.origin_y_m + map.spacing_y_m * static_cast<double>(map.rows) < 100.0);  // ns
}

}  // namespace test_link_plots
