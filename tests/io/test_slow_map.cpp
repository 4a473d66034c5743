/// Before a map that takes hours the program says what would take minutes; before any other it says nothing.
#include "dcem/io/slow_map.hpp"

#include <doctest/doctest.h>

#include <string>

namespace test_slow_map {

using namespace dcem;

TEST_CASE("a city's map of three interactions has a hint to two, and no other has one") {
  const PropagationSettings three;  // two reflections and a diffraction
  const SearchPlan joined{Discovery::exact, false, 3};
  const auto hint = io::slow_map_hint(three, joined, 17'269, 40'000);
  REQUIRE(hint.has_value());
  CHECK(hint->find("40000 points of a scene of 17269 facets") != std::string::npos);
  CHECK(hint->find("max_interactions 2") != std::string::npos);
  PropagationSettings two;
  two.max_interactions = 2;
  CHECK_FALSE(io::slow_map_hint(two, joined, 17'269, 40'000).has_value());
  CHECK_FALSE(io::slow_map_hint(three, joined, 300, 40'000).has_value());
  CHECK_FALSE(io::slow_map_hint(three, joined, 17'269, 100).has_value());
  CHECK_FALSE(io::slow_map_hint(three, {Discovery::exact, true}, 17'269, 40'000).has_value());
  CHECK_FALSE(io::slow_map_hint(three, {Discovery::sampled}, 17'269, 40'000).has_value());
}

}  // namespace test_slow_map
