/// The channel between the elements of arrays: a path of its own for each pair of elements against plane waves from the
/// centres, against antennas that stand alone where the elements stand, and against closed forms.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "dcem/sim/verify/verifier.hpp"
#include "tests/support/law_scenes.hpp"

namespace test_array_elements {

using namespace dcem;
using namespace dcem::test;

namespace {

constexpr double light_mps = 299'792'458.0, circle_rad = 6.283185307179586477;
constexpr double frequency_hz = 30e9, carrier_wavelength_m = light_mps / frequency_hz;
constexpr double carrier_rad_per_m = circle_rad / carrier_wavelength_m;

SimulationSettings array_settings(ArrayChannel mode, int reflections, int transmissions = 0, int diffractions = 0) {
  SimulationSettings settings = law_settings(reflections, transmissions);
  settings.frequency_hz = frequency_hz;
  settings.propagation.max_diffractions = diffractions;
  settings.propagation.antenna_array = mode;
  return settings;
}

Antenna array_of(std::size_t rows, std::size_t columns, PolarizationKind kind = PolarizationKind::vertical,
                 const Orientation& turned = {}, double spacing_wavelengths = 0.5) {
  Antenna result = antenna(kind);
  result.orientation = turned;
  result.array = {rows, columns, spacing_wavelengths};
  return result;
}

/// Turned by yaw, then pitch (nose down), then roll, each about an axis of its own.
Mat3 turn_by_hand(const Orientation& turned) {
  const Mat3 yaw = rotation_about(Vec3(0, 0, 1), turned.yaw_rad);
  const Mat3 pitch = rotation_about(yaw * Vec3(0, 1, 0), turned.pitch_rad) * yaw;
  return rotation_about(pitch * Vec3(1, 0, 0), turned.roll_rad) * pitch;
}

/// Where an element stands from the centre: rows from below, each row from the smallest local y, local x ahead.
Vec3 element_place_m(const Antenna& antenna, std::size_t element) {
  const auto [rows, columns, spacing_wavelengths] = antenna.array;
  const double spacing_m = spacing_wavelengths * carrier_wavelength_m;
  const double right_m = 0.5 * spacing_m * static_cast<double>(columns - 1);
  const double below_m = 0.5 * spacing_m * static_cast<double>(rows - 1);
  return turn_by_hand(antenna.orientation) * Vec3(0, static_cast<double>(element % columns) * spacing_m - right_m,
                                                  static_cast<double>(element / columns) * spacing_m - below_m);
}

/// The same device with one element alone.
Device element_alone(const Device& device, std::size_t element, const Vec3& place_m) {
  Device alone = device;
  alone.id += "_" + std::to_string(element);
  alone.antenna.array = {};
  if (alone.attachment) {
    alone.attachment->offset_m += place_m;
  } else {
    std::get<LinearMotion>(alone.motion).pose.position_m += place_m;
  }
  return alone;
}

std::vector<PathContribution> paths_of(Scene scene, const Device& transmitter, const Device& receiver,
                                       const SimulationSettings& settings) {
  scene.add_transmitter(transmitter);
  scene.add_receiver(receiver);
  return std::move(Simulator(std::move(scene), settings).advance_to(0.0).links.at(0).paths);
}

/// Mirrors and edges, without the sheets that a path crosses: those may differ from element to element.
std::vector<std::pair<char, std::uint32_t>> touches(const PathContribution& path, bool backwards = false) {
  std::vector<std::pair<char, std::uint32_t>> result;
  for (const Interaction& one : path.path.interactions) {
    if (one.kind == InteractionKind::transmission) continue;
    const bool is_edge = one.kind == InteractionKind::diffraction;
    result.emplace_back(static_cast<char>(one.kind), is_edge ? one.wedge.value : one.facet.value);
  }
  if (backwards) std::reverse(result.begin(), result.end());
  return result;
}

const PathContribution* find_path(const std::vector<PathContribution>& paths,
                                  const std::vector<std::pair<char, std::uint32_t>>& wanted, bool backwards = false) {
  for (const PathContribution& path : paths) {
    if (touches(path, backwards) == wanted) return &path;
  }
  return nullptr;
}

/// A street: metal ground, a house front and a fence of constant reflection.
Patches street() {
  return {sheet(Vec3(0), Vec3(500, 0, 0), Vec3(0, 200, 0), "pec"),
          sheet(Vec3(0, 15, 10), Vec3(450, 0, 0), Vec3(0, 0, 10), "opaque"),
          sheet(Vec3(0, -12, 6), Vec3(450, 3, 0), Vec3(0, 0, 6), "alpha")};
}

/// A yard with all that a path can meet: ground, walls, panes, and a house with corners.
Patches yard() {
  Patches patches{sheet(Vec3(0), Vec3(30, 0, 0), Vec3(0, 30, 0), "half_space"),
                  sheet(Vec3(0, 9, 3), Vec3(15, 2, 0), Vec3(0, 0, 3), "wall"),
                  sheet(Vec3(1, -1, 1.5), Vec3(1.3, 1, 0.2), Vec3(0, 0.3, 1.4), "lossy")};
  for (const Patch& face : box_faces(Vec3(3, -5, 0.01), Vec3(6, -0.7, 4), "pec")) patches.push_back(face);
  return patches;
}

Device posed(const std::string& id, const Vec3& position_m, const Antenna& antenna) {
  return device_at(id, position_m, 3.0, antenna);
}

/// A car with both ends of a link to a mast, in a bend.
Scene car_and_mast(const Antenna& on_roof, const Antenna& on_mast, bool sees_own_body) {
  WaypointMotion bend;
  bend.waypoints = {{0.0, {Vec3(-6, -2, 0), 0.3}}, {1.0, {Vec3(1, 1, 0.2), 1.9, -0.1, 0.05}}};
  Scene scene = scene_through_files({sheet(Vec3(0), Vec3(60, 0, 0), Vec3(0, 60, 0), "half_space"),
                                     sheet(Vec3(0, 9, 3), Vec3(15, 2, 0), Vec3(0, 0, 3), "wall")},
                                    {{"car", box_faces(Vec3(-2.2, -0.9, 0.1), Vec3(2.2, 0.9, 1.5), "pec"), bend}});
  Device roof = device_at("roof", Vec3(0.0), 0.0, on_roof);
  roof.attachment = Attachment{"car", Vec3(-0.4, 0.2, 1.62), sees_own_body};
  Device mast = device_at("mast", Vec3(9, -4, 5), 0.0, on_mast);
  scene.add_transmitter(mast);
  scene.add_receiver(roof);
  return scene;
}

std::string channel_bits(const LinkResult& link) {
  std::string bytes;
  for (const PathContribution& path : link.paths) {
    for (std::size_t row = 0; row < path.channel.rows(); ++row) {
      for (std::size_t column = 0; column < path.channel.columns(); ++column)
        append_bits(bytes, {path.channel(row, column).real(), path.channel(row, column).imag()});
    }
  }
  return bytes;
}

/// All entries of `found` are those of antennas that stand alone at the places of the elements, added to `scene`.
/// Returns the number of entries that are not zero, and that of zeros.
struct Entries {
  std::size_t there = 0, zero = 0;
};

Entries check_against_single_antennas(const Scene& scene, const Device& transmitter, const Device& receiver,
                                      const SimulationSettings& settings, double time_s = 0.0) {
  Scene with_arrays = scene, with_singles = scene;
  with_arrays.add_transmitter(transmitter);
  with_arrays.add_receiver(receiver);
  const std::size_t from_size = transmitter.antenna.array.size(), to_size = receiver.antenna.array.size();
  for (std::size_t from = 0; from < from_size; ++from)
    with_singles.add_transmitter(element_alone(transmitter, from, element_place_m(transmitter.antenna, from)));
  for (std::size_t to = 0; to < to_size; ++to)
    with_singles.add_receiver(element_alone(receiver, to, element_place_m(receiver.antenna, to)));
  Simulator arrays(std::move(with_arrays), settings), singles(std::move(with_singles), settings);
  const std::vector<PathContribution> paths = arrays.advance_to(time_s).links.at(0).paths;
  const FrameResult alone = singles.advance_to(time_s);
  REQUIRE(alone.links.size() == from_size * to_size);
  const std::size_t out_ports = receiver.antenna.port_count(), in_ports = transmitter.antenna.port_count();
  Entries entries;
  for (const PathContribution& path : paths) {
    CAPTURE(kinds(path));
    REQUIRE(path.channel.rows() == to_size * out_ports);
    REQUIRE(path.channel.columns() == from_size * in_ports);
    // 1e-12, and k times lengths to an element whose place is rounded at 2e-15 m here and there, some of it magnified
    // by flat angles; a sector has 8 dBi.
    const double tolerance = 2.52 * (1e-12 + carrier_rad_per_m * 8e-15) * std::sqrt(norm_squared(path.transfer));
    for (std::size_t from = 0; from < from_size; ++from) {
      for (std::size_t to = 0; to < to_size; ++to) {
        const PathContribution* single = find_path(alone.links[from * to_size + to].paths, touches(path));
        (single != nullptr ? entries.there : entries.zero) += 1;
        for (std::size_t out = 0; out < out_ports; ++out) {
          for (std::size_t in = 0; in < in_ports; ++in) {
            const Complex found = path.channel(to * out_ports + out, from * in_ports + in);
            CHECK(std::abs(found - (single != nullptr ? single->ports(out, in) : Complex{})) <= tolerance);
            if (single == nullptr) CHECK(found == Complex{});
          }
        }
      }
    }
  }
  return entries;
}

}  // namespace

TEST_CASE("array elements: a plane wave is off by k r²/2L at most, L unfolded, over line of sight and mirrors") {
  // The far end, or its image, is D = L·d away from the centre, and |D − r| from an element displaced by r. With a = L
  // − r·d, which is the length that a plane wave has, and b² = r² − (r·d)²: |D − r| = √(a² + b²), so the plane wave is
  // too short by √(a² + b²) − a, which lies between 0 and b²/2a ≤ r²/(2(L − r)). The amplitude goes with 1/|D − r| in
  // place of 1/L: off by r/(L − r) at most. (Mirrors upright or level, of constant coefficient, leave V to V as it is
  // but for the coefficient: nothing else depends on the direction.)
  const Antenna panel = array_of(8, 8);
  for (const Vec3& far_m : {Vec3(100, 3, 1.5), Vec3(60, -8, 17)}) {
    const Device transmitter = posed("tx", Vec3(0, 0, 10), panel), receiver = posed("rx", far_m, antenna({}));
    const Scene scene = scene_through_files(street());
    const auto exact = paths_of(scene, transmitter, receiver, array_settings(ArrayChannel::exact, 2));
    const auto plane = paths_of(scene, transmitter, receiver, array_settings(ArrayChannel::plane_wave, 2));
    REQUIRE(exact.size() == plane.size());
    REQUIRE(exact.size() >= 6);
    for (std::size_t path = 0; path < exact.size(); ++path) {
      CAPTURE(kinds(exact[path]));
      REQUIRE(touches(exact[path]) == touches(plane[path]));
      const double length_m = exact[path].path.length_m;
      const auto [azimuth_rad, zenith_rad] = exact[path].departure;
      const Vec3 direction(std::sin(zenith_rad) * std::cos(azimuth_rad), std::sin(zenith_rad) * std::sin(azimuth_rad),
                           std::cos(zenith_rad));
      double largest_rad = 0.0, bound_rad = 0.0;
      for (std::size_t element = 0; element < 64; ++element) {
        const Vec3 place_m = element_place_m(panel, element);
        const double r_m = glm::length(place_m), along_m = length_m - glm::dot(place_m, direction);
        const double across_m = glm::length(glm::cross(place_m, direction));
        const Complex quotient = exact[path].channel(0, element) / plane[path].channel(0, element);
        // k times lengths rounded at some 3e-14 m.
        const double rounding_rad = 3e-11;
        const double own_bound_rad = carrier_rad_per_m * r_m * r_m / (2.0 * (length_m - r_m));
        CHECK(std::arg(quotient) <= rounding_rad);
        CHECK(std::arg(quotient) >= -own_bound_rad - rounding_rad);
        CHECK(std::abs(std::abs(quotient) - 1.0) <= r_m / (length_m - r_m) + 1e-12);
        // √(a² + b²) − a, written without a difference of nearly equal numbers; and the amplitude itself.
        const double element_length_m = std::hypot(along_m, across_m);
        const double lag_m = across_m * across_m / (element_length_m + along_m);
        CHECK(std::abs(std::arg(quotient) + carrier_rad_per_m * lag_m) < rounding_rad);
        CHECK(std::abs(quotient) == doctest::Approx(length_m / element_length_m).epsilon(1e-12));
        largest_rad = std::max(largest_rad, std::abs(std::arg(quotient)));
        bound_rad = std::max(bound_rad, own_bound_rad);
      }
      // Nearly broadside the bound is reached; at 30 degrees from there the plane wave is short by cos² of less.
      CHECK(largest_rad > 0.6 * bound_rad);
      CHECK(bound_rad < 3.5e-3);  // 1.9e-3 at 100 m
    }
  }
}

TEST_CASE("array elements: what a plane wave leaves out falls as one over the distance") {
  const Antenna panel = array_of(8, 8);
  const Vec3 direction = glm::normalize(Vec3(5, 2, -1));
  const auto largest_rad = [&](double distance_m) {
    const Device transmitter = posed("tx", Vec3(0, 0, 10), panel);
    const Device receiver = posed("rx", Vec3(0, 0, 10) + distance_m * direction, antenna({}));
    const auto exact = paths_of(Scene(), transmitter, receiver, array_settings(ArrayChannel::exact, 0));
    const auto plane = paths_of(Scene(), transmitter, receiver, array_settings(ArrayChannel::plane_wave, 0));
    double largest = 0.0;
    for (std::size_t element = 0; element < 64; ++element)
      largest = std::max(largest, std::abs(std::arg(exact[0].channel(0, element) / plane[0].channel(0, element))));
    return largest;
  };
  const double near = largest_rad(2.0) * 2.0;
  for (const double distance_m : {4.0, 20.0, 100.0, 400.0}) {
    // The next order is r/L of it, 0.025 m over 2 m; far away phases of 3e5 rad are rounded at 6e-11.
    CHECK(largest_rad(distance_m) * distance_m / near ==
          doctest::Approx(1.0).epsilon(0.025 + 1e-10 * distance_m * distance_m));
  }
}

TEST_CASE("array elements: over an edge the wave is as curved as if it came from there") {
  // A displacement across the edge by b changes the distance s to the edge alone: the plane wave is off by b²/2s, not
  // by b²/2L. Here the corner of a house is 1.5 m from an upright one-row array and 40 m from the other end.
  const Patches house{{{Vec3(0, 0, -30), Vec3(-40, 0, -30), Vec3(-40, 0, 30), Vec3(0, 0, 30)}, "pec"},
                      {{Vec3(0, 0, -30), Vec3(0, -40, -30), Vec3(0, -40, 30), Vec3(0, 0, 30)}, "pec"}};
  const double near_wall_rad = circle_rad / 24.0;  // 15 degrees from the walls on both sides: deep in the shadow
  const Vec3 near_m = 1.5 * Vec3(-std::cos(near_wall_rad), std::sin(near_wall_rad), 0);
  const Vec3 far_m = 40.0 * Vec3(std::sin(near_wall_rad), -std::cos(near_wall_rad), 0);
  const Antenna row = array_of(1, 8);
  const Device transmitter = posed("tx", near_m, row), receiver = posed("rx", far_m, antenna({}));
  const Scene scene = scene_through_files(house);
  const auto exact = paths_of(scene, transmitter, receiver, array_settings(ArrayChannel::exact, 0, 0, 1));
  const auto plane = paths_of(scene, transmitter, receiver, array_settings(ArrayChannel::plane_wave, 0, 0, 1));
  REQUIRE(exact.size() == 1);
  REQUIRE(kinds(exact[0]) == "D");
  const Vec3 direction = glm::normalize(-near_m);
  for (std::size_t element = 0; element < 8; ++element) {
    const Vec3 place_m = element_place_m(row, element);
    const double along_m = 1.5 - glm::dot(place_m, direction);
    const double across_m = glm::length(glm::cross(place_m, direction));
    const double lag_m = across_m * across_m / (std::hypot(along_m, across_m) + along_m);
    const double off_rad = std::arg(exact[0].channel(0, element) / plane[0].channel(0, element));
    // The coefficient's own phase is that of F = 1 + j/2X, X > 400: 1e-3 rad, of which 0.7 degrees change a few
    // percent.
    CHECK(std::abs(off_rad + carrier_rad_per_m * lag_m) < 1e-4);
    const double by_whole_length_rad = carrier_rad_per_m * across_m * across_m / (2.0 * exact[0].path.length_m);
    if (element == 0 || element == 7) CHECK(std::abs(off_rad) > 20.0 * by_whole_length_rad);
  }
}

TEST_CASE("array elements: two rays over lossy ground to every element, in closed form") {
  // V to V: λ/4πd·e^{−jkd}, and the same of the image times R_TM; H to H: minus the first, and minus R_TE.
  const Complex eta(4.4, -0.05 / (circle_rad * frequency_hz * 8.8541878128e-12));
  const Vec3 centre_m(0, 0, 4), far_m(17, 6, 1.5);
  for (const bool vertical : {true, false}) {
    const PolarizationKind kind = vertical ? PolarizationKind::vertical : PolarizationKind::horizontal;
    const Antenna panel = array_of(4, 2, kind, {0.5 * circle_rad});
    const Scene scene = scene_through_files({sheet(Vec3(0), Vec3(60, 0, 0), Vec3(0, 60, 0), "half_space")});
    const auto paths = paths_of(scene, posed("tx", centre_m, panel), posed("rx", far_m, antenna(kind)),
                                array_settings(ArrayChannel::exact, 1));
    REQUIRE(paths.size() == 2);
    for (std::size_t element = 0; element < 8; ++element) {
      const Vec3 from_m = centre_m + element_place_m(panel, element);
      for (const double height_m : {far_m.z, -far_m.z}) {
        const double length_m = std::hypot(far_m.x - from_m.x, far_m.y - from_m.y, from_m.z - height_m);
        const double cosine = (from_m.z - height_m) / length_m;
        const Complex root = std::sqrt(eta - (1.0 - cosine * cosine));  // Im η < 0: so is that of the principal root
        const Complex te = (cosine - root) / (cosine + root), tm = (eta * cosine - root) / (eta * cosine + root);
        const Complex coefficient = height_m > 0.0 ? (vertical ? 1.0 : -1.0) : (vertical ? tm : -te);
        const Complex expected = carrier_wavelength_m / (2.0 * circle_rad * length_m) * coefficient *
                                 std::polar(1.0, -std::fmod(carrier_rad_per_m * length_m, circle_rad));
        const Complex found = paths[height_m > 0.0 ? 0 : 1].channel(0, element);
        // k times lengths rounded at 2e-14 m.
        CHECK(std::abs(found - expected) < 2e-11 * std::abs(expected) + 1e-15);
      }
    }
  }
}

TEST_CASE("array elements: exact is what antennas find that stand alone where the elements stand") {
  const Scene scene = scene_through_files(yard());
  Antenna sector = array_of(2, 2, PolarizationKind::dual, {0.2, -0.1, 0.3});
  sector.pattern = Tr38901Element{};
  const Antenna row = array_of(1, 4, PolarizationKind::slant, {2.9, 0.1, 0.4}, 0.7);
  const SimulationSettings settings = array_settings(ArrayChannel::exact, 2, 2, 1);
  std::size_t there = 0;
  // In the open, behind the pane, and behind the house.
  for (const Vec3& far_m : {Vec3(1, 6, 1.4), Vec3(2.6, -2.1, 1.2), Vec3(8, -3, 1.7)}) {
    there +=
        check_against_single_antennas(scene, posed("tx", Vec3(-6, 1, 3), sector), posed("rx", far_m, row), settings)
            .there;
    // And the other way round, so that arrays of either shape are at either end.
    there +=
        check_against_single_antennas(scene, posed("tx", far_m, row), posed("rx", Vec3(-6, 1, 3), sector), settings)
            .there;
  }
  CHECK(there > 16 * 30);
}

TEST_CASE("array elements: in rooms, and 20 wavelengths apart so that walls and rims come between, it is the same") {
  Entries entries;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    CAPTURE(seed);
    const RandomRoom room = seed % 2 == 1 ? random_room(seed, 2, 1) : furnished_room(seed);
    Antenna sector = array_of(2, 2, PolarizationKind::dual, {0.2, -0.1, 0.3}, 20.0);
    sector.pattern = Tr38901Element{};
    const Entries found = check_against_single_antennas(
        scene_through_files(room.patches), posed("tx", room.transmitter_m, sector),
        posed("rx", room.receiver_m, array_of(1, 3, PolarizationKind::slant, {2.9, 0.1, 0.4}, 0.7)),
        array_settings(ArrayChannel::exact, 2, 2, 1));
    entries.there += found.there;
    entries.zero += found.zero;
  }
  CHECK(entries.there > 3000);
  CHECK(entries.zero > 100);
}

TEST_CASE("array elements: of a dual array the ports follow each other within an element, at both ends") {
  const Scene scene = scene_through_files(street());
  const Device transmitter = posed("tx", Vec3(0, 0, 10), array_of(2, 2, PolarizationKind::dual, {0.3, 0.2, 0.4}));
  const Device receiver = posed("rx", Vec3(20, 4, 2), array_of(1, 3, PolarizationKind::dual, {3.0, 0.0, -0.7}));
  for (const ArrayChannel mode : {ArrayChannel::plane_wave, ArrayChannel::exact}) {
    const auto paths = paths_of(scene, transmitter, receiver, array_settings(mode, 1));
    REQUIRE(paths.size() == 4);
    for (const PathContribution& path : paths) {
      REQUIRE(path.channel.rows() == 3 * 2);
      REQUIRE(path.channel.columns() == 4 * 2);
      for (std::size_t to = 0; to < 3; ++to) {
        for (std::size_t from = 0; from < 4; ++from) {
          // All four couplings of a pair of elements have one phase against those of the centres; the middle element of
          // the receiver is its centre. Directions differ by r/L < 1e-3, and with them the couplings.
          const Complex phase = path.channel(2 * to, 2 * from) / path.ports(0, 0);
          for (std::size_t port = 1; port < 4; ++port) {
            const Complex entry = path.channel(2 * to + port / 2, 2 * from + port % 2);
            CHECK(std::abs(entry - phase * path.ports(port / 2, port % 2)) <
                  4e-3 * std::sqrt(norm_squared(path.ports)));
          }
        }
      }
      // The couplings differ, or the order of the ports would not show.
      const double along = std::abs(path.ports(0, 0) - path.ports(1, 1));
      const double across = std::abs(path.ports(0, 1) - path.ports(1, 0));
      CHECK(std::max(along, across) > 0.1 * std::sqrt(norm_squared(path.ports)));
    }
  }
}

TEST_CASE("array elements: an array that is turned to the left by a right angle has its columns along -x") {
  // Local y points to -x. Far away along x the columns lie one behind the other: the first is the closest.
  const double spacing_m = 0.5 * carrier_wavelength_m;
  for (const ArrayChannel mode : {ArrayChannel::plane_wave, ArrayChannel::exact}) {
    for (const bool by_pose : {true, false}) {
      Device transmitter = posed("tx", Vec3(0, 0, 2), array_of(2, 3));
      const double right_angle_rad = 0.25 * circle_rad;
      if (by_pose) std::get<LinearMotion>(transmitter.motion).pose.yaw_rad = right_angle_rad;
      if (!by_pose) transmitter.antenna.orientation.yaw_rad = right_angle_rad;
      const auto paths =
          paths_of(Scene(), transmitter, posed("rx", Vec3(30, 0, 2), antenna({})), array_settings(mode, 0));
      for (std::size_t element = 0; element < 6; ++element) {
        const double x_m = spacing_m * (1.0 - static_cast<double>(element % 3));
        const double z_m = spacing_m * (static_cast<double>(element / 3) - 0.5);
        const double length_m = mode == ArrayChannel::exact ? std::hypot(30.0 - x_m, z_m) : 30.0 - x_m;
        const double turn_rad = std::arg(paths[0].channel(0, element) / paths[0].amplitude);
        const double expected_rad = -carrier_rad_per_m * (length_m - 30.0);
        // Lengths rounded at 4e-15 m.
        CHECK(std::abs(std::remainder(turn_rad - expected_rad, circle_rad)) < 1e-11);
      }
    }
  }
}

TEST_CASE("array elements: on a car in a bend exact is what single antennas find that ride where the elements ride") {
  Antenna panel = array_of(2, 2, PolarizationKind::dual, {1.2, 0.2, -0.4});
  panel.pattern = Tr38901Element{};
  const Antenna row = array_of(1, 4, PolarizationKind::right_circular, {2.4, 0.3, 0.0});
  for (const bool sees_own_body : {false, true}) {
    const Scene scene = car_and_mast(panel, row, sees_own_body);
    const Device mast = scene.transmitters()[0], roof = scene.receivers()[0];
    Scene without_devices = scene_through_files(
        {sheet(Vec3(0), Vec3(60, 0, 0), Vec3(0, 60, 0), "half_space"),
         sheet(Vec3(0, 9, 3), Vec3(15, 2, 0), Vec3(0, 0, 3), "wall")},
        {{"car", box_faces(Vec3(-2.2, -0.9, 0.1), Vec3(2.2, 0.9, 1.5), "pec"), scene.bodies()[1].motion}});
    Entries entries;
    for (const double time_s : {0.0, 0.31, 0.77}) {
      const Entries now = check_against_single_antennas(without_devices, mast, roof,
                                                        array_settings(ArrayChannel::exact, 2, 1, 1), time_s);
      entries.there += now.there;
      entries.zero += now.zero;
    }
    CHECK(entries.there >= 3 * 16 * 2);
  }
}

TEST_CASE("array elements: behind the edge of a screen, and beside the rim of a mirror, elements hear nothing") {
  // Eight elements along y, 5 mm apart. Half way to the receiver on the x axis their rays are y/2 off that axis.
  const Antenna row = array_of(1, 8);
  const Device transmitter = posed("tx", Vec3(0, 0, 5), row), receiver = posed("rx", Vec3(20, 0, 5), antenna({}));
  const double rim_m =
      -0.5 * 1.0 * carrier_wavelength_m;  // between the rays of elements at −0.75 and −1.25 wavelengths
  const Patch screen = sheet(Vec3(10, rim_m - 2.0, 5), Vec3(0, 2, 0), Vec3(0, 0, 3), "pec");
  const auto exact =
      paths_of(scene_through_files({screen}), transmitter, receiver, array_settings(ArrayChannel::exact, 0));
  const auto plane =
      paths_of(scene_through_files({screen}), transmitter, receiver, array_settings(ArrayChannel::plane_wave, 0));
  REQUIRE(exact.size() == 1);
  for (std::size_t element = 0; element < 8; ++element) {
    const double y_m = element_place_m(row, element).y;
    CHECK((exact[0].channel(0, element) == Complex{}) == (0.5 * y_m < rim_m));
    CHECK(plane[0].channel(0, element) != Complex{});
  }
  CHECK(exact[0].channel(0, 1) == Complex{});
  CHECK(exact[0].channel(0, 2) != Complex{});
  // Behind the rim of a pane of 5 dB the rays of the same elements cross it.
  Patch pane = screen;
  pane.material = "glass";
  const auto through =
      paths_of(scene_through_files({pane}), transmitter, receiver, array_settings(ArrayChannel::exact, 0, 1));
  REQUIRE(through.size() == 1);
  for (std::size_t element = 0; element < 8; ++element) {
    const double loss_db = 20.0 * std::log10(std::abs(plane[0].channel(0, element) / through[0].channel(0, element)));
    CHECK(loss_db == doctest::Approx(element < 2 ? 5.0 : 0.0).epsilon(1e-4));  // 1/L of 1/(L + 1e-5 m)
  }
  // A mirror in the plane z = 0, and its rim where the ray of an element at 1 wavelength would touch it.
  const Patch mirror = sheet(Vec3(10, -rim_m - 2.0, 0), Vec3(3, 0, 0), Vec3(0, 2, 0), "pec");
  const auto mirrored =
      paths_of(scene_through_files({mirror}), transmitter, receiver, array_settings(ArrayChannel::exact, 1));
  REQUIRE(mirrored.size() == 2);
  for (std::size_t element = 0; element < 8; ++element) {
    CHECK(mirrored[0].channel(0, element) != Complex{});
    CHECK((mirrored[1].channel(0, element) == Complex{}) == (0.5 * element_place_m(row, element).y > -rim_m));
  }
}

TEST_CASE("array elements: exchanging the ends transposes the channel") {
  const Scene scene = scene_through_files(yard());
  Antenna sector = array_of(2, 2, PolarizationKind::dual, {0.2, -0.1, 0.3});
  sector.pattern = Tr38901Element{};
  const Device one = posed("one", Vec3(-6, 1, 3), sector);
  std::size_t compared = 0;
  for (const Vec3& far_m : {Vec3(1, 6, 1.4), Vec3(2.6, -2.1, 1.2), Vec3(8, -3, 1.7)}) {
    const Device other = posed("other", far_m, array_of(1, 3, PolarizationKind::left_circular, {2.9, 0.1, 0.4}, 0.7));
    for (const ArrayChannel mode : {ArrayChannel::plane_wave, ArrayChannel::exact}) {
      const auto there = paths_of(scene, one, other, array_settings(mode, 2, 2, 1));
      const auto back = paths_of(scene, other, one, array_settings(mode, 2, 2, 1));
      CHECK(there.size() == back.size());
      for (const PathContribution& path : there) {
        const PathContribution* reversed = find_path(back, touches(path), true);
        REQUIRE(reversed != nullptr);
        REQUIRE(path.channel.rows() == reversed->channel.columns());
        REQUIRE(path.channel.columns() == reversed->channel.rows());
        ++compared;
        for (std::size_t row = 0; row < path.channel.rows(); ++row) {
          for (std::size_t column = 0; column < path.channel.columns(); ++column) {
            // Coefficients to 1e-12; k times lengths that are summed the other way round. The sectors have 8 dBi.
            CHECK(std::abs(path.channel(row, column) - reversed->channel(column, row)) <
                  2.52 * (1e-12 + carrier_rad_per_m * 1.5e-14) * std::sqrt(norm_squared(path.transfer)));
          }
        }
      }
    }
  }
  CHECK(compared > 60);
}

TEST_CASE("array elements: equal weights make the beam of the array factor, sin(Nx)/sin(x)") {
  // x = π·s·sin(azimuth) along the columns, π·s·cos(zenith) along the rows.
  const Antenna panel = array_of(3, 16, PolarizationKind::vertical, {}, 0.6);
  const double distance_m = 100.0, half_turn = 0.5 * circle_rad;
  double deepest = 1.0, highest = 0.0;
  const auto line = [](double count, double x) {
    return std::abs(std::sin(x)) < 1e-9 ? count : std::abs(std::sin(count * x) / std::sin(x));
  };
  for (int azimuth_deg = -80; azimuth_deg <= 80; azimuth_deg += 4) {
    for (const double zenith_deg : {60.0, 90.0, 115.0}) {
      const double azimuth = azimuth_deg * circle_rad / 360.0, zenith = zenith_deg * circle_rad / 360.0;
      const Vec3 direction(std::sin(zenith) * std::cos(azimuth), std::sin(zenith) * std::sin(azimuth),
                           std::cos(zenith));
      const double expected = line(16, half_turn * 0.6 * direction.y) * line(3, half_turn * 0.6 * direction.z);
      for (const ArrayChannel mode : {ArrayChannel::plane_wave, ArrayChannel::exact}) {
        const auto paths = paths_of(Scene(), posed("tx", Vec3(0.0), panel),
                                    posed("rx", distance_m * direction, antenna({})), array_settings(mode, 0));
        Complex sum = 0.0;
        for (std::size_t element = 0; element < 48; ++element) sum += paths[0].channel(0, element);
        const double found = std::abs(sum) / std::abs(paths[0].amplitude);
        // Exact: each element is off by k·r²/2(L − r) and r/(L − r), r = 0.046 m: 6.7e-3 and 4.6e-4 at the rim.
        CHECK(std::abs(found - expected) < (mode == ArrayChannel::exact ? 48 * 7.2e-3 : 48 * 1e-12));
        deepest = std::min(deepest, expected / 48.0);
        highest = std::max(highest, found);
      }
    }
  }
  CHECK(highest == doctest::Approx(48.0).epsilon(1e-3));
  CHECK(deepest < 0.01);
}

TEST_CASE("array elements: everything but the channel is that of one antenna at the centre, to the bit") {
  const Scene scene = scene_through_files(yard());
  const auto solve = [&](const AntennaArray& from, const AntennaArray& to, ArrayChannel mode) {
    Scene with_devices = scene;
    Antenna transmitter = array_of(1, 1, PolarizationKind::right_circular, {0.2, -0.1, 0.3});
    Antenna receiver = array_of(1, 1, PolarizationKind::slant, {2.9, 0.1, 0.4});
    transmitter.array = from;
    receiver.array = to;
    transmitter.pattern = Tr38901Element{};
    with_devices.add_transmitter(posed("tx", Vec3(-6, 1, 3), transmitter));
    with_devices.add_receiver(posed("rx", Vec3(8, -3, 1.7), receiver));
    Simulator simulator(with_devices, array_settings(mode, 2, 2, 1));
    LinkResult link = simulator.advance_to(0.0).links.at(0);
    return std::pair(bits(with_devices, link), std::move(link));
  };
  const auto [bytes, single] = solve({}, {}, ArrayChannel::exact);
  REQUIRE(single.paths.size() >= 5);
  for (const PathContribution& path : single.paths) CHECK(path.channel.empty());
  for (const ArrayChannel mode : {ArrayChannel::plane_wave, ArrayChannel::exact}) {
    for (const auto& [from, to] :
         {std::pair(AntennaArray{4, 4}, AntennaArray{}), std::pair(AntennaArray{}, AntennaArray{1, 3}),
          std::pair(AntennaArray{2, 2}, AntennaArray{3, 1})}) {
      const auto [array_bytes, link] = solve(from, to, mode);
      CHECK(array_bytes == bytes);
      CHECK(link.statistics.zenith_spread_arrival_rad == single.statistics.zenith_spread_arrival_rad);
      CHECK(link.statistics.zenith_spread_departure_rad == single.statistics.zenith_spread_departure_rad);
      for (const PathContribution& path : link.paths) {
        CHECK(path.channel.rows() == to.size());
        CHECK(path.channel.columns() == from.size());
      }
    }
  }
}

TEST_CASE("array elements: an odd array has its centre among its elements") {
  const Scene scene = scene_through_files(yard());
  const auto paths =
      paths_of(scene, posed("tx", Vec3(-6, 1, 3), array_of(3, 5, PolarizationKind::slant, {0.2, 0.3, 0.1})),
               posed("rx", Vec3(8, -3, 1.7), array_of(1, 3)), array_settings(ArrayChannel::exact, 2, 2, 1));
  REQUIRE(paths.size() >= 5);
  for (const PathContribution& path : paths) CHECK(path.channel(1, 7) == path.amplitude);
}

TEST_CASE("array elements: runs with arrays pass verification, in both modes and with either discovery") {
  Antenna panel = array_of(2, 2, PolarizationKind::dual, {1.2, 0.2, -0.4});
  panel.pattern = Tr38901Element{};
  const Scene scene = car_and_mast(panel, array_of(1, 4, PolarizationKind::slant, {2.4, 0.3, 0.0}), false);
  for (const ArrayChannel mode : {ArrayChannel::plane_wave, ArrayChannel::exact}) {
    for (const Discovery discovery : {Discovery::exact, Discovery::sampled}) {
      SimulationSettings settings = array_settings(mode, 2, 1, 1);
      settings.propagation.discovery = discovery;
      Simulator simulator(scene, settings);
      Verifier verifier(scene, settings);
      std::size_t entries = 0;
      for (std::size_t frame = 0; frame < 6; ++frame) {
        const Frame instant = scene.frame_at(0.15 * static_cast<double>(frame), frame);
        FrameResult result = simulator.advance(instant);
        verifier.check(instant, result);
        for (const PathContribution& path : result.links.at(0).paths)
          entries += path.channel.rows() * path.channel.columns();
        if (frame < 5) continue;
        CHECK(verifier.report().passed());
        // One entry of one channel by one bit, and the frame no longer passes.
        Complex& entry = result.links[0].paths.at(0).channel(7, 3);
        entry = {std::nextafter(entry.real(), 1.0), entry.imag()};
        verifier.check(instant, result);
        CHECK_FALSE(verifier.report().passed());
      }
      CHECK(entries > 6 * 2 * 32);
    }
  }
}

TEST_CASE("array elements: one thread and three give the same bits") {
  const auto solve = [](ArrayChannel mode, unsigned threads) {
    Scene scene = scene_through_files(yard());
    for (int index = 0; index < 2; ++index)
      scene.add_transmitter(
          posed("tx" + std::to_string(index), Vec3(-6, 1 + index, 3), array_of(2, 2, PolarizationKind::dual)));
    for (int index = 0; index < 7; ++index)
      scene.add_receiver(
          posed("rx" + std::to_string(index), Vec3(8, 2 - index, 1.7), array_of(1, 3, PolarizationKind::slant)));
    SimulationSettings settings = array_settings(mode, 2, 2, 1);
    settings.threads = threads;
    Simulator simulator(scene, settings);
    std::string bytes;
    for (const LinkResult& link : simulator.advance_to(0.0).links) bytes += bits(scene, link) + channel_bits(link);
    return bytes;
  };
  const std::string exact = solve(ArrayChannel::exact, 1), plane = solve(ArrayChannel::plane_wave, 1);
  CHECK(exact.size() == plane.size());
  CHECK(exact != plane);
  CHECK(solve(ArrayChannel::exact, 3) == exact);
  CHECK(solve(ArrayChannel::plane_wave, 3) == plane);
}

TEST_CASE("elements of an array on a wall are mounted on it as its centre is, also where the array is tilted into it") {
  TriangleMesh wall;
  add_quad(wall, {Vec3(0, -20, 0), Vec3(0, 20, 0), Vec3(0, 20, 20), Vec3(0, -20, 20)}, "metal");
  for (const double pitch_rad : {0.0, 0.17}) {
    CAPTURE(pitch_rad);
    Scene scene;
    scene.add_material({"metal", PerfectConductor{}});
    scene.set_scenery(wall);
    Antenna column;
    column.array = {8, 1, 0.5};
    column.orientation.pitch_rad = pitch_rad;
    scene.add_transmitter(device_at("wall", Vec3(0, 1, 10), 0.0, column));
    scene.add_receiver(device_at("street", Vec3(30, 4, 1.5)));
    SimulationSettings settings;
    settings.propagation.antenna_array = ArrayChannel::exact;
    Simulator simulator(scene, settings);
    const LinkResult link = simulator.advance_to(0.0).links.at(0);
    REQUIRE(!link.paths.empty());
    const ChannelMatrix& channel = link.paths[0].channel;
    REQUIRE(channel.columns() == 8);
    for (std::size_t element = 0; element < 8; ++element) CHECK(channel(0, element) != Complex{});
  }
}

}  // namespace test_array_elements
