#pragma once
/// A glTF document with its buffer, in one binary file. Private to dcem::io.
///
/// Khronos Group, "glTF 2.0 Specification" (registry.khronos.org/glTF/specs/2.0). Numbers of arrays are single
/// precision there, so meshes are stored about a centre of their own and nodes carry it.
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "dcem/geometry/pose.hpp"
#include "dcem/io/atomic_file.hpp"
#include "dcem/io/image.hpp"

namespace dcem::io {

class GltfDocument {
 public:
  using Json = nlohmann::ordered_json;
  enum class Mode { lines = 1, triangles = 4 };

  // Each gives the number of what was added.

  std::size_t add_points(std::span<const Vec3> points_m, const Vec3& centre_m);
  std::size_t add_colours(std::span<const Colour> colours);
  std::size_t add_indices(std::span<const std::uint32_t> indices);
  /// Lit from both sides; or shown in the colours of its vertices, without light.
  std::size_t add_material(const std::string& name, Colour colour);
  std::size_t add_unlit_material(const std::string& name);
  std::size_t add_mesh(Json primitives);
  /// A child of the node that turns z up into glTF's y up.
  std::size_t add_node(const std::string& name, const Pose& pose);
  void set_mesh(std::size_t node, std::size_t mesh) { nodes_[node]["mesh"] = mesh; }
  void set_extras(std::size_t node, Json extras) { nodes_[node]["extras"] = std::move(extras); }

  static Json primitive(Mode mode, std::size_t points, std::size_t material);

  /// The whole file.
  std::string bytes(const std::string& scene_name) const;

 private:
  std::size_t add_accessor(const void* values, std::size_t size_bytes, Json facts, int target);

  Json accessors_ = Json::array(), views_ = Json::array(), materials_ = Json::array(), meshes_ = Json::array(),
       nodes_ = Json::array();
  std::string buffer_;
};

}  // namespace dcem::io
