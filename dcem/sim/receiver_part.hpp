#pragma once
/// A run in parts: whose links each part has in a frame.
///
/// Every receiver is in one part, and the parts agree on it, because they cut the same list in the same places. What a
/// link brings does not depend on it; what it costs does. Where links have a range, receivers that are near each other
/// have transmitters in common, each of which is looked from once a frame and part: they are taken in the order of a
/// curve that stays near itself (Morton 1966: the bits of the two numbers of a square, in turns), and the list is cut
/// where its parts have as many links. Otherwise every part has all transmitters, and the receivers are dealt out.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "dcem/geometry/vector.hpp"
#include "dcem/sim/settings.hpp"

namespace dcem {

/// Takes away the links of receivers of other parts. `chosen`: by receiver, the transmitters that it has links with;
/// `receivers_m`: where each is, none where it is absent.
void keep_part(const ReceiverPart& part, std::optional<double> range_m,
               std::span<const std::optional<Vec3>> receivers_m, std::vector<std::vector<std::uint32_t>>& chosen);

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/sim/receiver_part_bodies.hpp"
#endif
