/// What a sheet reflects and lets through is no more than what it receives, measured on paths of the engine.
#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/support/law_scenes.hpp"

namespace test_energy {

using namespace dcem;
using namespace dcem::test;

namespace {

struct Shares {
  double reflected, passed;
};

/// Power that a sheet in the plane x = 0 sends to q in front of it and to the mirror image of q behind it, over that of
/// free space. Both paths are equally long and meet the sheet under the same angle. With p and q at one height the
/// field is TE for V antennas and TM for H antennas.
Shares shares(const Scene& scene, const Vec3& p, const Vec3& q, std::size_t component) {
  const auto behind = paths_between(scene, p, Vec3(-q.x, q.y, q.z), law_settings(1, 1));
  const auto before = paths_between(scene, p, q, law_settings(1, 1));
  REQUIRE(behind.size() == 1);
  REQUIRE(kinds(behind[0]) == "T");
  REQUIRE(before.size() == 2);
  REQUIRE(kinds(before[1]) == "R");
  const double wavelength_m = 299'792'458.0 / law_frequency_hz;
  const double free_space = std::pow(wavelength_m / (4.0 * pi * behind[0].path.length_m), 2);
  return {std::norm(before[1].transfer(component, component)) / free_space,
          std::norm(behind[0].transfer(component, component)) / free_space};
}

Patches large_sheet(const std::string& material) {
  return {sheet(Vec3(0, 0, 0), Vec3(0, 400, 0), Vec3(0, 0, 300), material)};
}

Shares shares(const std::string& material, const Vec3& p, const Vec3& q, std::size_t component) {
  return shares(scene_through_files(large_sheet(material)), p, q, component);
}

/// Of a material that no MTL file can hold.
Shares shares(const Material& material, const Vec3& p, const Vec3& q, std::size_t component) {
  const TemporaryFolder folder;
  write_law_materials(folder / "laws.mtl");
  write_patches(folder / "sheet.obj", large_sheet(material.name));
  Scene scene;
  scene.add_material(material);
  add_obj_file(scene, folder / "sheet.obj", [&](const TriangleMesh& mesh) { scene.set_scenery(mesh); });
  return shares(scene, p, q, component);
}

}  // namespace

TEST_CASE("a lossless slab splits the power, a lossy one keeps some: both polarizations, all angles") {
  for (const std::size_t component : {0U, 1U}) {
    for (const double y : {0.0, 0.7, 3.0, 9.0, 40.0, 150.0}) {
      CAPTURE(y);
      CAPTURE(component);
      const Vec3 p(3.3, -0.5 * y, 1.2), q(2.1, 0.5 * y, 1.2);
      const Shares lossless = shares("lossless", p, q, component), lossy = shares("lossy", p, q, component);
      // 1e-11: the slab's own sums are good to 1e-15; the angle of incidence is taken from coordinates of up to 150 m.
      CHECK(lossless.reflected + lossless.passed == doctest::Approx(1.0).epsilon(1e-11));
      CHECK(lossy.reflected + lossy.passed < 1.0 - 1e-3);
      CHECK(lossy.reflected + lossy.passed > 0.0);
    }
  }
}

TEST_CASE("a lossless stack of layers splits the power, loss and roughness keep some") {
  const Dielectric board{2.7, 0.0, 0.0125}, air{1.0, 0.0, 0.071}, pane{6.3, 0.0, 0.004};
  const Multilayer clear{{board, air, pane}};
  const Multilayer wet{{board, Dielectric{1.0, 0.02, 0.071}, pane}};
  for (const std::size_t component : {0U, 1U}) {
    for (const double y : {0.0, 0.7, 3.0, 9.0, 40.0}) {
      CAPTURE(y);
      CAPTURE(component);
      const Vec3 p(3.3, -0.5 * y, 1.2), q(2.1, 0.5 * y, 1.2);
      const Shares lossless = shares({"stack", clear}, p, q, component);
      const Shares rough = shares({"stack", clear, 5e-4}, p, q, component);
      const Shares lossy = shares({"stack", wet}, p, q, component);
      // 1e-11 as above.
      CHECK(lossless.reflected + lossless.passed == doctest::Approx(1.0).epsilon(1e-11));
      CHECK(rough.passed == lossless.passed);
      CHECK(rough.reflected < lossless.reflected);
      CHECK(lossy.reflected + lossy.passed < 1.0 - 1e-3);
    }
  }
}

TEST_CASE("the sums of the lossless slab are no accident: the shares do change with angle") {
  const Shares steep = shares("lossless", Vec3(3, 0, 1), Vec3(2, 0, 1), 0);
  const Shares flat = shares("lossless", Vec3(3, -40, 1), Vec3(2, 40, 1), 0);
  CHECK(flat.reflected > steep.reflected + 0.2);
}

TEST_CASE("constant materials: the declared field coefficient and penetration loss, at any angle") {
  for (const double y : {0.0, 2.0, 30.0}) {
    const Shares wall = shares("wall", Vec3(3.3, -y, 1.2), Vec3(2.1, y, 1.2), 0);
    CHECK(wall.reflected == doctest::Approx(0.49).epsilon(1e-12));  // rounding of a dozen operations
    CHECK(wall.passed == doctest::Approx(0.01).epsilon(1e-12).scale(0.0));
    const Shares glass = shares("glass", Vec3(3.3, -y, 1.2), Vec3(2.1, y, 1.2), 1);
    CHECK(glass.reflected == doctest::Approx(0.74 * 0.74).epsilon(1e-12));
    CHECK(glass.passed == doctest::Approx(std::pow(10.0, -0.5)).epsilon(1e-12));
  }
}

TEST_CASE("every sheet is paid: a wall drawn as two sheets of 20 dB costs 40 dB, and transmissions are counted") {
  const Patches two{sheet(Vec3(0, 0, 0), Vec3(0, 40, 0), Vec3(0, 0, 30), "wall"),
                    sheet(Vec3(0.2, 0, 0), Vec3(0, 40, 0), Vec3(0, 0, 30), "wall")};
  const Vec3 p(-3, 1, 0.4), q(4, -2, 0.7);
  const auto paths = paths_between(scene_through_files(two), p, q, law_settings(0, 2));
  REQUIRE(paths.size() == 1);
  CHECK(kinds(paths[0]) == "TT");
  const double wavelength_m = 299'792'458.0 / law_frequency_hz;
  const double free_space_db = 20.0 * std::log10(wavelength_m / (4.0 * pi * glm::distance(p, q)));
  // 1e-9 dB: rounding of a logarithm.
  CHECK(10.0 * std::log10(paths[0].power_ratio) == doctest::Approx(free_space_db - 40.0).epsilon(1e-11));
  CHECK(paths_between(scene_through_files(two), p, q, law_settings(0, 1)).empty());
}

TEST_CASE("no reflection path gains power: every path of a random room stays below its free-space power") {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const RandomRoom room = random_room(seed, 3, 1);
    const auto paths =
        paths_between(scene_through_files(room.patches), room.transmitter_m, room.receiver_m, law_settings(3, 2));
    const double wavelength_m = 299'792'458.0 / law_frequency_hz;
    for (const PathContribution& path : paths) {
      const double free_space = std::pow(wavelength_m / (4.0 * pi * path.path.length_m), 2);
      // Two orthogonal sent fields: the sum of what is received of both is at most twice the free-space power.
      CHECK(norm_squared(path.transfer) <= 2.0 * free_space * (1.0 + 1e-12));
    }
  }
}

}  // namespace test_energy
