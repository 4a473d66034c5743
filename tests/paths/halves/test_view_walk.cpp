/// What outlines fill and show on a face of a view, beside the pixels looked at one by one; and every level of
/// instructions says the same.
#include "dcem/paths/halves/view_walk.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "dcem/core/instruction_set.hpp"
#include "dcem/core/random.hpp"
#include "dcem/geometry/vector.hpp"
#include "dcem/paths/halves/view_kernels.hpp"

namespace test_view_walk {

using namespace dcem;

namespace {

constexpr int pixels = 48, tiles = pixels / detail::FacePixels::tile_pixels;

struct Numbers {
  RandomStream random;
  double between(double low, double high) { return low + (high - low) * random.uniform(); }
};

struct Face {
  std::vector<float> nearness = std::vector<float>(pixels * pixels, 0.0F);
  std::vector<float> tile_nearness = std::vector<float>(tiles * tiles, 0.0F);
  std::vector<char> tile_is_old = std::vector<char>(tiles * tiles, 0);

  detail::FacePixels view() { return {nearness.data(), tile_nearness.data(), tile_is_old.data(), pixels, tiles}; }
  friend bool operator==(const Face&, const Face&) = default;
};

/// A convex polygon in a plane in front of the face, which looks along z from the origin.
struct Polygon {
  detail::FaceOutline outline;
  std::vector<std::array<double, 2>> corners;  ///< in pixels
  detail::FaceNearness nearness;

  explicit Polygon(Numbers& numbers) {
    const double depth_m = numbers.between(1.0, 20.0), by_x = numbers.between(-0.6, 0.6),
                 by_y = numbers.between(-0.6, 0.6);
    const double size = std::pow(10.0, numbers.between(-1.5, 0.3)), turn = numbers.between(0.0, 6.0);
    const double middle_x = numbers.between(-0.9, 0.9), middle_y = numbers.between(-0.9, 0.9);
    const int count = 3 + static_cast<int>(numbers.between(0.0, 6.0));
    // The plane z = depth + by_x·x + by_y·y has 1/z = (1 − by_x·x/z − by_y·y/z)/depth.
    const auto inverse_at = [&](double x, double y) { return (1.0 - by_x * x - by_y * y) / depth_m; };
    bool is_in_front = true;
    for (int at = 0; at < count; ++at) {
      const double angle = turn + 6.283185307 * at / count;
      const double x = middle_x + size * std::cos(angle), y = middle_y + size * std::sin(angle),
                   inverse = inverse_at(x, y);
      is_in_front = is_in_front && inverse > 1e-3;
      outline.add({x / inverse, y / inverse, 1.0 / inverse});
      corners.push_back({(x + 1.0) * 0.5 * pixels, (y + 1.0) * 0.5 * pixels});
    }
    const double per_pixel = 2.0 / pixels;
    nearness = {-by_x / depth_m * per_pixel, -by_y / depth_m * per_pixel, (1.0 + by_x + by_y) / depth_m};
    if (!is_in_front) {
      outline = {};
      corners.clear();
    }
    outline.clip(1.02);
  }
  double nearness_at(double x, double y) const {
    return nearness.by_column * x + nearness.by_row * y + nearness.at_origin;
  }
  /// How far inside the polygon a place is, in pixels; negative outside.
  double depth_inside(double x, double y) const {
    double least = 1e9;
    for (std::size_t at = 0; at < corners.size(); ++at) {
      const auto &from = corners[at], &to = corners[(at + 1) % corners.size()];
      const double length = std::hypot(to[0] - from[0], to[1] - from[1]);
      least = std::min(least, ((to[0] - from[0]) * (y - from[1]) - (to[1] - from[1]) * (x - from[0])) / length);
    }
    return least;
  }
  /// Of the four corners of a pixel the one that is least inside.
  double pixel_inside(int row, int column) const {
    return std::min({depth_inside(column, row), depth_inside(column + 1, row), depth_inside(column, row + 1),
                     depth_inside(column + 1, row + 1)});
  }
};

}  // namespace

TEST_CASE("an outline fills the pixels that lie in it, and with no more nearness than it has there") {
  Numbers numbers{RandomStream(11)};
  std::size_t filled = 0, outside = 0, missed = 0, too_near = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const Polygon polygon(numbers);
    if (polygon.outline.size() < 3) continue;
    Face face;
    detail::view_cover(face.view(), face.nearness.data(), polygon.outline, polygon.nearness);
    for (int row = 0; row < pixels; ++row) {
      for (int column = 0; column < pixels; ++column) {
        const float held = face.nearness[static_cast<std::size_t>(row * pixels + column)];
        const double inside = polygon.pixel_inside(row, column);
        double least = 1e9;
        for (const int x : {0, 1}) {
          for (const int y : {0, 1}) least = std::min(least, polygon.nearness_at(column + x, row + y));
        }
        filled += held > 0.0F ? 1 : 0;
        outside += held > 0.0F && inside < 0.0 ? 1 : 0;
        too_near += static_cast<double>(held) > std::max(least, 0.0) ? 1 : 0;
        missed += held == 0.0F && inside > 0.05 && least > 0.0 ? 1 : 0;
      }
    }
  }
  CHECK(filled > 200'000);
  CHECK(outside == 0);
  CHECK(too_near == 0);
  CHECK(missed == 0);
}

TEST_CASE("two planes together fill with the farther one, and nothing is taken back") {
  Numbers numbers{RandomStream(12)};
  for (int trial = 0; trial < 500; ++trial) {
    const Polygon polygon(numbers), other(numbers);
    Face one, second, both, after;
    detail::view_cover(one.view(), one.nearness.data(), polygon.outline, polygon.nearness);
    detail::view_cover(second.view(), second.nearness.data(), polygon.outline, other.nearness);
    detail::view_cover_both(both.view(), both.nearness.data(), polygon.outline, polygon.nearness, other.nearness);
    after = one;
    detail::view_cover(after.view(), after.nearness.data(), other.outline, other.nearness);
    bool is_farther = true, is_kept = true;
    for (std::size_t at = 0; at < both.nearness.size(); ++at) {
      is_farther = is_farther && both.nearness[at] == std::min(one.nearness[at], second.nearness[at]);
      is_kept = is_kept && after.nearness[at] >= one.nearness[at];
    }
    CHECK(is_farther);
    CHECK(is_kept);
  }
}

TEST_CASE("an outline is seen where a pixel in it holds less, and not where all that it touches hold more") {
  Numbers numbers{RandomStream(13)};
  std::size_t seen = 0, hidden = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const Polygon polygon(numbers);
    if (polygon.outline.size() < 3) continue;
    Face face;
    bool must_show = false, must_hide = true;
    const int open_row = static_cast<int>(numbers.between(0, pixels)),
              open_column = static_cast<int>(numbers.between(0, pixels));
    for (int row = 0; row < pixels; ++row) {
      for (int column = 0; column < pixels; ++column) {
        const bool is_open = row == open_row && column == open_column;
        face.nearness[static_cast<std::size_t>(row * pixels + column)] = is_open ? 0.0F : 10.0F;
        const double middle_inside = polygon.depth_inside(column + 0.5, row + 0.5);
        if (is_open && middle_inside > 0.0 && polygon.nearness_at(column + 0.5, row + 0.5) > 1e-3) must_show = true;
        if (is_open && middle_inside > -0.8) must_hide = false;  // more than half a pixel's diagonal away
      }
    }
    std::ranges::fill(face.tile_is_old, char{1});
    const bool is_seen = detail::view_shows(face.view(), polygon.outline, polygon.nearness, 1.0);
    if (must_show) CHECK(is_seen);
    if (must_hide) CHECK(!is_seen);
    seen += must_show ? 1 : 0;
    hidden += must_hide ? 1 : 0;
  }
  CHECK(seen > 200);
  CHECK(hidden > 1'000);
}

#if defined(DCEM_ENGINE)

TEST_CASE("every level of instructions fills the same bits and gives the same answers") {
  const InstructionSet before = instruction_set();
  const auto look = [](InstructionSet set) {
    select_instruction_set(set);
    const detail::ViewKernels& kernels = detail::view_kernels();
    Numbers numbers{RandomStream(14)};
    Face face;
    std::vector<char> answers;
    for (int trial = 0; trial < 3000; ++trial) {
      if (trial % 40 == 0) face = Face();
      const Polygon polygon(numbers), other(numbers);
      answers.push_back(kernels.shows(face.view(), polygon.outline, polygon.nearness, 1.001) ? 1 : 0);
      const double x = numbers.between(-9, 9), y = numbers.between(-9, 9), z = numbers.between(1, 12);
      answers.push_back(kernels.hides_box(face.view(), {x, y, z}, {x + 1, y + 2, z + 1}, 1.001) ? 1 : 0);
      if (polygon.outline.size() < 3) continue;
      if (trial % 3 == 0)
        kernels.cover_both(face.view(), face.nearness.data(), polygon.outline, polygon.nearness, other.nearness);
      else
        kernels.cover(face.view(), face.nearness.data(), polygon.outline, polygon.nearness);
      for (const float held : face.nearness)
        answers.push_back(static_cast<char>(std::bit_cast<std::uint32_t>(held) % 127));
    }
    return std::pair(answers, face);
  };
  const auto expected = look(InstructionSet::baseline);
  CHECK(std::ranges::count(expected.first, 0) > 0);
  for (const InstructionSet set : {InstructionSet::avx2, InstructionSet::avx512}) {
    if (is_supported(set)) CHECK((look(set) == expected));
  }
  select_instruction_set(before);
}

#endif

}  // namespace test_view_walk
