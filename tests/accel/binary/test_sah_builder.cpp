#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "dcem/accel/binary/sah_builder.hpp"
#include "dcem/accel/sah_cost.hpp"
#include "tests/accel/random_boxes.hpp"

namespace test_sah_builder {

using namespace dcem;

namespace {

template <class Scalar>
struct Built {
  std::vector<BuildItem<Scalar>> items;
  std::vector<BvhNode<Scalar>> nodes;
  std::uint32_t depth = 0;
};

template <class Scalar>
Built<Scalar> built(const dcem_test::Boxes<Scalar>& boxes, const SahSettings& settings = {}) {
  Built<Scalar> result;
  for (std::uint32_t index = 0; index < boxes.size(); ++index) result.items.emplace_back(boxes[index], index);
  result.nodes = SahBuilder<Scalar>(settings).build(result.items);
  for_each_node<Scalar>(result.nodes, 0,
                        [&](std::uint32_t, std::uint32_t depth) { result.depth = std::max(result.depth, depth); });
  return result;
}

template <class Scalar>
std::uint32_t largest_leaf(const Built<Scalar>& tree) {
  return std::ranges::max(tree.nodes, {}, &BvhNode<Scalar>::count).count;
}

}  // namespace

TEST_CASE("two clusters are divided between, not through, them") {
  dcem_test::Boxes<double> boxes;
  for (int index = 0; index < 40; ++index) {
    const Vec3 corner(index % 4 == 0 ? 100.0 + index : index * 0.1, 0, 0);
    boxes.push_back({corner, corner + Vec3(1)});
  }
  const auto tree = built(boxes);
  const Aabb<double> left = tree.nodes[tree.nodes[0].left()].box;
  const Aabb<double> right = tree.nodes[tree.nodes[0].right()].box;
  CHECK(std::max(left.min.x, right.min.x) == 100.0);
  CHECK(std::min(left.max.x, right.max.x) == doctest::Approx(4.9));
  CHECK(left.half_area() >= right.half_area());
}

TEST_CASE_TEMPLATE("no leaf exceeds the limit, also for identical boxes", Scalar, float, double) {
  CHECK(largest_leaf(built(dcem_test::random_boxes<Scalar>(3000, 1))) <= 4);
  const dcem_test::Boxes<Scalar> same(1000, {Vector3<Scalar>(1), Vector3<Scalar>(2)});
  const auto tree = built(same);
  CHECK(largest_leaf(tree) <= maximum_leaf_size);
  // 1000 boxes in leaves of up to 8 by halving: 125 leaves at least, so 7 halvings.
  CHECK(tree.depth == 8);
  SahSettings one;
  one.leaf_limit = one.leaf_maximum = 1;
  CHECK(largest_leaf(built(same, one)) == 1);
}

TEST_CASE("equal costs are divided evenly: points on a line make no chain") {
  dcem_test::Boxes<double> boxes;
  for (int index = 0; index < 4096; ++index) boxes.push_back({Vec3(index, 0, 0), Vec3(index, 0, 0)});
  // 1024 leaves of 4 would be 11 levels; the bins are not aligned with the points, which may cost a few.
  CHECK(built(boxes).depth <= 15);
}

TEST_CASE("boxes that shrink geometrically cannot make the tree deeper than its bound") {
  dcem_test::Boxes<double> boxes;
  for (int index = 0; index < 450; ++index) {
    const Vec3 corner(std::ldexp(1.0, 45 - index));
    boxes.push_back({corner, corner * 1.5});
  }
  const auto tree = built(boxes);
  CHECK(tree.depth > 32);
  CHECK(tree.depth <= maximum_build_depth);
  std::vector<BuildItem<double>> items = tree.items;
  // 450 items need 9 halvings at most: ten levels are always enough.
  const auto shallow = SahBuilder<double>({}).build(items, 10);
  std::uint32_t deepest = 0;
  for_each_node<double>(shallow, 0, [&](std::uint32_t, std::uint32_t depth) { deepest = std::max(deepest, depth); });
  CHECK(deepest <= 10);
}

TEST_CASE_TEMPLATE("the order of the boxes does not change the tree", Scalar, float, double) {
  auto boxes = dcem_test::random_boxes<Scalar>(2000, 3);
  for (std::size_t index = 0; index < 200; ++index) boxes[index] = boxes[index + 200];
  for (std::size_t index = 400; index < 600; ++index) boxes[index] = boxes[400];
  const auto tree = built(boxes);
  RandomStream random(4);
  std::vector<std::uint32_t> shuffled(boxes.size());
  std::iota(shuffled.begin(), shuffled.end(), 0U);
  for (std::size_t index = shuffled.size() - 1; index > 0; --index) {
    std::swap(shuffled[index], shuffled[random.next() % (index + 1)]);
  }
  Built<Scalar> other;
  for (const std::uint32_t index : shuffled) other.items.emplace_back(boxes[index], index);
  other.nodes = SahBuilder<Scalar>({}).build(other.items);
  REQUIRE(other.nodes.size() == tree.nodes.size());
  for (std::size_t slot = 0; slot < tree.nodes.size(); ++slot) {
    REQUIRE(other.nodes[slot].box == tree.nodes[slot].box);
    REQUIRE(other.nodes[slot].first == tree.nodes[slot].first);
    REQUIRE(other.nodes[slot].count == tree.nodes[slot].count);
  }
  CHECK(std::ranges::equal(tree.items, other.items, {}, &BuildItem<Scalar>::index, &BuildItem<Scalar>::index));
}

TEST_CASE("empty boxes stand aside from the others") {
  auto boxes = dcem_test::random_boxes<double>(500, 6);
  const double sah = subtree_sah_cost<double>(built(boxes).nodes, 0, {});
  for (int extra = 0; extra < 300; ++extra) boxes.insert(boxes.begin() + extra, Aabb<double>{});
  const auto tree = built(boxes);
  CHECK(largest_leaf(tree) <= maximum_leaf_size);
  // The same tree under one more node, whose box is that of the root: one more visit, of cost 1.
  CHECK(subtree_sah_cost<double>(tree.nodes, 0, {}) == doctest::Approx(sah + 1.0));
}

TEST_CASE("the surface-area heuristic beats halving by number") {
  const auto boxes = dcem_test::random_boxes<float>(5000, 11);
  SahSettings settings;
  const double sah = subtree_sah_cost<float>(built(boxes).nodes, 0, settings);
  std::vector<BuildItem<float>> items;
  for (std::uint32_t index = 0; index < boxes.size(); ++index) items.emplace_back(boxes[index], index);
  // With the fewest levels allowed the builder must take the median everywhere: 5000 items, 13 halvings.
  const auto median = SahBuilder<float>(settings).build(items, 14);
  CHECK(sah < 0.95 * subtree_sah_cost<float>(median, 0, settings));
}

TEST_CASE("settings outside their ranges are refused") {
  const auto refused = [](auto change) {
    SahSettings settings;
    change(settings);
    CHECK_THROWS_AS(SahBuilder<float>{settings}, std::invalid_argument);
  };
  refused([](SahSettings& settings) { settings.traversal_cost = 0.0; });
  refused([](SahSettings& settings) { settings.intersection_cost = std::nan(""); });
  refused([](SahSettings& settings) { settings.bins = 1; });
  refused([](SahSettings& settings) { settings.bins = 65; });
  refused([](SahSettings& settings) { settings.sweep_limit = 65; });
  refused([](SahSettings& settings) { settings.leaf_limit = 0; });
  refused([](SahSettings& settings) { settings.leaf_maximum = 9; });
  refused([](SahSettings& settings) { settings.leaf_limit = 5, settings.leaf_maximum = 4; });
}

TEST_CASE("no items, no nodes; one item, one leaf") {
  CHECK(SahBuilder<double>({}).build({}).empty());
  const auto tree = built<double>({{Vec3(1), Vec3(2)}});
  REQUIRE(tree.nodes.size() == 1);
  CHECK(tree.nodes[0].count == 1);
}

}  // namespace test_sah_builder
