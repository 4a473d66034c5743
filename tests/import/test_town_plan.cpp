/// Outlines as found become blocks: closed, with all roofs, without a wall twice.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/import/import_case.hpp"

namespace test_town_plan {

using namespace dcem;
using dcem::test::check_clean_town;
using dcem::test::import_polygons;
using dcem::test::param;
using dcem::test::poly;
using dcem::test::TemporaryFolder;

namespace {

std::string box(double x_low, double y_low, double x_high, double y_high) {
  return dcem::test::shape_text({{x_low, y_low}, {x_high, y_low}, {x_high, y_high}, {x_low, y_high}});
}

std::string height(const std::string& height_m) {
  return param("height", height_m);
}

double wall_area_m2(const std::filesystem::path& folder) {
  for (const io::InspectedMaterial& material : io::inspect_obj(folder / "scene.obj").materials) {
    if (material.name == "wall") return material.area_m2;
  }
  return 0.0;
}

/// A house with corners at random distances from its middle: no outline crosses itself, some are thin.
std::string random_house(std::mt19937& random, double x_m, double y_m) {
  std::uniform_real_distribution<double> distance_m(2.0, 14.0);
  std::uniform_int_distribution<int> corner_count(3, 9);
  const int corners = corner_count(random);
  io::Ring ring;
  for (int corner = 0; corner < corners; ++corner) {
    const double angle_rad = 2.0 * std::numbers::pi * corner / corners;
    const double out_m = distance_m(random);
    ring.emplace_back(x_m + out_m * std::cos(angle_rad), y_m + out_m * std::sin(angle_rad));
  }
  return dcem::test::shape_text(ring);
}

}  // namespace

TEST_CASE("a house alone: five faces") {
  DCEM_NEEDS_GEOS();
  const TemporaryFolder folder;
  const io::ImportReport report = import_polygons(folder, poly("a", box(0, 10, 10, 30), height("6")));
  check_clean_town(folder / "made", report);
  CHECK(report.sizes.at("volume_m3") == 1200.0);
  CHECK(wall_area_m2(folder / "made") == doctest::Approx(60.0 * 6.0));
  const io::Inspection seen = io::inspect_obj(folder / "made/scene.obj");
  CHECK(seen.facets == 6);         // with the ground
  CHECK(seen.wedges.wedges == 8);  // four corners, four roof edges
}

TEST_CASE("touching houses share no wall, whatever their heights") {
  DCEM_NEEDS_GEOS();
  for (const io::TouchingHouses touching : {io::TouchingHouses::unite, io::TouchingHouses::snap}) {
    CAPTURE(static_cast<int>(touching));
    io::ImportSettings settings;
    settings.touching = touching;
    const bool unites = touching == io::TouchingHouses::unite;
    {
      const TemporaryFolder folder;
      const auto report = import_polygons(
          folder, poly("a", box(0, 10, 10, 20), height("6")) + poly("b", box(10, 10, 20, 20), height("6")), settings);
      check_clean_town(folder / "made", report);
      CHECK(report.made.at("roofs") == (unites ? 1 : 2));
      CHECK(wall_area_m2(folder / "made") == doctest::Approx(60.0 * 6.0));
      CHECK_FALSE(report.made.contains("steps between roofs"));
    }
    {
      const TemporaryFolder folder;  // in the midst of a longer wall, and lower
      const auto report = import_polygons(
          folder, poly("a", box(0, 10, 10, 40), height("9")) + poly("b", box(10, 20, 20, 30), height("4")), settings);
      check_clean_town(folder / "made", report);
      CHECK(report.made.at("roofs") == 2);
      CHECK(report.made.at("steps between roofs") == 1);
      CHECK(wall_area_m2(folder / "made") == doctest::Approx(80.0 * 9.0 - 10.0 * 4.0 + 30.0 * 4.0));
      CHECK(report.sizes.at("volume_m3") == doctest::Approx(300.0 * 9.0 + 100.0 * 4.0));
    }
  }
}

TEST_CASE("a gap of a few centimetres and an overlap of a few are no gap and no overlap") {
  DCEM_NEEDS_GEOS();
  for (const double gap_m : {0.04, -0.04}) {
    CAPTURE(gap_m);
    const TemporaryFolder folder;
    const auto report = import_polygons(
        folder, poly("a", box(0, 10, 10, 20), height("6")) + poly("b", box(10 + gap_m, 10, 20, 20), height("8")));
    check_clean_town(folder / "made", report);
    CHECK(report.made.at("steps between roofs") == 1);
    CHECK(io::inspect_obj(folder / "made/scene.obj").report.standing_shells == 1);
    CHECK(report.repaired.contains("houses snapped to their neighbours"));
  }
}

TEST_CASE("where houses overlap the higher one stands") {
  DCEM_NEEDS_GEOS();
  const TemporaryFolder folder;
  const auto report = import_polygons(
      folder, poly("a", box(0, 10, 20, 30), height("6")) + poly("b", box(10, 20, 30, 40), height("12")));
  check_clean_town(folder / "made", report);
  CHECK(report.sizes.at("volume_m3") == doctest::Approx(300.0 * 6.0 + 400.0 * 12.0));
  CHECK(report.repaired.at("houses that overlap, the higher kept there") == 2);
}

TEST_CASE("a courtyard stays open, a house in it stands free") {
  DCEM_NEEDS_GEOS();
  const TemporaryFolder folder;
  // The ring as one outline that runs around and back: it touches itself along a line.
  const std::string ring = "0,10 60,10 60,70 0,70 0,10 20,30 20,50 40,50 40,30 20,30";
  const auto report =
      import_polygons(folder, poly("a", ring, height("10")) + poly("b", box(28, 38, 32, 42), height("3")));
  check_clean_town(folder / "made", report);
  CHECK(report.sizes.at("footprint_area_m2") == doctest::Approx(3600.0 - 400.0 + 16.0));
  CHECK(report.repaired.at("houses whose outline crosses itself") == 1);
  CHECK(io::inspect_obj(folder / "made/scene.obj").report.standing_shells == 2);
}

TEST_CASE("corners that touch in a point are parted") {
  DCEM_NEEDS_GEOS();
  const TemporaryFolder folder;
  const auto report =
      import_polygons(folder, poly("a", box(0, 10, 10, 20), height("6")) + poly("b", box(10, 20, 20, 30), height("6")));
  check_clean_town(folder / "made", report);
  CHECK(report.repaired.at("houses: corners that touched in a point, parted") == 1);
  CHECK(io::inspect_obj(folder / "made/scene.obj").report.standing_shells == 2);
}

TEST_CASE("a tower whose corner stands in the wall of the house below it") {
  DCEM_NEEDS_GEOS();
  const TemporaryFolder folder;
  const std::string tower = dcem::test::shape_text({{10, 10}, {14, 15}, {10, 20}, {6, 15}});
  const io::ImportReport report =
      import_polygons(folder, poly("house", box(0, 10, 20, 30), height("6")) + poly("tower", tower, height("12")));
  check_clean_town(folder / "made", report);  // below the lower roof two walls meet in that corner, above it two
  CHECK(report.made.at("roofs") == 2);
  CHECK(report.sizes.at("volume_m3") == doctest::Approx(400.0 * 6.0 + 40.0 * 6.0));
}

TEST_CASE("dirty outlines are repaired or skipped, and counted") {
  DCEM_NEEDS_GEOS();
  const TemporaryFolder folder;
  const std::string spike = "0,10 10,10 10,15 18,15 10,15 10,20 0,20";
  const std::string bow_tie = "40,10 50,20 50,10 40,20";
  const std::string repeated = "60,10 60,10 70,10 70,20 70,20 60,20 60,10";
  const auto report = import_polygons(
      folder, poly("spike", spike) + poly("tie", bow_tie) + poly("repeated", repeated) + poly("two", "80,10 90,10") +
                  poly("line", "80,10 90,10 100,10") + poly("once", box(100, 40, 110, 50)) +
                  poly("again", box(100, 40, 110, 50), height("20")) + poly("park", box(0, 60, 20, 80), "", "leisure"));
  check_clean_town(folder / "made", report);
  CHECK(report.read.at("houses") == 7);
  CHECK(report.repaired.at("houses with spikes") == 1);
  CHECK(report.repaired.at("houses whose outline crosses itself") == 1);
  CHECK(report.repaired.at("houses with repeated corners") == 1);
  CHECK(report.skipped.at("houses with fewer than three corners") == 2);
  CHECK(report.skipped.at("houses there already") == 1);
  CHECK(report.skipped.at("polygons of type 'leisure'") == 1);
  // 100 m², two triangles of 25, 100 m², and the higher of two.
  CHECK(report.sizes.at("volume_m3") == doctest::Approx(9.0 * (100.0 + 50.0 + 100.0) + 20.0 * 100.0).epsilon(1e-3));
  const auto json = dcem::test::read_json(folder / "made/report.json");
  CHECK(json["skipped"]["houses there already"] == 1);
  CHECK(json["settings"]["touching_houses"] == "union");
}

TEST_CASE("heights: length with its unit, storeys, default; materials by the words of the tags") {
  DCEM_NEEDS_GEOS();
  const TemporaryFolder folder;
  const auto report = import_polygons(
      folder,
      poly("a", box(0, 10, 10, 20), height("40 ft")) +
          poly("b", box(20, 10, 30, 20), param("building:levels", "4") + param("roof:levels", "1")) +
          poly("c", box(40, 10, 50, 20), param("building:material", "brick") + param("roof:material", "metal")) +
          poly("d", box(60, 10, 70, 20), height("tall")) + poly("e", box(80, 10, 90, 20), height("1e9")) +
          poly("f", box(100, 10, 110, 20), param("building:levels", "1e9")) +
          poly("g", box(120, 10, 130, 20), param("building:levels", "2") + param("roof:levels", "-1")) +
          poly("h", box(140, 10, 150, 20), height("1e9"), "forest"));
  check_clean_town(folder / "made", report);
  CHECK(report.sizes.at("volume_m3") == doctest::Approx(100.0 * (12.192 + 15.0 + 9.0 + 9.0 + 9.0 + 9.0 + 6.0)));
  CHECK(report.read.at("heights from 'height'") == 1);
  CHECK(report.read.at("heights from 'building:levels'") == 2);
  CHECK(report.read.at("heights by default") == 4);
  CHECK(report.repaired.at("heights that are no length") == 3);  // a house, one of 1e9 m, a forest of 1e9 m
  CHECK(report.repaired.at("numbers of storeys that are none") == 2);
  const std::string mtl = dcem::test::file_bytes(folder / "made/scene.mtl");
  CHECK(mtl.find("newmtl wall_brick\n") != std::string::npos);
  CHECK(mtl.find("em_itu brick\n") != std::string::npos);
  CHECK(mtl.find("newmtl roof_metal\n") != std::string::npos);
}

TEST_CASE("law: any heap of houses becomes closed blocks with volume area times height") {
  DCEM_NEEDS_GEOS();
  std::mt19937 random(20);
  std::uniform_real_distribution<double> place_m(20.0, 140.0);
  std::uniform_int_distribution<int> storeys(1, 4);
  for (int town = 0; town < 12; ++town) {
    CAPTURE(town);
    std::string houses;
    for (int house = 0; house < 40; ++house) {
      const double x_m = place_m(random), y_m = place_m(random);
      houses += poly("h" + std::to_string(house), random_house(random, x_m, y_m),
                     param("building:levels", std::to_string(storeys(random))));
    }
    const TemporaryFolder folder;
    io::ImportSettings settings;
    settings.touching = town % 2 == 0 ? io::TouchingHouses::unite : io::TouchingHouses::snap;
    check_clean_town(folder / "made", import_polygons(folder, houses, settings));
  }
}

TEST_CASE("forests are closed shells of foliage, without the houses in them") {
  DCEM_NEEDS_GEOS();
  const TemporaryFolder folder;
  const auto report = import_polygons(folder, poly("a", box(10, 20, 20, 30), height("6")) +
                                                  poly("wood", box(0, 10, 40, 50), "", "forest") +
                                                  poly("more", box(30, 40, 60, 60), "", "forest"));
  check_clean_town(folder / "made", report);
  CHECK(report.made.at("forests") == 1);
  const io::Inspection seen = io::inspect_obj(folder / "made/vegetation.obj");
  CHECK(seen.report.closed_shells == 1);
  CHECK(seen.report.open_edges == 0);
  const double area_m2 = 1600.0 + 600.0 - 100.0 - 100.0;
  CHECK(dcem::test::enclosed_volume_m3(folder / "made/vegetation.obj") == doctest::Approx(12.0 * area_m2));
  const io::Scenario scenario = io::load_scenario(folder / "made/scenario.json");
  CHECK(scenario.scene.foliage().size() == 1);
}

TEST_CASE("an import replaces the former one in its folder") {
  DCEM_NEEDS_GEOS();
  const TemporaryFolder folder;
  const std::string house = poly("a", box(10, 20, 20, 30));
  import_polygons(folder, house + poly("wood", box(40, 10, 60, 50), "", "forest"));
  CHECK(std::filesystem::exists(folder / "made/vegetation.obj"));
  import_polygons(folder, house);
  CHECK_FALSE(std::filesystem::exists(folder / "made/vegetation.obj"));
}

}  // namespace test_town_plan
