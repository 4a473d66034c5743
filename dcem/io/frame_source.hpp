#pragma once
/// The frames of a scenario, one after the other: motions of its objects, and the traffic of its trace.
#include <cstddef>
#include <memory>

#include "dcem/io/scenario.hpp"

namespace dcem::io {

/// Gives the frames of a scenario. Copies what it needs: the scene may be moved out of the scenario meanwhile.
///
/// With a trace it reads that file as it goes. A vehicle takes a free slot of its type when it enters, and keeps it
/// until it leaves. Those that enter in a frame take the lowest free slots in ascending order of their ids; a slot
/// that was left in this very frame is taken last. So a frame depends on the scenario and its number alone.
///
/// An instant within 1e-6 s of a step of the trace is that step. Between two steps positions and speeds are linear and
/// angles take the shortest arc; a vehicle that is in only one of the two is absent.
class FrameSource {
 public:
  /// Throws InputError where the trace cannot be read.
  explicit FrameSource(const Scenario& scenario);
  ~FrameSource();
  FrameSource(FrameSource&&) noexcept;
  FrameSource& operator=(FrameSource&&) noexcept;

  /// The frame `index` of the scenario, for its scene. With a trace, indices must not decrease from call to call; they
  /// may leave frames out. Throws InputError where the trace is no longer the one that was loaded, and
  /// std::invalid_argument where the index decreases or is beyond the scenario's last frame.
  Frame frame(const Scene& scene, std::size_t index);

 private:
  class Player;

  TimeSettings time_;
  std::unique_ptr<Player> player_;  ///< nothing where the scenario has no trace
};

/// Throws InputError, at its place in the scenario file, where a device rides on a vehicle that is in none of the
/// frames [first_frame, last_frame).
void require_attached_devices(const Scenario& scenario, std::size_t first_frame, std::size_t last_frame);

}  // namespace dcem::io
