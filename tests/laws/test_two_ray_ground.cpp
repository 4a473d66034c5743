/// Two antennas over flat ground, through files, the scenario file included, against the closed form.
#include <doctest/doctest.h>

#include <cmath>
#include <complex>
#include <fstream>
#include <iomanip>
#include <string>
#include <vector>

#include "dcem/io/scenario.hpp"
#include "tests/support/law_scenes.hpp"

namespace test_two_ray_ground {

using namespace dcem;
using namespace dcem::test;

namespace {

constexpr double light_mps = 299'792'458.0;
constexpr double transmitter_height_m = 9.7, receiver_height_m = 1.63;

/// Reflection at a flat ground in terms of the grazing angle ψ (ITU-R P.2040 with cos θ = sin ψ); η = 0 stands for a
/// perfect conductor.
std::complex<double> ground_coefficient(std::complex<double> eta, double grazing_rad, bool vertical) {
  if (eta == 0.0) return vertical ? 1.0 : -1.0;
  const double sine = std::sin(grazing_rad), cosine = std::cos(grazing_rad);
  std::complex<double> root = std::sqrt(eta - cosine * cosine);
  if (root.imag() > 0.0) root = -root;
  return vertical ? (eta * sine - root) / (eta * sine + root) : (sine - root) / (sine + root);
}

/// h = ±λ/(4πd₁)·e^{−jkd₁}·[1 + (d₁/d₂)·ρ·e^{−jkΔ}], Δ = d₂ − d₁ = 4·h_t·h_r/(d₁ + d₂), which loses no digits. With H
/// antennas φ̂ points the other way at the other end: the sign.
std::complex<double> two_ray(double distance_m, double frequency_hz, std::complex<double> eta, bool vertical) {
  const double k = 2.0 * 3.14159265358979323846 * frequency_hz / light_mps;
  const double direct_m = std::hypot(distance_m, transmitter_height_m - receiver_height_m);
  const double reflected_m = std::hypot(distance_m, transmitter_height_m + receiver_height_m);
  const double difference_m = 4.0 * transmitter_height_m * receiver_height_m / (direct_m + reflected_m);
  const double grazing_rad = std::atan2(transmitter_height_m + receiver_height_m, distance_m);
  const std::complex<double> rho = ground_coefficient(eta, grazing_rad, vertical);
  const std::complex<double> sum = 1.0 + direct_m / reflected_m * rho * std::polar(1.0, -k * difference_m);
  return (vertical ? 1.0 : -1.0) / (2.0 * k * direct_m) *
         std::polar(1.0, -std::fmod(k * direct_m, 2.0 * 3.14159265358979323846)) * sum;
}

/// Distances on a grid, and around every null of the perfectly reflecting ground in between: kΔ = nπ.
std::vector<double> distances_m(double frequency_hz) {
  std::vector<double> distances;
  for (double distance = 4.0; distance < 900.0; distance *= 1.17) distances.push_back(distance);
  const double wavelength_m = light_mps / frequency_hz;
  for (int half_waves = 1; half_waves <= 60; ++half_waves) {
    // The hyperbola d₂ − d₁ = Δ: a² = (Δ/2)², in closed form for the horizontal distance.
    const double delta = 0.5 * half_waves * wavelength_m;
    const double sum = 4.0 * transmitter_height_m * receiver_height_m / delta;  // d₁ + d₂
    const double direct = 0.5 * (sum - delta), dh = transmitter_height_m - receiver_height_m;
    if (direct <= dh) continue;
    const double distance = std::sqrt(direct * direct - dh * dh);
    if (distance < 4.0 || distance > 1000.0) continue;
    for (const double factor : {1.0, 1.001, 0.997}) distances.push_back(distance * factor);
  }
  return distances;
}

/// A scenario file with one transmitter and a receiver at each distance.
io::Scenario scenario(const TemporaryFolder& folder, const std::string& material, bool vertical, double frequency_hz,
                      const std::vector<double>& distances) {
  write_law_materials(folder / "laws.mtl");
  write_patches(folder / "ground.obj", {sheet(Vec3(300, -40, 0), Vec3(4000, 311, 0), Vec3(-173, 2225, 0), material)});
  std::ofstream json(folder / "two_ray.json");
  const std::string antenna_text = vertical ? R"("antenna": {"pattern": "isotropic", "polarization": "V"})"
                                            : R"("antenna": {"pattern": "isotropic", "polarization": "H"})";
  json << std::setprecision(17) << R"({"format": "dcem-scenario/1", "scene": {"obj": "ground.obj"}, "frequency_hz": )"
       << frequency_hz << R"(, "transmitters": [{"id": "tx", "position_m": [0, 0, )" << transmitter_height_m
       << R"(], "power_dbm": 0, )" << antenna_text << R"(}], "receivers": [{"id": "rx", "positions_m": [)";
  for (std::size_t index = 0; index < distances.size(); ++index) {
    json << (index > 0 ? "," : "") << "[" << distances[index] << ",0," << receiver_height_m << "]";
  }
  json << "], " << antenna_text << R"(}], "propagation": {"max_reflections": 2, "max_transmissions": 2, )"
       << R"("max_diffractions": 0, "discovery": "exact"}})";
  json.close();
  return io::load_scenario(folder / "two_ray.json");
}

void check_two_ray(const std::string& material, bool vertical, double frequency_hz, std::complex<double> eta) {
  CAPTURE(material);
  CAPTURE(vertical);
  const TemporaryFolder folder;
  const std::vector<double> distances = distances_m(frequency_hz);
  io::Scenario read = scenario(folder, material, vertical, frequency_hz, distances);
  Simulator simulator(std::move(read.scene), read.settings);
  const FrameResult frame = simulator.advance_to(0.0);
  REQUIRE(frame.links.size() == distances.size());
  double deepest_db = 0.0;
  for (std::size_t index = 0; index < distances.size(); ++index) {
    CAPTURE(distances[index]);
    const LinkResult& link = frame.links[index];
    REQUIRE(link.paths.size() == 2);
    const std::complex<double> found = link.paths[0].amplitude + link.paths[1].amplitude;
    const std::complex<double> expected = two_ray(distances[index], frequency_hz, eta, vertical);
    // 2e-8 of the direct field: k·d is up to 5e5 rad, so a rounding error of 1e-16 per length leaves 1e-10 rad; the
    // images add a few of these.
    const double direct = std::abs(link.paths[0].amplitude);
    CHECK(std::abs(found - expected) < 2e-8 * direct);
    // In dB the same error grows with the depth of the null: 2e-7 dB without a fade, 2e-5 dB in one of 40 dB.
    const double fade_db = 20.0 * std::log10(std::abs(expected) / direct);
    deepest_db = std::min(deepest_db, fade_db);
    const double tolerance_db = 20.0 * std::log10(1.0 + 2e-8 / std::pow(10.0, fade_db / 20.0)) + 1e-9;
    REQUIRE(link.statistics.power_dbm.has_value());
    CHECK(std::abs(*link.statistics.power_dbm - 20.0 * std::log10(std::abs(expected))) < tolerance_db);
  }
  // The points must pass through nulls: a test over smooth stretches alone would see no phase.
  CHECK(deepest_db < -12.0);
}

}  // namespace

TEST_CASE("two-ray ground: perfect conductor, V–V and H–H, through the nulls") {
  for (const bool vertical : {true, false}) {
    for (const double frequency_hz : {0.9e9, 28e9}) check_two_ray("pec", vertical, frequency_hz, 0.0);
  }
}

TEST_CASE("two-ray ground: ITU concrete, V–V and H–H, through the nulls") {
  for (const bool vertical : {true, false}) {
    for (const double frequency_ghz : {2.4, 28.0}) {
      // ITU-R P.2040-3, Table 3: concrete, ε' = 5.24, σ = 0.0462·f^0.7822 S/m; Im η = −σ/(ωε₀).
      const double sigma = 0.0462 * std::pow(frequency_ghz, 0.7822);
      const double omega_epsilon = 2.0 * 3.14159265358979323846 * frequency_ghz * 1e9 * 8.8541878128e-12;
      check_two_ray("itu_concrete", vertical, frequency_ghz * 1e9, {5.24, -sigma / omega_epsilon});
    }
  }
}

}  // namespace test_two_ray_ground
