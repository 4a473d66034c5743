/// The files of a run with everything that is new in it: diffuse power, air, foliage, profiles, spectra, responses. The
/// program writes them; what they say is worked out again here from `paths.jsonl` alone.
#include <doctest/doctest.h>
#include <sys/wait.h>
#include <zip.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>
#include <set>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include "tests/io/temporary_folder.hpp"

namespace test_channel_files {

using dcem::test::file_bytes;
using dcem::test::TemporaryFolder;
using Json = nlohmann::json;
using Complex = std::complex<double>;

namespace {

constexpr double speed_of_light_mps = 299'792'458.0, two_pi = 2.0 * std::numbers::pi;
constexpr double frequency_hz = 60e9;

// The program ---------------------------------------------------------------------------------------------------------

struct Outcome {
  int exit_code = -1;
  std::string output, error;
};

std::string quoted(const std::filesystem::path& path) {
  return "'" + path.string() + "'";
}

Outcome dcem_program(const TemporaryFolder& folder, const std::string& arguments) {
  const auto output = folder / ".stdout", error = folder / ".stderr";
  const std::string command = "cd " + quoted(folder.path()) + " && " + quoted(DCEM_PROGRAM) + " " + arguments + " > " +
                              quoted(output) + " 2> " + quoted(error);
  const int status = std::system(command.c_str());
  Outcome outcome{WIFEXITED(status) ? WEXITSTATUS(status) : -1, file_bytes(output), file_bytes(error)};
  std::filesystem::remove(output);
  std::filesystem::remove(error);
  return outcome;
}

/// A street: rough ground and wall, a pane, a car that drives, a tree and a bush before the second receiver.
Json street() {
  return Json::parse(R"({
    "format": "dcem-scenario/1", "scene": {"obj": "street.obj"}, "frequency_hz": 60e9,
    "materials": {
      "wall": {"model": "constant", "reflection": 0.8, "scattering": 0.4, "scattering_pattern": "directive", "scattering_lobe": 4},
      "ground": {"model": "constant", "reflection": 0.6, "scattering": 0.5},
      "glass": {"model": "constant", "reflection": 0.5, "penetration_loss_db": 5},
      "metal": {"model": "pec"}, "foliage": {"foliage_db_per_m": 1.5}},
    "time": {"start_s": 0, "step_s": 0.05, "frames": 3},
    "objects": [
      {"id": "car", "box_m": [4, 1.8, 1.5], "material": "metal", "motion": {"position_m": [0, -4, 0], "velocity_mps": [10, 0, 0]}},
      {"id": "tree", "box_m": [3, 3, 5], "foliage": true, "motion": {"position_m": [8, 4.5, 1], "yaw_deg": 20}},
      {"id": "bush", "box_m": [1.5, 1.5, 4], "foliage": true, "motion": {"position_m": [17.2, 4.2, 0]}}],
    "transmitters": [{"id": "bs", "position_m": [-20, 1.25, 5], "power_dbm": 30},
                     {"id": "mast", "position_m": [22, -3, 8], "power_dbm": 23}],
    "receivers": [{"id": "ue", "position_m": [15, 0.5, 1.5], "velocity_mps": [-12, 1, 0]},
                  {"id": "probe", "position_m": [16, 6, 2]}],
    "propagation": {"max_reflections": 2, "max_transmissions": 2, "max_diffractions": 1, "discovery": "exact",
      "diffuse": {"enabled": true, "tolerance_db": 1, "list_paths": true},
      "atmosphere": {"rain_mm_per_h": 20}},
    "output": {"paths": true, "links": true, "pdp": {"bin_s": 2e-9}, "cfr": {"bandwidth_hz": 4e8, "points": 33},
               "doppler": {"bin_hz": 50}}})");
}

/// A run of a scenario and the files it left.
struct Run {
  TemporaryFolder folder;
  Outcome outcome;

  explicit Run(const Json& scenario, const std::string& arguments = "") {
    // A wall of 8 m on the left, a pane before the first transmitter.
    std::ofstream(folder / "street.obj")
        << "v -40 -12 0\nv 40 -12 0\nv 40 12 0\nv -40 12 0\nv -40 12 8\nv 40 12 8\n"
           "v -15 -6 0.2\nv -15 6 0.2\nv -15 6 7\nv -15 -6 7\n"
           "usemtl ground\nf 1 2 3 4\nusemtl wall\nf 4 3 6 5\nusemtl glass\nf 7 8 9 10\n";
    std::ofstream(folder / "street.json") << scenario.dump(1);
    outcome = dcem_program(folder, "run street.json -o out " + arguments);
  }

  std::string bytes(const std::string& name) const { return file_bytes(folder / "out" / name); }
  bool has(const std::string& name) const { return std::filesystem::exists(folder / "out" / name); }
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& entry : std::filesystem::directory_iterator(folder / "out"))
      all.push_back(entry.path().filename().string());
    std::sort(all.begin(), all.end());
    return all;
  }
  Json summary() const { return Json::parse(bytes("summary.json")); }
};

// The files -----------------------------------------------------------------------------------------------------------

std::vector<std::string> split(const std::string& line, char separator) {
  std::vector<std::string> parts{""};
  for (const char character : line) {
    if (character == separator) {
      parts.emplace_back();
    } else {
      parts.back().push_back(character);
    }
  }
  return parts;
}

/// A table whose fields hold no quotes. Every line has as many fields as there are columns.
struct Csv {
  std::vector<std::string> columns;
  std::vector<std::map<std::string, std::string>> rows;

  explicit Csv(const std::string& text) {
    std::istringstream stream(text);
    std::string line;
    REQUIRE(std::getline(stream, line));
    columns = split(line, ',');
    while (std::getline(stream, line)) {
      const std::vector<std::string> fields = split(line, ',');
      REQUIRE(fields.size() == columns.size());
      std::map<std::string, std::string>& row = rows.emplace_back();
      for (std::size_t column = 0; column < fields.size(); ++column) row[columns[column]] = fields[column];
    }
  }
};

double number(const std::string& field) {
  REQUIRE_FALSE(field.empty());
  char* end = nullptr;
  const double value = std::strtod(field.c_str(), &end);
  REQUIRE(*end == '\0');
  REQUIRE(std::isfinite(value));
  return value;
}

/// A line of paths.jsonl.
struct Link {
  Json line;
  std::vector<Json> specular, tiles;
  double power_dbm = 0.0;  ///< of the transmitter

  std::string key() const {
    return line["frame"].dump() + " " + line["tx"].get<std::string>() + " " + line["rx"].get<std::string>();
  }
};

std::vector<Link> links_of(const Run& run) {
  const std::map<std::string, double> powers{{"bs", 30.0}, {"mast", 23.0}};
  std::vector<Link> links;
  std::istringstream stream(run.bytes("paths.jsonl"));
  for (std::string text; std::getline(stream, text);) {
    Link& link = links.emplace_back();
    link.line = Json::parse(text);
    link.power_dbm = powers.at(link.line["tx"]);
    for (const Json& path : link.line["paths"]) {
      const std::string kinds = path["kinds"];
      (kinds.find('S') == std::string::npos ? link.specular : link.tiles).push_back(path);
    }
  }
  return links;
}

std::string key_of(const std::map<std::string, std::string>& row) {
  return row.at("frame") + " " + row.at("tx") + " " + row.at("rx");
}

Complex complex_of(const Json& pair) {
  return {pair[0].get<double>(), pair[1].get<double>()};
}

double ratio_of(const Json& path) {
  return path["path_gain_db"].is_null() ? 0.0 : std::pow(10.0, path["path_gain_db"].get<double>() / 10.0);
}

double db(double ratio) {
  return 10.0 * std::log10(ratio);
}

double sum_of(const std::vector<Json>& paths) {
  return std::accumulate(paths.begin(), paths.end(), 0.0,
                         [](double sum, const Json& path) { return sum + ratio_of(path); });
}

Complex field_of(const std::vector<Json>& paths, double offset_hz = 0.0) {
  Complex sum;
  for (const Json& path : paths) {
    sum += complex_of(path["amplitude"]) * std::polar(1.0, -two_pi * offset_hz * path["delay_s"].get<double>());
  }
  return sum;
}

/// An array of an NPZ file.
struct Array {
  std::string type, shape, data;

  template <typename Value>
  std::vector<Value> values() const {
    std::vector<Value> all(data.size() / sizeof(Value));
    REQUIRE(all.size() * sizeof(Value) == data.size());
    std::memcpy(all.data(), data.data(), data.size());
    return all;
  }
};

std::string between(const std::string& text, const std::string& before, const std::string& after) {
  const std::size_t begin = text.find(before);
  REQUIRE(begin != std::string::npos);
  const std::size_t end = text.find(after, begin + before.size());
  REQUIRE(end != std::string::npos);
  return text.substr(begin + before.size(), end - begin - before.size());
}

std::map<std::string, Array> arrays_of(const std::filesystem::path& path) {
  int error = 0;
  zip_t* archive = zip_open(path.c_str(), ZIP_RDONLY | ZIP_CHECKCONS, &error);
  REQUIRE(archive != nullptr);
  std::map<std::string, Array> arrays;
  for (zip_int64_t index = 0; index < zip_get_num_entries(archive, 0); ++index) {
    zip_stat_t facts;
    REQUIRE(zip_stat_index(archive, static_cast<zip_uint64_t>(index), 0, &facts) == 0);
    zip_file_t* file = zip_fopen_index(archive, static_cast<zip_uint64_t>(index), 0);
    REQUIRE(file != nullptr);
    std::string bytes(facts.size, '\0');
    CHECK(zip_fread(file, bytes.data(), facts.size) == static_cast<zip_int64_t>(facts.size));
    CHECK(zip_fclose(file) == 0);
    REQUIRE(bytes.substr(0, 8) == std::string("\x93NUMPY\x01\x00", 8));
    const std::size_t length = static_cast<unsigned char>(bytes[8]) + 256u * static_cast<unsigned char>(bytes[9]);
    const std::string header = bytes.substr(10, length);
    CHECK(between(header, "'fortran_order': ", ",") == "False");
    const std::string name = facts.name;
    arrays[name.substr(0, name.size() - 4)] = {between(header, "'descr': '", "'"), between(header, "'shape': ", ", }"),
                                               bytes.substr(10 + length)};
  }
  zip_discard(archive);
  return arrays;
}

/// Texts of a '<U…' array.
std::vector<std::string> texts_of(const Array& array) {
  const std::size_t width = std::stoul(array.type.substr(2));
  const auto letters = array.values<std::uint32_t>();
  std::vector<std::string> texts(letters.size() / width);
  for (std::size_t index = 0; index < letters.size(); ++index) {
    if (letters[index] != 0) texts[index / width].push_back(static_cast<char>(letters[index]));
  }
  return texts;
}

const std::vector<std::string> contract_columns = split(
    "frame,time_s,tx,rx,line_of_sight,path_count,complete,valid_until_m,power_dbm,power_incoherent_dbm,power_los_dbm,"
    "power_reflected_dbm,power_transmitted_dbm,power_diffracted_dbm,power_diffuse_dbm,path_gain_db,first_delay_s,"
    "mean_delay_s,rms_delay_spread_s,k_factor_db,azimuth_spread_arrival_rad,azimuth_spread_departure_rad,"
    "mean_doppler_hz,rms_doppler_spread_hz",
    ',');

/// No word for a number that is none, in any field.
void check_numbers(const std::string& text) {
  for (const char* word : {"nan", "NaN", "inf", "Inf", "-nan"}) {
    CAPTURE(word);
    CHECK(text.find(word) == std::string::npos);
  }
}

/// One run for all cases that ask the same files.
const Run& street_run() {
  static const Run run(street());
  return run;
}

}  // namespace

#define DCEM_NEEDS_PROGRAM()                                  \
  if (!std::filesystem::exists(DCEM_PROGRAM)) {               \
    MESSAGE("skipped: there is no program at " DCEM_PROGRAM); \
    return;                                                   \
  }                                                           \
  static_assert(true, "asks for a semicolon")

TEST_CASE("the run ends well, and what it is asked for is there") {
  DCEM_NEEDS_PROGRAM();
  const Run& run = street_run();
  CAPTURE(run.outcome.error);
  REQUIRE(run.outcome.exit_code == 0);
  CHECK(run.names() ==
        std::vector<std::string>{"cfr.npz", "doppler.csv", "links.csv", "paths.jsonl", "pdp.csv", "summary.json"});
  for (const char* name : {"doppler.csv", "links.csv", "paths.jsonl", "pdp.csv", "summary.json"})
    check_numbers(run.bytes(name));
  const std::vector<Link> links = links_of(run);
  CHECK(links.size() == 3 * 2 * 2);
  std::size_t tiles = 0, specular = 0, behind_glass = 0;
  for (const Link& link : links) {
    tiles += link.tiles.size();
    specular += link.specular.size();
    for (const Json& tile : link.tiles) behind_glass += tile["kinds"] != "S";
  }
  // Enough of everything for the cases below.
  CHECK(tiles > 1000);
  CHECK(behind_glass > 100);
  CHECK(specular > 50);
}

TEST_CASE("links.csv: the contract's columns in its order, new ones behind") {
  DCEM_NEEDS_PROGRAM();
  const Csv table(street_run().bytes("links.csv"));
  REQUIRE(table.columns.size() >= contract_columns.size());
  CHECK(std::equal(contract_columns.begin(), contract_columns.end(), table.columns.begin()));
  CHECK(std::set<std::string>(table.columns.begin(), table.columns.end()).size() == table.columns.size());
  CHECK(table.rows.size() == 12);
  for (const auto& row : table.rows) {
    for (const std::string& column : table.columns) {
      CAPTURE(column);
      if (column == "tx" || column == "rx" || row.at(column).empty()) continue;
      number(row.at(column));
    }
    CHECK(row.at("valid_until_m").empty());
    CHECK_FALSE(row.at("power_diffuse_dbm").empty());
  }
}

TEST_CASE("links.csv: powers are those of the listed paths and tiles") {
  DCEM_NEEDS_PROGRAM();
  const Csv table(street_run().bytes("links.csv"));
  const std::vector<Link> links = links_of(street_run());
  REQUIRE(table.rows.size() == links.size());
  std::size_t in_sight = 0, hidden = 0;
  for (std::size_t index = 0; index < links.size(); ++index) {
    const auto& row = table.rows[index];
    const Link& link = links[index];
    CAPTURE(link.key());
    REQUIRE(key_of(row) == link.key());
    CHECK(row.at("path_count") == std::to_string(link.specular.size()));
    CHECK(row.at("complete") == "1");
    const double diffuse = sum_of(link.tiles);
    const auto close = [&](const char* column, double ratio) {
      CAPTURE(column);
      // Gains are listed in dB with all digits: 1e-15 of 100 dB is 1e-14 of the power; sums of thousands.
      if (ratio == 0.0) {
        CHECK(row.at(column).empty());
      } else {
        CHECK(std::abs(number(row.at(column)) - (link.power_dbm + db(ratio))) < 1e-9);
      }
    };
    close("power_diffuse_dbm", diffuse);
    CHECK(std::pow(10.0, (number(row.at("power_diffuse_dbm")) - link.power_dbm) / 10.0) ==
          doctest::Approx(diffuse).epsilon(1e-9).scale(0.0));
    close("power_dbm", std::norm(field_of(link.specular)) + diffuse);
    close("power_incoherent_dbm", sum_of(link.specular) + diffuse);
    std::map<char, double> shares{{'L', 0.0}, {'R', 0.0}, {'T', 0.0}, {'D', 0.0}};
    for (const Json& path : link.specular) {
      const std::string kinds = path["kinds"];
      const auto has = [&](char kind) { return kinds.find(kind) != std::string::npos; };
      shares[kinds.empty() ? 'L' : has('D') ? 'D' : has('R') ? 'R' : 'T'] += ratio_of(path);
    }
    close("power_los_dbm", shares['L']);
    close("power_reflected_dbm", shares['R']);
    close("power_transmitted_dbm", shares['T']);
    close("power_diffracted_dbm", shares['D']);
    CHECK(std::abs(number(row.at("path_gain_db")) + link.power_dbm - number(row.at("power_dbm"))) < 1e-9);
    const double rest = shares['R'] + shares['T'] + shares['D'] + diffuse;
    // Behind foliage the direct path is listed, and yet there is no line of sight.
    if (shares['L'] > 0.0 && row.at("line_of_sight") == "1") {
      CHECK(std::abs(number(row.at("k_factor_db")) - db(shares['L'] / rest)) < 1e-9);
      ++in_sight;
    } else {
      CHECK(row.at("k_factor_db").empty());
      ++hidden;
    }
  }
  CHECK(in_sight > 2);
  CHECK(hidden > 2);
}

TEST_CASE("links.csv: delays, spreads and Doppler weigh paths and tiles alike") {
  DCEM_NEEDS_PROGRAM();
  const Csv table(street_run().bytes("links.csv"));
  const std::vector<Link> links = links_of(street_run());
  for (std::size_t index = 0; index < links.size(); ++index) {
    const auto& row = table.rows[index];
    CAPTURE(links[index].key());
    const Json& paths = links[index].line["paths"];
    double total = 0.0, first_s = 1.0, delay = 0.0, doppler = 0.0;
    std::map<std::string, Complex> phasors;
    for (const Json& path : paths) {
      const double power = ratio_of(path);
      total += power;
      first_s = std::min(first_s, path["delay_s"].get<double>());
      delay += power * path["delay_s"].get<double>();
      doppler += power * path["doppler_hz"].get<double>();
      for (const char* end : {"arrival", "departure"}) {
        for (const char* angle : {"azimuth", "zenith"}) {
          phasors[std::string(angle) + "_spread_" + end + "_rad"] +=
              std::polar(power, path[end][std::string(angle) + "_rad"].get<double>());
        }
      }
    }
    const double mean_s = delay / total, mean_hz = doppler / total;
    double delay_square = 0.0, doppler_square = 0.0;
    for (const Json& path : paths) {
      delay_square += ratio_of(path) / total * std::pow(path["delay_s"].get<double>() - mean_s, 2);
      doppler_square += ratio_of(path) / total * std::pow(path["doppler_hz"].get<double>() - mean_hz, 2);
    }
    const auto near = [&](const std::string& column, double expected) {
      CAPTURE(column);
      CHECK(number(row.at(column)) == doctest::Approx(expected).epsilon(1e-9).scale(0.0));
    };
    near("first_delay_s", first_s);
    near("mean_delay_s", mean_s);
    near("rms_delay_spread_s", std::sqrt(delay_square));
    near("mean_doppler_hz", mean_hz);
    near("rms_doppler_spread_hz", std::sqrt(doppler_square));
    for (const auto& [column, phasor] : phasors) near(column, std::sqrt(-2.0 * std::log(std::abs(phasor) / total)));
    // Coherence: the correlation has fallen to one half there, and not before a sixth of 1/spread.
    for (const auto& [column, quantity, spread] :
         {std::tuple("coherence_bandwidth_hz", "delay_s", "rms_delay_spread_s"),
          std::tuple("coherence_time_s", "doppler_hz", "rms_doppler_spread_hz")}) {
      if (row.at(column).empty()) continue;
      const double step = number(row.at(column));
      Complex correlation;
      for (const Json& path : paths) {
        correlation += std::polar(ratio_of(path) / total, two_pi * step * path[quantity].get<double>());
      }
      CHECK(std::abs(correlation) == doctest::Approx(0.5).epsilon(1e-6));
      CHECK(step * number(row.at(spread)) > 1.0 / 6.0 - 1e-9);
    }
  }
}

TEST_CASE("tiles in paths.jsonl have everything of a path but a field") {
  DCEM_NEEDS_PROGRAM();
  const std::map<std::string, std::array<double, 3>> transmitters{{"bs", {-20, 1.25, 5}}, {"mast", {22, -3, 8}}};
  for (const Link& link : links_of(street_run())) {
    CAPTURE(link.key());
    const double time_s = link.line["time_s"];
    const std::array<double, 3> from = transmitters.at(link.line["tx"]);
    const bool moves = link.line["rx"] == "ue";
    const std::array<double, 3> to =
        moves ? std::array{15 - 12 * time_s, 0.5 + time_s, 1.5} : std::array{16.0, 6.0, 2.0};
    const auto apart = [](const std::array<double, 3>& a, const Json& b) {
      return std::hypot(a[0] - b[0].get<double>(), a[1] - b[1].get<double>(), a[2] - b[2].get<double>());
    };
    for (const Json& tile : link.tiles) {
      CHECK(tile["transfer"].is_null());
      CHECK(tile["amplitude"].is_null());
      const std::string kinds = tile["kinds"];
      CHECK(std::count(kinds.begin(), kinds.end(), 'S') == 1);
      CHECK(kinds.find_first_not_of("ST") == std::string::npos);
      for (const char* list : {"points_m", "objects", "materials"}) CHECK(tile[list].size() == kinds.size());
      const std::size_t place = kinds.find('S');
      const std::string material = tile["materials"][place];
      CHECK((material == "wall" || material == "ground"));  // neither pane, car nor tree scatters
      const Json& point = tile["points_m"][place];
      CHECK(tile["length_m"].get<double>() == doctest::Approx(apart(from, point) + apart(to, point)).epsilon(1e-12));
      CHECK(tile["delay_s"].get<double>() ==
            doctest::Approx(tile["length_m"].get<double>() / speed_of_light_mps).epsilon(1e-14).scale(0.0));
      CHECK(tile["received_power_dbm"].get<double>() ==
            doctest::Approx(tile["path_gain_db"].get<double>() + link.power_dbm).epsilon(1e-14));
      CHECK(tile["departure"]["azimuth_rad"].get<double>() ==
            doctest::Approx(std::atan2(point[1].get<double>() - from[1], point[0].get<double>() - from[0]))
                .epsilon(1e-13));
      CHECK(tile["arrival"]["zenith_rad"].get<double>() ==
            doctest::Approx(std::acos((point[2].get<double>() - to[2]) / apart(to, point))).epsilon(1e-13));
      // Only the receiver moves, and the walls stand: f = −v·k/λ with k along the last leg.
      const double closing_mps =
          moves ? ((point[0].get<double>() - to[0]) * -12 + (point[1].get<double>() - to[1])) / apart(to, point) : 0.0;
      CHECK(std::abs(tile["doppler_hz"].get<double>() - closing_mps * frequency_hz / speed_of_light_mps) < 1e-6);
    }
  }
}

TEST_CASE("ids of paths and tiles are unique within a link, and a tile keeps its id from frame to frame") {
  DCEM_NEEDS_PROGRAM();
  std::map<std::string, std::map<std::string, Json>> by_link;
  std::size_t again = 0, all = 0;
  for (const Link& link : links_of(street_run())) {
    std::set<std::string> ids;
    auto& known = by_link[link.line["tx"].get<std::string>() + link.line["rx"].get<std::string>()];
    for (const Json& path : link.line["paths"]) {
      const std::string id = path["id"];
      CAPTURE(id);
      CHECK(ids.insert(id).second);
      if (path["kinds"].get<std::string>().find('S') == std::string::npos) continue;
      ++all;
      const auto before = known.find(id);
      if (before != known.end()) {
        ++again;
        const std::size_t place = path["kinds"].get<std::string>().find('S');
        // The walls stand still. What of them is visible is cut out in another order, so corners are rounded otherwise.
        for (std::size_t axis = 0; axis < 3; ++axis) {
          CHECK(std::abs(path["points_m"][place][axis].get<double>() -
                         before->second["points_m"][place][axis].get<double>()) < 1e-9);
        }
        CHECK(path["materials"] == before->second["materials"]);
      }
      known[id] = path;
    }
  }
  // Two frames of three have one before. The receiver moves by 0.6 m: most tiles are cut as they were.
  CHECK(static_cast<double>(again) > 0.4 * static_cast<double>(all));
}

TEST_CASE("tiles stand among the paths by delay, kinds, points") {
  DCEM_NEEDS_PROGRAM();
  bool mixed = false;
  for (const Link& link : links_of(street_run())) {
    const Json& paths = link.line["paths"];
    bool tile_before = false;
    for (std::size_t index = 0; index < paths.size(); ++index) {
      const bool is_tile = paths[index]["transfer"].is_null();
      mixed = mixed || (tile_before && !is_tile);
      tile_before = tile_before || is_tile;
      if (index == 0) continue;
      const auto order = [](const Json& path) {
        return std::tuple(path["delay_s"].get<double>(), path["kinds"].get<std::string>(),
                          path["points_m"].get<std::vector<std::vector<double>>>());
      };
      CHECK(order(paths[index - 1]) <= order(paths[index]));
    }
  }
  CHECK(mixed);
}

TEST_CASE("whether tiles are listed changes no other number, and without diffuse power the rest stays") {
  DCEM_NEEDS_PROGRAM();
  Json unlisted = street(), off = street();
  unlisted["propagation"]["diffuse"]["list_paths"] = false;
  off["propagation"]["diffuse"]["enabled"] = false;
  const Run listed_run(street()), unlisted_run(unlisted), off_run(off);
  REQUIRE(unlisted_run.outcome.exit_code == 0);
  REQUIRE(off_run.outcome.exit_code == 0);
  for (const char* name : {"links.csv", "pdp.csv", "doppler.csv", "cfr.npz"}) {
    CAPTURE(name);
    CHECK(unlisted_run.bytes(name) == listed_run.bytes(name));
  }
  CHECK(unlisted_run.bytes("paths.jsonl") == off_run.bytes("paths.jsonl"));
  for (const Link& link : links_of(unlisted_run)) CHECK(link.tiles.empty());
  CHECK(off_run.bytes("cfr.npz") == listed_run.bytes("cfr.npz"));
  const Csv with(listed_run.bytes("links.csv")), without(off_run.bytes("links.csv"));
  CHECK(with.columns == without.columns);
  for (std::size_t index = 0; index < with.rows.size(); ++index) {
    CHECK(without.rows[index].at("power_diffuse_dbm").empty());
    for (const char* column : {"line_of_sight", "path_count", "complete", "power_los_dbm", "power_reflected_dbm",
                               "power_transmitted_dbm", "power_diffracted_dbm"}) {
      CAPTURE(column);
      CHECK(with.rows[index].at(column) == without.rows[index].at(column));
    }
  }
  // A profile says of diffuse power only where it is computed.
  CHECK(Csv(off_run.bytes("pdp.csv")).columns == split("frame,tx,rx,delay_s,power_dbm", ','));
  CHECK(Csv(listed_run.bytes("pdp.csv")).columns == split("frame,tx,rx,delay_s,power_dbm,power_diffuse_dbm", ','));
}

TEST_CASE("without the block diffuse, rough walls scatter nothing, but their mirrors stay weakened") {
  DCEM_NEEDS_PROGRAM();
  Json silent = street(), off = street();
  silent["propagation"].erase("diffuse");
  off["propagation"]["diffuse"]["enabled"] = false;
  const Run silent_run(silent), off_run(off);
  REQUIRE(silent_run.outcome.exit_code == 0);
  for (const char* name : {"links.csv", "pdp.csv", "doppler.csv", "cfr.npz", "paths.jsonl"})
    CHECK(silent_run.bytes(name) == off_run.bytes(name));
  Json smooth = silent;
  for (const char* key : {"scattering", "scattering_pattern", "scattering_lobe"})
    smooth["materials"]["wall"].erase(key);
  smooth["materials"]["ground"].erase("scattering");
  const Run smooth_run(smooth);
  const auto rough = links_of(silent_run), plain = links_of(smooth_run);
  std::size_t compared = 0;
  for (std::size_t link = 0; link < rough.size(); ++link) {
    REQUIRE(rough[link].specular.size() == plain[link].specular.size());
    for (std::size_t path = 0; path < rough[link].specular.size(); ++path) {
      const Json &weak = rough[link].specular[path], &strong = plain[link].specular[path];
      if (weak["kinds"].get<std::string>().find('D') != std::string::npos) continue;
      double expected_db = 0.0;  // each mirror keeps 1 − S² of its power
      for (std::size_t at = 0; at < weak["materials"].size(); ++at) {
        if (weak["kinds"].get<std::string>()[at] != 'R') continue;
        if (weak["materials"][at] == "wall") expected_db += db(1.0 - 0.16);
        if (weak["materials"][at] == "ground") expected_db += db(1.0 - 0.25);
      }
      CHECK(std::abs(weak["path_gain_db"].get<double>() - strong["path_gain_db"].get<double>() - expected_db) < 1e-9);
      compared += expected_db != 0.0;
    }
  }
  CHECK(compared > 10);
}

// Profiles ------------------------------------------------------------------------------------------------------------

namespace {

struct ProfileRow {
  double delay_s, ratio, diffuse;
};

std::map<std::string, std::vector<ProfileRow>> profiles_of(const Run& run) {
  check_numbers(run.bytes("pdp.csv"));
  const std::map<std::string, double> powers{{"bs", 30.0}, {"mast", 23.0}};
  std::map<std::string, std::vector<ProfileRow>> profiles;
  for (const auto& row : Csv(run.bytes("pdp.csv")).rows) {
    const double power_dbm = powers.at(row.at("tx"));
    const auto ratio = [&](const std::string& field) { return std::pow(10.0, (number(field) - power_dbm) / 10.0); };
    const std::string& diffuse = row.at("power_diffuse_dbm");
    const ProfileRow line{number(row.at("delay_s")), ratio(row.at("power_dbm")),
                          diffuse.empty() ? 0.0 : ratio(diffuse)};
    std::vector<ProfileRow>& profile = profiles[key_of(row)];
    if (!profile.empty()) CHECK(profile.back().delay_s < line.delay_s);
    CHECK(line.ratio > 0.0);
    CHECK(line.diffuse <= line.ratio * (1.0 + 1e-12));
    profile.push_back(line);
  }
  return profiles;
}

Json street_with_profile(const std::string& mode) {
  Json scenario = street();
  scenario["output"]["pdp"] = {{"bin_s", 2e-9}, {"mode", mode}};
  return scenario;
}

/// Power by number of the bin, worked out from the listed paths: n·bin ≤ delay < (n + 1)·bin.
struct Bins {
  std::map<long long, double> incoherent, coherent, diffuse;
};

Bins bins_of(const Link& link, double bin_s) {
  Bins bins;
  std::map<long long, Complex> fields;
  const auto bin = [&](const Json& path) {
    return static_cast<long long>(std::floor(path["delay_s"].get<double>() / bin_s));
  };
  for (const Json& path : link.specular) {
    bins.incoherent[bin(path)] += ratio_of(path);
    fields[bin(path)] += complex_of(path["amplitude"]);
  }
  for (const auto& [index, field] : fields) bins.coherent[index] = std::norm(field);
  for (const Json& tile : link.tiles) {
    bins.diffuse[bin(tile)] += ratio_of(tile);
    bins.incoherent[bin(tile)] += ratio_of(tile);
    bins.coherent[bin(tile)] += ratio_of(tile);
  }
  return bins;
}

}  // namespace

TEST_CASE("pdp.csv: bins hold the powers, or the squared field, of their paths, and diffuse power beside") {
  DCEM_NEEDS_PROGRAM();
  const double bin_s = 2e-9;
  for (const std::string mode : {"incoherent", "coherent"}) {
    CAPTURE(mode);
    const Run run(street_with_profile(mode));
    REQUIRE(run.outcome.exit_code == 0);
    auto profiles = profiles_of(run);
    const Csv table(run.bytes("links.csv"));
    const std::vector<Link> links = links_of(run);
    for (std::size_t index = 0; index < links.size(); ++index) {
      const Link& link = links[index];
      CAPTURE(link.key());
      const Bins bins = bins_of(link, bin_s);
      const std::map<long long, double>& expected = mode == "coherent" ? bins.coherent : bins.incoherent;
      const std::vector<ProfileRow>& profile = profiles[link.key()];
      REQUIRE(profile.size() == expected.size());
      double sum = 0.0, diffuse_sum = 0.0;
      std::size_t row = 0;
      for (const auto& [bin, ratio] : expected) {
        CHECK(profile[row].delay_s == doctest::Approx(double(bin) * bin_s).epsilon(1e-12).scale(0.0));
        CHECK(profile[row].ratio == doctest::Approx(ratio).epsilon(1e-9).scale(0.0));
        const auto found = bins.diffuse.find(bin);
        const double diffuse = found == bins.diffuse.end() ? 0.0 : found->second;
        CHECK(std::abs(profile[row].diffuse - diffuse) <= 1e-9 * diffuse);
        sum += profile[row].ratio;
        diffuse_sum += profile[row].diffuse;
        ++row;
      }
      if (mode == "incoherent")
        CHECK(db(sum) + link.power_dbm ==
              doctest::Approx(number(table.rows[index].at("power_incoherent_dbm"))).epsilon(1e-9));
      CHECK(db(diffuse_sum) + link.power_dbm ==
            doctest::Approx(number(table.rows[index].at("power_diffuse_dbm"))).epsilon(1e-9));
    }
  }
}

TEST_CASE("pdp.csv, band limited: the transform of the response, its energy the mean over the band") {
  DCEM_NEEDS_PROGRAM();
  const double bin_s = 2e-9, bandwidth_hz = 1.0 / bin_s;
  const Run run(street_with_profile("band_limited"));
  REQUIRE(run.outcome.exit_code == 0);
  auto profiles = profiles_of(run);
  std::size_t taps = 0;
  for (const Link& link : links_of(run)) {
    CAPTURE(link.key());
    const std::vector<ProfileRow>& profile = profiles[link.key()];
    REQUIRE_FALSE(profile.empty());
    // From the first delay to the last with 32 taps more on both sides, an odd number.
    double first_s = 1.0, last_s = 0.0;
    for (const Json& path : link.line["paths"]) {
      first_s = std::min(first_s, path["delay_s"].get<double>());
      last_s = std::max(last_s, path["delay_s"].get<double>());
    }
    const auto begin = static_cast<long long>(std::floor(first_s / bin_s)) - 32;
    const auto end = static_cast<long long>(std::ceil(last_s / bin_s)) + 32;
    const long long count = (end - begin + 1) | 1;
    CHECK(static_cast<long long>(profile.size()) <= count);
    CHECK(profile.front().delay_s >= double(begin) * bin_s - 1e-15);
    CHECK(profile.back().delay_s <= double(begin + count - 1) * bin_s + 1e-15);
    // H at the middles of N equal parts of the band, transformed back tap by tap.
    std::vector<Complex> response;
    double mean = 0.0;
    for (long long k = 0; k < count; ++k) {
      const double offset_hz = (double(k) - 0.5 * (double(count) - 1.0)) * bandwidth_hz / double(count);
      response.push_back(field_of(link.specular, offset_hz));
      mean += std::norm(response.back()) / double(count);
    }
    double sum = 0.0, diffuse_sum = 0.0, largest = 0.0;
    for (const ProfileRow& row : profile) largest = std::max(largest, row.ratio);
    for (std::size_t index = 0; index < profile.size(); ++index) {
      const ProfileRow& row = profile[index];
      sum += row.ratio - row.diffuse;
      diffuse_sum += row.diffuse;
      if (index % 7 != 0) continue;
      Complex field;
      for (long long k = 0; k < count; ++k) {
        const double offset_hz = (double(k) - 0.5 * (double(count) - 1.0)) * bandwidth_hz / double(count);
        field +=
            response[static_cast<std::size_t>(k)] * std::polar(1.0 / double(count), two_pi * offset_hz * row.delay_s);
      }
      double diffuse = 0.0;
      for (const Json& tile : link.tiles) {
        const double x = (row.delay_s - tile["delay_s"].get<double>()) / bin_s;
        const double kernel = std::abs(x) < 1e-9 ? 1.0
                                                 : std::sin(std::numbers::pi * x) /
                                                       (double(count) * std::sin(std::numbers::pi * x / double(count)));
        diffuse += ratio_of(tile) * kernel * kernel;
      }
      CHECK(row.diffuse == doctest::Approx(diffuse).epsilon(1e-6).scale(0.0));
      CHECK(std::abs(row.ratio - row.diffuse - std::norm(field)) < 1e-9 * largest);
      ++taps;
    }
    CHECK(sum == doctest::Approx(mean).epsilon(1e-9).scale(0.0));
    CHECK(diffuse_sum == doctest::Approx(sum_of(link.tiles)).epsilon(1e-9).scale(0.0));
  }
  CHECK(taps > 50);
}

TEST_CASE("doppler.csv: every path's and tile's power in the bin around its shift") {
  DCEM_NEEDS_PROGRAM();
  const Run& run = street_run();
  const Csv table(run.bytes("doppler.csv"));
  CHECK(table.columns == split("frame,tx,rx,doppler_hz,power_dbm", ','));
  std::map<std::string, std::map<long long, double>> spectra;
  for (const auto& row : table.rows) {
    const double shift = number(row.at("doppler_hz")) / 50.0;
    CHECK(std::abs(shift - std::round(shift)) < 1e-9);
    auto& spectrum = spectra[key_of(row)];
    const auto bin = static_cast<long long>(std::round(shift));
    if (!spectrum.empty()) CHECK(spectrum.rbegin()->first < bin);
    spectrum[bin] = number(row.at("power_dbm"));
  }
  bool spread = false;
  for (const Link& link : links_of(run)) {
    CAPTURE(link.key());
    std::map<long long, double> expected;
    for (const Json& path : link.line["paths"]) {
      expected[static_cast<long long>(std::floor(path["doppler_hz"].get<double>() / 50.0 + 0.5))] += ratio_of(path);
    }
    const auto& found = spectra[link.key()];
    REQUIRE(found.size() == expected.size());
    for (const auto& [bin, ratio] : expected) {
      REQUIRE(found.contains(bin));
      CHECK(found.at(bin) == doctest::Approx(link.power_dbm + db(ratio)).epsilon(1e-9));
    }
    spread = spread || found.size() > 20;
  }
  CHECK(spread);
}

// Responses -----------------------------------------------------------------------------------------------------------

TEST_CASE("cfr.npz: frames, receivers, transmitters, frequencies; the response is that of the listed paths") {
  DCEM_NEEDS_PROGRAM();
  const Run& run = street_run();
  const auto arrays = arrays_of(run.folder / "out" / "cfr.npz");
  CHECK(arrays.at("h").type == "<c16");
  CHECK(arrays.at("h").shape == "(3, 2, 2, 33)");
  CHECK(arrays.at("valid").shape == "(3, 2, 2)");
  CHECK(arrays.at("valid").values<char>() == std::vector<char>(12, 1));
  CHECK(arrays.at("time_s").values<double>() == std::vector<double>{0.0, 0.05, 0.1});
  CHECK(texts_of(arrays.at("tx_id")) == std::vector<std::string>{"bs", "mast"});
  CHECK(texts_of(arrays.at("rx_id")) == std::vector<std::string>{"ue", "probe"});
  const auto frequencies_hz = arrays.at("frequency_hz").values<double>();
  REQUIRE(frequencies_hz.size() == 33);
  CHECK(frequencies_hz[16] == 60e9);
  CHECK(frequencies_hz[1] - frequencies_hz[0] == doctest::Approx(4e8 / 33.0).epsilon(1e-6));
  CHECK(frequencies_hz.front() == doctest::Approx(60e9 - 2e8 + 2e8 / 33.0).epsilon(1e-14));
  const auto h = arrays.at("h").values<Complex>();
  REQUIRE(h.size() == 3 * 2 * 2 * 33);
  std::size_t compared = 0;
  for (const Link& link : links_of(run)) {
    CAPTURE(link.key());
    const std::size_t frame = link.line["frame"], receiver = link.line["rx"] == "ue" ? 0 : 1,
                      transmitter = link.line["tx"] == "bs" ? 0 : 1;
    double size = 0.0;
    for (const Json& path : link.specular) size += std::abs(complex_of(path["amplitude"]));
    for (std::size_t k = 0; k < 33; ++k) {
      const Complex found = h[((frame * 2 + receiver) * 2 + transmitter) * 33 + k];
      const double offset_hz = (double(k) - 16.0) * 4e8 / 33.0;
      CHECK(std::abs(found - field_of(link.specular, offset_hz)) < 1e-12 * size);
      ++compared;
    }
  }
  CHECK(compared == h.size());
}

TEST_CASE("cfr.npz with a dual-polarized device has receive and transmit ports") {
  DCEM_NEEDS_PROGRAM();
  Json scenario = street();
  scenario["receivers"][1]["antenna"] = {{"polarization", "VH"}};
  scenario["output"]["cfr"] = {{"bandwidth_hz", 1e8}, {"points", 4}};
  const Run run(scenario);
  REQUIRE(run.outcome.exit_code == 0);
  const auto arrays = arrays_of(run.folder / "out" / "cfr.npz");
  CHECK(arrays.at("h").shape == "(3, 2, 2, 2, 2, 4)");
  CHECK(arrays.at("valid").shape == "(3, 2, 2)");
  const auto h = arrays.at("h").values<Complex>();
  REQUIRE(h.size() == 3 * 2 * 2 * 2 * 2 * 4);
  bool crossed = false;
  for (const Link& link : links_of(run)) {
    CAPTURE(link.key());
    const bool dual = link.line["rx"] == "probe";
    const std::size_t frame = link.line["frame"], receiver = dual ? 1 : 0,
                      transmitter = link.line["tx"] == "bs" ? 0 : 1;
    for (std::size_t port = 0; port < 4; ++port) {
      const std::size_t out = port / 2, in = port % 2;
      for (std::size_t k = 0; k < 4; ++k) {
        // Both transmitters are V: what goes out is the first component alone; a port that is not there hears nothing.
        Complex expected;
        double size = 1e-300;
        for (const Json& path : link.specular) {
          if (in == 1 || (out == 1 && !dual)) continue;
          const double offset_hz = (double(k) - 1.5) * 1e8 / 4.0;
          const Complex entry = complex_of(path["transfer"][out][in]);
          expected += entry * std::polar(1.0, -two_pi * offset_hz * path["delay_s"].get<double>());
          size += std::abs(entry);
        }
        const Complex found = h[((((frame * 2 + receiver) * 2 + transmitter) * 2 + out) * 2 + in) * 4 + k];
        CHECK(std::abs(found - expected) <= 1e-12 * size);
        crossed = crossed || (out == 1 && std::abs(found) > 0.0);
      }
    }
    for (const Json& path : link.specular) CHECK(path["amplitude"].is_null() == dual);
  }
  CHECK(crossed);
}

TEST_CASE("cfr.npz: of a device that is away nothing is valid, and its response is zero") {
  DCEM_NEEDS_PROGRAM();
  Json scenario = street();
  scenario.erase("time");
  scenario["objects"] = Json::array();
  scenario["mobility"] = {{"sumo_fcd", "trace.xml"}, {"vehicle_types", "types.xml"}, {"material", "metal"}};
  scenario["receivers"][1] = {{"id", "rider"}, {"attach_to", "a"}, {"offset_m", {0, 0, 2}}};
  TemporaryFolder folder;
  std::ofstream(folder / "street.obj") << "v -40 -12 0\nv 40 -12 0\nv 40 12 0\nv -40 12 0\nusemtl ground\nf 1 2 3 4\n";
  std::ofstream(folder / "street.json") << scenario.dump(1);
  std::ofstream(folder / "types.xml")
      << "<additional><vType id=\"car\" length=\"4\" width=\"2\" height=\"1.5\"/></additional>";
  const std::string car = "<vehicle id=\"a\" type=\"car\" x=\"5\" y=\"1\" angle=\"90\" speed=\"8\"/>";
  std::ofstream(folder / "trace.xml") << "<fcd-export><timestep time=\"0\"/><timestep time=\"0.1\">" << car
                                      << "</timestep><timestep time=\"0.2\"/></fcd-export>";
  const Outcome outcome = dcem_program(folder, "run street.json -o out");
  CAPTURE(outcome.error);
  REQUIRE(outcome.exit_code == 0);
  const auto arrays = arrays_of(folder / "out" / "cfr.npz");
  CHECK(arrays.at("h").shape == "(3, 2, 2, 33)");
  CHECK(arrays.at("valid").values<char>() == std::vector<char>{1, 1, 0, 0, 1, 1, 1, 1, 1, 1, 0, 0});
  const auto h = arrays.at("h").values<Complex>();
  for (const std::size_t link : {2U, 3U, 10U, 11U}) {
    for (std::size_t k = 0; k < 33; ++k) CHECK(h.at(link * 33 + k) == Complex());
  }
  for (const std::size_t link : {6U, 7U}) CHECK(std::abs(h.at(link * 33)) > 0.0);
  CHECK(Csv(file_bytes(folder / "out" / "links.csv")).rows.size() == 2 * 2 + 4);
}

TEST_CASE("a part of the frames has the responses of that part") {
  DCEM_NEEDS_PROGRAM();
  const Run part(street(), "--frames 1:3");
  REQUIRE(part.outcome.exit_code == 0);
  const auto whole = arrays_of(street_run().folder / "out" / "cfr.npz"),
             some = arrays_of(part.folder / "out" / "cfr.npz");
  CHECK(some.at("h").shape == "(2, 2, 2, 33)");
  CHECK(some.at("time_s").values<double>() == std::vector<double>{0.05, 0.1});
  CHECK(whole.at("h").data.substr(4 * 33 * sizeof(Complex)) == some.at("h").data);
}

// The run -------------------------------------------------------------------------------------------------------------

TEST_CASE("the number of threads changes no byte of any result") {
  DCEM_NEEDS_PROGRAM();
  for (const std::string phases : {"incoherent", "seeded"}) {
    Json scenario = street();
    scenario["propagation"]["diffuse"]["phases"] = phases;
    const Run one(scenario, "--threads 1"), four(scenario, "--threads 4");
    REQUIRE(one.outcome.exit_code == 0);
    REQUIRE(four.outcome.exit_code == 0);
    for (const std::string& name : one.names()) {
      CAPTURE(name);
      if (name != "summary.json") CHECK(one.bytes(name) == four.bytes(name));
    }
  }
}

TEST_CASE("seeded phases: one seed, one result; another seed moves the coherent power and nothing else") {
  DCEM_NEEDS_PROGRAM();
  Json scenario = street();
  scenario["propagation"]["diffuse"]["phases"] = "seeded";
  const Run first(scenario, "--seed 1"), again(scenario, "--seed 1"), other(scenario, "--seed 2");
  REQUIRE(other.outcome.exit_code == 0);
  CHECK(first.bytes("links.csv") == again.bytes("links.csv"));
  const Csv one(first.bytes("links.csv")), two(other.bytes("links.csv")), plain(street_run().bytes("links.csv"));
  for (std::size_t row = 0; row < one.rows.size(); ++row) {
    CHECK(one.rows[row].at("power_dbm") != two.rows[row].at("power_dbm"));
    for (const std::string& column : one.columns) {
      CAPTURE(column);
      if (column == "power_dbm" || column == "path_gain_db") continue;
      CHECK(one.rows[row].at(column) == two.rows[row].at(column));
      CHECK(one.rows[row].at(column) == plain.rows[row].at(column));
    }
  }
}

TEST_CASE("seeded phases of a dual-polarized link add in power, whether a path is there or not") {
  DCEM_NEEDS_PROGRAM();
  // Without reflections and diffractions the car and a wall of metal leave nothing but tiles to one receiver.
  Json scenario = street();
  scenario["propagation"]["diffuse"]["phases"] = "seeded";
  scenario["propagation"]["max_reflections"] = 0;
  scenario["propagation"]["max_diffractions"] = 0;
  scenario["objects"] = {{{"id", "block"}, {"box_m", {1, 6, 9}}, {"material", "metal"}}};
  scenario["receivers"] = {{{"id", "hidden"}, {"position_m", {15, 0.5, 1.5}}, {"antenna", {{"polarization", "VH"}}}},
                           {{"id", "free"}, {"position_m", {15, 10, 1.5}}, {"antenna", {{"polarization", "VH"}}}}};
  const Run run(scenario);
  REQUIRE(run.outcome.exit_code == 0);
  bool hidden = false, free = false;
  const Csv table(run.bytes("links.csv"));
  const std::vector<Link> links = links_of(run);
  for (std::size_t index = 0; index < links.size(); ++index) {
    CAPTURE(links[index].key());
    if (links[index].specular.size() > 1) continue;
    (links[index].specular.empty() ? hidden : free) = true;
    // One path or none: there is nothing else whose phase could count.
    const auto& row = table.rows[index];
    CHECK(number(row.at("power_dbm")) == doctest::Approx(number(row.at("power_incoherent_dbm"))).epsilon(1e-9));
  }
  CHECK(hidden);
  CHECK(free);
}

TEST_CASE("the summary says what was in force and what it took") {
  DCEM_NEEDS_PROGRAM();
  const Json summary = street_run().summary();
  const Json& propagation = summary["settings"]["propagation"];
  const Json diffuse = {{"enabled", true},        {"tile_max_m", nullptr}, {"tolerance_db", 1},
                        {"phases", "incoherent"}, {"list_paths", true},    {"tile_budget", 20000}};
  CHECK(propagation["diffuse"] == diffuse);
  const Json air = {{"gas", true},
                    {"temperature_k", 288.15},
                    {"dry_pressure_hpa", 1013.25},
                    {"water_vapour_g_per_m3", 7.5},
                    {"rain_mm_per_h", 20}};
  CHECK(propagation["atmosphere"] == air);
  CHECK(propagation["antenna_array"] == "plane_wave");
  const Json& materials = summary["scene"]["materials"];
  CHECK(materials["wall"]["scattering"] == 0.4);
  CHECK(materials["wall"]["scattering_pattern"] == "directive");
  CHECK(materials["wall"]["scattering_lobe"] == 4);
  CHECK(materials["foliage"]["foliage_db_per_m"] == 1.5);
  const Json& work = summary["totals"]["work"];
  std::size_t tiles = 0, listed = 0;
  for (const Json& frame : summary["frames"]) tiles += frame["work"]["diffuse_tiles"].get<std::size_t>();
  for (const Link& link : links_of(street_run())) listed += link.tiles.size();
  CHECK(work["diffuse_tiles"] == tiles);
  CHECK(7 * tiles >= listed);                                   // of seven points each
  CHECK(summary["totals"]["paths"].get<std::size_t>() < 1000);  // tiles are no paths
  CHECK(summary["totals"]["links"] == 12);
  CHECK(summary["warnings"].empty());
}

TEST_CASE("a budget that does not suffice is said, and the run goes on") {
  DCEM_NEEDS_PROGRAM();
  Json scenario = street();
  scenario["propagation"]["diffuse"]["tile_budget"] = 10;
  const Run run(scenario);
  CHECK(run.outcome.exit_code == 0);
  const Json summary = run.summary();
  CHECK(summary["settings"]["propagation"]["diffuse"]["tile_budget"] == 10);
  CHECK(summary["totals"]["work"]["diffuse_links_unfinished"] == 12);
  // The last halving looks at two tiles.
  CHECK(summary["totals"]["work"]["diffuse_tiles"].get<std::size_t>() <= 12 * 11);
  CHECK((run.outcome.output + run.outcome.error).find("12 links not within") != std::string::npos);
  CHECK(street_run().summary()["totals"]["work"]["diffuse_links_unfinished"].get<std::size_t>() < 12);
}

TEST_CASE("--output names what is written; settings of the file stay in force, defaults stand where there are none") {
  DCEM_NEEDS_PROGRAM();
  const Run named(street(), "--output cfr,doppler");
  REQUIRE(named.outcome.exit_code == 0);
  CHECK(named.names() == std::vector<std::string>{"cfr.npz", "doppler.csv", "summary.json"});
  CHECK(named.bytes("cfr.npz") == street_run().bytes("cfr.npz"));
  CHECK(named.bytes("doppler.csv") == street_run().bytes("doppler.csv"));
  Json plain = street();
  plain.erase("output");
  const Run defaults(plain, "--output cfr,doppler");
  REQUIRE(defaults.outcome.exit_code == 0);
  const auto arrays = arrays_of(defaults.folder / "out" / "cfr.npz");
  CHECK(arrays.at("h").shape == "(3, 2, 2, 256)");
  const auto frequencies_hz = arrays.at("frequency_hz").values<double>();
  CHECK(frequencies_hz.back() - frequencies_hz.front() == doctest::Approx(1e8 * 255.0 / 256.0).epsilon(1e-6));
  for (const auto& row : Csv(defaults.bytes("doppler.csv")).rows) {
    const double shift = number(row.at("doppler_hz")) / 10.0;
    CHECK(std::abs(shift - std::round(shift)) < 1e-9);
  }
}

TEST_CASE("behind a tree there is no line of sight; the direct path is listed, weakened by the metre") {
  DCEM_NEEDS_PROGRAM();
  Json bare = street();
  bare["objects"].erase(1);
  bare["objects"].erase(1);
  const Run bare_run(bare);
  REQUIRE(bare_run.outcome.exit_code == 0);
  const Csv with(street_run().bytes("links.csv")), without(bare_run.bytes("links.csv"));
  const auto green = links_of(street_run()), plain = links_of(bare_run);
  std::size_t behind = 0;
  for (std::size_t index = 0; index < green.size(); ++index) {
    CAPTURE(green[index].key());
    REQUIRE(green[index].specular.size() == plain[index].specular.size());
    bool hidden = false;
    for (std::size_t path = 0; path < green[index].specular.size(); ++path) {
      const Json &one = green[index].specular[path], &other = plain[index].specular[path];
      CHECK(one["id"] == other["id"]);
      CHECK(one["points_m"] == other["points_m"]);
      const double lost_db = other["path_gain_db"].get<double>() - one["path_gain_db"].get<double>();
      CHECK(lost_db > -1e-9);
      CHECK(lost_db < 60.0);  // 40 m of it: there is no such way
      hidden = hidden || (one["kinds"] == "" && lost_db > 0.01);
    }
    behind += hidden;
    CHECK(with.rows[index].at("line_of_sight") == (hidden ? "0" : without.rows[index].at("line_of_sight")));
  }
  CHECK(behind > 0);
}

TEST_CASE("where nothing comes through, fields are empty and null, and no number is none") {
  DCEM_NEEDS_PROGRAM();
  Json scenario = street();
  scenario["materials"]["foliage"]["foliage_db_per_m"] = 1000;
  scenario["objects"] = {{{"id", "wood"}, {"box_m", {300, 300, 50}}, {"foliage", true}}};
  for (const std::string mode : {"incoherent", "coherent", "band_limited"}) {
    CAPTURE(mode);
    scenario["output"]["pdp"] = {{"bin_s", 2e-9}, {"mode", mode}};
    const Run run(scenario);
    CAPTURE(run.outcome.error);
    REQUIRE(run.outcome.exit_code == 0);
    for (const std::string& name : run.names()) {
      if (name != "cfr.npz") check_numbers(run.bytes(name));
    }
    std::size_t silent = 0;
    for (const auto& row : Csv(run.bytes("links.csv")).rows) {
      if (!row.at("power_incoherent_dbm").empty()) continue;
      ++silent;
      for (const char* column : {"power_dbm", "power_los_dbm", "power_diffuse_dbm", "path_gain_db", "mean_delay_s",
                                 "rms_delay_spread_s", "k_factor_db", "mean_doppler_hz", "coherence_bandwidth_hz"}) {
        CHECK(row.at(column).empty());
      }
    }
    CHECK(silent > 0);
    for (const Link& link : links_of(run)) {
      for (const Json& path : link.specular) {
        CHECK(path["path_gain_db"].is_null() == (complex_of(path["amplitude"]) == Complex()));
      }
    }
    const auto arrays = arrays_of(run.folder / "out" / "cfr.npz");
    for (const Complex& value : arrays.at("h").values<Complex>()) CHECK(std::isfinite(std::abs(value)));
  }
}

TEST_CASE("a receiver that sees nothing has lines with empty fields, and none in profile and spectrum") {
  DCEM_NEEDS_PROGRAM();
  Json scenario = street();
  scenario["receivers"][1]["position_m"] = {16, 30, 1};  // behind the wall, in its shadow
  scenario["propagation"]["max_diffractions"] = 0;
  const Run run(scenario);
  REQUIRE(run.outcome.exit_code == 0);
  std::size_t dark = 0;
  for (const auto& row : Csv(run.bytes("links.csv")).rows) {
    if (row.at("rx") != "probe") continue;
    if (row.at("path_count") != "0") continue;
    ++dark;
    CHECK(row.at("line_of_sight") == "0");
    for (const char* column : {"power_dbm", "power_diffuse_dbm", "first_delay_s", "k_factor_db"})
      CHECK(row.at(column).empty());
  }
  CHECK(dark > 0);
  for (const char* name : {"pdp.csv", "doppler.csv"}) {
    for (const auto& row : Csv(run.bytes(name)).rows) CHECK(row.at("rx") == "ue");
  }
}

}  // namespace test_channel_files
