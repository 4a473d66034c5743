#pragma once
/// What an end may send on to over one of its edges, as an image of the edge.
///
/// A way from an end over the point t of an edge goes on along Keller's cone: with the end at the place t_E along the
/// edge's line and ρ_E from it, the way of azimuth φ is at z = t + (t − t_E) ρ/ρ_E along the edge where it is ρ from
/// its line (J. B. Keller, "Geometrical theory of diffraction", J. Opt. Soc. Am. 52, 116, 1962). So through each point
/// off the line leads one way, of one t and one φ, and the ways over all of the edge make an image like that of a
/// camera: t and φ are its coordinates, ρ its depth. A half plane φ = const cuts a convex outline in one piece, and the
/// plane N·X = D, in the edge's frame, has there the nearness
///   1/ρ = (N₁ cos φ + N₂ sin φ + N₃ (t − t_E)/ρ_E) / (D − N₃ t).
/// The way of a path that leaves the edge for a mirror is one of these: a mirror that the image hides carries no path
/// over this edge. Guards, and the reason of each: docs/design/exact_search.md.
#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "dcem/geometry/aabb.hpp"
#include "dcem/geometry/plane.hpp"
#include "dcem/geometry/wedge.hpp"
#include "dcem/paths/halves/edge_parts.hpp"
#include "dcem/paths/halves/keller_kernels.hpp"
#include "dcem/paths/halves/may_face.hpp"

namespace dcem {

namespace detail {

/// The azimuth of a direction, in columns of a full turn: see `column_error`.
inline float rough_column(float x, float y) {
  constexpr double per_rad = KellerCells::columns / (2.0 * pi);
  const double off_rad = rough_angle_rad(std::abs(static_cast<double>(x)) + 1e-30, std::abs(static_cast<double>(y)));
  const double half_rad = x < 0.0F ? pi - off_rad : off_rad;
  return static_cast<float>(per_rad * (y < 0.0F ? -half_rad : half_rad));
}

}  // namespace detail

/// Holds scratch memory: one per thread.
class KellerView {
 public:
  KellerView();

  /// Looks from the parts of one edge that an end sees, of which there is one at least, ascending.
  void look_from(const Wedge& edge, std::span<const EdgePart> parts);

  /// Whether nothing in a box may be seen, but for planes that the edge grazes.
  bool hides(const Aabb<double>& box) const;
  /// Looks at a convex plane outline: the cells along the edge, a bit for each, from which it may be seen. What is no
  /// farther in front of it than `lift_m` does not hide it.
  std::uint32_t look_at(std::span<const Vec3> corners_m, const Plane& plane, double lift_m);
  /// Notes an outline that hides what is behind it, but for what is no farther from its plane than `lift_m`; what hides
  /// is at most `stray_m` off the plane.
  void cover(std::span<const Vec3> corners_m, const Plane& plane, double lift_m, double stray_m);

  /// Where a cell begins and ends along the edge.
  float from_m(std::uint32_t cell) const { return cells_.from_m[cell]; }
  float to_m(std::uint32_t cell) const { return cells_.to_m[cell]; }
  /// Where what is looked from begins and ends.
  Vec3 first_m() const { return start_m_ + static_cast<double>(first()) * axes_[2]; }
  Vec3 last_m() const { return start_m_ + static_cast<double>(last()) * axes_[2]; }

 private:
  float first() const { return cells_.from_m[0]; }
  float last() const { return cells_.to_m[cells_.rows - 1]; }
  void open_cells(const Wedge& edge, std::span<const EdgePart> parts);
  /// False where an outline has too many corners.
  bool place(std::span<const Vec3> corners_m);
  void measure();
  void place_plane(const Plane& plane, double lift_m);
  /// Where it counts as nearer, or as farther, by the share of its distance that these are.
  void count_nearer(double by_m);
  void find_columns();
  void find_close();
  /// Whether no way over what is looked from leads into the outline, as its corners say.
  bool is_beside() const;
  bool is_too_small() const;

  Vec3 start_m_{0.0};
  std::array<Vec3, 3> axes_{};  ///< of the edge's frame
  KellerCells cells_;
  KellerOutline outline_;
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/halves/keller_view_bodies.hpp"
#include "dcem/paths/halves/keller_view_outlines_bodies.hpp"
#endif
