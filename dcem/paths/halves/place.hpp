#pragma once
/// A place: a box that a device is in for some frames, and what of the scenery may be seen from anywhere in it.
///
/// Bodies hide nothing in it, and what a point of the box may see is a part of what the place may: so it serves every
/// device in the box, in every frame, as long as the scenery stands.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "dcem/paths/halves/shared_beams.hpp"
#include "dcem/paths/halves/sight.hpp"
#include "dcem/paths/halves/spread_work.hpp"

namespace dcem {

/// A box that is turned about the vertical.
struct PlaceBox {
  Vec3 middle_m{0.0};
  Vec3 ahead{1.0, 0.0, 0.0};  ///< level, of unit length
  Vec3 half_m{1.0};           ///< half of its length, width and height

  Vec3 aside() const { return {-ahead.y, ahead.x, 0.0}; }

  /// Whether a point is inside, by more than rounding.
  bool holds(const Vec3& point_m) const {
    const Vec3 away_m = point_m - middle_m;
    const double hair_m = 1e-6 + 1e-12 * (std::abs(point_m.x) + std::abs(point_m.y) + std::abs(point_m.z));
    return std::abs(glm::dot(away_m, ahead)) <= half_m.x - hair_m &&
           std::abs(glm::dot(away_m, aside())) <= half_m.y - hair_m && std::abs(away_m.z) <= half_m.z - hair_m;
  }

  /// How far a point that is inside is from where it comes out if it moves on along `towards`, of unit length; 0 for
  /// one that is not inside.
  double way_out_m(const Vec3& point_m, const Vec3& towards) const;
  /// How long boxes of devices are that move so far from frame to frame: 4 m by measurement; twice as long they take
  /// longer for each metre, half as long, too. Of fast ones 6 m.
  static double length_for_m(double step_m) { return step_m < 1.0 ? 4.0 : 6.0; }

  /// Corners of the part of the box that is on one `side` (1 or −1) of a plane and not in it; none where there is no
  /// such part.
  void corners_beside(const Plane& plane, double side, std::vector<Vec3>& result_m) const;

  std::array<Vec3, 8> corners_m() const;
};

/// A mirror of a place, for what of the place is on one side of it.
struct PlaceMirror {
  FacetId facet;
  std::uint32_t number;             ///< of the facet among the mirrors of the place's scenery
  double side;                      ///< of it, 1 or −1
  Vec3 image_m;                     ///< of the middle of the place
  std::span<const HalfSpace> cone;  ///< what any image may see through the mirror, from the middle of the scene
};

class Place {
 public:
  /// Pixels along a side of the view map: those of a device (`PathHalf`).
  static constexpr int map_pixels = 256;

  /// Of which nothing is known yet; `over_mirrors`: what is seen through its mirrors is to be known, too.
  explicit Place(const PlaceBox& box, bool over_mirrors = false)
      : box_(box), corners_m_(box.corners_m()), sight_(map_pixels) {
    sight_.look_from_within(corners_m_);
    if (!over_mirrors) return;
    beams_ = std::make_unique<SharedBeams>();
    beams_->begin(true);
    steps_left_ += beam_steps;
  }
  Place(const Scene& scene, const FacetOutlines& outlines, const PlaceBox& box, const HalfSettings& settings,
        bool over_mirrors = false)
      : Place(box, over_mirrors) {
    while (!is_known()) go_on(scene, outlines, settings);
  }
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;

  /// Works out a part of what may be seen; `steps_left` of them until all is known. The settings are the same each
  /// time.
  void go_on(const Scene& scene, const FacetOutlines& outlines, const HalfSettings& settings);
  int steps_left() const { return steps_left_; }
  /// What the next part takes, and all that are left.
  int next_work() const { return work().next(steps_left_); }
  int work_left() const { return work().left(steps_left_); }
  bool is_known() const { return steps_left_ == 0; }

  const PlaceBox& box() const { return box_; }
  std::span<const Vec3, 8> corners_m() const { return corners_m_; }
  const Sight& sight() const { return sight_; }
  /// What of the scenery some point of the box may see.
  const SeenLayer& scenery() const { return scenery_; }
  /// The mirrors among it, in the same order; those whose plane cuts the box twice.
  std::span<const PlaceMirror> mirrors() const { return mirrors_; }
  /// What of the scenery some point of the box may light over these mirrors; none where that is not asked for.
  const SharedBeams* beams() const { return beams_.get(); }
  /// The images in a mirror of the corners of what of the box is on its side.
  void find_images(const Plane& plane, const PlaceMirror& mirror, std::vector<Vec3>& result_m) const;
  /// How far a point of the box may be from its middle.
  double radius_m() const { return glm::length(box_.half_m); }

 private:
  void take_mirrors(const Scene& scene, const FacetOutlines& outlines, int step);
  void look_through_mirrors(const Scene& scene, const FacetOutlines& outlines, const HalfSettings& settings, int step);

  static constexpr int mirror_steps = 2, beam_steps = 13, steps_without_beams = Sight::scenery_steps + mirror_steps;
  /// Four faces of the map, two of them, what is seen in it, its mirrors …
  static constexpr std::array<int, steps_without_beams> work_without_beams{6, 6, 6, 7, 4, 6, 6, 4};
  /// … and what is seen through these, where more is to be known of what is seen, too.
  static constexpr std::array<int, steps_without_beams + beam_steps> work_with_beams{
      4, 5, 4, 5, 3, 20, 3, 1, 115, 80, 80, 80, 80, 80, 80, 80, 80, 80, 80, 80, 80};
  WorkSteps work() const { return beams_ ? WorkSteps(work_with_beams) : WorkSteps(work_without_beams); }

  PlaceBox box_;
  std::array<Vec3, 8> corners_m_;
  Sight sight_;
  int steps_left_ = steps_without_beams;
  SeenLayer scenery_;
  std::vector<HalfSpace> planes_;
  std::vector<PlaceMirror> mirrors_;
  std::vector<std::size_t> cone_ends_;  ///< in `planes_`, until all mirrors are known
  std::unique_ptr<SharedBeams> beams_;
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/halves/place_bodies.hpp"
#endif
