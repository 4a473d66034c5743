#include "dcem/io/src/viewer/page_scene.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

namespace dcem::io {
namespace {

using Json = nlohmann::ordered_json;

/// Light and muted for what stands, so that rays stand out; dark for what moves.
constexpr std::array<std::string_view, 8> standing_colours{"#d5cdbd", "#b9c6d1", "#c2cfb6", "#d8bfb2",
                                                           "#c6bed0", "#b3c9c6", "#dcd3a8", "#bcbcbc"};
constexpr std::array<std::string_view, 4> moving_colours{"#77838f", "#8f7f6d", "#6f8a7b", "#87779a"};

bool same_shape(const SurfaceMesh& a, const SurfaceMesh& b) {
  const auto material = [](const SurfaceMesh& mesh, std::size_t triangle) -> const std::string& {
    return mesh.material_names[mesh.facets[mesh.facet_of_triangle[triangle]].material];
  };
  if (a.vertices_m != b.vertices_m || a.triangles != b.triangles) return false;
  for (std::size_t triangle = 0; triangle < a.triangles.size(); ++triangle) {
    if (material(a, triangle) != material(b, triangle)) return false;
  }
  return true;
}

}  // namespace

PageScene::PageScene(const Scene& scene, const Vec3& centre_m) : scene_(scene), centre_m_(centre_m) {
  arrays_.announce({"triangles", "triangle_material"}, {"vertices"});
  colours_.resize(scene.materials().size());
  for (std::size_t body = 0; body < scene.bodies().size(); ++body) add(BodyId(body));
}

void PageScene::describe(Json& head) const {
  Json materials = Json::array();
  for (std::size_t index = 0; index < colours_.size(); ++index) {
    const std::string colour(colours_[index].empty() ? "#bcbcbc" : colours_[index]);
    materials.push_back(
        {{"name", scene_.materials()[index].name}, {"colour", colour}, {"used", !colours_[index].empty()}});
  }
  head["materials"] = std::move(materials);
  head["meshes"] = meshes_;
  head["bodies"] = bodies_;
}

void PageScene::add(BodyId id) {
  const SurfaceMesh& mesh = scene_.body(id).mesh;
  std::uint32_t number = find(mesh);
  if (number == shapes_.size() || id.value == 0) {
    number = static_cast<std::uint32_t>(shapes_.size());
    shapes_.push_back(&mesh);
    append(mesh, id.value == 0);
  }
  bodies_.push_back({{"mesh", number}});
}

/// A shape that is the same; the scenery has a place of its own, because it is moved to the centre.
std::uint32_t PageScene::find(const SurfaceMesh& mesh) const {
  std::uint32_t number = 1;
  while (number < shapes_.size() && !same_shape(*shapes_[number], mesh)) ++number;
  return std::max(number, static_cast<std::uint32_t>(std::min<std::size_t>(1, shapes_.size())));
}

void PageScene::append(const SurfaceMesh& mesh, bool is_scenery) {
  meshes_.push_back({{"first_vertex", vertex_count_},
                     {"vertices", mesh.vertices_m.size()},
                     {"first_triangle", triangle_count_},
                     {"triangles", mesh.triangles.size()}});
  PageArray& vertices = arrays_.numbers("vertices");
  for (const Vec3& vertex_m : mesh.vertices_m) vertices.add(is_scenery ? vertex_m - centre_m_ : vertex_m);
  PageArray& triangles = arrays_.counts("triangles");
  for (const auto& corners : mesh.triangles) {
    for (const std::uint32_t corner : corners) triangles.add(corner);
  }
  PageArray& materials = arrays_.counts("triangle_material");
  for (const std::uint32_t facet : mesh.facet_of_triangle) {
    const MaterialId material = *scene_.find_material(mesh.material_names[mesh.facets[facet].material]);
    materials.add(static_cast<std::uint32_t>(material.value));
    give_colour(material, is_scenery);
  }
  vertex_count_ += mesh.vertices_m.size();
  triangle_count_ += mesh.triangles.size();
}

void PageScene::give_colour(MaterialId material, bool is_scenery) {
  std::string_view& colour = colours_[material.value];
  if (!colour.empty()) return;
  colour = is_scenery ? standing_colours[standing_++ % standing_colours.size()]
                      : moving_colours[moving_++ % moving_colours.size()];
}

}  // namespace dcem::io
