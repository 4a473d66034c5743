/// The field of a path against a second derivation: 2×2 Jones matrices that are turned from basis to basis at each
/// surface, where the engine carries Cartesian vectors.
#include "dcem/field/field_evaluator.hpp"

#include <doctest/doctest.h>

#include <complex>
#include <vector>

#include "dcem/paths/path_finder.hpp"
#include "tests/paths/small_scenes.hpp"

namespace test_field_evaluator {

using namespace dcem;
using namespace dcem::test;

namespace {

constexpr double frequency_hz = 30e9;

/// Coefficients without any symmetry, different for each material and angle: nothing can cancel.
struct OddSurface {
  SurfaceResponse response(MaterialId material, double cos_incidence) const {
    const double m = material.value + 1.0, c = cos_incidence;
    return {{Complex(0.3 * c + 0.1 * m, -0.2 * m * c), Complex(0.5 - 0.1 * c, 0.15 * m + 0.2 * c)},
            {Complex(0.7 - 0.05 * m * c, 0.3 * c), Complex(0.2 * c + 0.4, -0.1 * m)}};
  }
};

using LongComplex = std::complex<long double>;
using Jones = std::array<LongComplex, 2>;

/// One end of a basis: two unit vectors across the ray.
struct Basis {
  Vec3 first, second;
};

/// (θ̂, φ̂) of an outgoing direction, from its angles.
Basis spherical(const Vec3& direction) {
  const double zenith = std::acos(glm::normalize(direction).z), azimuth = std::atan2(direction.y, direction.x);
  return {{std::cos(zenith) * std::cos(azimuth), std::cos(zenith) * std::sin(azimuth), -std::sin(zenith)},
          {-std::sin(azimuth), std::cos(azimuth), 0.0}};
}

/// The same field in another basis of the same plane.
Jones turned(const Jones& jones, const Basis& from, const Basis& to) {
  const auto in = [&](const Vec3& axis) {
    return jones[0] * static_cast<long double>(glm::dot(from.first, axis)) +
           jones[1] * static_cast<long double>(glm::dot(from.second, axis));
  };
  return {in(to.first), in(to.second)};
}

/// Transfer matrix of a path: column by column through the bases (TE, TM) of every surface.
ComplexMatrix2 second_derivation(const Scene& scene, const Path& path, const Vec3& from_m, const Vec3& to_m) {
  const OddSurface surface;
  std::vector<Vec3> corners_m{from_m};
  for (const Interaction& interaction : path.interactions) corners_m.push_back(interaction.point_m);
  corners_m.push_back(to_m);
  ComplexMatrix2 transfer;
  const long double k = 2.0L * std::numbers::pi_v<long double> * frequency_hz / 299'792'458.0L;
  const LongComplex phasor =
      std::polar(1.0L, -std::fmod(k * static_cast<long double>(path.length_m), 2.0L * std::numbers::pi_v<long double>));
  for (std::size_t in = 0; in < 2; ++in) {
    Jones jones{in == 0 ? 1.0L : 0.0L, in == 1 ? 1.0L : 0.0L};
    Basis basis = spherical(corners_m[1] - corners_m[0]);
    for (std::size_t index = 0; index < path.interactions.size(); ++index) {
      const WorldFacet& facet = scene.facet(path.interactions[index].facet);
      const Vec3 before = glm::normalize(corners_m[index + 1] - corners_m[index]);
      const Vec3 after = glm::normalize(corners_m[index + 2] - corners_m[index + 1]);
      const Vec3 te = glm::normalize(glm::cross(before, facet.plane.normal));
      const SurfaceResponse response = surface.response(facet.material, std::abs(glm::dot(before, facet.plane.normal)));
      const bool reflects = path.interactions[index].kind == InteractionKind::reflection;
      const PolarizedCoefficients& factors = reflects ? response.reflection : response.transmission;
      jones = turned(jones, basis, {te, glm::cross(te, before)});
      jones = {jones[0] * LongComplex(factors.te), jones[1] * LongComplex(factors.tm)};
      basis = {te, glm::cross(te, after)};
    }
    jones = turned(jones, basis, spherical(corners_m[corners_m.size() - 2] - corners_m.back()));
    for (std::size_t out = 0; out < 2; ++out) {
      const LongComplex value = jones[out] * phasor / (2.0L * k * static_cast<long double>(path.length_m));
      transfer(out, in) = Complex(static_cast<double>(value.real()), static_cast<double>(value.imag()));
    }
  }
  return transfer;
}

/// A room of tilted sheets with a body that moves, for paths with every mixture of R and T.
Scene odd_room() {
  TriangleMesh mesh;
  add_box_faces(mesh, Vec3(0.0), Vec3(7, 5, 3), "wall");
  add_sheet(mesh, Vec3(3, 2.5, 1.5), Vec3(0.2, 1.8, 0.1), Vec3(0.3, -0.1, 1.1), "glass");
  add_sheet(mesh, Vec3(5, 2, 1.2), Vec3(0.9, 0.7, -0.3), Vec3(-0.2, 0.5, 0.8), "alpha");
  Scene scene = scene_of(mesh);
  scene.add_object("plate", make_box(Vec3(1, 0.5, 0.7), "metal"),
                   LinearMotion{{Vec3(2, 4, 0.4), 0.3, 0.1, -0.2}, Vec3(3, -2, 1), 0});
  return scene;
}

std::vector<Path> paths_in(TracedScene<>& traced, const Vec3& from_m, const Vec3& to_m) {
  SearchCounters counters;
  const std::vector<std::optional<LinkEnd>> transmitters{traced.end(from_m)};
  return find_paths(traced.tracer, {true, 3, 2}, traced.end(to_m), {"ue", 0}, transmitters, counters)[0].paths;
}

double largest_entry(const ComplexMatrix2& m) {
  return std::max({std::abs(m(0, 0)), std::abs(m(0, 1)), std::abs(m(1, 0)), std::abs(m(1, 1))});
}

Antenna polarized(PolarizationKind kind, double gain_dbi = 0.0) {
  return {gain_dbi, {kind, 0.0}};
}

/// Free space between two points, without a scene.
PathContribution line_of_sight(const Vec3& from_m, const Vec3& to_m, const Antenna& transmit = {},
                               const Antenna& receive = {}, const AnyPathLoss& loss = {}) {
  const Scene scene;
  const MaterialTable surface({}, frequency_hz);
  const FieldEvaluator<> evaluator(scene, surface, loss, frequency_hz);
  return evaluator.evaluate({{}, glm::distance(from_m, to_m)}, {from_m, Vec3(0.0), transmit},
                            {to_m, Vec3(0.0), receive});
}

}  // namespace

TEST_CASE("the transfer matrix equals the product of Jones matrices in local bases, for every mixture of R and T") {
  TracedScene<> traced(odd_room());
  const OddSurface surface;
  const FieldEvaluator<OddSurface> evaluator(traced.scene, surface, AnyPathLoss{}, frequency_hz);
  Draw draw(1);
  int compared = 0, mixed = 0;
  for (int trial = 0; trial < 6; ++trial) {
    const Vec3 from_m = draw.inside(Vec3(0.2), Vec3(6.8, 4.8, 0.35)),
               to_m = draw.inside(Vec3(0.2), Vec3(6.8, 4.8, 2.8));
    for (const Path& path : paths_in(traced, from_m, to_m)) {
      const ComplexMatrix2 expected = second_derivation(traced.scene, path, from_m, to_m);
      const ComplexMatrix2 transfer = evaluator.evaluate(path, {from_m, {}, {}}, {to_m, {}, {}}).transfer;
      // The phase of the engine is good to 1e-11 over some 20 m; a basis next to normal incidence, or a leg of a
      // centimetre between two sheets, whose direction the second derivation takes from its ends, to 1e-13/1e-2.
      CHECK(largest_entry(transfer + Complex(-1.0) * expected) < 1e-8 * largest_entry(expected));
      ++compared;
      mixed += kinds(path).find('R') != std::string::npos && kinds(path).find('T') != std::string::npos;
    }
  }
  CHECK(compared > 150);
  CHECK(mixed > 50);
}

TEST_CASE("line of sight: lambda/(4 pi d) exp(-jkd), and its negative for the other component") {
  Draw draw(2);
  for (int trial = 0; trial < 500; ++trial) {
    const Vec3 from_m = draw.inside(Vec3(-100), Vec3(100)),
               to_m = from_m + draw.magnitude(0.01, 1e4) * draw.direction();
    const double d = glm::distance(from_m, to_m);
    const ComplexMatrix2 transfer = line_of_sight(from_m, to_m).transfer;
    const long double wavelength = 299'792'458.0L / frequency_hz;
    const long double cycles = static_cast<long double>(d) / wavelength;
    const long double phase = -2.0L * std::numbers::pi_v<long double> * (cycles - std::floor(cycles));
    const auto magnitude =
        static_cast<double>(wavelength / (4.0L * std::numbers::pi_v<long double> * static_cast<long double>(d)));
    const Complex expected = std::polar(magnitude, static_cast<double>(phase));
    CHECK(std::abs(transfer(0, 0) - expected) < 2e-9 * magnitude);  // the phase, see below
    CHECK(std::abs(transfer(1, 1) + expected) < 2e-9 * magnitude);
    CHECK(std::abs(transfer(0, 1)) < 1e-15 * magnitude * 10);
    CHECK(std::abs(transfer(1, 0)) < 1e-15 * magnitude * 10);
  }
}

TEST_CASE("straight up and down the signs follow the pole rule") {
  // For d = +z and d = -z the azimuth is 0, so θ̂ is +x and -x, φ̂ is y at both ends.
  const ComplexMatrix2 transfer = line_of_sight(Vec3(1, 2, 0), Vec3(1, 2, 5)).transfer;
  const double magnitude = 299'792'458.0 / frequency_hz / (4.0 * pi * 5.0);
  CHECK(std::abs(transfer(0, 0) + transfer(1, 1)) < 1e-15);
  CHECK(std::abs(transfer(0, 1)) == 0.0);
  CHECK(std::abs(transfer(1, 1)) == doctest::Approx(magnitude).epsilon(1e-14).scale(0.0));
  CHECK(std::abs(transfer(1, 1) - magnitude * propagation_phasor(5.0, frequency_hz)) < 1e-15);
}

TEST_CASE("the phase keeps its digits over ten kilometres") {
  // 10 km at 30 GHz are a million wavelengths. f/c and the product L·(f/c) are each rounded by at most 2^-53 of
  // themselves: 2.2e-16 · 1e6 cycles · 2π = 1.4e-9 rad; cosine and sine add some 1e-16.
  Draw draw(3);
  double worst_rad = 0.0;
  for (int trial = 0; trial < 20'000; ++trial) {
    const double length_m = draw.between(9'000, 10'000);
    const long double cycles =
        static_cast<long double>(length_m) * (static_cast<long double>(frequency_hz) / 299'792'458.0L);
    const long double phase = -2.0L * std::numbers::pi_v<long double> * (cycles - std::floor(cycles));
    const Complex phasor = propagation_phasor(length_m, frequency_hz);
    const Complex turned_back = phasor * std::polar(1.0, static_cast<double>(-phase));
    worst_rad = std::max(worst_rad, std::abs(std::arg(turned_back)));
    CHECK(std::abs(std::abs(phasor) - 1.0) < 4e-16);
  }
  CHECK(worst_rad < 1.4e-9);
}

TEST_CASE("delay, departure and arrival belong to the first and last leg") {
  TracedScene<> traced(odd_room());
  const OddSurface surface;
  const FieldEvaluator<OddSurface> evaluator(traced.scene, surface, AnyPathLoss{}, frequency_hz);
  const Vec3 from_m(0.7, 1.1, 0.9), to_m(6.1, 3.3, 2.2);
  int reflected = 0;
  for (const Path& path : paths_in(traced, from_m, to_m)) {
    const PathContribution c = evaluator.evaluate(path, {from_m, {}, {}}, {to_m, {}, {}});
    CHECK(c.delay_s == doctest::Approx(path.length_m / 299'792'458.0).epsilon(1e-15).scale(0.0));
    const auto unit = [](const Direction& d) {
      return Vec3(std::sin(d.zenith_rad) * std::cos(d.azimuth_rad), std::sin(d.zenith_rad) * std::sin(d.azimuth_rad),
                  std::cos(d.zenith_rad));
    };
    const Vec3 first_m = path.interactions.empty() ? to_m : path.interactions.front().point_m;
    const Vec3 last_m = path.interactions.empty() ? from_m : path.interactions.back().point_m;
    CHECK(glm::distance(unit(c.departure), glm::normalize(first_m - from_m)) < 1e-12);  // legs of 1 cm and more
    CHECK(glm::distance(unit(c.arrival), glm::normalize(last_m - to_m)) < 1e-12);
    reflected += !path.interactions.empty();
  }
  CHECK(reflected > 20);
}

TEST_CASE("antennas: gains multiply, ports are the Jones products, dual power is summed and averaged") {
  const Vec3 from_m(0, 0, 0), to_m(3, 4, 1);
  const double friis = std::norm(line_of_sight(from_m, to_m).transfer(0, 0));
  using Kind = PolarizationKind;
  const auto gain = [&](Kind transmit, Kind receive, double transmit_dbi = 0, double receive_dbi = 0) {
    return line_of_sight(from_m, to_m, polarized(transmit, transmit_dbi), polarized(receive, receive_dbi));
  };
  CHECK(gain(Kind::vertical, Kind::vertical).power_ratio == doctest::Approx(friis).epsilon(1e-13).scale(0.0));
  CHECK(gain(Kind::vertical, Kind::horizontal).power_ratio < 1e-29 * friis);
  CHECK(gain(Kind::vertical, Kind::right_circular).power_ratio == doctest::Approx(friis / 2).epsilon(1e-13).scale(0.0));
  CHECK(gain(Kind::right_circular, Kind::right_circular).power_ratio ==
        doctest::Approx(friis).epsilon(1e-13).scale(0.0));
  CHECK(gain(Kind::right_circular, Kind::left_circular).power_ratio < 1e-29 * friis);
  CHECK(gain(Kind::vertical, Kind::vertical, 3, 7).power_ratio ==
        doctest::Approx(friis * 10).epsilon(1e-13).scale(0.0));
  const PathContribution dual = gain(Kind::dual, Kind::dual, 0, 10);
  CHECK(dual.transmit_ports == 2);
  CHECK_FALSE(dual.has_amplitude);
  CHECK(dual.amplitude == Complex{});
  CHECK(dual.power_ratio ==
        doctest::Approx(friis * 10).epsilon(1e-13).scale(0.0));  // two halves, each heard by one port
  const PathContribution one_to_two = gain(Kind::right_circular, Kind::dual);
  CHECK(one_to_two.transmit_ports == 1);
  CHECK(one_to_two.power_ratio == doctest::Approx(friis).epsilon(1e-13).scale(0.0));
  CHECK(gain(Kind::dual, Kind::vertical).power_ratio == doctest::Approx(friis / 2).epsilon(1e-13).scale(0.0));
  const PathContribution plain = gain(Kind::vertical, Kind::vertical);
  CHECK(plain.has_amplitude);
  CHECK(plain.amplitude == plain.ports(0, 0));
  CHECK(std::norm(plain.amplitude) == doctest::Approx(plain.power_ratio).epsilon(1e-14).scale(0.0));
}

TEST_CASE("the path-loss model acts once, on the total length") {
  const Vec3 from_m(0, 0, 0), to_m(30, 40, 0);  // 50 m
  const AnyPathLoss close_in{CloseIn{3.0, 0.1}};
  const double free = line_of_sight(from_m, to_m).power_ratio;
  const double lossy = line_of_sight(from_m, to_m, {}, {}, close_in).power_ratio;
  // One more unit of exponent is 10·log10(50) = 16.9897 dB, and 5 dB of air.
  CHECK(power_ratio_to_db(free / lossy) == doctest::Approx(16.989700043360187 + 5.0).epsilon(1e-12));
}

TEST_CASE("Doppler of ends: closing speed over wavelength, nothing from motion across") {
  const Scene scene;
  const MaterialTable surface({}, frequency_hz);
  const FieldEvaluator<> evaluator(scene, surface, {}, frequency_hz);
  const double per_mps = frequency_hz / 299'792'458.0;
  const auto shift = [&](const Vec3& transmitter_mps, const Vec3& receiver_mps) {
    return evaluator.evaluate({{}, 10.0}, {Vec3(0.0), transmitter_mps, {}}, {Vec3(10, 0, 0), receiver_mps, {}})
        .doppler_hz;
  };
  CHECK(shift(Vec3(0.0), Vec3(0.0)) == 0.0);
  CHECK(shift(Vec3(7, 0, 0), Vec3(0.0)) == doctest::Approx(7 * per_mps).epsilon(1e-14));
  CHECK(shift(Vec3(0.0), Vec3(7, 0, 0)) == doctest::Approx(-7 * per_mps).epsilon(1e-14));
  CHECK(shift(Vec3(7, 0, 0), Vec3(7, 0, 0)) == 0.0);
  CHECK(shift(Vec3(0, 9, 3), Vec3(0, -2, 8)) == 0.0);
}

TEST_CASE("Doppler is the rate at which the path shortens, whatever moves and turns") {
  // The lengths of the same sequence a moment earlier and later, solved anew; 1e-5 s and lengths good to 1e-14 m give
  // the rate to 1e-9 m/s plus its third derivative times 1e-10: 1e-6 of the shift and 1e-3 Hz hold both.
  const double dt_s = 1e-5;
  Scene moving;
  {
    TriangleMesh mesh;
    add_sheet(mesh, Vec3(0, 0, 0), Vec3(20, 0, 0), Vec3(0, 20, 0), "wall");
    moving = scene_of(mesh);
    WaypointMotion turning{{{-1.0, {Vec3(1, 4, -1), -0.3, -0.1, 0.05}}, {1.0, {Vec3(2, 3, -0.5), 0.4, 0.2, -0.1}}}};
    moving.add_object("plate", make_box(Vec3(14, 0.4, 6), "glass"), turning);
  }
  TracedScene<> traced(std::move(moving));
  const MaterialTable surface({traced.scene.materials().begin(), traced.scene.materials().end()}, frequency_hz);
  const FieldEvaluator<> evaluator(traced.scene, surface, {}, frequency_hz);
  const Vec3 from_m(-3, -2, 2), to_m(5, -1, 1.5), from_mps(4, 1, -2), to_mps(-3, 6, 1);
  const auto at = [&](double time_s) {
    traced.apply(traced.scene.frame_at(time_s));
    return paths_in(traced, from_m + time_s * from_mps, to_m + time_s * to_mps);
  };
  const std::vector<Path> before = at(-dt_s), after = at(dt_s), now = at(0.0);
  int on_plate = 0;
  for (const Path& path : now) {
    const auto same = [&](const Path& other) { return same_sequence(path, other); };
    const auto earlier = std::find_if(before.begin(), before.end(), same),
               later = std::find_if(after.begin(), after.end(), same);
    REQUIRE(earlier != before.end());
    REQUIRE(later != after.end());
    const double rate_mps = (later->length_m - earlier->length_m) / (2.0 * dt_s);
    const double doppler_hz = evaluator.evaluate(path, {from_m, from_mps, {}}, {to_m, to_mps, {}}).doppler_hz;
    CHECK(std::abs(doppler_hz + rate_mps * frequency_hz / 299'792'458.0) < 1e-3 + 1e-6 * std::abs(doppler_hz));
    for (const Interaction& i : path.interactions) on_plate += traced.scene.facet(i.facet).body != BodyId{};
  }
  CHECK(now.size() >= 3);
  CHECK(on_plate > 0);
}

}  // namespace test_field_evaluator
