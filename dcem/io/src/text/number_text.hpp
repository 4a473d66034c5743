#pragma once
/// Numbers and CSV fields as text, for the writers of results. Private to dcem::io.
#include <array>
#include <charconv>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace dcem::io {

/// The text of a number, where it stands without asking for memory.
class NumberText {
 public:
  /// The fewest digits that read back as the same double, "0" also for −0; nothing where the value is not finite.
  explicit NumberText(double value) : value_(value) {
    if (!std::isfinite(value)) return;
    // Adding +0 turns −0 into +0 and leaves every other number as it is.
    size_ = static_cast<std::size_t>(std::to_chars(digits_.data(), digits_.data() + digits_.size(), value + 0.0).ptr -
                                     digits_.data());
  }

  double value() const { return value_; }
  std::string_view text() const { return {digits_.data(), size_}; }

 private:
  double value_;
  std::size_t size_ = 0;
  std::array<char, 32> digits_{};
};

/// Appends `value` as `NumberText` has it; returns whether there was anything to append.
inline bool append_number(std::string& text, double value) {
  const NumberText number(value);
  text += number.text();
  return !number.text().empty();
}

template <std::integral Integer>
void append_number(std::string& text, Integer value) {
  std::array<char, 24> digits{};
  text.append(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr);
}

/// A CSV field as RFC 4180 wants it: quoted, with its quotes doubled, where it holds a comma, a quote or a line end.
inline std::string csv_field(std::string_view field) {
  if (field.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(field);
  std::string quoted = "\"";
  for (const char character : field) {
    if (character == '"') quoted.push_back('"');
    quoted.push_back(character);
  }
  return quoted + '"';
}

/// One line of a CSV file, field by field. What is absent or not finite is an empty field.
class CsvLine {
 public:
  /// Appends to `text`.
  explicit CsvLine(std::string& text) : text_(text) {}
  /// Appends to a line that has begun; `begun` holds its first fields.
  CsvLine(std::string& text, std::string_view begun) : text_(text), first_(false) { text_ += begun; }

  /// Of one direct path power and delay stand in several columns: the same number is not worked out again.
  CsvLine& number(double value) {
    separate();
    if (value != last_.value()) last_ = NumberText(value);
    text_ += last_.text();
    return *this;
  }
  CsvLine& number(const std::optional<double>& value) { return value ? number(*value) : empty(); }
  template <std::integral Integer>
  CsvLine& count(Integer value) {
    separate();
    append_number(text_, value);
    return *this;
  }
  CsvLine& flag(bool value) { return count(value ? 1 : 0); }
  /// Text that `csv_field` has prepared.
  CsvLine& prepared(std::string_view field) {
    separate();
    text_ += field;
    return *this;
  }
  CsvLine& empty(int fields = 1) {
    for (int field = 0; field < fields; ++field) separate();
    return *this;
  }
  void end() { text_.push_back('\n'); }

 private:
  void separate() {
    if (!first_) text_.push_back(',');
    first_ = false;
  }

  std::string& text_;
  bool first_ = true;
  NumberText last_{0.0};
};

}  // namespace dcem::io
