/// A device follows another one while it comes to where that one has been, going the same way.
#include "dcem/paths/halves/driven_ways.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "dcem/core/constants.hpp"
#include "tests/paths/small_scenes.hpp"

namespace test_driven_ways {

using namespace dcem;
using namespace dcem::test;

namespace {

/// Where a device is at a moment, in frames; none: nowhere.
using Drive = std::function<std::optional<Vec3>(int)>;

struct Roles {
  bool has_followers = false, follows = false;

  friend bool operator==(const Roles&, const Roles&) = default;
};

/// What each device has been in any of the frames.
std::vector<Roles> roles(const std::vector<Drive>& drives, int frames) {
  DrivenWays ways;
  std::vector<Roles> result(drives.size());
  for (int frame = 0; frame < frames; ++frame) {
    for (std::size_t device = 0; device < drives.size(); ++device) ways.note(device, drives[device](frame));
    ways.next_frame();
    for (std::size_t device = 0; device < drives.size(); ++device) {
      result[device].has_followers = result[device].has_followers || ways.has_followers(device);
      result[device].follows = result[device].follows || ways.follows(device);
    }
  }
  return result;
}

/// Straight on from a point at frame 0.
Drive straight(const Vec3& from_m, const Vec3& step_m) {
  return [=](int frame) { return std::optional(from_m + static_cast<double>(frame) * step_m); };
}

constexpr Roles first{true, false}, middle{true, true}, last{false, true}, alone{};
using AllRoles = std::vector<Roles>;

}  // namespace

TEST_CASE("of those who drive one behind the other all but the last have followers, in any direction, at any speed") {
  Draw draw(1);
  for (int round = 0; round < 300; ++round) {
    CAPTURE(round);
    const double turn_rad = round < 16 ? round * pi / 8.0 : draw.between(0.0, 2.0 * pi);
    const Vec3 towards(std::cos(turn_rad), std::sin(turn_rad), 0.0), aside(-towards.y, towards.x, 0.0);
    const Vec3 at_m = draw.inside(Vec3(-500, -500, 0), Vec3(500, 500, 5)), step_m = draw.between(0.76, 2.0) * towards;
    const auto behind = [&](double later) {
      const Vec3 hair_m = draw.between(-0.18, 0.18) * aside + Vec3(0, 0, draw.between(-0.04, 0.04));
      return straight(at_m - later * step_m + hair_m, step_m);
    };
    CHECK(roles({behind(0), behind(5), behind(25.5)}, 60) == AllRoles{first, middle, last});
    CHECK(roles({behind(8.3), behind(0)}, 60) == AllRoles{last, first});
  }
}

TEST_CASE("nobody follows who comes towards one, crosses, drives beside, above, in jumps, much later, or stands") {
  const Vec3 start_m(3.2, -1.7, 3.98), step_m(1.4, 0.0, 0.0);
  const Drive leader = straight(start_m, step_m);
  const auto nobody = [&](const Drive& other) {
    CHECK(roles({leader, other}, 200) == AllRoles{alone, alone});
    CHECK(roles({other, leader}, 200) == AllRoles{alone, alone});
  };
  nobody(straight(start_m + Vec3(200, 0, 0), -step_m));
  for (const double angle_rad : {0.5, 1.0, 1.5, pi / 2.0, 2.5}) {
    const Vec3 across_m = 1.4 * Vec3(std::cos(angle_rad), std::sin(angle_rad), 0.0);
    nobody(straight(start_m + Vec3(60, 0, 0) - 50.0 * across_m, across_m));
  }
  nobody(straight(start_m - Vec3(15, 0.6, 0), step_m));
  nobody(straight(start_m - Vec3(15, 0, 1.5), step_m));
  nobody(straight(start_m - Vec3(15, 0, 0), Vec3(0.0)));
  nobody(straight(start_m - Vec3(1.4 * 30, 0, 0), step_m));
  nobody(straight(start_m - Vec3(100, 0, 0), Vec3(2.2, 0, 0)));
  nobody([](int) { return std::nullopt; });
  // Side by side, and in one and the same place.
  nobody(straight(start_m + Vec3(0, 0.3, 0), step_m));
  nobody(leader);
  // Over one's own way again.
  CHECK(roles({[&](int frame) { return std::optional(start_m + Vec3(1.4 * (frame % 20), 0, 0)); }}, 60) ==
        AllRoles{alone});
}

TEST_CASE("who follows counts from the third frame on and some frames longer, and ways are forgotten") {
  DrivenWays ways;
  const auto frame = [&](double first_m, const std::optional<Vec3>& second_m) {
    ways.note(0, Vec3(first_m, 0, 0));
    ways.note(1, second_m);
    ways.next_frame();
  };
  int at = 0;
  for (; at < 12; ++at) frame(1.4 * at, std::nullopt);
  for (; at < 15; ++at) frame(1.4 * at, Vec3(1.4 * (at - 10), 0, 0));  // the first of them is no step
  CHECK(!ways.has_followers(0));
  frame(1.4 * at, Vec3(1.4 * (at - 10), 0, 0));
  CHECK(ways.has_followers(0));
  CHECK(ways.follows(1));
  CHECK(!ways.follows(0));
  CHECK(!ways.has_followers(1));
  CHECK(!ways.has_followers(2));  // never heard of
  for (++at; at < 25; ++at) frame(1.4 * at, std::nullopt);
  CHECK(ways.has_followers(0));
  frame(1.4 * ++at, std::nullopt);
  frame(1.4 * ++at, std::nullopt);
  CHECK(!ways.has_followers(0));
  CHECK(ways.size() > 20);
  for (int later = 0; later < 60; ++later) frame(1.4 * at, std::nullopt);
  CHECK(ways.size() == 0);
}

}  // namespace test_driven_ways
