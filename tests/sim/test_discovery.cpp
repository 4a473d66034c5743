/// Which discovery a scene gets: what is asked for by name is done or refused.
#include "dcem/sim/discovery.hpp"

#include <doctest/doctest.h>

#include <string>

#include "tests/paths/small_scenes.hpp"

namespace test_discovery {

using namespace dcem;
using namespace dcem::test;

namespace {

/// So many separate facets of one triangle each.
Scene scene_with_facets(std::size_t count) {
  TriangleMesh mesh;
  const std::uint32_t material = material_index(mesh, "metal");
  for (std::size_t index = 0; index < count; ++index) {
    const double x = 3.0 * static_cast<double>(index);
    const auto first = static_cast<std::uint32_t>(mesh.vertices_m.size());
    mesh.vertices_m.insert(mesh.vertices_m.end(), {Vec3(x, 0, 0), Vec3(x + 1, 0, 0), Vec3(x, 1, 0)});
    mesh.triangles.push_back({{first, first + 1, first + 2}, material});
  }
  Scene scene = scene_of(mesh);
  REQUIRE(scene.facets().size() == count);
  return scene;
}

Discovery resolved(Discovery asked, int reflections, std::size_t facets, int diffractions = 0) {
  PropagationSettings propagation;
  propagation.discovery = asked;
  propagation.max_reflections = reflections;
  propagation.max_diffractions = diffractions;
  return resolve_discovery(propagation, scene_with_facets(facets));
}

}  // namespace

TEST_CASE("left to itself, discovery is exact while the scene is small for its order") {
  for (const int order : {0, 1, 2, 3}) {
    CHECK(resolved(Discovery::automatic, order, 1000) == Discovery::exact);
    CHECK(resolved(Discovery::automatic, order, 1001) == Discovery::exact);  // three interactions are, in any scene
  }
  CHECK(resolved(Discovery::automatic, 4, 32) == Discovery::exact);
  CHECK(resolved(Discovery::automatic, 10, 33) == Discovery::sampled);
}

TEST_CASE("edges make a scene large for exact discovery: each further diffraction sooner") {
  CHECK(resolved(Discovery::automatic, 2, 1001, 1) == Discovery::exact);  // one, after or before two mirrors
  std::size_t most = 1000, before = 1001;
  for (const int diffractions : {2, 3}) {
    while (most > 0 && resolved(Discovery::automatic, 2, most, diffractions) == Discovery::sampled) --most;
    MESSAGE(diffractions << " diffractions: exact up to " << most << " facets");
    CHECK(most >= 10);  // two boxes without a floor
    CHECK(resolved(Discovery::automatic, 2, most + 1, diffractions) == Discovery::sampled);
    CHECK(most < before);
    before = most;
  }
}

TEST_CASE("small scenes are searched exhaustively; in others short paths are found from halves, longer ones by rays") {
  PropagationSettings propagation;
  propagation.max_diffractions = 0;
  const SearchPlan small = plan_search(propagation, scene_with_facets(1000));
  CHECK((small.exhaustive && small.joined == 0));
  SearchPlan large = plan_search(propagation, scene_with_facets(1001));
  CHECK((!large.exhaustive && large.joined == 3 && large.discovery == Discovery::exact));
  propagation.max_diffractions = 1;
  CHECK(resolve_discovery(propagation, scene_with_facets(1001)) == Discovery::exact);
  propagation.max_reflections = 3;
  large = plan_search(propagation, scene_with_facets(1001));
  CHECK((!large.exhaustive && large.joined == 3 && large.discovery == Discovery::sampled));
  CHECK(exactly_searched_interactions(propagation, large) == 3);
  propagation.max_interactions = 3;
  CHECK(resolve_discovery(propagation, scene_with_facets(1001)) == Discovery::exact);
  propagation.max_diffractions = 2;  // two edges are not yet among what halves join
  CHECK(resolve_discovery(propagation, scene_with_facets(1001)) == Discovery::sampled);
  propagation.discovery = Discovery::sampled;
  large = plan_search(propagation, scene_with_facets(1001));
  CHECK((!large.exhaustive && large.joined == 0));
  CHECK(exactly_searched_interactions(propagation, large) == 0);
}

TEST_CASE("max_interactions counts when the order is judged") {
  PropagationSettings propagation;
  propagation.max_reflections = 10;
  propagation.max_diffractions = 0;
  propagation.max_interactions = 1;
  CHECK(resolve_discovery(propagation, scene_with_facets(300)) == Discovery::exact);
}

TEST_CASE("what is asked for by name is done, or refused with a reason") {
  CHECK(resolved(Discovery::sampled, 1, 3) == Discovery::sampled);
  CHECK(resolved(Discovery::exact, 3, 500) == Discovery::exact);
  CHECK(resolved(Discovery::exact, 1, 1000) == Discovery::exact);
  try {
    resolved(Discovery::exact, 4, 1001);
    FAIL("nothing was refused");
  } catch (const std::invalid_argument& error) {
    CHECK(std::string(error.what()).find("1001") != std::string::npos);
    CHECK(std::string(error.what()).find("1000") != std::string::npos);
    CHECK(std::string(error.what()).find("not in this version") != std::string::npos);
  }
}

TEST_CASE("an empty scene is solved exactly") {
  CHECK(resolved(Discovery::automatic, 10, 0) == Discovery::exact);
}

}  // namespace test_discovery
