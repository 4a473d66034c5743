/// The path lists that NIST published with its Q-D realization software: four rooms and streets, traced by somebody
/// else's program. Sets of specular paths up to the second order must be the same, none missing and none extra.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include "dcem/dcem.hpp"
#include "dcem/em/surface/user_surface.hpp"
#include "dcem/io/obj_reader.hpp"
#include "tests/support/shared_data.hpp"

namespace test_nist_lists {

namespace {

using namespace dcem;

/// One row of paths.csv: the points of reflection, from the transmitter to the receiver, and the length.
struct ListedPath {
  double length_m = 0.0;
  std::vector<Vec3> points_m;
};

using LinkKey = std::tuple<int, int, int>;  // step, transmitter, receiver

std::vector<double> numbers(const std::string& line) {
  std::vector<double> values;
  std::istringstream fields(line);
  for (std::string field; std::getline(fields, field, ',');) values.push_back(std::stod(field));
  return values;
}

std::map<LinkKey, std::vector<ListedPath>> listed_paths(const std::string& folder) {
  std::map<LinkKey, std::vector<ListedPath>> lists;
  std::ifstream file(folder + "/paths.csv");
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    const std::vector<double> row = numbers(line);
    ListedPath path{row[4], {}};
    for (std::size_t first = 8; first + 3 < row.size(); first += 3) {
      path.points_m.emplace_back(row[first], row[first + 1], row[first + 2]);
    }
    std::reverse(path.points_m.begin(), path.points_m.end());  // rows of order 1 and more run from the receiver
    lists[{static_cast<int>(row[0]), static_cast<int>(row[1]), static_cast<int>(row[2])}].push_back(path);
  }
  return lists;
}

std::map<std::pair<int, int>, Vec3> node_positions(const std::string& folder) {
  std::map<std::pair<int, int>, Vec3> nodes;
  std::ifstream file(folder + "/nodes.csv");
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    const std::vector<double> row = numbers(line);
    nodes[{static_cast<int>(row[0]), static_cast<int>(row[1])}] = {row[2], row[3], row[4]};
  }
  return nodes;
}

/// Position of a node at a step; nodes that stand still are listed for step 0 alone.
Vec3 node_at(const std::map<std::pair<int, int>, Vec3>& nodes, int node, int step) {
  const auto found = nodes.find({node, step});
  return found != nodes.end() ? found->second : nodes.at({node, 0});
}

/// The reflection model of the lists: 15 dB and a phase of π at each bounce (also an example of the project).
class FixedLoss : public UserSurfaceModel {
 public:
  SurfaceResponse response(double, double) const override {
    const double amplitude = db_to_amplitude_ratio(-15.0);
    return {{-amplitude, -amplitude}, {0.0, 0.0}};
  }
};

Scene scene_of(const std::string& folder, const MaterialModel& walls = PerfectConductor{}) {
  Scene scene;
  scene.add_material({"default", walls});
  scene.set_scenery(io::read_obj(folder + "/scene.obj").mesh);
  return scene;
}

SimulationSettings second_order(double frequency_hz) {
  SimulationSettings settings;
  settings.frequency_hz = frequency_hz;
  settings.propagation.max_reflections = 2;
  settings.propagation.max_transmissions = 0;
  settings.propagation.max_diffractions = 0;  // the lists hold none
  settings.propagation.discovery = Discovery::exact;
  settings.threads = 1;
  return settings;
}

double largest_distance_m(const ListedPath& listed, const Path& path) {
  if (listed.points_m.size() != path.interactions.size()) return 1e9;
  double largest_m = 0.0;
  for (std::size_t index = 0; index < listed.points_m.size(); ++index) {
    largest_m = std::max(largest_m, glm::distance(listed.points_m[index], path.interactions[index].point_m));
  }
  return largest_m;
}

struct Comparison {
  std::size_t listed = 0, found = 0, missing = 0;
  double largest_error_m = 0.0;
};

/// Pairs each listed path with the nearest path of the engine that is not taken yet.
void compare(const std::vector<ListedPath>& listed, std::vector<PathContribution> paths, double tolerance_m,
             Comparison& result) {
  result.listed += listed.size();
  result.found += paths.size();
  for (const ListedPath& expected : listed) {
    const auto nearest =
        std::min_element(paths.begin(), paths.end(), [&](const PathContribution& a, const PathContribution& b) {
          return largest_distance_m(expected, a.path) < largest_distance_m(expected, b.path);
        });
    if (nearest == paths.end() || largest_distance_m(expected, nearest->path) > tolerance_m) {
      ++result.missing;
      continue;
    }
    result.largest_error_m = std::max(result.largest_error_m, largest_distance_m(expected, nearest->path));
    paths.erase(nearest);
  }
}

Comparison compare_scene(const std::string& name, double tolerance_m) {
  const std::string folder = dcem::test::shared_path("nist_qd/" + name);
  const auto nodes = node_positions(folder);
  const Scene scene = scene_of(folder);
  Comparison result;
  for (const auto& [key, listed] : listed_paths(folder)) {
    const auto [step, transmitter, receiver] = key;
    Scene at_step = scene;
    at_step.add_transmitter(device_at("tx", node_at(nodes, transmitter, step)));
    at_step.add_receiver(device_at("rx", node_at(nodes, receiver, step)));
    Simulator simulator(std::move(at_step), second_order(60e9));
    compare(listed, simulator.advance_to(0.0).links.at(0).paths, tolerance_m, result);
  }
  return result;
}

/// One ray of qdOutput.json.
struct ListedRay {
  double length_m, gain_db, phase_rad;
  Direction departure, arrival;
};

std::vector<ListedRay> listed_rays(const nlohmann::json& link, std::size_t step) {
  std::vector<ListedRay> rays;
  const auto value = [&](const char* key, std::size_t ray) { return link.at(key).at(step).at(ray).get<double>(); };
  for (std::size_t ray = 0; ray < link.at("Delay").at(step).size(); ++ray) {
    rays.push_back({value("Delay", ray) * 3e8,  // the source takes c = 3e8 m/s
                    value("Gain", ray),
                    value("Phase", ray),
                    {degrees_to_radians(value("AODAZ", ray)), degrees_to_radians(value("AODEL", ray))},
                    {degrees_to_radians(value("AOAAZ", ray)), degrees_to_radians(value("AOAEL", ray))}});
  }
  return rays;
}

Vec3 unit_vector(const Direction& direction) {
  const double sine = std::sin(direction.zenith_rad);
  return {sine * std::cos(direction.azimuth_rad), sine * std::sin(direction.azimuth_rad),
          std::cos(direction.zenith_rad)};
}

/// The angle between two directions: close to the vertical an azimuth alone says little.
double angle_error_rad(const Direction& a, const Direction& b) {
  return glm::distance(unit_vector(a), unit_vector(b));
}

/// The larger of the errors in length (metres) and in the two directions (radians).
double geometry_error(const ListedRay& ray, const PathContribution& path) {
  return std::max({std::abs(ray.length_m - path.path.length_m), angle_error_rad(ray.departure, path.departure),
                   angle_error_rad(ray.arrival, path.arrival)});
}

/// Distance of an angle from the nearest multiple of π: the sign of a field that was turned about its direction is a
/// matter of the basis, so a matrix tells the phase of the path up to half turns.
double half_turn_error_rad(double angle_rad) {
  return std::abs(std::remainder(angle_rad, pi));
}

}  // namespace

// Points of rooms with walls along the axes are listed to nine digits; the source rounds the planes of slanted walls to
// four decimals, which moves points by up to 0.2 mm in rooms and 15 mm over the 60 m of the canyon.
TEST_CASE("NIST lists: the same specular paths up to order 2, none missing and none extra") {
  DCEM_NEEDS_SHARED();
  const std::array<std::pair<const char*, double>, 4> scenes{
      {{"L-Room", 1e-6}, {"ConferenceRoom", 1e-6}, {"LivingRoom", 5e-4}, {"StreetCanyon", 20e-3}}};
  for (const auto& [name, tolerance_m] : scenes) {
    CAPTURE(name);
    const Comparison result = compare_scene(name, tolerance_m);
    MESSAGE(std::string(name) << ": " << result.listed << " paths listed, " << result.found
                              << " found, largest difference " << result.largest_error_m << " m");
    CHECK(result.listed > 0);
    CHECK(result.missing == 0);
    CHECK(result.found == result.listed);
  }
}

// The lists carry nine significant digits: 5e-9 relative of 60 m and of 360 degrees, and 5e-8 dB; bounds are rounded
// up.
TEST_CASE("NIST L-Room: lengths, angles and gains of 200 frames, with a reflection model of the user's own") {
  DCEM_NEEDS_SHARED();
  const std::string folder = dcem::test::shared_path("nist_qd/L-Room");
  const auto nodes = node_positions(folder);
  const Scene scene = scene_of(folder, user_surface(FixedLoss{}));
  std::ifstream file(folder + "/qdOutput.json");
  std::string line;
  std::getline(file, line);
  const nlohmann::json link = nlohmann::json::parse(line);
  const Antenna both{0.0, {PolarizationKind::dual}};
  SimulationSettings settings = second_order(60e9 * speed_of_light_mps / 3e8);  // the wavelength that the source used
  std::size_t rays = 0;
  double largest_error = 0.0, largest_gain_error_db = 0.0, largest_phase_error_rad = 0.0;
  for (int step = 0; step < 200; ++step) {
    Scene at_step = scene;
    at_step.add_transmitter(device_at("tx", node_at(nodes, 0, step), 0.0, both));
    at_step.add_receiver(device_at("rx", node_at(nodes, 1, step), 0.0, both));
    Simulator simulator(std::move(at_step), settings);
    std::vector<PathContribution> paths = simulator.advance_to(0.0).links.at(0).paths;
    const std::vector<ListedRay> listed = listed_rays(link, static_cast<std::size_t>(step));
    REQUIRE(paths.size() == listed.size());
    for (const ListedRay& ray : listed) {
      const auto nearest = std::min_element(paths.begin(), paths.end(), [&](const auto& a, const auto& b) {
        return geometry_error(ray, a) < geometry_error(ray, b);
      });
      largest_error = std::max(largest_error, geometry_error(ray, *nearest));
      largest_gain_error_db =
          std::max(largest_gain_error_db, std::abs(ray.gain_db - power_ratio_to_db(nearest->power_ratio)));
      CHECK(ray.phase_rad == doctest::Approx(pi * static_cast<double>(nearest->path.interactions.size())));
      // The transfer is a turn of the field times λ/(4πL)·(−10^(−15/20))^n·exp(−jkL); seen from the receiver one axis
      // is mirrored, so its determinant is minus the square of that factor.
      const Complex determinant =
          nearest->transfer(0, 0) * nearest->transfer(1, 1) - nearest->transfer(0, 1) * nearest->transfer(1, 0);
      const double expected_rad = -2.0 * pi * nearest->path.length_m / (3e8 / 60e9) + ray.phase_rad;
      largest_phase_error_rad =
          std::max(largest_phase_error_rad, half_turn_error_rad(0.5 * std::arg(-determinant) - expected_rad));
      paths.erase(nearest);
      ++rays;
    }
  }
  MESSAGE("L-Room: " << rays << " rays, largest error " << largest_error << " m or rad, " << largest_gain_error_db
                     << " dB, phase " << largest_phase_error_rad << " rad");
  CHECK(rays == 2455);
  CHECK(largest_error < 3e-6);
  CHECK(largest_gain_error_db < 1e-5);
  CHECK(largest_phase_error_rad < 1e-6);
}

}  // namespace test_nist_lists
