/// OpenStreetMap becomes a scenario: XML, and PBF where libosmium is there.
#include <doctest/doctest.h>

#include "dcem/io/src/import/osm_pbf.hpp"
#include "tests/import/import_case.hpp"

namespace test_import_osm {

using namespace dcem;
using dcem::test::refusal;
using dcem::test::TemporaryFolder;
using dcem::test::write;

namespace {

// Near 9° east (the middle of zone 32) and 50° north, a degree of longitude is 71 696 m long, one of latitude 111 229
// m. Source: GeographicLib's GeodSolve; times UTM's scale of 0.9996.
constexpr double east_deg_per_m = 1.0 / (71696.0 * 0.9996), north_deg_per_m = 1.0 / (111229.0 * 0.9996);

std::string node(int id, double x_m, double y_m) {
  char text[160];
  std::snprintf(text, sizeof text, "<node id=\"%d\" lat=\"%.9f\" lon=\"%.9f\"/>\n", id, 50.0 + y_m * north_deg_per_m,
                9.0 + x_m * east_deg_per_m);
  return text;
}

std::string tags(const std::vector<std::pair<std::string, std::string>>& entries) {
  std::string text;
  for (const auto& [key, value] : entries) text += "<tag k=\"" + key + "\" v=\"" + value + "\"/>";
  return text;
}

std::string way(int id, const std::vector<int>& nodes, const std::string& its_tags = "") {
  std::string text = "<way id=\"" + std::to_string(id) + "\">";
  for (const int n : nodes) text += "<nd ref=\"" + std::to_string(n) + "\"/>";
  return text + its_tags + "</way>\n";
}

std::string member(int id, const std::string& role) {
  return "<member type=\"way\" ref=\"" + std::to_string(id) + "\" role=\"" + role + "\"/>";
}

std::string osm(const std::string& content) {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<osm version=\"0.6\">\n" + content + "</osm>\n";
}

/// Corners 1 to 4 of a square of 40 m, 5 to 8 of one of 20 m in it, 11 to 14 of a house beside it, 21 to 24 of a wood.
std::string corners() {
  std::string text;
  const auto square = [&](int first, double x_m, double y_m, double size_m) {
    text += node(first, x_m, y_m) + node(first + 1, x_m + size_m, y_m) + node(first + 2, x_m + size_m, y_m + size_m) +
            node(first + 3, x_m, y_m + size_m);
  };
  square(1, 0, 0, 40);
  square(5, 10, 10, 20);
  square(11, 60, 0, 10);
  square(21, 100, 0, 50);
  return text;
}

const std::string town =
    osm(corners() +
        // A courtyard house whose outer ring is two ways.
        way(31, {1, 2, 3}) + way(32, {1, 4, 3}) + way(33, {5, 6, 7, 8, 5}) +
        way(34, {11, 12, 13, 14, 11}, tags({{"building", "yes"}, {"building:levels", "2"}})) +
        way(35, {21, 22, 23, 24, 21}, tags({{"natural", "wood"}})) + way(36, {11, 13}, tags({{"building", "yes"}})) +
        way(37, {1, 3, 99, 1}, tags({{"building", "yes"}})) + way(38, {1, 2}, tags({{"highway", "residential"}})) +
        "<relation id=\"41\">" + member(31, "outer") + member(32, "outer") + member(33, "inner") +
        tags({{"type", "multipolygon"}, {"building", "yes"}, {"height", "15"}}) + "</relation>\n");

void check_town(const TemporaryFolder& folder, const io::ImportReport& report) {
  dcem::test::check_clean_town(folder / "made", report);
  CHECK(report.read.at("houses") == 2);
  CHECK(report.read.at("multipolygons") == 1);
  CHECK(report.made.at("forests") == 1);
  CHECK(report.skipped.at("outlines that are not closed") == 1);
  CHECK(report.skipped.at("outlines with nodes that are not in the file") == 1);
  CHECK(report.sizes.at("footprint_area_m2") == doctest::Approx(1600.0 - 400.0 + 100.0).epsilon(2e-3));
  CHECK(report.sizes.at("volume_m3") == doctest::Approx(1200.0 * 15.0 + 100.0 * 6.0).epsilon(2e-3));
  const auto geo = dcem::test::read_json(folder / "made/report.json")["geo"];
  CHECK(geo["crs"] == "utm32n");
  CHECK(geo["origin_lat_deg"].get<double>() == doctest::Approx(50.0 + 25.0 * north_deg_per_m).epsilon(1e-6));
  CHECK(geo["origin_lon_deg"].get<double>() == doctest::Approx(9.0 + 75.0 * east_deg_per_m).epsilon(1e-6));
}

bool can_import() {
  return io::can_shape_outlines() && io::knows_utm();
}

}  // namespace

TEST_CASE("XML: ways, a multipolygon of several ways, a wood; the scenario runs without editing") {
  DCEM_NEEDS_PROGRAM();
  if (!can_import()) {
    MESSAGE("skipped: this build imports no OpenStreetMap");
    return;
  }
  const TemporaryFolder folder;
  write(folder / "town.osm", town);
  check_town(folder, io::import_osm(folder / "town.osm", folder / "made"));
  const auto run = dcem::test::dcem_program(folder, "run made/scenario.json -o out --quiet");
  CAPTURE(run.error);
  CHECK(run.exit_code == 0);
  CHECK(std::filesystem::file_size(folder / "out/links.csv") > 500);
}

TEST_CASE("a building told in parts stands for its outline; tags on the outer way of an old multipolygon") {
  if (!can_import()) return;
  const TemporaryFolder folder;
  write(folder / "town.osm",
        osm(corners() + way(31, {1, 2, 3, 4, 1}, tags({{"building", "yes"}, {"height", "30"}})) +
            way(33, {5, 6, 7, 8, 5}, tags({{"building:part", "yes"}, {"height", "30"}, {"min_height", "3"}})) +
            way(34, {11, 12, 13, 14, 11}, tags({{"building", "yes"}, {"height", "5"}})) + "<relation id=\"41\">" +
            member(31, "outline") + member(33, "part") + tags({{"type", "building"}}) + "</relation>\n" +
            "<relation id=\"42\">" + member(34, "outer") + tags({{"type", "multipolygon"}}) + "</relation>\n"));
  const io::ImportReport report = io::import_osm(folder / "town.osm", folder / "made");
  dcem::test::check_clean_town(folder / "made", report);
  CHECK(report.sizes.at("volume_m3") == doctest::Approx(400.0 * 30.0 + 100.0 * 5.0).epsilon(2e-3));
  CHECK(report.skipped.at("outlines of buildings told in parts") == 1);
  CHECK(report.repaired.at("parts above the ground, let down to it") == 1);
}

TEST_CASE("damaged maps: one line, nothing written") {
  if (!can_import()) return;
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& name, const std::string& content, const char* said) {
    write(folder / name, content);
    const std::string message = refusal(folder, [&] { io::import_osm(folder / name, folder / "made"); });
    CAPTURE(said);
    CHECK(message.find(said) != std::string::npos);
  };
  refused("a.osm", town.substr(0, town.size() - 30), "damaged XML");
  refused("a.osm", "<!DOCTYPE osm [<!ENTITY a \"b\">]><osm/>", "document type declaration");
  refused("a.osm", "<gpx/>", "expected <osm>");
  refused("a.osm", osm(""), "holds no node");
  refused("a.osm", osm(corners()), "holds no building with an area");
  refused("a.osm", osm(corners() + way(1, {1, 2, 1}, tags({{"building", "yes"}}))), "holds no building with an area");
  refused("a.osm", osm("<node id=\"1\" lat=\"95\" lon=\"0\"/>"), "a.osm:3: node: lat: found '95'");
  refused("a.osm", osm("<node id=\"x\" lat=\"5\" lon=\"0\"/>"), "a.osm:3: node: id: found 'x'");
  refused("a.osm", osm("<node id=\"1\" lat=\"5\" lon=\"0\"/><node id=\"2\" lat=\"5\" lon=\"100\"/>"), "5 degrees");
}

TEST_CASE("PBF: the same town; damaged: one line, nothing written") {
  if (!can_import()) return;
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& content, const char* said) {
    write(folder / "b.osm.pbf", content);
    const std::string message = refusal(folder, [&] { io::import_osm(folder / "b.osm.pbf", folder / "made"); });
    CAPTURE(said);
    CHECK(message.find(said) != std::string::npos);
  };
  if (!io::can_read_pbf()) {
    refused("", "cannot read PBF");
    return;
  }
  // Made of `town` by libosmium's writer.
  const std::string pbf = dcem::test::file_bytes(std::filesystem::path(DCEM_SOURCE_DIR) / "tests/import/town.osm.pbf");
  write(folder / "town.osm.pbf", pbf);
  check_town(folder, io::import_osm(folder / "town.osm.pbf", folder / "made"));
  std::filesystem::remove_all(folder / "made");
  refused(pbf.substr(0, pbf.size() / 2), "damaged PBF");
  refused(pbf.substr(0, 3), "damaged PBF");
  refused("no PBF at all, but long enough to look for a header", "damaged PBF");
  // However often one is refused, no file stays open.
  const auto open_files = [] { return std::distance(std::filesystem::directory_iterator("/proc/self/fd"), {}); };
  const auto before = open_files();
  for (int again = 0; again < 3; ++again) refused(std::string(pbf.size(), '\0'), "damaged PBF");
  CHECK(open_files() == before);
  std::string changed = pbf;
  for (std::size_t byte = pbf.size() / 2; byte < pbf.size() / 2 + 40; ++byte) changed[byte] = '\xff';
  refused(changed, "damaged PBF");
}

}  // namespace test_import_osm
