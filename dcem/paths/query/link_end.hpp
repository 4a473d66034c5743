#pragma once
/// A device as paths see it.
#include <optional>
#include <vector>

#include "dcem/paths/query/scene_tracer.hpp"

namespace dcem {

struct LinkEnd {
  Vec3 position_m{0.0};
  std::optional<BodyId> ignored_body;  ///< the object that the device rides on
  std::vector<FacetId> mounted_on;     ///< facets within the weld tolerance: they neither reflect nor block its legs

  friend bool operator==(const LinkEnd&, const LinkEnd&) = default;
};

template <typename Index>
LinkEnd make_link_end(const SceneTracer<Index>& tracer, const Vec3& position_m, std::optional<BodyId> ignored_body,
                      TraversalCounters& counters) {
  const IgnoredBodies ignored{ignored_body, std::nullopt};
  return {position_m, ignored_body,
          tracer.facets_near(position_m, tracer.scene().settings().weld_tolerance_m, ignored, counters)};
}

}  // namespace dcem
