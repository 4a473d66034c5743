#pragma once
/// What a point, or any of a few points side by side, may see: mirrors and edges of a scene.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "dcem/paths/halves/facet_outlines.hpp"
#include "dcem/paths/halves/half_settings.hpp"
#include "dcem/paths/halves/may_face.hpp"
#include "dcem/paths/halves/mirror_beam.hpp"
#include "dcem/paths/halves/view_cells.hpp"
#include "dcem/paths/halves/view_map.hpp"
#include "dcem/paths/query/link_end.hpp"

namespace dcem {

class ThreadPool;

class Sight {
 public:
  /// A leg that grazes a mirror may ignore what lies along it for a long way. Facets for which that is a larger share
  /// of the way are looked at one by one, whatever hides the box they are in.
  static constexpr double longest_lift_share = 0.005;
  /// By which factor boxes count as nearer, for all other facets.
  static constexpr double nearer_boxes = 1.0 / (1.0 - longest_lift_share);

  explicit Sight(int map_pixels) : map_(map_pixels) {}

  /// Looks from one end. `pool`: empties the map; none: the calling thread does.
  void look_from(const LinkEnd& end, ThreadPool* pool = nullptr);
  /// Looks from several points at once, which ride on nothing and touch nothing.
  void look_from(std::span<const Vec3> points_m);
  /// Looks from all of a convex body at once, of which these are the corners; what stands in it may touch things.
  void look_from_within(std::span<const Vec3> corners_m);
  /// Looks from an end's image through the mirror that it is in: at what is beyond the mirror, as seen from the image.
  /// The image must not lie in the mirror's plane.
  void look_through(const Scene& scene, const FacetOutlines& outlines, FacetId mirror, const Vec3& image_m,
                    const std::optional<BodyId>& ignored_body);
  /// The same of the images of several points, which ride on nothing, on one side of the mirror; of `all_between` them:
  /// of the convex body of which they are the corners.
  void look_through(const Scene& scene, const FacetOutlines& outlines, FacetId mirror, std::span<const Vec3> images_m,
                    bool all_between = false);

  /// Works out what may be seen of the scenery. `pool`: looks at several faces, and into many cells, at once; none: the
  /// calling thread does.
  void find_scenery(const Scene& scene, const FacetOutlines& outlines, const HalfSettings& settings, SeenLayer& layer,
                    ThreadPool* pool = nullptr);
  /// The same, looking all around, in so many steps, numbered from 0, one after the other.
  static constexpr int scenery_steps = 6;
  void find_scenery_step(int step, const Scene& scene, const FacetOutlines& outlines, const HalfSettings& settings,
                         SeenLayer& layer);
  /// The same of bodies, where they are now. The scenery must be known.
  void find_bodies(const Scene& scene, const FacetOutlines& outlines, const HalfSettings& settings,
                   const BodyChoice& bodies, SeenLayer& layer) const;

  /// All facets that may be seen, of the scenery and, where they are asked for, of bodies.
  void find_facets(const Scene& scene, const FacetOutlines& outlines, const HalfSettings& settings, bool bodies,
                   std::vector<FacetId>& seen);
  /// Whether a piece of an edge, or a bit of it, may be seen.
  bool shows(const Scene& scene, const FacetOutlines& outlines, WedgeId edge, const Vec3& from_m,
             const Vec3& to_m) const {
    return map_.shows(from_m, to_m, nearer_on(scene, outlines, edge));
  }

  /// From now on several threads may ask what is seen.
  void settle_map() { map_.settle(); }
  /// Ends looking, too: frees what only that needs.
  void settle() {
    settle_map();
    seen_ = std::vector<unsigned char>();
    grazed_ = std::vector<FacetId>();
    found_ = {};
    shown_ = std::vector<char>();
    cells_ = {};
    cell_map_.reset();
  }

  /// Where the map is made: the point, or the middle of the points.
  const Vec3& position_m() const { return map_.from_m(); }
  const ViewMap& map() const { return map_; }

  /// By which factor a point of a facet or an edge counts as nearer, so that nothing that its legs ignore hides it.
  /// `end_m`: to whom, of a view from several points one of them or between them; null: to all.
  double nearer_on(const Scene& scene, const FacetOutlines& outlines, FacetId facet, double more_m = 0.0,
                   const Vec3* end_m = nullptr) const {
    const double distance_m = distance_of(end_m, scene.facet(facet).plane);
    const double lift_m = outlines.of(facet).lift_m + more_m;
    if (points_m_.size() == 1) {
      return distance_m > 2.0 * lift_m ? distance_m / (distance_m - lift_m) : ViewMap::always_seen;
    }
    // Of two points an outline hides something farther along the leg of one than along that of the other, but by less
    // than twice: it is no nearer to one point than half its distance from the middle.
    // So from two lifts on; all points of a view are taken at their word farther away alone.
    const double fewest = end_m != nullptr ? 4.0 : 100.0;
    return distance_m > fewest * lift_m ? 1.0 / (1.0 - 2.0 * lift_m / distance_m) : ViewMap::always_seen;
  }
  double nearer_on(const Scene& scene, const FacetOutlines& outlines, WedgeId edge, const Vec3* end_m = nullptr) const {
    const WorldWedge& wedge = scene.wedge(edge);
    // The edge may lie on one side of a face's plane, and triangles of the face on the other.
    const auto on = [&](FacetId face) {
      return nearer_on(scene, outlines, face, wedge.edge.stray_m + outlines.of(face).stray_m, end_m);
    };
    return std::max(on(wedge.facets[0]), on(wedge.facets[1]));
  }

 private:
  /// A cell with fewer facets is not looked into: it takes longer than it saves.
  static constexpr std::size_t crowded = 24;
  static constexpr int most_cell_pixels = 512;
  /// What images and points may be off by, far above rounding.
  static constexpr double in_reach_m = 0.01;

  /// By how much more than for one point a lift counts: see `nearer_on`.
  double lift_share() const { return points_m_.size() == 1 ? 1.0 : 2.0; }
  /// How close to a plane any of the points may be.
  double least_distance_m(const Plane& plane) const {
    const double middle_m = std::abs(signed_distance_m(plane, position_m()));
    if (points_m_.size() == 1) return middle_m;
    if (middle_m > 2.0 * radius_m_) return middle_m - radius_m_;
    double lowest_m = std::numeric_limits<double>::infinity(), highest_m = -lowest_m, least_m = lowest_m;
    for (const Vec3& point_m : points_m_) {
      const double distance_m = signed_distance_m(plane, point_m);
      lowest_m = std::min(lowest_m, distance_m);
      highest_m = std::max(highest_m, distance_m);
      least_m = std::min(least_m, std::abs(distance_m));
    }
    return is_body_ && lowest_m <= 0.0 && highest_m >= 0.0 ? 0.0 : least_m;
  }
  /// How close to a plane one point is, or, null, any of them.
  double distance_of(const Vec3* end_m, const Plane& plane) const {
    return end_m != nullptr ? std::abs(signed_distance_m(plane, *end_m)) : least_distance_m(plane);
  }
  /// One point, or, null, all of them.
  std::span<const Vec3> points_or(const Vec3* end_m) const {
    return end_m != nullptr ? std::span(end_m, 1) : std::span(points_m_);
  }
  /// Whether a facet is grazed so that a point of it, lifted, is farther in front than boxes allow for.
  bool is_lifted_far(const Scene& scene, const FacetOutlines& outlines, FacetId id, const Vec3* end_m = nullptr) const {
    const double lift_m = lift_share() * outlines.of(id).lift_m;
    return distance_of(end_m, scene.facet(id).plane) * longest_lift_share <= lift_m;
  }
  /// Whether all points are above the feet of the façades that stand on the lowest level of the scenery.
  bool is_above_feet(const FacetOutlines& outlines) const {
    return std::all_of(points_m_.begin(), points_m_.end(), [&](const Vec3& point_m) {
      return point_m.z > outlines.feet().lowest_m() + FacetFeet::least_height_m;
    });
  }
  /// Bodies may reach under what stands on that level, and edges where planes cross.
  void hide_nothing_below_feet(const FacetOutlines& outlines, ViewMap& map) const {
    if (hides_under_feet_) map.hide_nothing_below(below_feet_m(outlines));
  }
  static double below_feet_m(const FacetOutlines& outlines) { return outlines.feet().lowest_m() - 1e-9; }
  /// Whether a facet, or an edge of it, may be seen under feet.
  bool reaches_under_feet(const FacetOutlines& outlines, FacetId id) const {
    return hides_under_feet_ && outlines.of(id).box.min.z < below_feet_m(outlines);
  }
  void take_points(std::span<const Vec3> points_m, const Vec3& middle_m);
  using FaceSpan = ViewMap::FaceSpan;
  void look_at_scenery(const Scene& scene, const FacetOutlines& outlines, const HalfSettings& settings,
                       std::vector<FacetId>& seen, ThreadPool* pool);
  void begin_looking(const Scene& scene, const FacetOutlines& outlines, const HalfSettings& settings);
  void look_at_face(const Scene& scene, const FacetOutlines& outlines, const HalfSettings& settings, int face);
  void gather_faces(std::vector<FacetId>& seen);
  void look_at_each_face(const Scene& scene, const FacetOutlines& outlines, const HalfSettings& settings,
                         ThreadPool* pool);
  /// On some faces of the map.
  void look_at_faces(const Scene& scene, const FacetOutlines& outlines, const HalfSettings& settings,
                     const FaceSpan& faces, std::vector<FacetId>& seen);
  void look_at_bodies(const Scene& scene, const FacetOutlines& outlines, const BodyChoice& bodies,
                      std::vector<FacetId>& seen) const;
  bool may_see(const Scene& scene, const FacetOutlines& outlines, FacetId id, const FaceSpan& faces = {},
               const Vec3* end_m = nullptr) const;
  /// How many of some facets are not wider than a few pixels of the map: those that others hide only in finer ones.
  std::size_t count_small(const FacetOutlines& outlines, std::span<const FacetId> seen) const;
  /// Where it pays.
  void look_closer(const Scene& scene, const FacetOutlines& outlines, const HalfSettings& settings,
                   std::vector<FacetId>& seen, ThreadPool* pool);
  void look_into_all(const Scene& scene, const FacetOutlines& outlines, const HalfSettings& settings,
                     std::span<const FacetId> seen, ThreadPool* pool);
  void look_into(const Scene& scene, const FacetOutlines& outlines, const HalfSettings& settings, int cell,
                 std::span<const FacetId> seen, ViewMap& map);
  void cover(const Scene& scene, const FacetOutlines& outlines, FacetId id, const HalfSettings& settings, ViewMap& map,
             const FaceSpan& faces = {}) const;
  void cover_as_whole(const Scene& scene, const FacetOutlines& outlines, FacetId id, const HalfSettings& settings,
                      ViewMap& map, const FaceSpan& faces) const;
  std::span<const Vec3> deepened(const Scene& scene, const FacetOutlines& outlines, FacetId id, const ViewMap& map,
                                 detail::InsetOutline& deep) const;
  /// The plane of a facet where it is farthest.
  Plane farthest_plane(const WorldFacet& facet, const FacetOutline& outline) const;
  /// Whether its hull hides all behind it: it is opaque, no end that touches it looks past it, and where a mirror is
  /// looked through it is beyond that.
  bool hides_as_whole(const Scene& scene, const FacetOutlines& outlines, FacetId id,
                      const HalfSettings& settings) const {
    const WorldFacet& facet = scene.facet(id);
    const FacetOutline& outline = outlines.of(id);
    if (!hides_as_hull(outline) || (facet.transmits && settings.sheets > 0)) return false;
    if (least_distance_m(facet.plane) <= 2.0 * outline.lift_m) return false;
    return !beam_ || beam_->is_occluder(scene.hull_m(facet), outline.stray_m);
  }
  static void count_sheets(const Scene& scene, const HalfSettings& settings, ViewMap& map);
  /// `sheet`: its plane, where it is a sheet that a path may cross; null: nothing passes.
  void cover_beyond(std::span<const Vec3> corners_m, const Plane& plane, const Plane* sheet, ViewMap& map,
                    const FaceSpan& faces) const;
  /// Whether all points are in a facet's plane: nothing is reflected there, though its edges may diffract.
  static bool are_along(std::span<const Vec3> points_m, const Plane& plane) {
    return std::all_of(points_m.begin(), points_m.end(), [&](const Vec3& point_m) {
      return std::abs(signed_distance_m(plane, point_m)) <= in_plane_guard_m;
    });
  }
  /// Whether all of a box is farther away than anything that is looked for.
  bool is_beyond(const Aabb<double>& box) const {
    const Vec3 away_m = glm::clamp(position_m(), box.min, box.max) - position_m();
    return glm::dot(away_m, away_m) > reach_m_ * reach_m_;
  }
  /// Whether nothing in a box is looked for: it is too far away, or beside the mirror that is looked through.
  bool is_out_of_view(const Aabb<double>& box) const { return is_beyond(box) || (beam_ && beam_->is_beside(box)); }
  /// Whether all points are between the faces of a wedge, where it is solid.
  static bool are_inside(std::span<const Vec3> points_m, const Wedge& wedge) {
    return std::none_of(points_m.begin(), points_m.end(),
                        [&](const Vec3& point_m) { return may_face(wedge, point_m - wedge.start_m); });
  }
  /// `pool`: asks about the edges, of a map that is settled; none: the calling thread does.
  void finish(const Scene& scene, const FacetOutlines& outlines, const HalfSettings& settings, SeenLayer& layer,
              ThreadPool* pool = nullptr, const Vec3* end_m = nullptr) const;

  ViewMap map_;
  std::vector<Vec3> points_m_, offsets_m_;  ///< of several: from their middle
  Vec3 middle_m_{0.0};
  std::optional<MirrorBeam> beam_;                            ///< where a mirror is looked through
  double radius_m_ = 0.0;                                     ///< how far points are from the middle
  double reach_m_ = std::numeric_limits<double>::infinity();  ///< from `position_m()`, with what points may be off by
  bool hides_under_feet_ = false;                             ///< nothing is seen there
  bool faces_are_old_ = false;                                ///< each is emptied before it is looked at
  bool is_body_ = false;  ///< the points are the corners of a body that is looked from
  std::optional<BodyId> ignored_body_;
  std::vector<FacetId> mounted_on_;
  std::vector<FacetId> grazed_;
  std::array<std::vector<FacetId>, 6> found_;  ///< by face
  std::vector<unsigned char> seen_;            ///< by facet, a bit for each face on which it may be seen
  detail::ViewCells cells_;
  std::optional<ViewMap> cell_map_;  ///< of one cell after the other; none where no view is looked at twice
  std::vector<char> shown_;          ///< by place among the facets that are looked at again
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/halves/sight_bodies.hpp"
#include "dcem/paths/halves/sight_closer_bodies.hpp"
#include "dcem/paths/halves/sight_covers_bodies.hpp"
#endif
