#pragma once
/// Bodies of path_half.hpp.
#include "dcem/core/build_mode.hpp"
#include "dcem/paths/halves/path_half.hpp"

namespace dcem {

DCEM_INLINE void PathHalf::find_scenery(const Scene& scene, const FacetOutlines& outlines, const LinkEnd& end,
                                        const HalfSettings& settings, ThreadPool* pool) {
  note(end);
  place_ = nullptr;
  has_images_ = true;
  own_sight_.look_from(end, pool);
  own_sight_.find_scenery(scene, outlines, settings, layers_[0], pool);
  has_pairs_ = settings.pairs;
  layers_[0].lay_out(scene, position_m_, outlines.middle_m(), has_pairs_);
}

DCEM_INLINE void PathHalf::take_scenery(const Scene& scene, const FacetOutlines& outlines, const LinkEnd& end,
                                        const HalfSettings& settings, const Place& place) {
  note(end);
  has_images_ = false;
  has_pairs_ = settings.pairs;
  if (place_ == &place) {
    if (has_pairs_) layers_[0].see_edges_from(position_m_);
    return;
  }
  if (place_ == nullptr) own_sight_ = Sight(map_pixels_);
  place_ = &place;
  static_cast<SeenLayer&>(layers_[0]) = place.scenery();
  if (has_pairs_) layers_[0].lay_out_edges(scene, position_m_, outlines.middle_m());
}

DCEM_INLINE void PathHalf::lay_out_images(const Scene& scene, const FacetOutlines& outlines) {
  if (has_images_) return;
  has_images_ = true;
  if (!has_pairs_) return layers_[0].find_images(scene, position_m_);
  layers_[0].lay_out_images(scene, position_m_, outlines.middle_m());
}

DCEM_INLINE void PathHalf::find_bodies(const Scene& scene, const FacetOutlines& outlines, const HalfSettings& settings,
                                       std::span<const char> moved, ThreadPool* pool) {
  for (const bool have_moved : {true, false}) {
    HalfLayer& layer = layers_[have_moved ? 1 : 2];
    sight().find_bodies(scene, outlines, settings, {ignored_body_, moved, have_moved, &position_m_}, layer);
    layer.lay_out(scene, position_m_, outlines.middle_m(), has_pairs_);
    if (has_pairs_) bodies_[have_moved ? 0 : 1].lay_out(scene, layer, position_m_, outlines.middle_m());
  }
  if (!has_pairs_) return;
  if (place_ != nullptr) {
    const std::span<const PlaceMirror> mirrors = place_->mirrors();
    const auto cone_at = [&](std::size_t at) -> MirrorCone { return {mirrors[at].cone, mirrors[at].number}; };
    return reach_.find(outlines, mirrors.size(), cone_at, pool);
  }
  const auto cone_at = [&](std::size_t at) -> MirrorCone {
    return {layers_[0].cones[at], static_cast<std::uint32_t>(at)};
  };
  reach_.find(outlines, layers_[0].mirrors.size(), cone_at, pool);
}

}  // namespace dcem
