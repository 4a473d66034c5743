#include <doctest/doctest.h>

#include <vector>

#include "dcem/accel/binary/node.hpp"

namespace test_node {

using namespace dcem;

namespace {

std::vector<BvhNode<float>> three_leaves() {
  std::vector<BvhNode<float>> nodes(5);
  nodes[0] = {{}, 1, 0};
  nodes[1] = {{}, 0, 2};
  nodes[2] = {{}, 3, 0};
  nodes[3] = {{}, 2, 1};
  nodes[4] = {{}, 3, 1};
  return nodes;
}

}  // namespace

TEST_CASE("a node in float is half a cache line") {
  CHECK(sizeof(BvhNode<float>) == 32);
}

TEST_CASE("a node with primitives is a leaf, the others have two neighbouring children") {
  const auto nodes = three_leaves();
  CHECK(nodes[1].is_leaf());
  CHECK_FALSE(nodes[2].is_leaf());
  CHECK(nodes[2].left() == 3);
  CHECK(nodes[2].right() == 4);
}

TEST_CASE("the walk below a node meets each node once, parents first, with its depth") {
  const auto nodes = three_leaves();
  std::vector<std::pair<std::uint32_t, std::uint32_t>> met;
  const auto note = [&](std::uint32_t slot, std::uint32_t depth) { met.emplace_back(slot, depth); };
  for_each_node<float>(nodes, 0, note);
  CHECK(met == std::vector<std::pair<std::uint32_t, std::uint32_t>>{{0, 1}, {1, 2}, {2, 2}, {3, 3}, {4, 3}});
  met.clear();
  for_each_node<float>(nodes, 2, note);
  CHECK(met == std::vector<std::pair<std::uint32_t, std::uint32_t>>{{2, 1}, {3, 2}, {4, 2}});
}

TEST_CASE("a walk in a circle is stopped by the bound of the stack") {
  auto nodes = three_leaves();
  nodes[3] = {{}, 1, 0};
  nodes[1] = {{}, 1, 0};
  CHECK_THROWS_AS(for_each_node<float>(nodes, 0, [](std::uint32_t, std::uint32_t) {}), InvariantError);
}

}  // namespace test_node
