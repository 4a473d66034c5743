#pragma once
/// Diffuse power of a link on a fine and even grid of points, leg by leg with rays: it knows nothing of visible parts,
/// of bounds and of estimates.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "dcem/accel/wide_index.hpp"
#include "dcem/field/diffuse/scattered_power.hpp"
#include "dcem/sim/simulator.hpp"
#include "tests/support/scatter_solver.hpp"

namespace dcem::test {

/// Points of a triangle with the area that each stands for: rows along its longest edge, no cell larger than `cell_m`.
template <typename Visit>
void for_each_cell(const TriangleCorners& corners, double cell_m, Visit&& visit) {
  std::size_t first = 0;
  for (std::size_t edge = 1; edge < 3; ++edge) {
    const auto length_m = [&](std::size_t one) { return glm::distance(corners[one], corners[(one + 1) % 3]); };
    if (length_m(edge) > length_m(first)) first = edge;
  }
  const Vec3 &from = corners[first], &to = corners[(first + 1) % 3], &top = corners[(first + 2) % 3];
  const double base_m = glm::distance(from, to), height_m = glm::length(glm::cross(to - from, top - from)) / base_m;
  const int rows = static_cast<int>(std::ceil(height_m / cell_m));
  for (int row = 0; row < rows; ++row) {
    const double up = (row + 0.5) / rows, width_m = base_m * (1.0 - up);
    const int cells = static_cast<int>(std::ceil(width_m / cell_m));
    for (int cell = 0; cell < cells; ++cell) {
      const Vec3 left_m = from + up * (top - from), right_m = to + up * (top - to);
      visit(left_m + (cell + 0.5) / cells * (right_m - left_m), width_m / cells * height_m / rows);
    }
  }
}

/// A scene, as it stands, with all that the power of one of its points is made of. Everything named must outlive it.
struct Illuminated {
  Illuminated(const Scene& world, double frequency_hz)
      : scene(world),
        tracer(scene, index),
        table({scene.materials().begin(), scene.materials().end()}, frequency_hz),
        medium({}, scene.materials(), frequency_hz),
        scattered(scene, table, loss, medium, frequency_hz) {
    index.build(scene.triangle_view(), scene.triangle_boxes(), scene.first_triangles());
  }

  LinkEnd end_at(const Vec3& position_m, const std::optional<BodyId>& ridden = {}) const {
    TraversalCounters counters;
    return make_link_end(tracer, position_m, ridden, counters);
  }

  const Scene& scene;
  WideIndex index;
  SceneTracer<WideIndex> tracer;
  MaterialTable table;
  AnyPathLoss loss;
  MediumLoss medium;
  ScatteredPower<MaterialTable, AnyPathLoss> scattered;
};

/// The power between two ends on an even grid, relative to what is sent.
inline double grid_power(const Illuminated& world, const LinkEnd& from, const LinkEnd& to, const RadioEnd& sender,
                         const RadioEnd& listener, double cell_m, int max_transmissions) {
  ScatterSolver<WideIndex> solver(world.tracer, max_transmissions);
  Path path;
  double sum = 0.0;
  for (std::uint32_t triangle = 0; triangle < world.scene.triangles().size(); ++triangle) {
    const FacetId facet = world.scene.facet_of_triangle(triangle);
    if (!solver.may_scatter(from, to, facet)) continue;
    for_each_cell(world.scene.corners_m(triangle), cell_m, [&](const Vec3& point_m, double area_m2) {
      if (!solver.solve(from, to, facet, point_m, path)) return;
      sum += area_m2 * world.scattered.power_per_m2(path, sender, listener);
    });
  }
  return sum;
}

/// The same between isotropic ends.
inline double grid_power(const Illuminated& world, const LinkEnd& from, const LinkEnd& to, double cell_m,
                         int max_transmissions) {
  return grid_power(world, from, to, RadioEnd{from.position_m}, RadioEnd{to.position_m}, cell_m, max_transmissions);
}
inline double grid_power(const Illuminated& world, const Vec3& from_m, const Vec3& to_m, double cell_m,
                         int max_transmissions) {
  return grid_power(world, world.end_at(from_m), world.end_at(to_m), cell_m, max_transmissions);
}

}  // namespace dcem::test
