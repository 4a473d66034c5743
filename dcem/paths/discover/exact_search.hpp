#pragma once
/// Exhaustive discovery: every sequence of facets that a path could take, up to an order.
///
/// From the receiver, each facet is a mirror; through the window that it offers to the receiver's image, a beam
/// collects the facets that may come next, and so on. Beams only discard what cannot carry a path, so every valid
/// path's sequence is visited; whether a visited sequence is a path is for `PathSolver` to say. Cost: facets × beams.
/// Where edges are wanted, every edge that a beam meets is noted as within reach.
#include <array>
#include <cmath>
#include <vector>

#include "dcem/paths/discover/beam.hpp"
#include "dcem/paths/discover/edge_reach.hpp"
#include "dcem/paths/query/link_end.hpp"
#include "dcem/paths/sequence.hpp"
#include "dcem/paths/solve/edge_rules.hpp"
#include "dcem/paths/solve/image_method.hpp"

namespace dcem {

class ExactSearch {
 public:
  ExactSearch(const Scene& scene, int max_reflections)
      : scene_(scene), order_(static_cast<std::size_t>(max_reflections)), windows_m_(order_ + 1) {}

  /// From now on the edges that beams meet over at most so many mirrors are noted, by rules that say which edges count.
  /// Reach, which must be empty, and rules outlive the search.
  void note_edges(EdgeReach& reach, const EdgeRules& rules, std::size_t most_mirrors) {
    reach_ = &reach;
    rules_ = &rules;
    most_mirrors_ = most_mirrors;
  }

  /// Calls `visit(sequence, images_m)` for the direct path and for every sequence that a beam from the receiver
  /// reaches.
  template <typename Visit>
  void for_each_sequence(const LinkEnd& receiver, Visit&& visit) {
    sequence_.clear();
    images_m_.assign(1, receiver.position_m);
    ignored_body_ = receiver.ignored_body;
    visit(sequence_, images_m_);
    note_edges_in(nullptr);
    if (order_ == 0) return;
    for (std::uint32_t index = 0; index < scene_.facets().size(); ++index) {
      const WorldFacet& facet = scene_.facets()[index];
      if (!reflects(facet)) continue;
      const auto hull_m = scene_.hull_m(facet);
      windows_m_[1].assign(hull_m.begin(), hull_m.end());
      descend(FacetId(index), visit);
    }
  }

 private:
  /// Whether the facet can be the next mirror, seen from the latest image.
  bool reflects(const WorldFacet& facet) const {
    return facet.present && facet.body != ignored_body_ &&
           std::abs(signed_distance_m(facet.plane, images_m_.back())) > in_plane_guard_m;
  }

  /// Visits the sequence that ends in `mirror`, whose window stands ready, and all that continue it.
  template <typename Visit>
  void descend(FacetId mirror, Visit&& visit) {
    const WorldFacet& facet = scene_.facet(mirror);
    sequence_.push_back(mirror);
    append_image(images_m_, facet.plane);
    visit(sequence_, images_m_);
    const Beam beam(images_m_.back(), facet.plane, windows_m_[sequence_.size()]);
    note_edges_in(&beam);
    if (sequence_.size() < order_) {
      for (std::uint32_t index = 0; index < scene_.facets().size(); ++index) {
        const WorldFacet& next = scene_.facets()[index];
        if (FacetId(index) == mirror || !reflects(next)) continue;
        if (beam.clip(scene_.hull_m(next), windows_m_[sequence_.size() + 1])) descend(FacetId(index), visit);
      }
    }
    images_m_.pop_back();
    sequence_.pop_back();
  }

  /// Notes the edges that a beam meets; without a beam all.
  void note_edges_in(const Beam* beam) {
    if (reach_ == nullptr || sequence_.size() > most_mirrors_) return;
    for (std::uint32_t index = 0; index < scene_.wedges().size(); ++index) {
      const WorldWedge& wedge = scene_.wedges()[index];
      if (!diffracts(wedge, *rules_) || wedge.body == ignored_body_ || is_embedded(WedgeId(index), *rules_)) continue;
      const std::array<Vec3, 2> ends_m{wedge.edge.start_m, wedge.edge.end_m};
      if (beam == nullptr || beam->clip(ends_m, inside_m_)) reach_->append(sequence_, WedgeId(index));
    }
  }

  const Scene& scene_;
  std::size_t order_;
  EdgeReach* reach_ = nullptr;
  const EdgeRules* rules_ = nullptr;
  std::size_t most_mirrors_ = 0;
  std::vector<Vec3> inside_m_;
  Sequence sequence_;
  std::vector<Vec3> images_m_;
  std::optional<BodyId> ignored_body_;
  std::vector<std::vector<Vec3>> windows_m_;  ///< per depth: the lit part of the latest mirror
};

}  // namespace dcem
