#pragma once
/// Paths, edges and boxes as plain Wavefront OBJ, to be looked at in any viewer.
#include <limits>
#include <ostream>
#include <span>

#include "dcem/field/path_contribution.hpp"
#include "dcem/geometry/aabb.hpp"
#include "dcem/geometry/wedge.hpp"
#include "dcem/paths/path.hpp"

namespace dcem::debug {

inline void write_vertex(std::ostream& out, const Vec3& point_m) {
  const auto before = out.precision(std::numeric_limits<double>::max_digits10);
  out << "v " << point_m.x << ' ' << point_m.y << ' ' << point_m.z << '\n';
  out.precision(before);
}

/// One polyline through the two ends and all points of a path. Vertices are numbered from the end of the file (negative
/// indices), so pieces can be written one after the other.
inline void write_path(std::ostream& out, const Path& path, const Vec3& transmitter_m, const Vec3& receiver_m) {
  out << "o path_" << (path.interactions.empty() ? "LOS" : kinds(path)) << '\n';
  write_vertex(out, transmitter_m);
  for (const Interaction& interaction : path.interactions) write_vertex(out, interaction.point_m);
  write_vertex(out, receiver_m);
  const auto count = static_cast<int>(path.interactions.size() + 2);
  out << 'l';
  for (int index = -count; index < 0; ++index) out << ' ' << index;
  out << '\n';
}

/// A diffracting edge as one line from start to end: `wedge` between two facets, `free_edge` at a rim.
inline void write_wedge(std::ostream& out, const Wedge& wedge) {
  out << "o " << (is_free(wedge) ? "free_edge" : "wedge") << '\n';
  write_vertex(out, wedge.start_m);
  write_vertex(out, wedge.end_m);
  out << "l -2 -1\n";
}

/// The twelve edges of a box.
inline void write_box(std::ostream& out, const Aabb<double>& box) {
  out << "o box\n";
  for (int corner = 0; corner < 8; ++corner) {
    write_vertex(out, {(corner & 1) ? box.max.x : box.min.x, (corner & 2) ? box.max.y : box.min.y,
                       (corner & 4) ? box.max.z : box.min.z});
  }
  for (int corner = 0; corner < 8; ++corner) {
    for (int axis = 1; axis < 8; axis *= 2) {
      if (!(corner & axis)) out << "l " << corner - 8 << ' ' << (corner | axis) - 8 << '\n';
    }
  }
}

}  // namespace dcem::debug
