#include "dcem/io/src/exchange/gltf_document.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <utility>

namespace dcem::io {
namespace {

static_assert(std::endian::native == std::endian::little, "values are written as they lie in memory");

using Json = GltfDocument::Json;

// Words of the specification, sections 3.6.2 and 3.11.
constexpr int type_uint8 = 5121, type_uint32 = 5125, type_float = 5126, vertex_buffer = 34962, index_buffer = 34963;
constexpr std::uint32_t magic_gltf = 0x46546c67, chunk_json = 0x4e4f534a, chunk_binary = 0x004e4942;

/// IEC 61966-2-1: glTF wants colours of materials and vertices linear.
double linear(std::uint8_t channel) {
  const double share = channel / 255.0;
  return share <= 0.04045 ? share / 12.92 : std::pow((share + 0.055) / 1.055, 2.4);
}

void append_word(std::string& text, std::size_t value) {
  const auto word = static_cast<std::uint32_t>(value);
  text.append(reinterpret_cast<const char*>(&word), sizeof word);
}

/// Length, kind and content; chunks end at multiples of four bytes.
void append_chunk(std::string& text, std::uint32_t kind, std::string content, char filler) {
  content.resize((content.size() + 3) / 4 * 4, filler);
  append_word(text, content.size());
  append_word(text, kind);
  text += content;
}

}  // namespace

std::size_t GltfDocument::add_accessor(const void* values, std::size_t size_bytes, Json facts, int target) {
  views_.push_back({{"buffer", 0}, {"byteOffset", buffer_.size()}, {"byteLength", size_bytes}, {"target", target}});
  buffer_.append(static_cast<const char*>(values), size_bytes);  // all have multiples of four bytes
  Json accessor{{"bufferView", views_.size() - 1}};
  accessor.update(facts);
  accessors_.push_back(std::move(accessor));
  return accessors_.size() - 1;
}

std::size_t GltfDocument::add_points(std::span<const Vec3> points_m, const Vec3& centre_m) {
  std::vector<std::array<float, 3>> values;
  for (const Vec3& point_m : points_m) {
    const Vec3 from_centre_m = point_m - centre_m;
    values.push_back({static_cast<float>(from_centre_m.x), static_cast<float>(from_centre_m.y),
                      static_cast<float>(from_centre_m.z)});
  }
  std::array<float, 3> least = values.front(), most = values.front();
  for (const auto& value : values) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      least[axis] = std::min(least[axis], value[axis]);
      most[axis] = std::max(most[axis], value[axis]);
    }
  }
  return add_accessor(
      values.data(), values.size() * sizeof values[0],
      {{"componentType", type_float}, {"count", values.size()}, {"type", "VEC3"}, {"min", least}, {"max", most}},
      vertex_buffer);
}

std::size_t GltfDocument::add_colours(std::span<const Colour> colours) {
  std::vector<std::array<std::uint8_t, 4>> values;
  const auto share = [](std::uint8_t channel) {
    return static_cast<std::uint8_t>(std::lround(255.0 * linear(channel)));
  };
  for (const Colour& colour : colours) {
    values.push_back({share(colour.red), share(colour.green), share(colour.blue), 255});
  }
  return add_accessor(values.data(), values.size() * sizeof values[0],
                      {{"componentType", type_uint8}, {"normalized", true}, {"count", values.size()}, {"type", "VEC4"}},
                      vertex_buffer);
}

std::size_t GltfDocument::add_indices(std::span<const std::uint32_t> indices) {
  return add_accessor(indices.data(), indices.size_bytes(),
                      {{"componentType", type_uint32}, {"count", indices.size()}, {"type", "SCALAR"}}, index_buffer);
}

std::size_t GltfDocument::add_material(const std::string& name, Colour colour) {
  const Json surface{{"baseColorFactor", {linear(colour.red), linear(colour.green), linear(colour.blue), 1.0}},
                     {"metallicFactor", 0.0},
                     {"roughnessFactor", 1.0}};
  materials_.push_back({{"name", name}, {"doubleSided", true}, {"pbrMetallicRoughness", surface}});
  return materials_.size() - 1;
}

std::size_t GltfDocument::add_unlit_material(const std::string& name) {
  materials_.push_back({{"name", name}, {"extensions", {{"KHR_materials_unlit", Json::object()}}}});
  return materials_.size() - 1;
}

Json GltfDocument::primitive(Mode mode, std::size_t points, std::size_t material) {
  return {{"attributes", {{"POSITION", points}}}, {"mode", static_cast<int>(mode)}, {"material", material}};
}

std::size_t GltfDocument::add_mesh(Json primitives) {
  meshes_.push_back({{"primitives", std::move(primitives)}});
  return meshes_.size() - 1;
}

std::size_t GltfDocument::add_node(const std::string& name, const Pose& pose) {
  Json node{{"name", name}, {"translation", {pose.position_m.x, pose.position_m.y, pose.position_m.z}}};
  const auto turn = glm::quat_cast(rotation_matrix(pose));
  if (pose.yaw_rad != 0.0 || pose.pitch_rad != 0.0 || pose.roll_rad != 0.0) {
    node["rotation"] = {turn.x, turn.y, turn.z, turn.w};
  }
  nodes_.push_back(std::move(node));
  return nodes_.size() - 1;
}

std::string GltfDocument::bytes(const std::string& scene_name) const {
  Json nodes = nodes_, children = Json::array();
  for (std::size_t node = 0; node < nodes_.size(); ++node) children.push_back(node);
  const double half = std::sqrt(0.5);  // a quarter turn about x
  nodes.push_back({{"name", "z up"}, {"rotation", {-half, 0.0, 0.0, half}}, {"children", children}});
  const Json document{{"asset", {{"version", "2.0"}, {"generator", "DCEM"}}},
                      {"extensionsUsed", {"KHR_materials_unlit"}},
                      {"scene", 0},
                      {"scenes", {{{"name", scene_name}, {"nodes", {nodes_.size()}}}}},
                      {"nodes", nodes},
                      {"meshes", meshes_},
                      {"materials", materials_},
                      {"accessors", accessors_},
                      {"bufferViews", views_},
                      {"buffers", {{{"byteLength", buffer_.size()}}}}};
  std::string chunks;
  append_chunk(chunks, chunk_json, document.dump(-1, ' ', false, Json::error_handler_t::replace), ' ');
  append_chunk(chunks, chunk_binary, buffer_, '\0');
  std::string file;
  append_word(file, magic_gltf);
  append_word(file, 2);
  append_word(file, chunks.size() + 12);
  return file + chunks;
}

}  // namespace dcem::io
