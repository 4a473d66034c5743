/// Settings are checked once, at the border, and the message names the field.
#include "dcem/sim/settings.hpp"

#include <doctest/doctest.h>

#include <functional>
#include <limits>
#include <string>

namespace test_settings {

using namespace dcem;

namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN(),
                 unbounded = std::numeric_limits<double>::infinity();

/// The message of the refusal, empty where the settings are accepted.
std::string refusal(const std::function<void(SimulationSettings&)>& change) {
  SimulationSettings settings;
  change(settings);
  try {
    validate(settings);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

bool names(const std::string& message, const std::string& field) {
  return message.find(field) != std::string::npos;
}

}  // namespace

TEST_CASE("the defaults are valid and are those of the documentation") {
  const SimulationSettings settings;
  CHECK_NOTHROW(validate(settings));
  CHECK(settings.propagation.line_of_sight);
  CHECK(settings.propagation.max_reflections == 2);
  CHECK(settings.propagation.max_transmissions == 2);
  CHECK(settings.propagation.rays == 20'000);
  CHECK_FALSE(settings.propagation.rays_steady.has_value());
  CHECK(settings.propagation.cache == CacheMode::automatic);
  CHECK(settings.tree.policy == TreePolicy::adaptive);
  CHECK(settings.propagation.seed == 1);
  CHECK_FALSE(settings.propagation.min_path_gain_db.has_value());
  CHECK(settings.propagation.path_loss == AnyPathLoss{});
}

TEST_CASE("a frequency must be positive, finite and below the optical") {
  for (const double bad : {0.0, -1e9, not_a_number, unbounded, 1.1e15}) {
    CHECK(names(refusal([&](auto& s) { s.frequency_hz = bad; }), "frequency_hz"));
  }
  for (const double good : {1e-3, 30e9, 1e15}) CHECK(refusal([&](auto& s) { s.frequency_hz = good; }).empty());
}

TEST_CASE("orders are bounded") {
  for (const int bad : {-1, 11, std::numeric_limits<int>::max(), std::numeric_limits<int>::min()}) {
    CHECK(names(refusal([&](auto& s) { s.propagation.max_reflections = bad; }), "max_reflections"));
    CHECK(names(refusal([&](auto& s) { s.propagation.max_transmissions = bad; }), "max_transmissions"));
  }
  CHECK(names(refusal([](auto& s) { s.propagation.max_interactions = -1; }), "max_interactions"));
  for (const int good : {0, 10}) {
    CHECK(refusal([&](auto& s) { s.propagation.max_reflections = s.propagation.max_transmissions = good; }).empty());
    CHECK(refusal([&](auto& s) { s.propagation.max_interactions = good; }).empty());
  }
}

TEST_CASE("at least one ray, at most a hundred million") {
  CHECK(names(refusal([](auto& s) { s.propagation.rays = 0; }), "rays"));
  CHECK(names(refusal([](auto& s) { s.propagation.rays = 100'000'001; }), "rays"));
  CHECK(refusal([](auto& s) { s.propagation.rays = 1; }).empty());
  CHECK(names(refusal([](auto& s) { s.propagation.rays_steady = 0; }), "rays_steady"));
  CHECK(names(refusal([](auto& s) { s.propagation.rays_steady = 100'000'001; }), "rays_steady"));
  CHECK(refusal([](auto& s) { s.propagation.rays_steady = 1; }).empty());
  CHECK(names(refusal([](auto& s) { s.tree.sah_growth_limit = 1.0; }), "sah_growth_limit"));
  CHECK(names(refusal([](auto& s) { s.tree.deformation_limit = 0.0; }), "deformation_limit"));
}

TEST_CASE("numbers that would spread as NaN are refused") {
  CHECK_FALSE(refusal([](auto& s) { s.propagation.path_loss.model = CloseIn{not_a_number, 0.0}; }).empty());
  CHECK_FALSE(refusal([](auto& s) { s.propagation.path_loss.model = CloseIn{2.0, unbounded}; }).empty());
  CHECK_FALSE(refusal([](auto& s) { s.propagation.path_loss.model = CloseIn{-1.0, 0.0}; }).empty());
  CHECK(names(refusal([](auto& s) { s.propagation.min_path_gain_db = not_a_number; }), "min_path_gain_db"));
}

TEST_CASE("the longest path is a length") {
  for (const double bad : {0.0, -1.0, not_a_number, unbounded, 2e9}) {
    CHECK(names(refusal([&](auto& s) { s.propagation.max_path_length_m = bad; }), "max_path_length_m"));
  }
  CHECK(refusal([](auto& s) { s.propagation.max_path_length_m = 300.0; }).empty());
}

TEST_CASE("the order in force is the smaller of the two bounds") {
  PropagationSettings propagation;
  propagation.max_reflections = 3;
  CHECK(reflection_order(propagation) == 3);
  for (const auto& [bound, order] : {std::pair(0, 0), {2, 2}, {3, 3}, {9, 3}}) {
    propagation.max_interactions = bound;
    CHECK(reflection_order(propagation) == order);
  }
}

}  // namespace test_settings
