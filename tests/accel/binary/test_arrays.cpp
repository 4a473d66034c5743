#include <doctest/doctest.h>

#include "dcem/accel/binary/arrays.hpp"

namespace test_arrays {

using namespace dcem;

TEST_CASE("pairs of slots start even, and freed pairs are used again, lowest first") {
  BvhArrays<float> arrays;
  arrays.reset(6);
  CHECK(arrays.nodes.size() == 2);
  std::vector<BvhNode<float>> sprout(5);
  sprout[0].first = 1;
  sprout[1] = {{}, 0, 3};
  sprout[2].first = 3;
  sprout[3] = {{}, 3, 2};
  sprout[4] = {{}, 5, 1};
  std::vector<std::uint32_t> leaves;
  const auto note = [&](std::uint32_t leaf) { leaves.push_back(leaf); };
  arrays.build_all(0, sprout, note);
  CHECK(leaves == std::vector<std::uint32_t>{2, 4, 5});
  CHECK(arrays.nodes[0].left() == 2);
  CHECK(arrays.nodes[3].left() == 4);
  CHECK(arrays.parent == std::vector<std::uint32_t>{no_node, free_slot, 0, 0, 3, 3});
  arrays.free_below(3);
  CHECK(arrays.free_pairs == std::vector<std::uint32_t>{4});
  CHECK(arrays.parent[5] == free_slot);
  arrays.nodes[3] = {{}, 3, 3};
  arrays.free_below(0);
  CHECK(arrays.take_pair() == 2);
  CHECK(arrays.take_pair() == 4);
  CHECK(arrays.take_pair() == 6);
}

TEST_CASE("arrays of nothing have no root") {
  BvhArrays<float> arrays;
  arrays.reset(3);
  arrays.reset(0);
  CHECK(arrays.empty());
  CHECK(arrays.nodes.empty());
}

}  // namespace test_arrays
