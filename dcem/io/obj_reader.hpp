#pragma once
/// Wavefront OBJ and MTL, read in double.
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "dcem/em/surface/material.hpp"
#include "dcem/geometry/triangle_mesh.hpp"

namespace dcem::io {

/// Which axis of the file points up; `y` turns the file's (x, y, z) into (x, −z, y).
enum class UpAxis { z, y };

struct ObjSettings {
  UpAxis up = UpAxis::z;
  double unit_m = 1.0;  ///< length of one file unit, metres
};

/// The `em_*` keys of one `newmtl` block, as text, with the line that each stands in.
struct MtlMaterial {
  struct Entry {
    std::string value;
    std::size_t line = 0;
  };
  std::string file;
  std::size_t line = 0;  ///< of `newmtl`
  std::map<std::string, Entry> em_keys;
};

struct ObjFile {
  TriangleMesh mesh;
  std::map<std::string, MtlMaterial> materials;  ///< by name
  std::map<std::string, std::size_t> used_at;    ///< line of the first `usemtl` of each material
  std::vector<std::string> warnings;             ///< one line each: what was odd but survived
};

/// Reads an OBJ file and the MTL files it names. Polygons are cut into triangles. Throws InputError with file and line.
ObjFile read_obj(const std::filesystem::path& file, const ObjSettings& settings = {});

/// The electromagnetic material that a name and its `em_*` keys define: keys first, then an `itu_*` name; absent where
/// neither says anything. Throws InputError on an unknown key or an impossible value.
std::optional<Material> material_from_mtl(const std::string& name, const MtlMaterial* mtl);

}  // namespace dcem::io
