/// The ground of an ASCII grid, and houses that stand on it.
#include <doctest/doctest.h>

#include "dcem/io/src/import/terrain.hpp"
#include "tests/import/import_case.hpp"

namespace test_terrain {

using namespace dcem;
using dcem::test::poly;
using dcem::test::refusal;
using dcem::test::TemporaryFolder;
using dcem::test::write;

namespace {

/// A slope: 200 m + 0.1 m for each metre to the east, cells of 50 m around the small network of the tests, in UTM.
std::string slope(const std::string& header = "ncols 9\nnrows 8\nxllcenter 499900\nyllcenter 5599850\ncellsize 50\n") {
  std::string text = header;
  for (int row = 0; row < 8; ++row) {
    for (int column = 0; column < 9; ++column) text += std::to_string(200 + 5 * column) + ' ';
    text += '\n';
  }
  return text;
}

}  // namespace

TEST_CASE("rows come from the north, heights are counted from the lowest") {
  const TemporaryFolder folder;
  write(folder / "a.asc", "NCOLS 3\nNROWS 2\nXLLCORNER 10\nYLLCORNER 20\nCELLSIZE 2\nNODATA_value -1\n5 6 7\n3 4 -1\n");
  const io::Terrain terrain = io::read_terrain(folder / "a.asc");
  CHECK(terrain.low_m == Vec2(11, 21));
  CHECK(terrain.high_m() == Vec2(15, 23));
  CHECK(terrain.lowest_m == 3.0);
  CHECK(terrain.without_value == 1);
  CHECK(terrain.height_m({11, 21}) == 0.0);
  CHECK(terrain.height_m({11, 23}) == 2.0);
  CHECK(terrain.height_m({12, 22}) == 1.5);
  CHECK(terrain.height_m({-100, 100}) == 2.0);
  CHECK(terrain.height_m({15, 21}) == 0.0);
}

TEST_CASE("houses stand on their lowest corner, those that touch on one foot") {
  DCEM_NEEDS_GEOS();
  if (!io::knows_utm()) return;
  const TemporaryFolder folder;
  write(folder / "slope.asc", slope());
  io::ImportSettings settings;
  settings.terrain = folder / "slope.asc";
  const auto height = [](const char* height_m) { return dcem::test::param("height", height_m); };
  const io::ImportReport report = dcem::test::import_polygons(
      folder, poly("a", "20,20 40,20 40,40 20,40", height("6")) + poly("b", "40,20 60,20 60,40 40,40", height("9")),
      settings);
  const io::Inspection seen = io::inspect_obj(folder / "made/scene.obj");
  CHECK(seen.report.crowded_edges == 0);
  CHECK(seen.report.standing_shells == 1);
  // 0.1 m per metre from x = -100 m on: the lowest corner, at x = 20 m, lies at 12 m; the foot half a metre under it.
  CHECK(report.sizes.at("volume_m3") == doctest::Approx(400.0 * 6.5 + 400.0 * 9.5));
  CHECK(seen.box.max.z >= 21.0);
  const TriangleMesh mesh = io::read_obj(folder / "made/scene.obj").mesh;
  double lowest_wall_m = 1e9, highest_roof_m = 0.0;
  for (const TriangleMesh::Triangle& triangle : mesh.triangles) {
    for (const auto vertex : triangle.vertices) {
      const std::string& material = mesh.material_names[triangle.material];
      const Vec3& corner_m = mesh.vertices_m[vertex];
      if (material == "wall") lowest_wall_m = std::min(lowest_wall_m, corner_m.z);
      if (material == "roof") highest_roof_m = std::max(highest_roof_m, corner_m.z);
      if (material == "ground") CHECK(corner_m.z == doctest::Approx(0.1 * (corner_m.x + 100.0)));
    }
  }
  CHECK(lowest_wall_m == doctest::Approx(11.5));
  CHECK(highest_roof_m == doctest::Approx(21.0));
  // Points on the street are 1.5 m above the ground.
  const auto scenario = dcem::test::read_json(folder / "made/scenario.json");
  CHECK(scenario["receivers"][0]["positions_m"][0][2].get<double>() == doctest::Approx(0.1 * 200.0 + 1.5));
  CHECK_NOTHROW(io::load_scenario(folder / "made/scenario.json"));
}

TEST_CASE("damaged grids: one line with what was expected") {
  DCEM_NEEDS_GEOS();
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& text, const char* said) {
    write(folder / "a.asc", text);
    const std::string message = refusal(folder, [&] { io::read_terrain(folder / "a.asc"); });
    CHECK(message.find(said) != std::string::npos);
  };
  const std::string good = slope();
  refused("", "no heights");
  refused(good.substr(0, good.size() - 20), "breaks off");
  refused(good + "7", "more heights");
  refused(slope("ncols 9\nxllcenter 0\nyllcenter 0\ncellsize 50\n"), "no nrows");
  refused(slope("ncols 9\nnrows 4000000000\nxllcenter 0\nyllcenter 0\ncellsize 50\n"),
          "a.asc:2: nrows: found '4000000000'");
  refused(slope("ncols 9\nnrows 8\nxllcenter 0\nyllcenter 0\ncellsize 0\n"), "without size");
  refused(slope("ncols 9\nnrows 8\nxllcenter zero\nyllcenter 0\ncellsize 50\n"), "a.asc:3: xllcenter: found 'zero'");
  write(folder / "far.asc", slope("ncols 9\nnrows 8\nxllcenter 0\nyllcenter 0\ncellsize 50\n"));
  io::ImportSettings settings;
  settings.terrain = folder / "far.asc";
  if (!io::knows_utm()) return;
  write(folder / "town.net.xml", dcem::test::small_network);
  write(folder / "town.poly.xml", "<additional>" + poly("a", "20,20 40,20 40,40 20,40") + "</additional>");
  CHECK(refusal(folder, [&] {
          io::import_sumo({folder / "town.net.xml", folder / "town.poly.xml", {}, {}}, folder / "made", settings);
        }).find("lies elsewhere") != std::string::npos);
}

}  // namespace test_terrain
