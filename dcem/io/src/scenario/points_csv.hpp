#pragma once
/// Points as a table: `x_m,y_m,z_m`, one row per point. Private to dcem::io.
#include <filesystem>
#include <vector>

#include "dcem/geometry/vector.hpp"

namespace dcem::io {

/// The points in the order of the rows. Columns are found by name, others are passed over, so that a map's own table
/// will do. Throws InputError with the line.
std::vector<Vec3> read_points_csv(const std::filesystem::path& file);

}  // namespace dcem::io
