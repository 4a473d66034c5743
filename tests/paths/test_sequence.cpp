/// Two sequences are one only if all their members are.
#include "dcem/paths/sequence.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>
#include <unordered_map>
#include <vector>

#include "tests/paths/sequences.hpp"

namespace test_sequence {

using namespace dcem;
using namespace dcem::test;

namespace {

/// Two different pairs of facets with one hash. The hash of (a, b) is a bijection of H(a) xor b, H the hash so far; so
/// any two a whose H agree in their upper 32 bits collide for suitable b. By the birthday paradox 2^18 values of a hold
/// some 8 such pairs.
std::pair<Sequence, Sequence> colliding_pairs() {
  std::unordered_map<std::uint64_t, std::pair<std::uint32_t, std::uint64_t>> seen;
  for (std::uint32_t a = 0; a < (1U << 20); ++a) {
    const std::uint64_t after_first = hash_values(std::uint64_t{2}, a);  // hash of a sequence of two, after its first
    const std::uint64_t stirred = RandomStream(after_first).next();      // what the second member is mixed into
    const auto [at, is_new] = seen.try_emplace(stirred >> 32, a, stirred);
    if (is_new) continue;
    const auto difference = static_cast<std::uint32_t>(stirred ^ at->second.second);
    return {over({at->second.first, 7}), over({a, 7 ^ difference})};
  }
  return {};
}

}  // namespace

TEST_CASE("two sequences with one hash are still two") {
  const auto [one, other] = colliding_pairs();
  REQUIRE(one.size() == 2);
  REQUIRE(one != other);
  REQUIRE(SequenceHash{}(one) == SequenceHash{}(other));
  SequenceTable table;
  CHECK(table.insert(one));
  CHECK(table.insert(other));
  CHECK_FALSE(table.insert(one));
  CHECK_FALSE(table.insert(other));
  CHECK(table.size() == 2);
}

TEST_CASE("a table knows the number of each of thousands, keeps their order, and forgets some or all of them") {
  SequenceTable table;
  const auto one = [](std::uint32_t number) { return over({number % 7, number, number / 3}); };
  CHECK_FALSE(table.contains(one(0)));  // of an empty one, too
  for (std::uint32_t number = 0; number < 5'000; ++number) CHECK(table.insert(one(number)));
  for (std::uint32_t number = 0; number < 5'000; ++number) CHECK(table.find(one(number)) == number);
  CHECK_FALSE(table.find(one(5'000)).has_value());
  const auto is_of_third_mirror = [](std::span<const SequenceElement> all) { return all[0].code() == 3; };
  table.erase_if(is_of_third_mirror);
  CHECK(table.size() == 5'000 - 714);
  for (std::uint32_t number = 0; number < 5'000; ++number) CHECK(table.contains(one(number)) == (number % 7 != 3));
  CHECK(table[3].front().code() == 4);
  table.clear();
  CHECK(table.size() == 0);
  CHECK_FALSE(table.contains(one(1)));
  CHECK(table.insert(one(1)));
  CHECK(table.find(one(1)) == 0);
}

TEST_CASE("a table that was appended to takes more, and knows all of them then") {
  SequenceTable table;
  for (std::uint32_t number = 0; number < 100; ++number) table.append(over({number, 7}));
  CHECK(table.insert(over({200})));
  CHECK_FALSE(table.insert(over({99, 7})));
  for (std::uint32_t number = 0; number < 100; ++number) CHECK(table.find(over({number, 7})) == number);
  CHECK(table.size() == 101);
}

TEST_CASE("order and length matter") {
  SequenceTable table;
  const std::vector<Sequence> all{over({}),     over({0}),       over({0, 0}), over({1, 2}),
                                  over({2, 1}), over({1, 2, 1}), over({1}),    over({1, 2, 2})};
  for (const Sequence& one : all) CHECK(table.insert(one));
  for (const Sequence& one : all) CHECK_FALSE(table.insert(one));
  CHECK(table.size() == all.size());
}

TEST_CASE("sequences of a scene spread over all hash values") {
  // 32 896 values drawn from 2^64 collide with a chance of 3e-11; drawn from 2^16 buckets of their low bits they fill
  // 1 - exp(-32896/65536) = 39.5 % of them, give or take 0.2 %.
  std::set<std::size_t> hashes;
  std::set<std::size_t> buckets;
  for (std::uint32_t a = 0; a < 256; ++a) {
    for (std::uint32_t b = 0; b <= a; ++b) {
      hashes.insert(SequenceHash{}(over({a, b})));
      buckets.insert(SequenceHash{}(over({a, b})) % 65536);
    }
  }
  CHECK(hashes.size() == 32896);
  CHECK(static_cast<double>(buckets.size()) / 65536.0 == doctest::Approx(0.3947).epsilon(0.02));
}

}  // namespace test_sequence
