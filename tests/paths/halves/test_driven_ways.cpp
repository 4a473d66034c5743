/// A device is followed while another one comes by where it has been, going the same way.
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

/// Which of the devices have been followed in any of the frames.
std::vector<bool> followed(const std::vector<Drive>& drives, int frames) {
  DrivenWays ways;
  std::vector<bool> result(drives.size(), false);
  for (int frame = 0; frame < frames; ++frame) {
    for (std::size_t device = 0; device < drives.size(); ++device) ways.note(device, drives[device](frame));
    ways.next_frame();
    for (std::size_t device = 0; device < drives.size(); ++device) {
      result[device] = result[device] || ways.is_followed(device);
    }
  }
  return result;
}

/// Straight on from a point at frame 0.
Drive straight(const Vec3& from_m, const Vec3& step_m) {
  return [=](int frame) { return std::optional(from_m + static_cast<double>(frame) * step_m); };
}

using Followed = std::vector<bool>;

}  // namespace

TEST_CASE("of those who drive one behind the other all but the last are followed, in any direction, at any speed") {
  Draw draw(1);
  for (int round = 0; round < 300; ++round) {
    const double turn_rad = round < 16 ? round * pi / 8.0 : draw.between(0.0, 2.0 * pi);
    const Vec3 towards(std::cos(turn_rad), std::sin(turn_rad), 0.0), aside(-towards.y, towards.x, 0.0);
    const Vec3 at_m = draw.inside(Vec3(-500, -500, 0), Vec3(500, 500, 3)), step_m = draw.between(0.3, 3.0) * towards;
    const auto behind = [&](double way_m) {
      return straight(at_m - way_m * towards + draw.between(-0.4, 0.4) * aside, step_m);
    };
    const int frames = static_cast<int>(60.0 / glm::length(step_m));
    CHECK(followed({behind(0.0), behind(12.0), behind(30.0)}, frames) == Followed{true, true, false});
    CHECK(followed({behind(30.0), behind(0.0)}, frames) == Followed{false, true});
  }
}

TEST_CASE(
    "nobody is followed by those who come towards him, cross, drive in another lane, jump, stand or come too late") {
  const Vec3 start_m(3.2, -1.7, 1.5), step_m(1.4, 0.0, 0.0);
  const Drive first = straight(start_m, step_m);
  const auto nobody = [&](const Drive& other, int frames = 80) {
    CHECK(followed({first, other}, frames) == Followed{false, false});
  };
  nobody(straight(start_m + Vec3(100, 0, 0), -step_m));
  nobody(straight(start_m + Vec3(30, -40, 0), Vec3(0, 1.4, 0)));
  nobody(straight(start_m - Vec3(15, 3.5, 0), step_m));
  nobody(straight(start_m - Vec3(15, 0, 9), step_m));
  nobody(straight(start_m - Vec3(15, 0, 0), Vec3(0.0)));
  nobody([&](int frame) { return std::optional(start_m + Vec3(6.0 * frame - 100.0, 0, 0)); });
  nobody([](int) { return std::nullopt; });
  nobody([&](int frame) { return std::optional(start_m + Vec3(1.4 * (frame - 650), 0, 0)); }, 700);
  // Over one's own way again.
  CHECK(followed({[&](int frame) { return std::optional(start_m + Vec3(1.4 * (frame % 20), 0, 0)); }}, 60) ==
        Followed{false});
}

TEST_CASE("who was followed is so for some seconds more, and a way is forgotten after a minute") {
  DrivenWays ways;
  const auto frame = [&](double first_m, const std::optional<Vec3>& second_m) {
    ways.note(0, Vec3(first_m, 0, 0));
    ways.note(1, second_m);
    ways.next_frame();
  };
  int at = 0;
  for (; at < 20; ++at) frame(1.4 * at, Vec3(1.4 * (at - 10), 0, 0));
  CHECK(ways.is_followed(0));
  CHECK(!ways.is_followed(1));
  CHECK(!ways.is_followed(2));  // never heard of
  for (; at < 49; ++at) frame(1.4 * at, std::nullopt);
  CHECK(ways.is_followed(0));
  for (; at < 52; ++at) frame(1.4 * at, std::nullopt);
  CHECK(!ways.is_followed(0));
  const std::size_t pieces = ways.size();
  CHECK(pieces > 50);
  for (; at < 1000; ++at) frame(1.4 * 52, std::nullopt);
  CHECK(ways.size() == 0);
}

}  // namespace test_driven_ways
