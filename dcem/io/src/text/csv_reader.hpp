#pragma once
/// Tables as text: a header that names the columns, and rows of as many fields. Private to dcem::io.
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dcem/io/src/text/text_input.hpp"

namespace dcem::io {

/// Fields as RFC 4180 has them, but for line ends in quotes. Every error is an InputError with file and line.
class CsvReader {
 public:
  /// A column that is looked for.
  struct Column {
    std::string name;
    bool is_required = true;
  };
  enum class OtherColumns { refused, ignored };
  enum class EmptyLines { anywhere, at_the_end };

  /// Reads the header. `expectation`: what should have been there, e.g. "a header x_m,y_m".
  CsvReader(std::string file, std::string_view text, std::vector<Column> columns, std::string expectation,
            OtherColumns others, EmptyLines empty_lines);

  /// Moves to the next row; false at the end.
  bool next();

  std::size_t line() const { return lines_.number(); }
  [[noreturn]] void fail(const std::string& what) const;

  /// The field of a column of the constructor's list, without blanks at its ends; empty where the column is absent.
  std::string_view text(std::size_t column) const;
  /// The same as a number; 0 where the column is absent.
  double number(std::size_t column, const NumberRange& range) const;

 private:
  void read_header(OtherColumns others);
  void split();

  std::string file_;
  LineReader lines_;
  std::vector<Column> columns_;
  std::string expectation_;
  EmptyLines empty_lines_;
  std::vector<std::string> fields_;
  std::size_t width_ = 0;
  std::vector<std::optional<std::size_t>> field_of_;  ///< by column
};

}  // namespace dcem::io
