#include <doctest/doctest.h>

#include <algorithm>
#include <functional>

#include "dcem/accel/binary/validate.hpp"
#include "dcem/accel/bvh.hpp"
#include "tests/accel/random_boxes.hpp"

namespace test_validate {

using namespace dcem;

namespace {

using Arrays = BvhArrays<double>;

struct Sound {
  dcem_test::Boxes<double> boxes = dcem_test::random_boxes<double>(300, 21);
  Bvh<double> tree;
  Sound() { tree.build(boxes); }
};

std::uint32_t some_leaf(const Arrays& arrays) {
  return arrays.leaf_of[137];
}

/// The defect that is found after one change of a sound tree.
std::string defect_after(const std::function<void(Arrays&)>& change) {
  const Sound sound;
  Arrays arrays = sound.tree.arrays();
  REQUIRE(find_defect<double>(arrays, sound.boxes).empty());
  change(arrays);
  return find_defect<double>(arrays, sound.boxes);
}

bool names(const std::string& defect, const char* words) {
  return defect.find(words) != std::string::npos;
}

}  // namespace

TEST_CASE("each broken promise is found and named") {
  CHECK(names(defect_after([](Arrays& a) { a.nodes[some_leaf(a)].box.min.x += 0.001; }), "box"));
  CHECK(names(defect_after([](Arrays& a) { a.nodes[a.parent[some_leaf(a)]].box.max.y += 0.5; }), "box"));
  CHECK(names(defect_after([](Arrays& a) { a.nodes[0].box.max.z += 1.0; }), "not that of its children"));
  CHECK(names(defect_after([](Arrays& a) { a.nodes[0].box.max.z -= 1.0; }), "not inside"));
  CHECK(names(defect_after([](Arrays& a) { a.parent[some_leaf(a)] = 0; }), "parent link"));
  CHECK(names(defect_after([](Arrays& a) { a.parent[0] = 2; }), "root has a parent"));
  CHECK(names(defect_after([](Arrays& a) { a.leaf_of[137] = 0; }), "another leaf"));
  CHECK(names(defect_after([](Arrays& a) {
                const BvhNode<double>& leaf =
                    *std::ranges::find_if(a.nodes, [](const auto& node) { return node.count > 1; });
                a.order[leaf.first + 1] = a.order[leaf.first];
              }),
              "twice"));
  CHECK(names(defect_after([](Arrays& a) { a.order[0] = 300; }), "does not exist"));
  CHECK(names(defect_after([](Arrays& a) { a.ordered_boxes[40].max.x += 1.0; }), "stored box"));
  CHECK(names(defect_after([](Arrays& a) { a.nodes[some_leaf(a)].count = 9; }), "too large"));
  CHECK(names(defect_after([](Arrays& a) { a.nodes[some_leaf(a)].first = 299, a.nodes[some_leaf(a)].count = 8; }),
              "beyond"));
  CHECK(names(defect_after([](Arrays& a) { a.nodes[0].first = 3; }), "pair of slots"));
  CHECK(names(defect_after([](Arrays& a) { a.nodes[0].first = 100000; }), "pair of slots"));
  CHECK(names(defect_after([](Arrays& a) { a.free_pairs.push_back(2); }), "free"));
  CHECK(names(defect_after([](Arrays& a) { a.take_pair(); }), "free"));
  CHECK(names(defect_after([](Arrays& a) { a.order.pop_back(); }), "primitives"));
  CHECK(names(defect_after([](Arrays& a) { a.nodes.clear(), a.parent.clear(); }), "root"));
}

TEST_CASE("a lost primitive is found") {
  CHECK(names(defect_after([](Arrays& a) {
                // The leaf lets go of its last primitive and keeps a box that is tight around the others.
                std::uint32_t leaf = some_leaf(a);
                for (std::uint32_t slot = 2; a.nodes[leaf].count < 2; ++slot) {
                  if (a.parent[slot] != free_slot && a.nodes[slot].is_leaf()) leaf = slot;
                }
                --a.nodes[leaf].count;
                for (std::uint32_t slot = leaf; slot != no_node; slot = a.parent[slot]) {
                  Aabb<double> tight;
                  const auto& node = a.nodes[slot];
                  for (std::size_t i = 0; i < node.count; ++i) tight.extend(a.ordered_boxes[node.first + i]);
                  if (!node.is_leaf()) {
                    tight.extend(a.nodes[node.left()].box);
                    tight.extend(a.nodes[node.right()].box);
                  }
                  a.nodes[slot].box = tight;
                }
              }),
              "in no leaf"));
}

TEST_CASE("a tree that was not told of a motion is defective") {
  Sound sound;
  sound.boxes[42].max.x += 1e-9;
  CHECK(names(sound.tree.validate(sound.boxes), "stored box of primitive 42"));
  sound.boxes.pop_back();
  CHECK_FALSE(sound.tree.validate(sound.boxes).empty());
}

}  // namespace test_validate
