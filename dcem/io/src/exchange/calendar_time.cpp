#include "dcem/io/src/exchange/calendar_time.hpp"

#include <array>
#include <chrono>
#include <cstdio>

namespace dcem::io {
namespace {

using namespace std::chrono;

/// The number in some of the digits of a text; nothing where one is none.
std::optional<int> digits(const std::string& text, std::size_t first, std::size_t count) {
  int value = 0;
  for (std::size_t i = first; i < first + count; ++i) {
    if (text[i] < '0' || text[i] > '9') return std::nullopt;
    value = 10 * value + (text[i] - '0');
  }
  return value;
}

}  // namespace

std::optional<long long> calendar_microseconds(const std::string& text) {
  const std::string form = "....-..-..T..:..:..Z";
  if (text.size() != form.size()) return std::nullopt;
  for (std::size_t i = 0; i < form.size(); ++i) {
    if (form[i] != '.' && text[i] != form[i]) return std::nullopt;
  }
  const auto y = digits(text, 0, 4), mo = digits(text, 5, 2), d = digits(text, 8, 2);
  const auto h = digits(text, 11, 2), mi = digits(text, 14, 2), s = digits(text, 17, 2);
  if (!y || !mo || !d || !h || !mi || !s || *h > 23 || *mi > 59 || *s > 59) return std::nullopt;
  const year_month_day date{year(*y), month(static_cast<unsigned>(*mo)), day(static_cast<unsigned>(*d))};
  if (!date.ok()) return std::nullopt;
  const auto instant = sys_days(date) + hours(*h) + minutes(*mi) + seconds(*s);
  return duration_cast<microseconds>(instant.time_since_epoch()).count();
}

std::string calendar_text(long long microseconds_since_1970) {
  const microseconds all(microseconds_since_1970);
  const auto whole_days = floor<days>(all);
  const year_month_day date{sys_days(whole_days)};
  const hh_mm_ss<microseconds> time(all - whole_days);
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%04d-%02u-%02uT%02d:%02d:%02d.%06d", static_cast<int>(date.year()),
                static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                static_cast<int>(time.hours().count()), static_cast<int>(time.minutes().count()),
                static_cast<int>(time.seconds().count()), static_cast<int>(time.subseconds().count()));
  std::string result = text.data();
  while (result.back() == '0') result.pop_back();
  if (result.back() == '.') result.pop_back();
  return result + "Z";
}

}  // namespace dcem::io
