#pragma once
/// What the viewer keeps of a run, within its bounds. Private to dcem::io.
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "dcem/io/scenario.hpp"
#include "dcem/io/src/viewer/viewed_map.hpp"
#include "dcem/io/src/viewer/viewed_surfaces.hpp"
#include "dcem/scene/scene.hpp"
#include "dcem/sim/frame_result.hpp"

namespace dcem::io {

/// Where a path meets a surface.
struct ViewedTouch {
  Vec3 point_m{0.0};
  std::uint32_t surface = 0;  ///< number in `ViewerFrames::surfaces()`
};

/// A path as the viewer shows it. Its ends are where the devices are.
struct ViewedRay {
  std::string kinds, id;
  double length_m = 0.0;
  double gain_db = 0.0;  ///< −∞ where no power arrives
  double doppler_hz = 0.0;
  std::vector<ViewedTouch> touches;
};

struct ViewedLink {
  std::size_t transmitter = 0, receiver = 0;
  LinkStatistics statistics;
  std::size_t listed = 0;       ///< paths and listed tiles, before the weakest were left out
  std::vector<ViewedRay> rays;  ///< strongest first
};

/// Where a thing is from a frame on. Things are bodies, then transmitters, then receivers.
struct ViewedPose {
  std::size_t thing = 0;
  bool present = true;
  std::string name;  ///< of an object; empty for a device
  Pose pose;
  friend bool operator==(const ViewedPose&, const ViewedPose&) = default;
};

struct ViewedFrame {
  std::size_t index = 0;
  double time_s = 0.0;
  std::vector<ViewedPose> changes;  ///< ascending by thing: those that are not as in the frame before
  std::vector<ViewedLink> links;
  std::vector<ViewedMap> maps;
};

/// Frames of a run as they come, never more than the settings allow. What is kept in the end does not depend on the
/// moment at which something had to go, nor on how many frames were to come: of every link the strongest paths, as many
/// for all links, and every so many frames.
class ViewerFrames {
 public:
  ViewerFrames(std::size_t map_values_per_frame, const ViewerSettings& settings);

  void add(const Scene& scene, const Frame& frame, const FrameResult& result);
  void add(std::span<const RadioMap> maps, const CombinedMap& combined, bool has_noise);

  const std::vector<ViewedFrame>& frames() const { return frames_; }
  const ViewedSurfaces& surfaces() const { return surfaces_; }
  std::size_t seen() const { return seen_; }  ///< frames, those that were left out among them
  /// What was left out, a line each.
  std::vector<std::string> notices() const;

 private:
  ViewedLink view_of_link(const Scene& scene, const LinkResult& link);
  void keep_bounds();
  void limit_paths();
  void thin_frames();
  bool can_be_thinned() const { return frames_.size() > 1; }
  std::size_t links() const;
  std::size_t poses() const;
  std::size_t rays(std::size_t most_per_link) const;
  std::size_t map_values() const;

  ViewerSettings settings_;
  std::size_t step_ = 1;       // every so many frames is kept
  std::size_t map_step_ = 1;   // along each axis of a grid
  std::size_t list_step_ = 1;  // of the longest list
  std::size_t seen_ = 0;
  std::size_t paths_per_link_ = std::numeric_limits<std::size_t>::max();
  std::size_t most_links_ = 0;  // in a frame that had too many
  bool keeps_last_ = false;
  std::vector<ViewedFrame> frames_;
  ViewedSurfaces surfaces_;        // also those of paths that were left out since
  std::vector<ViewedPose> last_;   // of every thing
  std::vector<ViewedPose> carry_;  // changes of frames that were dropped since the last kept one
};

}  // namespace dcem::io
