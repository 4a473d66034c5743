#pragma once
/// Scenes for three interactions, and how many paths of each kind there are.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "tests/paths/halves/small_town.hpp"

namespace dcem::test {

/// So small that every sequence of three elements can be tried: a ground, houses beside a street, sheets, and a car.
inline Scene small_street(Draw& draw) {
  TriangleMesh mesh;
  if (draw.below(4) != 0) add_sheet(mesh, Vec3(0.0), Vec3(30, 0, 0), Vec3(0, 30, 0), "opaque");
  for (const double side : {-1.0, 1.0}) {
    const double near_m = side * draw.between(3, 5), far_m = side * draw.between(6, 9), low_m = draw.between(-8, 0);
    add_box_faces(mesh, Vec3(low_m, std::min(near_m, far_m), draw.below(2) == 0 ? 0.0 : 0.01),
                  Vec3(low_m + draw.between(4, 12), std::max(near_m, far_m), draw.between(2, 8)), "metal");
  }
  const std::size_t sheets = draw.below(3);
  for (std::size_t sheet = 0; sheet < sheets; ++sheet) {
    const double turn = draw.between(-pi, pi);
    add_sheet(mesh, draw.inside(Vec3(-8, -8, 2), Vec3(8, 8, 4)),
              draw.between(1, 6) * Vec3(std::cos(turn), std::sin(turn), 0), Vec3(0, 0, 2),
              draw.below(2) == 0 ? "glass" : "wall");
  }
  Scene scene = scene_of(mesh);
  TriangleMesh car;
  add_box_faces(car, Vec3(-2, -0.9, 0), Vec3(2, 0.9, 1.5), "metal");
  scene.add_object("one", car,
                   LinearMotion{{draw.inside(Vec3(-8, -3, 0.02), Vec3(8, 3, 0.05)), draw.between(-pi, pi), 0, 0}});
  return scene;
}

/// How many paths there are of each kind, from the receiver: three mirrors, an edge last, in the middle, first.
struct Kinds {
  std::array<std::size_t, 4> count{};

  void add(const std::vector<Path>& paths) {
    for (const Path& path : paths) {
      std::vector<InteractionKind> kinds;
      for (const Interaction& interaction : path.interactions) {
        if (interaction.kind != InteractionKind::transmission) kinds.push_back(interaction.kind);
      }
      if (kinds.size() != 3) continue;
      const auto edge = std::ranges::find(kinds, InteractionKind::diffraction);
      ++count[edge == kinds.end() ? 0 : static_cast<std::size_t>(edge - kinds.begin()) + 1];
    }
  }
  std::size_t least() const { return *std::ranges::min_element(count); }
};

}  // namespace dcem::test
