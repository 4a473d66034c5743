/// Power that rough surfaces scatter, through the simulator, against solid angles in closed form and against the
/// formula of the effective-roughness model as this file writes and integrates it.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dcem/channel/power_delay_profile.hpp"
#include "dcem/core/random.hpp"
#include "dcem/field/diffuse/adaptive_tiles.hpp"
#include "dcem/field/diffuse/scattered_power.hpp"
#include "dcem/sim/simulator.hpp"
#include "tests/support/all_tests.hpp"
#include "tests/support/even_grid.hpp"
#include "tests/support/quadrature.hpp"

namespace test_diffuse_power {

using namespace dcem;
using dcem::test::gauss_nodes, dcem::test::grid_power, dcem::test::Illuminated, dcem::test::QuadratureNode;

namespace {

constexpr double frequency_hz = 30e9;
constexpr double light_mps = 299'792'458.0;
constexpr double wavelength = light_mps / frequency_hz;
constexpr double circle = 2.0 * 3.14159265358979323846;

// A world of a few patches -------------------------------------------------------------------------------------------

/// A rectangle or parallelogram: a corner and two edges.
struct Patch {
  Vec3 corner_m, u_m, v_m;
  std::string material;
};

TriangleMesh mesh_of(const std::vector<Patch>& patches) {
  TriangleMesh mesh;
  for (const Patch& p : patches) {
    add_quad(mesh, {p.corner_m, p.corner_m + p.u_m, p.corner_m + p.u_m + p.v_m, p.corner_m + p.v_m}, p.material);
  }
  return mesh;
}

Scene scene_of(const std::vector<Patch>& patches, const std::vector<Material>& materials) {
  Scene scene;
  for (const Material& material : materials) scene.add_material(material);
  scene.set_scenery(mesh_of(patches));
  return scene;
}

Material rough(const std::string& name, MaterialModel model, double s,
               ScatteringPattern pattern = ScatteringPattern::lambertian, int lobe = 4, int back_lobe = 4,
               double share = 0.5) {
  return {name, std::move(model), 0.0, {s, pattern, lobe, back_lobe, share}};
}

SimulationSettings settings_for(double tolerance_db, std::size_t budget = 1'000'000, int reflections = 0) {
  SimulationSettings settings;
  settings.frequency_hz = frequency_hz;
  settings.threads = 1;
  settings.propagation.discovery = Discovery::exact;
  settings.propagation.max_reflections = reflections;
  settings.propagation.max_diffractions = 0;
  settings.propagation.diffuse.enabled = true;
  settings.propagation.diffuse.tolerance_db = tolerance_db;
  settings.propagation.diffuse.tile_budget = budget;
  return settings;
}

LinkResult link(Scene scene, Device from, Device to, const SimulationSettings& settings) {
  scene.add_transmitter(std::move(from));
  scene.add_receiver(std::move(to));
  Simulator simulator(std::move(scene), settings);
  return std::move(simulator.advance_to(0.0).links.at(0));
}

LinkResult link(const Scene& scene, const Vec3& from_m, const Vec3& to_m, const SimulationSettings& settings) {
  return link(scene, device_at("tx", from_m), device_at("rx", to_m), settings);
}

double db(double ratio) {
  return 10.0 * std::log10(ratio);
}

/// A number to a relative error, however small it is: doctest's own measure adds 1 to it.
doctest::Approx relative(double expected, double error) {
  return doctest::Approx(expected).epsilon(error).scale(0.0);
}

// The model as the specification writes it ----------------------------------------------------------------------------

double lobe(int order, double cosine) {
  return std::pow(0.5 * (1.0 + cosine), order);
}

/// ∫ lobe dΩ over the half space by quadrature, exact for a polynomial of this degree.
double lobe_integral(int order, double cos_axis) {
  static std::map<int, std::vector<QuadratureNode>> rules;
  std::vector<QuadratureNode>& nodes = rules[order];
  if (nodes.empty()) nodes = gauss_nodes(order / 2 + 2);
  const double sin_axis = std::sqrt(1.0 - cos_axis * cos_axis);
  double sum = 0.0;
  for (const QuadratureNode& node : nodes) {
    for (int step = 0; step < order + 2; ++step) {
      const double across = std::sqrt(1.0 - node.at * node.at) * std::cos(circle * step / (order + 2));
      sum += node.weight * lobe(order, cos_axis * node.at + sin_axis * across) * circle / (order + 2);
    }
  }
  return sum;
}

double pattern_per_sr(const Scattering& s, double cos_i, double cos_s, double cos_mirrored, double cos_back) {
  if (s.pattern == ScatteringPattern::lambertian) return cos_s / (0.5 * circle);
  const double forward = s.pattern == ScatteringPattern::directive ? 1.0 : s.forward_share;
  const double top = forward * lobe(s.lobe, cos_mirrored) + (1.0 - forward) * lobe(s.back_lobe, cos_back);
  return top / (forward * lobe_integral(s.lobe, cos_i) + (1.0 - forward) * lobe_integral(s.back_lobe, cos_i));
}

using Jones = std::array<Complex, 2>;

/// |R|² of TE and TM. Slab: ITU-R P.2040, section 2.2.2.2.
std::array<double, 2> reflected_shares(const MaterialModel& model, double cosine) {
  if (const auto* constant = std::get_if<ConstantReflection>(&model)) {
    const double share = constant->reflection_amplitude * constant->reflection_amplitude;
    return {share, share};
  }
  if (std::holds_alternative<PerfectConductor>(model)) return {1.0, 1.0};
  const auto& medium = std::get<Dielectric>(model);
  const double omega_epsilon = circle * frequency_hz * 8.8541878128e-12;
  const Complex eta(medium.relative_permittivity, -medium.conductivity_s_per_m / omega_epsilon);
  const Complex q = std::sqrt(eta - (1.0 - cosine * cosine));
  std::array<Complex, 2> r{(cosine - q) / (cosine + q), (eta * cosine - q) / (eta * cosine + q)};
  if (medium.thickness_m) {
    const Complex round = std::exp(Complex(0.0, -2.0) * (circle / wavelength * *medium.thickness_m * q));
    for (Complex& one : r) one = one * (1.0 - round) / (1.0 - one * one * round);
  }
  return {std::norm(r[0]), std::norm(r[1])};
}

/// The share of a unit field with this Jones vector that a surface reflects.
double reflected_share(const Vec3& k, const Vec3& normal, const Jones& jones, const MaterialModel& model) {
  const double zenith = std::acos(k.z), azimuth = std::atan2(k.y, k.x);
  const Vec3 theta(std::cos(zenith) * std::cos(azimuth), std::cos(zenith) * std::sin(azimuth), -std::sin(zenith));
  const Vec3 phi(-std::sin(azimuth), std::cos(azimuth), 0.0);
  const Vec3 across = glm::normalize(glm::cross(k, normal));
  const double te = std::norm(jones[0] * glm::dot(theta, across) + jones[1] * glm::dot(phi, across));
  const std::array<double, 2> shares = reflected_shares(model, std::abs(glm::dot(k, normal)));
  return shares[0] * te + shares[1] * (1.0 - te);
}

struct Setup {
  Patch wall;
  Material material;
  Vec3 from_m, to_m;
  Jones jones{1.0, 0.0};
};

/// P_rx/P_tx per m² of the wall, free of obstacles.
double power_per_m2(const Setup& setup, const Vec3& point_m) {
  const Vec3 normal = glm::normalize(glm::cross(setup.wall.u_m, setup.wall.v_m));
  const Vec3 in_m = point_m - setup.from_m, out_m = setup.to_m - point_m;
  const double r_in = glm::length(in_m), r_out = glm::length(out_m);
  const Vec3 k_in = in_m / r_in, k_out = out_m / r_out, mirrored = k_in - 2.0 * glm::dot(k_in, normal) * normal;
  const double cos_i = std::abs(glm::dot(k_in, normal)), cos_s = std::abs(glm::dot(k_out, normal));
  const double density =
      pattern_per_sr(setup.material.scattering, cos_i, cos_s, glm::dot(mirrored, k_out), -glm::dot(k_in, k_out));
  const double s = setup.material.scattering.coefficient;
  return std::pow(wavelength / (2.0 * circle), 2) * s * s *
         reflected_share(k_in, normal, setup.jones, setup.material.model) * cos_i * density /
         (r_in * r_in * r_out * r_out);
}

/// The same over the whole wall: Gauss' rule on 10 × 10 parts of it.
double wall_power(const Setup& setup, int parts = 10) {
  static const std::vector<QuadratureNode> nodes = gauss_nodes(8);
  double sum = 0.0;
  for (int i = 0; i < parts; ++i) {
    for (int j = 0; j < parts; ++j) {
      for (const QuadratureNode& u : nodes) {
        for (const QuadratureNode& v : nodes) {
          const Vec3 point_m =
              setup.wall.corner_m + (i + u.at) / parts * setup.wall.u_m + (j + v.at) / parts * setup.wall.v_m;
          sum += u.weight * v.weight * power_per_m2(setup, point_m);
        }
      }
    }
  }
  return sum / (parts * parts) * glm::length(glm::cross(setup.wall.u_m, setup.wall.v_m));
}

Scene scene_of(const Setup& setup) {
  return scene_of({setup.wall}, {setup.material});
}

/// Solid angle of the rectangle 0…a, 0…b from a height over its corner; odd in a and b.
double corner_solid_angle(double a, double b, double height) {
  return std::atan(a * b / (height * std::sqrt(a * a + b * b + height * height)));
}

Vec3 direction(double cos_zenith, double azimuth) {
  const double sine = std::sqrt(1.0 - cos_zenith * cos_zenith);
  return {sine * std::cos(azimuth), sine * std::sin(azimuth), cos_zenith};
}

struct NamedPattern {
  ScatteringPattern pattern;
  int lobe, back_lobe;
  double share;
};

constexpr std::array<NamedPattern, 4> patterns{{{ScatteringPattern::lambertian, 4, 4, 0.5},
                                                {ScatteringPattern::directive, 5, 1, 0.5},
                                                {ScatteringPattern::backscattering, 4, 3, 0.6},
                                                {ScatteringPattern::backscattering, 2, 7, 0.2}}};

Material rough(const std::string& name, MaterialModel model, double s, const NamedPattern& p) {
  return rough(name, std::move(model), s, p.pattern, p.lobe, p.back_lobe, p.share);
}

const Dielectric lossy_slab{5.1, 0.2, 0.02};
const Dielectric half_space{4.4, 0.5, {}};

struct NamedPolarization {
  Polarization polarization;
  Jones jones;
};

const std::array<NamedPolarization, 5> polarizations{{
    {{PolarizationKind::vertical}, {1.0, 0.0}},
    {{PolarizationKind::horizontal}, {0.0, 1.0}},
    {{PolarizationKind::slant, 0.6}, {std::cos(0.6), std::sin(0.6)}},
    {{PolarizationKind::right_circular}, {std::sqrt(0.5), Complex(0.0, -std::sqrt(0.5))}},
    {{PolarizationKind::left_circular}, {std::sqrt(0.5), Complex(0.0, std::sqrt(0.5))}},
}};

/// An oblique wall and three pairs of ends before it: side by side, far apart, one close.
std::vector<Setup> setups(const Material& material) {
  const Patch wall{Vec3(2, 5, -1), Vec3(6, 1, 0.5), Vec3(-0.4, 0.3, 4), material.name};
  return {{wall, material, Vec3(1, -3, 0.5), Vec3(4, -6, 2)},
          {wall, material, Vec3(-9, 0, 3), Vec3(17, 2, -1)},
          {wall, material, Vec3(4.1, 4.0, 1.2), Vec3(9, -8, 6)}};
}

Device device(const std::string& id, const Vec3& position_m, const Polarization& polarization) {
  return device_at(id, position_m, 0.0, {0.0, polarization});
}

/// The piece of a triangle that a place names.
Tile piece_at(const Scene& scene, std::uint32_t triangle, std::uint64_t place) {
  Tile piece{scene.corners_m(triangle), triangle};
  for (int bit = static_cast<int>(std::bit_width(place)) - 2; bit >= 0; --bit)
    piece = piece.halves()[place >> bit & 1U];
  return piece;
}

double wall_area_m2(const Patch& wall) {
  return glm::length(glm::cross(wall.u_m, wall.v_m));
}

}  // namespace

// All directions together ---------------------------------------------------------------------------------------------

TEST_CASE("diffuse power: what one wall scatters in all directions is (S·Γ)²·Ω/4π, by every pattern") {
  // The wall 0…2 by 0…1.4 in z = 0; the transmitter above it at (0.5, 0.3, 1.2).
  const Vec3 from_m(0.5, 0.3, 1.2);
  const auto corner = [](double x, double y) { return corner_solid_angle(x, y, 1.2); };
  const double omega = corner(1.5, 1.1) - corner(-0.5, 1.1) - corner(1.5, -0.3) + corner(-0.5, -0.3);
  for (const NamedPattern& pattern : patterns) {
    CAPTURE(pattern.lobe);
    Scene scene = scene_of({{Vec3(0), Vec3(2, 0, 0), Vec3(0, 1.4, 0), "wall"}},
                           {rough("wall", ConstantReflection{0.7, {}}, 0.4, pattern)});
    scene.add_transmitter(device_at("tx", from_m));
    // Receivers on a sphere of 1000 km, where all of the wall is seen in one direction: ten azimuths and five Gauss
    // nodes integrate a lobe of order 7 exactly. From a millionth of that distance directions differ by 1e-6.
    const std::vector<QuadratureNode> nodes = gauss_nodes(5);
    std::vector<Device> receivers;
    std::vector<double> weights_sr;
    for (const QuadratureNode& node : nodes) {
      for (int step = 0; step < 10; ++step) {
        const Vec3 to_m = Vec3(1, 0.7, 0) + 1e6 * direction(node.at, circle * step / 10);
        receivers.push_back(device_at("rx" + std::to_string(receivers.size()), to_m));
        weights_sr.push_back(node.weight * circle / 10);
      }
    }
    Simulator simulator(std::move(scene), settings_for(0.02));
    simulator.move_to(simulator.scene().frame_at(0.0));
    double sum = 0.0;
    for (const LinkResult& one : simulator.solve(receivers)) {
      CHECK(one.diffuse.converged);
      // An isotropic antenna receives λ²/4π of the power density.
      sum += weights_sr[one.receiver] * one.diffuse.power_ratio * 2.0 * circle / (wavelength * wavelength) * 1e12;
    }
    // 0.02 dB is the tolerance of each link.
    CHECK(std::abs(db(sum / (0.16 * 0.49 * omega / (2.0 * circle)))) < 0.02);
  }
}

TEST_CASE("diffuse power: of a perfect conductor with S = 1 all that falls on it is scattered and no mirror is left") {
  Scene scene =
      scene_of({{Vec3(-1, -1, 0), Vec3(2, 0, 0), Vec3(0, 2, 0), "wall"}}, {rough("wall", PerfectConductor{}, 1.0)});
  const SimulationSettings settings = settings_for(0.02, 1'000'000, 1);
  const LinkResult result = link(scene, Vec3(0.1, 0.2, 1), Vec3(0, 0, 1e6), settings);
  // Straight above the density of a Lambertian surface is 1/π everywhere: P·4π/λ²·R² = Ω/4π/π.
  const double omega = [] {
    const auto corner = [](double x, double y) { return corner_solid_angle(x, y, 1.0); };
    return corner(0.9, 0.8) - corner(-1.1, 0.8) - corner(0.9, -1.2) + corner(-1.1, -1.2);
  }();
  const double scattered_per_sr = result.diffuse.power_ratio * 2.0 * circle / (wavelength * wavelength) * 1e12;
  CHECK(std::abs(db(scattered_per_sr / (omega / (2.0 * circle) / (0.5 * circle)))) < 0.02);
  for (const PathContribution& path : result.paths) {
    if (kinds(path.path) == "R") CHECK(path.power_ratio == 0.0);
  }
  CHECK_FALSE(result.statistics.power_reflected_dbm);
}

// One wall, one pair of ends ------------------------------------------------------------------------------------------

TEST_CASE("diffuse power: every tile brings what the formula says, for all patterns, materials and polarizations") {
  std::size_t compared = 0;
  for (const NamedPattern& pattern : patterns) {
    for (const MaterialModel& model :
         {MaterialModel(ConstantReflection{0.8, 5.0}), MaterialModel(lossy_slab), MaterialModel(half_space)}) {
      for (const NamedPolarization& sent : polarizations) {
        for (Setup& setup : setups(rough("wall", model, 0.55, pattern))) {
          setup.jones = sent.jones;
          Scene scene = scene_of(setup);
          SimulationSettings settings = settings_for(0.1);
          settings.propagation.diffuse.list_paths = true;
          const LinkResult result = link(scene, device("tx", setup.from_m, sent.polarization),
                                         device("rx", setup.to_m, {PolarizationKind::horizontal}), settings);
          double sum = 0.0, area_m2 = 0.0;
          for (const DiffuseContribution& tile : result.diffuse.tiles) {
            REQUIRE(kinds(tile.path) == "S");
            const Vec3& point_m = tile.path.interactions[0].point_m;
            const double expected = power_per_m2(setup, point_m) * tile.area_m2;
            // 1e-10: rounding of cosines near 1, of which the square roots of the Fresnel formulas lose half the
            // digits.
            CHECK(tile.sample.power_ratio == relative(expected, 1e-10));
            const double length_m = glm::distance(setup.from_m, point_m) + glm::distance(point_m, setup.to_m);
            CHECK(tile.sample.delay_s == relative(length_m / light_mps, 1e-14));
            sum += tile.sample.power_ratio;
            area_m2 += tile.area_m2;
            CHECK(distance_to_triangle_m(piece_at(scene, tile.triangle, tile.place).corners_m, point_m) < 1e-9);
            ++compared;
          }
          CHECK(sum == relative(result.diffuse.power_ratio, 1e-13));
          CHECK(area_m2 == doctest::Approx(wall_area_m2(setup.wall)).epsilon(1e-12));
        }
      }
    }
  }
  CHECK(compared > 5000);
}

TEST_CASE("diffuse power: the sum over a wall is its integral, to the tolerance asked for") {
  int index = 0;
  for (const NamedPattern& pattern : patterns) {
    for (const MaterialModel& model :
         {MaterialModel(ConstantReflection{0.8, {}}), MaterialModel(lossy_slab), MaterialModel(half_space)}) {
      const NamedPolarization& sent = polarizations[static_cast<std::size_t>(index++) % polarizations.size()];
      for (Setup& setup : setups(rough("wall", model, 0.55, pattern))) {
        setup.jones = sent.jones;
        const double exact = wall_power(setup);
        for (const double tolerance_db : {1.0, 0.3, 0.1, 0.03}) {
          CAPTURE(index);
          CAPTURE(tolerance_db);
          const DiffusePower power = link(scene_of(setup), device("tx", setup.from_m, sent.polarization),
                                          device_at("rx", setup.to_m), settings_for(tolerance_db))
                                         .diffuse;
          CHECK(power.converged);
          CHECK(std::abs(db(power.power_ratio / exact)) <= tolerance_db);
          CHECK(power.residual_ratio <= (std::pow(10.0, tolerance_db / 10.0) - 1.0) * power.power_ratio * (1.0 + 1e-8));
        }
      }
    }
  }
}

TEST_CASE("diffuse power: an antenna a centimetre to a metre off an endless wall sends half of its power to it") {
  for (const double off_m : {1.0, 0.1, 0.03, 0.01}) {
    CAPTURE(off_m);
    const Scene scene = scene_of({{Vec3(-300, -300, 0), Vec3(600, 0, 0), Vec3(0, 600, 0), "wall"}},
                                 {rough("wall", ConstantReflection{0.6, {}}, 0.5)});
    // All of it from one place, as seen from 100 m away: (λ/4π)²·(S·Γ)²·2π·cos θ_s/π/r_s². The wall ends 300 m away,
    // where 1 − off/300 of the half space is covered; the lit spot is as large as `off_m`.
    const Vec3 to_m(30, 40, 86.6025403784);
    const DiffusePower power = link(scene, Vec3(0, 0, off_m), to_m, settings_for(0.1, 20'000)).diffuse;
    const double expected = std::pow(wavelength / (2.0 * circle), 2) * 0.09 * 2.0 * 0.866025403784 / 1e4;
    CHECK(power.converged);
    CHECK(std::abs(db(power.power_ratio / expected)) < 0.1 + 5.0 * off_m / 100.0 * 4.343);
  }
}

TEST_CASE("diffuse power: no end on the wall's other side, none without S, none unless it is asked for") {
  const Patch wall{Vec3(-2, 3, -2), Vec3(4, 0, 0), Vec3(0, 0, 4), "wall"};
  const Scene scene = scene_of({wall}, {rough("wall", ConstantReflection{0.7, 10.0}, 0.5)});
  const Scene smooth = scene_of({wall}, {rough("wall", ConstantReflection{0.7, 10.0}, 0.0)});
  const Vec3 from_m(-1, 0, 0), to_m(1.5, 0.5, 0.3);
  const SimulationSettings settings = settings_for(0.1);
  CHECK(link(scene, from_m, to_m, settings).diffuse.power_ratio > 0.0);
  for (const DiffusePower& none :
       {link(scene, from_m, Vec3(0, 6, 0), settings).diffuse, link(smooth, from_m, to_m, settings).diffuse}) {
    CHECK(none.power_ratio == 0.0);
    CHECK(none.tiles.empty());
    CHECK(none.tiles_evaluated == 0);
    CHECK(none.residual_ratio == 0.0);
    CHECK(none.converged);
  }
  SimulationSettings off = settings;
  off.propagation.diffuse = {};
  const LinkResult without = link(scene, from_m, to_m, off), with = link(scene, from_m, to_m, settings);
  CHECK(without.diffuse.tiles.empty());
  CHECK(without.diffuse.tiles_evaluated == 0);
  CHECK_FALSE(without.statistics.power_diffuse_dbm);
  CHECK_FALSE(DiffuseSettings{}.enabled);
  CHECK(DiffuseSettings{}.phases == DiffusePhases::incoherent);
  // Paths do not know of tiles.
  REQUIRE(without.paths.size() == with.paths.size());
  CHECK(without.statistics.path_count == with.statistics.path_count);
  for (std::size_t path = 0; path < with.paths.size(); ++path) {
    CHECK(with.paths[path].amplitude == without.paths[path].amplitude);
  }
}

// What lies on the way, and the antennas ------------------------------------------------------------------------------

namespace {

const Vec3& scattering_point_m(const DiffuseContribution& tile) {
  const auto scatters = [](const Interaction& at) { return at.kind == InteractionKind::scattering; };
  return std::find_if(tile.path.interactions.begin(), tile.path.interactions.end(), scatters)->point_m;
}

/// Tiles by their points: triangles have other numbers in another scene.
std::map<std::array<double, 3>, DiffuseContribution> by_point(const DiffusePower& power) {
  std::map<std::array<double, 3>, DiffuseContribution> tiles;
  for (const DiffuseContribution& tile : power.tiles) {
    const Vec3& point_m = scattering_point_m(tile);
    tiles.emplace(std::array{point_m.x, point_m.y, point_m.z}, tile);
  }
  return tiles;
}

/// Checks that `factor(tile)` is what every tile of `with` has over the same of `without`; returns how many.
template <typename Factor>
std::size_t check_factor(const DiffusePower& with, const DiffusePower& without, double tolerance, Factor&& factor) {
  const auto plain = by_point(without);
  std::size_t compared = 0;
  for (const auto& [point, tile] : by_point(with)) {
    const auto found = plain.find(point);
    if (found == plain.end()) continue;
    const double ratio = tile.sample.power_ratio / found->second.sample.power_ratio;
    CHECK(ratio == relative(factor(tile), tolerance));
    ++compared;
  }
  return compared;
}

SimulationSettings listing(double tolerance_db = 0.3) {
  SimulationSettings settings = settings_for(tolerance_db);
  settings.propagation.diffuse.list_paths = true;
  settings.propagation.diffuse.tile_max_m = 0.5;  // so that many tiles are the same in two solutions
  return settings;
}

}  // namespace

TEST_CASE("diffuse power: gains of both antennas count towards the tile, the receiver's polarization does not") {
  const Setup setup = setups(rough("wall", ConstantReflection{0.8, {}}, 0.5))[0];
  const DiffusePower plain = link(scene_of(setup), setup.from_m, setup.to_m, listing()).diffuse;
  const auto dipole_gain = [](const Vec3& from_m, const Vec3& to_m) {
    const double cosine = glm::normalize(to_m - from_m).z, sine = std::sqrt(1.0 - cosine * cosine);
    // Balanis, Antenna Theory, eq. (4-84): directivity 1.6409, 4/Cin(2π).
    return 1.64092237698459 * std::pow(std::cos(0.25 * circle * cosine) / sine, 2);
  };
  const Antenna dipole{2.0, {}, HalfWaveDipole{}};
  const DiffusePower received =
      link(scene_of(setup), device_at("tx", setup.from_m), device_at("rx", setup.to_m, 0.0, dipole), listing()).diffuse;
  const DiffusePower sent =
      link(scene_of(setup), device_at("tx", setup.from_m, 0.0, dipole), device_at("rx", setup.to_m), listing()).diffuse;
  const double two_db = std::pow(10.0, 0.2);
  CHECK(check_factor(received, plain, 1e-11, [&](const DiffuseContribution& tile) {
          return two_db * dipole_gain(setup.to_m, tile.path.interactions[0].point_m);
        }) > 100);
  CHECK(check_factor(sent, plain, 1e-11, [&](const DiffuseContribution& tile) {
          return two_db * dipole_gain(setup.from_m, tile.path.interactions[0].point_m);
        }) > 100);
  for (const NamedPolarization& other : polarizations) {
    const DiffusePower turned =
        link(scene_of(setup), device_at("tx", setup.from_m), device("rx", setup.to_m, other.polarization), listing())
            .diffuse;
    CHECK(turned.power_ratio == relative(plain.power_ratio, 1e-13));
  }
  // Two ports at the receiver hear the power once; two at the transmitter share it.
  const auto dual = [&](const Setup& one, bool at_transmitter, bool at_receiver) {
    const Polarization both{PolarizationKind::dual};
    return link(scene_of(one), device("tx", one.from_m, at_transmitter ? both : Polarization{}),
                device("rx", one.to_m, at_receiver ? both : Polarization{}), listing())
        .diffuse;
  };
  CHECK(dual(setup, false, true).power_ratio == relative(plain.power_ratio, 1e-13));
  const Setup slab = setups(rough("wall", lossy_slab, 0.5))[0];
  Setup vertical = slab, horizontal = slab;
  horizontal.jones = {0.0, 1.0};
  CHECK(check_factor(dual(slab, true, false), dual(slab, false, false), 1e-10, [&](const DiffuseContribution& tile) {
          const Vec3& point_m = tile.path.interactions[0].point_m;
          return 0.5 * (1.0 + power_per_m2(horizontal, point_m) / power_per_m2(vertical, point_m));
        }) > 100);
}

TEST_CASE(
    "diffuse power: a sheet takes from the wave that comes by its polarization, from what is scattered by the mean") {
  const Patch wall{Vec3(-3, 0, -3), Vec3(6, 0, 0), Vec3(0, 0, 6), "wall"};
  const Patch before_tx{Vec3(-40, -4, -30), Vec3(38, 0, 0), Vec3(0, 0, 60), "sheet"};
  const Patch before_rx{Vec3(2, -4, -30), Vec3(38, 0, 0), Vec3(0, 0, 60), "sheet"};
  const Material rough_wall = rough("wall", ConstantReflection{0.8, {}}, 0.5);
  const Vec3 from_m(-14, -12, 0.3), to_m(14, -12, 1);
  const auto shares_through = [](const Vec3& k, double sine_sign) {
    // |T|² of a lossless slab is 1 − |R|²: by energy, without a formula of its own.
    const std::array<double, 2> r = reflected_shares(Dielectric{4.0, 0.0, 0.0031}, std::abs(k.y));
    const Vec3 across = glm::normalize(glm::cross(k, Vec3(0, sine_sign, 0)));
    const Vec3 phi = glm::normalize(Vec3(-k.y, k.x, 0));
    const double te = 1.0 - std::pow(glm::dot(phi, across), 2);  // of a V field, which is across φ̂
    return std::array{(1.0 - r[0]) * te + (1.0 - r[1]) * (1.0 - te), 0.5 * (2.0 - r[0] - r[1])};
  };
  const Material sheet{"sheet", Dielectric{4.0, 0.0, 0.0031}};
  const DiffusePower plain = link(scene_of({wall}, {rough_wall}), from_m, to_m, listing()).diffuse;
  const DiffusePower coming = link(scene_of({wall, before_tx}, {rough_wall, sheet}), from_m, to_m, listing()).diffuse;
  const DiffusePower going = link(scene_of({wall, before_rx}, {rough_wall, sheet}), from_m, to_m, listing()).diffuse;
  // 1e-9: the lossless slab of this file has no rounding better than that near its resonance.
  CHECK(check_factor(coming, plain, 1e-9, [&](const DiffuseContribution& tile) {
          CHECK(kinds(tile.path) == "TS");
          return shares_through(glm::normalize(scattering_point_m(tile) - from_m), 1.0)[0];
        }) > 100);
  CHECK(check_factor(going, plain, 1e-9, [&](const DiffuseContribution& tile) {
          CHECK(kinds(tile.path) == "ST");
          return shares_through(glm::normalize(to_m - scattering_point_m(tile)), 1.0)[1];
        }) > 100);
  SimulationSettings opaque = listing();
  opaque.propagation.diffuse.tile_budget = 1000;
  opaque.propagation.max_transmissions = 0;
  CHECK(link(scene_of({wall, before_tx}, {rough_wall, sheet}), from_m, to_m, opaque).diffuse.power_ratio == 0.0);
}

TEST_CASE("diffuse power: air, foliage and close-in path loss act on the whole length of the two legs") {
  Setup setup = setups(rough("wall", ConstantReflection{0.8, {}}, 0.5))[0];
  const DiffusePower plain = link(scene_of(setup), setup.from_m, setup.to_m, listing()).diffuse;
  SimulationSettings close_in = listing(), gas = listing();
  close_in.propagation.path_loss = {CloseIn{2.7, 0.05}};
  CHECK(check_factor(link(scene_of(setup), setup.from_m, setup.to_m, close_in).diffuse, plain, 1e-12,
                     [](const DiffuseContribution& tile) {
                       const double length_m = tile.path.length_m;
                       return std::pow(length_m, -0.7) * std::pow(10.0, -0.005 * length_m);
                     }) > 100);
  gas.propagation.atmosphere = Atmosphere{};
  gas.frequency_hz = 60e9;
  SimulationSettings clear = listing();
  clear.frequency_hz = 60e9;
  const LinkResult damped = link(scene_of(setup), setup.from_m, setup.to_m, gas);
  const LinkResult undamped = link(scene_of(setup), setup.from_m, setup.to_m, clear);
  // What the direct path says of the air, per metre.
  REQUIRE(!damped.paths.empty());
  const double per_m =
      std::log(damped.paths[0].power_ratio / undamped.paths[0].power_ratio) / damped.paths[0].path.length_m;
  CHECK(per_m < 0.0);
  CHECK(check_factor(damped.diffuse, undamped.diffuse, 1e-10,
                     [&](const DiffuseContribution& tile) { return std::exp(per_m * tile.path.length_m); }) > 100);
  // A hedge of 2 m of thickness across all legs that come, 1.5 dB per metre.
  Scene hedged = scene_of({setup.wall}, {setup.material, {"leaves", Foliage{1.5}}});
  hedged.add_object("hedge", make_box(Vec3(200, 2, 100), "leaves"), LinearMotion{{Vec3(0, 0.5, -50)}});
  setup.to_m = Vec3(4, 3, 2);
  // Hardly more than tiles of the longest edge that is allowed: behind leaves there would be others.
  const DiffusePower near_plain = link(scene_of(setup), setup.from_m, setup.to_m, listing(3.0)).diffuse;
  CHECK(check_factor(link(hedged, setup.from_m, setup.to_m, listing(3.0)).diffuse, near_plain, 1e-10,
                     [&](const DiffuseContribution& tile) {
                       const Vec3 leg_m = tile.path.interactions[0].point_m - setup.from_m;
                       return std::pow(10.0, -0.15 * glm::length(leg_m) * 2.0 / leg_m.y);
                     }) > 100);
}

// Reciprocity, scale, place -------------------------------------------------------------------------------------------

TEST_CASE(
    "diffuse power: exchanging the ends changes nothing where cos θ_i·f·|Γ|² is symmetric, and something else where "
    "not") {
  // Lambertian: cos θ_i·cos θ_s/π. |Γ|² must not depend on the angle, or the two angles of incidence differ.
  const auto both = [](const Setup& setup) {
    const SimulationSettings settings = settings_for(0.01);
    return std::pair(link(scene_of(setup), setup.from_m, setup.to_m, settings).diffuse.power_ratio,
                     link(scene_of(setup), setup.to_m, setup.from_m, settings).diffuse.power_ratio);
  };
  for (const Setup& setup : setups(rough("wall", ConstantReflection{0.8, {}}, 0.5))) {
    const auto [there, back] = both(setup);
    CHECK(std::abs(db(there / back)) < 0.02);  // twice the tolerance
  }
  const auto [there, back] = both(setups(rough("wall", half_space, 0.5))[2]);
  CHECK(std::abs(db(there / back)) > 0.1);
  const auto [forth, reverse] =
      both(setups(rough("wall", ConstantReflection{0.8, {}}, 0.5, ScatteringPattern::directive, 5))[2]);
  CHECK(std::abs(db(forth / reverse)) > 0.1);
}

TEST_CASE("diffuse power: no matter where the world stands, how it is turned, and into what its walls are cut") {
  const std::vector<Patch> room{{Vec3(0, 0, 0), Vec3(8, 0, 0), Vec3(0, 6, 0), "wall"},
                                {Vec3(0, 0, 3), Vec3(8, 0, 0), Vec3(0, 6, 0), "wall"},
                                {Vec3(0, 0, 0), Vec3(8, 0, 0), Vec3(0, 0, 3), "wall"},
                                {Vec3(0, 6, 0), Vec3(8, 0, 0), Vec3(0, 0, 3), "wall"}};
  const Material material = rough("wall", ConstantReflection{0.7, {}}, 0.4, ScatteringPattern::directive, 4);
  const Vec3 from_m(1, 2, 1.5), to_m(6.5, 4.5, 0.7);
  const SimulationSettings settings = settings_for(0.02);
  const double expected = link(scene_of(room, {material}), from_m, to_m, settings).diffuse.power_ratio;
  const auto compare = [&](const std::vector<Patch>& patches, const Vec3& from, const Vec3& to) {
    const DiffusePower power = link(scene_of(patches, {material}), from, to, settings).diffuse;
    CHECK(power.converged);
    CHECK(std::abs(db(power.power_ratio / expected)) < 0.04);  // two results of 0.02 dB each
  };
  const auto moved = [&](auto&& map) {
    std::vector<Patch> patches = room;
    for (Patch& patch : patches) {
      const Vec3 corner_m = map(patch.corner_m);
      patch = {corner_m, map(patch.corner_m + patch.u_m) - corner_m, map(patch.corner_m + patch.v_m) - corner_m,
               "wall"};
    }
    compare(patches, map(from_m), map(to_m));
  };
  moved([](const Vec3& p) { return p + Vec3(512.3, -1033.7, 61.1); });
  const Mat3 turn = rotation_matrix(Pose{Vec3(0.0), 0.7, -0.4, 1.1});
  moved([&](const Vec3& p) { return turn * p; });
  moved([](const Vec3& p) { return Vec3(-p.x, p.y, p.z); });  // windings turn, too
  for (const auto& [columns, rows] : {std::pair(2, 1), std::pair(7, 5), std::pair(31, 1)}) {
    std::vector<Patch> cut;
    for (const Patch& patch : room) {
      const Vec3 u_m = patch.u_m / double(columns), v_m = patch.v_m / double(rows);
      for (int i = 0; i < columns; ++i) {
        for (int j = 0; j < rows; ++j)
          cut.push_back({patch.corner_m + double(i) * u_m + double(j) * v_m, u_m, v_m, "wall"});
      }
    }
    compare(cut, from_m, to_m);
  }
  std::vector<Patch> backwards(room.rbegin(), room.rend());
  for (Patch& patch : backwards) std::swap(patch.u_m, patch.v_m);
  compare(backwards, from_m, to_m);
  // A wall drawn twice is one wall.
  std::vector<Patch> twice = room;
  twice.push_back(room[2]);
  twice.push_back({room[1].corner_m + 0.3 * room[1].u_m, 0.4 * room[1].u_m, room[1].v_m, "wall"});
  compare(twice, from_m, to_m);
}

// A street ------------------------------------------------------------------------------------------------------------

namespace {

Scene street(double s, ScatteringPattern pattern = ScatteringPattern::directive) {
  return scene_of(
      {{Vec3(-60, 8, 0), Vec3(120, 0, 0), Vec3(0, 0, 18), "facade"},
       {Vec3(-60, -8, 0), Vec3(120, 0, 0), Vec3(0, 0, 18), "facade"},
       {Vec3(-60, -8, 0), Vec3(120, 0, 0), Vec3(0, 16, 0), "ground"}},
      {rough("facade", ConstantReflection{0.7, {}}, s, pattern), rough("ground", Dielectric{5.0, 0.3, {}}, s)});
}

const Vec3 lamp_m(-20, 3, 6), walker_m(17, -2, 1.5);

}  // namespace

TEST_CASE("diffuse power: in a street it grows as S², and every reflection keeps 1 − S² of its power") {
  const SimulationSettings settings = settings_for(0.1, 20'000, 2);
  const LinkResult smooth = link(street(0.0), lamp_m, walker_m, settings),
                   some = link(street(0.3), lamp_m, walker_m, settings),
                   more = link(street(0.6), lamp_m, walker_m, settings);
  // 1e-12: S² enters every tile and every bound as one factor, so the tiles are the same.
  CHECK(more.diffuse.power_ratio == relative(4.0 * some.diffuse.power_ratio, 1e-12));
  CHECK(some.diffuse.tiles.size() == more.diffuse.tiles.size());
  REQUIRE(smooth.paths.size() == some.paths.size());
  REQUIRE(smooth.paths.size() == more.paths.size());
  std::array<int, 3> of_order{};
  for (std::size_t index = 0; index < smooth.paths.size(); ++index) {
    const std::string letters = kinds(smooth.paths[index].path);
    REQUIRE(kinds(some.paths[index].path) == letters);
    const int order = static_cast<int>(letters.size());
    ++of_order[static_cast<std::size_t>(order)];
    CHECK(some.paths[index].power_ratio == relative(smooth.paths[index].power_ratio * std::pow(0.91, order), 1e-13));
    CHECK(more.paths[index].power_ratio == relative(smooth.paths[index].power_ratio * std::pow(0.64, order), 1e-13));
    // The phase of the mirror is not touched.
    CHECK(std::abs(std::arg(more.paths[index].amplitude / smooth.paths[index].amplitude)) < 1e-13);
  }
  CHECK(of_order[0] == 1);
  CHECK(of_order[1] == 3);
  CHECK(of_order[2] >= 4);
}

TEST_CASE("diffuse power: a rough wall weakens its mirror whether or not its diffuse power is asked for") {
  SimulationSettings off = settings_for(0.1, 20'000, 2);
  off.propagation.diffuse = {};
  const LinkResult smooth = link(street(0.0), lamp_m, walker_m, off), some = link(street(0.6), lamp_m, walker_m, off),
                   asked = link(street(0.6), lamp_m, walker_m, settings_for(0.1, 20'000, 2));
  REQUIRE(smooth.paths.size() == some.paths.size());
  for (std::size_t index = 0; index < smooth.paths.size(); ++index) {
    const double order = static_cast<double>(smooth.paths[index].path.interactions.size());
    CHECK(some.paths[index].power_ratio == relative(smooth.paths[index].power_ratio * std::pow(0.64, order), 1e-13));
    CHECK(some.paths[index].amplitude == asked.paths[index].amplitude);
  }
  CHECK_FALSE(some.statistics.power_diffuse_dbm);
}

TEST_CASE("diffuse power: in a street it arrives after the direct path and dies away") {
  const LinkResult result =
      link(street(0.4, ScatteringPattern::lambertian), lamp_m, walker_m, settings_for(0.1, 20'000, 1));
  const double first_s = result.paths.at(0).delay_s;
  for (const DiffuseContribution& tile : result.diffuse.tiles) CHECK(tile.sample.delay_s > first_s);
  const auto taps = power_delay_profile(result.paths, power_samples(result.diffuse), 20e-9, PdpMode::incoherent);
  std::map<int, double> diffuse;  // by the excess over the direct path in 20 ns
  double total = 0.0;
  for (const PdpTap& tap : taps) {
    total += tap.diffuse_power_ratio;
    CHECK(tap.diffuse_power_ratio <= tap.power_ratio);
  }
  for (const DiffuseContribution& tile : result.diffuse.tiles) {
    diffuse[static_cast<int>((tile.sample.delay_s - first_s) / 20e-9)] += tile.sample.power_ratio;
  }
  CHECK(total == relative(result.diffuse.power_ratio, 1e-12));
  REQUIRE(diffuse.size() >= 5);
  for (int step = 1; step < 5; ++step) {
    CAPTURE(step);
    CHECK(diffuse[step] < diffuse[step - 1]);
  }
  CHECK(diffuse[4] < 0.2 * diffuse[0]);
}

TEST_CASE("diffuse power: the field of reflections and wedge stays continuous where a rough mirror ends") {
  // The corner of a rough building; the receiver walks through the boundary of the reflection at its front.
  Scene scene = scene_of({{Vec3(-40, 0, -200), Vec3(40, 0, 0), Vec3(0, 0, 400), "wall"},
                          {Vec3(0, 0, -200), Vec3(0, 40, 0), Vec3(0, 0, 400), "wall"}},
                         {rough("wall", ConstantReflection{0.9, {}}, 0.6)});
  SimulationSettings settings = settings_for(0.1, 20'000, 1);
  settings.propagation.diffuse.enabled = false;
  settings.propagation.max_diffractions = 1;
  const auto field = [&](double shift_m) {
    Complex sum{};
    std::size_t mirrors = 0;
    for (const PathContribution& path : link(scene, Vec3(-5, -5, 0), Vec3(5 + shift_m, -5, 0.4), settings).paths) {
      sum += path.amplitude;
      mirrors += kinds(path.path) == "R";
    }
    return std::pair(sum, mirrors);
  };
  const auto [before, with] = field(-1e-6);
  const auto [after, without] = field(1e-6);
  CHECK(with == 1);
  CHECK(without == 0);
  // Both sides are 2 µm apart: 1e-3 rad of phase, and a field that falls as the root of the distance next to it.
  CHECK(std::abs(before - after) < 3e-3 * std::abs(before));
}

// What the budget allows ----------------------------------------------------------------------------------------------

TEST_CASE("diffuse power: with too few tiles the result says so, and the residual covers what is missing") {
  Scene city = scene_of({{Vec3(-60, -60, 0), Vec3(120, 0, 0), Vec3(0, 120, 0), "ground"}},
                        {rough("ground", ConstantReflection{0.5, {}}, 0.3),
                         rough("house", ConstantReflection{0.7, {}}, 0.5, ScatteringPattern::directive, 3)});
  for (int row = -1; row <= 1; ++row) {
    for (int column = -1; column <= 1; ++column) {
      city.add_object("house" + std::to_string(3 * row + column),
                      make_box(Vec3(18, 14, 9.0 + row + 2.0 * column), "house"),
                      LinearMotion{{Vec3(34.0 * column, 30.0 * row, 0.0), 0.1 * row}});
    }
  }
  const Vec3 from_m(-17, 4, 3), to_m(16, -14, 1.5);
  constexpr double tolerance_db = 1e-5;
  const DiffusePower reference = link(city, from_m, to_m, settings_for(tolerance_db, 400'000)).diffuse;
  REQUIRE(reference.power_ratio > 0.0);
  CHECK(reference.converged);
  CHECK(reference.tiles_evaluated > 1000);
  for (const std::size_t budget : {1U, 5U, 20U, 60U, 200U, 1000U}) {
    CAPTURE(budget);
    const LinkResult result = link(city, from_m, to_m, settings_for(tolerance_db, budget));
    CHECK_FALSE(result.diffuse.converged);
    CHECK(result.diffuse.tiles_evaluated <= budget + 1);
    CHECK(std::abs(result.diffuse.power_ratio - reference.power_ratio) <=
          result.diffuse.residual_ratio + reference.residual_ratio);
    CHECK(result.diffuse.residual_ratio > (std::pow(10.0, 0.1 * tolerance_db) - 1.0) * result.diffuse.power_ratio);
  }
  city.add_transmitter(device_at("tx", from_m));
  city.add_receiver(device_at("rx", to_m));
  city.add_receiver(device_at("sky", Vec3(0, 0, 80)));
  Simulator simulator(std::move(city), settings_for(tolerance_db, 20));
  const FrameResult frame = simulator.advance_to(0.0);
  CHECK(frame.work.diffuse_links_unfinished == 2);
  CHECK(frame.work.diffuse_tiles == frame.links[0].diffuse.tiles_evaluated + frame.links[1].diffuse.tiles_evaluated);
}

TEST_CASE("diffuse power: no tile is longer than asked for") {
  SimulationSettings settings = settings_for(1.0);
  settings.propagation.diffuse.list_paths = true;
  const Setup setup = setups(rough("wall", ConstantReflection{0.8, {}}, 0.5))[1];
  const Scene scene = scene_of(setup);
  for (const double longest_m : {3.0, 0.8, 0.3}) {
    settings.propagation.diffuse.tile_max_m = longest_m;
    const DiffusePower power = link(scene, setup.from_m, setup.to_m, settings).diffuse;
    // A triangle with no edge longer than that has no more than √3/4 of its square, and its centroid stands for 0.225
    // of it, no other point for more.
    for (const DiffuseContribution& tile : power.tiles) {
      CHECK(tile.area_m2 <= 0.225 * std::sqrt(3.0) / 4.0 * longest_m * longest_m);
    }
    CHECK(std::abs(db(power.power_ratio / wall_power(setup))) < 1.0);
  }
}

// Phases --------------------------------------------------------------------------------------------------------------

namespace {

SimulationSettings seeded(std::uint64_t seed) {
  SimulationSettings settings = settings_for(1.0);
  settings.propagation.diffuse.phases = DiffusePhases::seeded;
  settings.propagation.seed = seed;
  return settings;
}

Complex sum_of_tiles(const DiffusePower& power) {
  Complex sum{};
  for (const DiffuseContribution& tile : power.tiles) sum += tile.amplitude;
  return sum;
}

}  // namespace

TEST_CASE("diffuse power: a seed gives one field, another seed another, and the mean over seeds is the sum of powers") {
  const Setup setup = setups(rough("wall", ConstantReflection{0.8, {}}, 0.5))[0];
  const Scene scene = scene_of(setup);
  const auto solve = [&](std::uint64_t seed) { return link(scene, setup.from_m, setup.to_m, seeded(seed)).diffuse; };
  const DiffusePower one = solve(1), same = solve(1);
  REQUIRE(one.tiles.size() == same.tiles.size());
  for (std::size_t index = 0; index < one.tiles.size(); ++index) {
    CHECK(one.tiles[index].amplitude == same.tiles[index].amplitude);
    CHECK(std::norm(one.tiles[index].amplitude) == relative(one.tiles[index].sample.power_ratio, 1e-13));
  }
  CHECK(sum_of_tiles(one) != sum_of_tiles(solve(2)));
  constexpr int seeds = 2000;
  double mean = 0.0, square = 0.0;
  Complex mean_field{};
  for (int seed = 1; seed <= seeds; ++seed) {
    const Complex field = sum_of_tiles(solve(static_cast<std::uint64_t>(seed))) / std::sqrt(one.power_ratio);
    mean += std::norm(field) / seeds;
    square += std::norm(field) * std::norm(field) / seeds;
    mean_field += field / static_cast<double>(seeds);
  }
  // A sum of many random phasors is a complex normal number: its power has the mean 1, the standard deviation 1 and the
  // mean square 2 (somewhat less for a finite number of tiles), whose own deviation is √20. Four deviations of means
  // over 2000 draws are 0.09, 0.4, and 0.09 for the field, which has the mean 0.
  CHECK(std::abs(mean - 1.0) < 4.0 / std::sqrt(seeds));
  CHECK(std::abs(square - 2.0) < 0.4);
  CHECK(std::abs(mean_field) < 4.0 / std::sqrt(seeds));
}

TEST_CASE("diffuse power: seeded tiles join the coherent sum, others add their power, and nothing else differs") {
  const SimulationSettings plain_settings = settings_for(1.0, 20'000, 1);
  SimulationSettings seeded_settings = plain_settings;
  seeded_settings.propagation.diffuse.phases = DiffusePhases::seeded;
  const LinkResult plain = link(street(0.5), lamp_m, walker_m, plain_settings);
  const LinkResult coherent = link(street(0.5), lamp_m, walker_m, seeded_settings);
  Complex paths{};
  double powers = 0.0;
  for (const PathContribution& path : plain.paths) paths += path.amplitude, powers += std::norm(path.amplitude);
  for (const DiffuseContribution& tile : plain.diffuse.tiles) CHECK(tile.amplitude == Complex{});
  const double diffuse = plain.diffuse.power_ratio;
  // 1e-12 dB of about −100: rounding of sums of a thousand terms.
  CHECK(*plain.statistics.power_dbm == doctest::Approx(db(std::norm(paths) + diffuse)).epsilon(1e-13));
  CHECK(*coherent.statistics.power_dbm ==
        doctest::Approx(db(std::norm(paths + sum_of_tiles(coherent.diffuse)))).epsilon(1e-13));
  for (const LinkResult* one : {&plain, &coherent}) {
    CHECK(*one->statistics.power_incoherent_dbm == doctest::Approx(db(powers + diffuse)).epsilon(1e-13));
    CHECK(*one->statistics.power_diffuse_dbm == doctest::Approx(db(diffuse)).epsilon(1e-13));
    CHECK(one->diffuse.power_ratio == diffuse);
  }
}

TEST_CASE("diffuse power: the phase of a tile follows its length from frame to frame") {
  Scene scene = scene_of(setups(rough("wall", ConstantReflection{0.8, {}}, 0.5))[0]);
  Device moving = device_at("rx", Vec3(4, -6, 2));
  std::get<LinearMotion>(moving.motion).velocity_mps = Vec3(1.0, 0.5, -0.2);
  scene.add_transmitter(device_at("tx", Vec3(1, -3, 0.5)));
  scene.add_receiver(moving);
  SimulationSettings settings = seeded(5);
  settings.propagation.diffuse.list_paths = true;
  settings.propagation.diffuse.tile_max_m = 0.5;
  Simulator simulator(std::move(scene), settings);
  const auto tiles_at = [&](double time_s) {
    std::map<std::pair<std::uint32_t, std::uint64_t>, DiffuseContribution> tiles;
    const FrameResult frame = simulator.advance_to(time_s);
    for (const DiffuseContribution& tile : frame.links.at(0).diffuse.tiles) {
      tiles.emplace(std::pair(tile.triangle, tile.place), tile);
    }
    return tiles;
  };
  const auto before = tiles_at(0.0), after = tiles_at(1e-3);
  std::size_t compared = 0;
  for (const auto& [place, tile] : before) {
    const auto later = after.find(place);
    if (later == after.end()) continue;
    const double lengthening_m = later->second.path.length_m - tile.path.length_m;
    const double turn = std::arg(later->second.amplitude / tile.amplitude);
    // 1e-9 rad: k = 629 rad/m times the rounding of lengths of ten metres.
    CHECK(std::abs(std::remainder(turn + circle / wavelength * lengthening_m, circle)) < 1e-9);
    ++compared;
  }
  CHECK(compared > 50);
}

// Statistics, Doppler, order of work ----------------------------------------------------------------------------------

TEST_CASE("diffuse power: statistics of a link are sums over its paths and its tiles") {
  Scene scene = scene_of({{Vec3(-5, 3, -2), Vec3(10, 0, 0), Vec3(0, 1, 4), "wall"}},
                         {rough("wall", ConstantReflection{0.8, {}}, 0.6, ScatteringPattern::directive)});
  Device from = device_at("tx", Vec3(-4, 0, 0.5), 17.0), to = device_at("rx", Vec3(4, -1, 1.0));
  std::get<LinearMotion>(to.motion).velocity_mps = Vec3(-11, 3, 0);
  const LinkResult result = link(scene, from, to, settings_for(0.5, 20'000, 0));
  REQUIRE(result.paths.size() == 1);
  REQUIRE(result.diffuse.tiles.size() > 50);
  const LinkStatistics& s = result.statistics;
  CHECK(s.path_count == 1);
  CHECK(s.line_of_sight);
  std::vector<PowerSample> samples{power_sample(result.paths[0])};
  for (const DiffuseContribution& tile : result.diffuse.tiles) samples.push_back(tile.sample);
  const auto mean = [&](auto&& quantity) {
    double top = 0.0, bottom = 0.0;
    for (const PowerSample& one : samples) top += one.power_ratio * quantity(one), bottom += one.power_ratio;
    return top / bottom;
  };
  const double los = result.paths[0].power_ratio, diffuse = result.diffuse.power_ratio, first_s = samples[0].delay_s;
  CHECK(*s.power_dbm == doctest::Approx(17.0 + db(los + diffuse)).epsilon(1e-12));
  CHECK(*s.power_incoherent_dbm == doctest::Approx(17.0 + db(los + diffuse)).epsilon(1e-12));
  CHECK(*s.power_los_dbm == doctest::Approx(17.0 + db(los)).epsilon(1e-12));
  CHECK(*s.power_diffuse_dbm == doctest::Approx(17.0 + db(diffuse)).epsilon(1e-12));
  CHECK_FALSE(s.power_reflected_dbm);
  CHECK_FALSE(s.power_transmitted_dbm);
  CHECK_FALSE(s.power_diffracted_dbm);
  CHECK(*s.k_factor_db == doctest::Approx(db(los / diffuse)).epsilon(1e-12));
  CHECK(*s.path_gain_db == doctest::Approx(db(los + diffuse)).epsilon(1e-12));
  CHECK(*s.first_delay_s == first_s);
  const double excess_s = mean([&](const PowerSample& one) { return one.delay_s - first_s; });
  CHECK(*s.mean_delay_s == relative(first_s + excess_s, 1e-12));
  const double spread_s =
      std::sqrt(mean([&](const PowerSample& one) { return std::pow(one.delay_s - first_s - excess_s, 2); }));
  CHECK(*s.rms_delay_spread_s == relative(spread_s, 1e-9));
  CHECK(spread_s > 1e-11);
  const double doppler_hz = mean([](const PowerSample& one) { return one.doppler_hz; });
  CHECK(*s.mean_doppler_hz == doctest::Approx(doppler_hz).epsilon(1e-10));
  CHECK(*s.rms_doppler_spread_hz == doctest::Approx(std::sqrt(mean([&](const PowerSample& one) {
                                      return std::pow(one.doppler_hz - doppler_hz, 2);
                                    }))).epsilon(1e-9));
  const auto spread_rad = [&](auto&& angle) {
    const double c = mean([&](const PowerSample& one) { return std::cos(angle(one)); });
    return std::sqrt(-2.0 *
                     std::log(std::hypot(c, mean([&](const PowerSample& one) { return std::sin(angle(one)); }))));
  };
  CHECK(*s.azimuth_spread_arrival_rad ==
        relative(spread_rad([](const PowerSample& one) { return one.arrival.azimuth_rad; }), 1e-9));
  CHECK(*s.azimuth_spread_departure_rad ==
        relative(spread_rad([](const PowerSample& one) { return one.departure.azimuth_rad; }), 1e-9));
}

TEST_CASE("diffuse power: angles of a tile point from the devices to it") {
  Setup setup = setups(rough("wall", ConstantReflection{0.8, {}}, 0.5))[0];
  for (const DiffuseContribution& tile : link(scene_of(setup), setup.from_m, setup.to_m, listing()).diffuse.tiles) {
    const Vec3 out_m = scattering_point_m(tile) - setup.from_m, back_m = scattering_point_m(tile) - setup.to_m;
    CHECK(tile.sample.departure.azimuth_rad == doctest::Approx(std::atan2(out_m.y, out_m.x)).epsilon(1e-13));
    CHECK(tile.sample.departure.zenith_rad == doctest::Approx(std::acos(out_m.z / glm::length(out_m))).epsilon(1e-13));
    CHECK(tile.sample.arrival.azimuth_rad == doctest::Approx(std::atan2(back_m.y, back_m.x)).epsilon(1e-13));
    CHECK(tile.sample.arrival.zenith_rad == doctest::Approx(std::acos(back_m.z / glm::length(back_m))).epsilon(1e-13));
  }
}

TEST_CASE("diffuse power: without a specular path there are no powers of such, and no K factor") {
  Scene scene = scene_of({{Vec3(-5, 3, -2), Vec3(10, 0, 0), Vec3(0, 0, 4), "wall"}},
                         {rough("wall", ConstantReflection{0.8, {}}, 0.6), {"screen", PerfectConductor{}}});
  scene.add_object("screen", mesh_of({{Vec3(0, -4, -3), Vec3(0, 5.5, 0), Vec3(0, 0, 6), "screen"}}), LinearMotion{});
  const LinkResult result = link(scene, Vec3(-2, 0, 0), Vec3(2, 0, 0), settings_for(0.5));
  CHECK(result.paths.empty());
  CHECK(result.statistics.path_count == 0);
  CHECK_FALSE(result.statistics.line_of_sight);
  CHECK_FALSE(result.statistics.power_los_dbm);
  CHECK_FALSE(result.statistics.k_factor_db);
  REQUIRE(result.statistics.power_dbm);
  CHECK(*result.statistics.power_dbm == doctest::Approx(db(result.diffuse.power_ratio)).epsilon(1e-13));
  CHECK(*result.statistics.power_dbm == doctest::Approx(*result.statistics.power_incoherent_dbm).epsilon(1e-13));
}

TEST_CASE("diffuse power: the Doppler shift of a tile is the rate at which its path shortens, whatever moves") {
  Scene scene = scene_of({{Vec3(-30, 9, 0), Vec3(60, 0, 0), Vec3(0, 0, 12), "wall"}},
                         {rough("wall", ConstantReflection{0.8, {}}, 0.5), rough("bus", PerfectConductor{}, 0.4)});
  // A bus that drives and turns: its tiles ride along with it, also within their own plane.
  const Pose start{Vec3(-6, 5, 0), 0.1}, end{Vec3(10, 4, 0.5), 0.5};
  scene.add_object("bus", make_box(Vec3(9, 2.4, 3), "bus"), WaypointMotion{{{0.0, start}, {1.0, end}}});
  Device from = device_at("tx", Vec3(-8, -6, 4)), to = device_at("rx", Vec3(12, -4, 1.5));
  std::get<LinearMotion>(from.motion).velocity_mps = Vec3(7, -2, 1);
  std::get<LinearMotion>(to.motion).velocity_mps = Vec3(-15, 1, 0.3);
  scene.add_transmitter(from);
  scene.add_receiver(to);
  SimulationSettings settings = settings_for(1.0);
  settings.propagation.diffuse.list_paths = true;
  settings.propagation.diffuse.tile_max_m = 1.0;
  Simulator simulator(std::move(scene), settings);
  struct OnBody {
    DiffuseContribution tile;
    Vec3 local_m;  ///< the point in the axes of its body
  };
  using Tiles = std::map<std::pair<std::uint32_t, std::uint64_t>, OnBody>;
  const auto tiles_at = [&](double time_s) {
    Tiles tiles;
    const FrameResult frame = simulator.advance_to(time_s);
    for (const DiffuseContribution& tile : frame.links.at(0).diffuse.tiles) {
      const BodyId body = simulator.scene().facet(tile.path.interactions[0].facet).body;
      const Pose pose = simulator.scene().body_state(body).placement.pose;
      const Vec3 local_m = (scattering_point_m(tile) - pose.position_m) * rotation_matrix(pose);
      tiles.emplace(std::pair(tile.triangle, tile.place), OnBody{tile, local_m});
    }
    return tiles;
  };
  constexpr double step_s = 5e-4;
  std::size_t on_wall = 0, on_bus = 0;
  for (const double time_s : {0.2, 0.45, 0.8}) {
    const std::array<Tiles, 4> around{tiles_at(time_s - 2 * step_s), tiles_at(time_s - step_s),
                                      tiles_at(time_s + step_s), tiles_at(time_s + 2 * step_s)};
    for (const auto& [place, here] : tiles_at(time_s)) {
      const DiffuseContribution& tile = here.tile;
      std::array<double, 4> length_m{};
      bool everywhere = true;
      for (std::size_t index = 0; index < 4; ++index) {
        const auto found = around[index].find(place);
        // The same point of its body: behind an edge of shadow the points of a part go along with the edge.
        everywhere =
            everywhere && found != around[index].end() && glm::distance(found->second.local_m, here.local_m) < 1e-9;
        if (everywhere) length_m[index] = found->second.tile.path.length_m;
      }
      if (!everywhere) continue;
      const double wide = (length_m[3] - length_m[0]) / (4.0 * step_s),
                   narrow = (length_m[2] - length_m[1]) / (2.0 * step_s);
      const double expected_hz = -(4.0 * narrow - wide) / 3.0 / wavelength;
      // 2e-5 Hz: lengths rounded to 1e-14 m leave 1e-14/(5e-4·λ) = 2e-9 Hz, Richardson's next term is smaller than
      // 1e-5.
      CHECK(std::abs(tile.sample.doppler_hz - expected_hz) < 2e-5 + 1e-8 * std::abs(expected_hz));
      const bool is_bus = simulator.scene().facet(tile.path.interactions[0].facet).body != BodyId{};
      ++(is_bus ? on_bus : on_wall);
    }
  }
  CHECK(on_wall > 300);
  CHECK(on_bus > 60);
}

namespace {

using Numbers = std::vector<double>;

/// All that is said of diffuse power, in the order in which it is said.
Numbers numbers_of(const DiffusePower& power) {
  Numbers numbers{power.power_ratio, power.residual_ratio, double(power.tiles_evaluated), double(power.converged)};
  for (const DiffuseContribution& tile : power.tiles) {
    numbers.insert(numbers.end(),
                   {tile.sample.power_ratio, tile.sample.delay_s, tile.sample.doppler_hz, tile.amplitude.real(),
                    tile.amplitude.imag(), double(tile.triangle), double(tile.place), tile.area_m2});
  }
  return numbers;
}

/// The same of a link, with what it makes of it.
Numbers numbers_of(const LinkResult& link) {
  Numbers numbers = numbers_of(link.diffuse);
  const LinkStatistics& statistics = link.statistics;
  numbers.insert(numbers.begin() + 4, {*statistics.power_dbm, *statistics.power_incoherent_dbm,
                                       *statistics.power_diffuse_dbm, *statistics.rms_delay_spread_s});
  return numbers;
}

struct Run {
  unsigned threads = 1;
  bool devices_backwards = false;
  Discovery discovery = Discovery::exact;
  CacheMode cache = CacheMode::off;
  DiffusePhases phases = DiffusePhases::seeded;
};

/// Links of three frames by frame and names of the ends.
std::map<std::string, Numbers> run_street(const Run& run) {
  Scene scene = street(0.5);
  scene.add_material(rough("car", PerfectConductor{}, 0.3));
  scene.add_object("car", make_box(Vec3(5, 2, 1.6), "car"), LinearMotion{{Vec3(-3, 1, 0), 0.2}, Vec3(12, 0, 0)});
  std::vector<Device> senders{device_at("a", lamp_m), device_at("b", Vec3(30, -5, 5))};
  std::vector<Device> receivers{device_at("x", walker_m), device_at("y", Vec3(-2, 4, 1.5)),
                                device_at("z", Vec3(5, -6, 2))};
  if (run.devices_backwards)
    std::reverse(senders.begin(), senders.end()), std::reverse(receivers.begin(), receivers.end());
  for (const Device& one : senders) scene.add_transmitter(one);
  for (const Device& one : receivers) scene.add_receiver(one);
  SimulationSettings settings = settings_for(0.5, 3000, 1);
  settings.threads = run.threads;
  settings.propagation.discovery = run.discovery;
  settings.propagation.cache = run.cache;
  settings.propagation.rays = 300;
  settings.propagation.diffuse.phases = run.phases;
  Simulator simulator(std::move(scene), settings);
  std::map<std::string, Numbers> links;
  for (std::size_t index = 0; index < 3; ++index) {
    for (const LinkResult& one : simulator.advance_to(0.1 * double(index), index).links) {
      const std::string name = std::to_string(index) + simulator.scene().transmitters()[one.transmitter].id +
                               simulator.scene().receivers()[one.receiver].id;
      links.emplace(name, numbers_of(one));
    }
  }
  return links;
}

}  // namespace

TEST_CASE(
    "diffuse power: the same bits for any number of threads, any order of devices, and with or without a memory") {
  const auto expected = run_street({});
  REQUIRE(expected.size() == 18);
  for (const auto& [name, numbers] : expected) CHECK(numbers.size() > 300);
  CHECK(run_street({}) == expected);
  CHECK(run_street({3}) == expected);
  CHECK(run_street({2, true}) == expected);
  // Sampled paths may be others than the exact ones, so these two are compared with each other; in the first frame
  // there is nothing to remember. Tiles are the same in all frames.
  const auto sampled = run_street({1, false, Discovery::sampled}),
             remembering = run_street({3, true, Discovery::sampled, CacheMode::seed});
  for (const auto& [name, numbers] : expected) {
    const auto tiles = [](const Numbers& all) {
      Numbers kept = all;
      kept.erase(kept.begin() + 4, kept.begin() + 8);
      return kept;
    };
    CHECK(tiles(sampled.at(name)) == tiles(numbers));
    CHECK(tiles(remembering.at(name)) == tiles(numbers));
    if (name[0] == '0') CHECK(remembering.at(name) == sampled.at(name));
  }
}

TEST_CASE("diffuse power: a frame does not depend on the frames before it") {
  Scene scene = street(0.5);
  scene.add_material(rough("car", PerfectConductor{}, 0.3));
  scene.add_object("car", make_box(Vec3(5, 2, 1.6), "car"), LinearMotion{{Vec3(-3, 1, 0), 0.2}, Vec3(12, 0, 0)});
  scene.add_transmitter(device_at("a", lamp_m));
  scene.add_receiver(device_at("x", walker_m));
  Simulator simulator(scene, settings_for(0.3, 20'000, 1)), other(scene, settings_for(0.3, 20'000, 1));
  simulator.advance_to(0.7);
  simulator.advance_to(1.9);
  CHECK(numbers_of(simulator.advance_to(0.3).links.at(0)) == numbers_of(other.advance_to(0.3).links.at(0)));
}

TEST_CASE("diffuse power: a map says what a link to its point says, with phases and without") {
  for (const DiffusePhases phases : {DiffusePhases::seeded, DiffusePhases::incoherent}) {
    Scene scene = street(0.5);
    scene.add_material(rough("car", PerfectConductor{}, 0.3));
    scene.add_object("car", make_box(Vec3(5, 2, 1.6), "car"), LinearMotion{{Vec3(8, 1, 0), 0.2}});
    scene.add_transmitter(device_at("a", lamp_m));
    scene.add_transmitter(device_at("b", Vec3(25, -5, 4)));
    SimulationSettings settings = settings_for(0.5, 3000, 1);
    settings.propagation.diffuse.phases = phases;
    settings.threads = phases == DiffusePhases::seeded ? 1 : 2;
    Simulator simulator(std::move(scene), settings);
    simulator.advance_to(0.0);
    const ReceiverGrid grid{"area", Vec3(4, -5, 1.5), {3.0, 4.0}, {3, 2}, {}};
    const std::vector<RadioMap> maps = simulator.radio_maps(grid);
    REQUIRE(maps.size() == 2);
    for (std::size_t row = 0; row < 2; ++row) {
      for (std::size_t column = 0; column < 3; ++column) {
        const std::vector<Device> receiver{grid_receiver(grid, row, column)};
        for (const LinkResult& one : simulator.solve(receiver)) {
          const LinkStatistics& single = one.statistics;
          const LinkStatistics& point = maps.at(one.transmitter).points[row * 3 + column].statistics;
          REQUIRE(point.power_diffuse_dbm);
          CHECK(point.power_diffuse_dbm == single.power_diffuse_dbm);
          CHECK(point.power_dbm == single.power_dbm);
          CHECK(point.power_incoherent_dbm == single.power_incoherent_dbm);
          CHECK(point.rms_delay_spread_s == single.rms_delay_spread_s);
        }
      }
    }
  }
}

TEST_CASE("diffuse power: no point of a tile brings more than the limit that steers the refinement") {
  RandomStream random(23);
  const auto between = [&](double low, double high) { return low + (high - low) * random.uniform(); };
  std::size_t close = 0;
  for (int draw = 0; draw < 3000; ++draw) {
    const NamedPattern& pattern = patterns[static_cast<std::size_t>(draw) % patterns.size()];
    const NamedPattern narrow{pattern.pattern, draw % 5 == 0 ? 60 : pattern.lobe, pattern.back_lobe, pattern.share};
    const Material wall = rough("wall", draw % 2 == 0 ? MaterialModel(PerfectConductor{}) : lossy_slab, 0.7, narrow);
    Scene scene = scene_of({{Vec3(-20, -20, 0), Vec3(40, 0, 0), Vec3(0, 40, 0), "wall"}}, {wall});
    scene.apply(scene.frame_at(0.0));
    const MaterialTable table({wall}, frequency_hz);
    // Below an exponent of 2 the excess grows with the length, but never as fast as 1/(r_i·r_s)² falls.
    const AnyPathLoss loss{
        CloseIn{std::array{2.0, 2.9, 0.4}[static_cast<std::size_t>(draw) % 3], draw % 7 == 1 ? 0.02 : 0.0}};
    const MediumLoss medium;
    const ScatteredPower<MaterialTable, AnyPathLoss> scattered(scene, table, loss, medium, frequency_hz);
    const auto end = [&] {
      RadioEnd radio{Vec3(between(-8, 8), between(-8, 8), std::pow(10.0, between(-1.5, 1)))};
      radio.antenna.gain_dbi = between(-3, 10);
      if (draw % 4 == 1) radio.antenna.pattern = HalfWaveDipole{};
      if (draw % 4 == 2) radio.antenna.pattern = Tr38901Element{};
      radio.rotation = rotation_matrix(Pose{Vec3(0.0), between(-3, 3), between(-1, 1), between(-3, 3)});
      return radio;
    };
    const RadioEnd from = end(), to = end();
    const double size_m = std::pow(10.0, between(-2, 1));
    Tile tile;
    for (Vec3& corner : tile.corners_m) corner = Vec3(between(-5, 5), between(-5, 5), 0);
    for (Vec3& corner : tile.corners_m) corner = tile.corners_m[2] + 0.1 * size_m * (corner - tile.corners_m[2]);
    const double from_m = distance_to_triangle_m(tile.corners_m, from.position_m);
    const double to_m = distance_to_triangle_m(tile.corners_m, to.position_m);
    const double limit =
        scattered.limit_per_m2(scene.facet(FacetId(0)), tile.centroid_m(), tile.radius_m(), from_m, to_m, from, to);
    double highest = 0.0;
    for (int point = 0; point < 30; ++point) {
      const double a = random.uniform(), b = random.uniform() * (1.0 - a);
      const Vec3 point_m = point < 3 ? tile.corners_m[static_cast<std::size_t>(point)]
                                     : tile.corners_m[0] + a * (tile.corners_m[1] - tile.corners_m[0]) +
                                           b * (tile.corners_m[2] - tile.corners_m[0]);
      const double length_m = glm::distance(from.position_m, point_m) + glm::distance(point_m, to.position_m);
      const Path path{{{InteractionKind::scattering, FacetId(0), point_m}}, length_m};
      highest = std::max(highest, scattered.power_per_m2(path, from, to));
    }
    CHECK(highest <= limit * (1.0 + 1e-12));
    // e^(−1/2) of a lobe of order α is at √(2/α); what is wider than 1 rad is as good as Lambertian.
    const int narrowest = wall.scattering.pattern == ScatteringPattern::lambertian ? 1
                          : wall.scattering.pattern == ScatteringPattern::directive
                              ? wall.scattering.lobe
                              : std::max(narrow.lobe, narrow.back_lobe);
    CHECK(scattered.pattern_width_rad(MaterialId(0)) == relative(std::min(1.0, std::sqrt(2.0 / narrowest)), 1e-15));
    close += highest > 0.3 * limit;
  }
  CHECK(close > 100);  // a limit that is always far off would be of no use
}

TEST_CASE("diffuse power: an antenna a hair off a wall has its power to the tolerance, and the result says so") {
  const Scene scene = scene_of({{Vec3(-300, -300, 0), Vec3(600, 0, 0), Vec3(0, 600, 0), "wall"}},
                               {rough("wall", ConstantReflection{0.6, {}}, 0.5)});
  const double expected = std::pow(wavelength / (2.0 * circle), 2) * 0.09 * 2.0 * 0.866025403784 / 1e4;
  for (const double off_m : {3e-3, 1e-3, 3e-4, 1.5e-4}) {
    CAPTURE(off_m);
    const DiffusePower power =
        link(scene, Vec3(0, 0, off_m), Vec3(30, 40, 86.6025403784), settings_for(0.1, 20'000)).diffuse;
    CHECK(power.converged);
    CHECK(power.tiles_evaluated < 20'000);
    CHECK(std::abs(db(power.power_ratio / expected)) < 0.1);
  }
}

TEST_CASE("diffuse power: a place is the same part of its triangle in every frame, however the body stands") {
  // Else the seeded phase of a tile jumps to another tile. The halves of a right triangle have two edges of one length.
  Scene scene = scene_of({}, {rough("bus", PerfectConductor{}, 0.4)});
  scene.add_object("bus", make_box(Vec3(9, 2.4, 3), "bus"),
                   WaypointMotion{{{0.0, {Vec3(-6, 5, 0), 0.1}}, {1.0, {Vec3(10, 4, 0.5), 0.5}}}});
  scene.add_transmitter(device_at("tx", Vec3(-8, -6, 4)));
  scene.add_receiver(device_at("rx", Vec3(12, -4, 1.5)));
  SimulationSettings settings = settings_for(1.0);
  settings.propagation.diffuse.list_paths = true;
  settings.propagation.diffuse.tile_max_m = 1.0;
  Simulator simulator(std::move(scene), settings);
  std::map<std::pair<std::uint32_t, std::uint64_t>, Vec3> first;
  std::size_t compared = 0;
  for (int step = 0; step < 20; ++step) {
    const double time_s = 0.05 * step;
    const FrameResult frame = simulator.advance_to(time_s);
    const Pose pose = simulator.scene().body_state(BodyId(1)).placement.pose;
    for (const DiffuseContribution& tile : frame.links.at(0).diffuse.tiles) {
      // Into the bus's own axes: the transpose of its rotation.
      const Vec3 local_m = (scattering_point_m(tile) - pose.position_m) * rotation_matrix(pose);
      const auto [entry, is_new] = first.emplace(std::pair(tile.triangle, tile.place), local_m);
      CHECK(glm::distance(entry->second, local_m) < 1e-9);
      compared += !is_new;
    }
  }
  CHECK(compared > 100);
}

TEST_CASE("diffuse power: between two ports at an end seeded tiles add in power, with or without a specular path") {
  const Scene open = scene_of({{Vec3(-5, 3, -2), Vec3(10, 0, 0), Vec3(0, 0, 4), "wall"}},
                              {rough("wall", ConstantReflection{0.8, {}}, 0.6), {"screen", PerfectConductor{}}});
  Scene hidden = open;
  hidden.add_object("screen", mesh_of({{Vec3(0, -4, -3), Vec3(0, 5.5, 0), Vec3(0, 0, 6), "screen"}}), LinearMotion{});
  SimulationSettings settings = settings_for(0.5);
  settings.propagation.diffuse.phases = DiffusePhases::seeded;
  for (const Scene* scene : std::array<const Scene*, 2>{&open, &hidden}) {
    const LinkResult result = link(*scene, device("tx", Vec3(-2, 0, 0), {PolarizationKind::vertical}),
                                   device("rx", Vec3(2, 0, 0), {PolarizationKind::dual}), settings);
    CHECK(result.paths.empty() == (scene == &hidden));
    double specular = 0.0;
    for (const PathContribution& path : result.paths) specular += path.power_ratio;
    CHECK(*result.statistics.power_dbm == doctest::Approx(db(specular + result.diffuse.power_ratio)).epsilon(1e-12));
  }
}

TEST_CASE("diffuse power: what a wall hides from both ends changes no bit of it, and is hardly looked at") {
  const Material brick = rough("brick", Dielectric{3.75, 0.1}, 0.5);
  const std::vector<Patch> wall{{Vec3(-20, 0, -20), Vec3(40, 0, 0), Vec3(0, 0, 40), "brick"}};
  std::vector<Patch> with_more = wall;
  for (int hidden = 0; hidden < 40; ++hidden) {  // behind it, turned towards the ends
    with_more.push_back({Vec3(-10 + 0.5 * hidden, 1 + 0.1 * hidden, -3), Vec3(0.4, 0.1, 0), Vec3(0, 0, 6), "brick"});
  }
  const Vec3 from_m(-2, -4, 1), to_m(3, -6, -1);
  const LinkResult alone = link(scene_of(wall, {brick}), from_m, to_m, settings_for(0.1));
  const LinkResult among = link(scene_of(with_more, {brick}), from_m, to_m, settings_for(0.1));
  CHECK(alone.diffuse.power_ratio > 0.0);
  CHECK(among.diffuse.power_ratio == alone.diffuse.power_ratio);
  // One or two may be met in the same box as the wall, before it.
  CHECK(among.diffuse.tiles_evaluated <= alone.diffuse.tiles_evaluated + 8);
  CHECK(among.diffuse.residual_ratio == alone.diffuse.residual_ratio);
}

// Streets with cars and panes, against rays ---------------------------------------------------------------------------

namespace {

struct Draw {
  RandomStream random;
  double between(double low, double high) { return low + (high - low) * random.uniform(); }
  std::size_t below(std::size_t count) { return static_cast<std::size_t>(random.next() % count); }
  Vec3 inside(const Vec3& low, const Vec3& high) {
    return {between(low.x, high.x), between(low.y, high.y), between(low.z, high.z)};
  }
};

struct Traffic {
  Scene scene;  ///< as it stands at 0 s
  Vec3 from_m, to_m;
  std::vector<Vec3> car_sizes_m{};
};

constexpr double street_half_m = 18.0;

/// Two facades, the ground, some cars, and with sheets also panes and cars of board. Cars stand on the ground or above
/// it, some stick in a facade or in each other.
Traffic traffic(std::uint64_t seed, bool with_sheets, std::size_t fewest_cars = 0) {
  Draw draw{RandomStream(hash_values(seed, 0x7aff1cULL))};
  const double half_width_m = draw.between(5, 8), height_m = draw.between(4, 8), end_m = street_half_m;
  const ScatteringPattern pattern = seed % 3 == 0 ? ScatteringPattern::directive : ScatteringPattern::lambertian;
  Traffic result{
      scene_of({{Vec3(-end_m, half_width_m, 0), Vec3(2 * end_m, 0, 0), Vec3(0, 0, height_m), "facade"},
                {Vec3(-end_m, -half_width_m, 0), Vec3(2 * end_m, 0, 0), Vec3(0, 0, height_m), "brick"},
                {Vec3(-end_m, -half_width_m, 0), Vec3(2 * end_m, 0, 0), Vec3(0, 2 * half_width_m, 0), "ground"}},
               {rough("facade", ConstantReflection{0.7, {}}, 0.5, pattern),
                rough("brick", Dielectric{3.75, 0.1, {}}, 0.4),
                rough("ground", Dielectric{5.0, 0.3, {}}, 0.4),
                rough("paint", PerfectConductor{}, 0.3),
                {"metal", PerfectConductor{}},
                rough("board", ConstantReflection{0.6, 10.0}, 0.5),
                {"pane", Dielectric{4.0, 0.0, 0.0031}},
                {"film", ConstantReflection{0.5, 3.0}}}),
      Vec3(0), Vec3(0)};
  std::vector<std::string> materials{"paint", "metal"};
  if (with_sheets) materials.insert(materials.end(), {"board", "pane", "film"});
  const std::size_t cars = fewest_cars + draw.below(6 - fewest_cars);
  for (std::size_t car = 0; car < cars; ++car) {
    const Vec3 size_m = draw.inside(Vec3(1, 1, 0.8), Vec3(6, 2.5, 3.2));
    const Vec3 place_m(draw.between(-14, 14), draw.between(2 - half_width_m, half_width_m - 2),
                       draw.below(2) == 0 ? 0.0 : draw.between(0.1, 1));
    result.scene.add_object("car" + std::to_string(car), make_box(size_m, materials[draw.below(materials.size())]),
                            LinearMotion{{place_m, draw.between(-3, 3)}, Vec3(draw.between(-9, 9), 0, 0)});
    result.car_sizes_m.push_back(size_m);
  }
  for (std::size_t pane = 0; with_sheets && pane < 1 + draw.below(3); ++pane) {
    const Vec3 corner_m = draw.inside(Vec3(-12, 1 - half_width_m, 0.3), Vec3(9, half_width_m - 1, 3));
    const Vec3 u_m = draw.inside(Vec3(0.5, -1, -0.3), Vec3(4, 1, 0.3)),
               v_m = draw.inside(Vec3(-0.3, -1, 1), Vec3(0.3, 1, 3));
    result.scene.add_object("pane" + std::to_string(pane),
                            mesh_of({{corner_m, u_m, v_m, materials[2 + draw.below(3)]}}), LinearMotion{});
  }
  const auto somewhere_m = [&](double top_m) {
    return draw.inside(Vec3(-15, 0.5 - half_width_m, 0.5), Vec3(15, half_width_m - 0.5, top_m));
  };
  result.from_m = somewhere_m(7);
  result.to_m = somewhere_m(3);
  result.scene.apply(result.scene.frame_at(0.0));
  return result;
}

SimulationSettings settings_of_traffic(double tolerance_db, int max_transmissions) {
  SimulationSettings settings = settings_for(tolerance_db, 200'000);
  settings.propagation.max_transmissions = max_transmissions;
  return settings;
}

/// What an even grid says, and by how much larger cells differ from it, dB.
struct Even {
  double power_ratio = 0.0, spread_db = 0.0;
};

Even even_power(const Illuminated& world, const LinkEnd& from, const LinkEnd& to, double cell_m,
                int max_transmissions) {
  Even even{grid_power(world, from, to, cell_m, max_transmissions)};
  for (const double larger : {1.4, 2.0}) {
    const double other = grid_power(world, from, to, larger * cell_m, max_transmissions);
    even.spread_db = std::max(even.spread_db, std::abs(db(other / even.power_ratio)));
  }
  return even;
}

/// Checks each listed point by rays: whether both ends see it, through the same sheets in the same order, and that it
/// brings what its own way brings. Returns how many there are behind sheets.
std::size_t check_by_rays(const Illuminated& world, const LinkEnd& from, const LinkEnd& to, const DiffusePower& power,
                          int max_transmissions) {
  ScatterSolver<WideIndex> solver(world.tracer, max_transmissions);
  Path path;
  std::size_t behind_sheets = 0;
  for (const DiffuseContribution& one : power.tiles) {
    const auto scatters = [](const Interaction& at) { return at.kind == InteractionKind::scattering; };
    const auto at = std::find_if(one.path.interactions.begin(), one.path.interactions.end(), scatters);
    REQUIRE(at != one.path.interactions.end());
    CAPTURE(at->point_m.x);
    CAPTURE(at->point_m.y);
    CAPTURE(at->point_m.z);
    CHECK(world.scene.facet_of_triangle(one.triangle) == at->facet);
    CHECK(solver.may_scatter(from, to, at->facet));
    const bool is_visible = solver.solve(from, to, at->facet, at->point_m, path);
    CHECK(is_visible);
    if (!is_visible) continue;
    CHECK(kinds(path) == kinds(one.path));
    CHECK(same_sequence(path, one.path));
    for (std::size_t index = 0; index < path.interactions.size() && same_sequence(path, one.path); ++index) {
      CHECK(glm::distance(path.interactions[index].point_m, one.path.interactions[index].point_m) < 1e-9);
    }
    CHECK(one.path.length_m == doctest::Approx(path.length_m).epsilon(1e-14));
    const double per_m2 = world.scattered.power_per_m2(path, RadioEnd{from.position_m}, RadioEnd{to.position_m});
    // As of one wall: rounding of cosines near 1 in the Fresnel formulas.
    CHECK(one.sample.power_ratio == relative(per_m2 * one.area_m2, 1e-10));
    behind_sheets += path.interactions.size() > 1;
  }
  return behind_sheets;
}

}  // namespace

TEST_CASE("diffuse power: in streets with cars and panes the sum is that of an even grid of rays") {
  for (const int max_transmissions : {0, 1, 2}) {
    std::size_t told = 0;
    const int draws = dcem::test::all_or(40, 6);
    for (int seed = 0; seed < draws; ++seed) {
      CAPTURE(max_transmissions);
      CAPTURE(seed);
      const Traffic street = traffic(static_cast<std::uint64_t>(seed), max_transmissions > 0);
      const DiffusePower power =
          link(street.scene, street.from_m, street.to_m, settings_of_traffic(0.02, max_transmissions)).diffuse;
      CHECK(power.converged);
      const Illuminated world(street.scene, frequency_hz);
      const Even even =
          even_power(world, world.end_at(street.from_m), world.end_at(street.to_m), 0.1, max_transmissions);
      // In a car, or between sheets, an end may see nothing.
      CHECK((power.power_ratio > 0.0) == (even.power_ratio > 0.0));
      if (power.power_ratio == 0.0 || even.power_ratio == 0.0) continue;
      CHECK(std::abs(db(power.power_ratio / even.power_ratio)) <= 0.02 + even.spread_db);
      told += even.spread_db < 0.03;
    }
    CHECK(3 * told > 2 * static_cast<std::size_t>(draws));  // a grid that does not know says nothing
  }
}

TEST_CASE(
    "diffuse power: both ends see every listed point, through the sheets that are listed, and it brings its own") {
  std::size_t points = 0, behind_sheets = 0;
  for (const int max_transmissions : {0, 1, 2, 3}) {
    for (int seed = 0; seed < dcem::test::all_or(100, 12); ++seed) {
      CAPTURE(max_transmissions);
      CAPTURE(seed);
      const Traffic street = traffic(1000 + static_cast<std::uint64_t>(seed), max_transmissions > 0);
      SimulationSettings settings = settings_of_traffic(0.1, max_transmissions);
      settings.propagation.diffuse.list_paths = true;
      const DiffusePower power = link(street.scene, street.from_m, street.to_m, settings).diffuse;
      const Illuminated world(street.scene, frequency_hz);
      behind_sheets +=
          check_by_rays(world, world.end_at(street.from_m), world.end_at(street.to_m), power, max_transmissions);
      points += power.tiles.size();
    }
  }
  CHECK(points > 10'000);
  CHECK(behind_sheets > 1000);
}

TEST_CASE("diffuse power: every point of a link has a place of its own, with the point in it") {
  for (int seed = 0; seed < dcem::test::all_or(60, 10); ++seed) {
    CAPTURE(seed);
    const Traffic street = traffic(2000 + static_cast<std::uint64_t>(seed), true, 2);
    SimulationSettings settings = settings_of_traffic(0.1, 2);
    settings.propagation.diffuse.list_paths = true;
    const DiffusePower power = link(street.scene, street.from_m, street.to_m, settings).diffuse;
    REQUIRE(power.tiles.size() > 100);
    std::map<std::pair<std::uint32_t, std::uint64_t>, Vec3> points_m;
    for (const DiffuseContribution& one : power.tiles) {
      CHECK(points_m.emplace(std::pair(one.triangle, one.place), scattering_point_m(one)).second);
      const Tile piece = piece_at(street.scene, one.triangle, one.place);
      CHECK(distance_to_triangle_m(piece.corners_m, scattering_point_m(one)) < 1e-9);
    }
  }
}

TEST_CASE("diffuse power: where sheets cross each point has their order of its own way") {
  // Two panes through each other before a wall, both far from upright to the way: each turns the polarization that the
  // other one divides, so it counts which comes first.
  Scene scene = scene_of({{Vec3(-3, 0, -3), Vec3(6, 0, 0), Vec3(0, 0, 6), "wall"}},
                         {rough("wall", ConstantReflection{0.8, {}}, 0.5),
                          {"pane", Dielectric{6.0, 0.0, 0.0025}},
                          {"sheet", Dielectric{3.0, 0.0, 0.0031}}});
  const auto around = [](const Vec3& centre_m, const Vec3& u_m, const Vec3& v_m, const std::string& material) {
    return mesh_of({{centre_m - u_m - v_m, 2.0 * u_m, 2.0 * v_m, material}});
  };
  const double c = std::cos(1.2), s = std::sin(1.2);
  const Vec3 centre_m(0, -5, 0);
  scene.add_object("one", around(centre_m, 9.0 * Vec3(c, s, 0), Vec3(0, 0, 9), "pane"), LinearMotion{});
  scene.add_object("other", around(centre_m, 9.0 * Vec3(0.825, 0, 0.565), 9.0 * Vec3(0, -s, c), "sheet"),
                   LinearMotion{});
  scene.apply(scene.frame_at(0.0));
  const Vec3 from_m(0.5, -14, 0.3), to_m(1, -0.7, 0.5);
  SimulationSettings settings = settings_of_traffic(0.02, 2);
  settings.propagation.diffuse.list_paths = true;
  const DiffusePower power = link(scene, from_m, to_m, settings).diffuse;
  const Illuminated world(scene, frequency_hz);
  CHECK(check_by_rays(world, world.end_at(from_m), world.end_at(to_m), power, 2) == power.tiles.size());
  std::map<std::string, std::size_t> orders;
  for (const DiffuseContribution& tile : power.tiles) {
    if (kinds(tile.path) == "TTS") ++orders[scene.body_name(scene.facet(tile.path.interactions[0].facet).body)];
  }
  CHECK(orders["one"] > 50);
  CHECK(orders["other"] > 50);
  const Even even = even_power(world, world.end_at(from_m), world.end_at(to_m), 0.04, 2);
  CHECK(std::abs(db(power.power_ratio / even.power_ratio)) <= 0.02 + even.spread_db);
  CHECK(even.spread_db < 0.02);
}

TEST_CASE("diffuse power: fringes of a thick pane on the way are summed to the tolerance") {
  for (int seed = 0; seed < dcem::test::all_or(100, 20); ++seed) {
    CAPTURE(seed);
    Draw draw{RandomStream(hash_values(static_cast<std::uint64_t>(seed), 0xf217ULL))};
    const double wall_y_m = draw.between(3, 6), pane_y_m = draw.between(-1, wall_y_m - 1.5);
    const Dielectric glass{5.0, 0.0, draw.between(0.04, 0.12)};
    Scene scene = scene_of({{Vec3(-6, wall_y_m, 0), Vec3(12, 0, 0), Vec3(0, 0, 4), "wall"},
                            {Vec3(-30, pane_y_m, -30), Vec3(60, 0, 0), Vec3(0, 0, 60), "pane"}},
                           {rough("wall", ConstantReflection{0.7, {}}, 0.5), {"pane", glass}});
    scene.apply(scene.frame_at(0.0));
    const Vec3 from_m = draw.inside(Vec3(-6, -4, 0.5), Vec3(6, -1.2, 4));
    Vec3 to_m = draw.inside(Vec3(-6, -4, 0.5), Vec3(6, -1.2, 3));
    if (seed % 2 == 0) to_m.y = wall_y_m - 1.0;  // the pane is on one of the legs alone
    const DiffusePower power = link(scene, from_m, to_m, settings_of_traffic(0.1, 2)).diffuse;
    CHECK(power.converged);
    const Illuminated world(scene, frequency_hz);
    const Even even = even_power(world, world.end_at(from_m), world.end_at(to_m), 0.05, 2);
    CHECK(even.spread_db < 0.01);
    CHECK(std::abs(db(power.power_ratio / even.power_ratio)) <= 0.1 + even.spread_db);
  }
}

TEST_CASE("diffuse power: what a device rides on hides nothing, whichever end rides") {
  // A van that fills the street between the ends: without it, and ridden, the link is the same to the last bit.
  const std::vector<Material> materials{rough("facade", ConstantReflection{0.7, {}}, 0.5),
                                        rough("van", PerfectConductor{}, 0.4),
                                        {"metal", PerfectConductor{}}};
  const Scene open = [&] {
    Scene scene = scene_of({{Vec3(-20, 6, 0), Vec3(40, 0, 0), Vec3(0, 0, 8), "facade"},
                            {Vec3(-20, -6, 0), Vec3(40, 0, 0), Vec3(0, 0, 8), "facade"}},
                           materials);
    scene.add_object("post", make_box(Vec3(0.4, 0.5, 5), "metal"), LinearMotion{{Vec3(-5, 3, 0)}});
    return scene;
  }();
  Scene with_van = open;
  with_van.add_object("van", make_box(Vec3(3, 11, 7), "van"), LinearMotion{{Vec3(2, 0, 0)}});
  const SimulationSettings settings = settings_of_traffic(0.1, 0);
  const Vec3 lamp(-12, 1, 4);
  for (const Vec3 offset_m : {Vec3(0, 0, 7.2), Vec3(0, 1, 2), Vec3(1.8, 0, 1.5), Vec3(9, -2, 1.5), Vec3(-1.6, 4, 3)}) {
    CAPTURE(offset_m.x);
    CAPTURE(offset_m.z);
    const Device stands = device_at("rider", Vec3(2, 0, 0) + offset_m);
    Device rides = stands;
    rides.attachment = Attachment{"van", offset_m};
    const Device far = device_at("lamp", lamp);
    const DiffusePower there = link(with_van, far, rides, settings).diffuse;
    CHECK(there.power_ratio > 0.0);
    CHECK(numbers_of(there) == numbers_of(link(open, far, stands, settings).diffuse));
    CHECK(numbers_of(link(with_van, rides, far, settings).diffuse) ==
          numbers_of(link(open, stands, far, settings).diffuse));
    rides.attachment->sees_own_body = true;
    CHECK(numbers_of(link(with_van, far, rides, settings).diffuse) ==
          numbers_of(link(with_van, far, stands, settings).diffuse));
    CHECK(numbers_of(link(with_van, far, rides, settings).diffuse) != numbers_of(there));
  }
}

TEST_CASE("diffuse power: of several receivers, some of them riding, each has the bits of its own link alone") {
  std::size_t riding = 0, compared = 0;
  for (int seed = 0; seed < dcem::test::all_or(30, 5); ++seed) {
    CAPTURE(seed);
    Traffic street = traffic(3000 + static_cast<std::uint64_t>(seed), seed % 2 == 1, 2);
    const int max_transmissions = seed % 2 == 1 ? 2 : 0;
    Draw draw{RandomStream(hash_values(static_cast<std::uint64_t>(seed), 5ULL))};
    const auto device_in_street = [&](const std::string& id) {
      Device one = device_at(id, draw.inside(Vec3(-14, -4, 0.5), Vec3(14, 4, 4)));
      if (draw.below(2) == 0) return one;
      const std::size_t car = draw.below(street.car_sizes_m.size());
      const Vec3& size_m = street.car_sizes_m[car];
      const std::array<Vec3, 4> offsets_m{Vec3(0, 0, size_m.z), Vec3(0, 0, size_m.z + 0.3),
                                          Vec3(0.1 * size_m.x, 0.2 * size_m.y, 0.5 * size_m.z),
                                          Vec3(0.5 * size_m.x + 0.1, 0, 0.5 * size_m.z)};
      one.attachment = Attachment{"car" + std::to_string(car), offsets_m[draw.below(4)], draw.below(5) == 0};
      return one;
    };
    std::vector<Device> senders, receivers;
    for (const char* id : {"a", "b"}) senders.push_back(device_in_street(id));
    for (const char* id : {"v", "w", "x", "y", "z"}) receivers.push_back(device_in_street(id));
    Scene all = street.scene;
    for (const Device& one : senders) all.add_transmitter(one);
    for (const Device& one : receivers) all.add_receiver(one);
    SimulationSettings settings = settings_of_traffic(0.1, max_transmissions);
    settings.propagation.diffuse.list_paths = true;
    SimulationSettings threaded = settings;
    threaded.threads = 1 + static_cast<unsigned>(seed % 3);
    Simulator simulator(std::move(all), threaded);
    simulator.advance_to(0.2, 0);
    const FrameResult frame = simulator.advance_to(0.3, 1);
    REQUIRE(frame.links.size() == senders.size() * receivers.size());
    const Illuminated world(simulator.scene(), frequency_hz);
    for (const LinkResult& one : frame.links) {
      CAPTURE(one.transmitter);
      CAPTURE(one.receiver);
      Scene alone = street.scene;
      alone.add_transmitter(senders[one.transmitter]);
      alone.add_receiver(receivers[one.receiver]);
      Simulator single(std::move(alone), settings);
      CHECK(numbers_of(single.advance_to(0.3, 1).links.at(0).diffuse) == numbers_of(one.diffuse));
      const auto end_of = [&](const Device& device) {
        const DeviceState state = simulator.scene().device_state_now(device, 0.3);
        riding += state.ignored_body.has_value();
        return world.end_at(state.position_m, state.ignored_body);
      };
      const LinkEnd from = end_of(senders[one.transmitter]), to = end_of(receivers[one.receiver]);
      check_by_rays(world, from, to, one.diffuse, max_transmissions);
      const Even even = even_power(world, from, to, 0.2, max_transmissions);
      // Grids of this size say nothing of what is seen through a gap.
      if (even.power_ratio == 0.0 || even.spread_db > 0.3) continue;
      CHECK(std::abs(db(one.diffuse.power_ratio / even.power_ratio)) <= 0.1 + even.spread_db);
      ++compared;
    }
  }
  CHECK(riding > 20);
  CHECK(compared > 30);
}

}  // namespace test_diffuse_power
