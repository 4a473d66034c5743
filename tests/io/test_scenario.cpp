#include "dcem/io/scenario.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <fstream>
#include <string>

#include "dcem/io/geo_anchor.hpp"
#include "dcem/io/input_error.hpp"
#include "tests/io/drawing_needed.hpp"
#include "tests/io/temporary_folder.hpp"

namespace test_scenario {

using namespace dcem;

namespace {

/// A scenario in a temporary folder: a ground of one square and whatever the text adds.
struct ScenarioCase {
  test::TemporaryFolder folder;
  std::string materials = R"("ground": {"model": "pec"})";
  std::string objects = "";
  std::string transmitters = R"({"id": "tx", "position_m": [0, 0, 10], "power_dbm": 30})";
  std::string receivers = R"({"id": "rx", "position_m": [5, 0, 1]})";
  std::string more = "";  ///< further blocks, each with a comma before it
  std::string scene = R"({"obj": "ground.obj"})";
  std::string ground_mtl = "newmtl ground\n";

  io::Scenario load(const io::ScenarioOverrides& overrides = {}) const {
    std::ofstream(folder / "ground.mtl") << ground_mtl;
    std::ofstream(folder / "ground.obj")
        << "mtllib ground.mtl\nv -9 -9 0\nv 9 -9 0\nv 9 9 0\nv -9 9 0\nusemtl ground\nf 1 2 3 4\n";
    std::ofstream(folder / "case.json") << R"({"format": "dcem-scenario/1", "frequency_hz": 30e9, "scene": )" << scene
                                        << R"(, "materials": {)" << materials << R"(}, "objects": [)" << objects
                                        << R"(], "transmitters": [)" << transmitters << R"(], "receivers": [)"
                                        << receivers << "]" << more << "}";
    return io::load_scenario(folder / "case.json", overrides);
  }
  std::string error(const io::ScenarioOverrides& overrides = {}) const {
    try {
      load(overrides);
    } catch (const io::InputError& caught) {
      return caught.what();
    }
    return "no error";
  }
};

bool contains(const std::string& text, const std::string& piece) {
  return text.find(piece) != std::string::npos;
}

/// Overrides of which one is set.
template <typename Member, typename Value>
io::ScenarioOverrides only(Member member, const Value& value) {
  io::ScenarioOverrides overrides;
  overrides.*member = value;
  return overrides;
}

template <typename Model>
Model model_of(const io::Scenario& scenario, const std::string& name) {
  return std::get<Model>(scenario.scene.material(*scenario.scene.find_material(name)).model);
}

}  // namespace

TEST_CASE("what a scenario leaves out has the documented defaults") {
  const io::Scenario scenario = ScenarioCase().load();
  CHECK(scenario.name == "case");
  CHECK(scenario.settings.frequency_hz == 30e9);
  CHECK(scenario.settings.itu.revision == 3);
  CHECK_FALSE(scenario.settings.itu.allow_extrapolation);
  const PropagationSettings& propagation = scenario.settings.propagation;
  CHECK(propagation.line_of_sight);
  CHECK(propagation.max_reflections == 2);
  CHECK(propagation.max_transmissions == 2);
  CHECK_FALSE(propagation.max_interactions.has_value());
  CHECK(propagation.discovery == Discovery::automatic);
  CHECK(propagation.rays == 20'000);
  CHECK(propagation.seed == 1);
  CHECK_FALSE(propagation.min_path_gain_db.has_value());
  CHECK_FALSE(propagation.max_path_length_m.has_value());
  CHECK_FALSE(propagation.valid_until_limit_m.has_value());
  CHECK(propagation.path_loss == AnyPathLoss{});
  CHECK(scenario.time.start_s == 0.0);
  CHECK(scenario.time.frames == 1);
  CHECK(scenario.output.links);
  CHECK_FALSE(scenario.output.paths);
  CHECK_FALSE(scenario.output.pdp);
  CHECK(scenario.scene.settings().weld_tolerance_m == 1e-4);
  CHECK(scenario.scene.settings().planarity_tolerance_m == 1e-3);
  CHECK(scenario.scene.facets().size() == 1);
  CHECK(scenario.grids.empty());
  CHECK(scenario.warnings.empty());
}

TEST_CASE("every setting arrives") {
  ScenarioCase files;
  files.scene =
      R"({"obj": "ground.obj", "up": "z", "unit_m": 2, "weld_tolerance_m": 1e-3, "planarity_tolerance_m": 0.01})";
  files.more = R"(, "itu": {"revision": 4, "allow_extrapolation": true},
    "time": {"start_s": 5, "step_s": 0.5, "frames": 7},
    "propagation": {"line_of_sight": false, "max_reflections": 10, "max_transmissions": 0, "max_diffractions": 0,
      "max_interactions": 3, "discovery": "sampled", "rays": 5e3, "seed": 12, "cache": "off", "diffuse": {"enabled": false},
      "path_loss": {"model": "close_in", "exponent": 2.1, "attenuation_db_per_m": 0.01}, "atmosphere": null,
      "antenna_array": null, "min_path_gain_db": -150.5, "max_path_length_m": 750,
      "valid_until_limit_m": 0.25},
    "output": {"paths": true, "links": false, "pdp": {"bin_s": 2e-9, "mode": "coherent"}, "npz": false}, "links": "all")";
  const io::Scenario scenario = files.load();
  const PropagationSettings& propagation = scenario.settings.propagation;
  CHECK(scenario.settings.itu.revision == 4);
  CHECK(scenario.settings.itu.allow_extrapolation);
  CHECK(scenario.time_s(2) == 6.0);
  CHECK(scenario.time.frames == 7);
  CHECK_FALSE(propagation.line_of_sight);
  CHECK(propagation.max_reflections == 10);
  CHECK(propagation.max_transmissions == 0);
  CHECK(propagation.max_interactions == 3);
  CHECK(propagation.discovery == Discovery::sampled);
  CHECK(propagation.rays == 5000);
  CHECK(propagation.seed == 12);
  CHECK(propagation.path_loss == AnyPathLoss{CloseIn{2.1, 0.01}});
  CHECK(propagation.min_path_gain_db == -150.5);
  CHECK(propagation.max_path_length_m == 750.0);
  CHECK(propagation.valid_until_limit_m == 0.25);
  CHECK(scenario.output.paths);
  CHECK_FALSE(scenario.output.links);
  CHECK(scenario.output.pdp);
  CHECK(scenario.output.pdp_bin_s == 2e-9);
  CHECK(scenario.output.pdp_mode == PdpMode::coherent);
  CHECK(scenario.scene.settings().weld_tolerance_m == 1e-3);
  CHECK(scenario.scene.settings().planarity_tolerance_m == 0.01);
  CHECK(scenario.scene.vertices_m()[0] == Vec3(-18, -18, 0));
}

TEST_CASE("pictures are asked for by true, or with their settings") {
  DCEM_NEEDS_DRAWING();
  ScenarioCase files;
  files.more = R"(, "output": {"npz": true, "plots": {"max_links": 3, "pdp_frame": 40}})";
  io::OutputSettings output = files.load().output;
  CHECK(output.npz);
  CHECK(output.plots);
  CHECK(output.plots_max_links == 3);
  CHECK(output.plots_pdp_frame == 40);
  files.more = R"(, "output": {"plots": true})";
  output = files.load().output;
  CHECK(output.plots);
  CHECK_FALSE(output.npz);
  CHECK(output.plots_max_links == 20);
  CHECK_FALSE(output.plots_pdp_frame.has_value());
  files.more = R"(, "output": {"plots": false})";
  CHECK_FALSE(files.load().output.plots);
}

TEST_CASE("a device has one of five forms") {
  ScenarioCase files;
  files.objects =
      R"({"id": "car", "box_m": [4, 2, 1.5], "material": "itu_metal", "motion": {"position_m": [1, 2, 0]}})";
  files.transmitters = R"({"id": "a", "position_m": [0, 0, 9], "velocity_mps": [1, 0, 0], "power_w": 5},
    {"id": "car", "attach_to": "car", "offset_m": [0, 0, 1.6], "sees_own_body": true, "power_dbm": -10})";
  files.receivers = R"({"id": "car", "attach_to": "car", "offset_m": [0, 0, 1.6]},
    {"id": "probe", "positions_m": [[1, 2, 3], [4, 5, 6]], "antenna": {"gain_dbi": 3, "polarization": "H"}},
    {"id": "walker", "motion": {"waypoints": [{"t_s": 0, "position_m": [0, 0, 1]}, {"t_s": 2, "position_m": [4, 0, 1]}]}},
    {"id": "area", "grid": {"origin_m": [-1, -2, 1.5], "spacing_m": [0.5, 0.25], "count": [3, 4]}, "antenna": {"polarization": "VH"}})";
  files.more = R"(, "time": {"start_s": 1})";
  const io::Scenario scenario = files.load();
  const Scene& scene = scenario.scene;
  const auto position_at = [&](const Device& device, double time_s) {
    return scene.device_state(device, scene.frame_at(time_s)).position_m;
  };
  REQUIRE(scene.transmitters().size() == 2);
  CHECK(scene.transmitters()[0].power_dbm == doctest::Approx(36.98970004336019).epsilon(1e-14));  // 10·log10(5000)
  CHECK(scene.transmitters()[1].attachment->sees_own_body);
  // The position holds at the scenario's start, here 1 s.
  CHECK(position_at(scene.transmitters()[0], 3.0) == Vec3(2, 0, 9));
  REQUIRE(scene.receivers().size() == 4);
  CHECK(position_at(scene.receivers()[0], 0.0) == Vec3(1, 2, 1.6));
  CHECK(scene.receivers()[1].id == "probe[0]");
  CHECK(scene.receivers()[2].id == "probe[1]");
  CHECK(position_at(scene.receivers()[2], 0.0) == Vec3(4, 5, 6));
  CHECK(scene.receivers()[2].antenna.gain_dbi == 3.0);
  CHECK(scene.receivers()[2].antenna.polarization.kind == PolarizationKind::horizontal);
  CHECK(position_at(scene.receivers()[3], 1.0) == Vec3(2, 0, 1));
  REQUIRE(scenario.grids.size() == 1);
  CHECK(scenario.grids[0].columns() == 3);
  CHECK(scenario.grids[0].rows() == 4);
  CHECK(grid_point_m(scenario.grids[0], 3, 2) == Vec3(0, -1.25, 1.5));
  CHECK(scenario.grids[0].antenna.is_dual());
}

TEST_CASE("points of a list are receivers in their place, and a map can take them out") {
  ScenarioCase files;
  files.receivers = R"({"id": "a", "position_m": [5, 0, 1]}, {"id": "list", "positions_m": [[1, 2, 3], [4, 5, 6]]},)"
                    R"({"id": "b", "position_m": [6, 0, 1]}, {"id": "c", "positions_m": [[7, 8, 9]]},)"
                    R"({"id": "area", "grid": {"origin_m": [0, 0, 1], "spacing_m": [1, 1], "count": [2, 2],)"
                    R"( "samples": [4, 3]}})";
  io::Scenario scenario = files.load();
  CHECK(scenario.grids.at(0).samples == std::array<std::size_t, 2>{4, 3});
  const auto ids = [](std::span<const Device> devices) {
    std::string text;
    for (const Device& device : devices) text += device.id + " ";
    return text;
  };
  CHECK(ids(scenario.scene.receivers()) == "a list[0] list[1] b c[0] ");
  const std::vector<ReceiverList> lists = io::take_point_lists(scenario);
  CHECK(ids(scenario.scene.receivers()) == "a b ");
  REQUIRE(lists.size() == 2);
  CHECK(lists[0].id == "list");
  CHECK(ids(lists[0].receivers) == "list[0] list[1] ");
  CHECK(ids(lists[1].receivers) == "c[0] ");
  CHECK(io::take_point_lists(scenario).empty());
}

TEST_CASE("every polarization has a name") {
  const auto read = [](const std::string& text) {
    ScenarioCase files;
    files.receivers =
        R"({"id": "rx", "position_m": [5, 0, 1], "antenna": {"pattern": "isotropic", "polarization": )" + text +
        R"(, "orientation_deg": [0, 0, 0], "array": {"rows": 1, "columns": 1, "spacing_wavelengths": 0.5}}})";
    return files.load().scene.receivers()[0].antenna.polarization;
  };
  CHECK(read("\"V\"").kind == PolarizationKind::vertical);
  CHECK(read("\"H\"").kind == PolarizationKind::horizontal);
  CHECK(read("\"RHC\"").kind == PolarizationKind::right_circular);
  CHECK(read("\"LHC\"").kind == PolarizationKind::left_circular);
  CHECK(read("\"VH\"").kind == PolarizationKind::dual);
  CHECK(read("{\"slant_deg\": 45}").kind == PolarizationKind::slant);
  CHECK(read("{\"slant_deg\": 45}").slant_angle_rad == doctest::Approx(pi / 4).epsilon(1e-15));
}

TEST_CASE("objects stand, drive or follow waypoints") {
  ScenarioCase files;
  files.objects = R"({"id": "mesh", "obj": "ground.obj", "up": "y", "unit_m": 0.1},
    {"id": "bus", "box_m": [12, 2.5, 3], "material": "ground", "motion": {"position_m": [5, 3, 0], "yaw_deg": 90, "velocity_mps": [0, -8, 0]}},
    {"id": "car", "box_m": [4, 2, 1], "material": "ground", "motion": {"waypoints": [
      {"t_s": 0, "position_m": [0, 0, 0], "yaw_deg": 350, "pitch_deg": 2, "roll_deg": -2},
      {"t_s": 10, "position_m": [100, 0, 0], "yaw_deg": 10}]}})";
  const Scene scene = files.load().scene;
  REQUIRE(scene.bodies().size() == 4);
  const Frame frame = scene.frame_at(5.0);
  CHECK(frame.bodies[1].placement.pose == Pose{});
  CHECK(frame.bodies[2].placement.pose.position_m == Vec3(5, -37, 0));
  CHECK(frame.bodies[2].placement.pose.yaw_rad == doctest::Approx(pi / 2).epsilon(1e-15));
  CHECK(frame.bodies[3].placement.pose.position_m == Vec3(50, 0, 0));
  // 350° to 10° is 20° through north, so half way is 360°. The sine of it is 0 up to the rounding of 2π.
  CHECK(std::abs(std::sin(frame.bodies[3].placement.pose.yaw_rad)) < 1e-14);
  CHECK(frame.bodies[3].placement.pose.pitch_rad == doctest::Approx(pi / 180).epsilon(1e-14).scale(0.0));
  const auto [first, last] = scene.triangle_range(BodyId(1));
  CHECK(last - first == 2);
  CHECK(std::abs(scene.corners_m(first)[0].z) == doctest::Approx(0.9).epsilon(1e-15));  // y up, a tenth
}

TEST_CASE("the scenario's materials override or complete those of the MTL file") {
  ScenarioCase files;
  files.ground_mtl = "newmtl ground\nem_model constant\nem_reflection 0.7\n";
  SUBCASE("nothing said") {
    files.materials = "";
    CHECK(model_of<ConstantReflection>(files.load(), "ground") == ConstantReflection{0.7, std::nullopt});
  }
  SUBCASE("completed") {
    files.materials = R"("ground": {"penetration_loss_db": 20})";
    CHECK(model_of<ConstantReflection>(files.load(), "ground") == ConstantReflection{0.7, 20.0});
  }
  SUBCASE("one value overridden") {
    files.materials = R"("ground": {"reflection": 0.5})";
    CHECK(model_of<ConstantReflection>(files.load(), "ground") == ConstantReflection{0.5, std::nullopt});
  }
  SUBCASE("another model") {
    files.materials = R"("ground": {"model": "dielectric", "relative_permittivity": 4})";
    CHECK(model_of<Dielectric>(files.load(), "ground") == Dielectric{4.0, 0.0, std::nullopt});
  }
}

TEST_CASE("a wall of layers, told by the keys of dielectric and ITU materials") {
  ScenarioCase files;
  files.materials = R"("ground": {"model": "multilayer", "layers": [
    {"itu": "ceiling-board", "thickness_m": 0.0125},
    {"relative_permittivity": 1, "thickness_m": 0.07},
    {"model": "dielectric", "relative_permittivity": 5, "conductivity_s_per_m": 0.1, "thickness_m": 0.15},
    {"model": "itu", "itu": "concrete", "thickness_m": 0.2}]})";
  const Multilayer expected{{ItuMaterial{"ceiling_board", 0.0125}, Dielectric{1.0, 0.0, 0.07},
                             Dielectric{5.0, 0.1, 0.15}, ItuMaterial{"concrete", 0.2}}};
  const io::Scenario scenario = files.load();
  CHECK(model_of<Multilayer>(scenario, "ground") == expected);
  CHECK(scenario.scene.material(*scenario.scene.find_material("ground")).roughness_rms_m == 0.0);
  SUBCASE("the key layers alone says the model") {
    files.materials.replace(files.materials.find(R"("model": "multilayer", )"), 23, "");
    CHECK(model_of<Multilayer>(files.load(), "ground") == expected);
  }
  SUBCASE("over the model of an MTL file") {
    files.ground_mtl = "newmtl ground\nem_model constant\nem_reflection 0.7\n";
    CHECK(model_of<Multilayer>(files.load(), "ground") == expected);
  }
  SUBCASE("an MTL file cannot hold layers") {
    files.ground_mtl = "newmtl ground\nem_model multilayer\n";
    CHECK(contains(files.error(), "ground.mtl:2: em_model: layers do not fit"));
  }
}

TEST_CASE("roughness goes with every model, from both kinds of files") {
  ScenarioCase files;
  const auto roughness_m = [&files] {
    const io::Scenario scenario = files.load();
    return scenario.scene.material(*scenario.scene.find_material("ground")).roughness_rms_m;
  };
  for (const std::string model : {R"("model": "pec")", R"("reflection": 0.7)", R"("relative_permittivity": 4)",
                                  R"("itu": "concrete")", R"("layers": [{"itu": "concrete", "thickness_m": 0.1}])"}) {
    CAPTURE(model);
    files.materials = R"("ground": {"roughness_rms_m": 0.0025, )" + model + "}";
    CHECK(roughness_m() == 0.0025);
  }
  files.ground_mtl = "newmtl ground\nem_model constant\nem_reflection 0.7\nem_roughness_rms_m 0.001\n";
  files.materials = "";
  CHECK(roughness_m() == 0.001);
  files.materials = R"("ground": {"roughness_rms_m": 0.0025})";
  CHECK(roughness_m() == 0.0025);
  files.materials = R"("ground": {"model": "pec"})";  // another model: the file's keys do not count
  CHECK(roughness_m() == 0.0);
}

TEST_CASE("one name with two meanings in two files is an error unless the scenario decides") {
  ScenarioCase files;
  std::ofstream(files.folder / "other.mtl") << "newmtl ground\nem_model pec\n";
  std::ofstream(files.folder / "other.obj") << "mtllib other.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl ground\nf 1 2 3\n";
  files.ground_mtl = "newmtl ground\nem_model constant\nem_reflection 0.7\n";
  files.objects = R"({"id": "other", "obj": "other.obj"})";
  files.materials = "";
  CHECK(contains(files.error(), "other.mtl:1: material 'ground' differs from"));
  files.materials = R"("ground": {"model": "itu", "itu": "concrete"})";
  CHECK(model_of<ItuMaterial>(files.load(), "ground") == ItuMaterial{"concrete", std::nullopt});
}

TEST_CASE("ITU materials outside their table: an error, or a warning when asked for") {
  ScenarioCase files;
  files.materials = R"("ground": {"itu": "wet_ground"})";  // tabulated from 1 to 10 GHz, revision 3 only
  CHECK(contains(files.error(), "frequency_hz: 'ground'"));
  files.more = R"(, "itu": {"allow_extrapolation": true})";
  REQUIRE(files.load().warnings.size() == 1);
  CHECK(contains(files.load().warnings[0], "'ground'"));
  files.materials = R"("ground": {"layers": [{"itu": "wet_ground", "thickness_m": 0.1},
    {"itu": "concrete", "thickness_m": 0.1}, {"itu": "wet_ground", "thickness_m": 0.2}]})";
  REQUIRE(files.load().warnings.size() == 1);  // concrete reaches to 100 GHz, and wet ground is named once
  CHECK(contains(files.load().warnings[0], "'wet_ground'"));
  files.more = R"(, "itu": {"revision": 4, "allow_extrapolation": true})";
  CHECK(contains(files.error(), "is in revision 3"));
}

TEST_CASE("links that are longer than any path may be are warned of") {
  ScenarioCase files;
  files.more = R"(, "links": {"range_m": 150}, "propagation": {"max_path_length_m": 100.5})";
  REQUIRE(files.load().warnings.size() == 1);
  CHECK(contains(files.load().warnings[0],
                 "links.range_m is 150, propagation.max_path_length_m 100.5: longer links have no path"));
  files.more = R"(, "links": {"range_m": 150}, "propagation": {"max_path_length_m": 150})";
  CHECK(files.load().warnings.empty());
}

TEST_CASE("materials that nothing uses are checked but not added") {
  ScenarioCase files;
  files.materials += R"(, "spare": {"model": "itu", "itu": "wet_ground"})";  // not in force at 30 GHz, and not used
  CHECK_FALSE(files.load().scene.find_material("spare").has_value());
  files.materials += R"(, "wrong": {"model": "constant"})";
  CHECK(contains(files.error(), "'wrong'"));
}

TEST_CASE("the command line overrides the file and is checked like it") {
  ScenarioCase files;
  files.more =
      R"(, "propagation": {"cache": "exactly", "rays": 100}, "output": {"paths": true, "pdp": {"bin_s": 1e-8}})";
  CHECK(contains(files.error(), "propagation.cache: found '\"exactly\"'"));
  const io::Scenario scenario = files.load({"exact", "off", 7, 9, "pdp", {}});
  CHECK(scenario.settings.propagation.discovery == Discovery::exact);
  CHECK(scenario.settings.propagation.rays == 7);
  CHECK(scenario.settings.propagation.seed == 9);
  CHECK_FALSE(scenario.output.paths);
  CHECK_FALSE(scenario.output.links);
  CHECK(scenario.output.pdp);
  CHECK(scenario.output.pdp_bin_s == 1e-8);  // the file's settings of what is asked for hold
  files.more = "";
  CHECK(files.error(only(&io::ScenarioOverrides::rays, 0))
            .starts_with("command line: --rays: found '0'; expected a whole number from 1"));
  CHECK(files.error(only(&io::ScenarioOverrides::seed, -1)).starts_with("command line: --seed:"));
  CHECK(files.error(only(&io::ScenarioOverrides::cache, "all")).starts_with("command line: --cache: found '\"all\"'"));
  CHECK(files.error(only(&io::ScenarioOverrides::discovery, "best"))
            .starts_with("command line: --discovery: found '\"best\"'"));
  CHECK(files.error(only(&io::ScenarioOverrides::output, "links,kmz"))
            .starts_with("command line: --output.kmz: unknown key"));
  CHECK(
      files.error(only(&io::ScenarioOverrides::output, "links,")).starts_with("command line: --output.: unknown key"));
}

TEST_CASE("a band that reaches below 0 is named by its own key, whatever says the frequency") {
  ScenarioCase files;
  files.more = R"(, "output": {"cfr": {"bandwidth_hz": 1e9, "points": 16}})";
  CHECK(files.error() == "no error");
  const std::string said = "output.cfr.bandwidth_hz: 1e+09 Hz around 1e+08 Hz reach below 0; expected at most twice";
  CHECK(contains(files.error(only(&io::ScenarioOverrides::frequency_hz, 1e8)), "case.json:1: " + said));
  io::ScenarioOverrides overrides = only(&io::ScenarioOverrides::frequency_hz, 1e8);
  overrides.output = "cfr";
  CHECK(contains(files.error(overrides), "command line: --" + said));
}

TEST_CASE("a place outside of its zone names the block once") {
  if (!io::knows_utm()) return;
  ScenarioCase files;
  files.more = R"(, "geo": {"crs": "utm32n", "offset_m": [1e8, 1e8]})";
  CHECK(contains(files.error(), "case.json:1: geo: no place in UTM"));
}

TEST_CASE("numbers that no whole number holds are refused") {
  ScenarioCase files;
  for (const std::string seed :
       {"-1", "1.5", "18446744073709551615", "-9223372036854775809", "1e300", "true", "\"1\""}) {
    CAPTURE(seed);
    files.more = R"(, "propagation": {"seed": )" + seed + "}";
    CHECK(contains(files.error(), "propagation.seed: found"));
  }
}

TEST_CASE("keys without an effect are named with the reason, once each, where the file says them") {
  ScenarioCase files;
  const auto warnings_with = [&](const std::string& propagation, const io::ScenarioOverrides& overrides = {}) {
    files.more = ", \n\n\"propagation\": {" + propagation + "}";
    return files.load(overrides).warnings;
  };
  const std::string rays = R"("rays": 100, "rays_steady": 10, "seed": 3)";
  const auto exact = warnings_with(R"("discovery": "exact", )" + rays);
  REQUIRE(exact.size() == 3);
  CHECK(contains(exact[0],
                 ": propagation.rays has no effect: discovery is exact, and no ray is shot; expected "
                 "discovery sampled"));
  CHECK(contains(exact[0], "case.json:"));
  CHECK(contains(exact[1], ": propagation.rays_steady has no effect: discovery is exact"));
  CHECK(contains(exact[2], ": propagation.seed has no effect: discovery is exact"));
  CHECK(warnings_with(rays).size() == 3);  // a small scene: exact by itself
  CHECK(warnings_with(R"("discovery": "sampled", )" + rays).empty());
  const auto uncached = warnings_with(R"("discovery": "sampled", "cache": "off", )" + rays);
  REQUIRE(uncached.size() == 1);
  CHECK(contains(uncached[0], "propagation.rays_steady has no effect: the cache is off; expected cache seed"));
  CHECK(warnings_with(R"("diffuse": {"phases": "seeded"}, "seed": 3)").empty());
  // Said for another discovery than that of the command line.
  CHECK(warnings_with(R"("discovery": "sampled", )" + rays, only(&io::ScenarioOverrides::discovery, "exact")).empty());
  CHECK(warnings_with(R"("max_interactions": 2, "valid_until_limit_m": 1)").empty());
  CHECK(warnings_with(R"("valid_until_limit_m": null)").empty());
  const auto lifetimes = warnings_with(R"("max_interactions": 3, "valid_until_limit_m": 1)");
  REQUIRE(lifetimes.size() == 1);
  CHECK(contains(lifetimes[0],
                 "propagation.valid_until_limit_m has no effect: paths may have more than two "
                 "interactions; expected max_interactions 2"));
  const auto sampled = warnings_with(R"("max_interactions": 2, "discovery": "sampled", "valid_until_limit_m": 1)");
  REQUIRE(sampled.size() == 1);
  CHECK(contains(sampled[0], "discovery is sampled; expected discovery exact"));
  CHECK(warnings_with(R"("max_interactions": 2, "cache": "off", "valid_until_limit_m": 1)").size() == 1);
  CHECK(warnings_with(R"("max_interactions": 2, "valid_until_limit_m": 1)", only(&io::ScenarioOverrides::cache, "off"))
            .empty());
}

}  // namespace test_scenario
