#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

#include "dcem/core/radix_sort.hpp"
#include "dcem/core/random.hpp"

namespace test_radix_sort {

using namespace dcem;

namespace {

std::vector<KeyOrder::Entry> random_entries(std::uint32_t count, std::uint32_t most, std::uint64_t seed) {
  RandomStream random(seed);
  std::vector<KeyOrder::Entry> entries;
  for (std::uint32_t index = 0; index < count; ++index) {
    entries.push_back({static_cast<std::uint32_t>(random.uniform() * most), index});
  }
  return entries;
}

}  // namespace

TEST_CASE("keys rise, and equal ones stay in the order given") {
  KeyOrder order;  // one for all: nothing of one call shows in the next
  for (const std::uint32_t count : {0U, 1U, 2U, 255U, 256U, 257U, 50'000U}) {
    for (const std::uint32_t most : {1U, 3U, 70'000U, 0xffffffffU}) {
      CAPTURE(count);
      CAPTURE(most);
      std::vector<KeyOrder::Entry> expected = random_entries(count, most, count);
      order.entries = expected;
      order.sort();
      std::ranges::stable_sort(expected, {}, &KeyOrder::Entry::key);
      CHECK(std::ranges::equal(order.entries, expected, {}, &KeyOrder::Entry::key, &KeyOrder::Entry::key));
      CHECK(std::ranges::equal(order.entries, expected, {}, &KeyOrder::Entry::index, &KeyOrder::Entry::index));
    }
  }
}

TEST_CASE("bits above those that are asked for count for nothing, but for the rest of their digit") {
  KeyOrder order;
  order.entries = {{0x1'00'05, 0}, {0x0'01'05, 1}, {0x7'00'04, 2}, {0x0'00'06, 3}};
  order.sort(8);
  CHECK(order.entries[0].index == 2);
  CHECK(order.entries[1].index == 0);
  CHECK(order.entries[2].index == 1);
  CHECK(order.entries[3].index == 3);
}

}  // namespace test_radix_sort
