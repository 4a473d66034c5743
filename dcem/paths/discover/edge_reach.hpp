#pragma once
/// Which edges an end of a link may reach, and over which mirrors: half a path. Two halves that meet at an edge are a
/// candidate. So edges cost the sum of what the two ends see, not the product, and one half of a transmitter serves all
/// receivers.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "dcem/paths/discover/proposal_memory.hpp"
#include "dcem/paths/sequence.hpp"
#include "dcem/scene/scene.hpp"

namespace dcem {

/// The edges that one end reaches. A half is a sequence that counts from the end and whose last element is the edge.
class EdgeReach {
 public:
  using Mirrors = std::span<const SequenceElement>;  ///< from the end to an edge

  struct Edge {
    WedgeId id;
    std::span<const Mirrors> mirrors;  ///< one list per way, in the order in which they were noted
    std::span<const FacetId> in_view;  ///< mirrors that rays from the edge met, ascending
  };

  /// Notes that the edge may be reached over `mirrors`.
  void add(const Sequence& mirrors, WedgeId edge) {
    half_ = mirrors;
    half_.emplace_back(edge);
    halves_.note(half_);
  }

  /// The same where each half comes once, as in exhaustive search, and the reach is for one frame only.
  void append(const Sequence& mirrors, WedgeId edge) {
    half_ = mirrors;
    half_.emplace_back(edge);
    halves_.append(half_);
  }

  /// Notes that a ray from the edge met a mirror.
  void note_view(WedgeId edge, FacetId mirror) {
    half_.assign({edge, mirror});
    views_.note(half_);
  }

  /// Forgets everything, or what was not noted in the last `lifetime_frames` frames.
  void clear() {
    halves_.clear();
    views_.clear();
  }
  void next_frame(std::uint32_t lifetime_frames) {
    halves_.next_frame(lifetime_frames);
    views_.next_frame(lifetime_frames);
  }

  std::size_t size() const { return halves_.size(); }

  /// All edges, ascending. Valid until halves come or go, or it is asked again.
  std::span<const Edge> edges();

 private:
  void list_ways();
  void list_views();

  ProposalMemory halves_;
  ProposalMemory views_;  ///< an edge and a mirror each
  Sequence half_;
  std::vector<Edge> edges_;          ///< what `edges` has handed out last, with the lists to which it points
  std::vector<Mirrors> ways_;        ///< by edge
  std::vector<FacetId> viewed_;      ///< by edge
  std::vector<std::uint64_t> keys_;  ///< of halves or views, as they are sorted: the edge comes first
};

/// The edges of one end, ascending.
using ReachedEdges = std::span<const EdgeReach::Edge>;

/// One end of a link, and the edges that it reaches.
struct ReachingEnd {
  Vec3 position_m{0.0};
  ReachedEdges edges;
};

/// Bounds of a chain with edges.
struct ChainLimits {
  std::size_t max_reflections = 2;
  std::size_t max_diffractions = 1;
  std::size_t max_interactions = 3;  ///< reflections and diffractions together
  bool mirrors_between = false;      ///< try every mirror between two edges, too: for small scenes
  bool few_apart = false;            ///< chains over one edge or two are somebody else's
};

/// Calls `visit(sequence)` for every chain that joins a half of the receiver's with a half of a transmitter's: at one
/// edge, or with further edges (and mirrors, where the limits say so) between two.
class ChainJoiner {
 public:
  ChainJoiner(const Scene& scene, const ChainLimits& limits) : scene_(scene), limits_(limits) {}

  template <typename Visit>
  void for_each_chain(std::span<const EdgeReach::Edge> receiver, std::span<const EdgeReach::Edge> transmitter,
                      Visit&& visit) {
    for (const EdgeReach::Edge& near : receiver) {
      for (const std::span<const SequenceElement> mirrors : near.mirrors) {
        chain_.assign(mirrors.begin(), mirrors.end());
        chain_.emplace_back(near.id);
        const Spent spent{mirrors.size(), 1};
        if (fits(spent)) extend(spent, transmitter, visit);
      }
    }
  }

 private:
  struct Spent {
    std::size_t reflections = 0, diffractions = 0;
  };

  bool fits(const Spent& spent) const {
    return spent.reflections <= limits_.max_reflections && spent.diffractions <= limits_.max_diffractions &&
           spent.reflections + spent.diffractions <= limits_.max_interactions;
  }

  /// Ends the chain at its last element where that is an edge the transmitter reaches, and goes on over further ones.
  template <typename Visit>
  void extend(const Spent& spent, std::span<const EdgeReach::Edge> transmitter, Visit& visit) {
    if (chain_.back().is_edge() && !(limits_.few_apart && spent.diffractions <= 2)) {
      end_here(spent, transmitter, visit);
    }
    if (spent.diffractions == limits_.max_diffractions) return;
    const auto go_on = [&](SequenceElement element, const Spent& then) {
      if (!fits(then) || element == chain_.back()) return;
      chain_.push_back(element);
      extend(then, transmitter, visit);
      chain_.pop_back();
    };
    // Edges that the transmitter does not reach cannot end the chain, and rays from it find most of those in between.
    for (const EdgeReach::Edge& next : transmitter) {
      go_on(next.id, {spent.reflections, spent.diffractions + 1});
    }
    for (std::uint32_t facet = 0; limits_.mirrors_between && facet < scene_.facets().size(); ++facet) {
      // A chain never ends at a mirror between edges: one more edge must still fit.
      if (spent.reflections + spent.diffractions + 2 > limits_.max_interactions) break;
      if (scene_.facets()[facet].present) go_on(FacetId(facet), {spent.reflections + 1, spent.diffractions});
    }
  }

  template <typename Visit>
  void end_here(const Spent& spent, std::span<const EdgeReach::Edge> transmitter, Visit& visit) {
    const WedgeId last = chain_.back().edge();
    const auto edge = std::lower_bound(transmitter.begin(), transmitter.end(), last,
                                       [](const EdgeReach::Edge& one, WedgeId id) { return one.id < id; });
    if (edge == transmitter.end() || edge->id != last) return;
    const std::size_t length = chain_.size();
    for (const std::span<const SequenceElement> mirrors : edge->mirrors) {
      if (!fits({spent.reflections + mirrors.size(), spent.diffractions})) continue;
      chain_.insert(chain_.end(), mirrors.rbegin(), mirrors.rend());
      visit(std::as_const(chain_));
      chain_.resize(length, chain_.front());
    }
  }

  const Scene& scene_;
  ChainLimits limits_;
  Sequence chain_;
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/discover/edge_reach_bodies.hpp"
#endif
