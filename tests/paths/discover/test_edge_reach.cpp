/// What an end reaches is listed by edge, with all ways to it and all that it sees.
#include "dcem/paths/discover/edge_reach.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <vector>

#include "tests/paths/sequences.hpp"

namespace test_edge_reach {

using namespace dcem;
using namespace dcem::test;

namespace {

struct Listed {
  std::size_t edge;
  std::vector<Sequence> ways;
  std::vector<std::size_t> in_view;
  bool operator==(const Listed&) const = default;
};

std::vector<Listed> listed(EdgeReach& reach) {
  std::vector<Listed> all;
  for (const EdgeReach::Edge& edge : reach.edges()) {
    Listed one{edge.id.value, {}, {}};
    for (const EdgeReach::Mirrors mirrors : edge.mirrors) one.ways.emplace_back(mirrors.begin(), mirrors.end());
    for (const FacetId mirror : edge.in_view) one.in_view.push_back(mirror.value);
    all.push_back(one);
  }
  return all;
}

}  // namespace

TEST_CASE("edges ascend, ways stand as they were noted, views ascend, each once") {
  EdgeReach reach;
  reach.add(over({3, 1}), WedgeId(7));
  reach.add(over({}), WedgeId(2));
  reach.add(over({}), WedgeId(7));
  reach.add(over({3, 1}), WedgeId(7));
  reach.add(over({9}), WedgeId(5));
  for (const std::size_t mirror : {8, 4, 8, 6}) reach.note_view(WedgeId(7), FacetId(mirror));
  reach.note_view(WedgeId(2), FacetId(1));
  CHECK(reach.size() == 4);
  CHECK(listed(reach) ==
        std::vector<Listed>{{2, {over({})}, {1}}, {5, {over({9})}, {}}, {7, {over({3, 1}), over({})}, {4, 6, 8}}});
}

TEST_CASE("what an edge sees counts for no other edge, and for none that is not reached") {
  EdgeReach reach;
  reach.note_view(WedgeId(1), FacetId(11));
  reach.note_view(WedgeId(4), FacetId(14));
  reach.note_view(WedgeId(9), FacetId(19));
  CHECK(reach.edges().empty());
  reach.add(over({}), WedgeId(3));
  reach.add(over({}), WedgeId(4));
  CHECK(listed(reach) == std::vector<Listed>{{3, {over({})}, {}}, {4, {over({})}, {14}}});
}

TEST_CASE("an edge is reached no longer than a way to it is remembered") {
  EdgeReach reach;
  reach.add(over({2}), WedgeId(6));
  reach.add(over({}), WedgeId(1));
  reach.note_view(WedgeId(6), FacetId(5));
  reach.next_frame(1);
  reach.add(over({}), WedgeId(1));
  reach.note_view(WedgeId(6), FacetId(5));
  CHECK(listed(reach).size() == 2);
  reach.next_frame(1);
  CHECK(listed(reach) == std::vector<Listed>{{1, {over({})}, {}}});
  reach.clear();
  CHECK(reach.edges().empty());
}

}  // namespace test_edge_reach
