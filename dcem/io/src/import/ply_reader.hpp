#pragma once
/// Stanford PLY meshes, text and binary (little endian). Private to dcem::io.
#include <cstddef>
#include <filesystem>
#include <vector>

#include "dcem/geometry/vector.hpp"

namespace dcem::io {

struct PlyMesh {
  std::vector<Vec3> vertices_m;
  std::vector<std::vector<std::size_t>> faces;  ///< at least three corners each
  std::size_t faces_without_area = 0;           ///< of fewer corners: left out
};

/// Reads positions and faces; other properties and elements are passed over. The memory needed grows with the file, not
/// with what its header claims. Throws InputError, with the line where there are lines.
PlyMesh read_ply(const std::filesystem::path& file);

}  // namespace dcem::io
