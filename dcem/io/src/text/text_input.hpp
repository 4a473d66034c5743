#pragma once
/// What the readers of text files share: reading a whole file, numbers without surprises, words of error messages.
/// Private to dcem::io.
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dcem::io {

/// The file's bytes without a UTF-8 byte order mark. Throws InputError when it is missing, a folder or unreadable;
/// `expectation` says what should have been there, e.g. "expected an OBJ file".
std::string read_text_file(const std::filesystem::path& file, const std::string& expectation);

/// What keeps a name from being that of something to read: "is not there", "is a folder"; nothing where it is.
std::optional<std::string> trouble_of(const std::filesystem::path& file);
/// The same of a file that another file names and that may be read more than once: no pipe.
std::optional<std::string> trouble_of_named(const std::filesystem::path& file);

/// The same text with a '?' for each control character.
std::string without_controls(std::string_view text);
/// Text from a file as it may stand in a message: on one line, without control characters, cut when too long.
std::string printable(std::string_view text);
/// The same in quotes.
std::string in_quotes(std::string_view text);

/// Whether a name may stand in a line of a result or of a message: no control characters.
bool is_printable(std::string_view text);

/// The whole text as a finite number in decimal notation; nothing where it is anything else ("nan", "1e999", "1x").
std::optional<double> parse_number(std::string_view text);
/// The whole text as an integer; nothing where it is anything else or too large.
std::optional<long long> parse_integer(std::string_view text);

/// The fewest digits that say the same: "0.5", "100", "1e+300".
std::string number_text(double value);

/// Numbers that are allowed, and how a message calls them.
struct NumberRange {
  double minimum, maximum;
  bool above_minimum = false;  ///< the minimum itself is not allowed

  bool holds(double value) const { return (above_minimum ? value > minimum : value >= minimum) && value <= maximum; }
  std::string bounds_text() const;  ///< "from 0 to 1", "above 0, at most 10"
  std::string text() const { return "a number " + bounds_text(); }
};

/// Text without blanks at its ends.
std::string_view trimmed(std::string_view text);

/// Takes the next word, up to a blank or tabulator, from the front of `rest`; empty at the end.
std::string_view take_word(std::string_view& rest);

/// Takes lines from a text one by one; they end in LF, CR LF or CR.
class LineReader {
 public:
  explicit LineReader(std::string_view text) : rest_(text) {}

  /// Moves to the next line; false at the end.
  bool next();
  std::string_view line() const { return line_; }
  std::size_t number() const { return number_; }  ///< counted from 1

 private:
  std::string_view rest_, line_;
  std::size_t number_ = 0;
};

}  // namespace dcem::io
