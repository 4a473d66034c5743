/// What a scenario is told of its keys: the reference, comments, unknown keys, files that are no scenario. The keys one
/// by one: scenario_keys.py.
#include "dcem/io/scenario_keys.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>
#include <string>

#include "dcem/io/input_error.hpp"
#include "dcem/io/scenario.hpp"
#include "tests/io/temporary_folder.hpp"

namespace test_scenario_keys {

using namespace dcem;

namespace {

const std::string ground_obj = "mtllib ground.mtl\nusemtl ground\nv -9 -9 0\nv 9 -9 0\nv 9 9 0\nf 1 2 3\n";

/// What loading a file says, without the folder.
std::string said_of(const std::string& name, const std::string& text) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "ground.mtl") << "newmtl ground\nem_model pec\n";
  std::ofstream(folder / "ground.obj") << ground_obj;
  std::ofstream(folder / name) << text;
  try {
    io::load_scenario(folder / name);
  } catch (const io::InputError& error) {
    const std::string message = error.what();
    return message.substr(message.rfind(folder.path().string(), 0) == 0 ? folder.path().string().size() + 1 : 0);
  }
  return "no error";
}

/// A scenario whose last line, the tenth, is `more`.
std::string scenario_with(const std::string& more) {
  return R"(// What stands in line 1 is a comment,
/* and this one
   takes three
   lines: "up" */ {
  "format": "dcem-scenario/1", /* in a line */ "scene": {"obj": "ground.obj"}, // behind it
  "frequency_hz": /* in front of a value */ 28e9,

  "transmitters": [{"id": "tx", "position_m": [0, 0, 5], "power_dbm": 30}],
  "receivers": [{"id": "rx", "position_m": [1, 0, 5]}],
)" + more +
         "}";
}

}  // namespace

TEST_CASE("comments are read, and lines are still right behind them") {
  CHECK(said_of("a.json", scenario_with(R"("tree": {})")) == "no error");
  CHECK(said_of("a.json", scenario_with(R"("time": /* a few */ {"frames": 0})")) ==
        "a.json:10: time.frames: found '0'; expected a whole number from 1 to 1000000000");
  CHECK(said_of("a.json", scenario_with("/* not\nclosed ")).starts_with("a.json:11: "));
  std::string twice = scenario_with("\"tree\": {}, // once\n\"tree\": {}");
  CHECK(said_of("a.json", twice) == "a.json:11: key 'tree' stands twice; expected it once");
}

TEST_CASE("the address of the schema may stand anywhere at the top") {
  CHECK(said_of("a.json", scenario_with(R"("$schema": "dcem-scenario-1.schema.json")")) == "no error");
  CHECK(said_of("a.json", scenario_with(R"("$schema": 1)")) ==
        "a.json:10: $schema: found '1'; expected text that is not empty");
  CHECK(said_of("a.json", scenario_with(R"("time": {"$schema": "x"})")) ==
        "a.json:10: time.$schema: unknown key; expected one of start_s, step_s, frames");
}

TEST_CASE("an unknown key is answered with all that may stand there, the nearest first") {
  CHECK(said_of("a.json", scenario_with(R"("propagation": {"ray": 5})")) ==
        "a.json:10: propagation.ray: unknown key (did you mean 'rays'?); expected one of line_of_sight, "
        "max_reflections, max_transmissions, max_diffractions, max_interactions, discovery, rays, rays_steady, seed, "
        "cache, diffraction, diffuse, path_loss, atmosphere, antenna_array, min_path_gain_db, max_path_length_m, "
        "valid_until_limit_m");
  CHECK(said_of("a.json", scenario_with(R"("itu": {"colour": "blue"})")) ==
        "a.json:10: itu.colour: unknown key; expected one of revision, allow_extrapolation");
  CHECK(said_of("a.json", scenario_with(R"("output": {"doppler": {"bin_s": 1}})")) ==
        "a.json:10: output.doppler.bin_s: unknown key (did you mean 'bin_hz'?); expected bin_hz");
}

TEST_CASE("a word that is none is answered with those that are, a block with its keys") {
  CHECK(said_of("a.json", scenario_with(R"("propagation": {"cache": "exakt"})")) ==
        "a.json:10: propagation.cache: found '\"exakt\"'; expected off, seed or exact");
  CHECK(said_of("a.json", scenario_with(R"("links": {"rang_m": 150})")) ==
        "a.json:10: links.rang_m: unknown key (did you mean 'range_m'?); expected one of range_m, pairs");
}

TEST_CASE("a file of another kind is told what it is, and where a scenario names it") {
  CHECK(said_of("town.obj", ground_obj) ==
        "town.obj: this is an OBJ, a scene; expected a scenario (JSON) that names it under scene.obj");
  CHECK(said_of("TOWN.MTL", "newmtl wall\n") ==
        "TOWN.MTL: this is an MTL, the materials of an OBJ; expected a scenario (JSON) that names it in the OBJ under "
        "scene.obj");
  CHECK(said_of("a.xml", "<?xml version=\"1.0\"?>\n<!-- made -->\n<fcd-export>\n") ==
        "a.xml: this is SUMO's FCD output, a trace; expected a scenario (JSON) that names it under mobility.sumo_fcd");
  CHECK(said_of("a.net.xml", "<net version=\"1\">") ==
        "a.net.xml: this is a road network of SUMO; expected a scenario (JSON)");
  CHECK(said_of("a.csv", "x_m,y_m,z_m\n") ==
        "a.csv: this is a table (CSV); expected a scenario (JSON) that names it under poses_csv, points_csv or "
        "antenna.pattern.csv");
  CHECK(said_of("a.csv", scenario_with(R"("tree": {})")) == "no error");  // the name alone is no reason
  CHECK(said_of("a.txt", "v 0 0 0\n").find("expected well-formed JSON") != std::string::npos);
}

TEST_CASE("JSON that is no scenario is told so, whatever its first key") {
  const std::string expected =
      "the key 'format' is missing, this is no scenario; expected \"format\": "
      "\"dcem-scenario/1\" in it";
  CHECK(said_of("package.json", R"({"name": "x", "version": 1})") == "package.json:1: " + expected);
  CHECK(said_of("list.json", "[1, 2]") == "list.json: found an array; expected an object {...}");
}

TEST_CASE("the keys that have to do with a word") {
  const std::string found = io::scenario_keys("Rays_Steady");
  CHECK(found ==
        "propagation: Which paths are looked for, how, and what acts on them.\n"
        "  propagation.rays_steady\n"
        "      The same in a later frame with cache seed.\n"
        "      a whole number from 1 to 100000000; without it: a tenth of rays; e.g. 200\n");
  CHECK(io::scenario_keys("shadow").find("propagation.diffraction.region") != std::string::npos);  // a word of it
  CHECK(io::scenario_keys("em_reflection").find("materials.*.reflection  (MTL: em_reflection)") != std::string::npos);
  CHECK(io::scenario_keys("Google Earth").find("output.kml") != std::string::npos);
  CHECK(io::scenario_keys("no such word").empty());
  const std::string all = io::scenario_keys();
  CHECK(all.find(found.substr(found.find("  prop"))) != std::string::npos);
}

TEST_CASE("the texts are plain") {
  for (const std::string& text : {io::scenario_keys(), io::scenario_reference(), io::scenario_schema()}) {
    CHECK(text.size() > 10'000);
    CHECK(text.ends_with("\n"));
    CHECK(std::all_of(text.begin(), text.end(),
                      [](char letter) { return letter == '\n' || (letter >= 32 && letter < 127); }));
  }
}

}  // namespace test_scenario_keys
