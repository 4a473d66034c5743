/// The phase of a path turns at the rate of its Doppler shift; and what two rays make of a drive and of a band of
/// frequencies. All lengths and their rates are written down by hand, with images of points that move.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "dcem/channel/coherence.hpp"
#include "dcem/channel/doppler_spectrum.hpp"
#include "dcem/channel/frequency_response.hpp"
#include "tests/support/law_scenes.hpp"

namespace test_phase_and_doppler {

using namespace dcem;
using namespace dcem::test;

namespace {

constexpr double light_mps = 299'792'458.0, circle_rad = 6.283185307179586477;
constexpr double carrier_wavelength_m = light_mps / law_frequency_hz;

/// A point that moves in a straight line: at + velocity·t.
struct Moving {
  Vec3 at_m, velocity_mps{0.0};
};

/// A plane n·x = offset + speed·t, n a unit vector.
struct MovingPlane {
  Vec3 normal;
  double offset_m = 0.0, speed_mps = 0.0;
};

MovingPlane plane_through(const Vec3& normal, const Moving& point) {
  return {normal, glm::dot(normal, point.at_m), glm::dot(normal, point.velocity_mps)};
}

/// The image moves in a straight line, too.
Moving image(const Moving& point, const MovingPlane& plane) {
  const auto twice = [&](const Vec3& vector, double level) { return 2.0 * (glm::dot(plane.normal, vector) - level); };
  return {point.at_m - twice(point.at_m, plane.offset_m) * plane.normal,
          point.velocity_mps - twice(point.velocity_mps, plane.speed_mps) * plane.normal};
}

/// A distance |r + w·t|. The length of every path here is a sum of such.
struct Stretch {
  Vec3 apart_m, rate_mps;
};

Stretch between(const Moving& one, const Moving& other) {
  return {other.at_m - one.at_m, other.velocity_mps - one.velocity_mps};
}

/// Length and its derivatives at t = 0. With L² = |r + w·t|² and u = r·w/L: L' = u, L''' = −3u(w² − u²)/L².
struct Rates {
  double length_m = 0.0, first_mps = 0.0, third_m_per_s3 = 0.0;
  /// Bound of |L⁽⁵⁾|/5!: √(1 − 2xs + s²) = Σ sⁿ·(P_n(x) − P_(n−2)(x))/(2n − 1), so the fifth coefficient of a stretch
  /// is at most 2/9·|w|⁵/L⁴.
  double fifth_m_per_s5 = 0.0;
};

Rates rates_of(const std::vector<Stretch>& stretches) {
  Rates sum;
  for (const Stretch& stretch : stretches) {
    const double length_m = glm::length(stretch.apart_m), speed_mps = glm::length(stretch.rate_mps);
    const double u = glm::dot(stretch.apart_m, stretch.rate_mps) / length_m;
    sum.length_m += length_m;
    sum.first_mps += u;
    sum.third_m_per_s3 += -3.0 * u * (speed_mps * speed_mps - u * u) / (length_m * length_m);
    sum.fifth_m_per_s5 += 2.0 / 9.0 * std::pow(speed_mps, 5) / std::pow(length_m, 4);
  }
  return sum;
}

Device moving_device(const std::string& id, const Moving& point, PolarizationKind polarization) {
  Device device = device_at(id, point.at_m, 0.0, antenna(polarization));
  device.motion = LinearMotion{{point.at_m}, point.velocity_mps, 0.0};
  return device;
}

/// One path of one link, with its length as a sum of stretches.
struct Walk {
  std::string name;
  Patches scenery;
  std::vector<MovingPatches> objects;
  Moving transmitter, receiver;
  std::string kinds;  ///< of the path
  std::vector<Stretch> stretches;
  PolarizationKind polarization = PolarizationKind::vertical;
  double own_hz = 0.0;        ///< the rate at which the coefficients of the path turn the phase on their own
  double own_bound_hz = 0.0;  ///< how well that is known
};

/// The link of a walk, solved at any instant.
class WalkedLink {
 public:
  explicit WalkedLink(const Walk& walk) : walk_(walk), simulator_(scene(walk), settings()) {}

  PathContribution at(double time_s) {
    const FrameResult frame = simulator_.advance_to(time_s);
    std::vector<Stretch> now = walk_.stretches;
    for (Stretch& stretch : now) stretch.apart_m += time_s * stretch.rate_mps;
    const double length_m = rates_of(now).length_m;
    const PathContribution* found = nullptr;
    for (const PathContribution& path : frame.links.at(0).paths) {
      // 1e-9 m: the images agree to rounding, and different paths differ by centimetres.
      if (kinds(path) != walk_.kinds || std::abs(path.path.length_m - length_m) > 1e-9) continue;
      CHECK(found == nullptr);
      found = &path;
    }
    REQUIRE_MESSAGE(found != nullptr, walk_.name << ": no path of the length that was computed by hand");
    return *found;
  }

  /// (φ(t) − φ(−t))/(2π·2t) at t = 0, from amplitudes alone.
  double phase_rate_hz(double step_s) {
    const Complex after = at(step_s).amplitude, before = at(-step_s).amplitude;
    return std::arg(after / before) / (2.0 * circle_rad * step_s);
  }

 private:
  static Scene scene(const Walk& walk) {
    Scene scene = scene_through_files(walk.scenery, walk.objects);
    scene.add_transmitter(moving_device("tx", walk.transmitter, walk.polarization));
    scene.add_receiver(moving_device("rx", walk.receiver, walk.polarization));
    return scene;
  }
  static SimulationSettings settings() {
    SimulationSettings settings = law_settings(2, 1);
    settings.propagation.max_diffractions = 1;
    return settings;
  }

  Walk walk_;
  Simulator simulator_;
};

/// The phase −kL(t) has the symmetric difference f_D − (dt²/6·L''' + dt⁴/120·L⁽⁵⁾ + …)/λ: an error known in advance, of
/// which halving dt leaves a quarter.
void check_phase_rate(const Walk& walk) {
  CAPTURE(walk.name);
  WalkedLink link(walk);
  const Rates rates = rates_of(walk.stretches);
  const double shift_hz = -rates.first_mps / carrier_wavelength_m;
  // 1e-9 of the shift; a microhertz for one that vanishes.
  CHECK(std::abs(link.at(0.0).doppler_hz - shift_hz) < 1e-9 * std::abs(shift_hz) + 1e-6);
  // The symmetric step spans 2·dt: |f_D|·2dt stays below 0.4.
  const double step_s = std::min(8e-5, 0.2 / std::abs(shift_hz));
  std::vector<double> errors_hz;
  for (const double step : {step_s, 0.5 * step_s, 0.25 * step_s}) {
    const double error_hz = link.phase_rate_hz(step) - shift_hz - walk.own_hz;
    const double second_order_hz = -step * step / 6.0 * rates.third_m_per_s3 / carrier_wavelength_m;
    const double fourth_order_hz = 1.01 * std::pow(step, 4) * rates.fifth_m_per_s5 / carrier_wavelength_m;
    // Lengths of some 30 m are sums of a few doubles rounded at 4e-15 m: 3e-14 m for an image.
    const double rounding_hz = 3e-14 / (step * carrier_wavelength_m);
    CHECK(std::abs(error_hz - second_order_hz) < fourth_order_hz + rounding_hz + walk.own_bound_hz);
    errors_hz.push_back(error_hz);
  }
  // What the coefficients add, if anything, does not depend on dt and drops out of the differences.
  const double fall_hz = errors_hz[0] - errors_hz[1], next_fall_hz = errors_hz[1] - errors_hz[2];
  const double expected_hz = -step_s * step_s / 8.0 * rates.third_m_per_s3 / carrier_wavelength_m;
  const double rounding_hz = 8.0 * 3e-14 / (0.25 * step_s * carrier_wavelength_m);
  if (std::abs(expected_hz) < 100.0 * rounding_hz) return;  // a length that shortens evenly has no error to fall
  CHECK(std::abs(fall_hz - 4.0 * next_fall_hz) < rounding_hz + 0.01 * std::abs(expected_hz));
  CHECK(std::abs(fall_hz - expected_hz) < rounding_hz + 0.01 * std::abs(expected_hz));
}

Patch ground(const std::string& material) {
  return sheet(Vec3(0), Vec3(60, 0, 0), Vec3(0, 60, 0), material);
}

/// A car of 4.4 m x 1.8 m x 1.5 m around its own origin, which stands 0.1 m above what is below.
MovingPatches car(const Vec3& at_m, double yaw_rad, const Vec3& velocity_mps) {
  return {"car", box_faces(Vec3(-2.2, -0.9, 0.1), Vec3(2.2, 0.9, 1.6), "pec"),
          LinearMotion{{at_m, yaw_rad}, velocity_mps, 0.0}};
}

/// The plane of the car's right side (own −y) or rear (own −x), with the normal out of the car.
MovingPlane car_plane(const Vec3& own_normal, double half_m, const MovingPatches& car) {
  const LinearMotion& motion = std::get<LinearMotion>(car.motion);
  const Vec3 normal = rotation_about(Vec3(0, 0, 1), motion.pose.yaw_rad) * own_normal;
  return plane_through(normal, {motion.pose.position_m + half_m * normal, motion.velocity_mps});
}

/// The quadrant x < 0, y < 0 as two metal walls that meet in the z axis, from `low_m` up.
Patches corner(double low_m) {
  return {{{Vec3(0, 0, low_m), Vec3(-40, 0, low_m), Vec3(-40, 0, 30), Vec3(0, 0, 30)}, "pec"},
          {{Vec3(0, 0, low_m), Vec3(0, -40, low_m), Vec3(0, -40, 30), Vec3(0, 0, 30)}, "pec"}};
}

/// The phase of the coefficient of a metal corner for E along the edge, from two ends beside the z axis: four terms
/// cot((π ± β)/2n)·F(X), n = 3/2, X = 2kL·cos²(nπN − β/2), with Keller's F = 1 and what follows for large X:
/// F = 1 + j/2X − 3/4X² (McNamara, Pistorius and Malherbe, ch. 6).
double corner_phase_rad(const Vec3& from_m, const Vec3& to_m) {
  const auto azimuth = [](const Vec3& p) { return 0.5 * circle_rad - std::atan2(p.y, p.x); };  // from the wall along −x
  const double across_from_m = std::hypot(from_m.x, from_m.y), across_to_m = std::hypot(to_m.x, to_m.y);
  const double sine = std::cos(std::atan2(to_m.z - from_m.z, across_from_m + across_to_m));
  // s·s'·sin²/(s + s') with s = across/sin.
  const double distance_m = across_from_m * across_to_m / (across_from_m + across_to_m) * sine;
  const double k = circle_rad / carrier_wavelength_m, n = 1.5, half_turn = 0.5 * circle_rad;
  Complex sum = 0.0;
  for (const double sign_of_from : {-1.0, 1.0}) {
    for (const double side : {1.0, -1.0}) {
      const double beta = azimuth(to_m) + sign_of_from * azimuth(from_m);
      const double turns = std::round((beta + side * half_turn) / (2.0 * n * half_turn));
      const double cosine = std::cos(n * half_turn * turns - 0.5 * beta);
      const double x = 2.0 * k * distance_m * cosine * cosine;
      REQUIRE(x > 20.0);
      // The field along the edge vanishes on the walls: the terms of the mirrors count negative.
      sum += -sign_of_from / std::tan((half_turn + side * beta) / (2.0 * n)) * Complex(1.0 - 0.75 / (x * x), 0.5 / x);
    }
  }
  return std::arg(sum);
}

/// The rate of that phase while ends and edge move.
double corner_rate_hz(const Moving& from, const Moving& to, const Moving& edge) {
  const auto phase_rad = [&](double t) {
    const auto seen = [&](const Moving& p) { return p.at_m - edge.at_m + t * (p.velocity_mps - edge.velocity_mps); };
    return corner_phase_rad(seen(from), seen(to));
  };
  return (phase_rad(1e-4) - phase_rad(-1e-4)) / (2e-4 * circle_rad);
}

/// Reflection at a half space of relative permittivity η, from air, E in the plane of incidence (TM) or across it (TE).
Complex half_space_reflection_by_hand(const Complex& eta, double cosine, bool in_plane) {
  Complex root = std::sqrt(eta - (1.0 - cosine * cosine));
  if (root.imag() > 0.0) root = -root;
  return in_plane ? (eta * cosine - root) / (eta * cosine + root) : (cosine - root) / (cosine + root);
}

/// The permittivity of `half_space` in law_scenes.hpp: 4.4, 0.05 S/m.
Complex ground_permittivity() {
  return {4.4, -0.05 / (circle_rad * law_frequency_hz * 8.8541878128e-12)};
}

// Two rays over a flat ground ---------------------------------------------------------------------------------------

constexpr double mast_m = 12.0, antenna_m = 6.0;

/// A receiver that drives, straight and level, through the field of a mast at the origin over flat ground.
struct Drive {
  std::string material;
  Vec3 at_m, velocity_mps{0.0};  ///< at t = 0; of height 0
};

/// One of the two rays by hand.
struct HandRay {
  double length_m, shift_hz;
  Complex amplitude;

  double delay_s() const { return length_m / light_mps; }
  double power() const { return std::norm(amplitude); }
};

/// The ray to the antenna (height > 0) or to its image under the ground, V to V.
HandRay hand_ray(const Drive& drive, double height_m) {
  const double length_m = std::hypot(drive.at_m.x, drive.at_m.y, mast_m - height_m);
  // −v/λ·cos of the angle between the drive and the direction in which the ray runs.
  const double shift_hz = -glm::dot(drive.at_m, drive.velocity_mps) / length_m / carrier_wavelength_m;
  Complex coefficient = 1.0;
  if (height_m < 0.0) {
    coefficient = drive.material == "pec" ? 1.0 : 0.8;  // a conductor reflects V as it comes; `opaque`: 0.8 of it
    if (drive.material == "half_space")
      coefficient = half_space_reflection_by_hand(ground_permittivity(), (mast_m - height_m) / length_m, true);
  }
  const double cycles = length_m / carrier_wavelength_m;
  return {length_m, shift_hz,
          carrier_wavelength_m / (2.0 * circle_rad * length_m) * coefficient *
              std::polar(1.0, -circle_rad * (cycles - std::floor(cycles)))};
}

std::pair<HandRay, HandRay> hand_rays(const Drive& drive) {
  return {hand_ray(drive, antenna_m), hand_ray(drive, -antenna_m)};
}

Simulator two_ray_simulator(const Drive& drive, double frequency_hz = law_frequency_hz) {
  Scene scene = scene_through_files({sheet(Vec3(0), Vec3(400, 0, 0), Vec3(0, 400, 0), drive.material)});
  scene.add_transmitter(moving_device("tx", {Vec3(0, 0, mast_m)}, PolarizationKind::vertical));
  scene.add_receiver(
      moving_device("rx", {drive.at_m + Vec3(0, 0, antenna_m), drive.velocity_mps}, PolarizationKind::vertical));
  SimulationSettings settings = law_settings(1, 0);
  settings.frequency_hz = frequency_hz;
  return Simulator(std::move(scene), settings);
}

LinkResult two_ray_link(const Drive& drive) {
  LinkResult link = two_ray_simulator(drive).advance_to(0.0).links.at(0);
  REQUIRE(link.paths.size() == 2);
  return link;
}

const std::vector<Drive> drives{{"pec", Vec3(40, 0, 0), Vec3(-30, 0, 0)},
                                {"opaque", Vec3(40, 0, 0), Vec3(30, 0, 0)},
                                {"opaque", Vec3(24, -18, 0), Vec3(-11, 25, 0)},
                                {"half_space", Vec3(-9, 14, 0), Vec3(20, -13, 0)}};

/// The discrete Fourier transform, with Hann's window, at any frequency (Hz).
double magnitude_at(const std::vector<Complex>& values, double step_s, double frequency_hz) {
  Complex sum = 0.0;
  const double count = static_cast<double>(values.size());
  for (std::size_t n = 0; n < values.size(); ++n) {
    const double place = static_cast<double>(n) + 0.5, window = 0.5 - 0.5 * std::cos(circle_rad * place / count);
    sum += window * values[n] * std::polar(1.0, -circle_rad * frequency_hz * step_s * (place - 0.5 * count));
  }
  return std::abs(sum);
}

/// Where the transform is largest within ±reach of a frequency, in steps of a five-hundredth of the resolution.
double peak_hz(const std::vector<Complex>& values, double step_s, double around_hz, double reach_hz) {
  const double grain_hz = 1.0 / (500.0 * step_s * static_cast<double>(values.size()));
  double best_hz = around_hz, best = 0.0;
  for (double frequency_hz = around_hz - reach_hz; frequency_hz <= around_hz + reach_hz; frequency_hz += grain_hz) {
    const double magnitude = magnitude_at(values, step_s, frequency_hz);
    if (magnitude > best) std::tie(best, best_hz) = std::pair(magnitude, frequency_hz);
  }
  return best_hz;
}

const Moving still_mast{Vec3(0, 0, 3)}, driving{Vec3(4, -2, 1.5), Vec3(-17, 29, 2)},
    driving_mast{Vec3(0, 0, 3), Vec3(21, -9, -1)};

}  // namespace

TEST_CASE("phase and Doppler: line of sight with either end or both in motion") {
  const Moving still{driving.at_m};
  for (const auto& [transmitter, receiver] :
       {std::pair(still_mast, driving), std::pair(driving_mast, still), std::pair(driving_mast, driving)}) {
    check_phase_rate({"line of sight", {}, {}, transmitter, receiver, "", {between(transmitter, receiver)}});
  }
}

TEST_CASE("phase and Doppler: through a pane, and through one that moves, which does nothing") {
  const Patch pane = sheet(Vec3(0), Vec3(0.3, 5, 0), Vec3(0, 0, 5), "glass");
  const auto placed = [&](const Vec3& p) { return p + Vec3(2, -1, 2); };
  const MovingPatches curtain{"curtain", {pane}, LinearMotion{{Vec3(2, -1, 2), 0.1}, Vec3(13, 5, 1), 0.0}};
  check_phase_rate(
      {"fixed pane", mapped({pane}, placed), {}, still_mast, driving, "T", {between(still_mast, driving)}});
  check_phase_rate({"moving pane", {}, {curtain}, driving_mast, driving, "T", {between(driving_mast, driving)}});
}

TEST_CASE("phase and Doppler: a fixed mirror, with either end in motion") {
  const MovingPlane plane{Vec3(0, 0, 1)};
  for (const std::string material : {"pec", "opaque"}) {
    for (const auto& [transmitter, receiver] :
         {std::pair(still_mast, driving), std::pair(driving_mast, Moving{driving.at_m}),
          std::pair(driving_mast, driving)}) {
      check_phase_rate({"ground, " + material,
                        {ground(material)},
                        {},
                        transmitter,
                        receiver,
                        "R",
                        {between(image(transmitter, plane), receiver)}});
    }
  }
}

TEST_CASE("phase and Doppler: a mirror that drives; along itself it does nothing") {
  const Moving mast{Vec3(-3, -4, 1.2)}, other{Vec3(2, -5, 0.8)}, walker{Vec3(2, -5, 0.8), Vec3(-6, 11, 0.4)};
  for (const double yaw_rad : {0.0, 0.2}) {
    const Mat3 turn = rotation_about(Vec3(0, 0, 1), yaw_rad);
    // Straight ahead, and in a skid towards the devices.
    for (const Vec3& own_velocity_mps : {Vec3(31, 0, 0), Vec3(24, -9, 0)}) {
      const MovingPatches body = car(Vec3(-0.4, 0.3, 0), yaw_rad, turn * own_velocity_mps);
      const MovingPlane side = car_plane(Vec3(0, -1, 0), 0.9, body);
      CHECK(side.speed_mps == doctest::Approx(-own_velocity_mps.y).epsilon(1e-12));
      for (const auto& [transmitter, receiver] :
           {std::pair(mast, other), std::pair(mast, walker), std::pair(walker, mast)}) {
        check_phase_rate(
            {"side of a car", {}, {body}, transmitter, receiver, "R", {between(image(transmitter, side), receiver)}});
      }
    }
    const MovingPatches ahead = car(turn * Vec3(9, 0.4, 0), yaw_rad, turn * Vec3(31, 0, 0));
    const Moving left{turn * Vec3(1, 2, 1.2)}, right{turn * Vec3(0, -1, 1.0), turn * Vec3(4, 3, 0)};
    const MovingPlane rear = car_plane(Vec3(-1, 0, 0), 2.2, ahead);
    CHECK(rear.speed_mps == doctest::Approx(-31.0).epsilon(1e-12));
    check_phase_rate({"rear of a car", {}, {ahead}, left, right, "R", {between(image(left, rear), right)}});
  }
}

TEST_CASE("phase and Doppler: two mirrors, standing and driving") {
  const Moving mast{Vec3(-3, -4, 1.2)}, walker{Vec3(2, -5, 0.8), Vec3(-6, 11, 0.4)};
  const MovingPatches body = car(Vec3(-0.4, 0.3, 0), 0.2, rotation_about(Vec3(0, 0, 1), 0.2) * Vec3(24, -9, 0));
  const MovingPlane side = car_plane(Vec3(0, -1, 0), 0.9, body), floor{Vec3(0, 0, 1)};
  check_phase_rate({"ground and side",
                    {ground("pec")},
                    {body},
                    mast,
                    walker,
                    "RR",
                    {between(image(image(mast, floor), side), walker)}});
  // A narrow street: one wall along x, one turned by atan(0.1) against it.
  const Patches walls{sheet(Vec3(0, 6, 5), Vec3(40, 0, 0), Vec3(0, 0, 10), "opaque"),
                      sheet(Vec3(0, -6, 5), Vec3(40, 4, 0), Vec3(0, 0, 10), "pec")};
  const MovingPlane north = plane_through(Vec3(0, -1, 0), {Vec3(0, 6, 5)});
  const MovingPlane south = plane_through(glm::normalize(Vec3(-4, 40, 0)), {Vec3(0, -6, 5)});
  check_phase_rate({"north, then south",
                    walls,
                    {},
                    driving_mast,
                    driving,
                    "RR",
                    {between(image(image(driving_mast, north), south), driving)}});
  check_phase_rate({"south, then north",
                    walls,
                    {},
                    driving_mast,
                    driving,
                    "RR",
                    {between(image(image(driving_mast, south), north), driving)}});
}

TEST_CASE("phase and Doppler: round a corner, with ends and corner in motion") {
  const auto walk = [&](const char* name, const Moving& transmitter, const Moving& receiver, const Moving& edge) {
    // All at one height: two straight legs.
    Walk result{name, {}, {}, transmitter, receiver, "D", {between(transmitter, edge), between(edge, receiver)}};
    if (edge.velocity_mps == Vec3(0.0)) {
      result.scenery = corner(-30);
    } else {
      result.objects = {{"house", corner(-30), LinearMotion{{edge.at_m}, edge.velocity_mps, 0.0}}};
    }
    // The coefficient turns, too, by some hundredths of a hertz. The next imaginary term of F is −15/8X³; its rate is
    // 45/4X² of that of 1/2X, and X > 20.
    result.own_hz = corner_rate_hz(transmitter, receiver, edge);
    result.own_bound_hz = 45.0 / 4.0 / 400.0 * std::abs(result.own_hz);
    return result;
  };
  const Moving mast{Vec3(-6, 5, 0)}, shadowed{Vec3(4, -7, 0)}, lit{Vec3(3, 4.5, 0)};
  const Moving edge{Vec3(0.0)}, driving_edge{Vec3(0.0), Vec3(13, 8, 0)};
  const auto with = [](const Moving& point, const Vec3& velocity_mps) { return Moving{point.at_m, velocity_mps}; };
  check_phase_rate(walk("receiver in the shadow", mast, with(shadowed, Vec3(-11, 23, 0)), edge));
  check_phase_rate(walk("lit receiver", mast, with(lit, Vec3(19, -23, 0)), edge));
  check_phase_rate(walk("transmitter", with(mast, Vec3(22, -9, 0)), shadowed, edge));
  check_phase_rate(walk("corner", mast, shadowed, driving_edge));
  check_phase_rate(walk("all three", with(mast, Vec3(22, -9, 0)), with(shadowed, Vec3(-11, 23, 0)), driving_edge));

  // Along the edge the unfolded length is one stretch: the distances from the edge beside the difference of heights.
  const double across_m = std::hypot(6.0, 5.0) + std::hypot(4.0, 7.0);
  const Moving climbing{Vec3(4, -7, 6), Vec3(0, 0, 33)};
  Walk along = walk("along the edge", mast, climbing, edge);
  along.stretches = {{Vec3(across_m, 0, 6), Vec3(0, 0, 33)}};
  check_phase_rate(along);
  // Motion of the corner along its own edge does nothing.
  along = walk("the edge itself moves along", mast, climbing, {Vec3(0.0), Vec3(0, 0, 21)});
  along.stretches = {{Vec3(across_m, 0, 6), Vec3(0, 0, 33)}};
  check_phase_rate(along);
  // Over the ground as well: the image of the mast counts. Unfolded, the path passes the ground at a third of the way
  // and the edge at half of it.
  Walk mixed = walk("ground and edge", {Vec3(-6, 5, -3)}, climbing, edge);
  mixed.transmitter = {Vec3(-6, 5, 3)};
  mixed.scenery = corner(0);
  mixed.scenery.push_back(ground("pec"));
  mixed.stretches = {{Vec3(across_m, 0, 9), Vec3(0, 0, 33)}};
  mixed.kinds = "RD";
  check_phase_rate(mixed);
}

TEST_CASE("phase and Doppler: a lossy mirror near Brewster's angle turns the phase on its own; f_D is that of length") {
  // tan θ = √4.4: there the coefficient of V passes the origin at a short distance.
  const double mast_height_m = 4.0, height_m = 1.0, ground_m = std::sqrt(4.4) * (mast_height_m + height_m);
  const Complex eta = ground_permittivity();
  for (const bool vertical : {true, false}) {
    const Moving mast{Vec3(0, 0, mast_height_m)}, receiver{Vec3(ground_m, 0, height_m), Vec3(-25, 0, 0)};
    Walk walk{"lossy ground",
              {ground("half_space")},
              {},
              mast,
              receiver,
              "R",
              {between(image(mast, {Vec3(0, 0, 1)}), receiver)}};
    walk.polarization = vertical ? PolarizationKind::vertical : PolarizationKind::horizontal;
    WalkedLink link(walk);
    const double step_s = 4e-5;
    double turn_rad = 0.0;
    for (const double side : {1.0, -1.0}) {
      const double length_m = std::hypot(ground_m - side * step_s * 25.0, mast_height_m + height_m);
      const double cosine = (mast_height_m + height_m) / length_m;
      const double cycles = length_m / carrier_wavelength_m;
      turn_rad += side * (std::arg(half_space_reflection_by_hand(eta, cosine, vertical)) - circle_rad * cycles);
    }
    const double turn_hz = turn_rad / (2.0 * circle_rad * step_s);
    const double shift_hz = link.at(0.0).doppler_hz, rate_hz = link.phase_rate_hz(step_s);
    CHECK(shift_hz == doctest::Approx(25.0 / carrier_wavelength_m * std::sqrt(4.4 / 5.4)).epsilon(1e-9));
    // Rounding of lengths as above; the coefficient passes the origin at a few 1e-3, which magnifies its own 1e-16.
    CHECK(std::abs(rate_hz - turn_hz) < 1e-6);
    if (vertical) CHECK(std::abs(rate_hz - shift_hz) > 20.0);
    if (!vertical) CHECK(std::abs(rate_hz - shift_hz) < 0.1);
  }
}

TEST_CASE("phase from frame to frame: half a cycle per step is the limit") {
  // Straight towards the mast: one shift for the whole drive.
  const Moving mast{Vec3(0, 0, 2)}, receiver{Vec3(70, 0, 2), Vec3(-32.0, 0, 0)};
  WalkedLink link({"straight", {}, {}, mast, receiver, "", {between(mast, receiver)}});
  const double shift_hz = 32.0 / carrier_wavelength_m;
  CHECK(shift_hz > 2950.0);
  for (const double cycles : {0.1, 0.4, 0.49, 0.51, 0.9, 1.0, 7.3}) {
    const double step_s = cycles / shift_hz;
    const double seen_cycles = std::arg(link.at(step_s).amplitude / link.at(0.0).amplitude) / circle_rad;
    // k·L of 40,000 rad holds 1e-11 rad; the step is what is left of the cycles after whole ones.
    CHECK(std::abs(seen_cycles - (cycles - std::round(cycles))) < 1e-10);
    CHECK((std::abs(seen_cycles / step_s - shift_hz) < 1e-5) == (cycles < 0.5));
  }
}

TEST_CASE("phase from frame to frame: pictures 10 ms apart do not show a Doppler shift of 3 kHz") {
  const Moving mast{Vec3(0, 0, 8)}, receiver{Vec3(50, 3, 1.5), Vec3(-32.5, 0, 0)};
  WalkedLink link({"past a mast", {}, {}, mast, receiver, "", {between(mast, receiver)}});
  constexpr double frame_s = 0.01;
  Complex before = link.at(0.0).amplitude;
  double length_before_m = link.at(0.0).path.length_m;
  for (int frame = 1; frame <= 20; ++frame) {
    const PathContribution path = link.at(frame * frame_s);
    const double seen_hz = std::arg(path.amplitude / before) / (circle_rad * frame_s);
    const double mean_shift_hz = (length_before_m - path.path.length_m) / (carrier_wavelength_m * frame_s);
    CHECK(path.doppler_hz > 2950.0);
    CHECK(std::abs(seen_hz) <= 50.0);
    CHECK(std::abs(seen_hz - path.doppler_hz) > 2900.0);
    // What was seen is short of the truth by whole cycles per frame: 29 or 30 of them.
    const double lost_cycles = (mean_shift_hz - seen_hz) * frame_s;
    CHECK(std::abs(lost_cycles - std::round(lost_cycles)) < 1e-9);
    CHECK(std::round(lost_cycles) >= 29.0);
    before = path.amplitude;
    length_before_m = path.path.length_m;
  }
}

TEST_CASE("a drive through a two-ray field: the Doppler spectrum has the lines of the two rays, with their powers") {
  for (const Drive& drive : drives) {
    CAPTURE(drive.material);
    const auto [direct, reflected] = hand_rays(drive);
    const LinkResult link = two_ray_link(drive);
    const double bin_hz = 0.25;
    std::vector<DopplerBin> bins = doppler_spectrum(power_samples(link.paths, {}), bin_hz);
    REQUIRE(bins.size() == 2);
    // The reflected ray comes in more steeply: its shift is the smaller one, and its line the one nearer to 0.
    if (std::abs(bins[0].doppler_hz) < std::abs(bins[1].doppler_hz)) std::swap(bins[0], bins[1]);
    CHECK(std::abs(direct.shift_hz) > std::abs(reflected.shift_hz) + 20.0 * bin_hz);
    CHECK(std::abs(bins[0].doppler_hz - direct.shift_hz) < 0.5 * bin_hz + 1e-6);
    CHECK(std::abs(bins[1].doppler_hz - reflected.shift_hz) < 0.5 * bin_hz + 1e-6);
    CHECK(bins[0].power_ratio == doctest::Approx(direct.power()).epsilon(1e-12).scale(0.0));
    CHECK(bins[1].power_ratio == doctest::Approx(reflected.power()).epsilon(1e-12).scale(0.0));
  }
}

TEST_CASE("a drive through a two-ray field: mean and rms spread of delay and Doppler are those of two taps") {
  for (const Drive& drive : drives) {
    CAPTURE(drive.material);
    const auto [direct, reflected] = hand_rays(drive);
    const LinkStatistics statistics = two_ray_link(drive).statistics;
    const double share = direct.power() / (direct.power() + reflected.power()),
                 deviation = std::sqrt(share * (1 - share));
    CHECK(*statistics.mean_doppler_hz ==
          doctest::Approx(share * direct.shift_hz + (1 - share) * reflected.shift_hz).epsilon(1e-11));
    CHECK(*statistics.rms_doppler_spread_hz ==
          doctest::Approx(deviation * std::abs(direct.shift_hz - reflected.shift_hz)).epsilon(1e-10));
    CHECK(*statistics.rms_delay_spread_s ==
          doctest::Approx(deviation * (reflected.delay_s() - direct.delay_s())).epsilon(1e-10).scale(0.0));
  }
}

TEST_CASE("a drive through a two-ray field: the field has its lines there, and its power beats with their difference") {
  // 50 ms at 30 m/s: the beat of 216 Hz drifts by 16 Hz meanwhile, less than the resolution of 20 Hz. The drift is
  // nearly even and the window symmetrical, so the peak is where the shifts are in the middle of the drive.
  const Drive drive = drives.front();
  constexpr std::size_t count = 512;
  constexpr double duration_s = 0.05, step_s = duration_s / count;
  const auto [direct, reflected] = hand_rays(drive);
  Simulator simulator = two_ray_simulator(drive);
  std::vector<Complex> fields, powers;
  double mean_power = 0.0;
  for (std::size_t n = 0; n < count; ++n) {
    const double time_s = (static_cast<double>(n) + 0.5) * step_s - 0.5 * duration_s;
    const LinkResult link = simulator.advance_to(time_s).links.at(0);
    REQUIRE(link.paths.size() == 2);
    fields.push_back(link.paths[0].amplitude + link.paths[1].amplitude);
    const double power = db_to_power_ratio(*link.statistics.path_gain_db);
    CHECK(power == doctest::Approx(std::norm(fields.back())).epsilon(1e-9).scale(0.0));
    powers.emplace_back(power);
    mean_power += power / count;
  }
  for (Complex& power : powers) power -= mean_power;
  const double resolution_hz = 1.0 / duration_s, beat_hz = std::abs(direct.shift_hz - reflected.shift_hz);
  CHECK(beat_hz > 10.0 * resolution_hz);
  CHECK(std::abs(peak_hz(fields, step_s, direct.shift_hz, 2.0 * resolution_hz) - direct.shift_hz) <
        0.05 * resolution_hz);
  CHECK(std::abs(peak_hz(fields, step_s, reflected.shift_hz, 2.0 * resolution_hz) - reflected.shift_hz) <
        0.05 * resolution_hz);
  const double seen_hz = peak_hz(powers, step_s, beat_hz, 3.0 * resolution_hz);
  CHECK(std::abs(seen_hz - beat_hz) < 0.05 * resolution_hz);
  // The beat swings by 2·|h₁·h₂| about P₁ + P₂. A peak that drifts by 0.8 of the resolution is a little lower.
  const double swing = magnitude_at(powers, step_s, seen_hz) * 2.0 / (0.5 * count);
  const double swing_by_hand = 2.0 * std::sqrt(direct.power() * reflected.power());
  CHECK(swing / swing_by_hand == doctest::Approx(1.0).epsilon(0.05));
  CHECK(mean_power / (direct.power() + reflected.power()) == doctest::Approx(1.0).epsilon(0.05));
}

TEST_CASE("a two-ray field over a band: notches every 1/(difference of the delays), where the rays are opposed") {
  const Drive place = drives.front();
  const auto [direct, reflected] = hand_rays(place);
  // Without a difference of nearly equal numbers: d₂ − d₁ = 4·h·h'/(d₁ + d₂).
  const double lag_s = 4.0 * mast_m * antenna_m / (direct.length_m + reflected.length_m) / light_mps;
  const FrequencyGrid grid{law_frequency_hz, 1e9, 2001};
  const std::vector<Complex> response = frequency_response(two_ray_link(place).paths, grid);
  std::vector<double> notches_hz;
  for (std::size_t k = 1; k + 1 < response.size(); ++k) {
    const double below = std::norm(response[k - 1]), here = std::norm(response[k]), above = std::norm(response[k + 1]);
    if (here > below || here >= above) continue;
    const double step_hz = grid.bandwidth_hz / static_cast<double>(grid.points);
    notches_hz.push_back(grid.offset_hz(k) + 0.5 * step_hz * (below - above) / (below - 2.0 * here + above));
    const double depth = std::abs(std::abs(direct.amplitude) - std::abs(reflected.amplitude));
    // Half a step off the notch the rays are out of phase by π·lag·step = 0.018 rad.
    CHECK(std::abs(response[k]) >= depth * (1.0 - 1e-9));
    CHECK(std::abs(response[k]) < depth + 0.02 * std::abs(direct.amplitude));
  }
  CHECK(notches_hz.size() >= 11);
  for (std::size_t n = 0; n < notches_hz.size(); ++n) {
    // Opposed where f·lag is half a cycle from a whole number; the conductor leaves V as it is. A parabola through
    // three points of a cosine, 1/175 of its period apart, finds the minimum to 1e-4 of their distance of 0.5 MHz.
    const double cycles = (law_frequency_hz + notches_hz[n]) * lag_s - 0.5;
    CHECK(std::abs(cycles - std::round(cycles)) < 100.0 * lag_s);
    if (n > 0) CHECK(std::abs(notches_hz[n] - notches_hz[n - 1] - 1.0 / lag_s) < 200.0);
  }
}

TEST_CASE("a two-ray field over a band: the response is what simulations at its frequencies find") {
  // Over a conductor nothing but λ of λ/4πd changes with frequency.
  const Drive place = drives.front();
  const FrequencyGrid grid{law_frequency_hz, 2e9, 9};
  const LinkResult link = two_ray_link(place);
  const std::vector<Complex> response = frequency_response(link.paths, grid);
  for (std::size_t k = 0; k < grid.points; ++k) {
    const LinkResult there = two_ray_simulator(place, grid.frequency_hz(k)).advance_to(0.0).links.at(0);
    const Complex field = there.paths.at(0).amplitude + there.paths.at(1).amplitude;
    const Complex expected = response[k] * (law_frequency_hz / grid.frequency_hz(k));
    // Phases of 26,000 rad hold 1e-11 rad.
    CHECK(std::abs(field - expected) < 1e-10 * std::abs(link.paths[0].amplitude));
  }
}

TEST_CASE("a two-ray field: coherence bandwidth and time are those of two taps") {
  for (const Drive& drive : drives) {
    CAPTURE(drive.material);
    const auto [direct, reflected] = hand_rays(drive);
    const double share = direct.power() / (direct.power() + reflected.power());
    const std::vector<PowerSample> samples = power_samples(two_ray_link(drive).paths, {});
    for (const double level : {0.1, 0.5, 0.7, 0.9}) {
      CAPTURE(level);
      const std::optional<double> bandwidth_hz = coherence_bandwidth_hz(samples, level);
      const std::optional<double> time_s = coherence_time_s(samples, level);
      // |p + q·e^{jx}|² = p² + q² + 2pq·cos x = level².
      const double cosine = (level * level - share * share - (1 - share) * (1 - share)) / (2.0 * share * (1 - share));
      REQUIRE(bandwidth_hz.has_value() == (cosine > -1.0));
      REQUIRE(time_s.has_value() == (cosine > -1.0));
      if (cosine <= -1.0) continue;
      const double cycles = std::acos(cosine) / circle_rad;
      CHECK(*bandwidth_hz == doctest::Approx(cycles / (reflected.delay_s() - direct.delay_s())).epsilon(1e-10));
      CHECK(*time_s ==
            doctest::Approx(cycles / std::abs(direct.shift_hz - reflected.shift_hz)).epsilon(1e-10).scale(0.0));
    }
  }
}

}  // namespace test_phase_and_doppler
