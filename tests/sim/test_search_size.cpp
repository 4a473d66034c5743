/// How much an exhaustive search would be: what is said of it before it begins.
#include "dcem/sim/search_size.hpp"

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "dcem/sim/discovery.hpp"
#include "dcem/sim/simulator.hpp"
#include "tests/paths/small_scenes.hpp"

namespace test_search_size {

using namespace dcem;
using namespace dcem::test;

namespace {

/// A room with some boxes in it, and a transmitter.
Scene furnished_room(int boxes) {
  TriangleMesh mesh;
  add_box_faces(mesh, Vec3(0, 0, 0), Vec3(12, 9, 4), "metal");
  for (int index = 0; index < boxes; ++index) {
    const Vec3 low_m(1.1 + 2.3 * (index % 4), 1.3 + 2.7 * (index / 4), 0.2 + 0.1 * index);
    add_box_faces(mesh, low_m, low_m + Vec3(0.9, 0.7 + 0.05 * index, 0.8), "metal");
  }
  Scene scene = scene_of(mesh);
  scene.add_transmitter(device_at("tx", {0.4, 0.6, 3.1}, 30.0));
  return scene;
}

PropagationSettings orders(int reflections, int diffractions, Discovery discovery = Discovery::exact) {
  PropagationSettings propagation;
  propagation.max_reflections = reflections;
  propagation.max_diffractions = diffractions;
  propagation.max_transmissions = 0;
  propagation.discovery = discovery;
  return propagation;
}

std::string refusal(const PropagationSettings& propagation, const Scene& scene) {
  try {
    plan_search(propagation, scene);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST_CASE("what is estimated is what a search then tries") {
  struct Case {
    int boxes, reflections, diffractions;
    double within;  ///< as a factor: chains are joined at edges that both ends must reach
  };
  for (const auto& [boxes, reflections, diffractions, within] :
       {Case{0, 5, 0, 1.1}, Case{2, 4, 0, 1.2}, Case{4, 3, 0, 1.2}, Case{2, 2, 1, 1.6}, Case{2, 1, 2, 1.6}}) {
    Scene scene = furnished_room(boxes);
    const std::vector<Vec3> ends_m{Vec3(0.4, 0.6, 3.1), Vec3(11.2, 7.9, 1.3)};
    const PropagationSettings propagation = orders(reflections, diffractions);
    const double estimated = detail::probed_sequences(propagation, scene, ends_m);
    scene.add_receiver(device_at("rx", ends_m[1]));
    SimulationSettings settings{.frequency_hz = 30e9};
    settings.propagation = propagation;
    settings.propagation.cache = CacheMode::off;  // what is remembered is not found by trying all sequences
    Simulator simulator(scene, settings);
    REQUIRE(simulator.plan().exhaustive);
    const auto tried = static_cast<double>(simulator.advance_to(0.0).work.sequences_proposed);
    MESSAGE(scene.facets().size() << " facets, " << reflections << " + " << diffractions << ": " << estimated
                                  << " estimated, " << tried << " tried");
    CHECK(estimated < within * tried);
    CHECK(estimated > tried / within);
    CHECK(detail::count_all_sequences(propagation, scene) >= tried);
  }
}

TEST_CASE("an order that cannot end is refused with what it would take and what would end") {
  const Scene scene = furnished_room(8);
  const std::string said = refusal(orders(10, 3), scene);
  MESSAGE(said);
  for (const char* piece : {"discovery exact: 54 facets", "10 reflections", "3 diffractions", "sequences", " years",
                            "; expected max_interactions "}) {
    CAPTURE(piece);
    CHECK(said.find(piece) != std::string::npos);
  }
  // What is offered instead is accepted, and one more is not.
  PropagationSettings less = orders(10, 3);
  less.max_interactions = std::stoi(said.substr(said.find("max_interactions ") + 17));
  CHECK(refusal(less, scene).empty());
  CHECK(plan_search(less, scene).exhaustive);
  ++*less.max_interactions;
  CHECK_FALSE(refusal(less, scene).empty());
}

TEST_CASE("what halves find exactly is refused in no scene") {
  PropagationSettings propagation = orders(10, 1);
  propagation.max_interactions = 3;
  CHECK(refusal(propagation, furnished_room(8)).empty());
}

TEST_CASE("left to itself, discovery begins no search that does not end") {
  std::size_t endless = 0;
  for (const int boxes : {0, 1, 2, 4}) {
    const Scene scene = furnished_room(boxes);
    for (const int reflections : {0, 2, 4, 7, 10}) {
      for (const int diffractions : {0, 1, 2, 3}) {
        const PropagationSettings propagation = orders(reflections, diffractions, Discovery::automatic);
        const SearchPlan plan = plan_search(propagation, scene);
        const bool ends = search_ends(propagation, scene);
        if (plan.exhaustive) CHECK(ends);
        endless += ends ? 0 : 1;
      }
    }
  }
  CHECK(endless > 5);
}

TEST_CASE("durations are told in units that a person counts in") {
  CHECK(rough_duration(1.0) == "1 second");
  CHECK(rough_duration(45.0) == "45 seconds");
  CHECK(rough_duration(600.0) == "10 minutes");
  CHECK(rough_duration(5.0 * 3600.0) == "5 hours");
  CHECK(rough_duration(3.4 * 86'400.0) == "3.4 days");
  CHECK(rough_duration(1e12) == "3.2e+04 years");
}

}  // namespace test_search_size
