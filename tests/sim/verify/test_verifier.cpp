/// The verifier passes what is right and finds whatever is not: each way in which a frame can be false is tried.
#include "dcem/paths/path_id.hpp"
#include "dcem/sim/simulator.hpp"
#include "dcem/sim/verify/verifier.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "tests/paths/small_scenes.hpp"

namespace test_verifier {

using namespace dcem;
using namespace dcem::test;

namespace {

Scene office() {
  TriangleMesh mesh;
  add_box_faces(mesh, Vec3(0.0), Vec3(9, 6, 3), "opaque");
  add_sheet(mesh, Vec3(4, 3, 1.5), Vec3(0, 2.2, 0), Vec3(0, 0, 1.2), "glass");
  Scene scene = scene_of(mesh);
  scene.add_object("trolley", make_box(Vec3(1, 0.6, 0.9), "metal"),
                   LinearMotion{{Vec3(2, 1.5, 0.05), 0.4, 0, 0}, Vec3(1.0, 0.4, 0), 0});
  scene.add_transmitter(device_at("t0", Vec3(1, 1.2, 2)));
  scene.add_transmitter(device_at("t1", Vec3(8, 1.3, 2)));
  scene.add_receiver(device_at("r0", Vec3(7.4, 4.7, 1.1)));
  Device rider = device_at("r1", Vec3(0.0));
  rider.attachment = Attachment{"trolley", Vec3(0, 0, 1.3), false};
  scene.add_receiver(rider);
  return scene;
}

SimulationSettings settings_for(Discovery discovery, CacheMode cache = CacheMode::automatic) {
  SimulationSettings settings;
  settings.propagation.discovery = discovery;
  settings.propagation.cache = cache;
  settings.propagation.rays = 500;
  settings.threads = 2;
  return settings;
}

/// A run and its verifier.
struct Verified {
  Scene scene = office();
  Simulator simulator;
  Verifier verifier;

  explicit Verified(const SimulationSettings& settings)
      : simulator(scene, settings), verifier(simulator.scene(), settings) {}

  void frame(std::size_t index, const std::function<void(FrameResult&)>& falsify = {}) {
    const Frame frame = scene.frame_at(0.2 * double(index), index);
    FrameResult result = simulator.advance(frame);
    if (falsify) falsify(result);
    verifier.check(frame, result);
  }
  const VerificationReport& report() const { return verifier.report(); }
};

/// What the verifier says of one frame that was tampered with.
VerificationReport falsified(Discovery discovery, const std::function<void(FrameResult&)>& falsify) {
  Verified run(settings_for(discovery));
  run.frame(0, falsify);
  return run.report();
}

/// The first path that is reflected once and crosses nothing, and its link.
std::pair<LinkResult*, PathContribution*> reflected_in(FrameResult& result) {
  for (LinkResult& link : result.links) {
    for (PathContribution& path : link.paths) {
      if (kinds(path.path) == "R") return {&link, &path};
    }
  }
  throw std::logic_error("no path is reflected once");
}

PathContribution& reflected(FrameResult& result) {
  return *reflected_in(result).second;
}

double next_up(double value) {
  return std::nextafter(value, std::numeric_limits<double>::infinity());
}

constexpr std::array both_discoveries{Discovery::sampled, Discovery::exact};

PathContribution contribution(std::vector<std::size_t> facets, double power_ratio) {
  PathContribution path;
  for (const std::size_t facet : facets) {
    path.path.interactions.push_back({InteractionKind::reflection, FacetId(facet), Vec3(0.0)});
  }
  path.power_ratio = power_ratio;
  return path;
}

}  // namespace

TEST_CASE("a good run passes, and the report counts what was looked at") {
  for (const Discovery discovery : both_discoveries) {
    for (const CacheMode cache : {CacheMode::off, CacheMode::automatic}) {
      Verified run(settings_for(discovery, cache));
      std::uint64_t paths = 0;
      for (std::size_t index = 0; index < 12; ++index) {
        run.frame(index, [&](FrameResult& result) { paths += result.work.paths; });
      }
      const VerificationReport& report = run.report();
      CHECK(report.passed());
      CHECK(report.frames == 12);
      CHECK(report.links == 12 * 4);
      CHECK(report.paths == paths);
      CHECK(report.paths_different == 0);
      CHECK(report.paths_extra == 0);
      CHECK(report.compared);
      CHECK(report.differences.empty());
      REQUIRE(report.recall_by_frame.size() == 12);
      Recall sum;
      for (const Recall& recall : report.recall_by_frame) sum += recall;
      CHECK(sum.paths_there == report.recall.paths_there);
      CHECK(sum.paths_found == report.recall.paths_found);
      CHECK(report.recall.links == 12 * 4);
      if (discovery == Discovery::sampled) CHECK(report.recall.paths_found == paths);
      CHECK(report.recall.by_power() > 0.9);
    }
  }
}

TEST_CASE("without edges few rays with memory find nine paths in ten") {
  for (const CacheMode cache : {CacheMode::off, CacheMode::automatic}) {
    SimulationSettings settings = settings_for(Discovery::sampled, cache);
    settings.propagation.max_diffractions = 0;
    Verified run(settings);
    for (std::size_t index = 0; index < 12; ++index) {
      run.frame(index, [](FrameResult&) {});
    }
    CHECK(run.report().passed());
    CHECK(run.report().recall.by_count() > 0.9);
    CHECK(run.report().recall.by_power() > 0.9);
  }
}

TEST_CASE("one number of one path that is another makes the run fail, and the path is named") {
  const std::vector<std::pair<std::string, std::function<void(PathContribution&)>>> changes{
      {"length", [](auto& path) { path.path.length_m = next_up(path.path.length_m); }},
      {"point", [](auto& path) { path.path.interactions[0].point_m.y = next_up(path.path.interactions[0].point_m.y); }},
      {"transfer",
       [](auto& path) {
         path.transfer(1, 1) = Complex(next_up(path.transfer(1, 1).real()), path.transfer(1, 1).imag());
       }},
      {"imaginary", [](auto& path) { path.transfer(0, 1) = Complex(path.transfer(0, 1).real(), 1e-300); }},
      {"power", [](auto& path) { path.power_ratio = next_up(path.power_ratio); }},
      {"delay", [](auto& path) { path.delay_s = next_up(path.delay_s); }},
      {"doppler", [](auto& path) { path.doppler_hz += 1e-9; }},
      {"amplitude", [](auto& path) { path.amplitude = Complex(next_up(path.amplitude.real()), 0.0); }},
      {"port", [](auto& path) { path.ports(0, 0) = Complex(1.0, 0.0); }},
      {"arrival", [](auto& path) { path.arrival.azimuth_rad += 0.1; }},
      {"departure", [](auto& path) { path.departure.zenith_rad += 0.1; }},
      {"not a number", [](auto& path) { path.power_ratio = std::numeric_limits<double>::quiet_NaN(); }}};
  for (const Discovery discovery : both_discoveries) {
    for (const auto& [name, change] : changes) {
      CAPTURE(name);
      std::string id;
      const VerificationReport report = falsified(discovery, [&, &change = change](FrameResult& result) {
        const auto [link, path] = reflected_in(result);
        const Scene scene = office();
        id = scene.transmitters()[link->transmitter].id + " to " + scene.receivers()[link->receiver].id + ": path " +
             path_id(scene, path->path);
        change(*path);
      });
      CHECK(report.paths_different == 1);
      CHECK_FALSE(report.passed());
      if (report.differences.size() != 1) continue;
      CHECK(report.differences[0].find("frame 0, " + id + " ") == 0);
    }
  }
}

TEST_CASE("a path that does not exist is different; one at a facet that it does not touch is, too") {
  for (const Discovery discovery : both_discoveries) {
    const VerificationReport report = falsified(discovery, [](FrameResult& result) {
      const auto [link, path] = reflected_in(result);
      PathContribution invented = *path;
      invented.path.interactions.push_back(invented.path.interactions[0]);  // twice at one wall
      link->paths.push_back(invented);
    });
    CHECK(report.paths_different == 1);
    CHECK(report.paths_extra == (discovery == Discovery::sampled ? 1 : 0));
    CHECK_FALSE(report.passed());
    const VerificationReport other = falsified(discovery, [](FrameResult& result) {
      FacetId& facet = reflected(result).path.interactions[0].facet;
      facet = FacetId(facet.value == 0 ? 1 : 0);
    });
    CHECK(other.paths_different >= 1);  // two where the list has the path over that facet as well: it is there twice
  }
}

TEST_CASE("a path of another link, or of the frame before, is different") {
  for (const Discovery discovery : both_discoveries) {
    std::size_t moved = 0;
    const VerificationReport swapped = falsified(discovery, [&](FrameResult& result) {
      REQUIRE(result.links[0].receiver != result.links[1].receiver);
      moved = result.links[0].paths.size() + result.links[1].paths.size();
      std::swap(result.links[0].paths, result.links[1].paths);
    });
    CHECK(swapped.paths_different == moved);
    Verified run(settings_for(discovery));
    FrameResult stale;
    run.frame(0, [&](FrameResult& result) { stale = result; });
    run.frame(1, [&](FrameResult& result) {
      for (std::size_t link = 0; link < result.links.size(); ++link) {
        if (result.links[link].receiver == 1) result.links[link].paths = stale.links[link].paths;
      }
    });
    CHECK(run.report().paths_different > 10);
  }
}

TEST_CASE("a path that is reported twice is a fault: powers are summed over what is listed") {
  for (const Discovery discovery : both_discoveries) {
    const VerificationReport report = falsified(
        discovery, [](FrameResult& result) { result.links[0].paths.push_back(result.links[0].paths.front()); });
    CHECK_FALSE(report.passed());
  }
}

TEST_CASE("a path beyond the declared orders is extra, though it is there") {
  // Found with three reflections, smuggled into a run with two.
  SimulationSettings three = settings_for(Discovery::exact);
  three.propagation.max_reflections = 3;
  Simulator deeper(office(), three);
  const FrameResult all = deeper.advance_to(0.0, 0);
  const auto& paths = all.links[0].paths;
  const auto third =
      std::find_if(paths.begin(), paths.end(), [](const PathContribution& path) { return kinds(path.path) == "RRR"; });
  REQUIRE(third != paths.end());
  for (const Discovery discovery : both_discoveries) {
    const VerificationReport report =
        falsified(discovery, [&](FrameResult& result) { result.links[0].paths.push_back(*third); });
    CHECK_FALSE(report.passed());
    if (discovery == Discovery::sampled) CHECK(report.paths_extra == 1);
  }
}

TEST_CASE("a path that exhaustive search is said to have missed is extra") {
  const VerificationReport report = falsified(Discovery::exact, [](FrameResult& result) {
    result.links[0].paths.erase(result.links[0].paths.begin());  // the direct path, which any rays find
  });
  CHECK(report.paths_different == 0);
  CHECK(report.paths_extra == 1);
  CHECK_FALSE(report.passed());
}

TEST_CASE("a link that is missing or is there without its devices is a fault") {
  for (const Discovery discovery : both_discoveries) {
    CHECK_FALSE(falsified(discovery, [](FrameResult& result) { result.links.pop_back(); }).passed());
    CHECK_FALSE(falsified(discovery, [](FrameResult& result) { result.links.erase(result.links.begin()); }).passed());
  }
}

TEST_CASE("links of two receivers in each other's place are a fault: results are read in the order of the devices") {
  for (const Discovery discovery : both_discoveries) {
    const auto swap_two = [](FrameResult& result) {
      REQUIRE(result.links.at(0).transmitter == result.links.at(1).transmitter);
      std::swap(result.links[0], result.links[1]);
    };
    const VerificationReport report = falsified(discovery, swap_two);
    CHECK(report.frames_with_other_links == 1);
    CHECK_FALSE(report.passed());
  }
}

TEST_CASE("paths that were not found are no fault of sampled discovery: they lower the recall") {
  const VerificationReport report = falsified(Discovery::sampled, [](FrameResult& result) {
    for (LinkResult& link : result.links) link.paths.clear();
  });
  CHECK(report.passed());
  CHECK(report.recall.by_count() == 0.0);
  CHECK(report.recall.by_power() == 0.0);
  CHECK(report.recall.links == 4);
}

TEST_CASE("of many differences the first ten are named, and all are counted") {
  const VerificationReport report = falsified(Discovery::sampled, [](FrameResult& result) {
    for (LinkResult& link : result.links) {
      for (PathContribution& path : link.paths) path.delay_s = 0.0;
    }
  });
  CHECK(report.paths_different == report.paths);
  CHECK(report.paths > 10);
  CHECK(report.differences.size() == 10);
}

TEST_CASE("recall of lists made by hand") {
  const std::vector<PathContribution> all{contribution({}, 6.0), contribution({1}, 3.0), contribution({2, 1}, 1.0)};
  const Recall two = recall_of({all[0], all[2]}, all);
  CHECK(two.paths_there == 3);
  CHECK(two.paths_found == 2);
  CHECK(two.links == 1);
  CHECK(two.by_count() == doctest::Approx(2.0 / 3.0));
  CHECK(two.by_power() == doctest::Approx(7.0 / 10.0));
  CHECK(recall_of(all, all).by_power() == 1.0);
  CHECK(recall_of({}, all).by_power() == 0.0);
  CHECK(recall_of({contribution({1, 2}, 9.0)}, all).paths_found == 0);  // another order is another path
  CHECK(recall_of({all[1], all[1]}, all).paths_found == 1);
  const Recall nothing = recall_of(all, {});
  CHECK(nothing.links == 0);
  CHECK(nothing.by_count() == 1.0);
  CHECK(nothing.by_power() == 1.0);
  const Recall dark = recall_of({}, {contribution({1}, 0.0)});
  CHECK(dark.by_count() == 0.0);
  CHECK(dark.by_power() == 1.0);
}

TEST_CASE("recall over links: paths are counted together, shares of the power are a mean over the links") {
  const std::vector<PathContribution> one{contribution({}, 1.0)};
  const std::vector<PathContribution> three{contribution({}, 1.0), contribution({1}, 1e6), contribution({2}, 1e6)};
  Recall sum = recall_of(one, one);
  sum += recall_of({three[1]}, three);
  sum += recall_of({}, {});
  CHECK(sum.links == 2);
  CHECK(sum.by_count() == doctest::Approx(2.0 / 4.0));
  CHECK(sum.by_power() == doctest::Approx((1.0 + 1e6 / (2e6 + 1.0)) / 2.0).epsilon(1e-14));
  CHECK(Recall{}.by_count() == 1.0);
  CHECK(Recall{}.by_power() == 1.0);
}

TEST_CASE("where the scene is too large for exhaustive search, paths alone are checked and nothing is compared") {
  TriangleMesh mesh;
  add_box_faces(mesh, Vec3(0.0), Vec3(40, 40, 5), "opaque");
  for (int index = 0; index < 340; ++index) {
    const Vec3 low(1.0 + 2.0 * (index % 19), 1.0 + 2.0 * (index / 19), 0.5);
    add_sheet(mesh, low, Vec3(0.3, 0.05 * (index % 7), 0), Vec3(0, 0, 0.4), "glass");
    add_sheet(mesh, low + Vec3(0, 0.7, 0), Vec3(0.2, 0.03 * (index % 5), 0), Vec3(0, 0, 0.3), "wall");
    add_sheet(mesh, low + Vec3(0.7, 0.3, 0), Vec3(0.04 * (index % 3), 0.3, 0), Vec3(0, 0, 0.3), "wall");
  }
  Scene scene = scene_of(mesh);
  REQUIRE(scene.facets().size() > 1000);
  scene.add_transmitter(device_at("t", Vec3(0.4, 0.4, 3)));
  scene.add_receiver(device_at("r", Vec3(20.1, 20.2, 2)));
  SimulationSettings settings;
  settings.propagation.rays = 300;
  settings.propagation.max_interactions = 4;
  settings.propagation.max_reflections = 4;
  Simulator simulator(scene, settings);
  REQUIRE(simulator.cache() == CacheMode::seed);
  Verifier verifier(scene, settings);
  for (std::size_t index = 0; index < 2; ++index) {
    const Frame frame = scene.frame_at(0.0, index);
    verifier.check(frame, simulator.advance(frame));
  }
  CHECK(verifier.report().passed());
  CHECK_FALSE(verifier.report().compared);
  CHECK(verifier.report().recall_by_frame.empty());
  CHECK(verifier.report().paths > 2);
}

}  // namespace test_verifier
