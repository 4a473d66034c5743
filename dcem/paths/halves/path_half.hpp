#pragma once
/// One end's half of all its paths: what the end may see, its images in the mirrors among it, and the cones behind
/// them.
///
/// A half belongs to a device in a frame and serves all its links. What moves hides nothing in it: so the scenery's
/// part is worked out once for an end that stands, and only what moves is looked at in every frame.
#include <array>
#include <span>

#include "dcem/paths/halves/half_layer.hpp"
#include "dcem/paths/halves/sight.hpp"

namespace dcem {

class PathHalf {
 public:
  /// Pixels along a side of the view map: by measurement for ends at street level.
  static constexpr int default_pixels = 256;

  explicit PathHalf(int map_pixels = default_pixels) : sight_(map_pixels) {}

  /// Works out what the end may see of the scenery.
  void find_scenery(const Scene& scene, const FacetOutlines& outlines, const LinkEnd& end,
                    const HalfSettings& settings) {
    sight_.look_from(end);
    sight_.find_scenery(scene, outlines, settings, layers_[0]);
    layers_[0].lay_out(scene, position_m(), outlines.middle_m());
  }
  /// The same of all other bodies, where they are now. The scenery must be known.
  void find_bodies(const Scene& scene, const FacetOutlines& outlines, const HalfSettings& settings) {
    sight_.find_bodies(scene, outlines, settings, layers_[1]);
    layers_[1].lay_out(scene, position_m(), outlines.middle_m());
  }

  const Vec3& position_m() const { return sight_.position_m(); }
  const Sight& sight() const { return sight_; }
  /// That of the scenery, and that of what moves.
  std::span<const HalfLayer, 2> layers() const { return layers_; }

  /// Whether the end surely cannot see a point that lies on a facet, or on an edge.
  template <typename Element>
  bool hides(const Scene& scene, const FacetOutlines& outlines, Element element, const Vec3& point_m) const {
    return sight_.map().hides(point_m, sight_.nearer_on(scene, outlines, element));
  }

 private:
  Sight sight_;
  std::array<HalfLayer, 2> layers_;
};

}  // namespace dcem
