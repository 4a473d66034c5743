#pragma once
/// Numbers and tables as text, for the summary at the end of a run and for the labels of pictures.
#include <string>
#include <string_view>
#include <vector>

namespace dcem::io {

/// `value` with `decimals` digits after the point, whatever the locale. Never "-0"; "-" for a value that is not finite.
std::string format_fixed(double value, int decimals);

/// Bytes in two to four digits: "368 GB", "1049 MB", "640 bytes"; kB, MB and GB are powers of 1000.
std::string memory_text(double bytes);

/// A table for the console: columns as wide as their longest cell, two blanks between them.
class TextTable {
 public:
  enum class Align { left, right };

  struct Column {
    std::string heading;
    Align align = Align::right;
  };

  /// Where every heading is empty the table has no head. Throws `std::invalid_argument` without a column.
  explicit TextTable(std::vector<Column> columns);

  /// Adds a row; throws `std::invalid_argument` where the number of cells is not the number of columns.
  void add_row(std::vector<std::string> cells);

  /// The table, each line ended by a line feed and without blanks at its end.
  [[nodiscard]] std::string str() const;

 private:
  [[nodiscard]] std::vector<std::size_t> column_widths() const;
  [[nodiscard]] std::string line(const std::vector<std::string>& cells, const std::vector<std::size_t>& widths) const;

  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;
};

/// Number of characters of a UTF-8 text (so that "µV" counts two): the width it takes on a console.
std::size_t character_count(std::string_view text);

}  // namespace dcem::io
