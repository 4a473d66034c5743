#pragma once
/// The state of the world at an instant, and what differs from the state before.
#include <cstddef>
#include <string>
#include <vector>

#include "dcem/core/ids.hpp"
#include "dcem/world/motion.hpp"

namespace dcem {

/// One body in a frame.
struct BodyState {
  bool present = true;
  Placement placement;
  std::string occupant = {};  ///< of a slot: the object that is there in this frame; otherwise empty

  friend bool operator==(const BodyState&, const BodyState&) = default;
};

/// Poses and velocities of all bodies at an instant. A frame is a value: it never changes once made.
struct Frame {
  std::size_t index = 0;
  double time_s = 0.0;
  std::vector<BodyState> bodies;  ///< one per body of the scene; entry 0 is the standing scenery
};

/// What `Scene::apply` changed. Updaters read this and look at nothing else.
struct ChangeSet {
  std::vector<BodyId> moved;     ///< bodies whose pose or presence changed, ascending
  std::vector<BodyId> replaced;  ///< slots in which another object is than before, ascending
};

}  // namespace dcem
