#include "dcem/io/src/text/text_input.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <fstream>
#include <istream>
#include <iterator>
#include <system_error>
#include <utility>

#include "dcem/core/error.hpp"
#include "dcem/io/input_error.hpp"
#include "dcem/io/src/text/read_log.hpp"
#include "dcem/io/src/text/unwritten_files.hpp"

namespace dcem::io {

namespace {

constexpr std::size_t longest_quotation = 80;

// Character by character: words are short, and the searches of std::string_view call a function for each of theirs.
bool is_blank(char character) {
  return character == ' ' || character == '\t';
}

bool ends_line(char character) {
  return character == '\n' || character == '\r';
}

/// How many characters come before the first that is one of them.
template <typename IsOne>
std::size_t length_until(std::string_view text, IsOne is_one) {
  return static_cast<std::size_t>(std::find_if(text.begin(), text.end(), is_one) - text.begin());
}

bool is_control(char character) {
  const auto code = static_cast<unsigned char>(character);
  return code < 0x20 || code == 0x7F;
}

/// What a stream that was just opened holds. A file is read at once; what has no size, as a pipe, piece by piece.
std::string all_of(std::istream& stream, const std::filesystem::path& file) {
  std::error_code ignored;
  const bool has_size = std::filesystem::is_regular_file(file, ignored);
  std::string text(has_size ? std::filesystem::file_size(file, ignored) : 0, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  if (!stream.bad()) stream.clear();  // a file may have shrunk meanwhile
  text.append(std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>());
  return text;
}

}  // namespace

std::optional<std::string> trouble_of(const std::filesystem::path& file) {
  if (UnwrittenFiles::find(file) != nullptr) return std::nullopt;
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) return "is not there";
  if (std::filesystem::is_directory(file, ignored)) return "is a folder";
  return std::nullopt;
}

std::optional<std::string> trouble_of_named(const std::filesystem::path& file) {
  if (UnwrittenFiles::find(file) != nullptr) return std::nullopt;
  std::error_code ignored;
  if (std::filesystem::is_regular_file(file, ignored)) return std::nullopt;
  return trouble_of(file).value_or("is no regular file");
}

std::string read_text_file(const std::filesystem::path& file, const std::string& expectation) {
  if (const std::string* text = UnwrittenFiles::find(file)) return *text;
  if (const auto trouble = trouble_of(file)) throw InputError(file.string(), *trouble + "; " + expectation);
  ReadLog::note(file);
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  std::string text = stream ? all_of(stream, file) : std::string();
  if (!stream) {
    const std::string reason = errno != 0 ? std::generic_category().message(errno) : "input error";
    throw InputError(file.string(), "cannot be read (" + reason + "); " + expectation);
  }
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  if (text.starts_with(byte_order_mark)) text.erase(0, byte_order_mark.size());
  return text;
}

bool is_printable(std::string_view text) {
  return std::none_of(text.begin(), text.end(), is_control);
}

std::string without_controls(std::string_view text) {
  std::string result(text);
  std::replace_if(result.begin(), result.end(), is_control, '?');
  return result;
}

std::string printable(std::string_view text) {
  std::string result = without_controls(text.substr(0, longest_quotation));
  if (text.size() <= longest_quotation) return result;
  // A character of several bytes must not be cut in two.
  while (!result.empty() && (static_cast<unsigned char>(result.back()) & 0x80U) != 0) result.pop_back();
  return result + "...";
}

std::string in_quotes(std::string_view text) {
  return "'" + printable(text) + "'";
}

std::string number_text(double value) {
  std::array<char, 32> digits{};
  return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr};
}

std::string NumberRange::bounds_text() const {
  const std::string low = number_text(minimum), high = number_text(maximum);
  return above_minimum ? "above " + low + ", at most " + high : "from " + low + " to " + high;
}

std::optional<double> parse_number(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = error == std::errc() && end == text.data() + text.size() && !text.empty();
  return whole && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

std::optional<long long> parse_integer(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  long long value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = error == std::errc() && end == text.data() + text.size() && !text.empty();
  return whole ? std::optional(value) : std::nullopt;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string_view take_word(std::string_view& rest) {
  while (!rest.empty() && is_blank(rest.front())) rest.remove_prefix(1);
  const std::size_t length = length_until(rest, is_blank);
  const std::string_view word = rest.substr(0, length);
  rest.remove_prefix(length);
  return word;
}

bool LineReader::next() {
  if (rest_.empty()) return false;
  const std::size_t length = length_until(rest_, ends_line);
  line_ = rest_.substr(0, length);
  rest_.remove_prefix(length);
  if (rest_.starts_with("\r\n")) {
    rest_.remove_prefix(2);
  } else if (!rest_.empty()) {
    rest_.remove_prefix(1);
  }
  ++number_;
  return true;
}

}  // namespace dcem::io
