/// The block `antenna` of a scenario file.
#include <doctest/doctest.h>

#include <fstream>
#include <string>
#include <variant>

#include "dcem/io/antenna_files.hpp"
#include "dcem/io/scenario.hpp"
#include "tests/io/temporary_folder.hpp"

namespace test_scenario_antenna {

using namespace dcem;

namespace {

/// A scenario in a folder below that of its pattern files.
struct AntennaCase {
  test::TemporaryFolder folder;
  std::string transmit = "{}";
  std::string receive = "{}";
  std::string propagation = "{}";

  io::Scenario load() const {
    std::ofstream(folder / "ground.mtl") << "newmtl ground\nem_model pec\n";
    std::ofstream(folder / "ground.obj")
        << "mtllib ground.mtl\nv -9 -9 0\nv 9 -9 0\nv 9 9 0\nv -9 9 0\nusemtl ground\nf 1 2 3 4\n";
    std::ofstream(folder / "case.json")
        << R"({"format": "dcem-scenario/1", "frequency_hz": 30e9, "scene": {"obj": "ground.obj"}, "propagation": )"
        << propagation << ","
        << R"("transmitters": [{"id": "tx", "position_m": [0, 0, 5], "power_dbm": 30, "antenna": )" << transmit
        << R"(}], "receivers": [{"id": "rx", "positions_m": [[5, 0, 1], [6, 0, 1]], "antenna": )" << receive
        << R"(}, {"id": "area", "grid": {"origin_m": [1, 1, 1], "spacing_m": [1, 1], "count": [2, 2]}, "antenna": )"
        << receive << "}]}";
    return io::load_scenario(folder / "case.json");
  }
  Antenna transmitting() const { return load().scene.transmitters()[0].antenna; }
};

}  // namespace

TEST_CASE("an antenna without keys is isotropic, vertical, single and not turned") {
  CHECK(AntennaCase{}.transmitting() == Antenna{});
}

TEST_CASE("every key of an antenna reaches it") {
  AntennaCase files;
  files.transmit = R"({"pattern": "tr38901", "gain_dbi": -1.5, "polarization": {"slant_deg": 45},
    "orientation_deg": [90, 10, -5], "array": {"rows": 4, "columns": 8, "spacing_wavelengths": 0.6}})";
  const Antenna antenna = files.transmitting();
  CHECK(std::holds_alternative<Tr38901Element>(antenna.pattern));
  CHECK(antenna.gain_dbi == -1.5);
  CHECK(antenna.polarization.kind == PolarizationKind::slant);
  CHECK(antenna.orientation.yaw_rad == doctest::Approx(std::acos(0.0)).epsilon(1e-15));
  CHECK(antenna.orientation.pitch_rad == doctest::Approx(std::acos(-1.0) / 18).epsilon(1e-15).scale(0.0));
  CHECK(antenna.orientation.roll_rad == doctest::Approx(-std::acos(-1.0) / 36).epsilon(1e-15).scale(0.0));
  CHECK(antenna.array == AntennaArray{4, 8, 0.6});
  files.transmit = R"({"pattern": "half_wave_dipole", "array": {"rows": 3}})";
  CHECK(std::holds_alternative<HalfWaveDipole>(files.transmitting().pattern));
  CHECK(files.transmitting().array == AntennaArray{3, 1, 0.5});
  files.transmit = R"({"pattern": "isotropic"})";
  CHECK(files.transmitting() == Antenna{});
}

TEST_CASE("pattern files are relative to the scenario, and all antennas that name one share its table") {
  AntennaCase files;
  std::filesystem::create_directory(files.folder / "patterns");
  const PatternTable table = tabulated(Tr38901Element{}, 24, 13);
  io::write_pattern_csv(table, files.folder / "patterns" / "element.csv");
  std::ofstream(files.folder / "panel.msi")
      << "GAIN 7\nHORIZONTAL 4\n0 0\n90 9\n180 9\n270 9\nVERTICAL 4\n0 0\n90 9\n180 9\n270 9\n";
  files.transmit = R"({"pattern": {"csv": "patterns/element.csv"}})";
  files.receive = R"({"pattern": {"msi": "panel.msi"}})";
  const io::Scenario scenario = files.load();
  const auto shared = [](const Antenna& antenna) { return std::get<TabulatedPattern>(antenna.pattern).table; };
  CHECK(*shared(scenario.scene.transmitters()[0].antenna) == table);
  const auto panel = shared(scenario.scene.receivers()[0].antenna);
  CHECK(panel->gain_dbi(0.0, std::acos(0.0)) == doctest::Approx(9.15).epsilon(1e-12));
  CHECK(shared(scenario.scene.receivers()[1].antenna) == panel);
  CHECK(shared(scenario.grids[0].antenna) == panel);
}

TEST_CASE("plane waves over an array may be asked for by name") {
  AntennaCase files;
  files.propagation = R"({"antenna_array": "plane_wave"})";
  CHECK_NOTHROW(files.load());
  files.propagation = R"({"antenna_array": null})";
  CHECK_NOTHROW(files.load());
}

}  // namespace test_scenario_antenna
