/// Before a sampled search that takes hours the program says what it takes and what would take less.
#include "dcem/io/slow_search.hpp"

#include <doctest/doctest.h>

#include <string>
#include <vector>

namespace test_slow_search {

using namespace dcem;

TEST_CASE("a link of hours is named with what would take less, and no other is") {
  const std::vector<double> chains{0.0, 20.0, 4e3, 5e6, 2e10};  // by max_interactions
  const auto hint = io::slow_search_hint({chains, 2, 1});
  REQUIRE(hint.has_value());
  CHECK(*hint ==
        "rays propose about 2e+10 chains of edges and mirrors for a link: about 5.6 hours of one thread, and 11 hours "
        "for the 2 links of 1 frame; lower propagation.max_interactions (3: about 10 seconds), max_diffractions or "
        "max_reflections");
  CHECK_FALSE(io::slow_search_hint({std::span(chains).first(4), 2, 1}).has_value());
  CHECK_FALSE(io::slow_search_hint({{}, 1000, 1000}).has_value());
}

TEST_CASE("many links of seconds add up") {
  const std::vector<double> chains{0.0, 20.0, 4e3, 5e6};
  CHECK_FALSE(io::slow_search_hint({chains, 100, 1}).has_value());
  const auto hint = io::slow_search_hint({chains, 100, 100});
  REQUIRE(hint.has_value());
  CHECK(hint->find("14 hours for the 100 links of 100 frames") != std::string::npos);
  CHECK(hint->find("max_interactions (2: about 40 seconds)") != std::string::npos);
}

}  // namespace test_slow_search
