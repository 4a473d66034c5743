#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <string_view>

#include "dcem/core/random.hpp"

namespace test_random {

using namespace dcem;

// The published test vectors of FNV-1a, 64 bit (draft-eastlake-fnv, appendix C).
static_assert(hash_text("") == 0xcbf29ce484222325ULL);
static_assert(hash_text("a") == 0xaf63dc4c8601ec8cULL);
static_assert(hash_text("foobar") == 0x85944171f73967e8ULL);
// Bytes above 127 count as 128 … 255, whatever the sign of char. Numbers from a script with unbounded integers.
static_assert(hash_text("\xff") == 0xaf64724c8602eb6eULL);
static_assert(hash_text(std::string_view("\0", 1)) == 0xaf63bd4c8601b7dfULL);

TEST_CASE("a text hashed in pieces is the text hashed at once") {
  CHECK(hash_text("bar", hash_text("foo")) == hash_text("foobar"));
  CHECK(hash_text("ue[0,12]") != hash_text("ue[01,2]"));
}

TEST_CASE("SplitMix64 gives the published sequences") {
  // Seed 1234567: the reference output of Vigna's splitmix64.c as Rosetta Code lists it; seed 0: as used to test the
  // seeding of xoshiro.
  RandomStream stream(1234567);
  for (const std::uint64_t expected : {6457827717110365317ULL, 3203168211198807973ULL, 9817491932198370423ULL,
                                       4593380528125082431ULL, 16408922859458223821ULL}) {
    CHECK(stream.next() == expected);
  }
  RandomStream zero(0);
  CHECK(zero.next() == 0xe220a8397b1dcdafULL);
  CHECK(zero.next() == 0x6e789e6aa1b965f4ULL);
  CHECK(zero.next() == 0x06c45d188009454fULL);
}

TEST_CASE("uniform numbers are the upper 53 bits, below one, and evenly spread") {
  RandomStream stream(0), bits(0);
  std::array<int, 16> bins{};
  double sum = 0.0;
  constexpr int count = 160'000;
  for (int index = 0; index < count; ++index) {
    const double value = stream.uniform();
    CHECK_UNARY(value == std::ldexp(static_cast<double>(bits.next() / 2048), -53));
    CHECK_UNARY(value >= 0.0 && value < 1.0);
    ++bins[static_cast<std::size_t>(value * 16)];
    sum += value;
  }
  // Standard deviations: 1/√(12·160000) = 7.2e-4 of the mean, √(10000·15/16) = 97 of a bin; six of them each.
  CHECK(std::abs(sum / count - 0.5) < 6 * 7.2e-4);
  for (const int bin : bins) CHECK(std::abs(bin - 10'000) < 6 * 97);
}

TEST_CASE("the value of several values depends on each and on their order") {
  CHECK(hash_values(1, 2) != hash_values(2, 1));
  CHECK(hash_values(7) == 0x63cbe1e459320dd7ULL);        // first output of SplitMix64 with seed 7, from a script
  CHECK(hash_values(1, 2, 3) == 0xd0734750fde362b3ULL);  // h(h(h(1) ^ 2) ^ 3), from the same script: results hang on it
  std::set<std::uint64_t> seen;
  for (std::int64_t x = -10; x < 10; ++x) {
    for (std::int64_t y = -10; y < 10; ++y) {
      for (std::int64_t z = -10; z < 10; ++z) seen.insert(hash_values(static_cast<std::uint64_t>(x), y, z));
    }
  }
  CHECK(seen.size() == 8000);
}

}  // namespace test_random
