#include "dcem/io/result_writer.hpp"

#include <doctest/doctest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "dcem/core/random.hpp"
#include "dcem/io/src/text/number_text.hpp"
#include "dcem/io/summary.hpp"
#include "tests/io/temporary_folder.hpp"

namespace test_result_writer {

using namespace dcem;

namespace {

// A floor, and a box whose id and material need quoting.
Scene small_scene() {
  Scene scene;
  scene.add_material({"floor", ConstantReflection{0.5, std::nullopt}});
  scene.add_material({"sheet \"thin\"", ConstantReflection{0.5, 6.0}});
  TriangleMesh floor;
  add_quad(floor, {Vec3(-50, -50, 0), Vec3(50, -50, 0), Vec3(50, 50, 0), Vec3(-50, 50, 0)}, "floor");
  scene.set_scenery(floor);
  scene.add_object("car, red", make_box({4, 2, 1.5}, "sheet \"thin\""), LinearMotion{});
  scene.add_transmitter(device_at("mast, west", {0, 0, 10}, 20.0));
  scene.add_receiver(device_at("ue", {3, 0, 10}));
  scene.add_receiver(device_at("far", {30, 0, 10}));
  return scene;
}

PathContribution line_of_sight_path() {
  PathContribution path;
  path.path.length_m = 3.0;
  path.transfer(0, 0) = {0.25, -0.0};
  path.transfer(1, 1) = {-0.25, 0.0};
  path.amplitude = {0.25, 0.0};
  path.power_ratio = 0.01;
  path.delay_s = 1e-8;
  path.departure = {0.0, 1.5};
  path.arrival = {3.0, 1.5};
  path.doppler_hz = -0.0;
  return path;
}

PathContribution path_over_floor_and_through_car() {
  PathContribution path;
  path.path.length_m = 4.5;
  path.path.interactions = {{InteractionKind::reflection, FacetId(0), {0.1, -0.2, 0}},
                            {InteractionKind::transmission, FacetId(1), {1, 2, 1e-30}}};
  path.has_amplitude = false;
  path.power_ratio = 0.001;
  path.delay_s = 1.5e-8;
  path.doppler_hz = 812.5;
  return path;
}

FrameResult small_frame() {
  FrameResult frame;
  frame.index = 7;
  frame.time_s = 0.7;
  LinkResult link;
  link.complete = true;
  link.paths = {line_of_sight_path(), path_over_floor_and_through_car()};
  link.statistics.line_of_sight = true;
  link.statistics.path_count = 2;
  link.statistics.power_dbm = 0.5;
  link.statistics.first_delay_s = 1e-8;
  link.statistics.rms_doppler_spread_hz = 0.0;
  frame.links.push_back(link);
  LinkResult dark;
  dark.receiver = 1;
  frame.links.push_back(dark);
  return frame;
}

struct Written {
  std::vector<std::string> names;
  std::string paths, links, profile;
};

Written written(const FrameResult& frame, const io::OutputSettings& output) {
  const test::TemporaryFolder folder;
  const Scene scene = small_scene();
  io::OutputFolder out(folder.path());
  io::ResultWriter writer(out, scene, scene.receivers(), io::ResultFacts{Discovery::exact}, output);
  writer.write(frame);
  out.commit();
  return {folder.names(), test::file_bytes(folder / "paths.jsonl"), test::file_bytes(folder / "links.csv"),
          test::file_bytes(folder / "pdp.csv")};
}

std::string number_text(double value) {
  std::string text;
  io::append_number(text, value);
  return text;
}

std::vector<std::string> split(const std::string& line, char separator) {
  std::vector<std::string> parts{""};
  for (const char character : line) {
    if (character == separator) {
      parts.emplace_back();
    } else {
      parts.back().push_back(character);
    }
  }
  return parts;
}

}  // namespace

TEST_CASE("a path's line holds what the contract names, in its order") {
  const Written files = written(small_frame(), {true, true, true, 1e-9, PdpMode::incoherent});
  const std::string expected =
      R"({"frame":7,"time_s":0.7,"tx":"mast, west","rx":"ue","complete":true,"paths":[)"
      R"({"id":"LOS","kinds":"","points_m":[],"objects":[],"materials":[],"length_m":3,"delay_s":1e-08,)"
      R"("found_by":"exact","transfer":[[[0.25,0],[0,0]],[[0,0],[-0.25,0]]],"amplitude":[0.25,0],)"
      R"("path_gain_db":-20,"received_power_dbm":0,"departure":{"azimuth_rad":0,"zenith_rad":1.5},)"
      R"("arrival":{"azimuth_rad":3,"zenith_rad":1.5},"doppler_hz":0},)"
      R"({"id":"R0/T0@car, red","kinds":"RT","points_m":[[0.1,-0.2,0],[1,2,1e-30]],"objects":["","car, red"],)"
      R"("materials":["floor","sheet \"thin\""],"length_m":4.5,"delay_s":1.5e-08,)"
      R"("found_by":"exact","transfer":[[[0,0],[0,0]],[[0,0],[0,0]]],"amplitude":null,)"
      R"("path_gain_db":-30,"received_power_dbm":-10,"departure":{"azimuth_rad":0,"zenith_rad":0},)"
      R"("arrival":{"azimuth_rad":0,"zenith_rad":0},"doppler_hz":812.5}]})"
      "\n"
      R"({"frame":7,"time_s":0.7,"tx":"mast, west","rx":"far","complete":false,"paths":[]})"
      "\n";
  CHECK(files.paths == expected);
}

TEST_CASE("of the strongest alone a line says how many there are; of equals the first ones, in the usual order") {
  FrameResult frame = small_frame();
  std::vector<PathContribution>& paths = frame.links[0].paths;
  paths = {paths[1], paths[0], paths[1], paths[0], paths[1]};
  for (std::size_t place = 0; place < 5; ++place) paths[place].delay_s = 1.0 + static_cast<double>(place);
  const auto delays = [&](std::size_t top) {
    io::OutputSettings output;
    output.paths = true;
    output.paths_top = top;
    const std::string text = written(frame, output).paths;
    CHECK(split(text, '\n').at(1).find(R"("complete":false,"paths_in_all":0,"paths":[])") != std::string::npos);
    const std::string line = split(text, '\n').front();
    CHECK(line.find(R"("complete":true,"paths_in_all":5,"paths":[)") != std::string::npos);
    std::string listed;
    for (std::size_t at = line.find("\"delay_s\":"); at != std::string::npos; at = line.find("\"delay_s\":", at + 1)) {
      listed += line[at + 10];
    }
    return listed;
  };
  CHECK(delays(1) == "2");
  CHECK(delays(2) == "24");
  CHECK(delays(3) == "124");
  CHECK(delays(4) == "1234");
  CHECK(delays(9) == "12345");
}

TEST_CASE("a path between arrays has its channel beside the amplitude: receiving element, then transmitting one") {
  FrameResult frame = small_frame();
  ChannelMatrix& channel = frame.links[0].paths[0].channel;
  channel = ChannelMatrix(2, 3);
  for (std::size_t entry = 0; entry < 6; ++entry) channel(entry / 3, entry % 3) = {double(entry), -0.5};
  const Written files = written(frame, {true, false, false, 1e-9, PdpMode::incoherent});
  const std::string expected =
      R"("amplitude":[0.25,0],"channel":[[[0,-0.5],[1,-0.5],[2,-0.5]],[[3,-0.5],[4,-0.5],[5,-0.5]]],"path_gain_db":-20,)";
  CHECK(files.paths.find(expected) != std::string::npos);
  CHECK(files.paths.find(R"("amplitude":null,"path_gain_db")") != std::string::npos);  // the other path has none
}

TEST_CASE("links.csv has the contract's columns, and empty fields where nothing is defined") {
  const Written files = written(small_frame(), {false, true, false, 1e-9, PdpMode::incoherent});
  const std::vector<std::string> lines = split(files.links, '\n');
  REQUIRE(lines.size() == 4);
  // The header as contract section 4 has it.
  CHECK(lines[0] ==
        "frame,time_s,tx,rx,line_of_sight,path_count,complete,valid_until_m,power_dbm,power_incoherent_dbm,"
        "power_los_dbm,power_reflected_dbm,power_transmitted_dbm,power_diffracted_dbm,power_diffuse_dbm,path_gain_db,"
        "first_delay_s,mean_delay_s,rms_delay_spread_s,k_factor_db,azimuth_spread_arrival_rad,"
        "azimuth_spread_departure_rad,mean_doppler_hz,rms_doppler_spread_hz,zenith_spread_arrival_rad,"
        "zenith_spread_departure_rad,coherence_bandwidth_hz,coherence_time_s");
  CHECK(lines[1] == "7,0.7,\"mast, west\",ue,1,2,1,,0.5,,,,,,,,1e-08,,,,,,,0,,,,");
  CHECK(lines[2] == "7,0.7,\"mast, west\",far,0,0,0,,,,,,,,,,,,,,,,,,,,,");
  // As many fields as columns, for a line whose ids need no quotes.
  CHECK(split(lines[2], ',').size() == split(lines[0], ',').size() + 1);  // one comma stands inside the quotes
  CHECK(files.names == std::vector<std::string>{"links.csv"});
}

TEST_CASE("pdp.csv has a line per bin that holds power") {
  const Written files = written(small_frame(), {false, false, true, 1e-8, PdpMode::incoherent});
  // Both paths fall into the bin from 10 to 20 ns: 0.01 + 0.001 of 20 dBm (10 log10(0.011) + 20 by hand).
  const std::vector<std::string> lines = split(files.profile, '\n');
  REQUIRE(lines.size() == 3);
  CHECK(lines[0] == "frame,tx,rx,delay_s,power_dbm");
  CHECK(lines[1].starts_with("7,\"mast, west\",ue,1e-08,"));
  CHECK(std::stod(lines[1].substr(lines[1].rfind(',') + 1)) == doctest::Approx(0.41392685158225).epsilon(1e-12));
}

TEST_CASE("a number reads back as the same double, from the fewest digits") {
  RandomStream random(hash_values(3, 5));
  int tried = 0;
  for (int round = 0; round < 20000; ++round) {
    const auto value = std::bit_cast<double>(random.next());
    if (!std::isfinite(value)) continue;
    const std::string text = number_text(value);
    REQUIRE(std::strtod(text.c_str(), nullptr) == value);
    REQUIRE(text.size() <= 24);  // sign, 17 digits, point, e, sign and three digits of the exponent
    ++tried;
  }
  CHECK(tried > 19000);
  CHECK(number_text(0.1) == "0.1");
  CHECK(number_text(-0.0) == "0");
  CHECK(number_text(30e9) == "3e+10");
}

TEST_CASE("no file ever holds NaN or infinity") {
  CHECK(number_text(std::numeric_limits<double>::quiet_NaN()).empty());
  CHECK(number_text(-std::numeric_limits<double>::infinity()).empty());
  FrameResult frame = small_frame();
  frame.links[0].paths[0].power_ratio = 0.0;  // its gain in dB is minus infinity
  frame.links[0].paths[0].doppler_hz = std::numeric_limits<double>::quiet_NaN();
  frame.links[0].statistics.power_dbm = -std::numeric_limits<double>::infinity();
  const Written files = written(frame, {true, true, true, 1e-9, PdpMode::incoherent});
  CHECK(files.paths.find(R"("path_gain_db":null,"received_power_dbm":null)") != std::string::npos);
  CHECK(files.paths.find(R"("doppler_hz":null)") != std::string::npos);
  for (const std::string& text : {files.paths, files.links, files.profile}) {
    CHECK(text.find("nan") == std::string::npos);
    CHECK(text.find("inf") == std::string::npos);
  }
}

TEST_CASE("a field with a comma, a quote or a line end is quoted as RFC 4180 says") {
  CHECK(io::csv_field("area[0,1]") == "\"area[0,1]\"");
  CHECK(io::csv_field("a \"b\"") == "\"a \"\"b\"\"\"");
  CHECK(io::csv_field("two\nlines") == "\"two\nlines\"");
  CHECK(io::csv_field("plain [m]") == "plain [m]");
}

TEST_CASE("an id that is not UTF-8 still gives JSON") {
  Scene scene;
  scene.add_transmitter(device_at("m\xfcnchen", {0, 0, 10}));
  scene.add_receiver(device_at("ue", {3, 0, 10}));
  const test::TemporaryFolder folder;
  io::OutputFolder out(folder.path());
  io::ResultWriter writer(out, scene, scene.receivers(), io::ResultFacts{Discovery::sampled},
                          {true, false, false, 1e-9, {}});
  FrameResult frame;
  frame.links.emplace_back();
  writer.write(frame);
  out.commit();
  CHECK(test::file_bytes(folder / "paths.jsonl").find("m\xef\xbf\xbdnchen") != std::string::npos);
}

TEST_CASE("the summary counts, and says which discovery was used") {
  const Scene scene = small_scene();
  io::RunFacts facts{"1.2.3", "town", {}, Discovery::sampled, CacheMode::seed, {0.0, 0.1, 10}, 2, {"odd thing"}};
  io::RunSummary summary(facts, scene);
  FrameResult frame = small_frame();
  frame.update_time_s = 0.05;
  frame.solve_time_s = 0.15;
  frame.work.rays = 2000;
  summary.add(io::figures_of(frame));
  summary.add(io::figures_of(frame));
  const std::string json = summary.json();
  // Step 0.1 s over 0.05 s + 0.15 s.
  for (const char* part : {R"("version": "1.2.3")", R"("real_time_factor": 0.5)", R"("discovery": "sampled")",
                           R"("discovery_asked_for": "automatic")", R"("cache": "seed")", R"("max_diffractions": 1)",
                           R"("rays": 4000)", R"("links": 4)", R"("paths": 4)", R"("odd thing")", R"("triangles": 14)",
                           R"("closed_shells": 1)", R"("model": "constant")"}) {
    CAPTURE(part);
    CHECK(json.find(part) != std::string::npos);
  }
  const std::string table = summary.table("out/town");
  for (const char* part : {"200 ms median", "4 (2.0 per frame, 1.0 per link)", "sampled", "out/town", "0.500"}) {
    CAPTURE(part);
    CHECK(table.find(part) != std::string::npos);
  }
}

}  // namespace test_result_writer
