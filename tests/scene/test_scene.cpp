#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "dcem/geometry/surfaces/build_surface_mesh.hpp"
#include "dcem/scene/scene.hpp"

namespace test_scene {

using namespace dcem;

namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

TriangleMesh ground() {
  TriangleMesh mesh;
  add_quad(mesh, {Vec3(-50, -50, 0), Vec3(50, -50, 0), Vec3(50, 50, 0), Vec3(-50, 50, 0)}, "ground");
  return mesh;
}

WaypointMotion drive() {
  return {{{0.0, {Vec3(0, 0, 0), 0, 0, 0}}, {10.0, {Vec3(30, 10, 2), 2.0, 0.3, -0.2}}}};
}

Scene town() {
  Scene scene;
  scene.add_material({"ground", ConstantReflection{0.6, std::nullopt}});
  scene.add_material({"metal", PerfectConductor{}});
  scene.add_material({"glass", ConstantReflection{0.7, 5.0}});
  scene.set_scenery(ground());
  scene.add_object("car", make_box(Vec3(4, 2, 1.5), "metal"), drive());
  scene.add_object("kiosk", make_box(Vec3(2, 2, 3), "glass"), LinearMotion{{Vec3(-20, 5, 0), 0.7, 0, 0}, Vec3(0), 0});
  scene.add_object("bus", make_box(Vec3(12, 2.5, 3), "metal"),
                   LinearMotion{{Vec3(5, 30, 0), 0, 0, 0}, Vec3(-8, 0, 0), 0});
  return scene;
}

/// Everything of the world that may change with a frame, as bytes.
std::string bits(const Scene& scene) {
  std::string bytes;
  const auto add = [&](const void* data, std::size_t size) { bytes.append(static_cast<const char*>(data), size); };
  add(scene.vertices_m().data(), scene.vertices_m().size_bytes());
  for (const WorldFacet& facet : scene.facets()) {
    add(&facet.plane.point_m, sizeof(Vec3));
    add(&facet.plane.normal, sizeof(Vec3));
    bytes.push_back(facet.present ? 1 : 0);
    bytes.push_back(facet.transmits ? 1 : 0);
    const std::span<const Vec3> hull = scene.hull_m(facet);
    add(hull.data(), hull.size_bytes());
  }
  for (const Aabb<double>& box : scene.triangle_boxes()) add(&box, sizeof(box));
  return bytes;
}

std::string counts(const Scene& scene) {
  return std::to_string(scene.bodies().size()) + "/" + std::to_string(scene.materials().size()) + "/" +
         std::to_string(scene.transmitters().size()) + "/" + std::to_string(scene.receivers().size()) + "/" +
         std::to_string(scene.facets().size()) + "/" + std::to_string(scene.triangles().size()) + "/" +
         std::to_string(scene.first_triangles().size());
}

/// The call must throw std::invalid_argument, say `name`, and leave the scene as it was.
template <typename Call>
void check_refused(Scene& scene, const std::string& name, Call&& call) {
  const std::string bits_before = bits(scene), counts_before = counts(scene);
  try {
    call();
    FAIL("accepted: " << name);
  } catch (const std::invalid_argument& error) {
    CAPTURE(std::string(error.what()));
    CHECK(std::string(error.what()).find(name) != std::string::npos);
  }
  CHECK_UNARY(bits(scene) == bits_before);
  CHECK(counts(scene) == counts_before);
}

BodyId body(const Scene& scene, const std::string& id) {
  const auto found = scene.find_body(id);
  REQUIRE(found);
  return *found;
}

}  // namespace

TEST_CASE("bodies stand one after the other in the common arrays, body 0 first") {
  const Scene scene = town();
  CHECK(scene.bodies().size() == 4);
  CHECK(scene.facets().size() == 1 + 3 * 6);
  CHECK(scene.first_triangles() == std::vector<std::uint32_t>{0, 2, 14, 26});
  CHECK(scene.triangle_range(BodyId(2U)) == std::pair<std::uint32_t, std::uint32_t>(14, 26));
  CHECK(scene.body(BodyId(0U)).id.empty());
  CHECK(body(scene, "kiosk") == BodyId(2U));
  CHECK_FALSE(scene.find_body("tram"));
  CHECK_FALSE(scene.find_body(""));
  for (std::uint32_t triangle = 0; triangle < scene.triangles().size(); ++triangle) {
    const WorldFacet& facet = scene.facet(scene.facet_of_triangle(triangle));
    CHECK(triangle >= facet.first_triangle);
    CHECK(triangle < facet.first_triangle + facet.triangle_count);
    const auto [first, last] = scene.triangle_range(facet.body);
    CHECK(triangle >= first);
    CHECK(triangle < last);
    CHECK(scene.shell_of_triangle(triangle) == (facet.body == BodyId(0U) ? 0 : 1));
    for (const Vec3& corner : scene.corners_m(triangle)) {
      CHECK(std::abs(signed_distance_m(facet.plane, corner)) < 1e-13);  // coordinates of 50 m
    }
  }
  CHECK(scene.material(scene.facet(FacetId(7U)).material).name == "glass");
  CHECK(scene.facet(FacetId(7U)).transmits);
  CHECK_FALSE(scene.facet(FacetId(1U)).transmits);
}

TEST_CASE("a world vertex is position + Rz·Ry·Rx times the local one, and planes and hulls go along") {
  Scene scene = town();
  scene.apply(scene.frame_at(4.0));
  // The pose at 40 % of the way, and the matrix written out anew.
  const double yaw = 0.8, pitch = 0.12, roll = -0.08;
  const auto turned = [&](Vec3 p) {
    p = Vec3(p.x, std::cos(roll) * p.y - std::sin(roll) * p.z, std::sin(roll) * p.y + std::cos(roll) * p.z);
    p = Vec3(std::cos(pitch) * p.x + std::sin(pitch) * p.z, p.y, -std::sin(pitch) * p.x + std::cos(pitch) * p.z);
    return Vec3(std::cos(yaw) * p.x - std::sin(yaw) * p.y, std::sin(yaw) * p.x + std::cos(yaw) * p.y, p.z);
  };
  const Body& car = scene.body(body(scene, "car"));
  const WorldGeometry::First first = scene.world().first(body(scene, "car"));
  for (std::size_t index = 0; index < car.mesh.vertices_m.size(); ++index) {
    const Vec3 expected = Vec3(12, 4, 0.8) + turned(car.mesh.vertices_m[index]);
    CHECK(glm::distance(scene.vertices_m()[first.vertex + index], expected) < 1e-14);  // a few roundings of 12 m
  }
  for (std::size_t index = 0; index < car.mesh.facets.size(); ++index) {
    const WorldFacet& facet = scene.facets()[first.facet + index];
    const Facet& local = car.mesh.facets[index];
    CHECK(glm::distance(facet.plane.normal, turned(local.plane.normal)) < 1e-15);
    CHECK(glm::distance(facet.plane.point_m, Vec3(12, 4, 0.8) + turned(local.plane.point_m)) < 1e-14);
    const auto hull = scene.hull_m(facet);
    REQUIRE(hull.size() == 4);
    for (std::size_t corner = 0; corner < 4; ++corner) {
      const Vec3 expected = Vec3(12, 4, 0.8) + turned(car.mesh.hull_points_m[local.first_hull_point + corner]);
      CHECK(glm::distance(hull[corner], expected) < 1e-14);
    }
  }
}

TEST_CASE("the box of a triangle is the box of its corners") {
  Scene scene = town();
  scene.apply(scene.frame_at(4.0));
  for (std::uint32_t triangle = 0; triangle < scene.triangles().size(); ++triangle) {
    Aabb<double> box;
    for (const Vec3& corner : scene.corners_m(triangle)) box.extend(corner);
    CHECK(scene.triangle_boxes()[triangle] == box);
  }
}

TEST_CASE("the scenery keeps its coordinates to the last bit") {
  TriangleMesh mesh;
  add_quad(mesh, {Vec3(0.1, 0.2, 0.3), Vec3(1.1, 0.2, 0.3), Vec3(1.1, 1.2, 0.3), Vec3(0.1, 1.2, 0.3)}, "ground");
  Scene scene;
  scene.add_material({"ground", PerfectConductor{}});
  scene.set_scenery(mesh);
  const SurfaceMesh surface = build_surface_mesh(mesh);
  REQUIRE(scene.vertices_m().size() == 4);
  CHECK(std::equal(surface.vertices_m.begin(), surface.vertices_m.end(), scene.vertices_m().begin()));
}

TEST_CASE("only what moved is moved, and the change says so") {
  Scene scene = town();
  const std::string at_zero = bits(scene);
  CHECK(scene.apply(scene.frame_at(0.0)).moved.empty());  // bodies were placed at time 0
  CHECK_UNARY(bits(scene) == at_zero);

  const std::vector<Vec3> before(scene.vertices_m().begin(), scene.vertices_m().end());
  const BodyId car = body(scene, "car"), kiosk = body(scene, "kiosk"), bus = body(scene, "bus");
  CHECK(scene.apply(scene.frame_at(4.0)).moved == std::vector<BodyId>{car, bus});
  for (std::size_t index = 0; index < before.size(); ++index) {
    const bool of_car = index >= scene.world().first(car).vertex && index < scene.world().first(kiosk).vertex;
    const bool of_bus = index >= scene.world().first(bus).vertex;
    CHECK_UNARY((scene.vertices_m()[index] != before[index]) == (of_car || of_bus));
  }
  CHECK(scene.apply(scene.frame_at(4.0)).moved.empty());
  // Held at its end the car stands, the bus goes on.
  CHECK(scene.apply(scene.frame_at(11.0)).moved == std::vector<BodyId>{car, bus});
  CHECK(scene.apply(scene.frame_at(12.0)).moved == std::vector<BodyId>{bus});
}

TEST_CASE("a velocity alone moves nothing but is known") {
  Scene scene = town();
  Frame frame = scene.frame_at(0.0);
  frame.bodies[2].placement.velocity.linear_mps = Vec3(1, 2, 3);
  CHECK(scene.apply(frame).moved.empty());
  CHECK(scene.body_state(BodyId(2U)).placement.velocity.linear_mps == Vec3(1, 2, 3));
}

TEST_CASE("there and back gives identical bits, whatever lay between") {
  Scene scene = town();
  scene.apply(scene.frame_at(3.3));
  const std::string expected = bits(scene);
  for (const double time_s : {7.7, -2.0, 1e6, 3.299999, 0.0}) {
    scene.apply(scene.frame_at(time_s));
    CHECK_UNARY(bits(scene) != expected);
    scene.apply(scene.frame_at(3.3));
    CHECK_UNARY(bits(scene) == expected);
  }
  Scene fresh = town();
  fresh.apply(fresh.frame_at(3.3));
  CHECK_UNARY(bits(fresh) == expected);
}

TEST_CASE("an absent body has empty boxes and absent facets, and comes back as it was") {
  Scene scene = town();
  const std::string expected = bits(scene);
  const BodyId kiosk = body(scene, "kiosk");
  Frame frame = scene.frame_at(0.0);
  frame.bodies[kiosk.value].present = false;
  CHECK(scene.apply(frame).moved == std::vector<BodyId>{kiosk});
  CHECK(scene.apply(frame).moved.empty());
  for (std::uint32_t triangle = 0; triangle < scene.triangles().size(); ++triangle) {
    const WorldFacet& facet = scene.facet(scene.facet_of_triangle(triangle));
    CHECK(facet.present == (facet.body != kiosk));
    CHECK(scene.triangle_boxes()[triangle].empty() == (facet.body == kiosk));
  }
  frame.bodies[kiosk.value].present = true;
  CHECK(scene.apply(frame).moved == std::vector<BodyId>{kiosk});
  CHECK_UNARY(bits(scene) == expected);
}

TEST_CASE("a frame is for this scene: one state per body") {
  Scene scene = town();
  Frame frame = scene.frame_at(1.0);
  frame.bodies.pop_back();
  check_refused(scene, "frame", [&] { scene.apply(frame); });
  frame = scene.frame_at(1.0, 17);
  CHECK(frame.index == 17);
  CHECK(frame.time_s == 1.0);
  frame.bodies.emplace_back();
  check_refused(scene, "frame", [&] { scene.apply(frame); });
}

TEST_CASE("a frame with a pose that is no number is refused: no NaN reaches the world") {
  Scene scene = town();
  for (const double bad : {not_a_number, std::numeric_limits<double>::infinity()}) {
    Frame frame = scene.frame_at(1.0);
    frame.bodies[2].placement.pose.position_m.y = bad;
    check_refused(scene, "kiosk", [&] { scene.apply(frame); });
    frame = scene.frame_at(1.0);
    frame.bodies[3].placement.pose.yaw_rad = bad;
    check_refused(scene, "bus", [&] { scene.apply(frame); });
  }
}

TEST_CASE("a time that is no number is refused") {
  Scene scene = town();
  for (const double bad : {not_a_number, std::numeric_limits<double>::infinity()}) {
    check_refused(scene, "time", [&] { scene.frame_at(bad); });
  }
}

TEST_CASE("tolerances that are no lengths are refused") {
  for (const double bad : {not_a_number, -1e-4, std::numeric_limits<double>::infinity()}) {
    SurfaceSettings weld, planarity;
    weld.weld_tolerance_m = bad;
    planarity.planarity_tolerance_m = bad;
    CHECK_THROWS_AS(Scene{weld}, std::invalid_argument);
    CHECK_THROWS_AS(Scene{planarity}, std::invalid_argument);
  }
  CHECK_THROWS_AS((Scene{SurfaceSettings{0.0, 1e-3}}), std::invalid_argument);
  CHECK_NOTHROW(Scene{SurfaceSettings{1e-9, 1e-9}});
  CHECK_NOTHROW(Scene{SurfaceSettings{1.0, 1.0}});
}

TEST_CASE("a free device moves by its own motion") {
  Scene scene = town();
  Device walker = device_at("ue", Vec3(1, 2, 3));
  walker.motion = LinearMotion{{Vec3(1, 2, 3)}, Vec3(0, 1.5, 0), 0.0};
  scene.add_receiver(walker);
  const DeviceState state = scene.device_state(scene.receivers()[0], scene.frame_at(4.0));
  CHECK(state.position_m == Vec3(1, 8, 3));
  CHECK(state.velocity_mps == Vec3(0, 1.5, 0));
  CHECK_FALSE(state.ignored_body);
  CHECK(state.present);
}

TEST_CASE(
    "an attached device rides along, and its velocity is the finite difference of its position, turning included") {
  Scene scene = town();
  Device antenna = device_at("roof", Vec3(999));  // its own place does not count
  antenna.attachment = Attachment{"car", Vec3(1.8, -0.7, 1.6), false};
  scene.add_transmitter(antenna);
  const Device& device = scene.transmitters()[0];
  CHECK(scene.device_state(device, scene.frame_at(0.0)).position_m == Vec3(1.8, -0.7, 1.6));
  for (double time_s = 0.5; time_s < 10.0; time_s += 0.5) {
    constexpr double step_s = 1e-5;
    const DeviceState now = scene.device_state(device, scene.frame_at(time_s));
    const Vec3 difference = (scene.device_state(device, scene.frame_at(time_s + step_s)).position_m -
                             scene.device_state(device, scene.frame_at(time_s - step_s)).position_m) /
                            (2 * step_s);
    CHECK(glm::distance(now.velocity_mps, difference) < 2e-9);  // coordinates of 30 m rounded at 4e-15, over 2e-5 s
    CHECK(glm::distance(now.velocity_mps, Vec3(3, 1, 0.2)) > 0.05);  // the turning shows
    CHECK(now.ignored_body == body(scene, "car"));
    CHECK(now.present);
  }
  CHECK(scene.device_state(device, scene.frame_at(20.0)).velocity_mps == Vec3(0.0));
}

TEST_CASE("a device at rest on a body that turns on the spot moves on a circle") {
  Scene scene;
  scene.add_material({"metal", PerfectConductor{}});
  scene.add_object("mast", make_box(Vec3(1), "metal"),
                   WaypointMotion{{{0.0, {Vec3(10, 0, 0)}}, {2.0, {Vec3(10, 0, 0), 2.0}}}});
  Device device = device_at("lamp", Vec3(0));
  device.attachment = Attachment{"mast", Vec3(3, 0, 5), true};
  scene.add_receiver(device);
  const DeviceState state = scene.device_state(scene.receivers()[0], scene.frame_at(0.5));  // 1 rad/s, turned by 0.5
  CHECK(glm::distance(state.position_m, Vec3(10 + 3 * std::cos(0.5), 3 * std::sin(0.5), 5)) < 1e-14);
  CHECK(glm::distance(state.velocity_mps, Vec3(-3 * std::sin(0.5), 3 * std::cos(0.5), 0)) < 1e-14);
  CHECK_FALSE(state.ignored_body);  // it sees its own body
}

TEST_CASE("a device is absent with the object it rides on") {
  Scene scene = town();
  Device device = device_at("roof", Vec3(0));
  device.attachment = Attachment{"bus", Vec3(0, 0, 3.1), false};
  scene.add_receiver(device);
  Frame frame = scene.frame_at(0.0);
  CHECK(scene.device_state(scene.receivers()[0], frame).present);
  frame.bodies[body(scene, "bus").value].present = false;
  CHECK_FALSE(scene.device_state(scene.receivers()[0], frame).present);
}

TEST_CASE("a device that rides on nothing breaks an invariant when it is asked for") {
  Scene scene = town();
  Device device = device_at("roof", Vec3(0));
  device.attachment = Attachment{"tram", Vec3(0), false};
  CHECK_THROWS_AS(scene.device_state(device, scene.frame_at(0.0)), InvariantError);
}

TEST_CASE("what cannot be built is refused by name and changes nothing") {
  Scene scene = town();
  scene.add_transmitter(device_at("bs", Vec3(0, 0, 10)));
  scene.add_receiver(device_at("bs", Vec3(0, 0, 10)));  // the other list: allowed
  const TriangleMesh box = make_box(Vec3(1), "metal");

  check_refused(scene, "glass", [&] { scene.add_material({"glass", PerfectConductor{}}); });
  check_refused(scene, "mirror", [&] { scene.add_material({"mirror", ConstantReflection{1.5, std::nullopt}}); });
  check_refused(scene, "scenery", [&] { scene.set_scenery(ground()); });
  check_refused(scene, "car", [&] { scene.add_object("car", box, LinearMotion{}); });
  check_refused(scene, "''", [&] { scene.add_object("", box, LinearMotion{}); });
  check_refused(scene, "jelly", [&] { scene.add_object("pudding", make_box(Vec3(1), "jelly"), LinearMotion{}); });
  check_refused(scene, "waypoint", [&] { scene.add_object("van", box, WaypointMotion{}); });
  check_refused(scene, "finite", [&] { scene.add_object("van", box, LinearMotion{{}, Vec3(not_a_number), 0.0}); });
  TriangleMesh broken = box;
  broken.vertices_m[3].x = not_a_number;
  check_refused(scene, "vertex 3", [&] { scene.add_object("van", broken, LinearMotion{}); });
  broken = box;
  broken.triangles[5].vertices[0] = 1'000'000;
  check_refused(scene, "triangle 5", [&] { scene.add_object("van", broken, LinearMotion{}); });

  for (const bool transmits : {true, false}) {
    const auto add = [&](const Device& device) {
      transmits ? scene.add_transmitter(device) : scene.add_receiver(device);
    };
    check_refused(scene, "id", [&] { add(device_at("", Vec3(0))); });
    check_refused(scene, "'bs'", [&] { add(device_at("bs", Vec3(0))); });
    check_refused(scene, "finite", [&] { add(device_at("x", Vec3(0, not_a_number, 0))); });
    check_refused(scene, "power_dbm", [&] { add(device_at("x", Vec3(0), not_a_number)); });
    Device device = device_at("x", Vec3(0));
    device.antenna.gain_dbi = not_a_number;
    check_refused(scene, "gain", [&] { add(device); });
    device = device_at("x", Vec3(0));
    device.attachment = Attachment{"tram", Vec3(0), false};
    check_refused(scene, "'tram'", [&] { add(device); });
    device.attachment = Attachment{"car", Vec3(0, 0, not_a_number), false};
    check_refused(scene, "offset_m", [&] { add(device); });
    device.attachment->offset_m.z = 2.0;
    CHECK_NOTHROW(add(device));
  }
  // After all the refusals the scene still works.
  CHECK(scene.add_object("van", box, LinearMotion{}) == BodyId(4U));
}

TEST_CASE("an error of an object or a device names the object or the device") {
  Scene scene = town();
  TriangleMesh broken = make_box(Vec3(1), "metal");
  broken.vertices_m[3].x = not_a_number;
  check_refused(scene, "van", [&] { scene.add_object("van", broken, LinearMotion{}); });
  check_refused(scene, "van", [&] { scene.add_object("van", make_box(Vec3(1), "metal"), WaypointMotion{}); });
  check_refused(scene, "van", [&] { scene.add_object("van", make_box(Vec3(1), "jelly"), LinearMotion{}); });
  check_refused(scene, "probe", [&] { scene.add_receiver(device_at("probe", Vec3(not_a_number))); });
  Device device = device_at("probe", Vec3(0));
  device.antenna.gain_dbi = not_a_number;
  check_refused(scene, "probe", [&] { scene.add_receiver(device); });
}

TEST_CASE("the scenery comes before any object") {
  Scene scene;
  scene.add_material({"metal", PerfectConductor{}});
  scene.add_material({"ground", PerfectConductor{}});
  scene.add_object("box", make_box(Vec3(1), "metal"), LinearMotion{});
  check_refused(scene, "scenery", [&] { scene.set_scenery(ground()); });
  CHECK(scene.first_triangles() == std::vector<std::uint32_t>{0, 0});
}

TEST_CASE("a material that a mesh lists but does not use need not be defined") {
  Scene scene;
  scene.add_material({"metal", PerfectConductor{}});
  TriangleMesh mesh = make_box(Vec3(1), "metal");
  mesh.material_names.push_back("never used");
  CHECK_NOTHROW(scene.add_object("box", mesh, LinearMotion{}));
}

}  // namespace test_scene
