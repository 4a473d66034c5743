#pragma once
/// The ends of a link as fields see them.
#include "dcem/em/antenna/antenna.hpp"
#include "dcem/geometry/vector.hpp"

namespace dcem {

/// One end of a link with its antenna.
struct RadioEnd {
  Vec3 position_m{0.0};  ///< of the antenna's point; of an array its centre
  Vec3 velocity_mps{0.0};
  Antenna antenna{};
  /// The antenna's axes in the world, as columns: the axes of what carries it times the antenna's orientation
  /// (DeviceState::rotation). Where nothing else is said the carrier's axes are the world's.
  Mat3 rotation = rotation_matrix(antenna.orientation);
  double power_dbm = 0.0;  ///< that it sends; not used of a receiver
};

}  // namespace dcem
