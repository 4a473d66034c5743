#include <doctest/doctest.h>

#include <string>

#include "dcem/core/error.hpp"

namespace test_error {

using namespace dcem;

TEST_CASE("a broken invariant throws and says where and what") {
  try {
    DCEM_ASSERT(1 + 1 == 3);
    FAIL("the invariant did not fire");
  } catch (const InvariantError& error) {
    const std::string text = error.what();
    CHECK(text.find("test_error.cpp:") != std::string::npos);
    CHECK(text.find("1 + 1 == 3") != std::string::npos);
  }
}

TEST_CASE("a kept invariant does nothing and looks at its condition once") {
  int looks = 0;
  CHECK_NOTHROW(DCEM_ASSERT(++looks == 1));
  CHECK(looks == 1);
}

TEST_CASE("an invariant is one expression: it may stand in an if without braces") {
  bool other = false;
  if (true)
    DCEM_ASSERT(true);
  else
    other = true;
  CHECK_FALSE(other);
}

}  // namespace test_error
