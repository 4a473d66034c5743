/// Arrays at the ends of a path: the channel between elements against paths that are solved element by element.
#include "dcem/field/array_channel.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "dcem/core/random.hpp"
#include "dcem/field/field_evaluator.hpp"

namespace test_array_channel {

using namespace dcem;

namespace {

constexpr double frequency_hz = 28e9, carrier_wavelength_m = speed_of_light_mps / frequency_hz;

PathContribution line_of_sight(const RadioEnd& transmitter, const RadioEnd& receiver) {
  const Scene scene;
  const MaterialTable surface({}, frequency_hz);
  const FieldEvaluator<> evaluator(scene, surface, AnyPathLoss{}, frequency_hz);
  return evaluator.evaluate({{}, glm::distance(transmitter.position_m, receiver.position_m)}, transmitter, receiver);
}

RadioEnd end_at(const Vec3& position_m, PolarizationKind kind, const AntennaArray& array, const Orientation& turned) {
  return {position_m, Vec3(0.0), {0.0, {kind}, Tr38901Element{}, turned, array}};
}

/// The same end with one element, which stands where the element of the array stands.
RadioEnd element_of(const RadioEnd& end, std::size_t element) {
  RadioEnd alone = end;
  alone.position_m += end.rotation * element_offset_m(end.antenna.array, element, carrier_wavelength_m);
  alone.antenna.array = {};
  return alone;
}

}  // namespace

TEST_CASE("an end that says nothing else is turned as its antenna is") {
  const RadioEnd turned = end_at(Vec3(0.0), PolarizationKind::vertical, {}, {0.3, -0.2, 0.7});
  CHECK(turned.rotation == rotation_matrix(Orientation{0.3, -0.2, 0.7}));
  CHECK(RadioEnd{}.rotation == Mat3(1.0));
}

TEST_CASE("two single elements have no channel matrix") {
  const auto link = line_of_sight(end_at(Vec3(0.0), PolarizationKind::vertical, {}, {}),
                                  end_at(Vec3(9, 2, 1), PolarizationKind::dual, {}, {}));
  CHECK(link.channel.empty());
  CHECK(link.channel.rows() == 0);
}

TEST_CASE(
    "plane-wave phases are those of paths solved between each pair of elements, up to k r² sin²/2d at both ends") {
  const RadioEnd from = end_at(Vec3(1, 2, 3), PolarizationKind::vertical, {2, 3, 0.5}, {0.4, 0.1, -0.3});
  const RadioEnd to = end_at(Vec3(41, 12, -3), PolarizationKind::slant, {3, 2, 0.8}, {-2.6, -0.2, 0.5});
  const PathContribution link = line_of_sight(from, to);
  REQUIRE(link.channel.rows() == 6);
  REQUIRE(link.channel.columns() == 6);
  const double distance_m = link.path.length_m, wave_number = 2.0 * pi / carrier_wavelength_m;
  double largest_m = 0.0;
  for (std::size_t element = 0; element < 6; ++element) {
    largest_m = std::max(largest_m, glm::length(element_offset_m(from.antenna.array, element, carrier_wavelength_m)) +
                                        glm::length(element_offset_m(to.antenna.array, element, carrier_wavelength_m)));
  }
  const double phase_bound = wave_number * largest_m * largest_m / (2.0 * distance_m);
  // Distance, and the beams' slopes towards a direction that is off by r/d: some 0.1 per degree at the most.
  const double amplitude_bound = 10.0 * largest_m / distance_m;
  double largest_phase = 0.0;
  for (std::size_t row = 0; row < 6; ++row) {
    for (std::size_t column = 0; column < 6; ++column) {
      const Complex exact = line_of_sight(element_of(from, column), element_of(to, row)).amplitude;
      const Complex quotient = link.channel(row, column) / exact;
      CHECK(std::abs(std::arg(quotient)) < phase_bound);
      CHECK(std::abs(std::abs(quotient) - 1.0) < amplitude_bound);
      largest_phase = std::max(largest_phase, std::abs(std::arg(link.channel(row, column) / link.amplitude)));
    }
  }
  CHECK(phase_bound < 0.01);
  CHECK(largest_phase > 1.0);  // against which the bound is nothing
}

TEST_CASE("of a dual antenna the ports follow each other within an element") {
  const RadioEnd from = end_at(Vec3(0, 0, 5), PolarizationKind::dual, {2, 1, 0.5}, {0.1, 0.2, 0.3});
  const RadioEnd to = end_at(Vec3(30, 4, 1), PolarizationKind::vertical, {1, 3, 0.5}, {pi, 0.1, 0.0});
  const PathContribution link = line_of_sight(from, to);
  REQUIRE(link.channel.rows() == 3);
  REQUIRE(link.channel.columns() == 4);
  const Vec3 departure = glm::normalize(to.position_m - from.position_m);
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t element = 0; element < 2; ++element) {
      const Complex phase = element_phasor(to.antenna.array, row, glm::transpose(to.rotation) * -departure) *
                            element_phasor(from.antenna.array, element, glm::transpose(from.rotation) * departure);
      for (std::size_t port = 0; port < 2; ++port) {
        const Complex expected = phase * link.ports(0, port);
        CHECK(std::abs(link.channel(row, 2 * element + port) - expected) < 1e-15 * std::abs(expected) + 1e-20);
      }
    }
  }
}

TEST_CASE("the link back has the transposed channel") {
  const RadioEnd from = end_at(Vec3(0, 0, 5), PolarizationKind::dual, {2, 2, 0.5}, {0.1, 0.2, 0.3});
  const RadioEnd to = end_at(Vec3(30, 4, 1), PolarizationKind::right_circular, {1, 3, 0.7}, {3.0, 0.1, 0.4});
  const ChannelMatrix there = line_of_sight(from, to).channel, back = line_of_sight(to, from).channel;
  REQUIRE(there.rows() == back.columns());
  REQUIRE(there.columns() == back.rows());
  for (std::size_t row = 0; row < there.rows(); ++row) {
    for (std::size_t column = 0; column < there.columns(); ++column) {
      CHECK(std::abs(there(row, column) - back(column, row)) < 1e-14 * std::abs(there(row, column)) + 1e-20);
    }
  }
}

TEST_CASE("an array changes nothing but the channel: amplitude and power are those of one element at its centre") {
  const RadioEnd single = end_at(Vec3(0, 0, 5), PolarizationKind::vertical, {}, {0.1, 0.2, 0.3});
  const RadioEnd array = end_at(Vec3(0, 0, 5), PolarizationKind::vertical, {8, 8, 0.5}, {0.1, 0.2, 0.3});
  const RadioEnd to = end_at(Vec3(30, 4, 1), PolarizationKind::horizontal, {}, {3.0, 0.1, 0.4});
  const PathContribution one = line_of_sight(single, to), many = line_of_sight(array, to);
  CHECK(one.amplitude == many.amplitude);
  CHECK(one.power_ratio == many.power_ratio);
  CHECK(one.transfer == many.transfer);
  // A beam that gathers 64 elements brings 64 times the amplitude.
  Complex beam{};
  for (std::size_t element = 0; element < 64; ++element) {
    const Complex h = many.channel(0, element);
    beam += h * std::conj(h) / std::abs(h);
  }
  CHECK(std::abs(beam) == doctest::Approx(64.0 * std::abs(one.amplitude)).epsilon(1e-13).scale(0.0));
}

TEST_CASE("the gain of a link is the sum of both antennas' gains towards each other") {
  // 30 degrees off the boresight of one, 20 of the other, V to V: 8 - 12·(30/65)², 8 - 12·(20/65)² by hand.
  const double thirty = pi / 6.0, twenty = pi / 9.0;
  const PathContribution link = line_of_sight(end_at(Vec3(0.0), PolarizationKind::vertical, {}, {thirty}),
                                              end_at(Vec3(50, 0, 0), PolarizationKind::vertical, {}, {pi + twenty}));
  const PathContribution plain = line_of_sight({}, {Vec3(50, 0, 0)});
  const double gain_db = 10.0 * std::log10(link.power_ratio / plain.power_ratio);
  CHECK(gain_db == doctest::Approx(16.0 - 12.0 * (900.0 + 400.0) / 4225.0).epsilon(1e-12));
}

}  // namespace test_array_channel
