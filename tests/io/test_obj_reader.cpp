#include "dcem/io/obj_reader.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <fstream>
#include <string>

#include "dcem/io/input_error.hpp"
#include "tests/io/temporary_folder.hpp"
#include "tests/support/shared_data.hpp"

namespace test_obj_reader {

using namespace dcem;

namespace {

/// Writes the texts and reads the OBJ.
struct ObjCase {
  test::TemporaryFolder folder;

  io::ObjFile read(const std::string& obj, const std::string& mtl = "", const io::ObjSettings& settings = {}) const {
    std::ofstream(folder / "m.mtl", std::ios::binary) << mtl;
    std::ofstream(folder / "a.obj", std::ios::binary) << obj;
    return io::read_obj(folder / "a.obj", settings);
  }
  std::string error(const std::string& obj, const std::string& mtl = "") const {
    try {
      read(obj, mtl);
    } catch (const io::InputError& caught) {
      return std::string(caught.what()).substr(folder.path().string().size() + 1);
    }
    return "no error";
  }
};

io::ObjFile read_text(const std::string& obj, const std::string& mtl = "", const io::ObjSettings& settings = {}) {
  return ObjCase().read(obj, mtl, settings);
}

double triangle_area_m2(const TriangleMesh& mesh, const TriangleMesh::Triangle& triangle) {
  const Vec3 &a = mesh.vertices_m[triangle.vertices[0]], &b = mesh.vertices_m[triangle.vertices[1]],
             &c = mesh.vertices_m[triangle.vertices[2]];
  return glm::length(glm::cross(b - a, c - a)) / 2.0;
}

double area_m2(const TriangleMesh& mesh) {
  double sum = 0.0;
  for (const auto& triangle : mesh.triangles) sum += triangle_area_m2(mesh, triangle);
  return sum;
}

/// The polygon through the points, in order, with one face.
std::string polygon_obj(const std::vector<Vec3>& corners) {
  std::string vertices, face = "f";
  for (const Vec3& corner : corners) {
    vertices +=
        "v " + std::to_string(corner.x) + " " + std::to_string(corner.y) + " " + std::to_string(corner.z) + "\n";
    face += " " + std::to_string(&corner - corners.data() + 1);
  }
  return vertices + face + "\n";
}

const std::string triangle_obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

}  // namespace

TEST_CASE("an OBJ file gives its vertices to the last bit") {
  const auto file = read_text(
      "v 87.0257 -200.7223 0.1\nv 691234.123456789012 5334567.987654321 +1.5e-3\nv 0 1 0 1.0\nusemtl a\nf 1 2 3\n");
  // The compiler reads these literals correctly rounded: the reader must agree exactly.
  CHECK(file.mesh.vertices_m[0] == Vec3(87.0257, -200.7223, 0.1));
  CHECK(file.mesh.vertices_m[1] == Vec3(691234.123456789012, 5334567.987654321, 1.5e-3));
  REQUIRE(file.mesh.triangles.size() == 1);
  CHECK(file.mesh.triangles[0].vertices == std::array<std::uint32_t, 3>{0, 1, 2});
  CHECK(file.mesh.material_names == std::vector<std::string>{"a"});
}

TEST_CASE("faces carry the material named last, and 'default' before any") {
  const auto file =
      read_text(triangle_obj + "f 1 2 3\nusemtl a\nf 1 2 3\nusemtl Brick #2\nf 1 2 3\nusemtl a\nf 1 2 3\n");
  CHECK(file.mesh.material_names == std::vector<std::string>{"default", "a", "Brick #2"});
  std::vector<std::uint32_t> materials;
  for (const auto& triangle : file.mesh.triangles) materials.push_back(triangle.material);
  CHECK(materials == std::vector<std::uint32_t>{0, 1, 2, 1});
  CHECK(file.used_at.at("default") == 4);
  CHECK(file.used_at.at("Brick #2") == 7);
}

TEST_CASE("negative indices count back, attributes of corners are passed over, lines may end in any way") {
  const auto file = read_text("v 9 9 9\r\nv 0 0 0\rv 1 0 0\nv 0 1 0\n\n# c\n  f -3/1/1 -2//5 4/2\nv 5 5 5\nf -1 1 2");
  REQUIRE(file.mesh.triangles.size() == 2);
  CHECK(file.mesh.triangles[0].vertices == std::array<std::uint32_t, 3>{1, 2, 3});
  CHECK(file.mesh.triangles[1].vertices == std::array<std::uint32_t, 3>{4, 0, 1});
}

TEST_CASE("y up turns (x, y, z) into (x, -z, y), and the unit scales") {
  const auto file = read_text("v 1 2 3\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "", {io::UpAxis::y, 0.5});
  CHECK(file.mesh.vertices_m[0] == Vec3(0.5, -1.5, 1.0));
}

TEST_CASE("a polygon is cut into n - 2 triangles that cover it and nothing else") {
  // Triangles inside the polygon that overlap nowhere have its area; an overlap or a triangle outside adds to it. The
  // areas are from the shoelace formula by hand.
  const double rounding = 1e-12;
  struct Shape {
    std::string name;
    std::vector<Vec3> corners;
    double area_m2;
  };
  const std::vector<Shape> shapes{
      {"rectangle", {{0, 0, 0}, {3, 0, 0}, {3, 2, 0}, {0, 2, 0}}, 6.0},
      {"arrow head, whose shorter diagonal runs outside", {{0, 0, 0}, {4, 1, 0}, {0, 2, 0}, {3, 1, 0}}, 1.0},
      {"arrow head, far from the origin", {{90, 50, 7}, {94, 51, 7}, {90, 52, 7}, {93, 51, 7}}, 1.0},
      {"L upright", {{0, 0, 0}, {0, 2, 0}, {0, 2, 1}, {0, 1, 1}, {0, 1, 2}, {0, 0, 2}}, 3.0},
      {"U, clockwise", {{0, 3, 0}, {1, 3, 0}, {1, 1, 0}, {2, 1, 0}, {2, 3, 0}, {3, 3, 0}, {3, 0, 0}, {0, 0, 0}}, 7.0},
      {"comb",
       {{0, 0, 0}, {7, 0, 0}, {7, 3, 0}, {6, 1, 0}, {5, 3, 0}, {4, 1, 0}, {3, 3, 0}, {2, 1, 0}, {1, 3, 0}, {0, 1, 0}},
       14.0}};
  for (const Shape& shape : shapes) {
    CAPTURE(shape.name);
    for (std::size_t first = 0; first < shape.corners.size(); ++first) {
      std::vector<Vec3> corners(shape.corners.begin() + static_cast<std::ptrdiff_t>(first), shape.corners.end());
      corners.insert(corners.end(), shape.corners.begin(), shape.corners.begin() + static_cast<std::ptrdiff_t>(first));
      const auto file = read_text(polygon_obj(corners));
      CHECK(file.mesh.triangles.size() == corners.size() - 2);
      CHECK(area_m2(file.mesh) == doctest::Approx(shape.area_m2).epsilon(rounding));
      CHECK(file.warnings.empty());
    }
  }
}

TEST_CASE("a corner in the midst of a straight edge stays: no triangle of a polygon lacks area") {
  const auto file = read_text(polygon_obj({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0, 1, 0}}));
  for (const auto& triangle : file.mesh.triangles) CHECK(triangle_area_m2(file.mesh, triangle) > 0.1);
  CHECK(area_m2(file.mesh) == doctest::Approx(4.0).epsilon(1e-12));  // rounding
}

TEST_CASE("a disc of 2000 corners, more than a byte counts, is cut whole") {
  std::vector<Vec3> corners;
  const int count = 2000;
  for (int index = 0; index < count; ++index) {
    const double angle_rad = 2.0 * pi * index / count;
    corners.push_back({100.0 * std::cos(angle_rad), 100.0 * std::sin(angle_rad), 5.0});
  }
  const auto file = read_text(polygon_obj(corners));
  CHECK(file.mesh.triangles.size() == 1998);
  // Regular polygon: n/2·r²·sin(2π/n). The coordinates are written with six decimals.
  CHECK(area_m2(file.mesh) == doctest::Approx(count / 2.0 * 1e4 * std::sin(2.0 * pi / count)).epsilon(1e-6));
}

TEST_CASE("a polygon that crosses itself survives with a warning") {
  const auto file = read_text(polygon_obj({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0.5, 0}}));
  CHECK(file.mesh.triangles.size() == 3);
  const auto degenerate = read_text(polygon_obj({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}));
  CHECK(degenerate.warnings.size() == 1);
}

TEST_CASE("curved surfaces are left out with a warning") {
  CHECK(read_text(triangle_obj + "f 1 2 3\ncstype bezier\ndeg 3\n").warnings.size() == 1);
}

TEST_CASE("materials come with their keys and lines, from several libraries") {
  const ObjCase files;
  std::ofstream(files.folder / "my paint.mtl") << "newmtl b\nem_model pec\n";
  const auto file = files.read("mtllib m.mtl\nmtllib my paint.mtl\n" + triangle_obj + "usemtl a\nf 1 2 3\n",
                               "# x\nnewmtl a\nKd 1 1 1\nem_model constant\n  em_reflection\t0.7 # painted\n");
  REQUIRE(file.materials.size() == 2);
  const io::MtlMaterial& a = file.materials.at("a");
  CHECK(a.line == 2);
  CHECK(a.em_keys.at("em_reflection").value == "0.7");
  CHECK(a.em_keys.at("em_reflection").line == 5);
  CHECK(io::material_from_mtl("a", &a) == Material{"a", ConstantReflection{0.7, std::nullopt}});
  CHECK(io::material_from_mtl("b", &file.materials.at("b")) == Material{"b", PerfectConductor{}});
}

TEST_CASE("keys and name define the material") {
  const auto made = [](const std::string& name, const std::map<std::string, std::string>& keys) {
    io::MtlMaterial mtl{"m.mtl", 1, {}};
    for (const auto& [key, value] : keys) mtl.em_keys[key] = {value, 2};
    return io::material_from_mtl(name, &mtl);
  };
  CHECK(made("x", {}) == std::nullopt);
  CHECK(io::material_from_mtl("itu_concrete", nullptr) == Material{"itu_concrete", ItuMaterial{"concrete", {}}});
  CHECK(made("itu-medium-dry-ground", {})->model == MaterialModel(ItuMaterial{"medium_dry_ground", {}}));
  CHECK(made("itu_wood", {{"em_thickness_m", "0.04"}})->model == MaterialModel(ItuMaterial{"wood", 0.04}));
  CHECK(made("itu_wood", {{"em_model", "pec"}})->model == MaterialModel(PerfectConductor{}));
  CHECK(made("x", {{"em_itu", "glass"}})->model == MaterialModel(ItuMaterial{"glass", {}}));
  CHECK(made("x", {{"em_reflection", "0.5"}, {"em_penetration_loss_db", "20"}})->model ==
        MaterialModel(ConstantReflection{0.5, 20.0}));
  CHECK(made("x", {{"em_model", "dielectric"},
                   {"em_relative_permittivity", "5"},
                   {"em_conductivity_s_per_m", "0.1"},
                   {"em_thickness_m", "0.2"}})
            ->model == MaterialModel(Dielectric{5.0, 0.1, 0.2}));
  CHECK_THROWS_AS(made("x", {{"em_thickness_m", "0.2"}}), io::InputError);
  CHECK_THROWS_AS(made("x", {{"em_model", "itu"}}), io::InputError);
}

TEST_CASE("damaged files are named with file, line and element") {
  const ObjCase files;
  CHECK(files.error("v 0 0 0\nv 1 0 zero\n") == "a.obj:2: v: 'zero' is no finite number; expected coordinates x y z");
  CHECK(files.error(triangle_obj + "f 1 2 4\n") ==
        "a.obj:4: f: vertex 4 does not exist; expected an index from 1 to 3 or a negative one that counts back");
  CHECK(files.error(triangle_obj + "f 1 2 3\nv 1 -inf 0\n").starts_with("a.obj:5: v: '-inf'"));
  CHECK(files.error(triangle_obj + "f 1 2 \\\n3\n").starts_with("a.obj:4: the line goes on"));
  CHECK(files.error("mtllib m.mtl\n" + triangle_obj + "f 1 2 3\n", "newmtl a\nem_reflecton 1\n") ==
        "m.mtl:2: em_reflecton: unknown key (did you mean 'em_reflection'?); expected one of em_model, em_itu, "
        "em_relative_permittivity, em_conductivity_s_per_m, em_thickness_m, em_reflection, em_penetration_loss_db, "
        "em_foliage_db_per_m, em_roughness_rms_m, em_scattering, em_scattering_pattern, em_scattering_lobe, "
        "em_scattering_back_lobe, em_scattering_forward_share");
  CHECK_THROWS_AS(io::read_obj(files.folder / "absent.obj"), io::InputError);
  CHECK_THROWS_AS(io::read_obj(files.folder.path()), io::InputError);
}

TEST_CASE("a vertex may stand behind the face that uses it") {
  CHECK(read_text("f 1 2 3\n" + triangle_obj).mesh.triangles.size() == 1);
}

TEST_CASE("Munich is read whole") {
  DCEM_NEEDS_SHARED();
  const auto file = io::read_obj(test::shared_path("scenes/munich.obj"));
  // Counted with grep in the file.
  CHECK(file.mesh.vertices_m.size() == 34044);
  CHECK(file.mesh.triangles.size() == 38936);
  CHECK(file.materials.size() == 5);
  CHECK(io::material_from_mtl("metal", &file.materials.at("metal"))->model == MaterialModel(PerfectConductor{}));
}

}  // namespace test_obj_reader
