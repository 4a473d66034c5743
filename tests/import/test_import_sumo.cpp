/// SUMO's own files become a scenario that runs.
#include <doctest/doctest.h>

#include "tests/import/import_case.hpp"
#include "tests/io/trace_files.hpp"
#include "tests/support/shared_data.hpp"

namespace test_import_sumo {

using namespace dcem;
using dcem::test::param;
using dcem::test::poly;
using dcem::test::refusal;
using dcem::test::TemporaryFolder;
using dcem::test::write;

namespace {

const std::string house = poly("a", "10,10 40,10 40,30 10,30", param("height", "12"));

void write_town(const TemporaryFolder& folder) {
  write(folder / "town.net.xml", dcem::test::small_network);
  write(folder / "town.poly.xml", "<additional>\n" + house + "</additional>\n");
  write(folder / "types.add.xml",
        "<additional><vType id=\"car\" length=\"4\" width=\"2\" height=\"1.5\"/></additional>\n");
  // Routes repeat the type.
  write(folder / "town.rou.xml", "<routes><vType id=\"car\" length=\"4\" width=\"2\" height=\"1.5\"/></routes>\n");
  std::string steps;
  for (int step = 0; step < 3; ++step) {
    steps += dcem::test::step(
        std::to_string(step),
        dcem::test::vehicle("v1", "x=\"" + std::to_string(20 + 10 * step) + "\" y=\"0\" angle=\"90\" speed=\"10\"") +
            dcem::test::vehicle("v2", "x=\"150\" y=\"-4\" angle=\"270\" speed=\"0\""));
  }
  write(folder / "town.fcd.xml", dcem::test::trace(steps));
  write(folder / "town.sumocfg",
        "<configuration><input><net-file value=\"town.net.xml\"/><route-files value=\"town.rou.xml\"/>"
        "<additional-files value=\"types.add.xml,town.poly.xml\"/></input>"
        "<output><fcd-output value=\"town.fcd.xml\"/></output></configuration>\n");
}

std::string refused(const TemporaryFolder& folder, const io::SumoFiles& files) {
  return refusal(folder, [&] { io::import_sumo(files, folder / "made"); });
}

bool holds(const std::string& message, const std::string& piece) {
  return message.find(piece) != std::string::npos;
}

}  // namespace

TEST_CASE("a configuration names all: the scenario runs without editing") {
  DCEM_NEEDS_GEOS();
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  write_town(folder);
  const auto outcome = dcem::test::dcem_program(folder, "import sumo town.sumocfg -o made");
  CAPTURE(outcome.error);
  CHECK(outcome.exit_code == 0);
  CHECK(holds(outcome.output, "houses"));
  const auto run = dcem::test::dcem_program(folder, "run made/scenario.json -o out --quiet");
  CAPTURE(run.error);
  CHECK(run.exit_code == 0);
  const io::Scenario scenario = io::load_scenario(folder / "made/scenario.json");
  CHECK(scenario.time.frames == 3);
  CHECK(scenario.scene.bodies().size() == 3);  // the scenery and two cars at a time
}

TEST_CASE("the place on the Earth comes from the network") {
  DCEM_NEEDS_GEOS();
  const TemporaryFolder folder;
  write_town(folder);
  io::import_sumo({folder / "town.net.xml", folder / "town.poly.xml", {}, {}}, folder / "made");
  const auto geo = dcem::test::read_json(folder / "made/report.json")["geo"];
  if (!io::knows_utm()) {
    CHECK(geo.is_null());
    return;
  }
  CHECK(geo["crs"] == "utm32n");
  CHECK(geo["origin_lon_deg"].get<double>() == doctest::Approx(9.0).epsilon(1e-12));  // the middle of zone 32
  // Northing 5 600 000 m, from PROJ: cs2cs EPSG:32632 EPSG:4326.
  CHECK(geo["origin_lat_deg"].get<double>() == doctest::Approx(50.55).epsilon(1e-3));
}

TEST_CASE("polygons with another offset, or in degrees, come to lie where they belong") {
  DCEM_NEEDS_GEOS();
  const TemporaryFolder folder;
  write_town(folder);
  const std::string location =
      "<location netOffset=\"-500100.00,-5600000.00\" convBoundary=\"0,0,1,1\" origBoundary=\"9,50,10,51\" "
      "projParameter=\"+proj=utm +zone=32 +ellps=WGS84 +datum=WGS84 +units=m +no_defs\"/>";
  write(folder / "town.poly.xml", "<additional>" + location + house + "</additional>");
  io::import_sumo({folder / "town.net.xml", folder / "town.poly.xml", {}, {}}, folder / "made");
  double east_m = -1e9;
  const TriangleMesh mesh = io::read_obj(folder / "made/scene.obj").mesh;
  for (const auto& triangle : mesh.triangles) {
    if (mesh.material_names[triangle.material] != "roof") continue;
    for (const auto vertex : triangle.vertices) east_m = std::max(east_m, mesh.vertices_m[vertex].x);
  }
  CHECK(east_m == doctest::Approx(140.0));
}

TEST_CASE("damaged files: one line, nothing written") {
  DCEM_NEEDS_GEOS();
  const TemporaryFolder folder;
  write_town(folder);
  const io::SumoFiles good{folder / "town.net.xml", folder / "town.poly.xml", {}, {}};
  const std::string whole = "<additional>\n" + house + "</additional>\n";

  write(folder / "town.poly.xml", whole.substr(0, whole.size() - 20));
  CHECK(holds(refused(folder, good), "town.poly.xml:2: damaged XML"));
  write(folder / "town.poly.xml", "<!DOCTYPE x [<!ENTITY a \"aaaa\">]><additional/>");
  CHECK(holds(refused(folder, good), "document type declaration"));
  write(folder / "town.poly.xml", "<additional>\n<poly id=\"a\" type=\"building\" shape=\"1,2 3,x\"/></additional>");
  CHECK(holds(refused(folder, good), "town.poly.xml:2: poly 'a': shape: found '3,x'"));
  write(folder / "town.poly.xml", "<additional>\n<poly id=\"a\" type=\"building\"/></additional>");
  CHECK(holds(refused(folder, good), "shape: missing"));
  write(folder / "town.poly.xml", "<additional><poly id=\"a\" type=\"building\" shape=\"1,2 3,4\"/></additional>");
  CHECK(holds(refused(folder, good), "holds no building with an area"));
  write(folder / "town.poly.xml", "<additional/>");
  CHECK(holds(refused(folder, good), "no polygons"));
  CHECK(holds(refused(folder, {folder / "types.add.xml", folder / "town.poly.xml", {}, {}}), "holds no location"));
  CHECK(holds(refused(folder, {folder / "absent.net.xml", folder / "town.poly.xml", {}, {}}), "is not there"));

  write(folder / "town.poly.xml", whole);
  write(folder / "bad.fcd.xml", dcem::test::trace(dcem::test::step(
                                    "0", dcem::test::vehicle("v", "x=\"0\" y=\"0\" angle=\"0\" speed=\"0\"", "ufo"))));
  CHECK(holds(refused(folder, {folder / "town.net.xml", folder / "town.poly.xml", folder / "bad.fcd.xml", {}}), "ufo"));
  CHECK(holds(refusal(folder,
                      [&] {
                        io::ImportSettings settings;
                        settings.default_height_m = 0.0;
                        io::import_sumo(good, folder / "made", settings);
                      }),
              "default height: found 0"));
}

TEST_CASE("files of another kind: one line, nothing written") {
  DCEM_NEEDS_GEOS();
  const TemporaryFolder folder;
  write_town(folder);
  const io::SumoFiles good{folder / "town.net.xml", folder / "town.poly.xml", {}, {}};
  std::string network = dcem::test::small_network;
  network.replace(network.find("<net>"), 5, "<nix>").replace(network.find("</net>"), 6, "</nix>");
  write(folder / "other.net.xml", network);
  CHECK(holds(refused(folder, {folder / "other.net.xml", folder / "town.poly.xml", {}, {}}),
              "other.net.xml: the root element is 'nix'; expected net, a SUMO network"));
  write(folder / "nix.xml", "<nix/>");
  CHECK(holds(refused(folder, {folder / "town.net.xml", folder / "nix.xml", {}, {}}), "nix.xml: holds no polygons"));
  CHECK(holds(refused(folder, {folder / "town.net.xml", folder / "town.poly.xml", folder / "nix.xml", {}}),
              "nix.xml:1: the root element is 'nix'; expected fcd-export"));
  CHECK(holds(refused(folder, {folder / "town.net.xml", folder / "town.poly.xml", {}, {folder / "nix.xml"}}),
              "nix.xml: the root element is 'nix'; expected additional or routes, with polygons or vehicle types"));
  CHECK(holds(refused(folder, {folder / "town.net.xml", folder / "town.net.xml", {}, {}}),
              "town.net.xml: holds no polygons"));
  io::ImportSettings settings;
  settings.frequency_hz = 1.5e11;
  CHECK(holds(refusal(folder, [&] { io::import_sumo(good, folder / "made", settings); }),
              "town.net.xml: frequency: material 'ground': material 'concrete' at 150 GHz is outside"));
  // What has nothing to say is counted.
  write(folder / "empty.add.xml", "<additional/>");
  const io::SumoFiles with_empty{folder / "town.net.xml", folder / "town.poly.xml", {}, {folder / "empty.add.xml"}};
  CHECK(
      io::import_sumo(with_empty, folder / "made").skipped.at("additional files without polygons and vehicle types") ==
      1);
}

TEST_CASE("a vehicle may have any name; a town beyond what a scene may hold is refused") {
  DCEM_NEEDS_GEOS();
  const TemporaryFolder folder;
  write_town(folder);
  const std::string place = "x=\"20\" y=\"0\" angle=\"90\" speed=\"10\"";
  write(folder / "town.fcd.xml",
        dcem::test::trace(
            dcem::test::step("0", dcem::test::vehicle("mast", place) + dcem::test::vehicle("vegetation", place))));
  write(folder / "town.poly.xml",
        "<additional>\n" + house + poly("f", "60,10 90,10 90,30 60,30", "", "forest") + "</additional>\n");
  io::import_sumo(
      {folder / "town.net.xml", folder / "town.poly.xml", folder / "town.fcd.xml", {folder / "types.add.xml"}},
      folder / "made");
  const auto json = dcem::test::read_json(folder / "made/scenario.json");
  CHECK(json["transmitters"][0]["id"] == "mast_");
  CHECK(json["objects"][0]["id"] == "vegetation_");
  std::filesystem::remove_all(folder / "made");
  write(folder / "town.poly.xml",
        "<additional>\n" + poly("a", "9e8,9e8 900000040,9e8 900000040,900000020") + "</additional>\n");
  CHECK(holds(refused(folder, {folder / "town.net.xml", folder / "town.poly.xml", {}, {}}),
              "town.poly.xml: reaches farther than 1e9 m from its origin; expected a town"));
}

TEST_CASE("a scenario in a folder behind a link finds its trace") {
  DCEM_NEEDS_GEOS();
  const TemporaryFolder folder;
  write_town(folder);
  std::filesystem::create_directories(folder / "elsewhere/deep");
  std::filesystem::create_directory_symlink(folder / "elsewhere/deep", folder / "link");
  io::import_sumo(
      {folder / "town.net.xml", folder / "town.poly.xml", folder / "town.fcd.xml", {folder / "types.add.xml"}},
      folder / "link");
  CHECK(io::load_scenario(folder / "elsewhere/deep/scenario.json").time.frames == 3);
  // Up from where the link leads, as the system opens it.
  std::filesystem::rename(folder / "town.fcd.xml", folder / "elsewhere/town.fcd.xml");
  io::import_sumo(
      {folder / "town.net.xml", folder / "town.poly.xml", folder / "link/../town.fcd.xml", {folder / "types.add.xml"}},
      folder / "made");
  CHECK(io::load_scenario(folder / "made/scenario.json").time.frames == 3);
}

TEST_CASE("Bad Hersfeld from its own files: every block closed, every roof there") {
  DCEM_NEEDS_SHARED();
  DCEM_NEEDS_GEOS();
  const TemporaryFolder folder;
  const auto file = [](const std::string& name) { return dcem::test::shared_path("badhersfeld/" + name); };
  const io::ImportReport report = io::import_sumo(
      {file("centre.net.xml.gz"), file("polys.xml.gz"), file("fcd_600-660s_0.1s.xml.gz"), {file("vtypes.add.xml")}},
      folder / "made");
  dcem::test::check_clean_town(folder / "made", report);
  CHECK(report.read.at("houses") == 2441);
  CHECK(report.skipped.at("houses there already") == 1);
  CHECK(report.read.at("steps of the trace") == 600);
  CHECK(report.notes.size() <= 1);
  const io::Scenario scenario = io::load_scenario(folder / "made/scenario.json");
  CHECK(scenario.time.frames == 600);
  CHECK(scenario.time.step_s == doctest::Approx(0.1).scale(0.0));
}

}  // namespace test_import_sumo
