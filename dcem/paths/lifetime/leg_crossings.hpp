#pragma once
/// Facets that a leg crosses now: whether it surely goes on crossing them while ends and bodies move.
#include <cstddef>
#include <optional>
#include <vector>

#include "dcem/paths/lifetime/way_gates.hpp"

namespace dcem {

/// Where along a leg a facet is crossed.
struct LegCrossing {
  FacetId facet;
  Share part;
};

class LegCrossings {
 public:
  LegCrossings(const VagueScene& vague, const WayGates& gates) : vague_(vague), gates_(gates) {}

  /// Whether a leg begins or ends on a facet: on the mirror itself, or on an edge of it.
  static bool is_own(const Scene& scene, const VagueStretch& leg, FacetId id);

  /// Where a facet, which the line of a leg meets now, surely goes on being met, between both ends of the leg and as
  /// something that the leg does not ignore. None where that is not sure.
  std::optional<Share> crosses(const VagueStretch& leg, FacetId id) const;

  /// Adds a sheet that is surely crossed, and surely counted apart from those that are there; false where that is not
  /// sure.
  bool add_sheet(const VagueStretch& leg, FacetId id, std::vector<LegCrossing>& crossed) const;

 private:
  const Scene& scene() const { return vague_.scene(); }

  /// Where along a line it may cross a facet that it crosses now: where its plane is, as far as the ends surely stay on
  /// two sides of it, and where its corners are.
  Share crossing_part(const VagueLine& line, FacetId id) const;

  /// Whether planes may come to be parallel as the solver has it, for which 0.995 is enough; 0.98 leaves 0.1 radians.
  bool may_be_parallel(const WorldFacet& one, const WorldFacet& other) const;
  /// A leg ignores what lies along the mirrors and faces at its ends.
  bool may_be_ignored(const VagueStretch& leg, const WorldFacet& facet, const Share& part) const;
  /// Whether two sheets are surely crossed one after the other, and are not one sheet (`SceneTracer::one_sheet`): along
  /// the normal of a sheet they are as far apart as the share of the line between them times what the line's ends are
  /// from each other along that normal.
  bool are_apart(const VagueLine& line, const LegCrossing& one, const LegCrossing& other) const;
  double across_m(const VagueLine& line, const WorldFacet& facet) const;

  const VagueScene& vague_;
  const WayGates& gates_;
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/lifetime/leg_crossings_bodies.hpp"
#endif
