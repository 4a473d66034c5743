#include <doctest/doctest.h>

#include <vector>

#include "dcem/accel/refit.hpp"

using namespace dcem;

namespace {

/// Root 0; 2 and 3 below it; 4, 5 below 2; 6, 7 below 3. Slots 4 to 7 are leaves, slot 1 is unused.
const std::vector<std::uint32_t> parents{no_node, free_slot, 0, 0, 2, 2, 3, 3};

std::vector<std::uint32_t> swept(DirtyPaths& paths, bool changes = true) {
  std::vector<std::uint32_t> order;
  paths.sweep(parents, [&](std::uint32_t slot) {
    order.push_back(slot);
    return changes;
  });
  return order;
}

DirtyPaths fresh() {
  DirtyPaths paths;
  paths.reserve(parents.size());
  return paths;
}

}  // namespace

TEST_CASE("without marks nothing is recomputed") {
  DirtyPaths paths = fresh();
  CHECK(swept(paths).empty());
}

TEST_CASE("one leaf makes one path, from the leaf to the root") {
  DirtyPaths paths = fresh();
  paths.mark(5, parents);
  CHECK(swept(paths) == std::vector<std::uint32_t>{5, 2, 0});
  CHECK(swept(paths).empty());
}

TEST_CASE("paths that join are recomputed once above, after both children") {
  DirtyPaths paths = fresh();
  for (const std::uint32_t leaf : {7U, 4U, 5U, 4U}) paths.mark(leaf, parents);
  CHECK(swept(paths) == std::vector<std::uint32_t>{7, 3, 4, 5, 2, 0});
}

TEST_CASE("above a box that did not change nothing is recomputed, and the marks are gone all the same") {
  DirtyPaths paths = fresh();
  paths.mark(4, parents);
  paths.mark(6, parents);
  CHECK(swept(paths, false) == std::vector<std::uint32_t>{4, 6});
  paths.mark(4, parents);
  CHECK(swept(paths) == std::vector<std::uint32_t>{4, 2, 0});
}

TEST_CASE("one changed child is enough to recompute the parent") {
  DirtyPaths paths = fresh();
  for (const std::uint32_t leaf : {4U, 7U}) paths.mark(leaf, parents);
  std::vector<std::uint32_t> order;
  const RefitReport report = paths.sweep(parents, [&](std::uint32_t slot) {
    order.push_back(slot);
    return slot != 7;
  });
  CHECK(order == std::vector<std::uint32_t>{4, 2, 7, 0});
  CHECK(report == RefitReport{4, 3});
}
