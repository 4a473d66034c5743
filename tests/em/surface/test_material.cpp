#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "dcem/em/surface/material.hpp"

namespace test_material {

using namespace dcem;

namespace {

const double infinity = std::numeric_limits<double>::infinity();
const double not_a_number = std::numeric_limits<double>::quiet_NaN();

bool accepted(const MaterialModel& model, double roughness_rms_m = 0.0) {
  try {
    validate(Material{"wall", model, roughness_rms_m});
  } catch (const std::invalid_argument&) {
    return false;
  }
  return true;
}

}  // namespace

TEST_CASE("what a path may cross") {
  CHECK_FALSE(transmits({"m", PerfectConductor{}}));
  CHECK_FALSE(transmits({"m", ConstantReflection{0.8, std::nullopt}}));
  CHECK(transmits({"m", ConstantReflection{0.7, 20.0}}));
  CHECK(transmits({"m", ConstantReflection{0.0, 0.0}}));
  CHECK_FALSE(transmits({"m", Dielectric{4.0, 0.1, std::nullopt}}));
  CHECK(transmits({"m", Dielectric{4.0, 0.1, 0.2}}));
  CHECK_FALSE(transmits({"m", ItuMaterial{"glass", std::nullopt}}));
  CHECK(transmits({"m", ItuMaterial{"glass", 0.005}}));
  CHECK_FALSE(transmits({"m", ItuMaterial{"metal", 0.001}}));
  CHECK(transmits({"m", Multilayer{{ItuMaterial{"glass", 0.004}, Dielectric{1.0, 0.0, 0.016}}}}));
  CHECK_FALSE(transmits({"m", Multilayer{{ItuMaterial{"glass", 0.004}, ItuMaterial{"metal", 0.001}}}}));
  CHECK(transmits({"m", ConstantReflection{0.7, 20.0}, 0.01}));  // roughness closes nothing
}

TEST_CASE("the materials of the paper conserve energy and are accepted") {
  CHECK(accepted(ConstantReflection{0.8, std::nullopt}));
  CHECK(accepted(ConstantReflection{0.7, 20.0}));
  CHECK(accepted(ConstantReflection{0.74, 5.0}));
  CHECK(accepted(ConstantReflection{1.0, std::nullopt}));
  CHECK(accepted(PerfectConductor{}));
  CHECK(accepted(Dielectric{}));
  CHECK(accepted(ItuMaterial{"medium_dry_ground", 1.0}));
}

TEST_CASE("more power out than in is refused, with room for the rounding of a lossless split") {
  for (int percent = 1; percent < 100; ++percent) {
    const double amplitude = percent / 100.0;
    const double lossless_db = -10.0 * std::log10(1.0 - amplitude * amplitude);
    CHECK(accepted(ConstantReflection{amplitude, lossless_db}));
    CHECK(accepted(ConstantReflection{amplitude, lossless_db - 1e-12}));  // up to 2.3e-13 of the power too much
    if (lossless_db > 1e-3) CHECK_FALSE(accepted(ConstantReflection{amplitude, lossless_db - 1e-6}));
  }
  CHECK_FALSE(accepted(ConstantReflection{1.0, 100.0}));
  CHECK_FALSE(accepted(ConstantReflection{0.9, 3.0}));
}

TEST_CASE("numbers out of range and not finite are refused") {
  for (const double bad : {-0.01, 1.01, infinity, -infinity, not_a_number})
    CHECK_FALSE(accepted(ConstantReflection{bad, std::nullopt}));
  for (const double bad : {-1.0, infinity, not_a_number}) {
    CHECK_FALSE(accepted(ConstantReflection{0.0, bad}));
    CHECK_FALSE(accepted(Dielectric{2.0, bad, std::nullopt}));
    CHECK_FALSE(accepted(Dielectric{2.0, 0.0, bad}));
    CHECK_FALSE(accepted(ItuMaterial{"glass", bad}));
  }
  CHECK_FALSE(accepted(Dielectric{2.0, 0.0, 0.0}));
  for (const double bad : {0.99, 0.0, -5.0, infinity, not_a_number}) CHECK_FALSE(accepted(Dielectric{bad, 0.0, {}}));
  CHECK_FALSE(accepted(ItuMaterial{"cheese", std::nullopt}));
  CHECK_FALSE(accepted(ItuMaterial{"wet-ground", std::nullopt}));  // canonical names only
}

TEST_CASE("a multilayer needs layers, and every layer what a slab of its medium needs") {
  CHECK(accepted(Multilayer{{Dielectric{4.0, 0.1, 0.2}}}));
  CHECK(accepted(Multilayer{{ItuMaterial{"glass", 0.004}, Dielectric{1.0, 0.0, 0.016}, ItuMaterial{"glass", 0.004}}}));
  CHECK_FALSE(accepted(Multilayer{}));
  const Dielectric good{4.0, 0.1, 0.2};
  for (const MaterialLayer& bad : std::vector<MaterialLayer>{
           Dielectric{4.0, 0.1, {}}, Dielectric{4.0, 0.1, 0.0}, Dielectric{4.0, 0.1, not_a_number},
           Dielectric{0.5, 0.1, 0.2}, Dielectric{4.0, -0.1, 0.2}, ItuMaterial{"glass", {}}, ItuMaterial{"glass", -0.1},
           ItuMaterial{"cheese", 0.1}}) {
    CHECK_FALSE(accepted(Multilayer{{bad}}));
    CHECK_FALSE(accepted(Multilayer{{good, bad}}));
    CHECK_FALSE(accepted(Multilayer{{bad, good}}));
  }
}

TEST_CASE("any material may be rough, by a finite height that is not negative") {
  for (const MaterialModel& model :
       std::vector<MaterialModel>{PerfectConductor{}, ConstantReflection{0.7, 20.0}, Dielectric{4.0, 0.1, {}},
                                  ItuMaterial{"concrete", 0.2}, Multilayer{{Dielectric{4.0, 0.1, 0.2}}}}) {
    CHECK(accepted(model, 0.003));
    for (const double bad : {-1e-9, infinity, not_a_number}) CHECK_FALSE(accepted(model, bad));
  }
}

TEST_CASE("the ITU materials of a material, each once") {
  using Names = std::vector<std::string>;
  CHECK(itu_names({"m", PerfectConductor{}}).empty());
  CHECK(itu_names({"glass", Dielectric{6.0, 0.0, 0.1}}).empty());
  CHECK(itu_names({"m", ItuMaterial{"wood", {}}}) == Names{"wood"});
  CHECK(itu_names({"m", Multilayer{{ItuMaterial{"plasterboard", 0.0125}, Dielectric{1.0, 0.0, 0.07},
                                    ItuMaterial{"wood", 0.02}, ItuMaterial{"plasterboard", 0.0125}}}}) ==
        Names{"plasterboard", "wood"});
}

TEST_CASE("a refusal names the material") {
  try {
    validate({"front door", ConstantReflection{2.0, {}}});
    FAIL("accepted");
  } catch (const std::invalid_argument& error) {
    CHECK(std::string(error.what()).find("front door") != std::string::npos);
  }
}

}  // namespace test_material
