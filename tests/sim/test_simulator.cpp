/// The whole line in memory: who is linked with whom, and what settings do to a link.
#include "dcem/sim/simulator.hpp"
#include "dcem/sim/verify/brute_force_simulator.hpp"

#include <doctest/doctest.h>

#include <atomic>
#include <cstring>
#include <string>
#include <vector>

#include "dcem/paths/path_id.hpp"
#include "tests/paths/small_scenes.hpp"

namespace test_simulator {

using namespace dcem;
using namespace dcem::test;

namespace {

/// An office of glass and walls with a trolley that moves through it.
Scene office() {
  TriangleMesh mesh;
  add_box_faces(mesh, Vec3(0.0), Vec3(9, 6, 3), "opaque");
  add_sheet(mesh, Vec3(4, 3, 1.5), Vec3(0, 2.2, 0), Vec3(0, 0, 1.2), "glass");
  add_sheet(mesh, Vec3(6, 4, 1.5), Vec3(1.2, 0.4, 0), Vec3(0, 0, 1.1), "wall");
  Scene scene = scene_of(mesh);
  scene.add_object("trolley", make_box(Vec3(1, 0.6, 0.9), "metal"),
                   LinearMotion{{Vec3(2, 1.5, 0.05), 0.4, 0, 0}, Vec3(1.0, 0.4, 0), 0});
  return scene;
}

SimulationSettings settings_for(int reflections, int transmissions, unsigned threads = 1) {
  SimulationSettings settings;
  settings.propagation.max_reflections = reflections;
  settings.propagation.max_transmissions = transmissions;
  settings.threads = threads;
  return settings;
}

bool same_bits(const std::optional<double>& a, const std::optional<double>& b) {
  return a.has_value() == b.has_value() && (!a || std::memcmp(&*a, &*b, sizeof(double)) == 0);
}

bool same_bits(const LinkStatistics& a, const LinkStatistics& b) {
  return a.line_of_sight == b.line_of_sight && a.path_count == b.path_count && same_bits(a.power_dbm, b.power_dbm) &&
         same_bits(a.power_incoherent_dbm, b.power_incoherent_dbm) && same_bits(a.power_los_dbm, b.power_los_dbm) &&
         same_bits(a.power_reflected_dbm, b.power_reflected_dbm) &&
         same_bits(a.power_transmitted_dbm, b.power_transmitted_dbm) &&
         same_bits(a.power_diffracted_dbm, b.power_diffracted_dbm) && same_bits(a.path_gain_db, b.path_gain_db) &&
         same_bits(a.first_delay_s, b.first_delay_s) && same_bits(a.mean_delay_s, b.mean_delay_s) &&
         same_bits(a.rms_delay_spread_s, b.rms_delay_spread_s) && same_bits(a.k_factor_db, b.k_factor_db) &&
         same_bits(a.azimuth_spread_arrival_rad, b.azimuth_spread_arrival_rad) &&
         same_bits(a.azimuth_spread_departure_rad, b.azimuth_spread_departure_rad);
}

/// Names, lengths and transfer matrices of all links, as text with all digits.
std::string fingerprint(const Scene& scene, const std::vector<LinkResult>& links) {
  std::string text;
  const auto add = [&](double value) { text.append(reinterpret_cast<const char*>(&value), sizeof value); };
  for (const LinkResult& link : links) {
    text += std::to_string(link.transmitter) + ">" + std::to_string(link.receiver) + (link.complete ? "c" : "s");
    for (const PathContribution& path : link.paths) {
      text += path_id(scene, path.path);
      add(path.path.length_m);
      add(path.doppler_hz);
      for (const auto& row : path.transfer.entries) {
        for (const Complex& entry : row) {
          add(entry.real());
          add(entry.imag());
        }
      }
    }
  }
  return text;
}

bool operator==(const WorkCounters& a, const WorkCounters& b) {
  return a.rays == b.rays && a.legs == b.legs && a.sequences_proposed == b.sequences_proposed &&
         a.sequences_solved == b.sequences_solved && a.paths == b.paths && a.nodes_visited == b.nodes_visited &&
         a.primitives_tested == b.primitives_tested;
}

std::vector<std::string> kinds_of(const LinkResult& link) {
  std::vector<std::string> all;
  for (const PathContribution& path : link.paths) all.push_back(kinds(path.path));
  return all;
}

using Strings = std::vector<std::string>;

}  // namespace

TEST_CASE("links come by transmitter, then receiver, and a device has none with itself") {
  Scene scene = office();
  scene.add_transmitter(device_at("a", Vec3(1, 1, 2)));
  scene.add_transmitter(device_at("b", Vec3(8, 1, 2)));
  scene.add_receiver(device_at("x", Vec3(7, 2, 1)));
  scene.add_receiver(device_at("b", Vec3(8, 1, 2)));
  scene.add_receiver(device_at("y", Vec3(1, 5, 1)));
  Simulator simulator(std::move(scene), settings_for(1, 1));
  const FrameResult result = simulator.advance_to(0.0, 7);
  CHECK(result.index == 7);
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (const LinkResult& link : result.links) pairs.emplace_back(link.transmitter, link.receiver);
  CHECK(pairs == std::vector<std::pair<std::size_t, std::size_t>>{{0, 0}, {0, 1}, {0, 2}, {1, 0}, {1, 2}});
  std::uint64_t paths = 0;
  for (const LinkResult& link : result.links) {
    CHECK(link.complete);
    CHECK(link.statistics.path_count == link.paths.size());
    paths += link.paths.size();
  }
  CHECK(result.work.paths == paths);
}

TEST_CASE("results and work do not depend on the number of threads or on the tree") {
  for (const Discovery discovery : {Discovery::exact, Discovery::sampled}) {
    const auto solve = [&](unsigned threads) {
      Scene scene = office();
      for (int t = 0; t < 3; ++t) scene.add_transmitter(device_at("t" + std::to_string(t), Vec3(1 + 3 * t, 1.2, 2)));
      for (int r = 0; r < 7; ++r) scene.add_receiver(device_at("r" + std::to_string(r), Vec3(0.5 + 1.2 * r, 4.7, 1.1)));
      SimulationSettings settings = settings_for(2, 2, threads);
      settings.propagation.discovery = discovery;
      settings.propagation.rays = 300;
      Simulator simulator(std::move(scene), settings);
      simulator.advance_to(0.0, 0);
      FrameResult result = simulator.advance_to(0.5, 1);
      return std::pair(fingerprint(simulator.scene(), result.links), result.work);
    };
    const auto one = solve(1);
    CHECK(one.first.size() > 10'000);
    CHECK((one.second.rays > 0) == (discovery == Discovery::sampled));
    for (const unsigned threads : {2U, 5U, 0U}) {
      const auto many = solve(threads);
      CHECK(many.first == one.first);
      CHECK(many.second == one.second);
    }
  }
}

TEST_CASE("the tree and its brute-force twin find the same paths, frame after frame") {
  const auto run = [](auto make) {
    Scene scene = office();
    scene.add_transmitter(device_at("t", Vec3(1, 1.2, 2)));
    scene.add_receiver(device_at("r", Vec3(7.4, 4.7, 1.1)));
    auto simulator = make(std::move(scene));
    std::string all;
    for (std::size_t frame = 0; frame < 5; ++frame) {
      all += fingerprint(simulator.scene(), simulator.advance_to(0.7 * static_cast<double>(frame), frame).links);
    }
    return all;
  };
  const auto tree = run([](Scene scene) { return Simulator(std::move(scene), settings_for(2, 2)); });
  const auto brute = run([](Scene scene) { return BruteForceSimulator(std::move(scene), settings_for(2, 2)); });
  CHECK(tree.size() > 2000);
  CHECK(tree == brute);
}

TEST_CASE("a point of a map equals the same receiver solved alone, to the last bit") {
  for (const Discovery discovery : {Discovery::exact, Discovery::sampled}) {
    Scene scene = office();
    scene.add_transmitter(device_at("a", Vec3(1, 1.2, 2), 27.0));
    scene.add_transmitter(device_at("b", Vec3(8, 1.3, 2), 10.0));
    SimulationSettings settings = settings_for(2, 2, 3);
    settings.propagation.discovery = discovery;
    settings.propagation.rays = 200;
    Simulator simulator(std::move(scene), settings);
    simulator.advance_to(0.3, 4);
    ReceiverGrid grid{"area", Vec3(0.25, 0.31, 1.2), {0.9, 0.83}, {10, 7}, {}};
    std::atomic<std::size_t> done{0};
    WorkCounters map_work, solve_work;
    const auto maps = simulator.radio_maps(
        grid, [&](std::size_t points) { done += points; }, &map_work);
    CHECK(done == grid.size());
    REQUIRE(maps.size() == 2);
    std::vector<Device> receivers;
    for (std::size_t row = 0; row < grid.rows(); ++row) {
      for (std::size_t column = 0; column < grid.columns(); ++column)
        receivers.push_back(grid_receiver(grid, row, column));
    }
    const auto links = simulator.solve(receivers, &solve_work);
    REQUIRE(links.size() == 2 * grid.size());
    std::size_t covered = 0;
    for (const LinkResult& link : links) {
      const RadioMapPoint& point = maps[link.transmitter].points[link.receiver];
      CHECK(maps[link.transmitter].transmitter == (link.transmitter == 0 ? "a" : "b"));
      CHECK(point.position_m == grid_point_m(grid, link.receiver / 10, link.receiver % 10));
      CHECK_FALSE(point.obstructed);
      CHECK(same_bits(point.statistics, link.statistics));
      const PathContribution* strongest = nullptr;
      for (const PathContribution& path : link.paths) {
        if (strongest == nullptr || path.power_ratio > strongest->power_ratio) strongest = &path;
      }
      CHECK(point.strongest_kinds == (strongest == nullptr ? "" : kinds(strongest->path)));
      covered += !link.paths.empty();
    }
    CHECK(covered > 100);
    // Without sharing the map takes the same work as well; with it, no more.
    CHECK(map_work.sequences_solved <= solve_work.sequences_solved);
    settings.share_map_work = false;
    Scene again = office();
    again.add_transmitter(device_at("a", Vec3(1, 1.2, 2), 27.0));
    again.add_transmitter(device_at("b", Vec3(8, 1.3, 2), 10.0));
    Simulator apart(std::move(again), settings);
    apart.advance_to(0.3, 4);
    WorkCounters apart_work;
    const auto same_maps = apart.radio_maps(grid, {}, &apart_work);
    CHECK(apart_work == solve_work);
    for (std::size_t cell = 0; cell < grid.size(); ++cell) {
      CHECK(same_bits(same_maps[0].points[cell].statistics, maps[0].points[cell].statistics));
    }
  }
}

TEST_CASE("map points inside a body or on a wall are obstructed and hold nothing") {
  Scene scene = office();
  scene.add_transmitter(device_at("a", Vec3(1, 5, 2)));
  Simulator simulator(std::move(scene), settings_for(1, 1));
  const auto maps = simulator.radio_maps({"area", Vec3(2, 1.5, 0.5), {2.0, 1.5}, {2, 2}, {}});
  const auto& points = maps.at(0).points;
  CHECK(points[0].obstructed);  // in the trolley
  CHECK(points[1].obstructed);  // on the glass
  CHECK_FALSE(points[2].obstructed);
  CHECK(points[0].statistics.path_count == 0);
  CHECK_FALSE(points[0].statistics.power_dbm.has_value());
  CHECK(points[2].statistics.path_count > 0);
  simulator.advance_to(4.0, 1);  // the trolley has gone on
  CHECK_FALSE(simulator.radio_maps({"area", Vec3(2, 1.5, 0.5), {2.0, 1.5}, {1, 1}, {}})[0].points[0].obstructed);
}

TEST_CASE("absent bodies: no link for what rides on them, and nothing of them in the way") {
  Scene scene = scene_of_materials();
  scene.add_object("bus", make_box(Vec3(4, 4, 4), "metal"), {});
  scene.add_object("car", make_box(Vec3(2, 2, 1), "metal"), LinearMotion{{Vec3(6, 0, 0)}, Vec3(0.0), 0});
  scene.add_transmitter(device_at("t", Vec3(-6, 0, 0.7)));
  Device roof = device_at("roof", Vec3(0.0));
  roof.attachment = Attachment{"car", Vec3(0, 0, 1.3), false};
  scene.add_receiver(roof);
  scene.add_receiver(device_at("free", Vec3(9, 0.5, 0.7)));
  Device speaker = device_at("speaker", Vec3(0.0));
  speaker.attachment = Attachment{"bus", Vec3(0, 0, 4.5), false};
  scene.add_transmitter(speaker);
  Simulator simulator(std::move(scene), settings_for(0, 0));
  Frame frame = simulator.scene().frame_at(0.0);
  const auto pairs = [&](const FrameResult& result) {
    Strings all;
    for (const LinkResult& link : result.links) {
      all.push_back(std::to_string(link.transmitter) + std::to_string(link.receiver) +
                    (link.statistics.line_of_sight ? "+" : "-"));
    }
    return all;
  };
  CHECK(pairs(simulator.advance(frame)) == Strings{"00-", "01-", "10+", "11+"});
  frame.bodies[1].present = false;
  CHECK(pairs(simulator.advance(frame)) == Strings{"00+", "01-"});
  frame.bodies[2].present = false;
  CHECK(pairs(simulator.advance(frame)) == Strings{"01+"});
  frame.bodies[1].present = true;
  CHECK(pairs(simulator.advance(frame)) == Strings{"01-", "11+"});
  CHECK_FALSE(simulator.radio_maps({"area", Vec3(6, 0, 0.5), {1, 1}, {1, 1}, {}})[0].points[0].obstructed);
}

TEST_CASE("without line_of_sight the direct path is dropped and the flag stays") {
  TriangleMesh mesh;
  add_sheet(mesh, Vec3(0, 0, 0), Vec3(9, 0, 0), Vec3(0, 9, 0), "glass");
  const auto solve = [&](bool line_of_sight, double receiver_z_m) {
    Scene scene = scene_of(mesh);
    scene.add_transmitter(device_at("t", Vec3(-2, 0.5, 1.5)));
    scene.add_receiver(device_at("r", Vec3(2, 0.5, receiver_z_m)));
    SimulationSettings settings = settings_for(1, 1);
    settings.propagation.line_of_sight = line_of_sight;
    Simulator simulator(std::move(scene), settings);
    return std::move(simulator.advance_to(0.0).links.at(0));
  };
  CHECK(kinds_of(solve(true, 1.5)) == Strings{"", "R"});
  const LinkResult dropped = solve(false, 1.5);
  CHECK(kinds_of(dropped) == Strings{"R"});
  CHECK(dropped.statistics.line_of_sight);
  CHECK(dropped.statistics.path_count == 1);
  CHECK_FALSE(dropped.statistics.power_los_dbm.has_value());
  CHECK_FALSE(dropped.statistics.k_factor_db.has_value());
  CHECK(kinds_of(solve(false, -1.5)) == Strings{"T"});  // a path through a sheet is no line of sight
  CHECK_FALSE(solve(false, -1.5).statistics.line_of_sight);
}

TEST_CASE("min_path_gain_db drops what is weaker, after its field is known, and nothing else") {
  const auto solve = [](std::optional<double> limit_db, PolarizationKind kind = PolarizationKind::vertical) {
    Scene scene = office();
    scene.add_transmitter(device_at("t", Vec3(1, 1.2, 2), 0.0, {0.0, {kind, 0.0}}));
    scene.add_receiver(device_at("r", Vec3(7.4, 4.7, 1.1), 0.0, {0.0, {kind, 0.0}}));
    SimulationSettings settings = settings_for(2, 2);
    settings.propagation.min_path_gain_db = limit_db;
    Simulator simulator(std::move(scene), settings);
    return std::move(simulator.advance_to(0.0).links.at(0));
  };
  for (const PolarizationKind kind : {PolarizationKind::vertical, PolarizationKind::dual}) {
    const LinkResult all = solve(std::nullopt, kind);
    REQUIRE(all.paths.size() > 10);
    for (const double limit_db : {-200.0, -105.0, -90.0, -50.0}) {
      std::vector<double> expected_m, kept_m;
      for (const PathContribution& path : all.paths) {
        if (10.0 * std::log10(path.power_ratio) >= limit_db) expected_m.push_back(path.path.length_m);
      }
      const LinkResult kept = solve(limit_db, kind);
      for (const PathContribution& path : kept.paths) kept_m.push_back(path.path.length_m);
      CHECK(kept_m == expected_m);
      CHECK(kept.statistics.path_count == expected_m.size());
      CHECK(kept.statistics.line_of_sight == all.statistics.line_of_sight);
    }
  }
}

TEST_CASE("max_interactions bounds reflections, not crossings") {
  const auto kinds_with = [](std::optional<int> bound) {
    Scene scene = office();
    scene.add_transmitter(device_at("t", Vec3(1, 1.2, 2)));
    scene.add_receiver(device_at("r", Vec3(7.4, 4.7, 1.1)));
    SimulationSettings settings = settings_for(2, 2);
    settings.propagation.max_interactions = bound;
    Simulator simulator(std::move(scene), settings);
    return kinds_of(simulator.advance_to(0.0).links.at(0));
  };
  const auto longest = [](const Strings& all, char letter) {
    std::ptrdiff_t most = 0;
    for (const std::string& one : all) most = std::max(most, std::count(one.begin(), one.end(), letter));
    return most;
  };
  CHECK(longest(kinds_with(std::nullopt), 'R') == 2);
  CHECK(kinds_with(5) == kinds_with(std::nullopt));
  CHECK(longest(kinds_with(1), 'R') == 1);
  CHECK(longest(kinds_with(1), 'T') == 2);
  CHECK(longest(kinds_with(0), 'R') == 0);
  CHECK(kinds_with(0).size() == 1);
}

TEST_CASE("sampled results say that they may be incomplete, unless there was nothing to sample") {
  for (const int order : {0, 1}) {
    Scene scene = office();
    scene.add_transmitter(device_at("t", Vec3(1, 1.2, 2)));
    scene.add_receiver(device_at("r", Vec3(7.4, 4.7, 1.1)));
    SimulationSettings settings = settings_for(order, 2);
    settings.propagation.max_diffractions = 0;
    settings.propagation.discovery = Discovery::sampled;
    settings.propagation.rays = 10;
    Simulator simulator(std::move(scene), settings);
    CHECK(simulator.discovery() == Discovery::sampled);
    CHECK(simulator.advance_to(0.0).links.at(0).complete == (order == 0));
  }
}

TEST_CASE("without a cache a sampled frame depends on seed, receiver and frame number, and on nothing before") {
  const auto rays_of = [](std::uint64_t seed, std::vector<std::size_t> frames) {
    Scene scene = office();
    scene.add_transmitter(device_at("t", Vec3(1, 1.2, 2)));
    scene.add_receiver(device_at("r", Vec3(7.4, 4.7, 1.1)));
    SimulationSettings settings = settings_for(3, 2);
    settings.propagation.discovery = Discovery::sampled;
    settings.propagation.cache = CacheMode::off;
    settings.propagation.rays = 20;
    settings.propagation.seed = seed;
    Simulator simulator(std::move(scene), settings);
    FrameResult last;
    for (const std::size_t frame : frames) last = simulator.advance_to(0.0, frame);
    return std::pair(fingerprint(simulator.scene(), last.links), last.work.sequences_proposed);
  };
  CHECK(rays_of(1, {5}) == rays_of(1, {0, 3, 9, 5}));
  CHECK(rays_of(1, {5}) != rays_of(1, {6}));
  CHECK(rays_of(1, {5}) != rays_of(2, {5}));
}

TEST_CASE("a frame is the same from wherever the scene came: moving there and back leaves no trace") {
  const auto at = [](std::vector<double> times_s) {
    Scene scene = office();
    scene.add_transmitter(device_at("t", Vec3(1, 1.2, 2)));
    Device rider = device_at("rider", Vec3(0.0));
    rider.attachment = Attachment{"trolley", Vec3(0.1, 0, 1.2), false};
    scene.add_receiver(rider);
    Simulator simulator(std::move(scene), settings_for(2, 2));
    std::string last;
    for (const double time_s : times_s) last = fingerprint(simulator.scene(), simulator.advance_to(time_s).links);
    return last;
  };
  CHECK(at({1.7}) == at({0.0, 4.0, 0.3, 1.7}));
  CHECK(at({1.7}) != at({1.6}));
}

TEST_CASE("empty scenes, and scenes without devices, are no special case") {
  Simulator nothing(Scene{}, settings_for(2, 2));
  CHECK(nothing.advance_to(0.0).links.empty());
  CHECK(nothing.radio_maps({"area", Vec3(0.0), {1, 1}, {2, 2}, {}}).empty());
  Scene scene;
  scene.add_transmitter(device_at("t", Vec3(0, 0, 1)));
  scene.add_receiver(device_at("r", Vec3(3, 0, 1)));
  Simulator space(std::move(scene), settings_for(2, 2));
  const FrameResult result = space.advance_to(0.0);
  REQUIRE(result.links.size() == 1);
  CHECK(kinds_of(result.links[0]) == Strings{""});
  CHECK(result.links[0].statistics.line_of_sight);
}

TEST_CASE("settings out of range and materials without values are refused at once") {
  SimulationSettings settings;
  settings.propagation.rays = 0;
  CHECK_THROWS_AS(Simulator(Scene{}, settings), std::invalid_argument);
  Scene scene;
  scene.add_material({"odd", ItuMaterial{"concrete", std::nullopt}});
  settings = {};
  settings.frequency_hz = 1e12;  // the table ends at 100 GHz
  CHECK_THROWS_AS(Simulator(std::move(scene), settings), std::invalid_argument);
}

TEST_CASE("a progress callback's exception reaches the caller") {
  Scene scene = office();
  scene.add_transmitter(device_at("t", Vec3(1, 1.2, 2)));
  Simulator simulator(std::move(scene), settings_for(1, 1, 3));
  const ReceiverGrid grid{"area", Vec3(0.25, 0.31, 1.2), {0.9, 0.83}, {4, 7}, {}};
  CHECK_THROWS_AS(simulator.radio_maps(grid, [](std::size_t) { throw std::runtime_error("stop"); }),
                  std::runtime_error);
}

}  // namespace test_simulator
