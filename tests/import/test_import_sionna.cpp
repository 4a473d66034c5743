/// Scenes of Mitsuba with radio materials become scenarios; PLY meshes, text and binary.
#include <doctest/doctest.h>

#include <array>
#include <cstring>

#include "dcem/io/src/import/ply_reader.hpp"
#include "tests/import/import_case.hpp"

namespace test_import_sionna {

using namespace dcem;
using dcem::test::refusal;
using dcem::test::TemporaryFolder;
using dcem::test::write;

namespace {

const std::string square_header =
    "ply\nformat ascii 1.0\ncomment a wall\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "property float s\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
const std::string square = square_header + "0 0 0 0.5\n10 0 0 0.5\n10 0 5 0.5\n0 0 5 0.5\n4 0 1 2 3\n";

template <typename Value>
void append(std::string& bytes, Value value) {
  std::array<char, sizeof(Value)> raw{};
  std::memcpy(raw.data(), &value, sizeof(Value));
  bytes.append(raw.data(), raw.size());
}

/// Two triangles in the plane z = 0; the second shares an edge with the first.
std::string binary_ground() {
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double "
      "z\n"
      "element face 2\nproperty list uchar uint vertex_index\nend_header\n";
  for (const Vec3& corner : {Vec3(-50, -50, 0), Vec3(50, -50, 0), Vec3(50, 50, 0), Vec3(-50, 50, 0)}) {
    for (int axis = 0; axis < 3; ++axis) append(bytes, corner[axis]);
  }
  for (const std::array<std::uint32_t, 3>& face : {std::array<std::uint32_t, 3>{0, 1, 2}, {0, 2, 3}}) {
    append(bytes, static_cast<std::uint8_t>(3));
    for (const std::uint32_t corner : face) append(bytes, corner);
  }
  return bytes;
}

std::string scene(const std::string& shapes) {
  return "<scene version=\"2.1.0\">\n<default name=\"spp\" value=\"64\"/>\n<integrator type=\"path\"/>\n"
         "<bsdf type=\"twosided\" id=\"mat-itu_marble\"><bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"0.7 "
         "0.6 "
         "0.5\"/></bsdf></bsdf>\n"
         "<bsdf type=\"itu-radio-material\" id=\"glazing\"><string name=\"type\" value=\"glass\"/><float "
         "name=\"thickness\" "
         "value=\"0.01\"/></bsdf>\n"
         "<bsdf type=\"radio-material\" id=\"own\"><float name=\"relative_permittivity\" value=\"4.5\"/><float "
         "name=\"conductivity\" value=\"0.1\"/><float name=\"scattering_coefficient\" value=\"0.3\"/></bsdf>\n"
         "<bsdf type=\"diffuse\" id=\"paint\"/>\n" +
         shapes + "</scene>\n";
}

std::string shape(const std::string& file, const std::string& material, const std::string& more = "",
                  const std::string& type = "ply") {
  return "<shape type=\"" + type + "\" id=\"mesh-" + file + "\"><string name=\"filename\" value=\"" + file +
         "\"/><boolean name=\"face_normals\" value=\"true\"/>" + more + "<ref id=\"" + material +
         "\" name=\"bsdf\"/></shape>\n";
}

std::string ply_error(const TemporaryFolder& folder, const std::string& bytes) {
  write(folder / "mesh.ply", bytes);
  return refusal(folder, [&] { io::read_ply(folder / "mesh.ply"); });
}

bool holds(const std::string& message, const std::string& piece) {
  return message.find(piece) != std::string::npos;
}

}  // namespace

TEST_CASE("a scene becomes a scenario that runs without editing") {
  DCEM_NEEDS_PROGRAM();
  const TemporaryFolder folder;
  write(folder / "square.ply", square);
  write(folder / "ground.ply", binary_ground());
  const std::string moved =
      "<transform name=\"to_world\"><scale value=\"2\"/><rotate z=\"1\" angle=\"90\"/><translate x=\"5\" "
      "z=\"1\"/></transform>";
  write(
      folder / "scene.xml",
      scene(shape("ground.ply", "mat-itu_marble") + shape("square.ply", "glazing") + shape("square.ply", "own", moved) +
            shape("", "paint", "<transform name=\"to_world\"><translate value=\"20 0 1\"/></transform>", "cube") +
            shape("", "paint", "", "sphere")));
  const io::ImportReport report = io::import_sionna(folder / "scene.xml", folder / "made");
  CHECK(report.read.at("shapes") == 5);
  CHECK(report.made.at("objects") == 4);
  CHECK(report.skipped.at("shapes of type 'sphere'") == 1);
  CHECK(report.repaired.at("materials that say nothing of radio, taken for concrete") == 1);

  const io::Inspection seen = io::inspect_obj(folder / "made/scene.obj");
  CHECK(seen.materials.size() == 4);
  for (const io::InspectedMaterial& material : seen.materials) {
    CAPTURE(material.name);
    CHECK(material.material.has_value());
    if (material.name == "own") CHECK(material.area_m2 == doctest::Approx(4.0 * 50.0));
    if (material.name == "itu_marble") CHECK(material.area_m2 == doctest::Approx(10000.0));
    if (material.name == "paint") CHECK(material.area_m2 == doctest::Approx(24.0));
  }
  const TriangleMesh mesh = io::read_obj(folder / "made/scene.obj").mesh;
  double highest_m = 0.0;
  for (const Vec3& vertex : mesh.vertices_m) highest_m = std::max(highest_m, vertex.z);
  CHECK(highest_m == doctest::Approx(11.0));  // 5 m, twice, lifted by 1 m
  const std::string mtl = dcem::test::file_bytes(folder / "made/scene.mtl");
  CHECK(holds(mtl, "newmtl glazing\nem_model itu\nem_itu glass\nem_thickness_m 0.01\n"));
  CHECK(holds(mtl, "em_relative_permittivity 4.5\nem_conductivity_s_per_m 0.1\nem_scattering 0.3\n"));

  const auto run = dcem::test::dcem_program(folder, "run made/scenario.json -o out --quiet");
  CAPTURE(run.error);
  CHECK(run.exit_code == 0);
}

TEST_CASE("in a closed room the mast is inside") {
  const TemporaryFolder folder;
  const auto mast_z_m = [&](const std::string& shapes) {
    write(folder / "scene.xml", scene(shapes));
    io::import_sionna(folder / "scene.xml", folder / "made");
    return dcem::test::read_json(folder / "made/scenario.json")["transmitters"][0]["position_m"][2].get<double>();
  };
  const std::string size = "<transform name=\"to_world\"><scale value=\"5\"/></transform>";
  CHECK(mast_z_m(shape("", "paint", size, "cube")) == doctest::Approx(3.0));  // from -5 to 5
  CHECK(mast_z_m(shape("", "paint", size, "rectangle")) == doctest::Approx(5.0));
}

TEST_CASE("long names of files and materials are not cut") {
  const TemporaryFolder folder;
  const std::string long_name(120, 'm');
  write(folder / (long_name + ".ply"), square);
  std::string materials;
  for (const char* const end : {"_a", "_b"}) {
    materials += "<bsdf type=\"itu-radio-material\" id=\"" + long_name + end +
                 "\"><string name=\"type\" value=\"metal\"/></bsdf>\n";
  }
  write(folder / "scene.xml",
        scene(materials + shape(long_name + ".ply", long_name + "_a") + shape(long_name + ".ply", long_name + "_b")));
  CHECK(io::import_sionna(folder / "scene.xml", folder / "made").made.at("objects") == 2);
  CHECK(holds(dcem::test::file_bytes(folder / "made/scene.mtl"), "newmtl " + long_name + "_b\n"));
  write(folder / "scene.xml", scene(shape(long_name + long_name + ".ply", "own")));
  const std::string message = refusal(folder, [&] { io::import_sionna(folder / "scene.xml", folder / "other"); });
  CHECK(holds(message, "is not there"));
  CHECK(message.size() < 400);
}

TEST_CASE("PLY: text and binary give the same mesh") {
  const TemporaryFolder folder;
  write(folder / "ground.ply", binary_ground());
  const io::PlyMesh ground = io::read_ply(folder / "ground.ply");
  REQUIRE(ground.vertices_m.size() == 4);
  CHECK(ground.vertices_m[2] == Vec3(50, 50, 0));
  REQUIRE(ground.faces.size() == 2);
  CHECK(ground.faces[1] == std::vector<std::size_t>{0, 2, 3});
  write(folder / "square.ply", square);
  const io::PlyMesh wall = io::read_ply(folder / "square.ply");
  CHECK(wall.vertices_m[2] == Vec3(10, 0, 5));
  CHECK(wall.faces[0].size() == 4);
}

TEST_CASE("damaged PLY: one line with what was expected") {
  const TemporaryFolder folder;
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = square;
    return text.replace(text.find(from), from.size(), to);
  };
  CHECK(holds(ply_error(folder, ""), "no 'ply'"));
  CHECK(holds(ply_error(folder, "ply\nformat ascii 1.0\n"), "the header breaks off"));
  CHECK(holds(ply_error(folder, with("ascii", "binary_big_endian")), "mesh.ply:2: format 'binary_big_endian'"));
  CHECK(holds(ply_error(folder, with("vertex 4", "vertex 5")), "mesh.ply:16: "));  // takes the face for a vertex
  CHECK(holds(ply_error(folder, with("vertex 4", "vertex 3")), "more follows"));
  CHECK(holds(ply_error(folder, with("vertex 4", "vertex 4000000000")), "more than the file holds"));
  CHECK(holds(ply_error(folder, with("vertex 4", "vertex -4")), "mesh.ply:4"));
  CHECK(holds(ply_error(folder, with("face 1", "face 2")), "breaks off in face 2 of 2"));
  CHECK(holds(ply_error(folder, with("4 0 1 2 3", "4 0 1 2 7")), "has corner 7"));
  CHECK(holds(ply_error(folder, with("4 0 1 2 3", "400000 0 1 2 3")), "a list of 4e+05"));
  CHECK(holds(ply_error(folder, with("10 0 5", "10 nan 5")), "expected a number"));
  CHECK(holds(ply_error(folder, with("10 0 5", "10 1e12 5")), "not within 1e9"));
  CHECK(holds(ply_error(folder, with("property float z\n", "")), "with x, y and z"));
  const std::string binary = binary_ground();
  CHECK(holds(ply_error(folder, binary.substr(0, binary.size() - 5)), "breaks off in face 2 of 2"));
}

TEST_CASE("damaged scenes: one line, nothing written") {
  const TemporaryFolder folder;
  write(folder / "square.ply", square);
  const auto refused = [&](const std::string& xml, const char* said) {
    write(folder / "scene.xml", xml);
    const std::string message = refusal(folder, [&] { io::import_sionna(folder / "scene.xml", folder / "made"); });
    CHECK(holds(message, said));
  };
  const std::string good = scene(shape("square.ply", "own"));
  refused(good.substr(0, good.size() - 12), "damaged XML");
  refused("<!DOCTYPE scene [<!ENTITY a \"b\">]>" + good, "document type declaration");
  refused("<osm/>", "expected <scene>");
  refused(scene(""), "holds no surface");
  refused(scene(shape("absent.ply", "own")), "absent.ply");
  refused(scene(shape("square.ply", "unheard")), "nowhere defined");
  refused(scene(shape("square.ply", "own", "<transform name=\"to_world\"><matrix value=\"1 2 3\"/></transform>")),
          "found 3 numbers");
  refused(scene(shape("square.ply", "own", "<transform name=\"to_world\"><rotate angle=\"90\"/></transform>")),
          "without axis");
}

TEST_CASE("what no scenario may hold is refused where the scene says it") {
  const TemporaryFolder folder;
  write(folder / "square.ply", square);
  io::ImportSettings settings;
  const auto refused = [&](const std::string& materials_and_shapes, const std::string& said) {
    CAPTURE(said);
    write(folder / "scene.xml", "<scene>\n" + materials_and_shapes + "</scene>\n");
    const std::string message =
        refusal(folder, [&] { io::import_sionna(folder / "scene.xml", folder / "made", settings); });
    CAPTURE(message);
    CHECK(holds(message, "scene.xml"));
    CHECK(holds(message, said));
  };
  const auto material = [&](const std::string& type, const std::string& says) {
    return "<bsdf type=\"" + type + "\" id=\"mat-x\">\n" + says + "</bsdf>\n" + shape("square.ply", "mat-x");
  };
  const auto number = [](const std::string& name, const std::string& value) {
    return "<float name=\"" + name + "\" value=\"" + value + "\"/>\n";
  };
  const auto itu = [](const std::string& name) { return "<string name=\"type\" value=\"" + name + "\"/>\n"; };
  refused(
      material("itu-radio-material", itu("concret")),
      "scene.xml:3: bsdf 'mat-x': type: unknown ITU-R P.2040 material 'concret'; the nearest known one is 'concrete'");
  refused(
      "<bsdf type=\"diffuse\" id=\"mat-itu_glas\"/>\n" + shape("square.ply", "mat-itu_glas"),
      "scene.xml:2: bsdf 'mat-itu_glas': itu: unknown ITU-R P.2040 material 'glas'; the nearest known one is 'glass'");
  for (const char* const thickness_m : {"0", "-0.1", "5000"}) {
    refused(material("itu-radio-material", itu("glass") + number("thickness", thickness_m)),
            "scene.xml:4: bsdf 'mat-x': thickness: found '" + std::string(thickness_m) +
                "'; expected a number above 0, at most 1000 m");
  }
  const std::string good = number("relative_permittivity", "4");
  refused(material("radio-material", number("relative_permittivity", "0.5")),
          "scene.xml:3: bsdf 'mat-x': relative_permittivity: found '0.5'; expected a number from 1 to 1e+06");
  refused(material("radio-material", number("eta_r", "1e308")), "scene.xml:3: bsdf 'mat-x': eta_r: found '1e+308'");
  refused(material("radio-material", good + number("conductivity", "-1")),
          "scene.xml:4: bsdf 'mat-x': conductivity: found '-1'; expected a number from 0");
  refused(material("radio-material", good + number("scattering_coefficient", "2")),
          "scene.xml:4: bsdf 'mat-x': scattering_coefficient: found '2'; expected a number from 0 to 1");
  refused(material("radio-material", ""),
          "scene.xml:2: bsdf 'mat-x': material 'x': model 'dielectric' lacks the key 'relative_permittivity'");

  const std::string bare = "<bsdf type=\"radio-material\" id=\"mat-x\">\n" + good + "</bsdf>\n\n";
  const auto moved = [&](const std::string& transform) {
    return bare + shape("square.ply", "mat-x", "<transform name=\"to_world\">" + transform + "</transform>");
  };
  for (const char* const scale : {"0", "1e-9"}) {
    refused(moved("<scale value=\"" + std::string(scale) + "\"/>"), "scene.xml:6: shape 'mesh-square.ply': is ");
  }
  for (const char* const transform :
       {"<scale value=\"1e9\"/>", "<translate x=\"1e12\"/>", "<scale value=\"1e300\"/><scale value=\"1e300\"/>"}) {
    refused(moved(transform),
            "scene.xml:6: shape 'mesh-square.ply': a corner too far away; expected points within 1e9 m");
  }
  refused(moved("<rotate x=\"1e200\" angle=\"90\"/>"), "scene.xml:6: rotate: without axis");
  settings.frequency_hz = 2e11;
  refused(
      material("itu-radio-material", itu("concrete")),
      "frequency: material 'x': material 'concrete' at 200 GHz is outside the range of ITU-R P.2040 revision 3: 1 to "
      "100 GHz; expected a material and a frequency of the table");
  settings.frequency_hz.reset();
  refused(material("itu-radio-material", itu("floorboard")), "material 'floorboard' at 3.5 GHz is outside");
}

TEST_CASE("what importers overlook is refused by the reader of scenarios before anything is written") {
  const TemporaryFolder folder;
  // All faces lie on lines: each in itself has a size, and none an area.
  write(folder / "scene.xml", scene(shape("", "own",
                                          "<transform name=\"to_world\"><scale x=\"9\" y=\"0\" "
                                          "z=\"0\"/></transform>",
                                          "cube")));
  const std::string message = refusal(folder, [&] { io::import_sionna(folder / "scene.xml", folder / "made"); });
  CHECK(holds(message, "scene.xml: would become a scenario that does not run ("));
  CHECK(holds(message, "scenario.json:"));
  CHECK(holds(message, "no face has an area"));
}

TEST_CASE("materials whose names would be the same in an OBJ file keep apart; names that mean more there are changed") {
  const TemporaryFolder folder;
  write(folder / "square.ply", square);
  const auto metal = [](const std::string& id, const std::string& permittivity) {
    return "<bsdf type=\"radio-material\" id=\"" + id + "\"><float name=\"relative_permittivity\" value=\"" +
           permittivity + "\"/></bsdf>\n";
  };
  write(folder / "scene.xml",
        scene(metal("mat-a", "2") + metal("a", "3") + metal("b\\", "4") + shape("square.ply", "mat-a") +
              shape("square.ply", "a") + shape("square.ply", "b\\")));
  io::import_sionna(folder / "scene.xml", folder / "made");
  const std::string mtl = dcem::test::file_bytes(folder / "made/scene.mtl");
  CHECK(holds(mtl, "newmtl a\nem_model dielectric\nem_relative_permittivity 2\n"));
  CHECK(holds(mtl, "newmtl a_\nem_model dielectric\nem_relative_permittivity 3\n"));
  CHECK(holds(mtl, "newmtl b_\nem_model dielectric\nem_relative_permittivity 4\n"));
}

}  // namespace test_import_sionna
