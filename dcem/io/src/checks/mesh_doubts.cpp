#include "dcem/io/src/checks/mesh_doubts.hpp"

#include <algorithm>
#include <cmath>

#include "dcem/core/statistics.hpp"
#include "dcem/geometry/aabb.hpp"
#include "dcem/io/text_table.hpp"

namespace dcem::io {
namespace {

constexpr std::size_t least_triangles = 20;
constexpr double millimetres_height_m = 2000.0, millimetres_edge_m = 500.0;
constexpr double degrees_width_m = 2.0, degrees_slenderness = 10.0;
constexpr double upright_height_m = 150.0, flatness = 4.0;
constexpr double longest_object_m = 500.0;
constexpr double highest_storey_m = 150.0, least_storey_m = 1.8, most_storey_m = 4.5, least_width_m = 6.0;
constexpr double narrowness = 1.6;
constexpr double covered_share = 0.6;  ///< of a storey's plan, by its floor and by its ceiling

/// Of what faces use: other vertices are not drawn either.
Aabb<double> box_of(const TriangleMesh& mesh) {
  Aabb<double> box;
  for (const TriangleMesh::Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t vertex : triangle.vertices) box.extend(mesh.vertices_m[vertex]);
  }
  return box;
}

double median_edge_m(const TriangleMesh& mesh) {
  std::vector<double> lengths_m;
  for (const TriangleMesh::Triangle& triangle : mesh.triangles) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      lengths_m.push_back(glm::length(mesh.vertices_m[triangle.vertices[corner]] -
                                      mesh.vertices_m[triangle.vertices[(corner + 1) % 3]]));
    }
  }
  return median(std::move(lengths_m));
}

/// How much of the area faces along each axis, m².
Vec3 facing_m2(const TriangleMesh& mesh) {
  Vec3 sum_m2(0.0);
  for (const TriangleMesh::Triangle& triangle : mesh.triangles) {
    const Vec3& first_m = mesh.vertices_m[triangle.vertices[0]];
    sum_m2 += 0.5 * glm::abs(glm::cross(mesh.vertices_m[triangle.vertices[1]] - first_m,
                                        mesh.vertices_m[triangle.vertices[2]] - first_m));
  }
  return sum_m2;
}

/// A tenth of the triangles stands upright: a mountain has none.
bool has_walls(const TriangleMesh& mesh) {
  const auto upright = std::ranges::count_if(mesh.triangles, [&](const TriangleMesh::Triangle& triangle) {
    const Vec3& first_m = mesh.vertices_m[triangle.vertices[0]];
    const Vec3 normal =
        glm::cross(mesh.vertices_m[triangle.vertices[1]] - first_m, mesh.vertices_m[triangle.vertices[2]] - first_m);
    return std::abs(normal.z) < 0.05 * glm::length(normal);
  });
  return 10 * static_cast<std::size_t>(upright) >= mesh.triangles.size();
}

bool is_flat_along_y(const TriangleMesh& mesh, const Vec3& size_m) {
  if (size_m.z < upright_height_m || flatness * size_m.y > std::min(size_m.x, size_m.z)) return false;
  const Vec3 area_m2 = facing_m2(mesh);
  return area_m2.y > std::max(area_m2.x, area_m2.z);
}

/// How much of a box's plan across an axis is covered near its low and near its high end, the smaller of both: 1 for a
/// closed room, little for houses on a ground.
double covered_at_both_ends(const TriangleMesh& mesh, const Aabb<double>& box, int axis) {
  const Vec3 size_m = box.max - box.min;
  const double plan_m2 = size_m[(axis + 1) % 3] * size_m[(axis + 2) % 3];
  double low_m2 = 0.0, high_m2 = 0.0;
  for (const TriangleMesh::Triangle& triangle : mesh.triangles) {
    const Vec3& first_m = mesh.vertices_m[triangle.vertices[0]];
    const Vec3 second_m = mesh.vertices_m[triangle.vertices[1]], third_m = mesh.vertices_m[triangle.vertices[2]];
    const double facing_m2 = 0.5 * std::abs(glm::cross(second_m - first_m, third_m - first_m)[axis]);
    const double low_end_m = std::min({first_m[axis], second_m[axis], third_m[axis]}) - box.min[axis];
    const double high_end_m = box.max[axis] - std::max({first_m[axis], second_m[axis], third_m[axis]});
    if (low_end_m <= 0.2 * size_m[axis]) low_m2 += facing_m2;
    if (high_end_m <= 0.2 * size_m[axis]) high_m2 += facing_m2;
  }
  return plan_m2 > 0.0 ? std::min(low_m2, high_m2) / plan_m2 : 0.0;
}

bool is_storey_on_its_side(const TriangleMesh& mesh, const Aabb<double>& box) {
  const Vec3 size_m = box.max - box.min;
  const double width_m = std::min(size_m.x, size_m.z);
  const bool is_slab = size_m.y >= least_storey_m && size_m.y <= most_storey_m && width_m >= least_width_m &&
                       width_m > narrowness * size_m.y;  // a tunnel for one track is higher than wide, but not by much
  if (!is_slab || covered_at_both_ends(mesh, box, 1) < covered_share) return false;
  // An alley between two houses has neither ends nor a roof.
  return covered_at_both_ends(mesh, box, 0) >= covered_share && covered_at_both_ends(mesh, box, 2) >= covered_share;
}

bool is_enormous_storey(const TriangleMesh& mesh, const Aabb<double>& box) {
  const Vec3 size_m = box.max - box.min;
  return size_m.z >= highest_storey_m && std::min(size_m.x, size_m.y) > size_m.z &&
         covered_at_both_ends(mesh, box, 2) >= covered_share && has_walls(mesh);
}

std::string size_text(const Vec3& size_m) {
  const auto number = [](double length_m) { return format_fixed(length_m, length_m < 10.0 ? 3 : 0); };
  return number(size_m.x) + " x " + number(size_m.y) + " x " + number(size_m.z) + " m";
}

}  // namespace

std::vector<std::string> mesh_doubts(const TriangleMesh& mesh) {
  if (mesh.triangles.size() < least_triangles) return {};
  const Aabb<double> box = box_of(mesh);
  const Vec3 size_m = box.max - box.min;
  const double width_m = std::max(size_m.x, size_m.y);
  if (size_m.z >= millimetres_height_m && median_edge_m(mesh) >= millimetres_edge_m && has_walls(mesh)) {
    return {"is " + size_text(size_m) + " in size; is it in millimetres (unit_m 0.001) or centimetres (unit_m 0.01)?"};
  }
  if (is_enormous_storey(mesh, box)) {
    return {"is " + size_text(size_m) + " in size with a ceiling over all of it; is it in centimetres (unit_m 0.01)" +
            " or millimetres (unit_m 0.001)?"};
  }
  if (width_m < degrees_width_m && size_m.z > degrees_slenderness * width_m) {
    return {"is " + size_text(size_m) + " in size; are x and y in degrees? They must be in one unit with z"};
  }
  if (is_flat_along_y(mesh, size_m) || is_storey_on_its_side(mesh, box)) {
    return {"is " + size_text(size_m) + " in size and flat along y; does another axis of the file point up (up)?"};
  }
  return {};
}

std::vector<std::string> object_doubts(const TriangleMesh& mesh) {
  const Aabb<double> box = box_of(mesh);
  const Vec3 size_m = box.max - box.min;
  if (std::max({size_m.x, size_m.y, size_m.z}) <= longest_object_m) return {};
  return {"is " + size_text(size_m) + " in size; is it in another unit (unit_m)?"};
}

}  // namespace dcem::io
