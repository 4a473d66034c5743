#pragma once
/// Heaps of boxes and sheets around an edge, made to deceive its image.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "dcem/paths/solve/edge_rules.hpp"
#include "tests/paths/small_scenes.hpp"

namespace dcem::test {

/// Three unit vectors that are across each other.
using Axes = std::array<Vec3, 3>;

inline Axes any_axes(Draw& draw) {
  const Vec3 first = draw.direction(), second = glm::normalize(glm::cross(first, draw.direction()));
  return {first, second, glm::cross(first, second)};
}

inline std::string some_material(Draw& draw) {
  return std::array{"metal", "opaque", "glass", "wall"}[draw.below(4)];
}

/// An edge with three to forty things about it. The edge is that of a box, along z at the origin, before all is turned.
class KellerHeap {
 public:
  explicit KellerHeap(Draw& draw) : draw_(draw) {
    length_m_ = draw.magnitude(0.01, 100.0);
    size_m_ = draw.magnitude(0.3, 3.0) * std::max(1.0, length_m_);
    add_edge();
    const std::size_t things = 3 + draw.below(38);
    for (std::size_t thing = 0; thing < things; ++thing) add_thing();
    turn();
  }

  /// A scene of all that; the edge in question is that which is nearest to where it was put.
  Scene scene() const { return scene_of(mesh_); }
  std::vector<WedgeId> edges_of(const Scene& scene) const {
    std::vector<WedgeId> edges;
    std::optional<WedgeId> nearest;
    for (std::uint32_t number = 0; number < scene.wedges().size(); ++number) {
      const WedgeId id(number);
      EdgeRules rules;
      rules.free_edges = true;
      if (!diffracts(scene.wedge(id), rules)) continue;
      if (draw_.below(scene.wedges().size()) < 2) edges.push_back(id);
      if (!nearest || off_m(scene, id) < off_m(scene, *nearest)) nearest = id;
    }
    if (nearest) edges.push_back(*nearest);
    return edges;
  }

 private:
  double off_m(const Scene& scene, WedgeId id) const {
    const Wedge& edge = scene.wedge(id).edge;
    return glm::distance(0.5 * (edge.start_m + edge.end_m), middle_m_);
  }

  /// A prism of three or four sides, and the edge between two of them: of any angle but flat ones.
  void add_edge() {
    const double turn = draw_.between(0.02, 2.9), width_m = draw_.magnitude(0.02, 1.0) * size_m_;
    const Vec3 up(0, 0, length_m_), one(width_m, 0, 0), two = width_m * Vec3(std::cos(turn), -std::sin(turn), 0);
    const std::string material = some_material(draw_);
    add_quad(mesh_, {Vec3(0.0), one, one + up, up}, material);
    add_quad(mesh_, {Vec3(0.0), up, two + up, two}, material);
    add_quad(mesh_, {one, two, two + up, one + up}, material);
    middle_m_ = 0.5 * up;
  }

  void add_thing() {
    switch (draw_.below(9)) {
      case 0:
      case 1:
        return add_box();
      case 2:
        return add_box_with_patch();
      case 3:
        return add_frame();
      case 4:
        return add_beside_edge();
      case 5:
        return add_touching();
      case 6:
        return add_holding();
      case 7:
        return add_warped();
      default:
        return add_sheet(mesh_, place(), some_m() * draw_.direction(), some_m() * draw_.direction(),
                         some_material(draw_));
    }
  }

  double some_m() { return draw_.magnitude(0.01, 2.0) * size_m_; }
  /// Close to the edge or far from it.
  Vec3 place() {
    return Vec3(0, 0, draw_.between(-0.5, 1.5) * length_m_) + draw_.magnitude(0.02, 3.0) * size_m_ * draw_.direction();
  }

  Vec3 in_box(const Axes& axes, const Vec3& middle_m, const Vec3& at_m) const {
    return middle_m + at_m.x * axes[0] + at_m.y * axes[1] + at_m.z * axes[2];
  }

  void add_turned_box(const Axes& axes, const Vec3& middle_m, const Vec3& half_m) {
    TriangleMesh box;
    add_box_faces(box, -half_m, half_m, some_material(draw_));
    for (Vec3& vertex_m : box.vertices_m) vertex_m = in_box(axes, middle_m, vertex_m);
    append(box);
  }

  void append(const TriangleMesh& more) {
    const auto first = static_cast<std::uint32_t>(mesh_.vertices_m.size());
    mesh_.vertices_m.insert(mesh_.vertices_m.end(), more.vertices_m.begin(), more.vertices_m.end());
    for (const auto& triangle : more.triangles) {
      const auto& [a, b, c] = triangle.vertices;
      const std::uint32_t material = material_index(mesh_, more.material_names[triangle.material]);
      mesh_.triangles.push_back({{first + a, first + b, first + c}, material});
    }
  }

  void add_box() { add_turned_box(any_axes(draw_), place(), {some_m(), some_m(), some_m()}); }

  /// A patch within the lift of a wall, or a little in front of it, along it but for dirt; others stand on it.
  void add_box_with_patch() {
    const Axes axes = any_axes(draw_);
    const Vec3 half_m(some_m(), some_m(), some_m()), middle_m = place();
    add_turned_box(axes, middle_m, half_m);
    for (std::size_t patch = 0; patch < 3; ++patch) {
      const double off_m = draw_.between(-2e-4, 6e-4), tilt = draw_.below(2) == 0 ? 0.0 : draw_.between(-0.2, 0.2);
      const Vec3 at(draw_.between(-1, 1) * half_m.x, draw_.between(-1, 1) * half_m.y, half_m.z + off_m);
      const double wide_m = draw_.magnitude(0.003, 1.0) * half_m.x, high_m = draw_.magnitude(0.003, 1.0) * half_m.y;
      add_sheet(mesh_, in_box(axes, middle_m, at), wide_m * glm::normalize(axes[0] + tilt * 1e-3 / wide_m * axes[2]),
                high_m * axes[1], some_material(draw_));
    }
  }

  /// Four bars around a hole, one facet; or three of them, a dent.
  void add_frame() {
    const Axes axes = any_axes(draw_);
    const Vec3 middle_m = place();
    const double out_m = some_m(), in_m = draw_.between(0.1, 0.95) * out_m;
    const std::string material = some_material(draw_);
    const std::size_t bars = 3 + draw_.below(2);
    const std::array<Vec3, 4> corners{Vec3(-1, -1, 0), Vec3(1, -1, 0), Vec3(1, 1, 0), Vec3(-1, 1, 0)};
    for (std::size_t bar = 0; bar < bars; ++bar) {
      const Vec3 &from = corners[bar], &to = corners[(bar + 1) % 4];
      add_quad(mesh_,
               {in_box(axes, middle_m, out_m * from), in_box(axes, middle_m, out_m * to),
                in_box(axes, middle_m, in_m * to), in_box(axes, middle_m, in_m * from)},
               material);
    }
  }

  /// A sheet that passes the edge's line, or is pierced by it, closer than it is wide.
  void add_beside_edge() {
    const double turn = draw_.between(-pi, pi), off_m = draw_.magnitude(0.015, 1.0);
    const Vec3 away(std::cos(turn), std::sin(turn), 0), aside(-away.y, away.x, draw_.between(-1, 1));
    const Vec3 on_line_m(0, 0, draw_.between(-0.5, 1.5) * length_m_);
    const Vec3 along = draw_.direction();
    const double half_m = draw_.between(5.0, 40.0) * off_m, deep_m = some_m();
    const double side = draw_.below(3) == 0 ? -1.0 : 1.0;
    add_quad(mesh_,
             {on_line_m + side * off_m * away - half_m * aside, on_line_m + side * off_m * away + half_m * aside,
              on_line_m + side * off_m * away + half_m * aside + deep_m * (away + along),
              on_line_m + side * off_m * away - half_m * aside + deep_m * (away + along)},
             some_material(draw_));
  }

  /// A wall that begins at the edge, or a hair from it.
  void add_touching() {
    const Vec3 at_m(0, 0, draw_.between(0, 1) * length_m_), away = draw_.direction(), along = draw_.direction();
    const Vec3 from_m = at_m + static_cast<double>(draw_.below(2)) * draw_.magnitude(1e-5, 0.1) * away;
    const double wide_m = some_m(), high_m = some_m();
    add_quad(mesh_, {from_m, from_m + wide_m * away, from_m + wide_m * away + high_m * along, from_m + high_m * along},
             some_material(draw_));
  }

  /// A sheet off the edge, whose plane holds it, or nearly.
  void add_holding() {
    const double turn = draw_.between(-pi, pi), tilt = draw_.magnitude(1e-6, 0.1);
    const Vec3 away(std::cos(turn), std::sin(turn), draw_.below(2) == 0 ? 0.0 : draw_.between(-2, 2));
    const Vec3 up = glm::normalize(Vec3(tilt * away.y, -tilt * away.x, 1.0));
    const Vec3 off_m = draw_.magnitude(1e-6, 0.05) * Vec3(away.y, -away.x, 0);
    add_sheet(mesh_, off_m + (some_m() + 0.02) * away + draw_.between(-1, 2) * length_m_ * up, some_m() * away,
              some_m() * up, some_material(draw_));
  }

  /// Tiles that are one facet though they stray from its plane.
  void add_warped() {
    TriangleMesh tiles;
    const Axes axes = any_axes(draw_);
    add_tiled_sheet(tiles, Vec3(0.0), Vec3(some_m(), 0, 0), Vec3(0, some_m(), 0), 3, some_material(draw_));
    const double stray_m = draw_.magnitude(1e-7, 1e-3);
    const Vec3 middle_m = place();
    const auto bent_m = [&](const Vec3& at) { return stray_m * std::sin(7.0 * at.x + 3.0 * at.y); };
    for (Vec3& at_m : tiles.vertices_m) at_m = in_box(axes, middle_m, Vec3(at_m.x, at_m.y, bent_m(at_m)));
    append(tiles);
  }

  /// Turns everything, somewhere in the world.
  void turn() {
    const Axes axes = any_axes(draw_);
    const Vec3 to_m = draw_.magnitude(1.0, 1e4) * draw_.direction();
    for (Vec3& at_m : mesh_.vertices_m) at_m = in_box(axes, to_m, at_m);
    middle_m_ = in_box(axes, to_m, middle_m_);
  }

  Draw& draw_;
  double length_m_ = 1.0, size_m_ = 1.0;
  Vec3 middle_m_{0.0};
  TriangleMesh mesh_;
};

}  // namespace dcem::test
