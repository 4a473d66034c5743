/// viewer.html read back: its arrays are decoded here and compared with the results that went in.
#include "dcem/io/viewer_writer.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <stdexcept>

#include "tests/io/temporary_folder.hpp"

namespace test_viewer_writer {

using namespace dcem;
using test::file_bytes;
using test::TemporaryFolder;

#define DCEM_NEEDS_VIEWER()                                                       \
  if (!io::viewer_is_built_in()) {                                                \
    MESSAGE("skipped: this build has no viewer (three.js was not there for it)"); \
    return;                                                                       \
  }

namespace {

const std::string hostile = "</script><script>alert(1)</script>";

Scene small_scene() {
  Scene scene;
  scene.add_material({"ground", ConstantReflection{0.5, std::nullopt}});
  scene.add_material({"metal", PerfectConductor{}});
  TriangleMesh ground;
  add_quad(ground, {Vec3(400000, 0, 0), Vec3(400100, 0, 0), Vec3(400100, 50, 0), Vec3(400000, 50, 0)}, "ground");
  scene.set_scenery(ground);
  scene.add_object("car", make_box({4, 2, 1.5}, "metal"), LinearMotion{{Vec3(400010, 5, 0)}, Vec3(10, 0, 0), 0.0});
  scene.add_object("<!--<script>", make_box({4, 2, 1.5}, "metal"), LinearMotion{{Vec3(400050, 5, 0)}, Vec3(0.0), 0.0});
  scene.add_transmitter(device_at("mast", {400020, 20, 10}, 30.0));
  scene.add_receiver(device_at(hostile, {400030, 20, 1.5}));
  return scene;
}

/// A path whose numbers say which one it is; `strength` 0 is the strongest.
PathContribution path_of_strength(int strength) {
  PathContribution path;
  path.path.interactions = {
      {InteractionKind::reflection, FacetId(0), {400020.0 + strength, 20.5, 0.25}, WedgeId{}, false}};
  path.path.length_m = 10.0 + strength;
  path.delay_s = path.path.length_m / speed_of_light_mps;
  path.power_ratio = std::pow(10.0, -strength - 6.0);
  path.doppler_hz = -3.5 * strength;
  return path;
}

FrameResult result_with(std::size_t index, int paths) {
  FrameResult result;
  result.index = index;
  result.time_s = 0.1 * static_cast<double>(index);
  LinkResult link;
  // In the order of delays, as results are; here it is not the order of powers.
  for (int strength = paths - 1; strength >= 0; --strength) link.paths.push_back(path_of_strength(strength));
  link.statistics = link_statistics(link.paths, 30.0, false);
  result.links.push_back(link);
  return result;
}

struct Page {
  std::string bytes;
  std::vector<std::string> notices;

  std::string between(const std::string& before, const std::string& after) const {
    const std::size_t begin = bytes.find(before);
    REQUIRE(begin != std::string::npos);
    const std::size_t end = bytes.find(after, begin + before.size());
    REQUIRE(end != std::string::npos);
    return bytes.substr(begin + before.size(), end - begin - before.size());
  }
  std::string head() const { return between("id=\"head\">", "</script>"); }

  /// The numbers of an array. Base64 as RFC 4648 has it, little-endian values.
  template <typename Value>
  std::vector<Value> array(const std::string& name) const {
    const std::string text = between("\" id=\"" + name + "\">", "</script>");
    std::string packed;
    std::uint32_t group = 0;
    int bits = 0;
    for (const char character : text) {
      if (character == '=') break;
      const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
      const char* place = std::strchr(digits, character);
      REQUIRE(place != nullptr);
      group = group << 6 | static_cast<std::uint32_t>(place - digits);
      bits += 6;
      if (bits < 8) continue;
      bits -= 8;
      packed.push_back(static_cast<char>(group >> bits & 255U));
    }
    REQUIRE(packed.size() % sizeof(Value) == 0);
    std::vector<Value> values(packed.size() / sizeof(Value));
    if (!values.empty()) std::memcpy(values.data(), packed.data(), packed.size());
    return values;
  }
};

Page page_of(std::size_t frames, int paths, const io::ViewerSettings& settings = {},
             const std::vector<std::string>& notes = {}) {
  const TemporaryFolder folder;
  Scene scene = small_scene();
  io::OutputFolder output(folder.path());
  io::ViewerWriter writer(output, scene, {"drive", 28e9, 0, 0}, settings);
  for (std::size_t index = 0; index < frames; ++index) {
    const Frame frame = scene.frame_at(0.1 * static_cast<double>(index), index);
    scene.apply(frame);
    writer.add(frame, result_with(index, paths));
  }
  Page page;
  page.notices = writer.finish(notes);
  CHECK(folder.names() != std::vector<std::string>{"viewer.html"});  // not before the whole folder is complete
  output.commit();
  CHECK(folder.names() == std::vector<std::string>{"viewer.html"});
  page.bytes = file_bytes(folder / "viewer.html");
  return page;
}

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

}  // namespace

TEST_CASE("the page gives back lengths, gains, points, Doppler and poses of the results") {
  DCEM_NEEDS_VIEWER();
  const Page page = page_of(3, 2);
  CHECK(page.array<std::uint32_t>("frame_index") == std::vector<std::uint32_t>{0, 1, 2});
  const auto times_s = page.array<double>("frame_time");
  REQUIRE(times_s.size() == 3);
  CHECK(times_s[2] == 0.2);
  CHECK(page.array<std::uint32_t>("link_rays") == std::vector<std::uint32_t>{2, 2, 2});
  // Strongest first: lengths 10 and 11 m, −60 and −70 dB.
  CHECK(page.array<float>("ray_length") == std::vector<float>{10, 11, 10, 11, 10, 11});
  CHECK(page.array<float>("ray_gain") == std::vector<float>{-60, -70, -60, -70, -60, -70});
  CHECK(page.array<float>("ray_doppler") == std::vector<float>{0, -3.5F, 0, -3.5F, 0, -3.5F});
  // The ground's middle is (400050, 25): points count from there, so that single precision holds them.
  const auto points = page.array<float>("ray_points");
  REQUIRE(points.size() == 18);
  CHECK(std::vector<float>(points.begin(), points.begin() + 6) ==
        std::vector<float>{-30, -4.5F, 0.25F, -29, -4.5F, 0.25F});
  CHECK(page.array<std::uint32_t>("link_paths") == std::vector<std::uint32_t>{2, 2, 2});
  CHECK(page.array<float>("link_diffuse").size() == 3);
  CHECK(std::isnan(page.array<float>("link_diffuse")[0]));  // none computed
}

TEST_CASE("a pose stands in the frames in which it changes, and the shape of two equal cars once") {
  DCEM_NEEDS_VIEWER();
  const Page page = page_of(3, 1);
  // Things: 1 the car that drives, 2 the one that stands, 3 the transmitter, 4 the receiver.
  CHECK(page.array<std::uint32_t>("frame_poses") == std::vector<std::uint32_t>{4, 1, 1});
  CHECK(page.array<std::uint32_t>("pose_thing") == std::vector<std::uint32_t>{1, 2, 3, 4, 1, 1});
  const auto poses = page.array<float>("pose");
  REQUIRE(poses.size() == 36);
  CHECK(poses[0] == -40.0F);
  CHECK(poses[24] == -39.0F);  // 10 m/s for 0.1 s
  CHECK(poses[30] == -38.0F);
  // 2 triangles of the ground, 12 of the box.
  CHECK(page.array<std::uint32_t>("triangle_material").size() == 14);
  CHECK(page.array<std::uint32_t>("triangles").size() == 42);
  CHECK(page.array<float>("vertices").size() == 3 * (4 + 8));
}

TEST_CASE("no name of the user ends a script or becomes an element") {
  DCEM_NEEDS_VIEWER();
  const Page page = page_of(1, 1);
  CHECK(page.bytes.find(hostile) == std::string::npos);
  CHECK(page.head().find('<') == std::string::npos);
  CHECK(page.head().find("\\u003c/script>") != std::string::npos);
  // Each script that begins also ends, and nothing is loaded from elsewhere.
  CHECK(count_of(page.bytes, "<script") == count_of(page.bytes, "</script>"));
  CHECK(page.bytes.find(" src=") == std::string::npos);
  CHECK(page.bytes.find("default-src 'none'") != std::string::npos);
}

TEST_CASE("frames are thinned evenly and the page says so") {
  DCEM_NEEDS_VIEWER();
  const Page page = page_of(100, 1, {400'000, 20});
  const auto indices = page.array<std::uint32_t>("frame_index");
  REQUIRE(indices.size() == 13);
  for (std::size_t place = 0; place < indices.size(); ++place) CHECK(indices[place] == 8 * place);
  REQUIRE(page.notices.size() == 1);
  CHECK(page.notices[0] == "one of every 8 of 100 frames is shown");
  CHECK(page.head().find(page.notices[0]) != std::string::npos);
}

TEST_CASE("of each link the strongest paths are kept, as many as fit, and the page says so") {
  DCEM_NEEDS_VIEWER();
  // 10 frames with one link of 30 paths each; 125 rays fit: 12 per link.
  const Page page = page_of(10, 30, {125, 100});
  CHECK(page.array<std::uint32_t>("link_rays") == std::vector<std::uint32_t>(10, 12));
  CHECK(page.array<std::uint32_t>("link_listed") == std::vector<std::uint32_t>(10, 30));
  const auto lengths_m = page.array<float>("ray_length");
  REQUIRE(lengths_m.size() == 120);
  for (std::size_t ray = 0; ray < 120; ++ray) CHECK(lengths_m[ray] == 10.0F + static_cast<float>(ray % 12));
  REQUIRE(page.notices.size() == 1);
  CHECK(page.notices[0] == "the 12 strongest of up to 30 paths per link are shown");
}

TEST_CASE("the page says what is said of the results, apart from what it leaves out") {
  const std::vector<std::string> notes{"sampled: 2000 rays find 58 % of the paths", "powers lack 1.2 dB in the median"};
  const Page page = page_of(2, 3, {}, notes);
  CHECK(page.notices.empty());
  CHECK(
      page.head().find(R"("notes":["sampled: 2000 rays find 58 % of the paths","powers lack 1.2 dB in the median"])") !=
      std::string::npos);
  CHECK(page_of(2, 3).head().find(R"("notes":[])") != std::string::npos);
}

TEST_CASE("frames go before a link keeps fewer than eight paths; a pose survives the frame that is dropped") {
  DCEM_NEEDS_VIEWER();
  // 40 rays: five links with eight paths each, of 16 frames.
  const Page page = page_of(16, 30, {40, 100});
  const auto indices = page.array<std::uint32_t>("frame_index");
  CHECK(indices == std::vector<std::uint32_t>{0, 4, 8, 12});
  const auto rays = page.array<std::uint32_t>("link_rays");
  for (const std::uint32_t count : rays) CHECK(count >= 8);
  // The car drives 1 m per frame: it must be at 4 m per kept frame, whatever was dropped in between.
  const auto things = page.array<std::uint32_t>("pose_thing");
  const auto poses = page.array<float>("pose");
  std::vector<float> x_m;
  for (std::size_t entry = 0; entry < things.size(); ++entry) {
    if (things[entry] == 1) x_m.push_back(poses[6 * entry]);
  }
  CHECK(x_m == std::vector<float>{-40, -36, -32, -28});
}

TEST_CASE("the same results give the same bytes") {
  DCEM_NEEDS_VIEWER();
  CHECK(page_of(7, 5, {60, 5}).bytes == page_of(7, 5, {60, 5}).bytes);
}

TEST_CASE("what paths touch stands in the page once, in the axes of its object") {
  DCEM_NEEDS_VIEWER();
  const TemporaryFolder folder;
  Scene scene = small_scene();
  io::OutputFolder output(folder.path());
  io::ViewerWriter writer(output, scene, {"drive", 28e9, 0, 0}, {});
  const auto is_of_car = [&](const WorldWedge& wedge) { return scene.body_name(wedge.body) == "car"; };
  const auto edge = std::find_if(scene.wedges().begin(), scene.wedges().end(), is_of_car);
  REQUIRE(edge != scene.wedges().end());
  const WedgeId wedge(static_cast<std::uint32_t>(edge - scene.wedges().begin()));
  FrameResult result = result_with(0, 2);
  for (PathContribution& path : result.links[0].paths) {
    path.path.interactions.push_back({InteractionKind::diffraction, edge->facets[0], Vec3(400010, 5, 0), wedge, false});
  }
  // The car stands across: in the world its normals and edges are others than in its own axes.
  Frame frame = scene.frame_at(0.0, 0);
  frame.bodies[1].placement.pose.yaw_rad = pi / 3;
  scene.apply(frame);
  writer.add(frame, result);
  writer.finish();
  output.commit();
  const Page page{file_bytes(folder / "viewer.html"), {}};
  // Both paths have the same kinds and surfaces, so they are one to the page.
  CHECK(page.array<std::uint32_t>("ray_path") == std::vector<std::uint32_t>{0, 0});
  CHECK(page.array<std::uint32_t>("path_surfaces") == std::vector<std::uint32_t>{0, 1});
  CHECK(page.array<std::uint32_t>("surface_material") == std::vector<std::uint32_t>{0, 1});
  const auto objects = page.array<std::uint32_t>("surface_object");
  REQUIRE(objects.size() == 2);
  CHECK(objects[0] == 0);
  CHECK(page.head().find(R"("names":["","car",)") != std::string::npos);
  CHECK(objects[1] == 1);
  const auto axes = page.array<float>("surface_axes");
  REQUIRE(axes.size() == 12);
  CHECK(std::abs(axes[2]) == 1.0F);  // the ground
  CHECK(std::vector<float>(axes.begin() + 3, axes.begin() + 6) == std::vector<float>{0, 0, 0});
  const Wedge& own = scene.body(BodyId(1)).mesh.wedges[scene.wedge_number(wedge)];
  const Vec3 along = edge_direction(own);
  for (int axis = 0; axis < 3; ++axis) {
    CHECK(axes[static_cast<std::size_t>(6 + axis)] == static_cast<float>(own.normal[axis]));
    CHECK(axes[static_cast<std::size_t>(9 + axis)] == static_cast<float>(along[axis]));
  }
  CHECK(page.array<float>("surface_exterior") == std::vector<float>{0, 270});
}

namespace {

/// −60, −61 … dBm; nothing at the last point, and the one before it is inside an object.
RadioMap map_of(MapPlaces places, const std::string& transmitter, double first_dbm = -60.0) {
  RadioMap map{std::move(places), transmitter, {}};
  map.points.resize(map.places.size());
  for (std::size_t point = 0; point < map.points.size(); ++point) {
    map.points[point].position_m = Vec3(400000.0 + static_cast<double>(point), 25, 1.5);
    map.points[point].statistics.power_incoherent_dbm = first_dbm - static_cast<double>(point);
  }
  map.points.back().statistics.power_incoherent_dbm.reset();
  RadioMapPoint& inside = map.points[map.points.size() - 2];
  inside.obstructed = true;
  inside.statistics.power_incoherent_dbm.reset();
  return map;
}

Page page_of_maps(const std::vector<std::vector<RadioMap>>& frames, std::optional<double> noise_dbm = {},
                  const io::ViewerSettings& settings = {}, std::size_t values_per_frame = 6) {
  const TemporaryFolder folder;
  Scene scene = small_scene();
  io::OutputFolder output(folder.path());
  io::ViewerWriter writer(output, scene, {"area", 28e9, 0, values_per_frame}, settings);
  for (std::size_t index = 0; index < frames.size(); ++index) {
    writer.add(scene.frame_at(0.1 * static_cast<double>(index), index), FrameResult{});
    writer.add(frames[index], combine_maps(frames[index], noise_dbm), noise_dbm.has_value());
  }
  Page page;
  page.notices = writer.finish();
  output.commit();
  page.bytes = file_bytes(folder / "viewer.html");
  return page;
}

const ReceiverGrid area{"area", {400040, 10, 1.5}, {2.0, 1.0}, {3, 2}, {}};

}  // namespace

TEST_CASE("a map stands in the page point by point, with what is inside an object marked") {
  DCEM_NEEDS_VIEWER();
  const Page page = page_of_maps({{map_of(area, "mast")}});
  CHECK(page.notices.empty());
  const auto values = page.array<float>("map_values");
  REQUIRE(values.size() == 6);
  for (std::size_t point = 0; point < 4; ++point) CHECK(values[point] == -60.0F - static_cast<float>(point));
  CHECK(std::isnan(values[4]));
  CHECK(std::isnan(values[5]));
  CHECK(page.array<std::uint32_t>("map_obstructed") == std::vector<std::uint32_t>{1U << 4});
  // The corner of the first cell, from the ground's middle (400050, 25): half a spacing before the origin.
  CHECK(page.head().find(
            R"("corner_m":[-11.0,-15.5,1.5],"spacing_m":[2.0,1.0],"columns":3,"rows":2,"first_obstructed":0,)"
            R"("layers":[{"shows":"power","first":0,"tx":0}])") != std::string::npos);
}

TEST_CASE("several transmitters have a map each, the best server and the ratio of it to the others") {
  DCEM_NEEDS_VIEWER();
  std::vector<RadioMap> maps{map_of(area, "mast"), map_of(area, "roof", -70.0)};
  maps[1].points[1].statistics.power_incoherent_dbm = -41.0;  // here the second one serves
  const Page page = page_of_maps({maps});
  CHECK(page.head().find(R"("layers":[{"shows":"power","first":0,"tx":0},{"shows":"power","first":6,"tx":1},)"
                         R"({"shows":"best_server","first":12},{"shows":"sir","first":18}])") != std::string::npos);
  const auto values = page.array<float>("map_values");
  REQUIRE(values.size() == 24);
  CHECK(std::vector<float>(values.begin() + 12, values.begin() + 16) == std::vector<float>{0, 1, 0, 0});
  CHECK(std::isnan(values[16]));
  CHECK(std::isnan(values[17]));
  CHECK(values[18] == 10.0F);
  CHECK(values[19] == 20.0F);
}

TEST_CASE("with noise one transmitter has a SINR, without it only its power") {
  DCEM_NEEDS_VIEWER();
  const Page page = page_of_maps({{map_of(area, "mast")}}, -90.0);
  CHECK(page.head().find(R"({"shows":"sinr","first":6}])") != std::string::npos);
  CHECK(page.head().find("best_server") == std::string::npos);
  CHECK(page.array<float>("map_values")[6] == 30.0F);
  CHECK(page_of_maps({{map_of(area, "mast")}}).head().find("sinr") == std::string::npos);
}

TEST_CASE("a list of points stands in the page with its places, once while it stays where it is") {
  DCEM_NEEDS_VIEWER();
  const RadioMap route = map_of(MapPlaces("route", 4), "mast");
  const Page page = page_of_maps({{route}, {route}});
  const auto points = page.array<float>("map_points");
  CHECK(points == std::vector<float>{-50, 0, 1.5F, -49, 0, 1.5F, -48, 0, 1.5F, -47, 0, 1.5F});
  CHECK(page.array<float>("map_values").size() == 8);
  CHECK(page.head().find(R"({"places":"route","frame":1,"points":4,"first_point":0,"first_obstructed":4,)") !=
        std::string::npos);
}

TEST_CASE("of too large a map every second point is kept, in the middle of a cell that is twice as wide") {
  DCEM_NEEDS_VIEWER();
  // 5 x 4 values, and at most 10 of them.
  const ReceiverGrid wide{"area", {400040, 10, 1.5}, {2.0, 1.0}, {5, 4}, {}};
  const Page page = page_of_maps({{map_of(wide, "mast")}}, {}, {1, 100}, 20);
  const auto values = page.array<float>("map_values");
  CHECK(std::vector<float>(values.begin(), values.begin() + 5) == std::vector<float>{-60, -62, -64, -70, -72});
  CHECK(page.head().find(R"("corner_m":[-12.0,-16.0,1.5],"spacing_m":[4.0,2.0],"columns":3,"rows":2)") !=
        std::string::npos);
  REQUIRE(page.notices.size() == 1);
  CHECK(page.notices[0] == "one of every 2 points of a map along each axis is shown");
}

TEST_CASE("of too long a list every so many points are kept, and the page says so") {
  DCEM_NEEDS_VIEWER();
  // 9 points of three values each, and about 10 values.
  const Page page = page_of_maps({{map_of(MapPlaces("route", 9), "mast")}}, {}, {1, 100});
  const auto values = page.array<float>("map_values");
  CHECK(values.size() == 3);
  CHECK(values[1] == -63.0F);
  REQUIRE(page.notices.size() == 1);
  CHECK(page.notices[0] == "one of every 3 points of a list is shown");
}

TEST_CASE("a build without three.js refuses to make a page") {
  if (io::viewer_is_built_in()) return;
  const TemporaryFolder folder;
  const Scene scene = small_scene();
  io::OutputFolder output(folder.path());
  CHECK_THROWS_AS(io::ViewerWriter(output, scene, {"drive", 28e9, 0, 0}, {}), std::invalid_argument);
}

}  // namespace test_viewer_writer
