/// Patterns and polarizations of antennas along whole paths, against gains evaluated here from the printed formulas,
/// image theory, and what a mirror does to a hand.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/law_scenes.hpp"

namespace test_antenna_patterns_in_links {

using namespace dcem;
using namespace dcem::test;

namespace {

constexpr double light_mps = 299'792'458.0, circle_rad = 6.283185307179586477, degree_rad = circle_rad / 360.0;
constexpr double carrier_wavelength_m = light_mps / law_frequency_hz;

/// Turned by yaw, then pitch (nose down), then roll, each about an axis of its own.
Mat3 turn_by_hand(const Orientation& turned) {
  const Mat3 yaw = rotation_about(Vec3(0, 0, 1), turned.yaw_rad);
  const Mat3 pitch = rotation_about(yaw * Vec3(0, 1, 0), turned.pitch_rad) * yaw;
  return rotation_about(pitch * Vec3(1, 0, 0), turned.roll_rad) * pitch;
}

/// 3GPP TR 38.901, Table 7.3-1, as printed: A'' = −min(−(A''_V + A''_H), 30), with θ'' and φ'' in degrees and 8 dBi.
double sector_gain_db(const Mat3& axes, const Vec3& direction) {
  const Vec3 d = glm::normalize(direction);
  const double theta_deg = std::acos(std::clamp(glm::dot(d, axes[2]), -1.0, 1.0)) / degree_rad;
  const double phi_deg = std::atan2(glm::dot(d, axes[1]), glm::dot(d, axes[0])) / degree_rad;
  const double vertical_db = -std::min(12.0 * std::pow((theta_deg - 90.0) / 65.0, 2), 30.0);
  const double horizontal_db = -std::min(12.0 * std::pow(phi_deg / 65.0, 2), 30.0);
  return 8.0 - std::min(-(vertical_db + horizontal_db), 30.0);
}

/// A thin half-wave dipole along `wire`: 4/Cin(2π)·(cos(π/2·cos)/sin)², Cin(2π) = γ + ln 2π − Ci(2π) = 2.43765339305722
/// (mpmath).
double dipole_gain(const Vec3& wire, const Vec3& direction) {
  const double cosine = glm::dot(wire, direction), sine = glm::length(glm::cross(wire, direction));
  const double pattern = std::cos(0.25 * circle_rad * cosine) / sine;
  return 4.0 / 2.43765339305722441 * pattern * pattern;
}

/// θ̂ and φ̂ of a direction off the vertical, φ̂ level and to the left of who looks along it.
Vec3 level_by_hand(const Vec3& direction) {
  return glm::normalize(glm::cross(Vec3(0, 0, 1), direction));
}
Vec3 upright_by_hand(const Vec3& direction) {
  return glm::cross(level_by_hand(direction), direction);  // θ̂ × φ̂ = d, so θ̂ = φ̂ × d: points down
}

Antenna turned_antenna(const AntennaPattern& pattern, const Orientation& turned,
                       PolarizationKind kind = PolarizationKind::vertical) {
  Antenna result = antenna(kind);
  result.pattern = pattern;
  result.orientation = turned;
  return result;
}

Complex free_space(double length_m) {
  const double cycles = length_m / carrier_wavelength_m;
  return carrier_wavelength_m / (2.0 * circle_rad * length_m) *
         std::polar(1.0, -circle_rad * (cycles - std::floor(cycles)));
}

LinkResult link_between(Scene scene, const Device& transmitter, const Device& receiver, int reflections) {
  scene.add_transmitter(transmitter);
  scene.add_receiver(receiver);
  return Simulator(std::move(scene), law_settings(reflections, 0)).advance_to(0.0).links.at(0);
}

/// The path of a length.
const PathContribution& path_of_length(const LinkResult& link, double length_m) {
  const PathContribution* found = nullptr;
  for (const PathContribution& path : link.paths) {
    // Images agree to 1e-12 m; different paths differ by centimetres here.
    if (std::abs(path.path.length_m - length_m) < 1e-9) found = &path;
  }
  REQUIRE(found != nullptr);
  return *found;
}

double gain_db(const PathContribution& path) {
  return 10.0 * std::log10(path.power_ratio);
}

constexpr double front_m = 14.0;  // the house front is the plane y = front_m

Scene street() {
  return scene_through_files({sheet(Vec3(0), Vec3(400, 0, 0), Vec3(0, 400, 0), "half_space"),
                              sheet(Vec3(0, front_m, 15), Vec3(400, 0, 0), Vec3(0, 0, 15), "opaque")});
}

/// A point and its images in ground, house front, and both.
std::vector<Vec3> images_in_street(const Vec3& point_m) {
  const auto over_ground = [](const Vec3& p) { return Vec3(p.x, p.y, -p.z); };
  const auto over_front = [](const Vec3& p) { return Vec3(p.x, 2.0 * front_m - p.y, p.z); };
  return {point_m, over_ground(point_m), over_front(point_m), over_front(over_ground(point_m))};
}

const std::vector<Orientation> turns{
    {0.0, 0.0, 0.0},  {0.7, 0.0, 0.0},  {0.3, 6.0 * degree_rad, 0.0}, {-2.8, 12.0 * degree_rad, 0.0},
    {1.1, -0.4, 0.9}, {-0.6, 1.3, -2.2}};

const std::vector<Vec3> places_in_street{Vec3(40, 3, 1.5),   Vec3(-25, 8, 1.5), Vec3(3, -6, 1.2),
                                         Vec3(90, 13, 20.0), Vec3(15, 9, 26.0), Vec3(-60, -35, 1.7)};

}  // namespace

TEST_CASE(
    "patterns in links: a sector antenna adds its gain towards the departure to every path of a street, no more") {
  const Vec3 mast_m(0, 0, 12);
  double least_db = 0.0, largest_db = -100.0;
  for (const Orientation& turned : turns) {
    const Mat3 axes = turn_by_hand(turned);
    for (const Vec3& place_m : places_in_street) {
      const Device receiver = device_at("rx", place_m, 0.0, antenna(PolarizationKind::slant));
      const auto with = [&](const AntennaPattern& pattern) {
        return link_between(street(), device_at("tx", mast_m, 0.0, turned_antenna(pattern, turned)), receiver, 2);
      };
      const LinkResult sector = with(Tr38901Element{}), plain = with(IsotropicPattern{});
      REQUIRE(sector.paths.size() == 4);
      REQUIRE(plain.paths.size() == 4);
      for (const Vec3& image_m : images_in_street(place_m)) {
        // The path leaves towards the image of the receiver.
        const double length_m = glm::distance(mast_m, image_m);
        const double expected_db = sector_gain_db(axes, image_m - mast_m);
        const PathContribution &loud = path_of_length(sector, length_m), &quiet = path_of_length(plain, length_m);
        CHECK(gain_db(loud) - gain_db(quiet) == doctest::Approx(expected_db).epsilon(1e-9));
        // The same phase: an antenna has no phase pattern.
        CHECK(std::abs(std::arg(loud.amplitude / quiet.amplitude)) < 1e-12);
        least_db = std::min(least_db, expected_db);
        largest_db = std::max(largest_db, expected_db);
      }
    }
  }
  CHECK(least_db == doctest::Approx(-22.0).epsilon(1e-12));  // 30 dB below 8 dBi: behind
  CHECK(largest_db > 7.0);
}

TEST_CASE("patterns in links: a receiver's pattern counts towards the last point of the path, and gain_dbi on top") {
  const Vec3 mast_m(0, 0, 12);
  for (const Orientation& turned : turns) {
    const Mat3 axes = turn_by_hand(turned);
    for (const Vec3& place_m : places_in_street) {
      Antenna listening = turned_antenna(Tr38901Element{}, turned);
      listening.gain_dbi = 3.25;
      const Device mast = device_at("tx", mast_m, 0.0, antenna(PolarizationKind::slant));
      const LinkResult sector = link_between(street(), mast, device_at("rx", place_m, 0.0, listening), 2);
      const LinkResult plain =
          link_between(street(), mast, device_at("rx", place_m, 0.0, turned_antenna(IsotropicPattern{}, turned)), 2);
      for (const Vec3& image_m : images_in_street(mast_m)) {
        const double length_m = glm::distance(place_m, image_m);
        const double expected_db = sector_gain_db(axes, image_m - place_m) + 3.25;
        CHECK(gain_db(path_of_length(sector, length_m)) - gain_db(path_of_length(plain, length_m)) ==
              doctest::Approx(expected_db).epsilon(1e-9));
      }
    }
  }
}

TEST_CASE("patterns in links: values of the sector's pattern worked out by hand") {
  // Boresight 8 dBi; half the beam width of 65 degrees 3 dB less; behind 30 dB less; 26 degrees both ways 2·1.92 dB.
  const auto gain_towards_db = [](double azimuth_deg, double elevation_deg) {
    const double azimuth = azimuth_deg * degree_rad, elevation = elevation_deg * degree_rad;
    const Vec3 far_m = 50.0 * Vec3(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                                   std::sin(elevation));
    const Device sector = device_at("tx", Vec3(0), 0.0, turned_antenna(Tr38901Element{}, {}));
    const LinkResult link = link_between(Scene(), sector, device_at("rx", far_m, 0.0, antenna({})), 0);
    return *link.statistics.path_gain_db - 20.0 * std::log10(std::abs(free_space(50.0)));
  };
  CHECK(gain_towards_db(0, 0) == doctest::Approx(8.0).epsilon(1e-12));
  CHECK(gain_towards_db(32.5, 0) == doctest::Approx(5.0).epsilon(1e-12));
  CHECK(gain_towards_db(0, -32.5) == doctest::Approx(5.0).epsilon(1e-12));
  CHECK(gain_towards_db(65, 0) == doctest::Approx(-4.0).epsilon(1e-12));
  CHECK(gain_towards_db(26, 26) == doctest::Approx(8.0 - 3.84).epsilon(1e-12));
  CHECK(gain_towards_db(-26, 26) == doctest::Approx(8.0 - 3.84).epsilon(1e-12));
  CHECK(gain_towards_db(180, 0) == doctest::Approx(-22.0).epsilon(1e-12));
  CHECK(gain_towards_db(-130, 20) == doctest::Approx(-22.0).epsilon(1e-12));
}

TEST_CASE("patterns in links: downtilt by pitch points the beam at who stands below") {
  // The receiver is 10 degrees below the horizon of the mast, its image in the ground a known angle further down.
  const double height_m = 25.0, below_m = height_m - 1.5, ground_m = below_m / std::tan(10.0 * degree_rad);
  const double image_deg = std::atan2(height_m + 1.5, ground_m) / degree_rad;
  const Vec3 mast_m(0, 0, height_m), place_m(ground_m, 0, 1.5);
  const Scene scene = scene_through_files({sheet(Vec3(0), Vec3(400, 0, 0), Vec3(0, 400, 0), "pec")});
  for (const double pitch_deg : {-20.0, 0.0, 4.0, 10.0, 15.0, 60.0}) {
    const Orientation turned{0.0, pitch_deg * degree_rad, 0.0};
    const LinkResult link = link_between(scene, device_at("tx", mast_m, 0.0, turned_antenna(Tr38901Element{}, turned)),
                                         device_at("rx", place_m, 0.0, antenna({})), 1);
    REQUIRE(link.paths.size() == 2);
    const auto expected_db = [&](double depression_deg) {
      return 8.0 - std::min(12.0 * std::pow((depression_deg - pitch_deg) / 65.0, 2), 30.0);
    };
    // In the plane of the tilt V stays V.
    for (const auto& [depression_deg, vertical_m] : {std::pair(10.0, below_m), std::pair(image_deg, height_m + 1.5)}) {
      const double length_m = std::hypot(ground_m, vertical_m);
      CHECK(gain_db(path_of_length(link, length_m)) - 20.0 * std::log10(std::abs(free_space(length_m))) ==
            doctest::Approx(expected_db(depression_deg)).epsilon(1e-9));
    }
  }
}

TEST_CASE("patterns in links: the antenna on a car follows the car, over line of sight and over the ground") {
  // Masts to the east, north, west and south; the sector on the roof looks ahead, or to the left.
  const double roof_m = 1.6, mast_m = 9.0, away_m = 30.0;
  const auto off_axis_deg = [](double angle_deg) { return std::abs(std::remainder(angle_deg, 360.0)); };
  std::vector<double> ahead_db;
  for (const double yaw_deg : {0.0, 90.0, 180.0, 270.0}) {
    Scene scene = scene_through_files({sheet(Vec3(0), Vec3(90, 0, 0), Vec3(0, 90, 0), "pec")},
                                      {{"car", box_faces(Vec3(-2, -0.9, 0.2), Vec3(2, 0.9, 1.5), "pec"),
                                        LinearMotion{{Vec3(0), yaw_deg * degree_rad}, Vec3(0.0), 0.0}}});
    for (int mast = 0; mast < 4; ++mast) {
      const double azimuth = 90.0 * mast * degree_rad;
      scene.add_transmitter(device_at("mast" + std::to_string(mast),
                                      Vec3(away_m * std::cos(azimuth), away_m * std::sin(azimuth), mast_m)));
    }
    for (const double mounted_deg : {0.0, 90.0}) {
      Device roof = device_at(mounted_deg == 0.0 ? "ahead" : "left", Vec3(0.0));
      roof.antenna = turned_antenna(Tr38901Element{}, {mounted_deg * degree_rad});
      roof.attachment = Attachment{"car", Vec3(0, 0, roof_m), false};
      scene.add_receiver(roof);
    }
    const FrameResult frame = Simulator(scene, law_settings(1, 0)).advance_to(0.0);
    REQUIRE(frame.links.size() == 8);
    for (const LinkResult& link : frame.links) {
      const double mast_azimuth_deg = 90.0 * static_cast<double>(link.transmitter);
      const double horizontal_deg =
          off_axis_deg(mast_azimuth_deg - yaw_deg - 90.0 * static_cast<double>(link.receiver));
      REQUIRE(link.paths.size() == 2);
      for (const double height_m : {mast_m, -mast_m}) {
        const double vertical_deg = std::atan2(height_m - roof_m, away_m) / degree_rad;
        const double length_m = std::hypot(away_m, height_m - roof_m);
        const double loss_db = std::min(12.0 * std::pow(horizontal_deg / 65.0, 2), 30.0) +
                               std::min(12.0 * std::pow(vertical_deg / 65.0, 2), 30.0);
        // V to V over a conductor: the pattern is all there is beside spreading.
        CHECK(gain_db(path_of_length(link, length_m)) - 20.0 * std::log10(std::abs(free_space(length_m))) ==
              doctest::Approx(8.0 - std::min(loss_db, 30.0)).epsilon(1e-9));
      }
      const bool faced = mast_azimuth_deg == yaw_deg && link.receiver == 0;
      if (faced) ahead_db.push_back(*link.statistics.power_dbm);
    }
  }
  REQUIRE(ahead_db.size() == 4);
  // Every turn has a mast ahead; the sum of both paths is the same to the rounding of k·L.
  for (const double db : ahead_db) CHECK(std::abs(db - ahead_db[0]) < 1e-8);
}

TEST_CASE("patterns in links: straight above and below a dipole there is nothing, and around it its pattern") {
  const Vec3 mast_m(2, -3, 10);
  const Scene scene = scene_through_files({sheet(Vec3(0), Vec3(60, 0, 0), Vec3(0, 60, 0), "pec")});
  const Device dipole = device_at("tx", mast_m, 0.0, turned_antenna(HalfWaveDipole{}, {}));
  // Along the wire, down to the receiver and down to the ground and back up: nothing but rounding, (π/4·1e-16)² of the
  // field of an isotropic antenna.
  for (const Vec3& place_m : {Vec3(2, -3, 1.5), Vec3(2, -3, 40)}) {
    for (const PolarizationKind kind : {PolarizationKind::vertical, PolarizationKind::horizontal}) {
      const LinkResult link = link_between(scene, dipole, device_at("rx", place_m, 0.0, antenna(kind)), 1);
      REQUIRE(link.paths.size() == 2);
      for (const PathContribution& path : link.paths)
        CHECK(path.power_ratio < 1e-30 * std::norm(free_space(path.path.length_m)));
    }
  }
  // An upright dipole over a conductor and its image, which is upright, too: V to V.
  for (const double ground_m : {0.02, 0.5, 3.0, 11.0, 40.0}) {
    const Vec3 place_m = Vec3(2, -3, 1.5) + ground_m * Vec3(0.6, 0.8, 0);
    const LinkResult link = link_between(scene, dipole, device_at("rx", place_m, 0.0, antenna({})), 1);
    REQUIRE(link.paths.size() == 2);
    for (const double height_m : {1.5, -1.5}) {
      const double length_m = std::hypot(ground_m, mast_m.z - height_m);
      const Vec3 direction = Vec3(0.6 * ground_m, 0.8 * ground_m, height_m - mast_m.z) / length_m;
      const double expected = std::sqrt(dipole_gain(Vec3(0, 0, 1), direction));
      const Complex found = path_of_length(link, length_m).amplitude / free_space(length_m);
      // k·L to 1e-11 rad, with lengths of 40 m.
      CHECK(std::abs(found - expected) < 2e-11);
    }
  }
}

TEST_CASE("patterns in links: a dipole that lies along x is a wire along x, to V and to H") {
  // Pitch of a right angle lays the antenna's own z along x. Its field towards d is −x without what lies along d, the
  // sign from θ̂ = (cos θ·d − z)/sin θ; received by V it counts along θ̂, by H along φ̂ of the way back, −φ̂(d).
  const Device lying = device_at("tx", Vec3(0), 0.0, turned_antenna(HalfWaveDipole{}, {0.0, 0.25 * circle_rad, 0.0}));
  const Vec3 wire(1, 0, 0);
  Dice dice(7);
  for (int draw = 0; draw < 60; ++draw) {
    const Vec3 direction = draw == 0 ? Vec3(0, 1, 0) : draw == 1 ? glm::normalize(Vec3(0, 3, 4)) : dice.direction();
    const double length_m = 20.0, sine = glm::length(glm::cross(wire, direction));
    const Vec3 field = (glm::dot(wire, direction) * direction - wire) / sine;
    for (const bool vertical : {true, false}) {
      const PolarizationKind kind = vertical ? PolarizationKind::vertical : PolarizationKind::horizontal;
      const LinkResult link =
          link_between(Scene(), lying, device_at("rx", length_m * direction, 0.0, antenna(kind)), 0);
      const double component =
          vertical ? glm::dot(field, upright_by_hand(direction)) : -glm::dot(field, level_by_hand(direction));
      const double expected = std::sqrt(dipole_gain(wire, direction)) * component;
      // The place of the receiver is rounded at 4e-15 m, and k = 586 rad/m.
      CHECK(std::abs(link.paths.at(0).amplitude / free_space(length_m) - expected) < 2e-11);
      if (draw == 0) CHECK((std::abs(expected) > 1.28) == !vertical);  // broadside, level: H alone, √1.641
      if (draw == 0 && vertical) CHECK(std::abs(link.paths.at(0).amplitude) < 1e-15);
    }
  }
  // Off its ends there is nothing.
  for (const Vec3& end_m : {Vec3(20, 0, 0), Vec3(-20, 0, 0)}) {
    for (const PolarizationKind kind : {PolarizationKind::vertical, PolarizationKind::horizontal}) {
      const LinkResult link = link_between(Scene(), lying, device_at("rx", end_m, 0.0, antenna(kind)), 0);
      CHECK(link.paths.at(0).power_ratio < 1e-30 * std::norm(free_space(20.0)));
    }
  }
}

TEST_CASE("patterns in links: a dipole over a metal ground and its image, however it is turned") {
  // The image of a wire along w stands as deep below, along (−w_x, −w_y, w_z).
  const Scene scene = scene_through_files({sheet(Vec3(0), Vec3(200, 0, 0), Vec3(0, 200, 0), "pec")});
  Dice dice(11);
  for (int draw = 0; draw < 60; ++draw) {
    const Orientation turned{dice.between(-3, 3), dice.between(-1.5, 1.5), dice.between(-3, 3)};
    const Vec3 mast_m(0, 0, dice.between(2, 12));
    const Vec3 place_m(dice.between(-15, 15), dice.between(-15, 15), dice.between(1, 9));
    const Vec3 wire = turn_by_hand(turned)[2];
    for (const bool vertical : {true, false}) {
      const PolarizationKind kind = vertical ? PolarizationKind::vertical : PolarizationKind::horizontal;
      const LinkResult link =
          link_between(scene, device_at("tx", mast_m, 0.0, turned_antenna(HalfWaveDipole{}, turned)),
                       device_at("rx", place_m, 0.0, antenna(kind)), 1);
      REQUIRE(link.paths.size() == 2);
      for (const bool image : {false, true}) {
        const Vec3 from_m = image ? Vec3(0, 0, -mast_m.z) : mast_m;
        const Vec3 along = image ? Vec3(-wire.x, -wire.y, wire.z) : wire;
        const double length_m = glm::distance(from_m, place_m);
        const Vec3 direction = (place_m - from_m) / length_m;
        const Vec3 field = (glm::dot(along, direction) * direction - along) / glm::length(glm::cross(along, direction));
        const double component =
            vertical ? glm::dot(field, upright_by_hand(direction)) : -glm::dot(field, level_by_hand(direction));
        const double expected = std::sqrt(dipole_gain(along, direction)) * component;
        CHECK(std::abs(path_of_length(link, length_m).amplitude / free_space(length_m) - expected) < 2e-11);
      }
    }
  }
}

TEST_CASE("patterns in links: a metal mirror changes the hand of a circular wave, two of them change it back") {
  const Scene scene = scene_through_files({sheet(Vec3(0), Vec3(200, 0, 0), Vec3(0, 200, 0), "pec"),
                                           sheet(Vec3(3, 12, 0), Vec3(200, 20, 0), Vec3(0, 3, 90), "pec")});
  Dice dice(5);
  std::size_t reflected = 0, twice = 0;
  for (int draw = 0; draw < 40; ++draw) {
    // However the antennas are turned.
    const auto device = [&](const char* id, const Vec3& place_m, PolarizationKind kind, const Orientation& turned) {
      return device_at(id, place_m, 0.0, turned_antenna(IsotropicPattern{}, turned, kind));
    };
    const auto any_turn = [&] {
      return Orientation{dice.between(-3, 3), dice.between(-1.5, 1.5), dice.between(-3, 3)};
    };
    const Vec3 one_m = dice.inside(Vec3(-10, -10, 1), Vec3(10, 5, 9)),
               other_m = dice.inside(Vec3(-10, -10, 1), Vec3(10, 5, 9));
    const Orientation one_turn = any_turn(), other_turn = any_turn();
    for (const PolarizationKind sent : {PolarizationKind::right_circular, PolarizationKind::left_circular}) {
      for (const PolarizationKind heard : {PolarizationKind::right_circular, PolarizationKind::left_circular}) {
        const LinkResult link =
            link_between(scene, device("tx", one_m, sent, one_turn), device("rx", other_m, heard, other_turn), 2);
        for (const PathContribution& path : link.paths) {
          const bool changes = reflections(path) % 2 == 1;
          const double magnitude = std::abs(path.amplitude / free_space(path.path.length_m));
          CHECK(std::abs(magnitude - ((sent == heard) != changes ? 1.0 : 0.0)) < 1e-12);
          reflected += changes ? 1U : 0U;
          twice += reflections(path) == 2 ? 1U : 0U;
        }
      }
    }
  }
  CHECK(reflected >= 4 * 60);
  CHECK(twice >= 4 * 20);
}

TEST_CASE("patterns in links: lossy ground splits a circular wave into both hands, as its two coefficients say") {
  // T = diag(R_TM, −R_TE) in (θ̂, φ̂) of either end: (R_TM + R_TE)/2 stays in the hand, (R_TM − R_TE)/2 changes it.
  const Complex eta(4.4, -0.05 / (circle_rad * law_frequency_hz * 8.8541878128e-12));
  const Scene scene = scene_through_files({sheet(Vec3(0), Vec3(200, 0, 0), Vec3(0, 200, 0), "half_space")});
  for (const double ground_m : {0.5, 4.0, 12.0, 40.0, 150.0}) {
    const Vec3 mast_m(0, 0, 5), place_m(0.8 * ground_m, -0.6 * ground_m, 2);
    const double length_m = std::hypot(ground_m, 7.0), cosine = 7.0 / length_m;
    const Complex root = std::sqrt(eta - (1.0 - cosine * cosine));  // Im η < 0: so is that of the principal root
    const Complex te = (cosine - root) / (cosine + root), tm = (eta * cosine - root) / (eta * cosine + root);
    for (const PolarizationKind heard : {PolarizationKind::right_circular, PolarizationKind::left_circular}) {
      const LinkResult link =
          link_between(scene, device_at("tx", mast_m, 0.0, antenna(PolarizationKind::right_circular)),
                       device_at("rx", place_m, 0.0, antenna(heard)), 1);
      const Complex found = path_of_length(link, length_m).amplitude / free_space(length_m);
      const Complex expected = 0.5 * (heard == PolarizationKind::right_circular ? tm + te : tm - te);
      CHECK(std::abs(found - expected) < 1e-10);  // k times 2e-14 m
    }
  }
}

TEST_CASE("patterns in links: rolling a circular antenna about the line of sight turns the phase by the roll") {
  // θ̂ of an antenna that rolls by ρ about +x is θ̂·cos ρ + φ̂·sin ρ: (1, −j) becomes e^{jρ}·(1, −j), (1, j) e^{−jρ}·(1,
  // j).
  for (const PolarizationKind kind : {PolarizationKind::right_circular, PolarizationKind::left_circular}) {
    const double sign = kind == PolarizationKind::right_circular ? 1.0 : -1.0;
    for (const double roll_rad : {-2.5, -0.3, 0.0, 0.4, 1.7, 3.0}) {
      const Device rolled =
          device_at("tx", Vec3(0), 0.0, turned_antenna(IsotropicPattern{}, {0.0, 0.0, roll_rad}, kind));
      const LinkResult link = link_between(Scene(), rolled, device_at("rx", Vec3(10, 0, 0), 0.0, antenna(kind)), 0);
      const Complex turned = link.paths.at(0).amplitude / free_space(10.0);
      CHECK(std::abs(turned - std::polar(1.0, sign * roll_rad)) < 1e-12);
    }
  }
}

}  // namespace test_antenna_patterns_in_links
