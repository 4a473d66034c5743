/// In real cities, dirty as found, exact discovery finds every path of two interactions: an oracle that shares no code
/// with the search says which paths there must be, and which there may be.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "dcem/io/obj_reader.hpp"
#include "dcem/sim/simulator.hpp"
#include "tests/paths/halves/city_comparison.hpp"
#include "tests/paths/halves/city_corners.hpp"
#include "tests/paths/halves/city_links.hpp"
#include "tests/paths/halves/city_oracle.hpp"
#include "tests/support/shared_data.hpp"

namespace test_city_links_slow {

using namespace dcem;
using namespace dcem::test;

namespace {

/// A city, and seeds that give links with some tens to some hundreds of paths.
struct City {
  std::string file;
  std::uint64_t roof_seed, mast_seed, street_seed;
};

const std::array<City, 3> cities{City{"scenes/munich.obj", 1005, 1009, 1010},
                                 City{"scenes/etoile.obj", 1005, 1003, 1004},
                                 City{"badhersfeld/badhersfeld_centre.obj", 1008, 1006, 1007}};

Scene scene_of(const TriangleMesh& mesh) {
  Scene scene;
  for (const std::string& name : mesh.material_names) scene.add_material({name, PerfectConductor{}});
  scene.set_scenery(mesh);
  return scene;
}

Scene scene_of(const City& city) {
  return scene_of(io::read_obj(shared_path(city.file)).mesh);
}

std::vector<CityLink> links_in(const City& city, const CityTriangles& triangles) {
  return {CityLinks(triangles, city.roof_seed).from_roof(), CityLinks(triangles, city.mast_seed).from_mast(),
          CityLinks(triangles, city.street_seed).along_street()};
}

std::vector<FoundPath> search(Scene scene, const CityLink& link, Discovery discovery) {
  scene.add_transmitter(device_at("tx", link.from_m));
  scene.add_receiver(device_at("rx", link.to_m));
  SimulationSettings settings;
  settings.threads = 1;
  settings.propagation.max_interactions = 2;
  settings.propagation.max_diffractions = 1;
  settings.propagation.max_transmissions = 0;
  settings.propagation.discovery = discovery;
  settings.propagation.cache = CacheMode::off;
  settings.propagation.rays = 200'000;
  Simulator simulator(std::move(scene), settings);
  const FrameResult frame = simulator.advance_to(0.0);
  REQUIRE(frame.links.size() == 1);
  CHECK(frame.links[0].complete == (discovery == Discovery::exact));
  return found_paths(frame.links[0]);
}

std::set<std::vector<Step>> sequences_of(const std::vector<FoundPath>& paths, bool turned = false) {
  std::set<std::vector<Step>> sequences;
  for (const FoundPath& path : paths) {
    sequences.insert(turned ? std::vector<Step>(path.steps.rbegin(), path.steps.rend()) : path.steps);
  }
  return sequences;
}

}  // namespace

TEST_CASE("cities: exact discovery finds every path that all pairs of facets and edges demand, and none beyond") {
  DCEM_NEEDS_SHARED();
  for (const City& city : cities) {
    const Scene scene = scene_of(city);
    const CityOracle oracle(scene);
    for (const CityLink& link : links_in(city, oracle.city())) {
      const Comparison found = compared(oracle.paths(link.from_m, link.to_m), search(scene, link, Discovery::exact));
      MESSAGE(city.file << ": " << found.summary());
      CHECK(found.required >= 25);
      CHECK(found.only_possible <= found.required / 10);
      for (const std::string& mistake : found.mistakes) FAIL_CHECK(mistake);
    }
  }
}

TEST_CASE("parts of cities: from next to walls and edges, in their planes and on their lines, nothing is lost") {
  DCEM_NEEDS_SHARED();
  constexpr double reach_m = 100.0;  // some thousand facets: still more than are searched by trying all sequences
  for (const City& city : cities) {
    const TriangleMesh mesh = io::read_obj(shared_path(city.file)).mesh;
    const Scene town = scene_of(mesh);
    const CityTriangles whole(town);
    std::size_t links = 0, required = 0, possible = 0;
    for (std::uint64_t part = 0; part < 6; ++part) {
      const Vec3 centre_m = CityLinks(whole, part).along_street().from_m;
      const Scene scene = scene_of(part_of(mesh, centre_m, reach_m));
      const CityOracle oracle(scene);
      CityCorners corners(scene, oracle.city(), centre_m, reach_m, part);
      for (int link_number = 0; link_number < 16; ++link_number) {
        const CityLink link = corners.link();
        const Comparison comparison =
            compared(oracle.paths(link.from_m, link.to_m), search(scene, link, Discovery::exact));
        CAPTURE(city.file);
        CAPTURE(part);
        for (const std::string& mistake : comparison.mistakes) FAIL_CHECK(mistake);
        required += comparison.required;
        possible += comparison.only_possible;
        ++links;
      }
    }
    MESSAGE(city.file << ": " << links << " links, " << required << " required, " << possible << " only possible");
    CHECK(required >= 3'000);
    CHECK(possible <= required / 10);
  }
}

TEST_CASE("cities: a path taken away is missed, one over another facet is refused, and so is a wrong length") {
  DCEM_NEEDS_SHARED();
  const Scene scene = scene_of(cities[1]);
  const CityOracle oracle(scene);
  const CityLink link = CityLinks(oracle.city(), cities[1].mast_seed).from_mast();
  const std::vector<JudgedPath> judged = oracle.paths(link.from_m, link.to_m);
  const std::vector<FoundPath> found = search(scene, link, Discovery::exact);
  REQUIRE(compared(judged, found).mistakes.empty());
  for (std::size_t index = 0; index < found.size(); ++index) {
    std::vector<FoundPath> fewer = found, longer = found, other = found;
    fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(index));
    longer[index].length_m += 2e-6;
    CHECK(compared(judged, fewer).mistakes.size() == 1);
    CHECK(compared(judged, longer).mistakes.size() == 1);
    if (found[index].steps.empty()) continue;
    other[index].steps[0].number ^= 1U;
    CHECK(compared(judged, other).mistakes.size() >= 1);
  }
}

TEST_CASE("cities: 200,000 rays find no path of two interactions that exact discovery lacks") {
  DCEM_NEEDS_SHARED();
  std::size_t by_rays = 0, all = 0;
  for (const City& city : cities) {
    const Scene scene = scene_of(city);
    const CityTriangles triangles(scene);
    for (const CityLink& link : links_in(city, triangles)) {
      const std::vector<FoundPath> exact = search(scene, link, Discovery::exact);
      const std::set<std::vector<Step>> there = sequences_of(exact);
      const std::vector<FoundPath> shot = search(scene, link, Discovery::sampled);
      for (const FoundPath& path : shot) {
        CHECK_MESSAGE(there.contains(path.steps), city.file << ": " << described(path.steps, path.points_m));
      }
      by_rays += shot.size();
      all += exact.size();
    }
  }
  MESSAGE("rays find " << by_rays << " of " << all << " paths");
  CHECK(by_rays > all / 2);
  CHECK(by_rays <= all);
}

TEST_CASE("cities: with the ends swapped the same paths are found, the other way round") {
  DCEM_NEEDS_SHARED();
  for (const City& city : cities) {
    const Scene scene = scene_of(city);
    const CityTriangles triangles(scene);
    for (const CityLink& link : links_in(city, triangles)) {
      CAPTURE(city.file);
      const auto there = search(scene, link, Discovery::exact);
      const auto back = search(scene, {link.to_m, link.from_m}, Discovery::exact);
      CHECK(there.size() == back.size());
      CHECK(sequences_of(there) == sequences_of(back, true));
    }
  }
}

}  // namespace test_city_links_slow
