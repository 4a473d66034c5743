#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

#include "dcem/accel/binary/refit.hpp"

namespace test_refit {

using namespace dcem;

namespace {

/// Root 0; 2 and 3 below it; 4, 5 below 2; 6, 7 below 3. Slots 4 to 7 are leaves, slot 1 is unused.
const std::vector<std::uint32_t> parents{no_node, free_slot, 0, 0, 2, 2, 3, 3};

using Slots = std::vector<std::uint32_t>;

/// The slots that a sweep visits and, of these, those whose box it asks to compute anew.
struct Swept {
  Slots visited, recomputed;
  RefitReport report;
};

/// Recomputed boxes become others, but for those in `same`.
Swept swept(DirtyPaths& paths, const Slots& same = {}) {
  Swept result;
  result.report = paths.sweep(parents, [&](std::uint32_t slot, bool stale) {
    result.visited.push_back(slot);
    if (!stale) return false;
    result.recomputed.push_back(slot);
    return std::find(same.begin(), same.end(), slot) == same.end();
  });
  return result;
}

DirtyPaths fresh() {
  DirtyPaths paths;
  paths.reserve(parents.size());
  return paths;
}

}  // namespace

TEST_CASE("without marks nothing is visited") {
  DirtyPaths paths = fresh();
  const Swept nothing = swept(paths);
  CHECK(nothing.visited.empty());
  CHECK(nothing.report == RefitReport{});
}

TEST_CASE("one leaf makes one path, from the leaf to the root") {
  DirtyPaths paths = fresh();
  paths.mark(5, parents);
  const Swept one = swept(paths);
  CHECK(one.visited == Slots{5, 2, 0});
  CHECK(one.recomputed == one.visited);
  CHECK(one.report == RefitReport{3, 3, 3});
  CHECK(swept(paths).visited.empty());
}

TEST_CASE("a tree that is a single leaf is a path of one") {
  DirtyPaths paths;
  paths.reserve(1);
  paths.mark(0, Slots{no_node});
  Slots visited;
  paths.sweep(Slots{no_node}, [&](std::uint32_t slot, bool) {
    visited.push_back(slot);
    return true;
  });
  CHECK(visited == Slots{0});
}

TEST_CASE("paths that join are visited once above, after both children") {
  DirtyPaths paths = fresh();
  for (const std::uint32_t leaf : {7U, 4U, 5U, 4U}) paths.mark(leaf, parents);
  const Swept three = swept(paths);
  CHECK(three.visited == Slots{7, 3, 4, 5, 2, 0});
  CHECK(three.recomputed == three.visited);
}

TEST_CASE("above a box that did not change nothing is recomputed, all is visited, and the marks are gone") {
  DirtyPaths paths = fresh();
  paths.mark(4, parents);
  paths.mark(6, parents);
  const Swept same = swept(paths, {4, 6});
  CHECK(same.recomputed == Slots{4, 6});
  CHECK(same.visited == Slots{4, 2, 6, 3, 0});
  CHECK(same.report == RefitReport{5, 2, 0});
  paths.mark(4, parents);
  CHECK(swept(paths).recomputed == Slots{4, 2, 0});
}

TEST_CASE("the early out may come half way up") {
  DirtyPaths paths = fresh();
  paths.mark(4, parents);
  const Swept half = swept(paths, {2});
  CHECK(half.visited == Slots{4, 2, 0});
  CHECK(half.recomputed == Slots{4, 2});
  CHECK(half.report == RefitReport{3, 2, 1});
}

TEST_CASE("one changed child is enough to recompute the parent") {
  DirtyPaths paths = fresh();
  for (const std::uint32_t leaf : {4U, 7U}) paths.mark(leaf, parents);
  const Swept two = swept(paths, {7});
  CHECK(two.visited == Slots{4, 2, 7, 3, 0});
  CHECK(two.recomputed == Slots{4, 2, 7, 0});
  CHECK(two.report == RefitReport{5, 4, 3});
}

}  // namespace test_refit
