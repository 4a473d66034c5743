/// The name of a path stays while things move, come and go.
#include "dcem/paths/path_id.hpp"

#include <doctest/doctest.h>

#include <map>
#include <string>
#include <vector>

#include "dcem/paths/path_finder.hpp"
#include "tests/paths/small_scenes.hpp"

namespace test_path_id {

using namespace dcem;
using namespace dcem::test;

namespace {

struct NamedObject {
  std::string id;
  Vec3 position_m;
  Vec3 velocity_mps;
};

/// A street between two walls with some glass boxes on it.
Scene street(const std::vector<NamedObject>& objects) {
  TriangleMesh mesh;
  add_sheet(mesh, Vec3(0, 0, 0), Vec3(50, 0, 0), Vec3(0, 10, 0), "opaque");
  add_sheet(mesh, Vec3(0, 10, 5), Vec3(50, 0, 0), Vec3(0, 0, 5), "metal");
  add_sheet(mesh, Vec3(0, -10, 5), Vec3(50, 0, 0), Vec3(0, 0, 5), "metal");
  Scene scene = scene_of(mesh);
  for (const NamedObject& object : objects) {
    const std::string material = object.id == "hall" ? "glass" : "metal";
    scene.add_object(object.id, make_box(Vec3(4, 2, 1.5), material),
                     LinearMotion{{object.position_m}, object.velocity_mps, 0});
  }
  return scene;
}

/// Names of all paths up to two reflections, each with its kinds.
std::map<std::string, std::string> names(Scene scene, double time_s) {
  TracedScene<> traced(std::move(scene));
  traced.apply(traced.scene.frame_at(time_s));
  SearchCounters counters;
  const std::vector<std::optional<LinkEnd>> transmitters{traced.end(Vec3(-20, 1, 2))};
  const auto links =
      find_paths(traced.tracer, PathSearchSettings{}, traced.end(Vec3(18, -2, 1.2)), {"ue", 0}, transmitters, counters);
  std::map<std::string, std::string> named;
  for (const Path& path : links.at(0).paths) {
    CHECK(named.emplace(path_id(traced.scene, path), kinds(path)).second);  // no name twice in a link
  }
  return named;
}

}  // namespace

TEST_CASE("a name says kind, facet within its body, and object") {
  Scene scene = street({{"car", Vec3(0, 0, 0), Vec3(0.0)}});
  const std::size_t scenery = scene.facets().size() - 6;
  CHECK(path_id(scene, {}) == "LOS");
  const Path path{
      {{InteractionKind::reflection, FacetId(2), {}}, {InteractionKind::transmission, FacetId(scenery + 3), {}}}, 1.0};
  CHECK(path_id(scene, path) == "R2/T3@car");
}

TEST_CASE("names do not change when objects move or others are added") {
  const NamedObject car{"car", Vec3(0, 4, 0), Vec3(0.5, 0, 0)};
  const NamedObject hall{"hall", Vec3(5, -1, 0), Vec3(0, 0.01, 0)};
  const auto now = names(street({car, hall}), 0.0), later = names(street({car, hall}), 0.2);
  CHECK(now.size() > 6);
  CHECK(now == later);
  bool met_object = false;
  for (const auto& [name, kinds] : now) met_object = met_object || name.find('@') != std::string::npos;
  CHECK(met_object);
  // Far away, behind the walls, in front of the others in the order of objects and behind them.
  const NamedObject bus{"bus", Vec3(0, 60, 0), Vec3(0.0)};
  CHECK(names(street({bus, car, hall}), 0.0) == now);
  CHECK(names(street({hall, car, bus}), 0.0) == now);
}

TEST_CASE("the order of triangles in a file does not rename a path") {
  const auto room = [](bool backwards) {
    TriangleMesh mesh;
    add_box_faces(mesh, Vec3(0.0), Vec3(5, 4, 3), "metal");
    if (backwards) std::reverse(mesh.triangles.begin(), mesh.triangles.end());
    return scene_of(mesh);
  };
  const auto names_in = [](Scene scene) {
    TracedScene<> traced(std::move(scene));
    SearchCounters counters;
    const std::vector<std::optional<LinkEnd>> transmitters{traced.end(Vec3(1, 1, 1))};
    const auto links = find_paths(traced.tracer, PathSearchSettings{}, traced.end(Vec3(4.1, 2.7, 1.7)), {"ue", 0},
                                  transmitters, counters);
    std::vector<std::string> all;
    for (const Path& path : links.at(0).paths) all.push_back(path_id(traced.scene, path));
    return all;
  };
  CHECK(names_in(room(false)).size() == 25);  // 1 + 6 + 18 in a closed box
  CHECK(names_in(room(false)) == names_in(room(true)));
}

}  // namespace test_path_id
