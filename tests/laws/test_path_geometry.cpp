/// Every reported path is a path of light: checked leg by leg, without images and without the engine's geometry.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/laws/independent_tracer.hpp"

namespace test_path_geometry {

using namespace dcem;
using namespace dcem::test;

namespace {

/// The ends and reflection points of a path, and on which patch each of these points lies.
struct Corners {
  std::vector<LongVec> points;
  std::vector<std::size_t> mirrors;  ///< of points[1], points[2], …
};

Corners corners_of(const OwnPath& path, const Vec3& from_m, const Vec3& to_m) {
  Corners corners{{LongVec(from_m)}, {}};
  for (std::size_t index = 0; index < path.kinds.size(); ++index) {
    if (path.kinds[index] != 'R') continue;
    corners.points.push_back(path.points[index]);
    corners.mirrors.push_back(path.patches[index]);
  }
  corners.points.emplace_back(to_m);
  return corners;
}

long double length_of(const std::vector<LongVec>& points) {
  long double length = 0.0L;
  for (std::size_t leg = 1; leg < points.size(); ++leg) length += glm::length(points[leg] - points[leg - 1]);
  return length;
}

long double shortest_leg(const std::vector<LongVec>& points) {
  long double shortest = std::numeric_limits<long double>::infinity();
  for (std::size_t leg = 1; leg < points.size(); ++leg) {
    shortest = std::min(shortest, glm::length(points[leg] - points[leg - 1]));
  }
  return shortest;
}

void check_law_of_reflection(const Corners& corners, const std::vector<LongPatch>& patches) {
  for (std::size_t index = 0; index < corners.mirrors.size(); ++index) {
    const LongPatch& patch = patches[corners.mirrors[index]];
    const LongVec& point = corners.points[index + 1];
    const LongVec in = glm::normalize(point - corners.points[index]);
    const LongVec out = glm::normalize(corners.points[index + 2] - point);
    CHECK(std::fabs(height(patch, point)) < 1e-9L);
    // 1e-9 m: a point on the rim may round to the other side.
    CHECK(inside_by(patch, point) > -1e-9L);
    // Both neighbours on one side, and angles equal: the tangential part stays, the normal part turns round. 1e-9 is
    // what the contract promises.
    CHECK(height(patch, corners.points[index]) * height(patch, corners.points[index + 2]) > 0.0L);
    CHECK(glm::length(out - (in - 2.0L * glm::dot(in, patch.normal) * patch.normal)) < 1e-9L);
  }
}

/// Fermat: shifted in their planes, the points make a path that is longer, by the square of the shift.
void check_stationary(const Corners& corners, const std::vector<LongPatch>& patches, Dice& dice) {
  if (corners.mirrors.empty()) return;
  std::vector<LongVec> shifts{LongVec(0.0L)};
  for (const std::size_t mirror : corners.mirrors) {
    const LongVec any(dice.direction());
    shifts.push_back(glm::normalize(any - glm::dot(any, patches[mirror].normal) * patches[mirror].normal));
  }
  shifts.emplace_back(0.0L);
  const auto shifted_length = [&](long double step) {
    std::vector<LongVec> points = corners.points;
    for (std::size_t index = 0; index < points.size(); ++index) points[index] += step * shifts[index];
    return length_of(points);
  };
  const long double step = 1e-4L * shortest_leg(corners.points), at_rest = shifted_length(0.0L);
  const long double growth = shifted_length(step) + shifted_length(-step) - 2.0L * at_rest;
  const long double half_growth = shifted_length(step / 2) + shifted_length(-step / 2) - 2.0L * at_rest;
  // The slope: its own third-order error is (step/leg)² = 1e-8 at most; points rounded to 2e-15 m move it by 1e-15 over
  // the shortest leg.
  const long double slope_tolerance = 1e-7L + 1e-13L / shortest_leg(corners.points);
  CHECK(std::fabs(shifted_length(step) - shifted_length(-step)) / (2.0L * step) < slope_tolerance);
  CHECK(growth > 0.0L);
  // Twice the shift, four times the growth; the next term is of relative order (step/leg)² = 1e-8.
  CHECK(static_cast<double>(growth / half_growth) == doctest::Approx(4.0).epsilon(1e-5));
}

/// Each leg meets exactly the sheets that the path lists, in order, and nothing opaque.
void check_legs(const OwnPath& path, const Vec3& from_m, const Vec3& to_m, const std::vector<LongPatch>& patches) {
  const Corners corners = corners_of(path, from_m, to_m);
  std::size_t listed = 0;
  for (std::size_t leg = 1; leg < corners.points.size(); ++leg) {
    const LongVec &a = corners.points[leg - 1], &b = corners.points[leg];
    std::vector<std::pair<long double, std::size_t>> met;
    for (std::size_t index = 0; index < patches.size(); ++index) {
      if (leg >= 2 && corners.mirrors[leg - 2] == index) continue;
      if (leg - 1 < corners.mirrors.size() && corners.mirrors[leg - 1] == index) continue;
      if (const auto t = meets_patch(a, b, patches[index])) met.emplace_back(*t, index);
    }
    std::sort(met.begin(), met.end());
    for (const auto& [t, index] : met) {
      REQUIRE_MESSAGE(!patches[index].opaque, "an opaque patch stands in a leg of " << path.name());
      REQUIRE(listed < path.kinds.size());
      CHECK(path.kinds[listed] == 'T');
      CHECK(path.patches[listed] == index);
      CHECK(glm::length(path.points[listed] - (a + t * (b - a))) <
            1e-9L);  // rounding of a double at 15 m, and a flat angle
      ++listed;
    }
    if (leg < corners.points.size() - 1) {
      REQUIRE(listed < path.kinds.size());
      CHECK(path.kinds[listed++] == 'R');
    }
  }
  CHECK(listed == path.kinds.size());
}

void check_paths(const RandomRoom& room, const SimulationSettings& settings, std::size_t& checked) {
  const Scene scene = scene_through_files(room.patches);
  const auto patch_of = patch_of_facet(scene, room.patches);
  REQUIRE(std::find(patch_of.begin(), patch_of.end(), room.patches.size()) == patch_of.end());
  const std::vector<LongPatch> patches = long_patches(room.patches);
  Dice dice(77);
  for (const PathContribution& found : paths_between(scene, room.transmitter_m, room.receiver_m, settings)) {
    const OwnPath path = in_patches(found.path, patch_of);
    CAPTURE(path.name());
    const Corners corners = corners_of(path, room.transmitter_m, room.receiver_m);
    check_law_of_reflection(corners, patches);
    check_stationary(corners, patches, dice);
    check_legs(path, room.transmitter_m, room.receiver_m, patches);
    // A sum of up to four legs of 10 m each.
    CHECK(static_cast<double>(length_of(corners.points)) == doctest::Approx(found.path.length_m).epsilon(1e-14));
    CHECK(found.delay_s == doctest::Approx(found.path.length_m / 299'792'458.0).epsilon(1e-14).scale(0.0));
    // Angles point away from the devices, along the first and against the last leg.
    const LongVec out = glm::normalize(corners.points[1] - corners.points[0]);
    const LongVec back = glm::normalize(corners.points[corners.points.size() - 2] - corners.points.back());
    for (const auto& [direction, leg] : {std::pair(found.departure, out), std::pair(found.arrival, back)}) {
      const LongVec told(std::sin(direction.zenith_rad) * std::cos(direction.azimuth_rad),
                         std::sin(direction.zenith_rad) * std::sin(direction.azimuth_rad),
                         std::cos(direction.zenith_rad));
      CHECK(glm::length(told - leg) < 1e-9L);
    }
    ++checked;
  }
}

}  // namespace

TEST_CASE("each path obeys the law of reflection and Fermat's principle, is free, and lists what it crosses") {
  std::size_t checked = 0;
  for (std::uint64_t seed = 1; seed <= 250; ++seed) {
    CAPTURE(seed);
    check_paths(random_room(50'000 + seed, 1 + seed % 4, seed % 3), law_settings(3, 2), checked);
  }
  CHECK(checked > 15'000);
}

TEST_CASE("the same holds for what rays find") {
  std::size_t checked = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    CAPTURE(seed);
    check_paths(random_room(60'000 + seed, 1 + seed % 4, seed % 3), law_settings(3, 2, Discovery::sampled), checked);
  }
  CHECK(checked > 5000);
}

}  // namespace test_path_geometry
