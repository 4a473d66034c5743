#include "dcem/io/text_table.hpp"

#include <doctest/doctest.h>

#include <clocale>
#include <limits>
#include <stdexcept>
#include <string>

namespace test_text_table {

using dcem::io::character_count;
using dcem::io::format_fixed;
using dcem::io::memory_text;
using dcem::io::TextTable;

TEST_CASE("a table is as wide as its longest cells and aligned by column") {
  TextTable table({{"link", TextTable::Align::left}, {"paths"}, {"time / ms"}});
  table.add_row({"bs -> ue", "12", "0.5"});
  table.add_row({"a", "1234567", ""});
  CHECK(table.str() ==
        "link        paths  time / ms\n"
        "--------  -------  ---------\n"
        "bs -> ue       12        0.5\n"
        "a         1234567\n");
}

TEST_CASE("a table without headings has no head") {
  TextTable table({{"", TextTable::Align::left}, {""}});
  table.add_row({"frames", "100"});
  table.add_row({"rays", "2000"});
  CHECK(table.str() == "frames   100\nrays    2000\n");
}

TEST_CASE("a character counts one, however many bytes it takes") {
  CHECK(character_count("dBµV/m") == 6);
  TextTable table({{"unit", TextTable::Align::left}, {"n"}});
  table.add_row({"µV", "1"});
  table.add_row({"dBm", "2"});
  CHECK(table.str() == "unit  n\n----  -\nµV    1\ndBm   2\n");
}

TEST_CASE("rows that do not fit are refused") {
  CHECK_THROWS_AS(TextTable({}), std::invalid_argument);
  TextTable table({{"a"}, {"b"}});
  CHECK_THROWS_AS(table.add_row({"1"}), std::invalid_argument);
  CHECK_THROWS_AS(table.add_row({"1", "2", "3"}), std::invalid_argument);
}

TEST_CASE("numbers have a point in every locale, no minus zero and no nan") {
  CHECK(format_fixed(-101.25, 1) == "-101.2");  // exactly half: to even
  CHECK(format_fixed(0.1, 3) == "0.100");
  CHECK(format_fixed(-0.04, 1) == "0.0");
  CHECK(format_fixed(-0.0, 0) == "0");
  CHECK(format_fixed(1e15, 0) == "1000000000000000");
  CHECK(format_fixed(std::numeric_limits<double>::max(), 2).size() == 312);
  CHECK(format_fixed(std::numeric_limits<double>::infinity(), 2) == "-");
  CHECK(format_fixed(std::numeric_limits<double>::quiet_NaN(), 2) == "-");
  const std::string old_locale = std::setlocale(LC_NUMERIC, nullptr);
  std::setlocale(LC_NUMERIC, "de_DE.UTF-8");  // where it is installed
  CHECK(format_fixed(1.5, 1) == "1.5");
  std::setlocale(LC_NUMERIC, old_locale.c_str());
}

TEST_CASE("memory has two to four digits and a unit") {
  CHECK(memory_text(0) == "0 bytes");
  CHECK(memory_text(9999) == "9999 bytes");
  CHECK(memory_text(10240) == "10 kB");
  CHECK(memory_text(1048576) == "1049 kB");
  CHECK(memory_text(9.9e9) == "9900 MB");
  CHECK(memory_text(80e9) == "80 GB");
}

}  // namespace test_text_table
