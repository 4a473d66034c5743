#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "dcem/core/units.hpp"
#include "dcem/em/diffraction/wedge_diffraction.hpp"
#include "dcem/em/surface/itu_p2040.hpp"
#include "dcem/em/surface/material_table.hpp"

namespace test_material_table {

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

TEST_CASE("a multilayer of one layer is the slab") {
  const MaterialTable table({{"stack", Multilayer{{ItuMaterial{"concrete", 0.2}}}},
                             {"slab", ItuMaterial{"concrete", 0.2}},
                             {"foil", Multilayer{{Dielectric{2.2, 0.001, 1e-4}}}},
                             {"film", Dielectric{2.2, 0.001, 1e-4}}},
                            28e9);
  for (const double cos_incidence : {0.0, 1e-6, 0.05, 0.3, 0.8, 1.0}) {
    CAPTURE(cos_incidence);
    for (const auto& [stack, slab] : {std::pair(first, second), std::pair(third, MaterialId(3))}) {
      const SurfaceResponse a = table.response(stack, cos_incidence), b = table.response(slab, cos_incidence);
      // Two routes through the same layer, the chain matrix and the sum of the internal reflections; 2kd√η is 500 rad,
      // whose rounding alone is 1e-13.
      CHECK(std::abs(a.reflection.te - b.reflection.te) <= 1e-12);
      CHECK(std::abs(a.reflection.tm - b.reflection.tm) <= 1e-12);
      CHECK(std::abs(a.transmission.te - b.transmission.te) <= 1e-12 * std::abs(b.transmission.te));
      CHECK(std::abs(a.transmission.tm - b.transmission.tm) <= 1e-12 * std::abs(b.transmission.tm));
    }
  }
  CHECK_FALSE(table.permittivity(first));  // a stack has no single one
}

TEST_CASE("layers stand one behind the other in their order, the first in front") {
  // Quarter-wave layers at λ = 1 cm; the admittance at normal incidence is v²/y after each, from the back:
  // 1 → 4/1 → 16/4 = 4, R = (1 − 4)/(1 + 4); turned about 1 → 16/1 → 4/16 = 1/4, R = (1 − 1/4)/(1 + 1/4).
  const Dielectric dense{16.0, 0.0, 0.01 / 16}, light{4.0, 0.0, 0.01 / 8};
  const MaterialTable table({{"a", Multilayer{{dense, light}}}, {"b", Multilayer{{light, dense}}}}, 29.9792458e9);
  // λ and kd are rounded a few times.
  CHECK(std::abs(table.response(first, 1.0).reflection.te + 0.6) <= 1e-14);
  CHECK(std::abs(table.response(first, 1.0).reflection.tm - 0.6) <= 1e-14);
  CHECK(std::abs(table.response(second, 1.0).reflection.te - 0.6) <= 1e-14);
  for (const double cos_incidence : {0.1, 0.6, 1.0}) {
    const auto a = table.response(first, cos_incidence).transmission;
    const auto b = table.response(second, cos_incidence).transmission;
    CHECK(std::abs(a.te - b.te) <= 1e-14);
    CHECK(std::abs(a.tm - b.tm) <= 1e-14);
  }
  // Lossless: |T|² = 1 − 0.36. Two quarter waves turn by π; the air they displace, 3λ/16, is given back.
  const Complex through = table.response(first, 1.0).transmission.te;
  CHECK(std::abs(through + 0.8 * Complex(std::cos(0.375 * pi), std::sin(0.375 * pi))) <= 1e-14);
}

TEST_CASE("layers of ITU materials follow revision, frequency intervals and the rule for metal") {
  const Multilayer wall{{ItuMaterial{"plasterboard", 0.0125}, Dielectric{1.0, 0.0, 0.07}}};
  for (const int revision : {3, 4}) {
    const auto board = itu_properties("plasterboard", 28e9, revision, false);
    const Dielectric same{board.relative_permittivity, board.conductivity_s_per_m, 0.0125};
    const MaterialTable table({{"itu", wall}, {"same", Multilayer{{same, Dielectric{1.0, 0.0, 0.07}}}}}, 28e9,
                              {revision, false});
    CHECK(table.response(first, 0.7) == table.response(second, 0.7));
    CHECK(table.extrapolated().empty());
  }
  const MaterialTable third_revision({{"w", wall}}, 28e9, {3, false}), fourth({{"w", wall}}, 28e9, {4, false});
  CHECK(std::abs(third_revision.response(first, 0.7).reflection.te - fourth.response(first, 0.7).reflection.te) > 1e-3);

  const std::vector<Material> bricks{{"w", wall},
                                     {"b", Multilayer{{Dielectric{2.0, 0.0, 0.01}, ItuMaterial{"brick", 0.1}}}}};
  CHECK_THROWS_AS(MaterialTable(bricks, 60e9, {3, false}), std::invalid_argument);  // brick: 1 to 40 GHz
  const MaterialTable beyond(bricks, 60e9, {3, true});
  REQUIRE(beyond.extrapolated().size() == 1);
  CHECK(beyond.extrapolated()[0] == second);

  const MaterialTable foil({{"f", Multilayer{{ItuMaterial{"metal", 1e-9}, Dielectric{2.0, 0.0, 0.01}}}}}, 1e9);
  CHECK(foil.response(first, 1.0).transmission == PolarizedCoefficients{0.0, 0.0});
}

TEST_CASE("a rough surface reflects less by exp(−g²/2), g = 2kσ·cos θ, and passes what it passed") {
  // λ = 1 cm, σ = 1 mm: g = 0.4π at normal incidence, 0.2π at 60°, 0 at grazing incidence.
  const double normal = 0.4540407387, oblique = 0.8208687174;  // exp(−0.7895683521), exp(−0.1973920880)
  const MaterialTable table({{"metal", PerfectConductor{}, 1e-3},
                             {"rough", Dielectric{4.0, 0.3, 0.004}, 1e-3},
                             {"smooth", Dielectric{4.0, 0.3, 0.004}}},
                            29.9792458e9);
  const auto at_normal = table.response(first, 1.0).reflection, at_60_deg = table.response(first, 0.5).reflection;
  CHECK(std::abs(at_normal.te + normal) <= 1e-9);
  CHECK(std::abs(at_normal.tm - normal) <= 1e-9);
  CHECK(std::abs(at_60_deg.te + oblique) <= 1e-9);
  CHECK(std::abs(at_60_deg.tm - oblique) <= 1e-9);
  CHECK(table.response(first, 0.0).reflection == PolarizedCoefficients{-1.0, 1.0});
  for (const double cos_incidence : {0.0, 0.5, 1.0}) {
    const auto rough = table.response(second, cos_incidence), smooth = table.response(third, cos_incidence);
    const double factor = cos_incidence == 1.0 ? normal : cos_incidence == 0.5 ? oblique : 1.0;
    CHECK(std::abs(rough.reflection.te - factor * smooth.reflection.te) <= 1e-9);
    CHECK(std::abs(rough.reflection.tm - factor * smooth.reflection.tm) <= 1e-9);
    CHECK(rough.transmission == smooth.transmission);
  }
}

TEST_CASE("every model may be rough, and no height gives NaN") {
  const std::vector<MaterialModel> models{PerfectConductor{}, ConstantReflection{0.7, 20.0}, Dielectric{4.0, 0.1, {}},
                                          ItuMaterial{"glass", 0.004}, Multilayer{{ItuMaterial{"glass", 0.004}}}};
  for (const MaterialModel& model : models) {
    const double huge_m = std::numeric_limits<double>::max();
    const MaterialTable table({{"smooth", model}, {"rough", model, 1e-3}, {"peaks", model, huge_m}}, 30e9);
    for (const double cos_incidence : {0.3, 1.0}) {
      const double smooth = std::abs(table.response(first, cos_incidence).reflection.te);
      CHECK(std::abs(table.response(second, cos_incidence).reflection.te) < 0.95 * smooth);
      CHECK(std::abs(table.response(third, cos_incidence).reflection.te) == 0.0);
    }
    CHECK(table.response(third, 0.0) == table.response(first, 0.0));
  }
}

TEST_CASE("the face of a wedge is as rough as the surface, so nothing jumps at the reflection boundary") {
  const MaterialTable table({{"rough", Dielectric{5.24, 0.6, {}}, 1e-3}, {"smooth", Dielectric{5.24, 0.6, {}}}},
                            29.9792458e9);
  const auto face = [&table](MaterialId id) {
    return [&table, id](double cos_incidence) { return table.response(id, cos_incidence).reflection; };
  };
  // At φ = π − φ' the reflected ray meets face 0 under cos θ = sin φ'·sin β0: twice 60°, where g = 0.2π.
  for (const auto& [incident_deg, edge_deg] : {std::pair(30.0, 90.0), std::pair(90.0, 30.0)}) {
    const WedgeAngles boundary{1.5, degrees_to_radians(incident_deg), pi - degrees_to_radians(incident_deg),
                               degrees_to_radians(edge_deg)};
    for (const LossyWedge variant : {LossyWedge::holm_reciprocal, LossyWedge::reciprocal, LossyWedge::luebbers84}) {
      const ComplexMatrix2 rough = face_reflection_matrix(boundary, WedgeFace::zero, variant, face(first));
      const ComplexMatrix2 smooth = face_reflection_matrix(boundary, WedgeFace::zero, variant, face(second));
      for (std::size_t entry = 0; entry < 4; ++entry) {
        const std::size_t row = entry / 2, column = entry % 2;
        CHECK(std::abs(rough(row, column) - 0.8208687174 * smooth(row, column)) <= 1e-9);
      }
      CHECK(std::abs(smooth(0, 0)) > 0.1);
    }
  }
}

TEST_CASE("bad materials, frequencies and ids do not pass") {
  CHECK_THROWS_AS(MaterialTable({{"a", ConstantReflection{1.1, {}}}}, 30e9), std::invalid_argument);
  CHECK_THROWS_AS(MaterialTable({}, 0.0), std::invalid_argument);
  CHECK_THROWS_AS(MaterialTable({}, std::numeric_limits<double>::infinity()), std::invalid_argument);
  CHECK_THROWS_AS(MaterialTable({{"a", Dielectric{1.0, 1e300, {}}}}, 1e-9), std::invalid_argument);
  const Multilayer conductor{{Dielectric{2.0, 0.0, 0.1}, Dielectric{1.0, 1e300, 0.1}}};
  CHECK_THROWS_AS(MaterialTable({{"a", conductor}}, 1e-9), std::invalid_argument);
  CHECK_THROWS_AS(MaterialTable({{"a", Multilayer{}}}, 30e9), std::invalid_argument);
  CHECK_THROWS_AS(MaterialTable({{"a", PerfectConductor{}, -1e-3}}, 30e9), std::invalid_argument);
  const MaterialTable table({{"car", PerfectConductor{}}}, 30e9);
  CHECK_THROWS_AS(table.response(second, 0.5), InvariantError);
  CHECK_THROWS_AS(table.material(second), InvariantError);
}

}  // namespace test_material_table
