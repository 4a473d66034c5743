/// Diffuse power where what is scattered changes faster than distances do: narrow beams, fringes of slabs, hedges.
#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <utility>

#include "dcem/core/random.hpp"
#include "dcem/geometry/triangle_mesh.hpp"
#include "dcem/sim/simulator.hpp"
#include "tests/support/all_tests.hpp"
#include "tests/support/even_grid.hpp"

namespace test_diffuse_smoothness {

using namespace dcem;

namespace {

constexpr double frequency_hz = 30e9;

/// cos^n of the angle from +x, of the gain 2(n + 1), and nothing behind.
class Beam : public UserPatternModel {
 public:
  explicit Beam(double gain_dbi) : gain_(std::pow(10.0, 0.1 * gain_dbi)) {}
  JonesVector field(const Vec3& direction, std::size_t) const override {
    if (!(direction.x > 0.0)) return {0.0, 0.0};
    return {std::sqrt(gain_ * std::pow(direction.x, 0.5 * gain_ - 1.0)), 0.0};
  }
  double peak_power_gain() const override { return gain_; }

 private:
  double gain_;
};

struct Draw {
  RandomStream random;
  double between(double low, double high) { return low + (high - low) * random.uniform(); }
};

SimulationSettings settings_for(double tolerance_db) {
  SimulationSettings settings;
  settings.frequency_hz = frequency_hz;
  settings.threads = 1;
  settings.propagation.discovery = Discovery::exact;
  settings.propagation.max_reflections = settings.propagation.max_diffractions = 0;
  settings.propagation.max_transmissions = 2;
  settings.propagation.diffuse.enabled = true;
  settings.propagation.diffuse.tolerance_db = tolerance_db;
  return settings;
}

Scene scene_with_wall(const MaterialModel& model, double width_m, double height_m) {
  Scene scene;
  scene.add_material({"wall", model, 0.0, {0.5}});
  scene.add_material({"leaves", Foliage{0.8}});
  scene.add_material({"thick", Foliage{8.0}});
  TriangleMesh wall;
  add_quad(wall, {Vec3(0, 0, 0), Vec3(width_m, 0, 0), Vec3(width_m, 0, height_m), Vec3(0, 0, height_m)}, "wall");
  scene.set_scenery(wall);
  return scene;
}

DiffusePower power_between(Scene scene, Device from, Device to, double tolerance_db) {
  scene.add_transmitter(std::move(from));
  scene.add_receiver(std::move(to));
  Simulator simulator(std::move(scene), settings_for(tolerance_db));
  return std::move(simulator.advance_to(0.0).links.at(0).diffuse);
}

double db(double ratio) {
  return 10.0 * std::log10(ratio);
}

/// What a wall that nothing hides brings, on an even grid.
double free_power(const test::Illuminated& world, const RadioEnd& from, const RadioEnd& to, double cell_m) {
  double power = 0.0;
  Path path{{{InteractionKind::scattering, FacetId(0), Vec3(0.0)}}, 0.0};
  for (std::uint32_t triangle = 0; triangle < world.scene.triangles().size(); ++triangle) {
    test::for_each_cell(world.scene.corners_m(triangle), cell_m, [&](const Vec3& point_m, double area_m2) {
      path.interactions[0].point_m = point_m;
      path.length_m = glm::distance(from.position_m, point_m) + glm::distance(point_m, to.position_m);
      power += area_m2 * world.scattered.power_per_m2(path, from, to);
    });
  }
  return power;
}

}  // namespace

TEST_CASE("diffuse power: no beam is overlooked, however narrow, at either end") {
  Draw draw{RandomStream(7)};
  const double width_m = 40.0, height_m = 15.0;
  for (int trial = 0; trial < test::all_or(60, 10); ++trial) {
    CAPTURE(trial);
    Scene scene = scene_with_wall(ConstantReflection{0.8, {}}, width_m, height_m);
    const Vec3 from_m(draw.between(-5, 45), draw.between(3, 30), draw.between(1, 20));
    const Vec3 to_m(draw.between(-5, 45), draw.between(3, 30), draw.between(1, 20));
    const Vec3 spot_m(draw.between(1, width_m - 1), 0, draw.between(1, height_m - 1));
    const double gain_dbi = draw.between(6, 32);
    const bool at_transmitter = trial % 2 == 0;
    const Vec3 aim = glm::normalize(spot_m - (at_transmitter ? from_m : to_m));
    RadioEnd sender{from_m}, listener{to_m};
    Antenna beam;
    beam.pattern = user_pattern(Beam(gain_dbi));
    beam.orientation.yaw_rad = std::atan2(aim.y, aim.x);
    beam.orientation.pitch_rad = -std::asin(aim.z);
    RadioEnd& directed = at_transmitter ? sender : listener;
    directed.antenna = beam;
    directed.rotation = rotation_matrix(beam.orientation);
    REQUIRE(glm::distance(directed.rotation * Vec3(1, 0, 0), aim) < 1e-12);
    const test::Illuminated world(scene, frequency_hz);
    // A beam of 32 dBi is 5 degrees wide, 0.25 m at 3 m: cells of 0.04 m are a sixth of that and err by less than 1e-3.
    const double expected = free_power(world, sender, listener, 0.04);
    Device from = device_at("tx", from_m), to = device_at("rx", to_m);
    (at_transmitter ? from : to).antenna = beam;
    const DiffusePower power = power_between(scene, from, to, 0.1);
    CHECK(power.converged);
    CHECK(std::abs(db(power.power_ratio / expected)) < 0.1);
  }
}

TEST_CASE("diffuse power: fringes of thick slabs are summed to the tolerance") {
  Draw draw{RandomStream(11)};
  for (int trial = 0; trial < test::all_or(40, 12); ++trial) {
    CAPTURE(trial);
    const Dielectric slab{draw.between(2, 7), draw.between(0.0, 0.02), draw.between(0.01, 0.2)};
    const Scene scene = scene_with_wall(slab, 8, 5);
    const Vec3 from_m(draw.between(-3, 11), draw.between(1, 6), draw.between(0, 5));
    const Vec3 to_m(draw.between(-3, 11), draw.between(1, 6), draw.between(0, 5));
    const test::Illuminated world(scene, frequency_hz);
    // Of 0.2 m and √7 there are some hundred fringes in a right angle, 1.5 cm each at 1 m: two cells or more for each.
    const double expected = free_power(world, RadioEnd{from_m}, RadioEnd{to_m}, 0.0075);
    const DiffusePower power = power_between(scene, device_at("tx", from_m), device_at("rx", to_m), 0.1);
    CHECK(power.converged);
    CHECK(std::abs(db(power.power_ratio / expected)) < 0.05);  // the half that estimates are held to
  }
}

TEST_CASE("diffuse power: hedges between wall and ends are summed to the tolerance") {
  Draw draw{RandomStream(13)};
  std::size_t darkened = 0;
  for (int trial = 0; trial < test::all_or(40, 12); ++trial) {
    CAPTURE(trial);
    Scene bare = scene_with_wall(ConstantReflection{0.8, {}}, 30, 12);
    Scene scene = bare;
    for (int hedge = 0; hedge < 3; ++hedge) {
      const Vec3 size_m(draw.between(0.5, 6), draw.between(0.5, 2), draw.between(0.5, 4));
      const Pose pose{Vec3(draw.between(2, 28), draw.between(2, 6), draw.between(0, 3)), draw.between(-1, 1)};
      scene.add_object("hedge" + std::to_string(hedge), make_box(size_m, "leaves"), LinearMotion{pose});
    }
    scene.apply(scene.frame_at(0.0));
    const Vec3 from_m(draw.between(0, 30), draw.between(8, 14), draw.between(1, 6));
    const Vec3 to_m(draw.between(0, 30), draw.between(8, 20), draw.between(1, 6));
    const test::Illuminated world(scene, frequency_hz);
    const double expected = test::grid_power(world, from_m, to_m, 0.1, 0);
    const DiffusePower power = power_between(scene, device_at("tx", from_m), device_at("rx", to_m), 0.1);
    CHECK(power.converged);
    // The grid cuts the hedges' outlines, some 40 m of them, with cells of 0.1 m: half a cell of a fortieth of the
    // wall.
    CHECK(std::abs(db(power.power_ratio / expected)) < 0.1 + 0.01);
    const DiffusePower free = power_between(bare, device_at("tx", from_m), device_at("rx", to_m), 0.1);
    darkened += db(free.power_ratio / power.power_ratio) > 0.2;
  }
  CHECK(darkened > 3);
}

TEST_CASE("diffuse power: what comes through a gap between hedges is found, however dark they are") {
  Draw draw{RandomStream(17)};
  std::size_t converged = 0;
  for (int trial = 0; trial < test::all_or(30, 8); ++trial) {
    CAPTURE(trial);
    Scene scene = scene_with_wall(ConstantReflection{0.8, {}}, 14, 6);
    // Five metres of leaves, 40 dB, before all of the wall but a slit.
    const double gap_m = draw.between(0.3, 1.0), at_m = draw.between(3, 11);
    const Vec3 left_m(at_m + 40, 5, 30), right_m(50 - at_m, 5, 30);
    scene.add_object("left", make_box(left_m, "thick"), LinearMotion{{Vec3(at_m - 0.5 * (left_m.x + gap_m), 4, -9)}});
    scene.add_object("right", make_box(right_m, "thick"),
                     LinearMotion{{Vec3(at_m + 0.5 * (right_m.x + gap_m), 4, -9)}});
    scene.apply(scene.frame_at(0.0));
    const Vec3 from_m(at_m + draw.between(-1, 1), draw.between(8, 14), draw.between(1, 4));
    const Vec3 to_m(at_m + draw.between(-1, 1), draw.between(8, 20), draw.between(1, 4));
    const test::Illuminated world(scene, frequency_hz);
    const double expected = test::grid_power(world, from_m, to_m, 0.03, 0);
    const DiffusePower power = power_between(scene, device_at("tx", from_m), device_at("rx", to_m), 0.1);
    if (!power.converged) continue;  // and it says so
    ++converged;
    // Cells of 0.03 m cut a slit of 0.3 m to a twentieth at either side, by chance to either hand: a percent.
    CHECK(std::abs(db(power.power_ratio / expected)) < 0.1 + 0.05);
  }
  CHECK(converged > 4);
}

}  // namespace test_diffuse_smoothness
