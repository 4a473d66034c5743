/// Rows of items under numbers, few or many of which are used.
#include "dcem/paths/halves/row_index.hpp"

#include <doctest/doctest.h>

#include <cstdint>
#include <map>
#include <vector>

#include "tests/paths/small_scenes.hpp"

namespace test_row_index {

using namespace dcem;
using namespace dcem::test;

TEST_CASE("items stand in their order in rows under their numbers, few or many of which are used") {
  Draw draw(1);
  for (int round = 0; round < 200; ++round) {
    const std::size_t numbers = 1 + draw.below(400), items = draw.below(60);
    const std::uint32_t unit = draw.below(2) == 0 ? 1 : 8;
    std::vector<std::uint32_t> number_of;
    std::map<std::uint32_t, std::vector<std::size_t>> expected;
    for (std::size_t item = 0; item < items; ++item) {
      number_of.push_back(static_cast<std::uint32_t>(draw.below(numbers)));
      expected[number_of.back()].push_back(item);
    }
    RowIndex rows;
    std::map<std::uint32_t, std::size_t> at;
    rows.build(
        numbers, items, unit, [&](std::size_t item) { return number_of[item]; },
        [&](std::size_t item, std::uint32_t place) { at[place] = item; });
    REQUIRE(rows.used().size() == expected.size());
    std::size_t used = 0;
    for (std::uint32_t number = 0; number < numbers; ++number) {
      const RowIndex::Row row = rows.row(number);
      const std::vector<std::size_t>& own = expected[number];
      REQUIRE(row.first % unit == 0);
      REQUIRE(row.last - row.first == (own.size() + unit - 1) / unit * unit);
      for (std::uint32_t place = 0; place < own.size(); ++place) CHECK(at.at(row.first + place) == own[place]);
      if (!own.empty()) CHECK(rows.used()[used++] == number);
      CHECK(row.last <= rows.size());
    }
  }
}

}  // namespace test_row_index
