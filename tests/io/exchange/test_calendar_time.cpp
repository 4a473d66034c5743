/// Instants as dates, both ways.
#include "dcem/io/src/exchange/calendar_time.hpp"

#include <doctest/doctest.h>

namespace test_calendar_time {

using namespace dcem::io;

TEST_CASE("dates are read as ISO 8601 has them, and nothing else is") {
  CHECK(calendar_microseconds("1970-01-01T00:00:00Z") == 0);
  CHECK(calendar_microseconds("2000-01-01T00:00:00Z") == 946684800000000);
  CHECK(calendar_microseconds("2024-02-29T23:59:59Z") == 1709251199000000);
  for (const char* text : {"", "2023-02-29T00:00:00Z", "2024-02-29", "2024-02-29T24:00:00Z", "2024-02-29T00:00:00",
                           "2024-13-01T00:00:00Z", "2024-1-01T00:00:000Z", "2024-02-29 00:00:00Z"}) {
    CAPTURE(text);
    CHECK_FALSE(calendar_microseconds(text));
  }
}

TEST_CASE("instants are written with as many decimals as it takes") {
  CHECK(calendar_text(946684800000000) == "2000-01-01T00:00:00Z");
  CHECK(calendar_text(946684800100000) == "2000-01-01T00:00:00.1Z");
  CHECK(calendar_text(946684799999999) == "1999-12-31T23:59:59.999999Z");
  CHECK(calendar_text(-1) == "1969-12-31T23:59:59.999999Z");
}

}  // namespace test_calendar_time
