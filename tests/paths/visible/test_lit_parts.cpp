/// What a transmitter sees of pieces of surfaces is kept for all receivers, whoever asks first.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <thread>
#include <vector>

#include "tests/paths/visible/visible_trial.hpp"

namespace test_lit_parts {

using namespace dcem;
using namespace dcem::test;

namespace {

/// What belongs to a piece, and can be told from what belongs to any other.
void find_piece(std::uint32_t triangle, std::uint64_t place, LitParts& found) {
  found = {};
  found.parts.add(std::array{Vec3(triangle, double(place), 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}, {0, 0});
  found.are_too_many = (triangle + place) % 3 == 0;
  found.bodies.assign(place % 4, BodyId(triangle));
}

bool is_piece(const LitParts& one, std::uint32_t triangle, std::uint64_t place) {
  LitParts other;
  find_piece(triangle, place, other);
  return std::ranges::equal(one.parts.all_corners_m(), other.parts.all_corners_m()) &&
         one.are_too_many == other.are_too_many && one.bodies == other.bodies;
}

}  // namespace

TEST_CASE("lit parts: whoever asks first, from several threads, all get what belongs to their piece") {
  constexpr std::uint32_t triangles = 40;
  constexpr std::uint64_t places = 50;
  LitPartsCache cache;
  std::atomic<std::size_t> found{0}, wrong{0};
  std::array<std::vector<const LitParts*>, 4> kept;
  {
    std::vector<std::jthread> threads;
    for (std::size_t thread = 0; thread < kept.size(); ++thread) {
      threads.emplace_back([&, thread] {
        LitParts spare;
        kept[thread].resize(triangles * places);
        Draw draw(thread);
        for (std::size_t step = 0; step < 4 * triangles * places; ++step) {
          // Each in its own order at first, all pieces in the end.
          const std::size_t piece =
              step < 3 * triangles * places ? draw.below(triangles * places) : step % (triangles * places);
          const auto triangle = static_cast<std::uint32_t>(piece / places);
          const std::uint64_t place = 1 + piece % places;
          const LitParts& got = cache.of(triangle, place, spare, [&](LitParts& parts) {
            ++found;
            find_piece(triangle, place, parts);
          });
          wrong += !is_piece(got, triangle, place);
          wrong += &got == &spare;  // there is room for all
          kept[thread][piece] = &got;
        }
      });
    }
  }
  CHECK(wrong == 0);
  CHECK(found >= triangles * places);
  CHECK(found <= kept.size() * triangles * places);
  // One is kept of each, and it has stayed where it was.
  for (std::size_t piece = 0; piece < triangles * places; ++piece) {
    for (const auto& of_thread : kept) CHECK(of_thread[piece] == kept[0][piece]);
    CHECK(is_piece(*kept[0][piece], static_cast<std::uint32_t>(piece / places), 1 + piece % places));
  }
}

TEST_CASE("lit parts: pieces that differ in the last or in the first bit of their place are different") {
  LitPartsCache cache;
  LitParts spare;
  const auto ask = [&](std::uint32_t triangle, std::uint64_t place) {
    const auto find = [&](LitParts& parts) { find_piece(triangle, place, parts); };
    return is_piece(cache.of(triangle, place, spare, find), triangle, place);
  };
  for (int round = 0; round < 2; ++round) {
    for (int bit = 0; bit < 64; ++bit) {
      CHECK(ask(7, std::uint64_t{1} << bit));
      CHECK(ask(std::uint32_t{1} << (bit % 32), 1));
      CHECK(ask(7, (std::uint64_t{1} << bit) + 1));
    }
  }
}

TEST_CASE("lit parts: beyond the limit pieces are found again each time, and are right") {
  LitPartsCache cache;
  LitParts spare;
  std::size_t found = 0;
  const auto ask = [&](std::uint64_t place) -> const LitParts& {
    return cache.of(1, place, spare, [&](LitParts& parts) {
      ++found;
      parts = {};
      parts.bodies.assign(place % 2, BodyId(place));
    });
  };
  for (std::uint64_t place = 0; place < LitPartsCache::most_pieces; ++place) ask(place);
  REQUIRE(found == LitPartsCache::most_pieces);
  const std::uint64_t beyond = LitPartsCache::most_pieces + 1;
  for (int round = 1; round <= 3; ++round) {
    const LitParts& got = ask(beyond);
    CHECK(&got == &spare);
    REQUIRE(got.bodies.size() == 1);
    CHECK(got.bodies[0] == BodyId(beyond));
    CHECK(found == LitPartsCache::most_pieces + static_cast<std::size_t>(round));
  }
  const LitParts& kept = ask(3);
  CHECK(&kept != &spare);
  CHECK(kept.bodies[0] == BodyId(3));
  CHECK(found == LitPartsCache::most_pieces + 3);
}

}  // namespace test_lit_parts
