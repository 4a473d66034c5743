/// Two diffractions in a city: of all pairs of edges, some two hundred million for a link, none that carries a path is
/// missed. Exhaustion is all that this search shares nothing with: the solver says of both what a path is.
#include <doctest/doctest.h>

#include <array>
#include <vector>

#include "dcem/io/obj_reader.hpp"
#include "tests/paths/halves/small_town.hpp"
#include "tests/support/shared_data.hpp"

namespace test_edge_pairs_slow {

using namespace dcem;
using namespace dcem::test;

namespace {

Scene munich() {
  const TriangleMesh mesh = io::read_obj(shared_path("scenes/munich.obj")).mesh;
  Scene scene;
  for (const std::string& name : mesh.material_names) scene.add_material({name, PerfectConductor{}});
  scene.set_scenery(mesh);
  return scene;
}

/// The edges of whose solid side an end is not, and their lines as the solver takes them.
struct OpenEdges {
  std::vector<WedgeId> ids;
  std::vector<EdgeLine> lines;

  OpenEdges(const Scene& scene, const LinkEnd& end) {
    for (std::uint32_t number = 0; number < scene.wedges().size(); ++number) {
      const WorldWedge& wedge = scene.wedge(WedgeId(number));
      if (!diffracts(wedge, {}) || !may_face(wedge.edge, end.position_m - wedge.edge.start_m)) continue;
      const Vec3 along_m = wedge.edge.end_m - wedge.edge.start_m;
      ids.push_back(WedgeId(number));
      lines.push_back({wedge.edge.start_m, glm::normalize(along_m), glm::length(along_m)});
    }
  }
};

std::vector<Path> over_all_pairs(TracedScene<>& traced, const LinkEnd& from, const LinkEnd& to) {
  const OpenEdges far(traced.scene, from), near(traced.scene, to);
  PathSolver<WideIndex> solver(traced.tracer, 0);
  std::vector<Path> paths;
  const auto add = [&](const Sequence& sequence) {
    if (const auto path = solver.solve(from, to, sequence)) paths.push_back(*path);
  };
  add({});
  for (std::uint32_t number = 0; number < traced.scene.wedges().size(); ++number) add({WedgeId(number)});
  for (std::size_t last = 0; last < near.ids.size(); ++last) {
    for (std::size_t first = 0; first < far.ids.size(); ++first) {
      const std::array<EdgeLine, 2> lines{far.lines[first], near.lines[last]};
      EdgePlaces places_m{};
      if (far.ids[first] == near.ids[last] || !diffraction_places(from.position_m, lines, to.position_m, places_m))
        continue;
      add({near.ids[last], far.ids[first]});
    }
  }
  dcem::detail::sort_and_drop_repeated(paths);
  return paths;
}

}  // namespace

TEST_CASE("of all pairs of edges in Munich the search misses none that carries a path") {
  DCEM_NEEDS_SHARED();
  TracedScene<> traced(munich());
  const LinkEnd from = traced.end(Vec3(-14.77, 118.92, 25.0)), to = traced.end(Vec3(-2.77, 123.92, 1.5));
  const std::vector<Path> all = over_all_pairs(traced, from, to);
  MESSAGE(all.size() << " paths");
  CHECK(all.size() > 50);
  for (const Listed listed : {Listed::nothing, Listed::scenery}) {
    CHECK(same_paths(joined(traced, from, to, {0, 0, 2, 2}, 256, listed), all));
  }
}

}  // namespace test_edge_pairs_slow
