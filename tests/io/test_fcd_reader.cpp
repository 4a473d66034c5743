#include "dcem/io/src/traffic/fcd_reader.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "tests/io/temporary_folder.hpp"
#include "tests/io/trace_files.hpp"
#include "tests/support/shared_data.hpp"

namespace test_fcd_reader {

using namespace dcem;
using test::holds;
using test::step;
using test::trace;
using test::vehicle;

namespace {

const std::string anywhere = R"(x="1" y="2" angle="90" speed="3")";

std::vector<io::FcdStep> read_all(const std::filesystem::path& file, std::size_t chunk_bytes = io::xml_chunk_bytes) {
  std::vector<io::FcdStep> steps;
  io::FcdReader reader(file, chunk_bytes);
  for (io::FcdStep one; reader.next(one);) steps.push_back(one);
  return steps;
}

/// Everything that was read, as text: two readings are equal where their texts are.
std::string text_of(const std::vector<io::FcdStep>& steps) {
  std::string text;
  for (const io::FcdStep& one : steps) {
    text += std::to_string(one.line) + " " + std::to_string(one.time_s) + "\n";
    for (const io::FcdVehicle& v : one.vehicles) {
      text += std::to_string(v.line) + " " + v.id + " " + v.type;
      for (const double number : {v.x_m, v.y_m, v.z_m, v.angle_deg, v.speed_mps, v.slope_deg}) {
        text += " " + std::to_string(number);
      }
      text += "\n";
    }
  }
  return text;
}

std::string error_of(const std::string& text) {
  const test::TemporaryFolder folder;
  test::write_text(folder / "trace.xml", text);
  return test::input_error_of([&] { read_all(folder / "trace.xml"); });
}

/// One vehicle in one step, on line 3.
std::string error_of_vehicle(const std::string& attributes) {
  return error_of(trace(step("0", "<vehicle " + attributes + "/>\n")));
}

const std::string small_trace =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- made by hand: <timestep> here means nothing -->\n" +
    trace(step("1.50",
               vehicle("b", R"(x="-1.5" y="2e3" z="4" angle="359.99" speed="13.9" pos="7" lane="e_0" slope="-2")") +
                   vehicle("a&amp;\xC3\xBC", anywhere, "bus") + "<person id=\"b\" x=\"1\" y=\"1\"/>\n") +
          "<timestep time=\"2\"/>\n" + step("2.25", "<container id=\"c\"/>\n" + vehicle("b", anywhere)));

}  // namespace

TEST_CASE("steps come one by one, vehicles in the order of their ids, with what is missing at zero") {
  const test::TemporaryFolder folder;
  test::write_text(folder / "trace.xml", small_trace);
  const std::vector<io::FcdStep> steps = read_all(folder / "trace.xml");
  REQUIRE(steps.size() == 3);
  CHECK(steps[0].time_s == 1.5);
  CHECK(steps[0].line == 4);
  REQUIRE(steps[0].vehicles.size() == 2);
  const io::FcdVehicle& first = steps[0].vehicles[0];
  CHECK(first.id == "a&\xC3\xBC");
  CHECK(first.type == "bus");
  CHECK(first.z_m == 0.0);
  CHECK(first.slope_deg == 0.0);
  CHECK(first.line == 6);
  const io::FcdVehicle& second = steps[0].vehicles[1];
  CHECK(second.id == "b");
  CHECK(second.x_m == -1.5);
  CHECK(second.y_m == 2000.0);
  CHECK(second.z_m == 4.0);
  CHECK(second.angle_deg == 359.99);
  CHECK(second.speed_mps == 13.9);
  CHECK(second.slope_deg == -2.0);
  CHECK(second.line == 5);
  CHECK(steps[1].time_s == 2.0);
  CHECK(steps[1].vehicles.empty());
  CHECK(steps[2].time_s == 2.25);
  CHECK(steps[2].vehicles.size() == 1);
}

TEST_CASE("a chunk may end at any byte, and a compressed trace reads as the plain one") {
  const test::TemporaryFolder folder;
  test::write_text(folder / "trace.xml", small_trace);
  test::write_gz(folder / "trace.xml.gz", small_trace);
  const std::string whole = text_of(read_all(folder / "trace.xml"));
  CHECK(text_of(read_all(folder / "trace.xml.gz")) == whole);
  for (std::size_t chunk_bytes = 1; chunk_bytes <= small_trace.size() + 1; ++chunk_bytes) {
    CAPTURE(chunk_bytes);
    REQUIRE(text_of(read_all(folder / "trace.xml", chunk_bytes)) == whole);
    REQUIRE(text_of(read_all(folder / "trace.xml.gz", chunk_bytes)) == whole);
  }
}

TEST_CASE("a byte order mark and other encodings are read") {
  const test::TemporaryFolder folder;
  test::write_text(folder / "mark.xml", "\xEF\xBB\xBF" + trace(step("0", vehicle("a", anywhere))));
  CHECK(read_all(folder / "mark.xml").at(0).vehicles.at(0).id == "a");
  test::write_text(folder / "latin.xml",
                   "<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>" + trace(step("0", vehicle("\xFC", anywhere))));
  CHECK(read_all(folder / "latin.xml").at(0).vehicles.at(0).id == "\xC3\xBC");
}

TEST_CASE("a trace cut off at any byte is refused, compressed or not") {
  const test::TemporaryFolder folder;
  const std::string whole = trace(step("0", vehicle("a", anywhere)) + step("1", vehicle("a", anywhere)));
  test::write_gz(folder / "whole.gz", whole);
  const std::string packed = test::file_bytes(folder / "whole.gz");
  const std::size_t end = whole.find_last_of('>');
  for (std::size_t length = 0; length < end; ++length) {
    CAPTURE(length);
    test::write_text(folder / "cut.xml", whole.substr(0, length));
    const std::string error = test::input_error_of([&] { read_all(folder / "cut.xml"); });
    REQUIRE(holds(error, "cut.xml:"));
    REQUIRE(holds(error, "damaged XML"));
  }
  for (std::size_t length = 1; length < packed.size(); ++length) {
    CAPTURE(length);
    test::write_text(folder / "cut.gz", packed.substr(0, length));
    REQUIRE(holds(test::input_error_of([&] { read_all(folder / "cut.gz"); }), "cut.gz:"));
  }
  test::write_text(folder / "cut.gz", packed.substr(0, packed.size() - 9));
  CHECK(holds(test::input_error_of([&] { read_all(folder / "cut.gz"); }), "breaks off"));
}

TEST_CASE("damaged compressed data is refused") {
  const test::TemporaryFolder folder;
  test::write_gz(folder / "trace.gz", small_trace);
  std::string packed = test::file_bytes(folder / "trace.gz");
  packed[packed.size() - 6] = static_cast<char>(packed[packed.size() - 6] ^ 1);  // in the checksum
  test::write_text(folder / "trace.gz", packed);
  CHECK(holds(test::input_error_of([&] { read_all(folder / "trace.gz"); }), "damaged compressed data"));
}

TEST_CASE("what is no trace is refused with the line") {
  CHECK(holds(error_of(""), "trace.xml:1: damaged XML"));
  CHECK(holds(error_of("<routes>\n</routes>"), "trace.xml:1: the root element is 'routes'; expected fcd-export"));
  CHECK(holds(error_of("<fcd-export>\n</fcd-export>"), "trace.xml: holds no timestep"));
  CHECK(holds(error_of("<fcd-export>\n<timestep time=\"0\">\n</fcd-export>"),
              "trace.xml:3: damaged XML: mismatched tag"));
  CHECK(holds(error_of("<!DOCTYPE a [<!ENTITY b \"c\">]>\n<fcd-export/>"), "trace.xml:1: a document type declaration"));
  CHECK(holds(error_of(trace("<timestep/>")), "trace.xml:2: timestep: time: missing"));
  CHECK(holds(error_of(trace(step("noon", ""))), "trace.xml:2: timestep: time: found 'noon'"));
  CHECK(holds(error_of(trace(step("nan", ""))), "found 'nan'"));
  CHECK(holds(error_of(trace(step("1", "") + step("1", ""))), "trace.xml:4: timestep: time: not later"));
  CHECK(holds(error_of(trace(step("1", "") + step("0.5", ""))), "expected increasing times"));
  CHECK(holds(error_of(trace(vehicle("a", anywhere))), "trace.xml:2: a vehicle outside a timestep"));
  CHECK(holds(error_of(trace(step("0", "<person>\n" + vehicle("a", anywhere) + "</person>\n"))),
              "trace.xml:4: a vehicle outside a timestep"));
  CHECK(holds(error_of(trace(step("0", step("1", "")))), "trace.xml:3: a timestep in another element"));
  CHECK(holds(error_of(trace(step("0", vehicle("a", anywhere) + vehicle("b", anywhere) + vehicle("a", anywhere)))),
              "trace.xml:5: vehicle 'a' is there twice"));
  CHECK(holds(test::input_error_of([] { read_all("/no/such/trace.xml"); }), "is not there"));
  CHECK(holds(test::input_error_of([] { read_all("/"); }), "is a folder"));
}

TEST_CASE("what is wrong with a vehicle is refused with line, id and attribute") {
  CHECK(holds(error_of_vehicle(R"(type="car" )" + anywhere), "trace.xml:3: vehicle: id: missing"));
  CHECK(holds(error_of_vehicle(R"(id="" type="car" )" + anywhere), "vehicle: id: found ''"));
  CHECK(holds(error_of_vehicle(R"(id="a/b" type="car" )" + anywhere), "vehicle: id: found 'a/b'"));
  CHECK(holds(error_of_vehicle(R"(id="a&#10;b" type="car" )" + anywhere), "vehicle: id: found 'a?b'"));
  CHECK(holds(error_of_vehicle(R"(id="a" )" + anywhere), "vehicle 'a': type: missing"));
  CHECK(holds(error_of_vehicle(R"(id="a" type="" )" + anywhere), "vehicle 'a': type: found ''"));
  CHECK(holds(error_of_vehicle(R"(id="a" type="car" y="2" angle="90" speed="3")"), "vehicle 'a': x: missing"));
  CHECK(holds(error_of_vehicle(R"(id="a" type="car" x="1" angle="90" speed="3")"), "vehicle 'a': y: missing"));
  CHECK(holds(error_of_vehicle(R"(id="a" type="car" x="1" y="2" speed="3")"), "vehicle 'a': angle: missing"));
  CHECK(holds(error_of_vehicle(R"(id="a" type="car" x="1" y="2" angle="90")"), "vehicle 'a': speed: missing"));
  CHECK(holds(error_of_vehicle(R"(id="a" type="car" x="inf" y="2" angle="90" speed="3")"), "x: found 'inf'"));
  CHECK(holds(error_of_vehicle(R"(id="a" type="car" x="1" y="2e9" angle="90" speed="3")"), "y: found '2e9'"));
  CHECK(holds(error_of_vehicle(R"(id="a" type="car" x="1" y="2" angle="1e7" speed="3")"), "angle: found '1e7'"));
  CHECK(holds(error_of_vehicle(R"(id="a" type="car" x="1" y="2" angle="0" speed="3e8")"), "speed: found '3e8'"));
  CHECK(holds(error_of_vehicle(R"(id="a" type="car" slope="up" )" + anywhere), "slope: found 'up'"));
  CHECK(holds(error_of_vehicle(R"(id="a" type="car" z="1e999" )" + anywhere), "z: found '1e999'"));
  CHECK(holds(error_of_vehicle(R"(id="a" id="b" type="car" )" + anywhere), "duplicate attribute"));
}

TEST_CASE("neither endless tags nor endless nesting fill the memory") {
  CHECK(holds(error_of("<fcd-export a=\"" + std::string(9'000'000, 'x')), "more than 4 MB"));
  std::string deep = "<fcd-export>";
  for (int level = 0; level < 1000; ++level) deep += "<a>";
  CHECK(holds(error_of(deep), "nested too deeply"));
}

TEST_CASE("the reference trace: every row of every step") {
  DCEM_NEEDS_SHARED();
  io::FcdReader reader(test::shared_path("badhersfeld/fcd_600-660s_0.1s.xml.gz"));
  std::set<std::string> ids;
  std::size_t steps = 0, rows = 0, least = 1000, most = 0;
  double first_s = 0.0, last_s = 0.0;
  for (io::FcdStep one; reader.next(one);) {
    if (steps++ == 0) first_s = one.time_s;
    last_s = one.time_s;
    rows += one.vehicles.size();
    least = std::min(least, one.vehicles.size());
    most = std::max(most, one.vehicles.size());
    for (const io::FcdVehicle& v : one.vehicles) ids.insert(v.id);
  }
  CHECK(steps == 600);
  CHECK(rows == 114'086);
  CHECK(ids.size() == 243);
  // The description says 187 to 195; a count of the file's elements with another XML reader gives these.
  CHECK(least == 184);
  CHECK(most == 196);
  CHECK(first_s == 600.0);
  CHECK(last_s == 659.9);
}

TEST_CASE("a trace in longitude and latitude has the vehicles where the same trace in metres has them") {
  DCEM_NEEDS_SHARED();
  if (!io::knows_utm()) return;
  const io::UtmFrame frame{32, true, {543074.33, 5627577.65}};
  io::FcdReader metres(test::shared_path("badhersfeld/fcd_600-660s_0.1s.xml.gz"));
  io::FcdReader degrees(test::shared_path("badhersfeld/fcd_600-660s_1s_lonlat.xml.gz"), io::xml_chunk_bytes, frame);
  std::size_t compared = 0;
  double farthest_m = 0.0;
  io::FcdStep expected;
  for (io::FcdStep step; degrees.next(step);) {
    while (expected.time_s < step.time_s) REQUIRE(metres.next(expected));
    REQUIRE(expected.vehicles.size() == step.vehicles.size());
    for (std::size_t index = 0; index < step.vehicles.size(); ++index) {
      const io::FcdVehicle &one = step.vehicles[index], &other = expected.vehicles[index];
      CHECK(one.id == other.id);
      CHECK(one.angle_deg == other.angle_deg);
      farthest_m = std::max(farthest_m, std::hypot(one.x_m - other.x_m, one.y_m - other.y_m));
      ++compared;
    }
  }
  CHECK(compared > 10'000);
  CHECK(farthest_m < 0.075);  // half a millionth of a degree and half a centimetre in each direction
}

}  // namespace test_fcd_reader
