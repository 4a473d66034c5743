#pragma once
/// An edge in single precision, as eight points see it: what is along and across it, what is behind its faces, and
/// where the shortest ways over it meet it.
#include <array>
#include <cmath>
#include <cstdint>

#include "dcem/core/constants.hpp"
#include "dcem/core/simd.hpp"
#include "dcem/geometry/wedge.hpp"
#include "dcem/paths/halves/lane_points.hpp"

namespace dcem {

/// An edge in single precision, with the normals of both faces.
struct LaneEdge {
  std::array<float, 3> start, direction, first_normal, last_normal;
  bool both_faces = false;  ///< in the interior is what is behind both faces; otherwise the gate does not ask

  LanePoints from_start(const LanePoints& points) const {
    return {points.x - start[0], points.y - start[1], points.z - start[2]};
  }
  /// What is across the edge of points, counted from its start, that are at a place along it.
  LanePoints across(const LanePoints& away, const Float8& place) const {
    return {away.x - place * direction[0], away.y - place * direction[1], away.z - place * direction[2]};
  }
  Float8 place(const LanePoints& away) const { return dot(away, direction[0], direction[1], direction[2]); }
  /// The lanes of points, counted from the start, that surely are behind both faces.
  std::uint32_t behind(const LanePoints& away, float error_m) const {
    if (!both_faces) return 0;
    const Float8 slack(-(error_m + 1e-3F));
    return ((dot(away, first_normal[0], first_normal[1], first_normal[2]) < slack) &
            (dot(away, last_normal[0], last_normal[1], last_normal[2]) < slack))
        .bits();
  }
};

inline LaneEdge lane_edge(const Wedge& wedge, const Vec3& origin_m) {
  const double angle_rad = wedge.exterior_angle_rad;
  const Vec3 last = std::sin(angle_rad) * wedge.tangent - std::cos(angle_rad) * wedge.normal;
  const auto floats = [](const Vec3& of) {
    return std::array{static_cast<float>(of.x), static_cast<float>(of.y), static_cast<float>(of.z)};
  };
  return {floats(wedge.start_m - origin_m), floats(edge_direction(wedge)), floats(wedge.normal), floats(last),
          angle_rad > pi};
}

inline namespace DCEM_ISA {

/// Where along an edge the shortest ways from points to the end that sees it at `own_place_m`, `own_distance_m` away,
/// meet it.
struct LaneMeeting {
  Float8 place_m, beside_m;  ///< and how far that may be off
  Float8 between_m, sum_m;   ///< of both ends, along the edge and across it

  /// The points count from the edge's start; `error_m`: how far they may be off.
  LaneMeeting(const LaneEdge& edge, float own_place_m, float own_distance_m, const LanePoints& away, float error_m)
      : place_m(0.0F), beside_m(0.0F), between_m(0.0F), sum_m(0.0F) {
    const Float8 place = edge.place(away);
    const LanePoints across = edge.across(away, place);
    sum_m = simd::square_root(across.x * across.x + across.y * across.y + across.z * across.z) + own_distance_m;
    between_m = place - own_place_m;
    const Float8 inverse = Float8(1.0F) / sum_m;
    place_m = Float8(own_place_m) + between_m * (Float8(own_distance_m) * inverse);
    beside_m = Float8(4.0F * error_m) * (Float8(1.0F) + simd::absolute(between_m) * inverse);
  }
};

/// How the length of the shortest ways over an edge, on to eight points and from there to others, changes as the points
/// move along lines of their own: cos(in) − cos(out) (paths/solve/wedge_method.hpp).
struct LaneSlope {
  LaneMeeting near;           ///< where these ways meet the edge
  Float8 slope, slope_error;  ///< per length; and how far that may be off

  /// `along`: unit vectors of the lines; `goal`: where the ways lead on to. All count from one origin, as `edge` does.
  LaneSlope(const LaneEdge& edge, float own_place_m, float own_distance_m, float error_m, const LanePoints& points,
            const LanePoints& along, const LanePoints& goal)
      : near(edge, own_place_m, own_distance_m, edge.from_start(points), error_m), slope(0.0F), slope_error(0.0F) {
    const LanePoints in = edge.across(edge.from_start(points), near.place_m), out = goal - points;
    const auto per_length = [](const LanePoints& way) {
      return Float8(1.0F) / simd::square_root(way.x * way.x + way.y * way.y + way.z * way.z);
    };
    const auto along_line = [&](const LanePoints& way) { return way.x * along.x + way.y * along.y + way.z * along.z; };
    const Float8 per_in = per_length(in), per_out = per_length(out), error(2.0F * error_m);
    slope = along_line(in) * per_in - along_line(out) * per_out;
    slope_error = Float8(2.0F) * ((near.beside_m + error) * per_in + error * per_out) + 2e-6F;
  }
};

}  // namespace DCEM_ISA

}  // namespace dcem
