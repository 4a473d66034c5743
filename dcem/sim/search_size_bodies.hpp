#pragma once
/// Bodies of search_size.hpp.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "dcem/core/build_mode.hpp"
#include "dcem/core/random.hpp"
#include "dcem/paths/discover/beam.hpp"
#include "dcem/paths/solve/edge_rules.hpp"
#include "dcem/paths/solve/image_method.hpp"
#include "dcem/scene/scene.hpp"
#include "dcem/sim/search_size.hpp"
#include "dcem/sim/settings.hpp"

namespace dcem {

namespace detail {

/// Mean numbers by the number of mirrors.
struct SequenceCounts {
  std::vector<double> mirrors;  ///< sequences of so many mirrors
  std::vector<double> halves;   ///< edges reached over so many mirrors, counted once per way
};

inline EdgeRules edge_rules(const PropagationSettings& propagation) {
  return {degrees_to_radians(propagation.diffraction.min_exterior_angle_deg), propagation.diffraction.free_edges};
}

inline std::size_t diffracting_edges(const Scene& scene, const EdgeRules& rules) {
  return static_cast<std::size_t>(
      std::ranges::count_if(scene.wedges(), [&](const WorldWedge& wedge) { return diffracts(wedge, rules); }));
}

/// Random descents from one end of a link.
class SequenceProbe {
 public:
  SequenceProbe(const PropagationSettings& propagation, const Scene& scene)
      : scene_(scene),
        order_(static_cast<std::size_t>(reflection_order(propagation))),
        has_edges_(diffraction_order(propagation) > 0),
        rules_(edge_rules(propagation)),
        counts_{std::vector<double>(order_ + 1), std::vector<double>(order_ + 1)} {}

  void descend(const Vec3& position_m, RandomStream& random) {
    ++descents_;
    images_m_.assign(1, position_m);
    double weight = 1.0;
    std::optional<Beam> beam;
    std::optional<std::uint32_t> mirror;
    for (std::size_t depth = 0; depth <= order_; ++depth) {
      counts_.mirrors[depth] += weight;
      if (has_edges_) counts_.halves[depth] += weight * static_cast<double>(edges_in(beam));
      if (depth == order_) return;
      collect_next(beam, mirror);
      if (next_.empty()) return;
      weight *= static_cast<double>(next_.size());
      mirror = next_[static_cast<std::size_t>(random.uniform() * static_cast<double>(next_.size()))];
      beam = beam_through(beam, scene_.facets()[*mirror]);
    }
  }

  SequenceCounts mean() const {
    SequenceCounts mean = counts_;
    for (std::vector<double>* counts : {&mean.mirrors, &mean.halves}) {
      for (double& count : *counts) count /= static_cast<double>(descents_);
    }
    return mean;
  }

 private:
  /// The facets that may come next, as `ExactSearch` finds them.
  void collect_next(const std::optional<Beam>& beam, std::optional<std::uint32_t> mirror) {
    next_.clear();
    for (std::uint32_t index = 0; index < scene_.facets().size(); ++index) {
      const WorldFacet& facet = scene_.facets()[index];
      if (!facet.present || mirror == index) continue;
      if (std::abs(signed_distance_m(facet.plane, images_m_.back())) <= in_plane_guard_m) continue;
      if (!beam || beam->clip(scene_.hull_m(facet), window_m_)) next_.push_back(index);
    }
  }

  Beam beam_through(const std::optional<Beam>& beam, const WorldFacet& facet) {
    const auto hull_m = scene_.hull_m(facet);
    window_m_.assign(hull_m.begin(), hull_m.end());
    if (beam) beam->clip(hull_m, window_m_);
    append_image(images_m_, facet.plane);
    return Beam(images_m_.back(), facet.plane, window_m_);
  }

  std::size_t edges_in(const std::optional<Beam>& beam) {
    std::size_t count = 0;
    for (const WorldWedge& wedge : scene_.wedges()) {
      const std::array<Vec3, 2> ends_m{wedge.edge.start_m, wedge.edge.end_m};
      count += diffracts(wedge, rules_) && (!beam || beam->clip(ends_m, window_m_));
    }
    return count;
  }

  const Scene& scene_;
  std::size_t order_;
  bool has_edges_;
  EdgeRules rules_;
  SequenceCounts counts_;
  std::size_t descents_ = 0;
  std::vector<Vec3> images_m_, window_m_;
  std::vector<std::uint32_t> next_;
};

inline double binomial(int of, int choose) {
  double result = 1.0;
  for (int step = 1; step <= choose; ++step) result *= static_cast<double>(of - choose + step) / step;
  return result;
}

/// Chains with so many edges, and mirrors before, between and behind them.
inline double chain_count(const SequenceCounts& counts, int diffractions, int most_mirrors, double facets,
                          double edges) {
  double sum = 0.0;
  for (int before = 0; before <= most_mirrors; ++before) {
    for (int behind = 0; before + behind <= most_mirrors; ++behind) {
      const double ends =
          counts.halves[static_cast<std::size_t>(before)] * counts.halves[static_cast<std::size_t>(behind)];
      if (diffractions == 1) sum += ends / std::max(1.0, edges);
      for (int between = 0; diffractions > 1 && before + between + behind <= most_mirrors; ++between) {
        sum += ends * binomial(between + diffractions - 2, between) * std::pow(facets, between) *
               std::pow(edges, diffractions - 2);
      }
    }
  }
  return sum;
}

inline double sum_of_sequences(const SequenceCounts& counts, const PropagationSettings& propagation,
                               const Scene& scene) {
  const auto facets = static_cast<double>(scene.surface_count());
  const auto edges = static_cast<double>(diffracting_edges(scene, edge_rules(propagation)));
  double sum = 0.0;
  for (const double sequences : counts.mirrors) sum += sequences;
  for (int diffractions = 1; diffractions <= diffraction_order(propagation); ++diffractions) {
    const int most_mirrors = std::min(reflection_order(propagation), interaction_order(propagation) - diffractions);
    sum += chain_count(counts, diffractions, most_mirrors, facets, edges);
  }
  return sum;
}

DCEM_INLINE double count_all_sequences(const PropagationSettings& propagation, const Scene& scene) {
  SequenceCounts counts;
  for (int mirrors = 0; mirrors <= reflection_order(propagation); ++mirrors) {
    counts.mirrors.push_back(std::pow(static_cast<double>(scene.surface_count()), mirrors));
    counts.halves.push_back(static_cast<double>(scene.wedges().size()) * counts.mirrors.back());
  }
  return sum_of_sequences(counts, propagation, scene);
}

DCEM_INLINE double probed_sequences(const PropagationSettings& propagation, const Scene& scene,
                                    std::span<const Vec3> points_m) {
  constexpr std::size_t descents = 400;
  SequenceProbe probe(propagation, scene);
  RandomStream random(hash_text("sequences"));
  for (std::size_t descent = 0; descent < descents; ++descent) {
    probe.descend(points_m[descent % points_m.size()], random);
  }
  return sum_of_sequences(probe.mean(), propagation, scene);
}

/// Where the first transmitters are.
inline std::vector<Vec3> some_transmitters_m(const Scene& scene) {
  constexpr std::size_t most = 4;
  const Frame frame = scene.frame_at(0.0);
  std::vector<Vec3> positions_m;
  for (const Device& device : scene.transmitters().first(std::min(most, scene.transmitters().size()))) {
    const DeviceState state = scene.device_state(device, frame);
    if (state.present) positions_m.push_back(state.position_m);
  }
  return positions_m;
}

}  // namespace detail

DCEM_INLINE double estimated_sequences(const PropagationSettings& propagation, const Scene& scene) {
  const double all = detail::count_all_sequences(propagation, scene);
  if (all <= most_sequences_of_a_link) return all;
  const std::vector<Vec3> transmitters_m = detail::some_transmitters_m(scene);
  return transmitters_m.empty() ? all : std::min(all, detail::probed_sequences(propagation, scene, transmitters_m));
}

DCEM_INLINE bool search_ends(const PropagationSettings& propagation, const Scene& scene) {
  return estimated_sequences(propagation, scene) <= most_sequences_of_a_link;
}

DCEM_INLINE std::string rough_number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.2g", value);
  return text.data();
}

DCEM_INLINE std::string rough_duration(double duration_s) {
  struct Unit {
    const char* name;
    double length_s;
  };
  constexpr double day_s = 86'400.0;
  const std::array<Unit, 4> units{{{"years", 365.25 * day_s}, {"days", day_s}, {"hours", 3'600.0}, {"minutes", 60.0}}};
  for (const Unit& unit : units) {
    if (duration_s >= 2.0 * unit.length_s) return rough_number(duration_s / unit.length_s) + " " + unit.name;
  }
  const std::string seconds = rough_number(duration_s);
  return seconds + (seconds == "1" ? " second" : " seconds");
}

}  // namespace dcem
