#pragma once
/// One end's half of all its paths: what the end may see, its images in the mirrors among it, and the cones behind
/// them.
///
/// A half belongs to a device in a frame and serves all its links. What moves hides nothing in it: so the scenery's
/// part is worked out once for an end that stands, and only what moves is looked at in every frame.
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "dcem/paths/halves/body_elements.hpp"
#include "dcem/paths/halves/half_layer.hpp"
#include "dcem/paths/halves/place.hpp"
#include "dcem/paths/halves/sight.hpp"

namespace dcem {

class PathHalf {
 public:
  /// Pixels along a side of the view map: by measurement for ends at street level.
  static constexpr int default_pixels = 256;

  explicit PathHalf(int map_pixels = default_pixels) : map_pixels_(map_pixels), own_sight_(map_pixels) {}

  /// Works out what the end may see of the scenery. `pool`: as in `Sight`.
  void find_scenery(const Scene& scene, const FacetOutlines& outlines, const LinkEnd& end, const HalfSettings& settings,
                    ThreadPool* pool = nullptr);
  /// Takes what may be seen of the scenery from the place that the end is in, which must stay as long as the half uses
  /// it. Images in mirrors of the scenery are laid out when they are asked for.
  void take_scenery(const Scene& scene, const FacetOutlines& outlines, const LinkEnd& end, const HalfSettings& settings,
                    const Place& place);
  /// Lays out the images in all mirrors of the scenery, where they are not yet.
  void lay_out_images(const Scene& scene, const FacetOutlines& outlines);
  /// The same of all other bodies, where they are now. The scenery must be known. `moved`, by body: which of them have
  /// moved since the frame before; empty: all. `pool`: as in `BodyReach::find`.
  void find_bodies(const Scene& scene, const FacetOutlines& outlines, const HalfSettings& settings,
                   std::span<const char> moved = {}, ThreadPool* pool = nullptr);

  /// From now on several threads may ask what is hidden, until the end looks again.
  void settle() {
    if (place_ == nullptr) own_sight_.settle_map();
  }

  int map_pixels() const { return map_pixels_; }
  const Vec3& position_m() const { return position_m_; }
  /// The body that is not there for the end.
  const std::optional<BodyId>& ignored_body() const { return ignored_body_; }
  const Sight& sight() const { return place_ != nullptr ? place_->sight() : own_sight_; }
  /// That of the scenery, that of bodies that have moved, and that of the other bodies.
  std::span<const HalfLayer, 3> layers() const { return layers_; }

  /// The bodies of a layer but the first, one by one …
  const BodyElements& bodies_of(std::size_t layer) const { return bodies_[layer - 1]; }
  /// … and the mirrors of the scenery that may light one.
  std::span<const std::uint32_t> mirrors_lighting(BodyId body) const { return reach_.mirrors_lighting(body); }

  /// The image in a mirror of the scenery, and what it may see through the mirror; `scratch` may hold that.
  Vec3 image_m(const Scene& scene, std::size_t at) const {
    return has_images_ ? layers_[0].images_m[at] : mirrored(scene.facet(layers_[0].mirrors[at]).plane, position_m_);
  }
  std::span<const HalfSpace> cone(const Scene& scene, const FacetOutlines& outlines, std::size_t at,
                                  std::vector<HalfSpace>& scratch) const {
    if (has_images_) return layers_[0].cones[at];
    const WorldFacet& facet = scene.facet(layers_[0].mirrors[at]);
    scratch.clear();
    add_cone(outlines.middle_m(), mirrored(facet.plane, position_m_), facet.plane, scene.hull_m(facet), scratch);
    return scratch;
  }

  /// Whether the end surely cannot see a point that lies on a facet, or on an edge.
  template <typename Element>
  bool hides(const Scene& scene, const FacetOutlines& outlines, Element element, const Vec3& point_m) const {
    return sight().map().hides(point_m, nearer_on(scene, outlines, element));
  }

 private:
  double nearer_on(const Scene& scene, const FacetOutlines& outlines, FacetId mirror) const {
    return sight().nearer_on(scene, outlines, mirror, 0.0, &position_m_);
  }
  double nearer_on(const Scene& scene, const FacetOutlines& outlines, WedgeId edge) const {
    return sight().nearer_on(scene, outlines, edge, &position_m_);
  }
  void note(const LinkEnd& end) {
    position_m_ = end.position_m;
    ignored_body_ = end.ignored_body;
  }

  int map_pixels_;
  Sight own_sight_;
  const Place* place_ = nullptr;  ///< none: the end looks itself
  bool has_images_ = false;       ///< those in mirrors of the scenery
  bool has_pairs_ = true;         ///< as in `HalfSettings`
  Vec3 position_m_{0.0};
  std::optional<BodyId> ignored_body_;
  std::array<HalfLayer, 3> layers_;
  std::array<BodyElements, 2> bodies_;
  BodyReach reach_;
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/halves/path_half_bodies.hpp"
#endif
