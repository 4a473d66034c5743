#pragma once
/// What ends of links are asked to look for, and what they see.
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "dcem/core/ids.hpp"
#include "dcem/geometry/vector.hpp"
#include "dcem/paths/solve/edge_rules.hpp"

namespace dcem {

/// What is the same for all halves.
struct HalfSettings {
  bool edges = true;  ///< look for edges, too
  /// A path crosses at most so many sheets: what is behind more of them is hidden.
  int sheets = std::numeric_limits<int>::max();
  EdgeRules rules{};
  /// Where at least so many facets of the scenery may be seen that are small in the map, the view is looked at twice.
  /// That only takes away what nothing comes of.
  std::size_t closer_from = std::numeric_limits<std::size_t>::max();
  /// Nothing farther than this counts as seen, along the way over a mirror where one is looked through.
  double reach_m = std::numeric_limits<double>::infinity();
  bool pairs = true;                    ///< halves are joined over two elements and more: images need what they may see
  std::span<const char> asked_edges{};  ///< by edge, 0 where nobody asks whether it is seen; empty: all are asked for
};

/// Bodies that are looked at.
struct BodyChoice {
  std::optional<BodyId> not_there;  ///< one that does not exist for the end
  std::span<const char> moved{};    ///< by body, whether it has moved; empty: all have
  bool have_moved = true;           ///< those that have, or those that have not
  const Vec3* end_m = nullptr;      ///< who looks, where the view is one from all of a body; null: all of it does

  bool takes(std::uint32_t body) const {
    return (moved.empty() || moved[body] != 0) == have_moved && not_there != BodyId(body);
  }
};

/// Of the scenery, or of what moves.
struct SeenLayer {
  std::vector<FacetId> mirrors;  ///< ascending
  std::vector<WedgeId> edges;    ///< ascending
};

}  // namespace dcem
