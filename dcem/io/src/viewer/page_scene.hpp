#pragma once
/// The part of the page that stands still: materials, and the shapes of scenery and objects. Private to dcem::io.
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

#include "dcem/io/src/viewer/page_array.hpp"
#include "dcem/scene/scene.hpp"

namespace dcem::io {

/// The scene, and its shapes once each.
class PageScene {
 public:
  PageScene(const Scene& scene, const Vec3& centre_m);

  void describe(nlohmann::ordered_json& head) const;
  void write(AtomicFile& file) const { arrays_.write(file); }

 private:
  void add(BodyId id);
  std::uint32_t find(const SurfaceMesh& mesh) const;
  void append(const SurfaceMesh& mesh, bool is_scenery);
  void give_colour(MaterialId material, bool is_scenery);

  const Scene& scene_;
  Vec3 centre_m_;
  std::vector<const SurfaceMesh*> shapes_;
  std::vector<std::string_view> colours_;
  std::size_t standing_ = 0, moving_ = 0, vertex_count_ = 0, triangle_count_ = 0;
  nlohmann::ordered_json meshes_ = nlohmann::ordered_json::array(), bodies_ = nlohmann::ordered_json::array();
  PageArrays arrays_;
};

}  // namespace dcem::io
