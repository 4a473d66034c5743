#pragma once
/// For how long the paths of links stay what they are, in one frame: what their transmitters may see is worked out
/// once.
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "dcem/paths/lifetime/link_lifetime.hpp"

namespace dcem {

/// Several threads may ask at once. What is handed over must stay.
template <typename Index>
class LifetimeFinder {
 public:
  LifetimeFinder(const SceneTracer<Index>& tracer, const FacetOutlines& outlines, const FacetRims& rims,
                 const LifetimeSettings& settings, const HalfSettings& views,
                 std::span<const std::optional<LinkEnd>> transmitters)
      : tracer_(tracer),
        outlines_(outlines),
        rims_(rims),
        settings_(settings),
        views_(views),
        shapes_(body_shapes(tracer.scene())),
        transmitters_(transmitters),
        places_(transmitters.size()) {}

  /// What is worked out for one receiver, whose links are asked one after another.
  class Receiver {
   public:
    Receiver(LifetimeFinder& finder, const LinkEnd& end) : finder_(finder), end_(end) {}

    /// For a link that has exactly these paths.
    double valid_until_m(std::size_t transmitter, std::span<const Sequence> open) {
      LinkLifetime<Index> link(finder_.tracer_, {finder_.outlines_, finder_.rims_, finder_.shapes_}, finder_.settings_,
                               *finder_.transmitters_[transmitter], end_);
      const double until_m = link.open_until_m(open);
      if (!(until_m > 0.0)) return 0.0;
      const std::size_t size = finder_.size_for(until_m);
      if (!places_[size]) places_[size] = finder_.look_from(end_, size);
      return link.shut_until_m(finder_.place_of(transmitter, size), *places_[size], until_m);
    }

   private:
    LifetimeFinder& finder_;
    const LinkEnd& end_;
    std::array<std::unique_ptr<const VaguePlace>, 16> places_;
  };

 private:
  friend class Receiver;
  static constexpr std::size_t size_count = 16;
  /// Places come in sizes, each half as large as the one before: what a link gets depends on nothing but the link.
  std::size_t size_for(double until_m) const {
    const double halvings = std::floor(std::log2(settings_.limit_m / until_m));
    return std::min(size_count - 1, static_cast<std::size_t>(std::max(0.0, halvings)));
  }
  std::unique_ptr<const VaguePlace> look_from(const LinkEnd& end, std::size_t size) const {
    const double moved_m = settings_.limit_m * std::exp2(-static_cast<double>(size));
    return std::make_unique<const VaguePlace>(tracer_.scene(), outlines_, shapes_, end.position_m, moved_m, views_);
  }
  const VaguePlace& place_of(std::size_t transmitter, std::size_t size) {
    Sized& place = places_[transmitter][size];
    std::call_once(place.once, [&] { place.place = look_from(*transmitters_[transmitter], size); });
    return *place.place;
  }

  struct Sized {
    std::once_flag once;
    std::unique_ptr<const VaguePlace> place;
  };

  const SceneTracer<Index>& tracer_;
  const FacetOutlines& outlines_;
  const FacetRims& rims_;
  LifetimeSettings settings_;
  HalfSettings views_;
  std::vector<BodyShape> shapes_;
  std::span<const std::optional<LinkEnd>> transmitters_;
  std::vector<std::array<Sized, size_count>> places_;
};

}  // namespace dcem
