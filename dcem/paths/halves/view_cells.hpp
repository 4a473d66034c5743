#pragma once
/// Which outlines are seen in which part of a view: each face of the cube in eight by eight cells.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "dcem/paths/halves/face_outline.hpp"
#include "dcem/paths/halves/view_frame.hpp"

namespace dcem::detail {

class ViewCells {
 public:
  static constexpr int to_a_side = 8;
  static constexpr int count = 6 * to_a_side * to_a_side;

  /// Empties the cells, which from now on are those around another point.
  void look_from(const Vec3& point_m) {
    from_m_ = point_m;
    cells_.resize(count);
    for (std::vector<std::uint32_t>& cell : cells_) cell.clear();
  }

  /// Notes in which cells a convex polygon may be seen. False where nothing can be said: it has too many corners, or is
  /// too close to the point.
  bool add(std::uint32_t number, std::span<const Vec3> corners_m) {
    if (corners_m.size() > FaceOutline::most_corners) return false;
    for (int face = 0; face < faces_.count(); ++face) {
      if (!add_on(face, number, corners_m)) return false;
    }
    return true;
  }

  /// The numbers of the polygons that may be seen in a cell, ascending as they were added.
  std::span<const std::uint32_t> in(int cell) const { return cells_[static_cast<std::size_t>(cell)]; }

  /// The corners of a cell, in order around it, on the cube that reaches 1 m from the point.
  std::array<Vec3, 4> corners_m(int cell) const {
    const int face = cell / (to_a_side * to_a_side), line = cell / to_a_side % to_a_side, column = cell % to_a_side;
    const auto corner_m = [&](int across, int along) {
      const int axis = face / 2;
      Vec3 offset_m(0.0);
      offset_m[axis] = face % 2 == 0 ? 1.0 : -1.0;
      offset_m[(axis + 1) % 3] = 2.0 * across / to_a_side - 1.0;
      offset_m[(axis + 2) % 3] = 2.0 * along / to_a_side - 1.0;
      return from_m_ + offset_m;
    };
    return {corner_m(column, line), corner_m(column + 1, line), corner_m(column + 1, line + 1),
            corner_m(column, line + 1)};
  }

 private:
  bool add_on(int face, std::uint32_t number, std::span<const Vec3> corners_m) {
    FaceOutline outline;
    for (const Vec3& corner_m : corners_m) outline.add(faces_.point(face, corner_m - from_m_));
    outline.clip(1.0 + 1e-6);
    constexpr double infinity = std::numeric_limits<double>::infinity();
    std::array<double, 2> low{infinity, infinity}, high{-infinity, -infinity};
    for (std::size_t index = 0; index < outline.size(); ++index) {
      if (!(outline[index].depth > 1e-3)) return false;
      const std::array<double, 2> seen{outline[index].across / outline[index].depth,
                                       outline[index].along / outline[index].depth};
      for (const std::size_t axis : {0U, 1U}) {
        low[axis] = std::min(low[axis], seen[axis]);
        high[axis] = std::max(high[axis], seen[axis]);
      }
    }
    for (int line = cell_at(low[1] - slack); line <= cell_at(high[1] + slack); ++line) {
      for (int column = cell_at(low[0] - slack); column <= cell_at(high[0] + slack); ++column) {
        cells_[static_cast<std::size_t>((face * to_a_side + line) * to_a_side + column)].push_back(number);
      }
    }
    return true;
  }
  static int cell_at(double place) {
    return std::clamp(static_cast<int>(std::floor((place + 1.0) * 0.5 * to_a_side)), 0, to_a_side - 1);
  }

  static constexpr double slack = 1e-6;  ///< for rounding: what is on a line between two cells is in both

  ViewFaces faces_;
  Vec3 from_m_{0.0};
  std::vector<std::vector<std::uint32_t>> cells_;
};

}  // namespace dcem::detail
