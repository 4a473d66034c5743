#include <doctest/doctest.h>

#include "dcem/world/frame.hpp"

namespace test_frame {

using namespace dcem;

TEST_CASE("a body is there unless it is said to be away") {
  CHECK(BodyState{}.present);
  CHECK(BodyState{} == BodyState{});
  CHECK(Frame{}.bodies.empty());
  CHECK(ChangeSet{}.moved.empty());
}

TEST_CASE("two states are equal only where presence, pose and velocity are") {
  BodyState away, elsewhere, faster;
  away.present = false;
  elsewhere.placement.pose.roll_rad = 1e-300;
  faster.placement.velocity.angular_rad_per_s.z = 1.0;
  for (const BodyState& other : {away, elsewhere, faster}) CHECK_FALSE(BodyState{} == other);
}

}  // namespace test_frame
