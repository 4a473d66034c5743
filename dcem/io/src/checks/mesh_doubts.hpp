#pragma once
/// Whether a mesh looks as if it were meant in another unit or another orientation. Private to dcem::io.
#include <string>
#include <vector>

#include "dcem/geometry/triangle_mesh.hpp"

namespace dcem::io {

/// What looks odd about a scene in metres and with z up as it was read, what "the mesh" is said to be, a sentence each:
/// * millimetres or centimetres taken for metres: 2 km high or more, with edges of half a kilometre or more, walls
/// among
///   them; or a storey more than 150 m high, that is a floor with walls and one ceiling that covers it;
/// * degrees of longitude and latitude taken for metres: less than 2 m wide, and ten times as high;
/// * another axis up: flattest along y by a factor of four, with most of its area facing along y, and higher than
///   150 m; or a storey on its side, closed all around, its walls 1.8 to 4.5 m apart along y and 6 m high or more.
/// Meshes of fewer than twenty triangles are taken as they are.
std::vector<std::string> mesh_doubts(const TriangleMesh& mesh);

/// The same of an object that moves: longer than 500 m.
std::vector<std::string> object_doubts(const TriangleMesh& mesh);

}  // namespace dcem::io
