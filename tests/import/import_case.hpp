#pragma once
/// What tests of imports have in common: small sources, and the laws that an imported town obeys.
#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "dcem/io/import.hpp"
#include "dcem/io/input_error.hpp"
#include "dcem/io/inspection.hpp"
#include "dcem/io/obj_reader.hpp"
#include "dcem/io/scenario.hpp"
#include "dcem/io/src/geo/utm.hpp"
#include "dcem/io/src/import/outlines.hpp"
#include "tests/io/program_case.hpp"
#include "tests/io/temporary_folder.hpp"

namespace dcem::test {

/// What a closed shell over the plane z = 0 holds, by the divergence theorem, of all triangles but the ground's. The
/// floor, which houses do not have, lies in that plane and adds nothing.
inline double enclosed_volume_m3(const std::filesystem::path& obj) {
  const TriangleMesh mesh = io::read_obj(obj).mesh;
  double six_volumes_m3 = 0.0;
  const Vec3 origin_m(mesh.vertices_m.front().x, mesh.vertices_m.front().y, 0.0);
  for (const TriangleMesh::Triangle& triangle : mesh.triangles) {
    if (mesh.material_names[triangle.material] == "ground") continue;
    const Vec3 a = mesh.vertices_m[triangle.vertices[0]] - origin_m,
               b = mesh.vertices_m[triangle.vertices[1]] - origin_m,
               c = mesh.vertices_m[triangle.vertices[2]] - origin_m;
    six_volumes_m3 += glm::dot(a, glm::cross(b, c));
  }
  return six_volumes_m3 / 6.0;
}

/// Upwards area of all triangles of materials that begin with `material`, seen from above.
inline double seen_from_above_m2(const std::filesystem::path& obj, const std::string& material) {
  const TriangleMesh mesh = io::read_obj(obj).mesh;
  double twice_m2 = 0.0;
  for (const TriangleMesh::Triangle& triangle : mesh.triangles) {
    if (!mesh.material_names[triangle.material].starts_with(material)) continue;
    const Vec3 &a = mesh.vertices_m[triangle.vertices[0]], &b = mesh.vertices_m[triangle.vertices[1]],
               &c = mesh.vertices_m[triangle.vertices[2]];
    twice_m2 += glm::cross(b - a, c - a).z;
  }
  return 0.5 * twice_m2;
}

/// Every block is one closed shell that stands on its open foot; no wall is there twice; every roof is there; the
/// volume is area times height.
inline void check_clean_town(const std::filesystem::path& folder, const io::ImportReport& report) {
  const io::Inspection seen = io::inspect_obj(folder / "scene.obj");
  CHECK(seen.report.crowded_edges == 0);
  CHECK(seen.report.triangles_repeated == 0);
  CHECK(seen.report.triangles_without_area == 0);
  CHECK(seen.report.vertices_welded == 0);
  CHECK(seen.report.closed_shells == 0);
  CHECK(seen.report.standing_shells > 0);
  CHECK(seen.overlapping_facet_pairs == 0);
  constexpr std::size_t edges_of_ground = 4;
  CHECK(seen.report.open_edges == report.made.at("outer walls") + edges_of_ground);
  const double footprint_m2 = report.sizes.at("footprint_area_m2"), volume_m3 = report.sizes.at("volume_m3");
  CHECK(seen_from_above_m2(folder / "scene.obj", "roof") == doctest::Approx(footprint_m2).epsilon(1e-9));
  CHECK(seen_from_above_m2(folder / "scene.obj", "wall") == doctest::Approx(0.0).epsilon(1e-6));
  CHECK(enclosed_volume_m3(folder / "scene.obj") == doctest::Approx(volume_m3).epsilon(1e-9));
}

/// The message of the InputError that an import throws, which leaves nothing behind.
template <typename Import>
std::string refusal(const TemporaryFolder& folder, const Import& import) {
  const auto before = folder.names();
  std::string message = "accepted";
  try {
    import();
  } catch (const io::InputError& error) {
    message = error.what();
  }
  CAPTURE(message);
  CHECK(folder.names() == before);
  const bool says_what_to_do =
      message.find("; expected ") != std::string::npos || message.find("nearest known one") != std::string::npos;
  CHECK(says_what_to_do);
  CHECK(message.find('\n') == std::string::npos);
  return message;
}

inline nlohmann::json read_json(const std::filesystem::path& file) {
  return nlohmann::json::parse(file_bytes(file));
}

/// A ring as SUMO writes it.
inline std::string shape_text(const io::Ring& ring) {
  std::string text;
  for (const Vec2& corner : ring) text += std::to_string(corner.x) + ',' + std::to_string(corner.y) + ' ';
  return text.substr(0, text.size() - 1);
}

inline std::string poly(const std::string& id, const std::string& shape, const std::string& tags = "",
                        const std::string& type = "building") {
  return "<poly id=\"" + id + "\" type=\"" + type + "\" shape=\"" + shape + "\">" + tags + "</poly>\n";
}

inline std::string param(const std::string& key, const std::string& value) {
  return "<param key=\"" + key + "\" value=\"" + value + "\"/>";
}

/// A network of one street along y = 0, in UTM 32.
inline const std::string small_network =
    "<net>\n<location netOffset=\"-500000.00,-5600000.00\" convBoundary=\"0,-20,200,120\" "
    "origBoundary=\"9,50,10,51\" projParameter=\"+proj=utm +zone=32 +ellps=WGS84 +datum=WGS84 +units=m +no_defs\"/>\n"
    "<edge id=\"street\"><lane id=\"street_0\" index=\"0\" speed=\"13.9\" length=\"200\" shape=\"0,0 200,0\"/></edge>\n"
    "</net>\n";

/// Imports polygons with the small network.
inline io::ImportReport import_polygons(const TemporaryFolder& folder, const std::string& polygons,
                                        const io::ImportSettings& settings = {}) {
  write(folder / "town.net.xml", small_network);
  write(folder / "town.poly.xml", "<additional>\n" + polygons + "</additional>\n");
  return io::import_sumo({folder / "town.net.xml", folder / "town.poly.xml", {}, {}}, folder / "made", settings);
}

}  // namespace dcem::test

#define DCEM_NEEDS_GEOS()                                \
  if (!dcem::io::can_shape_outlines()) {                 \
    MESSAGE("skipped: this build imports without GEOS"); \
    return;                                              \
  }                                                      \
  static_assert(true, "asks for a semicolon")
