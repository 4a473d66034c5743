/// Tables of a GEMV² run become a scenario.
#include <doctest/doctest.h>

#include "dcem/io/geo_anchor.hpp"
#include "tests/import/import_case.hpp"
#include "tests/support/shared_data.hpp"

namespace test_import_gemv2 {

using namespace dcem;
using dcem::test::refusal;
using dcem::test::TemporaryFolder;
using dcem::test::write;

namespace {

const std::string link_header =
    "veh_i,veh_j,link_type(1=LOS 2=NLOSb/f 3=NLOSv),x_i,y_i,h_ant_i,x_j,y_j,h_ant_j,dist2d_m,large_scale_rx_dBm\n";

void write_tables(const TemporaryFolder& folder) {
  std::filesystem::create_directories(folder / "run");
  write(folder / "run/town_buildings_xy.csv",
        "building_id,x_m,y_m\n-1,0,10\n-1,10,10\n-1,10,20\n-1,0,20\n-1,0,10\n-2,10,10\n-2,20,10\n-2,20,20\n-2,10,20\n"
        "-3,50,50\n-3,60,60\n");
  // A car along x, a lorry turned by 30 degrees.
  write(folder / "run/town_vehicles_xy.csv",
        "vehicle_index_1based,x_m,y_m\n7,0,0\n7,4,0\n7,4,2\n7,0,2\n7,0,0\n"
        "9,30,0\n9,38.6603,5\n9,37.6603,6.7321\n9,29,1.7321\n9,30,0\n");
  write(folder / "run/links_5.89GHz.csv", link_header + "7,9,1,2,1,1.6,33.83,3.366,3.1,31,-70\n");
  write(folder / "run/links_30GHz.csv", link_header + "7,9,1,2,1,1.6,33.83,3.366,3.1,31,-80\n");
  write(folder / "run/town_origin.json", "{\"origin_utm29n\": [529203.0, 4555870.0]}");
}

}  // namespace

TEST_CASE("outlines, vehicles and links: the scenario runs without editing") {
  DCEM_NEEDS_GEOS();
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  write_tables(folder);
  const io::ImportReport report = io::import_gemv2(folder / "run", folder / "made");
  dcem::test::check_clean_town(folder / "made", report);
  CHECK(report.read.at("houses") == 3);
  CHECK(report.skipped.at("houses with fewer than three corners") == 1);
  CHECK(report.made.at("vehicles") == 2);
  CHECK(report.read.at("links") == 1);
  const auto json = dcem::test::read_json(folder / "made/scenario.json");
  CHECK(json["frequency_hz"] == 5.89e9);
  CHECK(json["objects"][0]["box_m"] == nlohmann::json({4.0, 2.0, 1.5}));
  CHECK(json["objects"][1]["box_m"][0].get<double>() == doctest::Approx(10.0).epsilon(1e-4));
  CHECK(json["objects"][1]["motion"]["yaw_deg"].get<double>() == doctest::Approx(30.0).epsilon(1e-4));
  CHECK(json["objects"][1]["box_m"][2] == 3.0);
  const auto run = dcem::test::dcem_program(folder, "run made/scenario.json -o out --quiet");
  CAPTURE(run.error);
  CHECK(run.exit_code == 0);
  CHECK(dcem::test::file_bytes(folder / "out/links.csv").find(",on_7,on_9,1,") != std::string::npos);
}

TEST_CASE("damaged tables: one line, nothing written") {
  DCEM_NEEDS_GEOS();
  const TemporaryFolder folder;
  const auto refused = [&](const char* said) {
    const std::string message = refusal(folder, [&] { io::import_gemv2(folder / "run", folder / "made"); });
    CHECK(message.find(said) != std::string::npos);
  };
  refused("is no folder that can be read");
  write_tables(folder);
  write(folder / "run/links_5.89GHz.csv", link_header + "7,9,1,2,1\n");
  refused("links_5.89GHz.csv:2");
  write(folder / "run/links_5.89GHz.csv", link_header + "7,7,1,2,1,1.6,33,3,3.1,31,-70\n");
  refused("with itself");
  write(folder / "run/links_5.89GHz.csv", link_header);
  refused("holds no link");
  write_tables(folder);
  if (io::knows_utm()) {
    write(folder / "run/town_origin.json", "{\"origin_utm29n\": [1e300, 1]}");
    refused("town_origin.json: origin_utm29n: no place in UTM");
    write_tables(folder);
  }
  write(folder / "run/town_buildings_xy.csv", "building_id,x_m,y_m\n-1,0,1e300\n");
  refused("town_buildings_xy.csv:2");
  write(folder / "run/town_buildings_xy.csv", "building_id,x_m,y_m\n-1,0,1\n-1,3,3\n");
  refused("holds no building with an area");
  write(folder / "run/town_buildings_xy.csv", "building_id,x_m,y_m\n1,0,0\n\xc3(,9,0\n");
  refused("town_buildings_xy.csv:3: a name that is no UTF-8; expected text in UTF-8");
  std::filesystem::remove(folder / "run/town_buildings_xy.csv");
  refused("holds no *buildings_xy.csv");
}

TEST_CASE("hidden files beside the tables, as archives leave them, are none of them") {
  DCEM_NEEDS_GEOS();
  const TemporaryFolder folder;
  write_tables(folder);
  for (const std::string name : {"._town_buildings_xy.csv", "._links_5.89GHz.csv"}) write(folder / ("run/" + name), "");
  io::import_gemv2(folder / "run", folder / "made", {});
  CHECK(std::filesystem::exists(folder / "made/scenario.json"));
}

TEST_CASE("tables that do not belong together: one line, nothing written") {
  DCEM_NEEDS_GEOS();
  const TemporaryFolder folder;
  io::ImportSettings settings;
  const auto refused = [&](const std::string& said) {
    const std::string message = refusal(folder, [&] { io::import_gemv2(folder / "run", folder / "made", settings); });
    CAPTURE(message);
    CAPTURE(said);
    CHECK(message.find(said) != std::string::npos);
    std::filesystem::remove_all(folder / "run");
    write_tables(folder);
  };
  write_tables(folder);
  for (const std::string kind : {"buildings_xy.csv", "vehicles_xy.csv", "origin.json", "5.89GHz.csv"}) {
    write(folder / ("run/a_" + kind), "");
    refused("run: holds 'a_" + kind + "' and '");
  }
  const std::string second = ",33.83,3.366,3.1,31,-70\n";
  write(folder / "run/links_5.89GHz.csv", link_header + "107,109,1,2,1,1.6" + second);
  refused("links_5.89GHz.csv: names no vehicle of 'town_vehicles_xy.csv'; expected tables of one GEMV2 run");
  write(folder / "run/links_5.89GHz.csv", link_header + "7,9,1,2,1,1.6" + second + "7,8,1,2,1.5,1.6" + second);
  refused("links_5.89GHz.csv:3: vehicle '7' is elsewhere than in a row before; expected the links of one instant");
  for (const std::string& name : {std::string("7/1"), std::string("7\\1"), std::string(193, '7'), std::string()}) {
    write(folder / "run/links_5.89GHz.csv", link_header + name + ",9,1,2,1,1.6" + second);
    refused("links_5.89GHz.csv:2: found '");
    write(folder / "run/town_vehicles_xy.csv", "vehicle_index_1based,x_m,y_m\n" + name + ",0,0\n");
    refused("town_vehicles_xy.csv:2: found '");
  }
  write(folder / "run/town_vehicles_xy.csv", "vehicle_index_1based,x_m,y_m\n7,0,0\n7,9e6,0\n7,9e6,2\n7,0,2\n");
  refused("town_vehicles_xy.csv: vehicle '7' is 9e+06 m long; expected at most 1000");
  write(folder / "run/town_vehicles_xy.csv", "vehicle_index_1based,x_m,y_m\n7,100,0\n7,104,0\n7,104,2\n7,100,2\n");
  refused("town_vehicles_xy.csv: vehicle '7' is 100 m from where 'links_5.89GHz.csv' has it");
  settings.frequency_hz = 5e8;
  refused("town_buildings_xy.csv: frequency: material 'ground': material 'concrete' at 0.5 GHz is outside");
  settings.frequency_hz.reset();
  std::filesystem::remove(folder / "run/links_5.89GHz.csv");
  std::filesystem::rename(folder / "run/links_30GHz.csv", folder / "run/links_300GHz.csv");
  refused("links_300GHz.csv: frequency: material 'ground': material 'concrete' at 300 GHz is outside");
  if (!io::knows_utm()) return;
  for (const char* const zone : {"utm99n", "utm0n", "utm29x", "utm", "utmn"}) {
    write(folder / "run/town_origin.json", "{\"origin_" + std::string(zone) + "\": [529203, 4555870]}");
    refused("town_origin.json: origin_" + std::string(zone) + ": no zone of UTM; expected one from origin_utm1n");
  }
  write(folder / "run/town_origin.json", R"({"origin_utm29n": [1, 2], "origin_utm30n": [1, 2]})");
  refused("town_origin.json: origin_utm30n: a second origin; expected one");
  write(folder / "run/town_origin.json", R"({"origin_utm29n": [1]})");
  refused("town_origin.json: origin_utm29n: found something else; expected [easting, northing] in metres");
  write(folder / "run/town_origin.json", R"({"orgin_utm29n": [1, 2]})");
  refused("town_origin.json: holds no origin; expected one as in \"origin_utm29n\"");
}

TEST_CASE("a vehicle of links that the table of vehicles lacks is a device without a body, and counted") {
  DCEM_NEEDS_GEOS();
  const TemporaryFolder folder;
  write_tables(folder);
  write(folder / "run/links_5.89GHz.csv", link_header + "7,8,1,2,1,1.6,33.83,3.366,3.1,31,-70\n");
  const io::ImportReport report = io::import_gemv2(folder / "run", folder / "made");
  CHECK(report.repaired.at("vehicles of links that the table lacks, left without a body") == 1);
  CHECK(dcem::test::read_json(folder / "made/scenario.json")["receivers"][0].contains("position_m"));
}

TEST_CASE("Porto: 4411 outlines, 2410 vehicles, 889 links") {
  DCEM_NEEDS_SHARED();
  DCEM_NEEDS_GEOS();
  const TemporaryFolder folder;
  const io::ImportReport report = io::import_gemv2(dcem::test::shared_path("gemv2"), folder / "made");
  dcem::test::check_clean_town(folder / "made", report);
  CHECK(report.read.at("houses") == 4411);
  CHECK(report.made.at("vehicles") == 2410);
  CHECK(report.read.at("links") == 889);
  CHECK(report.made.at("transmitters") == 742);
  CHECK(report.made.at("receivers") == 700);
  CHECK(report.skipped == io::ImportReport::Counts{{"houses with fewer than three corners", 1}});
}

}  // namespace test_import_gemv2
