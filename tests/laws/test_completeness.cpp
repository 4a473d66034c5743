/// Exact discovery finds every path: compared with a second tracer that tries everything and prunes nothing.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "tests/laws/independent_tracer.hpp"
#include "tests/support/all_tests.hpp"

namespace test_completeness {

using namespace dcem;
using namespace dcem::test;

namespace {

struct Count {
  std::size_t compared = 0, doubtful = 0;
};

std::string without_transmissions(const OwnPath& path) {
  OwnPath mirrors;
  for (std::size_t index = 0; index < path.kinds.size(); ++index) {
    if (path.kinds[index] != 'R') continue;
    mirrors.kinds += 'R';
    mirrors.patches.push_back(path.patches[index]);
  }
  return mirrors.name();
}

/// 0 missing, 0 extra, and the same points. Candidates whose margins are below what rounding decides are left out on
/// both sides and counted.
void check_complete(const RandomRoom& room, int max_reflections, int max_transmissions, Count& count) {
  const OwnSearch own =
      IndependentTracer(room.patches, max_reflections, max_transmissions).search(room.transmitter_m, room.receiver_m);
  const std::set<std::string> doubtful(own.doubtful.begin(), own.doubtful.end());
  const Scene scene = scene_through_files(room.patches);
  const auto patch_of = patch_of_facet(scene, room.patches);
  REQUIRE(std::find(patch_of.begin(), patch_of.end(), room.patches.size()) == patch_of.end());
  std::map<std::string, OwnPath> found;
  for (const PathContribution& path :
       paths_between(scene, room.transmitter_m, room.receiver_m, law_settings(max_reflections, max_transmissions))) {
    const OwnPath in_own = in_patches(path.path, patch_of);
    if (doubtful.contains(without_transmissions(in_own))) continue;
    CHECK_MESSAGE(found.emplace(in_own.name(), in_own).second, "reported twice: " << in_own.name());
  }
  for (const OwnPath& path : own.paths) {
    const auto partner = found.find(path.name());
    CHECK_MESSAGE(partner != found.end(), "missing: " << path.name());
    if (partner == found.end()) continue;
    // 1e-10 m: double against long double at 15 m, magnified by flat angles.
    CHECK(std::fabs(partner->second.length - path.length) < 1e-10L);
    for (std::size_t index = 0; index < path.points.size(); ++index) {
      CHECK(glm::length(partner->second.points[index] - path.points[index]) < 1e-9L);
    }
    found.erase(partner);
    ++count.compared;
  }
  for (const auto& [name, path] : found) FAIL_CHECK("extra: " << name);
  count.doubtful += doubtful.size();
}

void report(const Count& count, std::size_t least) {
  MESSAGE(count.compared << " paths compared, " << count.doubtful << " candidates left out for their margins");
  CHECK(count.compared > least);
  CHECK(count.doubtful * 500 < count.compared);
}

}  // namespace

TEST_CASE("exact discovery finds all paths and no other: random rooms, three reflections, two transmissions") {
  Count count;
  for (std::uint64_t seed = 1; seed <= all_or(400U, 100U); ++seed) {
    CAPTURE(seed);
    check_complete(random_room(10'000 + seed, 1 + seed % 5, seed % 2), 3, 2, count);
  }
  report(count, all_or(20'000U, 5'000U));
}

TEST_CASE("exact discovery finds all paths and no other: many surfaces, two reflections, ten transmissions") {
  Count count;
  for (std::uint64_t seed = 1; seed <= all_or(120U, 30U); ++seed) {
    CAPTURE(seed);
    check_complete(random_room(20'000 + seed, 12, 3), 2, 10, count);
  }
  report(count, all_or(2500U, 600U));
}

TEST_CASE("exact discovery finds all paths and no other: few surfaces, five reflections") {
  Count count;
  for (std::uint64_t seed = 1; seed <= all_or(60U, 15U); ++seed) {
    CAPTURE(seed);
    RandomRoom room = random_room(30'000 + seed, 1, 0);
    room.patches.erase(room.patches.begin() + 5);  // no ceiling
    check_complete(room, 5, 1, count);
  }
  report(count, all_or(3000U, 700U));
}

TEST_CASE("exact discovery finds all paths and no other: loose tilted sheets without a room") {
  Count count;
  for (std::uint64_t seed = 1; seed <= all_or(600U, 150U); ++seed) {
    CAPTURE(seed);
    RandomRoom room = random_room(40'000 + seed, 12, 0);
    room.patches.erase(room.patches.begin(), room.patches.begin() + 6);
    check_complete(room, 3, 3, count);
  }
  report(count, all_or(1000U, 250U));
}

TEST_CASE("exact discovery finds all paths and no other: furnished storeys with shared planes and edges") {
  Count count;
  for (std::uint64_t seed = 1; seed <= all_or(120U, 30U); ++seed) {
    CAPTURE(seed);
    check_complete(furnished_room(45'000 + seed), 3, 3, count);
  }
  report(count, all_or(4000U, 1000U));
}

}  // namespace test_completeness
