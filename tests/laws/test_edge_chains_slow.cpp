/// Chains of reflections and diffractions at a small crossing: nothing is missing, nothing depends on who looks, in
/// which order, with how many threads, or on what was remembered.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "tests/support/law_scenes.hpp"

namespace test_edge_chains_slow {

using namespace dcem;
using namespace dcem::test;

namespace {

Patches house(const Vec3& low_m, const Vec3& high_m, const std::string& material) {
  Patches faces = box_faces(low_m, high_m, material);
  faces.erase(faces.begin() + 4);  // it stands on the ground
  return faces;
}

/// Four houses of different heights at a crossing.
Patches crossing() {
  Patches all{sheet(Vec3(0, 0, 0), Vec3(80, 0, 0), Vec3(0, 80, 0), "half_space")};
  for (const Patches& one :
       {house(Vec3(7, 6, 0), Vec3(21, 23, 12), "opaque"), house(Vec3(-24, 7, 0), Vec3(-8, 20, 15), "itu_concrete"),
        house(Vec3(-22, -25, 0), Vec3(-7, -6, 9), "half_space"), house(Vec3(8, -21, 0), Vec3(25, -7, 18), "pec")}) {
    all.insert(all.end(), one.begin(), one.end());
  }
  return all;
}

/// Two houses, one of them turned.
Patches two_houses() {
  const Mat3 turn = rotation_about(Vec3(0, 0, 1), 0.3);
  Patches all = house(Vec3(-9, -4, 0), Vec3(-3, 5, 7), "opaque");
  all.push_back(sheet(Vec3(0, 0, 0), Vec3(40, 0, 0), Vec3(0, 40, 0), "itu_concrete"));
  for (const Patch& face :
       mapped(house(Vec3(3, -5, 0), Vec3(8, 4, 5), "half_space"), [&](const Vec3& p) { return turn * p; }))
    all.push_back(face);
  return all;
}

const Vec3 mast_m(2.3, -31.7, 6.1);

std::vector<Vec3> walkers_m() {
  return {Vec3(-33.1, 1.7, 1.5), Vec3(29.3, -2.9, 1.6), Vec3(1.1, 28.7, 1.4), Vec3(-2.2, -12.9, 1.7),
          Vec3(14.1, 30.3, 3.2)};
}

/// Behind, between and above the two houses.
std::vector<Vec3> around_two_houses() {
  std::vector<Vec3> receivers_m;
  Dice dice(91);
  for (int index = 0; index < 6; ++index) {
    receivers_m.push_back(dice.inside(Vec3(9, -9, 0.2), Vec3(16, 9, 9)));
    receivers_m.push_back(dice.inside(Vec3(-2, -15, 0.2), Vec3(2, 15, 5)));
  }
  return receivers_m;
}

SimulationSettings chain_settings(int reflections, int diffractions, Discovery discovery = Discovery::exact) {
  SimulationSettings settings = law_settings(reflections, 0, discovery);
  settings.propagation.max_diffractions = diffractions;
  return settings;
}

Scene with_devices(Scene scene, const Vec3& transmitter_m, const std::vector<Vec3>& receivers_m) {
  scene.add_transmitter(device_at("tx", transmitter_m, 0.0, antenna(PolarizationKind::dual)));
  for (std::size_t index = 0; index < receivers_m.size(); ++index) {
    scene.add_receiver(
        device_at("rx" + std::to_string(index), receivers_m[index], 0.0, antenna(PolarizationKind::dual)));
  }
  return scene;
}

std::vector<LinkResult> links(const Patches& patches, const Vec3& transmitter_m, const std::vector<Vec3>& receivers_m,
                              const SimulationSettings& settings) {
  Simulator simulator(with_devices(scene_through_files(patches), transmitter_m, receivers_m), settings);
  return simulator.advance_to(0.0).links;
}

bool diffracted(const PathContribution& path) {
  return kinds(path).find('D') != std::string::npos;
}

std::string all_bits(const Scene& scene, const std::vector<LinkResult>& all) {
  std::string bytes;
  for (const LinkResult& link : all) bytes += bits(scene, link);
  return bytes;
}

/// Touches by surface and edge, in either direction.
std::string name(const Path& path, bool backwards) {
  std::vector<std::string> parts;
  for (const Interaction& one : path.interactions) {
    const bool edge = one.kind == InteractionKind::diffraction;
    parts.push_back(static_cast<char>(one.kind) + std::to_string(edge ? one.wedge.value : one.facet.value) + " ");
  }
  if (backwards) std::reverse(parts.begin(), parts.end());
  return std::accumulate(parts.begin(), parts.end(), std::string());
}

/// All sequences of mirrors and edges within the orders, none left out.
template <typename Visit>
void for_each_sequence(const Scene& scene, int reflections, int diffractions, Sequence& sequence, Visit&& visit) {
  visit(sequence);
  const auto go_on = [&](SequenceElement element, int r, int d) {
    if (!sequence.empty() && sequence.back() == element) return;
    sequence.push_back(element);
    for_each_sequence(scene, r, d, sequence, visit);
    sequence.pop_back();
  };
  for (std::size_t facet = 0; reflections > 0 && facet < scene.facets().size(); ++facet)
    go_on(FacetId(facet), reflections - 1, diffractions);
  for (std::size_t edge = 0; diffractions > 0 && edge < scene.wedges().size(); ++edge)
    go_on(WedgeId(edge), reflections, diffractions - 1);
}

void check_complete(const Patches& patches, const Vec3& transmitter_m, const std::vector<Vec3>& receivers_m,
                    int reflections, int diffractions, const std::vector<std::string>& wanted_kinds) {
  Simulator simulator(with_devices(scene_through_files(patches), transmitter_m, receivers_m),
                      chain_settings(reflections, diffractions));
  const FrameResult frame = simulator.advance_to(0.0);
  std::map<std::string, int> seen_kinds;
  for (const LinkResult& link : frame.links) {
    CHECK(link.complete);
    std::map<std::string, std::vector<double>> found, expected;
    for (const PathContribution& path : link.paths) {
      if (!diffracted(path)) continue;
      CHECK(found.emplace(path_id(simulator.scene(), path.path), all_numbers(path)).second);
      ++seen_kinds[kinds(path)];
    }
    Sequence sequence;
    for_each_sequence(simulator.scene(), reflections, diffractions, sequence, [&](const Sequence& one) {
      if (edge_count(one) == 0) return;
      const auto path = simulator.solve_path(link.transmitter, link.receiver, one);
      if (path) expected.emplace(path_id(simulator.scene(), path->path), all_numbers(*path));
    });
    CHECK(found.size() == expected.size());
    for (const auto& [id, numbers] : expected) {
      CAPTURE(id);
      REQUIRE(found.contains(id));
      CHECK(found.at(id) == numbers);
    }
  }
  std::string summary;
  for (const auto& [letters, count] : seen_kinds) summary += letters + " " + std::to_string(count) + ", ";
  MESSAGE(summary);
  for (const std::string& letters : wanted_kinds) {
    CAPTURE(letters);
    CHECK(seen_kinds[letters] > 0);
  }
}

void check_swap(const Patches& patches, const Vec3& transmitter_m, const std::vector<Vec3>& receivers_m,
                const SimulationSettings& settings, std::size_t least) {
  std::size_t compared = 0;
  for (const Vec3& receiver_m : receivers_m) {
    const auto forth = links(patches, transmitter_m, {receiver_m}, settings).at(0).paths;
    const auto back = links(patches, receiver_m, {transmitter_m}, settings).at(0).paths;
    CHECK(forth.size() == back.size());
    std::map<std::string, const PathContribution*> by_name;
    for (const PathContribution& path : back) by_name[name(path.path, true)] = &path;
    for (const PathContribution& path : forth) {
      CAPTURE(name(path.path, false));
      const auto other = by_name.find(name(path.path, false));
      CHECK(other != by_name.end());
      if (other == by_name.end()) continue;
      compared += diffracted(path);
      const ComplexMatrix2 difference = path.transfer + Complex(-1.0) * transposed(other->second->transfer);
      CHECK(std::sqrt(norm_squared(difference)) <= 1e-9 * std::sqrt(norm_squared(path.transfer)));
      CHECK(path.path.length_m == doctest::Approx(other->second->path.length_m).epsilon(1e-13));
      const auto &ours = path.path.interactions, &theirs = other->second->path.interactions;
      for (std::size_t index = 0; index < ours.size(); ++index) {
        CHECK(ours[index].in_shadow == theirs[ours.size() - 1 - index].in_shadow);
        CHECK(glm::distance(ours[index].point_m, theirs[ours.size() - 1 - index].point_m) < 1e-9);
      }
    }
  }
  MESSAGE(compared << " diffracted paths compared with their reverse");
  CHECK(compared > least);
}

}  // namespace

TEST_CASE("exhaustive search: every sequence of two mirrors and an edge that solves is there, with the same bits") {
  check_complete(crossing(), mast_m, {walkers_m()[0], walkers_m()[3]}, 2, 1, {"D", "RD", "DR", "RDR"});
}

TEST_CASE("exhaustive search: two edges with a mirror before, between or after them") {
  check_complete(two_houses(), Vec3(-13, 2, 3), {Vec3(12, -3, 2), Vec3(0.2, -9, 1)}, 1, 2, {"D", "DD", "DRD"});
}

TEST_CASE("sampled within exhaustive: none that the exhaustive search lacks, with the same bits") {
  SimulationSettings many = chain_settings(2, 1, Discovery::sampled);
  many.propagation.rays = 20'000;
  const auto exact = links(crossing(), mast_m, walkers_m(), chain_settings(2, 1));
  const auto sampled = links(crossing(), mast_m, walkers_m(), many);
  const Scene scene = scene_through_files(crossing());
  std::map<std::string, std::array<std::size_t, 2>> recall;
  REQUIRE(exact.size() == sampled.size());
  for (std::size_t link = 0; link < exact.size(); ++link) {
    std::map<std::string, const PathContribution*> by_id;
    for (const PathContribution& path : exact[link].paths) {
      by_id[path_id(scene, path.path)] = &path;
      ++recall[kinds(path)][0];
    }
    CHECK(by_id.size() == exact[link].paths.size());
    std::set<std::string> seen;
    for (const PathContribution& path : sampled[link].paths) {
      const std::string id = path_id(scene, path.path);
      CAPTURE(id);
      CHECK(seen.insert(id).second);
      REQUIRE(by_id.contains(id));
      CHECK(all_numbers(path) == all_numbers(*by_id.at(id)));
      ++recall[kinds(path)][1];
    }
  }
  for (const auto& [letters, count] : recall) {
    MESSAGE("'" << letters << "': " << count[1] << " of " << count[0]);
    CHECK(count[1] >= 0.8 * static_cast<double>(count[0]));  // 20,000 rays miss what little shows
  }
}

TEST_CASE("exchanging the ends gives the same paths, each with the transposed transfer") {
  check_swap(crossing(), mast_m, walkers_m(), chain_settings(2, 1), 50);
}

TEST_CASE("exchanging the ends of two diffractions gives the same paths, each with the transposed transfer") {
  check_swap(two_houses(), Vec3(-13, 2, 3), around_two_houses(), chain_settings(1, 2), 25);
}

TEST_CASE("exchanging the ends with two diffractions at the crossing, where edges of one house meet in its corners") {
  check_swap(crossing(), mast_m, walkers_m(), chain_settings(0, 2), 50);
}

TEST_CASE("exchanging two ends at one azimuth about an edge gives the transposed transfer") {
  // Both ends in one plane with the edge, at an oblique incidence: which of the two rays comes first must not show.
  const Patches corner{{{Vec3(0, 0, -30), Vec3(0, -30, -30), Vec3(0, -30, 30), Vec3(0, 0, 30)}, "itu_concrete"},
                       {{Vec3(0, 0, -30), Vec3(-30, 0, -30), Vec3(-30, 0, 30), Vec3(0, 0, 30)}, "itu_concrete"}};
  for (const double turn_rad : {0.0, 0.1, 0.7, 1.9}) {
    const Mat3 turn = rotation_about(Vec3(0, 0, 1), turn_rad);
    const auto map = [&](const Vec3& p) { return turn * p; };
    std::vector<Vec3> receivers_m;
    for (const double far_m : {3.0, 7.0, 11.0}) receivers_m.push_back(map(Vec3(2 * far_m, far_m, 8)));
    check_swap(mapped(corner, map), map(Vec3(10, 5, -4)), receivers_m, chain_settings(0, 1), 2);
  }
}

TEST_CASE("exchanging the ends of three diffractions gives the same paths, each with the transposed transfer") {
  check_swap(two_houses(), Vec3(-13, 2, 3), around_two_houses(), chain_settings(0, 3), 15);
}

TEST_CASE("a frame in which nothing moved repeats the one before, byte for byte") {
  for (const Discovery discovery : {Discovery::exact, Discovery::sampled}) {
    CAPTURE(discovery == Discovery::exact);
    SimulationSettings settings = chain_settings(2, 1, discovery);
    settings.propagation.rays = 20'000;
    settings.propagation.rays_steady = 2000;
    Simulator simulator(with_devices(scene_through_files(crossing()), mast_m, walkers_m()), settings);
    CHECK((simulator.cache() == CacheMode::seed) == (discovery == Discovery::sampled));
    std::vector<std::string> frames;
    for (std::size_t frame = 0; frame < 12; ++frame) {
      frames.push_back(all_bits(simulator.scene(), simulator.advance_to(0.0, frame).links));
      // Rays of another frame look elsewhere and may find more; the same frame again is the same.
      CHECK(all_bits(simulator.scene(), simulator.advance_to(0.0, frame).links) == frames.back());
    }
    for (std::size_t frame = 1; frame < frames.size() && discovery == Discovery::exact; ++frame) {
      CHECK(frames[frame] == frames[0]);
    }
    for (std::size_t frame = 1; frame < frames.size(); ++frame) CHECK(frames[frame].size() >= frames[frame - 1].size());
  }
}

TEST_CASE("the number of threads and the order of patches change no bit") {
  for (const Discovery discovery : {Discovery::exact, Discovery::sampled}) {
    std::set<std::string> results;
    Dice dice(92);
    Patches patches = crossing();
    for (const unsigned threads : {1U, 2U, 5U}) {
      SimulationSettings settings = chain_settings(2, 1, discovery);
      settings.threads = threads;
      Simulator simulator(with_devices(scene_through_files(patches), mast_m, walkers_m()), settings);
      const FrameResult first = simulator.advance_to(0.0, 0), second = simulator.advance_to(0.0, 1);
      results.insert(all_bits(simulator.scene(), first.links) + all_bits(simulator.scene(), second.links));
      dice.shuffle(patches);
      for (Patch& patch : patches) {
        if (dice.below(2) == 0) std::reverse(patch.corners_m.begin(), patch.corners_m.end());
      }
    }
    CHECK(results.size() == 1);
  }
}

TEST_CASE("a turned scene has the same paths with the same lengths and the same power") {
  const auto upright = links(crossing(), mast_m, walkers_m(), chain_settings(2, 1));
  Dice dice(93);
  for (int round = 0; round < 3; ++round) {
    const Mat3 turn = rotation_about(dice.direction(), dice.between(-pi, pi));
    const auto map = [&](const Vec3& p) { return turn * p + Vec3(100, -40, 30); };
    std::vector<Vec3> receivers_m;
    for (const Vec3& p : walkers_m()) receivers_m.push_back(map(p));
    const auto turned = links(mapped(crossing(), map), map(mast_m), receivers_m, chain_settings(2, 1));
    for (std::size_t link = 0; link < upright.size(); ++link) {
      REQUIRE(turned[link].paths.size() == upright[link].paths.size());
      for (std::size_t index = 0; index < upright[link].paths.size(); ++index) {
        const PathContribution &one = upright[link].paths[index], &other = turned[link].paths[index];
        CHECK(kinds(one) == kinds(other));
        CHECK(one.path.length_m == doctest::Approx(other.path.length_m).epsilon(1e-12));
        // Both polarizations together do not depend on where "up" is.
        CHECK(norm_squared(one.transfer) == doctest::Approx(norm_squared(other.transfer)).epsilon(1e-9).scale(0.0));
      }
    }
  }
}

TEST_CASE("a moving box takes its edges along, and its paths keep their names") {
  const MovingPatches car{"car", box_faces(Vec3(-2.2, -0.9, 0), Vec3(2.2, 0.9, 1.5), "pec"),
                          LinearMotion{{Vec3(0, -20, 0), 0.4, 0.0, 0.0}, Vec3(0.5, 9, 0), 0.0}};
  SimulationSettings settings = chain_settings(1, 1);
  Simulator simulator(
      with_devices(scene_through_files(crossing(), {car}), Vec3(4, -30, 1.1), {Vec3(-3, 25, 1.2), Vec3(2, -2, 3)}),
      settings);
  std::map<std::string, Vec3> before;
  std::size_t on_car = 0, kept = 0;
  for (std::size_t frame = 0; frame < 40; ++frame) {
    const double time_s = 0.01 * static_cast<double>(frame);
    const Vec3 here_m = Vec3(0, -20, 0) + time_s * Vec3(0.5, 9, 0);
    const Mat3 turn = rotation_about(Vec3(0, 0, 1), 0.4);
    std::map<std::string, Vec3> now;
    for (const LinkResult& link : simulator.advance_to(time_s, frame).links) {
      for (const PathContribution& path : link.paths) {
        for (const Interaction& one : path.path.interactions) {
          if (one.kind != InteractionKind::diffraction) continue;
          const BodyId body = simulator.scene().facet(one.facet).body;
          if (simulator.scene().body_name(body) != "car") continue;
          ++on_car;
          const std::string id = std::to_string(link.receiver) + ":" + path_id(simulator.scene(), path.path);
          CHECK(id.find("@car") != std::string::npos);
          const Vec3 local_m = glm::transpose(turn) * (one.point_m - here_m);
          // On an edge of the box two of three coordinates are at their ends; none is at the wheels.
          const int at_ends = (std::abs(std::abs(local_m.x) - 2.2) < 1e-9) +
                              (std::abs(std::abs(local_m.y) - 0.9) < 1e-9) + (std::abs(local_m.z - 1.5) < 1e-9);
          CHECK(at_ends == 2);
          now[id] = local_m;
          const auto old = before.find(id);
          if (old == before.end()) continue;
          ++kept;
          CHECK(glm::distance(old->second, local_m) < 1.0);  // in 10 ms the car goes 9 cm; the point slides a little
        }
      }
    }
    before = now;
  }
  MESSAGE(on_car << " diffractions at the car, " << kept << " with the name of the frame before");
  CHECK(on_car > 100);
  CHECK(kept > on_car / 2);
}

}  // namespace test_edge_chains_slow
