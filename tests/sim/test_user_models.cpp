/// Models of the caller's own beside the built-in ones: the same model gives the same links, whoever wrote it, and a
/// silent mistake is an error.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "dcem/em/surface/user_surface.hpp"
#include "dcem/sim/basic_simulator.hpp"
#include "dcem/sim/simulator.hpp"

namespace test_user_models {

using namespace dcem;

namespace {

/// ConstantReflection{0.8, 6 dB}, written by a user.
class OwnConstant : public UserSurfaceModel {
 public:
  explicit OwnConstant(double through) : through_(through) {}
  SurfaceResponse response(double, double) const override { return {{-0.8, 0.8}, {through_, through_}}; }

 private:
  double through_;
};

class OwnDipole : public UserPatternModel {
 public:
  JonesVector field(const Vec3& direction, std::size_t) const override {
    return {std::sqrt(power_gain(HalfWaveDipole{}, direction)), 0.0};
  }
  double peak_power_gain() const override { return half_wave_dipole_directivity; }
};

Scene room(const MaterialModel& sheet, const AntennaPattern& pattern) {
  Scene scene;
  scene.add_material({"wall", Dielectric{5.0, 0.05}});
  scene.add_material({"sheet", sheet});
  TriangleMesh mesh = make_box(Vec3(9, 6, 3), "wall");
  add_quad(mesh, {Vec3(1, -2, 0.2), Vec3(1, 2, 0.2), Vec3(1, 2, 2.8), Vec3(1, -2, 2.8)}, "sheet");
  scene.set_scenery(mesh);
  Antenna antenna;
  antenna.pattern = pattern;
  antenna.orientation.pitch_rad = 0.3;
  scene.add_transmitter(device_at("t", Vec3(-3, 1, 2.1), 20.0, antenna));
  scene.add_receiver(device_at("r", Vec3(3, -1, 1.2), 0.0, antenna));
  return scene;
}

SimulationSettings settings_for(int reflections) {
  SimulationSettings settings;
  settings.frequency_hz = 28e9;
  settings.propagation.max_reflections = reflections;
  settings.propagation.max_diffractions = 0;
  return settings;
}

std::vector<PathContribution> paths_in(Scene scene, const SimulationSettings& settings) {
  return std::move(Simulator(std::move(scene), settings).advance_to(0.0).links.at(0).paths);
}

template <typename Action>
std::string refusal(Action&& action) {
  try {
    action();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

bool says(const std::string& message, const std::string& part) {
  return message.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("a user's copy of a built-in surface, beside built-in ones, gives the same links to the last bit") {
  const double through = db_to_amplitude_ratio(-6.0);
  const auto built_in = paths_in(room(ConstantReflection{0.8, 6.0}, IsotropicPattern{}), settings_for(2));
  const auto own = paths_in(room(user_surface(OwnConstant(through), true), IsotropicPattern{}), settings_for(2));
  REQUIRE(built_in.size() > 10);
  REQUIRE(own.size() == built_in.size());
  bool crosses = false;
  for (std::size_t path = 0; path < own.size(); ++path) {
    CHECK(own[path].amplitude == built_in[path].amplitude);
    crosses = crosses || kinds(own[path].path).find('T') != std::string::npos;
  }
  CHECK(crosses);
}

TEST_CASE("an opaque surface of a user's blocks as a built-in one does, and scattering is applied to it") {
  Scene own = room(user_surface(OwnConstant(0.0)), IsotropicPattern{});
  Scene built_in = room(ConstantReflection{0.8, std::nullopt}, IsotropicPattern{});
  const auto one = paths_in(std::move(own), settings_for(1)), other = paths_in(std::move(built_in), settings_for(1));
  REQUIRE(one.size() == other.size());
  for (std::size_t path = 0; path < one.size(); ++path) CHECK(one[path].amplitude == other[path].amplitude);
  Material rough{"own", user_surface(OwnConstant(0.0))};
  rough.scattering.coefficient = 0.6;
  const MaterialTable table({rough}, 28e9);
  CHECK(std::abs(table.response(MaterialId(0), 0.5).reflection.te) == doctest::Approx(0.8 * 0.8).epsilon(1e-15));
  CHECK(std::abs(table.smooth_reflection(MaterialId(0), 0.5).te) == 0.8);
}

TEST_CASE("a user's half-wave dipole, turned, receives what the built-in one does") {
  const auto built_in = paths_in(room(ConstantReflection{0.8, 6.0}, HalfWaveDipole{}), settings_for(2));
  const auto own = paths_in(room(ConstantReflection{0.8, 6.0}, user_pattern(OwnDipole{})), settings_for(2));
  REQUIRE(own.size() == built_in.size());
  for (std::size_t path = 0; path < own.size(); ++path) {
    // The user's pattern gets a direction that was normalized once more: a few roundings.
    CHECK(std::abs(own[path].amplitude - built_in[path].amplitude) <= 1e-13 * std::abs(built_in[path].amplitude));
  }
}

TEST_CASE("a user's path loss acts on the whole length of a path") {
  SimulationSettings settings = settings_for(1);
  const auto free_space = paths_in(room(PerfectConductor{}, IsotropicPattern{}), settings);
  struct Halved {
    double excess_amplitude(double total_length_m) const { return total_length_m > 8.0 ? 0.5 : 1.0; }
  };
  settings.propagation.path_loss.model = UserPathLoss(Halved{});
  const auto own = paths_in(room(PerfectConductor{}, IsotropicPattern{}), settings);
  REQUIRE(own.size() == free_space.size());
  bool some = false, others = false;
  for (std::size_t path = 0; path < own.size(); ++path) {
    const double factor = own[path].path.length_m > 8.0 ? 0.5 : 1.0;
    (factor < 1.0 ? some : others) = true;
    CHECK(own[path].amplitude == factor * free_space[path].amplitude);
  }
  CHECK(some);
  CHECK(others);
}

TEST_CASE("silent mistakes with own models are errors that name the material") {
  const SimulationSettings settings = settings_for(1);
  const auto simulate = [&](const MaterialModel& sheet) {
    return refusal([&] { Simulator(room(sheet, IsotropicPattern{}), settings); });
  };
  CHECK(says(simulate(user_surface(OwnConstant(0.5))), "material 'sheet': its own model lets a wave through"));
  CHECK(says(simulate(user_surface(OwnConstant(std::numeric_limits<double>::quiet_NaN()), true)), "not finite"));
  CHECK(says(refusal([&] { room(UserSurface{}, IsotropicPattern{}); }), "its own model is missing"));
  CHECK(says(refusal([&] { room(PerfectConductor{}, UserPattern{}); }), "its own pattern has no model"));
}

TEST_CASE("a surface model for all materials must fit them, and must scatter where that is asked for") {
  struct Window {
    SurfaceResponse response(MaterialId, double) const { return {{-0.5, 0.5}, {0.7, 0.7}}; }
  };
  struct Mirror {
    SurfaceResponse response(MaterialId, double) const { return {{-0.5, 0.5}, {}}; }
  };
  const Scene scene = room(PerfectConductor{}, IsotropicPattern{});
  const SimulationSettings settings = settings_for(1);
  CHECK(says(refusal([&] { BasicSimulator<Window>(scene, settings, Window{}); }), "lets a wave through"));
  CHECK(refusal([&] { BasicSimulator<Mirror>(scene, settings, Mirror{}); }) == "");
  SimulationSettings diffuse = settings;
  diffuse.propagation.diffuse.enabled = true;
  CHECK(says(refusal([&] { BasicSimulator<Mirror>(scene, diffuse, Mirror{}); }), "does not scatter"));
}

}  // namespace test_user_models
