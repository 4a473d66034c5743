#pragma once
/// Heights of the ground from an ASCII grid of ESRI. Private to dcem::io.
#include <cstddef>
#include <filesystem>
#include <vector>

#include "dcem/io/import.hpp"
#include "dcem/io/src/import/city_plan.hpp"
#include "dcem/io/src/import/obj_draft.hpp"

namespace dcem::io {

/// Heights at the centres of cells, above the lowest of them; between four centres bilinear, beyond the rim as there.
struct Terrain {
  Vec2 low_m{0.0};   ///< centre of the south-western cell
  Vec2 cell_m{1.0};  ///< width and height of a cell
  std::size_t columns = 0, rows = 0;
  std::vector<double> heights_m;  ///< row by row from the south
  double lowest_m = 0.0;          ///< what the file says at height 0 of the scene
  std::size_t without_value = 0;  ///< cells that the file leaves open: as low as the lowest

  Vec2 high_m() const { return low_m + cell_m * Vec2(static_cast<double>(columns - 1), static_cast<double>(rows - 1)); }
  double height_m(const Vec2& point_m) const;
};

/// Reads the grid; the memory needed grows with the file, not with what its header claims. Throws InputError with the
/// line.
Terrain read_terrain(const std::filesystem::path& file);

/// Puts parts on the ground: those that touch have one foot, half a metre under the lowest corner of them all.
void settle(std::vector<TownPart>& parts, const Terrain& terrain);

/// Adds the cells that the rectangle meets, two triangles each, of the material `ground`.
void add_terrain(const Terrain& terrain, const Vec2& low_m, const Vec2& high_m, ObjDraft& obj);

}  // namespace dcem::io
