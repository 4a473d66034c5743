#pragma once
/// Looks over edges, one after the other, for the facets of the scenery that an end may light over them.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/paths/halves/edge_parts.hpp"
#include "dcem/paths/halves/facet_outlines.hpp"
#include "dcem/paths/halves/keller_view.hpp"

namespace dcem {

/// Holds scratch memory: one per thread.
class EdgeLooker {
 public:
  /// `hides_sheets`: no path crosses a sheet, so that sheets hide, too.
  EdgeLooker(const Scene& scene, const FacetOutlines& outlines, bool hides_sheets)
      : scene_(scene), outlines_(outlines), hides_sheets_(hides_sheets), is_asked_(outlines.size(), 0) {}

  /// Notes the number of each facet that may be lit over parts of one edge, which an end sees, and the place of the
  /// part among all: those from `first` to `last` − 1.
  void look_over(std::span<const EdgePart> all, std::size_t first, std::size_t last,
                 std::vector<std::array<std::uint32_t, 2>>& lit);

 private:
  void ask(FacetId id, const WorldWedge& wedge);
  bool is_ignored_along(FacetId id, const WorldWedge& wedge) const;
  void cover(FacetId id);

  const Scene& scene_;
  const FacetOutlines& outlines_;
  bool hides_sheets_;
  KellerView view_;
  std::vector<char> is_asked_;                       ///< by facet
  std::vector<FacetId> asked_, grazed_;              ///< in the view being made
  std::vector<std::array<std::uint32_t, 2>> shown_;  ///< a facet, and the cells from which it may be seen
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/halves/edge_looker_bodies.hpp"
#endif
