/// Maps as arrays, rasters and distributions; what all transmitters do together.
#include <doctest/doctest.h>
#include <zip.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "dcem/io/combined_map_writer.hpp"
#include "dcem/io/distribution_chart.hpp"
#include "dcem/io/esri_grid.hpp"
#include "dcem/io/map_distribution.hpp"
#include "dcem/io/map_writer.hpp"
#include "dcem/io/src/pictures/colour_map.hpp"
#include "tests/io/png_reader.hpp"
#include "tests/io/temporary_folder.hpp"

namespace test_map_files {

using namespace dcem;

namespace {

/// Three columns and two rows. Point 1 is lit, point 5 is obstructed, elsewhere nothing arrives.
RadioMap small_map(const std::string& id, double power_dbm) {
  RadioMap map{ReceiverGrid{"area", {-1, 2, 1.5}, {0.5, 0.5}, {3, 2}, {}}, id, {}};
  for (std::size_t cell = 0; cell < 6; ++cell) {
    map.points.push_back({grid_point_m(map.grid(), cell / 3, cell % 3), cell == 5, {}, {}});
  }
  LinkStatistics& lit = map.points[1].statistics;
  lit.line_of_sight = true;
  lit.path_count = 3;
  lit.power_dbm = power_dbm;
  lit.power_incoherent_dbm = power_dbm - 1.5;
  lit.path_gain_db = power_dbm - 30.0;
  lit.mean_delay_s = 2e-8;
  lit.rms_delay_spread_s = 0.0;
  map.points[1].strongest_kinds = "RT";
  return map;
}

template <typename Write>
std::string written(Write&& write) {
  const test::TemporaryFolder folder;
  io::AtomicFile file(folder / "file");
  write(file);
  file.commit();
  return test::file_bytes(folder / "file");
}

/// The bytes of an entry of an archive, header and all; read by libzip itself.
std::string npy_bytes(const std::string& archive, const std::string& name) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "a.npz", std::ios::binary) << archive;
  zip_t* zip = zip_open((folder / "a.npz").c_str(), ZIP_RDONLY, nullptr);
  REQUIRE(zip != nullptr);
  std::string bytes;
  if (zip_file_t* entry = zip_fopen(zip, (name + ".npy").c_str(), 0)) {
    char block[4096];
    for (zip_int64_t size = 1; (size = zip_fread(entry, block, sizeof block)) > 0;) {
      bytes.append(block, static_cast<std::size_t>(size));
    }
    zip_fclose(entry);
  }
  zip_discard(zip);
  return bytes;
}

/// The array's values; its header must say `type` and `shape`.
template <typename Number>
std::vector<Number> array_of(const std::string& archive, const std::string& name, const std::string& type,
                             const std::string& shape = "(2, 3)") {
  CAPTURE(name);
  const std::string bytes = npy_bytes(archive, name);
  REQUIRE(bytes.size() > 128);
  const std::size_t begin = bytes.find('\n') + 1;
  const std::string header = bytes.substr(0, begin);
  CHECK(header.find("'" + type + "'") != std::string::npos);
  CHECK(header.find("'shape': " + shape) != std::string::npos);
  std::vector<Number> values((bytes.size() - begin) / sizeof(Number));
  std::memcpy(values.data(), bytes.data() + begin, values.size() * sizeof(Number));
  return values;
}

Scene scene_with(const std::vector<std::string>& transmitters) {
  Scene scene;
  double x_m = -0.5;
  for (const std::string& id : transmitters) scene.add_transmitter(device_at(id, {x_m += 0.3, 2.2, 3}));
  return scene;
}

}  // namespace

TEST_CASE("a map's arrays are over row and column, with NaN where the table is empty") {
  const RadioMap map = small_map("bs", -60.0);
  const std::string archive = written([&](io::AtomicFile& file) { io::write_map_npz(file, map, 30e9); });
  CHECK(array_of<double>(archive, "x_m", "<f8") == std::vector<double>{-1, -0.5, 0, -1, -0.5, 0});
  CHECK(array_of<double>(archive, "y_m", "<f8") == std::vector<double>{2, 2, 2, 2.5, 2.5, 2.5});
  CHECK(array_of<double>(archive, "z_m", "<f8") == std::vector<double>(6, 1.5));
  const auto check_lit = [&](const char* name, double value) {
    const auto values = array_of<double>(archive, name, "<f8");
    CHECK(values[1] == value);
    for (const std::size_t cell : {0U, 2U, 3U, 4U, 5U}) CHECK(std::isnan(values[cell]));
  };
  check_lit("power_dbm", -60.0);
  check_lit("power_incoherent_dbm", -61.5);
  check_lit("path_gain_db", -90.0);
  check_lit("field_strength_dbuv_per_m", field_strength_dbuv_per_m(-60.0, 30e9));
  check_lit("mean_delay_s", 2e-8);
  check_lit("rms_delay_spread_s", 0.0);
  CHECK(array_of<char>(archive, "line_of_sight", "|b1") == std::vector<char>{0, 1, 0, 0, 0, 0});
  CHECK(array_of<char>(archive, "obstructed", "|b1") == std::vector<char>{0, 0, 0, 0, 0, 1});
  CHECK(array_of<std::uint32_t>(archive, "path_count", "<u4") == std::vector<std::uint32_t>{0, 3, 0, 0, 0, 0});
  const auto kinds = array_of<char32_t>(archive, "strongest_kinds", "<U2");
  CHECK(std::u32string(kinds.begin() + 2, kinds.begin() + 4) == U"RT");
  CHECK(array_of<double>(archive, "frequency_hz", "<f8", "()") == std::vector<double>{30e9});
}

TEST_CASE("a raster has its northern row first and says where its south-western point lies") {
  const RadioMap map = small_map("bs", -60.25);
  CHECK(written([&](io::AtomicFile& file) { io::write_map_asc(file, map); }) ==
        "ncols 3\nnrows 2\nxllcenter -1\nyllcenter 2\ncellsize 0.5\nNODATA_value -9999\n"
        "-9999 -9999 -9999\n-9999 -60.25 -9999\n");
}

TEST_CASE("a raster of oblong cells has two spacings, as GDAL writes and reads them") {
  const ReceiverGrid grid{"area", {0, 0, 1}, {0.5, 2}, {2, 1}, {}};
  const std::vector<double> values{1.5, std::numeric_limits<double>::infinity()};
  CHECK(written([&](io::AtomicFile& file) { io::write_esri_grid(file, grid, values); }) ==
        "ncols 2\nnrows 1\nxllcenter 0\nyllcenter 0\ndx 0.5\ndy 2\nNODATA_value -9999\n1.5 -9999\n");
  CHECK_THROWS_AS(written([&](io::AtomicFile& file) { io::write_esri_grid(file, grid, std::vector<double>(3)); }),
                  std::invalid_argument);
}

TEST_CASE("best server and SINR name the transmitter, and are empty where nothing arrives") {
  std::vector<RadioMap> maps{small_map("a, left", -60.0), small_map("b", -50.0)};
  maps[1].points[0].statistics.power_incoherent_dbm = -80.0;
  maps[0].points[2].statistics.power_incoherent_dbm = -70.0;
  const CombinedMap map = combine_maps(maps);
  CHECK(written([&](io::AtomicFile& file) { io::write_best_server_csv(file, map); }) ==
        "x_m,y_m,z_m,tx,power_dbm,power_incoherent_dbm\n"
        "-1,2,1.5,b,,-80\n-0.5,2,1.5,b,-50,-51.5\n0,2,1.5,\"a, left\",,-70\n"
        "-1,2.5,1.5,,,\n-0.5,2.5,1.5,,,\n0,2.5,1.5,,,\n");
  // Without noise and interference there is no ratio; between the two it is that of -51.5 and -61.5 dBm.
  CHECK(written([&](io::AtomicFile& file) { io::write_sinr_csv(file, map); }) ==
        "x_m,y_m,z_m,tx,sinr_db,snr_db\n"
        "-1,2,1.5,b,,\n-0.5,2,1.5,b,10,\n0,2,1.5,\"a, left\",,\n"
        "-1,2.5,1.5,,,\n-0.5,2.5,1.5,,,\n0,2.5,1.5,,,\n");
  CHECK(written([&](io::AtomicFile& file) {
          io::write_best_server_asc(file, map);
        }).ends_with("-9999 -9999 -9999\n1 1 0\n"));
  CHECK(written([&](io::AtomicFile& file) { io::write_sinr_asc(file, map); }).ends_with("\n-9999 10 -9999\n"));
  const std::string archive = written([&](io::AtomicFile& file) { io::write_best_server_npz(file, map); });
  CHECK(array_of<std::uint32_t>(archive, "tx", "<u4") == std::vector<std::uint32_t>{1, 1, 0, 0, 0, 0});
  CHECK(array_of<char>(archive, "served", "|b1") == std::vector<char>{1, 1, 1, 0, 0, 0});
  CHECK(array_of<double>(archive, "power_incoherent_dbm", "<f8")[2] == -70.0);
  CHECK(array_of<char32_t>(archive, "tx_id", "<U7", "(2,)")[0] == U'a');
  const std::string ratios = written([&](io::AtomicFile& file) { io::write_sinr_npz(file, map); });
  CHECK(array_of<double>(ratios, "sinr_db", "<f8")[1] == doctest::Approx(10.0));
  CHECK(std::isnan(array_of<double>(ratios, "snr_db", "<f8")[1]));
  CHECK(io::has_sinr(map, false));
  CHECK_FALSE(io::has_sinr(combine_maps(std::span(maps).first(1)), false));
  CHECK(io::has_sinr(combine_maps(std::span(maps).first(1)), true));
}

TEST_CASE("the picture of the best server gives each transmitter a colour of its own and a name") {
  const std::vector<RadioMap> maps{small_map("a", -60.0), small_map("b", -50.0)};
  const CombinedMap map = combine_maps(maps);
  const Scene scene = scene_with({"a", "b"});
  io::HeatMap picture = io::best_server_picture(map, scene, scene.frame_at(0.0), 30e9);
  CHECK(picture.categories == std::vector<std::string>{"a", "b"});
  CHECK(picture.values[1] == 1.0);
  CHECK(std::isnan(picture.values[0]));
  CHECK(picture.hatched[5] == 1);
  picture.walls_m.clear();
  picture.transmitters.clear();
  const io::HeatMapLayout layout = io::heat_map_layout(picture);
  CHECK_FALSE(layout.range.has_value());  // no colour bar
  // Apart from the dots of the second texture, which stand every 20 pixels.
  const auto colour_at = [&](double value) {
    picture.values[1] = value;
    const io::PixelPoint middle = layout.point(-0.5, 2.0);
    const int x = static_cast<int>(middle.x) - layout.plot.x, y = static_cast<int>(middle.y) - layout.plot.y;
    return io::draw_cells(picture).pixel(x - x % 20 + 10, y - y % 20 + 10);
  };
  CHECK(colour_at(0.0) == io::Colour{230, 159, 0});  // the orange of Okabe and Ito
  CHECK(colour_at(1.0) == io::Colour{0, 114, 178});  // their blue
  picture.values[1] = 2.0;
  CHECK_THROWS_AS(io::draw_cells(picture), std::invalid_argument);
  picture.values[1] = 0.5;
  CHECK_THROWS_AS(io::draw_cells(picture), std::invalid_argument);
}

TEST_CASE("the transmitter of a map chooses first where its name stands") {
  const RadioMap map = small_map("b", -60.0);
  const Scene scene = scene_with({"a", "b", "c"});
  std::vector<std::string> names;
  for (const auto& marker : io::map_picture(map, scene, scene.frame_at(0.0), 30e9).transmitters)
    names.push_back(marker.label);
  CHECK(names == std::vector<std::string>{"b", "a", "c"});
}

TEST_CASE("areas of servers are told apart in grey: by their own textures") {
  const Scene scene = scene_with({"a", "b", "c", "d", "e", "f", "g"});
  std::vector<RadioMap> maps;
  for (const char* id : {"a", "b", "c", "d", "e", "f", "g"}) maps.push_back(small_map(id, -60.0));
  io::HeatMap picture = io::best_server_picture(combine_maps(maps), scene, scene.frame_at(0.0), 30e9);
  picture.hatched.clear();
  std::vector<std::vector<bool>> textures;
  for (double server = 0.0; server < 7.0; ++server) {
    picture.values.assign(6, server);
    const io::Image cells = io::draw_cells(picture);
    const io::Colour bare = io::category_colour(static_cast<std::size_t>(server));
    std::vector<bool> marks;
    for (int i = 0; i < 60 * 60; ++i) marks.push_back(cells.pixel(100 + i % 60, 100 + i / 60) != bare);
    CHECK(std::count(marks.begin(), marks.end(), true) < 60 * 60 / 3);  // the colour stays
    for (const auto& other : textures) CHECK(marks != other);
    textures.push_back(std::move(marks));
  }
}

TEST_CASE("pictures of maps without any value, and of equal values, are drawn") {
  std::vector<RadioMap> maps{small_map("a", -60.0), small_map("b", -60.0)};
  for (const bool empty : {false, true}) {
    for (RadioMap& map : maps) {
      for (RadioMapPoint& point : map.points) {
        point.statistics = {};
        if (!empty) point.statistics.power_dbm = point.statistics.power_incoherent_dbm = -60.0;
      }
    }
    const CombinedMap map = combine_maps(maps);
    const Scene scene = scene_with({"a", "b"});
    const Frame frame = scene.frame_at(0.0);
    const test::TemporaryFolder folder;
    io::write_heat_map(io::map_picture(maps[0], scene, frame, 30e9), folder / "a.png");
    io::write_heat_map(io::best_server_picture(map, scene, frame, 30e9), folder / "b.png");
    io::write_heat_map(io::sinr_picture(map, scene, frame, 30e9, true), folder / "c.png");
    for (const std::string& name : folder.names()) CHECK(test::read_png(folder / name).width > 700);
    const std::vector<io::LineChart> charts = io::map_distribution_charts(maps, map);
    CHECK((charts[0].title.find("nothing arrives") != std::string::npos) == empty);
    REQUIRE(charts.size() == (empty ? 1 : 2));
    if (io::can_draw()) CHECK_NOTHROW(io::write_line_charts(charts, folder / "d.svg"));
  }
}

TEST_CASE("a histogram sums to the share of members that have a value, and the cumulated line ends at 100 %") {
  io::Distribution part{"one", {}, 25};
  for (int index = 0; index < 75; ++index) part.values.push_back(-100.0 + 0.5 * index);
  const auto charts = io::distribution_charts({"title", "power", "dBm"}, std::span(&part, 1));
  REQUIRE(charts.size() == 2);
  const io::LineChart::Series &bins = charts[0].series.at(0), &sums = charts[1].series.at(0);
  double total_percent = 0.0;
  for (std::size_t point = 1; point + 1 < bins.x.size(); point += 2) {
    CHECK(bins.x[point + 1] - bins.x[point] == doctest::Approx(1.0));  // 37 dB in at most 60 bins of 1, 2 or 5
    CHECK(bins.y[point] == bins.y[point + 1]);                         // a step
    total_percent += bins.y[point];
  }
  CHECK(total_percent == doctest::Approx(75.0).epsilon(1e-12));
  CHECK(bins.y.front() == 0.0);
  CHECK(bins.y.back() == 0.0);
  CHECK(sums.y.front() == doctest::Approx(26.0));  // the 25 without a value, and the lowest one
  CHECK(sums.y.back() == 100.0);
  CHECK(std::is_sorted(sums.y.begin(), sums.y.end()));
  // Half of the 75 values are at most -81.75 dBm.
  const auto middle = std::lower_bound(sums.x.begin(), sums.x.end(), -81.74) - sums.x.begin();
  CHECK(sums.y[static_cast<std::size_t>(middle)] == doctest::Approx(25.0 + 37.0));
}

TEST_CASE("more distributions than a chart has colours are spread over several") {
  std::vector<io::Distribution> parts;
  for (int index = 0; index < 9; ++index) parts.push_back({"tx" + std::to_string(index), {1.0 * index, 2.0}, 0});
  parts.push_back({"without", {std::nan("")}, 3});
  const auto charts = io::distribution_charts({"title", "power", "dBm"}, parts);
  REQUIRE(charts.size() == 4);
  CHECK(charts[0].series.size() == 7);
  CHECK(charts[2].series.size() == 2);
  CHECK(io::distribution_charts({"title", "power", "dBm"}, std::span(parts).last(1)).empty());
}

TEST_CASE("roofs that look to the north-west are bright, to the south-east dark, and level ones in between") {
  Scene scene;
  scene.add_material({"roof", PerfectConductor{}});
  TriangleMesh roofs;
  // Over x from 0 to 10: falling to the north-west; from 20 to 30: to the south-east; from 40 to 50: level.
  add_quad(roofs, {Vec3(0, 0, 8), Vec3(10, 0, 12), Vec3(10, 10, 8), Vec3(0, 10, 4)}, "roof");
  add_quad(roofs, {Vec3(20, 0, 8), Vec3(30, 0, 4), Vec3(30, 10, 8), Vec3(20, 10, 12)}, "roof");
  add_quad(roofs, {Vec3(40, 0, 8), Vec3(50, 0, 8), Vec3(50, 10, 8), Vec3(40, 10, 8)}, "roof");
  add_quad(roofs, {Vec3(0, 0, 1), Vec3(50, 0, 1), Vec3(50, 10, 1), Vec3(0, 10, 1)}, "roof");  // lower than the map
  scene.set_scenery(roofs);
  const ReceiverGrid grid{"area", {0.5, 0.5, 1.5}, {1, 1}, {50, 10}, {}};
  const io::Relief relief = io::map_relief(grid, scene);
  REQUIRE(relief.columns == 1280);
  REQUIRE(relief.rows == 256);
  REQUIRE(relief.tones.size() == relief.columns * relief.rows);
  const auto tone_at = [&](double x_m, double y_m) {
    return relief.tones[static_cast<std::size_t>(y_m * 25.6) * relief.columns + static_cast<std::size_t>(x_m * 25.6)];
  };
  // Slopes of 0.4 along both axes; the light comes from (-1/2, 1/2, 1/sqrt(2)).
  const double upright = std::sqrt(1.0 + 2.0 * 0.16);
  CHECK(tone_at(5.0, 5.0) == doctest::Approx((0.4 + std::sqrt(0.5)) / upright).epsilon(1e-4));
  CHECK(tone_at(25.0, 5.0) == doctest::Approx((-0.4 + std::sqrt(0.5)) / upright).epsilon(1e-4));
  CHECK(tone_at(45.0, 5.0) == doctest::Approx(std::sqrt(0.5)).epsilon(1e-5));
  CHECK(tone_at(15.0, 5.0) == doctest::Approx(std::sqrt(0.5)).epsilon(1e-5));  // the ground
  for (const float tone : relief.tones) REQUIRE((tone >= 0.0F && tone <= 1.0F));
}

TEST_CASE("light and shade show in hatched cells alone") {
  const RadioMap map = small_map("bs", -60.0);
  const Scene scene = scene_with({"bs"});
  io::HeatMap picture = io::map_picture(map, scene, scene.frame_at(0.0), 30e9);
  const io::Image plain = io::draw_cells(picture);
  picture.relief = {1, 1, {0.0F}};
  const io::Image shaded = io::draw_cells(picture);
  const int width = plain.width(), height = plain.height();
  long changed = 0, changed_elsewhere = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const bool is_hatched = x >= width * 2 / 3 && y < height / 2;  // point 5, the upper right one
      (is_hatched ? changed : changed_elsewhere) += plain.pixel(x, y) == shaded.pixel(x, y) ? 0 : 1;
    }
  }
  CHECK(changed_elsewhere == 0);
  CHECK(changed > width * height / 6 * 3 / 4);  // all but the lines
}

}  // namespace test_map_files
