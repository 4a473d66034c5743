#pragma once
/// Outlines of buildings and forests in the plane, and what is asked of GEOS about them. Private to dcem::io.
///
/// All coordinates are metres, x east, y north. Without GEOS every function but `outline_library` throws
/// std::logic_error: importers ask `can_shape_outlines` first.
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "dcem/geometry/vector.hpp"

namespace dcem::io {

/// Corners in turn; the first is not repeated at the end.
using Ring = std::vector<Vec2>;

/// A polygon with holes: the outer ring counterclockwise, the holes clockwise, none touching itself. A hole may touch
/// another ring in a corner.
struct Area {
  Ring outer;
  std::vector<Ring> holes;
  bool operator==(const Area&) const = default;
};
using Areas = std::vector<Area>;

/// Corners of all outlines come to lie on a grid of this spacing: well above the weld tolerance of scenes, far below
/// what an outline is worth.
inline constexpr double outline_grid_m = 0.0005;

bool can_shape_outlines();
/// "GEOS 3.11.1", or that there is none.
std::string outline_library();

/// Rings as found, made into polygons: what crosses itself is cut at the crossings, corners that hardly change the
/// outline (2 cm) are left out. Empty where nothing with an area is left.
struct ShapedOutline {
  Areas areas;
  bool was_crossed = false;
};
ShapedOutline shape_outline(const std::vector<Ring>& outers, const std::vector<Ring>& inners);

/// Moves corners onto corners and edges of other outlines where those are no further away than `tolerance_m`. Returns
/// how many outlines changed.
std::size_t snap_outlines(std::vector<Areas>& outlines, double tolerance_m);

/// A piece of the plane that no outline crosses, and which outlines it lies in (none: a courtyard).
struct PlanePiece {
  Area area;
  std::vector<std::size_t> inside_of;
};
/// Cuts the plane along all outlines. Neighbouring pieces have the same corners along their common border.
std::vector<PlanePiece> cut_plane(const std::vector<Areas>& outlines);

/// The union of pieces of one `cut_plane`; corners on the rim stay, also those in the midst of straight edges.
Areas unite_pieces(const std::vector<Area>& pieces);

/// What is left of each outline without the others. Those that are far away cost nothing.
void subtract_outlines(std::vector<Areas>& outlines, const std::vector<Areas>& others);

/// Takes a regular octagon about each point out of the outlines.
void part_corners(std::vector<Areas>& outlines, const std::vector<Vec2>& points_m, double radius_m);

/// Triangles, counterclockwise, that use every corner of the area and no other point.
std::vector<std::array<Vec2, 3>> triangulate(const Area& area);

/// The smallest rectangle around a ring, whatever its direction.
struct TurnedRectangle {
  Vec2 centre_m{0.0};
  double length_m = 0.0, width_m = 0.0;  ///< length ≥ width
  double yaw_rad = 0.0;                  ///< of the length, from x towards y, in [0, π)
};
TurnedRectangle rectangle_around(const Ring& ring);

/// Of the ring, positive where it runs counterclockwise.
double signed_area_m2(const Ring& ring);
double area_m2(const Area& area);
double area_m2(const Areas& areas);
double perimeter_m(const Area& area);
bool holds_point(const Area& area, const Vec2& point_m);

}  // namespace dcem::io
