/// Numbers as text, and lines in which the same number stands more than once.
#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "dcem/io/src/text/number_text.hpp"

namespace test_number_text {

using namespace dcem::io;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity(), none = std::numeric_limits<double>::quiet_NaN();

/// What a line should hold, each number by itself.
std::string line_of(const std::vector<double>& numbers) {
  std::string text;
  for (std::size_t index = 0; index < numbers.size(); ++index) {
    if (index > 0) text += ',';
    append_number(text, numbers[index]);
  }
  return text + '\n';
}

}  // namespace

TEST_CASE("a line tells each number as it stands by itself, whatever stood before it") {
  const std::vector<double> some{0.0,      -0.0,      1.0, -1.0, 0.1, 4.05e-7, 5e-324, 1.7976931348623157e308,
                                 infinity, -infinity, none};
  for (const double first : some) {
    for (const double second : some) {
      for (const double third : some) {
        std::string text;
        CsvLine(text).number(first).number(second).number(third).end();
        REQUIRE(text == line_of({first, second, third}));
      }
    }
  }
}

TEST_CASE("a line that has begun, with counts, absent numbers and names between numbers") {
  std::string text = "before\n";
  CsvLine line(text, "7,0.5");
  line.number(0.5).count(12).number(std::optional<double>()).number(0.5).prepared("car 1").flag(true);
  CsvLine copy = line;  // goes on where the other one was
  copy.number(0.5).number(-0.0).end();
  CHECK(text == "before\n7,0.5,0.5,12,,0.5,car 1,1,0.5,0\n");
}

TEST_CASE("numbers that are not finite have no text, and say so") {
  std::string text = "x";
  for (const double value : {infinity, -infinity, none}) CHECK(!append_number(text, value));
  CHECK(text == "x");
  CHECK(append_number(text, -0.0));
  CHECK(text == "x0");
}

}  // namespace test_number_text
