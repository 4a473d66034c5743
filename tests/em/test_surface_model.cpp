#include <doctest/doctest.h>

#include <limits>

#include "dcem/em/surface_model.hpp"

using namespace dcem;

namespace {

constexpr double rounding = 1e-15;  // of a table's value that is computed twice in the same order or once

/// What a program may bring: one loss and a turn of the phase by π at every bounce.
struct FixedBounce {
  SurfaceResponse response(MaterialId, double) const { return {{-0.178, -0.178}, {}}; }
};
struct NoModel {
  double response(MaterialId, double) const { return 0.0; }
};
static_assert(SurfaceModel<FixedBounce>);
static_assert(!SurfaceModel<NoModel>);
static_assert(!SurfaceModel<int>);

const MaterialId first(0), second(1), third(2);

}  // namespace

TEST_CASE("constant and conducting surfaces answer the same at every angle") {
  const MaterialTable table({{"wall", ConstantReflection{0.7, 20.0}},
                             {"facade", ConstantReflection{0.8, std::nullopt}},
                             {"car", PerfectConductor{}}},
                            30e9);
  CHECK(table.size() == 3);
  CHECK(table.frequency_hz() == 30e9);
  for (const double cos_incidence : {0.0, 0.3, 1.0}) {
    const auto wall = table.response(first, cos_incidence);
    CHECK(wall.reflection == PolarizedCoefficients{-0.7, 0.7});
    CHECK(std::abs(wall.transmission.te - 0.1) <= rounding);  // 20 dB of power: a tenth of the field, no phase
    CHECK(wall.transmission.te == wall.transmission.tm);
    CHECK(table.response(second, cos_incidence) == SurfaceResponse{{-0.8, 0.8}, {0.0, 0.0}});
    CHECK(table.response(third, cos_incidence) == SurfaceResponse{{-1.0, 1.0}, {0.0, 0.0}});
  }
  CHECK_FALSE(table.permittivity(first));
  CHECK(table.material(second).name == "facade");
}

TEST_CASE("a dielectric without thickness is an opaque half space, with thickness a slab") {
  const MaterialTable table({{"ground", Dielectric{4.0, 0.0, {}}}, {"pane", Dielectric{4.0, 0.0, 0.005}}}, 30e9);
  const auto ground = table.response(first, 1.0);
  CHECK(std::abs(ground.reflection.te + 1.0 / 3.0) <= rounding);  // (1 − 2)/(1 + 2)
  CHECK(ground.transmission == PolarizedCoefficients{0.0, 0.0});
  // 5 mm of index 2 at a wavelength of 9.993 mm are 1.0007 wavelengths: nearly a window.
  const auto pane = table.response(second, 1.0);
  CHECK(std::abs(pane.reflection.te) < 0.01);
  CHECK(std::abs(pane.transmission.te) > 0.99);
  // No loss: energy to a dozen roundings.
  CHECK(std::norm(pane.reflection.te) + std::norm(pane.transmission.te) == doctest::Approx(1.0).epsilon(1e-14));
}

TEST_CASE("an ITU material is the dielectric of its table") {
  const auto properties = itu_properties("concrete", 28e9, 4, false);
  const MaterialTable table(
      {{"itu", ItuMaterial{"concrete", 0.2}},
       {"same", Dielectric{properties.relative_permittivity, properties.conductivity_s_per_m, 0.2}},
       {"half", ItuMaterial{"concrete", {}}}},
      28e9, {4, false});
  for (const double cos_incidence : {0.0, 0.2, 0.7, 1.0}) {
    CHECK(table.response(first, cos_incidence) == table.response(second, cos_incidence));
    CHECK(table.response(third, cos_incidence).transmission == PolarizedCoefficients{0.0, 0.0});
  }
  REQUIRE(table.permittivity(first));
  CHECK(table.permittivity(first)->real() == 5.24);
  CHECK(table.extrapolated().empty());
}

TEST_CASE("the ITU's metal is opaque with and without thickness, and nearly a perfect conductor") {
  const MaterialTable table({{"a", ItuMaterial{"metal", 1e-3}}, {"b", ItuMaterial{"metal", {}}}}, 30e9);
  for (const MaterialId id : {first, second})
    for (const double cos_incidence : {0.1, 0.5, 1.0}) {
      const auto metal = table.response(id, cos_incidence);
      CHECK(metal.transmission == PolarizedCoefficients{0.0, 0.0});
      // 2/(|√η|·cos), |η| = 17.98 · 1e7/30 = 6e6: within 0.01 at cos = 0.1.
      CHECK(std::abs(metal.reflection.te + 1.0) < 0.01);
      CHECK(std::abs(metal.reflection.tm - 1.0) < 0.01);
    }
}

TEST_CASE("a foil far thinner than the skin depth passes as a dielectric, but not as the ITU's metal") {
  const MaterialTable table({{"a", ItuMaterial{"metal", 1e-9}}, {"b", Dielectric{1.0, 1e7, 1e-9}}}, 1e9);
  CHECK(table.response(first, 1.0).transmission == PolarizedCoefficients{0.0, 0.0});
  CHECK(std::abs(table.response(second, 1.0).transmission.te) > 1e-3);
  CHECK(table.response(first, 1.0).reflection == table.response(second, 1.0).reflection);
}

TEST_CASE("outside an ITU table: refused, or done and reported") {
  const std::vector<Material> materials{{"a", ItuMaterial{"glass", {}}}, {"b", ItuMaterial{"brick", {}}}};
  CHECK_THROWS_AS(MaterialTable(materials, 60e9, {3, false}), std::invalid_argument);
  const MaterialTable table(materials, 60e9, {3, true});
  REQUIRE(table.extrapolated().size() == 1);
  CHECK(table.extrapolated()[0] == second);
}

TEST_CASE("bad materials, frequencies and ids do not pass") {
  CHECK_THROWS_AS(MaterialTable({{"a", ConstantReflection{1.1, {}}}}, 30e9), std::invalid_argument);
  CHECK_THROWS_AS(MaterialTable({}, 0.0), std::invalid_argument);
  CHECK_THROWS_AS(MaterialTable({}, std::numeric_limits<double>::infinity()), std::invalid_argument);
  CHECK_THROWS_AS(MaterialTable({{"a", Dielectric{1.0, 1e300, {}}}}, 1e-9), std::invalid_argument);
  const MaterialTable table({{"car", PerfectConductor{}}}, 30e9);
  CHECK_THROWS_AS(table.response(second, 0.5), InvariantError);
  CHECK_THROWS_AS(table.material(second), InvariantError);
}
