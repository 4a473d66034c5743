#pragma once
/// Whether a receiver could stand at a point at all.
#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "dcem/paths/query/scene_tracer.hpp"

namespace dcem {

/// An enclosing shell: (body, number of the shell within it).
using Shell = std::pair<BodyId, std::uint32_t>;

namespace detail {

/// Whether a point is above the foot of a shell, which may be open there, in the body's own coordinates.
inline bool above_foot(const Scene& scene, const Shell& shell, const Vec3& point_m) {
  const auto& [body, number] = shell;
  const Pose& pose = scene.body_state(body).placement.pose;
  const double height_m = glm::dot(rotation_matrix(pose)[2], point_m - pose.position_m);  // along the body's own z
  return height_m >= scene.body(body).mesh.shell_foot_m[number - 1];
}

}  // namespace detail

/// Enclosing shells that hold a point, ascending: those that a ray upwards from it crosses an odd number of times.
template <typename Index>
std::vector<Shell> shells_around(const SceneTracer<Index>& tracer, const Index& index, const Vec3& point_m) {
  // Upwards, because a house may lack its floor; with no relation to any wall, so that the ray meets no edge.
  const Ray<double> ray{point_m, Vec3(0.271'828'182'8, 0.141'421'356'2, 1.0)};
  const Scene& scene = tracer.scene();
  std::map<Shell, std::set<FacetId>> crossed;  // a facet is plane: it is crossed once, even on a diagonal
  const auto note = [&](const TriangleHit& hit) {
    const std::uint32_t shell = scene.shell_of_triangle(hit.triangle);
    if (shell == 0 || !(hit.t > 0.0)) return false;
    const FacetId facet = scene.facet_of_triangle(hit.triangle);
    crossed[{scene.facet(facet).body, shell}].insert(facet);
    return false;
  };
  index.visit_hits(ray, HitFilter{}, note, nullptr);
  std::vector<Shell> around;
  for (const auto& [shell, facets] : crossed) {
    if (facets.size() % 2 == 1 && detail::above_foot(scene, shell, point_m)) around.push_back(shell);
  }
  return around;
}

/// Points inside closed objects or on a surface are obstructed. A closed shell that holds a transmitter is taken for a
/// room, any other for a solid body.
template <typename Index>
class ObstructionTest {
 public:
  ObstructionTest(const SceneTracer<Index>& tracer, const Index& index, const std::vector<Vec3>& transmitters_m)
      : tracer_(tracer), index_(index) {
    for (const Vec3& transmitter_m : transmitters_m) add_rooms(transmitter_m);
  }

  bool obstructed(const Vec3& point_m) const {
    TraversalCounters counters;
    const double tolerance_m = tracer_.scene().settings().weld_tolerance_m;
    if (!tracer_.facets_near(point_m, tolerance_m, {}, counters).empty()) return true;
    const std::vector<Shell> around = shells_around(tracer_, index_, point_m);
    return std::any_of(around.begin(), around.end(), [&](const Shell& shell) {
      return std::find(rooms_.begin(), rooms_.end(), shell) == rooms_.end();
    });
  }

 private:
  /// The shells around a transmitter, and those that it is mounted on: what it is mounted on does not hide it.
  void add_rooms(const Vec3& transmitter_m) {
    const Scene& scene = tracer_.scene();
    const std::vector<Shell> around = shells_around(tracer_, index_, transmitter_m);
    rooms_.insert(rooms_.end(), around.begin(), around.end());
    TraversalCounters counters;
    for (const FacetId id : tracer_.facets_near(transmitter_m, scene.settings().weld_tolerance_m, {}, counters)) {
      const WorldFacet& facet = scene.facet(id);
      rooms_.emplace_back(facet.body, scene.shell_of_triangle(facet.first_triangle));
    }
  }

  const SceneTracer<Index>& tracer_;
  const Index& index_;
  std::vector<Shell> rooms_;
};

}  // namespace dcem
