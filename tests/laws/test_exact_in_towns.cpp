/// In a town of thousands of facets, discovery of two interactions is exact: rays find nothing that it lacks, a loop
/// over all facets and edges neither, and what is kept from frame to frame changes no bit.
#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "dcem/io/obj_reader.hpp"
#include "dcem/io/scenario.hpp"
#include "dcem/paths/discover/path_cache.hpp"
#include "dcem/sim/basic_simulator.hpp"
#include "dcem/sim/detail/material_table_of.hpp"
#include "dcem/sim/simulator.hpp"
#include "tests/paths/small_scenes.hpp"
#include "tests/support/law_scenes.hpp"
#include "tests/support/shared_data.hpp"

namespace test_exact_in_towns {

using namespace dcem;
using namespace dcem::test;

namespace {

io::Scenario town() {
  io::Scenario scenario = io::load_scenario(std::filesystem::path(DCEM_DATA_DIR) / "town_drive.json");
  PropagationSettings& propagation = scenario.settings.propagation;
  propagation.discovery = Discovery::automatic;
  propagation.cache = CacheMode::automatic;
  propagation.max_interactions = 2;
  scenario.settings.threads = 1;
  return scenario;
}

std::vector<double> numbers_of(const FrameResult& frame) {
  std::vector<double> numbers;
  for (const LinkResult& link : frame.links) {
    numbers.push_back(static_cast<double>(link.paths.size()));
    for (const PathContribution& path : link.paths) {
      const auto own = all_numbers(path);
      numbers.insert(numbers.end(), own.begin(), own.end());
    }
  }
  return numbers;
}

std::set<std::string> ids(const Scene& scene, const LinkResult& link) {
  std::set<std::string> found;
  for (const PathContribution& path : link.paths) found.insert(path_id(scene, path.path));
  return found;
}

}  // namespace

TEST_CASE("a town is searched exactly without being told, and says so") {
  const io::Scenario scenario = town();
  REQUIRE(scenario.scene.surface_count() > exact_discovery_facet_limit);
  Simulator simulator(scenario.scene, scenario.settings);
  CHECK(simulator.discovery() == Discovery::exact);
  CHECK(simulator.cache() == CacheMode::exact);
  const FrameResult frame = simulator.advance_to(0.0);
  CHECK(frame.links.size() == 8);
  CHECK(frame.work.rays == 0);
  for (const LinkResult& link : frame.links) CHECK(link.complete);
}

TEST_CASE("200,000 rays from every end find no path of two interactions that exact discovery lacks") {
  io::Scenario scenario = town();
  Simulator exact(scenario.scene, scenario.settings);
  scenario.settings.propagation.discovery = Discovery::sampled;
  scenario.settings.propagation.cache = CacheMode::off;
  scenario.settings.propagation.rays = 200'000;
  Simulator sampled(scenario.scene, scenario.settings);
  std::size_t by_rays = 0, all = 0;
  for (const double time_s : {0.0, 4.0, 8.0}) {
    const FrameResult found = exact.advance_to(time_s), shot = sampled.advance_to(time_s);
    REQUIRE(found.links.size() == shot.links.size());
    for (std::size_t link = 0; link < found.links.size(); ++link) {
      const std::set<std::string> there = ids(exact.scene(), found.links[link]);
      for (const std::string& id : ids(sampled.scene(), shot.links[link])) CHECK_MESSAGE(there.contains(id), id);
      by_rays += shot.links[link].paths.size();
      all += there.size();
    }
  }
  MESSAGE("rays find " << by_rays << " of " << all << " paths");
  CHECK(by_rays > 100);
  CHECK(by_rays <= all);
}

TEST_CASE("every facet and every edge, tried one by one, gives no single reflection or diffraction more") {
  const io::Scenario scenario = town();
  Simulator simulator(scenario.scene, scenario.settings);
  const FrameResult frame = simulator.advance_to(2.0);
  std::size_t tried = 0, single = 0;
  for (const LinkResult& link : frame.links) {
    const std::set<std::string> there = ids(simulator.scene(), link);
    const auto check = [&](const Sequence& sequence) {
      ++tried;
      const auto path = simulator.solve_path(link.transmitter, link.receiver, sequence);
      if (!path) return;
      ++single;
      CHECK_MESSAGE(there.contains(path_id(simulator.scene(), path->path)), path_id(simulator.scene(), path->path));
    };
    check({});
    for (std::uint32_t facet = 0; facet < simulator.scene().facets().size(); ++facet) check({FacetId(facet)});
    for (std::uint32_t edge = 0; edge < simulator.scene().wedges().size(); ++edge) check({WedgeId(edge)});
  }
  MESSAGE(single << " paths among " << tried << " sequences");
  CHECK(single > 50);
}

TEST_CASE("Munich and Étoile: every facet and edge tried one by one, and rays for pairs, give no path more") {
  DCEM_NEEDS_SHARED();
  for (const char* file : {"scenes/munich.obj", "scenes/etoile.obj"}) {
    Scene scene;
    const TriangleMesh mesh = io::read_obj(shared_path(file)).mesh;
    for (const std::string& name : mesh.material_names) scene.add_material({name, PerfectConductor{}});
    scene.set_scenery(mesh);
    scene.add_transmitter(device_at("mast", {0.0, 0.0, 35.0}));
    scene.add_transmitter(device_at("street", {20.0, 40.0, 2.0}));
    for (int place = 0; place < 6; ++place) {
      const double turn_rad = 1.1 * place;
      const Vec3 position_m{(30.0 + 20.0 * place) * std::cos(turn_rad), (30.0 + 20.0 * place) * std::sin(turn_rad),
                            1.5};
      scene.add_receiver(device_at("street" + std::to_string(place), position_m));
    }
    SimulationSettings settings;
    settings.propagation.max_interactions = 2;
    settings.propagation.max_transmissions = 0;
    settings.threads = 2;
    Simulator exact(scene, settings);
    REQUIRE(exact.discovery() == Discovery::exact);
    settings.propagation.discovery = Discovery::sampled;
    settings.propagation.rays = 100'000;
    Simulator sampled(std::move(scene), settings);
    const FrameResult found = exact.advance_to(0.0), shot = sampled.advance_to(0.0);
    std::size_t single = 0, all = 0, by_rays = 0;
    for (std::size_t index = 0; index < found.links.size(); ++index) {
      const LinkResult& link = found.links[index];
      const std::set<std::string> there = ids(exact.scene(), link);
      const auto check = [&](const Sequence& sequence) {
        const auto path = exact.solve_path(link.transmitter, link.receiver, sequence);
        if (!path) return;
        ++single;
        const std::string id = path_id(exact.scene(), path->path);
        CHECK_MESSAGE(there.contains(id), id);
      };
      for (std::uint32_t facet = 0; facet < exact.scene().facets().size(); ++facet) check({FacetId(facet)});
      for (std::uint32_t edge = 0; edge < exact.scene().wedges().size(); ++edge) check({WedgeId(edge)});
      for (const std::string& id : ids(sampled.scene(), shot.links[index])) CHECK_MESSAGE(there.contains(id), id);
      all += there.size();
      by_rays += shot.links[index].paths.size();
    }
    MESSAGE(std::string(file) << ": " << all << " paths, " << single << " of one interaction, " << by_rays
                              << " found by rays");
    CHECK(single > 30);
    CHECK(by_rays > 100);
  }
}

TEST_CASE("kept halves, threads and frames left out change no bit") {
  io::Scenario scenario = town();
  Simulator steady(scenario.scene, scenario.settings);
  scenario.settings.threads = 3;
  Simulator threaded(scenario.scene, scenario.settings);
  for (const double time_s : {0.0, 0.1, 0.2, 3.0, 0.1}) {
    const std::vector<double> numbers = numbers_of(steady.advance_to(time_s));
    CHECK(numbers == numbers_of(threaded.advance_to(time_s)));
    Simulator fresh(scenario.scene, scenario.settings);
    CHECK(numbers == numbers_of(fresh.advance_to(time_s)));
  }
}

TEST_CASE("where more is allowed than is searched exactly, rays add to it and take nothing away") {
  io::Scenario scenario = town();
  Simulator exact(scenario.scene, scenario.settings);
  scenario.settings.propagation.max_interactions = 3;
  scenario.settings.propagation.max_diffractions = 2;
  scenario.settings.propagation.rays = 20'000;
  Simulator more(scenario.scene, scenario.settings);
  CHECK(more.discovery() == Discovery::sampled);
  const FrameResult few = exact.advance_to(1.0), many = more.advance_to(1.0);
  std::size_t longer = 0;
  for (std::size_t link = 0; link < few.links.size(); ++link) {
    CHECK_FALSE(many.links[link].complete);
    const std::set<std::string> all = ids(more.scene(), many.links[link]);
    for (const std::string& id : ids(exact.scene(), few.links[link])) CHECK_MESSAGE(all.contains(id), id);
    for (const PathContribution& path : many.links[link].paths) longer += sequence_of(path.path).size() > 2 ? 1U : 0U;
  }
  CHECK(longer > 10);
}

TEST_CASE("a simulator that is moved between two frames goes on with what it has listed") {
  TriangleMesh mesh;
  for (int box = 0; box < 170; ++box) {
    const Vec3 low_m(6.0 * (box % 13), 6.0 * (box / 13), 0.0);
    add_box_faces(mesh, low_m, low_m + Vec3(3, 2 + box % 3, 3 + box % 5), "metal");
  }
  Scene scene;
  scene.add_material({"metal", PerfectConductor{}});
  scene.set_scenery(mesh);
  REQUIRE(scene.facets().size() > exact_discovery_facet_limit);
  scene.add_transmitter(device_at("tx", {4.5, 4.5, 5.0}));
  scene.add_receiver(device_at("rx", {16.5, 11.0, 1.5}));
  SimulationSettings settings;
  settings.threads = 1;
  const MaterialTable surface = detail::material_table_of(scene, settings);
  BasicSimulator<MaterialTable> first(scene, settings, surface);
  REQUIRE(first.plan().joined == 3);
  const std::vector<double> numbers = numbers_of(first.advance(scene.frame_at(0.0, 0)));
  BasicSimulator<MaterialTable> second = std::move(first);
  CHECK(numbers == numbers_of(second.advance(scene.frame_at(0.0, 1))));
  CHECK(numbers.size() > 100);
}

}  // namespace test_exact_in_towns
