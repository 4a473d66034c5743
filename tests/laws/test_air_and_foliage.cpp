/// What air and foliage take from a link, through the whole engine. Losses per kilometre are the tables' of the ITU,
/// lengths are by hand; where nothing is said of the air, nothing may change.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/law_scenes.hpp"

namespace test_air_and_foliage {

using namespace dcem;
using namespace dcem::test;

namespace {

Atmosphere gas_alone() {
  return Atmosphere{};
}

Atmosphere rain_alone(double rain_mm_per_h) {
  Atmosphere atmosphere;
  atmosphere.gas = false;
  atmosphere.rain_mm_per_h = rain_mm_per_h;
  return atmosphere;
}

Atmosphere gas_and_rain(double rain_mm_per_h) {
  Atmosphere atmosphere;
  atmosphere.rain_mm_per_h = rain_mm_per_h;
  return atmosphere;
}

SimulationSettings settings_for(double frequency_hz, const std::optional<Atmosphere>& atmosphere = std::nullopt) {
  SimulationSettings settings = law_settings(1, 2);
  settings.frequency_hz = frequency_hz;
  settings.propagation.atmosphere = atmosphere;
  return settings;
}

void add_patches(TriangleMesh& mesh, const Patches& patches) {
  for (const Patch& patch : patches) {
    const auto& c = patch.corners_m;
    add_quad(mesh, {c.at(0), c.at(1), c.at(2), c.at(3)}, patch.material);
  }
}

TriangleMesh mesh_of(const Patches& patches) {
  TriangleMesh mesh;
  add_patches(mesh, patches);
  return mesh;
}

/// Knows a mirror, a wall, a pane, and foliage of 2 dB/m, 5 dB/m, 0 dB/m and by frequency.
Scene scene_of(const Patches& scenery) {
  Scene scene;
  scene.add_material({"pec", PerfectConductor{}});
  scene.add_material({"opaque", ConstantReflection{0.8, std::nullopt}});
  scene.add_material({"glass", ConstantReflection{0.74, 5.0}});
  scene.add_material({"rough", PerfectConductor{}, 0.0, {0.6}});
  scene.add_material({"leaves", Foliage{2.0}});
  scene.add_material({"needles", Foliage{5.0}});
  scene.add_material({"air", Foliage{0.0}});
  scene.add_material({"black", Foliage{1000.0}});
  scene.add_material({"auto", Foliage{}});
  if (!scenery.empty()) scene.set_scenery(mesh_of(scenery));
  return scene;
}

void add_crown(Scene& scene, const std::string& id, const Vec3& low_m, const Vec3& high_m,
               const std::string& material) {
  scene.add_object(id, mesh_of(box_faces(low_m, high_m, material)), LinearMotion{});
}

/// The one link of a scene.
LinkResult link_between(Scene scene, const Vec3& transmitter_m, const Vec3& receiver_m,
                        const SimulationSettings& settings,
                        PolarizationKind polarization = PolarizationKind::vertical) {
  scene.add_transmitter(device_at("tx", transmitter_m, 0.0, antenna(polarization)));
  scene.add_receiver(device_at("rx", receiver_m, 0.0, antenna(polarization)));
  Simulator simulator(std::move(scene), settings);
  return simulator.advance_to(0.0).links.at(0);
}

const PathContribution& path_of(const LinkResult& link, const std::string& letters) {
  const auto found = std::find_if(link.paths.begin(), link.paths.end(),
                                  [&](const PathContribution& path) { return kinds(path) == letters; });
  if (found == link.paths.end()) throw std::logic_error("no path " + letters);
  return *found;
}

double gain_db(const PathContribution& path) {
  return 10.0 * std::log10(path.power_ratio);
}

/// What a link's only path loses by `atmosphere`.
double air_loss_db(const Vec3& from_m, const Vec3& to_m, double frequency_hz, const Atmosphere& atmosphere,
                   PolarizationKind polarization = PolarizationKind::vertical) {
  const LinkResult with =
      link_between(scene_of({}), from_m, to_m, settings_for(frequency_hz, atmosphere), polarization);
  const LinkResult without = link_between(scene_of({}), from_m, to_m, settings_for(frequency_hz), polarization);
  REQUIRE(with.paths.size() == 1);
  // Air takes field, and nothing else: no delay, no phase, no direction.
  CHECK(with.paths[0].delay_s == without.paths.at(0).delay_s);
  const Complex ratio = with.paths[0].amplitude / without.paths[0].amplitude;
  CHECK(std::abs(std::arg(ratio)) < 1e-15);
  CHECK(*with.statistics.power_dbm == doctest::Approx(gain_db(with.paths[0])).epsilon(1e-12));
  return gain_db(without.paths[0]) - gain_db(with.paths[0]);
}

const Vec3 kilometre_m(1000, 0, 50), here_m(0, 0, 50);

}  // namespace

TEST_CASE("gas takes the ITU's dB per kilometre from a line of sight") {
  // P.676-13 at 1013.25 hPa of dry air, 288.15 K, 7.5 g/m³, dB/km, to the digits that are given.
  struct Row {
    double frequency_hz, gas_db_per_km, last_digit;
  };
  for (const Row& row :
       {Row{5.9e9, 0.0094, 1e-4}, Row{28e9, 0.102, 1e-3}, Row{30e9, 0.094, 1e-3}, Row{38e9, 0.117, 1e-3},
        Row{60e9, 14.78, 1e-2}, Row{72e9, 0.419, 1e-3}, Row{77e9, 0.348, 1e-3}}) {
    CAPTURE(row.frequency_hz);
    const double loss_db = air_loss_db(here_m, kilometre_m, row.frequency_hz, gas_alone());
    CHECK(std::abs(loss_db - row.gas_db_per_km) < 0.51 * row.last_digit);
    // A quarter of the way, a quarter of the loss; the polarization does not matter.
    CHECK(air_loss_db(here_m, Vec3(0, 250, 50), row.frequency_hz, gas_alone(), PolarizationKind::horizontal) ==
          doctest::Approx(0.25 * loss_db).epsilon(1e-9).scale(0.0));
  }
}

TEST_CASE("the exact rows of the ITU's validation sheet, through the engine") {
  // 5, 6 and 24 GHz of the ITU's own examples, dB/km.
  CHECK(air_loss_db(here_m, kilometre_m, 5e9, gas_alone()) ==
        doctest::Approx(0.0087138851774633).epsilon(1e-9).scale(0.0));
  CHECK(air_loss_db(here_m, kilometre_m, 6e9, gas_alone()) ==
        doctest::Approx(0.00945878388736656).epsilon(1e-9).scale(0.0));
  CHECK(air_loss_db(here_m, kilometre_m, 24e9, gas_alone()) ==
        doctest::Approx(0.173161144145986).epsilon(1e-9).scale(0.0));
}

TEST_CASE("rain takes more from a horizontal field than from a vertical one, by the tables of P.838-3") {
  // k·R^α with k and α of Table 5 of P.838-3, R = 25 mm/h, a level path: dB/km, horizontal and vertical.
  struct Row {
    double frequency_hz, horizontal, vertical;
  };
  for (const Row& row : {Row{28e9, 4.6236, 3.8911}, Row{30e9, 5.0893, 4.3273}, Row{38e9, 6.8319, 6.0302},
                         Row{60e9, 10.1185, 9.4764}, Row{77e9, 11.4054, 10.9880}}) {
    CAPTURE(row.frequency_hz);
    const double h_db =
        air_loss_db(here_m, kilometre_m, row.frequency_hz, rain_alone(25), PolarizationKind::horizontal);
    const double v_db = air_loss_db(here_m, kilometre_m, row.frequency_hz, rain_alone(25), PolarizationKind::vertical);
    // Five digits of k and α: the last one of α is 3e-5 of the loss.
    CHECK(h_db == doctest::Approx(row.horizontal).epsilon(1e-4));
    CHECK(v_db == doctest::Approx(row.vertical).epsilon(1e-4));
  }
}

TEST_CASE("upwards in rain both polarizations lose the same; on a slant they are nearer than on the level") {
  // Eqs. (4) and (5) of P.838-3 with Table 5 at 28 GHz and 25 mm/h, worked out beforehand, dB/km: 45° and 90°.
  const double slant_m = 1000.0 * std::sqrt(0.5);
  const auto loss_db = [&](const Vec3& to_m, PolarizationKind polarization) {
    return air_loss_db(here_m, to_m, 28e9, rain_alone(25), polarization);
  };
  const Vec3 slant(slant_m, 0, 50 + slant_m), up(0, 0, 1050), down(slant_m, 0, 50 - slant_m);
  CHECK(loss_db(slant, PolarizationKind::horizontal) == doctest::Approx(4.4338).epsilon(1e-4));
  CHECK(loss_db(slant, PolarizationKind::vertical) == doctest::Approx(4.0676).epsilon(1e-4));
  CHECK(loss_db(down, PolarizationKind::horizontal) == doctest::Approx(4.4338).epsilon(1e-4));
  CHECK(loss_db(up, PolarizationKind::horizontal) == doctest::Approx(4.2485).epsilon(1e-4));
  CHECK(loss_db(up, PolarizationKind::vertical) == doctest::Approx(4.2485).epsilon(1e-4));
}

TEST_CASE("gas and rain add up in dB, and with the close-in model's loss per metre") {
  const double gas_db = air_loss_db(here_m, kilometre_m, 60e9, gas_alone());
  const double rain_db = air_loss_db(here_m, kilometre_m, 60e9, rain_alone(25));
  CHECK(air_loss_db(here_m, kilometre_m, 60e9, gas_and_rain(25)) == doctest::Approx(gas_db + rain_db).epsilon(1e-9));
  SimulationSettings both = settings_for(60e9, gas_alone());
  both.propagation.path_loss = {CloseIn{2.0, 0.003}};
  const LinkResult link = link_between(scene_of({}), here_m, kilometre_m, both);
  // Friis at 60 GHz over 1 km by hand: 20·log10(4π·1000·60e9/299792458) = 128.0108 dB.
  CHECK(gain_db(link.paths.at(0)) == doctest::Approx(-128.0108 - 3.0 - gas_db).epsilon(1e-6));
}

TEST_CASE("two rays over ground in rain: each ray loses by its own length, and they still interfere") {
  // Over a perfect conductor a horizontal field is turned over: h = λ/4π·(e^(−jkL1)·g1/L1 − e^(−jkL2)·g2/L2).
  const Patches ground{sheet(Vec3(150, 0, 0), Vec3(400, 0, 0), Vec3(0, 400, 0), "pec")};
  const Vec3 from_m(0, 0, 10), to_m(300, 0, 2);
  const double direct_m = std::sqrt(300.0 * 300.0 + 8.0 * 8.0), bounced_m = std::sqrt(300.0 * 300.0 + 12.0 * 12.0);
  // Rain of 25 mm/h at 60 GHz at these elevations (P.838-3 (4), (5) with Table 5, worked out beforehand) plus gas,
  // dB/km.
  const double rain_direct = 10.118152, rain_bounced = 10.117860;
  const double gas = air_loss_db(here_m, kilometre_m, 60e9, gas_alone());
  CHECK(std::abs(gas - 14.78) < 0.006);
  const LinkResult dry = link_between(scene_of(ground), from_m, to_m, settings_for(60e9), PolarizationKind::horizontal);
  const LinkResult wet =
      link_between(scene_of(ground), from_m, to_m, settings_for(60e9, gas_and_rain(25)), PolarizationKind::horizontal);
  REQUIRE(dry.paths.size() == 2);
  REQUIRE(wet.paths.size() == 2);
  const double lost_direct_db = (gas + rain_direct) * direct_m / 1000.0;
  const double lost_bounced_db = (gas + rain_bounced) * bounced_m / 1000.0;
  CHECK(gain_db(path_of(dry, "")) - gain_db(path_of(wet, "")) == doctest::Approx(lost_direct_db).epsilon(1e-5));
  CHECK(gain_db(path_of(dry, "R")) - gain_db(path_of(wet, "R")) == doctest::Approx(lost_bounced_db).epsilon(1e-5));
  const double wavelength_m = 299'792'458.0 / 60e9, k = 2.0 * pi / wavelength_m;
  const auto ray = [&](double length_m, double lost_db) {
    return std::polar(wavelength_m / (4.0 * pi * length_m) * std::pow(10.0, -lost_db / 20.0), -k * length_m);
  };
  const double expected_db =
      20.0 * std::log10(std::abs(ray(direct_m, lost_direct_db) - ray(bounced_m, lost_bounced_db)));
  // The rays' difference is some ten times smaller than each: 1e-5 of a dB of each is 1e-4 of theirs.
  CHECK(std::abs(*wet.statistics.power_dbm - expected_db) < 1e-3);
}

TEST_CASE("without air, and with one that takes nothing, every bit stays as it was") {
  Atmosphere nothing = rain_alone(0.0);
  nothing.temperature_k = 300.0;  // of no effect
  std::size_t compared = 0;
  for (const std::uint64_t seed : {3U, 4U, 5U}) {
    const RandomRoom room = random_room(seed, 2, 1);
    const Scene scene = scene_through_files(room.patches);
    const SimulationSettings plain = law_settings(2, 2);
    SimulationSettings empty = plain;
    empty.propagation.atmosphere = nothing;
    const auto before = paths_between(scene, room.transmitter_m, room.receiver_m, plain);
    const auto after = paths_between(scene, room.transmitter_m, room.receiver_m, empty);
    REQUIRE(before.size() == after.size());
    for (std::size_t path = 0; path < before.size(); ++path) {
      std::string one, other;
      append_bits(one, all_numbers(before[path]));
      append_bits(other, all_numbers(after[path]));
      CHECK(one == other);
      ++compared;
    }
  }
  CHECK(compared > 30);
}

TEST_CASE("a crown that no path meets, and one that takes nothing, change no number") {
  const Patches ground{sheet(Vec3(0, 0, 0), Vec3(50, 0, 0), Vec3(0, 50, 0), "opaque")};
  const Vec3 from_m(-10, 0, 5), to_m(10, 1, 3);
  const auto numbers = [&](const std::string& material, const Vec3& low_m) {
    Scene scene = scene_of(ground);
    if (!material.empty()) add_crown(scene, "crown", low_m, low_m + Vec3(3, 3, 6), material);
    std::vector<double> all;
    const LinkResult link = link_between(std::move(scene), from_m, to_m, settings_for(28e9), PolarizationKind::dual);
    for (const PathContribution& path : link.paths) {
      for (const double number : all_numbers(path)) all.push_back(number);
    }
    CHECK(link.paths.size() == 2);
    return all;
  };
  const std::vector<double> bare = numbers("", Vec3(0.0));
  CHECK(bare == numbers("leaves", Vec3(0, 5, 0)));    // beside
  CHECK(bare == numbers("leaves", Vec3(20, -1, 0)));  // behind the receiver
  CHECK(bare == numbers("air", Vec3(-1, -1, 0)));
  CHECK(bare != numbers("leaves", Vec3(-1, -1, 0)));
}

TEST_CASE("foliage takes dB per metre times metres, the same of every polarization, and no time") {
  const Vec3 from_m(-20, 0, 3), to_m(20, 0, 3);
  for (const double width_m : {0.25, 1.0, 7.5}) {
    Scene scene = scene_of({});
    add_crown(scene, "crown", Vec3(2, -3, 0), Vec3(2 + width_m, 3, 6), "leaves");
    const LinkResult behind = link_between(scene, from_m, to_m, settings_for(28e9), PolarizationKind::dual);
    const LinkResult free = link_between(scene_of({}), from_m, to_m, settings_for(28e9), PolarizationKind::dual);
    REQUIRE(behind.paths.size() == 1);
    for (const std::size_t entry : {0U, 1U}) {
      const Complex ratio = behind.paths[0].transfer(entry, entry) / free.paths.at(0).transfer(entry, entry);
      CHECK(20.0 * std::log10(std::abs(ratio)) == doctest::Approx(-2.0 * width_m).epsilon(1e-9));
      CHECK(std::abs(std::arg(ratio)) < 1e-15);
    }
    CHECK(behind.paths[0].delay_s == free.paths[0].delay_s);
    CHECK(behind.paths[0].path.length_m == free.paths[0].path.length_m);
    CHECK(*free.statistics.power_dbm - *behind.statistics.power_dbm == doctest::Approx(2.0 * width_m).epsilon(1e-9));
  }
}

TEST_CASE("foliage by frequency takes 0.79·f^0.61 dB per metre, f in GHz") {
  // 10^0.61 = 4.073803, 100^0.61 = 16.59587, 28^0.61 = 7.634250, 60^0.61 = 12.152686 by tables of logarithms.
  const std::map<double, double> expected_db_per_m{
      {1e9, 0.79}, {10e9, 3.218304}, {28e9, 6.031058}, {60e9, 9.600622}, {100e9, 13.110737}};
  for (const auto& row : expected_db_per_m) {
    const double frequency_hz = row.first, db_per_m = row.second;
    CAPTURE(frequency_hz);
    Scene scene = scene_of({});
    add_crown(scene, "crown", Vec3(0, -1, 0), Vec3(2, 1, 6), "auto");
    const Vec3 from_m(-20, 0, 3), to_m(20, 0, 3);
    const LinkResult behind = link_between(scene, from_m, to_m, settings_for(frequency_hz));
    const LinkResult free = link_between(scene_of({}), from_m, to_m, settings_for(frequency_hz));
    CHECK(gain_db(free.paths.at(0)) - gain_db(behind.paths.at(0)) == doctest::Approx(2.0 * db_per_m).epsilon(1e-6));
  }
}

TEST_CASE("outside 1 to 100 GHz foliage by frequency has no model; a number of one's own holds anywhere") {
  for (const double frequency_hz : {0.9e9, 200e9}) {
    Scene by_frequency = scene_of({});
    CHECK_THROWS_AS(link_between(by_frequency, Vec3(0.0), Vec3(1, 0, 0), settings_for(frequency_hz)),
                    std::invalid_argument);
    Scene own;
    own.add_material({"leaves", Foliage{2.0}});
    add_crown(own, "crown", Vec3(0, -1, 0), Vec3(2, 1, 6), "leaves");
    const LinkResult link = link_between(own, Vec3(-5, 0, 3), Vec3(9, 0, 3), settings_for(frequency_hz));
    const LinkResult free = link_between(Scene{}, Vec3(-5, 0, 3), Vec3(9, 0, 3), settings_for(frequency_hz));
    CHECK(gain_db(free.paths.at(0)) - gain_db(link.paths.at(0)) == doctest::Approx(4.0).epsilon(1e-9));
  }
  for (const double frequency_hz : {0.5e9, 1001e9}) {
    Scene empty;
    CHECK_THROWS_AS(link_between(empty, Vec3(0.0), Vec3(1, 0, 0), settings_for(frequency_hz, gas_alone())),
                    std::invalid_argument);
    CHECK_THROWS_AS(link_between(empty, Vec3(0.0), Vec3(1, 0, 0), settings_for(frequency_hz, rain_alone(1))),
                    std::invalid_argument);
  }
}

TEST_CASE("behind foliage there is no line of sight, though the direct path is there") {
  const Vec3 from_m(-20, 0, 3), to_m(20, 0, 3);
  Scene scene = scene_of({});
  add_crown(scene, "crown", Vec3(2, -3, 0), Vec3(3, 3, 6), "leaves");
  for (const bool asked_for : {true, false}) {
    SimulationSettings settings = settings_for(28e9);
    settings.propagation.line_of_sight = asked_for;
    const LinkResult behind = link_between(scene, from_m, to_m, settings);
    const LinkResult beside = link_between(scene, from_m, Vec3(20, 20, 3), settings);
    const LinkResult above = link_between(scene, Vec3(-20, 0, 6.5), Vec3(20, 0, 6.5), settings);
    CHECK_FALSE(behind.statistics.line_of_sight);
    CHECK(beside.statistics.line_of_sight);
    CHECK(above.statistics.line_of_sight);
    CHECK(behind.paths.size() == (asked_for ? 1 : 0));
    CHECK(behind.statistics.path_count == (asked_for ? 1 : 0));
    if (asked_for) CHECK(kinds(behind.paths[0]).empty());
  }
  // Foliage that takes nothing is still no free segment.
  Scene clear = scene_of({});
  add_crown(clear, "crown", Vec3(2, -3, 0), Vec3(3, 3, 6), "air");
  CHECK_FALSE(link_between(clear, from_m, to_m, settings_for(28e9)).statistics.line_of_sight);
}

TEST_CASE("a reflected path loses where its legs pass a crown, whatever the direct one does") {
  const Patches ground{sheet(Vec3(0, 0, 0), Vec3(50, 0, 0), Vec3(0, 50, 0), "pec")};
  const Vec3 from_m(-10, 0, 5), to_m(10, 0, 5);  // the ground reflects at the origin, both legs fall 1 in 2
  const auto lost_db = [&](const std::vector<std::pair<Vec3, Vec3>>& crowns, const std::string& letters) {
    Scene scene = scene_of(ground);
    int number = 0;
    for (const auto& [low_m, high_m] : crowns) {
      add_crown(scene, "crown" + std::to_string(number++), low_m, high_m, "leaves");
    }
    const LinkResult green = link_between(scene, from_m, to_m, settings_for(28e9));
    const LinkResult bare = link_between(scene_of(ground), from_m, to_m, settings_for(28e9));
    CHECK(green.paths.size() == 2);
    return gain_db(path_of(bare, letters)) - gain_db(path_of(green, letters));
  };
  const double along = std::sqrt(1.25);  // metres of leg per metre of x
  const std::pair<Vec3, Vec3> first{Vec3(-6, -1, 0), Vec3(-4, 1, 4)}, second{Vec3(3, -1, 0), Vec3(6, 1, 4)},
      hedge{Vec3(-1, -1, 0), Vec3(2, 1, 2)}, high{Vec3(-1, -1, 3), Vec3(1, 1, 8)};
  CHECK(lost_db({first}, "R") == doctest::Approx(2.0 * 2.0 * along).epsilon(1e-9));
  CHECK(lost_db({first}, "") == doctest::Approx(0.0));
  CHECK(lost_db({second}, "R") == doctest::Approx(2.0 * 3.0 * along).epsilon(1e-9));
  CHECK(lost_db({first, second}, "R") == doctest::Approx(2.0 * 5.0 * along).epsilon(1e-9));
  CHECK(lost_db({hedge}, "R") == doctest::Approx(2.0 * 3.0 * along).epsilon(1e-9));  // around the point of reflection
  CHECK(lost_db({high}, "R") == doctest::Approx(0.0));
  CHECK(lost_db({high}, "") == doctest::Approx(2.0 * 2.0).epsilon(1e-9));
  CHECK(lost_db({high, first}, "") == doctest::Approx(2.0 * 2.0).epsilon(1e-9));
  CHECK(lost_db({high, first}, "R") == doctest::Approx(2.0 * 2.0 * along).epsilon(1e-9));
}

TEST_CASE("a path through a pane that stands in a crown pays both") {
  const Patches pane{sheet(Vec3(5, 0, 5), Vec3(0, 5, 0), Vec3(0, 0, 5), "glass")};
  Scene scene = scene_of(pane);
  add_crown(scene, "crown", Vec3(4, -2, 0), Vec3(7, 2, 9), "leaves");
  add_crown(scene, "fir", Vec3(8, -2, 0), Vec3(9, 2, 9), "needles");
  const Vec3 from_m(0, 0, 5), to_m(12, 0, 5);
  const LinkResult link = link_between(scene, from_m, to_m, settings_for(28e9));
  const LinkResult free = link_between(scene_of({}), from_m, to_m, settings_for(28e9));
  REQUIRE(link.paths.size() == 1);
  CHECK(kinds(link.paths[0]) == "T");
  // 5 dB of pane, 3 m of 2 dB/m, 1 m of 5 dB/m.
  CHECK(gain_db(free.paths.at(0)) - gain_db(link.paths[0]) == doctest::Approx(5.0 + 6.0 + 5.0).epsilon(1e-9));
  // With no crossing left the pane blocks; the crown does not.
  SimulationSettings none = settings_for(28e9);
  none.propagation.max_transmissions = 0;
  none.propagation.max_reflections = 0;
  CHECK(link_between(scene, from_m, to_m, none).paths.empty());
  CHECK(link_between(scene, Vec3(6, 0, 5), to_m, none).paths.size() == 1);
}

TEST_CASE("a diffracted path loses by air and foliage, too") {
  // A screen of one sheet, free rim on top at z = 8.
  const Patches screen{sheet(Vec3(0, 0, 0), Vec3(0, 60, 0), Vec3(0, 0, 8), "pec")};
  const Vec3 from_m(-30, 0, 2), to_m(40, 0, 2);
  SimulationSettings settings = settings_for(60e9);
  settings.propagation.max_reflections = 0;
  settings.propagation.max_diffractions = 1;
  settings.propagation.diffraction.free_edges = true;
  const LinkResult bare = link_between(scene_of(screen), from_m, to_m, settings);
  Scene scene = scene_of(screen);
  add_crown(scene, "crown", Vec3(10, -2, 0), Vec3(20, 2, 20), "leaves");
  settings.propagation.atmosphere = gas_alone();
  const LinkResult green = link_between(scene, from_m, to_m, settings);
  const PathContribution &before = path_of(bare, "D"), &after = path_of(green, "D");
  CHECK(after.path.interactions.at(0).point_m.z == doctest::Approx(8.0));
  const double gas_db_per_km = air_loss_db(here_m, kilometre_m, 60e9, gas_alone());
  // Down from the rim: 6 m over 40 m of way.
  const double within_m = 10.0 * std::sqrt(1.0 + 0.15 * 0.15);
  const double expected_db = 2.0 * within_m + gas_db_per_km * after.path.length_m / 1000.0;
  CHECK(gain_db(before) - gain_db(after) == doctest::Approx(expected_db).epsilon(1e-9));
}

TEST_CASE("reciprocity holds in rain and through foliage") {
  std::size_t compared = 0, through = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    Dice dice(seed);
    const RandomRoom room = random_room(400 + seed, 2, 1);
    Scene scene = scene_through_files(room.patches);
    scene.add_material({"leaves", Foliage{2.0}});
    scene.add_material({"needles", Foliage{}});
    for (int crown = 0; crown < 3; ++crown) {
      const Vec3 low_m = dice.inside(Vec3(0.0), 0.6 * room.size_m), size_m = dice.inside(Vec3(0.5), Vec3(3.0));
      add_crown(scene, "crown" + std::to_string(crown), low_m, low_m + size_m, crown == 1 ? "needles" : "leaves");
    }
    SimulationSettings settings = law_settings(2, 2);
    settings.propagation.max_diffractions = 1;
    settings.propagation.atmosphere = gas_and_rain(500);
    const auto forth = paths_between(scene, room.transmitter_m, room.receiver_m, settings);
    const auto back = paths_between(scene, room.receiver_m, room.transmitter_m, settings);
    REQUIRE(forth.size() == back.size());
    double largest = 0.0;
    for (const PathContribution& path : forth) largest = std::max(largest, std::sqrt(norm_squared(path.transfer)));
    std::map<std::string, const PathContribution*> by_name;
    const auto name = [](const Path& path, bool backwards) {
      std::vector<std::string> parts;
      for (const Interaction& at : path.interactions) {
        const bool edge = at.kind == InteractionKind::diffraction;
        parts.push_back(static_cast<char>(at.kind) + std::to_string(edge ? at.wedge.value : at.facet.value) + " ");
      }
      if (backwards) std::reverse(parts.begin(), parts.end());
      return std::accumulate(parts.begin(), parts.end(), std::string());
    };
    for (const PathContribution& path : back) by_name[name(path.path, true)] = &path;
    for (const PathContribution& path : forth) {
      const auto found = by_name.find(name(path.path, false));
      REQUIRE(found != by_name.end());
      const ComplexMatrix2 reversed = transposed(found->second->transfer);
      // As in the law of reciprocity: rounding of the coefficients and of kL. At edges 1e-9, the rounding of Q.
      for (std::size_t entry = 0; entry < 4; ++entry) {
        const Complex difference = path.transfer(entry / 2, entry % 2) - reversed(entry / 2, entry % 2);
        CHECK(std::abs(difference) <= 1e-9 * largest);
      }
      ++compared;
      through += !path.path.foliage.empty();
    }
  }
  CHECK(compared > 300);
  CHECK(through > 100);
}

namespace {

/// A plate of 0.2 m at the origin, tilted so that it mirrors nothing to the receiver; seen from −x and from −y.
Patches plate() {
  const Vec3 u = glm::normalize(Vec3(0.6, -1.0, 0.0)), v(0, 0, 1);
  return {sheet(Vec3(0.0), 0.1 * u, 0.1 * v, "rough")};
}

double diffuse_ratio(const Scene& scene, const SimulationSettings& base, const Vec3& from_m, const Vec3& to_m,
                     PolarizationKind polarization = PolarizationKind::vertical) {
  SimulationSettings settings = base;
  settings.propagation.diffuse.enabled = true;
  settings.propagation.diffuse.list_paths = true;
  settings.propagation.diffuse.tolerance_db = 0.01;
  const LinkResult link = link_between(scene, from_m, to_m, settings, polarization);
  CHECK(link.diffuse.converged);
  REQUIRE(link.diffuse.power_ratio > 0.0);
  double sum = 0.0;
  for (const DiffuseContribution& tile : link.diffuse.tiles) sum += tile.sample.power_ratio;
  CHECK(sum == doctest::Approx(link.diffuse.power_ratio).epsilon(1e-12).scale(0.0));
  CHECK(*link.statistics.power_diffuse_dbm == doctest::Approx(10.0 * std::log10(sum)).epsilon(1e-12));
  return link.diffuse.power_ratio;
}

}  // namespace

TEST_CASE("diffuse power passes the air on the whole way") {
  const Vec3 from_m(-200, 0, 0), to_m(0, -150, 0);
  const Scene scene = scene_of(plate());
  const double dry = diffuse_ratio(scene, settings_for(60e9), from_m, to_m);
  const auto lost_db = [&](const Atmosphere& atmosphere, PolarizationKind polarization = PolarizationKind::vertical) {
    return 10.0 * std::log10(diffuse_ratio(scene, settings_for(60e9), from_m, to_m, polarization) /
                             diffuse_ratio(scene, settings_for(60e9, atmosphere), from_m, to_m, polarization));
  };
  CHECK(dry > 0.0);
  // The plate is 0.2 m wide: lengths differ by as much at most, 0.003 dB; half a digit of 14.78 is 0.002 dB.
  CHECK(std::abs(lost_db(gas_alone()) - 14.78 * 0.350) < 0.006);
  // Unpolarized: something between what a horizontal and a vertical field lose, P.838-3 as above.
  for (const PolarizationKind polarization : {PolarizationKind::vertical, PolarizationKind::horizontal}) {
    const double rain_db = lost_db(rain_alone(25), polarization);
    CHECK(rain_db > 9.4764 * 0.350 - 0.003);
    CHECK(rain_db < 10.1185 * 0.350 + 0.003);
  }
}

TEST_CASE("diffuse power passes foliage on both of its legs") {
  const Vec3 from_m(-200, 0, 0), to_m(0, -150, 0);
  const double bare = diffuse_ratio(scene_of(plate()), settings_for(28e9), from_m, to_m);
  const auto lost_db = [&](bool first, bool second) {
    Scene scene = scene_of(plate());
    // Walls of leaves across the leg: 3 m and 1 m thick; the legs are within 0.001 of the perpendicular.
    if (first) add_crown(scene, "one", Vec3(-50, -5, -5), Vec3(-47, 5, 5), "leaves");
    if (second) add_crown(scene, "two", Vec3(-5, -31, -5), Vec3(5, -30, 5), "needles");
    return 10.0 * std::log10(bare / diffuse_ratio(scene, settings_for(28e9), from_m, to_m));
  };
  // Tiles need not be the same with and without: both sums are good to 0.01 dB.
  CHECK(lost_db(true, false) == doctest::Approx(6.0).epsilon(0.003));
  CHECK(lost_db(false, true) == doctest::Approx(5.0).epsilon(0.003));
  CHECK(lost_db(true, true) == doctest::Approx(11.0).epsilon(0.003));
}

TEST_CASE("each tile has the foliage of its own way") {
  // A wall, half of it behind a hedge as seen from the transmitter.
  const Patches wall{sheet(Vec3(0, 10, 3), Vec3(20, 0, 0), Vec3(0, 0, 3), "rough")};
  Scene scene = scene_of(wall);
  add_crown(scene, "hedge", Vec3(0, 4, -1), Vec3(25, 6, 7), "leaves");
  SimulationSettings settings = settings_for(28e9, gas_and_rain(25));
  settings.propagation.diffuse.enabled = true;
  settings.propagation.diffuse.list_paths = true;
  const Vec3 from_m(-1, -10, 3), to_m(-12, -5, 2);
  const LinkResult green = link_between(scene, from_m, to_m, settings);
  // By hand: a leg crosses 4 < y < 6 where it has come by these shares, at x > 0 or at x < 0 or partly so.
  const auto within_hedge_m = [](const Vec3& end_m, const Vec3& point_m) {
    const double enter = (4.0 - end_m.y) / (point_m.y - end_m.y), leave = (6.0 - end_m.y) / (point_m.y - end_m.y);
    const double x_enter = end_m.x + enter * (point_m.x - end_m.x), x_leave = end_m.x + leave * (point_m.x - end_m.x);
    double share = leave - enter;
    if (x_leave <= 0.0) share = 0.0;
    if (x_leave > 0.0 && x_enter < 0.0) share *= x_leave / (x_leave - x_enter);
    return share * glm::distance(end_m, point_m);
  };
  std::size_t behind = 0, beside = 0;
  for (const DiffuseContribution& tile : green.diffuse.tiles) {
    const Vec3& point_m = tile.path.interactions.at(0).point_m;
    const double expected_m = within_hedge_m(from_m, point_m) + within_hedge_m(to_m, point_m);
    double found_m = 0.0;
    for (const FoliageLength& part : tile.path.foliage) found_m += part.length_m;
    CHECK(std::abs(found_m - expected_m) < 1e-9);
    behind += found_m > 0.0;
    beside += found_m == 0.0;
  }
  CHECK(behind > 3);
  CHECK(beside > 3);
}

TEST_CASE("a crown that lets nothing through leaves no NaN, no infinity and no power") {
  Scene scene = scene_of({});
  add_crown(scene, "crown", Vec3(0, -20, -20), Vec3(100, 20, 20), "black");
  const LinkResult link = link_between(scene, Vec3(-5, 0, 0), Vec3(105, 0, 0), settings_for(28e9));
  REQUIRE(link.paths.size() == 1);
  CHECK(link.paths[0].power_ratio == 0.0);
  for (const double number : all_numbers(link.paths[0])) CHECK(std::isfinite(number));
  for (const double number : all_numbers(link.statistics)) CHECK(std::isfinite(number));
  CHECK_FALSE(link.statistics.power_dbm.has_value());
  CHECK_FALSE(link.statistics.k_factor_db.has_value());
  CHECK_FALSE(link.statistics.line_of_sight);
}

TEST_CASE("the filter on weak paths looks at what foliage and air have left") {
  const Vec3 from_m(-20, 0, 3), to_m(20, 0, 3);
  Scene scene = scene_of({});
  add_crown(scene, "crown", Vec3(0, -3, 0), Vec3(5, 3, 6), "leaves");
  // Friis over 40 m at 28 GHz by hand: 93.432 dB; 10 dB of foliage.
  SimulationSettings settings = settings_for(28e9);
  settings.propagation.min_path_gain_db = -103.5;
  CHECK(link_between(scene, from_m, to_m, settings).paths.size() == 1);
  settings.propagation.min_path_gain_db = -103.4;
  CHECK(link_between(scene, from_m, to_m, settings).paths.empty());
  CHECK(link_between(scene_of({}), from_m, to_m, settings).paths.size() == 1);
}

TEST_CASE("elements of an array that are traced one by one have their own foliage") {
  // Two elements 3 m apart, one above the other (10 wavelengths at 1 GHz); leaves before the upper one alone.
  Scene scene;
  scene.add_material({"leaves", Foliage{2.0}});
  add_crown(scene, "crown", Vec3(20, -5, 10.5), Vec3(23, 5, 20), "leaves");
  Device tall = device_at("tx", Vec3(0, 0, 10));
  tall.antenna.array = {2, 1, 10.0};
  scene.add_transmitter(tall);
  scene.add_receiver(device_at("rx", Vec3(2000, 0, 10)));
  SimulationSettings settings = settings_for(299'792'458.0 / 0.3);
  settings.propagation.antenna_array = ArrayChannel::exact;
  Simulator simulator(std::move(scene), settings);
  const LinkResult link = simulator.advance_to(0.0).links.at(0);
  REQUIRE(link.paths.size() == 1);
  REQUIRE(link.paths[0].channel.columns() == 2);
  const double ratio = std::abs(link.paths[0].channel(0, 1)) / std::abs(link.paths[0].channel(0, 0));
  CHECK(20.0 * std::log10(ratio) == doctest::Approx(-6.0).epsilon(1e-5));  // the legs fall by 0.00075 rad
}

TEST_CASE("how many threads work changes no bit, and a map holds what a receiver there gets") {
  const auto simulator = [](unsigned threads) {
    Scene scene = scene_of({sheet(Vec3(0, 0, 0), Vec3(50, 0, 0), Vec3(0, 50, 0), "rough")});
    add_crown(scene, "crown", Vec3(-2, -3, 0), Vec3(3, 3, 6), "leaves");
    scene.add_transmitter(device_at("tx", Vec3(-20, 0.5, 5)));
    for (int column = 0; column < 4; ++column) {
      scene.add_receiver(device_at("area[0," + std::to_string(column) + "]", Vec3(4.0 * column, 0, 1.5)));
    }
    SimulationSettings settings = settings_for(60e9, gas_and_rain(50));
    settings.propagation.diffuse.enabled = true;
    settings.threads = threads;
    return Simulator(std::move(scene), settings);
  };
  Simulator one = simulator(1), four = simulator(4);
  const FrameResult alone = one.advance_to(0.0), together = four.advance_to(0.0);
  const RadioMap map = four.radio_maps({"area", Vec3(0, 0, 1.5), {4.0, 1.0}, {4, 1}, {}}).at(0);
  for (std::size_t link = 0; link < 4; ++link) {
    CHECK(bits(one.scene(), alone.links.at(link)) == bits(four.scene(), together.links.at(link)));
    CHECK(alone.links[link].diffuse.power_ratio == together.links[link].diffuse.power_ratio);
    CHECK(all_numbers(map.points.at(link).statistics) == all_numbers(alone.links[link].statistics));
    CHECK(map.points[link].statistics.power_diffuse_dbm == alone.links[link].statistics.power_diffuse_dbm);
  }
}

}  // namespace test_air_and_foliage
