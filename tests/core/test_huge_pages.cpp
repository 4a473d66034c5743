#include <doctest/doctest.h>

#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "dcem/core/huge_pages.hpp"

namespace test_huge_pages {

using namespace dcem;

namespace {

struct alignas(64) Line {
  std::uint64_t number = 0;
  friend bool operator==(const Line&, const Line&) = default;
};

constexpr std::size_t page_bytes = HugePageAllocator<Line>::page_bytes;
constexpr std::size_t many = 3 * page_bytes / sizeof(Line) + 1;

HugePageVector<Line> lines(std::size_t count, bool asks) {
  HugePageVector<Line> result{HugePageAllocator<Line>(asks)};
  for (std::size_t index = 0; index < count; ++index) result.push_back({index});
  return result;
}

bool begins_at(const HugePageVector<Line>& list, std::size_t multiple_of) {
  return reinterpret_cast<std::uintptr_t>(list.data()) % multiple_of == 0;
}

}  // namespace

TEST_CASE("a large list begins with a page, a small one where its items may lie") {
  for (const bool asks : {true, false}) {
    CHECK(begins_at(lines(many, asks), page_bytes));
    CHECK(begins_at(lines(100, asks), alignof(Line)));
  }
}

TEST_CASE("a list that grows past a page, copies and moves keep what they hold") {
  for (const bool asks : {true, false}) {
    for (const std::size_t count : {std::size_t{100}, many}) {
      HugePageVector<Line> list = lines(count, asks);
      REQUIRE(list.size() == count);
      for (std::size_t index = 0; index < count; ++index) REQUIRE(list[index].number == index);
      HugePageVector<Line> copy = list, other = lines(7, !asks);
      CHECK(copy == list);
      CHECK(copy.data() != list.data());
      other = list;
      CHECK(other == list);
      CHECK(other.get_allocator().asks() == asks);
      const Line* const where = list.data();
      other = std::move(list);
      CHECK(other.data() == where);
      CHECK(other == copy);
      other.shrink_to_fit();
      other.clear();
      other.shrink_to_fit();
      CHECK(other.empty());
    }
  }
}

TEST_CASE("lists that ask and lists that do not may exchange their memory") {
  HugePageVector<Line> one = lines(many, true), other = lines(many / 2, false);
  std::swap(one, other);
  CHECK(one.size() == many / 2);
  CHECK(other.size() == many);
  CHECK(one.get_allocator() == other.get_allocator());
}

TEST_CASE("memory that no system has is refused as any allocator refuses it") {
  HugePageVector<Line> list;
  CHECK_THROWS_AS(list.reserve(std::size_t{1} << 52), std::bad_alloc);
  CHECK_THROWS_AS(HugePageAllocator<Line>().allocate(std::size_t{1} << 57), std::bad_alloc);
  CHECK_THROWS_AS(HugePageAllocator<Line>().allocate(std::size_t{1} << 58), std::bad_alloc);  // 2⁶⁴ bytes
  CHECK(list.empty());
}

}  // namespace test_huge_pages
