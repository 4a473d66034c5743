/// What is in both of two ascending lists, whichever of them is how much longer.
#include "dcem/paths/halves/in_both.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <set>
#include <vector>

#include "dcem/core/random.hpp"

namespace test_in_both {

using namespace dcem;

namespace {

std::vector<std::uint32_t> ascending(RandomStream& random, std::size_t most, double below) {
  std::set<std::uint32_t> values;
  const auto count = static_cast<std::size_t>(random.uniform() * static_cast<double>(most + 1));
  for (std::size_t at = 0; at < count; ++at) values.insert(static_cast<std::uint32_t>(random.uniform() * below));
  return {values.begin(), values.end()};
}

}  // namespace

TEST_CASE("what is in both of two lists is found once, in order, with its place in the first") {
  RandomStream random(5);
  std::size_t found = 0;
  for (int round = 0; round < 600; ++round) {
    const std::size_t most[3] = {8, 60, 3000};
    const auto one = ascending(random, most[round % 3], 4000.0), other = ascending(random, most[round / 3 % 3], 4000.0);
    std::vector<std::uint32_t> expected, values;
    std::ranges::set_intersection(one, other, std::back_inserter(expected));
    for_each_in_both<std::uint32_t>(one, other, [&](std::size_t place) { values.push_back(one.at(place)); });
    CHECK(values == expected);
    found += values.size();
  }
  CHECK(found > 10'000);
}

}  // namespace test_in_both
