#pragma once
/// Scenes of Mitsuba as Sionna RT writes them: shapes with radio materials. Private to dcem::io.
#include <filesystem>
#include <glm/mat4x4.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace dcem::io {

/// What a `string` or a `float` says.
template <typename Value>
struct MitsubaEntry {
  Value value{};
  std::size_t line = 0;
};

/// A `bsdf`: what it says of radio, and nothing of light.
struct MitsubaMaterial {
  std::string type;  ///< "itu-radio-material", "radio-material", "twosided", …
  std::size_t line = 0;
  std::map<std::string, MitsubaEntry<std::string>> words;
  std::map<std::string, MitsubaEntry<double>> numbers;
};

struct MitsubaShape {
  std::string type, id;
  std::size_t line = 0;
  std::string file;      ///< of `ply`, as it stands there
  std::string material;  ///< id of a material
  glm::dmat4 to_world{1.0};
};

struct MitsubaScene {
  std::map<std::string, MitsubaMaterial> materials;  ///< by id
  std::vector<MitsubaShape> shapes;
};

/// Throws InputError with the line.
MitsubaScene read_mitsuba_scene(const std::filesystem::path& file);

}  // namespace dcem::io
