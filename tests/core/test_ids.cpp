#include <doctest/doctest.h>

#include <type_traits>
#include <unordered_set>

#include "dcem/core/ids.hpp"

namespace test_ids {

using namespace dcem;

static_assert(!std::is_convertible_v<FacetId, BodyId>, "a facet is no body");
static_assert(!std::is_constructible_v<MaterialId, BodyId>, "a body is no material");
static_assert(!std::is_convertible_v<int, FacetId>, "a number becomes an id only where that is said");
static_assert(sizeof(FacetId) == 4);

TEST_CASE("ids compare and hash as their numbers do") {
  CHECK(FacetId(3U) == FacetId(3U));
  CHECK(FacetId(2U) < FacetId(10U));
  CHECK(BodyId{} == BodyId(0U));
  std::unordered_set<BodyId> ids;
  for (std::size_t index = 0; index < 100; ++index) ids.insert(BodyId(index % 10));
  CHECK(ids.size() == 10);
}

}  // namespace test_ids
