/// Writes an office of nine rooms along a corridor, 20 m x 12 m and 3 m high: office.obj with open doors and
/// office_doors_closed.obj with wooden leaves. Every wall is one sheet without thickness: a ray that passes it pays
/// the penetration loss once. Usage: make_office FOLDER
#include <iostream>

#include "scene_writer.hpp"

namespace {

using example::Outline;
using example::Point;

constexpr double length_m = 20.0, depth_m = 12.0, ceiling_m = 3.0, door_height_m = 2.1;

constexpr const char* materials =
    R"(# Materials of the office: the paper's indoor table. Walls are single sheets; the thickness
# of a sheet with constant coefficients is in the coefficients, so it stands in a comment only.
# Wall: 10 mm.
newmtl wall
Kd 0.85 0.82 0.76
em_model constant
em_reflection 0.7
em_penetration_loss_db 20
# Glass: 5 mm.
newmtl glass
Kd 0.60 0.78 0.88
em_model constant
em_reflection 0.74
em_penetration_loss_db 5
# Floor and ceiling: the reflection of the wall, and nothing passes.
newmtl floor
Kd 0.45 0.42 0.40
em_model constant
em_reflection 0.7
newmtl ceiling
Kd 0.92 0.92 0.92
em_model constant
em_reflection 0.7
)";

constexpr const char* door_material = R"(# Door leaves: wood of ITU-R P.2040, a slab of 40 mm.
newmtl itu_wood
Kd 0.55 0.38 0.22
em_model itu
em_itu wood
em_thickness_m 0.04
)";

/// A stretch of a wall, metres along it and metres up.
struct Opening {
  double from_m, to_m, bottom_m, top_m;
};

Opening door(double from_m, double width_m = 0.9) {
  return {from_m, from_m + width_m, 0.0, door_height_m};
}
Opening window(double from_m, double to_m, double bottom_m = 0.9, double top_m = 2.4) {
  return {from_m, to_m, bottom_m, top_m};
}

/// A wall from a start point along x or along y, with doors (from left to right) and panes.
struct Wall {
  std::string name;
  double x_m, y_m, length_m;
  bool along_x;
  std::vector<Opening> doors;
  std::vector<Opening> panes;
};

Point on_wall(const Wall& wall, double along_m, double up_m) {
  return {wall.x_m + (wall.along_x ? along_m : 0.0), wall.y_m + (wall.along_x ? 0.0 : along_m), up_m};
}

Outline rectangle(const Wall& wall, const Opening& opening) {
  return {on_wall(wall, opening.from_m, opening.bottom_m), on_wall(wall, opening.to_m, opening.bottom_m),
          on_wall(wall, opening.to_m, opening.top_m), on_wall(wall, opening.from_m, opening.top_m)};
}

/// The wall in one piece: doors are cut in from the floor, panes are holes filled with glass that shares their corners.
void add_wall(example::SceneWriter& scene, const Wall& wall, bool doors_closed) {
  scene.object(wall.name);
  Outline outline{on_wall(wall, 0.0, 0.0)};
  std::vector<Outline> holes;
  for (const Opening& cut : wall.doors) {
    outline.push_back(on_wall(wall, cut.from_m, 0.0));
    outline.push_back(on_wall(wall, cut.from_m, cut.top_m));
    outline.push_back(on_wall(wall, cut.to_m, cut.top_m));
    outline.push_back(on_wall(wall, cut.to_m, 0.0));
  }
  outline.push_back(on_wall(wall, wall.length_m, 0.0));
  outline.push_back(on_wall(wall, wall.length_m, ceiling_m));
  outline.push_back(on_wall(wall, 0.0, ceiling_m));
  for (const Opening& pane : wall.panes) holes.push_back(rectangle(wall, pane));
  scene.face("wall", outline, holes);
  for (const Outline& pane : holes) scene.face("glass", pane);
  if (!doors_closed) return;
  for (const Opening& leaf : wall.doors) scene.face("itu_wood", rectangle(wall, leaf));
}

/// South rooms lie between y = 0 and 5, the corridor between 5 and 7, north rooms between 7 and 12.
std::vector<Wall> walls() {
  const Opening corridor_end = window(5.5, 6.5, 0.9, 2.4);
  std::vector<Wall> list{
      {"facade_south",
       0,
       0,
       length_m,
       true,
       {},
       {window(0.8, 3.2), window(4.8, 7.2), window(8.7, 10.3), window(10.7, 12.3), window(13.7, 15.3),
        window(16.8, 19.2)}},
      {"facade_north",
       0,
       depth_m,
       length_m,
       true,
       {},
       {window(0.8, 2.3), window(2.7, 4.2), window(5.9, 8.6), window(10.4, 12.1), window(14, 16, 0.6),
        window(17, 19, 0.6)}},
      {"facade_west", 0, 0, depth_m, false, {door(5.4, 1.2)}, {window(1.5, 3.5), window(8.5, 10.5)}},
      {"facade_east", length_m, 0, depth_m, false, {}, {window(1.5, 3.5), corridor_end, window(8.2, 10.8)}},
      {"corridor_south",
       0,
       5,
       length_m,
       true,
       {door(1.2), door(6.4), door(9.1), door(14.1), door(17.2)},
       {window(10.6, 12.4, 0.9, 2.1)}},
      {"corridor_north",
       0,
       7,
       length_m,
       true,
       {door(2.1), door(7.3), door(11.3), door(14.2), door(18.6)},
       {window(15.6, 18.2, 0.3, 2.1)}}};
  for (const double x : {4.0, 8.0, 13.0, 16.0})
    list.push_back({"partition_south_" + std::to_string(static_cast<int>(x)), x, 0, 5, false, {}, {}});
  for (const double x : {5.0, 10.0, 13.0})
    list.push_back({"partition_north_" + std::to_string(static_cast<int>(x)), x, 7, 5, false, {}, {}});
  return list;
}

void add_slab(example::SceneWriter& scene, const std::string& name, double height_m) {
  scene.object(name);
  scene.face(name, {{0, 0, height_m}, {length_m, 0, height_m}, {length_m, depth_m, height_m}, {0, depth_m, height_m}});
}

void write_office(const std::filesystem::path& folder, const std::string& name, bool doors_closed) {
  example::SceneWriter scene(doors_closed ? std::string(materials) + door_material : materials);
  add_slab(scene, "floor", 0.0);
  add_slab(scene, "ceiling", ceiling_m);
  for (const Wall& wall : walls()) add_wall(scene, wall, doors_closed);
  scene.write(folder, name, "An office of nine rooms, walls as single sheets, made by examples/make_office.cpp");
  std::cout << name << ": " << scene.object_count() << " sheets, " << scene.triangle_count() << " triangles\n";
}

}  // namespace

int main(int argument_count, char** arguments) {
  return example::run_maker(argument_count, arguments, [](const std::filesystem::path& folder) {
    write_office(folder, "office", false);
    write_office(folder, "office_doors_closed", true);
  });
}
