/// Where a receiver cannot stand: on a surface, or inside a solid body.
#include "dcem/paths/query/obstruction.hpp"

#include <doctest/doctest.h>

#include <vector>

#include "tests/paths/small_scenes.hpp"

namespace test_obstruction {

using namespace dcem;
using namespace dcem::test;

namespace {

using Points = std::vector<Vec3>;

bool obstructed(TracedScene<>& traced, const Points& transmitters_m, const Vec3& point_m) {
  return ObstructionTest<WideIndex>(traced.tracer, traced.index, transmitters_m).obstructed(point_m);
}

}  // namespace

TEST_CASE("inside a box is obstructed, outside, above and below it is not") {
  Scene scene = scene_of_materials();
  scene.add_object("car", make_box(Vec3(4, 2, 1.5), "metal"), LinearMotion{{Vec3(10, 5, 0), 0.7, 0, 0}, Vec3(0.0), 0});
  TracedScene<> traced(std::move(scene));
  const Mat3 turn = rotation_matrix({Vec3(0.0), 0.7, 0, 0});
  Draw draw(1);
  int inside = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const Vec3 local = draw.inside(Vec3(-3, -2, -1), Vec3(3, 2, 2.5));
    const bool expected = std::abs(local.x) < 2 && std::abs(local.y) < 1 && local.z > 0 && local.z < 1.5;
    CHECK(obstructed(traced, {Vec3(50, 0, 10)}, Vec3(10, 5, 0) + turn * local) == expected);
    inside += expected;
  }
  CHECK(inside > 400);
}

TEST_CASE("what stands without a floor is solid down to its foot, and not below") {
  TriangleMesh house = make_box(Vec3(4, 2, 1.5), "opaque");
  house.triangles.erase(house.triangles.begin(), house.triangles.begin() + 2);
  for (const double pitch_rad : {0.0, 0.3}) {  // the foot is where the body's own axes say
    Scene scene = scene_of_materials();
    const Pose pose{Vec3(10, 5, 20), 0.7, pitch_rad, 0};
    scene.add_object("house", house, LinearMotion{pose, Vec3(0.0), 0});
    TracedScene<> traced(std::move(scene));
    const auto at = [&](double height_m) { return pose.position_m + rotation_matrix(pose) * Vec3(0.3, 0.2, height_m); };
    CHECK(obstructed(traced, {}, at(0.75)));
    CHECK(obstructed(traced, {}, at(0.001)));
    CHECK_FALSE(obstructed(traced, {}, at(-0.001)));
    CHECK_FALSE(obstructed(traced, {}, at(-0.5)));
  }
}

TEST_CASE("on a surface is obstructed, on open sheets too; beside it is not") {
  TriangleMesh mesh;
  add_sheet_across_x(mesh, 0.0, 5.0, "glass");
  TracedScene<> traced(scene_of(mesh));
  CHECK(obstructed(traced, {}, Vec3(0, 1, 1)));
  CHECK(obstructed(traced, {}, Vec3(0.9e-4, 1, 1)));
  CHECK(obstructed(traced, {}, Vec3(0, 5, 5)));
  CHECK_FALSE(obstructed(traced, {}, Vec3(1.1e-4, 1, 1)));
  CHECK_FALSE(obstructed(traced, {}, Vec3(0, 5.1, 1)));
  CHECK_FALSE(obstructed(traced, {}, Vec3(-1, 1, 1)));
}

TEST_CASE("a closed shell that holds a transmitter is a room; shells in it are solid") {
  TriangleMesh mesh;
  add_box_faces(mesh, Vec3(0, 0, 0), Vec3(10, 8, 3), "opaque");
  add_box_faces(mesh, Vec3(20, 0, 0), Vec3(30, 8, 3), "opaque");       // the house next door
  add_box_faces(mesh, Vec3(4, 4, 0.5), Vec3(6, 6, 2.5), "metal");      // a cupboard in the room
  add_box_faces(mesh, Vec3(4.5, 4.5, 1), Vec3(5.5, 5.5, 2), "glass");  // a box in the cupboard
  TracedScene<> traced(scene_of(mesh));
  const Vec3 in_room(2, 2, 1.5), in_cupboard(4.2, 5.1, 1.4), in_box(5.1, 4.9, 1.3), outside(15, 4, 1),
      next_door(25, 4, 1);
  const Points nobody{outside}, room{in_room}, box{in_box};
  CHECK(obstructed(traced, nobody, in_room));
  CHECK(obstructed(traced, nobody, in_box));
  CHECK(obstructed(traced, nobody, next_door));
  CHECK_FALSE(obstructed(traced, nobody, outside));
  CHECK_FALSE(obstructed(traced, room, in_room));
  CHECK(obstructed(traced, room, in_cupboard));
  CHECK(obstructed(traced, room, in_box));
  CHECK(obstructed(traced, room, next_door));
  CHECK_FALSE(obstructed(traced, room, outside));
  CHECK_FALSE(obstructed(traced, box, in_box));
  CHECK_FALSE(obstructed(traced, box, in_cupboard));
  CHECK_FALSE(obstructed(traced, box, in_room));
  CHECK(obstructed(traced, box, next_door));
  CHECK_FALSE(obstructed(traced, {in_room, next_door}, next_door));
}

TEST_CASE("shells of two bodies, one inside the other, are told apart") {
  Scene scene = scene_of_materials();
  scene.add_object("garage", make_box(Vec3(8, 6, 3), "opaque"), {});
  scene.add_object("car", make_box(Vec3(4, 2, 1.5), "metal"), LinearMotion{{Vec3(0, 0, 0.1)}, Vec3(0.0), 0});
  TracedScene<> traced(std::move(scene));
  const auto count = [&](const Vec3& p) { return shells_around(traced.tracer, traced.index, p).size(); };
  CHECK(count(Vec3(0.1, 0.2, 0.7)) == 2);
  CHECK(count(Vec3(3.1, 2.2, 0.7)) == 1);
  CHECK(count(Vec3(9, 0, 0.7)) == 0);
  CHECK(count(Vec3(0.1, 0.2, -1)) == 0);
  Frame frame = traced.scene.frame_at(0.0);
  frame.bodies[1].present = false;
  traced.apply(frame);
  CHECK(count(Vec3(0.1, 0.2, 0.7)) == 1);
}

TEST_CASE("a transmitter mounted on the inside of a room makes it a room") {
  TriangleMesh mesh;
  add_box_faces(mesh, Vec3(0, 0, 0), Vec3(10, 8, 3), "opaque");
  TracedScene<> traced(scene_of(mesh));
  for (const Vec3& mounted_m : {Vec3(5, 4, 0), Vec3(5, 4, 3), Vec3(0, 4, 1), Vec3(10, 4, 1), Vec3(5, 0, 1),
                                Vec3(5, 8, 1), Vec3(5, 4, 2.99995)}) {
    CHECK_FALSE(obstructed(traced, {mounted_m}, Vec3(2, 2, 1.5)));
  }
}

TEST_CASE("so does one mounted where two or three of its faces meet") {
  TriangleMesh mesh;
  add_box_faces(mesh, Vec3(0, 0, 0), Vec3(10, 8, 3), "opaque");
  TracedScene<> traced(scene_of(mesh));
  for (const double x : {0.0, 4.0, 10.0}) {
    for (const double y : {0.0, 3.0, 8.0}) {
      for (const double z : {0.0, 1.0, 3.0}) CHECK_FALSE(obstructed(traced, {Vec3(x, y, z)}, Vec3(2, 2, 1.5)));
    }
  }
}

}  // namespace test_obstruction
