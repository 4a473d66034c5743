#pragma once
/// How a `BasicSimulator` begins; included by basic_simulator.hpp.
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include "dcem/sim/basic_simulator.hpp"
#include "dcem/sim/detail/device_numbers.hpp"

namespace dcem {

template <SurfaceModel Surface, SpatialIndex Index>
BasicSimulator<Surface, Index>::BasicSimulator(Scene scene, SimulationSettings settings, Surface surface)
    : scene_(std::move(scene)),
      settings_(std::move(settings)),
      surface_(std::move(surface)),
      index_(settings_.tree),
      choice_(scene_, settings_.links),
      numbers_(std::make_shared<const detail::DeviceNumbers>(detail::numbers_by_id(scene_.transmitters()))),
      pool_(std::make_unique<ThreadPool>(settings_.threads)) {
  validate(settings_);
  check_surface_model();
  medium_ = MediumLoss(settings_.propagation.atmosphere, scene_.materials(), settings_.frequency_hz);
  plan_ = plan_search(settings_.propagation, scene_);
  cache_ = resolve_cache(settings_.propagation, plan_.discovery);
  const bool is_direct_alone = plan_.discovery == Discovery::exact && interaction_order(settings_.propagation) == 0;
  // The direct path takes no views, unless it is asked for how long it lasts.
  if (is_direct_alone && !settings_.propagation.valid_until_limit_m) {
    plan_ = {Discovery::exact, true};
    // What is remembered is what halves find: the same paths as by trying all sequences.
  } else if (cache_ == CacheMode::exact && halves_cover(most_joined_interactions, settings_.propagation)) {
    plan_ = {Discovery::exact, false, most_joined_interactions};
  }
  if (cache_ == CacheMode::seed) {
    caches_.resize(scene_.receivers().size());
    reach_.resize(scene_.transmitters().size());
  }
  frame_ = scene_.frame_at(0.0);
  scene_.apply(frame_);
  index_.build(scene_.triangle_view(), scene_.triangle_boxes(), scene_.first_triangles());
  if (looks()) outlines_.emplace(scene_);
  if (cache_ == CacheMode::exact) {
    change_.emplace(scene_, plan_.joined > 0);
    receivers_.resize(scene_.receivers().size());
  }
  if (plan_.joined == 0) return;
  lanes_ = std::make_unique<LaneScene>(scene_, *outlines_);
  const std::size_t transmitters = scene_.transmitters().size();
  halves_ =
      kept_halves(transmitters, detail::pixels_for_facets(detail::view_pixels_for(transmitters), outlines_->size()));
  if (cache_ != CacheMode::exact) return;
  for (std::size_t transmitter = 0; transmitter < halves_.size(); ++transmitter) {
    PlaceUse use{detail::longest_step_in_place_m, true, false, false, known_places_.get()};
    use.early = early_of(receivers_.size() + transmitter);
    halves_[transmitter].keep_places(use);
  }
}

/// What a model of the caller's own cannot do would otherwise be left out in silence.
template <SurfaceModel Surface, SpatialIndex Index>
void BasicSimulator<Surface, Index>::check_surface_model() const {
  if (!ScatteringModel<Surface> && settings_.propagation.diffuse.enabled) {
    throw std::invalid_argument("diffuse: the surface model does not scatter; expected a ScatteringModel");
  }
  std::vector<bool> is_looked_at(scene_.materials().size());
  for (const WorldFacet& facet : scene_.facets()) {
    if (facet.transmits || facet.is_foliage || is_looked_at[facet.material.value]) continue;
    is_looked_at[facet.material.value] = true;
    const Material& material = scene_.material(facet.material);
    for (const double cos_incidence : {0.25, 0.5, 1.0}) {
      const SurfaceResponse response = surface_.response(facet.material, cos_incidence);
      if (response.transmission.te == 0.0 && response.transmission.tm == 0.0) continue;
      throw std::invalid_argument("material '" + material.name +
                                  "': the surface model lets a wave through, but the scene's material blocks paths; "
                                  "expected a material that transmits, such as ConstantReflection with a loss");
    }
  }
}

}  // namespace dcem
