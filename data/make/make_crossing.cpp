/// Writes crossing.obj and crossing.mtl: two streets 20 m wide between four corner blocks with flat roofs.
/// Small enough for the exact search. Usage: make_crossing FOLDER
#include <iostream>

#include "scene_writer.hpp"

namespace {

using example::Outline;
using example::Point;

constexpr const char* materials =
    R"(# Materials of crossing.obj. The wall is the paper's outdoor wall: reflection 0.8, nothing passes.
newmtl wall
Kd 0.80 0.74 0.64
em_model constant
em_reflection 0.8
# A half space of concrete (ITU-R P.2040): no thickness, so nothing passes.
newmtl ground
Kd 0.45 0.45 0.45
em_model itu
em_itu concrete
)";

/// Plan of a building in its block: x and y count from the centre of the crossing into the block.
struct Building {
  double height_m;
  std::vector<std::array<double, 2>> corners_m;  ///< counterclockwise
};

/// Walls and a flat roof over the plan; it stands on the ground, so there is no floor.
void add_building(example::SceneWriter& scene, const Building& building, double sign_x, double sign_y) {
  Outline foot, roof;
  for (const auto& [x, y] : building.corners_m) {
    foot.push_back({sign_x * x, sign_y * y, 0.0});
    roof.push_back({sign_x * x, sign_y * y, building.height_m});
  }
  if (sign_x * sign_y < 0.0) {  // mirrored once: turn the plan counterclockwise again
    std::reverse(foot.begin(), foot.end());
    std::reverse(roof.begin(), roof.end());
  }
  for (std::size_t i = 0; i < foot.size(); ++i) {
    const std::size_t next = (i + 1) % foot.size();
    scene.face("wall", {foot[i], foot[next], roof[next], roof[i]});
  }
  scene.face("wall", roof);
}

Building block(double height_m, double x0, double y0, double x1, double y1) {
  return {height_m, {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}};
}

void add_corner_block(example::SceneWriter& scene, const std::string& name, double sign_x, double sign_y,
                      const std::vector<Building>& buildings) {
  for (std::size_t i = 0; i < buildings.size(); ++i) {
    scene.object(name + "_" + std::to_string(i + 1));
    add_building(scene, buildings[i], sign_x, sign_y);
  }
}

void add_ground(example::SceneWriter& scene, double half_m) {
  scene.object("ground");
  scene.face("ground", {{-half_m, -half_m, 0}, {half_m, -half_m, 0}, {half_m, half_m, 0}, {-half_m, half_m, 0}});
}

/// The streets run along both axes; their fronts stand 10 m from the axis and more, each building a little differently.
void add_blocks(example::SceneWriter& scene) {
  add_corner_block(scene, "northeast", 1, 1,
                   {{15.2, {{10.6, 10.8}, {31, 10.8}, {31, 24.4}, {24.5, 24.4}, {24.5, 33}, {10.6, 33}}},
                    block(12.4, 33.2, 11.6, 52, 25.1),
                    block(9.8, 54.5, 10.4, 74.3, 23.3),
                    block(13.7, 11.9, 36, 25.3, 53.2),
                    block(10.9, 10.3, 55.6, 22.7, 75.1)});
  add_corner_block(scene, "northwest", -1, 1,
                   {{18.6, {{14.8, 10.5}, {29, 10.5}, {29, 27.7}, {10.9, 27.7}, {10.9, 14.4}}},  // corner cut off
                    block(14.1, 31.3, 12.2, 49.4, 24.9),
                    block(11.3, 52.6, 10.9, 73.8, 26.2),
                    block(8.7, 10.4, 30.5, 24.1, 48.9),
                    block(15.9, 12.7, 51.2, 26.4, 74.6)});
  add_corner_block(scene, "southwest", -1, -1,
                   {{13.3, {{10.7, 11.1}, {34, 11.1}, {34, 23.8}, {23.2, 23.8}, {23.2, 35.4}, {10.7, 35.4}}},
                    block(17.5, 36.4, 10.6, 55.7, 25.6),
                    block(12.8, 58.1, 12.9, 75.2, 24.4),
                    block(11.6, 11.5, 38.3, 24.8, 73.9)});
  add_corner_block(
      scene, "southeast", 1, -1,
      {block(21.4, 11.3, 10.9, 30.2, 28.6), block(10.2, 32.9, 13.4, 50.8, 26.7), block(14.6, 53.1, 11.2, 74.9, 25.5),
       block(12.1, 10.8, 31.2, 25.9, 50.3), block(16.3, 12.1, 52.8, 24.6, 74.2)});
}

}  // namespace

int main(int argument_count, char** arguments) {
  return example::run_maker(argument_count, arguments, [](const std::filesystem::path& folder) {
    example::SceneWriter scene(materials);
    add_ground(scene, 100.0);
    add_blocks(scene);
    scene.write(folder, "crossing", "A street crossing, made by examples/make_crossing.cpp");
    std::cout << scene.object_count() - 1 << " buildings, " << scene.triangle_count() << " triangles\n";
  });
}
