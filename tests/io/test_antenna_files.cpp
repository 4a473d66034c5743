/// Antenna patterns in files. The MSI and NSMA files are written here, by hand or from the formulas beside them.
#include "dcem/io/antenna_files.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <memory>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "dcem/core/random.hpp"
#include "dcem/em/antenna/antenna_pattern.hpp"
#include "dcem/io/input_error.hpp"
#include "tests/io/temporary_folder.hpp"

namespace test_antenna_files {

using namespace dcem;

namespace {

constexpr double degree = pi / 180.0;

std::filesystem::path written(const test::TemporaryFolder& folder, const std::string& text) {
  std::ofstream(folder / "pattern", std::ios::binary) << text;
  return folder / "pattern";
}

PatternTable csv(const std::string& text) {
  const test::TemporaryFolder folder;
  return io::read_pattern_csv(written(folder, text));
}

PatternTable msi(const std::string& text) {
  const test::TemporaryFolder folder;
  return io::read_msi(written(folder, text));
}

std::string error_of(const std::function<PatternTable(const std::string&)>& read, const std::string& text) {
  try {
    read(text);
  } catch (const io::InputError& error) {
    return error.what();
  }
  return "accepted";
}

/// The message must hold all pieces, name the file and say what is expected.
void check_refused(const std::function<PatternTable(const std::string&)>& read, const std::string& text,
                   const std::vector<std::string>& pieces) {
  const std::string message = error_of(read, text);
  CAPTURE(message);
  for (const std::string& piece : pieces) {
    CAPTURE(piece);
    CHECK(message.find(piece) != std::string::npos);
  }
  CHECK(message.find("pattern") != std::string::npos);
  CHECK((message.find("; expected ") != std::string::npos || message.find("nearest known one") != std::string::npos));
  CHECK(std::none_of(message.begin(), message.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; }));
}

std::string replaced(std::string text, const std::string& piece, const std::string& by) {
  const std::size_t place = text.find(piece);
  REQUIRE(place != std::string::npos);
  return text.replace(place, piece.size(), by);
}

const std::string header = "azimuth_deg,zenith_deg,gain_dbi\n";

/// Gains that name their node: azimuth step 90, zenith step 60, in the order of the table.
std::string small_csv() {
  std::string text = header;
  for (int zenith = 0; zenith <= 180; zenith += 60) {
    for (int azimuth = 0; azimuth < 360; azimuth += 90) {
      const bool pole = zenith % 180 == 0;
      text += std::to_string(azimuth) + "," + std::to_string(zenith) + "," +
              std::to_string(pole ? -5 : azimuth / 90 + zenith / 6) + "\n";
    }
  }
  return text;
}

/// Attenuations of a sector antenna with 4 degrees of tilt and lobes that differ left and right, up and down.
double horizontal_db(double clockwise_deg) {
  const double off = std::abs(std::remainder(clockwise_deg - 3.0, 360.0));
  return std::min(25.0, 12.0 * off * off / 4225.0) + (clockwise_deg > 90 && clockwise_deg < 180 ? 7.0 : 4.0);
}
double vertical_db(double down_deg) {
  const double off = std::abs(std::remainder(down_deg - 4.0, 360.0));
  return std::min(28.0, off * 0.9) + (down_deg > 180 ? 1.5 : 0.0);
}

/// The same cuts shifted so that they agree where they cross, ahead and behind.
double agreeing_vertical_db(double down_deg) {
  const double w = std::abs(std::remainder(down_deg, 360.0)) / 180.0;
  const double ahead = horizontal_db(0.0) - vertical_db(0.0), behind = horizontal_db(180.0) - vertical_db(180.0);
  return vertical_db(down_deg) + (1.0 - w) * ahead + w * behind;
}

std::string number(double value) {
  std::ostringstream text;
  text.precision(17);
  text << value;
  return text.str();
}

std::string cut_lines(const std::function<double(double)>& attenuation_db, double step_deg = 1.0) {
  std::string lines;
  const int count = static_cast<int>(std::lround(360.0 / step_deg));
  for (int index = 0; index < count; ++index) {
    const double angle = 360.0 * index / count;
    lines += number(angle) + "\t" + number(attenuation_db(angle)) + "\r\n";
  }
  return lines;
}

std::string sector_msi(const std::string& gain = "GAIN 15.85 dBd") {
  return "NAME 742 215 V4\r\nMAKE our own\r\nFREQUENCY 1800\r\nH_WIDTH 65\r\nV_WIDTH 7\r\nFRONT_TO_BACK 25\r\n" + gain +
         "\r\nTILT ELECTRICAL 4\r\nPOLARIZATION VERTICAL\r\nCOMMENT GAIN stands above\r\nHORIZONTAL 360\r\n" +
         cut_lines(horizontal_db) + "VERTICAL 360\r\n" + cut_lines(agreeing_vertical_db);
}

double gain_dbi(const PatternTable& table, double azimuth_deg, double elevation_deg) {
  return table.gain_dbi(azimuth_deg * degree, (90.0 - elevation_deg) * degree);
}

/// Four points per cut, small enough to be read.
const std::string tiny_msi =
    "NAME tiny\nGAIN 10\nHORIZONTAL 4\n0 0\n90 6\n180 20\n270 8\nVERTICAL 4\n0 0\n90 12\n180 20\n270 15\n";

const std::string tiny_nsma =
    "REVNUM:,NSMA WG16.99.050\r\nREVDAT:,19990520\r\nANTMAN:,our own\r\nMODNUM:,tiny\r\nGUNITS:,DBD/DBR\r\n"
    "MDGAIN:,10\r\nELTILT:,0,0\r\nNOFREQ:,1\r\nPATFRE:,6175\r\nNUMCUT:,3\r\n"
    "PATCUT:,AZ\r\nPOLARI:,V/H\r\nNUPOIN:,4\r\nFSTLST:,-90,180\r\n-90,-30,\r\n0,-31,\r\n90,-32,\r\n180,-33,\r\n"
    "PATCUT:,AZ\r\nPOLARI:,V/V\r\nNUPOIN:,4\r\nFSTLST:,-90,180\r\n-90,-8,\r\n0,0,\r\n90,-6,\r\n180,-20,\r\n"
    "PATCUT:,EL\r\nPOLARI:,V/"
    "V\r\nNUPOIN:,5\r\nFSTLST:,-180,180\r\n-180,-20,0\r\n-90,-12\r\n0,0\r\n90,-15\r\n180,-20\r\n"
    "ENDFIL:,EOF\r\n\x1A";

}  // namespace

TEST_CASE("a table of gains is read in any order of lines and columns, in any turn") {
  const PatternTable table = csv(small_csv());
  REQUIRE(table.azimuth_count() == 4);
  REQUIRE(table.zenith_count() == 4);
  CHECK(table.node_dbi(3, 1) == 13.0);
  CHECK(table.node_dbi(2, 2) == 22.0);
  CHECK(table.node_dbi(1, 0) == -5.0);
  std::istringstream stream(small_csv());
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  std::shuffle(lines.begin() + 1, lines.end(), std::mt19937(5));
  std::string shuffled = "gain_dbi, zenith_deg ,azimuth_deg\n";
  for (std::size_t line = 1; line < lines.size(); ++line) {
    std::istringstream fields(lines[line]);
    std::string azimuth, zenith, gain;
    std::getline(fields, azimuth, ',');
    std::getline(fields, zenith, ',');
    std::getline(fields, gain, ',');
    shuffled += gain + ", " + zenith + "," + (azimuth == "270" ? "-90" : azimuth) + "\r\n";
  }
  CHECK(csv(shuffled) == table);
}

TEST_CASE("a table may close the turn by repeating its first azimuth, with the same gains") {
  std::string closed = small_csv();
  for (const char* line : {"360,0,-5\n", "360,60,10\n", "360,120,20\n", "360,180,-5\n"}) closed += line;
  CHECK(csv(closed) == csv(small_csv()));
  check_refused(csv, replaced(closed, "360,60,10", "360,60,10.5"),
                {"pattern:19: ", "azimuth 360, zenith 60", "line 6"});
}

TEST_CASE("what is written reads back as the same table, to the bit") {
  const test::TemporaryFolder folder;
  RandomStream random(9);
  for (const auto& [azimuths, zeniths] : {std::pair{2, 2}, std::pair{7, 4}, std::pair{72, 37}, std::pair{13, 91}}) {
    std::vector<double> gains;
    for (int node = 0; node < azimuths * zeniths; ++node) gains.push_back(60.0 * random.uniform() - 40.0);
    const PatternTable table(static_cast<std::size_t>(azimuths), static_cast<std::size_t>(zeniths), gains);
    io::write_pattern_csv(table, folder / "table.csv");
    CHECK(io::read_pattern_csv(folder / "table.csv") == table);
  }
  CHECK(folder.names() == std::vector<std::string>{"table.csv"});
}

TEST_CASE("a damaged table is refused with the angle or the line") {
  const std::string good = small_csv();
  check_refused(csv, replaced(good, "90,60,11\n", ""), {"azimuth 90, zenith 60", "missing"});
  check_refused(csv, good + "90,60,11\n", {"pattern:18: ", "azimuth 90, zenith 60", "line 7"});
  check_refused(csv, header + "0,0,1\n90,0,1\n180,0,1\n0,180,1\n90,180,1\n180,180,1\n",
                {"azimuth_deg: 270 is missing"});
  check_refused(csv, header + "10,0,1\n190,0,1\n10,180,1\n190,180,1\n", {"azimuth_deg: 0 is missing"});
  check_refused(csv, header + "0,0,1\n0,180,1\n", {"one azimuth"});
  check_refused(csv, header + "0,0,1\n180,0,1\n0,90,1\n180,90,1\n", {"zenith_deg: 180 is missing"});
  check_refused(csv, header + "0,30,1\n180,30,1\n0,180,1\n180,180,1\n", {"zenith_deg: 0 is missing"});
  check_refused(csv, header + "0,0,1\n180,0,1\n0,30,1\n180,30,1\n0,180,1\n180,180,1\n", {"zenith_deg: 60 is missing"});
  check_refused(csv, replaced(good, "90,60,11", "90,60,11dB"), {"pattern:7: ", "gain_dbi", "'11dB'"});
  check_refused(csv, replaced(good, "90,60,11", "90,60,nan"), {"pattern:7: ", "'nan'"});
  check_refused(csv, replaced(good, "90,60,11", "90,60,1111"), {"pattern:7: ", "'1111'", "200"});
  check_refused(csv, replaced(good, "90,60,11", "90,190,11"), {"pattern:7: ", "zenith_deg", "'190'"});
  check_refused(csv, replaced(good, "90,60,11", "400,60,11"), {"pattern:7: ", "azimuth_deg", "'400'"});
  check_refused(csv, replaced(good, "90,60,11", "90,60"), {"pattern:7: ", "2 fields; expected 3"});
  check_refused(csv, replaced(good, "gain_dbi", "gain_db"), {"pattern:1: ", "'gain_db'", "'gain_dbi'"});
  check_refused(csv, replaced(good, "azimuth_deg", "zenith_deg"), {"pattern:1: ", "there twice"});
  check_refused(csv, "azimuth_deg,gain_dbi\n0,1\n", {"pattern:1: ", "'zenith_deg' is missing"});
  check_refused(csv, "", {"is empty"});
  check_refused(csv, header, {"holds no gain"});
}

TEST_CASE("an MSI file: exact on both cuts, clockwise and downwards") {
  const PatternTable table = msi(sector_msi());
  REQUIRE(table.azimuth_count() == 360);
  REQUIRE(table.zenith_count() == 181);
  for (int angle = 0; angle < 360; ++angle) {
    CHECK(gain_dbi(table, -angle, 0) == doctest::Approx(18.0 - horizontal_db(angle)).epsilon(1e-12));
    // Down from the boresight over the nadir to the back, and up from there.
    const double down = angle <= 180 ? angle : angle - 360.0;
    const double vertical = agreeing_vertical_db(angle);
    const double found =
        std::abs(down) <= 90 ? gain_dbi(table, 0, -down) : gain_dbi(table, 180, down > 0 ? down - 180.0 : down + 180.0);
    CHECK(found == doctest::Approx(18.0 - vertical).epsilon(1e-12));
  }
  // To the right of the boresight is a clockwise angle of 90, a local azimuth of -90.
  CHECK(gain_dbi(table, -120, 0) == doctest::Approx(18.0 - horizontal_db(120)).epsilon(1e-12));
  CHECK(horizontal_db(120) != horizontal_db(240));
}

TEST_CASE("between the cuts: front and back of the vertical cut weighted by azimuth, and what the horizontal adds") {
  const PatternTable table = msi(tiny_msi);
  // By hand, to the left (clockwise 270) at 30 degrees up. w = 1/2; ahead v = 330: between 270 (15) and 360 (0) 5 dB;
  // behind v = 210: a third of the way from 20 to 15, 18.3333. Horizontal 8, less the mean of 0 and 20.
  const double expected = 0.5 * 5.0 + 0.5 * (20.0 - 5.0 / 3.0) + std::sqrt(0.75) * (8.0 - 10.0);
  CHECK(gain_dbi(table, 90, 30) == doctest::Approx(12.15 - expected).epsilon(1e-12));
  // A pole has one gain, that of the vertical cut.
  for (const double azimuth : {0.0, 90.0, 200.0}) {
    CHECK(gain_dbi(table, azimuth, 90) == doctest::Approx(12.15 - 15.0).epsilon(1e-12));
    CHECK(gain_dbi(table, azimuth, -90) == doctest::Approx(12.15 - 12.0).epsilon(1e-12));
  }
}

TEST_CASE("a horizontal cut that was taken at the tilt holds there, and no gain exceeds the file's") {
  // The beam 10 degrees down; the horizontal cut starts at 0 dB, the vertical one has 12 dB at the horizon.
  std::string text = "NAME tilted\nGAIN 15 dBi\nHORIZONTAL 360\n";
  text += cut_lines([](double a) { return std::min(12.0 * std::pow(std::remainder(a, 360.0) / 65.0, 2), 25.0); });
  text += "VERTICAL 360\n";
  text += cut_lines([](double v) { return std::min(std::abs(std::remainder(v - 10.0, 360.0)) * 1.2, 25.0); });
  const PatternTable table = msi(text);
  CHECK(gain_dbi(table, 0, -10) == doctest::Approx(15.0).epsilon(1e-12));
  CHECK(gain_dbi(table, 0, 0) == doctest::Approx(3.0).epsilon(1e-12));
  // 30 degrees aside on the cone of the tilt: 2.556 dB of the horizontal cut, and what cos 10° and the back leave out.
  CHECK(gain_dbi(table, 30, -10) == doctest::Approx(15.0 - 2.556).epsilon(0.005));
  for (int azimuth = 0; azimuth < 360; azimuth += 5) {
    for (int elevation = -90; elevation <= 90; elevation += 5) CHECK(gain_dbi(table, azimuth, elevation) <= 15.0);
  }
}

TEST_CASE("an omnidirectional antenna of two cuts is its vertical cut, whatever the azimuth") {
  std::string text = "NAME omni\nGAIN 0\nHORIZONTAL 4\n0 0\n90 0\n180 0\n270 0\nVERTICAL 360\n";
  text += cut_lines([](double v) {
    const double gain = power_gain(HalfWaveDipole{}, 0.0, (90.0 + v) * degree) / half_wave_dipole_directivity;
    return std::min(-10.0 * std::log10(std::max(gain, 1e-9)), 60.0);
  });
  const auto table = std::make_shared<const PatternTable>(msi(text));
  for (int azimuth = 0; azimuth < 360; azimuth += 7) {
    for (int elevation = -85; elevation <= 85; elevation += 5) {
      // 0 dBd is the dipole itself; files count 2.15 dB for what is 2.1509.
      CHECK(gain_dbi(*table, azimuth, elevation) + 0.0009 ==
            doctest::Approx(10.0 * std::log10(power_gain(HalfWaveDipole{}, 0.0, (90.0 - elevation) * degree)))
                .epsilon(1e-4));
    }
  }
  // dB is linear between degrees, which is a little less than the pattern's curve; 0.0009 dB are 2e-4.
  CHECK(radiated_share(TabulatedPattern{table}) == doctest::Approx(1.0).epsilon(5e-4));
}

TEST_CASE("made again from its two cuts, the 38.901 element is within 0.8 dB where it radiates") {
  const auto element_dbi = [](double azimuth_rad, double elevation_rad) {
    return 10.0 * std::log10(power_gain(Tr38901Element{}, azimuth_rad, pi / 2 - elevation_rad));
  };
  std::string text = "NAME element\nGAIN 8 dBi\nHORIZONTAL 360\n";
  text += cut_lines([&](double a) { return 8.0 - element_dbi(-a * degree, 0.0); });
  text += "VERTICAL 360\n" + cut_lines([&](double v) {
            const bool behind = v > 90 && v < 270;
            const double elevation_deg = behind ? v - 180.0 : -std::remainder(v, 360.0);
            return 8.0 - element_dbi(behind ? pi : 0.0, elevation_deg * degree);
          });
  const PatternTable table = msi(text);
  double strong_sum = 0.0, strong_weight = 0.0, sum = 0.0, weight = 0.0;
  for (int elevation = -87; elevation < 90; elevation += 3) {
    for (int azimuth = -179; azimuth < 180; azimuth += 3) {
      const double expected = element_dbi(azimuth * degree, elevation * degree);
      const double difference = gain_dbi(table, azimuth, elevation) - expected, area = std::cos(elevation * degree);
      sum += area * difference * difference;
      weight += area;
      if (expected < -12.0) continue;  // 20 dB below the maximum
      strong_sum += area * difference * difference;
      strong_weight += area;
    }
  }
  // As docs/physics.md has it; no formula over two cuts can be exact for this pattern.
  CHECK(std::sqrt(strong_sum / strong_weight) == doctest::Approx(0.8).epsilon(0.05));
  CHECK(std::sqrt(sum / weight) == doctest::Approx(1.7).epsilon(0.05));
}

TEST_CASE("gains are dBd, unless the file says dBi") {
  const auto highest = [](const std::string& gain) { return gain_dbi(msi(replaced(tiny_msi, "GAIN 10", gain)), 0, 0); };
  CHECK(highest("GAIN 10") == doctest::Approx(12.15).epsilon(1e-14));
  CHECK(highest("GAIN 10 dBd") == doctest::Approx(12.15).epsilon(1e-14));
  CHECK(highest("gain 10.5dBD") == doctest::Approx(12.65).epsilon(1e-14));
  CHECK(highest("GAIN 10 dBi") == doctest::Approx(10.0).epsilon(1e-14));
  CHECK(highest("Gain\t-1.5   DBI ") == doctest::Approx(-1.5).epsilon(1e-14));
}

TEST_CASE("the steps of the table are those that the points ask for") {
  const auto cut = [](double step_deg) { return cut_lines([](double) { return 3.0; }, step_deg); };
  const PatternTable table = msi("NAME fine\nGAIN 0\nHORIZONTAL 720\n" + cut(0.5) + "VERTICAL 3600\n" + cut(0.1));
  CHECK(table.azimuth_count() == 720);
  CHECK(table.zenith_count() == 1801);
  CHECK(table.node_dbi(17, 311) == doctest::Approx(-0.85).epsilon(1e-13));
}

TEST_CASE("an NSMA file: the same antenna as in MSI, counted upwards; crossed polarizations are passed over") {
  CHECK(msi(tiny_nsma) == msi(tiny_msi));
  // Absolute values instead of relative ones.
  std::string absolute = replaced(tiny_nsma, "DBD/DBR", "DBI/DBI");
  absolute = replaced(absolute, "MDGAIN:,10", "MDGAIN:,12.15");
  absolute =
      replaced(absolute, "-90,-8,\r\n0,0,\r\n90,-6,\r\n180,-20,", "-90,4.15,\r\n0,12.15,\r\n90,6.15,\r\n180,-7.85,");
  absolute = replaced(absolute, "-180,-20,0\r\n-90,-12\r\n0,0\r\n90,-15\r\n180,-20",
                      "-180,-7.85,0\r\n-90,0.15\r\n0,12.15\r\n90,-2.85\r\n180,-7.85");
  const PatternTable first = msi(tiny_msi), second = msi(absolute);
  for (int azimuth = 0; azimuth < 360; azimuth += 10) {
    for (int elevation = -90; elevation <= 90; elevation += 10) {
      CHECK(gain_dbi(second, azimuth, elevation) ==
            doctest::Approx(gain_dbi(first, azimuth, elevation)).epsilon(1e-13));
    }
  }
}

TEST_CASE("damaged MSI files are refused with the line") {
  check_refused(msi, replaced(tiny_msi, "HORIZONTAL 4", "HORIZONAL 4"), {"no line HORIZONTAL"});
  check_refused(msi, replaced(tiny_msi, "VERTICAL 4\n0 0\n90 12\n180 20\n270 15\n", ""), {"no line VERTICAL"});
  check_refused(msi, replaced(tiny_msi, "GAIN 10\n", ""), {"no line GAIN"});
  check_refused(msi, replaced(tiny_msi, "GAIN 10", "GAIN high"), {"pattern:2: ", "GAIN", "'high'"});
  check_refused(msi, replaced(tiny_msi, "GAIN 10", "GAIN 10 dBm"), {"pattern:2: ", "'10 dBm'"});
  check_refused(msi, replaced(tiny_msi, "GAIN 10", "GAIN 1000"), {"pattern:2: ", "'1000'", "100"});
  check_refused(msi, "GAIN 3\n" + tiny_msi, {"pattern:3: ", "GAIN: there twice"});
  check_refused(msi, tiny_msi + "VERTICAL 1\n0 0\n", {"pattern:13: ", "VERTICAL: there twice"});
  check_refused(msi, replaced(tiny_msi, "HORIZONTAL 4", "HORIZONTAL four"), {"pattern:3: ", "'four'"});
  check_refused(msi, replaced(tiny_msi, "HORIZONTAL 4", "HORIZONTAL 5"), {"pattern:8: ", "VERTICAL"});
  check_refused(msi, replaced(tiny_msi, "HORIZONTAL 4", "HORIZONTAL 3"), {"pattern:6: ", "nothing between 180 and 0"});
  check_refused(msi, tiny_msi + "280 15\n", {"pattern:13: ", "'280 15'"});
  check_refused(msi, replaced(tiny_msi, "VERTICAL 4", "VERTICAL 6"), {"VERTICAL: ends after 4 points"});
  check_refused(msi, replaced(tiny_msi, "90 6", "90 -6"), {"pattern:5: ", "'-6'", "from 0"});
  check_refused(msi, replaced(tiny_msi, "90 6", "90"), {"pattern:5: ", "an angle and an attenuation"});
  check_refused(msi, replaced(tiny_msi, "90 6", "90 6 7"), {"pattern:5: ", "'90 6 7'"});
  check_refused(msi, replaced(tiny_msi, "90 6", "0 6"), {"pattern:5: ", "0 degrees", "line 4"});
  check_refused(msi, replaced(tiny_msi, "90 6", "100 6"), {"pattern:4: ", "nothing between 0 and 100"});
  check_refused(msi, "", {"no line GAIN"});
}

TEST_CASE("damaged NSMA files are refused with the line") {
  check_refused(msi, replaced(tiny_nsma, "DBD/DBR", "DBD/LIN"), {"pattern:5: ", "GUNITS", "LIN"});
  check_refused(msi, replaced(tiny_nsma, "MDGAIN:,10\r\n", ""), {"no line MDGAIN"});
  check_refused(msi, replaced(tiny_nsma, "MDGAIN:,10", "MDGAIN:,ten"), {"pattern:6: ", "'ten'"});
  check_refused(msi, replaced(tiny_nsma, "NOFREQ:,1", "NOFREQ:,3"), {"pattern:8: ", "1 frequency"});
  check_refused(msi, replaced(tiny_nsma, "PATCUT:,EL", "PATCUT:,45"), {"PATCUT", "'45'"});
  check_refused(msi, replaced(tiny_nsma, "PATCUT:,EL\r\nPOLARI:,V/V", "PATCUT:,EL\r\nPOLARI:,H/H"),
                {"no pair of cuts"});
  check_refused(msi, replaced(tiny_nsma, "POLARI:,V/H", "POLARI:,V"), {"pattern:12: ", "POLARI"});
  check_refused(msi, replaced(tiny_nsma, "NUPOIN:,5", "NUPOIN:,6"), {"PATCUT EL", "5 points; expected 6"});
  check_refused(msi, replaced(tiny_nsma, "NUPOIN:,5", "NUPOIN:,many"), {"NUPOIN", "'many'"});
  check_refused(msi, replaced(tiny_nsma, "90,-6,", "90,6,"), {"pattern:25: ", "'6'", "DBR"});
  check_refused(msi, replaced(tiny_nsma, "90,-6,", "90;-6"), {"pattern:25: ", "'90;-6'"});
  check_refused(msi, replaced(tiny_nsma, "90,-6,", "90,-6dB,"), {"pattern:25: ", "'-6dB'"});
  check_refused(msi, replaced(tiny_nsma, "180,-20\r\nENDFIL", "180,-21\r\nENDFIL"), {"180 degrees"});
  check_refused(msi, replaced(tiny_nsma, "REVDAT:,19990520", "0,0"), {"pattern:2: ", "FIELD:,value"});
}

TEST_CASE("whatever stands in a file, reading it ends in a table or in an InputError") {
  std::mt19937 engine(1);
  const auto below = [&](std::size_t bound) { return engine() % bound; };
  for (const auto& [read, text] : {std::pair{std::function<PatternTable(const std::string&)>(csv), small_csv()},
                                   std::pair{std::function<PatternTable(const std::string&)>(msi), tiny_msi},
                                   std::pair{std::function<PatternTable(const std::string&)>(msi), tiny_nsma}}) {
    int accepted = 0, refused = 0;
    for (int round = 0; round < 400; ++round) {
      std::string damaged = text;
      const std::size_t place = below(damaged.size()),
                        length = std::min<std::size_t>(1 + below(8), damaged.size() - place);
      constexpr std::string_view telling = "0123456789-+.e,: \n\tdBiV";
      switch (below(4)) {
        case 0:
          damaged[place] = telling[below(telling.size())];
          break;
        case 1:
          damaged.insert(place, 1, telling[below(telling.size())]);
          break;
        case 2:
          damaged.erase(place, length);
          break;
        default:
          damaged.insert(below(damaged.size()), damaged.substr(place, length));
      }
      try {
        const PatternTable table = read(damaged);
        CHECK(std::isfinite(table.gain_dbi(1.0, 1.0)));
        ++accepted;
      } catch (const io::InputError&) {
        ++refused;
      }
    }
    CHECK(accepted > 10);
    CHECK(refused > 100);
  }
}

TEST_CASE("the pattern that is shipped is that of its description") {
  // data/README.md: 6·cos² of the angle off the boresight, -20 dBi at least, to two decimals.
  const std::filesystem::path file = std::filesystem::path(DCEM_DATA_DIR) / "patch_element.csv";
  const auto table = std::make_shared<const PatternTable>(io::read_pattern_csv(file));
  REQUIRE(table->azimuth_count() == 24);
  REQUIRE(table->zenith_count() == 13);
  for (int row = 0; row < 13; ++row) {
    for (int column = 0; column < 24; ++column) {
      const double cosine = std::sin(15.0 * row * degree) * std::cos(15.0 * column * degree);
      const double gain = cosine > 1e-9 ? std::max(10.0 * std::log10(6.0 * cosine * cosine), -20.0) : -20.0;
      CHECK(std::abs(table->node_dbi(static_cast<std::size_t>(column), static_cast<std::size_t>(row)) - gain) <
            0.00501);
    }
  }
  // The formula radiates 1.005 of what it is fed; steps of 15 degrees cut off the bends, which are hollow in dB.
  CHECK(radiated_share(TabulatedPattern{table}) == doctest::Approx(1.0).epsilon(0.03));
}

}  // namespace test_antenna_files
