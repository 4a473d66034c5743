#pragma once
/// Chains over one edge that both ends reach, in sampled search.
///
/// Of all pairs of ways to an edge few can carry a path: the end must be in front of the edge over the mirrors on its
/// way, the shortest way from one end's image to the other's must meet the edge within its ends, and lead over the
/// mirrors where they are. What is refused cannot be a path, so nothing is lost; what is left the solver decides.
#include <cstddef>
#include <vector>

#include "dcem/paths/discover/edge_reach.hpp"

namespace dcem {

/// Holds scratch memory: one per thread.
class EdgeMeetings {
 public:
  /// Appends the chains over one edge within some limits, from the receiver outwards, each once, without those that
  /// surely carry no path.
  void join(const Scene& scene, const ChainLimits& limits, const ReachingEnd& receiver, const ReachingEnd& transmitter,
            SequenceList& chains);

 private:
  /// The ways of one end to an edge, with its images in their mirrors.
  class Ways {
   public:
    /// Those within some limits over which the edge may have the end in its exterior.
    void take(const Scene& scene, const ChainLimits& limits, const Vec3& end_m, const EdgeReach::Edge& edge);

    std::size_t size() const { return ways_.size(); }
    EdgeReach::Mirrors mirrors(std::size_t way) const { return ways_[way].mirrors; }
    /// The end as the edge sees it.
    const Vec3& image_m(std::size_t way) const { return images_m_[ways_[way].first + ways_[way].mirrors.size()]; }
    /// Whether the way from a point on the edge to the end meets each mirror, or a little beside.
    bool leads_from(const Vec3& point_m, std::size_t way, const Scene& scene) const;

   private:
    struct Way {
      EdgeReach::Mirrors mirrors;
      std::size_t first;  ///< the end, then its image in the first mirror, in the second in that …
    };

    std::vector<Way> ways_;
    std::vector<Vec3> images_m_;
  };

  /// The chains over one edge, whose ways have been taken.
  void join_at(WedgeId id, const Scene& scene, const ChainLimits& limits, SequenceList& chains);

  Ways near_, far_;
  Sequence chain_;
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/discover/edge_meetings_bodies.hpp"
#endif
