#include "dcem/io/src/traffic/vehicle_types.hpp"

#include <doctest/doctest.h>

#include <string>

#include "tests/io/temporary_folder.hpp"
#include "tests/io/trace_files.hpp"
#include "tests/support/shared_data.hpp"

namespace test_vehicle_types {

using namespace dcem;
using test::holds;

namespace {

io::VehicleTypes types_of(const std::string& text) {
  const test::TemporaryFolder folder;
  test::write_text(folder / "types.xml", text);
  io::VehicleTypes types;
  types.read(folder / "types.xml");
  return types;
}

std::string error_of(const std::string& text) {
  return test::input_error_of([&] { types_of(text); });
}

Vec3 size_m(const io::VehicleTypes& types, const std::string& id) {
  const Vec3* found = types.find_size_m(id);
  REQUIRE(found != nullptr);
  return *found;
}

}  // namespace

TEST_CASE("a type has the size that its file gives, wherever it stands in the file") {
  const io::VehicleTypes types = types_of(
      "<routes>\n<vType id=\"a\" length=\"4.2\" width=\"1.7\" height=\"1.4\"><param key=\"k\" value=\"v\"/></vType>\n"
      "<vTypeDistribution id=\"mix\"><vType id=\"b\" vClass=\"bus\" length=\"18\"/></vTypeDistribution>\n"
      "<vehicle id=\"v\" type=\"a\" depart=\"0\"/></routes>");
  CHECK(size_m(types, "a") == Vec3(4.2, 1.7, 1.4));
  CHECK(size_m(types, "b") == Vec3(18.0, 2.5, 3.4));
  CHECK(types.find_size_m("mix") == nullptr);
  CHECK(types.find_size_m("v") == nullptr);
}

// Rows of the table in SUMO's documentation, "Vehicle Type Parameter Defaults".
TEST_CASE("what a type leaves out is SUMO's default for its class") {
  const auto of_class = [](const std::string& name) {
    return size_m(types_of("<a><vType id=\"t\" vClass=\"" + name + "\"/></a>"), "t");
  };
  CHECK(of_class("passenger") == Vec3(5.0, 1.8, 1.5));
  CHECK(of_class("motorcycle") == Vec3(2.2, 0.9, 1.5));
  CHECK(of_class("bicycle") == Vec3(1.6, 0.65, 1.7));
  CHECK(of_class("pedestrian") == Vec3(0.215, 0.478, 1.719));
  CHECK(of_class("delivery") == Vec3(6.5, 2.16, 2.86));
  CHECK(of_class("truck") == Vec3(7.1, 2.4, 2.4));
  CHECK(of_class("trailer") == Vec3(16.5, 2.55, 4.0));
  CHECK(of_class("bus") == Vec3(12.0, 2.5, 3.4));
  CHECK(of_class("coach") == Vec3(14.0, 2.6, 4.0));
  CHECK(of_class("tram") == Vec3(22.0, 2.4, 3.2));
  CHECK(of_class("rail_urban") == Vec3(109.5, 3.0, 3.6));
  CHECK(of_class("custom1") == Vec3(5.0, 1.8, 1.5));
  CHECK(size_m(types_of("<a><vType id=\"t\"/></a>"), "t") == Vec3(5.0, 1.8, 1.5));
}

TEST_CASE("SUMO's own types need no file, and a file may define them anew") {
  CHECK(size_m(io::VehicleTypes(), "DEFAULT_VEHTYPE") == Vec3(5.0, 1.8, 1.5));
  CHECK(size_m(io::VehicleTypes(), "DEFAULT_BIKETYPE") == Vec3(1.6, 0.65, 1.7));
  CHECK(size_m(types_of("<a><vType id=\"DEFAULT_VEHTYPE\" length=\"3\"/></a>"), "DEFAULT_VEHTYPE").x == 3.0);
}

TEST_CASE("types of several files stand together, each once") {
  const test::TemporaryFolder folder;
  test::write_text(folder / "one.xml", "<a>\n<vType id=\"t\"/></a>");
  test::write_gz(folder / "two.xml.gz", "<a><vType id=\"u\"/></a>");
  io::VehicleTypes types;
  types.read(folder / "one.xml");
  types.read(folder / "two.xml.gz");
  CHECK(types.find_size_m("t") != nullptr);
  CHECK(types.find_size_m("u") != nullptr);
  const std::string error = test::input_error_of([&] { types.read(folder / "one.xml"); });
  CHECK(holds(error, "one.xml:2: vType 't': there already in"));
}

TEST_CASE("what is wrong with a type is refused with line, id and attribute") {
  CHECK(holds(error_of("<a>\n<vType length=\"1\"/></a>"), "types.xml:2: vType: id: missing"));
  CHECK(holds(error_of("<a><vType id=\"\"/></a>"), "vType: id: found ''"));
  CHECK(holds(error_of("<a><vType id=\"t\"/>\n<vType id=\"t\"/></a>"), "types.xml:2: vType 't': there already"));
  CHECK(holds(error_of("<a><vType id=\"t\" length=\"0\"/></a>"),
              "vType 't': length: found '0'; expected a number above 0"));
  CHECK(holds(error_of("<a><vType id=\"t\" width=\"-2\"/></a>"), "vType 't': width: found '-2'"));
  CHECK(holds(error_of("<a><vType id=\"t\" height=\"1.5m\"/></a>"), "vType 't': height: found '1.5m'"));
  CHECK(holds(error_of("<a><vType id=\"t\" height=\"nan\"/></a>"), "height: found 'nan'"));
  CHECK(holds(error_of("<a><vType id=\"t\" vClass=\"buss\"/></a>"),
              "unknown class 'buss' (did you mean 'bus'?); expected one of "));
  CHECK(holds(error_of("<a><vType id=\"t\"/>"), "damaged XML"));
  CHECK(holds(error_of("<a/>"), "holds no vType"));
  CHECK(holds(error_of("<!DOCTYPE a><a/>"), "document type declaration"));
}

TEST_CASE("the types of the reference trace") {
  DCEM_NEEDS_SHARED();
  io::VehicleTypes types;
  types.read(test::shared_path("badhersfeld/vtypes.add.xml"));
  CHECK(size_m(types, "car") == Vec3(5.0, 2.0, 1.6));
  CHECK(size_m(types, "van") == Vec3(6.5, 2.1, 2.6));
  CHECK(size_m(types, "truck") == Vec3(13.0, 2.6, 3.0));
  CHECK(size_m(types, "bus") == Vec3(12.0, 2.5, 3.4));
  CHECK(size_m(types, "motorcycle") == Vec3(2.2, 0.9, 1.5));
}

}  // namespace test_vehicle_types
