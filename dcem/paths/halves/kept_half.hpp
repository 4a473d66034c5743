#pragma once
/// The half of a device from frame to frame: its view of the scenery is worked out again only where the device has
/// moved.
#include <optional>

#include "dcem/paths/halves/path_half.hpp"

namespace dcem {

class KeptHalf {
 public:
  explicit KeptHalf(int map_pixels = PathHalf::default_pixels) : half_(map_pixels) {}

  /// Brings the half to where the device is, and to where the bodies are. The settings are those of the time before.
  void update(const Scene& scene, const FacetOutlines& outlines, const LinkEnd& end, const HalfSettings& settings) {
    const bool stands = end_ && end_->position_m == end.position_m && end_->ignored_body == end.ignored_body &&
                        end_->mounted_on == end.mounted_on;
    if (!stands) half_.find_scenery(scene, outlines, end, settings);
    half_.find_bodies(scene, outlines, settings);
    end_ = end;
  }
  const PathHalf& half() const { return half_; }

 private:
  PathHalf half_;
  std::optional<LinkEnd> end_;  ///< whose half it is; none yet: nobody's
};

}  // namespace dcem
