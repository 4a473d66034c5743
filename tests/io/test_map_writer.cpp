#include "dcem/io/map_writer.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "dcem/geometry/surfaces/build_surface_mesh.hpp"
#include "dcem/io/inspection.hpp"
#include "tests/io/temporary_folder.hpp"

namespace test_map_writer {

using namespace dcem;

namespace {

Scene scene_with_boxes(const std::vector<std::pair<Vec3, Vec3>>& sizes_and_places) {
  Scene scene;
  scene.add_material({"metal", PerfectConductor{}});
  for (const auto& [size_m, place_m] : sizes_and_places) {
    scene.add_object("box" + std::to_string(scene.bodies().size()), make_box(size_m, "metal"),
                     LinearMotion{{place_m}, Vec3(0.0), 0.0});
  }
  return scene;
}

RadioMap small_map() {
  RadioMap map{ReceiverGrid{"area", {-1, 2, 1.5}, {0.5, 1}, {2, 2}, {}}, "bs", {}};
  for (std::size_t row = 0; row < 2; ++row) {
    for (std::size_t column = 0; column < 2; ++column) {
      map.points.push_back({grid_point_m(map.grid(), row, column), false, {}, {}});
    }
  }
  LinkStatistics& lit = map.points[1].statistics;
  lit.line_of_sight = true;
  lit.path_count = 3;
  lit.power_dbm = -60.0;
  lit.power_incoherent_dbm = -61.5;
  lit.path_gain_db = -90.0;
  lit.mean_delay_s = 2e-8;
  lit.rms_delay_spread_s = 0.0;
  map.points[1].strongest_kinds = "RT";
  map.points[2].obstructed = true;
  return map;
}

// Every end of a segment is the end of exactly one other: the segments form closed outlines.
bool outlines_closed(const std::vector<std::array<double, 4>>& segments_m) {
  std::map<std::pair<double, double>, int> ends;
  for (const auto& segment : segments_m) {
    ++ends[{segment[0], segment[1]}];
    ++ends[{segment[2], segment[3]}];
  }
  return std::all_of(ends.begin(), ends.end(), [](const auto& end) { return end.second == 2; });
}

double total_length_m(const std::vector<std::array<double, 4>>& segments_m) {
  double sum_m = 0.0;
  for (const auto& segment : segments_m) sum_m += std::hypot(segment[2] - segment[0], segment[3] - segment[1]);
  return sum_m;
}

}  // namespace

TEST_CASE("a map's CSV gives coordinates alone for obstructed points and empty fields where nothing arrives") {
  const test::TemporaryFolder folder;
  io::AtomicFile file(folder / "map.csv");
  io::write_map_csv(file, small_map(), 30e9);
  file.commit();
  const std::string text = test::file_bytes(folder / "map.csv");
  const std::size_t field_begin = text.find("-90,") + 4;
  const std::size_t field_end = text.find(',', field_begin);
  // ITU-R P.525-4, equation 9: E = Pr + 20 log10(f/GHz) + 167.2 with Pr in dBW; the constant is rounded to 0.1 dB.
  const double field_dbuv_per_m = std::stod(text.substr(field_begin, field_end - field_begin));
  CHECK(std::abs(field_dbuv_per_m - (-90.0 + 20.0 * std::log10(30.0) + 167.2)) <= 0.05);
  CHECK(text.substr(0, field_begin) + "E" + text.substr(field_end) ==
        "x_m,y_m,z_m,power_dbm,power_incoherent_dbm,path_gain_db,field_strength_dbuv_per_m,mean_delay_s,"
        "rms_delay_spread_s,line_of_sight,path_count,strongest_kinds\n"
        "-1,2,1.5,,,,,,,0,0,\n"
        "-0.5,2,1.5,-60,-61.5,-90,E,2e-08,0,1,3,RT\n"
        "-1,3,1.5,,,,,,,,,\n"
        "-0.5,3,1.5,,,,,,,0,0,\n");
}

TEST_CASE("a map's file name holds no separators of folders") {
  CHECK(io::map_name("area", "bs") == "map_area_bs");
  CHECK(io::map_name("area", "bs", 12) == "map_area_bs_12");
  CHECK(io::map_name("a/b", "50%") == "map_a%2Fb_50%25");
}

TEST_CASE("walls are the outlines of what the plane of the grid cuts") {
  const Scene scene = scene_with_boxes({{{4, 2, 3}, {10, 20, 0}}});
  const auto walls_m = io::walls_at_height_m(scene, 1.5);
  CHECK(outlines_closed(walls_m));
  CHECK(total_length_m(walls_m) == doctest::Approx(12.0).epsilon(1e-12));  // 2 (4 + 2), rounding of a few sums
  for (const auto& segment : walls_m) {
    CHECK(std::abs(segment[0] - 10) <= 2.0);
    CHECK(std::abs(segment[1] - 20) <= 1.0);
  }
}

TEST_CASE("a plane through corners cuts as one a hair higher") {
  // Bottom and top of boxes in the plane; a roof with its eaves in the plane would do the same.
  const Scene scene = scene_with_boxes({{{4, 2, 3}, {0, 0, 1.5}}, {{4, 2, 1.5}, {20, 0, 0}}});
  const auto walls_m = io::walls_at_height_m(scene, 1.5);
  CHECK(outlines_closed(walls_m));
  CHECK(total_length_m(walls_m) == doctest::Approx(12.0).epsilon(1e-12));
  for (const auto& segment : walls_m) CHECK(segment[0] < 10.0);
}

TEST_CASE("a body that is away has no walls") {
  Scene scene = scene_with_boxes({{{4, 2, 3}, {0, 0, 0}}});
  Frame frame = scene.frame_at(0.0);
  frame.bodies[1].present = false;
  scene.apply(frame);
  CHECK(io::walls_at_height_m(scene, 1.5).empty());
}

TEST_CASE("the picture of a map hatches obstructed points and leaves the others their incoherent power") {
  Scene scene = scene_with_boxes({{{4, 2, 3}, {0, 0, 0}}});
  scene.add_transmitter(device_at("other", {5, 5, 2}));
  scene.add_transmitter(device_at("bs", {1, 2, 2}));
  const io::HeatMap picture = io::map_picture(small_map(), scene, scene.frame_at(0.0), 30e9);
  REQUIRE(picture.values.size() == 4);
  CHECK(picture.columns == 2);
  CHECK(picture.rows == 2);
  CHECK(picture.values[1] == -61.5);
  CHECK(std::isnan(picture.values[0]));
  CHECK(picture.hatched == std::vector<char>{0, 0, 1, 0});
  CHECK(picture.title.find("incoherent") != std::string::npos);
  CHECK(picture.title.find("30 GHz") != std::string::npos);
  REQUIRE(picture.transmitters.size() == 2);
  CHECK(picture.transmitters[0].label == "bs");  // whose map it is
  CHECK(picture.transmitters[0].y_m == 2.0);
  CHECK(picture.transmitters[1].label == "other");
}

TEST_CASE("facets on top of each other are counted, neighbours and steps are not") {
  const auto quad = [](TriangleMesh& mesh, double x0, double x1, double z, const char* material) {
    add_quad(mesh, {Vec3(x0, 0, z), Vec3(x1, 0, z), Vec3(x1, 4, z), Vec3(x0, 4, z)}, material);
  };
  const auto pairs = [](const TriangleMesh& mesh) {
    return io::overlapping_facet_pairs(build_surface_mesh(mesh), SurfaceSettings{});
  };
  TriangleMesh mesh;
  quad(mesh, 0, 10, 0, "a");
  quad(mesh, 10, 20, 0, "b");  // shares an edge
  quad(mesh, 20, 30, 0.1, "b");
  CHECK(pairs(mesh) == 0);
  quad(mesh, 19.9995, 25, 0, "c");  // a sliver of half a millimetre over its neighbour
  CHECK(pairs(mesh) == 0);
  quad(mesh, 5, 12, 0.0005, "c");  // half a millimetre above two others
  CHECK(pairs(mesh) == 2);
}

}  // namespace test_map_writer
