/// Exchanging transmitter and receiver changes nothing but the direction of the arrows.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "tests/support/law_scenes.hpp"

namespace test_reciprocity {

using namespace dcem;
using namespace dcem::test;

namespace {

std::string name(const Path& path, bool backwards) {
  std::vector<std::string> parts;
  for (const Interaction& interaction : path.interactions) {
    parts.push_back(static_cast<char>(interaction.kind) + std::to_string(interaction.facet.value) + " ");
  }
  if (backwards) std::reverse(parts.begin(), parts.end());
  return std::accumulate(parts.begin(), parts.end(), std::string());
}

}  // namespace

TEST_CASE("reciprocity: the transfer matrix of the reversed link is the transpose, for every path up to order 4") {
  std::size_t compared = 0, mixed = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    CAPTURE(seed);
    const RandomRoom room = random_room(100 + seed, 2, 1);
    const Scene scene = scene_through_files(room.patches);
    const auto forth = paths_between(scene, room.transmitter_m, room.receiver_m, law_settings(4, 2));
    const auto back = paths_between(scene, room.receiver_m, room.transmitter_m, law_settings(4, 2));
    CHECK(forth.size() == back.size());
    std::map<std::string, const PathContribution*> by_name;
    for (const PathContribution& path : back) by_name[name(path.path, true)] = &path;
    double largest = 0.0;
    for (const PathContribution& path : forth) largest = std::max(largest, std::sqrt(norm_squared(path.transfer)));
    for (const PathContribution& path : forth) {
      const auto found = by_name.find(name(path.path, false));
      REQUIRE_MESSAGE(found != by_name.end(), "no reversed path for " << name(path.path, false));
      const PathContribution& other = *found->second;
      ++compared;
      const std::string letters = kinds(path);
      mixed += letters.find('R') != std::string::npos && letters.find('T') != std::string::npos;
      // Relative to the largest entry of the link. 1e-12 for the coefficients; the phase −kL adds k times the rounding
      // error of a length that is summed the other way round: 600 rad/m · 4e-15 m per 10 m.
      const double phase_error = 590.0 * 4e-16 * path.path.length_m;
      const ComplexMatrix2 reversed = transposed(other.transfer);
      for (std::size_t entry = 0; entry < 4; ++entry) {
        const Complex difference = path.transfer(entry / 2, entry % 2) - reversed(entry / 2, entry % 2);
        CHECK(std::abs(difference) <= (1e-12 + phase_error) * largest);
      }
      CHECK(path.path.length_m == doctest::Approx(other.path.length_m).epsilon(1e-14));
      CHECK(path.departure.azimuth_rad == doctest::Approx(other.arrival.azimuth_rad).epsilon(1e-12));
      CHECK(path.departure.zenith_rad == doctest::Approx(other.arrival.zenith_rad).epsilon(1e-12));
      const auto& points = path.path.interactions;
      for (std::size_t index = 0; index < points.size(); ++index) {
        // 1e-11 m: the image is folded from the other end; flat bounces magnify 1e-15 a little.
        CHECK(glm::distance(points[index].point_m, other.path.interactions[points.size() - 1 - index].point_m) < 1e-11);
      }
    }
  }
  // The law would hold for no path at all; there must be many, with both kinds of touch.
  CHECK(compared > 5000);
  CHECK(mixed > 1000);
}

}  // namespace test_reciprocity
